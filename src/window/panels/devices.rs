//! The connected devices and their current input.

use super::state::{UiRequest, UiState, View};
use super::{camera_preview, tablet_keys, theme};
use crate::language::tr;
use sculptd_daemon::adaptors::POINTER_ID;
use sculptd_engine::hand::Pose;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let quiet = theme::quiet(ui);
    ui.strong(tr!("devices-heading"));
    if view.devices.is_empty() {
        ui.label(tr!("devices-none"));
        ui.colored_label(quiet, tr!("devices-none.mouse"));
    }
    for line in view.devices {
        ui.label(line);
    }
    if let Some(preview) = view.camera_preview {
        camera_preview::ui(ui, preview);
    }
    ui.add_space(8.0);
    ui.strong(tr!("devices-in-range"));
    let mut none = true;
    for (id, pen) in view.state.pens.iter().flatten() {
        none = false;
        let name = match id.0 {
            i if *id == POINTER_ID || i == POINTER_ID.0 => tr!("devices-pointer"),
            i @ 0..100 => tr!("devices-tablet", number = i),
            i @ 100..200 => tr!("devices-serial", number = i - 100),
            i @ 300..400 => tr!("devices-recording", number = i - 300),
            i if i >= 500 => tr!("devices-demo", number = i - 500),
            i => tr!("devices-pen", number = i),
        };
        ui.label(if pen.inverted { tr!("devices-eraser", pen = name) } else { name });
        ui.add(
            egui::ProgressBar::new(pen.pressure.clamp(0.0, 1.0))
                .desired_width(190.0)
                .desired_height(8.0),
        );
        let degrees = |radians: f32| format!("{:.0}", radians.to_degrees());
        let tilt = match pen.tilt {
            Some(t) => tr!("devices-tilt", x = degrees(t.x), y = degrees(t.y)),
            None => tr!("devices-no-tilt"),
        };
        let [x, y] = pen.view.to_array().map(|share| format!("{:.1}", share * 100.0));
        let pressure = format!("{:.2}", pen.pressure);
        ui.colored_label(quiet, tr!("devices-pressure", pressure = pressure, tilt = tilt));
        ui.colored_label(quiet, tr!("devices-place", x = x, y = y));
    }
    if let Some(hands) = view.state.hands.as_ref().filter(|h| h.count > 0) {
        none = false;
        ui.label(tr!("devices-hands", count = hands.count));
        for pose in view.state.poses.iter().flatten() {
            ui.colored_label(
                quiet,
                tr!(match pose {
                    Pose::Neutral => "pose-neutral",
                    Pose::Point => "pose-point",
                    Pose::Pinch => "pose-pinch",
                    Pose::Grab => "pose-grab",
                    Pose::Flat => "pose-flat",
                    Pose::Open => "pose-open",
                }),
            );
        }
        let (spent, lower) = view.state.fatigue;
        ui.colored_label(quiet, tr!("devices-strain", percent = format!("{:.0}", spent * 100.0)));
        if lower {
            ui.label(tr!("devices-rest"));
        }
    }
    if none {
        ui.colored_label(quiet, tr!("devices-nothing"));
    }
    ui.add_space(8.0);
    if ui_state.devices.recent().next().is_some() {
        ui.colored_label(quiet, tr!("devices-curve"));
        ui.add_space(8.0);
    }
    tablet_keys::ui(ui, view, ui_state, out);
}
