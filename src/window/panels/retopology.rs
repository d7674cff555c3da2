//! Quads that follow the shape, and decimation: how many, the buttons, and how far one is.

use std::time::Duration;

use super::rows;
use super::state::{CREASE, UiRequest, UiState, View};
use crate::language::tr;
use sculptd_daemon::decimate_job::{DecimateWanted, LEAST};
use sculptd_daemon::quad_job::{MOST_LEVELS, QuadsWanted};
use sculptd_daemon::symmetrise_job::SymmetriseWanted;

/// Interval at which a progress bar is redrawn, while there is one.
const LOOK: Duration = Duration::from_millis(100);

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let (free, wanted) = (!ui_state.joining, &mut ui_state.retopology);
    ui.strong(tr!("quads-heading"));
    let slider = egui::Slider::new(&mut wanted.quads, 100..=200_000).logarithmic(true);
    rows::slider(ui, slider, &tr!("quads-count"));
    let slider = egui::Slider::new(&mut wanted.levels, 0..=MOST_LEVELS);
    rows::slider(ui, slider, &tr!("quads-levels")).on_hover_text(tr!("quads-levels.tip"));
    ui.checkbox(&mut wanted.creases, tr!("remesh-sharp"));
    let button = ui.add_enabled(free, egui::Button::new(tr!("quads-button")));
    if button.on_hover_text(tr!("quads-button.tip")).clicked() {
        out.push(UiRequest::Quads(QuadsWanted {
            quads: wanted.quads as usize,
            creases: wanted.creases.then_some(CREASE),
            guides: Vec::new(),
            levels: wanted.levels,
        }));
    }
    ui.add_space(8.0);
    ui.strong(tr!("decimate-heading"));
    let slider = egui::Slider::new(&mut wanted.share, 0.1..=99.0).logarithmic(true).suffix(" %");
    rows::slider(ui, slider, &tr!("decimate-share"));
    let button = ui.add_enabled(free, egui::Button::new(tr!("decimate-button")));
    if button.on_hover_text(tr!("decimate-button.tip")).clicked() {
        let left = view.state.mesh.triangle_count() as f64 * f64::from(wanted.share) / 100.0;
        let triangles = (left.round() as usize).max(LEAST);
        out.push(UiRequest::Decimate(DecimateWanted { triangles, max_error: None }));
    }
    ui.add_space(8.0);
    ui.strong(tr!("symmetrise-heading"));
    ui.horizontal_wrapped(|ui| {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for keeps_positive in [true, false] {
                let (from, to) = if keeps_positive { ('+', '-') } else { ('-', '+') };
                let text = format!("{from}{name} > {to}{name}");
                let button = ui.add_enabled(free, egui::Button::new(text));
                if button.on_hover_text(tr!("symmetrise-heading.tip")).clicked() {
                    let wanted = SymmetriseWanted { axis, keeps_positive };
                    out.push(UiRequest::Symmetrise(wanted));
                }
            }
        }
    });
    progress(ui, ui_state);
}

/// Shows the progress of an operation on the whole object, with a button that cancels it.
pub fn progress(ui: &mut egui::Ui, ui_state: &UiState) {
    if let Some(job) = &ui_state.retopology.under_way {
        ui.horizontal(|ui| {
            let percent = tr!("percent", value = format!("{:.0}", job.done() * 100.0));
            ui.add(egui::ProgressBar::new(job.done()).desired_width(120.0).text(percent));
            if ui.button(tr!("cancel")).clicked() {
                job.cancel();
            }
        });
        ui.ctx().request_repaint_after(LOOK);
    }
}
