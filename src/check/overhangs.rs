//! Faces that look down: overhangs by angle, as connected regions, and the bridges among them.

use glam::DVec3;
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;

use crate::bridge::bridge_span;
use crate::columns::{CellSum, support_columns};
use crate::part::{PreparedPart, Standing};

/// Angles that differ by less, degrees, are one: the rounding of normals of small faces.
const ANGLE_SLACK: f64 = 0.01;
/// A face within this of the horizontal, degrees, is flat.
const FLAT: f64 = 1.0;

/// A connected region of faces.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceRegion {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// The sum of their areas.
    pub area: f64,
    /// The centre of the face of the region that is nearest to the region's centre.
    pub position: DVec3,
}

/// A region that looks down more steeply than a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct OverhangRegion {
    /// The region.
    pub region: FaceRegion,
    /// The largest angle from the vertical, degrees.
    pub angle: f64,
    /// The span of a flat ceiling that is held on two sides or more.
    pub bridge: Option<f64>,
    /// The volume of the support under it.
    pub support: CellSum,
}

/// The angle of a face from the vertical, degrees; negative where it looks up.
pub fn overhang_angle(normal: DVec3, up: DVec3) -> f64 {
    90.0 - (-normal.dot(up)).clamp(-1.0, 1.0).portable_acos().to_degrees()
}

/// The triangles that look down more steeply than `limit` (degrees from the vertical) and do not
/// lie on the plate, ascending.
pub fn overhang_faces(part: &PreparedPart, stand: &Standing, limit: f64) -> Vec<u32> {
    let least = -(limit + ANGLE_SLACK).to_radians().portable_sin();
    let names = &part.topology().triangles;
    (0..part.triangles() as u32)
        .filter(|&t| {
            part.areas[t as usize] > 0.0
                && part.normals[t as usize].dot(stand.up) < least
                && !stand.on_plate(&names[t as usize])
        })
        .collect()
}

/// The connected regions of some triangles, the largest first.
pub fn connected(part: &PreparedPart, faces: &[u32]) -> Vec<FaceRegion> {
    let place = |t: u32| faces.binary_search(&t).ok();
    let mut sets = DisjointSets::new(faces.len());
    for (i, &t) in faces.iter().enumerate() {
        for k in 0..3 {
            if let Some(j) = part.across(t, k).filter(|&u| u > t).and_then(place) {
                sets.join(i as u32, j as u32);
            }
        }
    }
    let mut by_root: Vec<(u32, u32)> =
        faces.iter().enumerate().map(|(i, &t)| (sets.root(i as u32), t)).collect();
    by_root.sort_unstable();
    let mut out: Vec<FaceRegion> = by_root
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| {
            let triangles: Vec<u32> = group.iter().map(|g| g.1).collect();
            let (mut area, mut moment) = (0.0, DVec3::ZERO);
            for &t in &triangles {
                area += part.areas[t as usize];
                moment += part.middle(t) * part.areas[t as usize];
            }
            let centre = moment / area;
            let away = |t: &&u32| part.middle(**t).distance_squared(centre);
            let nearest = triangles.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let position = nearest.map_or(centre, |&t| part.middle(t));
            FaceRegion { triangles, area, position }
        })
        .collect();
    out.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangles[0].cmp(&b.triangles[0])));
    out
}

/// The regions that look down more steeply than `limit` degrees from the vertical, with the support
/// under them; flat ceilings between supports stand alone, with their span. Cells of `cell` square
/// millimetres measure the support.
pub fn overhangs(
    part: &PreparedPart,
    stand: &Standing,
    limit: f64,
    bridges: bool,
    cell: f64,
    job: &Job,
) -> Result<Vec<OverhangRegion>, Cancelled> {
    let faces = overhang_faces(part, stand, limit);
    let columns = support_columns(part, stand, &faces, cell, job)?;
    let flat_from = -(90.0 - FLAT).to_radians().portable_sin();
    let (mut held, mut rest) = (Vec::new(), faces.clone());
    if bridges {
        let flat: Vec<u32> = faces
            .iter()
            .copied()
            .filter(|&t| part.normals[t as usize].dot(stand.up) <= flat_from)
            .collect();
        for region in connected(part, &flat) {
            job.check()?;
            if let Some(span) = bridge_span(part, stand, &region.triangles) {
                held.push((region, span));
            }
        }
        let mut spanned: Vec<u32> =
            held.iter().flat_map(|(r, _)| r.triangles.iter().copied()).collect();
        spanned.sort_unstable();
        rest.retain(|t| spanned.binary_search(t).is_err());
    }
    let finish = |region: FaceRegion, bridge: Option<f64>| {
        let mut support = CellSum::default();
        let mut angle = f64::NEG_INFINITY;
        for &t in &region.triangles {
            if let Ok(i) = faces.binary_search(&t) {
                support.add(&columns[i]);
            }
            angle = angle.max(overhang_angle(part.normals[t as usize], stand.up));
        }
        OverhangRegion { region, angle, bridge, support }
    };
    let mut out: Vec<OverhangRegion> =
        held.into_iter().map(|(region, span)| finish(region, Some(span))).collect();
    out.extend(connected(part, &rest).into_iter().map(|region| finish(region, None)));
    out.sort_by(|a, b| b.region.area.total_cmp(&a.region.area));
    Ok(out)
}
