//! The session's history for the panel: the tree after each change, and the pictures on the screen,
//! which a separate thread reads from the file.

use std::collections::BTreeSet;

use crossbeam_channel as cc;

use crate::panels::state::HistoryVersions;
use sculptd_daemon::session::history::Handle;

/// Pictures kept, of 27 KB each.
const KEPT: usize = 300;
/// Pictures that may be under way.
const ASKED: usize = 64;

/// A picture, or that there is none.
type Found = (u64, Option<egui::ColorImage>);

/// Data passed to the panel, and the thread that reads pictures.
#[derive(Debug, Default)]
pub(super) struct VersionPictures {
    /// The tree that the panel has: see [`Handle::shape`].
    shape: Option<(u64, u64, usize)>,
    asked: BTreeSet<u64>,
    reader: Option<(cc::Sender<u64>, cc::Receiver<Found>)>,
}

/// A picture of a session file.
pub(super) fn decode(png: &[u8]) -> Option<egui::ColorImage> {
    let picture = image::load_from_memory_with_format(png, image::ImageFormat::Png).ok()?.to_rgb8();
    let size = [picture.width() as usize, picture.height() as usize];
    Some(egui::ColorImage::from_rgb(size, picture.as_raw()))
}

/// Reads pictures until the requests end.
fn reader(
    history: Handle,
    context: egui::Context,
) -> Option<(cc::Sender<u64>, cc::Receiver<Found>)> {
    let (wanted, inbox) = cc::bounded::<u64>(ASKED);
    let (outbox, found) = cc::bounded(ASKED);
    let read = move || {
        for node in inbox {
            let picture = history.thumbnail(node).and_then(|png| decode(&png));
            if outbox.send((node, picture)).is_err() {
                return;
            }
            context.request_repaint();
        }
    };
    std::thread::Builder::new().name("sculptd-pictures".into()).spawn(read).ok()?;
    Some((wanted, found))
}

impl VersionPictures {
    /// Brings the panel's list up to date; `true` when it changed. Once a poll.
    pub(super) fn update(
        &mut self,
        shown: &mut HistoryVersions,
        context: &egui::Context,
        (history, rate_hz): (&Handle, u32),
    ) -> bool {
        let shape = history.shape();
        let mut changed = self.shape != Some(shape);
        if changed {
            self.shape = Some(shape);
            shown.rate_hz = rate_hz;
            shown.set(&history.tree());
        }
        if self.reader.is_none() {
            self.reader = reader(history.clone(), context.clone());
        }
        let Some((wanted, found)) = &self.reader else { return changed };
        for (node, picture) in found.try_iter() {
            if let Some(picture) = picture {
                let texture = context.load_texture("version", picture, Default::default());
                shown.pictures.insert(node, texture);
                changed = true;
            }
        }
        if shown.pictures.len() > KEPT {
            let visible: BTreeSet<u64> = shown.visible.iter().copied().collect();
            shown.pictures.retain(|node, _| visible.contains(node));
            self.asked.retain(|node| visible.contains(node));
        }
        for node in &shown.visible {
            if !self.asked.contains(node) && wanted.try_send(*node).is_ok() {
                self.asked.insert(*node);
            }
        }
        changed
    }
}
