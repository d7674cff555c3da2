//! Which triangles become quads: a matching of the triangles across edges that are no lines, good
//! quads first, then as many as there can be (Edmonds, "Paths, trees, and flowers", 1965; for quads
//! Remacle et al., "Blossom-Quad", 2012). On a closed surface without creases every triangle finds
//! a partner: its dual graph is cubic and has no bridge (Petersen 1891).

use std::collections::VecDeque;

use glam::DVec3;

use super::surface::{EditSurface, GONE};
use crate::job::{Cancelled, Job};

/// Triangles that one search for a partner looks at, at most.
const SEARCH: usize = 6000;

/// Returns the squareness of the quad with these corners: 1 for right angles, 0 if a corner is
/// straight or degenerate, below 0 if it is reflex or turned against `up`, which has unit length.
pub(super) fn squareness(corners: [DVec3; 4], up: DVec3) -> f64 {
    let mut worst = 1.0f64;
    for k in 0..4 {
        let p = corners[k];
        let to = (corners[(k + 1) % 4] - p).normalize_or_zero();
        let from = (corners[(k + 3) % 4] - p).normalize_or_zero();
        let turn = to.cross(from).dot(up);
        worst = worst.min(if turn > 0.0 { 1.0 - to.dot(from).abs() } else { turn - 1e-3 });
    }
    worst
}

/// Pairs of triangles (`partner[t]`, or [`GONE`]). `s` is compact.
pub(super) fn pair(s: &EditSurface, job: &Job) -> Result<Vec<u32>, Cancelled> {
    let mut across: Vec<Vec<u32>> = vec![Vec::new(); s.triangles.len()];
    let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
    for (a, b) in s.edges() {
        let [t, u] = s.sides(a, b);
        if u == GONE || s.is_line(a, b) {
            continue;
        }
        pairs.push((score(s, t, u, a, b), t.min(u), t.max(u)));
    }
    pairs.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let mut partner = vec![GONE; s.triangles.len()];
    for &(score, t, u) in &pairs {
        across[t as usize].push(u);
        across[u as usize].push(t);
        if score > 0.0 && partner[t as usize] == GONE && partner[u as usize] == GONE {
            partner[t as usize] = u;
            partner[u as usize] = t;
        }
    }
    let mut search = PartnerSearch::new(across, partner);
    for t in 0..s.triangles.len() as u32 {
        if t % 64 == 0 {
            job.check()?;
        }
        if search.partner[t as usize] == GONE {
            search.augment(t);
        }
    }
    Ok(search.partner)
}

/// Returns the quality of the quad across the edge.
fn score(s: &EditSurface, t: u32, u: u32, a: u32, b: u32) -> f64 {
    let up = (s.normal(t) + s.normal(u)).normalize_or_zero();
    let tri = s.triangles[t as usize];
    let forward = (0..3).any(|k| tri[k] == a && tri[(k + 1) % 3] == b);
    let (a, b) = if forward { (a, b) } else { (b, a) };
    let corners = [a, s.opposite(u, a, b), b, s.opposite(t, a, b)];
    squareness(corners.map(|v| s.positions[v as usize]), up)
}

/// The quads of the pairs and the triangles that are left, counter-clockwise; of a triangle the
/// last corner is [`GONE`].
pub(super) fn faces(s: &EditSurface, partner: &[u32]) -> Vec<[u32; 4]> {
    let mut out = Vec::with_capacity(partner.len());
    for (t, &u) in partner.iter().enumerate() {
        let [a, b, c] = s.triangles[t];
        if u == GONE {
            out.push([a, b, c, GONE]);
        } else if (t as u32) < u {
            let other = s.triangles[u as usize];
            let k = (0..3).find(|&k| !other.contains(&s.triangles[t][k])).unwrap_or(0);
            let [x, y, z] = [0, 1, 2].map(|i| s.triangles[t][(k + i) % 3]);
            out.push([x, y, s.opposite(u, y, z), z]);
        }
    }
    out
}

/// Breadth-first search for an alternating path, with blossoms shrunk to their bases.
struct PartnerSearch {
    across: Vec<Vec<u32>>,
    partner: Vec<u32>,
    parent: Vec<u32>,
    base: Vec<u32>,
    even: Vec<bool>,
    in_blossom: Vec<bool>,
    touched: Vec<u32>,
}

impl PartnerSearch {
    fn new(across: Vec<Vec<u32>>, partner: Vec<u32>) -> PartnerSearch {
        let n = across.len();
        PartnerSearch {
            across,
            partner,
            parent: vec![GONE; n],
            base: (0..n as u32).collect(),
            even: vec![false; n],
            in_blossom: vec![false; n],
            touched: Vec::new(),
        }
    }

    fn augment(&mut self, root: u32) {
        let mut end = self.path_from(root);
        while end != GONE {
            let before = self.parent[end as usize];
            let next = self.partner[before as usize];
            self.partner[end as usize] = before;
            self.partner[before as usize] = end;
            end = next;
        }
        for t in std::mem::take(&mut self.touched) {
            let t = t as usize;
            self.parent[t] = GONE;
            self.base[t] = t as u32;
            self.even[t] = false;
        }
    }

    /// A free triangle at the end of an alternating path from `root`, or [`GONE`].
    fn path_from(&mut self, root: u32) -> u32 {
        let mut queue = VecDeque::from([root]);
        self.even[root as usize] = true;
        self.touched.push(root);
        while let Some(v) = queue.pop_front() {
            if self.touched.len() > SEARCH {
                return GONE;
            }
            for k in 0..self.across[v as usize].len() {
                let to = self.across[v as usize][k];
                if self.base[v as usize] == self.base[to as usize] || self.partner[v as usize] == to
                {
                    continue;
                }
                let mate = self.partner[to as usize];
                if to == root || (mate != GONE && self.parent[mate as usize] != GONE) {
                    self.shrink(v, to, &mut queue);
                } else if self.parent[to as usize] == GONE {
                    self.parent[to as usize] = v;
                    self.touched.push(to);
                    if mate == GONE {
                        return to;
                    }
                    self.even[mate as usize] = true;
                    self.touched.push(mate);
                    queue.push_back(mate);
                }
            }
        }
        GONE
    }

    fn shrink(&mut self, v: u32, to: u32, queue: &mut VecDeque<u32>) {
        let meet = self.common_base(v, to);
        let mut marked = Vec::new();
        self.mark(v, meet, to, &mut marked);
        self.mark(to, meet, v, &mut marked);
        for i in 0..self.touched.len() {
            let t = self.touched[i];
            if self.in_blossom[self.base[t as usize] as usize] {
                self.base[t as usize] = meet;
                if !self.even[t as usize] {
                    self.even[t as usize] = true;
                    queue.push_back(t);
                }
            }
        }
        for t in marked {
            self.in_blossom[t as usize] = false;
        }
    }

    fn common_base(&self, a: u32, b: u32) -> u32 {
        let up = |v: u32| {
            let mate = self.partner[v as usize];
            if mate == GONE { GONE } else { self.parent[mate as usize] }
        };
        let mut seen = Vec::new();
        let mut v = a;
        loop {
            v = self.base[v as usize];
            seen.push(v);
            v = up(v);
            if v == GONE {
                break;
            }
        }
        seen.sort_unstable();
        let mut v = self.base[b as usize];
        while seen.binary_search(&v).is_err() {
            v = self.base[up(v) as usize];
        }
        v
    }

    fn mark(&mut self, mut v: u32, meet: u32, mut child: u32, marked: &mut Vec<u32>) {
        while self.base[v as usize] != meet {
            let mate = self.partner[v as usize];
            for t in [self.base[v as usize], self.base[mate as usize]] {
                self.in_blossom[t as usize] = true;
                marked.push(t);
            }
            self.parent[v as usize] = child;
            child = mate;
            v = self.parent[mate as usize];
        }
    }
}
