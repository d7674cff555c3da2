//! What can be wrong with a mesh file, told so that a person finds the place.

use std::borrow::Cow;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum At {
    /// 1-based, of a text file.
    Line(u64),
    /// 0-based offset, of a binary file.
    Byte(u64),
    /// The file as a whole.
    File,
}

/// Where a file is not what it claims, what the format wants there, and what there is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    pub at: At,
    pub expected: Cow<'static, str>,
    pub found: Cow<'static, str>,
}

impl Problem {
    pub(crate) fn new(
        at: At,
        expected: impl Into<Cow<'static, str>>,
        found: impl Into<Cow<'static, str>>,
    ) -> Self {
        Problem { at, expected: expected.into(), found: found.into() }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            At::Line(n) => write!(f, "line {n}: ")?,
            At::Byte(n) => write!(f, "byte {n}: ")?,
            At::File => {}
        }
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

/// Why a parser stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    Problem(Problem),
    Cancelled,
}

impl From<Problem> for Stop {
    fn from(p: Problem) -> Self {
        Stop::Problem(p)
    }
}

impl From<crate::job::Cancelled> for Stop {
    fn from(_: crate::job::Cancelled) -> Self {
        Stop::Cancelled
    }
}

/// Why [`super::read_mesh`] gave no mesh. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {problem}", path.display())]
    Format { path: PathBuf, problem: Problem },
    #[error("{}: cancelled", path.display())]
    Cancelled { path: PathBuf },
}

/// Why [`super::write_mesh`] wrote nothing. A file that stood at the path still stands there,
/// whole.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: expected a name that ends in .obj, .stl, .ply, .off, .glb or .3mf", path.display())]
    Extension { path: PathBuf },
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
