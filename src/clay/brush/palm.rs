//! A palm: a disc that presses the clay in front of it flat.

use glam::Vec3;

use crate::{Kernel, PageIn, PageOut};

/// A disc on its way.
#[derive(Debug, Clone, Copy)]
pub struct Palm {
    from: Vec3,
    along: Vec3,
    inv_length2: f32,
    normal: Vec3,
    radius: f32,
    strength: f32,
}

impl Palm {
    /// A disc of `radius` swept from `from` to `to`, facing along `normal` (unit length, out of the
    /// palm). Clay behind the disc by up to half its radius is carried to it: the disc went through
    /// there.
    pub fn new(from: Vec3, to: Vec3, normal: Vec3, radius: f32, strength: f32) -> Self {
        let along = to - from;
        let length2 = along.length_squared();
        let inv_length2 = if length2 > 0.0 { 1.0 / length2 } else { 0.0 };
        Palm { from, along, inv_length2, normal, radius, strength }
    }
}

impl Kernel for Palm {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        for i in 0..page.own() {
            let p = page.positions.get(i);
            let t = ((p - self.from).dot(self.along) * self.inv_length2).clamp(0.0, 1.0);
            let off = p - (self.from + self.along * t);
            let height = off.dot(self.normal);
            let aside = (off - self.normal * height).length() / self.radius;
            // Clay that faces away is the far side of a thin wall: the palm does not reach it.
            let faces = page.normals.get(i).dot(self.normal) < 0.0;
            if aside < 1.0 && height <= 0.0 && height > -0.5 * self.radius && faces {
                out.visit();
                let fade = 1.0 - aside * aside;
                out.set(
                    i,
                    p - self.normal * (height * fade * fade * self.strength * (1.0 - page.mask(i))),
                );
            }
        }
    }
}
