//! The loop's live figures, the work, the devices.

use super::View;
use super::theme::QUIET;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>) {
    let s = view.state;
    let f = &s.figures;
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(QUIET, name);
        ui.monospace(value);
        ui.end_row();
    };
    ui.strong("Loop");
    egui::Grid::new("loop").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        row(ui, "tick", format!("{}", s.tick));
        row(ui, "p50", format!("{:.3} ms", f.tick_ms.p50));
        row(ui, "p99", format!("{:.3} ms", f.tick_ms.p99));
        row(ui, "max", format!("{:.3} ms", f.tick_ms.max));
        row(ui, "late", format!("{}", f.overruns));
        row(ui, "samples", format!("{}", f.samples));
        row(ui, "dabs", format!("{}", f.dabs));
        row(ui, "lost", format!("{} + {}", f.losses.motion, f.losses.transition))
    });
    ui.add_space(10.0);
    ui.strong("Work");
    egui::Grid::new("work").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        row(ui, "vertices", format!("{}", s.mesh.vertex_count()));
        row(ui, "triangles", format!("{}", s.mesh.triangle_count()));
        row(ui, "uploaded", format!("{:.1} kB a frame", view.uploaded as f64 / 1024.0));
        if let Some(session) = view.session {
            row(ui, "session", session.to_owned());
        }
    });
    ui.add_space(10.0);
    ui.strong("Devices");
    if view.devices.is_empty() {
        ui.colored_label(QUIET, "No tablet found: plug one in, nothing to restart. The mouse sculpts too.");
    }
    for line in view.devices {
        ui.colored_label(QUIET, line);
    }
    ui.add_space(10.0);
    ui.colored_label(QUIET, view.adapter);
}
