//! Timing of the tick loop and of this window, and the size of the object.

use super::state::View;
use super::theme;
use crate::language::tr;
use crate::language::{text_of, text_or};
use sculptd_daemon::present_latency::{ABOUT, CLASSES_US, PresentLatency};

pub fn ui(ui: &mut egui::Ui, view: &View<'_>) {
    let s = view.state;
    let f = &s.figures;
    let quiet = theme::quiet(ui);
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.colored_label(quiet, text_or(name, name));
        ui.monospace(value);
        ui.end_row();
    };
    let ms = |value: String| tr!("time-ms", value = value);
    let grid = |name: &str| egui::Grid::new(name.to_owned()).num_columns(2).spacing([10.0, 3.0]);
    ui.strong(tr!("loop-heading"));
    grid("loop").show(ui, |ui| {
        row(ui, "loop-tick", format!("{}", s.tick));
        row(ui, "p50", ms(format!("{:.3}", f.tick_ms.p50)));
        row(ui, "p99", ms(format!("{:.3}", f.tick_ms.p99)));
        row(ui, "max", ms(format!("{:.3}", f.tick_ms.max)));
        row(ui, "loop-late", format!("{}", f.overruns));
        row(ui, "loop-samples", format!("{}", f.samples));
        row(ui, "loop-dabs", format!("{}", f.dabs));
        row(ui, "loop-lost", format!("{} + {}", f.losses.motion, f.losses.transition));
    });
    ui.colored_label(quiet, tr!("loop-lost.note"));
    ui.add_space(8.0);
    ui.strong(tr!("loop-window"));
    let w = &view.frame;
    grid("frame").show(ui, |ui| {
        row(ui, "loop-frames", format!("{}", w.frames_a_second));
        row(ui, "loop-frame", ms(format!("{:.2}", w.cpu_ms)));
        row(ui, "loop-worst", ms(format!("{:.2}", w.worst_cpu_ms)));
        row(ui, "loop-to-clay", ms(format!("{:.1}", w.input_to_snapshot_ms)));
        row(ui, "loop-to-screen", ms(format!("{:.1}", w.input_to_submit_ms)));
        let (part, all) = w.drawn;
        row(ui, "loop-in-view", tr!("loop-of", part = part, all = all));
        let kilobytes = format!("{:.1}", view.uploaded as f64 / 1024.0);
        row(ui, "loop-uploaded", tr!("size-kilobytes", value = kilobytes));
    });
    ui.colored_label(quiet, tr!("loop-to-screen.note"));
    ui.add_space(8.0);
    from_sample_to_screen(ui, &view.latency);
    ui.strong(tr!("loop-object"));
    grid("object").show(ui, |ui| {
        row(ui, "loop-vertices", format!("{}", s.mesh.vertex_count()));
        row(ui, "loop-triangles", format!("{}", s.mesh.triangle_count()));
    });
    if let Some(session) = view.session.as_ref().filter(|s| s.keeps()) {
        ui.colored_label(quiet, tr!("loop-saved", path = session.path));
    }
    ui.add_space(8.0);
    ui.colored_label(quiet, view.adapter);
}

/// The stages between a sample and the screen, and how many frames took how long in all.
fn from_sample_to_screen(ui: &mut egui::Ui, latency: &PresentLatency) {
    let quiet = theme::quiet(ui);
    let Some(summary) = latency.summary() else { return };
    ui.strong(tr!("loop-sample-to-screen"));
    egui::Grid::new("sample to screen").num_columns(4).spacing([10.0, 3.0]).show(ui, |ui| {
        for head in ["ms", "p50", "p99", "max"] {
            ui.colored_label(quiet, head);
        }
        ui.end_row();
        for (stage, about) in summary.stages.iter().zip(ABOUT) {
            let id = format!("stage-{}", stage.name);
            let about = text_of(&format!("{id}.about"), about);
            ui.colored_label(quiet, text_of(&id, stage.name)).on_hover_text(about);
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
        Some(us) => tr!("loop-up-to", value = format!("{:.1}", *us as f64 / 1e3)),
        None => tr!("loop-longer"),
    };
    let counted = summary.histogram.iter().enumerate().filter(|(_, n)| **n > 0);
    let lines: Vec<String> =
        counted.map(|(i, n)| tr!("loop-class", class = class(i), count = *n)).collect();
    response.on_hover_text(lines.join("\n"));
    let first = format!("{:.1}", CLASSES_US[0] as f64 / 1e3);
    let text = tr!("loop-histogram", frames = summary.frames, first = first);
    ui.colored_label(quiet, text);
    ui.add_space(8.0);
}
