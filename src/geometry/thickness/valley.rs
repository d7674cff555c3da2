//! Valleys of a surface, seen along a ray: the root of a groove, the tip of a pit.

use glam::{DVec3, Vec3};

use super::sharp_edges::OPPOSED;
use super::surface::WeldedSurface;

/// A surface seen along a direction.
pub(super) struct Valley<'a, F> {
    pub surface: &'a WeldedSurface,
    /// Tells faces that look against the direction, or aside: a ray meets them from within.
    pub faces_ray: F,
    /// The direction, of unit length.
    pub into: DVec3,
    /// Rises of less than some of this are rounding, in the mesh's unit.
    pub grain: f64,
}

/// What rises by less than this many of the grain is level.
const LEVEL: f64 = 8.0;

impl<F: Fn(u32) -> bool> Valley<'_, F> {
    /// Calls `visit` with the ends of each edge of facet `u` from which the faces on both sides go
    /// on deeper, unless it is steep, and with each of its corners, twice, around which all is
    /// deeper or as deep.
    pub fn each_bottom(&self, u: u32, mut visit: impl FnMut([DVec3; 2])) {
        let corners = self.surface.triangles[u as usize];
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            let beside = |&&f: &&u32| self.surface.triangles[f as usize].contains(&b);
            let mut faces = self.surface.around(a as usize).iter().filter(beside);
            let deeper = faces.clone().count() > 1 && faces.all(|&f| self.goes_deeper(f, a, b));
            if deeper && !self.is_steep(a, b) {
                visit([self.at(a), self.at(b)]);
            } else if self.is_bottom(a) {
                visit([self.at(a); 2]);
            }
        }
    }

    fn at(&self, v: u32) -> DVec3 {
        self.surface.positions[v as usize].as_dvec3()
    }

    /// The edge between two vertices goes deeper by more than 40 degrees: as a side, it is not
    /// opposite, and only its lower end may be.
    fn is_steep(&self, a: u32, b: u32) -> bool {
        let along = (self.at(b) - self.at(a)).normalize_or_zero();
        along.dot(self.into).powi(2) > 1.0 - OPPOSED * OPPOSED
    }

    /// Face `f` is met from within, and goes deeper from its edge between `a` and `b`.
    fn goes_deeper(&self, f: u32, a: u32, b: u32) -> bool {
        if !(self.faces_ray)(f) {
            return false;
        }
        let from = self.at(a);
        let along = (self.at(b) - from).normalize_or_zero();
        let other = self.surface.triangles[f as usize].into_iter().find(|&v| v != a && v != b);
        other.is_some_and(|c| {
            let way = self.at(c) - from;
            (way - along * way.dot(along)).dot(self.into) > LEVEL * self.grain
        })
    }

    fn is_bottom(&self, v: u32) -> bool {
        let depth = |p: Vec3| p.as_dvec3().dot(self.into);
        let own = depth(self.surface.positions[v as usize]) - LEVEL * self.grain;
        let deeper = |w: u32| depth(self.surface.positions[w as usize]) >= own;
        let all = |&f: &u32| {
            (self.faces_ray)(f) && self.surface.triangles[f as usize].into_iter().all(deeper)
        };
        self.surface.around(v as usize).iter().all(all)
    }
}
