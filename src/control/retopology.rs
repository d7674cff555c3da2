//! Other triangles for the same surface: quads that follow the shape, and fewer triangles.

use serde::{Deserialize, Serialize};

use crate::brush::ViewRegion;
#[cfg(test)]
use crate::range::COORDINATE;

/// Parameters of `remesh.quads`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RemeshQuadsParams {
    /// About how many quads.
    #[cfg_attr(test, schemars(range(min = 6, max = 1_000_000)))]
    pub quads: u32,
    /// Edges whose faces turn by more than this many degrees are kept; without it none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = 180.0)))]
    pub creases: Option<f64>,
    /// Lines on the surface that the quads follow, each a list of points in the mesh's unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(test, schemars(length(min = 0, max = 1000)))]
    pub guides: Vec<Vec<[f64; 3]>>,
    /// The quads become the lowest level, with so many finer ones on which the detail of the old
    /// surface is; the finest is shown.
    #[serde(default)]
    #[cfg_attr(test, schemars(range(min = 0, max = 6)))]
    pub levels: u32,
}

/// Reply of `remesh.quads`. Volumes are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RemeshQuadsReply {
    /// Quads, on the lowest level. Clay is made of triangles; without finer levels an export writes
    /// the quads as long as no triangle was changed.
    pub quads: u64,
    /// Triangles among them, on the lowest level.
    pub other_faces: u64,
    /// Vertices of the level that is shown.
    pub vertices: u64,
    /// Triangles of the level that is shown.
    pub triangles: u64,
    /// The volume before.
    pub volume_before: f64,
    /// The volume after.
    pub volume: f64,
    /// Pairs of triangles that cross each other: where the surface is thinner than a quad.
    pub self_intersections: u64,
    /// Vertices of finer levels without a place on the old surface: these are smooth.
    pub without_detail: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers that were baked into the surface, which is another one now.
    pub layers_baked: u64,
    /// Changes made beforehand, one sentence each.
    pub warnings: Vec<String>,
}

/// Parameters of `remesh.local`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RemeshLocalParams {
    /// The wanted length of edges in the mesh's unit, between a 16th and 16 times of the usual
    /// one. Without it that one: the median of the object's edges.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = COORDINATE.max)))]
    pub edge: Option<f32>,
    /// Only edges that are too long are changed: where the surface was stretched.
    pub stretched_only: bool,
    /// Only what is seen in this region, all the way through; without it the whole object.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<ViewRegion>,
}

/// Reply of `remesh.local`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RemeshLocalReply {
    /// Edges that were split, drawn together or flipped; 0: the triangles had their size already.
    pub changed: u64,
}

/// Parameters of `symmetrise`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SymmetriseParams {
    /// Normal of the plane through the middle of the object.
    pub axis: PlaneAxis,
    /// Keeps the side against the axis, and not the one towards which it points.
    #[serde(default)]
    pub negative: bool,
}

/// An axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum PlaneAxis {
    /// To the right.
    X,
    /// Up.
    Y,
    /// Towards the viewer of the front view.
    Z,
}

/// Reply of `symmetrise`. Volumes are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SymmetriseReply {
    /// Vertices of the new mesh.
    pub vertices: u64,
    /// Triangles of the new mesh.
    pub triangles: u64,
    /// The volume before.
    pub volume_before: f64,
    /// The volume after.
    pub volume: f64,
    /// Pairs of triangles that cross each other.
    pub self_intersections: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers that were baked into the surface, which is another one now.
    pub layers_baked: u64,
    /// Remarks on the figures, one sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// Parameters of `decimate`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DecimateParams {
    /// Stop at this many triangles; at least 4, or 0 with `max_error`.
    #[cfg_attr(test, schemars(range(min = 0, max = 67_108_864)))]
    pub triangles: u32,
    /// Stop before the error of a collapse exceeds this, in the mesh's unit: the root of the mean
    /// square distance of the new vertex from the planes of the triangles that it stands for. It
    /// is no bound on the distance between the surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = COORDINATE.max)))]
    pub max_error: Option<f32>,
}

/// Reply of `decimate`. Volumes are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DecimateReply {
    /// Vertices of the new mesh.
    pub vertices: u64,
    /// Triangles of the new mesh: more than wanted where the error or the shape allow no fewer.
    pub triangles: u64,
    /// Triangles before.
    pub triangles_before: u64,
    /// The volume before.
    pub volume_before: f64,
    /// The volume after.
    pub volume: f64,
    /// Pairs of triangles that cross each other where none did before.
    pub new_self_intersections: u64,
    /// Number of more careful repetitions to avoid crossings.
    pub repeated: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers that were baked into the surface, which is another one now.
    pub layers_baked: u64,
    /// Remarks on the figures, one sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
}
