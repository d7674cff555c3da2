//! Meshes from and to files: paths, and objects of Python that read or write bytes.

use std::ffi::CString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{
    self as files, LoadedMesh, WriteError, encode, left_out, lost, read_mesh, rounding,
    writable_format, write_beside,
};
use sculptd_geometry::job::Job;

use crate::errors::{self, LossWarning};
use crate::job::{Progress, watched};
use crate::mesh::Mesh;

/// A file on disk, or an object of Python with `read` or `write`.
enum Place<'py> {
    Path(PathBuf),
    Object(Bound<'py, PyAny>, PathBuf),
}

impl<'py> Place<'py> {
    /// Returns the place that `file` stands for. An object with the method `verb` is a file; its
    /// name gives the format, unless `format` does.
    fn of(file: &Bound<'py, PyAny>, verb: &str, format: Option<&str>) -> PyResult<Place<'py>> {
        if !file.hasattr(verb)? {
            return Ok(Place::Path(file.extract()?));
        }
        let own = file.getattr("name").ok().and_then(|name| name.extract::<PathBuf>().ok());
        let name = match format {
            Some(format) => PathBuf::from(format!("file.{format}")),
            None => own.unwrap_or_else(|| PathBuf::from("file")),
        };
        Ok(Place::Object(file.clone(), name))
    }
}

/// Warns with a LossWarning for each sentence; with `strict` raises the first.
pub fn tell(py: Python<'_>, sentences: &[String], strict: bool) -> PyResult<()> {
    let category = py.get_type::<LossWarning>();
    for text in sentences {
        if strict {
            return Err(LossWarning::new_err(text.clone()));
        }
        let text = CString::new(text.replace('\0', " "))?;
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}

/// Reads a mesh: OBJ, STL, PLY, OFF, glTF, GLB or 3MF; the content decides the format.
///
/// `path`: a path, or a binary file object. `format`: the ending of the format ('stl') for content
/// that does not say it. What the mesh does not keep of the file is in `warnings` of the mesh and
/// is a LossWarning; with `strict` it is raised.
///
/// Raises OSError (FileNotFoundError and others) if the file can't be opened. Raises
/// FileFormatError, with the line or byte, if the content violates the format.
#[pyfunction]
#[pyo3(signature = (path, progress=None, *, format=None, strict=false))]
fn read(
    py: Python<'_>,
    path: &Bound<'_, PyAny>,
    progress: Progress,
    format: Option<&str>,
    strict: bool,
) -> PyResult<Mesh> {
    let loaded = match (Place::of(path, "read", format)?, format) {
        (Place::Path(path), None) => watched(py, &progress, move |job| read_mesh(&path, job))?,
        (Place::Path(path), Some(format)) => {
            let name = Path::new("file").with_extension(format);
            watched(py, &progress, move |job| {
                let bytes = files::read_regular(&path, files::MAX_FILE)
                    .map_err(|source| files::ReadError::Io { path: path.clone(), source })?;
                files::parse(&bytes, &name, job).map_err(|e| e.of_file(&path))
            })?
        }
        (Place::Object(object, name), _) => {
            let bytes: Vec<u8> = object.call_method0("read")?.cast::<PyBytes>()?.as_bytes().into();
            watched(py, &progress, move |job| {
                files::parse(&bytes, &name, job).map_err(|e| e.of_file(&name))
            })?
        }
    };
    let LoadedMesh { mesh, format, warnings, .. } = loaded.map_err(|e| errors::read(py, &e))?;
    tell(py, &warnings, strict)?;
    Ok(Mesh::read(mesh, format.name(), warnings))
}

/// Stops writing once the job is cancelled.
struct StoppableWriter<'a> {
    out: &'a mut dyn Write,
    job: &'a Job,
}

impl Write for StoppableWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.job.check().map_err(io::Error::other)?;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.job.check().map_err(io::Error::other)?;
        self.out.flush()
    }
}

fn fill(kind: &str, mesh: &PolyMesh, out: &mut dyn Write, job: &Job) -> io::Result<()> {
    let mut out = StoppableWriter { out, job };
    encode(kind, mesh, &mut out)?;
    out.flush()
}

/// Coordinates that move by more than this part of the mesh's size are worth a warning.
const VISIBLE: f64 = 1e-6;

/// A sentence on coordinates that the format rounds: on all of them with `strict`, otherwise where
/// the mesh is so far from the origin that it may be seen.
fn rounded(kind: &str, mesh: &PolyMesh, strict: bool) -> Option<String> {
    let by = rounding(kind, mesh);
    let (low, high) = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let least = if strict { 0.0 } else { VISIBLE * (high - low).length() };
    (by > least).then(|| {
        format!(
            "the coordinates are rounded to single precision: .{kind} moves them by up to {by:.1e}"
        )
    })
}

/// Writes `mesh`, see `Mesh.write`.
pub fn write(
    py: Python<'_>,
    mesh: Arc<PolyMesh>,
    path: &Bound<'_, PyAny>,
    format: Option<&str>,
    strict: bool,
) -> PyResult<()> {
    let place = Place::of(path, "write", format)?;
    let kind = match (format, &place) {
        (Some(format), _) => writable_format(&Path::new("file").with_extension(format)),
        (None, Place::Path(name) | Place::Object(_, name)) => writable_format(name),
    };
    let kind = kind.map_err(|e| match (&place, format) {
        (Place::Object(_, name), None) if name.extension().is_none() => PyValueError::new_err(
            "format: expected a format such as 'stl', for a file object has no ending to go by",
        ),
        _ => errors::write(&e),
    })?;
    // Primitives and results are polygons: to cut them changes no surface, so only `strict` minds.
    let mut losses = if strict { left_out(kind, &mesh) } else { lost(kind, &mesh) };
    losses.extend(rounded(kind, &mesh, strict));
    tell(py, &losses, strict)?;
    match place {
        Place::Path(path) => {
            let to = path.clone();
            watched(py, &None, move |job| write_beside(&to, |out| fill(kind, &mesh, out, job)))?
                .map_err(|source| errors::write(&WriteError::Io { path, source }))
        }
        Place::Object(object, path) => {
            let bytes = watched(py, &None, move |job| {
                let mut bytes = Vec::new();
                fill(kind, &mesh, &mut bytes, job).map(|()| bytes)
            })?
            .map_err(|source| errors::write(&WriteError::Io { path, source }))?;
            object.call_method1("write", (PyBytes::new(py, &bytes),)).map(|_| ())
        }
    }
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(read, m)?)
}
