//! The Python module `sculptd._native`, over `sculptd-geometry`.
//!
//! Three rules hold for every function here:
//!
//! * A [`mesh::Mesh`] never changes. Its arrays are shared with NumPy and never copied: NumPy reads
//!   the memory of the Rust vectors through `__array_interface__`, and keeps their owner alive.
//! * Long work runs on a separate thread without the interpreter's lock ([`job::watched`]), calls
//!   `progress` with a number from 0 to 1 about ten times a second, and stops on Ctrl+C.
//! * A failure is an exception with its place and its reason as attributes ([`errors`]).

mod array;
mod boolean;
#[path = "../../../cli/embedded_presets.rs"]
mod embedded_presets;
mod errors;
mod file;
mod job;
mod measure;
mod mesh;
mod part_check;
mod picture;
mod pool;
mod remake;
mod solid;
mod thickness;

use pyo3::prelude::*;

/// Registers every class, function and exception.
#[pymodule]
fn _native(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    errors::register(m)?;
    mesh::register(m)?;
    file::register(m)?;
    boolean::register(m)?;
    thickness::register(m)?;
    measure::register(m)?;
    solid::register(m)?;
    remake::register(m)?;
    picture::register(m)
}
