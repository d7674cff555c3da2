//! What a mesh is: counts, topology, size, and whether it crosses itself.

use serde::Serialize;

use super::disjoint_sets::DisjointSets;
use super::edges::EdgeTable;
use super::{Aabb, PolyMesh, fans};
use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// The facts of a mesh, as `sculptd info --json` prints them. Lengths are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshReport {
    /// All vertices, including any that no face uses.
    pub vertices: usize,
    /// Polygons, including those without area.
    pub faces: usize,
    /// After cutting polygons into triangles.
    pub triangles: usize,
    /// Sets of faces connected by at least a vertex.
    pub components: usize,
    /// True if there is an edge and every edge is used by exactly two faces, in opposite
    /// directions.
    pub closed: bool,
    /// No edge has more than two faces, and the faces around each vertex form one fan.
    pub manifold: bool,
    /// No edge is used twice in the same direction.
    pub oriented: bool,
    /// Used vertices - edges + faces.
    pub euler: i64,
    /// Handles of all components together; of a closed manifold only.
    pub genus: Option<i64>,
    /// Of the vertices that faces use.
    pub bounds: Aabb,
    /// Of a closed mesh; negative if it is inside out.
    pub volume: Option<f64>,
    /// The sum of the triangles' areas.
    pub area: f64,
    /// Pairs of triangles that cross, beyond the vertices and edges that they share. `None` if not
    /// asked for.
    pub self_intersections: Option<usize>,
    /// Triangles that have a part in such a pair.
    pub crossed_triangles: Option<usize>,
    /// Edges with one face.
    pub boundary_edges: usize,
    /// Edges with more than two faces.
    pub nonmanifold_edges: usize,
    /// Edges with two faces that run along it in the same direction.
    pub misoriented_edges: usize,
    /// Faces with the same vertex twice or without area.
    pub degenerate_faces: usize,
    /// Vertices that no face uses.
    pub unused_vertices: usize,
}

/// Looks at everything; `crossings`: also for triangles that cross, the slowest part.
/// Sums run in double precision around the middle of the box, in the order of the faces.
pub fn report(mesh: &PolyMesh, crossings: bool, job: &Job) -> Result<MeshReport, Cancelled> {
    let topology = topology(mesh, job)?;
    job.check()?;
    job.progress(0.3);
    let mut used = vec![false; mesh.positions.len()];
    for &c in &mesh.corners {
        used[c as usize] = true;
    }
    let in_use = used.iter().filter(|&&u| u).count();
    let counted = mesh.positions.iter().zip(&used).filter(|(_, u)| **u || in_use == 0);
    let bounds = Aabb::of(counted.map(|(p, _)| *p));
    let (triangles, of) = mesh.triangles();
    let middle = bounds.centre();
    let (mut area, mut volume) = (0.0, 0.0);
    let mut degenerate = vec![false; mesh.face_count()];
    let mut face_area = 0.0;
    for (t, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|v| mesh.positions[v as usize] - middle);
        let normal = (b - a).cross(c - a);
        let twice = normal.length();
        area += twice / 2.0;
        volume += a.dot(b.cross(c)) / 6.0;
        face_area += twice;
        let [i, j, k] = *corners;
        if i == j || j == k || k == i {
            degenerate[of[t] as usize] = true;
        }
        if of.get(t + 1) != Some(&of[t]) {
            degenerate[of[t] as usize] |= face_area == 0.0;
            face_area = 0.0;
        }
    }
    job.check()?;
    job.progress(0.5);
    let faces = mesh.face_count();
    let EdgeFacts { boundary, nonmanifold, misoriented, count, fans, parts } = topology;
    let closed = faces > 0 && boundary == 0 && nonmanifold == 0 && misoriented == 0;
    let manifold = nonmanifold == 0 && fans == in_use;
    let euler = in_use as i64 - count + faces as i64;
    let components = parts - (mesh.positions.len() - in_use);
    let crossed = if crossings {
        Some(self_intersection::count(&mesh.positions, &triangles, job)?)
    } else {
        None
    };
    Ok(MeshReport {
        vertices: mesh.positions.len(),
        faces,
        triangles: triangles.len(),
        components,
        closed,
        manifold,
        oriented: misoriented == 0,
        euler,
        genus: (closed && manifold).then_some((2 * components as i64 - euler) / 2),
        bounds,
        volume: closed.then_some(volume),
        area,
        self_intersections: crossed.map(|c| c.pairs),
        crossed_triangles: crossed.map(|c| c.triangles),
        boundary_edges: boundary,
        nonmanifold_edges: nonmanifold,
        misoriented_edges: misoriented,
        degenerate_faces: degenerate.iter().filter(|&&d| d).count(),
        unused_vertices: mesh.positions.len() - in_use,
    })
}

/// The facts derived from the edges.
struct EdgeFacts {
    boundary: usize,
    nonmanifold: usize,
    misoriented: usize,
    /// All edges.
    count: i64,
    /// Sets of corners of a vertex that faces with a common edge join.
    fans: usize,
    /// Sets of vertices that edges join; a vertex without a face is one.
    parts: usize,
}

fn topology(mesh: &PolyMesh, job: &Job) -> Result<EdgeFacts, Cancelled> {
    let mut together = DisjointSets::new(mesh.positions.len());
    // Nearly every mesh is a closed manifold, which is the faster test.
    if let Some(degrees) = fans::degrees(mesh, mesh.positions.len(), job)? {
        for f in mesh.faces() {
            f.windows(2).for_each(|w| together.join(w[0], w[1]));
        }
        return Ok(EdgeFacts {
            boundary: 0,
            nonmanifold: 0,
            misoriented: 0,
            count: mesh.corners.len() as i64 / 2,
            fans: degrees.iter().filter(|&&d| d > 0).count(),
            parts: together.count(),
        });
    }
    let edges = EdgeTable::of(mesh);
    job.check()?;
    let (mut boundary, mut nonmanifold, mut misoriented, mut count) = (0, 0, 0, 0i64);
    // The corners of a vertex that faces with a common edge join: one set a fan.
    let mut fans = DisjointSets::new(mesh.corners.len());
    for half_edges in edges.each() {
        count += 1;
        let first = half_edges[0];
        let vertex = |corner: u32| mesh.corners[corner as usize];
        together.join(first.ends.0, first.ends.1);
        match *half_edges {
            [_] => boundary += 1,
            [a, b] => {
                let (a2, b2) = (edges.next(mesh, a.corner), edges.next(mesh, b.corner));
                if vertex(a.corner) == vertex(b.corner) {
                    misoriented += 1;
                    fans.join(a.corner, b.corner);
                    fans.join(a2, b2);
                } else {
                    fans.join(a.corner, b2);
                    fans.join(a2, b.corner);
                }
            }
            _ => nonmanifold += 1,
        }
    }
    job.check()?;
    // Corners of sides without length belong to their neighbours' fan.
    for f in mesh.face_starts.windows(2) {
        for c in f[0]..f[1] {
            let next = if c + 1 == f[1] { f[0] } else { c + 1 };
            if mesh.corners[c as usize] == mesh.corners[next as usize] {
                fans.join(c, next);
            }
        }
    }
    let (fans, parts) = (fans.count(), together.count());
    Ok(EdgeFacts { boundary, nonmanifold, misoriented, count, fans, parts })
}
