//! Undo: a step is the list of pages as they were.

use std::collections::BTreeMap;

use super::page::Page;

/// Pages by number, as they were before a step (or, on the redo side, after it).
type Step = BTreeMap<u32, Page>;

#[derive(Debug)]
pub struct History {
    open: Option<Step>,
    undo: Vec<Step>,
    redo: Vec<Step>,
    /// Bytes that all steps together may hold.
    pub limit: u64,
    bytes: u64,
}

impl Default for History {
    fn default() -> Self {
        History { open: None, undo: vec![], redo: vec![], limit: 1 << 30, bytes: 0 }
    }
}

/// What a kept page holds that the clay does not share once it has moved on.
fn cost(page: &Page) -> u64 {
    (page.positions.len() * 24 + page.halo.len() * 12) as u64
}

impl History {
    pub fn begin(&mut self) {
        self.open.get_or_insert_with(Step::new);
    }

    /// The page is about to change.
    pub fn keep(&mut self, index: u32, page: &Page) {
        if let Some(step) = &mut self.open {
            if let std::collections::btree_map::Entry::Vacant(slot) = step.entry(index) {
                self.bytes += cost(page);
                slot.insert(page.clone());
            }
        }
    }

    pub fn end(&mut self) {
        let Some(step) = self.open.take().filter(|s| !s.is_empty()) else { return };
        for gone in self.redo.drain(..) {
            self.bytes -= gone.values().map(cost).sum::<u64>();
        }
        self.undo.push(step);
        while self.bytes > self.limit && self.undo.len() > 1 {
            let gone = self.undo.remove(0);
            self.bytes -= gone.values().map(cost).sum::<u64>();
        }
    }

    fn swap(step: Step, pages: &mut [Page]) -> Step {
        step.into_iter()
            .map(|(i, page)| {
                let now = std::mem::replace(&mut pages[i as usize], page);
                (i, now)
            })
            .collect()
    }

    pub fn undo(&mut self, pages: &mut [Page]) -> bool {
        let Some(step) = self.undo.pop() else { return false };
        self.redo.push(Self::swap(step, pages));
        true
    }

    pub fn redo(&mut self, pages: &mut [Page]) -> bool {
        let Some(step) = self.redo.pop() else { return false };
        self.undo.push(Self::swap(step, pages));
        true
    }

    pub fn undo_steps(&self) -> usize {
        self.undo.len()
    }

    pub fn redo_steps(&self) -> usize {
        self.redo.len()
    }
}
