//! Valleys of a surface, seen along a ray: the root of a groove, the tip of a pit.

use glam::DVec3;

use super::sharp_edges::{GRAZING, OPPOSED};
use super::surface::WeldedSurface;

/// A surface seen along a direction.
pub(super) struct Valley<'a> {
    pub surface: &'a WeldedSurface,
    /// See [`WeldedSurface::tilts`].
    pub tilts: &'a [f32],
    /// 1 if normals point out of the measured side, -1 if into it.
    pub sign: f64,
    /// The direction, of unit length.
    pub into: DVec3,
    /// Rises of less than some of this are rounding, in the mesh's unit.
    pub grain: f64,
}

/// What rises by less than this many of the grain is level.
const LEVEL: f64 = 8.0;
/// Most facets on the way down a side; a longer one is taken for that of an edge.
const STEPS: usize = 4096;

impl Valley<'_> {
    /// Returns true if facet `u`, which is turned too far to be the other side of a wall, is the
    /// side of a valley: the way down from it, towards less depth, comes to a bottom, or to a facet
    /// that is turned less. The side of an edge goes down to the edge. `floor`: the depth of the
    /// plane that the ray begins on.
    pub fn is_side(&self, u: u32, floor: f64) -> bool {
        let floor = floor + LEVEL * self.grain;
        let mut f = u;
        for _ in 0..STEPS {
            if self.facing(f) >= OPPOSED {
                return true;
            }
            let mut bottom = false;
            self.each_bottom(f, |ends| bottom |= ends.iter().any(|p| p.dot(self.into) > floor));
            if bottom {
                return true;
            }
            let corners = self.surface.triangles[f as usize];
            let mut next: Option<(f64, u32)> = None;
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]];
                if !self.goes_deeper(f, a, b) {
                    continue;
                }
                for &g in self.surface.around(a as usize) {
                    let across = g != f && self.surface.triangles[g as usize].contains(&b);
                    if across && self.faces_ray(g) {
                        let [low, high] = self.extent(g);
                        if high > floor && next.is_none_or(|n| low < n.0) {
                            next = Some((low, g));
                        }
                    }
                }
            }
            match next {
                Some((_, g)) => f = g,
                None => return false,
            }
        }
        false
    }

    fn depth(&self, v: u32) -> f64 {
        self.at(v).dot(self.into)
    }

    /// The least and the greatest depth of facet `f`.
    fn extent(&self, f: u32) -> [f64; 2] {
        let depths = self.surface.triangles[f as usize].map(|v| self.depth(v));
        [
            depths.into_iter().fold(f64::INFINITY, f64::min),
            depths.into_iter().fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// The cosine of the angle between facet `f`, turned round, and the direction.
    fn facing(&self, f: u32) -> f64 {
        self.surface.face_normals[f as usize].as_dvec3().dot(self.into) * self.sign
    }

    /// Facet `f` looks against the direction, or aside: a ray meets it from within.
    fn faces_ray(&self, f: u32) -> bool {
        self.facing(f) > -(GRAZING + f64::from(self.tilts[f as usize]))
    }

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
            } else if self.depth(a) <= self.extent(u)[0] + LEVEL * self.grain && self.is_bottom(a) {
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
        if !self.faces_ray(f) {
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
        let own = self.depth(v) - LEVEL * self.grain;
        let deeper = |w: u32| self.depth(w) >= own;
        let all = |&f: &u32| {
            self.faces_ray(f) && self.surface.triangles[f as usize].into_iter().all(deeper)
        };
        self.surface.around(v as usize).iter().all(all)
    }
}
