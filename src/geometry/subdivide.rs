//! Subdivision surfaces: one level makes every face smaller and the surface rounder. Loop's scheme
//! for triangles ("Smooth subdivision surfaces based on triangles", 1987) and Catmull and Clark's
//! for polygons ("Recursively generated B-spline surfaces on arbitrary topological meshes", 1978).
//!
//! Borders are smoothed as curves of their own (a border edge's vertex at its middle, a border
//! vertex at 1/8, 3/4, 1/8), so that two meshes that share a border still do afterwards. Vertices
//! whose faces form no single fan stay where they are. Each new position is summed in the order of
//! the faces: the result does not depend on anything but the mesh.

use glam::DVec3;

use super::PolyMesh;
use super::edges::EdgeTable;
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;

/// More corners than this are not made: 2^31.
pub const MAX_CORNERS: u64 = 1 << 31;

/// The surroundings of each vertex, for both schemes.
struct VertexSurroundings {
    /// The edge of each corner's side.
    edge_of: Vec<u32>,
    ends: Vec<(u32, u32)>,
    /// Faces of each edge.
    uses: Vec<u32>,
    /// Per vertex: border edges, and the sum of the other ends of those.
    border: Vec<(u32, DVec3)>,
    /// Per vertex: edges, and the sum of all other ends.
    ring: Vec<(u32, DVec3)>,
    /// Per vertex: faces.
    faces: Vec<u32>,
    /// Per vertex: an edge with more than two faces ends here.
    fixed: Vec<bool>,
}

impl VertexSurroundings {
    fn of(mesh: &PolyMesh, job: &Job) -> Result<VertexSurroundings, Cancelled> {
        let edges = EdgeTable::of(mesh);
        job.check()?;
        let n = mesh.positions.len();
        let mut a = VertexSurroundings {
            edge_of: vec![u32::MAX; mesh.corners.len()],
            ends: Vec::new(),
            uses: Vec::new(),
            border: vec![(0, DVec3::ZERO); n],
            ring: vec![(0, DVec3::ZERO); n],
            faces: vec![0; n],
            fixed: vec![false; n],
        };
        for half_edges in edges.each() {
            let id = a.ends.len() as u32;
            look(id as usize, job)?;
            let (u, v) = half_edges[0].ends;
            for s in half_edges {
                a.edge_of[s.corner as usize] = id;
            }
            a.ends.push((u, v));
            a.uses.push(half_edges.len() as u32);
            for (from, to) in [(u, v), (v, u)] {
                let p = mesh.positions[to as usize];
                let ring = &mut a.ring[from as usize];
                *ring = (ring.0 + 1, ring.1 + p);
                match half_edges.len() {
                    1 => {
                        let b = &mut a.border[from as usize];
                        *b = (b.0 + 1, b.1 + p);
                    }
                    2 => {}
                    _ => a.fixed[from as usize] = true,
                }
            }
        }
        for &c in &mesh.corners {
            a.faces[c as usize] += 1;
        }
        Ok(a)
    }

    fn rule(&self, v: usize) -> VertexRule {
        match self.border[v].0 {
            _ if self.fixed[v] || self.ring[v].0 == 0 => VertexRule::Stays,
            0 if self.ring[v].0 == self.faces[v] => VertexRule::Inside,
            2 if self.ring[v].0 == self.faces[v] + 1 => VertexRule::Border,
            _ => VertexRule::Stays,
        }
    }

    /// The new place of a vertex on a border, or of one that stays; `None` for one inside.
    fn special(&self, mesh: &PolyMesh, v: usize) -> Option<DVec3> {
        let p = mesh.positions[v];
        match self.rule(v) {
            VertexRule::Inside => None,
            VertexRule::Border => Some(p * 0.75 + self.border[v].1 * 0.125),
            VertexRule::Stays => Some(p),
        }
    }
}

/// The rule for a vertex's new position.
#[derive(Clone, Copy, PartialEq, Eq)]
enum VertexRule {
    Inside,
    Border,
    Stays,
}

/// Loop's weight of each of `k` neighbours.
fn beta(k: f64) -> f64 {
    let c = 0.375 + (std::f64::consts::TAU / k).portable_cos() / 4.0;
    (0.625 - c * c) / k
}

/// One level of Loop's scheme as what it is, a linear map: which old vertices each new one is made
/// of, and how much of each. The rows sum to 1; the old vertices come first, then one for each
/// edge, as in what [`loop_`] makes of a triangle mesh.
#[derive(Debug, Clone)]
pub struct Stencils {
    old: usize,
    starts: Vec<u32>,
    from: Vec<u32>,
    weight: Vec<f64>,
}

/// Looks at the job now and then.
fn look(i: usize, job: &Job) -> Result<(), Cancelled> {
    if i.is_multiple_of(1 << 14) { job.check() } else { Ok(()) }
}

/// Returns the two ends of each edge, in the order of the new vertices that [`loop_`] makes.
///
/// # Errors
/// Returns an error if the job was cancelled.
pub fn edge_ends(mesh: &PolyMesh, job: &Job) -> Result<Vec<(u32, u32)>, Cancelled> {
    Ok(VertexSurroundings::of(mesh, job)?.ends)
}

impl Stencils {
    /// Of a mesh of triangles.
    ///
    /// # Errors
    /// Returns an error if the job was cancelled.
    pub fn of(mesh: &PolyMesh, job: &Job) -> Result<Stencils, Cancelled> {
        let around = VertexSurroundings::of(mesh, job)?;
        let n = mesh.positions.len();
        let mut rows: Vec<(u32, u32, f64)> = Vec::with_capacity(n * 7 + around.ends.len() * 4);
        for v in 0..n {
            let own = match around.rule(v) {
                VertexRule::Stays => 1.0,
                VertexRule::Border => 0.75,
                VertexRule::Inside => {
                    let k = f64::from(around.ring[v].0);
                    1.0 - k * beta(k)
                }
            };
            rows.push((v as u32, v as u32, own));
        }
        for (e, &(u, v)) in around.ends.iter().enumerate() {
            for (to, from) in [(u, v), (v, u)] {
                match around.rule(to as usize) {
                    VertexRule::Stays => {}
                    VertexRule::Border if around.uses[e] != 1 => {}
                    VertexRule::Border => rows.push((to, from, 0.125)),
                    VertexRule::Inside => {
                        rows.push((to, from, beta(f64::from(around.ring[to as usize].0))))
                    }
                }
            }
            let own = if around.uses[e] == 2 { 0.375 } else { 0.5 };
            rows.extend([(n as u32 + e as u32, u, own), (n as u32 + e as u32, v, own)]);
        }
        for c in 0..mesh.corners.len() {
            let e = around.edge_of[c];
            if e != u32::MAX && around.uses[e as usize] == 2 {
                rows.push((n as u32 + e, mesh.corners[c - c % 3 + (c + 2) % 3], 0.125));
            }
        }
        job.check()?;
        // By row, and in it as they were found: the sort is stable.
        rows.sort_by_key(|r| r.0);
        let mut starts = Vec::with_capacity(n + around.ends.len() + 1);
        for (i, r) in rows.iter().enumerate() {
            while starts.len() <= r.0 as usize {
                starts.push(i as u32);
            }
        }
        starts.push(rows.len() as u32);
        Ok(Stencils {
            old: n,
            starts,
            from: rows.iter().map(|r| r.1).collect(),
            weight: rows.iter().map(|r| r.2).collect(),
        })
    }

    fn row(&self, f: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[f] as usize..self.starts[f + 1] as usize;
        self.from[range.clone()].iter().map(|&v| v as usize).zip(self.weight[range].iter().copied())
    }

    /// Returns the displacement of the old vertices that moves the new ones as near to `wanted` as
    /// least squares permit, after `rounds` of simultaneous iteration (each correction is divided
    /// by the weights: Gilbert 1972). An old vertex stays if no new vertex that it influences is to
    /// move.
    pub fn fit(&self, wanted: &[DVec3], rounds: usize, job: &Job) -> Result<Vec<DVec3>, Cancelled> {
        let (mut shares, mut free) = (vec![0.0; self.old], vec![false; self.old]);
        for (f, goal) in wanted.iter().enumerate() {
            self.row(f).for_each(|(v, w)| shares[v] += w);
            if *goal != DVec3::ZERO {
                self.row(f).for_each(|(v, _)| free[v] = true);
            }
        }
        let mut by = vec![DVec3::ZERO; self.old];
        for _ in 0..rounds {
            job.check()?;
            let mut sums = vec![DVec3::ZERO; self.old];
            for (f, goal) in wanted.iter().enumerate() {
                let short = self.row(f).fold(*goal, |d, (v, w)| d - by[v] * w);
                if short != DVec3::ZERO {
                    self.row(f).for_each(|(v, w)| sums[v] += short * w);
                }
            }
            for v in (0..self.old).filter(|v| free[*v]) {
                by[v] += sums[v] / shares[v];
            }
        }
        Ok(by)
    }
}

fn mix(colours: &[[u8; 4]], of: &[u32]) -> [u8; 4] {
    let mut sum = [0u32; 4];
    for &v in of {
        for (s, c) in sum.iter_mut().zip(colours[v as usize]) {
            *s += c as u32;
        }
    }
    let n = of.len().max(1) as u32;
    sum.map(|s| ((s + n / 2) / n) as u8)
}

/// Loop's scheme (1987) on the mesh's triangles (polygons are cut first): four triangles for each.
pub fn loop_(mesh: &PolyMesh, levels: u32, job: &Job) -> Result<PolyMesh, Cancelled> {
    let (triangles, of) = mesh.triangles();
    let mut now = PolyMesh {
        face_starts: (0..=of.len() as u32).map(|t| t * 3).collect(),
        corners: triangles.into_iter().flatten().collect(),
        groups: mesh.groups.as_ref().map(|g| of.iter().map(|&f| g[f as usize]).collect()),
        positions: mesh.positions.clone(),
        colours: mesh.colours.clone(),
        attributes: None,
    };
    for _ in 0..levels {
        job.check()?;
        now = loop_once(&now, job)?;
    }
    Ok(now)
}

fn loop_once(mesh: &PolyMesh, job: &Job) -> Result<PolyMesh, Cancelled> {
    let around = VertexSurroundings::of(mesh, job)?;
    let n = mesh.positions.len();
    let mut out = PolyMesh::new();
    out.positions.reserve_exact(n + around.ends.len());
    for v in 0..n {
        look(v, job)?;
        let p = around.special(mesh, v).unwrap_or_else(|| {
            let (k, sum) = around.ring[v];
            let k = k as f64;
            let beta = beta(k);
            mesh.positions[v] * (1.0 - k * beta) + sum * beta
        });
        out.positions.push(p);
    }
    // The corners opposite an edge.
    let mut opposite = vec![DVec3::ZERO; around.ends.len()];
    for c in 0..mesh.corners.len() {
        let e = around.edge_of[c];
        if e != u32::MAX {
            let third = c - c % 3 + (c + 2) % 3;
            opposite[e as usize] += mesh.positions[mesh.corners[third] as usize];
        }
    }
    for (e, &(u, v)) in around.ends.iter().enumerate() {
        let sum = mesh.positions[u as usize] + mesh.positions[v as usize];
        let inside = around.uses[e] == 2;
        out.positions.push(if inside { sum * 0.375 + opposite[e] * 0.125 } else { sum * 0.5 });
    }
    for t in 0..mesh.corners.len() / 3 {
        look(t, job)?;
        let v = [0, 1, 2].map(|i| mesh.corners[t * 3 + i]);
        // A side without length has no middle but its end.
        let m = [0, 1, 2].map(|i| match around.edge_of[t * 3 + i] {
            u32::MAX => v[i],
            e => n as u32 + e,
        });
        for f in [[v[0], m[0], m[2]], [m[0], v[1], m[1]], [m[2], m[1], v[2]], m] {
            out.push_face(&f);
        }
    }
    out.colours = mesh.colours.as_ref().map(|c| {
        let middles = around.ends.iter().map(|&(u, v)| mix(c, &[u, v]));
        c.iter().copied().chain(middles).collect()
    });
    out.groups = mesh.groups.as_ref().map(|g| g.iter().flat_map(|&g| [g; 4]).collect());
    Ok(out)
}

/// Catmull and Clark's scheme (1978): a quadrilateral for each corner of each polygon.
pub fn catmull_clark(mesh: &PolyMesh, levels: u32, job: &Job) -> Result<PolyMesh, Cancelled> {
    let mut now = mesh.clone();
    for _ in 0..levels {
        job.check()?;
        now = catmull_clark_once(&now, job)?;
    }
    Ok(now)
}

fn catmull_clark_once(mesh: &PolyMesh, job: &Job) -> Result<PolyMesh, Cancelled> {
    let around = VertexSurroundings::of(mesh, job)?;
    let (n, edges) = (mesh.positions.len(), around.ends.len());
    let centres: Vec<DVec3> = mesh
        .faces()
        .map(|f| f.iter().map(|&v| mesh.positions[v as usize]).sum::<DVec3>() / f.len() as f64)
        .collect();
    // Sums of the centres of the faces around each vertex and each edge.
    let mut by_vertex = vec![DVec3::ZERO; n];
    let mut by_edge = vec![DVec3::ZERO; edges];
    for f in 0..mesh.face_count() {
        for c in mesh.face_starts[f] as usize..mesh.face_starts[f + 1] as usize {
            by_vertex[mesh.corners[c] as usize] += centres[f];
            if around.edge_of[c] != u32::MAX {
                by_edge[around.edge_of[c] as usize] += centres[f];
            }
        }
    }
    let mut out = PolyMesh::new();
    out.positions.reserve_exact(n + edges + centres.len());
    for v in 0..n {
        look(v, job)?;
        let p = around.special(mesh, v).unwrap_or_else(|| {
            let (k, sum) = around.ring[v];
            let k = k as f64;
            let p = mesh.positions[v];
            // Mean of the faces' centres, twice the mean of the edges' middles, and k - 3 times the
            // old place.
            let (faces, middles) = (by_vertex[v] / k, (sum / k + p) / 2.0);
            (faces + middles * 2.0 + p * (k - 3.0)) / k
        });
        out.positions.push(p);
    }
    for (e, &(u, v)) in around.ends.iter().enumerate() {
        let sum = mesh.positions[u as usize] + mesh.positions[v as usize];
        out.positions.push(if around.uses[e] == 2 { (sum + by_edge[e]) / 4.0 } else { sum / 2.0 });
    }
    out.positions.extend_from_slice(&centres);
    let mut groups = mesh.groups.as_ref().map(|_| Vec::with_capacity(mesh.corners.len()));
    for f in 0..mesh.face_count() {
        let (start, end) = (mesh.face_starts[f] as usize, mesh.face_starts[f + 1] as usize);
        for c in start..end {
            let before = if c == start { end - 1 } else { c - 1 };
            let own = mesh.corners[c];
            let middle = |corner: usize| match around.edge_of[corner] {
                u32::MAX => own,
                e => n as u32 + e,
            };
            out.push_face(&[own, middle(c), (n + edges + f) as u32, middle(before)]);
            if let (Some(new), Some(old)) = (&mut groups, &mesh.groups) {
                new.push(old[f]);
            }
        }
    }
    out.groups = groups;
    out.colours = mesh.colours.as_ref().map(|c| {
        let middles = around.ends.iter().map(|&(u, v)| mix(c, &[u, v]));
        c.iter().copied().chain(middles).chain(mesh.faces().map(|f| mix(c, f))).collect()
    });
    Ok(out)
}

/// Returns the number of corners after this many levels, to check before memory is allocated.
pub fn corners_after(mesh: &PolyMesh, levels: u32) -> u64 {
    (mesh.corners.len() as u64 * 3).saturating_mul(4u64.saturating_pow(levels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::report;
    use crate::shapes::{cuboid, grid, torus};

    #[test]
    fn a_cube_becomes_the_known_smooth_body() {
        let job = Job::default();
        let cube = cuboid(DVec3::splat(-1.0), DVec3::ONE);
        let once = catmull_clark(&cube, 1, &job).unwrap();
        assert_eq!((once.positions.len(), once.face_count()), (26, 24));
        // By hand: a corner goes to (Q + 2R + 0)/3 with Q = 1/3 of the corner, R = 2/3 of it; an
        // edge's vertex to 3/4.
        assert!((once.positions[7] - DVec3::splat(5.0 / 9.0)).length() < 1e-15);
        assert!(once.positions[8..20].iter().all(|p| (p.abs().max_element() - 0.75).abs() < 1e-15));
        let fine = report(&catmull_clark(&cube, 4, &job).unwrap(), false, &job).unwrap();
        assert!(fine.closed && fine.manifold && fine.genus == Some(0) && fine.faces == 6 * 256);
        let smooth = report(&loop_(&torus(3., 1., 12, 8), 3, &job).unwrap(), false, &job).unwrap();
        assert!(smooth.closed && smooth.manifold && smooth.genus == Some(1));
        assert!(smooth.faces == 12 * 8 * 2 * 64 && smooth.volume.unwrap() > 0.0);
    }

    #[test]
    fn the_linear_map_is_the_scheme_and_the_fit_is_its_inverse() {
        let job = Job::default();
        for mesh in [torus(3.0, 1.0, 12, 8), grid(2.0, 2.0, 5, 4)] {
            let mesh = mesh.triangulate().0.to_poly();
            let fine = loop_(&mesh, 1, &job).unwrap();
            let map = Stencils::of(&mesh, &job).unwrap();
            for (f, p) in fine.positions.iter().enumerate() {
                let q = map.row(f).fold(DVec3::ZERO, |q, (v, w)| q + mesh.positions[v] * w);
                assert!(
                    (q - *p).length() < 1e-14
                        && (map.row(f).map(|r| r.1).sum::<f64>() - 1.0).abs() < 1e-14
                );
            }
            // The fit recovers displacements that coarse vertices can produce.
            let by = |v: usize| DVec3::new((v as f64).sin(), 0.3, (v as f64 * 0.7).cos());
            let wanted: Vec<_> = (0..fine.positions.len())
                .map(|f| map.row(f).fold(DVec3::ZERO, |q, (v, w)| q + by(v) * w))
                .collect();
            let found = map.fit(&wanted, 300, &job).unwrap();
            let worst = (0..map.old).map(|v| (found[v] - by(v)).length()).fold(0.0, f64::max);
            assert!(worst < 1e-4, "{worst}");
            assert!(
                map.fit(&vec![DVec3::ZERO; wanted.len()], 3, &job)
                    .unwrap()
                    .iter()
                    .all(|b| *b == DVec3::ZERO)
            );
        }
    }

    #[test]
    fn a_flat_sheet_stays_flat_and_keeps_its_border_straight() {
        let job = Job::default();
        let sheet = grid(2.0, 2.0, 3, 3);
        for fine in [loop_(&sheet, 2, &job).unwrap(), catmull_clark(&sheet, 2, &job).unwrap()] {
            assert!(fine.positions.iter().all(|p| p.z == 0.0 && p.abs().max_element() <= 1.0));
            let edge = fine.positions.iter().filter(|p| p.x == -1.0).count();
            // Of 13 on that side: the corner, which is rounded off, and what is within its reach
            // are not on the line.
            assert_eq!(edge, 7);
            let r = report(&fine, true, &job).unwrap();
            assert_eq!((r.self_intersections, r.oriented, r.manifold), (Some(0), true, true));
        }
    }
}
