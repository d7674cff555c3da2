//! Thickness by the largest inscribed sphere: the ball inside the wall that touches the surface at
//! the site. Manufacturing means this by "wall thickness" (a probe ball that fits).
//!
//! Shrinking ball (Ma, Bae, Choi, "3D medial axis point approximation using nearest neighbors and
//! the normal field", 2012): begin with the ball whose diameter is the axis ray's length; while a
//! surface point `q` is inside it, take the ball through the site and `q`, tangent at the site. Its
//! radius is `|pq|^2 / (2 away . pq)`. Each ball is inside the last, so no earlier constraint
//! returns.
//!
//! The ball between two sides (`opposed_ball`) is limited by the opposite side alone: facets turned
//! by less than 40 degrees from parallel, touched within 20 degrees of the normal. Facets beside
//! the ball, such as the sides of a plate along its edges, do not limit it, so the value does not
//! go to zero there. The inscribed ball ([`Caster::ball`]) is limited by all facets. Both ignore
//! the site's triangles, and triangles that turn from the site's normal by less than `SAME_SIDE`; a
//! tessellated wall would otherwise dent every ball that rests on it.

use glam::Vec3;

use super::ray::{Caster, Site};
use super::sharp_edges::{AcuteEdges, OPPOSED};
use super::side_cones::{SAME_SIDE, SideCones};
use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, Pack, WideNode, nearest_on_triangle, push_children};
use crate::simd::wide::{self, Wide, WideWork};

/// cos 140 degrees: two touches nearer to each other, seen from the centre, sit in a corner, not in
/// a wall.
const CORNER: f32 = -(OPPOSED as f32);
/// cos 60 degrees: a side turned by more than this is beside the wall.
const FLANK: f32 = 0.5;
/// cos 20 degrees: a touch farther from the normal, seen from the site, is beside the wall.
const BESIDE: f32 = 0.939_692_6;
/// The ball has settled when no point is deeper inside it than this share of its radius.
const SETTLED: f32 = 1e-5;
/// The error of the test that leaves triangles out, in units of the largest distance of a corner.
pub(super) const SLACK: f32 = 1.5e-6;
/// Steps towards one triangle: near a sharp edge each takes the ball only a part of the way.
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
        self.held_ball(site, false, f32::NEG_INFINITY, None)
    }

    /// The same, if its diameter is larger than `least`: sooner known where it is not. `cones` are
    /// those of the caster's tree and normals; with them a large ball takes a fraction of the time.
    pub fn ball_above(
        &self,
        site: &Site<'_>,
        least: f32,
        cones: &SideCones,
    ) -> Option<InscribedBall> {
        let ball = self.held_ball(site, false, least, Some(cones));
        ball.filter(|ball| ball.diameter > least)
    }

    /// The ball between a site and the opposite side of its wall. `None` where no wall is ahead.
    pub(super) fn opposed_ball(&self, site: &Site<'_>) -> Option<InscribedBall> {
        self.held_ball(site, true, f32::NEG_INFINITY, None)
    }

    fn held_ball(
        &self,
        site: &Site<'_>,
        opposed: bool,
        least: f32,
        cones: Option<&SideCones>,
    ) -> Option<InscribedBall> {
        let mut touch = None;
        let first = self.hit(site, -site.away);
        let first = first.filter(|hit| {
            let n = self.face_normals[hit.triangle as usize];
            let facing = -n.dot(site.away) * self.sign;
            let turned = facing < OPPOSED as f32;
            let place = site.point.as_dvec3();
            let edge = |acute: &AcuteEdges| acute.own(place, f64::from(hit.t));
            !(opposed && turned && (facing < FLANK || self.acute.is_some_and(edge)))
        });
        let mut r = match first {
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
        // From how far on a triangle counts; none: it does not.
        let from = |t: u32| {
            let most = if opposed { -(OPPOSED as f32) } else { SAME_SIDE };
            let other = self.face_normals[t as usize].dot(site.away) * self.sign < most;
            let from = if site.owns(t) { site.clear } else { 0.0 };
            (other && from < f32::INFINITY).then_some(from)
        };
        let search = BallSearch {
            tree: self.tree,
            point: site.point,
            away: site.away,
            r,
            touch,
            least,
            cones: cones.map(|c| (c, site.away * self.sign)),
            from,
            opposed,
        };
        (r, touch) = wide::dispatch(self.tree.scalar(), search);
        let q = touch?;
        let centre = site.point - site.away * r;
        let cos = (q - centre).normalize_or_zero().dot(site.away);
        // On an open mesh nothing else bounds the ball.
        let diameter = (2.0 * r).min(self.longest(site));
        Some(InscribedBall { diameter, in_corner: !opposed && cos > CORNER })
    }
}

/// The largest ball that touches the surface at `point`, is at most `r` large, and into which no
/// triangle reaches, from that distance from `point` on which `from` tells. One walk over the tree
/// is enough: the ball only ever shrinks into itself, so what was outside of it stays outside.
struct BallSearch<'a, F> {
    tree: &'a Bvh8,
    point: Vec3,
    away: Vec3,
    r: f32,
    /// The point, besides `point`, where the ball of radius `r` touches.
    touch: Option<Vec3>,
    /// The search ends as soon as the diameter is no larger.
    least: f32,
    /// The cones of the tree, with the normal that they are compared with.
    cones: Option<(&'a SideCones, Vec3)>,
    from: F,
    /// True to ignore touches beside the wall.
    opposed: bool,
}

impl<F: Fn(u32) -> Option<f32>> WideWork for BallSearch<'_, F> {
    type Output = (f32, Option<Vec3>);

    #[inline(always)]
    fn run<W: Wide>(self, wide: W) -> (f32, Option<Vec3>) {
        let (nodes, packs) = (self.tree.nodes(), self.tree.packs());
        let mut ball = Shrinking::new(&self);
        if nodes.is_empty() {
            return (ball.r, ball.touch);
        }
        let mut inline = [(0f32, 0u32); 96];
        let mut heap = Vec::new();
        let need = self.tree.stack_need();
        let stack = if need > inline.len() {
            heap.resize(need, (0.0, 0));
            &mut heap[..]
        } else {
            &mut inline[..]
        };
        let mut top = 1;
        while top > 0 && !(2.0 * ball.r <= self.least) {
            top -= 1;
            let at = stack[top].1;
            if at & LEAF != 0 {
                let pack = &packs[(at & !LEAF) as usize];
                // Of the ball as it is now: a lane before may shrink it, and so move its centre.
                let bound = ball.bound;
                let (mut low, mut high) = ([0.0f32; 4], [0.0f32; 4]);
                wide.near_triangles(ball.centre.to_array(), pack, SLACK, &mut low, &mut high);
                for lane in 0..4 {
                    let id = pack.id[lane];
                    if id == NO_TRIANGLE {
                        break;
                    }
                    if low[lane] * low[lane] >= bound {
                        continue;
                    }
                    if let Some(from) = (self.from)(id) {
                        let before = ball;
                        let settled = ball.shrink(self.opposed, |centre| {
                            let q = nearest_on(pack, lane, centre);
                            let way = q - self.point;
                            let length = way.length();
                            if length < from && length > 0.0 {
                                self.point + way * (from / length)
                            } else {
                                q
                            }
                        });
                        if !settled {
                            ball = before;
                        }
                    }
                }
                continue;
            }
            let node = &nodes[at as usize];
            let mut near = [0.0f32; 8];
            let mut inside = wide.near_boxes(ball.centre.to_array(), node, ball.bound, &mut near);
            if let Some((cones, away)) = self.cones {
                inside &= cones.others(at as usize, away);
            }
            if self.opposed {
                inside &= boxes_ahead(node, self.point, self.away);
            }
            top = push_children(stack, top, inside, &near, &node.child);
        }
        (ball.r, ball.touch)
    }
}

/// Of the eight boxes those of which the sphere around them reaches to within 20 degrees of the
/// direction opposite to `away`.
#[inline(always)]
fn boxes_ahead(node: &WideNode, point: Vec3, away: Vec3) -> u32 {
    /// sin 20 degrees, a little more.
    const ASIDE: f32 = 0.342_03;
    let mut mask = 0;
    for i in 0..8 {
        let (mut square, mut depth, mut size) = (0.0f32, 0.0f32, 0.0f32);
        for axis in 0..3 {
            let (lo, hi) = (node.planes[axis][i], node.planes[3 + axis][i]);
            let (to, half) = ((lo + hi) * 0.5 - point[axis], (hi - lo) * 0.5);
            square += to * to;
            size += half * half;
            depth -= to * away[axis];
        }
        let lateral = (square - depth * depth).max(0.0).sqrt();
        // An unused box is no number, and near_boxes left it out.
        let behind = lateral * BESIDE - depth * ASIDE > size.sqrt() + square.sqrt() * 1e-5;
        mask |= u32::from(!behind) << i;
    }
    mask
}

/// A ball that touches the surface at a site.
#[derive(Clone, Copy)]
struct Shrinking {
    point: Vec3,
    away: Vec3,
    r: f32,
    centre: Vec3,
    /// The square of the radius within which a point is inside; finite.
    bound: f32,
    touch: Option<Vec3>,
}

impl Shrinking {
    #[inline(always)]
    fn new<F>(search: &BallSearch<'_, F>) -> Shrinking {
        let BallSearch { point, away, r, touch, .. } = *search;
        let mut ball = Shrinking { point, away, r, centre: point, bound: 0.0, touch };
        ball.resize(r);
        ball
    }

    #[inline(always)]
    fn resize(&mut self, r: f32) {
        let within = r * (1.0 - SETTLED);
        self.bound = (within * within).min(f32::MAX);
        (self.r, self.centre) = (r, self.point - self.away * r);
    }

    /// A point lies more than 20 degrees beside the normal, seen from the site.
    #[inline(always)]
    fn is_beside(&self, q: Vec3) -> bool {
        let way = self.point - q;
        way.dot(self.away) < BESIDE * way.length()
    }

    #[inline(always)]
    fn holds(&self, q: Vec3) -> bool {
        (q - self.centre).length_squared() < self.bound
    }

    /// Shrinks until no point of a triangle, whose nearest point to a place is asked of `nearest`,
    /// is inside. With `opposed` it gives up, and returns `false`, where the touch would lie
    /// beside the wall: while the ball shrinks, a touch only moves away from the normal.
    #[inline(always)]
    fn shrink(&mut self, opposed: bool, nearest: impl Fn(Vec3) -> Vec3) -> bool {
        for _ in 0..STEPS {
            let q = nearest(self.centre);
            if !self.holds(q) {
                return true;
            }
            if opposed && self.is_beside(q) {
                return false;
            }
            let to = self.point.as_dvec3() - q.as_dvec3();
            let along = self.away.as_dvec3().dot(to);
            if along <= 0.0 {
                // Rounding only: a point above the tangent plane cannot be inside the ball.
                return true;
            }
            let next = (to.length_squared() / (2.0 * along)) as f32;
            self.touch = Some(q);
            if next >= self.r {
                return true;
            }
            self.resize(next);
        }
        true
    }
}

/// The point nearest to `p` of a triangle in a leaf.
pub(super) fn nearest_on(pack: &Pack, lane: usize, p: Vec3) -> Vec3 {
    let corner = |k: usize| Vec3::new(pack.v[k][0][lane], pack.v[k][1][lane], pack.v[k][2][lane]);
    let corners = [0, 1, 2].map(|k| corner(k).as_dvec3());
    nearest_on_triangle(p.as_dvec3(), corners).0.as_vec3()
}
