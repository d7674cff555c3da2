//! Slide-relax: slides the triangles along the surface with the stroke and leaves the form; the
//! other way round (Shift, or the other end of the pen) it relaxes them, each vertex towards the
//! middle of its neighbours.
//!
//! A vertex goes in its tangent plane by at most two fifths of its shortest edge over a fifth of
//! the radius, so that no triangle turns over and closer dabs do not take it further, and is put
//! back upon the triangles that it came from: it never leaves the surface as the dab found it. A
//! border stays.

use glam::Vec3;

use super::brush_trait::{Brush, VertexChange, VertexContext};
use super::dab::Dab;
use crate::brush::surface_query::SurfaceQuery;

/// Of the shortest edge about a vertex, the furthest that a dab takes it for which `span` is 1.
const SAFE: f32 = 0.4;

/// One dab of slide relax, made ready.
#[derive(Debug, Clone, Copy)]
pub struct SlideRelaxBrush {
    /// The displacement; `None`: each vertex moves to the middle of its neighbours.
    by: Option<Vec3>,
}

impl Brush for SlideRelaxBrush {
    fn ready(dab: &Dab<'_>, _: &mut SurfaceQuery<'_>) -> Self {
        SlideRelaxBrush { by: (dab.sign > 0.0).then(|| dab.motion.clamp_length_max(dab.radius)) }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        if !spot.page.is_closed(spot.v) {
            return VertexChange::default();
        }
        let n = spot.normal();
        let by = match self.by {
            Some(by) => by * dab.strength,
            None => (spot.middle() - spot.p) * dab.evening(dab.strength),
        };
        let mut shortest = f32::INFINITY;
        for k in spot.page.ring(spot.v) {
            shortest = shortest.min((spot.page.point(k) - spot.p).length_squared());
        }
        let most = SAFE * dab.span.min(1.0) * shortest.sqrt();
        // The falloff scales the step after the bound. Bounded afterwards, the whole inside of the
        // brush would move as one, and the rim of the stroke would show the spacing of its dabs.
        let flat = (by - n * by.dot(n)).clamp_length_max(most) * spot.weight;
        VertexChange::by(put_back(spot, flat))
    }
}

/// The way to the point of the vertex's own triangles that is nearest to `to` (both from the
/// vertex, and nearer to it than the far sides of those).
fn put_back(spot: &VertexContext<'_>, to: Vec3) -> Vec3 {
    let ring = spot.page.ring(spot.v);
    let count = ring.len();
    let Some(last) = ring.last() else { return Vec3::ZERO };
    let mut before = spot.page.point(last) - spot.p;
    let (mut best, mut off) = (Vec3::ZERO, to.length_squared());
    let mut take = |q: Vec3| {
        let d = (q - to).length_squared();
        if d < off {
            (best, off) = (q, d);
        }
    };
    for k in spot.page.ring(spot.v).take(count) {
        let (a, b) = (before, spot.page.point(k) - spot.p);
        before = b;
        let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
        let (at, bt) = (a.dot(to), b.dot(to));
        let det = aa * bb - ab * ab;
        if det > 1e-8 * aa * bb {
            let (u, v) = ((at * bb - bt * ab) / det, (bt * aa - at * ab) / det);
            if u >= 0.0 && v >= 0.0 {
                take((a * u + b * v) / (u + v).max(1.0));
                continue;
            }
        }
        if bb > 0.0 {
            take(b * (bt / bb).clamp(0.0, 1.0));
        }
    }
    best
}
