//! What a dab leaves alone by itself.

use glam::Vec3;

use super::dab::Dab;
use super::placed_stamp::PlacedStamp;
use crate::PageIn;
use crate::brush::surface_query::{Scratch, SurfaceQuery};
use sculptd_geometry::portable::PortableMath;

/// Faces fade out over this much of the cosine to the eye.
const FRONT_FADE: f32 = 0.2;

/// The automatic masking of one dab, computed before the dab acts.
#[derive(Debug, Clone, Copy)]
pub struct AutoMasking {
    on: bool,
    eye: Option<Vec3>,
    boundary: bool,
    normal: Option<(Vec3, f32)>,
    /// Mesh units: what a bend of one in so much does.
    cavity: f32,
    /// The image whose connected part was marked.
    connected: Option<usize>,
    /// The only face set that is free.
    set: Option<u16>,
    stamp: Option<PlacedStamp>,
}

impl AutoMasking {
    /// For a dab; marks what hangs together with it where the settings ask for that.
    pub fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> AutoMasking {
        let a = &dab.settings.auto;
        if a.topology {
            on.mark_connected(dab);
        }
        let stamp = PlacedStamp::ready(dab);
        AutoMasking {
            on: a.is_on() || stamp.is_some(),
            eye: a.front_faces.then_some(dab.eye),
            boundary: a.boundary,
            normal: (a.normal_degrees > 0.0).then(|| (dab.normal, a.normal_degrees.to_radians())),
            cavity: a.cavity * dab.radius,
            connected: a.topology.then_some(on.image),
            set: a.face_sets.then_some(dab.set),
            stamp,
        }
    }

    /// Returns true if the dab may leave vertices alone.
    pub fn is_on(&self) -> bool {
        self.on
    }

    /// 0 left alone to 1 free. `at`: where the brush has the vertex, now or at the start of the
    /// stroke.
    #[inline(always)]
    pub fn share(&self, page: &PageIn<'_>, v: usize, at: Vec3, scratch: &Scratch) -> f32 {
        if !self.on {
            return 1.0;
        }
        let mut w = 1.0;
        let n = page.normals.get(v);
        if let Some(eye) = self.eye {
            w *= (n.dot(eye) / FRONT_FADE).clamp(0.0, 1.0);
        }
        if self.boundary && page.is_border(v) {
            return 0.0;
        }
        if self.set.is_some_and(|set| page.face_set(v) != set) {
            return 0.0;
        }
        if let Some((normal, most)) = self.normal {
            let angle = n.dot(normal).clamp(-1.0, 1.0).portable_acos();
            w *= ((most - angle) / (most / 3.0)).clamp(0.0, 1.0);
        }
        if self.cavity != 0.0 {
            w *= (0.5 + hollow(page, v) * self.cavity).clamp(0.0, 1.0);
        }
        if self.connected.is_some_and(|image| !scratch.is_marked(image, page.number(), v)) {
            return 0.0;
        }
        if let Some(stamp) = &self.stamp
            && w > 0.0
        {
            w *= stamp.share(at, scratch.picture());
        }
        w
    }
}

/// Returns the mean curvature at a vertex, in one over mesh units, computed from the heights of its
/// neighbours over the tangent plane. It is above 0 in a hollow and below 0 on a ridge; -1/r on a
/// ball of radius r.
pub fn hollow(page: &PageIn<'_>, v: usize) -> f32 {
    let (p, n) = (page.positions.get(v), page.normals.get(v));
    let (mut sum, mut count) = (0.0, 0.0f32);
    for k in page.ring(v) {
        let d = page.point(k) - p;
        let length2 = d.length_squared();
        if length2 > 0.0 {
            sum += 2.0 * d.dot(n) / length2;
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
