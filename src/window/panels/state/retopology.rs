//! Settings for quads and for decimation, and the operation under way.

use std::sync::Arc;

use sculptd_geometry::job::Job;

/// Degrees by which the faces of an edge turn that is kept.
pub const CREASE: f64 = 30.0;

/// Quads, decimation, and what is under way.
#[derive(Debug)]
pub struct Retopology {
    /// About how many quads.
    pub quads: u32,
    /// Edges of more than [`CREASE`] degrees are kept.
    pub creases: bool,
    /// Finer levels on top of the quads.
    pub levels: u32,
    /// Share of the triangles that decimation keeps, in per cent.
    pub share: f32,
    /// Quads or a decimation under way: how far it is, and its end.
    pub under_way: Option<Arc<Job>>,
}

impl Default for Retopology {
    fn default() -> Self {
        Retopology { quads: 5000, creases: false, levels: 0, share: 25.0, under_way: None }
    }
}
