//! `scene.snap`: an object is placed flush on a face of another.

use serde::{Deserialize, Serialize};

#[cfg(feature = "schema")]
use crate::range::{COORDINATE, YAW};
use crate::scene::Placement;

/// How two faces lie on each other besides that they share a plane.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SnapAlignment {
    /// The shortest way: the object is turned about the middle of its face and pushed along the
    /// normal.
    #[default]
    Nearest,
    /// The middles of the two faces lie on each other.
    Centre,
    /// The straight sides that are nearest to the two points lie on each other, middle on middle.
    Edge,
}

/// Parameters of `scene.snap`. A face is named by a point in the world: it is the flat face of the
/// object's surface that is nearest to it. On a curved surface that is one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SnapParams {
    /// The object that is moved; its scale stays.
    pub id: u32,
    /// A point at the face of it that is laid on the other; [`crate::range::COORDINATE`].
    #[cfg_attr(
        feature = "schema",
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub at: [f64; 3],
    /// The object that it is placed on, which stays where it is.
    pub to: u32,
    /// A point at the face of that object; [`crate::range::COORDINATE`].
    #[cfg_attr(
        feature = "schema",
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub to_at: [f64; 3],
    /// How the faces lie on each other.
    #[serde(default)]
    pub align: SnapAlignment,
    /// A further turn about the normal of the other object's face, radians.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(range(min = YAW.min, max = YAW.max)))]
    pub spin: f64,
}

/// Reply of `scene.snap`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SnapReply {
    /// The object that was moved.
    pub id: u32,
    /// Where it stands now.
    pub transform: Placement,
    /// How far corners of the two faces lie from their common plane at most: what the rounding of
    /// the vertices left.
    pub off: f64,
    /// The areas of the moved object's face and of the other's.
    pub areas: [f64; 2],
}
