//! Three hints for the first minute; each disappears once it was followed.

use super::state::HintsFollowed;

/// Shows the hint low in the middle of the view.
pub fn ui(ctx: &egui::Context, done: &HintsFollowed, demo_runs: bool, free: egui::Rect) {
    let hint =
        (demo_runs && !done.touched).then_some("The demo is running. Touch the clay at any time");
    let Some(text) = hint.or(done.hint()) else { return };
    let place = egui::Area::new(egui::Id::unique("hint"))
        .fixed_pos(free.center_bottom() - egui::vec2(0.0, 18.0))
        .pivot(egui::Align2::CENTER_BOTTOM)
        .constrain_to(free)
        .interactable(false);
    place.show(ctx, |ui| {
        ui.set_max_width((free.width() - 60.0).clamp(60.0, 460.0));
        egui::Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.label(egui::RichText::new(text).size(15.0));
        });
    });
}
