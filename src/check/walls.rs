//! Thin walls, pins, gaps and holes, and walls that are too thick: the definitions and the proofs
//! are those of [`sculptd_geometry::thickness`].

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sculptd_geometry::bvh::Ray;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::thickness::ray::{Caster, Site};
use sculptd_geometry::thickness::side_cones::SideCones;
use sculptd_geometry::thickness::worst::ThinRegion;
use sculptd_geometry::thickness::{Cone, Correction, MeasuredSide, Outliers, Weights, walls_below};

use crate::columns::surface_points;
use crate::finding::{Finding, FindingKind, MOST_OF_A_KIND};
use crate::part::PreparedPart;

/// The longest chord across a pin or a hole, in thicknesses.
const ROUND: f64 = 1.5;
/// Directions in which chords across are tried.
const FAN: usize = 16;
/// The distance from a thin place, in thicknesses, at which an extended wall is looked for.
const BESIDE: f64 = 2.0;
/// Balls that are laid against the surface, and the largest of them that are moved along it.
const BALLS: usize = 1 << 13;
const CLIMBED: usize = 24;

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

/// The walls (or the gaps) below the limits, the thinnest first.
pub fn thin_places(
    part: &PreparedPart,
    side: MeasuredSide,
    limits: &WallLimits,
    job: &Job,
) -> Result<Vec<Finding>, Cancelled> {
    let Some(largest) = limits.largest() else { return Ok(Vec::new()) };
    let grain = part.centred.grain;
    let found = walls_below(part.surface(), part.tree(), side, largest, grain, job)?;
    let slack = 4.0 * (grain + part.rounding());
    let mut out = Vec::new();
    for region in found.regions(0.0, MOST_OF_A_KIND + 1) {
        out.extend(judged(part, side, limits, &region, slack));
    }
    Ok(out)
}

/// Compares one region with the limits.
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
                format!(
                    "a wall of {value:.3} mm is too narrow to be made at all; thicken it to \
                     {limit} mm"
                )
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

/// Returns true if a thin region is narrow in every direction: from none of the places around it
/// that have the same thickness does it extend in two directions.
fn is_round(part: &PreparedPart, side: MeasuredSide, region: &ThinRegion) -> bool {
    let away = DVec3::from(region.normal.map(f64::from)).normalize_or_zero();
    let thickness = f64::from(region.thickness);
    if away == DVec3::ZERO || !(thickness > 0.0) {
        return false;
    }
    let middle = DVec3::from(region.position.map(f64::from)) - away * (thickness * 0.5);
    let (u, v) = away.any_orthonormal_pair();
    let fan = |i: usize| {
        let angle = std::f64::consts::PI * i as f64 / FAN as f64;
        u * angle.portable_cos() + v * angle.portable_sin()
    };
    let reach = |from: DVec3, dir: DVec3| {
        let ray = Ray::new(from.as_vec3(), dir.as_vec3());
        let ahead = |t: u32| {
            let facing = part.normals[t as usize].dot(dir);
            if side == MeasuredSide::Wall { facing > 0.0 } else { facing < 0.0 }
        };
        part.tree().closest_hit(ray, ahead).map_or(f64::INFINITY, |h| f64::from(h.t))
    };
    let narrow =
        |from: DVec3, dir: DVec3| reach(from, dir) + reach(from, -dir) <= ROUND * thickness;
    let extends = |dir: DVec3| {
        let from = middle + dir * (BESIDE * thickness);
        reach(middle, dir) >= (BESIDE + 0.5) * thickness
            && narrow(from, away)
            && !(0..FAN).any(|i| narrow(from, fan(i)))
    };
    !(0..FAN).any(|i| extends(fan(i)) || extends(-fan(i)))
}

/// The walls of a moulded part, by the largest ball that fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallSpread {
    /// The median by area: the nominal wall.
    pub nominal: f64,
    /// The thickest wall that was found: a ball of this diameter fits.
    pub thickest: f64,
    /// The centre of that ball, about the part's centre.
    pub position: DVec3,
    /// The rounding of both.
    pub error: f64,
}

/// The nominal and the thickest wall of a part, by the balls that rest on places spread over its
/// surface; the thickest are moved along the surface to where they are largest. `None` where no
/// ball is bounded.
pub fn wall_spread(part: &PreparedPart, job: &Job) -> Result<Option<WallSpread>, Cancelled> {
    let normals: Vec<Vec3> = part.normals.iter().map(|n| n.as_vec3()).collect();
    let cone = Cone::new(1, 0.0, Weights::Plain);
    let caster = Caster {
        tree: part.tree(),
        face_normals: &normals,
        corner_normals: &[],
        sign: 1.0,
        cone: &cone,
        outliers: Outliers::Keep,
        correction: Correction::None,
        acute: None,
    };
    let cones = SideCones::new(part.tree(), &normals);
    let ball = |p: DVec3, t: u32, least: f64| {
        let corners = part.corners(t)?;
        let site = Site {
            point: p.as_vec3(),
            away: normals[t as usize],
            along: (corners[1] - corners[0]).as_vec3(),
            own: &[t],
            clear: f32::INFINITY,
        };
        let found = caster.ball_above(&site, least as f32, &cones);
        found.map(|b| f64::from(b.diameter)).filter(|d| d.is_finite())
    };
    let points = surface_points(part, BALLS);
    let found: Vec<Option<f64>> = points
        .par_iter()
        .map(|&(p, t)| job.check().map(|()| ball(p, t, f64::NEG_INFINITY)))
        .collect::<Result<_, Cancelled>>()?;
    let mut balls: Vec<(f64, DVec3, u32)> =
        points.iter().zip(found).filter_map(|(&(p, t), d)| Some((d?, p, t))).collect();
    balls.sort_by(|a, b| b.0.total_cmp(&a.0));
    let Some(nominal) = balls.get(balls.len() / 2).map(|b| b.0) else { return Ok(None) };
    let spacing = (part.areas.iter().sum::<f64>() / BALLS as f64).sqrt();
    let least = spacing * 1e-4;
    let best: Vec<(f64, DVec3, u32)> = balls
        .par_iter()
        .take(CLIMBED)
        .map(|&(mut d, mut p, mut t)| {
            let mut step = 2.0 * spacing;
            while step > least {
                job.check()?;
                let (u, v) = part.normals[t as usize].any_orthonormal_pair();
                let around = (0..8).filter_map(|i| {
                    let turn = std::f64::consts::FRAC_PI_4 * f64::from(i);
                    let side = u * turn.portable_cos() + v * turn.portable_sin();
                    let near = part.tree().nearest(p + side * step, 2.0 * step)?;
                    Some((ball(near.point, near.triangle, d)?, near.point, near.triangle))
                });
                match around.max_by(|a, b| a.0.total_cmp(&b.0)) {
                    Some(better) => (d, p, t) = better,
                    None => step *= 0.5,
                }
            }
            Ok((d, p, t))
        })
        .collect::<Result<_, Cancelled>>()?;
    let most = best.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    Ok(most.map(|(thickest, p, t)| WallSpread {
        nominal,
        thickest,
        position: p - part.normals[t as usize] * (thickest * 0.5),
        error: 8.0 * part.rounding() + thickest * 2e-5,
    }))
}
