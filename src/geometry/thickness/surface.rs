//! What thickness needs to know of a mesh besides its tree: which corners are one vertex, which
//! faces meet there, normals, sharp edges, and what is wrong with it.

use glam::Vec3;

use crate::TriMesh;
use crate::disjoint_sets::DisjointSets;
use crate::weld::weld_positions;

/// Marks a triangle that is left out: degenerate, a duplicate, or with an index or a coordinate
/// that means nothing.
pub const DROPPED: u32 = u32::MAX;

/// A welded view of a mesh. Triangle indices are the mesh's own; vertex indices are of the welded
/// vertices.
#[derive(Debug, Clone)]
pub struct WeldedSurface {
    /// Welded vertex of each of the mesh's vertices.
    pub weld: Vec<u32>,
    /// The welded vertices, in the order of their first appearance.
    pub positions: Vec<Vec3>,
    /// Welded corners of each triangle; `[DROPPED; 3]` where it is left out.
    pub triangles: Vec<[u32; 3]>,
    /// Of unit length, outward where the mesh is right; zero where the triangle is left out.
    pub face_normals: Vec<Vec3>,
    /// Weighted by the corner's angle (Thuermer and Wuethrich 1998); zero where faces cancel or
    /// none meet.
    pub normals: Vec<Vec3>,
    /// The triangles around vertex `v` are `around[starts[v]..starts[v + 1]]`.
    pub starts: Vec<u32>,
    /// Triangles, vertex by vertex, see `starts`.
    pub around: Vec<u32>,
    /// An edge at this vertex turns by more than the crease angle.
    pub sharp: Vec<bool>,
    /// The faults of the mesh.
    pub faults: MeshFaults,
}

/// The faults of a mesh, counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MeshFaults {
    /// Triangles with an index out of range or a coordinate that is not finite.
    pub broken: usize,
    /// Triangles without area.
    pub degenerate: usize,
    /// Triangles with the same three corners as an earlier one.
    pub duplicate: usize,
    /// Vertices at the position of an earlier one.
    pub welded: usize,
    /// Edges of one face only.
    pub boundary_edges: usize,
    /// Edges of more than two faces.
    pub crowded_edges: usize,
    /// Edges of two faces that run along them the same way: one of the two is inverted.
    pub inverted_edges: usize,
    /// Sets of triangles that hang together by their edges.
    pub shells: usize,
    /// The enclosed volume is negative: the whole mesh is inside out.
    pub inside_out: bool,
}

impl WeldedSurface {
    /// `crease` is in radians.
    pub fn new(mesh: &TriMesh, crease: f32) -> WeldedSurface {
        let mut faults = MeshFaults::default();
        let (weld, positions) = weld_positions(&mesh.positions);
        faults.welded = mesh.positions.len() - positions.len();
        let mut s = WeldedSurface {
            weld,
            positions,
            triangles: Vec::with_capacity(mesh.triangles.len()),
            face_normals: Vec::with_capacity(mesh.triangles.len()),
            normals: Vec::new(),
            starts: Vec::new(),
            around: Vec::new(),
            sharp: Vec::new(),
            faults,
        };
        let mut volume = 0.0f64;
        // Triangles without area but with three vertices: no wall, but part of the closed surface.
        let mut flat = Vec::new();
        for t in &mesh.triangles {
            let welded = t.map(|v| s.weld.get(v as usize).copied().unwrap_or(DROPPED));
            let mut keep = welded;
            let mut normal = Vec3::ZERO;
            if welded.contains(&DROPPED)
                || welded.iter().any(|&v| !s.positions[v as usize].is_finite())
            {
                s.faults.broken += 1;
                keep = [DROPPED; 3];
            } else {
                let [a, b, c] = welded.map(|v| s.positions[v as usize].as_dvec3());
                let cross = (b - a).cross(c - a);
                normal = cross.normalize_or_zero().as_vec3();
                if normal == Vec3::ZERO {
                    s.faults.degenerate += 1;
                    keep = [DROPPED; 3];
                    let [a, b, c] = welded;
                    if a != b && b != c && c != a {
                        flat.push(welded);
                    }
                }
                volume += a.dot(b.cross(c));
            }
            s.triangles.push(keep);
            s.face_normals.push(normal);
        }
        s.triangles_that_meet();
        s.drop_duplicates();
        s.find_normals();
        s.edges(crease);
        if !flat.is_empty() {
            s.count_edges_with(&flat);
        }
        s.faults.inside_out = volume < 0.0 && s.faults.boundary_edges == 0;
        s
    }

    /// The kept triangles at welded vertex `v`.
    pub fn around(&self, v: usize) -> &[u32] {
        &self.around[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    /// The positions of triangle `t`; `None` where it is left out.
    pub fn corners(&self, t: usize) -> Option<[Vec3; 3]> {
        let corners = self.triangles[t];
        (corners[0] != DROPPED).then(|| corners.map(|v| self.positions[v as usize]))
    }

    /// Returns the greatest rotation of each triangle by rounding, in radians; `grain` is the
    /// greatest error of a coordinate.
    pub fn tilts(&self, grain: f64) -> Vec<f32> {
        let one = |t: usize| {
            let Some([a, b, c]) = self.corners(t) else { return 1.0 };
            let long = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let twice = (b - a).cross(c - a).length();
            (4.0 * grain as f32 * long / twice).min(1.0)
        };
        (0..self.triangles.len()).map(one).collect()
    }

    /// Returns the greatest distance of triangle `t` from the curved surface that it approximates,
    /// from the difference between its normal and those at its corners that are not sharp.
    pub fn sagitta(&self, t: u32) -> f32 {
        let Some([a, b, c]) = self.corners(t as usize) else { return 0.0 };
        let own = self.face_normals[t as usize];
        let smooth = self.triangles[t as usize].into_iter().filter(|&v| !self.sharp[v as usize]);
        let one = |v: u32| {
            let n = self.normals[v as usize];
            let cos = own.dot(n).clamp(0.3, 1.0);
            let across = n - own * cos;
            // The sine of the angle, and the width of the triangle in the direction it bends in.
            let sin = across.length();
            if !(sin > 1e-6) {
                return 0.0;
            }
            let [a, b, c] = [a, b, c].map(|p| p.dot(across) / sin);
            0.5 * (a.max(b).max(c) - a.min(b).min(c)) * sin / cos
        };
        smooth.map(one).fold(0.0, f32::max)
    }

    /// A direction of the surface at welded vertex `v`, which turns with the part: that of an edge.
    pub fn along(&self, v: usize) -> Vec3 {
        let Some(&t) = self.around(v).first() else { return Vec3::ZERO };
        let corners = self.triangles[t as usize];
        let k = corners.iter().position(|&c| c as usize == v).unwrap_or(0);
        self.positions[corners[(k + 1) % 3] as usize] - self.positions[v]
    }

    /// Fills `starts` and `around` from the triangles.
    fn triangles_that_meet(&mut self) {
        let n = self.positions.len();
        let mut starts = vec![0u32; n + 1];
        let kept = |t: &&[u32; 3]| t[0] != DROPPED;
        for t in self.triangles.iter().filter(kept) {
            t.iter().for_each(|&v| starts[v as usize + 1] += 1);
        }
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut around = vec![0u32; starts[n] as usize];
        for (i, t) in self.triangles.iter().enumerate().filter(|(_, t)| t[0] != DROPPED) {
            for &v in t {
                around[next[v as usize] as usize] = i as u32;
                next[v as usize] += 1;
            }
        }
        (self.starts, self.around) = (starts, around);
    }

    /// Counts the edges' faults again, with the triangles without area: where one closes the gap
    /// between a long edge and two short ones, the surface is closed, though nothing is measured
    /// there.
    fn count_edges_with(&mut self, flat: &[[u32; 3]]) {
        let kept = self.triangles.iter().filter(|t| t[0] != DROPPED);
        let mut half_edges: Vec<(u32, u32, bool)> = kept
            .chain(flat)
            .flat_map(|t| {
                [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a.min(b), a.max(b), a < b))
            })
            .collect();
        half_edges.sort_unstable();
        let faults = &mut self.faults;
        (faults.boundary_edges, faults.crowded_edges, faults.inverted_edges) = (0, 0, 0);
        for edge in half_edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            match edge {
                [_] => faults.boundary_edges += 1,
                [a, b] => faults.inverted_edges += (a.2 == b.2) as usize,
                _ => faults.crowded_edges += 1,
            }
        }
    }

    /// Of triangles with the same three corners the first stays.
    fn drop_duplicates(&mut self) {
        let mut found = Vec::new();
        let mut fan: Vec<([u32; 3], u32)> = Vec::new();
        for v in 0..self.positions.len() {
            fan.clear();
            fan.extend(self.around(v).iter().filter_map(|&t| {
                let mut corners = self.triangles[t as usize];
                corners.sort_unstable();
                // Seen from its lowest corner only, so each pair is met once.
                (corners[0] as usize == v).then_some((corners, t))
            }));
            // Sorted, not compared each with each: thousands of triangles may share a vertex.
            fan.sort_unstable();
            for pair in fan.windows(2) {
                if pair[0].0 == pair[1].0 {
                    found.push(pair[1].1 as usize);
                }
            }
        }
        if found.is_empty() {
            return;
        }
        self.faults.duplicate = found.len();
        for t in found {
            self.triangles[t] = [DROPPED; 3];
            self.face_normals[t] = Vec3::ZERO;
        }
        self.triangles_that_meet();
    }

    fn find_normals(&mut self) {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for (t, corners) in self.triangles.iter().enumerate().filter(|(_, t)| t[0] != DROPPED) {
            let p = corners.map(|v| self.positions[v as usize]);
            for c in 0..3 {
                normals[corners[c] as usize] += self.face_normals[t] * corner_angle(p, c);
            }
        }
        self.normals = normals.into_iter().map(Vec3::normalize_or_zero).collect();
    }

    /// Sharp vertices, and the edges' faults.
    fn edges(&mut self, crease: f32) {
        let turn = crease.cos();
        let mut sharp = vec![false; self.positions.len()];
        let mut shells = DisjointSets::new(self.positions.len());
        // The edges at `v` that lead to a higher vertex: (other end, triangle, this triangle runs v
        // -> other).
        let mut out: Vec<(u32, u32, bool)> = Vec::new();
        for v in 0..self.positions.len() as u32 {
            out.clear();
            for &t in self.around(v as usize) {
                let c = self.triangles[t as usize];
                let k = c.iter().position(|&x| x == v).unwrap_or(0);
                let (next, last) = (c[(k + 1) % 3], c[(k + 2) % 3]);
                if next > v {
                    out.push((next, t, true));
                }
                if last > v {
                    out.push((last, t, false));
                }
            }
            out.sort_unstable();
            let mut i = 0;
            while i < out.len() {
                let end =
                    out[i..].iter().position(|e| e.0 != out[i].0).map_or(out.len(), |n| i + n);
                let other = out[i].0;
                shells.join(v, other);
                match &out[i..end] {
                    [_] => self.faults.boundary_edges += 1,
                    [(_, a, along), (_, b, against)] => {
                        self.faults.inverted_edges += (along == against) as usize;
                        let (a, b) =
                            (self.face_normals[*a as usize], self.face_normals[*b as usize]);
                        if a.dot(b) < turn {
                            sharp[v as usize] = true;
                            sharp[other as usize] = true;
                        }
                    }
                    _ => {
                        self.faults.crowded_edges += 1;
                        sharp[v as usize] = true;
                        sharp[other as usize] = true;
                    }
                }
                i = end;
            }
        }
        self.faults.shells = (0..self.positions.len())
            .filter(|&v| shells.root(v as u32) == v as u32 && !self.around(v).is_empty())
            .count();
        self.sharp = sharp;
    }

    /// One normal a corner: the mean of the faces around the vertex that turn from this one by less
    /// than `crease` (radians), weighted by their angles there. So a curved wall is smooth and an
    /// edge stays an edge.
    pub fn corner_normals(&self, crease: f32) -> Vec<[Vec3; 3]> {
        use rayon::prelude::*;
        let turn = crease.cos();
        let one = |t: usize| {
            let own = self.face_normals[t];
            if own == Vec3::ZERO {
                return [own; 3];
            }
            self.triangles[t].map(|v| {
                // Not only at sharp edges: about the tip of a cone no edge is sharp, and yet its
                // far side is another wall.
                let beside = |&u: &u32| self.face_normals[u as usize].dot(own) >= turn;
                if !self.sharp[v as usize] && self.around(v as usize).iter().all(beside) {
                    return self.normals[v as usize];
                }
                let mut sum = Vec3::ZERO;
                for &u in self.around(v as usize) {
                    let n = self.face_normals[u as usize];
                    if beside(&u) {
                        let corners = self.triangles[u as usize];
                        let k = corners.iter().position(|&x| x == v).unwrap_or(0);
                        sum += n * corner_angle(corners.map(|x| self.positions[x as usize]), k);
                    }
                }
                sum.normalize_or(own)
            })
        };
        (0..self.triangles.len()).into_par_iter().map(one).collect()
    }

    /// Vertices joined to `v` by an edge, each once, rising.
    pub fn neighbours(&self, v: usize, into: &mut Vec<u32>) {
        into.clear();
        for &t in self.around(v) {
            into.extend(self.triangles[t as usize].iter().filter(|&&u| u as usize != v));
        }
        into.sort_unstable();
        into.dedup();
    }
}

/// The angle at corner `c`, radians.
pub fn corner_angle(p: [Vec3; 3], c: usize) -> f32 {
    let (e, f) = (p[(c + 1) % 3] - p[c], p[(c + 2) % 3] - p[c]);
    e.cross(f).length().atan2(e.dot(f))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_without_area_keeps_the_surface_closed() {
        // A tetrahedron, one edge of which has a vertex in its middle on one side only: a flat
        // triangle closes the gap.
        let positions = vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0, Vec3::X];
        let mut triangles = vec![[0, 2, 4], [4, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 4, 1]];
        let faults = |triangles: &[[u32; 3]]| {
            let mesh = TriMesh {
                positions: positions.clone(),
                triangles: triangles.to_vec(),
                colours: None,
            };
            WeldedSurface::new(&mesh, 0.7).faults
        };
        let with = faults(&triangles);
        assert_eq!((with.degenerate, with.boundary_edges, with.inverted_edges), (1, 0, 0));
        triangles.pop();
        assert_eq!(faults(&triangles).boundary_edges, 3);
    }

    #[test]
    fn copies_at_a_crowded_vertex_are_found() {
        let n = 3000u32;
        let mut positions = vec![Vec3::Z];
        positions.extend((0..n).map(|i| {
            let (s, c) = (i as f32 * std::f32::consts::TAU / n as f32).sin_cos();
            Vec3::new(c, s, 0.0) * 100.0
        }));
        let mut triangles: Vec<[u32; 3]> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        triangles.extend([[2, 0, 1], [7, 8, 0]]);
        let mesh = TriMesh { positions, triangles, colours: None };
        let s = WeldedSurface::new(&mesh, 0.7);
        assert_eq!(s.faults.duplicate, 2);
        assert_eq!(s.triangles[n as usize..], [[DROPPED; 3]; 2]);
    }
}
