//! A tree of boxes over triangles: finds pairs that may meet, and triangles that a line may cross.
//! In double precision, unlike [`crate::bvh`], whose documentation explains why both exist.

use glam::DVec3;

use crate::job::{Cancelled, Job};

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    /// The least coordinates.
    pub lo: DVec3,
    /// The largest coordinates.
    pub hi: DVec3,
}

impl Span {
    /// The box of nothing.
    pub const EMPTY: Span = Span { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    /// The least box around the points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Span {
        points.into_iter().fold(Span::EMPTY, |s, p| Span { lo: s.lo.min(p), hi: s.hi.max(p) })
    }

    /// The least box around both.
    pub fn join(self, o: Span) -> Span {
        Span { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Returns true if the boxes have a point in common.
    pub fn meets(&self, o: &Span) -> bool {
        self.lo.cmple(o.hi).all() && o.lo.cmple(self.hi).all()
    }

    /// The box, larger by a length on every side.
    pub fn grown(self, by: f64) -> Span {
        Span { lo: self.lo - by, hi: self.hi + by }
    }
}

#[derive(Debug, Clone, Copy)]
struct SpanNode {
    span: Span,
    /// Inner: index of the second child (the first follows its parent). Leaf: first item.
    at: u32,
    /// 0 for inner nodes, else items in the leaf.
    count: u32,
}

/// Median splits along the longest side; four items a leaf.
#[derive(Debug, Clone, Default)]
pub struct SpanTree {
    nodes: Vec<SpanNode>,
    items: Vec<u32>,
}

const LEAF: usize = 4;
/// Below this many items a branch is built on the same thread.
const FORK: usize = 8192;

impl SpanTree {
    /// Builds the tree over one box an item.
    pub fn build(spans: &[Span], job: &Job) -> Result<SpanTree, Cancelled> {
        let mut items: Vec<(u32, DVec3)> =
            spans.iter().enumerate().map(|(i, s)| (i as u32, s.lo + s.hi)).collect();
        let nodes = if items.is_empty() { Vec::new() } else { branch(&mut items, 0, spans, job) };
        job.check()?;
        Ok(SpanTree { nodes, items: items.into_iter().map(|(i, _)| i).collect() })
    }

    /// Calls `f(item of self, item of other)` for all pairs whose boxes, grown by `slack`, meet.
    pub fn pairs(
        &self,
        own: &[Span],
        other: &SpanTree,
        others: &[Span],
        slack: f64,
        job: &Job,
        mut f: impl FnMut(u32, u32),
    ) -> Result<(), Cancelled> {
        if self.nodes.is_empty() || other.nodes.is_empty() {
            return Ok(());
        }
        let mut stack = vec![(0u32, 0u32)];
        let mut steps = 0u32;
        while let Some((i, j)) = stack.pop() {
            steps = steps.wrapping_add(1);
            if steps % 65_536 == 0 {
                job.check()?;
            }
            let (a, b) = (self.nodes[i as usize], other.nodes[j as usize]);
            if !a.span.grown(slack).meets(&b.span) {
                continue;
            }
            if a.count > 0 && b.count > 0 {
                for &x in &self.items[a.at as usize..(a.at + a.count) as usize] {
                    let s = own[x as usize].grown(slack);
                    for &y in &other.items[b.at as usize..(b.at + b.count) as usize] {
                        if s.meets(&others[y as usize]) {
                            f(x, y);
                        }
                    }
                }
                continue;
            }
            let size = |n: &SpanNode| (n.span.hi - n.span.lo).element_sum();
            if b.count > 0 || (a.count == 0 && size(&a) >= size(&b)) {
                stack.extend([(i + 1, j), (a.at, j)]);
            } else {
                stack.extend([(i, j + 1), (i, b.at)]);
            }
        }
        Ok(())
    }

    /// Calls `f` for items whose leaf's box meets `span`.
    pub fn each_meets(&self, span: &Span, mut f: impl FnMut(u32)) {
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![0u32] };
        while let Some(i) = stack.pop() {
            let n = self.nodes[i as usize];
            if !n.span.meets(span) {
                continue;
            }
            if n.count == 0 {
                stack.extend([i + 1, n.at]);
            } else {
                self.items[n.at as usize..(n.at + n.count) as usize].iter().for_each(|&x| f(x));
            }
        }
    }

    /// Whether `f` holds for an item whose leaf's box meets `span`.
    pub fn any_meets(&self, span: &Span, f: impl Fn(u32) -> bool) -> bool {
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![0u32] };
        while let Some(i) = stack.pop() {
            let n = self.nodes[i as usize];
            if !n.span.meets(span) {
                continue;
            }
            if n.count == 0 {
                stack.extend([i + 1, n.at]);
            } else if self.items[n.at as usize..(n.at + n.count) as usize].iter().any(|&x| f(x)) {
                return true;
            }
        }
        false
    }

    /// Calls `f` for items whose leaf's box the segment from `o` to `p` may cross; stops when it
    /// returns false.
    pub fn along(&self, o: DVec3, p: DVec3, mut f: impl FnMut(u32) -> bool) {
        let inverse = 1.0 / (p - o);
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![0u32] };
        while let Some(i) = stack.pop() {
            let n = self.nodes[i as usize];
            let (a, b) = ((n.span.lo - o) * inverse, (n.span.hi - o) * inverse);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            if near.max(0.0) > far.min(1.0) + 1e-9 {
                continue;
            }
            if n.count == 0 {
                stack.extend([i + 1, n.at]);
            } else {
                for &x in &self.items[n.at as usize..(n.at + n.count) as usize] {
                    if !f(x) {
                        return;
                    }
                }
            }
        }
    }
}

/// Nodes of a branch, indices from `base` on of the whole tree's items, child indices relative to
/// the branch's root. A cancelled job leaves branches out.
fn branch(items: &mut [TreeItem], first: u32, spans: &[Span], job: &Job) -> Vec<SpanNode> {
    if items.len() <= FORK {
        let mut out = Vec::with_capacity(items.len());
        small_branch(items, first, spans, &mut out);
        return out;
    }
    let span = span_of(items, spans);
    if job.cancelled() {
        return vec![SpanNode { span, at: first, count: items.len() as u32 }];
    }
    let (l, r) = halves(items);
    let second = first + l.len() as u32;
    let (l, r) = rayon::join(|| branch(l, first, spans, job), || branch(r, second, spans, job));
    let mut out = Vec::with_capacity(1 + l.len() + r.len());
    let (one, two) = (1, 1 + l.len() as u32);
    out.push(SpanNode { span, at: two, count: 0 });
    let shifted = |by: u32| {
        move |n: SpanNode| SpanNode { at: if n.count == 0 { n.at + by } else { n.at }, ..n }
    };
    out.extend(l.into_iter().map(shifted(one)));
    out.extend(r.into_iter().map(shifted(two)));
    out
}

/// Appends the nodes of a branch to those of a tree.
fn small_branch(items: &mut [TreeItem], first: u32, spans: &[Span], out: &mut Vec<SpanNode>) {
    let (span, own) = (span_of(items, spans), out.len());
    if items.len() <= LEAF {
        out.push(SpanNode { span, at: first, count: items.len() as u32 });
        return;
    }
    out.push(SpanNode { span, at: 0, count: 0 });
    let (l, r) = halves(items);
    let second = first + l.len() as u32;
    small_branch(l, first, spans, out);
    out[own].at = out.len() as u32;
    small_branch(r, second, spans, out);
}

/// An item, and the middle of its box.
type TreeItem = (u32, DVec3);

fn span_of(items: &[TreeItem], spans: &[Span]) -> Span {
    items.iter().fold(Span::EMPTY, |s, i| s.join(spans[i.0 as usize]))
}

/// Divides the items at the median along the side in which they spread most.
fn halves(items: &mut [TreeItem]) -> (&mut [TreeItem], &mut [TreeItem]) {
    let c = Span::of(items.iter().map(|i| i.1));
    let d = c.hi - c.lo;
    let axis = if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    };
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| a.1[axis].total_cmp(&b.1[axis]).then(a.0.cmp(&b.0)));
    items.split_at_mut(half)
}
