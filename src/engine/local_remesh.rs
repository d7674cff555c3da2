//! Settings of a remesh of part of an object; `remesh_work` carries it out.

use serde::{Deserialize, Serialize};

use crate::view_region::ViewRegion;

/// The wanted length of edges.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum WantedEdge {
    /// In mesh units; between a 16th and 16 times of the usual length.
    Length(f32),
    /// So many times the usual length, a 16th to 16. The usual one is the median of the object's
    /// edges.
    OfUsual(f32),
}

/// Remesh of triangles of the active object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocalRemesh {
    /// Target length of edges.
    pub edge: WantedEdge,
    /// Only edges that are too long are changed, and what they leave badly shaped.
    pub stretched_only: bool,
    /// Only what is seen in this region of the view, all the way through; `None`: everywhere.
    pub region: Option<ViewRegion>,
}
