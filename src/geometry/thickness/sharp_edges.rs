//! Edges and tips where two sides of the solid meet at less than a right angle. Beside them the
//! sides come as near to each other as one likes, and yet nothing there is a thin wall.

use glam::DVec3;

use super::surface::WeldedSurface;

/// An acute edge within this many times a value to a turned side makes the value the edge's. Sides
/// that meet at 40 degrees need 1.2.
const REACH: f64 = 1.5;
/// cos 40 degrees: sides that meet at a larger angle make an edge, not a thin wall.
pub(super) const OPPOSED: f64 = 0.766_044_443;
/// Cosine below which rounding may have turned a right angle: 89.99 degrees. A side that is turned
/// so far is beside a ray and not ahead.
pub(super) const GRAZING: f64 = 2e-4;
/// Segments in a leaf of the tree.
const LEAF: usize = 4;

/// The acute edges and tips of a surface, in a tree of boxes.
#[derive(Debug, Default)]
pub struct AcuteEdges {
    /// Both ends; a tip has the same place twice.
    segments: Vec<[DVec3; 2]>,
    /// Depth first: box, first segment and count, or where the second child is.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    lo: DVec3,
    hi: DVec3,
    first: u32,
    /// 0: an inner node, whose second child is at `first`.
    count: u32,
}

impl AcuteEdges {
    /// Those of `surface`, seen from the measured side; `sign` is 1 where normals point out of it,
    /// `tilts` are [`WeldedSurface::tilts`].
    pub fn new(surface: &WeldedSurface, tilts: &[f32], sign: f64) -> AcuteEdges {
        let mut segments = Vec::new();
        let mut fan: Vec<(u32, u32)> = Vec::new();
        for v in 0..surface.positions.len() {
            let around = surface.around(v);
            let normal = surface.normals[v];
            // Normals within 45 degrees of one direction are within 90 degrees of each other.
            let near = |&t: &u32| surface.face_normals[t as usize].dot(normal) > 0.708;
            if around.is_empty() || around.iter().all(near) {
                continue;
            }
            let own = surface.positions[v].as_dvec3();
            fan.clear();
            for &t in around {
                let corners = surface.triangles[t as usize];
                fan.extend(corners.iter().filter(|&&u| u as usize != v).map(|&u| (u, t)));
            }
            fan.sort_unstable();
            let mut edges = 0;
            for two in fan.chunk_by(|a, b| a.0 == b.0) {
                let other = surface.positions[two[0].0 as usize].as_dvec3();
                let acute = two.iter().enumerate().any(|(i, a)| {
                    two[i + 1..].iter().any(|b| meets_acutely(surface, tilts, a.1, b.1, sign))
                });
                if acute {
                    edges += 1;
                    if two[0].0 as usize > v {
                        segments.push([own, other]);
                    }
                }
            }
            // A tip of which no edge is acute: a cone's.
            if edges == 0 && is_tip(surface, tilts, around, sign) {
                segments.push([own, own]);
            }
        }
        let mut edges = AcuteEdges { nodes: Vec::new(), segments };
        let count = edges.segments.len();
        if count > 0 {
            edges.build(0, count);
        }
        edges
    }

    fn build(&mut self, from: usize, to: usize) {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for [a, b] in &self.segments[from..to] {
            lo = lo.min(*a).min(*b);
            hi = hi.max(*a).max(*b);
        }
        let at = self.nodes.len();
        self.nodes.push(Node { lo, hi, first: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF {
            return;
        }
        let axis = (hi - lo).max_position();
        let half = (to - from) / 2;
        self.segments[from..to].select_nth_unstable_by(half, |s, t| {
            (s[0][axis] + s[1][axis]).total_cmp(&(t[0][axis] + t[1][axis]))
        });
        self.nodes[at].count = 0;
        self.build(from, from + half);
        self.nodes[at].first = self.nodes.len() as u32;
        self.build(from + half, to);
    }

    /// Returns true if a value to a turned side, measured at `place`, belongs to an edge.
    pub fn own(&self, place: DVec3, value: f64) -> bool {
        self.nearest(place, REACH * value * (1.0 + 1e-6)).is_some()
    }

    /// The nearest one to `p` within `reach`, and its distance.
    pub(super) fn nearest(&self, p: DVec3, reach: f64) -> Option<([DVec3; 2], f64)> {
        let (mut best, mut found) = (reach * reach, None);
        if self.nodes.is_empty() {
            return None;
        }
        let mut stack = vec![0u32];
        while let Some(at) = stack.pop() {
            let node = self.nodes[at as usize];
            let away = (node.lo - p).max(p - node.hi).max(DVec3::ZERO);
            if away.length_squared() > best {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, at + 1]);
                continue;
            }
            for &s in &self.segments[node.first as usize..(node.first + node.count) as usize] {
                let d = distance_squared(p, s);
                if d <= best {
                    (best, found) = (d, Some(s));
                }
            }
        }
        found.map(|s| (s, best.sqrt()))
    }
}

/// The square of the distance of `p` from the segment.
fn distance_squared(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let way = b - a;
    let along = ((p - a).dot(way) / way.length_squared().max(1e-300)).clamp(0.0, 1.0);
    (p - a - way * along).length_squared()
}

/// The cosine of the angle between two facets, one of them turned round, that rounding may make of
/// a right angle.
pub(super) fn grazing(tilts: &[f32], s: u32, t: u32) -> f64 {
    GRAZING + f64::from(tilts[s as usize]) + f64::from(tilts[t as usize])
}

/// Two triangles at an edge between which there is less than 90 degrees of what is measured.
fn meets_acutely(surface: &WeldedSurface, tilts: &[f32], s: u32, t: u32, sign: f64) -> bool {
    let [m, n] = [s, t].map(|t| surface.face_normals[t as usize].as_dvec3());
    m.dot(n) < -grazing(tilts, s, t) && convex(surface, s, t, sign)
}

/// Returns true if the second triangle is on the measured side of the first one's plane.
fn convex(surface: &WeldedSurface, s: u32, t: u32, sign: f64) -> bool {
    let (Some(a), Some(b)) = (surface.corners(s as usize), surface.corners(t as usize)) else {
        return false;
    };
    let out = surface.face_normals[s as usize].as_dvec3() * sign;
    let height = |p: glam::Vec3| (p.as_dvec3() - a[0].as_dvec3()).dot(out);
    let farthest =
        b.iter().map(|p| height(*p)).fold(0.0f64, |m, h| if h.abs() > m.abs() { h } else { m });
    farthest <= 0.0
}

/// Sides that face each other meet at a vertex.
fn is_tip(surface: &WeldedSurface, tilts: &[f32], around: &[u32], sign: f64) -> bool {
    /// Faces of a fan that are compared with each other.
    const MOST: usize = 64;
    let step = around.len().div_ceil(MOST);
    let some: Vec<u32> = around.iter().step_by(step).copied().collect();
    some.iter()
        .enumerate()
        .any(|(i, &s)| some[i + 1..].iter().any(|&t| meets_acutely(surface, tilts, s, t, sign)))
}
