//! Which part of the tracked space is mapped to the space around the object.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// The middle of a Leap's interaction box, mm over the device (protocol v6
/// `interactionBox.center`).
pub const BOX_MIDDLE_MM: Vec3 = Vec3::new(0.0, 200.0, 0.0);
/// Half the side of the tracked cube that is mapped, mm: the box is 235 x 235 x 148 mm.
pub const BOX_HALF_MM: f32 = 117.6;

/// The part of the tracked space that a person uses, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReachBox {
    /// The middle of the cube that is mapped, in the tracker's coordinates.
    pub middle_mm: Vec3,
    /// Half the side of the cube that is mapped.
    pub half_mm: f32,
}

impl Default for ReachBox {
    /// A Leap's interaction box.
    fn default() -> Self {
        ReachBox { middle_mm: BOX_MIDDLE_MM, half_mm: BOX_HALF_MM }
    }
}

impl ReachBox {
    /// Returns true if the middle lies within 2 m of the tracker on each axis, and the half side is
    /// 30 to 1000 mm.
    pub fn is_sane(&self) -> bool {
        self.middle_mm.is_finite()
            && self.middle_mm.abs().max_element() < 2000.0
            && (30.0..=1000.0).contains(&self.half_mm)
    }

    /// The same reach lower down, where elbows rest: the plane of work a hand's breadth over the
    /// table.
    pub fn lowered(self) -> Self {
        ReachBox {
            middle_mm: Vec3::new(self.middle_mm.x, self.half_mm.max(120.0), self.middle_mm.z),
            ..self
        }
    }
}
