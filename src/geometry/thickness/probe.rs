//! The value at one place, with the rays that it comes from.

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::cone::{Cone, frame_along};
use super::least::Solid;
use super::measuring::single;
use super::ray::{Caster, ConeScratch, Correction, Site};
use super::sharp_edges::AcuteEdges;
use super::surface::{DROPPED, WeldedSurface};
use super::{MeasuredSide, ThicknessError, ThicknessMethod, ThicknessSettings};
use crate::TriMesh;
use crate::bvh::{Bvh8, Feature, Ray};
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
    /// That triangle is a side of an edge and not the other side of a wall: it is turned by more
    /// than 40 degrees, and not the side of a groove or pit.
    pub edge: bool,
    /// In the mesh's unit; `None` where no wall is ahead.
    pub thickness: Option<f32>,
    /// Standard error of the cone's mean; 0 of one ray and of the sphere.
    pub error: f32,
    /// The diameter of the largest ball between the place and the side opposite, whatever the
    /// definition; `None` where nothing holds one.
    pub ball: Option<f32>,
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
    Ok(WallProber::new(mesh, settings, job)?.at(place))
}

/// A mesh made ready to be measured at any place.
#[derive(Debug)]
pub struct WallProber {
    tree: Bvh8,
    surface: WeldedSurface,
    corner_normals: Vec<[Vec3; 3]>,
    tilts: Vec<f32>,
    acute: AcuteEdges,
    cone: Cone,
    settings: ThicknessSettings,
    sign: f32,
}

impl WallProber {
    /// Prepares `mesh`.
    ///
    /// # Errors
    /// Returns an error if a setting is out of range, or the job was cancelled.
    pub fn new(
        mesh: &TriMesh,
        settings: &ThicknessSettings,
        job: &Job,
    ) -> Result<WallProber, ThicknessError> {
        settings.check()?;
        let tree = Bvh8::build(mesh, job)?;
        let crease = settings.crease.to_radians();
        let surface = WeldedSurface::new(mesh, crease);
        let inside_out = if surface.faults.inside_out { -1.0 } else { 1.0 };
        let sign = if settings.side == MeasuredSide::Wall { inside_out } else { -inside_out };
        let tilts = surface.tilts(single(&tree));
        let acute = AcuteEdges::new(&surface, &tilts, f64::from(sign));
        let opening = settings.opening.to_radians();
        Ok(WallProber {
            corner_normals: surface.corner_normals(crease),
            cone: Cone::new(settings.rays_at_a_place(), opening, settings.weights),
            settings: *settings,
            tree,
            surface,
            tilts,
            acute,
            sign,
        })
    }

    /// Measures at the point of the surface that is nearest to `place`; `None` as in [`probe`].
    pub fn at(&self, place: DVec3) -> Option<Probe> {
        let found = self.found(place)?;
        let (site, caster) = (found.site(), self.caster());
        let ball = caster.wall_ball(&site).map(|b| b.diameter);
        let value = self.value(&caster, &site);
        let (x, y) = frame_along(site.away, site.along);
        let ray = |d: &Vec3| {
            let direction = x * d.x + y * d.y - site.away * d.z;
            let length = caster.hit(&site, direction).map(|h| h.t);
            ProbedRay { direction: direction.to_array(), length }
        };
        let opposite = caster.hit(&site, -site.away).map(|h| h.triangle);
        Some(Probe {
            position: site.point.to_array(),
            normal: site.away.to_array(),
            triangle: found.triangle,
            opposite,
            edge: opposite.is_some_and(|u| self.is_edge(&site, u)),
            thickness: value.map(|v| v.0),
            error: value.map_or(0.0, |v| v.1),
            ball,
            rays: self.cone.dirs.iter().map(ray).collect(),
        })
    }

    /// Returns the wall at a place; `None` where there is none, or an edge.
    pub(super) fn wall(&self, found: &FoundPlace) -> Option<f32> {
        let (site, caster) = (found.site(), self.caster());
        let (value, _) = self.value(&caster, &site)?;
        let opposite = caster.hit(&site, -site.away);
        let edge = opposite.is_some_and(|h| self.is_edge(&site, h.triangle));
        (!edge).then_some(value)
    }

    /// Returns the distance to the first point of the surface on a ray, between two distances.
    pub(super) fn first_on(&self, origin: Vec3, dir: Vec3, [from, to]: [f32; 2]) -> Option<f32> {
        let ray = Ray { origin, dir, t_min: from, t_max: to };
        self.tree.closest_hit(ray, |_| true).map(|hit| hit.t)
    }

    /// The point of the surface that is nearest to `place`.
    pub(super) fn found(&self, place: DVec3) -> Option<FoundPlace> {
        let surface = &self.surface;
        let nearest = self.tree.nearest(place, f64::INFINITY)?;
        let corners = surface.triangles[nearest.triangle as usize];
        if corners[0] == DROPPED {
            return None;
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
        (normal.length_squared() >= 1e-12).then(|| FoundPlace {
            point: nearest.point.as_vec3(),
            away: normal.normalize() * self.sign,
            along: surface.along(corners[0] as usize),
            own,
            triangle: nearest.triangle,
        })
    }

    fn caster(&self) -> Caster<'_> {
        let single_ray = self.cone.dirs.len() == 1;
        Caster {
            tree: &self.tree,
            face_normals: &self.surface.face_normals,
            corner_normals: &self.corner_normals,
            sign: self.sign,
            cone: &self.cone,
            outliers: self.settings.outliers,
            correction: if single_ray { Correction::None } else { self.settings.correction },
            acute: Some(&self.acute),
        }
    }

    /// The value at a site by the settings' definition, and its error.
    fn value(&self, caster: &Caster<'_>, site: &Site<'_>) -> Option<(f32, f32)> {
        let by_rays = match self.settings.method {
            ThicknessMethod::Ray | ThicknessMethod::Cone => {
                caster.measure(site, &mut ConeScratch::default())
            }
            ThicknessMethod::Sphere => None,
        };
        let by_rays = by_rays.map(|c| (c.folded.value, c.folded.error));
        by_rays.or_else(|| caster.wall_ball(site).map(|b| (b.diameter, 0.0)))
    }

    fn is_edge(&self, site: &Site<'_>, opposite: u32) -> bool {
        let WallProber { tree, surface, tilts, .. } = self;
        let (sign, grain) = (f64::from(self.sign), single(tree));
        let solid = Solid { tree, surface, sign, grain, tilts, opposed_only: false };
        solid.is_edge(site.point.as_dvec3(), -site.away.as_dvec3(), opposite)
    }
}

/// A point of the surface.
pub(super) struct FoundPlace {
    pub(super) point: Vec3,
    /// Out of what is measured, of unit length.
    pub(super) away: Vec3,
    along: Vec3,
    /// The triangles that contain it.
    own: Vec<u32>,
    triangle: u32,
}

impl FoundPlace {
    fn site(&self) -> Site<'_> {
        let FoundPlace { point, away, along, ref own, .. } = *self;
        Site { point, away, along, own, clear: f32::INFINITY }
    }
}
