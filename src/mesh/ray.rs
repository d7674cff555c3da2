//! Rays, hits, and a watertight triangle test.

use glam::Vec3;

/// A half-line. `dir` has unit length, so `t` is a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    pub dir: Vec3,
}

/// Where a ray meets the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    pub position: Vec3,
    /// Interpolated vertex normal, unit length.
    pub normal: Vec3,
    pub page: u32,
    /// Within the page.
    pub triangle: u32,
    /// Weights of the triangle's corners, they sum to 1.
    pub barycentric: [f32; 3],
}

/// A ray with what the watertight test of Woop, Benthin and Wald (2013) derives from it once.
#[derive(Debug, Clone, Copy)]
pub struct PreparedRay {
    pub ray: Ray,
    pub inv: Vec3,
    k: [usize; 3],
    shear: Vec3,
}

impl PreparedRay {
    pub fn new(ray: Ray) -> Self {
        let d = ray.dir.to_array();
        let a = ray.dir.abs();
        let kz = if a.x > a.y && a.x > a.z {
            0
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut kx, mut ky) = ((kz + 1) % 3, (kz + 2) % 3);
        if d[kz] < 0.0 {
            std::mem::swap(&mut kx, &mut ky);
        }
        let shear = Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]);
        PreparedRay { ray, inv: ray.dir.recip(), k: [kx, ky, kz], shear }
    }

    /// Distance and barycentric weights where the ray crosses the triangle, from either side; edges and corners count.
    pub fn triangle(&self, corners: [Vec3; 3]) -> Option<(f32, [f32; 3])> {
        let [kx, ky, kz] = self.k;
        let s = self.shear;
        let [a, b, c] = corners.map(|p| (p - self.ray.origin).to_array());
        let flat = |p: [f32; 3]| (p[kx] - s.x * p[kz], p[ky] - s.y * p[kz]);
        let ((ax, ay), (bx, by), (cx, cy)) = (flat(a), flat(b), flat(c));
        let (mut u, mut v, mut w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        if u == 0.0 || v == 0.0 || w == 0.0 {
            let wide = |p: f32, q: f32, r: f32, t: f32| {
                (f64::from(p) * f64::from(q) - f64::from(r) * f64::from(t)) as f32
            };
            (u, v, w) = (wide(cx, by, cy, bx), wide(ax, cy, ay, cx), wide(bx, ay, by, ax));
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let t = (u * s.z * a[kz] + v * s.z * b[kz] + w * s.z * c[kz]) / det;
        (t >= 0.0).then(|| (t, [u / det, v / det, w / det]))
    }

    /// Where the ray enters a box, if it does before `far`. Widened by two units in the last place, so that no triangle on
    /// the box's face is lost to rounding.
    pub fn enters(&self, lo: Vec3, hi: Vec3, far: f32) -> Option<f32> {
        let a = (lo - self.ray.origin) * self.inv;
        let b = (hi - self.ray.origin) * self.inv;
        // A ray within a face's plane gives NaN there; `min` and `max` then keep the other side.
        let near = a.min(b).max_element().max(0.0);
        let exit = a.max(b).min_element() * (1.0 + 4.0 * f32::EPSILON);
        (near <= exit && near <= far).then_some(near)
    }
}
