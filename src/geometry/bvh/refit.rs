//! The tree follows triangles that moved: their leaves and the boxes above them, nothing else.

use glam::Vec3;

use super::build::PAD;
use super::{Bvh8, LEAF, NO_TRIANGLE};
use crate::TriMesh;

/// The parent of each triangle, leaf and node; made once for a tree that is to follow its mesh.
#[derive(Debug, Clone)]
pub struct Parents {
    /// Leaf of each triangle; `u32::MAX` where the triangle was left out.
    leaf_of: Vec<u32>,
    /// Node and lane above each leaf.
    above_leaf: Vec<(u32, u8)>,
    /// Node and lane above each node; of the root, itself.
    above_node: Vec<(u32, u8)>,
    stamped: Vec<bool>,
}

impl Bvh8 {
    /// `triangles` is the number of triangles of the mesh.
    pub fn parents(&self, triangles: usize) -> Parents {
        let mut p = Parents {
            leaf_of: vec![u32::MAX; triangles],
            above_leaf: vec![(0, 0); self.packs.len()],
            above_node: vec![(0, 0); self.nodes.len()],
            stamped: vec![false; self.nodes.len()],
        };
        for (i, pack) in self.packs.iter().enumerate() {
            for &t in pack.id.iter().filter(|t| **t != NO_TRIANGLE) {
                p.leaf_of[t as usize] = i as u32;
            }
        }
        for (i, node) in self.nodes.iter().enumerate() {
            for lane in (0..8).filter(|&l| node.planes[0][l] <= node.planes[3][l]) {
                let child = node.child[lane];
                let above = (i as u32, lane as u8);
                if child & LEAF != 0 {
                    p.above_leaf[(child & !LEAF) as usize] = above;
                } else {
                    p.above_node[child as usize] = above;
                }
            }
        }
        p
    }

    /// Updates the tree to the corners of `moved` triangles. Rays then return the same hits as in a
    /// rebuilt tree.
    pub fn refit(&mut self, mesh: &TriMesh, moved: &[u32], parents: &mut Parents) {
        let mut leaves: Vec<u32> =
            moved.iter().map(|&t| parents.leaf_of[t as usize]).filter(|&l| l != u32::MAX).collect();
        leaves.sort_unstable();
        leaves.dedup();
        let mut boxes = Vec::with_capacity(leaves.len());
        for &leaf in &leaves {
            let pack = &mut self.packs[leaf as usize];
            let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for lane in 0..4 {
                if pack.id[lane] == NO_TRIANGLE {
                    continue;
                }
                for (c, p) in mesh.corners(pack.id[lane] as usize).into_iter().enumerate() {
                    for axis in 0..3 {
                        pack.v[c][axis][lane] = p[axis];
                    }
                    (lo, hi) = (lo.min(p), hi.max(p));
                }
            }
            self.bounds = (self.bounds.0.min(lo), self.bounds.1.max(hi));
            boxes.push((lo, hi));
        }
        let pad = Vec3::splat(self.bounds.0.abs().max(self.bounds.1.abs()).max_element() * PAD);
        let mut touched = Vec::new();
        for (&leaf, (lo, hi)) in leaves.iter().zip(boxes) {
            let (node, lane) = parents.above_leaf[leaf as usize];
            self.put(node, lane, lo - pad, hi + pad);
            let mut at = node;
            while !std::mem::replace(&mut parents.stamped[at as usize], true) {
                touched.push(at);
                at = parents.above_node[at as usize].0;
            }
        }
        // Children come after their parents: from the last to the first, every box is ready when it
        // is asked for.
        touched.sort_unstable_by(|a, b| b.cmp(a));
        for at in touched {
            parents.stamped[at as usize] = false;
            if at == 0 {
                continue;
            }
            let planes = &self.nodes[at as usize].planes;
            let low = |axis: usize| planes[axis].iter().copied().fold(f32::INFINITY, f32::min);
            let high =
                |axis: usize| planes[3 + axis].iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let (lo, hi) =
                (Vec3::new(low(0), low(1), low(2)), Vec3::new(high(0), high(1), high(2)));
            let (node, lane) = parents.above_node[at as usize];
            self.put(node, lane, lo, hi);
        }
    }

    fn put(&mut self, node: u32, lane: u8, lo: Vec3, hi: Vec3) {
        let planes = &mut self.nodes[node as usize].planes;
        for axis in 0..3 {
            planes[axis][lane as usize] = lo[axis];
            planes[3 + axis][lane as usize] = hi[axis];
        }
    }
}
