//! Three hints for the first minute, each gone for good once it was followed.

/// What the person has done so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
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
pub fn ui(ctx: &egui::Context, done: &Done, ghosts: bool) {
    let hint = if ghosts { Some("Ghosts are sculpting. Touch the clay any time") } else { None };
    let Some(text) = done.hint().filter(|_| !ghosts || done.touched).or(hint) else { return };
    let place = egui::Area::new(egui::Id::unique("hint"))
        .anchor(egui::Align2::CENTER_BOTTOM, [110.0, -28.0])
        .interactable(false);
    place.show(ctx, |ui| {
        egui::Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            ui.label(egui::RichText::new(text).size(16.0));
        });
    });
}
