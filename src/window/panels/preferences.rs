//! What a person likes, kept from day to day.

use super::state::{Action, HintsFollowed, SCALE, TwoFingers, UiState, View};
use super::theme;

pub fn ui(ui: &mut egui::Ui, ui_state: &mut UiState, view: &View<'_>) {
    ui.strong("Preferences");
    let p = &mut ui_state.prefs;
    ui.horizontal(|ui| {
        ui.label("Text size");
        let less = ui.button("-").on_hover_text(view.tip(Action::SmallerText)).clicked();
        ui.label(format!("{:.0} %", p.scale * 100.0));
        let more = ui.button("+").on_hover_text(view.tip(Action::LargerText)).clicked();
        p.scale = (p.scale + 0.1 * (f32::from(more) - f32::from(less))).clamp(SCALE.0, SCALE.1);
    });
    ui.checkbox(&mut p.light, "Light panels");
    ui.checkbox(&mut p.speed_is_pressure, "Speed is pressure")
        .on_hover_text("For a mouse: slow strokes press harder than quick ones");
    ui.horizontal(|ui| {
        ui.label("Two fingers");
        let three = "On a touch screen. Pinched they zoom; three fingers do the other, three tap \
                     to undo, four to do it again";
        for (two, name) in [(TwoFingers::Turn, "Turn"), (TwoFingers::Slide, "Slide")] {
            ui.selectable_value(&mut p.two_fingers, two, name).on_hover_text(three);
        }
    });
    let teaches = p.hints.hint().is_some();
    let (name, hints) = match teaches {
        true => ("Skip the lesson", HintsFollowed::ALL),
        false => ("First lesson again", HintsFollowed::default()),
    };
    if ui.button(name).clicked() {
        p.hints = hints;
    }
    ui.horizontal_wrapped(|ui| {
        if ui.button("Keys...").on_hover_text(view.tip(Action::Keys)).clicked() {
            ui_state.keys.open = true;
        }
        if ui.button("Help").on_hover_text(view.tip(Action::Help)).clicked() {
            ui_state.help = true;
        }
    });
    if ui.button("Search actions").on_hover_text(view.tip(Action::Search)).clicked() {
        ui_state.search = Some(Default::default());
    }
    if view.session.is_none() {
        ui.colored_label(
            theme::quiet(ui),
            "No session file: the sculpture is kept only when you export it.",
        );
    }
}
