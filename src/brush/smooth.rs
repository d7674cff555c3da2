//! The smooth brush: cotangent-weighted Laplacian, weights clamped, boundaries and needles safe.
//!
//! Each neighbour `b` of a vertex `p` weighs `cot` of the angles opposite the edge, in the two triangles beside it (Pinkall and
//! Polthier 1993), clamped to 0 from below, where an obtuse angle would push instead of pull, and to [`MAX_COT`] from above.
//! With `b` and `c` relative to `p`, the triangle's doubled area `|b x c|` is under both its cotangents:
//! at `c` it is `(c.c - b.c) / |b x c|`, at `b` it is `(b.b - b.c) / |b x c|`.

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

/// Neighbours that are weighed together.
const LANES: usize = 8;

/// The weighted sum of a closed ring's neighbours relative to `p`, and the sum of weights. Up to [`LANES`] neighbours.
#[inline(always)]
fn closed(page: &PageIn<'_>, v: usize, p: Vec3) -> (Vec3, f32) {
    let (mut x, mut y, mut z) = ([0.0f32; LANES + 1], [0.0f32; LANES + 1], [0.0f32; LANES + 1]);
    let mut n = 0;
    for k in page.ring(v).take(LANES) {
        let d = page.point(k) - p;
        (x[n], y[n], z[n]) = (d.x, d.y, d.z);
        n += 1;
    }
    (x[n], y[n], z[n]) = (x[0], y[0], z[0]);
    let (mut to_b, mut to_c) = ([0.0f32; LANES], [0.0f32; LANES]);
    for i in 0..LANES {
        let (bx, by, bz, cx, cy, cz) = (x[i], y[i], z[i], x[i + 1], y[i + 1], z[i + 1]);
        let (nx, ny, nz) = (by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx);
        let area2 = nx * nx + ny * ny + nz * nz;
        let inverse = if area2 > 0.0 { 1.0 / area2.sqrt() } else { 0.0 };
        let bc = bx * cx + by * cy + bz * cz;
        let at_c = (cx * cx + cy * cy + cz * cz - bc) * inverse;
        let at_b = (bx * bx + by * by + bz * bz - bc) * inverse;
        // Lanes past the ring hold no triangle: their area is 0, and so is their weight.
        to_b[i] = at_c.clamp(0.0, MAX_COT);
        to_c[i] = at_b.clamp(0.0, MAX_COT);
    }
    let sum = |of: &[f32; LANES + 1]| {
        let mut s = [0.0f32; LANES];
        for i in 0..LANES {
            s[i] = of[i] * to_b[i] + of[i + 1] * to_c[i];
        }
        ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]))
    };
    (Vec3::new(sum(&x), sum(&y), sum(&z)), sum(&[1.0; LANES + 1]))
}

/// The same for any ring.
fn any(page: &PageIn<'_>, v: usize, p: Vec3) -> (Vec3, f32) {
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    for [b, c] in page.wedges(v) {
        let (b, c) = (page.point(b) - p, page.point(c) - p);
        let area = b.cross(c).length();
        let inverse = if area > 0.0 { 1.0 / area } else { 0.0 };
        let bc = b.dot(c);
        let to_b = ((c.dot(c) - bc) * inverse).clamp(0.0, MAX_COT);
        let to_c = ((b.dot(b) - bc) * inverse).clamp(0.0, MAX_COT);
        sum += b * to_b + c * to_c;
        weights += to_b + to_c;
    }
    (sum, weights)
}

impl Kernel for Smooth {
    #[inline]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let radius2 = self.radius * self.radius;
        for i in 0..page.own() {
            let p = page.positions.get(i);
            let d2 = (p - self.centre).length_squared();
            if d2 >= radius2 {
                continue;
            }
            out.visit();
            let short = page.is_closed(i) && page.ring(i).len() <= LANES;
            let (sum, weights) = if short { closed(page, i, p) } else { any(page, i, p) };
            if weights > 0.0 {
                let fade = 1.0 - d2 / radius2;
                out.set(i, p + sum * (self.lambda * fade * fade * (1.0 - page.mask(i)) / weights));
            }
        }
    }
}
