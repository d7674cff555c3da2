//! The mask of the whole object.

use super::state::{Action, UiRequest, View};
use super::theme;
use sculptd_clay::brush::MaskAction;
use sculptd_engine::command::Command;

const ACTIONS: [(MaskAction, &str, &str); 8] = [
    (MaskAction::Clear, "Clear", "Everything is free"),
    (MaskAction::Fill, "Fill", "Everything is held fast"),
    (MaskAction::Invert, "Invert", "What is free is held, what is held is free"),
    (MaskAction::Blur, "Blur", "A softer border"),
    (MaskAction::Sharpen, "Sharpen", "A harder border"),
    (MaskAction::Grow, "Grow", "One ring of vertices more"),
    (MaskAction::Shrink, "Shrink", "One ring less"),
    (MaskAction::Cavity(0.05), "Hollows", "Hollows are held fast"),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<UiRequest>) {
    egui::CollapsingHeader::new("Mask").default_open(false).show(ui, |ui| {
        egui::Grid::new("masks").num_columns(3).spacing([4.0, 4.0]).show(ui, |ui| {
            for (i, (action, name, tip)) in ACTIONS.into_iter().enumerate() {
                let button = egui::Button::new(name).min_size([62.0, 20.0].into());
                if ui.add(button).on_hover_text(tip).clicked() {
                    out.push(UiRequest::World(Command::Mask(action)));
                }
                if i % 3 == 2 {
                    ui.end_row();
                }
            }
        });
        let keys = view.keys.text(Action::Mask);
        ui.colored_label(theme::quiet(ui), format!("{keys} shows it; the brush mask paints it"));
    });
}
