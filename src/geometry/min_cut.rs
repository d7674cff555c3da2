//! The minimum cut of a graph with two terminals, by augmenting paths from two search trees that
//! are kept between augmentations (Boykov and Kolmogorov 2004, "An experimental comparison of
//! min-cut/max-flow algorithms for energy minimization in vision").
//!
//! Capacities are whole numbers, so the cut is exact and the same everywhere.

use std::collections::VecDeque;

use crate::job::{Cancelled, Job};

/// No arc.
const NONE: u32 = u32::MAX;
/// The node hangs on its terminal.
const TERMINAL: u32 = u32::MAX - 1;
/// The node lost its parent.
const ORPHAN: u32 = u32::MAX - 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tree {
    Free,
    Source,
    Sink,
}

#[derive(Debug, Clone, Copy)]
struct Arc {
    to: u32,
    left: i64,
}

/// A graph whose nodes each have a pull to the source or to the sink, and whose neighbours are held
/// together by edges.
#[derive(Debug)]
pub struct CutGraph {
    /// The arcs of node `n` are `starts[n]..starts[n + 1]` of `order`.
    starts: Vec<u32>,
    order: Vec<u32>,
    /// Arc `a` and its reverse `a ^ 1`.
    arcs: Vec<Arc>,
    /// The rest of the pull: above 0 to the source, below 0 to the sink.
    pull: Vec<i64>,
    tree: Vec<Tree>,
    /// The arc from a node to its parent.
    parent: Vec<u32>,
    /// The time of the last exact distance of a node from its terminal, and that distance.
    seen: Vec<u32>,
    distance: Vec<u32>,
    active: VecDeque<u32>,
    is_active: Vec<bool>,
    orphans: VecDeque<u32>,
    now: u32,
}

impl CutGraph {
    /// Makes a graph of `pull.len()` nodes. `pull` is above 0 for a node that belongs to the source
    /// and below 0 for one that belongs to the sink: the cost of the opposite. An edge
    /// `(a, b, weight)` costs `weight`, at least 0, where its ends are parted.
    ///
    /// The sum of all weights and pulls must be below 2^62.
    pub fn new(pull: Vec<i64>, edges: &[(u32, u32, i64)]) -> CutGraph {
        let n = pull.len();
        let mut starts = vec![0u32; n + 1];
        for &(a, b, _) in edges {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut order = vec![0u32; 2 * edges.len()];
        let mut arcs = Vec::with_capacity(2 * edges.len());
        for &(a, b, weight) in edges {
            for (from, to) in [(a, b), (b, a)] {
                let slot = &mut next[from as usize];
                order[*slot as usize] = arcs.len() as u32;
                *slot += 1;
                arcs.push(Arc { to, left: weight });
            }
        }
        CutGraph {
            starts,
            order,
            arcs,
            tree: vec![Tree::Free; n],
            parent: vec![NONE; n],
            seen: vec![0; n],
            distance: vec![0; n],
            active: VecDeque::new(),
            is_active: vec![false; n],
            orphans: VecDeque::new(),
            now: 0,
            pull,
        }
    }

    /// Cuts at the least cost. Returns for each node whether it is on the source's side; of several
    /// such cuts the one with the fewest nodes there.
    pub fn cut(mut self, job: &Job) -> Result<Vec<bool>, Cancelled> {
        for n in 0..self.pull.len() as u32 {
            let i = n as usize;
            self.tree[i] = match self.pull[i] {
                0 => continue,
                1.. => Tree::Source,
                _ => Tree::Sink,
            };
            self.parent[i] = TERMINAL;
            self.distance[i] = 1;
            self.wake(n);
        }
        while let Some(n) = self.active.pop_front() {
            job.check()?;
            self.is_active[n as usize] = false;
            while self.parent[n as usize] != NONE {
                let Some(middle) = self.grow(n) else { break };
                self.now += 1;
                self.augment(middle);
                while let Some(orphan) = self.orphans.pop_front() {
                    self.adopt(orphan);
                }
            }
        }
        Ok(self.tree.iter().map(|t| *t == Tree::Source).collect())
    }

    fn wake(&mut self, n: u32) {
        if !std::mem::replace(&mut self.is_active[n as usize], true) {
            self.active.push_back(n);
        }
    }

    /// Returns true if flow fits into arc `a` of a node of `tree`: away from the source, or towards
    /// the sink.
    fn open(&self, tree: Tree, a: u32) -> bool {
        let a = if tree == Tree::Source { a } else { a ^ 1 };
        self.arcs[a as usize].left > 0
    }

    fn arcs_of(&self, n: u32) -> std::ops::Range<u32> {
        self.starts[n as usize]..self.starts[n as usize + 1]
    }

    /// Takes free neighbours into the node's tree. Returns the arc, from the source's tree to the
    /// sink's, at which the trees meet.
    fn grow(&mut self, n: u32) -> Option<u32> {
        let tree = self.tree[n as usize];
        for slot in self.arcs_of(n) {
            let a = self.order[slot as usize];
            if !self.open(tree, a) {
                continue;
            }
            let to = self.arcs[a as usize].to;
            let i = to as usize;
            if self.tree[i] == Tree::Free {
                self.tree[i] = tree;
                self.parent[i] = a ^ 1;
                self.seen[i] = self.seen[n as usize];
                self.distance[i] = self.distance[n as usize] + 1;
                self.wake(to);
            } else if self.tree[i] != tree {
                return Some(if tree == Tree::Source { a } else { a ^ 1 });
            } else if self.seen[i] <= self.seen[n as usize]
                && self.distance[i] > self.distance[n as usize] + 1
            {
                self.parent[i] = a ^ 1;
                self.seen[i] = self.seen[n as usize];
                self.distance[i] = self.distance[n as usize] + 1;
            }
        }
        None
    }

    /// Calls `visit` with each arc of the path from a node to its terminal, and returns the node
    /// that hangs on it.
    fn walk(&mut self, mut n: u32, mut visit: impl FnMut(&mut CutGraph, u32, u32)) -> u32 {
        while self.parent[n as usize] != TERMINAL {
            let a = self.parent[n as usize];
            let next = self.arcs[a as usize].to;
            visit(self, n, a);
            n = next;
        }
        n
    }

    /// Sends as much as fits from the source through arc `middle` to the sink.
    fn augment(&mut self, middle: u32) {
        let (from, to) = (self.arcs[middle as usize ^ 1].to, self.arcs[middle as usize].to);
        let mut most = self.arcs[middle as usize].left;
        // On the source's side flow runs against the arcs to the parents, on the sink's along them.
        let root = self.walk(from, |g, _, a| most = most.min(g.arcs[a as usize ^ 1].left));
        most = most.min(self.pull[root as usize]);
        let root = self.walk(to, |g, _, a| most = most.min(g.arcs[a as usize].left));
        most = most.min(-self.pull[root as usize]);
        self.push_flow(middle, most);
        let root = self.walk(from, |g, n, a| {
            g.push_flow(a ^ 1, most);
            if g.arcs[a as usize ^ 1].left == 0 {
                g.lose(n);
            }
        });
        self.pull[root as usize] -= most;
        if self.pull[root as usize] == 0 {
            self.lose(root);
        }
        let root = self.walk(to, |g, n, a| {
            g.push_flow(a, most);
            if g.arcs[a as usize].left == 0 {
                g.lose(n);
            }
        });
        self.pull[root as usize] += most;
        if self.pull[root as usize] == 0 {
            self.lose(root);
        }
    }

    fn push_flow(&mut self, a: u32, flow: i64) {
        self.arcs[a as usize].left -= flow;
        self.arcs[a as usize ^ 1].left += flow;
    }

    fn lose(&mut self, n: u32) {
        self.parent[n as usize] = ORPHAN;
        self.orphans.push_back(n);
    }

    /// The distance of a node from its terminal; `None` where an orphan is on the way.
    fn distance_to_terminal(&mut self, from: u32) -> Option<u32> {
        let (mut n, mut steps) = (from, 0);
        let distance = loop {
            let i = n as usize;
            if self.seen[i] == self.now && self.parent[i] != ORPHAN {
                break steps + self.distance[i];
            }
            match self.parent[i] {
                NONE | ORPHAN => return None,
                TERMINAL => {
                    (self.seen[i], self.distance[i]) = (self.now, 1);
                    break steps + 1;
                }
                a => n = self.arcs[a as usize].to,
            }
            steps += 1;
        };
        let (mut n, mut left) = (from, distance);
        while self.seen[n as usize] != self.now {
            (self.seen[n as usize], self.distance[n as usize]) = (self.now, left);
            left -= 1;
            n = self.arcs[self.parent[n as usize] as usize].to;
        }
        Some(distance)
    }

    /// Finds a new parent for an orphan, or sets it and what hangs on it free.
    fn adopt(&mut self, orphan: u32) {
        let tree = self.tree[orphan as usize];
        let mut best: Option<(u32, u32)> = None;
        for slot in self.arcs_of(orphan) {
            let a = self.order[slot as usize];
            let to = self.arcs[a as usize].to;
            if self.tree[to as usize] != tree || !self.open(tree, a ^ 1) {
                continue;
            }
            if let Some(distance) = self.distance_to_terminal(to)
                && best.is_none_or(|b| distance < b.0)
            {
                best = Some((distance, a));
            }
        }
        let i = orphan as usize;
        if let Some((distance, a)) = best {
            self.parent[i] = a;
            (self.seen[i], self.distance[i]) = (self.now, distance + 1);
            return;
        }
        for slot in self.arcs_of(orphan) {
            let a = self.order[slot as usize];
            let to = self.arcs[a as usize].to;
            if self.tree[to as usize] != tree || self.parent[to as usize] == NONE {
                continue;
            }
            if self.open(tree, a ^ 1) {
                self.wake(to);
            }
            if self.parent[to as usize] == a ^ 1 {
                self.lose(to);
            }
        }
        self.tree[i] = Tree::Free;
        self.parent[i] = NONE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cost(pull: &[i64], edges: &[(u32, u32, i64)], source: impl Fn(usize) -> bool) -> i64 {
        let own = pull.iter().enumerate().map(|(n, p)| match source(n) {
            true => (-p).max(0),
            false => (*p).max(0),
        });
        let parted = edges.iter().filter(|e| source(e.0 as usize) != source(e.1 as usize));
        own.sum::<i64>() + parted.map(|e| e.2).sum::<i64>()
    }

    proptest! {
        #[test]
        fn no_other_division_costs_less_and_none_as_cheap_is_smaller(
            pull in proptest::collection::vec(-9i64..=9, 1..10),
            ends in proptest::collection::vec((0u32..10, 0u32..10, 0i64..7), 0..24),
        ) {
            let n = pull.len();
            let edges: Vec<_> = ends
                .into_iter()
                .map(|(a, b, w)| (a % n as u32, b % n as u32, w))
                .filter(|e| e.0 != e.1)
                .collect();
            let found = CutGraph::new(pull.clone(), &edges).cut(&Job::default());
            let found = found.expect("not cancelled");
            let paid = cost(&pull, &edges, |i| found[i]);
            let size = found.iter().filter(|s| **s).count() as u32;
            for other in 0u32..1 << n {
                let its = cost(&pull, &edges, |i| other >> i & 1 == 1);
                prop_assert!(its > paid || its == paid && other.count_ones() >= size);
            }
        }
    }
}
