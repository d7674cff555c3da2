//! Face sets: groups of the surface, and which part of it is hidden.
//!
//! Laws kept here:
//! * A vertex has one number of 16 bits: its set, 0 for none, and whether it is hidden. A triangle
//!   is hidden where all its corners are, so that what is hidden and what is left after
//!   [`SetsEdit::Invert`] together cover the surface.
//! * The numbers lie beside a page's points, behind an `Arc` of their own that dabs share. A page
//!   without sets and without hidden vertices has none: it costs what it cost before.
//! * What is hidden is not picked and not changed by brushes, masks and dynamic topology. Layers
//!   are summed up there too, for the surface is their sum.
//! * A copy in a halo says what its home says.

mod edit;
mod extract;
mod make;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::page::Page;

pub use edit::{SetsEdit, SetsError};
pub use extract::{ExtractError, FaceSetPart, extract};
pub use make::{Partition, partition};

/// The bit of a vertex that is hidden.
pub const HIDDEN: u16 = 0x8000;
/// The greatest number of a set.
pub const MOST_SETS: u16 = 0x7fff;

/// From this mask on, 0 free to 1 protected, a vertex counts as masked.
pub const MASKED: f32 = 0.5;

/// The face sets of a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageSets {
    /// Own, then halo.
    rows: Vec<u16>,
    /// Whether any of them is hidden.
    any_hidden: bool,
}

impl PageSets {
    /// One number a row, own and halo; `None` where all are 0.
    pub(crate) fn shared(rows: Vec<u16>) -> Option<Arc<PageSets>> {
        let any_hidden = rows.iter().any(|r| r & HIDDEN != 0);
        rows.iter().any(|r| *r != 0).then(|| Arc::new(PageSets { rows, any_hidden }))
    }

    /// Own and halo: the number of the set, and [`HIDDEN`].
    pub fn rows(&self) -> &[u16] {
        &self.rows
    }

    /// What undo counts, bytes.
    pub(crate) fn weight(&self) -> usize {
        size_of::<PageSets>() + 16 + self.rows.len() * 2
    }
}

impl Page {
    /// The page's face sets; `None`: no vertex is in a set or hidden.
    pub fn sets(&self) -> Option<&PageSets> {
        self.sets.as_deref()
    }

    /// The number of the set and [`HIDDEN`], of an own or a halo vertex.
    #[inline]
    pub(crate) fn set_bits(&self, local: usize) -> u16 {
        self.sets().map_or(0, |s| s.rows[local])
    }

    /// The set of an own or a halo vertex; 0: none.
    #[inline]
    pub fn face_set(&self, local: usize) -> u16 {
        self.set_bits(local) & !HIDDEN
    }

    /// Whether an own or a halo vertex is hidden.
    #[inline]
    pub fn is_hidden(&self, local: usize) -> bool {
        self.set_bits(local) & HIDDEN != 0
    }

    /// The rows of a page where something is hidden.
    #[inline]
    pub(crate) fn hidden_rows(&self) -> Option<&[u16]> {
        self.sets().filter(|s| s.any_hidden).map(|s| s.rows.as_slice())
    }

    /// Whether all corners of a triangle are hidden.
    #[inline]
    pub fn is_triangle_hidden(&self, triangle: usize) -> bool {
        self.hidden_rows().is_some_and(|rows| all_hidden(rows, self.triangles()[triangle]))
    }
}

/// Whether all three corners are hidden.
#[inline(always)]
pub(crate) fn all_hidden(rows: &[u16], corners: [u16; 3]) -> bool {
    corners.iter().fold(HIDDEN, |all, &v| all & rows[v as usize]) != 0
}
