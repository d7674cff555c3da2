//! Flush placing: computes the transform that brings a flat face of an object into the plane of a
//! flat face of another, the two facing each other.
//!
//! Everything is in double precision. The transform is composed of one rotation, corrected until
//! only rounding error is left, and a shift along the normal. The vertices of both faces were
//! rounded to single precision in their frames. That error remains between the solids; a Boolean
//! treats it as contact.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::ObjectTransform;
use sculptd_geometry::flat_region::FlatRegion;

/// A flat face, in an object's frame or in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatFace {
    /// The centre of its area.
    pub middle: DVec3,
    /// Outwards, unit length.
    pub normal: DVec3,
    /// A straight side of its outline, with the face to the left seen from outside.
    pub side: Option<[DVec3; 2]>,
}

impl FlatFace {
    /// The plane of a region, with the side of its outline that is nearest to `near`.
    pub fn of(region: &FlatRegion, near: DVec3) -> FlatFace {
        let (middle, normal) = (region.middle, region.normal);
        FlatFace { middle, normal, side: region.side_near(near) }
    }

    /// The face of an object that stands here.
    pub fn placed(&self, at: &ObjectTransform) -> FlatFace {
        FlatFace {
            middle: at.apply(self.middle),
            normal: (at.turn * self.normal).normalize(),
            side: self.side.map(|s| s.map(|p| at.apply(p))),
        }
    }
}

/// Alignment of two faces within their shared plane.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaceAlignment {
    /// The moved face is turned about its middle and pushed along the normal: the shortest way.
    #[default]
    Nearest,
    /// The middles of the faces coincide.
    Centre,
    /// The picked sides coincide, middle on middle.
    Edge,
}

/// The smallest rotation from one unit vector to another; of opposite ones a half turn about any
/// axis across.
fn arc(from: DVec3, to: DVec3) -> DQuat {
    let half = from + to;
    match half.try_normalize().filter(|_| half.length_squared() > 1e-12) {
        // The half-angle form is exact also for nearly opposite vectors.
        Some(half) => {
            let axis = from.cross(half);
            DQuat::from_xyzw(axis.x, axis.y, axis.z, from.dot(half)).normalize()
        }
        None => DQuat::from_axis_angle(from.any_orthonormal_vector(), std::f64::consts::PI),
    }
}

/// The turn about a unit vector by the angle of this cosine and sine, by half-angle formulas of
/// which each is used where it loses no digits.
fn about(axis: DVec3, cosine: f64, sine: f64) -> DQuat {
    let (w, s) = if cosine > 0.0 {
        let w = ((1.0 + cosine) * 0.5).sqrt();
        (w, sine / (2.0 * w))
    } else {
        let s = ((1.0 - cosine) * 0.5).sqrt().copysign(sine);
        (sine / (2.0 * s), s)
    };
    let v = axis * s;
    DQuat::from_xyzw(v.x, v.y, v.z, w).normalize()
}

/// Computes the transform that places `face` (in the object's frame) flush on `target` (in the
/// world). `now`: the current transform. `spin`: a further turn about the target's normal, in
/// radians. Returns `None` if an edge is requested and a face has none, or if the place is out of
/// range.
pub fn flush(
    face: &FlatFace,
    now: &ObjectTransform,
    target: &FlatFace,
    alignment: FaceAlignment,
    spin: f64,
) -> Option<ObjectTransform> {
    let against = -target.normal;
    let shown = face.placed(now);
    let mut turn = (arc(shown.normal, against) * now.turn).normalize();
    let along = |side: [DVec3; 2]| (side[1] - side[0]).try_normalize();
    if alignment == FaceAlignment::Edge {
        // Seen from one side, the outlines of faces that face each other run in opposite ways.
        let (own, to) = (along(face.side?)?, -along(target.side?)?);
        let own = turn * own;
        turn = about(target.normal, own.dot(to), own.cross(to).dot(target.normal)) * turn;
    }
    turn = (DQuat::from_axis_angle(target.normal, spin) * turn).normalize();
    // Products of rotations leave a few rounding errors; what they left is turned away.
    for _ in 0..2 {
        turn = (arc((turn * face.normal).normalize(), against) * turn).normalize();
    }
    let scale = now.scale;
    let placed = |p: DVec3| turn * (p * scale);
    let shift = match alignment {
        FaceAlignment::Nearest => {
            let height = (shown.middle - target.middle).dot(target.normal);
            shown.middle - target.normal * height - placed(face.middle)
        }
        FaceAlignment::Centre => target.middle - placed(face.middle),
        FaceAlignment::Edge => {
            let middle = |s: [DVec3; 2]| (s[0] + s[1]) * 0.5;
            middle(target.side?) - placed(middle(face.side?))
        }
    };
    let transform = ObjectTransform { shift, turn, scale };
    // The plane holds for the middle to the last place, whatever the alignment was.
    let height = (transform.apply(face.middle) - target.middle).dot(target.normal);
    let transform = ObjectTransform { shift: shift - target.normal * height, ..transform };
    transform.is_sane().then_some(transform)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Dice(u64);

    impl Dice {
        fn share(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.share(), self.share(), self.share())
        }

        fn turn(&mut self) -> DQuat {
            let axis = self.vector().normalize_or(DVec3::X);
            DQuat::from_axis_angle(axis, self.share() * 3.0)
        }

        fn face(&mut self) -> FlatFace {
            let turn = self.turn();
            let middle = self.vector() * 10.0;
            let side = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(2.0, -1.0, 0.0)];
            FlatFace {
                middle,
                normal: turn * DVec3::Z,
                side: Some(side.map(|p| middle + turn * p)),
            }
        }
    }

    #[test]
    fn ten_thousand_faces_share_a_plane_to_the_last_places() {
        let mut dice = Dice(3);
        let (mut worst_angle, mut worst_height) = (0f64, 0f64);
        for i in 0..10_000 {
            let (face, target) = (dice.face(), dice.face());
            let now = ObjectTransform {
                shift: dice.vector() * 50.0,
                turn: dice.turn(),
                scale: 10f64.powf(dice.share()),
            };
            let how = [FaceAlignment::Nearest, FaceAlignment::Centre, FaceAlignment::Edge][i % 3];
            let there = flush(&face, &now, &target, how, 0.0).expect("a place");
            let placed = face.placed(&there);
            let reach = 1.0 + there.shift.length() + 30.0 * there.scale;
            worst_angle = worst_angle.max((placed.normal + target.normal).length());
            let height = (placed.middle - target.middle).dot(target.normal).abs();
            worst_height = worst_height.max(height / reach);
            assert_eq!(there.scale, now.scale);
            match how {
                FaceAlignment::Nearest => {}
                FaceAlignment::Centre => {
                    assert!(placed.middle.distance(target.middle) < 1e-13 * reach);
                }
                FaceAlignment::Edge => {
                    let [a, b] = placed.side.expect("a side");
                    let [c, d] = target.side.expect("a side");
                    let apart = ((a + b) - (c + d)).length() * 0.5;
                    assert!(apart < 1e-13 * reach, "{apart}");
                    let (own, to) = ((b - a).normalize(), (d - c).normalize());
                    assert!((own + to).length() < 1e-14, "{own} {to}");
                }
            }
        }
        assert!(worst_angle < 2e-15 && worst_height < 1e-15, "{worst_angle} {worst_height}");
    }

    #[test]
    fn the_shortest_way_turns_no_more_than_it_must() {
        let face = FlatFace { middle: DVec3::Z, normal: DVec3::Z, side: None };
        let target = FlatFace { middle: DVec3::Z * 5.0, normal: -DVec3::Z, side: None };
        let now = ObjectTransform { shift: DVec3::new(3.0, -2.0, 1.0), ..ObjectTransform::NONE };
        let there = flush(&face, &now, &target, FaceAlignment::Nearest, 0.0).expect("a place");
        assert_eq!(there.turn, DQuat::IDENTITY);
        assert_eq!(there.shift, DVec3::new(3.0, -2.0, 4.0));
        // Faces that look the same way: a half turn.
        let other = FlatFace { normal: DVec3::Z, ..target };
        let there = flush(&face, &now, &other, FaceAlignment::Centre, 0.3).expect("a place");
        let placed = face.placed(&there);
        assert!((placed.normal + DVec3::Z).length() < 1e-15);
        assert!(placed.middle.distance(other.middle) < 1e-15);
        assert!(flush(&face, &now, &other, FaceAlignment::Edge, 0.0).is_none());
    }
}
