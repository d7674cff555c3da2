//! The mask of the whole object.

use super::region;
use super::rows;
use super::state::region::RegionPurpose;
use super::state::{Action, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::MaskAction;
use sculptd_clay::measured_mask::MaskMeasure;
use sculptd_engine::command::Command;

/// Each with the message of its name.
const ACTIONS: [(MaskAction, &str); 8] = [
    (MaskAction::Clear, "mask-clear"),
    (MaskAction::Fill, "mask-fill"),
    (MaskAction::Invert, "mask-invert"),
    (MaskAction::Blur, "mask-blur"),
    (MaskAction::Sharpen, "mask-sharpen"),
    (MaskAction::Grow, "mask-grow"),
    (MaskAction::Shrink, "mask-shrink"),
    (MaskAction::Cavity(0.05), "mask-cavity"),
];

/// The share of the light that is kept from what the button protects.
const SHELTERED: f32 = 0.4;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let title = egui::CollapsingHeader::new(tr!("mask-heading")).id_salt("mask-heading");
    title.default_open(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing = [4.0, 4.0].into();
        rows::flow(ui, |ui| {
            for (action, name) in ACTIONS {
                let button = egui::Button::new(tr!(name)).min_size([58.0, 20.0].into());
                if ui.add(button).on_hover_text(tr!(&format!("{name}.tip"))).clicked() {
                    out.push(UiRequest::World(Command::Mask(action)));
                }
            }
        });
        measured(ui, view, ui_state, out);
        region::buttons(ui, &mut ui_state.region, RegionPurpose::Mask);
        let keys = view.keys.text(Action::Mask);
        ui.colored_label(theme::quiet(ui), tr!("mask-note", keys = keys));
    });
}

/// Shows the masks by thickness and by ambient occlusion.
fn measured(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let (lo, hi) = view.state.mesh.bounds();
    let below = ui_state.mask.thin * (hi - lo).max_element().max(0.0);
    rows::flow(ui, |ui| {
        for (by, name) in [
            (MaskMeasure::Thin(below), "mask-thin"),
            (MaskMeasure::Occlusion(SHELTERED), "mask-occlusion"),
        ] {
            let button = egui::Button::new(tr!(name)).min_size([58.0, 20.0].into());
            let button = ui.add_enabled(!ui_state.joining, button);
            if button.on_hover_text(tr!(&format!("{name}.tip"))).clicked() {
                out.push(UiRequest::MaskMeasured(by));
            }
        }
    });
    let share = egui::Slider::new(&mut ui_state.mask.thin, 0.001..=0.5).logarithmic(true);
    rows::slider(ui, share, &tr!("mask-thin-below")).on_hover_text(tr!("mask-thin-below.tip"));
}
