//! The line below the clay: the tool and what the held keys make of it, the size of the sculpture,
//! the time that ticks and frames take, the devices, and where the work is kept. A press on a part
//! opens the page that says more of it.

use std::path::Path;

use egui::{Align, Layout, RichText};
use glam::Vec3;

use super::icons::{self, Icon};
use super::state::action::brush_title;
use super::state::{Tab, UiState, View};
use super::theme;
use crate::language::tr;

/// Height of the line, points.
pub const HEIGHT: f32 = 26.0;
/// Narrower windows, points, have the tool and the keeping of the work alone.
const ROOM_FOR_ALL: f32 = 900.0;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState) {
    let s = view.state;
    let wide = ui.ctx().content_rect().width() >= ROOM_FOR_ALL;
    let mut open = None;
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        match ui_state.look.cut {
            Some(_) => part(ui, &tr!("status-cut"), Tab::Look, &mut open),
            None => text(ui, &tool(ui, view)),
        }
        if wide {
            let triangles = tr!("triangles", count = s.mesh.triangle_count());
            part(ui, &triangles, Tab::Scene, &mut open);
            let (lo, hi) = s.transform().bounds(s.mesh.bounds());
            let size = (hi - lo).max(Vec3::ZERO);
            let [x, y, z] = size.to_array().map(|n| format!("{n:.1}"));
            let size = tr!("scene-size", x = x, y = y, z = z, unit = tr!("unit-mm"));
            part(ui, &size, Tab::Measure, &mut open);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 16.0;
            kept(ui, view);
            if wide {
                part(ui, &devices(view), Tab::Devices, &mut open);
                let tick = format!("{:.1}", s.figures.tick_ms.p99);
                let frame = format!("{:.1}", view.frame.cpu_ms);
                part(ui, &tr!("status-times", tick = tick, frame = frame), Tab::Loop, &mut open);
            }
        });
    });
    if let Some(tab) = open {
        (ui_state.tab, ui_state.hidden) = (tab, false);
    }
}

/// The brush, and what the keys that are held make of it.
fn tool(ui: &egui::Ui, view: &View<'_>) -> String {
    let brush = &view.state.brush;
    let held = ui.input(|i| i.modifiers);
    let title = brush_title(brush.kind);
    match (held.shift, brush.negative != (held.ctrl || held.alt)) {
        (true, _) => tr!("status-smooths", brush = title),
        (false, true) => tr!("status-carves", brush = title),
        (false, false) => title,
    }
}

/// How many pens and hands are here.
fn devices(view: &View<'_>) -> String {
    let pens = view.devices.len();
    match view.state.hands.as_ref().map_or(0, |h| h.count) {
        0 => tr!("status-devices", count = pens),
        hands => tr!("devices-hands", count = hands),
    }
}

/// Where the work is kept, or why it is not.
fn kept(ui: &mut egui::Ui, view: &View<'_>) {
    let wrong = |ui: &mut egui::Ui, told: String, why: String| {
        let told = RichText::new(icons::text(Icon::TriangleAlert, &told)).color(theme::alarm(ui));
        ui.label(told).on_hover_text(why);
    };
    let Some(session) = &view.session else {
        wrong(ui, tr!("status-not-kept"), tr!("status-not-kept.tip"));
        return;
    };
    if let Some(why) = &session.fault {
        wrong(ui, tr!("status-fault"), why.clone());
        return;
    }
    if session.lost > 0 {
        wrong(ui, tr!("status-lost", ticks = session.lost), session.path.to_owned());
        return;
    }
    let name = Path::new(session.path).file_name();
    let name = name.map_or_else(|| session.path.into(), |n| n.to_string_lossy().into_owned());
    let told = RichText::new(icons::text(Icon::HardDrive, &name)).color(theme::quiet(ui));
    let tip = tr!("loop-saved", path = session.path);
    ui.add(egui::Label::new(told).truncate()).on_hover_text(tip);
}

fn text(ui: &mut egui::Ui, text: &str) {
    ui.colored_label(theme::quiet(ui), text);
}

/// A text that a press on opens a page.
fn part(ui: &mut egui::Ui, text: &str, tab: Tab, open: &mut Option<Tab>) {
    let text = RichText::new(text).color(theme::quiet(ui));
    let label = egui::Label::new(text).selectable(false).sense(egui::Sense::click());
    if ui.add(label).on_hover_text(tab.about()).clicked() {
        *open = Some(tab);
    }
}
