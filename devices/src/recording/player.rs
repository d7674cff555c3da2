//! Feeds a recording through the same parser and pen state that a live device is read with.

use std::path::{Path, PathBuf};

use super::{HidRecording, RecordingError, hid_recorder};
use crate::catalogue::{Catalogue, Identification};
use crate::hid::decoder::Decoder;
use crate::sample::{DeviceId, Sample};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    Pen,
    Hand,
}

/// What plays.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    pub name: String,
    pub kind: DeviceKind,
    /// Size of the active area of a pen; zero for hands.
    pub area_mm: glam::Vec2,
    pub device: DeviceId,
    /// Which parser and why, for people.
    pub notes: Vec<String>,
}

/// A recording being played.
#[derive(Debug)]
pub struct Player {
    info: DeviceInfo,
    recording: HidRecording,
    /// One for each interface that is read; the others are left alone.
    decoders: Vec<Option<Decoder>>,
    next: usize,
    offset_us: u64,
    ended: bool,
}

impl Player {
    /// Opens a recording of any kind that is known, and finds its device.
    pub fn open(path: &Path, device: DeviceId, catalogue: &Catalogue) -> Result<Player, RecordingError> {
        let io = |error| RecordingError::Io { path: path.to_owned(), error };
        let bytes = std::fs::read(path).map_err(io)?;
        let text = String::from_utf8_lossy(&bytes);
        let recording = hid_recorder::parse(&text).map_err(|bad| RecordingError::Broken {
            path: path.to_owned(),
            line: bad.line,
            what: bad.what,
        })?;
        Player::of(path, recording, device, catalogue)
    }

    /// Plays a recording that is already in memory; `path` names it in errors.
    pub fn of(
        path: &Path,
        recording: HidRecording,
        device: DeviceId,
        catalogue: &Catalogue,
    ) -> Result<Player, RecordingError> {
        let (mut info, mut notes, mut decoders) = (None, Vec::new(), Vec::new());
        for (i, who) in recording.interfaces.iter().enumerate() {
            let label = who.interface.map_or_else(|| format!("device {i}"), |n| format!("interface {n}"));
            let found = match catalogue.identify(who) {
                Identification::Identified(found) => found,
                Identification::Declined(why) => {
                    notes.push(format!("{label} left alone: {why}"));
                    decoders.push(None);
                    continue;
                }
                Identification::Ambiguous(many) => {
                    let names: Vec<&str> = many.iter().map(|f| f.tablet.name.as_str()).collect();
                    notes.push(format!("{label} may be {}", names.join(" or ")));
                    decoders.push(None);
                    continue;
                }
            };
            notes.push(format!(
                "{label}: {}, parser {}{}",
                found.tablet.name,
                serde_json::to_string(&found.id().parser).unwrap_or_default().trim_matches('"'),
                found.note.as_ref().map_or(String::new(), |n| format!(" ({n})"))
            ));
            decoders.push(Some(Decoder::new(&found, &who.descriptor, device)));
            let spoke = recording.reports.iter().any(|r| r.interface == i);
            if info.is_none() || spoke {
                let a = found.tablet.area;
                info = Some(DeviceInfo {
                    name: found.tablet.name.clone(),
                    kind: DeviceKind::Pen,
                    area_mm: glam::Vec2::new(a.width_mm as f32, a.height_mm as f32),
                    device,
                    notes: Vec::new(),
                });
            }
        }
        let Some(mut info) = info else {
            return Err(RecordingError::Unknown { path: PathBuf::from(path), why: notes.join("; ") });
        };
        info.notes = notes;
        Ok(Player { info, recording, decoders, next: 0, offset_us: 0, ended: false })
    }

    pub fn device(&self) -> &DeviceInfo {
        &self.info
    }

    /// Adds `us` to every time from here on, so that the first report falls at `us`.
    pub fn start_at(&mut self, us: u64) {
        self.offset_us = us;
    }

    /// When the next report is due, relative to the first; `None` when all were played.
    pub fn next_due_us(&self) -> Option<u64> {
        self.recording.reports.get(self.next).map(|r| r.t_us)
    }

    pub fn finished(&self) -> bool {
        self.ended
    }

    /// Plays every report due up to `until_us`, relative to the first report, that one included. After the last, whatever
    /// is in range leaves.
    pub fn advance(&mut self, until_us: u64, emit: &mut dyn FnMut(Sample)) {
        while let Some(report) = self.recording.reports.get(self.next).filter(|r| r.t_us <= until_us) {
            let t = report.t_us.saturating_add(self.offset_us);
            for decoder in self.decoders.iter_mut().flatten() {
                decoder.tick(t, emit);
            }
            // Two interfaces of one tablet never hold its pen at once: the one that spoke last wins.
            if let Some(Some(decoder)) = self.decoders.get_mut(report.interface) {
                let before = decoder.in_range();
                let mut first = None;
                let mut rest = Vec::new();
                decoder.feed(&report.bytes, t, &mut |s| {
                    if first.is_none() { first = Some(s) } else { rest.push(s) }
                });
                if !before && decoder.in_range() {
                    for (i, other) in self.decoders.iter_mut().enumerate() {
                        if let Some(other) = other.as_mut().filter(|_| i != report.interface) {
                            other.leave(t, emit);
                        }
                    }
                }
                first.into_iter().chain(rest).for_each(&mut *emit);
            }
            self.next += 1;
        }
        let until = until_us.saturating_add(self.offset_us);
        for decoder in self.decoders.iter_mut().flatten() {
            decoder.tick(until, emit);
        }
        if self.next >= self.recording.reports.len() && !self.ended {
            self.ended = true;
            let last = self.recording.reports.last().map_or(0, |r| r.t_us).saturating_add(self.offset_us);
            for decoder in self.decoders.iter_mut().flatten() {
                decoder.leave(last, emit);
            }
        }
    }
}
