//! A part checked against limits: what the command line prints, the report shows and a batch
//! collects.

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::preset::Preset;
use super::refine::refine;
use super::summary::Summary;
use super::warnings::warnings;
use super::worst::Spot;
use super::{Method, Refused, Settings, Surface, Thickness, measure};
use crate::job::Job;
use crate::measure::measures;
use crate::{PolyMesh, TriMesh};

/// Worst spots that are told.
pub const SPOTS: usize = 10;

/// Places to measure at that a coarse part is given.
const PLACES: usize = 20_000;

/// A file's mesh about its own centre in single precision, scaled to millimetres.
#[derive(Debug, Clone)]
pub struct Part {
    pub mesh: TriMesh,
    /// Vertices and triangles in the file.
    pub counts: [usize; 2],
    /// Added to the mesh's coordinates, gives the file's, scaled.
    pub centre: DVec3,
}

impl Part {
    /// `scale` is millimetres per unit of the file. A part far from the origin loses no precision
    /// here.
    pub fn new(poly: &PolyMesh, scale: f64) -> Part {
        let (lo, hi) = poly
            .positions
            .iter()
            .filter(|p| p.is_finite())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let centre = if lo.x <= hi.x { (lo + hi) * 0.5 } else { DVec3::ZERO };
        let (mut mesh, _) = poly.triangulate();
        mesh.positions = poly.positions.iter().map(|&p| ((p - centre) * scale).as_vec3()).collect();
        let counts = [mesh.positions.len(), mesh.triangles.len()];
        Part { mesh, counts, centre: centre * scale }
    }

    /// Puts places to measure on walls that have none. `spacing` is the longest edge that stays,
    /// millimetres; without it, a part of which more than half of the vertices lie on sharp edges
    /// gets about [`PLACES`] of them, other parts none.
    pub fn refine(&mut self, spacing: Option<f32>, crease: f32) {
        let spacing = spacing.or_else(|| {
            if self.mesh.triangles.len() > PLACES {
                return None;
            }
            let s = Surface::new(&self.mesh, crease.to_radians());
            let sharp = s.sharp.iter().filter(|&&s| s).count();
            let area = measures(&self.mesh).area as f32;
            (sharp * 2 > s.sharp.len()).then(|| (area * 2.0 / PLACES as f32).sqrt())
        });
        if let Some(spacing) = spacing.filter(|s| *s > 0.0 && s.is_finite()) {
            self.mesh = refine(&self.mesh, spacing);
        }
    }

    fn place(&self, p: [f32; 3]) -> [f64; 3] {
        (Vec3::from(p).as_dvec3() + self.centre).to_array()
    }
}

/// Limits, millimetres. A value fails when it is strictly below, or strictly above.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Limits {
    pub warn_below: Option<f32>,
    pub fail_below: Option<f32>,
    pub fail_above: Option<f32>,
    pub neighbour_ratio: Option<f32>,
    /// Regions smaller than this, square millimetres, are not defects.
    pub minimum_area: f64,
}

impl From<&Preset> for Limits {
    fn from(p: &Preset) -> Self {
        Limits {
            warn_below: Some(p.warn_below),
            fail_below: Some(p.fail_below),
            fail_above: p.fail_above,
            neighbour_ratio: p.neighbour_ratio,
            minimum_area: 0.0,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No limit was given, or nothing could be measured.
    Unjudged,
    Pass,
    Warn,
    Fail,
}

/// The share of the area on the wrong side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Beyond {
    pub limit: f32,
    pub area_percent: f64,
}

/// A spot in the file's own coordinates (in millimetres).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WorstSpot {
    pub position: [f64; 3],
    pub thickness: f32,
    pub area: f64,
    pub vertices: u32,
}

/// The answer of `sculptd thickness --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Answer {
    pub file: String,
    pub method: Method,
    pub rays: usize,
    pub settings: Settings,
    pub limits: Limits,
    pub verdict: Verdict,
    #[serde(flatten)]
    pub summary: Summary,
    pub below: Option<Beyond>,
    pub above: Option<Beyond>,
    /// Vertices whose value differs from a neighbour's by more than the limit's ratio.
    pub uneven: Option<u64>,
    pub worst: Vec<WorstSpot>,
    pub vertices: usize,
    pub triangles: usize,
    /// Vertices that were measured: more than the file has, where a coarse part was refined.
    pub places: usize,
    pub volume: f64,
    pub area: f64,
    pub dimensions: [f64; 3],
    pub seconds: f64,
    pub rays_per_second: f64,
    pub warnings: Vec<String>,
}

/// An answer with what it was made from.
#[derive(Debug, Clone)]
pub struct Checked {
    pub answer: Answer,
    pub thickness: Thickness,
    /// In the part's coordinates, in the order of `answer.worst`.
    pub spots: Vec<Spot>,
}

/// Measures `part` and judges it. `seconds` reads a clock that the caller started.
pub fn check(
    file: &str,
    part: &Part,
    settings: &Settings,
    limits: Limits,
    job: &Job,
    seconds: impl Fn() -> f64,
) -> Result<Checked, Refused> {
    let began = seconds();
    let thickness = measure(&part.mesh, settings, job)?;
    let took = seconds() - began;
    let summary = thickness.summary();
    let sizes = measures(&part.mesh);
    // Without a limit the thinnest hundredth of the vertices is shown.
    let limit = limits.fail_below.or(limits.warn_below);
    let spot_limit = limit.or_else(|| thickness.quantile(0.01).map(f32::next_up));
    let spots = spot_limit.map_or(Vec::new(), |l| {
        let least = if limit.is_some() { limits.minimum_area } else { 0.0 };
        thickness.worst(l, least, SPOTS)
    });
    let beyond = |limit: f32, above: bool| {
        let (out, all) = thickness.area_beyond(limit, above);
        Beyond { limit, area_percent: if all > 0.0 { 100.0 * out / all } else { 0.0 } }
    };
    let uneven = limits.neighbour_ratio.map(|r| {
        let ratios = thickness.neighbour_ratio(1.0);
        ratios.iter().filter(|&&x| x > r).count() as u64
    });
    let broken = |limit: Option<f32>| {
        limit.is_some_and(|l| {
            if limits.minimum_area > 0.0 {
                !thickness.worst(l, limits.minimum_area, 1).is_empty()
            } else {
                summary.min.is_some_and(|m| m < l)
            }
        })
    };
    let too_thick = limits.fail_above.is_some_and(|l| summary.max.is_some_and(|m| m > l));
    let verdict = if broken(limits.fail_below) || too_thick {
        Verdict::Fail
    } else if broken(limits.warn_below) || uneven.is_some_and(|n| n > 0) {
        Verdict::Warn
    } else if summary.min.is_some()
        && limits.fail_below.or(limits.warn_below).or(limits.fail_above).is_some()
    {
        Verdict::Pass
    } else {
        Verdict::Unjudged
    };
    let size = sizes.dimensions.iter().copied().fold(0.0f64, f64::max) as f32;
    let place = |s: &Spot| WorstSpot {
        position: part.place(s.position),
        thickness: s.thickness,
        area: s.area,
        vertices: s.vertices,
    };
    let answer = Answer {
        file: file.into(),
        method: settings.method,
        rays: if settings.method == Method::Ray { settings.rays } else { 1 },
        settings: *settings,
        limits,
        verdict,
        below: limit.map(|l| beyond(l, false)),
        above: limits.fail_above.map(|l| beyond(l, true)),
        uneven,
        worst: spots.iter().map(place).collect(),
        vertices: part.counts[0],
        triangles: part.counts[1],
        places: part.mesh.positions.len(),
        volume: sizes.volume,
        area: sizes.area,
        dimensions: sizes.dimensions,
        seconds: took,
        rays_per_second: if took > 0.0 { thickness.queries as f64 / took } else { 0.0 },
        warnings: warnings(&thickness.surface.faults, &summary, size),
        summary,
    };
    Ok(Checked { answer, thickness, spots })
}
