//! What a dab covers and how it fades to its rim, as plain data: [`Footprint`]. Because it is data
//! and not code of a brush, one loop weighs the vertices of a page for every brush, compiled for
//! the processor, and a brush is asked only about vertices that it changes.

use glam::Vec3;

use super::dab::{Dab, soft};
use super::falloff::{CURVE, Falloff};

/// The form of a footprint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FootprintShape {
    /// A ball about the centre; `round`, a squared length, is added to the squared distance from
    /// the centre and so takes the point off the profile.
    Ball {
        /// See [`FootprintShape::Ball`].
        round: f32,
    },
    /// All within the radius of the segment from the centre to `centre + back`.
    Capsule {
        /// From the centre to the other end, mesh units.
        back: Vec3,
    },
    /// A square in the plane of `along` and `across`, both unit, faded along each of the two, and
    /// cut off a radius over and under that plane. One of the two that is longer than one makes it
    /// so many times shorter that way.
    Square {
        /// See [`FootprintShape::Square`].
        along: Vec3,
        /// See [`FootprintShape::Square`].
        across: Vec3,
        /// Unit normal of the plane.
        normal: Vec3,
        /// 0 a square to 1 a disc.
        round: f32,
    },
}

/// The area of a dab, and its fade to the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Its form.
    pub shape: FootprintShape,
    /// The middle, mesh units.
    pub centre: Vec3,
    /// Mesh units, above 0.
    pub radius: f32,
    /// See [`super::BrushSettings::hardness`].
    pub hardness: f32,
    /// The profile beyond the hardness.
    pub falloff: Falloff,
    /// Of a custom falloff.
    pub curve: [f32; CURVE],
}

impl Footprint {
    /// Of this form, as the dab's settings have it.
    pub fn of(dab: &Dab<'_>, shape: FootprintShape) -> Footprint {
        let s = dab.settings;
        Footprint {
            shape,
            centre: dab.centre,
            radius: dab.radius,
            hardness: s.hardness,
            falloff: s.falloff,
            curve: s.curve,
        }
    }

    /// A ball about the dab's centre.
    pub fn ball(dab: &Dab<'_>) -> Footprint {
        Footprint::of(dab, FootprintShape::Ball { round: 0.0 })
    }

    /// The squared distance from the centre beyond which nothing is covered.
    pub fn bound(&self) -> f32 {
        let r2 = self.radius * self.radius;
        // A little more than the radius: the profile decides at the rim.
        let wide = match self.shape {
            FootprintShape::Ball { .. } => 1.0,
            FootprintShape::Capsule { back } => {
                let far = 1.0 + back.length() / self.radius;
                far * far
            }
            // From the middle to a corner of the cube.
            FootprintShape::Square { .. } => 3.0,
        };
        r2 * (wide * 1.0001)
    }

    /// The share of the brush at a place, 0 to 1.
    pub fn at(&self, p: Vec3) -> f32 {
        let faded = |x: f32| {
            let x = if self.hardness > 0.0 { soft(x, self.hardness) } else { x };
            self.falloff.at(x, &self.curve)
        };
        let d = p - self.centre;
        match self.shape {
            FootprintShape::Ball { round } => {
                faded((d.length_squared() + round).sqrt() / self.radius)
            }
            FootprintShape::Capsule { back } => {
                let d = CapsuleAxis::new(back).away(d);
                faded(d.length_squared().sqrt() / self.radius)
            }
            FootprintShape::Square { along, across, normal, round } => {
                let d = d / self.radius;
                let (x, y, z) = (d.dot(along), d.dot(across), d.dot(normal));
                let mut share = faded(x.abs()) * faded(y.abs());
                if round != 0.0 {
                    let disc = faded((x * x + y * y).sqrt());
                    share += (disc - share) * round;
                }
                if z * z < 1.0 { share } else { 0.0 }
            }
        }
    }
}

/// The axis of a capsule, made ready.
#[derive(Clone, Copy)]
pub(super) struct CapsuleAxis {
    back: Vec3,
    /// One over its squared length; 0 for a capsule that is a ball.
    inverse: f32,
}

impl CapsuleAxis {
    pub(super) fn new(back: Vec3) -> CapsuleAxis {
        let length2 = back.length_squared();
        CapsuleAxis { back, inverse: if length2 > 0.0 { 1.0 / length2 } else { 0.0 } }
    }

    /// From the nearest point of the axis to `d`, both measured from the centre.
    #[inline(always)]
    pub(super) fn away(self, d: Vec3) -> Vec3 {
        d - self.back * (d.dot(self.back) * self.inverse).max(0.0).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footprint(shape: FootprintShape) -> Footprint {
        let curve = std::array::from_fn(|i| 1.0 - i as f32 / 8.0);
        let (centre, radius) = (Vec3::new(0.3, -0.2, 0.1), 0.5);
        Footprint { shape, centre, radius, hardness: 0.0, falloff: Falloff::Linear, curve }
    }

    #[test]
    fn a_footprint_is_its_formula_and_ends_within_its_bound() {
        let ball = footprint(FootprintShape::Ball { round: 0.0 });
        let at = |f: &Footprint, x: f32, y: f32, z: f32| f.at(f.centre + Vec3::new(x, y, z));
        assert!((at(&ball, 0.0, 0.2, 0.0) - 0.6).abs() < 1e-6);
        let back = Vec3::new(-0.4, 0.0, 0.0);
        let capsule = footprint(FootprintShape::Capsule { back });
        for x in [0.0, -0.1, -0.4] {
            assert!((at(&capsule, x, 0.0, 0.2) - 0.6).abs() < 1e-6, "{x}");
        }
        assert!((at(&capsule, -0.6, 0.0, 0.0) - 0.6).abs() < 1e-6);
        let (along, across, normal) = (Vec3::X, Vec3::Y, Vec3::Z);
        let square = footprint(FootprintShape::Square { along, across, normal, round: 0.0 });
        assert!((at(&square, 0.1, -0.2, 0.3) - 0.8 * 0.6).abs() < 1e-6);
        assert_eq!(at(&square, 0.0, 0.0, 0.5), 0.0);
        for f in [ball, capsule, square] {
            let far = f.bound().sqrt();
            for i in 0..100 {
                let turn =
                    glam::Quat::from_euler(glam::EulerRot::XYZ, i as f32, i as f32 * 1.7, 0.3);
                assert_eq!(f.at(f.centre + turn * Vec3::X * (far * 1.001)), 0.0, "{:?}", f.shape);
            }
        }
    }
}
