//! The scene: its objects, what can be done to each, Booleans between two, export.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::edit::Operation;
#[cfg(test)]
use crate::range::COORDINATE;

/// Transform of an object: `world = shift + turn * (own * scale)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Placement {
    /// Position of the object's origin; [`crate::range::COORDINATE`].
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub shift: [f64; 3],
    /// A rotation as a quaternion: x, y, z, w. It is brought to unit length.
    #[cfg_attr(test, schemars(inner(range(min = -1.0, max = 1.0))))]
    pub turn: [f64; 4],
    /// World units for a unit of the object.
    #[cfg_attr(test, schemars(range(min = 1e-6, max = 1e6)))]
    pub scale: f64,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { shift: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0], scale: 1.0 }
    }
}

/// A primitive by its numbers, in the scene's unit, each above 0. Its middle is the origin; what
/// has an axis stands along +y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PrimitiveShape {
    /// A box of these sides.
    Box([f64; 3]),
    /// A ball of this radius.
    Ball(f64),
    /// A closed cylinder: radius, height.
    Cylinder([f64; 2]),
    /// A closed cone with its tip up: radius of its base, height.
    Cone([f64; 2]),
    /// A torus: from the middle to the middle of its tube, radius of the tube.
    Torus([f64; 2]),
    /// A closed tube: outer radius, inner radius, height.
    Tube([f64; 3]),
    /// A flat sheet that faces up: its sides along x and z.
    Plane([f64; 2]),
}

/// Parameters of `scene.add`: one of `primitive`, `path` and `held`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct AddParams {
    /// A primitive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub primitive: Option<PrimitiveShape>,
    /// The length of an edge of the primitive's triangles; without it, one that gives about 20,000
    /// vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1e-9, max = COORDINATE.max)))]
    pub edge: Option<f64>,
    /// An absolute path of a mesh file of at most 1 GiB. It comes in its true size and place.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("minLength" = 1, "maxLength" = 4096)))]
    pub path: Option<PathBuf>,
    /// Adds the held object, at its current place; the hands hold nothing afterwards.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub held: bool,
    /// Its name; without it that of the file or the primitive.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: Option<String>,
    /// Its transform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Placement>,
}

/// Parameters of a method about one object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ObjectParams {
    /// The object, as `scene.list` names it.
    pub id: u32,
}

/// Parameters of `scene.rename`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RenameParams {
    /// The object.
    pub id: u32,
    /// Its new name; several objects may have the same.
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: String,
}

/// Parameters of `scene.transform`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TransformParams {
    /// The object.
    pub id: u32,
    /// New transform; by default no shift, no turn, and the object's unscaled size.
    pub transform: Placement,
    /// The transform follows the one that the object has, instead of taking its place.
    #[serde(default)]
    pub relative: bool,
}

/// Parameters of `scene.show`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ShowParams {
    /// The object.
    pub id: u32,
    /// True to show it: drawn, and reached by strokes.
    pub visible: bool,
}

/// Parameters of `scene.lock`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LockParams {
    /// The object.
    pub id: u32,
    /// True to lock it: protected from strokes, transforms and removal.
    pub locked: bool,
}

/// Parameters of `scene.move`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MoveParams {
    /// The object.
    pub id: u32,
    /// Its new place in the list, 0 the first; beyond the last it is the last.
    pub to: u32,
}

/// Parameters of `scene.group`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GroupParams {
    /// The objects, one or more.
    #[cfg_attr(test, schemars(length(min = 1, max = 4096)))]
    pub ids: Vec<u32>,
    /// The name of their group; without it they are in none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(length(min = 1, max = 128)))]
    pub name: Option<String>,
}

/// An axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum WorldAxis {
    /// To the right.
    X,
    /// Up.
    Y,
    /// Towards the eye at first.
    Z,
}

/// Parameters of `scene.mirror`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MirrorParams {
    /// The object.
    pub id: u32,
    /// Mirror axis: the mirror plane goes through the origin of the world, perpendicular to it.
    pub axis: WorldAxis,
}

/// Parameters of `scene.reshape`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ReshapeParams {
    /// An object that was added as a primitive and has not been changed since.
    pub id: u32,
    /// Its new numbers.
    pub primitive: PrimitiveShape,
    /// As [`AddParams::edge`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 1e-9, max = COORDINATE.max)))]
    pub edge: Option<f64>,
}

/// Parameters of `scene.boolean`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SceneBooleanParams {
    /// Operation that combines the two.
    pub operation: Operation,
    /// The first operand.
    pub a: u32,
    /// The second operand.
    pub b: u32,
    /// The operands stay, hidden; else the result takes their place.
    #[serde(default)]
    pub keep: bool,
    /// So they do, and the result follows them: where one of them is moved or changed, it is
    /// computed again, until it is changed itself or `scene.apply` is asked.
    #[serde(default)]
    pub live: bool,
    /// Makes objects of all four results, the named one first; empty ones are left out.
    #[serde(default)]
    pub all: bool,
    /// Faces in which the two only touch belong to an intersection too, both sides of them.
    #[serde(default)]
    pub keep_contact: bool,
    /// Length in the world within which places are one; without it what the vertices resolve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = COORDINATE.max)))]
    pub tolerance: Option<f64>,
}

/// Parameters of `scene.merge`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MergeParams {
    /// Two objects or more; the first gives its name and its place.
    #[cfg_attr(test, schemars(length(min = 2, max = 4096)))]
    pub ids: Vec<u32>,
}

/// Reply of a method that makes an object or changes one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ObjectReply {
    /// The object that was made, or that it was about.
    pub id: u32,
    /// Data that was left out or guessed, one sentence each.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// Reply of `scene.boolean`, `scene.merge` and `scene.split`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CombineReply {
    /// The new object; of several the first.
    pub id: u32,
    /// Number of new objects.
    pub objects: u64,
    /// Vertices of them all.
    pub vertices: u64,
    /// Duration, in seconds.
    pub seconds: f64,
    /// Layers of the operands: the new objects have their surfaces, baked.
    #[serde(default)]
    pub layers_baked: u64,
    /// Face sets that were dropped with the old surface; what was hidden is shown again. 0 where
    /// they were carried over.
    #[serde(default)]
    pub sets_dropped: u64,
}

/// Reply of `scene.list`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SceneReply {
    /// The object that strokes and Booleans act on.
    pub active: u32,
    /// All objects, in their order.
    pub objects: Vec<ObjectInfo>,
}

/// An object of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ObjectInfo {
    /// Its name for programs: no other object ever has it.
    pub id: u32,
    /// Its name for people.
    pub name: String,
    /// True if strokes and Booleans act on it.
    pub active: bool,
    /// True if it is drawn, and reached by strokes.
    pub visible: bool,
    /// True if it is protected from strokes, transforms and removal.
    pub locked: bool,
    /// Its transform.
    pub transform: Placement,
    /// The numbers that it was made of, as long as they can be changed.
    pub primitive: Option<PrimitiveShape>,
    /// Vertices of its mesh.
    pub vertices: u64,
    /// Triangles of its mesh.
    pub triangles: u64,
    /// The lower and the upper corner of its box in the world.
    pub bounds: [[f32; 3]; 2],
    /// The name of its group; `null`: it is in none.
    #[serde(default)]
    pub group: Option<String>,
    /// The Boolean whose result it is, as long as it follows its operands.
    #[serde(default)]
    pub follows: Option<FollowedBoolean>,
}

/// A Boolean whose result follows its operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FollowedBoolean {
    /// Operation that combines the two.
    pub operation: Operation,
    /// The first operand.
    pub a: u32,
    /// The second operand.
    pub b: u32,
}

/// Parameters of `export`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ExportParams {
    /// An absolute path without `..`, not a symbolic link.
    #[cfg_attr(test, schemars(extend("minLength" = 1, "maxLength" = 4096)))]
    pub path: PathBuf,
    /// Objects to write; by default the visible ones. glTF keeps them as nodes with their names and
    /// transforms; the other formats hold one mesh, in which the transforms are applied.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub objects: Option<ExportObjects>,
}

/// Objects to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ExportObjects {
    /// The active one.
    Active,
    /// Those that are drawn.
    Visible,
    /// Every one.
    All,
    /// This one.
    Object(u32),
}
