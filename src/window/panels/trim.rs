//! Trimming: a box or a line drawn over the view ([`super::region`]) cuts off the part in it or to
//! its left, all the way through. And the levels of detail.

use super::rows;
use super::state::region::{RegionPurpose, RegionShape};
use super::state::{UiRequest, UiState, View};
use super::theme;
use crate::language::tr;

/// The buttons.
pub fn buttons(ui: &mut egui::Ui, ui_state: &mut UiState) {
    ui.strong(tr!("trim-heading"));
    rows::flow(ui, |ui| {
        for (shape, name, tip) in [
            (RegionShape::Box, tr!("trim-box"), tr!("trim-box.tip")),
            (RegionShape::Line, tr!("trim-line"), tr!("trim-line.tip")),
        ] {
            let on = ui_state.region.now() == Some((shape, RegionPurpose::Trim));
            if ui
                .add_enabled(!ui_state.joining, egui::Button::selectable(on, name))
                .on_hover_text(tip)
                .clicked()
            {
                match on {
                    true => ui_state.region.drawing = None,
                    false => ui_state.region.begin(shape, RegionPurpose::Trim),
                }
            }
        }
    });
    if ui_state.region.now().is_some_and(|now| now.1 == RegionPurpose::Trim) {
        ui.colored_label(theme::quiet(ui), tr!("trim-note"));
    }
}

/// The levels of detail: coarser to shape, finer for detail.
pub fn levels(ui: &mut egui::Ui, view: &View<'_>, ui_state: &UiState, out: &mut Vec<UiRequest>) {
    ui.strong(tr!("levels-heading"));
    let (at, of) = view.state.mesh.levels().map_or((0, 1), |l| l.at());
    let n = view.state.mesh.triangle_count();
    ui.colored_label(theme::quiet(ui), tr!("levels-at", at = at + 1, all = of, count = n));
    rows::flow(ui, |ui| {
        let button = egui::Button::new(tr!("levels-coarser"));
        let coarser = ui.add_enabled(at > 0 && !ui_state.joining, button);
        if coarser.on_hover_text(tr!("levels-coarser.tip")).clicked() {
            out.push(UiRequest::Level(false));
        }
        let finer = ui.add_enabled(!ui_state.joining, egui::Button::new(tr!("levels-finer")));
        let tip = if at + 1 < of { tr!("levels-finer.back") } else { tr!("levels-finer.tip") };
        if finer.on_hover_text(tip).clicked() {
            out.push(UiRequest::Level(true));
        }
    });
}
