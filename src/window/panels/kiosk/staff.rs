//! The staff page of an installation: figures, cleaning, the exhibit, the works of today, restart
//! and end.

use egui::{Align2, RichText, vec2};

use super::parts::{Scan, TARGET, large, place};
use crate::language::{current, tr};
use crate::panels::state::{KioskPad, View};
use sculptd_daemon::kiosk::View as KioskView;
use sculptd_daemon::kiosk::desk::Screen;
use sculptd_daemon::kiosk::staff::{StaffFacts, StaffRequest};

/// Widths of the figures and of the buttons, points.
const FIGURES: f32 = 470.0;
const BUTTONS: f32 = 280.0;

pub(super) fn ui(
    ctx: &egui::Context,
    free: egui::Rect,
    (screen, view): (&Screen, &View<'_>),
    pad: &mut KioskPad,
    now: &KioskView,
    scan: &mut Scan,
) {
    // The page refreshes once a second.
    ctx.request_repaint_after(std::time::Duration::from_secs(1));
    let facts = screen.desk.staff.lock().map(|facts| facts.clone()).unwrap_or_default();
    let wide = free.width() > FIGURES + BUTTONS + 120.0;
    place(ctx, "staff page", free, Align2::CENTER_CENTER, |ui| {
        ui.set_width(if wide { FIGURES + BUTTONS + 24.0 } else { FIGURES });
        let most = free.height() - 80.0;
        let scroll = egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        scroll.show(ui, |ui| {
            let layout = match wide {
                true => egui::Layout::left_to_right(egui::Align::Min),
                false => egui::Layout::top_down(egui::Align::Min),
            };
            ui.with_layout(layout, |ui| {
                ui.vertical(|ui| {
                    ui.set_width(FIGURES);
                    ui.label(RichText::new(tr!("staff-heading")).size(28.0).strong());
                    ui.add_space(8.0);
                    metrics(ui, &facts, view);
                    exported(ui, &facts);
                });
                ui.add_space(24.0);
                ui.vertical_centered(|ui| {
                    ui.set_width(BUTTONS);
                    buttons(ui, (screen, now), pad, &facts, scan);
                });
            });
        });
    });
}

/// Result of the last export.
fn exported(ui: &mut egui::Ui, facts: &StaffFacts) {
    let Some(result) = &facts.exported else { return };
    ui.add_space(8.0);
    let text = match result {
        Ok(file) => RichText::new(tr!("staff-exported", file = file.display().to_string())),
        Err(why) => {
            let text = RichText::new(tr!("staff-not-exported", why = why.as_str()));
            text.color(ui.visuals().warn_fg_color)
        }
    };
    ui.label(text.size(16.0));
}

fn metrics(ui: &mut egui::Ui, facts: &StaffFacts, view: &View<'_>) {
    let quiet = ui.visuals().weak_text_color();
    let row = |ui: &mut egui::Ui, name: String, value: String| {
        ui.label(RichText::new(name).size(16.0).color(quiet));
        ui.label(RichText::new(value).size(16.0));
        ui.end_row();
    };
    let up = format!("{}:{:02}", facts.up_s / 3600, facts.up_s / 60 % 60);
    let mean = format!("{}:{:02}", facts.mean_s / 60, facts.mean_s % 60);
    egui::Grid::new("staff figures").num_columns(2).spacing([24.0, 6.0]).show(ui, |ui| {
        row(ui, tr!("staff-visits-today"), facts.visits_today.to_string());
        row(ui, tr!("staff-kept-today"), facts.kept_today.to_string());
        row(ui, tr!("staff-visits"), facts.visits.to_string());
        row(ui, tr!("staff-mean"), mean);
        row(ui, tr!("staff-up"), up);
        let ticks = view.state.figures.tick_ms;
        let times = tr!(
            "staff-times",
            tick = format!("{:.1}", ticks.p99),
            frame = format!("{:.1}", view.frame.cpu_ms)
        );
        row(ui, tr!("staff-speed"), times);
        if let Some(bytes) = facts.free_bytes {
            let gigabytes = format!("{:.1}", bytes as f64 / 1e9);
            row(ui, tr!("staff-disk"), tr!("staff-gigabytes", value = gigabytes));
        }
        if let Some(celsius) = facts.celsius {
            row(ui, tr!("staff-heat"), format!("{celsius:.0} °C"));
        }
    });
    ui.add_space(8.0);
    ui.label(RichText::new(tr!("staff-devices")).size(16.0).color(quiet));
    if view.devices.is_empty() {
        ui.label(RichText::new(tr!("staff-no-devices")).size(16.0));
    }
    for line in view.devices {
        ui.label(RichText::new(line).size(16.0));
    }
    if !facts.errors.is_empty() {
        ui.add_space(8.0);
        ui.label(RichText::new(tr!("staff-errors")).size(16.0).color(quiet));
        for error in &facts.errors {
            ui.label(RichText::new(error).size(16.0).color(ui.visuals().warn_fg_color));
        }
    }
}

fn buttons(
    ui: &mut egui::Ui,
    (screen, now): (&Screen, &KioskView),
    pad: &mut KioskPad,
    facts: &StaffFacts,
    scan: &mut Scan,
) {
    let button = |text: &str| large(text, 18.0, BUTTONS).min_size(vec2(BUTTONS, TARGET - 8.0));
    let press = |ui: &mut egui::Ui, scan: &mut Scan, text: String, request: StaffRequest| {
        if scan.button(ui, true, button(&text)) {
            screen.desk.touched.store(true, std::sync::atomic::Ordering::Relaxed);
            screen.desk.ask(request);
        }
    };
    ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
    ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
    press(ui, scan, tr!("staff-back"), StaffRequest::Leave);
    let cleaning = if facts.cleaning { tr!("staff-open") } else { tr!("staff-clean") };
    press(ui, scan, cleaning, StaffRequest::Cleaning(!facts.cleaning));
    if facts.free_bytes.is_some() {
        press(ui, scan, tr!("staff-export"), StaffRequest::Export);
    }
    press(ui, scan, tr!("staff-restart"), StaffRequest::Restart);
    if pad.ends {
        press(ui, scan, tr!("staff-end-sure"), StaffRequest::End);
    } else if scan.button(ui, true, button(&tr!("staff-end"))) {
        pad.ends = true;
    }
    if screen.exhibits.len() > 1 {
        ui.add_space(8.0);
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
        ui.label(
            RichText::new(tr!("staff-exhibit")).size(16.0).color(ui.visuals().weak_text_color()),
        );
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        for (i, exhibit) in screen.exhibits.iter().enumerate() {
            let title = exhibit.manifest.title.get(current().code());
            if scan.button(ui, true, button(title).selected(now.exhibit == Some(i))) {
                screen.desk.ask(StaffRequest::Exhibit(i));
            }
        }
    }
}
