//! Thin walls, pins, gaps and holes, and walls that are too thick: the definitions and the proofs
//! are those of [`sculptd_geometry::thickness`].

use glam::DVec3;
use sculptd_geometry::bvh::Ray;
use sculptd_geometry::job::Job;
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::thickness::check::add_places;
use sculptd_geometry::thickness::worst::ThinRegion;
use sculptd_geometry::thickness::{
    MeasuredSide, Thickness, ThicknessError, ThicknessMethod, ThicknessSettings, WallQuery,
    measure_at_places,
};

use crate::finding::{Finding, FindingKind, MOST_OF_A_KIND};
use crate::part::PreparedPart;

/// A chord across that is at most so many times the thickness makes a pin or a hole.
const ROUND: f64 = 1.5;
/// Directions in which chords across are tried.
const FAN: usize = 16;

/// Limits of walls and gaps, millimetres.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WallLimits {
    /// Thinner fails.
    pub fail_below: Option<f64>,
    /// Thinner is worth a warning.
    pub warn_below: Option<f64>,
    /// The least diameter of a pin or a hole.
    pub round: Option<f64>,
    /// The width of the nozzle or the pixel.
    pub resolution: Option<f64>,
}

impl WallLimits {
    fn largest(&self) -> Option<f64> {
        let all = [self.fail_below, self.warn_below, self.round, self.resolution];
        all.into_iter().flatten().max_by(f64::total_cmp)
    }
}

/// The part measured by one definition. A coarse part gets places to measure at.
fn measured(
    part: &PreparedPart,
    method: ThicknessMethod,
    side: MeasuredSide,
    limit: Option<f64>,
    job: &Job,
) -> Result<Thickness, ThicknessError> {
    let settings = ThicknessSettings { method, side, ..ThicknessSettings::default() };
    let mut mesh = part.centred.mesh.clone();
    let walls = add_places(&mut mesh, None, settings.crease);
    let query = WallQuery { limit, thinnest: false, grain: part.centred.grain };
    measure_at_places(&mesh, walls.as_ref(), &settings, query, job)
}

/// The walls (or the gaps) below the limits, the thinnest first.
pub fn thin_places(
    part: &PreparedPart,
    side: MeasuredSide,
    limits: &WallLimits,
    job: &Job,
) -> Result<Vec<Finding>, ThicknessError> {
    let Some(largest) = limits.largest() else { return Ok(Vec::new()) };
    let found = measured(part, ThicknessMethod::Ray, side, Some(largest), job)?;
    let slack = found.least.map_or(0.0, |l| (l.upper - l.value).max(0.0)) + 4.0 * part.centred.grain;
    let mut out = Vec::new();
    for region in found.worst(largest as f32, 0.0, MOST_OF_A_KIND + 1) {
        out.extend(judged(part, side, limits, &region, slack));
    }
    Ok(out)
}

/// What the limits say of one region.
fn judged(
    part: &PreparedPart,
    side: MeasuredSide,
    limits: &WallLimits,
    region: &ThinRegion,
    slack: f64,
) -> Option<Finding> {
    let value = f64::from(region.thickness);
    let below = |limit: Option<f64>| limit.filter(|l| value < l - slack);
    let round = is_round(part, side, region);
    let (kind, limit, severe, message) = match (side, round) {
        (MeasuredSide::Wall, false) => {
            let fails = below(limits.fail_below).or(below(limits.resolution));
            let limit = fails.or(below(limits.warn_below))?;
            let lost = below(limits.resolution).is_some();
            let message = if lost {
                format!("a wall of {value:.3} mm is too narrow to be made at all; thicken it to {limit} mm")
            } else {
                format!("a wall is {value:.3} mm thick; thicken it to {limit} mm")
            };
            (FindingKind::ThinWall, limit, fails.is_some(), message)
        }
        (MeasuredSide::Wall, true) => {
            let fails = below(limits.round).or(below(limits.fail_below));
            let limit = fails.or(below(limits.warn_below))?;
            let message = format!("a pin is {value:.3} mm across; widen it to {limit} mm");
            (FindingKind::ThinPin, limit, fails.is_some(), message)
        }
        (MeasuredSide::Gap, false) => {
            let fails = below(limits.fail_below).or(below(limits.resolution))?;
            let message =
                format!("two faces are {value:.3} mm apart; leave {fails} mm, or they may fuse");
            (FindingKind::Gap, fails, true, message)
        }
        (MeasuredSide::Gap, true) => {
            let fails = below(limits.round)?;
            let message = format!("a hole is {value:.3} mm across; widen it to {fails} mm");
            (FindingKind::Hole, fails, true, message)
        }
    };
    let place = part.to_file(DVec3::from(region.position.map(f64::from)));
    let found = Finding::new(kind, message)
        .at(place)
        .measured(value, limit, "mm")
        .over(region.area)
        .within(slack);
    Some(if severe { found } else { found.warning() })
}

/// Whether a thin region is narrow in the direction across its thickness as well.
fn is_round(part: &PreparedPart, side: MeasuredSide, region: &ThinRegion) -> bool {
    let away = DVec3::from(region.normal.map(f64::from)).normalize_or_zero();
    let thickness = f64::from(region.thickness);
    if away == DVec3::ZERO || !(thickness > 0.0) {
        return false;
    }
    let middle = DVec3::from(region.position.map(f64::from)) - away * (thickness * 0.5);
    let (u, v) = away.any_orthonormal_pair();
    let reach = |dir: DVec3| {
        let ray = Ray::new(middle.as_vec3(), dir.as_vec3());
        let ahead = |t: u32| {
            let facing = part.normals[t as usize].dot(dir);
            if side == MeasuredSide::Wall { facing > 0.0 } else { facing < 0.0 }
        };
        part.tree().closest_hit(ray, ahead).map_or(f64::INFINITY, |h| f64::from(h.t))
    };
    (0..FAN).any(|i| {
        let angle = std::f64::consts::PI * i as f64 / FAN as f64;
        let dir = u * angle.portable_cos() + v * angle.portable_sin();
        reach(dir) + reach(-dir) <= ROUND * thickness
    })
}

/// How thick a moulded part is, by the largest ball that fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallSpread {
    /// The median by area: the nominal wall.
    pub nominal: f64,
    /// The thickest wall.
    pub thickest: f64,
    /// Where it is, about the part's centre.
    pub position: DVec3,
    /// The greatest error of both.
    pub error: f64,
}

/// The nominal and the thickest wall of a part; `None` where it has no wall.
pub fn wall_spread(part: &PreparedPart, job: &Job) -> Result<Option<WallSpread>, ThicknessError> {
    let found = measured(part, ThicknessMethod::Sphere, MeasuredSide::Wall, None, job)?;
    let summary = found.summary();
    let (Some(nominal), Some(_)) = (summary.median, summary.max) else { return Ok(None) };
    let at_sample = found.samples.iter().map(|s| (s.value, s.position));
    let welded = found.welded_values();
    let at_vertex = welded.iter().copied().zip(found.surface.positions.iter().copied());
    let known = at_sample.chain(at_vertex).filter(|(v, _)| v.is_finite());
    let most = known.max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(most.map(|(thickest, position)| WallSpread {
        nominal: f64::from(nominal),
        thickest: f64::from(thickest),
        position: position.as_dvec3(),
        error: f64::from(summary.error_bound),
    }))
}
