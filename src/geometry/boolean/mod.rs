//! Booleans of polygon meshes: union, intersection and both differences from one arrangement.
//!
//! The steps, one file each:
//!
//! 1. `precision`: the tolerance, from what the coordinates of the operands can resolve.
//! 2. `common`: places within the tolerance become one point, so that faces that are meant to be
//!    coplanar share points.
//! 3. `intersect`: each point where an edge of one operand crosses an edge or a face of the other
//!    is computed once and shared by every triangle around it. Signs are exact (Shewchuk 1997).
//! 4. `pieces`, `planar`: each crossed triangle is cut into the cells of its plane graph.
//! 5. `classify`: each connected part of a surface between cuts is inside or outside by one winding
//!    number; faces in contact have equal borders. Samples on the parts are classified again, each
//!    by a separate winding number.
//! 6. `merge`, `simplify`, `emit`: cells of one face are joined, planes are triangulated again, and
//!    the result is made a closed manifold.
//!
//! Every result is checked before it is returned: closed, samples that agree with the winding
//! number of the other operand, and volumes that add up (union and intersection give A and B,
//! difference and intersection give A). If a check fails, other tolerances are tried, then the
//! engines of the crate `manifold-rust` (`global`): the one in doubles, then the one in rational
//! numbers. If all fail, the error states what each check found, in figures.
//!
//! `routes` chooses between these. If an operand crosses itself, or its own pieces touch in full
//! faces, and there is no consistent result or the result crosses itself too, [`solve`] replaces
//! the operand by the solid of all places that it winds around. [`BooleanReport`] states whether
//! the result depends on the tolerance or on such a solid.
//!
//! Booleans one after another on one solid go through [`BooleanChain`], which keeps the solid's
//! search trees: a step arranges only the faces near its tool, by the steps above, and puts what
//! comes of them in their place. [`compute`] is the chain of one step, which keeps nothing.
//!
//! Not promised: features smaller than the tolerance.

/// Both surfaces cut at each other, and the result of each operation from that.
pub mod arrange;
mod attributes;
pub(crate) mod box_tree;
mod broad_phase;
mod chain;
mod chosen;
/// Inside or outside, for each part of a surface.
pub mod classify;
mod common;
mod curve;
mod emit;
mod global;
mod intersect;
mod merge;
mod one_surface;
mod operand;
mod parts;
mod pieces;
mod planar;
/// Points with an identity, and a hash map with a fixed order of hashing.
pub mod points;
mod precision;
mod refine;
mod ring_joining;
mod routes;
mod self_arrangement;
mod self_cuts;
mod simplify;
mod solve;
mod task;
mod verify;

use glam::DVec3;
use rayon::prelude::*;

pub use attributes::mixed;
pub use chain::{BooleanChain, ChainOrigin, ChainSolid, SolidState};
pub use emit::{BooleanFacts, FaceOrigin};
pub use operand::check;
pub use parts::{shells, split};
use pieces::Placement;
pub use points::Contact;
pub use precision::{
    DefaultTolerance, Precision, Resolution, default_tolerance, resolution, single_tolerance,
};
pub use refine::{CutRefinement, refine_cut};
pub use solve::solve;
use task::BooleanTask;

use crate::PolyMesh;
use crate::job::{Cancelled, Job};

/// One of the four Boolean operations on two solids A and B.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Operation {
    /// A or B.
    Union,
    /// A and B.
    Intersection,
    /// A minus B.
    Difference,
    /// B minus A.
    ReverseDifference,
}

impl ResultFaces {
    /// Returns true if all faces of a result are triangles.
    fn triangles(self, operands: [&PolyMesh; 2]) -> bool {
        let all = |m: &PolyMesh| {
            m.corners.len() == 3 * m.face_count()
                && m.face_starts.par_windows(2).with_min_len(common::FEW).all(|w| w[1] - w[0] == 3)
        };
        match self {
            ResultFaces::Triangles => true,
            ResultFaces::AsOperands => operands.into_iter().all(all),
            _ => false,
        }
    }
}

impl Operation {
    /// All four, in the order of their results.
    pub const ALL: [Operation; 4] = [
        Operation::Union,
        Operation::Intersection,
        Operation::Difference,
        Operation::ReverseDifference,
    ];

    /// The operation's name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Operation::Union => "union",
            Operation::Intersection => "intersection",
            Operation::Difference => "difference",
            Operation::ReverseDifference => "reverse-difference",
        }
    }

    /// Returns whether to turn a piece of an operand (0 or 1), or `None` if the result omits the
    /// piece.
    fn takes(self, operand: usize, place: Placement, contact: bool) -> Option<bool> {
        use Operation::*;
        use Placement::*;
        match (self, operand, place) {
            (Union, _, Outside) | (Union, 0, Same) => Some(false),
            (Intersection, _, Inside) | (Intersection, 0, Same) => Some(false),
            (Intersection, _, Against) if contact => Some(false),
            (Difference, 0, Outside | Against) | (ReverseDifference, 1, Outside | Against) => {
                Some(false)
            }
            (Difference, 1, Inside) | (ReverseDifference, 0, Inside) => Some(true),
            _ => None,
        }
    }
}

/// The shape of a result's faces where a face of an operand was cut. An uncut face stays unchanged,
/// unless triangles are requested.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ResultFaces {
    /// Triangles where both operands are triangles, else polygons of any shape.
    #[default]
    AsOperands,
    /// Triangles throughout.
    Triangles,
    /// Convex polygons.
    ConvexPolygons,
    /// As few polygons as can be had, concave ones among them.
    Polygons,
}

/// The meaning of an operand whose own pieces cross each other, or touch in full faces.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum OwnCrossings {
    /// If the results cross themselves too, the solid of all places that the operand goes around
    /// takes its place ([`solve`]), and a warning says so.
    #[default]
    Solve,
    /// The surface as it is. If there is no consistent result, [`solve`] is tried nevertheless.
    Keep,
}

/// What [`compute`] is asked for besides the operations.
#[derive(Debug, Clone, Copy, Default)]
pub struct BooleanOptions {
    /// Length within which places are one, in the operands' unit. `None`: what the operands'
    /// coordinates can resolve ([`default_tolerance`]). A given length is a bound: no larger one is
    /// used, except for what rounding of computed points needs, 2^-49 of the largest coordinate.
    pub tolerance: Option<f64>,
    /// The shape of the results' faces.
    pub faces: ResultFaces,
    /// Faces in which the solids only touch belong to the intersection too, both sides of them.
    pub keep_contact: bool,
    /// The meaning of operands that cross themselves.
    pub own_crossings: OwnCrossings,
    /// Of each operand, whether it has triangles that cross, where the caller knows. `None`: it is
    /// examined if it has several shells whose boxes meet.
    pub known_crossings: [Option<bool>; 2],
}

/// One of the four results.
#[derive(Debug, Clone)]
pub struct BooleanSolid {
    /// The operation.
    pub operation: Operation,
    /// The result; an empty solid has no faces.
    pub mesh: PolyMesh,
    /// One a face.
    pub origins: Vec<FaceOrigin>,
    /// Volume, area and topology of `mesh`.
    pub facts: BooleanFacts,
}

/// The reason why there is no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BooleanError {
    /// An operand has edges without a partner.
    #[error("{operand} is open: {edges} edges lack a partner; mend it first")]
    Open {
        /// The name of the operand.
        operand: &'static str,
        /// Edges that lack a partner.
        edges: usize,
    },
    /// An operand has a negative volume.
    #[error("{operand} is inside out: its volume is {volume}")]
    InsideOut {
        /// The name of the operand.
        operand: &'static str,
        /// Its volume.
        volume: f64,
    },
    /// A coordinate is infinite or not a number.
    #[error("{operand} has a coordinate that is not finite")]
    NotFinite {
        /// The name of the operand, or the plane of a split.
        operand: &'static str,
    },
    /// No way led to a result that passes all checks; the text says what failed first.
    #[error(
        "no consistent result: {0}. Give a smaller tolerance, or mend operands that cross \
         themselves (sculptd convert --mend)"
    )]
    Inconsistent(String),
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The report that accompanies the results.
#[derive(Debug, Clone, Default)]
pub struct BooleanReport {
    /// The tolerance that was used, in the operands' unit.
    pub tolerance: f64,
    /// The precision of the operands' coordinates; the coarser of the two.
    pub precision: Option<Precision>,
    /// Distances that the tolerance decided.
    pub contact: Contact,
    /// True if places that double precision distinguishes were merged, or nearly were: another
    /// tolerance may then give another result.
    pub depends_on_tolerance: bool,
    /// True if both operands are one surface: each result is the first operand, or nothing.
    pub same_surface: bool,
    /// The greatest error of a volume relative to the operands as given, in cubic units.
    pub volume_bound: f64,
    /// Warnings for the caller, one sentence each.
    pub warnings: Vec<String>,
    /// The cut: places where both surfaces are, as polylines that end where the curve ends or
    /// branches. A closed one names its first place again at its end. Of the global engine: none.
    pub cut: Vec<Vec<DVec3>>,
    /// Phase names, called as each ends.
    pub phases: Vec<(&'static str, f64)>,
}

/// The names of the operands in errors.
pub const NAMES: [&str; 2] = ["A", "B"];

/// The asked operations on A and B, from one arrangement. `now` gives seconds (any origin), for the
/// phases only.
pub fn compute(
    operands: [&PolyMesh; 2],
    operations: &[Operation],
    options: &BooleanOptions,
    job: &Job,
    now: impl Fn() -> f64,
) -> Result<(Vec<BooleanSolid>, BooleanReport), BooleanError> {
    let mut report = BooleanReport::default();
    let start = now();
    job.check()?;
    let (a, b) =
        rayon::join(|| check(operands[0], NAMES[0], job), || check(operands[1], NAMES[1], job));
    let volumes = [a?, b?];
    report.phases.push(("check", now() - start));
    let reach = operands.iter().map(|m| reach(&m.positions)).fold(0.0, f64::max);
    let floor = reach * 2f64.powi(-49);
    let default = default_tolerance(operands);
    report.precision = Some(default.precision);
    let wanted = options.tolerance.unwrap_or(default.tolerance).max(floor).max(f64::MIN_POSITIVE);
    let now = &now;
    let task = BooleanTask { operands, volumes, operations, options, wanted, floor, job, now };
    let solids = task.results(default.precision, &mut report)?;
    Ok((solids, report))
}

/// The largest coordinate.
fn reach(at: &[DVec3]) -> f64 {
    let part = |c: &[DVec3]| c.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    at.par_chunks(1 << 15).map(part).reduce(|| 0.0, f64::max)
}
