//! The value at one place, with the rays that it comes from.

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::cone::{Cone, frame_along};
use super::measuring::single;
use super::ray::{Caster, ConeScratch, Correction, Site};
use super::sharp_edges::AcuteEdges;
use super::surface::{DROPPED, WeldedSurface};
use super::{MeasuredSide, ThicknessError, ThicknessMethod, ThicknessSettings};
use crate::TriMesh;
use crate::bvh::{Bvh8, Feature};
use crate::job::Job;

/// One ray of a cone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ProbedRay {
    /// Of unit length.
    pub direction: [f32; 3],
    /// To the first wall that faces the place; `None` where there is none.
    pub length: Option<f32>,
}

/// The thickness at one place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Probe {
    /// The point of the surface.
    pub position: [f32; 3],
    /// Out of what is measured, of unit length.
    pub normal: [f32; 3],
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// The triangle that the ray along the normal meets.
    pub opposite: Option<u32>,
    /// In the mesh's unit; `None` where no wall is ahead.
    pub thickness: Option<f32>,
    /// Standard error of the cone's mean; 0 of one ray and of the sphere.
    pub error: f32,
    /// The rays, the cone's axis first. The value is their mean by the settings' correction,
    /// without outliers.
    pub rays: Vec<ProbedRay>,
}

/// Measures at the point of the surface that is nearest to `place`; `None` on an empty mesh, or
/// where the surface has no direction.
///
/// ```
/// use glam::DVec3;
/// use sculptd_geometry::job::Job;
/// use sculptd_geometry::shapes;
/// use sculptd_geometry::thickness::{ThicknessSettings, probe};
///
/// let slab = shapes::cuboid(DVec3::ZERO, DVec3::new(50.0, 50.0, 3.0)).triangulate().0;
/// let place = DVec3::new(20.0, 24.0, 4.0);
/// let found = probe::probe(&slab, &ThicknessSettings::default(), place, &Job::default());
/// let found = found.expect("not cancelled").expect("a surface");
/// assert_eq!((found.position, found.normal), ([20.0, 24.0, 3.0], [0.0, 0.0, 1.0]));
/// assert!((found.thickness.expect("a wall") - 3.0).abs() < 1e-4 && found.rays.len() == 1);
/// ```
pub fn probe(
    mesh: &TriMesh,
    settings: &ThicknessSettings,
    place: DVec3,
    job: &Job,
) -> Result<Option<Probe>, ThicknessError> {
    settings.check()?;
    let tree = Bvh8::build(mesh, job)?;
    let crease = settings.crease.to_radians();
    let surface = WeldedSurface::new(mesh, crease);
    let Some(nearest) = tree.nearest(place, f64::INFINITY) else { return Ok(None) };
    let corners = surface.triangles[nearest.triangle as usize];
    if corners[0] == DROPPED {
        return Ok(None);
    }
    let around = |k: u8| surface.around(corners[k as usize] as usize);
    let own: Vec<u32> = match nearest.feature {
        Feature::Face => vec![nearest.triangle],
        Feature::Vertex(k) => around(k).to_vec(),
        Feature::Edge(k) => {
            let other = corners[(k as usize + 1) % 3];
            let at_edge = |t: &&u32| surface.triangles[**t as usize].contains(&other);
            around(k).iter().filter(at_edge).copied().collect()
        }
    };
    let normal = match nearest.feature {
        Feature::Vertex(k) => surface.normals[corners[k as usize] as usize],
        _ => own.iter().map(|&t| surface.face_normals[t as usize]).sum::<Vec3>(),
    };
    if normal.length_squared() < 1e-12 {
        return Ok(None);
    }
    let inside_out = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let rays = settings.rays_at_a_place();
    let cone = Cone::new(rays, settings.opening.to_radians(), settings.weights);
    let sign = if settings.side == MeasuredSide::Wall { inside_out } else { -inside_out };
    let tilts = surface.tilts(single(&tree));
    let acute = AcuteEdges::new(&surface, &tilts, f64::from(sign));
    let caster = Caster {
        tree: &tree,
        face_normals: &surface.face_normals,
        corner_normals: &surface.corner_normals(crease),
        sign,
        cone: &cone,
        outliers: settings.outliers,
        correction: if rays == 1 { Correction::None } else { settings.correction },
        acute: Some(&acute),
    };
    let away = normal.normalize() * caster.sign;
    let along = surface.along(corners[0] as usize);
    let point = nearest.point.as_vec3();
    let site = Site { point, away, along, own: &own, clear: f32::INFINITY };
    let by_rays = match settings.method {
        ThicknessMethod::Ray | ThicknessMethod::Cone => {
            let found = caster.measure(&site, &mut ConeScratch::default());
            found.map(|c| (c.folded.value, c.folded.error))
        }
        ThicknessMethod::Sphere => None,
    };
    let found = by_rays.or_else(|| caster.wall_ball(&site).map(|b| (b.diameter, 0.0)));
    let (x, y) = frame_along(away, along);
    let ray = |d: &Vec3| {
        let direction = x * d.x + y * d.y - away * d.z;
        let length = caster.hit(&site, direction).map(|h| h.t);
        ProbedRay { direction: direction.to_array(), length }
    };
    Ok(Some(Probe {
        position: site.point.to_array(),
        normal: away.to_array(),
        triangle: nearest.triangle,
        opposite: caster.hit(&site, -away).map(|h| h.triangle),
        thickness: found.map(|f| f.0),
        error: found.map_or(0.0, |f| f.1),
        rays: cone.dirs.iter().map(ray).collect(),
    }))
}
