//! How good a triangle is, without trigonometry: the squared sine of its smallest angle.
//!
//! The smallest angle lies opposite the shortest edge, between the two longest: its sine is the
//! doubled area over their product. It is at most 60 degrees, where the sine rises with the angle.

use glam::Vec3;

/// The squared sine of 3 degrees: no operation leaves a smaller angle, unless one that was smaller
/// still lay there before.
pub(crate) const LEAST: f32 = 0.002_739;
/// The squared sine of 35 degrees: an edge is flipped only beside a smaller angle.
pub(crate) const FLIP_BELOW: f32 = 0.328_99;
/// By how much a flip must raise the squared sine of the smallest angle: about a twentieth of the
/// angle. Without it the same edge could be flipped to and fro.
pub(crate) const FLIP_GAIN: f32 = 1.1;
/// Flat enough to flip across: the cosine between the two triangles.
pub(crate) const FLAT: f32 = 0.94;

/// The squared sine of the smallest angle, 0 for a triangle without area.
pub(crate) fn sine2(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let (u, v, w) = (b - a, c - b, a - c);
    let (l, m, n) = (u.length_squared(), v.length_squared(), w.length_squared());
    let shortest = l.min(m).min(n);
    let product = if shortest == l {
        m * n
    } else if shortest == m {
        l * n
    } else {
        l * m
    };
    let area2 = u.cross(w).length_squared();
    if product > 0.0 { area2 / product } else { 0.0 }
}

/// The unit normal of a triangle; zero for one without area.
pub(crate) fn normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The normal of a triangle, as long as the triangle is large.
pub(crate) fn by_area(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    (b - a).cross(c - a)
}
