//! Drain holes of trapped volumes, and vents of suction cups: a hole from the place of a void that
//! is built first, out through the wall.
//!
//! Resin and powder run out of a cavity at its lowest point. A cup is sealed from its lowest point
//! on, for the layers above seal it against the film; as the part hangs in the printer, that is the
//! top of the cup. So both holes are at the lowest point along the build direction. A plate would
//! seal a hole that leads down to it: there the hole leads out at the side.

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;

use super::tool::{Cylinder, united};
use super::way_out::{WayOut, WaySearch};
use super::{RepairError, rounding_volume, standing};
use crate::layers::plate::PlateContact;
use crate::layers::sweep::{SealedVoid, sweep};

/// The kind of void that gets a hole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SealedKind {
    /// Cavities that never open.
    Trapped,
    /// Volumes that are sealed for a while.
    Cup,
}

impl SealedKind {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            SealedKind::Trapped => "trapped volume",
            SealedKind::Cup => "suction cup",
        }
    }
}

/// The holes to be planned. Lengths are in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoleSettings {
    /// The kind of void that gets a hole.
    pub kind: SealedKind,
    /// Of a hole.
    pub diameter: f64,
    /// A second hole at the highest point, through which air comes in.
    pub inlet: bool,
    /// Only voids that hold more than this.
    pub least: f64,
    /// Only the void whose centre is nearest to this place.
    pub near: Option<DVec3>,
    /// The build direction.
    pub up: DVec3,
    /// The height of a layer.
    pub layer: f64,
    /// True for a part on a plate, which seals a hole that leads down to it.
    pub plate: bool,
}

/// A hole, in the mesh's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedHole {
    /// The point at which it leaves the void.
    pub from: DVec3,
    /// The point at which it leaves the part.
    pub to: DVec3,
    /// True for an air inlet.
    pub inlet: bool,
    /// True if it leads down to the plate, which seals it.
    pub sealed: bool,
}

/// The holes of a part, and the solid to subtract.
#[derive(Debug, Clone, PartialEq)]
pub struct HolePlan {
    /// All holes as one solid.
    pub tool: PolyMesh,
    /// In the order of the voids, the largest first.
    pub holes: Vec<PlannedHole>,
    /// The voids that get a hole.
    pub voids: usize,
    /// The voids of the part that are findings, with and without a hole.
    pub found: usize,
    /// Sentences on voids without a hole, and on holes that the plate seals.
    pub notes: Vec<String>,
}

/// Plans the holes of a part. `solid` is what [`super::solid_of`] returns.
///
/// # Errors
/// [`RepairError::NoFinding`] if no void is sealed; an error if the diameter is not above 0, or if
/// no hole leads out.
pub fn plan_holes(
    solid: &PolyMesh,
    settings: &HoleSettings,
    job: &Job,
) -> Result<HolePlan, RepairError> {
    let radius = 0.5 * RepairError::expect_length("diameter", settings.diameter)?;
    let (part, stand) = standing(solid, settings.up, settings.layer, job)?;
    let contact = PlateContact::new(&part, &stand);
    let found = sweep(&part, &stand, &contact, settings.layer, settings.plate, job)?;
    let all = match settings.kind {
        SealedKind::Trapped => found.trapped,
        SealedKind::Cup => found.cups,
    };
    let least = settings.least + rounding_volume(&part);
    let mut voids: Vec<SealedVoid> = all.into_iter().filter(|v| v.volume > least).collect();
    let count = voids.len();
    if let Some(near) = settings.near {
        let far = |v: &SealedVoid| part.to_file(v.position).distance(near);
        let nearest = voids.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)));
        voids = nearest.into_iter().collect();
    }
    let name = settings.kind.name();
    if voids.is_empty() {
        return Err(RepairError::NoFinding(name));
    }
    let (mut cylinders, mut holes, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut drained = 0;
    for void in &voids {
        job.check()?;
        let mut ends = vec![(-stand.up, settings.plate, false)];
        if settings.inlet {
            ends.push((stand.up, false, true));
        }
        let before = holes.len();
        for (down, plate, inlet) in ends {
            let (void_of, number) = (&found.void_of[..], void.number);
            let search =
                WaySearch { part: &part, stand: &stand, void_of, number, radius, down, plate };
            let Some(way) = search.best() else { continue };
            let WayOut { start, along, wall, begin, end, sealed } = way;
            cylinders.push(Cylinder {
                from: part.to_file(start + along * begin),
                to: part.to_file(start + along * end),
                radius,
                around: true,
            });
            let (from, to) = (part.to_file(start), part.to_file(start + along * wall));
            holes.push(PlannedHole { from, to, inlet, sealed });
            if sealed && !inlet {
                let [x, y, z] = to.to_array();
                notes.push(format!(
                    "the hole at ({x:.3}, {y:.3}, {z:.3}) leads down to the plate, which seals it \
                     while the part is built"
                ));
            }
        }
        drained += usize::from(holes.len() > before);
        if holes.len() == before {
            let [x, y, z] = part.to_file(void.position).to_array();
            notes.push(format!("no hole leads out of the {name} at ({x:.3}, {y:.3}, {z:.3})"));
        }
    }
    if holes.is_empty() {
        return Err(RepairError::NoWayOut(name));
    }
    let tool = united(&cylinders, job)?;
    Ok(HolePlan { tool, holes, voids: drained, found: count, notes })
}
