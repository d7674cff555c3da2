//! Signed distance to a mesh: negative inside, positive outside, zero on the surface.
//!
//! Guaranteed: the distance is that of an exhaustive search in double precision; the sign does not
//! depend on the number of threads. On a closed mesh, self-intersecting or not, the winding number
//! gives the sign that filling it would; the pseudonormal gives the same on meshes that do not
//! cross themselves, for less. Not guaranteed: a meaningful sign within a hole of an open mesh;
//! there it follows the generalised winding number, which closes holes smoothly.

pub mod topology;

use std::sync::OnceLock;

use glam::DVec3;
use rayon::prelude::*;

use super::winding::Winding;
use crate::TriMesh;
use crate::bvh::{Bvh8, NearestPoint};
use crate::job::{Cancelled, Job};
pub use topology::Topology;

/// The method that separates inside from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sign {
    /// By the winding number: right on every closed mesh, also where shells overlap, and smooth
    /// across holes.
    #[default]
    Winding,
    /// By the angle-weighted normal of the nearest face, edge or vertex (Baerentzen and Aanaes,
    /// "Signed distance computation using the angle weighted pseudonormal", 2005). Right on closed
    /// meshes that do not cross themselves.
    Pseudonormal,
}

/// A mesh made ready for questions of distance.
#[derive(Debug, Clone)]
pub struct DistanceSolid {
    /// The tree over the triangles.
    pub tree: Bvh8,
    /// Made by the first question that needs it.
    winding: OnceLock<Winding>,
    /// The triangles at each edge, and the pseudonormals.
    pub topology: Topology,
    sign: Sign,
    /// Corners of each triangle in double precision; empty: the tree's.
    corners: Vec<[DVec3; 3]>,
}

/// Points that one task works through.
const CHUNK: usize = 256;

impl DistanceSolid {
    /// About 0.4 us a triangle. The sign is the winding number's; [`DistanceSolid::with_sign`]
    /// changes that.
    pub fn build(mesh: &TriMesh, job: &Job) -> Result<DistanceSolid, Cancelled> {
        let (tree, topology) = rayon::join(|| Bvh8::build(mesh, job), || Topology::build(mesh));
        let tree = tree?;
        job.check()?;
        let (winding, sign) = (OnceLock::new(), Sign::default());
        Ok(DistanceSolid { tree, winding, topology, sign, corners: Vec::new() })
    }

    /// With the corners in double precision of which the mesh's are rounded, one entry a triangle:
    /// distances to them, without the rounding. Other numbers of corners are left out of account.
    pub fn with_corners(mut self, corners: Vec<[DVec3; 3]>) -> DistanceSolid {
        self.corners =
            if corners.len() == self.topology.triangles.len() { corners } else { Vec::new() };
        self
    }

    /// The welded vertices of [`DistanceSolid::topology`], in double precision where the corners
    /// were given so.
    pub fn positions(&self) -> Vec<DVec3> {
        let mut out: Vec<DVec3> = self.topology.positions.iter().map(|p| p.as_dvec3()).collect();
        for (names, corners) in self.topology.triangles.iter().zip(&self.corners) {
            for (&v, &p) in names.iter().zip(corners) {
                if let Some(place) = out.get_mut(v as usize) {
                    *place = p;
                }
            }
        }
        out
    }

    /// The nearest point of the surface, as [`Bvh8::nearest`] has it.
    pub fn nearest_point(&self, p: DVec3, within: f64) -> Option<NearestPoint> {
        self.tree.nearest_of(p, within, &self.corners)
    }

    /// [`Sign::Pseudonormal`] is refused, and the winding number kept, on meshes that are not
    /// closed.
    pub fn with_sign(mut self, sign: Sign) -> DistanceSolid {
        self.sign = if self.topology.closed { sign } else { Sign::Winding };
        self
    }

    /// Returns the method that separates inside from outside.
    pub fn sign(&self) -> Sign {
        self.sign
    }

    /// The generalised winding number of `p`.
    pub fn winding(&self, p: DVec3) -> f64 {
        self.winding.get_or_init(|| Winding::build(&self.tree)).at(&self.tree, p)
    }

    /// Whether `p` is inside. `nearest` is the mesh's nearest point, where the caller has it.
    pub fn inside(&self, p: DVec3, nearest: Option<&NearestPoint>) -> bool {
        if self.sign == Sign::Pseudonormal
            && let Some(n) = nearest.copied().or_else(|| self.nearest_point(p, f64::INFINITY))
            && let Some(normal) = self.topology.pseudonormal(&n)
        {
            let away = p - n.point;
            let side = away.dot(normal);
            // Too close to call where rounding of the nearest point matters: the winding number
            // decides.
            if side.abs() > 1e-9 * away.length() * normal.length() {
                return side < 0.0;
            }
        }
        // The winding number is that of the rounded corners: nearer than rounding may have moved
        // them, it is asked farther away on the same side.
        let mut place = p;
        if !self.corners.is_empty()
            && let Some(n) = nearest
            && n.distance() <= 8.0 * f64::from(self.tree.rounding())
            && let Some(normal) = self.topology.pseudonormal(n)
        {
            let side = (p - n.point).dot(normal).signum();
            let far = 16.0 * f64::from(self.tree.rounding());
            place += normal.normalize_or_zero() * (side * far);
        }
        // Either way round: a mesh turned inside out is a solid too.
        self.winding(place).abs() > 0.5
    }

    /// Negative inside; infinite for an empty mesh or a point that is not finite.
    pub fn signed_distance(&self, p: DVec3) -> f64 {
        match self.nearest_point(p, f64::INFINITY) {
            Some(n) if self.inside(p, Some(&n)) => -n.distance(),
            Some(n) => n.distance(),
            None => f64::INFINITY,
        }
    }

    /// [`DistanceSolid::signed_distance`] of each point, on all threads.
    pub fn signed_distances(&self, points: &[DVec3], job: &Job) -> Result<Vec<f64>, Cancelled> {
        self.batch(points, f64::INFINITY, job, |p| self.signed_distance(p))
    }

    /// The nearest point to each, on all threads; `None` as in [`Bvh8::nearest`].
    pub fn nearest(
        &self,
        points: &[DVec3],
        job: &Job,
    ) -> Result<Vec<Option<NearestPoint>>, Cancelled> {
        self.batch(points, None, job, |p| self.nearest_point(p, f64::INFINITY))
    }

    fn batch<T: Clone + Send>(
        &self,
        points: &[DVec3],
        fill: T,
        job: &Job,
        each: impl Fn(DVec3) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let mut out = vec![fill; points.len()];
        out.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).try_for_each(|(out, points)| {
            job.check()?;
            for (o, &p) in out.iter_mut().zip(points) {
                *o = each(p);
            }
            Ok(())
        })?;
        Ok(out)
    }
}
