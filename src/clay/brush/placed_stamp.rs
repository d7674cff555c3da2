//! A stamp ([`super::stamp`]) laid over one dab.

use glam::{Vec2, Vec3};

use super::alpha::{Alpha, Picture};
use super::dab::Dab;
use super::stamp::{Lens, Stamp, StampBy};
use sculptd_geometry::portable::PortableMath;

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
    /// The middle in the view, and half the stamp's width there.
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
    #[inline]
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
