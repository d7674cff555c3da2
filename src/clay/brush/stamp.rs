//! An alpha between the brush and the clay: a stamp under each dab, a picture projected along the
//! view, or a stencil that stands still before the view while the brush works behind it.
//!
//! It scales what any brush does: nothing where the alpha is 0, all of it where it is 1. (The
//! texture brush bends its alpha along the stroke instead; that is [`super::texture`].)

use glam::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// The placement of the alpha over the clay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StampBy {
    /// Not at all.
    #[default]
    Off,
    /// In the tangent plane of each dab, its `s` along the stroke.
    Dab,
    /// Along the view, about each dab, upright.
    View,
    /// Along the view, standing still: a stencil.
    Stencil,
}

/// An alpha between the brush and the clay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stamp {
    /// Its placement.
    pub by: StampBy,
    /// Its width: in widths of the brush, a stencil's in heights of the view; 0.05 to 10.
    pub size: f32,
    /// Counter-clockwise as seen; -180 to 180.
    pub turn_degrees: f32,
    /// The stencil's middle from the view's, in heights of the view, right and up; -4 to 4.
    pub at: [f32; 2],
    /// The alpha repeats beyond its edges; else nothing is done there.
    pub repeat: bool,
}

impl Default for Stamp {
    fn default() -> Self {
        Stamp { by: StampBy::Off, size: 1.0, turn_degrees: 0.0, at: [0.0; 2], repeat: false }
    }
}

/// A view of the clay: enough to project a point to the view.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lens {
    /// The eye's position, in mesh units.
    pub eye: Vec3,
    /// Unit: right, up, and back towards the eye.
    pub right: Vec3,
    /// See [`Lens::right`].
    pub up: Vec3,
    /// See [`Lens::right`].
    pub back: Vec3,
    /// Half the view's height over the distance from the eye; without perspective half the height
    /// itself.
    pub half: f32,
    /// Without perspective.
    pub parallel: bool,
}

impl Lens {
    /// Seen in a mirror, or from a turned place: `m * p + t`.
    #[must_use]
    pub fn image(&self, m: Mat3, t: Vec3) -> Lens {
        Lens {
            eye: m * self.eye + t,
            right: m * self.right,
            up: m * self.up,
            back: m * self.back,
            ..*self
        }
    }

    /// Half the view's height at a point; zero or less behind the eye.
    pub(super) fn half_at(&self, p: Vec3) -> f32 {
        if self.parallel { self.half } else { self.half * (self.eye - p).dot(self.back) }
    }

    /// Returns the projection of a point, from the view's middle, right and up, in view heights;
    /// `None` behind the eye.
    pub fn seen(&self, p: Vec3) -> Option<Vec2> {
        let (d, half) = (p - self.eye, self.half_at(p));
        (half > 0.0).then(|| Vec2::new(d.dot(self.right), d.dot(self.up)) * (0.5 / half))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_seen_where_it_is_and_its_image_in_the_mirror_too() {
        let lens = Lens {
            eye: Vec3::new(0.2, 0.0, 4.0),
            right: Vec3::X,
            up: Vec3::Y,
            back: Vec3::Z,
            half: 0.5,
            parallel: false,
        };
        // Four units off the view is four units high.
        assert_eq!(lens.seen(Vec3::new(1.2, -0.5, 0.0)), Some(Vec2::new(0.25, -0.125)));
        assert_eq!(lens.seen(Vec3::new(0.0, 0.0, 5.0)), None);
        let mirror = Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0));
        let p = Vec3::new(0.7, 0.3, -0.4);
        assert_eq!(lens.image(mirror, Vec3::ZERO).seen(mirror * p), lens.seen(p));
    }
}
