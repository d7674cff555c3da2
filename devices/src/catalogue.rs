//! Every known model, and which of them a device is.

use std::path::Path;
use std::sync::Arc;

use crate::hid::descriptor::{Bits, Descriptor, Kind};
use crate::tablet::{Area, Family, Id, PenFacts, Tablet, TabletError};

/// What can be read of one interface of a device before it speaks, and for recordings what it then sent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Identity {
    pub vid: u16,
    pub pid: u16,
    pub interface: Option<u8>,
    pub name: String,
    pub descriptor: Vec<u8>,
    /// USB strings by index, as raw bytes after their two-byte header.
    pub strings: Vec<(u8, Vec<u8>)>,
    /// Lengths of reports seen.
    pub seen_lengths: Vec<usize>,
}

/// A model, and which of its `[[id]]`s matched.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    pub tablet: Arc<Tablet>,
    pub at: usize,
    /// Why this model and not a namesake.
    pub note: Option<String>,
}

impl Found {
    pub fn id(&self) -> &Id {
        &self.tablet.id[self.at]
    }

    /// Model, parser and reason, for people.
    pub fn in_words(&self) -> String {
        let parser = serde_json::to_string(&self.id().parser).unwrap_or_default();
        let why = self.note.as_ref().map_or(String::new(), |n| format!(" ({n})"));
        format!("{}, parser {}{why}", self.tablet.name, parser.trim_matches('"'))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Identification {
    Identified(Found),
    /// Left alone, and why.
    Declined(String),
    /// Several models answer to this; the user is asked once.
    Ambiguous(Vec<Found>),
}

#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    tablets: Vec<Arc<Tablet>>,
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

    /// Adds every `.toml` of a folder; they come before the built-in ones, so that a user's facts win.
    pub fn with_dir(mut self, dir: &Path) -> Result<Catalogue, TabletError> {
        let fail = |what: String| TabletError { file: dir.display().to_string(), what };
        let mut paths: Vec<_> = std::fs::read_dir(dir)
            .and_then(|entries| entries.map(|e| e.map(|e| e.path())).collect::<Result<Vec<_>, _>>())
            .map_err(|e| fail(e.to_string()))?;
        paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
        paths.sort();
        let mut added = Vec::new();
        for path in paths {
            let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
            added.push(Arc::new(Tablet::parse(&path.display().to_string(), &text)?));
        }
        added.append(&mut self.tablets);
        Ok(Catalogue { tablets: added })
    }

    pub fn tablets(&self) -> &[Arc<Tablet>] {
        &self.tablets
    }

    /// Which model an interface belongs to.
    pub fn identify(&self, who: &Identity) -> Identification {
        let descriptor = Descriptor::parse(&who.descriptor);
        let mut found: Vec<Found> = Vec::new();
        for tablet in &self.tablets {
            for (at, id) in tablet.id.iter().enumerate() {
                if id.vid == who.vid && id.pid == who.pid && fits(id, who, descriptor.as_ref().ok()) {
                    found.push(Found { tablet: tablet.clone(), at, note: None });
                }
            }
        }
        if let Some(one) = found.into_iter().next() {
            return Identification::Identified(one);
        }
        match descriptor {
            Err(e) => Identification::Declined(e.to_string()),
            Ok(d) => described(who, &d),
        }
    }
}

fn fits(id: &Id, who: &Identity, descriptor: Option<&Descriptor>) -> bool {
    if id.interface.is_some() && who.interface.is_some() && id.interface != who.interface {
        return false;
    }
    let n = usize::from(id.length);
    who.seen_lengths.contains(&n) || descriptor.is_some_and(|d| d.declares_length(n))
}

/// A tablet from its own description.
fn described(who: &Identity, d: &Descriptor) -> Identification {
    let Some(pen) = d.pens.iter().find(|p| p.pressure.is_some()).or(d.pens.first()) else {
        return Identification::Declined(format!("no pen: {}", kinds_in_words(&d.kinds)));
    };
    let (Some(x), Some(y)) = (&pen.x, &pen.y) else { return Identification::Declined("no axes".to_owned()) };
    if x.max <= x.min || y.max <= y.min {
        return Identification::Declined("the pen's axes have no range".to_owned());
    }
    // Without a physical size, 5080 lines an inch is the commonest resolution by far.
    let guess = |bits: &Bits| (f64::from(bits.max) - f64::from(bits.min)) * 25.4 / 5080.0;
    let (width, height, note) = match (x.span_mm(), y.span_mm()) {
        (Some(w), Some(h)) => (w, h, None),
        _ => (
            guess(x).clamp(5.0, 5000.0),
            guess(y).clamp(5.0, 5000.0),
            Some("size guessed from 5080 lines an inch"),
        ),
    };
    let span = |bits: &Option<Bits>| bits.as_ref().map_or(0, |b| b.max.saturating_sub(b.min).max(0) as u32);
    let tablet = Tablet {
        name: if who.name.is_empty() {
            format!("digitiser {:04x}:{:04x}", who.vid, who.pid)
        } else {
            who.name.clone()
        },
        source: "its report descriptor".to_owned(),
        area: Area {
            width_mm: width,
            height_mm: height,
            min_x: x.min,
            min_y: y.min,
            max_x: x.max,
            max_y: y.max,
        },
        pen: PenFacts {
            max_pressure: span(&pen.pressure),
            buttons: pen.barrel.iter().flatten().count() as u8,
            max_distance: span(&pen.distance),
        },
        pad: crate::tablet::Pad::default(),
        id: vec![Id {
            vid: who.vid,
            pid: who.pid,
            length: d.longest_input().min(usize::from(u16::MAX)) as u16,
            parser: Family::Digitiser,
            interface: None,
            skip: 0,
            strings: Vec::new(),
            init_feature: Vec::new(),
            init_output: Vec::new(),
            init_strings: Vec::new(),
            quirks: Vec::new(),
        }],
    };
    Identification::Identified(Found { tablet: Arc::new(tablet), at: 0, note: note.map(str::to_owned) })
}

fn kinds_in_words(kinds: &[Kind]) -> String {
    if kinds.is_empty() {
        return "the interface has no input".to_owned();
    }
    let words: Vec<&str> = kinds
        .iter()
        .map(|k| match k {
            Kind::Pen => "pen without axes",
            Kind::Touch => "touch",
            Kind::Mouse => "mouse",
            Kind::Keyboard => "keyboard",
            Kind::Consumer => "media keys",
            Kind::Vendor => "maker's own",
            Kind::Other => "other",
        })
        .collect();
    words.join(", ")
}
