//! Timing of the tick loop and of this window, and the size of the object.

use super::state::View;
use super::theme;
use sculptd_daemon::present_latency::{ABOUT, CLASSES_US, PresentLatency};

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
    ui.colored_label(quiet, "to clay, to screen: from the newest sample");
    ui.add_space(8.0);
    from_sample_to_screen(ui, &view.latency);
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

/// The stages between a sample and the screen, and how many frames took how long in all.
fn from_sample_to_screen(ui: &mut egui::Ui, latency: &PresentLatency) {
    let quiet = theme::quiet(ui);
    let Some(summary) = latency.summary() else { return };
    ui.strong("Sample to screen");
    egui::Grid::new("sample to screen").num_columns(4).spacing([10.0, 3.0]).show(ui, |ui| {
        for head in ["ms", "p50", "p99", "max"] {
            ui.colored_label(quiet, head);
        }
        ui.end_row();
        for (stage, about) in summary.stages.iter().zip(ABOUT) {
            ui.colored_label(quiet, stage.name).on_hover_text(about);
            for us in [stage.quantiles.p50, stage.quantiles.p99, stage.quantiles.max] {
                ui.monospace(format!("{:.1}", us as f64 / 1e3));
            }
            ui.end_row();
        }
    });
    let most = summary.histogram.iter().max().copied().unwrap_or(0).max(1);
    let size = egui::vec2(ui.available_width().min(190.0), 34.0);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    let width = rect.width() / summary.histogram.len() as f32;
    for (i, count) in summary.histogram.iter().enumerate() {
        let x = rect.left() + i as f32 * width;
        let top = rect.bottom() - rect.height() * (*count as f32 / most as f32);
        let bar = egui::Rect::from_min_max(
            egui::pos2(x + 1.0, top.min(rect.bottom() - 1.0)),
            egui::pos2(x + width - 1.0, rect.bottom()),
        );
        ui.painter().rect_filled(bar, 0.0, quiet);
    }
    let class = |i: usize| match CLASSES_US.get(i) {
        Some(us) => format!("up to {:.1} ms", *us as f64 / 1e3),
        None => "longer".to_owned(),
    };
    let counted = summary.histogram.iter().enumerate().filter(|(_, n)| **n > 0);
    let lines: Vec<String> = counted.map(|(i, n)| format!("{}: {n}", class(i))).collect();
    response.on_hover_text(lines.join("\n"));
    let first = CLASSES_US[0] as f64 / 1e3;
    let text = format!("{} frames; {first:.1} ms, and twice as long with each bar", summary.frames);
    ui.colored_label(quiet, text);
    ui.add_space(8.0);
}
