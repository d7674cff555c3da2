//! Failures as Python exceptions: the text for people, place and reason as attributes for programs.

use pyo3::exceptions::{PyException, PyOSError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use pyo3::{IntoPyObjectExt, create_exception};
use sculptd_geometry::boolean::BooleanError;
use sculptd_geometry::io::{FilePlace, FileProblem, ReadError, WriteError};
use sculptd_geometry::job::Cancelled;
use sculptd_geometry::remesh::RemeshError;
use sculptd_geometry::thickness::ThicknessError;

create_exception!(sculptd, SculptdError, PyException, "The base of this module's exceptions.");
create_exception!(
    sculptd,
    FileFormatError,
    SculptdError,
    "A file is not what it claims. Attributes: path, line (from 1) or byte (from 0) or neither, \
     expected, found."
);
create_exception!(
    sculptd,
    BooleanFailed,
    SculptdError,
    "A Boolean has no result. Attributes: operand ('A', 'B' or None), kind ('open', 'inside-out', \
     'not-finite', 'inconsistent'), edges (of an open operand)."
);
create_exception!(
    sculptd,
    EmptyResult,
    SculptdError,
    "The operation leaves nothing, e.g. a wall thicker than the part."
);
create_exception!(
    sculptd,
    JobCancelled,
    SculptdError,
    "The work was cancelled by an exception of the progress function or by a signal."
);

create_exception!(
    sculptd,
    LossWarning,
    PyUserWarning,
    "A file does not hold all of a mesh, or a mesh not all of a file."
);

/// Adds the exceptions under the names that Python sees.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let add = |name: &str, of: Bound<'_, PyType>| m.add(name, of);
    let py = m.py();
    add("SculptdError", py.get_type::<SculptdError>())?;
    add("FileFormatError", py.get_type::<FileFormatError>())?;
    add("BooleanFailed", py.get_type::<BooleanFailed>())?;
    add("EmptyResult", py.get_type::<EmptyResult>())?;
    add("JobCancelled", py.get_type::<JobCancelled>())?;
    add("LossWarning", py.get_type::<LossWarning>())
}

/// `e` with attributes; where one can't be set, that error instead.
fn with<const N: usize>(py: Python<'_>, e: PyErr, attributes: [(&str, Py<PyAny>); N]) -> PyErr {
    for (name, value) in attributes {
        if let Err(other) = e.value(py).setattr(name, value) {
            return other;
        }
    }
    e
}

fn object<'py, T: IntoPyObjectExt<'py>>(py: Python<'py>, value: T) -> Py<PyAny> {
    value.into_py_any(py).unwrap_or_else(|_| py.None())
}

fn format(py: Python<'_>, path: &str, problem: &FileProblem) -> PyErr {
    let (line, byte) = match problem.at {
        FilePlace::Line(n) => (Some(n), None),
        FilePlace::Byte(n) => (None, Some(n)),
        FilePlace::File => (None, None),
    };
    with(
        py,
        FileFormatError::new_err(format!("{path}: {problem}")),
        [
            ("path", object(py, path)),
            ("line", object(py, line)),
            ("byte", object(py, byte)),
            ("expected", object(py, problem.expected.as_ref())),
            ("found", object(py, problem.found.as_ref())),
        ],
    )
}

/// An OS error as Python's own, so that `except FileNotFoundError` works.
fn system(path: &std::path::Path, source: &std::io::Error) -> PyErr {
    match source.raw_os_error() {
        // Three arguments make Python choose the subclass by the number.
        Some(n) => PyOSError::new_err((n, source.to_string(), path.display().to_string())),
        None => PyOSError::new_err(format!("{}: {source}", path.display())),
    }
}

/// The exception for a file that could not be read.
pub fn read(py: Python<'_>, e: &ReadError) -> PyErr {
    match e {
        ReadError::Io { path, source } => system(path, source),
        ReadError::Format { path, problem } => format(py, &path.display().to_string(), problem),
        ReadError::Cancelled { .. } => cancelled(Cancelled),
    }
}

/// The exception for a file that could not be written.
pub fn write(e: &WriteError) -> PyErr {
    match e {
        WriteError::Io { path, source } => system(path, source),
        WriteError::Extension { .. } => PyValueError::new_err(e.to_string()),
    }
}

/// The exception for a Boolean without a result.
pub fn boolean(py: Python<'_>, e: &BooleanError) -> PyErr {
    let (operand, kind, count) = match e {
        BooleanError::Open { operand, edges } => (Some(*operand), "open", Some(*edges)),
        BooleanError::InsideOut { operand, .. } => (Some(*operand), "inside-out", None),
        BooleanError::NotFinite { operand } => (Some(*operand), "not-finite", None),
        BooleanError::Inconsistent(_) => (None, "inconsistent", None),
        BooleanError::Cancelled(c) => return cancelled(*c),
    };
    with(
        py,
        BooleanFailed::new_err(e.to_string()),
        [
            ("operand", object(py, operand)),
            ("kind", object(py, kind)),
            ("edges", object(py, count)),
        ],
    )
}

/// The exception for a thickness that could not be measured.
pub fn thickness(e: &ThicknessError) -> PyErr {
    match e {
        ThicknessError::Cancelled(c) => cancelled(*c),
        ThicknessError::Setting { .. } => PyValueError::new_err(e.to_string()),
    }
}

/// The exception for a surface that could not be made.
pub fn remesh(e: &RemeshError) -> PyErr {
    match e {
        RemeshError::Cancelled(c) => cancelled(*c),
        RemeshError::Empty | RemeshError::TooDeep { .. } => EmptyResult::new_err(e.to_string()),
        RemeshError::Side(_) => PyValueError::new_err(e.to_string()),
    }
}

/// A job that was cancelled.
pub fn cancelled(_: Cancelled) -> PyErr {
    JobCancelled::new_err("cancelled")
}
