//! One dab: the input of a brush at one place.
//!
//! A dab may have images (mirrors, turns). Images whose reaches overlap act together: each reads
//! the clay in its state before any of them, and their changes add up. So a symmetric stroke on a
//! symmetric form stays symmetric also where it meets itself on the mirror.

use glam::Vec3;

use super::BrushSettings;
use super::options::Method;
use super::stamp::Lens;
use super::weights::{facing, ln};
use crate::Reach;

/// The greatest share of the way to its goal that a brush goes over a fifth of the radius.
pub const FASTEST: f32 = 0.97;

/// The share of the way to its goal that a vertex of this weight goes at this pace: `1 - e^-x` with
/// `x = pace * weight`, the exponential by its series to the fourth power. That is one division,
/// and off by less than 0.002 up to `x = 1`, by 0.012 at the fastest pace.
#[inline(always)]
pub fn part(pace: f32, weight: f32) -> f32 {
    let x = pace * weight;
    let e = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0))));
    (e - 1.0) / e
}

/// The way over which the direction of a stroke is averaged, in radii.
pub const HEADING: f32 = 0.5;

/// The sharpest bend in [`Dab::bend`], in inverse radii.
pub const SHARPEST: f32 = 0.7;

/// The way a brush follows the pen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grip {
    /// The brush stays on the surface: one dab per spacing.
    Surface,
    /// The brush holds the clay that was under it when the pen came down; a dab gives the motion
    /// since then.
    Anchor,
    /// The brush drags the clay parallel to the view and moves with it; a dab gives the motion
    /// since the last one.
    Tow,
}

/// One dab, in mesh units.
#[derive(Debug, Clone, Copy)]
pub struct Dab<'a> {
    /// The user's settings.
    pub settings: &'a BrushSettings,
    /// The middle of the dab: on the surface at the start of the stroke if `found`, else on the
    /// current surface.
    pub centre: Vec3,
    /// Unit vector out of the clay at `centre` (leaning to the pen where the settings ask for it).
    pub normal: Vec3,
    /// The point where the pen touches the current surface.
    pub touch: Vec3,
    /// True if the dab is measured on the surface at the start of the stroke.
    pub found: bool,
    /// In mesh units, pressure included.
    pub radius: f32,
    /// 0 to 1, pressure included.
    pub strength: f32,
    /// The length of stroke that the dab represents, in fifths of the radius. Strengths apply to a
    /// dab for which this is 1.
    pub span: f32,
    /// The pace of a brush towards its goal with this dab: [`Dab::pace_of`] at the rate `strength`.
    pub pace: f32,
    /// The direction of the stroke, averaged over half a radius; of any length, zero at its start.
    pub heading: Vec3,
    /// The direction of the stroke here: `heading`, corrected for its lag where the stroke bends.
    /// Of any length, zero at the start of a stroke.
    pub course: Vec3,
    /// The curvature of the stroke: points towards the middle of the circle that it follows, with
    /// the length one over the radius ([`SHARPEST`] at most), perpendicular to `course`. Zero for a
    /// stroke that goes straight or turns on the spot.
    pub bend: Vec3,
    /// The index of the brush's pass, from 0.
    pub pass: usize,
    /// 1, or -1 for the other way round.
    pub sign: f32,
    /// On the surface: from the last dab's centre, zero for the first. Anchored: from the start.
    /// Towed: of this step.
    pub motion: Vec3,
    /// Anchored: the motion of the dab before.
    pub last: Vec3,
    /// Unit, towards the eye.
    pub eye: Vec3,
    /// Unit, to the right of the view.
    pub right: Vec3,
    /// The camera's view of the clay.
    pub lens: Lens,
    /// 1, or -1 in an image that is mirrored.
    pub hand: f32,
    /// The index of the image; 0 is the brush itself.
    pub image: usize,
    /// Length of the stroke up to here, and a number that differs from stroke to stroke.
    pub travelled: f32,
    /// See [`Dab::travelled`].
    pub stroke: u32,
    /// The face set under the first dab of the stroke, of this image; 0: none.
    pub set: u16,
    /// The face set that the stroke draws, of all images; `None`: it draws none.
    pub draws: Option<u16>,
}

impl Dab<'_> {
    /// Returns the height that a raising brush adds with this dab; negative to carve.
    pub fn height(&self) -> f32 {
        self.sign * self.strength * self.span * self.radius
    }

    /// The height of a brush that does all it does at once, negative to carve.
    pub fn whole_height(&self) -> f32 {
        self.sign * self.strength * self.radius
    }

    /// Returns the pace of a brush towards its goal with this dab. `rate` is the share of the way
    /// that a dab with a `span` of 1 covers (0 to 1; clamped to [`FASTEST`]). The paces of several
    /// dabs add up, so neither their spacing nor their number changes how far they go together.
    pub fn pace_of(&self, rate: f32) -> f32 {
        -ln(1.0 - rate.clamp(0.0, FASTEST)) * self.span
    }

    /// The share of the way to a mean that moves along with it (that of its neighbours) which a
    /// vertex goes with this dab, if it goes `rate` of it (0 to 1) with a dab for which `span` is
    /// 1: what evens a surface adds up by the share itself.
    pub fn evening(&self, rate: f32) -> f32 {
        (rate * self.span).clamp(0.0, 1.0)
    }

    /// The share of the brush at a squared distance from its middle.
    #[inline(always)]
    pub fn fade(&self, d2: f32) -> f32 {
        let s = self.settings;
        let x = d2.sqrt() / self.radius;
        let x = if s.hardness > 0.0 { soft(x, s.hardness) } else { x };
        s.falloff.at(x, &s.curve)
    }

    /// Returns the weight of a vertex with the normal `n` by its side of the surface: 1 where it
    /// faces as the dab does, 0 from 120 degrees on, so that a thin plate's far side stays.
    #[inline(always)]
    pub fn facing(&self, n: Vec3) -> f32 {
        facing(n.dot(self.normal))
    }

    /// One of the brush's own numbers.
    pub fn extra(&self, i: usize) -> f32 {
        self.settings.extra[i]
    }

    /// The way from the dab before it, mesh units. Zero for the first dab of a stroke, after a leap
    /// of a radius or more, and where dabs do not follow the path (dots, jitter, a held brush).
    pub fn way(&self) -> Vec3 {
        let path = &self.settings.path;
        let follows =
            matches!(path.method, Method::Space | Method::Airbrush | Method::Line | Method::Curve);
        let near = self.motion.length_squared() < self.radius * self.radius;
        if follows && near && path.jitter <= 0.0 { self.motion } else { Vec3::ZERO }
    }

    /// The stroke's direction in the tangent plane, unit length; for a stroke without one, to the
    /// right of the view.
    pub fn along(&self) -> Vec3 {
        let flat = |d: Vec3| (d - self.normal * d.dot(self.normal)).try_normalize();
        flat(self.heading)
            .or_else(|| flat(self.motion))
            .or_else(|| flat(self.right))
            .unwrap_or_else(|| self.normal.any_orthonormal_vector())
    }

    /// [`Dab::course`] in the plane of this unit normal, unit length; for a stroke without a course
    /// any direction there.
    pub fn course_in(&self, normal: Vec3) -> Vec3 {
        let flat = self.course - normal * self.course.dot(normal);
        flat.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector())
    }

    /// A ball about the centre, drawn out to where the stroke may have raised what lay in it.
    pub fn ball(&self, radii: f32) -> Reach {
        let radius = self.radius * radii;
        if !self.found {
            return Reach::Sphere { centre: self.centre, radius };
        }
        // A stroke goes on raising what the pen has passed: by as much again as it had before.
        let raised = (self.touch - self.centre) * 2.5;
        let room = self.normal * (self.height() * 2.0);
        Reach::Capsule { from: self.centre, to: self.centre + raised + room, radius: radius * 1.01 }
    }
}

/// A distance in radii as the falloff counts it: 0 as far as `hardness`, 1 at the rim.
#[inline(always)]
pub(super) fn soft(x: f32, hardness: f32) -> f32 {
    ((x - hardness) / (1.0 - hardness)).max(0.0)
}

#[cfg(test)]
impl<'a> Dab<'a> {
    /// A dab by itself on a ball about the origin, seen from its normal.
    pub(crate) fn resting(
        settings: &'a BrushSettings,
        centre: Vec3,
        radius: f32,
        strength: f32,
    ) -> Dab<'a> {
        let normal = centre.normalize();
        let right = normal.any_orthonormal_vector();
        let dab = Dab {
            settings,
            centre,
            normal,
            touch: centre,
            found: false,
            radius,
            strength,
            span: 1.0,
            pace: 0.0,
            heading: right * HEADING,
            course: right,
            bend: Vec3::ZERO,
            pass: 0,
            sign: 1.0,
            motion: Vec3::ZERO,
            last: Vec3::ZERO,
            eye: normal,
            right,
            lens: Lens::default(),
            hand: 1.0,
            image: 0,
            travelled: 0.0,
            stroke: 1,
            set: 0,
            draws: None,
        };
        Dab { pace: dab.pace_of(strength), ..dab }
    }
}
