//! The face sets of one page, as numbers. See [`crate::face_sets`].

use std::sync::Arc;

/// The bit of a vertex that is hidden.
pub const HIDDEN: u16 = 0x8000;
/// The greatest number of a set.
pub const MOST_SETS: u16 = 0x7fff;

/// The face sets of a page.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct PageSets {
    /// Own, then halo.
    pub(crate) rows: Vec<u16>,
    /// True if any of them is hidden.
    pub(crate) any_hidden: bool,
    /// The greatest number of a set among them.
    pub(crate) highest: u16,
}

impl PageSets {
    /// One number a row, own and halo; `None` where all are 0.
    pub(crate) fn shared(rows: Vec<u16>) -> Option<Arc<PageSets>> {
        let mut sets = PageSets { rows, any_hidden: false, highest: 0 };
        sets.index().then(|| Arc::new(sets))
    }

    /// Fills in what follows from the rows; false where all are 0.
    pub(crate) fn index(&mut self) -> bool {
        self.any_hidden = self.rows.iter().any(|r| r & HIDDEN != 0);
        self.highest = self.rows.iter().map(|r| r & !HIDDEN).max().unwrap_or(0);
        self.any_hidden || self.highest > 0
    }

    /// Own and halo: the number of the set, and [`HIDDEN`].
    pub fn rows(&self) -> &[u16] {
        &self.rows
    }

    /// Returns the size in the undo budget, in bytes.
    pub(crate) fn weight(&self) -> usize {
        size_of::<PageSets>() + 16 + self.rows.len() * 2
    }
}

/// Returns true if all three corners are hidden.
#[inline(always)]
pub(crate) fn all_hidden(rows: &[u16], corners: [u16; 3]) -> bool {
    corners.iter().fold(HIDDEN, |all, &v| all & rows[v as usize]) != 0
}
