//! What background tasks say of files and operations.

use std::path::Path;

use crate::language::tr;
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
