//! Which model an interface belongs to.

use super::described::described;
use super::{Catalogue, Found, Identification, Identity, Params};
use crate::descriptor::Descriptor;
use crate::tablet::{Id, StringIs, Tablet};

/// A candidate's standing: higher is likelier.
const STRING: i32 = 1000;
const NAME: i32 = 200;
const PARAMS: i32 = 100;
const EXACT_LENGTH: i32 = 10;

impl Catalogue {
    /// Which model an interface belongs to.
    pub fn identify(&self, who: &Identity) -> Identification {
        let descriptor = Descriptor::parse(&who.descriptor);
        let mut best: Vec<Found> = Vec::new();
        let mut most = i32::MIN;
        for (i, tablet) in self.tablets.iter().enumerate() {
            for (at, id) in tablet
                .id
                .iter()
                .enumerate()
                .filter(|(_, id)| id.vid == who.vid && id.pid == who.pid)
            {
                let own = if i < self.added { STRING * 10 } else { 0 };
                let Some(score) = standing(tablet, id, who, descriptor.as_ref().ok()) else {
                    continue;
                };
                let score = score + own;
                if score > most {
                    best.clear();
                    most = score;
                }
                if score == most && !best.iter().any(|f| alike(f, tablet, id)) {
                    best.push(Found { tablet: tablet.clone(), at, note: None, described: false });
                }
            }
        }
        // A model whose own parameters say otherwise is a stranger with a known id.
        if most >= 0 {
            match best.len() {
                0 => {}
                1 => return Identification::Identified(best.remove(0)),
                _ => return Identification::Ambiguous(best),
            }
        }
        match descriptor {
            Err(e) => Identification::Declined(e.to_string()),
            Ok(d) => described(who, &d),
        }
    }
}

/// Two entries that decode every report alike are one.
fn alike(f: &Found, tablet: &Tablet, id: &Id) -> bool {
    f.id().parser == id.parser
        && f.id().skip == id.skip
        && f.id().quirks == id.quirks
        && f.tablet.area == tablet.area
        && f.tablet.pen.max_pressure == tablet.pen.max_pressure
}

/// `None`: certainly not this one.
fn standing(tablet: &Tablet, id: &Id, who: &Identity, d: Option<&Descriptor>) -> Option<i32> {
    if id.interface.is_some() && who.interface.is_some() && id.interface != who.interface {
        return None;
    }
    let mut score = 0;
    let n = usize::from(id.length);
    let seen = who.seen_lengths.contains(&n);
    if n > 0 && !seen && !d.is_some_and(|d| d.declares_length(n)) {
        return None;
    }
    if n == 0
        && d.is_some_and(|d| d.kinds.contains(&crate::descriptor::Kind::Touch) && d.pens.is_empty())
    {
        return None;
    }
    if seen || d.is_some_and(|d| d.longest_input() == n) {
        score += EXACT_LENGTH;
    }
    let patterns: Vec<StringIs> = id.strings.iter().filter_map(|s| StringIs::parse(s)).collect();
    let known: Vec<(StringIs, String)> =
        patterns.iter().filter_map(|p| Some((*p, who.string(p.index)?))).collect();
    if known.iter().any(|(p, text)| p.matches(text)) {
        score += STRING;
    } else if !known.is_empty() {
        return None;
    }
    if named(&tablet.name, &who.name) {
        score += NAME;
    }
    if let Some(p) = Params::of(who) {
        let same = tablet.area.max_x == p.max_x as i32 && tablet.area.max_y == p.max_y as i32;
        let near = |a: i32, b: u32| (f64::from(a) - f64::from(b)).abs() <= 0.01 * f64::from(a);
        score += match (same, near(tablet.area.max_x, p.max_x) && near(tablet.area.max_y, p.max_y))
        {
            (true, _) if tablet.pen.max_pressure == p.max_pressure => PARAMS,
            (true, _) => PARAMS / 2,
            (_, true) => 0,
            _ => -10 * PARAMS,
        };
    }
    Some(score)
}

/// The device's name holds the model's: its last word, letters and digits only.
fn named(model: &str, device: &str) -> bool {
    let plain = |s: &str| {
        s.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
    };
    let without_maker = model.split_once(' ').map_or(model, |(_, rest)| rest);
    let (full, device) = (plain(without_maker), plain(device));
    full.len() >= 3 && full.chars().any(|c| c.is_ascii_digit()) && device.ends_with(&full)
}
