//! The smooth brush: cotangent-weighted Laplacian, weights clamped, boundaries and needles safe.

use glam::Vec3;

use crate::mesh::{Kernel, PageIn, PageOut};

/// Cotangents beyond 20 belong to angles under 3 degrees: needles, whose weights would rule the ring.
const MAX_COT: f32 = 20.0;

#[derive(Debug, Clone, Copy)]
pub struct Smooth {
    centre: Vec3,
    radius: f32,
    lambda: f32,
}

impl Smooth {
    /// `lambda` 0 to 1: the share of the way to the weighted mean of the ring, at the centre.
    pub fn new(centre: Vec3, radius: f32, lambda: f32) -> Self {
        Smooth { centre, radius, lambda: lambda.clamp(0.0, 1.0) }
    }
}

fn cot(apex: Vec3, a: Vec3, b: Vec3) -> f32 {
    let (u, v) = (a - apex, b - apex);
    let sin = u.cross(v).length();
    if sin <= 0.0 { 0.0 } else { (u.dot(v) / sin).clamp(0.0, MAX_COT) }
}

impl Kernel for Smooth {
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for i in 0..page.own() {
            let p = page.positions.get(i);
            let d = (p - self.centre).length();
            if d >= self.radius {
                continue;
            }
            out.visit();
            let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
            for [b, c] in page.wedges(i) {
                let (b, c) = (page.point(b), page.point(c));
                let (wb, wc) = (cot(c, p, b), cot(b, c, p));
                sum += (b - p) * wb + (c - p) * wc;
                weights += wb + wc;
            }
            if weights > 0.0 {
                let x = d / self.radius;
                let fade = (1.0 - x * x) * (1.0 - x * x) * (1.0 - page.mask(i));
                out.set(i, p + sum * (self.lambda * fade / weights));
            }
        }
    }
}
