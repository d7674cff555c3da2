//! Pending page work after an edit of layers, or after a stroke on a layer.
//!
//! Laws kept here:
//! * The list of layers is the new one at once; the pages follow in portions, so that no tick takes
//!   more than its share however large the layer is. Strokes wait until the last page has followed.
//! * The portion is counted in vertices, so that a replay stops at the same page.
//! * An edit, with all that it does to pages, is one step of undo. While a slider is dragged, each
//!   change of the intensity goes on where the one before it stopped, so that every page follows in
//!   turn however fast the changes come, and all of them are one step.
//! * What a stroke did becomes offsets when it ends, as a part of its step.
//! * Nothing is under way whenever the world is at rest: it is no part of a saved state.

use sculptd_clay::{Clay, LayerEdit, LayerId, LayerJob, LayerOperation, Workers};

/// Vertices of a tick: about two milliseconds on one core.
const TICK_VERTICES: usize = 40_000;
/// Pages that one pass over the clay writes, at most.
const TOGETHER: usize = 96;

/// Why pages are worked through.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Cause {
    /// Nothing is under way.
    #[default]
    Nothing,
    /// A stroke has ended.
    Stroke,
    /// An edit was asked for. `live`: the layer whose intensity is being dragged.
    Edit { live: Option<LayerId> },
}

/// Page work that remains.
#[derive(Debug)]
pub(crate) struct LayerWork {
    cause: Cause,
    operation: LayerOperation,
    /// All pages concerned, ascending.
    pages: Vec<u32>,
    /// The next page, as a place in the list, and how many are left; after the last page the first
    /// follows.
    next: usize,
    left: usize,
    batch: Vec<u32>,
}

impl LayerWork {
    pub(crate) fn new() -> LayerWork {
        LayerWork {
            cause: Cause::Nothing,
            operation: LayerOperation::Evaluate,
            pages: Vec::new(),
            next: 0,
            left: 0,
            batch: Vec::with_capacity(TOGETHER),
        }
    }

    /// Returns true if the open step is an edit of layers.
    pub(crate) fn is_edit(&self) -> bool {
        matches!(self.cause, Cause::Edit { .. })
    }

    /// Returns true if this edit continues the one under way.
    pub(crate) fn goes_on_with(&self, edit: &LayerEdit) -> bool {
        match (self.cause, edit) {
            (Cause::Edit { live }, LayerEdit::Set { id, .. }) => live == Some(*id),
            _ => false,
        }
    }

    /// Returns true while pages remain.
    pub(crate) fn is_pending(&self) -> bool {
        self.left > 0
    }

    /// Returns true if the edit under way can be closed.
    pub(crate) fn is_complete(&self) -> bool {
        self.left == 0 && self.cause == Cause::Edit { live: None }
    }

    /// Begins or goes on with what an edit left to be done.
    pub(crate) fn edit(&mut self, edit: &LayerEdit, job: LayerJob) {
        let live = match edit {
            LayerEdit::Set { id, live: true, .. } => Some(*id),
            _ => None,
        };
        if !(self.goes_on_with(edit) && self.pages == job.pages) {
            (self.pages, self.next) = (job.pages, 0);
        }
        self.left = self.pages.len();
        self.operation = job.operation;
        self.cause = Cause::Edit { live };
    }

    /// Takes over what the open step did to the surface. Nothing, where that is under way or where
    /// the object has no layers.
    pub(crate) fn capture(&mut self, clay: &Clay) {
        if self.cause == Cause::Nothing && clay.is_in_step() {
            clay.touched_by_step(&mut self.pages);
            (self.cause, self.operation) = (Cause::Stroke, LayerOperation::Capture);
            (self.next, self.left) = (0, self.pages.len());
        }
    }

    /// A stroke goes on: what it did is taken over when it ends.
    pub(crate) fn stroke_goes_on(&mut self) {
        if self.cause == Cause::Stroke {
            self.clear();
        }
    }

    /// The step is closed.
    pub(crate) fn clear(&mut self) {
        (self.cause, self.left) = (Cause::Nothing, 0);
    }

    /// Does what fits in a tick.
    pub(crate) fn run(&mut self, clay: &mut Clay, workers: &Workers) {
        self.work(clay, workers, TICK_VERTICES);
    }

    /// Does all that is left.
    pub(crate) fn finish(&mut self, clay: &mut Clay, workers: &Workers) {
        self.work(clay, workers, usize::MAX);
    }

    fn work(&mut self, clay: &mut Clay, workers: &Workers, budget: usize) {
        let mut spent = 0;
        while self.left > 0 && spent < budget {
            self.batch.clear();
            // A pass takes pages in ascending order: it ends where the list does.
            let end = self.pages.len().min(self.next + self.left).min(self.next + TOGETHER);
            for &page in &self.pages[self.next..end] {
                let vertices = clay.page(page).own();
                if !self.batch.is_empty() && spent + vertices > budget {
                    break;
                }
                spent += vertices.max(1);
                self.batch.push(page);
            }
            clay.run_layers(&self.operation, &self.batch, workers);
            self.left -= self.batch.len();
            self.next = (self.next + self.batch.len()) % self.pages.len();
        }
    }
}
