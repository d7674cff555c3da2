//! A plane that cuts off what is in front of it, and the section of the object there.

use super::rows;
use super::state::{UiState, View};
use super::{measure, theme};
use crate::language::tr;
use crate::look::CutPlane;

pub fn ui(ui: &mut egui::Ui, ui_state: &mut UiState, view: &View<'_>) {
    rows::heading(ui, &tr!("cut-heading"));
    let (lo, hi) = view.state.world_bounds();
    let mut axis = ui_state.look.cut.map(|cut| cut.axis);
    rows::flow(ui, |ui| {
        ui.selectable_value(&mut axis, None, tr!("cut-none"));
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            let chosen = ui.selectable_value(&mut axis, Some(i), name);
            // The mirrors' buttons have the same letters.
            let (role, on) = (egui::Role::Button, axis == Some(i));
            let label = format!("{} {name}", tr!("cut-heading"));
            chosen.widget_info(|| egui::WidgetInfo::selected(role, true, on, &label));
            chosen.on_hover_text(tr!("cut-heading.tip"));
        }
    });
    let Some(axis) = axis.filter(|_| lo.cmple(hi).all()) else {
        ui_state.look.cut = None;
        return;
    };
    let (low, high) = (lo[axis], hi[axis]);
    let middle = CutPlane { axis, at: 0.5 * (low + high), below: false };
    let mut cut = ui_state.look.cut.filter(|cut| cut.axis == axis).unwrap_or(middle);
    let slider = egui::Slider::new(&mut cut.at, low..=high).fixed_decimals(2);
    rows::slider(ui, slider, &tr!("cut-at"));
    ui.checkbox(&mut cut.below, tr!("cut-below"));
    ui_state.look.cut = Some(cut);
    let quiet = theme::quiet(ui);
    let Some(found) = ui_state.sizes.section.filter(|found| found.cut == cut) else {
        ui.colored_label(quiet, tr!("measure-waits"));
        return;
    };
    egui::Grid::new("section").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        let rows = [
            ("measure-area", tr!("area-mm2", value = measure::short(found.area))),
            ("cut-perimeter", tr!("length-mm", value = measure::short(found.perimeter))),
            ("cut-contours", found.contours.to_string()),
            ("cut-open", found.open.to_string()),
        ];
        for (name, value) in rows.into_iter().filter(|r| r.0 != "cut-open" || found.open > 0) {
            ui.colored_label(quiet, tr!(name));
            ui.monospace(value);
            ui.end_row();
        }
    });
}
