//! Which model an interface belongs to.

use std::collections::BTreeMap;

use super::described::described;
use super::found::{Found, Identification};
use super::identity::{Identity, UC_LOGIC};
use super::params::Params;
use super::rewritten::rewritten;
use super::{Catalogue, size};
use crate::descriptor::{Bits, CollectionKind, Descriptor};
use crate::tablet::{Family, Id, StringIs, Tablet};

/// Points that each piece of evidence adds to a candidate's score. A contradiction excludes the
/// candidate and has no number.
mod score {
    /// The user added the model.
    pub(super) const OWN: i32 = 10_000;
    /// A USB string that tells models of one id apart.
    pub(super) const STRING: i32 = 1000;
    /// The device's name ends in the model's.
    pub(super) const NAME: i32 = 200;
    /// The same, but for a version at the end of either.
    pub(super) const BASE_NAME: i32 = 100;
    /// The descriptor states another size, and that can be believed.
    pub(super) const OTHER_SIZE: i32 = -150;
    /// The descriptor states less than half of the model's pressure: the pens differ.
    pub(super) const OTHER_PRESSURE: i32 = -150;
    /// The parameter string agrees.
    pub(super) const PARAMS: i32 = 100;
    /// The descriptor has the model's range of coordinates.
    pub(super) const RANGE: i32 = 20;
    /// The interface's longest report is as long as the model's.
    pub(super) const LENGTH: i32 = 10;
    /// The device's name holds the model's brand.
    pub(super) const BRAND: i32 = 5;
}

/// A pair of ids is shared if it stands for so many models.
const SHARED: usize = 3;
/// Greatest difference of a descriptor's believed size from a model's, as a share.
const SIZE_TOLERANCE: f64 = 0.12;
/// Greatest difference of counts between firmwares of one model, as a share.
const COUNT_TOLERANCE: f64 = 0.01;

impl Catalogue {
    /// Identifies the model that an interface belongs to.
    pub fn identify(&self, who: &Identity) -> Identification {
        let descriptor = Descriptor::parse(&who.descriptor);
        let d = descriptor.as_ref().ok();
        if let Some(d) = d.filter(|d| rewritten(who, d).is_some()) {
            let known = self.model_of_rewritten(who, d);
            return described(who, d, known, None);
        }
        let (mut best, score) = self.candidates(who, d, false);
        if best.is_empty() {
            best = self.candidates(who, d, true).0;
        } else if score < score::BASE_NAME + score::PARAMS
            && self.shared(who)
            && (d.is_some_and(|d| d.pens.iter().any(|p| !p.bare)) || Params::of(who).is_some())
        {
            // Neither a string nor a name supports it, many models share its ids, and the device
            // states its ranges.
            return self.without_model(who);
        }
        match best.len() {
            0 => self.without_model(who),
            1 => {
                let found = best.remove(0);
                match d {
                    Some(d) if found.id().parser == Family::Digitiser => {
                        described(who, d, Some(&found.tablet), None)
                    }
                    _ => Identification::Identified(found),
                }
            }
            _ => Identification::Ambiguous(best),
        }
    }

    /// Identifies an interface without a known model, or whose reports contradict the known one.
    pub(crate) fn without_model(&self, who: &Identity) -> Identification {
        match Descriptor::parse(&who.descriptor) {
            Err(e) => Identification::Declined(e.to_string()),
            Ok(d) => described(who, &d, None, self.size_of_ids(who)),
        }
    }

    /// The size of the models with these ids, where they all have one.
    fn size_of_ids(&self, who: &Identity) -> Option<(f64, f64)> {
        let mut sizes = self.tablets.iter().filter(|t| of_pid(t, who)).map(|t| t.area);
        let first = sizes.next()?;
        let other = |a: crate::tablet::Area| {
            other_size(a.width_mm, first.width_mm) || other_size(a.height_mm, first.height_mm)
        };
        (!sizes.any(other)).then_some((first.width_mm, first.height_mm))
    }

    fn shared(&self, who: &Identity) -> bool {
        self.tablets.iter().filter(|t| of_pid(t, who)).count() >= SHARED
    }

    /// The candidates with the best score, one for each way of decoding, and that score. `relaxed`:
    /// a model that is alone with its ids may come with a report length that its file does not
    /// have.
    fn candidates(
        &self,
        who: &Identity,
        d: Option<&Descriptor>,
        relaxed: bool,
    ) -> (Vec<Found>, i32) {
        let mut best: Vec<Found> = Vec::new();
        // A negative score is a stranger with a known id.
        let mut most = 0;
        // If a known string distinguishes these models, a model that it does not match is another
        // one.
        let ids = self.tablets.iter().flat_map(|t| &t.id);
        let shared = self.shared(who);
        let told_apart = ids
            .filter(|id| id.vid == who.vid && id.pid == who.pid)
            .flat_map(|id| id.strings.iter().filter_map(|s| StringIs::parse(s)))
            .any(|pattern| who.string(pattern.index).is_some());
        for (i, tablet) in self.tablets.iter().enumerate() {
            let same_ids = tablet
                .id
                .iter()
                .enumerate()
                .filter(|(_, id)| id.vid == who.vid && id.pid == who.pid);
            for (at, id) in same_ids {
                let own = i < self.added;
                let unmatched = told_apart && strings(id, who).is_none_or(|n| n == 0);
                if !fits_length(id, who, d, relaxed) || unmatched && !own {
                    continue;
                }
                let Some(score) = standing(tablet, id, who, d, shared) else { continue };
                let score = score + if own { score::OWN } else { 0 };
                if score > most {
                    best.clear();
                    most = score;
                }
                if score == most && !best.iter().any(|f| alike(f, tablet, id)) {
                    best.push(Found {
                        tablet: tablet.clone(),
                        at,
                        note: None,
                        described: false,
                        stated_pressure: Params::of(who).map(|p| p.max_pressure),
                    });
                }
            }
        }
        (best, most)
    }

    /// The model behind a descriptor that a kernel driver wrote: by the firmware's name, else by
    /// the product's, else by its ranges where they are one model's only.
    fn model_of_rewritten(&self, who: &Identity, d: &Descriptor) -> Option<&Tablet> {
        let of_vendor = |t: &&Tablet| t.id.iter().any(|id| id.vid == who.vid);
        let all = || self.tablets.iter().map(|t| &**t).filter(of_vendor);
        let by_string = all().find(|t| {
            let ids = t.id.iter().filter(|id| id.vid == who.vid);
            ids.into_iter().any(|id| matches!(strings(id, who), Some(n) if n > 0))
        });
        let pen = rewritten(who, d)?;
        let (x, y) = (pen.x.as_ref()?, pen.y.as_ref()?);
        let near =
            |a: i32, b: i32| f64::from(a.abs_diff(b)) <= COUNT_TOLERANCE * f64::from(a.max(b));
        let agrees = |t: &&Tablet| near(t.area.max_x, x.max) && near(t.area.max_y, y.max);
        let by_name = || all().find(|t| named(&t.name, &who.name) && agrees(t));
        by_string.or_else(by_name).or_else(|| {
            let same = |t: &&Tablet| agrees(t) && of_pid(t, who);
            let mut many = all().filter(same);
            many.next().filter(|_| many.next().is_none())
        })
    }
}

fn of_pid(tablet: &Tablet, who: &Identity) -> bool {
    tablet.id.iter().any(|id| id.vid == who.vid && id.pid == who.pid)
}

/// Two entries that decode every report alike are one.
fn alike(f: &Found, tablet: &Tablet, id: &Id) -> bool {
    f.id().parser == id.parser
        && f.id().skip == id.skip
        && f.id().quirks == id.quirks
        && f.tablet.area == tablet.area
        && f.tablet.pen.max_pressure == tablet.pen.max_pressure
}

/// Returns true if the interface has reports of the length in the model's file.
fn fits_length(id: &Id, who: &Identity, d: Option<&Descriptor>, relaxed: bool) -> bool {
    let has = |n: usize| who.seen_lengths.contains(&n) || d.is_some_and(|d| d.declares_length(n));
    if relaxed {
        return id.skip == 0 && usual_lengths(id.parser).iter().any(|n| has(*n));
    }
    match usize::from(id.length) {
        // The product id alone decides, unless the interface is for fingers only.
        0 => !d.is_some_and(|d| {
            d.kinds.contains(&CollectionKind::Touch) && d.pens.iter().all(|p| p.bare)
        }),
        n => has(n),
    }
}

/// Lengths of the pen's reports in families whose firmwares differ in them, in bytes with the id.
fn usual_lengths(family: Family) -> &'static [usize] {
    match family {
        Family::WacomSimple => &[9, 10],
        Family::WacomIntuosV1 => &[10],
        Family::WacomGraphire | Family::WacomGraphire4 | Family::WacomBamboo => &[8, 9],
        Family::WacomIntuosV2 => &[17, 27, 33, 64],
        Family::Kye | Family::KyePlain => &[6, 8],
        _ => &[],
    }
}

/// Returns the number of a model's string patterns that match; `None` if one is contradicted.
/// Patterns on one index are alternatives; of each known index one must match.
fn strings(id: &Id, who: &Identity) -> Option<i32> {
    let mut by_index: BTreeMap<u8, bool> = BTreeMap::new();
    for pattern in id.strings.iter().filter_map(|s| StringIs::parse(s)) {
        if let Some(text) = who.string(pattern.index) {
            *by_index.entry(pattern.index).or_default() |= pattern.matches(&text);
        }
    }
    by_index.values().all(|m| *m).then_some(by_index.len() as i32)
}

/// A candidate's score; `None`: something that the device states contradicts it.
fn standing(
    tablet: &Tablet,
    id: &Id,
    who: &Identity,
    d: Option<&Descriptor>,
    shared: bool,
) -> Option<i32> {
    if id.interface.is_some() && who.interface.is_some() && id.interface != who.interface {
        return None;
    }
    let matched = strings(id, who)?;
    let mut score = if matched > 0 { score::STRING + matched } else { 0 };
    let n = usize::from(id.length);
    if who.seen_lengths.contains(&n) || d.is_some_and(|d| d.longest_input() == n) {
        score += score::LENGTH;
    }
    let (full, part) = (named(&tablet.name, &who.name), alike_named(&tablet.name, &who.name));
    let by_name = full || part;
    if full {
        score += score::NAME;
    } else if part {
        score += score::BASE_NAME;
    }
    if of_brand(&tablet.name, &who.name) {
        score += score::BRAND;
    }
    let uc_logic = UC_LOGIC.contains(&who.vid);
    let params = if uc_logic { Params::all(who) } else { Vec::new() };
    if !params.is_empty() {
        score += params.iter().filter_map(|p| agreement(tablet, p, shared && !by_name)).max()?;
    }
    if uc_logic && params.is_empty() {
        score += d.map_or(0, |d| by_descriptor(tablet, d));
    }
    Some(score)
}

/// Returns the score of one parameter string; `None` if it contradicts the model.
///
/// `anonymous`: the model shares its ids, and no name speaks for it.
fn agreement(tablet: &Tablet, p: &Params, anonymous: bool) -> Option<i32> {
    let a = &tablet.area;
    let near =
        |a: i32, b: u32| (f64::from(a) - f64::from(b)).abs() <= COUNT_TOLERANCE * f64::from(a);
    let same = a.max_x == p.max_x as i32 && a.max_y == p.max_y as i32;
    if tablet.pen.max_pressure.abs_diff(p.max_pressure) > 1 {
        return None;
    }
    // Of models that share their ids, the one with the same counts may be of another size. Where
    // the ids or the name tell the model, its size is known better than the resolution that the
    // device states.
    let (w, h) = p.size_mm();
    if anonymous && (other_size(w, a.width_mm) || other_size(h, a.height_mm)) {
        return None;
    }
    match (same, near(a.max_x, p.max_x) && near(a.max_y, p.max_y)) {
        (true, _) => Some(score::PARAMS),
        (_, true) => Some(0),
        _ => None,
    }
}

/// Returns the score of the described pen reports, positive or negative.
fn by_descriptor(tablet: &Tablet, d: &Descriptor) -> i32 {
    let mut score = 0;
    for pen in d.pens.iter().filter(|p| !p.as_mouse) {
        let (Some(x), Some(y)) = (&pen.x, &pen.y) else { continue };
        let weaker = |p: &Bits| p.max > 0 && p.max as u32 <= tablet.pen.max_pressure / 2;
        if pen.pressure.as_ref().is_some_and(weaker) {
            return score::OTHER_PRESSURE;
        }
        if (x.max, y.max) == (tablet.area.max_x, tablet.area.max_y) {
            score = score.max(score::RANGE);
        } else if let Some((w, h)) = size::believed(x, y, true)
            && (other_size(w, tablet.area.width_mm) || other_size(h, tablet.area.height_mm))
        {
            return score::OTHER_SIZE;
        }
    }
    score
}

fn other_size(a: f64, b: f64) -> bool {
    (a - b).abs() > SIZE_TOLERANCE * b
}

/// Returns true if a word of the device's name is the model's brand.
fn of_brand(model: &str, device: &str) -> bool {
    let brand = model.split_whitespace().next().unwrap_or_default();
    let mut words = device.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
    words.any(|word| word.eq_ignore_ascii_case(brand))
}

/// Removes a part in parentheses and a version from a name: `GT-191 V2` becomes `GT-191`.
fn base(name: &str) -> &str {
    let name = name.split_once('(').map_or(name, |(before, _)| before).trim_end();
    match name.rsplit_once(' ') {
        Some((before, v)) if v.len() == 2 && v.starts_with(['V', 'v']) => before,
        _ => name,
    }
}

/// Returns true if the names agree apart from a version, or share a model code: a word with letters
/// and digits.
fn alike_named(model: &str, device: &str) -> bool {
    let codes = |name: &str| {
        let plain = name.split_whitespace().map(|word| {
            let kept = word.chars().filter(char::is_ascii_alphanumeric);
            kept.collect::<String>().to_ascii_lowercase()
        });
        let code = |w: &String| {
            let has = |f: fn(&char) -> bool| w.chars().any(|c| f(&c));
            w.len() >= 3 && has(char::is_ascii_digit) && has(char::is_ascii_alphabetic)
        };
        plain.filter(code).collect::<Vec<_>>()
    };
    let theirs = codes(device);
    named(base(model), base(device)) || codes(model).iter().any(|c| theirs.contains(c))
}

/// Returns true if the device's name ends with the model's, comparing only letters and digits,
/// without the brand.
fn named(model: &str, device: &str) -> bool {
    let plain = |s: &str| {
        s.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
    };
    let without_brand = model.split_once(' ').map_or(model, |(_, rest)| rest);
    let (full, device) = (plain(without_brand), plain(device));
    full.len() >= 3 && full.chars().any(|c| c.is_ascii_digit()) && device.ends_with(&full)
}
