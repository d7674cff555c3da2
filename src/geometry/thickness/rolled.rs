//! Thickness by the definition *sphere*: the largest ball that the wall holds at a place.
//!
//! Between two sides of a wall this is the ball that touches both. That ball may stick out beside
//! them: along an edge of the wall, where the wall is nevertheless as thick as it is farther in;
//! and where a thinner wall meets the place edge on, such as the top of a rib or the side of a
//! pocket. So a ball that sticks out shrinks about its centre until it fits, and then rolls, always
//! inside the solid and always the way in which it grows fastest, until it is held: until it
//! touches points at least 140 degrees apart, seen from its centre, or touches all around. If it is
//! then about as large as before, the place is at an edge of its wall; if not, the smaller ball is
//! the wall's.
//!
//! This is the flow of the distance function (Chazal and Lieutier, "The lambda-medial axis", 2005):
//! at a centre it grows by the length of the point nearest to zero in the convex hull of the
//! directions from the touches, which is cos 70 degrees for two of them 140 degrees apart.

use glam::Vec3;

use super::ball::{InscribedBall, SLACK, nearest_on};
use super::ray::{Caster, Site};
use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, Ray, push_children};
use crate::simd::wide::{self, Wide, WideWork};

/// Growth below which a ball is held: cos 70 degrees.
const HELD: f32 = 0.342_02;
/// A point counts as a touch up to this share of the radius outside the ball.
const NEAR: f32 = 0.04;
/// Touches that differ by less than 8 degrees are one.
const SAME: f32 = 0.99;
/// Touches that are kept, and leaves that are searched for them.
const TOUCHES: usize = 32;
const LEAVES: usize = 512;
/// Steps of a ball on its way. Each makes it an eighth larger, but for the last few.
const ROLLS: usize = 160;
/// The longest step and the shortest, in radii.
const STEP: f32 = 0.5;
const LEAST_STEP: f32 = 0.01;
/// Above 1 by more than single precision loses.
const ABOVE: f64 = 1.001;
/// The rounding of a place, as a share of the largest coordinate: that of three coordinates.
const ROUNDING: f32 = 2.0 * f32::EPSILON;
/// Below this share of the mesh's size nothing is known of a ball: single precision.
const LEAST: f32 = 1e-5;
/// The move of a settled ball, in radii: out of the reach of other sides.
const ON: f32 = 0.2;

/// A ball that reaches less than this share of its radius out of the solid fits: so much do the
/// facets of a bent wall dent it.
const FITS: f32 = 0.93;
/// A ball that grows back to this share of its size is held by the same wall.
const SAME_WALL: f32 = 0.9;

impl Caster<'_> {
    /// The largest ball that the wall holds at a site. `None` where nothing holds one.
    pub fn wall_ball(&self, site: &Site<'_>) -> Option<InscribedBall> {
        let held = |diameter| InscribedBall { diameter, in_corner: false };
        let ball = self.opposed_ball(site)?;
        let half = ball.diameter * 0.5;
        let centre = site.point - site.away * half;
        let fits = self.tree.nearest(centre.as_dvec3(), f64::from(half * FITS)).is_none();
        if fits || self.sign < 0.0 {
            return Some(ball);
        }
        let rolled = self.roll(centre).filter(|d| *d < SAME_WALL * ball.diameter);
        Some(rolled.map_or(ball, held))
    }

    /// Returns the diameter of the ball that rolls from a place inside the solid until it is held.
    fn roll(&self, mut centre: Vec3) -> Option<f32> {
        let mut r = self.tree.nearest(centre.as_dvec3(), f64::INFINITY)?.distance() as f32;
        let (lo, hi) = self.tree.bounds();
        let largest = (hi - lo).length();
        let rounding = lo.abs().max(hi.abs()).max_element() * ROUNDING;
        if r < largest * LEAST {
            // On the surface, as far as single precision goes: a little into the solid.
            let facet = self.tree.nearest(centre.as_dvec3(), f64::INFINITY)?.triangle;
            centre -= self.face_normals[facet as usize] * (self.sign * largest * 10.0 * LEAST);
            r = self.tree.nearest(centre.as_dvec3(), f64::INFINITY)?.distance() as f32;
        }
        for _ in 0..ROLLS {
            if r > largest || r <= 0.0 {
                return None;
            }
            let touches = self.touches(centre, r);
            let way = steepest(&touches);
            let next =
                if way.length() <= HELD { None } else { self.step(centre, r, way, rounding) };
            let Some(next) = next else {
                return Some(self.settled(centre, r));
            };
            (centre, r) = next;
        }
        None
    }

    /// Returns a larger ball on the way, and its radius; `None` where there is none. `rounding`: so
    /// far is a place from where it was meant to be.
    fn step(&self, centre: Vec3, r: f32, way: Vec3, rounding: f32) -> Option<(Vec3, f32)> {
        let growth = way.length();
        let way = way / growth;
        let mut step = STEP * r;
        while step > LEAST_STEP * r {
            let next = centre + way * step;
            // No distance changes faster than its place.
            let within = f64::from(r + step) * ABOVE + f64::from(rounding);
            let found = self.tree.nearest(next.as_dvec3(), within)?.distance() as f32;
            if found >= r + 0.4 * growth * step {
                return Some((next, found));
            }
            step *= 0.5;
        }
        None
    }

    /// Returns the diameter of a held ball, or of one tangent where it touches, or a little farther
    /// from what is beside it: those know the facets' planes, so they are exact where the way to
    /// this place was not.
    fn settled(&self, centre: Vec3, r: f32) -> f32 {
        let near = self.touching(centre, r * (1.0 + NEAR));
        let tangent = |triangle: u32, point: Vec3| {
            let own = [triangle];
            let away = self.face_normals[triangle as usize] * self.sign;
            let site = Site { point, away, along: Vec3::ZERO, own: &own, clear: f32::INFINITY };
            self.ball(&site).map_or(0.0, |ball| ball.diameter)
        };
        let mut best = 2.0 * r;
        for touch in &near {
            let away = self.face_normals[touch.triangle as usize] * self.sign;
            if away.dot(touch.towards) > -0.99 {
                continue;
            }
            best = best.max(tangent(touch.triangle, touch.foot));
            let beside: Vec3 = near.iter().map(|t| t.towards - away * t.towards.dot(away)).sum();
            let along =
                if beside.length() < HELD { Vec3::ZERO } else { beside.normalize() * (ON * r) };
            let on = self.tree.nearest((touch.foot + along).as_dvec3(), f64::from(r));
            if let Some(on) = on.filter(|_| along != Vec3::ZERO) {
                let flat = self.face_normals[on.triangle as usize] * self.sign;
                if flat.dot(away) > 0.99 {
                    best = best.max(tangent(on.triangle, on.point.as_vec3()));
                }
            }
        }
        best
    }

    /// The points of the surface that a ball touches, about; two where these face each other.
    fn touches(&self, centre: Vec3, r: f32) -> Vec<BallTouch> {
        let within = r * (1.0 + NEAR);
        let touch = |triangle: u32, foot: Vec3| {
            let distance = (centre - foot).length();
            let towards = (centre - foot).normalize_or_zero();
            BallTouch { triangle, foot, towards, distance }
        };
        let first = self.tree.nearest(centre.as_dvec3(), f64::from(r) * ABOVE);
        if let Some(first) = first.map(|n| touch(n.triangle, n.point.as_vec3()))
            && first.towards != Vec3::ZERO
            && let Some(hit) = self.tree.closest_hit(Ray::new(centre, first.towards), |_| true)
            && hit.t <= within
        {
            return vec![first, touch(hit.triangle, centre + first.towards * hit.t)];
        }
        self.touching(centre, within)
    }

    /// The points of the surface within a distance of a place, one for each direction.
    fn touching(&self, centre: Vec3, within: f32) -> Vec<BallTouch> {
        wide::dispatch(self.tree.scalar(), TouchSearch { tree: self.tree, centre, within })
    }
}

/// A touch of a ball.
#[derive(Debug, Clone, Copy)]
struct BallTouch {
    triangle: u32,
    foot: Vec3,
    /// The unit direction from the foot to the centre.
    towards: Vec3,
    distance: f32,
}

/// The point nearest to zero in the convex hull of the directions (Gilbert's algorithm).
fn steepest(touches: &[BallTouch]) -> Vec3 {
    let Some(first) = touches.first() else { return Vec3::ZERO };
    let mut p = first.towards;
    for _ in 0..64 {
        let least = touches.iter().map(|t| t.towards).min_by(|a, b| a.dot(p).total_cmp(&b.dot(p)));
        let Some(u) = least else { break };
        let way = u - p;
        if p.length_squared() - u.dot(p) < 1e-4 {
            break;
        }
        let t = (-p.dot(way) / way.length_squared()).clamp(0.0, 1.0);
        p += way * t;
    }
    p
}

/// The points of the surface within a distance of a place, one for each direction.
struct TouchSearch<'a> {
    tree: &'a Bvh8,
    centre: Vec3,
    within: f32,
}

impl WideWork for TouchSearch<'_> {
    type Output = Vec<BallTouch>;

    #[inline(always)]
    fn run<W: Wide>(self, wide: W) -> Vec<BallTouch> {
        let (nodes, packs) = (self.tree.nodes(), self.tree.packs());
        let mut found: Vec<BallTouch> = Vec::new();
        if nodes.is_empty() {
            return found;
        }
        let (centre, bound) = (self.centre.to_array(), self.within * self.within);
        let mut stack = vec![(0f32, 0u32); self.tree.stack_need().max(1)];
        let (mut top, mut leaves) = (1, 0);
        while top > 0 {
            top -= 1;
            let at = stack[top].1;
            if at & LEAF == 0 {
                let node = &nodes[at as usize];
                let mut near = [0.0f32; 8];
                let inside = wide.near_boxes(centre, node, bound, &mut near);
                top = push_children(&mut stack, top, inside, &near, &node.child);
                continue;
            }
            leaves += 1;
            if leaves > LEAVES {
                return found;
            }
            let pack = &packs[(at & !LEAF) as usize];
            let (mut low, mut high) = ([0.0f32; 4], [0.0f32; 4]);
            wide.near_triangles(centre, pack, SLACK, &mut low, &mut high);
            for lane in 0..4 {
                let triangle = pack.id[lane];
                if triangle == NO_TRIANGLE {
                    break;
                }
                if low[lane] > self.within {
                    continue;
                }
                let foot = nearest_on(pack, lane, self.centre);
                let (way, distance) = (self.centre - foot, (self.centre - foot).length());
                if !(distance > 0.0 && distance <= self.within) {
                    continue;
                }
                let new = BallTouch { triangle, foot, towards: way / distance, distance };
                let same = found.iter().position(|t| t.towards.dot(new.towards) > SAME);
                match same {
                    Some(known) if found[known].distance > distance => found[known] = new,
                    Some(_) => {}
                    None if found.len() < TOUCHES => found.push(new),
                    None => {}
                }
            }
        }
        found
    }
}
