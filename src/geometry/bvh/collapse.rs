//! From the binary tree to a plan of the wide one: which binary nodes become children of which wide
//! node, and which subtrees become leaves, so that the expected cost of a ray is the least (Ylitie,
//! Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", 2017,
//! section 3.1).
//!
//! `cost(n, i)` is the least cost of the subtree of `n` cut into at most `i` wide roots. Opening
//! the largest child until a node is full, the simple way, leaves the lowest nodes half empty: four
//! children of eight on average.

use obvhs::bvh2::Bvh2;

/// A wide node's width, and the most triangles of a leaf.
const WIDTH: usize = 8;
const LEAF_MAX: u32 = 4;

/// The cheapest way to collapse a binary node.
#[derive(Debug, Clone, Copy, Default)]
struct CollapseChoice {
    /// The least cost with at most 1 to 7 roots.
    cost: [f32; WIDTH - 1],
    /// With at most 2 to 8 roots: how many of them are the left child's; 0: one root fewer is no
    /// worse.
    left: [u8; WIDTH - 1],
    /// Triangles below, and whether one root is a leaf.
    count: u32,
    leaf: bool,
}

/// The plan for each binary node.
pub(super) struct CollapsePlan<'a> {
    binary: &'a Bvh2,
    choices: Vec<CollapseChoice>,
}

impl<'a> CollapsePlan<'a> {
    /// `within`: how many triangles, at most four, a box has that the binary tree was built from.
    pub fn new(binary: &'a Bvh2, within: impl Fn(u32) -> u32) -> CollapsePlan<'a> {
        let nodes = &binary.nodes;
        let mut plan =
            CollapsePlan { binary, choices: vec![CollapseChoice::default(); nodes.len()] };
        // Parents before children, then backwards.
        let mut order = Vec::with_capacity(nodes.len());
        order.push(0u32);
        let mut next = 0;
        while let Some(&n) = order.get(next) {
            next += 1;
            let node = &nodes[n as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
        }
        for &n in order.iter().rev() {
            plan.choices[n as usize] = plan.choose(n as usize, &within);
        }
        plan
    }

    fn choose(&self, n: usize, within: &impl Fn(u32) -> u32) -> CollapseChoice {
        let node = &self.binary.nodes[n];
        let area = node.aabb().half_area();
        // A leaf costs what a node costs; with half or three times as much the trees are as fast.
        let as_leaf = area;
        if node.is_leaf() {
            let first = node.first_index as usize;
            let boxes = &self.binary.primitive_indices[first..first + node.prim_count as usize];
            return CollapseChoice {
                cost: [as_leaf; 7],
                left: [0; 7],
                count: boxes.iter().map(|&i| within(i)).sum(),
                leaf: true,
            };
        }
        let (l, r) = (
            &self.choices[node.first_index as usize],
            &self.choices[node.first_index as usize + 1],
        );
        let mut out = CollapseChoice { count: l.count + r.count, ..CollapseChoice::default() };
        if out.count <= LEAF_MAX {
            return CollapseChoice {
                cost: [as_leaf; 7],
                left: [0; 7],
                count: out.count,
                leaf: true,
            };
        }
        // With exactly 2 to 8 roots.
        let mut spread = [f32::INFINITY; WIDTH - 1];
        for roots in 2..=WIDTH {
            for k in 1..roots {
                let cost = l.cost[k - 1] + r.cost[roots - k - 1];
                if cost < spread[roots - 2] {
                    spread[roots - 2] = cost;
                    out.left[roots - 2] = k as u8;
                }
            }
        }
        let inner = area + spread[WIDTH - 2];
        out.cost[0] = inner;
        for roots in 2..WIDTH {
            out.cost[roots - 1] = spread[roots - 2];
            if out.cost[roots - 2] <= spread[roots - 2] {
                out.cost[roots - 1] = out.cost[roots - 2];
                out.left[roots - 2] = 0;
            }
        }
        out
    }

    /// Whether `n`, as one root, is a leaf.
    pub fn is_leaf(&self, n: usize) -> bool {
        self.choices[n].leaf
    }

    /// Returns the children of the wide node that `n` becomes, and their number.
    pub fn children(&self, n: usize) -> ([usize; WIDTH], usize) {
        let (mut out, mut count) = ([0; WIDTH], 0);
        if self.is_leaf(n) {
            out[0] = n;
            return (out, 1);
        }
        // (binary node, roots it may become).
        let mut todo = [(0usize, 0usize); WIDTH];
        let mut top = 0;
        let put =
            |todo: &mut [(usize, usize); WIDTH], top: &mut usize, from: usize, roots: usize| {
                let k = self.choices[from].left[roots - 2] as usize;
                let first = self.binary.nodes[from].first_index as usize;
                todo[*top] = (first + 1, roots - k);
                todo[*top + 1] = (first, k);
                *top += 2;
            };
        put(&mut todo, &mut top, n, WIDTH);
        while top > 0 {
            top -= 1;
            let (at, mut roots) = todo[top];
            while roots > 1 && self.choices[at].left[roots - 2] == 0 {
                roots -= 1;
            }
            if roots == 1 {
                out[count] = at;
                count += 1;
            } else {
                put(&mut todo, &mut top, at, roots);
            }
        }
        (out, count)
    }

    /// The boxes, by place in the list the binary tree was built from, of a leaf; at most four.
    pub fn boxes(&self, n: usize) -> ([u32; LEAF_MAX as usize], usize) {
        let (mut out, mut count) = ([0; LEAF_MAX as usize], 0);
        let mut todo = [0usize; LEAF_MAX as usize + 1];
        todo[0] = n;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node = &self.binary.nodes[todo[top]];
            let first = node.first_index as usize;
            if node.is_leaf() {
                for &t in &self.binary.primitive_indices[first..first + node.prim_count as usize] {
                    if count < out.len() {
                        out[count] = t;
                        count += 1;
                    }
                }
            } else {
                todo[top] = first + 1;
                todo[top + 1] = first;
                top += 2;
            }
        }
        (out, count)
    }
}
