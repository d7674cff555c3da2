//! The pictures of earlier sculptures, and what must be known of each, which a thread reads from
//! their session files when the window opens.

use std::path::PathBuf;

use crossbeam_channel as cc;

use super::version_pictures::decode;
use crate::language::{self, tr};
use crate::panels::state::EarlierWork;
use sculptd_daemon::session::catalog;
use sculptd_daemon::session::history::listing;

/// What was read of an earlier sculpture, in the order of the files.
type Read = (usize, Option<egui::ColorImage>, Option<String>);

/// The thread that reads, and what it has found.
#[derive(Debug)]
pub(super) struct EarlierPictures {
    found: cc::Receiver<Read>,
}

impl EarlierPictures {
    /// Begins to read these files.
    pub(super) fn read(files: Vec<PathBuf>, context: egui::Context) -> Option<EarlierPictures> {
        let (outbox, found) = cc::bounded(files.len().max(1));
        let language = language::current();
        let read = move || {
            language::set_current(&language);
            for (i, path) in files.iter().enumerate() {
                let picture = listing::newest_picture(path).ok().flatten();
                let picture = picture.and_then(|png| decode(&png));
                if outbox.send((i, picture, warning(path))).is_err() {
                    return;
                }
                context.request_repaint();
            }
        };
        std::thread::Builder::new().name("sculptd-earlier".into()).spawn(read).ok()?;
        Some(EarlierPictures { found })
    }

    /// Hands the panel what was found since; `true` when there is something new.
    pub(super) fn update(&self, shown: &mut [EarlierWork], context: &egui::Context) -> bool {
        let mut changed = false;
        for (i, picture, told) in self.found.try_iter() {
            let Some(work) = shown.get_mut(i) else { continue };
            let load = |picture| context.load_texture("earlier", picture, Default::default());
            (work.picture, work.told) = (picture.map(load), told);
            changed = true;
        }
        changed
    }
}

/// What a person must know of a session before it is opened.
fn warning(path: &std::path::Path) -> Option<String> {
    match catalog::look(path) {
        Ok(entry) => entry.damage.or(entry.not_ended),
        Err(e) => Some(tr!("start-unreadable", why = e.to_string())),
    }
}
