//! Errors of mesh files, with the place of each.

use std::borrow::Cow;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePlace {
    /// A line of a text file, counted from 1.
    Line(u64),
    /// An offset in a binary file, counted from 0.
    Byte(u64),
    /// The file as a whole.
    File,
}

/// A place where a file violates its format, the expected and the found content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileProblem {
    /// The place.
    pub at: FilePlace,
    /// The expected content.
    pub expected: Cow<'static, str>,
    /// The found content.
    pub found: Cow<'static, str>,
}

impl FileProblem {
    pub(crate) fn new(
        at: FilePlace,
        expected: impl Into<Cow<'static, str>>,
        found: impl Into<Cow<'static, str>>,
    ) -> Self {
        FileProblem { at, expected: expected.into(), found: found.into() }
    }
}

impl fmt::Display for FileProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            FilePlace::Line(n) => write!(f, "line {n}: ")?,
            FilePlace::Byte(n) => write!(f, "byte {n}: ")?,
            FilePlace::File => {}
        }
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

/// The reason why [`super::parse`] stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ParseError {
    /// The bytes are not what they claim.
    Problem(FileProblem),
    /// The job was cancelled.
    Cancelled,
}

impl ParseError {
    /// Returns the same error with the name of the file.
    pub fn of_file(self, path: &Path) -> ReadError {
        match self {
            ParseError::Problem(problem) => ReadError::Format { path: path.into(), problem },
            ParseError::Cancelled => ReadError::Cancelled { path: path.into() },
        }
    }
}

impl From<FileProblem> for ParseError {
    fn from(p: FileProblem) -> Self {
        ParseError::Problem(p)
    }
}

impl From<crate::job::Cancelled> for ParseError {
    fn from(_: crate::job::Cancelled) -> Self {
        ParseError::Cancelled
    }
}

/// The reason why [`super::read_mesh`] returned no mesh. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// The file is not what it claims.
    #[error("{}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The place and the problem.
        problem: FileProblem,
    },
    /// The job was cancelled.
    #[error("{}: cancelled", path.display())]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
}

/// The reason why [`super::write_mesh`] wrote nothing. An existing file at the path stays
/// unchanged.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file could not be written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// The extension names no format that can be written.
    #[error(
        "{}: expected a name that ends in .obj, .stl, .ply, .off, .glb, .gltf or .3mf",
        path.display()
    )]
    Extension {
        /// The file.
        path: PathBuf,
    },
}

/// The first characters of what was found, printable and short.
pub(super) fn excerpt(bytes: &[u8]) -> String {
    let line = bytes.split(|&b| b == b'\n').next().unwrap_or_default();
    let text: String = String::from_utf8_lossy(&line[..line.len().min(60)])
        .chars()
        .map(|c| if c.is_control() { '.' } else { c })
        .collect();
    if text.trim().is_empty() { "nothing".to_string() } else { format!("\"{}\"", text.trim()) }
}
