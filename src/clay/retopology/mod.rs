//! The steps of dynamic topology, below the clay: finding edges to change, changing them, and
//! writing the pages that changed.
//!
//! Laws kept here:
//! * Work is counted, never timed: the same input stops at the same operation on every machine.
//! * Memory is kept from call to call.
//! * What runs on several threads writes one page from one task.

pub(crate) mod edit;
pub(crate) mod operations;
pub(crate) mod rebuild;
pub(crate) mod scan;
mod shape;
mod write_page;

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A vertex with this much mask stays where and as it is.
pub(crate) const PROTECTED: f32 = 0.99;

/// What is wanted of the triangles within a ball.
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

/// What was done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cuts {
    /// Edges that were split.
    pub splits: usize,
    /// Edges that were collapsed.
    pub collapses: usize,
    /// Edges that were flipped.
    pub flips: usize,
    /// Counted work: an operation that was looked at counts one, a page that was looked through
    /// [`PAGE_SCAN`], a page that was written [`PAGE_WRITE`].
    pub work: usize,
    /// The budget ended the work before all edges were looked at.
    pub unfinished: bool,
}

impl Cuts {
    /// Edges that were changed.
    pub fn changes(&self) -> usize {
        self.splits + self.collapses + self.flips
    }
}

/// What looking through a page counts, in operations.
pub const PAGE_SCAN: usize = 4;
/// What writing a page counts, in operations.
pub const PAGE_WRITE: usize = 24;

/// The memory of dynamic topology, kept from call to call.
#[derive(Debug, Default)]
pub(crate) struct TopologyBuffers {
    pub(crate) edit: edit::Edit,
    pub(crate) queues: operations::Queues,
    pub(crate) rebuild: rebuild::PageRebuild,
    /// One for each page that is looked through.
    pub(crate) scans: Vec<scan::PageScan>,
    pub(crate) pages: Vec<u32>,
    pub(crate) found: Vec<scan::Candidate>,
}
