//! Views that a person keeps, to come back to: a number each.

use super::rows;
use super::state::{UiRequest, UiState, VIEWS, View};
use crate::language::tr;
use sculptd_engine::camera::Camera;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let kept = &mut ui_state.prefs.kept_views;
    let mut gone = None;
    rows::flow(ui, |ui| {
        let keep = ui.add_enabled(kept.len() < VIEWS, egui::Button::new(tr!("look-keep")));
        if keep.on_hover_text(tr!("look-keep.tip")).clicked() {
            kept.push(view.camera);
        }
        for (i, camera) in kept.iter().enumerate() {
            let number = (i + 1).to_string();
            let shown = Camera { aspect: view.camera.aspect, ..*camera };
            let button = ui.selectable_label(shown == view.camera, number);
            let button = button.on_hover_text(tr!("look-keep.show"));
            if button.clicked() {
                out.push(UiRequest::Camera(shown));
            }
            if button.secondary_clicked() {
                gone = Some(i);
            }
        }
    });
    if let Some(i) = gone {
        kept.remove(i);
    }
}
