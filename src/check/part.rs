//! A part made ready for all checks: triangles about the centre, in millimetres, with a tree for
//! rays, the triangles across each edge, and the normals in double precision.

use std::sync::OnceLock;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sculptd_geometry::bvh::{Bvh8, REACH, Ray};
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::distance::topology::{NO_PARTNER, Topology};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::measure::{Measures, measures};
use sculptd_geometry::thickness::{ThicknessSettings, WeldedSurface};
use sculptd_geometry::{CentredMesh, PolyMesh, TriMesh};

/// Rounding errors of a coordinate within which two heights are one.
const ERRORS: f64 = 8.0;

/// A part made ready for all checks. Its faces look outwards.
#[derive(Debug)]
pub struct PreparedPart {
    /// The mesh about its centre, in millimetres.
    pub centred: CentredMesh,
    /// The tree over the triangles, and the winding number.
    pub solid: DistanceSolid,
    surface: OnceLock<WeldedSurface>,
    /// The welded vertices of [`Topology`], in double precision, about the centre.
    pub places: Vec<DVec3>,
    /// Of each triangle, outwards, of unit length; zero without area.
    pub normals: Vec<DVec3>,
    /// Of each triangle.
    pub areas: Vec<f64>,
    /// Heights that differ by less are one.
    pub tolerance: f64,
    /// Volume, area, size and centroid, about the centre.
    pub sizes: Measures,
}

/// The build direction of a part and the plate under it.
#[derive(Debug, Clone)]
pub struct Standing {
    /// The build direction, of unit length.
    pub up: DVec3,
    /// The height of each welded vertex.
    pub heights: Vec<f64>,
    /// The height of the plate, which the lowest vertex touches.
    pub plate: f64,
    /// The height of the highest vertex.
    pub top: f64,
    /// Vertices within this of the plate are on it.
    pub slack: f64,
}

impl PreparedPart {
    /// Prepares `poly`; `scale` is millimetres a unit of the file. The faces must look outwards.
    ///
    /// # Errors
    /// Returns an error if `job` was cancelled.
    pub fn new(poly: &PolyMesh, scale: f64, job: &Job) -> Result<PreparedPart, Cancelled> {
        PreparedPart::with_surface(poly, scale, false, job)
    }

    /// The same; with `walls` the surface for the search for thin walls as well.
    pub(crate) fn with_surface(
        poly: &PolyMesh,
        scale: f64,
        walls: bool,
        job: &Job,
    ) -> Result<PreparedPart, Cancelled> {
        let centred = CentredMesh::new(poly, scale);
        let (solid, surface) = rayon::join(
            || DistanceSolid::build(&centred.mesh, job),
            || if walls { OnceLock::from(welded(&centred.mesh)) } else { OnceLock::new() },
        );
        let solid = solid?;
        let topology = &solid.topology;
        let mut places: Vec<DVec3> = topology.positions.iter().map(|p| p.as_dvec3()).collect();
        for (own, of) in centred.mesh.triangles.iter().zip(&topology.triangles) {
            for (&v, &name) in own.iter().zip(of) {
                if let Some(place) = places.get_mut(name as usize) {
                    *place = poly.positions[v as usize] * scale - centred.centre;
                }
            }
        }
        let vectors: Vec<(DVec3, f64)> = topology
            .triangles
            .par_iter()
            .map(|t| {
                if t[0] == NO_PARTNER {
                    return (DVec3::ZERO, 0.0);
                }
                let [a, b, c] = t.map(|v| places[v as usize]);
                let twice = (b - a).cross(c - a);
                (twice.normalize_or_zero(), twice.length() * 0.5)
            })
            .collect();
        let (normals, areas) = vectors.into_iter().unzip();
        let reach = places.iter().fold(0f64, |r, p| r.max(p.abs().max_element()));
        let tolerance = ERRORS * (centred.grain + reach * 2f64.powi(-40));
        let sizes = measures(&centred.mesh);
        Ok(PreparedPart { centred, solid, surface, places, normals, areas, tolerance, sizes })
    }

    /// The surface for the search for thin walls.
    pub fn surface(&self) -> &WeldedSurface {
        self.surface.get_or_init(|| welded(&self.centred.mesh))
    }

    /// The tree for rays.
    pub fn tree(&self) -> &Bvh8 {
        &self.solid.tree
    }

    /// The triangles at each edge.
    pub fn topology(&self) -> &Topology {
        &self.solid.topology
    }

    /// The number of triangles, including those without area.
    pub fn triangles(&self) -> usize {
        self.areas.len()
    }

    /// The corners of a triangle that has area.
    pub fn corners(&self, t: u32) -> Option<[DVec3; 3]> {
        let names = self.topology().triangles.get(t as usize)?;
        (self.areas[t as usize] > 0.0).then(|| names.map(|v| self.places[v as usize]))
    }

    /// The centre of a triangle; the origin for one without area.
    pub fn middle(&self, t: u32) -> DVec3 {
        self.corners(t).map_or(DVec3::ZERO, |c| (c[0] + c[1] + c[2]) / 3.0)
    }

    /// A point of the part in the file's coordinates, in millimetres.
    pub fn to_file(&self, p: DVec3) -> DVec3 {
        p + self.centred.centre
    }

    /// The triangle beyond edge `k` of triangle `t`, where there is exactly one.
    pub fn across(&self, t: u32, k: usize) -> Option<u32> {
        Some(self.topology().across[t as usize][k]).filter(|&u| u != NO_PARTNER)
    }

    /// The distance from `from` along `along` (of unit length) to the first face that looks against
    /// the ray, from `least` on.
    pub fn distance_along(&self, from: DVec3, along: DVec3, least: f64) -> Option<(f64, u32)> {
        let ray = Ray { t_min: least as f32, ..Ray::new(from.as_vec3(), along.as_vec3()) };
        let against = |t: u32| self.normals[t as usize].dot(along) < 0.0;
        self.tree().closest_hit(ray, against).map(|h| (f64::from(h.t), h.triangle))
    }

    /// The distance from `from` along `along` (of unit length) to the first accepted face through
    /// which the ray leaves the solid, from `least` on.
    pub fn exit_along(
        &self,
        from: DVec3,
        along: DVec3,
        least: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<(f64, u32)> {
        let ray = Ray { t_min: least as f32, ..Ray::new(from.as_vec3(), along.as_vec3()) };
        let out = |t: u32| self.normals[t as usize].dot(along) > 0.0 && accept(t);
        self.tree().closest_hit(ray, out).map(|h| (f64::from(h.t), h.triangle))
    }

    /// Returns true if a face that looks against the ray blocks it from `least` on.
    pub fn blocked(&self, from: DVec3, along: DVec3, least: f64) -> bool {
        let ray = Ray { t_min: least as f32, ..Ray::new(from.as_vec3(), along.as_vec3()) };
        self.tree().any_hit(ray, |t| self.normals[t as usize].dot(along) < 0.0)
    }

    /// Returns true if all triangles are near enough for the tree, and some have an area.
    pub fn within_reach(&self) -> bool {
        let near = |p: &DVec3| p.abs().max_element() < REACH;
        self.places.iter().all(near) && self.areas.iter().any(|a| *a > 0.0)
    }

    /// The largest rounding of a coordinate to single precision.
    pub fn rounding(&self) -> f64 {
        let (lo, hi) = self.tree().bounds();
        if self.tree().is_empty() {
            return 0.0;
        }
        let reach: Vec3 = lo.abs().max(hi.abs());
        f64::from(reach.max_element()) * 2f64.powi(-24)
    }

    /// The part on a plate, built along `up` in layers of `layer`. A vertex within a twentieth of a
    /// layer of the plate is on it. `None` for a part without faces.
    pub fn standing(&self, up: DVec3, layer: f64) -> Option<Standing> {
        let heights: Vec<f64> = self.places.par_iter().map(|p| p.dot(up)).collect();
        let (mut plate, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
        for t in &self.topology().triangles {
            for &v in t.iter().filter(|v| **v != NO_PARTNER) {
                plate = plate.min(heights[v as usize]);
                top = top.max(heights[v as usize]);
            }
        }
        let slack = self.tolerance.max(0.05 * layer).min(0.01 * (top - plate).max(0.0));
        (plate <= top).then_some(Standing {
            up,
            heights,
            plate,
            top,
            slack: slack.max(self.tolerance),
        })
    }
}

fn welded(mesh: &TriMesh) -> WeldedSurface {
    WeldedSurface::new(mesh, ThicknessSettings::default().crease.to_radians())
}

impl Standing {
    /// Returns true if all corners of a triangle are on the plate.
    pub fn on_plate(&self, corners: &[u32; 3]) -> bool {
        corners.iter().all(|&v| self.heights[v as usize] <= self.plate + self.slack)
    }

    /// The two directions that, with `up`, make a right-handed frame.
    pub fn plan(&self) -> (DVec3, DVec3) {
        let plane = sculptd_geometry::projection::ProjectionPlane::along(-self.up, 0.0);
        plane.map_or((DVec3::X, DVec3::Y), |p| (p.u, p.v))
    }
}
