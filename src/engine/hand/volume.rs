//! The tracked volume laid over the work: a similarity from the tracker's millimetres to the world.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::reach_box::{BOX_HALF_MM, ReachBox};
use sculptd_geometry::portable::turn_about;

/// The work's bounding sphere takes this share of the cube, so that a hand can come from outside.
const WORK_SHARE: f32 = 0.6;
/// The tool fades out over the last 30 mm before the edge of the space that a Leap tracks well,
/// about 250 mm from the middle of its interaction box. For another reach both distances grow or
/// shrink with the mapped cube.
const EDGE_MM: [f32; 2] = [220.0, 250.0];

/// `world = origin + turn * (mm * scale)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Volume {
    /// Position of the tracker's origin in the world.
    pub origin: Vec3,
    /// From the tracker's axes to the world's; unit length.
    pub turn: Quat,
    /// World units a millimetre, > 0.
    pub scale: f32,
}

impl Volume {
    /// Over a work with this middle and bounding radius, seen from `yaw`: "toward the user" is
    /// toward the camera. `reach` is the part of the tracked space that is used.
    pub fn over(middle: Vec3, extent: f32, yaw: f32, reach: &ReachBox) -> Self {
        let scale = extent / (reach.half_mm * WORK_SHARE);
        let turn = turn_about(Vec3::Y, yaw);
        Volume { origin: middle - turn * (reach.middle_mm * scale), turn, scale }
    }

    /// Maps a point of the tracker (mm) to the world.
    pub fn to_world(&self, mm: Vec3) -> Vec3 {
        self.origin + self.turn * (mm * self.scale)
    }

    /// Turns a direction of the tracker into one of the world.
    pub fn direction(&self, d: Vec3) -> Vec3 {
        self.turn * d
    }

    /// Returns 1 well inside the part of the tracked space that is used, 0 at its edge.
    pub fn edge_fade(mm: Vec3, reach: &ReachBox) -> f32 {
        let off = (mm - reach.middle_mm).abs().max_element() - (reach.half_mm - BOX_HALF_MM);
        ((EDGE_MM[1] - off) / (EDGE_MM[1] - EDGE_MM[0])).clamp(0.0, 1.0)
    }

    /// Returns the volume that keeps the two held world points under two fingers at `a` and `b`
    /// (mm): moved, scaled, and turned by the smallest rotation. Returns `None` if the fingers are
    /// less than 20 mm apart.
    pub fn holding(&self, held: [Vec3; 2], fingers: [Vec3; 2]) -> Option<Volume> {
        let (mm, world) = (fingers[1] - fingers[0], held[1] - held[0]);
        // Fingers nearer than 20 mm would turn the work by their own noise.
        if mm.length() < 20.0 || world.length() <= 0.0 {
            return None;
        }
        let scale = world.length() / mm.length();
        let seen = (self.turn * mm).normalize();
        let turn = (Quat::from_rotation_arc(seen, world.normalize()) * self.turn).normalize();
        let middle = (fingers[0] + fingers[1]) * 0.5;
        let origin = (held[0] + held[1]) * 0.5 - turn * (middle * scale);
        (scale.is_finite() && scale > 0.0 && origin.is_finite()).then_some(Volume {
            origin,
            turn,
            scale,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tool_fades_at_the_edge_of_its_own_reach() {
        let leap = ReachBox::default();
        let at = |reach: &ReachBox, off: f32| {
            Volume::edge_fade(reach.middle_mm + Vec3::new(0.0, off, 0.0), reach)
        };
        assert_eq!([0.0, 220.0, 250.0].map(|off| at(&leap, off)), [1.0, 1.0, 0.0]);
        // A standing person's reach, and one that is larger than a Leap's box.
        let high = ReachBox { middle_mm: Vec3::new(0.0, 460.0, 0.0), ..leap };
        let wide = ReachBox { half_mm: 300.0, ..high };
        assert_eq!([0.0, 100.0, 200.0].map(|off| at(&high, off)), [1.0; 3]);
        assert_eq!([0.0, 300.0, 400.0].map(|off| at(&wide, off)), [1.0; 3]);
        assert_eq!(at(&wide, 433.0), 0.0);
        assert_eq!(Volume::edge_fade(leap.middle_mm, &high), 0.0, "too low for this reach");
    }

    #[test]
    fn what_two_fingers_hold_stays_under_them_to_half_a_millimetre() {
        let mut volume = Volume::over(Vec3::new(3.0, 1.0, -2.0), 5.0, 0.7, &ReachBox::default());
        let start = [Vec3::new(-60.0, 210.0, 5.0), Vec3::new(55.0, 190.0, -10.0)];
        let held = start.map(|p| volume.to_world(p));
        for i in 0..600 {
            let t = i as f32 * 0.01;
            let (reach, turn) = (50.0 + 30.0 * (t * 1.3).sin(), t * 0.9);
            let middle = Vec3::new(10.0 * t.sin(), 200.0 + 20.0 * t.cos(), 8.0 * t);
            let half = Vec3::new(reach * turn.cos(), 12.0 * (t * 2.0).sin(), reach * turn.sin());
            let fingers = [middle - half, middle + half];
            volume = volume.holding(held, fingers).expect("apart");
            for (f, w) in fingers.iter().zip(held) {
                let off_mm = (volume.to_world(*f) - w).length() / volume.scale;
                assert!(off_mm < 0.5, "{off_mm} mm at step {i}");
            }
        }
    }
}
