//! Every known model, and which of them a device is.
//!
//! One id often stands for many models (256c:006d for 59). They are told apart by what can be read:
//! report lengths, USB strings, the parameters that some of those strings hold, names. What remains
//! ambiguous is said to be; nothing is guessed in silence.

mod described;
mod identify;
mod params;

use std::path::Path;
use std::sync::Arc;

use crate::descriptor::Descriptor;
use crate::tablet::{Id, Tablet, TabletError};

pub(crate) use described::Scale;
pub use params::Params;

/// The tablet that an interface's descriptor describes, where it describes one.
pub(crate) fn by_descriptor(vid: u16, pid: u16, descriptor: &[u8]) -> Option<Found> {
    let d = Descriptor::parse(descriptor).ok().filter(|d| !d.pens.is_empty())?;
    match described::described(&Identity { vid, pid, ..Identity::default() }, &d) {
        Identification::Identified(found) => Some(found),
        _ => None,
    }
}

/// What can be read of one interface of a device before it speaks, and for recordings what it then
/// sent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Identity {
    pub vid: u16,
    pub pid: u16,
    pub interface: Option<u8>,
    pub name: String,
    pub descriptor: Vec<u8>,
    /// USB string descriptors by index, with their two-byte header.
    pub strings: Vec<(u8, Vec<u8>)>,
    /// Lengths of reports seen.
    pub seen_lengths: Vec<usize>,
}

impl Identity {
    /// A USB string's text, where it is known.
    pub fn string(&self, index: u8) -> Option<String> {
        let raw = &self.strings.iter().find(|(i, _)| *i == index)?.1;
        let units: Vec<u16> =
            raw.get(2..)?.chunks_exact(2).map(|p| u16::from_le_bytes([p[0], p[1]])).collect();
        Some(String::from_utf16_lossy(&units).trim_matches('\0').to_owned())
    }
}

/// A model, and which of its `[[id]]`s matched.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    pub tablet: Arc<Tablet>,
    pub at: usize,
    /// Why this model and not a namesake.
    pub note: Option<String>,
    /// Made up from the device's own descriptor, whose ranges differ by report.
    pub described: bool,
}

impl Found {
    pub fn id(&self) -> &Id {
        &self.tablet.id[self.at]
    }

    /// A described interface of a device whose model is known by another of its interfaces: that
    /// model's size and name.
    pub fn sized_like(&mut self, known: &Found) {
        let tablet = Arc::make_mut(&mut self.tablet);
        tablet.name.clone_from(&known.tablet.name);
        tablet.area.width_mm = known.tablet.area.width_mm;
        tablet.area.height_mm = known.tablet.area.height_mm;
    }

    /// Model, parser and reason, for people.
    pub fn in_words(&self) -> String {
        let why = self.note.as_ref().map_or(String::new(), |n| format!(" ({n})"));
        format!("{}, parser {}{why}", self.tablet.name, self.id().parser.name())
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Identification {
    Identified(Found),
    /// Left alone, and why.
    Declined(String),
    /// Several models answer to this, the likeliest first; the user is asked once.
    Ambiguous(Vec<Found>),
}

#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    tablets: Vec<Arc<Tablet>>,
    /// How many of them the user added; they win.
    added: usize,
}

impl Catalogue {
    /// The models built into the program.
    pub fn builtin() -> Result<Catalogue, TabletError> {
        let mut all = Catalogue::default();
        for (file, text) in crate::builtin::TABLETS {
            all.tablets.push(Arc::new(Tablet::parse(file, text)?));
        }
        Ok(all)
    }

    /// Adds every `.toml` of a folder; they come before the built-in ones, so that a user's facts
    /// win.
    pub fn with_dir(mut self, dir: &Path) -> Result<Catalogue, TabletError> {
        let fail = |what: String| TabletError { file: dir.display().to_string(), what };
        let mut paths: Vec<_> = std::fs::read_dir(dir)
            .and_then(|entries| entries.map(|e| e.map(|e| e.path())).collect::<Result<Vec<_>, _>>())
            .map_err(|e| fail(e.to_string()))?;
        paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
        paths.sort();
        let mut tablets = Vec::new();
        for path in paths {
            let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
            tablets.push(Arc::new(Tablet::parse(&path.display().to_string(), &text)?));
        }
        self.added += tablets.len();
        tablets.append(&mut self.tablets);
        Ok(Catalogue { tablets, added: self.added })
    }

    /// The model of this name, as the user told it, if it has an entry for these ids.
    pub fn named(&self, name: &str, who: &Identity) -> Option<Found> {
        let tablet = self.tablets.iter().find(|t| t.name == name)?;
        let at = tablet.id.iter().position(|id| id.vid == who.vid && id.pid == who.pid)?;
        Some(Found {
            tablet: tablet.clone(),
            at,
            note: Some("as the user said".to_owned()),
            described: false,
        })
    }

    pub fn tablets(&self) -> &[Arc<Tablet>] {
        &self.tablets
    }
}
