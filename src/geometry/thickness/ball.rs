//! Thickness by the largest inscribed sphere: the ball inside the wall that touches the surface at
//! the site. Manufacturing means this by "wall thickness" (a probe ball that fits).
//!
//! Shrinking ball (Ma, Bae, Choi, "3D medial axis point approximation using nearest neighbors and
//! the normal field", 2012): begin with the ball whose diameter is the axis ray's length; while a
//! surface point `q` lies inside it, take the ball through the site and `q`, tangent at the site:
//! `r = |pq|^2 / (2 away . pq)`. Each ball lies inside the last, so no earlier constraint comes
//! back. Left out: the site's own triangles, and triangles that turn from the site's normal by less
//! than `SAME_SIDE`; a tessellated wall would otherwise dent every ball that rests on it.

use glam::Vec3;

use super::ray::{Caster, Site};
use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, Pack};
use crate::simd::wide::{self, Wide, WideWork};

/// cos 20 degrees: a touch at a smaller angle seen from the ball's centre is the same side of the
/// wall.
const SAME_SIDE: f32 = 0.94;
/// cos 140 degrees: two touches nearer to each other, seen from the centre, sit in a corner, not in
/// a wall.
const CORNER: f32 = -0.766;
/// The ball has settled when no point is deeper inside it than this share of its radius.
const SETTLED: f32 = 1e-5;
const STEPS: usize = 40;

/// The settled ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InscribedBall {
    /// In the mesh's unit.
    pub diameter: f32,
    /// The two touches are nearer to each other than 140 degrees seen from the centre: the ball is
    /// held by a corner or an edge, not by the opposite side of a wall.
    pub in_corner: bool,
}

impl Caster<'_> {
    /// The inscribed ball at a site. `None` where no wall is ahead and so nothing bounds it.
    pub fn ball(&self, site: &Site<'_>) -> Option<InscribedBall> {
        let mut touch = None;
        let mut r = match self.hit(site, -site.away) {
            Some(hit) => {
                touch = Some(site.point - site.away * hit.t);
                hit.t * 0.5
            }
            // Open below: begin with a ball as large as the mesh, and let the rest of the surface
            // bound it.
            None => {
                let (lo, hi) = self.tree.bounds();
                (hi - lo).length()
            }
        };
        for _ in 0..STEPS {
            let centre = site.point - site.away * r;
            let limit = r * (1.0 - SETTLED);
            let accept = |t: u32| {
                self.face_normals[t as usize].dot(site.away) * self.sign < SAME_SIDE
                    && !site.owns(t)
            };
            let query = BallSearch { tree: self.tree, centre, limit, accept };
            let Some(q) = wide::dispatch(self.tree.scalar(), query) else { break };
            let to = site.point.as_dvec3() - q.as_dvec3();
            let along = site.away.as_dvec3().dot(to);
            if along <= 0.0 {
                // Rounding only: a point above the tangent plane cannot be inside the ball.
                break;
            }
            let next = (to.length_squared() / (2.0 * along)) as f32;
            touch = Some(q);
            if next >= r {
                break;
            }
            r = next;
        }
        let q = touch?;
        let centre = site.point - site.away * r;
        let cos = (q - centre).normalize_or_zero().dot(site.away);
        // On an open mesh nothing else bounds the ball.
        let diameter = (2.0 * r).min(self.longest(site));
        Some(InscribedBall { diameter, in_corner: cos > CORNER })
    }
}

/// The nearest surface point within `limit` of `centre` on a triangle that `accept` takes.
struct BallSearch<'a, A> {
    tree: &'a Bvh8,
    centre: Vec3,
    limit: f32,
    accept: A,
}

impl<A: Fn(u32) -> bool> WideWork for BallSearch<'_, A> {
    type Output = Option<Vec3>;

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> Option<Vec3> {
        let (nodes, packs) = (self.tree.nodes(), self.tree.packs());
        if nodes.is_empty() {
            return None;
        }
        let c = self.centre.to_array();
        let mut bound = self.limit * self.limit;
        let mut best = None::<(u32, Vec3)>;
        let mut inline = [(0u32, 0f32); 96];
        let mut heap = Vec::new();
        let need = self.tree.stack_need();
        let stack = if need > inline.len() {
            heap.resize(need, (0, 0.0));
            &mut heap[..]
        } else {
            &mut inline[..]
        };
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (at, near) = stack[top];
            if near > bound {
                continue;
            }
            if at & LEAF != 0 {
                let pack = &packs[(at & !LEAF) as usize];
                for lane in 0..4 {
                    let id = pack.id[lane];
                    if id == NO_TRIANGLE {
                        break;
                    }
                    let q = nearest_on(pack, lane, self.centre);
                    let d = (q - self.centre).length_squared();
                    let nearer = d < bound || (d == bound && best.is_some_and(|b| id < b.0));
                    if nearer && (self.accept)(id) {
                        bound = d;
                        best = Some((id, q));
                    }
                }
                continue;
            }
            let node = &nodes[at as usize];
            let mut d = [0f32; 8];
            for i in 0..8 {
                for axis in 0..3 {
                    let out = (node.planes[axis][i] - c[axis])
                        .max(c[axis] - node.planes[3 + axis][i])
                        .max(0.0);
                    d[i] += out * out;
                }
            }
            // Pushed so that the nearest comes off first.
            let base = top;
            for i in 0..8 {
                if d[i] <= bound {
                    let mut j = top;
                    while j > base && stack[j - 1].1 < d[i] {
                        stack[j] = stack[j - 1];
                        j -= 1;
                    }
                    stack[j] = (node.child[i], d[i]);
                    top += 1;
                }
            }
        }
        best.map(|b| b.1)
    }
}

/// The nearest point of a triangle by its seven regions (Ericson, Real-Time Collision Detection,
/// 5.1.5).
#[inline(always)]
fn nearest_on(pack: &Pack, lane: usize, p: Vec3) -> Vec3 {
    let corner = |k: usize| Vec3::new(pack.v[k][0][lane], pack.v[k][1][lane], pack.v[k][2][lane]);
    let (a, b, c) = (corner(0), corner(1), corner(2));
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && (d4 - d3) >= 0.0 && (d5 - d6) >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let n = 1.0 / (va + vb + vc);
    a + ab * (vb * n) + ac * (vc * n)
}
