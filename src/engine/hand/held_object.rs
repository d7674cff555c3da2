//! A thing in the hands: a primitive or a loaded mesh that is carried to its place before it is
//! joined with the work.
//!
//! One pinch carries and turns it, two pinches move, turn and scale it. It touches nothing until it
//! is joined.

use std::sync::Arc;

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::scene::ObjectTransform;
use sculptd_geometry::TriMesh;

/// `world = shift + turn * (own * scale)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Similarity {
    /// Position of the object's origin, in world units.
    pub shift: Vec3,
    /// Rotation of the object, a unit quaternion.
    pub turn: Quat,
    /// > 0.
    pub scale: f32,
}

/// A thing may not become smaller or larger than its size when it was taken up by more than this.
const SCALES: [f32; 2] = [1e-3, 1e3];

impl Similarity {
    /// Leaves everything where it is.
    pub const NONE: Similarity = Similarity { shift: Vec3::ZERO, turn: Quat::IDENTITY, scale: 1.0 };

    /// Maps a point of the object to the world.
    pub fn apply(&self, p: Vec3) -> Vec3 {
        self.shift + self.turn * (p * self.scale)
    }

    /// Returns the same transform in double precision, for an object of the scene.
    pub fn to_object(&self) -> ObjectTransform {
        ObjectTransform {
            shift: self.shift.as_dvec3(),
            turn: self.turn.as_dquat().normalize(),
            scale: f64::from(self.scale),
        }
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Similarity) -> Similarity {
        Similarity {
            shift: next.apply(self.shift),
            turn: (next.turn * self.turn).normalize(),
            scale: self.scale * next.scale,
        }
    }

    /// One hand that was at `from` with one orientation and is at `to` with another.
    pub fn carried(from: Vec3, to: Vec3, turn: Quat) -> Similarity {
        Similarity { shift: to - turn * from, turn, scale: 1.0 }
    }

    /// Computes the similarity that moves the two points `from` to `to` with the smallest rotation.
    /// Returns `None` if the points coincide.
    pub fn between(from: [Vec3; 2], to: [Vec3; 2]) -> Option<Similarity> {
        let (a, b) = (from[1] - from[0], to[1] - to[0]);
        let scale = b.length() / a.length();
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let turn = Quat::from_rotation_arc(a.normalize(), b.normalize());
        let shift = (to[0] + to[1]) * 0.5 - turn * ((from[0] + from[1]) * 0.5 * scale);
        (shift.is_finite() && turn.is_finite()).then_some(Similarity { shift, turn, scale })
    }

    /// Returns true if all values are finite, the rotation has unit length, and the scale is 0.001
    /// to 1000.
    pub fn is_sane(&self) -> bool {
        self.shift.is_finite()
            && self.turn.is_finite()
            && (self.turn.length() - 1.0).abs() < 1e-3
            && (SCALES[0]..=SCALES[1]).contains(&self.scale)
    }
}

/// Object held by the hands, and its place.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HeldObject {
    /// The triangles, in the coordinates of the object.
    pub plain: Arc<TriMesh>,
    /// From the coordinates of the object to the world.
    pub place: Similarity,
}

impl HeldObject {
    /// Returns the object at its current place, as a separate mesh.
    pub fn placed(&self) -> TriMesh {
        let positions = self.plain.positions.iter().map(|p| self.place.apply(*p)).collect();
        TriMesh { positions, ..(*self.plain).clone() }
    }

    /// Moves it on; what would make it vanish or fill the world is not done.
    pub fn carry(&mut self, by: &Similarity) {
        let next = self.place.then(by);
        if next.is_sane() {
            self.place = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_points_stay_under_two_fingers_however_they_move() {
        let mut place = Similarity::NONE;
        let own = [Vec3::new(-40.0, 10.0, 3.0), Vec3::new(35.0, -5.0, 8.0)];
        let mut now = own;
        for i in 0..900 {
            let t = i as f32 * 0.01;
            let middle = Vec3::new(30.0 * t.sin(), 20.0 * (0.7 * t).cos(), 5.0 * t);
            let half = Quat::from_rotation_y(0.8 * t)
                * Vec3::new(40.0 + 25.0 * (1.3 * t).sin(), 9.0 * t.cos(), 0.0);
            let next = [middle - half, middle + half];
            place = place.then(&Similarity::between(now, next).expect("apart"));
            now = next;
            for (o, n) in own.iter().zip(now) {
                let off = place.apply(*o).distance(n);
                assert!(off < 0.01, "{off} mm at step {i}");
            }
        }
    }

    #[test]
    fn one_hand_carries_and_turns_about_itself() {
        let (from, to) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 0.0, -1.0));
        let by = Similarity::carried(from, to, Quat::from_rotation_z(1.0));
        assert!(by.apply(from).distance(to) < 1e-5);
        assert!(
            by.apply(from + Vec3::X).distance(to + Quat::from_rotation_z(1.0) * Vec3::X) < 1e-5
        );
    }
}
