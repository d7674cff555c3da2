//! The subcommands over mesh files: one module each. Each reads its arguments, calls
//! `sculptd-geometry` and prints; it decides nothing.
//!
//! They are separate from the rest of the command line because they do not depend on the clay: an
//! edit of a brush does not recompile them.
//!
//! Read first: [`Fail`] (the exit codes), [`answer`] (what goes to standard output), then
//! [`convert`], the simplest command that reads and writes.

use std::io::Write;
use std::path::Path;

use sculptd_geometry::io::{ReadError, WriteError};

pub mod boolean;
pub mod check;
pub mod convert;
pub mod decimate;
pub mod distance;
pub mod hollow;
pub mod info;
mod many_files;
pub mod measure;
pub mod offset;
pub mod project;
pub mod remesh;
pub mod remesh_quads;
pub mod repair;
pub mod slice;
pub mod subdivide;
pub mod thickness;

/// Why a command ended badly. The variant is the exit code; the text says what was expected and
/// where.
#[derive(Debug, thiserror::Error)]
pub enum Fail {
    /// 1: a check found something.
    #[error("{0}")]
    Check(String),
    /// 2
    #[error("{0}")]
    Usage(String),
    /// 3
    #[error("{0}")]
    Config(String),
    /// 4
    #[error("{0}")]
    Permission(String),
    /// 5: a device is absent.
    #[error("{0}")]
    Device(String),
    /// 6: a file that can't be read or is not what it claims.
    #[error("{0}")]
    Input(String),
}

impl Fail {
    pub fn code(&self) -> u8 {
        match self {
            Fail::Check(_) => 1,
            Fail::Usage(_) => 2,
            Fail::Config(_) => 3,
            Fail::Permission(_) => 4,
            Fail::Device(_) => 5,
            Fail::Input(_) => 6,
        }
    }

    /// Converts an IO error on `path`: a denied permission has a separate exit code.
    pub fn io(path: &Path, e: &std::io::Error) -> Self {
        let text = format!("{}: {e}", path.display());
        if e.kind() == std::io::ErrorKind::PermissionDenied {
            Fail::Permission(text)
        } else {
            Fail::Input(text)
        }
    }
}

/// The size of a picture on a command line, in pixels: `1200x900`.
pub fn picture_size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parts {
        Some((w, h)) if (16..=8192).contains(&w) && (16..=8192).contains(&h) => Ok((w, h)),
        _ => Err(format!("expected WIDTHxHEIGHT, each from 16 to 8192, found '{text}'")),
    }
}

impl From<ReadError> for Fail {
    fn from(e: ReadError) -> Self {
        match &e {
            ReadError::Io { path, source } => Fail::io(path, source),
            _ => Fail::Input(e.to_string()),
        }
    }
}

impl From<WriteError> for Fail {
    fn from(e: WriteError) -> Self {
        match &e {
            WriteError::Io { path, source } => Fail::io(path, source),
            _ => Fail::Usage(e.to_string()),
        }
    }
}

/// The result of a command.
pub type Outcome = Result<(), Fail>;

/// Prints the answer: the object with `--json`, else the text. A closed pipe is the reader's
/// choice, not an error.
pub fn answer<T: serde::Serialize>(
    json: bool,
    value: &T,
    text: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) {
    let mut out = std::io::stdout().lock();
    let _ = if json {
        serde_json::to_writer(&mut out, value)
            .map_err(std::io::Error::from)
            .and_then(|()| writeln!(out))
    } else {
        text(&mut out)
    };
}
