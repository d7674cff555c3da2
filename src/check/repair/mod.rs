//! Repairs of a part: a flat base, a split with pegs and sockets, drain holes, vents, draft,
//! thicker walls, and text. Each is planned here. Draft and thicker walls move corners; all others
//! are carried out by the exact Boolean of `sculptd_geometry`.
//!
//! Lengths are in the mesh's unit, so whoever knows millimetres converts them first. A repair that
//! is one cut is planned as a *tool*, a solid to subtract, so that a caller can subtract it in its
//! own way: [`flat_base::base_tool`], [`holes::plan_holes`]. [`split::split_part`] makes two parts.
//!
//! No claim without a check: [`remaining`] looks at the result again, and says what is left.

pub mod flat_base;
pub mod holes;
pub mod lettering;
mod section_region;
pub mod split;
pub mod thickening;
mod tool;
pub mod wall_draft;
mod way_out;

use std::borrow::Cow;

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::{self, BooleanError, BooleanOptions, Operation};
use sculptd_geometry::job::{Cancelled, Job};

use crate::finding::FindingKind;
use crate::layers::plate::PlateContact;
use crate::layers::sweep::{SealedVoid, sweep};
use crate::part::{PreparedPart, Standing};
use crate::soundness::soundness;

/// Reason that a part was not repaired.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RepairError {
    /// The mesh is no solid.
    #[error("the part cannot be repaired: {0}. Close it with sculptd convert --mend, or remesh it")]
    NotSolid(String),
    /// A parameter is out of its range.
    #[error("{name} = {value}: expected {range}")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range, in words.
        range: String,
    },
    /// The plane leaves the part in one piece.
    #[error(
        "the plane does not cut the part, which reaches from {low} to {high} along its normal, and \
         the plane is at {offset}. Move the plane"
    )]
    BesidePart {
        /// The least height of the part over the plane through the origin.
        low: f64,
        /// The greatest.
        high: f64,
        /// The plane's.
        offset: f64,
    },
    /// The finding that the repair is for is not there.
    #[error("nothing to repair: the check finds no {0}")]
    NoFinding(&'static str),
    /// No hole leads out.
    #[error("no hole leads out of the {0}. Turn the part, or cut it open with a split")]
    NoWayOut(&'static str),
    /// A text that cannot be drawn.
    #[error("the text cannot be drawn: {0}")]
    Text(String),
    /// A text of which a part is beside the surface.
    #[error(
        "the text is {wide:.2} wide and {tall:.2} tall, and the surface ends or drops away under \
         it. Move it, or make it smaller"
    )]
    NoRoom {
        /// Width of the text.
        wide: f64,
        /// Height of all its lines.
        tall: f64,
    },
    /// The Boolean found no result.
    #[error(transparent)]
    Boolean(#[from] BooleanError),
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl RepairError {
    /// Refuses a length that is not above 0, or not finite.
    pub(crate) fn expect_length(name: &'static str, value: f64) -> Result<f64, RepairError> {
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(RepairError::OutOfRange { name, value, range: "a length above 0".into() })
    }
}

/// A part whose corners were moved.
#[derive(Debug, Clone, PartialEq)]
pub struct ReshapedPart {
    /// The part; its faces are those of the part before.
    pub mesh: PolyMesh,
    /// The area of the walls that were to be changed, in square units.
    pub area: f64,
    /// The connected walls that stayed as they are.
    pub kept: usize,
    /// Sentences on these walls.
    pub notes: Vec<String>,
}

/// Result of the check of a repaired part. Lengths and places are in the mesh's unit and frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Remaining {
    /// True if every edge has two faces.
    pub closed: bool,
    /// True if the faces around each vertex and edge are one fan.
    pub manifold: bool,
    /// Pairs of triangles that cross.
    pub crossings: usize,
    /// The enclosed volume.
    pub volume: f64,
    /// The flat area on the plate.
    pub base_area: f64,
    /// Cavities that never open, the largest first.
    pub trapped: Vec<SealedVoid>,
    /// Volumes that are sealed for a while, the largest first.
    pub cups: Vec<SealedVoid>,
}

/// Checks a part after its repair, built along `up` in layers of `layer`. `plate` is
/// true for a part on a plate, which seals voids that open downwards.
///
/// # Errors
/// [`RepairError::NotSolid`] if the result is no solid, and if the job was cancelled.
pub fn remaining(
    mesh: &PolyMesh,
    up: DVec3,
    layer: f64,
    plate: bool,
    job: &Job,
) -> Result<Remaining, RepairError> {
    let sound = soundness(mesh, 1.0, None, job)?;
    let crossings = sound.findings.iter().find(|f| f.kind == FindingKind::SelfIntersection);
    let crossings = crossings.and_then(|f| f.value).map_or(0, |n| n as usize);
    let (closed, manifold) = (sound.facts.closed, sound.facts.manifold);
    let solid = sound.solid.map_err(RepairError::NotSolid)?;
    let (part, stand) = standing(&solid, up, layer, job)?;
    let contact = PlateContact::new(&part, &stand);
    let found = sweep(&part, &stand, &contact, layer, plate, job)?;
    let small = rounding_volume(&part);
    let placed = |all: Vec<SealedVoid>| {
        let all = all.into_iter().filter(|v| v.volume > small);
        all.map(|v| SealedVoid { position: part.to_file(v.position), ..v }).collect()
    };
    let (trapped, cups) = (placed(found.trapped), placed(found.cups));
    let (volume, base_area) = (part.sizes.volume, contact.area);
    Ok(Remaining { closed, manifold, crossings, volume, base_area, trapped, cups })
}

/// Combines a part with a tool. Returns the result and sentences on how it was computed.
///
/// # Errors
/// Returns an error if the part is no solid, or the Boolean has no result.
pub fn combined(
    mesh: &PolyMesh,
    tool: &PolyMesh,
    operation: Operation,
    job: &Job,
) -> Result<(PolyMesh, Vec<String>), RepairError> {
    let options = BooleanOptions::default();
    let (solids, report) = boolean::compute([mesh, tool], &[operation], &options, job, || 0.0)?;
    let made = solids.into_iter().next().map(|s| s.mesh).unwrap_or_default();
    Ok((made, report.warnings))
}

/// Returns the solid that the checks look at, and that a repair cuts.
///
/// # Errors
/// [`RepairError::NotSolid`]
pub fn solid_of<'a>(mesh: &'a PolyMesh, job: &Job) -> Result<Cow<'a, PolyMesh>, RepairError> {
    soundness(mesh, 1.0, None, job)?.solid.map_err(RepairError::NotSolid)
}

/// The part made ready for rays, and how it stands.
fn standing(
    solid: &PolyMesh,
    up: DVec3,
    layer: f64,
    job: &Job,
) -> Result<(PreparedPart, Standing), RepairError> {
    let up = direction("up", up)?;
    let part = PreparedPart::new(solid, 1.0, job)?;
    let stand = part.standing(up, layer).filter(|_| part.within_reach());
    let why = || RepairError::NotSolid("no face has an area, or the part is too large".into());
    let stand = stand.ok_or_else(why)?;
    Ok((part, stand))
}

fn direction(name: &'static str, along: DVec3) -> Result<DVec3, RepairError> {
    let range = || "a direction with a length above 0".to_string();
    let value = along.length();
    along.try_normalize().ok_or_else(|| RepairError::OutOfRange { name, value, range: range() })
}

/// A volume that is only rounding.
pub(crate) fn rounding_volume(part: &PreparedPart) -> f64 {
    let [x, y, z] = part.sizes.dimensions;
    part.tolerance * (x * y + y * z + z * x)
}
