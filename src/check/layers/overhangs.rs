//! Faces that look down: overhangs by angle, as connected regions, and the bridges among them.

use glam::DVec3;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::portable::PortableMath;

use crate::columns::{CellSum, support_columns};
use crate::layers::bridge::bridge_span;
use crate::part::{PreparedPart, Standing};
use crate::regions::{FaceRegion, connected};

/// Angles that differ by less, degrees, are one: the rounding of normals of small faces.
const ANGLE_SLACK: f64 = 0.01;
/// A face within this of the horizontal, degrees, is flat.
const FLAT: f64 = 1.0;

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

/// The triangles that look down more steeply than `limit` (degrees from the vertical) and are
/// not on the plate, ascending.
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
