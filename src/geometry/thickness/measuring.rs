//! The measurement of a whole mesh.

use std::borrow::Cow;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::cone::Cone;
use super::least::{LeastWall, Solid};
use super::ray::{Caster, ConeScratch, Correction, Site};
use super::samples::{self, AreaSample};
use super::sharp_edges::AcuteEdges;
use super::surface::{DROPPED, WeldedSurface};
use super::walls::{OwnWalls, Walls, flatten_what_was_cut};
use super::{
    MeasuredPlaces, MeasuredSide, Opposite, Reason, SiteValue, Thickness, ThicknessError,
    ThicknessMethod, ThicknessSettings, ThinFacets, edges,
};
use crate::TriMesh;
use crate::bvh::Bvh8;
use crate::job::{Cancelled, Job};
use crate::tight_frame::tight_frame;

/// Vertices a task takes at once: a cancel is seen within a few milliseconds.
const CHUNK: usize = 512;

/// The results requested besides the map.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallQuery {
    /// The facets with walls below this are listed, in the mesh's unit.
    pub limit: Option<f64>,
    /// True to list, without a limit, the facets with the thinnest hundredth of the area.
    pub thinnest: bool,
    /// The greatest error of the mesh's coordinates besides the rounding to single precision.
    pub grain: f64,
}

/// Measures a whole mesh on the current rayon pool.
pub fn measure(
    mesh: &TriMesh,
    settings: &ThicknessSettings,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    measure_at_places(mesh, None, settings, WallQuery::default(), job)
}

/// The same where `mesh` is a surface in smaller triangles: rays and balls meet the `walls` that it
/// was cut from. Walls of another mesh, and such as would only cost more, are left out of account.
pub fn measure_at_places(
    mesh: &TriMesh,
    walls: Option<&Walls>,
    settings: &ThicknessSettings,
    query: WallQuery,
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
    let measured = |(tree, (surface, whole)): (Bvh8, (WeldedSurface, Option<WeldedSurface>)),
                    query| {
        let walls = whole.as_ref().zip(walls.map(|w| &w.of[..]));
        measure_prepared(Cow::Owned(surface), walls, &tree, settings, query, job)
    };
    if let Some(turn) = turn(solid) {
        let (made, surface) =
            rayon::join(|| ready(&turned(mesh, turn), &turned(solid, turn)), || of(mesh));
        let made = made?;
        let own = &made.1.0;
        // The same vertices and triangles, although rounded again.
        if own.weld == surface.weld && own.triangles == surface.triangles {
            let grain = query.grain + single(&made.0);
            let mut done = measured(made, WallQuery { grain, ..query })?;
            done.surface = surface;
            done.turn_back(turn.transpose());
            return Ok(done);
        }
    }
    measured(ready(mesh, solid)?, query)
}

/// Half of the last place of the largest coordinate in single precision.
pub(super) fn single(tree: &Bvh8) -> f64 {
    let (lo, hi) = tree.bounds();
    if tree.is_empty() {
        0.0
    } else {
        f64::from(lo.abs().max(hi.abs()).max_element()) * 2f64.powi(-24)
    }
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
    query: WallQuery,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    settings.check()?;
    let rays = settings.rays_at_a_place();
    let chord = settings.correction == Correction::Chord && rays > 1;
    let whole = walls.map_or(&*surface, |w| w.0);
    let mut corner_normals =
        if chord { whole.corner_normals(settings.crease.to_radians()) } else { Vec::new() };
    if let Some((_, of)) = walls.filter(|_| chord) {
        flatten_what_was_cut(&mut corner_normals, &whole.face_normals, of);
    }
    let cone = Cone::new(rays, settings.opening.to_radians(), settings.weights);
    let inside_out = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let sign = if settings.side == MeasuredSide::Wall { inside_out } else { -inside_out };
    let grain = query.grain + single(tree);
    let tilts = whole.tilts(grain);
    let sphere = settings.method == ThicknessMethod::Sphere;
    let acute = sphere.then(|| AcuteEdges::new(whole, &tilts, f64::from(sign)));
    let caster = Caster {
        tree,
        face_normals: &whole.face_normals,
        corner_normals: &corner_normals,
        sign,
        cone: &cone,
        outliers: settings.outliers,
        // A single ray is the axis: exact along it whatever the correction, and needs no smooth
        // normals.
        correction: if rays == 1 { Correction::None } else { settings.correction },
        acute: acute.as_ref(),
    };
    let own = OwnWalls::new(&surface, walls.map(|w| w.1));
    let faces = own.in_order(tree);
    let order = vertices_in_order(&surface, &faces);
    let vertices = order.len();
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
        let along = surface.along(v);
        let site = Site { point: surface.positions[v], away: n * caster.sign, along, own, clear };
        one(&caster, &site, settings, whole, surface.sharp[v], scratch)
    };
    let mut welded = scattered(&order, surface.positions.len(), job, (0.2, 0.8), at_vertex)?;
    let solid = Solid {
        tree,
        surface: whole,
        sign: f64::from(caster.sign),
        grain,
        tilts: &tilts,
        opposed_only: sphere,
    };
    edges::apply(&caster, &solid, &surface, &own, settings, &mut welded, job)?;
    let (mut face_values, mut face_reasons) = (Vec::new(), Vec::new());
    let at_face = |t: usize, scratch: &mut ConeScratch| -> SiteValue {
        let Some([a, b, c]) = surface.corners(t) else {
            return SiteValue::missing(Reason::NoFace);
        };
        let own = [own.of(t as u32)];
        let site = Site {
            point: (a + b + c) / 3.0,
            away: surface.face_normals[t] * caster.sign,
            along: b - a,
            own: &own,
            clear: f32::INFINITY,
        };
        one(&caster, &site, settings, whole, false, scratch)
    };
    if settings.at == MeasuredPlaces::VerticesAndFaces {
        let faces = scattered(&faces, surface.triangles.len(), job, (0.8, 0.98), at_face)?;
        face_values = faces.iter().map(|v| v.value).collect();
        face_reasons = faces.iter().map(|v| v.reason).collect();
    }
    let order = facets_in_order(whole, tree);
    let (samples, sample_area) = sampled(&caster, whole, settings, &order, job)?;
    let least = least_wall(&solid, &samples, &welded, &surface, settings, &order, job)?;
    let thin = thin_facets(&solid, least, &samples, settings, query, &order, job)?;
    let places = vertices + face_values.len() + samples.len();
    let queries = places as u64 * rays as u64;
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
        samples: samples.into_iter().map(|s| s.0).collect(),
        sample_area,
        least,
        thin,
        queries,
        surface: surface.into_owned(),
        rounding,
    })
}

/// The triangles that are kept, near ones one after the other.
fn facets_in_order(surface: &WeldedSurface, tree: &Bvh8) -> Vec<u32> {
    let mut seen = vec![false; surface.triangles.len()];
    let once = |t: &u32| {
        seen.get_mut(*t as usize).is_some_and(|seen| !std::mem::replace(seen, true))
            && surface.triangles[*t as usize][0] != DROPPED
    };
    tree.packs().iter().flat_map(|p| p.id).filter(once).collect()
}

/// The statistics' places with their values and the sides opposite.
fn sampled(
    caster: &Caster<'_>,
    whole: &WeldedSurface,
    settings: &ThicknessSettings,
    order: &[u32],
    job: &Job,
) -> Result<(Vec<(AreaSample, Opposite)>, f64), Cancelled> {
    let costly = settings.method != ThicknessMethod::Ray;
    let (places, each) = samples::spread(whole, order, costly);
    let at = |sample: &AreaSample, scratch: &mut ConeScratch| {
        let t = sample.triangle;
        let corners = whole.corners(t as usize).unwrap_or_default();
        let site = Site {
            point: sample.position,
            away: whole.face_normals[t as usize] * caster.sign,
            along: corners[1] - corners[0],
            own: &[t],
            clear: f32::INFINITY,
        };
        let found = match settings.method {
            ThicknessMethod::Sphere => {
                caster.wall_ball(&site).map(|b| (b.diameter, Opposite::Parallel))
            }
            _ => caster.measure(&site, scratch).map(|c| (c.folded.value, c.opposite)),
        };
        let (value, opposite) = found.unwrap_or((f32::NAN, Opposite::Parallel));
        (AreaSample { value, ..*sample }, opposite)
    };
    let found = places
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut scratch = ConeScratch::default();
            let each = |s: &AreaSample| {
                job.check()?;
                Ok(at(s, &mut scratch))
            };
            chunk.iter().map(each).collect::<Result<Vec<_>, Cancelled>>()
        })
        .collect::<Result<Vec<_>, Cancelled>>()?
        .concat();
    Ok((found, each))
}

/// The least wall: proven by rays along the normal, found at sampled places by the others.
fn least_wall(
    solid: &Solid<'_>,
    samples: &[(AreaSample, Opposite)],
    welded: &[SiteValue],
    surface: &WeldedSurface,
    settings: &ThicknessSettings,
    order: &[u32],
    job: &Job,
) -> Result<Option<LeastWall>, Cancelled> {
    if settings.method == ThicknessMethod::Ray {
        return solid.least(order, job);
    }
    // Of the balls between two flat sides the least is as large as the least ray.
    let by_rays = match settings.method {
        ThicknessMethod::Sphere => solid.least(order, job)?,
        _ => None,
    };
    let wall = |(s, opposite): &&(AreaSample, Opposite)| {
        let into = surface_normal(solid.surface, s.triangle).as_dvec3() * -solid.sign;
        let edge = |u| solid.is_edge(s.position.as_dvec3(), into, u);
        s.value.is_finite() && !matches!(opposite, Opposite::Turned(u) if edge(*u))
    };
    let at_sample = samples.iter().filter(wall).map(|(s, _)| {
        (s.value, s.position, surface_normal(solid.surface, s.triangle) * solid.sign as f32)
    });
    let measured = |v: &usize| {
        let s = welded[*v];
        let value = s.reason == Reason::Measured && s.value.is_finite();
        value && !solid.of_edge(surface, *v, s.opposite)
    };
    let at_vertex = (0..welded.len())
        .filter(measured)
        .map(|v| (welded[v].value, surface.positions[v], surface.normals[v] * solid.sign as f32));
    let found = at_sample.chain(at_vertex).min_by(|a, b| a.0.total_cmp(&b.0));
    let found = found.map(|(value, at, away)| {
        let (value, error) = (f64::from(value), 4.0 * solid.grain + f64::from(value) * 1e-6);
        LeastWall {
            lower: (value - error).max(0.0),
            upper: value + error,
            value,
            certified: false,
            settled: true,
            position: at.as_dvec3().to_array(),
            opposite: (at.as_dvec3() - away.as_dvec3() * value).to_array(),
            normal: away.as_dvec3().to_array(),
        }
    });
    let by_rays = by_rays.map(|w| LeastWall { certified: false, ..w });
    Ok([found, by_rays].into_iter().flatten().min_by(|a, b| a.upper.total_cmp(&b.upper)))
}

fn surface_normal(surface: &WeldedSurface, t: u32) -> Vec3 {
    surface.face_normals[t as usize]
}

/// The facets below the limit, by rays along the normal.
fn thin_facets(
    solid: &Solid<'_>,
    least: Option<LeastWall>,
    samples: &[(AreaSample, Opposite)],
    settings: &ThicknessSettings,
    query: WallQuery,
    order: &[u32],
    job: &Job,
) -> Result<Option<ThinFacets>, Cancelled> {
    if settings.method != ThicknessMethod::Ray {
        return Ok(None);
    }
    let hundredth = || {
        let mut known: Vec<f32> =
            samples.iter().map(|s| s.0.value).filter(|v| v.is_finite()).collect();
        let upper = least?.upper * 1.001;
        if known.is_empty() {
            return Some(upper);
        }
        let at = (known.len() - 1) / 100;
        let share = f64::from(*known.select_nth_unstable_by(at, f32::total_cmp).1);
        Some(share.max(upper))
    };
    let limit = query.limit.or_else(|| query.thinnest.then(hundredth).flatten());
    let Some(limit) = limit else { return Ok(None) };
    // A tie passes: walls within the tolerance of the limit are not below it.
    let below = limit - solid.tolerance();
    let found = least.is_some_and(|l| l.lower < below);
    let facets = if found { solid.thin(order, below, true, job)? } else { Vec::new() };
    Ok(Some(ThinFacets { limit, facets }))
}

/// One site's value by the chosen method. A value at a sharp vertex is marked for the edge policy.
fn one(
    caster: &Caster<'_>,
    site: &Site<'_>,
    settings: &ThicknessSettings,
    whole: &WeldedSurface,
    sharp: bool,
    scratch: &mut ConeScratch,
) -> SiteValue {
    let reason = if sharp { Reason::Edge } else { Reason::Measured };
    let by_rays = match settings.method {
        ThicknessMethod::Ray | ThicknessMethod::Cone => caster.measure(site, scratch),
        ThicknessMethod::Sphere => None,
    };
    if let Some(c) = by_rays {
        let error = c.folded.error + c.wall.map_or(0.0, |t| whole.sagitta(t));
        return SiteValue { value: c.folded.value, error, reason, opposite: c.opposite };
    }
    // If every ray of the cone leaves the solid (at a needle's tip), the ball still has a size.
    let ball = caster.wall_ball(site).or_else(|| caster.ball(site));
    ball.map_or(SiteValue::missing(Reason::NothingAhead), |b| SiteValue {
        value: b.diameter,
        error: 0.0,
        reason,
        opposite: if b.in_corner { Opposite::Corner } else { Opposite::Parallel },
    })
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
            let mut scratch = ConeScratch::default();
            let each = |&i: &u32| {
                job.check()?;
                Ok(value(i as usize, &mut scratch))
            };
            let values = chunk.iter().map(each).collect::<Result<Vec<SiteValue>, Cancelled>>()?;
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
        let settings = ThicknessSettings::default();
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
