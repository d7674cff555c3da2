//! Wall thickness of a solid, at every vertex or face, by rays or by the inscribed sphere.
//!
//! * One ray: the way through the wall along the normal. It jumps at steps, and under a rib it sees
//!   rib and all.
//! * A cone of rays: the mean depth of the wall ahead (Shapira, Shamir, Cohen-Or 2008). It smooths
//!   what is narrower than itself.
//! * The inscribed sphere: the ball that fits. It goes to zero in every convex edge, see
//!   [`EdgePolicy`].
//!
//! Guaranteed: the same values with any number of threads, with and without AVX2; a face that
//! touches the vertex is never hit from it; a value is missing only with a [`Reason`]. Not
//! guaranteed: anything about the solid that the triangles stand for. The stated error is against
//! the triangles' own surface, smoothed where it bends by less than the crease.

pub mod ball;
pub mod check;
pub mod colour;
pub mod cone;
mod edges;
pub mod preset;
pub mod probe;
pub mod ray;
pub mod refine;
pub mod report;
pub mod summary;
pub mod surface;
mod walls;
pub mod warnings;
pub mod worst;

use std::borrow::Cow;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use crate::TriMesh;
use crate::bvh::Bvh8;
use crate::job::{Cancelled, Job};
use crate::tight_frame::tight_frame;
pub use cone::{Cone, Outliers, Weights};
pub use ray::Correction;
use ray::{Caster, ConeScratch, Site};
pub use surface::{MeshFaults, WeldedSurface};
use walls::OwnWalls;
pub use walls::Walls;

/// How thickness is defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ThicknessMethod {
    /// A cone of rays into the wall, see [`ray`].
    Ray,
    /// The largest inscribed sphere, see [`ball`].
    Sphere,
}

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeasuredSide {
    /// The wall behind the surface.
    Wall,
    /// The gap in front of it (clearance).
    Gap,
}

/// What a vertex on a sharp edge says, where "the opposite side" has no meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgePolicy {
    /// Whatever was measured with the mean of the normals.
    Raw,
    /// The median of the nearest vertices beside the edge; where there are none (a box of eight
    /// vertices), the smallest of the walls under the faces that meet there.
    Extrapolate,
    /// The inscribed sphere, which goes to zero there.
    Sphere,
    /// Nothing, with [`Reason::Edge`].
    Neutral,
}

/// Why a value is what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[repr(u8)]
pub enum Reason {
    /// Measured here.
    Measured,
    /// On a sharp edge, or a ball held by one: the value follows the edge policy, or is missing
    /// under `Neutral`.
    Edge,
    /// Missing: no wall ahead; the mesh is open there, or nothing lies in front of it.
    NothingAhead,
    /// Missing: the faces around the vertex cancel each other, so there is no direction to measure
    /// in.
    NoNormal,
    /// Missing: the vertex belongs to no face of any area.
    NoFace,
}

/// Where values are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeasuredPlaces {
    /// At each welded vertex.
    Vertices,
    /// At each triangle's centroid, too.
    VerticesAndFaces,
}

/// What is measured, where and how. The default is what `sculptd thickness` does: 25 rays in a cone
/// of 60 degrees, corrected by the chord.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ThicknessSettings {
    /// How thickness is defined.
    pub method: ThicknessMethod,
    /// What is measured: walls or gaps.
    pub side: MeasuredSide,
    /// Rays in a cone, 1 to 1000.
    pub rays: usize,
    /// The cone's full angle, degrees, 0 to 120.
    pub opening: f32,
    /// What a ray's length is corrected by.
    pub correction: Correction,
    /// Which rays of a cone do not count.
    pub outliers: Outliers,
    /// What a ray counts in the cone's mean.
    pub weights: Weights,
    /// What a vertex on a sharp edge says.
    pub edges: EdgePolicy,
    /// An edge that turns by more than this, degrees, is sharp.
    pub crease: f32,
    /// Where values are wanted.
    pub at: MeasuredPlaces,
}

impl Default for ThicknessSettings {
    fn default() -> Self {
        ThicknessSettings {
            method: ThicknessMethod::Ray,
            side: MeasuredSide::Wall,
            rays: 25,
            opening: 60.0,
            correction: Correction::Chord,
            outliers: Outliers::SigmaMedian,
            weights: Weights::Plain,
            edges: EdgePolicy::Extrapolate,
            crease: 40.0,
            at: MeasuredPlaces::Vertices,
        }
    }
}

/// Settings that mean nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ThicknessError {
    /// A setting is out of range.
    #[error("{what} is {got}: it must be {expected}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        got: f32,
        /// The range.
        expected: &'static str,
    },
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ThicknessSettings {
    fn check(&self) -> Result<(), ThicknessError> {
        let say = |what, got, expected| Err(ThicknessError::Setting { what, got, expected });
        if !(1..=1000).contains(&self.rays) {
            return say("the number of rays", self.rays as f32, "from 1 to 1000");
        }
        if !(0.0..=120.0).contains(&self.opening) {
            return say("the cone's opening", self.opening, "from 0 to 120 degrees");
        }
        if !(0.0..=180.0).contains(&self.crease) {
            return say("the crease angle", self.crease, "from 0 to 180 degrees");
        }
        match self.outliers {
            Outliers::Within(low, high) if !(0.0 <= low && low < high && high <= 1.0) => {
                say("the outliers' range", low, "two shares from 0 to 1, the lower first")
            }
            Outliers::Range(share) if !(0.1..=0.9).contains(&share) => {
                say("the outliers' share of the range", share, "from 0.1 to 0.9")
            }
            _ => Ok(()),
        }
    }
}

/// The measured map. Lengths are in the mesh's unit; NaN stands for "no value", and `reasons` says
/// why.
#[derive(Debug, Clone)]
pub struct Thickness {
    /// What was asked for.
    pub settings: ThicknessSettings,
    /// One a vertex of the mesh.
    pub values: Vec<f32>,
    /// Why each value is what it is, one a vertex of the mesh.
    pub reasons: Vec<Reason>,
    /// One a vertex: the standard error of a cone's mean; 0 for a single ray and for the sphere.
    pub errors: Vec<f32>,
    /// One a triangle, with [`MeasuredPlaces::VerticesAndFaces`].
    pub face_values: Vec<f32>,
    /// Why each of `face_values` is what it is.
    pub face_reasons: Vec<Reason>,
    /// One a triangle, for statistics by area, which must not depend on how the part is meshed: the
    /// mean of the corners that were measured themselves; where all lie on sharp edges, the value
    /// at the centroid. NaN without a value.
    pub area_values: Vec<f32>,
    /// Rays and ball queries asked for.
    pub queries: u64,
    /// The welded mesh that was measured.
    pub surface: WeldedSurface,
    /// The largest coordinate error of single precision here, in the mesh's unit.
    pub rounding: f32,
}

/// Vertices a task takes at once: a cancel is seen within a few milliseconds.
const CHUNK: usize = 512;

#[derive(Debug, Clone, Copy)]
struct SiteValue {
    value: f32,
    error: f32,
    reason: Reason,
    /// The other side is not parallel enough to make a wall: near a sharp edge the value tells of
    /// the edge.
    turned: bool,
}

impl SiteValue {
    const fn missing(reason: Reason) -> Self {
        SiteValue { value: f32::NAN, error: 0.0, reason, turned: false }
    }
}

/// Measures a whole mesh on the current rayon pool.
pub fn measure(
    mesh: &TriMesh,
    settings: &ThicknessSettings,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    measure_at_places(mesh, None, settings, job)
}

/// The same where `mesh` is a surface in smaller triangles: rays and balls meet the `walls` that it
/// was cut from. Walls of another mesh, and such as would only cost more, are left out of account.
pub fn measure_at_places(
    mesh: &TriMesh,
    walls: Option<&Walls>,
    settings: &ThicknessSettings,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    settings.check()?;
    let walls = walls.filter(|w| w.serve(mesh));
    let solid = walls.map_or(mesh, |w| &w.mesh);
    let of = |m: &TriMesh| WeldedSurface::new(m, settings.crease.to_radians());
    let ready = |mesh: &TriMesh, solid: &TriMesh| {
        let (tree, surfaces) = rayon::join(
            || Bvh8::build_for_rays(solid, job),
            || (of(mesh), walls.map(|_| of(solid))),
        );
        Ok::<_, Cancelled>((tree?, surfaces))
    };
    let measured = |(tree, (surface, whole)): (Bvh8, (WeldedSurface, Option<WeldedSurface>))| {
        let walls = whole.as_ref().zip(walls.map(|w| &w.of[..]));
        measure_prepared(Cow::Owned(surface), walls, &tree, settings, job)
    };
    if let Some(turn) = turn(solid) {
        let (made, surface) =
            rayon::join(|| ready(&turned(mesh, turn), &turned(solid, turn)), || of(mesh));
        let made = made?;
        let own = &made.1.0;
        // The same vertices and triangles, though they are rounded anew.
        if own.weld == surface.weld && own.triangles == surface.triangles {
            let mut done = measured(made)?;
            done.surface = surface;
            return Ok(done);
        }
    }
    measured(ready(mesh, solid)?)
}

/// The turn into a frame in which the boxes of the mesh's triangles are much smaller, where there
/// is one. Along long thin triangles that run along no axis every ray would meet every box.
fn turn(mesh: &TriMesh) -> Option<DMat3> {
    let positions: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    if mesh.triangles.iter().flatten().any(|&v| v as usize >= positions.len()) {
        return None;
    }
    tight_frame(&positions, &mesh.triangles)
}

fn turned(mesh: &TriMesh, turn: DMat3) -> TriMesh {
    TriMesh {
        positions: mesh.positions.iter().map(|p| (turn * p.as_dvec3()).as_vec3()).collect(),
        triangles: mesh.triangles.clone(),
        colours: None,
    }
}

/// The same with the tree and the surface at hand, for several measures of one mesh. `walls`: the
/// surface that the tree was built from and [`Walls::of`], where that is not `surface` itself.
pub fn measure_prepared(
    surface: Cow<'_, WeldedSurface>,
    walls: Option<(&WeldedSurface, &[u32])>,
    tree: &Bvh8,
    settings: &ThicknessSettings,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    settings.check()?;
    let chord = settings.method == ThicknessMethod::Ray
        && settings.correction == Correction::Chord
        && settings.rays > 1;
    let whole = walls.map_or(&*surface, |w| w.0);
    let mut corner_normals =
        if chord { whole.corner_normals(settings.crease.to_radians()) } else { Vec::new() };
    if let Some((_, of)) = walls.filter(|_| chord) {
        walls::flatten_what_was_cut(&mut corner_normals, &whole.face_normals, of);
    }
    let cone = Cone::new(settings.rays, settings.opening.to_radians(), settings.weights);
    let inside_out = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let caster = Caster {
        tree,
        face_normals: &whole.face_normals,
        corner_normals: &corner_normals,
        sign: if settings.side == MeasuredSide::Wall { inside_out } else { -inside_out },
        cone: &cone,
        outliers: settings.outliers,
        // A single ray is the axis: exact along it whatever the correction, and needs no smooth
        // normals.
        correction: if settings.rays == 1 { Correction::None } else { settings.correction },
    };
    let own = OwnWalls::new(&surface, walls.map(|w| w.1));
    let faces = own.in_order(tree);
    let order = vertices_in_order(&surface, &faces);
    job.progress(0.2);
    let at_vertex = |v: usize, scratch: &mut ConeScratch| -> SiteValue {
        let clear = own.clear(v);
        let own = own.at(v);
        if own.is_empty() {
            return SiteValue::missing(Reason::NoFace);
        }
        let n = surface.normals[v];
        if n == Vec3::ZERO {
            return SiteValue::missing(Reason::NoNormal);
        }
        let site = Site { point: surface.positions[v], away: n * caster.sign, own, clear };
        one(&caster, &site, settings, surface.sharp[v], scratch)
    };
    let mut welded = scattered(&order, surface.positions.len(), job, (0.2, 0.8), at_vertex)?;
    edges::apply(&caster, &surface, &own, settings, &mut welded);
    let (mut face_values, mut face_reasons) = (Vec::new(), Vec::new());
    let at_face = |t: usize, scratch: &mut ConeScratch| -> SiteValue {
        let Some([a, b, c]) = surface.corners(t) else {
            return SiteValue::missing(Reason::NoFace);
        };
        let own = [own.of(t as u32)];
        let site = Site {
            point: (a + b + c) / 3.0,
            away: surface.face_normals[t] * caster.sign,
            own: &own,
            clear: f32::INFINITY,
        };
        one(&caster, &site, settings, false, scratch)
    };
    // (value, whether the triangle's centroid is to be measured)
    let by_corners = |t: usize| -> (f32, bool) {
        if surface.triangles[t][0] == surface::DROPPED {
            return (f32::NAN, false);
        }
        let corners = surface.triangles[t].map(|v| welded[v as usize]);
        let measured = corners.iter().filter(|v| v.reason == Reason::Measured);
        let (sum, n) = measured.fold((0.0f32, 0.0f32), |(s, n), v| (s + v.value, n + 1.0));
        let edges = corners.iter().any(|v| v.reason == Reason::Edge);
        if n > 0.0 { (sum / n, false) } else { (f32::NAN, edges) }
    };
    let (mut area_values, alone): (Vec<f32>, Vec<bool>) =
        (0..surface.triangles.len()).map(by_corners).unzip();
    let alone: Vec<u32> = (0..alone.len() as u32).filter(|&t| alone[t as usize]).collect();
    let centroids = scattered(&alone, area_values.len(), job, (0.8, 0.8), at_face)?;
    for &t in &alone {
        area_values[t as usize] = centroids[t as usize].value;
    }
    if settings.at == MeasuredPlaces::VerticesAndFaces {
        let faces = scattered(&faces, surface.triangles.len(), job, (0.8, 0.98), at_face)?;
        face_values = faces.iter().map(|v| v.value).collect();
        face_reasons = faces.iter().map(|v| v.reason).collect();
    }
    let per_site = if settings.method == ThicknessMethod::Ray { settings.rays } else { 1 };
    let queries = (order.len() + alone.len() + face_values.len()) as u64 * per_site as u64;
    let (lo, hi) = tree.bounds();
    let rounding = if tree.is_empty() { 0.0 } else { lo.abs().max(hi.abs()).max_element() * 1e-6 };
    let of =
        |f: fn(&SiteValue) -> f32| surface.weld.iter().map(|&v| f(&welded[v as usize])).collect();
    let values = of(|v| v.value);
    let errors = of(|v| v.error);
    let reasons = surface.weld.iter().map(|&v| welded[v as usize].reason).collect();
    job.progress(1.0);
    Ok(Thickness {
        settings: *settings,
        values,
        reasons,
        errors,
        face_values,
        face_reasons,
        area_values,
        queries,
        surface: surface.into_owned(),
        rounding,
    })
}

/// One site's value by the chosen method. A value at a sharp vertex is marked for the edge policy.
fn one(
    caster: &Caster<'_>,
    site: &Site<'_>,
    settings: &ThicknessSettings,
    sharp: bool,
    scratch: &mut ConeScratch,
) -> SiteValue {
    let marked = |edge| if edge { Reason::Edge } else { Reason::Measured };
    let by_rays = match settings.method {
        ThicknessMethod::Ray => caster.measure(site, scratch),
        ThicknessMethod::Sphere => None,
    };
    // Where every ray of the cone leaves the solid (a needle's tip), the ball still has a size.
    let found = by_rays
        .map(|(f, turned)| SiteValue {
            value: f.value,
            error: f.error,
            reason: marked(sharp),
            turned,
        })
        .or_else(|| {
            let b = caster.ball(site)?;
            Some(SiteValue {
                value: b.diameter,
                error: 0.0,
                reason: marked(sharp),
                turned: b.in_corner,
            })
        });
    found.unwrap_or(SiteValue::missing(Reason::NothingAhead))
}

/// `value` at each index of `order`, in parallel over spatially coherent chunks; the others have no
/// face.
fn scattered(
    order: &[u32],
    count: usize,
    job: &Job,
    (from, to): (f32, f32),
    value: impl Fn(usize, &mut ConeScratch) -> SiteValue + Sync,
) -> Result<Vec<SiteValue>, Cancelled> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let found: Vec<SiteValue> = order
        .par_chunks(CHUNK)
        .map(|chunk| {
            job.check()?;
            let mut scratch = ConeScratch::default();
            let values: Vec<SiteValue> =
                chunk.iter().map(|&i| value(i as usize, &mut scratch)).collect();
            let n = done.fetch_add(chunk.len(), std::sync::atomic::Ordering::Relaxed);
            job.progress(from + (to - from) * n as f32 / order.len() as f32);
            Ok(values)
        })
        .collect::<Result<Vec<_>, Cancelled>>()?
        .concat();
    let mut out = vec![SiteValue::missing(Reason::NoFace); count];
    for (&i, v) in order.iter().zip(found) {
        out[i as usize] = v;
    }
    Ok(out)
}

/// The welded vertices in the order of their faces.
fn vertices_in_order(surface: &WeldedSurface, faces: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; surface.positions.len()];
    let mut order = Vec::with_capacity(seen.len());
    for &t in faces {
        for v in surface.triangles[t as usize] {
            if !std::mem::replace(&mut seen[v as usize], true) {
                order.push(v);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::shapes::cylinder;

    #[test]
    fn slivers_along_a_diagonal_are_measured_in_their_own_frame() {
        let job = Job::default();
        let rod = cylinder(1.0, 2000.0, 60).triangulate().0;
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 0.3, -0.2).normalize(), 0.8);
        let mut slanted = rod.clone();
        for p in &mut slanted.positions {
            *p = (turn * p.as_dvec3()).as_vec3();
        }
        let settings = ThicknessSettings { rays: 1, ..ThicknessSettings::default() };
        assert!(super::turn(&rod).is_none() && super::turn(&slanted).is_some());
        let of = |m: &TriMesh| measure(m, &settings, &job).expect("measured");
        let (straight, slanted) = (of(&rod), of(&slanted));
        for (v, (a, b)) in straight.values.iter().zip(&slanted.values).enumerate() {
            assert!((a - b).abs() < 2e-3 || a.is_nan() && b.is_nan(), "{v}: {a} {b}");
        }
        // The surface is the mesh's own, not the turned one.
        let there = turn * straight.surface.positions[0].as_dvec3();
        assert!((slanted.surface.positions[0].as_dvec3() - there).length() < 1e-3);
    }
}
