//! The object: files, history, Booleans, levels, wall thickness.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::Value;

#[cfg(test)]
use crate::range::{COORDINATE, VIEW};

/// A Boolean of the object (the first operand) and a tool (the second).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Operation {
    /// Everything that either covers. Version 1 calls it `add` in `join`.
    #[serde(alias = "add")]
    Union,
    /// Everything that both cover. Version 1 calls it `keep` in `join`.
    #[serde(alias = "keep")]
    Intersection,
    /// The object without the tool. Version 1 calls it `carve` in `join`.
    #[serde(alias = "carve")]
    Difference,
    /// The tool without the object.
    ReverseDifference,
}

/// Parameters of `join`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JoinParams {
    /// Of the object and what the hands hold.
    pub operation: Operation,
}

/// Parameters of `boolean`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BooleanParams {
    /// Of the object and the mesh in the file.
    pub operation: Operation,
    /// The tool: an absolute path of a mesh file.
    #[cfg_attr(test, schemars(extend("minLength" = 1, "maxLength" = 4096)))]
    pub path: PathBuf,
    /// The tool is moved by this, in the mesh's unit; [`crate::range::COORDINATE`].
    #[serde(default)]
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub at: [f64; 3],
}

/// Reply of `join`, `boolean` and `trim`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BooleanReply {
    /// Computed and written only around the tool.
    pub local: bool,
    /// Pages of the mesh that were written.
    pub pages_written: u64,
    /// Pages that stayed as they were.
    pub pages_shared: u64,
    /// Number of computations: repeated if the object changed there meanwhile.
    pub tries: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers that were baked into the surface, because all of it was recomputed. If only the
    /// surroundings of the tool were, the layers stay.
    #[serde(default)]
    pub layers_baked: u64,
    /// Face sets that were dropped with the old surface; what was hidden is shown again. 0 where
    /// they were carried over.
    #[serde(default)]
    pub sets_dropped: u64,
}

/// Parameters of `trim`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TrimParams {
    /// Part to cut off, all the way through.
    pub part: TrimRegion,
}

/// A region of the view, (0, 0) top left to (1, 1) bottom right; [`crate::range::VIEW`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TrimRegion {
    /// Two opposite corners: x, y, x, y.
    Box(#[cfg_attr(test, schemars(inner(range(min = VIEW.min, max = VIEW.max))))] [f32; 4]),
    /// Everything to the left of the line from the first point to the second: x, y, x, y.
    Line(#[cfg_attr(test, schemars(inner(range(min = VIEW.min, max = VIEW.max))))] [f32; 4]),
}

/// Reply of `progress`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ProgressReply {
    /// True while a Boolean is under way.
    pub running: bool,
    /// Progress, 0 to 1; `null` if no Boolean is under way.
    pub done: Option<f32>,
}

/// Reply of `cancel`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CancelReply {
    /// True if a Boolean was cancelled.
    pub cancelled: bool,
}

/// Parameters of `level`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LevelParams {
    /// One level finer or coarser.
    pub to: LevelStep,
}

/// One level finer or coarser.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LevelStep {
    /// Finer.
    Up,
    /// Coarser.
    Down,
}

/// Reply of `level`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LevelReply {
    /// The level that is shown from now on.
    pub level: u64,
    /// Number of levels.
    pub levels: u64,
    /// Layers that were baked into the surface before another level took its place.
    #[serde(default)]
    pub layers_baked: u64,
    /// Face sets that were dropped with the old surface; what was hidden is shown again. 0 where
    /// they were carried over.
    #[serde(default)]
    pub sets_dropped: u64,
}

/// Parameters of `remesh`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RemeshParams {
    /// Edge of a voxel in the mesh's unit; without it the mean edge of the triangles as they are.
    /// At least 1/1024 and at most 1/8 of the object's longest side.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1e-9, max = COORDINATE.max)))]
    pub voxel: Option<f32>,
    /// Edges stay sharp.
    pub sharp: bool,
}

/// Reply of `remesh`. Lengths and volumes are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RemeshReply {
    /// Edge of a voxel.
    pub voxel: f32,
    /// Vertices of the new mesh.
    pub vertices: u64,
    /// Triangles of the new mesh.
    pub triangles: u64,
    /// The volume before.
    pub volume_before: f64,
    /// The volume after. Parts thinner than a voxel or two are lost or grow together.
    pub volume: f64,
    /// Pairs of triangles that cross each other.
    #[serde(default)]
    pub self_intersections: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers that were baked into the surface, which is another one now.
    #[serde(default)]
    pub layers_baked: u64,
    /// Face sets that were dropped with the old surface; what was hidden is shown again. 0 where
    /// they were carried over.
    #[serde(default)]
    pub sets_dropped: u64,
    /// Properties of the old surface that the new one lacks, in words.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// Parameters of `jump`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct JumpParams {
    /// A node of the history, as `history` lists them.
    #[cfg_attr(test, schemars(range(min = 0, max = 9_007_199_254_740_992_u64)))]
    pub node: u64,
}

/// Reply of `history`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HistoryReply {
    /// The node that the object is at.
    pub here: u64,
    /// Every node, in the order in which they were made.
    pub places: Vec<HistoryNode>,
}

/// A node of the history tree: the object as it was after one step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HistoryNode {
    /// Its number, for `jump`.
    pub node: u64,
    /// The node before; `null` where an object begins.
    pub parent: Option<u64>,
    /// The tick that made it.
    pub tick: u64,
    /// Cause of the node: the name of the event, for `Jump` with the target node.
    #[serde(alias = "event")]
    pub deed: Value,
    /// Pages of the mesh that the step changed.
    pub changed: u64,
    /// Pages of the mesh.
    pub pages: u64,
    /// True if another branch starts at the previous node.
    pub branch: bool,
    /// True if the object is at this node.
    pub here: bool,
}

/// Reply of `load`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LoadReply {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Data that was left out or guessed, one sentence each.
    pub warnings: Vec<String>,
}

/// Reply of `take-up`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TakeUpReply {
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Data that was left out or guessed, one sentence each.
    pub warnings: Vec<String>,
}

/// Reply of `export`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ExportReply {
    /// The file that was written.
    pub path: PathBuf,
    /// The tick whose state it holds.
    pub tick: u64,
    /// Vertices that were written.
    pub vertices: u64,
    /// Properties of the objects that the format cannot hold, one sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// Reply of `hash`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HashReply {
    /// The tick whose state was hashed.
    pub tick: u64,
    /// 16 hexadecimal digits over the whole mesh.
    pub hash: String,
}

/// Definition of wall thickness; as `--method` of `sculptd thickness`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ThicknessDefinition {
    /// One ray along the normal.
    Ray,
    /// The mean of a cone of rays.
    Cone,
    /// The largest ball between the place and the side opposite.
    Sphere,
}

/// Parameters of `thickness`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ThicknessParams {
    /// The definition; `null`: a ray, or a cone where more than one ray is asked for.
    pub method: Option<ThicknessDefinition>,
    /// Rays of a cone.
    #[cfg_attr(test, schemars(range(min = 1, max = 1000)))]
    pub rays: u32,
    /// Walls below this are too thin, in the mesh's unit; `null`: no limit.
    pub limit: Option<f32>,
    /// Not used any more; [`crate::range::COORDINATE`].
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub near: [f32; 3],
}

impl Default for ThicknessParams {
    fn default() -> Self {
        ThicknessParams { method: None, rays: 1, limit: None, near: [0.0; 3] }
    }
}

/// Reply of `thickness`: what `sculptd thickness` says of the same mesh. Lengths are in the mesh's
/// unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ThicknessReply {
    /// The revision of the mesh that was measured.
    pub revision: u64,
    /// The definition.
    pub method: ThicknessDefinition,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Vertices that were measured this time: none where nothing changed since the last call.
    pub measured: u64,
    /// Vertices with a thickness; the others see no opposite wall.
    pub valid: u64,
    /// The least wall; `null` where no place has one.
    pub min: Option<f32>,
    /// The thickest.
    pub max: Option<f32>,
    /// The mean over the area; `null` where no place has a wall.
    pub mean: Option<f32>,
    /// Half of the area is thinner.
    pub median: Option<f32>,
    /// No wall is thinner; `null` where no place has one.
    pub lower: Option<f64>,
    /// Some wall is no thicker.
    pub upper: Option<f64>,
    /// The two bounds are proven over the whole surface.
    pub certified: bool,
    /// Meaning of the bounds, in one sentence.
    pub statement: String,
    /// The share of the area below the limit, in per cent; `null` without a limit.
    pub below_percent: Option<f64>,
}
