//! The edges of a flat polygon mesh, found by sorting its half-edges at each
//! vertex: what checking, repair,
//! decimation and subdivision share.

use super::PolyMesh;

/// A half-edge: the side of a face from a corner's vertex to the next corner's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct HalfEdge {
    /// Lower vertex, higher vertex.
    pub ends: (u32, u32),
    /// Index into the mesh's `corners`.
    pub corner: u32,
}

/// All half-edges, grouped by edge, and the face of each corner.
#[derive(Debug, Clone, Default)]
pub struct EdgeTable {
    /// Sorted by [`HalfEdge::ends`], then by corner.
    pub half_edges: Vec<HalfEdge>,
    /// The face of each corner.
    pub face_of: Vec<u32>,
}

impl EdgeTable {
    /// Finds the edges of `mesh`. Half-edges of no length (the same vertex twice in a row) are left
    /// out.
    pub fn of(mesh: &PolyMesh) -> EdgeTable {
        let mut face_of = vec![0u32; mesh.corners.len()];
        // By the lower vertex: counted, then filled, then the few at each vertex are sorted.
        let vertices = mesh.corners.iter().max().map_or(0, |&v| v as usize + 1);
        let mut starts = vec![0u32; vertices + 1];
        each_half_edge(mesh, |a, b, c, face| {
            face_of[c as usize] = face as u32;
            starts[a.min(b) as usize + 1] += u32::from(a != b);
        });
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut half_edges = vec![HalfEdge { ends: (0, 0), corner: 0 }; starts[vertices] as usize];
        let mut next = starts.clone();
        each_half_edge(mesh, |a, b, corner, _| {
            if a != b {
                let at = &mut next[a.min(b) as usize];
                half_edges[*at as usize] = HalfEdge { ends: (a.min(b), a.max(b)), corner };
                *at += 1;
            }
        });
        let mut rest = &mut half_edges[..];
        for w in starts.windows(2) {
            let own;
            (own, rest) = rest.split_at_mut((w[1] - w[0]) as usize);
            own.sort_unstable();
        }
        EdgeTable { half_edges, face_of }
    }

    /// The half-edges of each edge: two where a surface is closed and manifold.
    pub fn each(&self) -> impl Iterator<Item = &[HalfEdge]> {
        self.half_edges.chunk_by(|a, b| a.ends == b.ends)
    }

    /// The corner after `corner` in its face.
    pub fn next(&self, mesh: &PolyMesh, corner: u32) -> u32 {
        let f = self.face_of[corner as usize] as usize;
        if corner + 1 == mesh.face_starts[f + 1] { mesh.face_starts[f] } else { corner + 1 }
    }
}

/// Calls `f(vertex, next vertex, corner, face)` for each corner of each face.
fn each_half_edge(mesh: &PolyMesh, mut f: impl FnMut(u32, u32, u32, usize)) {
    for (face, w) in mesh.face_starts.windows(2).enumerate() {
        let own = &mesh.corners[w[0] as usize..w[1] as usize];
        for (k, &a) in own.iter().enumerate() {
            let b = own[if k + 1 == own.len() { 0 } else { k + 1 }];
            f(a, b, w[0] + k as u32, face);
        }
    }
}
