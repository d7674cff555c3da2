//! An alpha between the brush and the clay: a stamp under each dab, a picture projected along the
//! view, or a stencil that stands still before the view while the brush works behind it.
//!
//! It scales what any brush does: nothing where the alpha is 0, all of it where it is 1. (The
//! texture brush bends its alpha along the stroke instead; that is `unroll`.)

use glam::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::alpha::{Alpha, Picture};
use super::dab::Dab;
use sculptd_geometry::portable::PortableMath;

/// How the alpha is laid over the clay.
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
    /// How it is laid.
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

/// How an eye sees the work: enough to find where a point is on the view.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lens {
    /// Where the eye is, mesh units.
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
    fn half_at(&self, p: Vec3) -> f32 {
        if self.parallel { self.half } else { self.half * (self.eye - p).dot(self.back) }
    }

    /// Where a point is seen, from the view's middle, in view heights, right and up; `None` behind
    /// the eye.
    pub fn seen(&self, p: Vec3) -> Option<Vec2> {
        let (d, half) = (p - self.eye, self.half_at(p));
        (half > 0.0).then(|| Vec2::new(d.dot(self.right), d.dot(self.up)) * (0.5 / half))
    }
}

/// A stamp over one dab.
#[derive(Debug, Clone, Copy)]
pub struct PlacedStamp {
    stamp: Stamp,
    alpha: Alpha,
    lens: Lens,
    /// Cosine and sine of the turn back.
    turn: Vec2,
    centre: Vec3,
    /// In the tangent plane, over half the stamp's width.
    along: Vec3,
    across: Vec3,
    /// The middle on the view, and what half the stamp's width is there.
    middle: Vec2,
    reach: f32,
}

impl PlacedStamp {
    /// `None`: there is no stamp.
    pub fn ready(dab: &Dab<'_>) -> Option<PlacedStamp> {
        let stamp = dab.settings.stamp;
        if stamp.by == StampBy::Off {
            return None;
        }
        let half = dab.radius * stamp.size;
        let along = dab.along();
        let (middle, reach) = match stamp.by {
            StampBy::Stencil => (Vec2::from(stamp.at), stamp.size * 0.5),
            _ => {
                let over = dab.lens.half_at(dab.centre).max(f32::MIN_POSITIVE);
                (dab.lens.seen(dab.centre).unwrap_or(Vec2::ZERO), 0.5 * half / over)
            }
        };
        let angle = -stamp.turn_degrees.to_radians();
        Some(PlacedStamp {
            stamp,
            alpha: dab.settings.alpha,
            lens: dab.lens,
            turn: Vec2::new(angle.portable_cos(), angle.portable_sin()),
            centre: dab.centre,
            along: along / half,
            across: dab.normal.cross(along) * (dab.hand / half),
            middle,
            reach,
        })
    }

    /// The share of the brush that goes through at a point, 0 to 1.
    pub fn share(&self, p: Vec3, picture: Option<&Picture>) -> f32 {
        let at = match self.stamp.by {
            StampBy::Dab => {
                let d = p - self.centre;
                Vec2::new(d.dot(self.along), d.dot(self.across))
            }
            _ => match self.lens.seen(p) {
                Some(seen) => (seen - self.middle) / self.reach,
                None => return 0.0,
            },
        };
        let st = self.turn.rotate(at) * 0.5 + 0.5;
        let within = st.cmpge(Vec2::ZERO).all() && st.cmple(Vec2::ONE).all();
        if !within && !self.stamp.repeat {
            return 0.0;
        }
        let st = if within { st } else { st - st.floor() };
        self.alpha.at(st.x, st.y, picture).clamp(0.0, 1.0)
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
