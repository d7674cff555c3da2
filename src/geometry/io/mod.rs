//! Mesh files: OBJ, STL, PLY, glTF/GLB, 3MF, OFF, in and out.
//!
//! The content decides the format of a file; the extension decides only if the content does not.
//! Positions keep double precision and faces their corners, as far as the format has them. Counts
//! in a file are compared with its length before memory is allocated for them; data that may grow
//! beyond it (3MF's packed parts, instances in glTF and 3MF) has a separate bound. Errors report
//! the line or byte where the format has one, the expected and the found content.

pub mod beside;
mod contents;
mod face_colours;
mod format;
#[cfg(test)]
mod formats;
mod gltf;
pub mod height_picture;
pub mod morph;
mod obj;
mod off;
mod ply;
pub mod problem;
mod regular;
mod stl;
mod text;
mod threemf;
#[cfg(test)]
mod variants;
mod write;
mod write_gltf;
mod write_scene;
mod write_threemf;

use std::borrow::Cow;
use std::path::Path;

pub use beside::write_beside;
pub use contents::FileContents;
pub use format::MeshFormat;
pub use morph::{MorphTarget, MorphedMesh};
pub use problem::{FilePlace, FileProblem, ParseError, ReadError, WriteError};
pub use regular::read_regular;
pub use write::{
    encode, left_out, lost, rounding, states_unit, writable_format, write_mesh, write_painted,
};
pub use write_scene::{SceneMesh, merged, write_scene};

use super::PolyMesh;
use crate::filaments::Filaments;
use crate::job::Job;
use gltf::GltfUnit;

/// Longest file that is read: what needs more memory than a workstation has is refused before it is
/// taken.
pub const MAX_FILE: u64 = 16 << 30;

/// A mesh from a file.
#[derive(Debug, Clone)]
pub struct LoadedMesh {
    /// The mesh, with the file's coordinates as they stand; in millimetres from 3MF.
    pub mesh: PolyMesh,
    /// The format detected in the file.
    pub format: MeshFormat,
    /// The data left out or guessed, one sentence each.
    pub warnings: Vec<String>,
    /// Morph targets, which are not applied to the mesh; glTF only.
    pub targets: Vec<MorphTarget>,
}

/// Reads the mesh at `path`, a regular file of at most [`MAX_FILE`] bytes. Every vertex is finite
/// in single precision too, every face has at least three corners, every index is in range; nothing
/// else is promised: it may be open, crossed or inside out ([`super::check::report`] tells).
pub fn read_mesh(path: &Path, job: &Job) -> Result<LoadedMesh, ReadError> {
    read_within(path, MAX_FILE, (GltfUnit::AsTheyStand, job))
}

/// As [`read_mesh`], of at most `limit` bytes and in millimetres: glTF has metres. A glTF file that
/// this program wrote has its numbers in millimetres, with or without a node that converts them.
pub fn read_in_millimetres(path: &Path, limit: u64, job: &Job) -> Result<LoadedMesh, ReadError> {
    read_within(path, limit, (GltfUnit::Millimetres, job))
}

/// Reads the filaments of the 3MF file at `path`, as [`write_painted`] writes them.
pub fn read_painting(path: &Path, job: &Job) -> Result<Filaments, ReadError> {
    let bytes = read_regular(path, MAX_FILE)
        .map_err(|source| ReadError::Io { path: path.into(), source })?;
    threemf::parse_painting(&bytes, job).map_err(|stop| stop.of_file(path))
}

fn read_within(
    path: &Path,
    limit: u64,
    (unit, job): (GltfUnit, &Job),
) -> Result<LoadedMesh, ReadError> {
    let bytes = read_regular(path, limit).map_err(|source| match source.kind() {
        std::io::ErrorKind::FileTooLarge => {
            let problem = FileProblem::new(
                FilePlace::File,
                format!("at most {limit} bytes"),
                source.to_string(),
            );
            ReadError::Format { path: path.into(), problem }
        }
        _ => ReadError::Io { path: path.into(), source },
    })?;
    job.progress(0.1);
    parse_in(&bytes, path, (unit, job)).map_err(|stop| stop.of_file(path))
}

/// The mesh in `bytes`; `name` gives the extension.
pub fn parse(bytes: &[u8], name: &Path, job: &Job) -> Result<LoadedMesh, ParseError> {
    parse_in(bytes, name, (GltfUnit::AsTheyStand, job))
}

/// As [`parse`], in millimetres ([`read_in_millimetres`]).
pub fn parse_in_millimetres(
    bytes: &[u8],
    name: &Path,
    job: &Job,
) -> Result<LoadedMesh, ParseError> {
    parse_in(bytes, name, (GltfUnit::Millimetres, job))
}

fn parse_in(
    bytes: &[u8],
    name: &Path,
    (unit, job): (GltfUnit, &Job),
) -> Result<LoadedMesh, ParseError> {
    let extension = extension(name);
    if bytes.is_empty() {
        return Err(FileProblem::new(FilePlace::Byte(0), "a mesh", "an empty file").into());
    }
    let mut warnings = Vec::new();
    let mut targets = Vec::new();
    let unmarked = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let is = |e: &str| extension == e;
    let plain = as_text(unmarked);
    let text = &*plain;
    let (mesh, format) = if unmarked.starts_with(b"ply")
        && unmarked.get(3).is_some_and(u8::is_ascii_whitespace)
        || is("ply")
    {
        ply::parse(unmarked, &mut warnings, job)?
    } else if bytes.starts_with(b"glTF") || is("glb") {
        if !bytes.starts_with(b"glTF") {
            return Err(
                FileProblem::new(FilePlace::Byte(0), "\"glTF\"", problem::excerpt(bytes)).into()
            );
        }
        (gltf::parse(bytes, name, &mut warnings, &mut targets, (unit, job))?, MeshFormat::Glb)
    } else if text.trim_ascii_start().starts_with(b"{") || is("gltf") {
        (gltf::parse(text, name, &mut warnings, &mut targets, (unit, job))?, MeshFormat::Gltf)
    } else if bytes.starts_with(b"PK\x03\x04") || is("3mf") {
        (threemf::parse(bytes, &mut warnings, job)?, MeshFormat::ThreeMf)
    } else if off::header(text).is_some() || is("off") {
        (off::parse(text, &mut warnings, job)?, MeshFormat::Off)
    } else if stl::binary_exact(bytes) {
        (stl::parse_binary(bytes, &mut warnings, job)?, MeshFormat::StlBinary)
    } else if stl::looks_ascii(text) {
        (stl::parse_ascii(text, &mut warnings, job)?, MeshFormat::StlAscii)
    } else if is("stl") {
        (stl::parse_binary(bytes, &mut warnings, job)?, MeshFormat::StlBinary)
    } else if is("obj") || looks_obj(text) {
        (obj::parse(text, &mut warnings, job)?, MeshFormat::Obj)
    } else {
        let found = problem::excerpt(bytes);
        return Err(FileProblem::new(
            FilePlace::Byte(0),
            "a mesh as OBJ, STL, PLY, OFF, glTF, GLB or 3MF",
            found,
        )
        .into());
    };
    job.progress(1.0);
    Ok(LoadedMesh { mesh, format, warnings, targets })
}

/// Text as this program reads it: what old systems put behind the end (zeros, Ctrl-Z) is left out,
/// and where lines end with a carriage return alone, they end with a line feed.
fn as_text(bytes: &[u8]) -> Cow<'_, [u8]> {
    let end = bytes.iter().rposition(|b| !matches!(b, 0 | 0x1a)).map_or(0, |at| at + 1);
    let text = &bytes[..end];
    let head = &text[..text.len().min(1 << 16)];
    // A file of several lines has an end of line near its beginning; packed numbers have zeros.
    if head.contains(&b'\r') && memchr::memchr2(b'\n', 0, text).is_none() {
        return text.iter().map(|b| if *b == b'\r' { b'\n' } else { *b }).collect();
    }
    Cow::Borrowed(text)
}

fn extension(name: &Path) -> String {
    name.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Returns true if the text looks like OBJ, which has no signature: checks its first word if the
/// extension does not decide.
fn looks_obj(text: &[u8]) -> bool {
    let word = text::TextCursor::new(&text[..text.len().min(1 << 16)]).word_anywhere(true);
    matches!(word, Some(b"v" | b"o" | b"g" | b"mtllib" | b"usemtl" | b"vn" | b"vt"))
}
