//! Union-find: which elements hang together.
//!
//! Tarjan, "Efficiency of a good but not linear set union algorithm", 1975, with path halving
//! (Tarjan and van Leeuwen, "Worst-case analysis of set union algorithms", 1984). The union is not
//! by size: the lowest member is the root of its set, so that the outcome does not depend on the
//! order of the unions.

/// Disjoint sets over the elements `0..n`. Initially each element is a separate set.
///
/// ```
/// use sculptd_geometry::disjoint_sets::DisjointSets;
///
/// let mut sets = DisjointSets::new(4);
/// sets.join(3, 1);
/// sets.join(1, 2);
/// assert_eq!((sets.root(3), sets.root(0)), (1, 0));
/// assert_eq!(sets.count(), 2);
/// ```
#[derive(Debug, Clone)]
pub struct DisjointSets {
    parent: Vec<u32>,
    count: usize,
}

impl DisjointSets {
    /// `n` sets of one element each; `n` is below 2^32.
    pub fn new(n: usize) -> DisjointSets {
        DisjointSets { parent: (0..n as u32).collect(), count: n }
    }

    /// The lowest member of the set of `i`. Panics if `i` is not below `n`.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let up = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = up;
            i = up;
        }
        i
    }

    /// Makes one set of those of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.count -= 1;
        }
    }

    /// The number of sets that are left.
    pub fn count(&self) -> usize {
        self.count
    }
}
