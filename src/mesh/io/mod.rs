//! Mesh files: OBJ, STL, PLY, OFF, in and out. The format is told by the content first, by the name's ending second.
//!
//! Laws kept here: bad input is an error that names the file, the line or byte, and what was expected; sizes are checked
//! before memory is taken; an output is written beside its place and renamed, so that it is there whole or not at all.

mod obj;
mod off;
mod ply;
mod stl;
mod write;

use std::io::Write;
use std::path::{Path, PathBuf};

pub use write::{WriteError, writable_format, write_mesh};

use super::PolyMesh;
use crate::analysis::cancel::Job;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Obj,
    Stl,
    Ply,
    Off,
}

#[derive(Debug)]
pub struct Loaded {
    pub mesh: PolyMesh,
    pub format: Format,
    pub warnings: Vec<String>,
}

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Line(usize),
    Byte(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Place::Line(n) => write!(f, "line {n}"),
            Place::Byte(n) => write!(f, "byte {n}"),
        }
    }
}

/// What a parser says; the file's name is added by [`read_mesh`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {text}")]
pub struct BadMesh {
    pub place: Place,
    pub text: String,
}

impl BadMesh {
    pub fn line(n: usize, text: impl Into<String>) -> Self {
        BadMesh { place: Place::Line(n), text: text.into() }
    }

    pub fn byte(n: usize, text: impl Into<String>) -> Self {
        BadMesh { place: Place::Byte(n), text: text.into() }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {source}", path.display())]
    Bad { path: PathBuf, source: BadMesh },
    #[error("{}: not a mesh that is known here (expected OBJ, STL, PLY or OFF)", path.display())]
    Unknown { path: PathBuf },
}

/// Reads a mesh file.
pub fn read_mesh(path: &Path, job: &Job) -> Result<Loaded, ReadError> {
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
    job.progress(0.2);
    let bad = |source| ReadError::Bad { path: path.into(), source };
    if bytes.is_empty() {
        return Err(bad(BadMesh::byte(0, "the file is empty, expected a mesh")));
    }
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let mut warnings = Vec::new();
    let (format, mesh) = if bytes.starts_with(b"ply") || ending == "ply" {
        (Format::Ply, ply::parse(&bytes).map_err(bad)?)
    } else if ending == "off" || bytes.starts_with(b"OFF") || bytes.starts_with(b"COFF") {
        (Format::Off, off::parse(&bytes).map_err(bad)?)
    } else if ending == "stl" {
        (Format::Stl, stl::parse(&bytes).map_err(bad)?)
    } else if ending == "obj" {
        (Format::Obj, obj::parse(&bytes, &mut warnings).map_err(bad)?)
    } else {
        return Err(ReadError::Unknown { path: path.into() });
    };
    if mesh.face_count() == 0 {
        return Err(bad(BadMesh::byte(bytes.len(), "the file holds no face")));
    }
    Ok(Loaded { mesh, format, warnings })
}

/// Writes a file beside its place, syncs it and renames it: whole or not at all.
pub fn write_beside(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let dir = path.parent().filter(|d| !d.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let part = dir.join(name);
    let result = (|| {
        let file = std::fs::OpenOptions::new().write(true).create(true).truncate(true).open(&part)?;
        let mut out = std::io::BufWriter::with_capacity(1 << 20, file);
        fill(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        std::fs::rename(&part, path)
    })();
    if result.is_err() {
        let _ = std::fs::remove_file(&part);
    }
    result
}

/// A finite number, or what was found instead.
fn number(text: &str, line: usize) -> Result<f64, BadMesh> {
    match text.parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(v),
        Ok(_) => Err(BadMesh::line(line, format!("expected a finite number, found '{text}'"))),
        Err(_) => Err(BadMesh::line(line, format!("expected a number, found '{}'", shorten(text)))),
    }
}

fn shorten(text: &str) -> String {
    text.chars().take(40).collect()
}
