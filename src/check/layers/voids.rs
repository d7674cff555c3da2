//! The voids of a sweep: which parts of the surface border the same void, and how much it holds.

use glam::DVec3;
use sculptd_geometry::disjoint_sets::DisjointSets;

use super::plate::{OUTSIDE, PlateContact};
use crate::part::{PreparedPart, Standing};

/// The voids as sets of vertices and regions of the plate, with the lowest member of each.
pub(super) struct Voids {
    pub sets: DisjointSets,
    next: Vec<u32>,
    tail: Vec<u32>,
    pub low: Vec<f64>,
    /// The cup of each node, or none.
    pub cup: Vec<u32>,
    /// The height at which each cup opened, and its first member.
    pub opened: Vec<Option<f64>>,
    slack: f64,
}

/// No node, no cup.
pub(super) const NONE: u32 = u32::MAX;

impl Voids {
    pub fn new(nodes: usize, slack: f64) -> Voids {
        Voids {
            sets: DisjointSets::new(nodes),
            next: vec![NONE; nodes],
            tail: (0..nodes as u32).collect(),
            low: vec![f64::INFINITY; nodes],
            cup: vec![NONE; nodes],
            opened: Vec::new(),
            slack,
        }
    }

    /// Makes one void of those of `a` and `b`, at this height.
    pub fn join(&mut self, a: u32, b: u32, height: f64) {
        let (a, b) = (self.sets.root(a), self.sets.root(b));
        if a == b {
            return;
        }
        let (keep, gone) = (a.min(b), a.max(b));
        if keep == OUTSIDE {
            if height - self.low[gone as usize] > self.slack {
                self.close(gone, Some(height));
            }
        } else {
            self.next[self.tail[keep as usize] as usize] = gone;
            self.tail[keep as usize] = self.tail[gone as usize];
            self.low[keep as usize] = self.low[keep as usize].min(self.low[gone as usize]);
        }
        self.sets.join(a, b);
    }

    /// Names all members of the void of `root` as one cup.
    pub fn close(&mut self, root: u32, opens: Option<f64>) {
        let number = self.opened.len() as u32;
        self.opened.push(opens);
        let mut at = root;
        while at != NONE {
            self.cup[at as usize] = number;
            at = self.next[at as usize];
        }
    }
}

/// Volume and first moment.
#[derive(Clone, Copy, Default)]
pub(super) struct VoidSum {
    pub volume: f64,
    pub moment: DVec3,
}

/// The volume of each cup up to the height at which it opens, by the divergence theorem: the sum
/// over its surface of the depth below that height, times the surface's area in the plan.
pub(super) fn measured(
    part: &PreparedPart,
    stand: &Standing,
    voids: &Voids,
    node: impl Fn(u32) -> u32,
    contact: &PlateContact,
) -> Vec<VoidSum> {
    let mut sums = vec![VoidSum::default(); voids.opened.len()];
    if sums.is_empty() {
        return sums;
    }
    let names = &part.topology().triangles;
    for t in 0..names.len() as u32 {
        let Some(corners) = part.corners(t) else { continue };
        let cup = voids.cup[node(t) as usize];
        if cup == NONE || contact.triangles[t as usize] {
            continue;
        }
        let rise = part.normals[t as usize].dot(stand.up);
        let open = voids.opened[cup as usize];
        let level = open.unwrap_or(stand.plate);
        let height = |p: DVec3| p.dot(stand.up);
        let mut polygon: Vec<DVec3> = corners.to_vec();
        if open.is_some() {
            polygon = below_level(&polygon, level, stand.up);
        }
        let sum = &mut sums[cup as usize];
        for i in 1..polygon.len().saturating_sub(1) {
            let [a, b, c] = [polygon[0], polygon[i], polygon[i + 1]];
            let plan = (b - a).cross(c - a).length() * 0.5 * rise;
            // Exact for polynomials of degree two: the middles of the sides.
            for m in [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5] {
                let (z, weight) = (height(m), plan / 3.0);
                sum.volume += (level - z) * weight;
                let across = m - stand.up * z;
                let up = (level * level - z * z) * 0.5;
                sum.moment += (across * (level - z) + stand.up * up) * weight;
            }
        }
    }
    sums
}

/// The cup that each triangle borders, or [`NONE`]; empty where there are no cups.
pub(super) fn walls(
    part: &PreparedPart,
    voids: &Voids,
    node: impl Fn(u32) -> u32,
    contact: &PlateContact,
) -> Vec<u32> {
    if voids.opened.is_empty() {
        return Vec::new();
    }
    let cup = |t: u32| match part.corners(t) {
        Some(_) if !contact.triangles[t as usize] => voids.cup[node(t) as usize],
        _ => NONE,
    };
    (0..part.triangles() as u32).map(cup).collect()
}

/// The part of a convex polygon below a height.
fn below_level(polygon: &[DVec3], level: f64, up: DVec3) -> Vec<DVec3> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let (h, k) = (a.dot(up) - level, b.dot(up) - level);
        if h <= 0.0 {
            out.push(a);
        }
        if (h < 0.0 && k > 0.0) || (h > 0.0 && k < 0.0) {
            out.push(a + (b - a) * (h / (h - k)));
        }
    }
    out
}
