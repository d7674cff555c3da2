//! The camera's lens, and the axes of camera and tracker.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Distance from the camera to the middle of the tracked space, mm: a forearm before a laptop.
pub const MIDDLE_MM: f32 = 450.0;
/// Height of the camera's axis in the tracker's axes, mm: the middle of the picture is the middle
/// of the space over a tracker.
pub const AXIS_HEIGHT_MM: f32 = 200.0;

/// A pinhole camera that looks at the user.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// Field of view along the longer side of the picture, degrees.
    pub fov_degrees: f32,
    /// The camera looks the same way as the user, instead of at the user.
    pub from_behind: bool,
}

impl Default for Lens {
    /// A common webcam: 60 degrees across, at 4:3 as at 16:9.
    fn default() -> Self {
        Lens { fov_degrees: 60.0, from_behind: false }
    }
}

impl Lens {
    /// Returns the focal length in pixels for pictures of this size.
    pub fn focal_px(&self, size: Vec2) -> f32 {
        let half = (self.fov_degrees.clamp(10.0, 170.0) * 0.5).to_radians();
        size.max_element() * 0.5 / half.tan()
    }

    /// From the camera's axes (x right in the picture, y down, z away from it, mm) to the
    /// tracker's (x to the user's right, y up, z toward the user).
    pub fn to_tracker(&self, p: Vec3) -> Vec3 {
        let turn = if self.from_behind { -1.0 } else { 1.0 };
        Vec3::new(-turn * p.x, AXIS_HEIGHT_MM - p.y, turn * (p.z - MIDDLE_MM))
    }

    /// The inverse of [`Lens::to_tracker`].
    pub fn to_camera(&self, p: Vec3) -> Vec3 {
        let turn = if self.from_behind { -1.0 } else { 1.0 };
        Vec3::new(-turn * p.x, AXIS_HEIGHT_MM - p.y, turn * p.z + MIDDLE_MM)
    }

    /// Turns a direction like [`Lens::to_tracker`].
    pub fn direction_to_tracker(&self, p: Vec3) -> Vec3 {
        let turn = if self.from_behind { -1.0 } else { 1.0 };
        Vec3::new(-turn * p.x, -p.y, turn * p.z)
    }

    /// Returns the pixel at which a place in the camera's axes is seen.
    pub fn project(&self, p: Vec3, size: Vec2) -> Vec2 {
        size * 0.5 + Vec2::new(p.x, p.y) * (self.focal_px(size) / p.z.max(1.0))
    }
}
