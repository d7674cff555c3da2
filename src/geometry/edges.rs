//! The edges of a flat polygon mesh, found by sorting its half-edges: what checking, repair,
//! decimation and subdivision share.

use rayon::prelude::*;

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
        let mut half_edges = Vec::with_capacity(mesh.corners.len());
        for (f, w) in mesh.face_starts.windows(2).enumerate() {
            for c in w[0]..w[1] {
                face_of[c as usize] = f as u32;
                let next = if c + 1 == w[1] { w[0] } else { c + 1 };
                let (a, b) = (mesh.corners[c as usize], mesh.corners[next as usize]);
                if a != b {
                    half_edges.push(HalfEdge { ends: (a.min(b), a.max(b)), corner: c });
                }
            }
        }
        half_edges.par_sort_unstable();
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
