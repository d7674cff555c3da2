//! Drain holes of trapped volumes, and vents of suction cups: a hole from the place of a void that
//! is built first, out through the wall.
//!
//! Resin and powder run out of a cavity at its lowest point. A cup is sealed from its lowest point
//! on, for the layers above seal it against the film; as the part hangs in the printer, that is the
//! top of the cup. So both holes are at the lowest point along the build direction. A plate would
//! seal a hole that leads down to it: there the hole leads out at the side.

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;

use super::tool::{Cylinder, united};
use super::way_out::{WayOut, WaySearch};
use super::{RepairError, combined, rounding_volume, standing};
use crate::layers::plate::PlateContact;
use crate::layers::sweep::{SealedVoid, sweep};

/// Rounds of holes for the pockets of opened cavities.
const ROUNDS: usize = 4;
/// Share of the size, and of the volume, within which two voids are one.
const SAME: f64 = 1e-3;

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
    /// Of trapped volumes: a pocket of an opened cavity that holds more than this and would stay
    /// full while the part is built gets a hole too. `None`: it gets none.
    pub pocket: Option<f64>,
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
    RepairError::expect_length("diameter", settings.diameter)?;
    let mut holes = DrilledHoles::default();
    let (found, before) = holes.drill(solid, settings, &[], job)?;
    let name = settings.kind.name();
    if found == 0 {
        return Err(RepairError::NoFinding(name));
    }
    if holes.holes.is_empty() {
        return Err(RepairError::NoWayOut(name));
    }
    let voids = holes.voids;
    let mut tool = united(&holes.cylinders, job)?;
    if let Some(least) = settings.pocket.filter(|_| settings.kind == SealedKind::Trapped) {
        // A cavity with several feet has a pocket in each of the higher ones.
        let pockets = HoleSettings { kind: SealedKind::Cup, inlet: false, near: None, ..*settings };
        let pockets = HoleSettings { least, ..pockets };
        for _ in 0..ROUNDS {
            let count = holes.holes.len();
            let opened = combined(solid, &tool, Operation::Difference, job)?.0;
            holes.drill(&opened, &pockets, &before, job)?;
            if holes.holes.len() == count {
                break;
            }
            tool = united(&holes.cylinders, job)?;
        }
    }
    let DrilledHoles { holes, notes, .. } = holes;
    Ok(HolePlan { tool, holes, voids, found, notes })
}

/// The holes that were planned so far.
#[derive(Debug, Default)]
struct DrilledHoles {
    cylinders: Vec<Cylinder>,
    holes: Vec<PlannedHole>,
    voids: usize,
    notes: Vec<String>,
}

impl DrilledHoles {
    /// Plans the holes of the voids of a solid, but for those cups that are in `known`. Returns the
    /// number of voids that are findings, and all cups of the solid.
    fn drill(
        &mut self,
        solid: &PolyMesh,
        settings: &HoleSettings,
        known: &[SealedVoid],
        job: &Job,
    ) -> Result<(usize, Vec<SealedVoid>), RepairError> {
        let (part, stand) = standing(solid, settings.up, settings.layer, job)?;
        let contact = PlateContact::new(&part, &stand);
        let found = sweep(&part, &stand, &contact, settings.layer, settings.plate, job)?;
        let placed = |v: &SealedVoid| SealedVoid { position: part.to_file(v.position), ..*v };
        let cups: Vec<SealedVoid> = found.cups.iter().map(placed).collect();
        let all = match settings.kind {
            SealedKind::Trapped => &found.trapped,
            SealedKind::Cup => &found.cups,
        };
        let least = settings.least + rounding_volume(&part);
        let size = DVec3::from(part.sizes.dimensions).length();
        let is_known = |v: &SealedVoid| {
            let same = |k: &SealedVoid| {
                let near = k.position.distance(part.to_file(v.position)) < SAME * size;
                near && (k.volume - v.volume).abs() < SAME * v.volume
            };
            known.iter().any(same)
        };
        let wanted = |v: &&SealedVoid| v.volume > least && !is_known(v);
        let mut voids: Vec<SealedVoid> = all.iter().filter(wanted).copied().collect();
        let count = voids.len();
        if let Some(near) = settings.near {
            let far = |v: &SealedVoid| part.to_file(v.position).distance(near);
            let nearest = voids.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)));
            voids = nearest.into_iter().collect();
        }
        let (radius, name) = (0.5 * settings.diameter, settings.kind.name());
        for void in &voids {
            job.check()?;
            let mut ends = vec![(-stand.up, settings.plate, false)];
            if settings.inlet {
                ends.push((stand.up, false, true));
            }
            let before = self.holes.len();
            for (down, plate, inlet) in ends {
                let (void_of, number) = (&found.void_of[..], void.number);
                let search =
                    WaySearch { part: &part, stand: &stand, void_of, number, radius, down, plate };
                let Some(way) = search.best() else { continue };
                let WayOut { start, along, wall, begin, end, sealed } = way;
                self.cylinders.push(Cylinder {
                    from: part.to_file(start + along * begin),
                    to: part.to_file(start + along * end),
                    radius,
                    around: true,
                });
                let (from, to) = (part.to_file(start), part.to_file(start + along * wall));
                self.holes.push(PlannedHole { from, to, inlet, sealed });
                if sealed && !inlet {
                    let [x, y, z] = to.to_array();
                    self.notes.push(format!(
                        "the hole at ({x:.3}, {y:.3}, {z:.3}) leads down to the plate, which seals \
                         it while the part is built"
                    ));
                }
            }
            self.voids += usize::from(self.holes.len() > before);
            if self.holes.len() == before {
                let [x, y, z] = part.to_file(void.position).to_array();
                self.notes
                    .push(format!("no hole leads out of the {name} at ({x:.3}, {y:.3}, {z:.3})"));
            }
        }
        Ok((count, cups))
    }
}
