//! Where an object stands: a similarity in double precision, from the object's own frame to the
//! world.
//!
//! The clay stays in its own frame, in single precision, so that a transform changes no vertex: an
//! object that is moved far away and back has the same bits. Double precision keeps a product of
//! many transforms exact to far below what a vertex can say.

use glam::{DQuat, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use sculptd_clay::Ray;

/// `world = shift + turn * (own * scale)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ObjectTransform {
    /// Position of the object's origin, in world units; each coordinate within
    /// [`ObjectTransform::FAR`].
    pub shift: DVec3,
    /// Rotation of the object, a unit quaternion.
    pub turn: DQuat,
    /// World units for a unit of the object, 1e-6 to 1e6.
    pub scale: f64,
}

impl Default for ObjectTransform {
    fn default() -> Self {
        ObjectTransform::NONE
    }
}

impl ObjectTransform {
    /// Leaves everything where it is.
    pub const NONE: ObjectTransform =
        ObjectTransform { shift: DVec3::ZERO, turn: DQuat::IDENTITY, scale: 1.0 };
    /// The largest coordinate of a shift, world units.
    pub const FAR: f64 = 1e9;

    /// Returns true if it leaves everything in place, to the bit.
    pub fn is_none(&self) -> bool {
        *self == ObjectTransform::NONE
    }

    /// Returns true if all values are finite and in their ranges.
    pub fn is_sane(&self) -> bool {
        self.shift.is_finite()
            && self.shift.abs().max_element() <= ObjectTransform::FAR
            && self.turn.is_finite()
            && (self.turn.length() - 1.0).abs() < 1e-6
            && (1e-6..=1e6).contains(&self.scale)
    }

    /// Maps a point of the object to the world.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.shift + self.turn * (p * self.scale)
    }

    /// As [`ObjectTransform::apply`]; without a transform the bits stay.
    pub fn point(&self, p: Vec3) -> Vec3 {
        if self.is_none() { p } else { self.apply(p.as_dvec3()).as_vec3() }
    }

    /// The direction of an object's vector in the world, of the same length.
    pub fn direction(&self, d: Vec3) -> Vec3 {
        if self.is_none() { d } else { (self.turn * d.as_dvec3()).as_vec3() }
    }

    /// A ray of the object's frame in the world; its direction keeps its length.
    pub fn ray(&self, ray: Ray) -> Ray {
        Ray { origin: self.point(ray.origin), dir: self.direction(ray.dir) }
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &ObjectTransform) -> ObjectTransform {
        ObjectTransform {
            shift: next.apply(self.shift),
            turn: (next.turn * self.turn).normalize(),
            scale: self.scale * next.scale,
        }
    }

    /// From the world to the object.
    pub fn inverse(&self) -> ObjectTransform {
        if self.is_none() {
            return *self;
        }
        let (turn, scale) = (self.turn.conjugate(), 1.0 / self.scale);
        ObjectTransform { shift: turn * (self.shift * -scale), turn, scale }
    }

    /// The box in the world around a box of the object.
    pub fn bounds(&self, (lo, hi): (Vec3, Vec3)) -> (Vec3, Vec3) {
        if self.is_none() || !lo.cmple(hi).all() {
            return (lo, hi);
        }
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        (0..8u32).fold(none, |(low, high), corner| {
            let pick = |bit: u32, a: f32, b: f32| if corner >> bit & 1 == 0 { a } else { b };
            let p = Vec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z));
            let p = self.point(p);
            (low.min(p), high.max(p))
        })
    }

    /// The values as bits, for a hash.
    pub(crate) fn bits(&self) -> [u64; 8] {
        let (s, t) = (self.shift, self.turn);
        [s.x, s.y, s.z, t.x, t.y, t.z, t.w, self.scale].map(f64::to_bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_exact_to_what_a_vertex_can_say() {
        let mut seed = 1u64;
        let mut dice = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for _ in 0..1000 {
            let axis = DVec3::new(dice(), dice(), dice()).normalize_or(DVec3::X);
            let there = ObjectTransform {
                shift: DVec3::new(dice(), dice(), dice()) * 1e4,
                turn: DQuat::from_axis_angle(axis, dice() * 3.0),
                scale: 10f64.powf(dice() * 3.0),
            };
            assert!(there.is_sane());
            let p = DVec3::new(dice(), dice(), dice()) * 100.0;
            let back = there.inverse().apply(there.apply(p));
            assert!((back - p).length() < 1e-6 * (1.0 + there.shift.length() / there.scale));
            let both = there.then(&there.inverse());
            assert!((both.apply(p) - p).length() < 1e-6 * (1.0 + 1e4 / there.scale));
        }
        assert!(ObjectTransform::NONE.is_none() && ObjectTransform::NONE.is_sane());
        let p = Vec3::new(0.1, -0.2, 1e-20);
        assert_eq!(ObjectTransform::NONE.point(p).to_array(), p.to_array());
    }

    #[test]
    fn values_that_are_no_transform_are_refused() {
        let one = ObjectTransform::NONE;
        for bad in [
            ObjectTransform { shift: DVec3::NAN, ..one },
            ObjectTransform { shift: DVec3::X * 1e10, ..one },
            ObjectTransform { turn: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..one },
            ObjectTransform { scale: 0.0, ..one },
            ObjectTransform { scale: -1.0, ..one },
            ObjectTransform { scale: f64::INFINITY, ..one },
        ] {
            assert!(!bad.is_sane(), "{bad:?}");
        }
    }
}
