//! Which triangles meet at an edge, and the normals of faces, edges and vertices.

use glam::{DVec3, Vec3};

use crate::TriMesh;
use crate::bvh::{Feature, NearestPoint};
use crate::weld::weld_positions;

/// Marks an edge with no partner, or with too many.
pub const NO_PARTNER: u32 = u32::MAX;

/// The surface with vertices at the same place taken as one.
#[derive(Debug, Clone)]
pub struct Topology {
    /// The welded vertices' positions, in the order of their first appearance in the mesh.
    pub positions: Vec<Vec3>,
    /// Welded corners of each triangle of the mesh; triangles with a bad index have `[u32::MAX;
    /// 3]`.
    pub triangles: Vec<[u32; 3]>,
    /// The triangle on the other side of edge `k` (from corner `k` to `k + 1`), or [`NO_PARTNER`].
    pub across: Vec<[u32; 3]>,
    /// Not of unit length: twice the area.
    pub face_normals: Vec<DVec3>,
    /// Weighted by the corners' angles; not of unit length.
    pub vertex_normals: Vec<DVec3>,
    /// Every edge is passed as often one way as the other.
    pub closed: bool,
    /// True for a vertex or an edge of a triangle without area, which has no valid pseudonormal.
    blunt: Vec<bool>,
}

impl Topology {
    /// Welds the corners of `mesh` and finds partners and normals, in time linear in its size but
    /// for the sorting of edges around a vertex.
    pub fn build(mesh: &TriMesh) -> Topology {
        let (weld, positions) = weld_positions(&mesh.positions);
        let triangles: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .map(|t| {
                let w = t.map(|v| weld.get(v as usize).copied().unwrap_or(u32::MAX));
                let usable = |&v: &u32| positions.get(v as usize).is_some_and(|p| p.is_finite());
                if w.iter().all(usable) { w } else { [u32::MAX; 3] }
            })
            .collect();
        let mut face_normals = vec![DVec3::ZERO; triangles.len()];
        let mut vertex_normals = vec![DVec3::ZERO; positions.len()];
        let mut blunt = vec![false; positions.len()];
        for (t, tri) in triangles.iter().enumerate() {
            if tri[0] == u32::MAX || tri[0] == tri[1] || tri[1] == tri[2] || tri[2] == tri[0] {
                continue;
            }
            let p = tri.map(|v| positions[v as usize].as_dvec3());
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            face_normals[t] = normal;
            let unit = normal.normalize_or_zero();
            if unit == DVec3::ZERO {
                tri.iter().for_each(|&v| blunt[v as usize] = true);
            }
            for k in 0..3 {
                let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                vertex_normals[tri[k] as usize] += unit * u.cross(v).length().atan2(u.dot(v));
            }
        }
        let (across, closed) = partners(&triangles, positions.len());
        Topology { positions, triangles, across, face_normals, vertex_normals, closed, blunt }
    }

    /// The normal that tells the sides of the surface apart at a nearest point; `None` where the
    /// mesh does not say.
    pub fn pseudonormal(&self, at: &NearestPoint) -> Option<DVec3> {
        let t = at.triangle as usize;
        let tri = self.triangles[t];
        let normal = match at.feature {
            Feature::Face => self.face_normals[t],
            Feature::Edge(k) => {
                let k = k as usize;
                let other = self.across[t][k];
                if other == NO_PARTNER
                    || self.blunt[tri[k] as usize] && self.blunt[tri[(k + 1) % 3] as usize]
                {
                    return None;
                }
                let unit = |t: usize| self.face_normals[t].normalize_or_zero();
                unit(t) + unit(other as usize)
            }
            Feature::Vertex(k) => {
                let v = tri[k as usize] as usize;
                if self.blunt[v] {
                    return None;
                }
                self.vertex_normals[v]
            }
        };
        (normal != DVec3::ZERO).then_some(normal)
    }
}

/// The partner of each half-edge: of two triangles that pass an edge opposite ways. And whether all
/// have one or, at edges of more than two triangles, as many one way as the other.
fn partners(triangles: &[[u32; 3]], vertices: usize) -> (Vec<[u32; 3]>, bool) {
    // Half-edges by their lower vertex: counted, then filled.
    let mut starts = vec![0u32; vertices + 1];
    let halves = |t: &[u32; 3]| {
        let t = *t;
        (0..3)
            .map(move |k| (t[k], t[(k + 1) % 3]))
            .filter(move |&(a, b)| t[0] != u32::MAX && a != b)
    };
    for t in triangles {
        halves(t).for_each(|(a, b)| starts[a.min(b) as usize + 1] += 1);
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    // (upper vertex, forward, half-edge)
    let mut list = vec![(0u32, false, 0u32); starts[vertices] as usize];
    for (i, t) in triangles.iter().enumerate() {
        if t[0] == u32::MAX {
            continue;
        }
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            if a != b {
                let slot = &mut next[a.min(b) as usize];
                list[*slot as usize] = (a.max(b), a < b, (i * 3 + k) as u32);
                *slot += 1;
            }
        }
    }
    let mut across = vec![[NO_PARTNER; 3]; triangles.len()];
    let mut closed = true;
    for v in 0..vertices {
        let around = &mut list[starts[v] as usize..starts[v + 1] as usize];
        around.sort_unstable();
        for edge in around.chunk_by(|x, y| x.0 == y.0) {
            let forward = edge.iter().filter(|e| e.1).count();
            closed &= forward * 2 == edge.len();
            if let [(_, false, x), (_, true, y)] = *edge {
                let (x, y) = (x as usize, y as usize);
                across[x / 3][x % 3] = (y / 3) as u32;
                across[y / 3][y % 3] = (x / 3) as u32;
            }
        }
    }
    (across, closed)
}
