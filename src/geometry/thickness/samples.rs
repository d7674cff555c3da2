//! Places spread evenly over the area, for statistics that do not depend on how a part is meshed.
//!
//! Every place stands for the same area: the surface's triangles lie end to end on a line as long
//! as the area, and a place is taken at equal steps along it (systematic sampling). Where it lies
//! in its triangle follows a sequence of low discrepancy (Roberts, "The unreasonable effectiveness
//! of quasirandom sequences", 2018).

use glam::Vec3;

use super::surface::WeldedSurface;

/// Places over the whole surface by single rays, and by cones and balls, which cost more.
const PLACES: usize = 1 << 16;
const COSTLY_PLACES: usize = 1 << 14;

/// A place of the surface and what was measured there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaSample {
    /// The place.
    pub position: Vec3,
    /// Index into the triangles of the surface that was sampled.
    pub triangle: u32,
    /// In the mesh's unit; NaN without a value.
    pub value: f32,
}

/// Evenly spread places with no value yet, and the area that each stands for. `order`: the
/// triangles, near ones one after the other.
pub(super) fn spread(s: &WeldedSurface, order: &[u32], costly: bool) -> (Vec<AreaSample>, f64) {
    /// 1 / g and 1 / g^2 for g^3 = g + 1.
    const STEP: (f64, f64) = (0.754_877_666_246_692_7, 0.569_840_290_998_053_3);
    let area = |t: u32| s.corners(t as usize).map_or(0.0, super::summary::triangle_area);
    let all: f64 = order.iter().map(|&t| area(t)).sum();
    if !(all > 0.0 && all.is_finite()) {
        return (Vec::new(), 0.0);
    }
    let count = if costly { COSTLY_PLACES } else { PLACES };
    let each = all / count as f64;
    let mut out = Vec::with_capacity(count + 1);
    let mut before = 0.0;
    for &t in order {
        let own = area(t);
        while (out.len() as f64 + 0.5) * each < before + own && out.len() < count {
            let k = out.len() as f64;
            let (mut u, mut v) = ((0.5 + k * STEP.0).fract(), (0.5 + k * STEP.1).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            if let Some([a, b, c]) = s.corners(t as usize).map(|c| c.map(Vec3::as_dvec3)) {
                let position = (a + (b - a) * u + (c - a) * v).as_vec3();
                out.push(AreaSample { position, triangle: t, value: f32::NAN });
            }
        }
        before += own;
    }
    (out, each)
}
