//! The answer of a check.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use serde::Serialize;

use crate::finding::Finding;
use crate::orientation::Orientation;
use crate::part::PreparedPart;

/// A check of the process, and whether it ran.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RanCheck {
    /// The check.
    pub name: &'static str,
    /// False if it could not run: then a finding says why.
    pub ran: bool,
    /// The duration, seconds.
    pub seconds: f64,
}

/// The facts of a part. Lengths in millimetres; absent where the process or the mesh has no such
/// value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PartFacts {
    /// Enclosed volume, mm3.
    pub volume: Option<f64>,
    /// Surface area, mm2.
    pub area: Option<f64>,
    /// Width, depth and height as the part stands.
    pub size: Option<[f64; 3]>,
    /// Grams.
    pub weight: Option<f64>,
    /// The number of layers.
    pub layers: Option<usize>,
    /// The area of the first layer, mm2.
    pub contact_area: Option<f64>,
    /// The angle by which the part can be tilted before it falls, degrees.
    pub tip_angle: Option<f64>,
    /// The area of overhangs, mm2.
    pub overhang_area: Option<f64>,
    /// The volume of support, mm3.
    pub support_volume: Option<f64>,
    /// One standard deviation of `support_volume`.
    pub support_error: Option<f64>,
    /// The area of the shadow along the build or pull direction, mm2.
    pub projected_area: Option<f64>,
    /// The usual wall, by area.
    pub nominal_wall: Option<f64>,
    /// The thickest wall, by the largest ball that fits.
    pub thickest_wall: Option<f64>,
    /// Seconds until the thickest wall has cooled.
    pub cooling_time: Option<f64>,
    /// kN.
    pub clamping_force: Option<f64>,
    /// The material of one shot without its runner, mm3.
    pub shot_volume: Option<f64>,
    /// The pull direction with the least undercut.
    pub parting_direction: Option<[f64; 3]>,
    /// The area that neither half of a mould releases along `parting_direction`, mm2.
    pub parting_undercut: Option<f64>,
    /// The same along the given direction, mm2.
    pub undercut_area: Option<f64>,
    /// Seconds that the build takes, roughly.
    pub build_time: Option<f64>,
}

/// The answer of `sculptd check --json`.
#[derive(Debug, Clone, Serialize)]
pub struct CheckAnswer {
    /// True if every check of the process ran, and none found an error.
    pub ok: bool,
    /// The name of the file as it was given.
    pub file: String,
    /// The process.
    pub process: String,
    /// The printer, where one was named.
    pub printer: Option<String>,
    /// The material.
    pub material: String,
    /// The build or pull direction.
    pub up: [f64; 3],
    /// The worst first.
    pub findings: Vec<Finding>,
    /// The best first; empty unless a search was asked for.
    pub orientations: Vec<Orientation>,
    /// Why the first orientation is better than the part as it is.
    pub reasons: Vec<String>,
    /// The facts of the part, flattened into this object in JSON.
    #[serde(flatten)]
    pub facts: PartFacts,
    /// The checks that the process asks for.
    pub checks: Vec<RanCheck>,
    /// Sentences on the file and on what was done to check it.
    pub warnings: Vec<String>,
    /// The duration, seconds.
    pub seconds: f64,
}

/// The work asked for besides the checks.
#[derive(Debug, Clone, Copy, Default)]
pub struct CheckRequest<'a> {
    /// Search for the best orientation.
    pub orient: bool,
    /// Counts the checks that have ended, for whoever waits for the answer.
    pub progress: Option<&'a CheckProgress>,
}

/// The number of checks that have ended, out of those that were asked for.
///
/// Each check reports its own progress to the job, so the job cannot tell how much of the whole is
/// done.
#[derive(Debug, Default)]
pub struct CheckProgress {
    ended: AtomicUsize,
    all: usize,
}

impl CheckProgress {
    /// Creates a count of 0 out of `all`.
    pub fn new(all: usize) -> CheckProgress {
        CheckProgress { ended: AtomicUsize::new(0), all }
    }

    /// Counts one more check.
    pub(crate) fn add(&self) {
        self.ended.fetch_add(1, Relaxed);
    }

    /// The number of checks that have ended, and the number asked for.
    pub fn count(&self) -> (usize, usize) {
        (self.ended.load(Relaxed).min(self.all), self.all)
    }
}

/// The answer with the part that it is about, for pictures. The part is absent where the mesh is no
/// solid.
#[derive(Debug)]
pub struct CheckedSolid {
    /// The answer.
    pub answer: CheckAnswer,
    /// The part that the checks looked at.
    pub part: Option<PreparedPart>,
}
