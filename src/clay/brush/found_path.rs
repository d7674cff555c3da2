//! The path from dab to dab over the surface as it was at the start of the stroke.
//!
//! Dabs are a spacing apart, and between them the surface may rise and fall. The path is followed
//! in pieces of one length. Each end of a piece is the surface point under the line of sight, so
//! the result along the stroke does not depend on the positions of its dabs. A dab's centre does
//! not serve as an end: it is where the touched clay was before it was raised, and it swerves with
//! the relief of the stroke itself.

use glam::Vec3;

use super::dab::Dab;
use super::stroke_param::{StrokeParameters, StrokePlace};
use crate::{Clay, Ray, Reach};

/// Length of a piece at most, in radii: that of the closest spacing that is usual.
const PIECE: f32 = 0.03;
/// Pieces of one way at most: the widest spacing is a radius.
const MOST: f32 = 40.0;
/// The search distance for the surface under a place, in radii.
const DEEP: f32 = 0.5;

/// The way to a dab that is measured on the surface as the stroke found it.
#[derive(Debug, Clone, Copy)]
pub struct FoundPath<'a> {
    /// The clay before the dab.
    pub mesh: &'a Clay,
    /// The dab.
    pub dab: &'a Dab<'a>,
}

impl FoundPath<'_> {
    /// Takes the coordinates of the stroke on to the dab; `radius` as in
    /// [`StrokeParameters::step`]. Returns whether vertices have coordinates.
    pub fn follow(&self, stroke: &mut StrokeParameters, radius: f32) -> bool {
        let Dab { touch, .. } = *self.dab;
        let [from, before] = match self.dab.way() == Vec3::ZERO {
            true => [None; 2],
            false => stroke.touched(self.mesh, self.dab.stroke),
        };
        let way = Bow::through(before, from.unwrap_or(touch), touch, self.dab.eye);
        let pieces = (way.chord / (PIECE * self.dab.radius)).ceil().clamp(1.0, MOST);
        let mut known = false;
        for i in 1..=pieces as usize {
            let last = i as f32 == pieces;
            let at = if last { touch } else { way.at(i as f32 / pieces) };
            let place = match self.under(at) {
                None if !last => continue,
                None => self.beside(),
                Some(place) => place,
            };
            known = stroke.step(self.mesh, self.dab.stroke, place, radius);
        }
        stroke.touch([Some(touch), from]);
        known
    }

    /// Returns the point where the line of sight through a place meets the surface at the start of
    /// the stroke.
    fn under(&self, at: Vec3) -> Option<StrokePlace> {
        let Dab { lens, eye, .. } = self.dab;
        let eye = if lens.parallel { *eye } else { (lens.eye - at).try_normalize()? };
        let deep = DEEP * self.dab.radius;
        let ray = Ray { origin: at + eye * deep, dir: -eye };
        let near = Reach::Capsule { from: ray.origin, to: at - eye * deep, radius: 0.01 * deep };
        let hit = self.mesh.pick_before(ray, &near)?;
        let facing = hit.normal.dot(self.dab.normal) > 0.0;
        (facing && hit.t <= 2.0 * deep).then_some(StrokePlace::Found(hit.position, hit.normal))
    }

    /// Returns the point where the line of sight to the dab's touch meets the tangent plane at its
    /// centre. Returns the centre where the plane is too oblique to approximate the surface.
    fn beside(&self) -> StrokePlace {
        let Dab { eye, normal, centre, touch, radius, .. } = *self.dab;
        let slant = eye.dot(normal);
        let place = touch + eye * ((centre - touch).dot(normal) / slant);
        let near = slant > 0.2 && place.distance(centre) < 0.25 * radius;
        StrokePlace::Found(if near { place } else { centre }, normal)
    }
}

/// The way of the pen between two touches as it is seen: the parabola through them and the one
/// before. The straight way would be the shorter the wider the spacing, and would turn at each dab.
struct Bow {
    from: Vec3,
    to: Vec3,
    /// Four times the offset of the parabola from the middle of the chord.
    bow: Vec3,
    /// Length of the chord as it is seen, mesh units.
    chord: f32,
}

impl Bow {
    fn through(before: Option<Vec3>, from: Vec3, to: Vec3, eye: Vec3) -> Bow {
        let seen = |d: Vec3| d - eye * d.dot(eye);
        let way = seen(to - from);
        let chord = way.length();
        let straight = Bow { from, to, bow: Vec3::ZERO, chord };
        let Some(old) = before.map(|before| seen(from - before)) else { return straight };
        let length = old.length();
        // Beyond 60 degrees it is a corner and no curve.
        if !(old.dot(way) > 0.5 * length * chord) {
            return straight;
        }
        // The second difference over the two lengths, to the scale of the chord.
        let bend = (way / chord - old / length) * (chord * chord / (chord + length));
        Bow { bow: -bend, ..straight }
    }

    /// The place at a share of the way.
    fn at(&self, t: f32) -> Vec3 {
        self.from.lerp(self.to, t) + self.bow * (t * (1.0 - t))
    }
}
