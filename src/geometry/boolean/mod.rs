//! Booleans of polygon meshes: union, intersection and both differences from one arrangement.
//!
//! The way: both surfaces are brought over common points (places within the tolerance are one
//! point), so that faces that a person means to be coplanar *are*, by the identity of their points;
//! then each point where an edge of one meets an edge or a face of the other is found once (signs
//! decided exactly, Shewchuk 1997) and known to every triangle around it; each crossed triangle is
//! cut into the cells of its plane graph; the parts of each surface between cuts are placed by one
//! winding number each; contact is found by equal borders. Cells of one face with one fate are
//! joined again, so that a face that is not crossed comes out as it went in. Every result is
//! checked before it is given: closed, and volumes that add up.
//!
//! Not promised: operands that cross themselves (asked for by [`Error`]); features smaller than the
//! tolerance.

pub mod arrange;
mod attributes;
mod box_tree;
mod broad_phase;
pub mod classify;
mod common;
mod curve;
mod emit;
mod fans;
mod global;
mod intersect;
mod merge;
mod parts;
mod pieces;
mod planar;
pub mod points;

use glam::DVec3;
use rayon::prelude::*;

use arrange::Arrangement;
pub use attributes::mixed;
use box_tree::Span;
pub use emit::{Facts, Origin};
pub use parts::{shells, split};
use pieces::Place;

use crate::PolyMesh;
use crate::job::{Cancelled, Job};

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Operation {
    Union,
    Intersection,
    Difference,
    /// B minus A.
    ReverseDifference,
}

impl Operation {
    pub const ALL: [Operation; 4] = [
        Operation::Union,
        Operation::Intersection,
        Operation::Difference,
        Operation::ReverseDifference,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Operation::Union => "union",
            Operation::Intersection => "intersection",
            Operation::Difference => "difference",
            Operation::ReverseDifference => "reverse-difference",
        }
    }

    /// Whether a piece of an operand (0 or 1) is in the result, and whether it is turned.
    fn takes(self, operand: usize, place: Place, contact: bool) -> Option<bool> {
        use Operation::*;
        use Place::*;
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

#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Length under which contact is contact. `None`: from the operands' own rounding, about 4e-12
    /// of the largest coordinate. 0: only what rounding of computed points needs.
    pub tolerance: Option<f64>,
    /// Faces in which the solids only touch belong to the intersection too, both sides of them.
    pub keep_contact: bool,
}

/// One of the four results.
#[derive(Debug, Clone)]
pub struct Solid {
    pub operation: Operation,
    pub mesh: PolyMesh,
    /// One a face.
    pub origins: Vec<Origin>,
    pub facts: Facts,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    #[error("{operand} is open: {edges} edges lack a partner; mend it first")]
    Open { operand: &'static str, edges: usize },
    #[error("{operand} is inside out: its volume is {volume}")]
    InsideOut { operand: &'static str, volume: f64 },
    #[error("{operand} has a coordinate that is not finite")]
    NotFinite { operand: &'static str },
    #[error("no consistent result: {0}. Do the operands cross themselves?")]
    Inconsistent(String),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What was done besides the results.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// The tolerance that was used.
    pub tolerance: f64,
    pub warnings: Vec<String>,
    /// The cut: places where both surfaces are, as polylines that end where the curve ends or
    /// branches. A closed one names its first place again at its end. Of the global engine: none.
    pub cut: Vec<Vec<DVec3>>,
    /// Phase names, called as each ends.
    pub phases: Vec<(&'static str, f64)>,
}

pub const NAMES: [&str; 2] = ["A", "B"];

/// The asked operations on A and B, from one arrangement. `now` gives seconds (any origin), for the
/// phases only.
pub fn compute(
    operands: [&PolyMesh; 2],
    operations: &[Operation],
    options: &Options,
    job: &Job,
    now: impl Fn() -> f64,
) -> Result<(Vec<Solid>, Report), Error> {
    let mut report = Report::default();
    let start = now();
    job.check()?;
    let (a, b) =
        rayon::join(|| check(operands[0], NAMES[0], job), || check(operands[1], NAMES[1], job));
    let volumes = [a?, b?];
    report.phases.push(("check", now() - start));
    let reach = operands.iter().map(|m| reach(&m.positions)).fold(0.0, f64::max);
    let floor = reach * 2f64.powi(-49);
    let wanted =
        options.tolerance.unwrap_or(reach * 2f64.powi(-38)).max(floor).max(f64::MIN_POSITIVE);
    let mut why = String::new();
    // Where the first tolerance falls between what is and is not in contact, another does not.
    for factor in [1.0, 0.125, 16.0, 1.0 / 64.0] {
        let eps = (wanted * factor).max(floor);
        match attempt(operands, volumes, operations, options, eps, floor, job, &now, &mut report)? {
            Ok(solids) => {
                report.tolerance = eps;
                if factor != 1.0 {
                    report
                        .warnings
                        .push(format!("tolerance {eps:.3e} taken instead of {wanted:.3e}: {why}"));
                }
                return Ok((solids, report));
            }
            Err(reason) => {
                if why.is_empty() {
                    why = reason;
                }
            }
        }
    }
    report
        .warnings
        .push(format!("no consistent result within the tolerance ({why}): global engine taken"));
    report.tolerance = wanted;
    let solids = globally(operands, volumes, operations, wanted, job, &now, &mut report)?;
    Ok((solids, report))
}

/// The largest coordinate.
fn reach(at: &[DVec3]) -> f64 {
    let part = |c: &[DVec3]| c.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    at.par_chunks(1 << 15).map(part).reduce(|| 0.0, f64::max)
}

/// The four results by the global engine, held against each other as the others are.
fn globally(
    operands: [&PolyMesh; 2],
    volumes: [f64; 2],
    operations: &[Operation],
    eps: f64,
    job: &Job,
    now: &impl Fn() -> f64,
    report: &mut Report,
) -> Result<Vec<Solid>, Error> {
    let start = now();
    let engine = global::Engine::new(operands, eps, job)?.map_err(Error::Inconsistent)?;
    let mut solids = Vec::new();
    for &operation in operations {
        let (mut mesh, origins, facts) =
            engine.run(operation, job)?.map_err(Error::Inconsistent)?;
        attributes::carry(&mut mesh, &origins, operands);
        if !facts.closed {
            return Err(Error::Inconsistent(format!("the {} is not closed", operation.name())));
        }
        solids.push(Solid { operation, mesh, origins, facts });
    }
    report.phases.push(("global", now() - start));
    match doubt(&solids, volumes, 8.0 * eps, &operands[0].positions) {
        Some(why) => Err(Error::Inconsistent(why)),
        None => Ok(solids),
    }
}

/// A surface that crosses itself as the solid of all places that it goes around: for operands that
/// [`compute`] refuses.
pub fn solve(mesh: &PolyMesh, job: &Job) -> Result<PolyMesh, Error> {
    global::solve(mesh, job)?.map_err(Error::Inconsistent)
}

/// Closed, oriented outwards, finite: the volume, or what is wrong.
pub fn check(mesh: &PolyMesh, operand: &'static str, job: &Job) -> Result<f64, Error> {
    if !mesh.positions.par_iter().all(|p| p.is_finite()) {
        return Err(Error::NotFinite { operand });
    }
    job.check()?;
    if !balanced(mesh) {
        let edges = open_edges(mesh);
        if edges > 0 {
            return Err(Error::Open { operand, edges });
        }
    }
    job.check()?;
    let (volume, _) = emit::measure(mesh);
    if volume < 0.0 { Err(Error::InsideOut { operand, volume }) } else { Ok(volume) }
}

/// Whether the edges, each as a number of 128 bits with its direction as its sign, add up to
/// nothing: so they do where each has its partners, and else all but never.
fn balanced(mesh: &PolyMesh) -> bool {
    let mix = |x: u64, by: u64| {
        let z = (x ^ (x >> 32)).wrapping_mul(by);
        (z ^ (z >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb)
    };
    let number = |a: u32, b: u32| {
        let edge = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let n = u128::from(mix(edge, 0xbf58_476d_1ce4_e5b9)) << 64
            | u128::from(mix(edge.wrapping_add(0x9e37_79b9_7f4a_7c15), 0xff51_afd7_ed55_8ccd));
        match a.cmp(&b) {
            std::cmp::Ordering::Less => n,
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Greater => n.wrapping_neg(),
        }
    };
    let part = |starts: &[u32]| {
        starts.windows(2).fold(0u128, |sum, w| {
            let f = &mesh.corners[w[0] as usize..w[1] as usize];
            let Some(&last) = f.last() else { return sum };
            f.iter().fold((sum, last), |(sum, a), &b| (sum.wrapping_add(number(a, b)), b)).0
        })
    };
    const BLOCK: usize = 1 << 14;
    let blocks = mesh.face_count().div_ceil(BLOCK);
    let block = |i: usize| {
        part(&mesh.face_starts[i * BLOCK..mesh.face_starts.len().min((i + 1) * BLOCK + 1)])
    };
    (0..blocks).into_par_iter().map(block).reduce(|| 0, u128::wrapping_add) == 0
}

/// Edges that lack a partner.
fn open_edges(mesh: &PolyMesh) -> usize {
    let mut half: Vec<(u32, u32, i32)> = Vec::with_capacity(mesh.corners.len());
    for f in mesh.faces() {
        for (i, &a) in f.iter().enumerate() {
            let b = f[(i + 1) % f.len()];
            half.push((a.min(b), a.max(b), if a < b { 1 } else { -1 }));
        }
    }
    half.par_sort_unstable();
    half.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1))
        .filter(|g| g[0].0 != g[0].1 && g.iter().map(|h| h.2).sum::<i32>() != 0)
        .count()
}

/// With one tolerance. The inner error says why the arrangement is not consistent.
fn attempt(
    operands: [&PolyMesh; 2],
    volumes: [f64; 2],
    operations: &[Operation],
    options: &Options,
    eps: f64,
    floor: f64,
    job: &Job,
    now: &impl Fn() -> f64,
    report: &mut Report,
) -> Result<Result<Vec<Solid>, String>, Error> {
    let mut clock = now();
    let mut lap = |name| {
        let t = now();
        report.phases.push((name, t - clock));
        clock = t;
    };
    let a = Arrangement::new(operands, eps, floor, None, job, &mut lap)?;
    let mut solids = Vec::new();
    for &operation in operations {
        job.check()?;
        let faces = operands.iter().map(|m| m.face_count()).sum();
        let (mut mesh, mut origins) = (PolyMesh::new(), Vec::with_capacity(faces));
        mesh.face_starts.reserve(faces);
        mesh.corners.reserve(operands.iter().map(|m| m.corners.len()).sum());
        a.faces(operation, options.keep_contact, job, |origin, corners, _| {
            mesh.push_face(corners);
            origins.push(origin);
        });
        job.check()?;
        let facts = emit::finish(&mut mesh, &a.points.at, job)?;
        if !facts.closed {
            return Ok(Err(format!("the {} is not closed", operation.name())));
        }
        attributes::carry(&mut mesh, &origins, operands);
        solids.push(Solid { operation, mesh, origins, facts });
    }
    lap("emit");
    // Places may have moved by a tolerance that was asked for, but only by rounding where none was.
    let slack = if options.tolerance.is_some() { 8.0 * eps } else { floor };
    if let Some(why) = doubt(&solids, volumes, slack, &a.points.at) {
        return Ok(Err(why));
    }
    report.cut = a.curve();
    job.progress(1.0);
    Ok(Ok(solids))
}

/// What the volumes say against the results; `eps`: how far a surface may have moved.
fn doubt(solids: &[Solid], [a, b]: [f64; 2], eps: f64, at: &[DVec3]) -> Option<String> {
    let of = |o| solids.iter().find(|s| s.operation == o).map(|s| s.facts.volume);
    let area: f64 = solids.iter().map(|s| s.facts.area).sum();
    let size = at
        .par_chunks(1 << 15)
        .map(|c| Span::of(c.iter().copied()))
        .reduce(|| Span::EMPTY, Span::join);
    let slack = (a + b) * 5e-13 + area * eps + (size.hi - size.lo).length().powi(3) * 1e-16;
    let (u, i) = (of(Operation::Union), of(Operation::Intersection));
    let (d, r) = (of(Operation::Difference), of(Operation::ReverseDifference));
    let sums = [
        (u.zip(i).map(|(u, i)| u + i - a - b), "union and intersection"),
        (d.zip(i).map(|(d, i)| d + i - a), "difference and intersection"),
        (r.zip(i).map(|(r, i)| r + i - b), "reverse difference and intersection"),
    ];
    for (off, what) in sums {
        if off.is_some_and(|x| x.abs() > slack) {
            return Some(format!(
                "the volumes of {what} do not add up, by {:.3e}",
                off.unwrap_or(0.0)
            ));
        }
    }
    solids
        .iter()
        .find(|s| s.facts.volume < -slack)
        .map(|s| format!("the {} has the volume {:.3e}", s.operation.name(), s.facts.volume))
}
