//! A tablet from its own words: report descriptor and parameter strings.

use std::sync::Arc;

use super::{Found, Identification, Identity, Params};
use crate::descriptor::{Bits, Descriptor, Kind, PenLayout};
use crate::tablet::{Area, Family, Id, Pad, PenFacts, Tablet};

/// Makers whose reports are UC-Logic's whatever their descriptors say: those label the second
/// button an eraser.
pub(super) const UC_LOGIC: [u16; 3] = [0x5543, 0x256c, 0x28bd];

/// The last resort.
pub(super) fn described(who: &Identity, d: &Descriptor) -> Identification {
    let uc_logic = UC_LOGIC.contains(&who.vid);
    let pen = d.pens.iter().find(|p| p.pressure.is_some()).or(d.pens.first());
    let Some((pen, (x, y))) = pen.and_then(|p| Some((p, p.x.as_ref().zip(p.y.as_ref())?))) else {
        return match Params::of(who).filter(|_| uc_logic && d.kinds.contains(&Kind::Vendor)) {
            Some(params) => Identification::Identified(by_params(who, d, params)),
            None => Identification::Declined(format!("no pen: {}", kinds_in_words(&d.kinds))),
        };
    };
    let Some(scale) = Scale::of(pen) else {
        return Identification::Declined("the pen's axes have no range".to_owned());
    };
    let (mut area, mut note) = (scale.area, "by its report descriptor");
    if let Some(params) = Params::of(who).filter(|_| uc_logic) {
        (area.width_mm, area.height_mm) = params.size_mm();
    } else if stated_size(x, y).is_none() {
        note = "by its report descriptor; size guessed from 5080 lines an inch";
    }
    let family = if uc_logic { Family::UcLogic } else { Family::Digitiser };
    let pen = PenFacts {
        max_pressure: scale.max_pressure,
        buttons: pen.barrel.iter().flatten().count() as u8,
        max_distance: scale.max_distance,
    };
    Identification::Identified(found(who, d, area, pen, family, note))
}

fn by_params(who: &Identity, d: &Descriptor, params: Params) -> Found {
    let (width_mm, height_mm) = params.size_mm();
    let area = Area {
        width_mm,
        height_mm,
        min_x: 0,
        min_y: 0,
        max_x: params.max_x as i32,
        max_y: params.max_y as i32,
    };
    let pen = PenFacts { max_pressure: params.max_pressure, buttons: 2, max_distance: 0 };
    let family = if who.vid == 0x256c { Family::Huion } else { Family::UcLogic };
    Found { described: false, ..found(who, d, area, pen, family, "by its parameter string") }
}

fn found(
    who: &Identity,
    d: &Descriptor,
    area: Area,
    pen: PenFacts,
    parser: Family,
    note: &str,
) -> Found {
    let name = if who.name.is_empty() {
        format!("digitiser {:04x}:{:04x}", who.vid, who.pid)
    } else {
        who.name.clone()
    };
    let id = Id {
        vid: who.vid,
        pid: who.pid,
        length: d.longest_input().min(usize::from(u16::MAX)) as u16,
        parser,
        interface: None,
        skip: 0,
        strings: Vec::new(),
        init_feature: Vec::new(),
        init_output: Vec::new(),
        init_strings: Vec::new(),
        quirks: Vec::new(),
    };
    let tablet = Tablet {
        name,
        source: "the device itself".to_owned(),
        area,
        pen,
        pad: Pad::default(),
        id: vec![id],
    };
    Found { tablet: Arc::new(tablet), at: 0, note: Some(note.to_owned()), described: true }
}

/// Ranges of one described report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub area: Area,
    pub max_pressure: u32,
    pub max_distance: u32,
}

impl Scale {
    /// `None` without axes or without their range.
    pub(crate) fn of(pen: &PenLayout) -> Option<Scale> {
        let (x, y) = (pen.x.as_ref()?, pen.y.as_ref()?);
        if x.max <= x.min || y.max <= y.min {
            return None;
        }
        // Without a physical size, 5080 lines an inch is the commonest resolution by far.
        let guess =
            |b: &Bits| ((f64::from(b.max) - f64::from(b.min)) * 25.4 / 5080.0).clamp(5.0, 5000.0);
        let (width_mm, height_mm) = stated_size(x, y).unwrap_or_else(|| (guess(x), guess(y)));
        let span =
            |b: &Option<Bits>| b.as_ref().map_or(0, |b| b.max.saturating_sub(b.min).max(0) as u32);
        let area =
            Area { width_mm, height_mm, min_x: x.min, min_y: y.min, max_x: x.max, max_y: y.max };
        Some(Scale { area, max_pressure: span(&pen.pressure), max_distance: span(&pen.distance) })
    }
}

/// The physical size that the descriptor states. Huion's default form states 2.048 inches square
/// for every tablet: not believed.
fn stated_size(x: &Bits, y: &Bits) -> Option<(f64, f64)> {
    let size = x.span_mm().zip(y.span_mm())?;
    (x.physical != Some((0, 0x800)) || y.physical != x.physical).then_some(size)
}

fn kinds_in_words(kinds: &[Kind]) -> String {
    if kinds.is_empty() {
        return "the interface has no input".to_owned();
    }
    let word = |k: &Kind| match k {
        Kind::Pen => "pen without axes",
        Kind::Touch => "touch",
        Kind::Mouse => "mouse",
        Kind::Keyboard => "keyboard",
        Kind::Consumer => "media keys",
        Kind::Vendor => "maker's own",
        Kind::Other => "other",
    };
    kinds.iter().map(word).collect::<Vec<_>>().join(", ")
}
