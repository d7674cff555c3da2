//! A tablet made from what the device states of itself: its report descriptor, its parameter
//! string.

use std::sync::Arc;

use super::found::{Found, Identification};
use super::identity::{Identity, TABLET_VENDORS, UC_LOGIC};
use super::params::Params;
use super::rewritten::rewritten;
use super::size;
use crate::descriptor::{Bits, CollectionKind, Descriptor, PenLayout};
use crate::tablet::{Area, Family, Id, PadFacts, PenFacts, Tablet};

/// A size in whole inches and the descriptor's agree within this share.
const NOMINAL: f64 = 0.2;

/// Identifies an interface by its report descriptor.
///
/// `known`: the model, if the catalogue has one for these ids whose reports are described; its name
/// and size are used.
///
/// `size_mm`: the size shared by every model with these ids; it is used if the descriptor states
/// none.
pub(super) fn described(
    who: &Identity,
    d: &Descriptor,
    known: Option<&Tablet>,
    size_mm: Option<(f64, f64)>,
) -> Identification {
    let uc_logic = UC_LOGIC.contains(&who.vid);
    let by_kernel = rewritten(who, d);
    let params = Params::of(who).filter(|_| uc_logic && by_kernel.is_none());
    // An absolute pointer without pressure is a pen only where the vendor sells nothing else: a
    // virtual machine's mouse and many touch screens are described like it.
    let only_tablets = TABLET_VENDORS.contains(&who.vid);
    let pens = || d.pens.iter().filter(|p| !p.bare || only_tablets);
    let pen = by_kernel
        .or_else(|| pens().find(|p| !p.as_mouse && p.pressure.is_some()))
        .or_else(|| pens().find(|p| p.pressure.is_some()))
        .or_else(|| pens().find(|p| !p.bare))
        .or_else(|| pens().next());
    let Some((pen, (x, y))) = pen.and_then(|p| Some((p, p.x.as_ref().zip(p.y.as_ref())?))) else {
        return match params.filter(|_| d.kinds.contains(&CollectionKind::Vendor)) {
            Some(params) => Identification::Identified(by_params(who, d, params)),
            None => Identification::Declined(format!("no pen: {}", kinds_in_words(&d.kinds))),
        };
    };
    let Some(scale) = Scale::of(pen) else {
        return Identification::Declined("the pen's axes have no range".to_owned());
    };
    let mut note = match by_kernel {
        Some(_) => "by its report descriptor, which a kernel driver wrote".to_owned(),
        None => "by its report descriptor".to_owned(),
    };
    let mut area = scale.area;
    let stated = size::believed(x, y, uc_logic);
    let of_model = known.map(|t| (t.area.width_mm, t.area.height_mm, t.area.nominal));
    (area.width_mm, area.height_mm) = match (params, of_model, stated) {
        (Some(params), ..) => params.size_mm(),
        // A driver's author measured it.
        (_, _, Some(stated)) if by_kernel.is_some() => stated,
        (_, Some((w, h, true)), Some(stated)) if near(stated, (w, h)) => stated,
        (_, Some((w, h, _)), _) => (w, h),
        (_, None, Some(stated)) => stated,
        (_, None, None) if size_mm.is_some_and(|size| same_shape(size, x, y)) => {
            note = format!("{note}; with the size of the model that its ids name");
            size_mm.unwrap_or_default()
        }
        (_, None, None) => {
            let (size, how) = size::guessed(pen, x, y);
            note = format!("{note}; {how}");
            size
        }
    };
    let family = if uc_logic && by_kernel.is_none() { Family::UcLogic } else { Family::Digitiser };
    let stated_pressure = params.map(|p| p.max_pressure);
    let pen = PenFacts {
        max_pressure: scale.max_pressure.max(stated_pressure.unwrap_or(0)),
        buttons: pen.barrel.iter().flatten().count() as u8,
        max_distance: scale.max_distance,
    };
    let mut found = described_tablet(who, d, area, pen, family, &note);
    found.stated_pressure = stated_pressure;
    if let Some(known) = known {
        let tablet = Arc::make_mut(&mut found.tablet);
        // The same chip is in many machines: the machine's own name says more, where it has one.
        if !known.area.nominal || who.name.is_empty() || names_a_chip(&who.name) {
            tablet.name.clone_from(&known.name);
        }
        tablet.source.clone_from(&known.source);
        tablet.pad = known.pad;
        tablet.pen.max_pressure = tablet.pen.max_pressure.max(known.pen.max_pressure);
    }
    Identification::Identified(found)
}

/// The tablet that an interface's descriptor describes, where it describes one.
pub(crate) fn by_descriptor(vid: u16, pid: u16, descriptor: &[u8]) -> Option<Found> {
    let d = Descriptor::parse(descriptor).ok().filter(|d| !d.pens.is_empty())?;
    match described(&Identity { vid, pid, ..Identity::default() }, &d, None, None) {
        Identification::Identified(found) => Some(found),
        _ => None,
    }
}

/// `WCOM4936:00 056A:5160` and `ELAN2513:00 04F3:2C81` are what I2C names look like.
fn names_a_chip(name: &str) -> bool {
    name.split(' ').any(|word| {
        let parts = word.split_once(':');
        parts.is_some_and(|(a, b)| a.len() == 4 && b.len() == 4)
    })
}

/// Returns true if the counts of the axes match a tablet of this shape.
fn same_shape(size: (f64, f64), x: &Bits, y: &Bits) -> bool {
    let span = |b: &Bits| f64::from(b.max) - f64::from(b.min);
    let ratio = (span(x) / span(y)) / (size.0 / size.1);
    span(x) == span(y) || (1.0 - NOMINAL..1.0 + NOMINAL).contains(&ratio)
}

fn near(a: (f64, f64), b: (f64, f64)) -> bool {
    let one = |a: f64, b: f64| (a - b).abs() <= NOMINAL * a.max(b);
    // A screen that stands upright in its machine is described as it stands.
    one(a.0, b.0) && one(a.1, b.1) || one(a.0, b.1) && one(a.1, b.0)
}

/// The vendor's own protocol with the ranges of the parameter string.
fn by_params(who: &Identity, d: &Descriptor, params: Params) -> Found {
    let (width_mm, height_mm) = params.size_mm();
    let area = Area {
        width_mm,
        height_mm,
        nominal: false,
        min_x: 0,
        min_y: 0,
        max_x: params.max_x as i32,
        max_y: params.max_y as i32,
    };
    let pen = PenFacts { max_pressure: params.max_pressure, buttons: 2, max_distance: 0 };
    let family = if who.vid == 0x256c { Family::Huion } else { Family::UcLogic };
    let mut found = described_tablet(who, d, area, pen, family, "by its parameter string");
    found.described = false;
    found.stated_pressure = Some(params.max_pressure);
    // Reading these strings switches the tablet to its vendor protocol.
    let long = Params::is_long(who);
    Arc::make_mut(&mut found.tablet).id[0].init_strings =
        if long { vec![200] } else { vec![100, 123] };
    found
}

fn described_tablet(
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
        pad: PadFacts::default(),
        actions: None,
        id: vec![id],
    };
    Found {
        tablet: Arc::new(tablet),
        at: 0,
        note: Some(note.to_owned()),
        described: true,
        stated_pressure: None,
    }
}

/// Ranges of one described report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    /// Counts of the axes. The size is 0: a report states none.
    pub area: Area,
    /// Counts at full pressure; 0 where the report has none.
    pub max_pressure: u32,
    /// Counts at the greatest height; 0 where the report has none.
    pub max_distance: u32,
}

impl Scale {
    /// `None` without axes or without their range.
    pub(crate) fn of(pen: &PenLayout) -> Option<Scale> {
        let (x, y) = (pen.x.as_ref()?, pen.y.as_ref()?);
        if x.max <= x.min || y.max <= y.min {
            return None;
        }
        let span =
            |b: &Option<Bits>| b.as_ref().map_or(0, |b| b.max.saturating_sub(b.min).max(0) as u32);
        let area = Area {
            width_mm: 0.0,
            height_mm: 0.0,
            nominal: false,
            min_x: x.min,
            min_y: y.min,
            max_x: x.max,
            max_y: y.max,
        };
        Some(Scale { area, max_pressure: span(&pen.pressure), max_distance: span(&pen.distance) })
    }
}

fn kinds_in_words(kinds: &[CollectionKind]) -> String {
    if kinds.is_empty() {
        return "the interface has no input".to_owned();
    }
    let word = |k: &CollectionKind| match k {
        CollectionKind::Pen => "pen without axes",
        CollectionKind::Touch => "touch",
        CollectionKind::Mouse => "mouse",
        CollectionKind::Keyboard => "keyboard",
        CollectionKind::Consumer => "media keys",
        CollectionKind::Vendor => "vendor page",
        CollectionKind::Other => "other",
    };
    kinds.iter().map(word).collect::<Vec<_>>().join(", ")
}
