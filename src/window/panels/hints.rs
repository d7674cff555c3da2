//! Three hints for the first minute, each gone for good once it was followed.

/// What the person has done so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Done {
    pub touched: bool,
    pub turned: bool,
    pub undone: bool,
}

impl Done {
    /// The hint for now, if one is left.
    pub fn hint(&self) -> Option<&'static str> {
        match (self.touched, self.turned, self.undone) {
            (false, ..) => Some("Touch the clay: press and drag on the form"),
            (_, false, _) => Some("Drag beside the form to turn it, scroll to come nearer"),
            (_, _, false) => Some("Ctrl+Z takes a stroke back, Shift smooths, Ctrl carves"),
            _ => None,
        }
    }
}

/// Shows the hint low in the middle of the view.
pub fn ui(ctx: &egui::Context, done: &Done, ghosts: bool, free: egui::Rect) {
    let hint = (ghosts && !done.touched).then_some("Ghosts are sculpting. Touch the clay any time");
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
