//! A surface with sharp edges, sampled for dual contouring (Ju et al., "Dual contouring of Hermite
//! data", 2002): a vertex is put where the planes of the surface in its cell meet.
//!
//! A vertex outside of its cell would fold the surface over, so it stays within it (Ju and Udeshi,
//! "Intersection-free contouring on an octree grid", 2006).

use glam::{DMat3, DVec3};

use super::dual::Sampled;
use super::{middle, onto};
use crate::bvh::Ray;
use crate::distance::DistanceSolid;

/// A weak pull to the middle of the crossings decides along a flat or an edge.
const PULL: f64 = 0.01;
/// The pull keeps a vertex from the place where planes meet by some hundredths of the way, so the
/// way is gone several times: an edge that is off by a thousandth of a voxel is a ledge to whoever
/// measures walls.
const ROUNDS: usize = 5;
/// Vertices stay this share of the spacing from the sides of their cells, so that two of them never
/// fall on one place.
const INSET: f64 = 0.01;

pub(super) struct SharpSurface<'a> {
    pub solid: &'a DistanceSolid,
    /// The grid's first sample.
    pub origin: DVec3,
    /// The grid's spacing.
    pub h: f64,
}

impl SharpSurface<'_> {
    /// Returns true if a triangle looks the other way than the surface does beside it.
    pub fn is_folded(&self, [a, b, c]: [DVec3; 3]) -> bool {
        let near = self.solid.tree.nearest((a + b + c) / 3.0, f64::INFINITY);
        let own = near.map(|n| self.solid.topology.face_normals[n.triangle as usize]);
        own.is_some_and(|own| own.dot((b - a).cross(c - a)) < 0.0)
    }
}

impl Sampled for SharpSurface<'_> {
    fn place(&self, crossings: &[DVec3]) -> DVec3 {
        let middle = middle(crossings);
        let low = ((middle - self.origin) / self.h).floor();
        let low = self.origin + (low + INSET) * self.h;
        let high = low + (1.0 - 2.0 * INSET) * self.h;
        let mut planes = Planes { squares: DMat3::ZERO, sides: DVec3::ZERO };
        for &p in crossings {
            let Some(n) = self.solid.tree.nearest(p, self.h) else { continue };
            let normal = self.solid.topology.face_normals[n.triangle as usize].normalize_or_zero();
            planes.add(normal, normal.dot(n.point - middle));
        }
        let way = planes.nearest_point_within(low - middle, high - middle);
        onto(self.solid, middle + way, self.h)
    }

    fn crossed_at(&self, from: DVec3, to: DVec3, guess: DVec3) -> DVec3 {
        let way = (to - from).normalize();
        let ray = Ray { t_max: self.h as f32, ..Ray::new(from.as_vec3(), way.as_vec3()) };
        self.solid
            .tree
            .closest_hit(ray, |_| true)
            .map_or(guess, |hit| from + way * f64::from(hit.t))
    }

    fn joined(&self, p: DVec3) -> bool {
        self.solid.inside(p, None)
    }

    fn off(&self, p: DVec3) -> f64 {
        self.solid.tree.nearest(p, self.h).map_or(self.h, |n| n.distance())
    }
}

/// The same cells with every vertex in the middle of its crossings.
pub(super) struct Middles<'a>(pub Option<&'a SharpSurface<'a>>);

impl Sampled for Middles<'_> {
    fn place(&self, crossings: &[DVec3]) -> DVec3 {
        middle(crossings)
    }

    fn joined(&self, p: DVec3) -> bool {
        self.0.is_some_and(|s| s.joined(p))
    }
}

/// Planes through places about an origin, as the sum of the squares of the distances from them.
struct Planes {
    squares: DMat3,
    sides: DVec3,
}

impl Planes {
    /// The plane of the points `p` with `normal.dot(p) == at`.
    fn add(&mut self, normal: DVec3, at: f64) {
        self.squares += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        self.sides += normal * at;
    }

    /// Returns the point of a box nearest to all planes, and of those one near the origin. A
    /// coordinate in which it would be outside is held at the box's side, the farthest first.
    fn nearest_point_within(&self, low: DVec3, high: DVec3) -> DVec3 {
        let mut held = [None; 3];
        loop {
            let p = self.nearest_point(held);
            let beyond = (p - high).max(low - p);
            let free = (0..3).filter(|&k| held[k].is_none() && beyond[k] > 0.0);
            let Some(k) = free.max_by(|&a, &b| beyond[a].total_cmp(&beyond[b])) else { return p };
            held[k] = Some(p[k].clamp(low[k], high[k]));
        }
    }

    /// Returns the point nearest to all planes with some coordinates held.
    fn nearest_point(&self, held: [Option<f64>; 3]) -> DVec3 {
        let (mut squares, mut sides) = (self.squares, self.sides);
        for (k, at) in held.iter().enumerate().filter_map(|(k, h)| h.map(|at| (k, at))) {
            sides -= squares.col(k) * at;
            for other in 0..3 {
                squares.col_mut(other)[k] = 0.0;
                squares.col_mut(k)[other] = 0.0;
            }
            squares.col_mut(k)[k] = 1.0;
            sides[k] = at;
        }
        let pull = (squares + DMat3::from_diagonal(DVec3::splat(PULL))).inverse();
        (0..ROUNDS).fold(DVec3::ZERO, |p, _| p + pull * (sides - squares * p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;
    use crate::remesh::{RemeshSettings, remesh};
    use crate::shapes;

    #[test]
    fn the_edges_of_a_box_are_where_they_were() {
        let mesh = shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0)).triangulate().0;
        let solid = DistanceSolid::build(&mesh, &Job::default()).expect("built");
        for side in [40, 64, 96] {
            let settings = RemeshSettings { side, sharp: true };
            let made = remesh(&mesh, &solid, settings, &Job::default()).expect("made");
            let edge = DistanceSolid::build(&made.mesh, &Job::default()).expect("built");
            for i in 0..200 {
                let p = DVec3::new(0.2 * f64::from(i), 0.0, 0.0);
                let off = edge.tree.nearest(p, 10.0).expect("near").distance();
                assert!(off < 1e-3, "{side}: {off} at {p}");
            }
        }
    }
}
