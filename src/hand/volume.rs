//! The tracked volume laid over the work.

use glam::{Quat, Vec3};

/// The middle of a Leap's interaction box, mm over the device (protocol v6 `interactionBox.center`).
const BOX_MIDDLE_MM: Vec3 = Vec3::new(0.0, 200.0, 0.0);
/// Half the side of the tracked cube that is mapped, mm: the box is 235 x 235 x 148 mm.
const BOX_HALF_MM: f32 = 117.6;
/// The work's bounding sphere takes this share of the cube, so that a hand can come from outside.
const WORK_SHARE: f32 = 0.6;
/// The tool fades out over the last 30 mm before the edge of what a Leap tracks well (about 250 mm from the middle).
const EDGE_MM: [f32; 2] = [220.0, 250.0];

/// Where the work is, in world units; see [`crate::world::World`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    pub middle: Vec3,
    pub extent: f32,
    /// The camera's, radians: "toward the user" stays toward the user when the work is turned.
    pub yaw: f32,
}

impl Volume {
    /// World units a millimetre.
    pub fn scale(&self) -> f32 {
        self.extent / (BOX_HALF_MM * WORK_SHARE)
    }

    pub fn to_world(&self, mm: Vec3) -> Vec3 {
        self.middle + Quat::from_rotation_y(self.yaw) * (mm - BOX_MIDDLE_MM) * self.scale()
    }

    /// 1 well inside the tracked volume, 0 at its edge.
    pub fn edge_fade(&self, mm: Vec3) -> f32 {
        let off = (mm - BOX_MIDDLE_MM).abs().max_element();
        ((EDGE_MM[1] - off) / (EDGE_MM[1] - EDGE_MM[0])).clamp(0.0, 1.0)
    }
}
