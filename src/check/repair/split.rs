//! A part split by a plane, with pegs on the lower half that fit sockets in the upper one.

use glam::{DVec2, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::{self, BooleanOptions, Operation};
use sculptd_geometry::job::Job;
use sculptd_geometry::section::{Section, Slicer};

use super::flat_base::extent;
use super::section_region::SectionRegion;
use super::tool::{Cylinder, PlaneFrame, united};
use super::{RepairError, combined, direction};
use crate::part::PreparedPart;

/// Matter that stays around a socket, as a share of the peg's radius.
const WALL: f64 = 1.0;
/// Directions around a peg in which the matter is measured.
const AROUND: usize = 8;
/// Pegs of one section, at most.
pub const MOST_PEGS: usize = 16;

/// Pegs and their sockets. Lengths are in the mesh's unit; the defaults are millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PegSettings {
    /// The radius of a peg.
    pub radius: f64,
    /// The length of a peg beyond the plane.
    pub length: f64,
    /// The least distance between a peg and its socket, at the side and at the end.
    pub clearance: f64,
    /// Pegs at most, up to [`MOST_PEGS`]; 0 splits without pegs.
    pub most: usize,
}

impl Default for PegSettings {
    fn default() -> PegSettings {
        PegSettings { radius: 2.0, length: 5.0, clearance: 0.2, most: 4 }
    }
}

impl PegSettings {
    /// The same pegs in another unit: `ratio` units for each of these.
    pub fn scaled(self, ratio: f64) -> PegSettings {
        let PegSettings { radius, length, clearance, most } = self;
        let (radius, length) = (radius * ratio, length * ratio);
        PegSettings { radius, length, clearance: clearance * ratio, most }
    }

    /// The least distance of a peg's axis from the boundary of the section.
    fn room(&self) -> f64 {
        self.radius * (1.0 + WALL) + self.clearance
    }
}

/// The plane of a split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitPlane {
    /// A point of the plane.
    pub point: DVec3,
    /// Towards the upper half; of any length above 0.
    pub normal: DVec3,
}

/// The two parts of a split.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitParts {
    /// The part below the plane, with the pegs.
    pub below: PolyMesh,
    /// The part above it, with the sockets.
    pub above: PolyMesh,
    /// The area of the section.
    pub section_area: f64,
    /// The centre of each peg in the plane.
    pub pegs: Vec<DVec3>,
    /// Sentences on the pegs, and on how the parts were computed.
    pub notes: Vec<String>,
}

/// Splits a part by a plane. Where the section has no room for a peg, a note says why.
///
/// # Errors
/// Returns an error if the part is no solid, if the plane does not cut it, or if a length is out of
/// its range.
pub fn split_part(
    mesh: &PolyMesh,
    plane: SplitPlane,
    pegs: PegSettings,
    job: &Job,
) -> Result<SplitParts, RepairError> {
    let normal = direction("normal", plane.normal)?;
    check(&pegs)?;
    let offset = normal.dot(plane.point);
    let (low, high) = extent(mesh, normal);
    let beside = RepairError::BesidePart { low, high, offset };
    if !(offset > low && offset < high) {
        return Err(beside);
    }
    let section = Slicer::new(mesh, normal).map(|s| s.at(offset)).unwrap_or_default();
    let options = BooleanOptions::default();
    let (halves, report) = boolean::split(mesh, normal, offset, &options, job, || 0.0)?;
    let [mut above, mut below] = halves.map(|s| s.mesh);
    if above.face_count() == 0 || below.face_count() == 0 {
        return Err(beside);
    }
    let mut notes = report.warnings;
    let mut found = Vec::new();
    if pegs.most > 0 {
        found = places(mesh, normal, offset, &section, &pegs, &mut notes, job)?;
    }
    if !found.is_empty() {
        let cylinder = |p: &DVec3, down: f64, up: f64, radius: f64, around: bool| Cylinder {
            from: *p - normal * down,
            to: *p + normal * up,
            radius,
            around,
        };
        let (r, c) = (pegs.radius, pegs.clearance);
        let solid: Vec<_> = found.iter().map(|p| cylinder(p, r, pegs.length, r, false)).collect();
        let free: Vec<_> =
            found.iter().map(|p| cylinder(p, r, pegs.length + c, r + c, true)).collect();
        let (with, more) = combined(&below, &united(&solid, job)?, Operation::Union, job)?;
        below = with;
        notes.extend(more);
        let (with, more) = combined(&above, &united(&free, job)?, Operation::Difference, job)?;
        above = with;
        notes.extend(more);
    }
    Ok(SplitParts { below, above, section_area: section.area, pegs: found, notes })
}

fn check(pegs: &PegSettings) -> Result<(), RepairError> {
    if pegs.most == 0 {
        return Ok(());
    }
    RepairError::expect_length("peg radius", pegs.radius)?;
    RepairError::expect_length("peg length", pegs.length)?;
    if !(pegs.clearance >= 0.0 && pegs.clearance.is_finite()) {
        let range = "a length of at least 0".into();
        return Err(RepairError::OutOfRange { name: "clearance", value: pegs.clearance, range });
    }
    if pegs.most > MOST_PEGS {
        let range = format!("0 to {MOST_PEGS}");
        let value = pegs.most as f64;
        return Err(RepairError::OutOfRange { name: "pegs", value, range });
    }
    Ok(())
}

/// The places of the pegs: in the section, away from its boundary, with matter on both sides of
/// the plane, and far from each other.
fn places(
    mesh: &PolyMesh,
    normal: DVec3,
    offset: f64,
    section: &Section,
    pegs: &PegSettings,
    notes: &mut Vec<String>,
    job: &Job,
) -> Result<Vec<DVec3>, RepairError> {
    let part = PreparedPart::new(mesh, 1.0, job)?;
    let frame = PlaneFrame::new(normal * offset, normal);
    let lines = section.contours.iter().flat_map(|c| c.points.windows(2));
    let lines = lines.map(|w| [frame.flat(w[0]), frame.flat(w[1])]).collect();
    let region = SectionRegion::new(lines);
    let room = pegs.room();
    let widest = region.widest();
    let clear = widest.map_or(0.0, |w| w.1);
    let mut flat = region.places(room);
    // A peg alone has the widest place.
    flat.extend(widest.filter(|w| w.1 >= room).map(|w| w.0));
    if flat.is_empty() {
        notes.push(format!(
            "no pegs: the section is {:.3} wide at its widest place, and a peg of radius {} with \
             its wall needs {:.3}",
            2.0 * clear,
            pegs.radius,
            2.0 * room
        ));
        return Ok(Vec::new());
    }
    let deep = |p: &DVec2| is_deep(&part, frame.place(*p) - part.centred.centre, normal, pegs);
    let firm: Vec<DVec2> = flat.iter().copied().filter(deep).collect();
    let Some(alone) = firm.last().copied() else {
        let (above, below) = depths(pegs);
        notes.push(format!(
            "no pegs: where the section is wide enough the part is not {below:.3} deep below the \
             plane and {above:.3} above it"
        ));
        return Ok(Vec::new());
    };
    let middle = section.centroid.map_or(alone, |c| frame.flat(c));
    let mut chosen: Vec<DVec2> = Vec::new();
    while chosen.len() < pegs.most {
        let from = |p: &DVec2| match chosen.is_empty() {
            true => p.distance(middle),
            false => chosen.iter().map(|c| c.distance(*p)).fold(f64::INFINITY, f64::min),
        };
        // The first of equals.
        let best = firm.iter().map(|p| (from(p), p)).reduce(|a, b| if b.0 > a.0 { b } else { a });
        match best {
            Some((far, p)) if chosen.is_empty() || far >= 2.0 * room => chosen.push(*p),
            _ => break,
        }
    }
    if chosen.len() == 1 {
        chosen = vec![alone];
        notes.push("one peg only: the parts can turn about it".into());
    }
    Ok(chosen.iter().map(|p| frame.place(*p)).collect())
}

/// Depths of matter that a peg needs above and below the plane.
fn depths(pegs: &PegSettings) -> (f64, f64) {
    let wall = WALL * pegs.radius;
    (pegs.length + pegs.clearance + wall, pegs.radius + wall)
}

/// Returns true if a place of the plane, about the part's centre, has enough matter on both sides.
fn is_deep(part: &PreparedPart, at: DVec3, normal: DVec3, pegs: &PegSettings) -> bool {
    let (above, below) = depths(pegs);
    let radius = pegs.radius * (1.0 + WALL) + pegs.clearance;
    let (x, y) = normal.any_orthonormal_pair();
    let rim = (0..AROUND).map(|i| {
        // Eight directions without sines.
        let [a, b] = [[1.0, 0.0], [0.7, 0.7], [0.0, 1.0], [-0.7, 0.7]][i % 4];
        let sign = if i < AROUND / 2 { 1.0 } else { -1.0 };
        at + (x * a + y * b) * (sign * radius)
    });
    let far = |p: DVec3, along: DVec3, need: f64| {
        part.exit_along(p, along, 0.0, |_| true).is_none_or(|(d, _)| d >= need)
    };
    std::iter::once(at).chain(rim).all(|p| far(p, normal, above) && far(p, -normal, below))
}
