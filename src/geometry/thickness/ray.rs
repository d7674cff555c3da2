//! Thickness by rays: a cone from the vertex itself, opposite its normal.
//!
//! Notation: `o` the origin, `a` the unit normal at `o` pointing away from what is measured, `h` a
//! hit, `c = h - o`, `b` the unit normal of the hit wall turned towards `a` (so `a . b > 0` on a
//! wall that faces the vertex).
//!
//! - An uncorrected ray measures `|c|`: on a slab of thickness d a cone of 120 degrees averages to
//!   about 1.3 d.
//! - Corrected by the hit angle, it measures `-c . b`, the distance of `o` from the plane of the
//!   hit face: exact on a slab, too small on a wedge, biased by the curvature of a wall that bends.
//! - Corrected by the chord (a new method): let `h0` be the point where the axis ray, at the
//!   unknown depth `s`, meets the wall, and `b0` the wall's normal there. On a plane, a sphere and
//!   a right cylinder alike the chord from `h0` to `h` is at right angles to `b0 + b` (the tangents
//!   at both ends of an arc make the same angle with its chord). So `s = -c . (b0 + b) / (a . (b0 +
//!   b))`: every ray of the cone measures the depth along the axis without bias, on a wedge and on
//!   bent walls too. Only the tessellation's error remains. A hit on another wall than the axis
//!   ray's (its normal turned by more than 60 degrees) does not measure this wall and does not
//!   count.

use glam::Vec3;

use super::Opposite;
use super::cone::{Cone, Folded, Outliers, fold, frame_along};
use super::sharp_edges::{AcuteEdges, GRAZING, OPPOSED};
use crate::bvh::{Bvh8, Ray, TraversalStack, TreeHit};

/// The correction of a ray's length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// The length itself.
    None,
    /// The distance from the hit face's plane.
    Angle,
    /// The depth of the wall along the axis, by the chord's right angle.
    Chord,
}

/// A point from which thickness is measured.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    /// The point where thickness is measured.
    pub point: Vec3,
    /// The unit direction away from the measured side.
    pub away: Vec3,
    /// A direction along the surface, which the cone's directions follow; zero: unknown.
    pub along: Vec3,
    /// The triangles that contain the point, ascending.
    pub own: &'a [u32],
    /// The distance within which balls ignore the site's triangles, in mesh units; infinity ignores
    /// them everywhere.
    pub clear: f32,
}

impl Site<'_> {
    /// Returns true if triangle `t` contains the site. Thousands of triangles may share a vertex.
    #[inline(always)]
    pub(super) fn owns(&self, t: u32) -> bool {
        if self.own.len() <= 16 {
            self.own.contains(&t)
        } else {
            self.own.binary_search(&t).is_ok()
        }
    }
}

/// The data shared by all sites.
#[derive(Debug)]
pub struct Caster<'a> {
    /// The tree over the measured mesh.
    pub tree: &'a Bvh8,
    /// One per triangle, of unit length; zero for a triangle that is left out.
    pub face_normals: &'a [Vec3],
    /// For [`Correction::Chord`]: smooth normals of each triangle's corners.
    pub corner_normals: &'a [[Vec3; 3]],
    /// 1 where normals point out of the measured side (a wall of a right mesh), -1 where into it.
    pub sign: f32,
    /// The directions of the rays.
    pub cone: &'a Cone,
    /// The rule for rays that do not count.
    pub outliers: Outliers,
    /// The correction of a ray's length.
    pub correction: Correction,
    /// Edges beside which a turned side does not hold the ball of a wall.
    pub acute: Option<&'a AcuteEdges>,
}

/// A hit on a wall turned by more than this from the axis ray's wall is another wall's: cos 60
/// degrees.
const SAME_WALL: f32 = 0.5;

/// The measurement of a cone of rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeValue {
    /// The mean and its error.
    pub folded: Folded,
    /// The side that the axis ray meets.
    pub(super) opposite: Opposite,
    /// The triangle that the axis ray meets.
    pub wall: Option<u32>,
}

/// Memory that a thread reuses from site to site.
#[derive(Debug, Default)]
pub struct ConeScratch {
    values: Vec<(f32, f32)>,
    rays: Vec<Ray>,
    hits: Vec<Option<TreeHit>>,
    stack: TraversalStack,
}

impl Caster<'_> {
    /// Returns the nearest wall ahead that faces the site: excludes the site's triangles, and any
    /// whose normal points the site's way.
    pub fn hit(&self, site: &Site<'_>, dir: Vec3) -> Option<TreeHit> {
        self.tree.closest_hit(Ray::new(site.point, dir), |t| self.faces(site, t))
    }

    // Called for every triangle that a ray meets, from code of another feature set, which is why it
    // is not inlined without being told.
    #[inline(always)]
    fn faces(&self, site: &Site<'_>, t: u32) -> bool {
        self.face_normals[t as usize].dot(site.away) * self.sign < -(GRAZING as f32)
            && !site.owns(t)
    }

    /// Returns the extent of the mesh's box along the site's axis: no wall is thicker.
    pub(super) fn longest(&self, site: &Site<'_>) -> f32 {
        let (lo, hi) = self.tree.bounds();
        (hi - lo).dot(site.away.abs()) * 1.000_01
    }

    /// The cone's value; `scratch` is reused between calls. Its error is at least the distance from
    /// the length of the axis ray.
    pub fn measure(&self, site: &Site<'_>, scratch: &mut ConeScratch) -> Option<ConeValue> {
        let ConeScratch { values: scratch, rays, hits, stack } = scratch;
        scratch.clear();
        let longest = self.longest(site);
        let (x, y) = frame_along(site.away, site.along);
        let mut first = None::<Vec3>;
        // Turned about the axis so that +z of the cone runs into the wall.
        rays.clear();
        rays.extend(
            self.cone
                .dirs
                .iter()
                .map(|d| Ray::new(site.point, x * d.x + y * d.y - site.away * d.z)),
        );
        self.tree.closest_hits(stack, rays, |_, t| self.faces(site, t), hits);
        for (i, (&Ray { dir, .. }, &hit)) in rays.iter().zip(&*hits).enumerate() {
            if i == 0 {
                first = hit.map(|h| match self.correction {
                    Correction::Chord => self.wall(&h),
                    _ => self.face_normals[h.triangle as usize] * -self.sign,
                });
            }
            let Some(hit) = hit else { continue };
            let weight = self.cone.weights[i];
            match self.correction {
                Correction::None => scratch.push((hit.t, weight)),
                Correction::Angle => {
                    let b = self.face_normals[hit.triangle as usize] * -self.sign;
                    if i > 0 && b.dot(first.unwrap_or(site.away)) < SAME_WALL {
                        continue;
                    }
                    let cos = self.face_normals[hit.triangle as usize].dot(dir).abs();
                    scratch.push((hit.t * cos, weight));
                }
                Correction::Chord => {
                    let b0 = first.unwrap_or(site.away);
                    let b = self.wall(&hit);
                    if i > 0 && b.dot(b0) < SAME_WALL {
                        continue;
                    }
                    let both = b0 + b;
                    let along = site.away.dot(both);
                    if i == 0 {
                        scratch.push((hit.t, weight));
                    } else if along > 0.1 {
                        let depth = -(dir * hit.t).dot(both) / along;
                        // A wall that bends towards the axis sends the chord's depth beyond the
                        // part.
                        if depth > 0.0 && depth <= longest {
                            scratch.push((depth, weight));
                        }
                    }
                }
            }
        }
        // If no hit is on the same wall, the plain lengths are still better than no value.
        if scratch.is_empty() && self.correction == Correction::Chord {
            for ((ray, hit), &weight) in rays.iter().zip(&*hits).zip(&self.cone.weights) {
                if let Some(hit) = hit {
                    let cos = self.face_normals[hit.triangle as usize].dot(ray.dir).abs();
                    scratch.push((hit.t * cos, weight));
                }
            }
        }
        let axis = hits.first().copied().flatten();
        fold(scratch, self.outliers).map(|mut folded| {
            if let Some(hit) = axis.filter(|_| rays.len() > 1) {
                folded.error = folded.error.max((folded.value - hit.t).abs());
            }
            let turned = |h: &TreeHit| {
                -self.sign * self.face_normals[h.triangle as usize].dot(site.away) < OPPOSED as f32
            };
            let opposite =
                axis.filter(turned).map_or(Opposite::Parallel, |h| Opposite::Turned(h.triangle));
            ConeValue { folded, opposite, wall: axis.map(|h| h.triangle) }
        })
    }

    /// The smooth normal of the wall at a hit, turned towards the site.
    fn wall(&self, hit: &TreeHit) -> Vec3 {
        let [a, b, c] = self.corner_normals[hit.triangle as usize];
        let n = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
        n.normalize_or(self.face_normals[hit.triangle as usize]) * -self.sign
    }
}
