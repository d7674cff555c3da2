//! `repair`: a flat base, a split with pegs and sockets, drain holes, vents, draft, thicker walls,
//! text.

use serde::{Deserialize, Serialize};

#[cfg(test)]
use crate::range::{COORDINATE, LENGTH};

/// Parameters of `repair`. Lengths and places are in the unit and the frame of the world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RepairParams {
    /// The repair of the active object.
    pub repair: RepairKind,
    /// The build direction, away from the plate.
    #[serde(default = "upright")]
    #[cfg_attr(test, schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max))))]
    pub up: [f64; 3],
    /// True if the object is built on a plate, which seals what leads down to it.
    #[serde(default = "on_plate")]
    pub plate: bool,
}

fn upright() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn on_plate() -> bool {
    true
}

/// A repair of an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RepairKind {
    /// Cuts a flat base at this height above the lowest point.
    Base(#[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))] f64),
    /// Splits the object by a plane: two new objects with pegs and sockets.
    Split(SplitRepair),
    /// Drills holes out of enclosed cavities.
    Drain(HoleRepair),
    /// Drills holes into suction cups.
    Vent(HoleRepair),
    /// Gives upright walls this draft, in degrees; `up` is the direction in which a mould opens.
    Draft(#[cfg_attr(test, schemars(range(min = 1e-3, max = 45.0)))] f64),
    /// Thickens walls below this.
    Thicken(#[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))] f64),
    /// Raises or engraves a text.
    Text(TextRepair),
}

/// The plane and the pegs of a split.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SplitRepair {
    /// A point of the plane.
    #[cfg_attr(test, schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max))))]
    pub point: [f64; 3],
    /// The direction of the part that gets the sockets; the other gets the pegs.
    #[cfg_attr(test, schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max))))]
    pub normal: [f64; 3],
    /// Pegs at most; 0 splits without pegs.
    #[serde(default = "four")]
    #[cfg_attr(test, schemars(range(min = 0, max = 16)))]
    pub pegs: u32,
    /// The radius of a peg.
    #[serde(default = "two")]
    #[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))]
    pub radius: f64,
    /// The length of a peg beyond the plane.
    #[serde(default = "five")]
    #[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))]
    pub length: f64,
    /// The least distance between a peg and its socket.
    #[serde(default = "fifth")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = LENGTH.max)))]
    pub clearance: f64,
}

fn four() -> u32 {
    4
}

fn two() -> f64 {
    2.0
}

fn five() -> f64 {
    5.0
}

fn fifth() -> f64 {
    0.2
}

/// The holes of `drain` and `vent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct HoleRepair {
    /// The diameter of a hole.
    #[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))]
    pub diameter: f64,
    /// A second hole at the highest point, through which air comes in.
    #[serde(default)]
    pub inlet: bool,
    /// Only cavities and cups that hold more than this, in cubic units. Without it 0 for cavities
    /// and 100 for cups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0, max = 1e18)))]
    pub least: Option<f64>,
    /// Only the cavity or cup whose centre is nearest to this place; without it all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 3]>,
}

/// The text of `text`, of 1 to 200 letters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TextRepair {
    /// The text; a line break begins a line.
    pub text: String,
    /// Its middle; the nearest place of the surface is taken.
    #[cfg_attr(test, schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max))))]
    pub at: [f64; 3],
    /// The surface is looked for from `at` in this direction, and not nearest to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 3]>,
    /// The direction in which the letters stand; without it `up`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upright: Option<[f64; 3]>,
    /// The height of a capital letter.
    #[cfg_attr(test, schemars(range(min = LENGTH.min, max = LENGTH.max)))]
    pub height: f64,
    /// Height above the surface; below 0 it is engraved to this depth.
    #[cfg_attr(test, schemars(range(min = -LENGTH.max, max = LENGTH.max)))]
    pub relief: f64,
}

/// Reply of `repair`: the changes, and the result of a check of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RepairReply {
    /// True if the check no longer finds what was repaired, and every result is one solid.
    pub repaired: bool,
    /// The results, each as it was checked.
    pub objects: Vec<RepairedObject>,
    /// The holes that were drilled.
    pub holes: Vec<DrilledHole>,
    /// The centre of each peg, in the plane of the split.
    pub pegs: Vec<[f64; 3]>,
    /// Findings that the repair left, and remarks on how it was carried out, one sentence each.
    pub notes: Vec<String>,
    /// Duration, in seconds.
    pub seconds: f64,
}

/// A repaired object, and the result of its check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RepairedObject {
    /// The object.
    pub id: u32,
    /// True if every edge has two faces.
    pub closed: bool,
    /// True if the faces around each vertex and edge are one fan.
    pub manifold: bool,
    /// Pairs of triangles that cross each other.
    pub self_intersections: u64,
    /// The enclosed volume, in cubic units.
    pub volume: f64,
    /// The flat area on the plate, in square units.
    pub base_area: f64,
    /// Enclosed cavities, the largest first.
    pub trapped: Vec<SealedPlace>,
    /// Suction cups, the largest first.
    pub cups: Vec<SealedPlace>,
}

/// An enclosed cavity, or a suction cup.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SealedPlace {
    /// The centre of its volume.
    pub at: [f64; 3],
    /// Its volume, in cubic units.
    pub volume: f64,
}

/// A hole that was drilled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DrilledHole {
    /// The point at which it leaves the cavity.
    pub from: [f64; 3],
    /// The point at which it leaves the object.
    pub to: [f64; 3],
    /// True for an air inlet.
    pub inlet: bool,
    /// True if it leads down to the plate, which seals it.
    pub sealed_by_plate: bool,
}
