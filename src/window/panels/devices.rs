//! What is connected and what it says now.

use super::state::{UiRequest, UiState, View};
use super::{tablet_keys, theme};
use sculptd_daemon::adaptors::POINTER_ID;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong("Devices");
    if view.devices.is_empty() {
        ui.label("No tablet found: plug one in, nothing to restart.");
        ui.colored_label(quiet, "The mouse sculpts too: slow strokes press harder.");
    }
    for line in view.devices {
        ui.label(line);
    }
    ui.add_space(8.0);
    ui.strong("In range now");
    let mut none = true;
    for (id, pen) in view.state.pens.iter().flatten() {
        none = false;
        let name = match id.0 {
            i if *id == POINTER_ID || i == POINTER_ID.0 => "pointer".to_owned(),
            i @ 0..100 => format!("tablet {i}"),
            i @ 100..200 => format!("serial pen {}", i - 100),
            i @ 300..400 => format!("recording {}", i - 300),
            i if i >= 500 => format!("demo pen {}", i - 500),
            i => format!("pen {i}"),
        };
        ui.label(format!("{name}{}", if pen.inverted { ", eraser" } else { "" }));
        ui.add(
            egui::ProgressBar::new(pen.pressure.clamp(0.0, 1.0))
                .desired_width(190.0)
                .desired_height(8.0),
        );
        let tilt = pen.tilt.map_or("no tilt".to_owned(), |t| {
            format!("tilt {:.0}, {:.0} degrees", t.x.to_degrees(), t.y.to_degrees())
        });
        let (x, y) = (pen.view.x * 100.0, pen.view.y * 100.0);
        ui.colored_label(quiet, format!("pressure {:.2}, {tilt}", pen.pressure));
        ui.colored_label(quiet, format!("at {x:.1} %, {y:.1} % of the view"));
    }
    if let Some(hands) = view.state.hands.as_ref().filter(|h| h.count > 0) {
        none = false;
        ui.label(format!(
            "{} tracked",
            if hands.count == 1 { "one hand".into() } else { format!("{} hands", hands.count) }
        ));
        for pose in view.state.poses.iter().flatten() {
            ui.colored_label(quiet, format!("{pose:?}"));
        }
        let (spent, lower) = view.state.fatigue;
        ui.colored_label(quiet, format!("arm strain {:.0} %", spent * 100.0));
        if lower {
            ui.label("Your arm works high: rest it, or work lower.");
        }
    }
    if none {
        ui.colored_label(quiet, "nothing");
    }
    ui.add_space(8.0);
    if ui_state.devices.recent().next().is_some() {
        ui.colored_label(quiet, "The pressure curve on the left shows the pen's live trace.");
        ui.add_space(8.0);
    }
    tablet_keys::ui(ui, view, ui_state, out);
}
