//! The direction in which to build a part: least support, then least overhang, fewest islands, a
//! first layer on which it stands, lowest, and largest first layer, in this order.
//!
//! Directions all over the sphere are tried with a sample of the overhangs, the best are refined,
//! and then measured in full beside the six axes, the part as it is, and its large flat faces put
//! on the plate. So the first one is never worse than any of these.

use glam::{DQuat, DVec3};
use rayon::prelude::*;
use sculptd_geometry::flat_region::large_faces;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::projection::spread_directions;
use serde::Serialize;

use crate::columns::{CELLS, CellSum, cell_area, column, point_in, support_columns};
use crate::layers::overhangs::overhang_faces;
use crate::layers::placement::{covers, first_layer, tip_angle};
use crate::layers::plate::PlateContact;
use crate::layers::sweep::sweep;
use crate::moulding::ring;
use crate::part::{PreparedPart, Standing};
use crate::settings::CheckSettings;

/// Directions of a hemisphere that are tried; the opposite ones are tried as well.
const DIRECTIONS: usize = 512;
/// Columns of support that a direction is tried with.
const COLUMNS: usize = 1024;
/// Directions that are refined.
const REFINED: usize = 10;
/// Flat faces that are put on the plate.
const FLAT_FACES: usize = 12;
/// The least share of the surface of such a face.
const FLAT_SHARE: f64 = 0.005;
/// Directions within this angle, degrees, of a better one are not listed.
const NEAR: f64 = 3.0;
/// The number of orientations in an answer.
const LISTED: usize = 12;

/// A build direction and what it costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Orientation {
    /// The build direction in the file's frame, of unit length.
    pub direction: [f64; 3],
    /// The volume of support, mm3.
    pub support_volume: f64,
    /// One standard deviation of `support_volume`.
    pub support_error: f64,
    /// The area of the overhangs, mm2.
    pub overhang_area: f64,
    /// The number of contours that begin with nothing below them.
    pub islands: usize,
    /// The height of the part, mm.
    pub height: f64,
    /// The area of the first layer, mm2.
    pub contact_area: f64,
    /// True if the first layer is large enough, and the part does not fall from it.
    pub stands: bool,
}

/// The outcome of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OrientationSearch {
    /// The best first.
    pub orientations: Vec<Orientation>,
    /// The part as it is.
    pub as_it_is: Orientation,
    /// Why the first is better than the part as it is; empty where it is not.
    pub reasons: Vec<String>,
    /// Directions that were tried.
    pub tried: usize,
}

/// A direction as it was tried.
#[derive(Debug, Clone, Copy)]
struct Trial {
    up: DVec3,
    support: f64,
    area: f64,
    height: f64,
}

/// Searches for the direction in which `part` is built best.
pub fn orientations(
    part: &PreparedPart,
    settings: &CheckSettings,
    job: &Job,
) -> Result<Option<OrientationSearch>, Cancelled> {
    let Some(as_it_is) = measured(part, settings, settings.up, job)? else { return Ok(None) };
    let half = spread_directions(DIRECTIONS);
    let sphere: Vec<DVec3> = half.iter().flat_map(|&d| [d, -d]).collect();
    let flat = large_faces(&part.centred.mesh, FLAT_SHARE);
    let mut fixed = vec![settings.up];
    fixed.extend([DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|d| [d, -d]));
    fixed.extend(flat.iter().take(FLAT_FACES).map(|f| -f.normal));
    let grain = volume_grain(part);
    let rate = |tried: &[DVec3]| -> Result<Vec<Trial>, Cancelled> {
        tried.par_iter().map(|&d| job.check().map(|()| tried_at(part, settings, d))).collect()
    };
    let order = |a: &Trial, b: &Trial| {
        let bucket = |t: &Trial| (t.support / grain).round();
        let by = bucket(a).total_cmp(&bucket(b)).then(a.area.total_cmp(&b.area));
        by.then(a.height.total_cmp(&b.height))
    };
    let mut rated = rate(&sphere)?;
    let mut tried = rated.len();
    rated.sort_by(order);
    rated.truncate(REFINED);
    let mut step = 4f64.to_radians();
    for _ in 0..3 {
        let around: Vec<DVec3> = rated.iter().flat_map(|r| ring(r.up, step)).collect();
        tried += around.len();
        rated.extend(rate(&around)?);
        rated.sort_by(order);
        rated.truncate(REFINED);
        step *= 0.35;
    }
    let mut directions: Vec<DVec3> = Vec::new();
    for d in fixed.into_iter().chain(rated.iter().map(|r| r.up)) {
        if directions.iter().all(|o| o.dot(d) < 1.0 - 1e-9) {
            directions.push(d);
        }
    }
    tried += directions.len();
    let mut found = Vec::new();
    for d in directions {
        found.extend(measured(part, settings, d, job)?);
    }
    found.sort_by(|a, b| compare(a, b, grain));
    // Of directions that are nearly one, the best is listed.
    let mut listed: Vec<Orientation> = Vec::new();
    for o in found {
        let near = |l: &Orientation| {
            DVec3::from(l.direction).dot(DVec3::from(o.direction))
                > NEAR.to_radians().portable_cos()
        };
        if !listed.iter().any(near) {
            listed.push(o);
        }
    }
    let mut found = listed;
    found.truncate(LISTED);
    let reasons = found.first().map_or(Vec::new(), |best| reasons(best, &as_it_is, grain));
    Ok(Some(OrientationSearch { orientations: found, as_it_is, reasons, tried }))
}

/// The turn that makes a build direction the z axis.
pub fn turn_upright(direction: DVec3) -> DQuat {
    DQuat::from_rotation_arc(direction.normalize_or(DVec3::Z), DVec3::Z)
}

/// Volumes that differ by less are one.
fn volume_grain(part: &PreparedPart) -> f64 {
    let [x, y, z] = part.sizes.dimensions;
    (x * y * z * 1e-6).max(f64::MIN_POSITIVE)
}

fn compare(a: &Orientation, b: &Orientation, grain: f64) -> std::cmp::Ordering {
    let bucket = |v: f64, g: f64| (v / g).round();
    let area = grain.powf(2.0 / 3.0);
    bucket(a.support_volume, grain)
        .total_cmp(&bucket(b.support_volume, grain))
        .then(bucket(a.overhang_area, area).total_cmp(&bucket(b.overhang_area, area)))
        .then(a.islands.cmp(&b.islands))
        .then(b.stands.cmp(&a.stands))
        .then(bucket(a.height, area.sqrt()).total_cmp(&bucket(b.height, area.sqrt())))
        .then(b.contact_area.total_cmp(&a.contact_area))
}

fn reasons(best: &Orientation, now: &Orientation, grain: f64) -> Vec<String> {
    let mut out = Vec::new();
    if compare(best, now, grain).is_ge() {
        return out;
    }
    let mut price = Vec::new();
    let mut say = |what: &str, new: f64, old: f64, digits: usize, unit: &str| {
        let (a, b) = (format!("{new:.digits$}"), format!("{old:.digits$}"));
        let gained = if what == "first layer" { new > old } else { new < old };
        if a != b {
            let text = format!("{what} {a} instead of {b}{unit}");
            if gained { out.push(text) } else { price.push(text) }
        }
    };
    say("support volume", best.support_volume, now.support_volume, 1, " mm3");
    say("overhang area", best.overhang_area, now.overhang_area, 1, " mm2");
    say("islands", best.islands as f64, now.islands as f64, 0, "");
    say("height", best.height, now.height, 1, " mm");
    say("first layer", best.contact_area, now.contact_area, 1, " mm2");
    if best.stands && !now.stands {
        out.push("the part stands on its first layer".into());
    }
    if !price.is_empty() {
        out.push(format!("at the price of {}", price.join(" and ")));
    }
    out
}

/// The cost of a direction, in full. `None` for a part without faces.
pub fn measured(
    part: &PreparedPart,
    settings: &CheckSettings,
    up: DVec3,
    job: &Job,
) -> Result<Option<Orientation>, Cancelled> {
    let layer = settings.layer();
    let Some(stand) = part.standing(up, layer) else { return Ok(None) };
    let (mut support, mut area) = (CellSum::default(), 0.0);
    if let Some(limit) = settings.process.overhang {
        let faces = overhang_faces(part, &stand, limit);
        area = faces.iter().fold(0.0, |sum, &t| sum + part.areas[t as usize]);
        let columns = support_columns(part, &stand, &faces, cell_area(part, CELLS), job)?;
        columns.iter().for_each(|c| support.add(c));
    }
    let islands = if settings.process.islands {
        let contact = PlateContact::new(part, &stand);
        sweep(part, &stand, &contact, layer, true, job)?.islands.len()
    } else {
        0
    };
    let first = first_layer(part, &stand, layer);
    let tip = part.sizes.centroid.map(|c| tip_angle(&stand, &first, c));
    let least = settings.process.contact_area.unwrap_or(0.0);
    let stands = covers(part, first.area, least)
        && settings.process.tip_angle.is_none_or(|l| tip.is_some_and(|t| t >= l));
    Ok(Some(Orientation {
        direction: up.to_array(),
        support_volume: support.total,
        support_error: support.error(),
        overhang_area: area,
        islands,
        height: stand.top - stand.plate,
        contact_area: first.area,
        stands,
    }))
}

/// The cost of a direction, by a sample of its overhangs.
fn tried_at(part: &PreparedPart, settings: &CheckSettings, up: DVec3) -> Trial {
    let (mut plate, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in &part.places {
        let h = p.dot(up);
        plate = plate.min(h);
        top = top.max(h);
    }
    let height = top - plate;
    let Some(limit) = settings.process.overhang else {
        return Trial { up, support: 0.0, area: 0.0, height };
    };
    let least = -limit.to_radians().portable_sin();
    let slack = part.tolerance.max(0.05 * settings.layer());
    let names = &part.topology().triangles;
    let on_plate =
        |t: usize| names[t].iter().all(|&v| part.places[v as usize].dot(up) <= plate + slack);
    let (mut sums, mut sum, mut area) = (Vec::new(), 0.0, 0.0);
    for (t, n) in part.normals.iter().enumerate() {
        let rise = n.dot(up);
        if rise < least && !on_plate(t) {
            area += part.areas[t];
            sum -= part.areas[t] * rise;
            sums.push((sum, t as u32));
        }
    }
    if sums.is_empty() {
        return Trial { up, support: 0.0, area, height };
    }
    let stand = Standing { up, heights: Vec::new(), plate, top, slack };
    let step = sum / COLUMNS as f64;
    let mut support = 0.0;
    for i in 0..COLUMNS {
        let at = (i as f64 + 0.5) * step;
        let k = sums.partition_point(|s| s.0 < at).min(sums.len() - 1);
        let Some(corners) = part.corners(sums[k].1) else { continue };
        support += column(part, &stand, point_in(corners, i)) * step;
    }
    Trial { up, support, area, height }
}
