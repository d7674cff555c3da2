//! An edit of a whole object's mask, face sets or triangles on its way through the pages.
//!
//! Laws kept here:
//! * The pages follow in portions, so that no tick takes more than its share however large the
//!   object is. Strokes wait until the last page has followed.
//! * The portion is counted in vertices, and in what finding out about one costs, so that a replay
//!   stops at the same page.
//! * The result depends only on the state before the edit: neighbours written in an earlier portion
//!   have no influence.
//! * An edit is one step of undo. None is under way whenever the world is at rest: it is no part of
//!   a saved state.

use crate::mask_region::MaskSeen;
use crate::region_seen::RegionSeen;
use crate::remesh_work::RemeshWork;
use crate::scene::SceneEvent;
use sculptd_clay::brush::mask_all::MaskAll;
use sculptd_clay::face_sets::{SetsError, SetsWork};
use sculptd_clay::measured_mask::MeasuredMask;
use sculptd_clay::{Clay, GarbageSink, Workers};

/// Vertices written in a tick, in time: about two milliseconds on one core.
const TICK_BUDGET: u64 = 80_000;

/// Kind of edit.
#[derive(Debug)]
pub(crate) enum SurfaceEdit {
    /// Something to the whole mask.
    Mask(MaskAll),
    /// The mask of what is seen in a region becomes this one.
    MaskSeen(RegionSeen, f32),
    /// Masks the measured vertices.
    MaskMeasured(MeasuredMask),
    /// Something to the face sets; where to a part, to what is seen in a region.
    Sets(SetsWork, Option<RegionSeen>),
    /// Triangles get another size.
    Remesh(Box<RemeshWork>),
}

/// Destination of an edit's result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Nobody waits for the result.
    Untold,
    /// To this place among the results of the tick.
    Now(usize),
    /// It was asked for in an earlier tick.
    Earlier,
}

/// Edit work that remains.
#[derive(Debug)]
pub(crate) struct SurfaceWork {
    edit: Option<SurfaceEdit>,
    asked: Asked,
    /// The next page of a mask.
    next: usize,
    batch: Vec<u32>,
}

impl SurfaceWork {
    pub(crate) fn new() -> SurfaceWork {
        SurfaceWork { edit: None, asked: Asked::Untold, next: 0, batch: Vec::with_capacity(256) }
    }

    /// Returns true while an edit is under way.
    pub(crate) fn is_under_way(&self) -> bool {
        self.edit.is_some()
    }

    /// Returns true if the edit resizes triangles.
    pub(crate) fn is_remesh(&self) -> bool {
        matches!(self.edit, Some(SurfaceEdit::Remesh(_)))
    }

    /// Returns the history event of the edit under way.
    pub(crate) fn event(&self) -> SceneEvent {
        match self.edit {
            Some(SurfaceEdit::Sets(..)) => SceneEvent::Sets,
            Some(SurfaceEdit::Remesh(_)) => SceneEvent::Remesh,
            _ => SceneEvent::Mask,
        }
    }

    /// Returns the destination of its result.
    pub(crate) fn asked(&self) -> Asked {
        self.asked
    }

    /// Begins an edit; none is under way.
    pub(crate) fn begin(&mut self, edit: SurfaceEdit, asked: Asked) {
        (self.edit, self.asked, self.next) = (Some(edit), asked, 0);
    }

    /// A tick has passed.
    pub(crate) fn next_tick(&mut self) {
        if matches!(self.asked, Asked::Now(_)) {
            self.asked = Asked::Earlier;
        }
    }

    /// The edit is done.
    pub(crate) fn end(&mut self, clay: &Clay, garbage: &GarbageSink) {
        match self.edit.take() {
            Some(SurfaceEdit::Sets(work, seen)) => {
                clay.discard_sets(work);
                seen.into_iter().for_each(|s| garbage.discard_owned(s));
            }
            Some(SurfaceEdit::MaskSeen(seen, _)) => garbage.discard_owned(seen),
            Some(SurfaceEdit::MaskMeasured(mask)) => garbage.discard_owned(mask),
            Some(SurfaceEdit::Remesh(work)) => garbage.discard_owned(work),
            Some(SurfaceEdit::Mask(_)) | None => {}
        }
        self.asked = Asked::Untold;
    }

    /// Does what fits in a tick. `None`: more is to follow; else the set that was made or that it
    /// was about, 0 for none, or how many edges were changed.
    pub(crate) fn run(
        &mut self,
        clay: &mut Clay,
        workers: &Workers,
    ) -> Option<Result<u32, SetsError>> {
        if let Some(SurfaceEdit::Remesh(work)) = &mut self.edit {
            return work.run(clay, workers).map(Ok);
        }
        self.work(clay, workers, TICK_BUDGET)
    }

    /// Does all that is left.
    pub(crate) fn finish(&mut self, clay: &mut Clay, workers: &Workers) -> Result<u32, SetsError> {
        self.work(clay, workers, u64::MAX).unwrap_or(Ok(0))
    }

    fn work(
        &mut self,
        clay: &mut Clay,
        workers: &Workers,
        budget: u64,
    ) -> Option<Result<u32, SetsError>> {
        let SurfaceWork { edit, next, batch, .. } = self;
        match edit.as_mut()? {
            SurfaceEdit::Remesh(work) => Some(Ok(work.finish(clay, workers))),
            SurfaceEdit::Sets(work, None) => {
                Some(clay.run_sets(work, budget, 1, &|_, _| false)?.map(u32::from))
            }
            SurfaceEdit::Sets(work, Some(seen)) => {
                let holds =
                    |page: &sculptd_clay::Page, v| seen.holds(page.point(v), page.normal(v));
                Some(clay.run_sets(work, budget, seen.cost(), &holds)?.map(u32::from))
            }
            SurfaceEdit::Mask(kernel) => {
                let all = take(clay, next, batch, budget, 1);
                clay.dab_on(batch, kernel, workers);
                all.then_some(Ok(0))
            }
            SurfaceEdit::MaskMeasured(mask) => {
                let all = take(clay, next, batch, budget, 1);
                clay.dab_on(batch, mask, workers);
                all.then_some(Ok(0))
            }
            SurfaceEdit::MaskSeen(seen, mask) => {
                let all = take(clay, next, batch, budget, seen.cost());
                clay.dab_on(batch, &MaskSeen { seen, mask: *mask }, workers);
                all.then_some(Ok(0))
            }
        }
    }
}

/// The pages that fit into a budget, and whether they are the last.
fn take(clay: &Clay, next: &mut usize, batch: &mut Vec<u32>, budget: u64, cost: u64) -> bool {
    batch.clear();
    let (count, mut spent) = (clay.page_count(), 0u64);
    while *next < count && spent < budget {
        let vertices = clay.page(*next as u32).own() as u64;
        if vertices > 0 {
            batch.push(*next as u32);
        }
        spent = spent.saturating_add(1 + cost * vertices);
        *next += 1;
    }
    *next == count
}
