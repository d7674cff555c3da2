//! A mesh in a local frame: about the middle of its box, in single precision.
//!
//! Single precision has 24 bits whatever the distance from the origin. A part of 100 mm at a
//! distance of a kilometre has steps of 60 micrometres there, but steps of 6 nanometres about its
//! centre. So every analysis in single precision works in this frame, and converts positions back
//! through [`CentredMesh::to_file`] in double precision.

use glam::{DVec3, Vec3};

use crate::boolean::resolution;
use crate::measure::{Measures, measures_of};
use crate::{Aabb, PolyMesh, TriMesh};

/// A file's mesh about its centre, scaled.
///
/// ```
/// use glam::DVec3;
/// use sculptd_geometry::{CentredMesh, shapes};
///
/// // A cube of one millimetre, a thousand kilometres away.
/// let far = DVec3::splat(1e9);
/// let part = CentredMesh::new(&shapes::cuboid(far, far + 1.0), 1.0);
/// assert_eq!(part.mesh.bounds().1, glam::Vec3::splat(0.5));
/// assert_eq!(part.to_file(glam::Vec3::splat(0.25)), far + 0.75);
/// ```
#[derive(Debug, Clone)]
pub struct CentredMesh {
    /// The triangles, about the origin.
    pub mesh: TriMesh,
    /// Vertices and triangles in the file.
    pub counts: [usize; 2],
    /// Added to the mesh's coordinates, gives the file's, scaled.
    pub centre: DVec3,
    /// The greatest rounding error of the file's coordinates, scaled.
    pub grain: f64,
    /// Volume, area, size and centroid of the file's own coordinates, scaled; the centroid is about
    /// the centre.
    pub sizes: Measures,
}

impl CentredMesh {
    /// `scale` is the wanted unit (millimetres, as a rule) per unit of the file. Polygons are cut
    /// into triangles. The frame's centre is the middle of the box of all finite vertices.
    pub fn new(poly: &PolyMesh, scale: f64) -> CentredMesh {
        let finite = poly.positions.iter().filter(|p| p.is_finite());
        CentredMesh::about(poly, Aabb::of(finite.copied()).centre(), scale)
    }

    /// The same in a frame whose origin is at `centre`, in the file's unit: for a mesh that is
    /// measured against another.
    pub fn about(poly: &PolyMesh, centre: DVec3, scale: f64) -> CentredMesh {
        let (mut mesh, _) = poly.triangulate();
        mesh.positions = poly.positions.iter().map(|&p| ((p - centre) * scale).as_vec3()).collect();
        let counts = [mesh.positions.len(), mesh.triangles.len()];
        let exact: Vec<DVec3> = poly.positions.iter().map(|&p| (p - centre) * scale).collect();
        let sizes = measures_of(&exact, &mesh.triangles);
        let grain = resolution(poly).error * scale;
        CentredMesh { mesh, counts, centre: centre * scale, grain, sizes }
    }

    /// A point of this frame in the file's coordinates, scaled.
    pub fn to_file(&self, p: Vec3) -> DVec3 {
        p.as_dvec3() + self.centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::DistanceSolid;
    use crate::job::Job;
    use crate::shapes::icosphere;

    #[test]
    fn a_million_sizes_from_the_origin_a_distance_is_exact() {
        let mut ball = icosphere(1.0, 8).to_poly();
        let far = DVec3::new(1e6, -2e6, 3e6);
        let asked = DVec3::new(0.3, 1.7, -0.4);
        let distance = |part: &CentredMesh, p: DVec3| {
            let solid = DistanceSolid::build(&part.mesh, &Job::default()).expect("built");
            solid.signed_distance(p - part.centre)
        };
        let near = distance(&CentredMesh::new(&ball, 1.0), asked);
        ball.positions.iter_mut().for_each(|p| *p += far);
        let moved = distance(&CentredMesh::new(&ball, 1.0), asked + far);
        assert!((moved - near).abs() < 1e-6, "{moved} for {near}");
        // About the origin single precision cannot hold the ball at all.
        let lost = distance(&CentredMesh::about(&ball, DVec3::ZERO, 1.0), asked + far);
        assert!((lost - near).abs() > 1e-3, "{lost} for {near}");
    }
}
