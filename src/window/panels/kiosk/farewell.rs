//! The farewell: consent, and the code by which the visitor takes the work home.

use std::sync::atomic::Ordering::Relaxed;

use egui::{Align2, RichText};

use super::exhibit;
use super::parts::{Scan, large, place};
use crate::panels::qr_code;
use sculptd_daemon::kiosk::Language;
use sculptd_daemon::kiosk::desk::Screen;
use sculptd_daemon::qr_code::Invitation;

/// Width of the texts, points.
const WIDTH: f32 = 380.0;
/// Side of the code, points.
const CODE: f32 = 260.0;
/// A lower screen has the texts beside the code.
const LOW: f32 = 640.0;

/// Asks for consent, then shows the code.
pub(super) fn ui(
    ctx: &egui::Context,
    free: egui::Rect,
    words: &Language,
    screen: &Screen,
    scan: &mut Scan,
) {
    // Two areas: one that grows would be placed by its former size.
    let Some(link) = link(screen) else {
        return place(ctx, "farewell", free, Align2::RIGHT_CENTER, |ui| {
            ui.set_width(WIDTH);
            ui.vertical_centered(|ui| consent(ui, words, screen, scan));
        });
    };
    place(ctx, "farewell code", free, Align2::RIGHT_CENTER, |ui| {
        if free.height() < LOW {
            ui.horizontal_top(|ui| {
                qr_code::ui(ui, &link.code, CODE);
                ui.vertical(|ui| texts(ui, words, (screen, scan), &link));
            });
        } else {
            ui.vertical_centered(|ui| {
                ui.set_width(WIDTH);
                qr_code::ui(ui, &link.code, CODE);
                ui.add_space(10.0);
                texts(ui, words, (screen, scan), &link);
            });
        }
    });
}

/// The link to the work, if the visitor consented.
#[cfg(unix)]
fn link(screen: &Screen) -> Option<Invitation> {
    let link = screen.desk.link.lock().ok()?.clone()?;
    Some(Invitation { url: link.url, code: link.code })
}

#[cfg(not(unix))]
fn link(_: &Screen) -> Option<Invitation> {
    None
}

fn consent(ui: &mut egui::Ui, words: &Language, screen: &Screen, scan: &mut Scan) {
    if let Some(result) = screen.desk.result.lock().ok().and_then(|result| *result) {
        exhibit::result(ui, words, &result);
    }
    if screen.desk.kept.load(Relaxed) {
        ui.label(RichText::new(&words.kept).size(20.0));
    }
    ui.add_space(10.0);
    let asks = screen.desk.asks_consent.load(Relaxed);
    if asks {
        let minutes = screen.share_minutes.ceil().to_string();
        ui.label(RichText::new(&words.consent).size(26.0).strong());
        ui.label(RichText::new(words.consent_about.replace("{minutes}", &minutes)).size(18.0));
        ui.add_space(10.0);
        if scan.button(ui, true, large(&words.yes, 22.0, WIDTH)) {
            screen.desk.consents.store(true, Relaxed);
            screen.desk.touched.store(true, Relaxed);
        }
    }
    let leave = if asks { &words.no } else { &words.done };
    if scan.button(ui, true, large(leave, 22.0, WIDTH)) {
        screen.desk.finished.store(true, Relaxed);
    }
}

fn texts(
    ui: &mut egui::Ui,
    words: &Language,
    (screen, scan): (&Screen, &mut Scan),
    link: &Invitation,
) {
    ui.set_width(WIDTH);
    let minutes = screen.share_minutes.ceil().to_string();
    ui.label(RichText::new(&words.fetch).size(22.0));
    ui.label(RichText::new(words.expires.replace("{minutes}", &minutes)).size(18.0));
    ui.label(RichText::new(&link.url).size(13.0).monospace());
    ui.add_space(10.0);
    if scan.button(ui, true, large(&words.done, 22.0, WIDTH)) {
        screen.desk.finished.store(true, Relaxed);
    }
}
