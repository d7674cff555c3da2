//! Timing of the tick loop and of this window, and the size of the object.

use super::state::View;
use super::theme;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>) {
    let s = view.state;
    let f = &s.figures;
    let quiet = theme::quiet(ui);
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(quiet, name);
        ui.monospace(value);
        ui.end_row();
    };
    let grid = |name: &str| egui::Grid::new(name.to_owned()).num_columns(2).spacing([10.0, 3.0]);
    ui.strong("Loop");
    grid("loop").show(ui, |ui| {
        row(ui, "tick", format!("{}", s.tick));
        row(ui, "p50", format!("{:.3} ms", f.tick_ms.p50));
        row(ui, "p99", format!("{:.3} ms", f.tick_ms.p99));
        row(ui, "max", format!("{:.3} ms", f.tick_ms.max));
        row(ui, "late", format!("{}", f.overruns));
        row(ui, "samples", format!("{}", f.samples));
        row(ui, "dabs", format!("{}", f.dabs));
        row(ui, "lost", format!("{} + {}", f.losses.motion, f.losses.transition));
    });
    ui.colored_label(quiet, "lost: motion + contacts; the second is always 0");
    ui.add_space(8.0);
    ui.strong("This window");
    let w = &view.frame;
    grid("frame").show(ui, |ui| {
        row(ui, "frames/s", format!("{}", w.frames_a_second));
        row(ui, "frame", format!("{:.2} ms", w.cpu_ms));
        row(ui, "worst", format!("{:.2} ms", w.worst_cpu_ms));
        row(ui, "to clay", format!("{:.1} ms", w.input_to_snapshot_ms));
        row(ui, "to screen", format!("{:.1} ms", w.input_to_submit_ms));
        row(ui, "in view", format!("{} of {}", w.drawn.0, w.drawn.1));
        row(ui, "uploaded", format!("{:.1} kB", view.uploaded as f64 / 1024.0));
    });
    ui.colored_label(quiet, "to clay, to screen: from the pointer's last sample");
    ui.add_space(8.0);
    ui.strong("Object");
    grid("object").show(ui, |ui| {
        row(ui, "vertices", format!("{}", s.mesh.vertex_count()));
        row(ui, "triangles", format!("{}", s.mesh.triangle_count()));
    });
    if let Some(session) = view.session {
        ui.colored_label(quiet, format!("saved as you work: {session}"));
    }
    ui.add_space(8.0);
    ui.colored_label(quiet, view.adapter);
}
