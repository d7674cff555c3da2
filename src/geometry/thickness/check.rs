//! A part checked against limits: what the command line prints, the report shows and a batch
//! collects.

use glam::DVec3;
use serde::Serialize;

use super::preset::Preset;
use super::refine::{refine, refine_within};
use super::summary::{BeyondArea, ThicknessSummary};
use super::warnings::warnings;
use super::worst::ThinRegion;
use super::{
    Comparison, LeastWall, Thickness, ThicknessError, ThicknessMethod, ThicknessSettings,
    WallQuery, Walls, WeldedSurface, measure_at_places,
};
use crate::job::Job;
use crate::measure::measures;
use crate::{CentredMesh, TriMesh};

/// The greatest number of worst spots in the answer.
pub const SPOTS: usize = 10;

/// Places to measure at that a coarse part is given, about.
const PLACES: usize = 20_000;
/// More than this many are too many: long thin triangles take several times what their area says.
const MOST_PLACES: usize = 32_000;
/// The greatest number of times that the spacing is then widened by a quarter. A part that still
/// exceeds the limit has enough vertices and gets no places.
const WIDER: usize = 16;

/// Adds places to measure to walls that have none, and returns the walls before that. `spacing` is
/// the longest edge that stays, in millimetres. Without it, a part gets about 20,000 places if more
/// than half of its vertices are on sharp edges (by `crease`, degrees), and other parts none.
pub fn add_places(mesh: &mut TriMesh, spacing: Option<f32>, crease: f32) -> Option<Walls> {
    let told = spacing.is_some();
    let spacing = spacing.or_else(|| {
        if mesh.triangles.len() > PLACES {
            return None;
        }
        let s = WeldedSurface::new(mesh, crease.to_radians());
        let sharp = s.sharp.iter().filter(|&&s| s).count();
        let area = measures(mesh).area as f32;
        (sharp * 2 > s.sharp.len()).then(|| (area * 2.0 / PLACES as f32).sqrt())
    });
    let mut spacing = spacing.filter(|s| *s > 0.0 && s.is_finite())?;
    let fine = if told {
        refine(mesh, spacing)
    } else {
        let mut within = refine_within(mesh, spacing, MOST_PLACES);
        for _ in 0..WIDER {
            if within.is_some() {
                break;
            }
            spacing *= 1.25;
            within = refine_within(mesh, spacing, MOST_PLACES);
        }
        within?
    };
    let whole = std::mem::replace(mesh, fine.mesh);
    Some(Walls { mesh: whole, of: fine.of })
}

/// Limits, millimetres. A value fails when it is strictly below, or strictly above.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ThicknessLimits {
    /// Thinner than this asks for a second look.
    pub warn_below: Option<f32>,
    /// Thinner than this fails.
    pub fail_below: Option<f32>,
    /// Thicker than this fails.
    pub fail_above: Option<f32>,
    /// A larger ratio between neighbouring walls asks for a second look.
    pub neighbour_ratio: Option<f32>,
    /// Regions smaller than this, square millimetres, are not defects.
    pub minimum_area: f64,
}

impl ThicknessLimits {
    /// Returns these limits, each replaced by that of `other` where `other` has one; the area is
    /// always that of `other`.
    pub fn replaced_by(self, other: ThicknessLimits) -> ThicknessLimits {
        ThicknessLimits {
            warn_below: other.warn_below.or(self.warn_below),
            fail_below: other.fail_below.or(self.fail_below),
            fail_above: other.fail_above.or(self.fail_above),
            neighbour_ratio: other.neighbour_ratio.or(self.neighbour_ratio),
            minimum_area: other.minimum_area,
        }
    }

    /// Returns true if every limit is finite and above 0, and the area is at least 0.
    pub fn is_valid(&self) -> bool {
        let given = [self.fail_below, self.warn_below, self.fail_above, self.neighbour_ratio];
        given.into_iter().flatten().all(|l| l > 0.0 && l.is_finite()) && self.minimum_area >= 0.0
    }
}

impl From<&Preset> for ThicknessLimits {
    fn from(p: &Preset) -> Self {
        ThicknessLimits {
            warn_below: Some(p.warn_below),
            fail_below: Some(p.fail_below),
            fail_above: p.fail_above,
            neighbour_ratio: p.neighbour_ratio,
            minimum_area: 0.0,
        }
    }
}

/// The verdict of the limits on a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// No limit was given, or nothing could be measured.
    Unjudged,
    /// Every value is within the limits.
    Pass,
    /// A value is beyond the warning limit.
    Warn,
    /// A value fails.
    Fail,
    /// The limit lies between the bounds of the least wall.
    Undecided,
}

/// The share of the area on the wrong side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AreaBeyond {
    /// The limit, millimetres.
    pub limit: f32,
    /// Of the area that has values, 0 to 100.
    pub area_percent: f64,
    /// The greatest error of `area_percent`.
    pub error_percent: f64,
}

/// A spot in the file's own coordinates (in millimetres).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WorstSpot {
    /// Of its thinnest vertex.
    pub position: [f64; 3],
    /// At its thinnest vertex, millimetres.
    pub thickness: f32,
    /// Square millimetres.
    pub area: f64,
    /// Welded vertices in the region.
    pub vertices: u32,
}

/// The answer of `sculptd thickness --json`.
#[derive(Debug, Clone, Serialize)]
pub struct ThicknessAnswer {
    /// The name of the file as it was given.
    pub file: String,
    /// The definition of thickness.
    pub method: ThicknessMethod,
    /// Rays a place; 1 for the sphere.
    pub rays: usize,
    /// All settings.
    pub settings: ThicknessSettings,
    /// The limits that the part was compared with.
    pub limits: ThicknessLimits,
    /// The verdict of the limits.
    pub verdict: Verdict,
    /// The least wall between two bounds; `null` where no place has a wall.
    pub least: Option<LeastWall>,
    /// The conclusion from the bounds, in one sentence.
    pub statement: String,
    /// The statistics, flattened into this object in JSON.
    #[serde(flatten)]
    pub summary: ThicknessSummary,
    /// The area below the failing limit, or the warning one.
    pub below: Option<AreaBeyond>,
    /// The area above the upper limit.
    pub above: Option<AreaBeyond>,
    /// Vertices whose value differs from a neighbour's by more than the limit's ratio.
    pub uneven: Option<u64>,
    /// At most [`SPOTS`] regions, the thinnest first.
    pub worst: Vec<WorstSpot>,
    /// Vertices in the file.
    pub vertices: usize,
    /// Triangles in the file, its polygons cut.
    pub triangles: usize,
    /// Vertices that were measured: more than the file has, where a coarse part was refined.
    pub places: usize,
    /// Cubic millimetres.
    pub volume: f64,
    /// Square millimetres.
    pub area: f64,
    /// Extents along x, y and z, millimetres.
    pub dimensions: [f64; 3],
    /// The duration of the measurement.
    pub seconds: f64,
    /// Rays over seconds.
    pub rays_per_second: f64,
    /// The faults of the mesh, one sentence each.
    pub warnings: Vec<String>,
}

/// An answer with what it was made from.
#[derive(Debug, Clone)]
pub struct CheckedPart {
    /// The answer.
    pub answer: ThicknessAnswer,
    /// The values at every vertex.
    pub thickness: Thickness,
    /// In the part's coordinates, in the order of `answer.worst`.
    pub spots: Vec<ThinRegion>,
}

/// Measures `part`, whose walls are `walls` where [`add_places`] gave them, and judges it.
/// `seconds` reads a clock that the caller started.
pub fn check(
    file: &str,
    part: &CentredMesh,
    walls: Option<&Walls>,
    settings: &ThicknessSettings,
    limits: ThicknessLimits,
    job: &Job,
    seconds: impl Fn() -> f64,
) -> Result<CheckedPart, ThicknessError> {
    let began = seconds();
    let asked = limits.fail_below.or(limits.warn_below);
    let query =
        WallQuery { limit: asked.map(f64::from), thinnest: asked.is_none(), grain: part.grain };
    let thickness = measure_at_places(&part.mesh, walls, settings, query, job)?;
    let took = seconds() - began;
    let mut summary = thickness.summary();
    let in_file = |p: [f32; 3]| part.to_file(p.into()).as_vec3().to_array();
    summary.thinnest = summary.thinnest.map(in_file);
    summary.thickest = summary.thickest.map(in_file);
    let sizes = measures(&part.mesh);
    // Without a limit the thinnest hundredth of the area is shown.
    let limit = asked;
    let shown = thickness.thin.as_ref().map(|t| t.limit as f32);
    let spot_limit = limit.or(shown).or_else(|| thickness.quantile(0.01).map(f32::next_up));
    let spots = spot_limit.map_or(Vec::new(), |l| {
        let least = if limit.is_some() { limits.minimum_area } else { 0.0 };
        thickness.worst(l, least, SPOTS)
    });
    let beyond = |limit: f32, above: bool| {
        let BeyondArea { area, error, all } = thickness.area_beyond(limit, above);
        let percent = |area: f64| if all > 0.0 { 100.0 * area / all } else { 0.0 };
        AreaBeyond { limit, area_percent: percent(area), error_percent: percent(error) }
    };
    let uneven = limits.neighbour_ratio.map(|r| {
        let ratios = thickness.neighbour_ratio(1.0);
        ratios.iter().filter(|&&x| x > r).count() as u64
    });
    let compared = |limit: Option<f32>| {
        let Some(limit) = limit else { return Comparison::Reached };
        let found = thickness.compare(limit);
        // Below the limit, but nowhere on as much area as makes a defect.
        let small =
            limits.minimum_area > 0.0 && thickness.worst(limit, limits.minimum_area, 1).is_empty();
        if small { Comparison::Reached } else { found }
    };
    let room = 8.0 * thickness.rounding;
    let too_thick = limits.fail_above.is_some_and(|l| summary.max.is_some_and(|m| m - room > l));
    let (fails, warns) = (compared(limits.fail_below), compared(limits.warn_below));
    let verdict = if fails == Comparison::Below || too_thick {
        Verdict::Fail
    } else if fails == Comparison::Undecided {
        Verdict::Undecided
    } else if warns != Comparison::Reached || uneven.is_some_and(|n| n > 0) {
        Verdict::Warn
    } else if summary.min.is_some()
        && limits.fail_below.or(limits.warn_below).or(limits.fail_above).is_some()
    {
        Verdict::Pass
    } else {
        Verdict::Unjudged
    };
    let moved = |p: [f64; 3]| (DVec3::from(p) + part.centre).to_array();
    let least = thickness.least.map(|l| LeastWall {
        position: moved(l.position),
        opposite: moved(l.opposite),
        ..l
    });
    let size = sizes.dimensions.iter().copied().fold(0.0f64, f64::max) as f32;
    let place = |s: &ThinRegion| WorstSpot {
        position: part.to_file(s.position.into()).to_array(),
        thickness: s.thickness,
        area: s.area,
        vertices: s.vertices,
    };
    let answer = ThicknessAnswer {
        file: file.into(),
        method: settings.method,
        rays: settings.rays_at_a_place(),
        settings: *settings,
        limits,
        verdict,
        below: limit.map(|l| beyond(l, false)),
        above: limits.fail_above.map(|l| beyond(l, true)),
        uneven,
        statement: statement(least, limits.fail_below.or(limits.warn_below), &thickness),
        least,
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
    Ok(CheckedPart { answer, thickness, spots })
}

/// Returns the sentence that compares the bounds of the least wall with a limit.
fn statement(least: Option<LeastWall>, limit: Option<f32>, thickness: &Thickness) -> String {
    let Some(l) = least else {
        return "no place has a wall: each belongs to an edge or meets nothing".into();
    };
    let how = if l.certified { "certified" } else { "sampled, not certified" };
    let [x, y, z] = l.position;
    let (lower, upper) = (digits(l.lower), digits(l.upper));
    match limit.map(|limit| (limit, thickness.compare(limit))) {
        Some((limit, Comparison::Reached)) => {
            format!("no wall below {} mm ({how})", digits(f64::from(limit)))
        }
        Some((_, Comparison::Undecided)) => {
            format!("undecided between {lower} and {upper} mm: raise the effort")
        }
        _ => format!("wall of {lower} to {upper} mm at ({x:.3}, {y:.3}, {z:.3}) ({how})"),
    }
}

/// Six digits, at least three of them after the point.
fn digits(value: f64) -> String {
    let before = if value > 0.0 { value.log10().floor() as i32 + 1 } else { 1 };
    format!("{value:.*}", (6 - before).clamp(3, 12) as usize)
}
