//! Pressures of the pens over the last frames.

use std::collections::VecDeque;

use super::view::View;

/// Pressures felt lately, newest first.
#[derive(Debug, Default)]
pub struct PenTrace {
    felt: VecDeque<f32>,
}

impl PenTrace {
    pub const KEPT: usize = 40;

    /// Remembers the pressure of the pen that presses hardest.
    pub fn feel(&mut self, view: &View<'_>) {
        let pens = view.state.pens.iter().flatten();
        let now = pens.map(|(_, p)| p.pressure).filter(|p| *p > 0.0).reduce(f32::max);
        match now {
            Some(p) => self.felt.push_front(p),
            None => drop(self.felt.pop_back()),
        }
        self.felt.truncate(PenTrace::KEPT);
    }

    pub fn recent(&self) -> impl Iterator<Item = f32> + '_ {
        self.felt.iter().copied()
    }
}
