//! The steps of dynamic topology, below the clay: finding edges to change, changing them, and
//! writing the pages that changed.
//!
//! Laws kept here:
//! * Work is counted, never timed: the same input stops at the same operation on every machine.
//! * Memory is kept from call to call.
//! * What runs on several threads writes one page from one task.

mod absorb;
mod collapse;
pub(crate) mod edit;
pub(crate) mod operations;
pub(crate) mod rebuild;
pub(crate) mod scan;
mod shape;
pub(crate) mod task;
mod write_page;

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A vertex with this much mask stays where and as it is.
pub(crate) const PROTECTED: f32 = 0.99;

/// The target for the triangles within a ball.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Detail {
    /// The centre of the ball, mesh units.
    pub centre: Vec3,
    /// The radius of the ball, mesh units, > 0.
    pub radius: f32,
    /// The wanted length of edges, mesh units, > 0. Longer than 4/3 of it they are split, shorter
    /// than 1/2 collapsed.
    pub edge: f32,
    /// Edges that are too long are split.
    pub split: bool,
    /// Edges that are too short are collapsed.
    pub collapse: bool,
}

impl Detail {
    /// Longer edges are split, mesh units. A half of such an edge is longer than
    /// [`Detail::shortest`]: what was split is not collapsed in turn.
    pub(crate) fn longest(&self) -> f32 {
        self.edge * (4.0 / 3.0)
    }

    /// Shorter edges are collapsed, mesh units.
    pub(crate) fn shortest(&self) -> f32 {
        self.edge * 0.5
    }

    pub(crate) fn contains(&self, p: Vec3) -> bool {
        (p - self.centre).length_squared() <= self.radius * self.radius
    }

    pub(crate) fn is_sane(&self) -> bool {
        self.edge > 0.0 && self.radius > 0.0 && self.centre.is_finite()
    }
}

/// The filter for places of the surface that may be changed, in addition to the balls. It must
/// return the same result for a place each time.
pub type Within<'a> = Option<&'a (dyn Fn(Vec3) -> bool + Sync)>;

/// The result of the changes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cuts {
    /// Edges that were split.
    pub splits: usize,
    /// Edges that were collapsed.
    pub collapses: usize,
    /// Edges that were flipped.
    pub flips: usize,
    /// Corners of slivers that were moved along the surface.
    pub slides: usize,
    /// Counted work: an operation that was looked at counts one, a page that was looked through
    /// [`PAGE_SCAN`], a page that was written [`PAGE_WRITE`].
    pub work: usize,
    /// Asking again may find more: the budget ended the work before all pages were looked through,
    /// or pages were changed, which are looked through again. Never where nothing was achieved.
    pub unfinished: bool,
    /// Nothing was changed, since a page would have become too tangled to be written: a smaller
    /// budget, which changes a page less at a time, may get further.
    pub tangled: bool,
}

impl Cuts {
    /// Edges that were changed, and vertices that were moved.
    pub fn changes(&self) -> usize {
        self.splits + self.collapses + self.flips + self.slides
    }
}

/// Pages that are looked through before what was found in them is changed.
pub(crate) const SCANNED: usize = 16;
/// The cost of a scan of a page, in operations: about 8 microseconds, where an operation takes a
/// quarter of one.
pub const PAGE_SCAN: usize = 32;
/// The cost of writing a page, in operations: about 50 microseconds.
pub const PAGE_WRITE: usize = 200;

/// The least budget of [`Clay::adapt_topology`](crate::Clay::adapt_topology) that surely gets on:
/// a page of triangles that all are tried in vain, and the writing of what a first change touches.
pub const LEAST_TOPOLOGY_BUDGET: usize = 4_000;

/// A page that was looked through and left as it was.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PageVisit {
    /// The page's revision then.
    pub(crate) revision: u64,
    /// The numbers of the balls that were asked for then: all that are still asked for and have a
    /// number from the first to the second.
    pub(crate) balls: (u32, u32),
}

impl PageVisit {
    /// No page has this revision.
    pub(crate) const NEVER: PageVisit = PageVisit { revision: u64::MAX, balls: (1, 0) };
}

/// The memory of dynamic topology, kept from call to call.
#[derive(Debug, Default)]
pub(crate) struct TopologyBuffers {
    pub(crate) edit: edit::Edit,
    pub(crate) queues: operations::Queues,
    pub(crate) rebuild: rebuild::PageRebuild,
    /// One for each page that is looked through at the same time.
    pub(crate) scans: Vec<scan::PageScan>,
    /// Pages to be looked through, in order: those of the newest balls first.
    pub(crate) pages: Vec<(u32, u32)>,
    /// For each page what was found when it was looked through last.
    pub(crate) visits: Vec<PageVisit>,
    /// The balls of the last call and their numbers. A ball keeps its number from call to call.
    pub(crate) balls: Vec<(Detail, u32)>,
    next_ball: u32,
    /// One for each page that is worked on apart from others, made when it is first needed.
    pub(crate) tasks: Vec<task::TopologyTask>,
    pub(crate) map: absorb::SlotMap,
}

/// Pages that one call writes, at most, without asking for memory.
const WRITTEN: usize = 64;

impl TopologyBuffers {
    /// Whether [`TopologyBuffers::make_ready`] was called.
    pub(crate) fn is_ready(&self) -> bool {
        !self.scans.is_empty()
    }

    /// Makes room for what a tick's work usually needs: lists would grow one by one, long into a
    /// stroke. `pages`: as many as the clay may come to have.
    pub(crate) fn make_ready(&mut self, pages: usize) {
        self.visits.reserve(pages);
        self.scans.resize_with(SCANNED, scan::PageScan::new);
        self.pages.reserve(1024);
        self.balls.reserve(2 * scan::BALLS);
        self.edit.reserve_lists();
        self.queues.reserve();
        self.rebuild.reserve(WRITTEN);
    }

    /// Gives each ball a number: the one that it had in the last call, else the next.
    pub(crate) fn number(&mut self, balls: &[Detail], pages: usize) {
        self.visits.resize(pages, PageVisit::NEVER);
        let old = self.balls.len();
        for ball in balls {
            let known = self.balls[..old].iter().find(|b| b.0 == *ball).map(|b| b.1);
            let number = known.unwrap_or_else(|| {
                self.next_ball = self.next_ball.wrapping_add(1);
                if self.next_ball == 0 {
                    // Numbers restart here: marks with old numbers must not match.
                    self.visits.fill(PageVisit::NEVER);
                }
                self.next_ball
            });
            self.balls.push((*ball, number));
        }
        self.balls.drain(..old);
    }
}
