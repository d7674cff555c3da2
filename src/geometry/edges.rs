//! The edges of a flat polygon mesh, found by sorting: what checking, mending and subdividing
//! share.

use rayon::prelude::*;

use super::PolyMesh;

/// One side of a face: the edge from the corner's vertex to the next one's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    /// Lower vertex, higher vertex.
    pub ends: (u32, u32),
    /// Index into the mesh's `corners`.
    pub corner: u32,
}

/// All sides, grouped by edge (sorted by vertices, then by corner), and whose each corner is.
#[derive(Debug, Clone, Default)]
pub struct Edges {
    pub sides: Vec<Side>,
    /// The face of each corner.
    pub face_of: Vec<u32>,
}

impl Edges {
    /// Sides of no length (the same vertex twice in a row) are left out.
    pub fn of(mesh: &PolyMesh) -> Edges {
        let mut face_of = vec![0u32; mesh.corners.len()];
        let mut sides = Vec::with_capacity(mesh.corners.len());
        for (f, w) in mesh.face_starts.windows(2).enumerate() {
            for c in w[0]..w[1] {
                face_of[c as usize] = f as u32;
                let next = if c + 1 == w[1] { w[0] } else { c + 1 };
                let (a, b) = (mesh.corners[c as usize], mesh.corners[next as usize]);
                if a != b {
                    sides.push(Side { ends: (a.min(b), a.max(b)), corner: c });
                }
            }
        }
        sides.par_sort_unstable();
        Edges { sides, face_of }
    }

    /// The sides of each edge.
    pub fn each(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.ends == b.ends)
    }

    /// The corner after `corner` in its face.
    pub fn next(&self, mesh: &PolyMesh, corner: u32) -> u32 {
        let f = self.face_of[corner as usize] as usize;
        if corner + 1 == mesh.face_starts[f + 1] { mesh.face_starts[f] } else { corner + 1 }
    }
}

/// Disjoint sets with path halving; the lowest member speaks for its set, so that the outcome does
/// not depend on the order.
#[derive(Debug, Clone)]
pub struct Sets {
    parent: Vec<u32>,
    count: usize,
}

impl Sets {
    pub fn new(n: usize) -> Sets {
        Sets { parent: (0..n as u32).collect(), count: n }
    }

    pub fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let up = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = up;
            i = up;
        }
        i
    }

    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.count -= 1;
        }
    }

    /// Sets left.
    pub fn count(&self) -> usize {
        self.count
    }
}
