//! What background tasks say of files and operations.

use std::path::Path;

use crate::language::tr;
use sculptd_daemon::repair_jobs::RepairDone;
use sculptd_daemon::symmetrise_job::SymmetriseMade;
use sculptd_geometry::boolean::Operation;

/// A file was written.
pub(super) fn saved(path: &Path) -> String {
    tr!("task-saved", path = path.display().to_string())
}

/// Something went wrong with a file.
pub(super) fn failed(path: &Path, error: &dyn std::fmt::Display) -> String {
    tr!("task-failed", path = path.display().to_string(), error = error.to_string())
}

/// Returns the name of an operation.
pub(super) fn operation_title(operation: Operation) -> String {
    tr!(match operation {
        Operation::Union => "operation-union",
        Operation::Intersection => "operation-intersection",
        Operation::Difference => "operation-difference",
        Operation::ReverseDifference => "operation-reverse-difference",
    })
}

/// The message after one side was made from the other.
pub(super) fn symmetric(made: &SymmetriseMade) -> String {
    tr!("task-symmetrised", crossings = made.crossings)
}

/// The message after a repair: the holes, the pegs, and the findings that are left.
pub(super) fn repaired(done: &RepairDone) -> String {
    let trapped: usize = done.objects.iter().map(|(_, left)| left.trapped.len()).sum();
    let cups: usize = done.objects.iter().map(|(_, left)| left.cups.len()).sum();
    let (holes, pegs) = (done.holes.len(), done.pegs.len());
    let mut text = match done.repaired {
        true => tr!("task-repaired", holes = holes, pegs = pegs),
        false => tr!("task-not-repaired"),
    };
    text.push('\n');
    text.push_str(&tr!("task-repair-left", trapped = trapped, cups = cups));
    for note in &done.notes {
        text.push('\n');
        text.push_str(note);
    }
    text
}
