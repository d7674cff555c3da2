//! A HID device's recorded reports, through the decoders that read it live.

use std::path::Path;

use super::device_info::{DeviceInfo, DeviceKind};
use super::{HidRecording, RecordingError};
use crate::catalogue::{Catalogue, Found, Identification, Identity};
use crate::hid::crosscheck::note_undecided;
use crate::hid::decoder::Decoder;
use crate::pressure_use::PressureUse;
use crate::sample::{Body, DeviceId, Sample};

/// One in so many positions may be outside a model's ranges: noise at the edge.
const MOST_OUTSIDE: u64 = 50;

/// Plays a pen's reports.
#[derive(Debug)]
pub(super) struct PenPlayer {
    pub recording: HidRecording,
    /// One for each interface that is read, `None` for the others.
    decoders: Vec<Option<Decoder>>,
}

impl PenPlayer {
    /// Finds the device of each interface.
    pub(super) fn of(
        path: &Path,
        recording: HidRecording,
        device: DeviceId,
        catalogue: &Catalogue,
    ) -> Result<(PenPlayer, DeviceInfo), RecordingError> {
        let mut notes = Vec::new();
        let mut found: Vec<Option<Found>> = Vec::new();
        for (i, who) in recording.interfaces.iter().enumerate() {
            found.push(match catalogue.identify(who) {
                Identification::Identified(found) => {
                    let sent = reports_of(&recording, i);
                    Some(unless_contradicted(found, who, sent, catalogue))
                }
                Identification::Declined(why) => {
                    notes.push(format!("{} left alone: {why}", label(who, i)));
                    None
                }
                Identification::Ambiguous(many) => {
                    Some(choose(many, reports_of(&recording, i), &who.descriptor))
                }
            });
        }
        let known = found.iter().flatten().find(|f| !f.described).cloned();
        let (mut info, mut decoders) = (None::<(DeviceInfo, bool, bool)>, Vec::new());
        for ((i, who), found) in recording.interfaces.iter().enumerate().zip(found) {
            let Some(mut found) = found else {
                decoders.push(None);
                continue;
            };
            if let Some(known) = known.as_ref().filter(|k| found.described && same_device(k, who)) {
                found.sized_like(known);
            }
            note_undecided(&mut found, &who.descriptor);
            notes.push(format!("{}: {}", label(who, i), found.in_words()));
            decoders.push(Some(Decoder::new(&found, &who.descriptor, device)));
            let spoke = recording.reports.iter().any(|r| r.interface == i);
            let better = match &info {
                None => true,
                // The interface that spoke last names the device; a known model goes before one
                // that is only described.
                Some((_, heard, described)) => spoke || !heard && *described && !found.described,
            };
            if better {
                let a = found.tablet.area;
                let told = DeviceInfo {
                    name: found.tablet.name.clone(),
                    kind: DeviceKind::Pen,
                    area_mm: glam::Vec2::new(a.width_mm as f32, a.height_mm as f32),
                    device,
                    notes: Vec::new(),
                };
                info = Some((told, spoke, found.described));
            }
        }
        let Some((mut info, ..)) = info else {
            return Err(RecordingError::Unknown { path: path.to_owned(), why: notes.join("; ") });
        };
        info.notes = notes;
        Ok((PenPlayer { recording, decoders }, info))
    }

    pub(super) fn feed(&mut self, i: usize, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.tick(t_us, emit);
        let report = &self.recording.reports[i];
        let at = report.interface;
        let Some(Some(decoder)) = self.decoders.get_mut(at) else { return };
        let before = decoder.in_range();
        let mut said = Vec::new();
        decoder.feed(&report.bytes, t_us, &mut |s| said.push(s));
        // Two interfaces of one tablet never hold its pen at once: the one that spoke last wins.
        if !before && decoder.in_range() {
            let others = self.decoders.iter_mut().enumerate().filter(|(k, _)| *k != at);
            others.filter_map(|(_, d)| d.as_mut()).for_each(|d| d.leave(t_us, emit));
        }
        said.into_iter().for_each(&mut *emit);
    }

    pub(super) fn pressure_use(&self) -> PressureUse {
        let all = self.decoders.iter().flatten().map(Decoder::pressure_use);
        all.fold(PressureUse::default(), PressureUse::and)
    }

    pub(super) fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.decoders.iter_mut().flatten().for_each(|d| d.tick(now_us, emit));
    }

    pub(super) fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.decoders.iter_mut().flatten().for_each(|d| d.leave(t_us, emit));
    }
}

fn reports_of(recording: &HidRecording, i: usize) -> impl Iterator<Item = &[u8]> {
    recording.reports.iter().filter(move |r| r.interface == i).map(|r| r.bytes.as_slice())
}

/// The model, unless what was sent lies outside its ranges: then what the descriptor says.
fn unless_contradicted<'a>(
    found: Found,
    who: &Identity,
    reports: impl Iterator<Item = &'a [u8]>,
    catalogue: &Catalogue,
) -> Found {
    if found.described {
        return found;
    }
    let mut decoder = Decoder::new(&found, &who.descriptor, DeviceId(0));
    for (i, report) in reports.enumerate() {
        decoder.feed(report, i as u64, &mut |_| {});
    }
    let counts = decoder.counts();
    if counts.placed == 0 || counts.outside * MOST_OUTSIDE <= counts.placed {
        return found;
    }
    match catalogue.without_model(who) {
        Identification::Identified(mut own) => {
            let name = &found.tablet.name;
            own.note = Some(format!(
                "not the {name} that its ids name: {} of {} positions are outside its ranges; {}",
                counts.outside,
                counts.placed,
                own.note.unwrap_or_default()
            ));
            own
        }
        _ => found,
    }
}

fn label(who: &Identity, i: usize) -> String {
    who.interface.map_or_else(|| format!("device {i}"), |n| format!("interface {n}"))
}

fn same_device(known: &Found, who: &Identity) -> bool {
    known.id().vid == who.vid && known.id().pid == who.pid
}

/// Of models that match equally well, the smallest whose area holds every position of the
/// recording. The note says that it is a choice.
fn choose<'a>(
    mut many: Vec<Found>,
    reports: impl Iterator<Item = &'a [u8]>,
    descriptor: &[u8],
) -> Found {
    let count = many.len();
    many.sort_by(|a, b| area(a).cmp(&area(b)).then_with(|| a.tablet.name.cmp(&b.tablet.name)));
    let (mut reach, mut sent) = ([0i32; 2], false);
    let mut decoder = Decoder::new(&many[count - 1], descriptor, DeviceId(0));
    for (i, report) in reports.enumerate() {
        decoder.feed(report, i as u64, &mut |s| {
            if let Body::Pen(p) = s.body {
                sent = true;
                reach = [reach[0].max(p.raw[0]), reach[1].max(p.raw[1])];
            }
        });
    }
    let holds = |f: &Found| f.tablet.area.max_x >= reach[0] && f.tablet.area.max_y >= reach[1];
    let at = many.iter().position(holds).unwrap_or(count - 1);
    let mut chosen = many.swap_remove(at);
    chosen.note = Some(match sent {
        true => format!(
            "one of {count} models alike: the smallest that holds every position that was sent"
        ),
        false => format!(
            "one of {count} models alike, and nothing was sent that tells them apart: name yours \
             in the configuration under `[tablets.models]`"
        ),
    });
    chosen
}

fn area(f: &Found) -> i64 {
    i64::from(f.tablet.area.max_x) * i64::from(f.tablet.area.max_y)
}
