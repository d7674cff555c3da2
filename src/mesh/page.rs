//! One page: about a thousand vertices, their surroundings, and the triangles between them.
//!
//! Laws kept here:
//! * A page holds its **own** vertices and copies (the **halo**) of the foreign vertices that its triangles and normals need, so
//!   every inner loop stays within the page. Local index `< own` is own, the rest is halo.
//! * What never changes while the topology stands ([`Topology`]) is apart from what a dab changes, so that copy on write
//!   copies only the latter.

use std::sync::Arc;

use glam::Vec3;

/// What stands still while a mesh is only displaced.
#[derive(Debug)]
pub struct Topology {
    pub own: usize,
    /// Where each halo vertex is at home: page, local index there.
    pub halo: Vec<(u32, u16)>,
    /// Pages that hold copies of vertices of this one.
    pub neighbours: Vec<u32>,
    /// Local corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u16; 3]>,
    /// The triangles' numbers in the mesh that was loaded.
    pub triangle_ids: Vec<u32>,
    /// The own vertices' numbers in the mesh that was loaded.
    pub ids: Vec<u32>,
    /// For own vertex `v`, `wedges[wedge_starts[v]..wedge_starts[v + 1]]`: the two other corners of each triangle about it,
    /// in the triangle's own order.
    pub wedge_starts: Vec<u16>,
    pub wedges: Vec<[u16; 2]>,
}

/// Coordinates as separate arrays: what the vectorised loops want.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Points {
    pub fn of(points: impl Iterator<Item = Vec3>) -> Self {
        let mut out = Points::default();
        for p in points {
            out.x.push(p.x);
            out.y.push(p.y);
            out.z.push(p.z);
        }
        out
    }

    pub fn len(&self) -> usize {
        self.x.len()
    }

    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    pub fn set(&mut self, i: usize, p: Vec3) {
        (self.x[i], self.y[i], self.z[i]) = (p.x, p.y, p.z);
    }
}

/// What a dab may change.
#[derive(Debug, Clone)]
pub struct Page {
    pub topology: Arc<Topology>,
    pub positions: Arc<Points>,
    pub halo: Arc<Points>,
    pub normals: Arc<Points>,
    /// 0 free to 1 protected, one an own vertex.
    pub mask: Arc<Vec<f32>>,
    /// RGBA, sRGB, one an own vertex.
    pub colours: Arc<Vec<[u8; 4]>>,
    /// Of the page's triangles.
    pub lo: Vec3,
    pub hi: Vec3,
}

impl Page {
    /// An own or a halo vertex.
    pub fn point(&self, local: usize) -> Vec3 {
        let own = self.topology.own;
        if local < own { self.positions.get(local) } else { self.halo.get(local - own) }
    }

    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.topology.triangles[triangle].map(|v| self.point(v as usize))
    }

    /// Bounds of the page's triangles.
    pub fn measure(&mut self) {
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for t in 0..self.topology.triangles.len() {
            for p in self.corners(t) {
                (lo, hi) = (lo.min(p), hi.max(p));
            }
        }
        // A page of lonely vertices is still found by its own points.
        for i in 0..self.positions.len() {
            let p = self.positions.get(i);
            (lo, hi) = (lo.min(p), hi.max(p));
        }
        (self.lo, self.hi) = (lo, hi);
    }

    /// Area-weighted normal of an own vertex; zero where all its triangles are degenerate.
    pub fn normal_of(&self, v: usize) -> Vec3 {
        let t = &self.topology;
        let p = self.positions.get(v);
        let mut n = Vec3::ZERO;
        for &[b, c] in &t.wedges[t.wedge_starts[v] as usize..t.wedge_starts[v + 1] as usize] {
            n += (self.point(b as usize) - p).cross(self.point(c as usize) - p);
        }
        n.normalize_or_zero()
    }
}
