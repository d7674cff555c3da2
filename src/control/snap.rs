//! `scene.snap`: an object is placed flush on a face of another.

use serde::{Deserialize, Serialize};

#[cfg(test)]
use crate::range::{COORDINATE, YAW};
use crate::scene::Placement;

/// Alignment of two faces within their shared plane.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SnapAlignment {
    /// The shortest way: the object is turned about the middle of its face and pushed along the
    /// normal.
    #[default]
    Nearest,
    /// The middles of the two faces coincide.
    Centre,
    /// The straight sides nearest to the two points coincide, middle on middle.
    Edge,
}

/// Parameters of `scene.snap`. A face is named by a point in the world: it is the flat face of the
/// object's surface that is nearest to it. On a curved surface that is one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SnapParams {
    /// The object that is moved; its scale stays.
    pub id: u32,
    /// A point at the face of it that is laid on the other; [`crate::range::COORDINATE`].
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub at: [f64; 3],
    /// The object that it is placed on, which stays where it is.
    pub to: u32,
    /// A point at the face of that object; [`crate::range::COORDINATE`].
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub to_at: [f64; 3],
    /// Alignment of the faces.
    #[serde(default)]
    pub align: SnapAlignment,
    /// A further turn about the normal of the other object's face, radians.
    #[serde(default)]
    #[cfg_attr(test, schemars(range(min = YAW.min, max = YAW.max)))]
    pub spin: f64,
}

/// Reply of `scene.snap`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SnapReply {
    /// The object that was moved.
    pub id: u32,
    /// Its new transform.
    pub transform: Placement,
    /// Greatest distance of the two faces' corners from their common plane: the rounding error of
    /// the vertices.
    pub off: f64,
    /// The areas of the moved object's face and of the other's.
    pub areas: [f64; 2],
}
