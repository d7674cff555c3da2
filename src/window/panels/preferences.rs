//! What a person likes, kept from day to day.

use super::rows;
use super::state::{Action, HintsFollowed, SCALE, TwoFingers, UiState, View};
use super::{fonts, theme};
use crate::language::Translation;
use crate::language::tr;

pub fn ui(ui: &mut egui::Ui, ui_state: &mut UiState, view: &View<'_>) {
    ui.strong(tr!("preferences-heading"));
    language(ui, ui_state, view);
    let p = &mut ui_state.prefs;
    rows::flow(ui, |ui| {
        ui.label(tr!("preferences-text-size"));
        let less = ui.button("-").on_hover_text(view.tip(Action::SmallerText)).clicked();
        ui.label(tr!("percent", value = format!("{:.0}", p.scale * 100.0)));
        let more = ui.button("+").on_hover_text(view.tip(Action::LargerText)).clicked();
        p.scale = (p.scale + 0.1 * (f32::from(more) - f32::from(less))).clamp(SCALE.0, SCALE.1);
    });
    ui.checkbox(&mut p.light, tr!("preferences-light"));
    ui.checkbox(&mut p.speed_is_pressure, tr!("preferences-speed"))
        .on_hover_text(tr!("preferences-speed.tip"));
    ui.checkbox(&mut p.lead_strokes, tr!("preferences-lead"))
        .on_hover_text(tr!("preferences-lead.tip"));
    rows::flow(ui, |ui| {
        ui.label(tr!("preferences-fingers"));
        for (two, name) in [
            (TwoFingers::Turn, tr!("preferences-fingers-turn")),
            (TwoFingers::Slide, tr!("preferences-fingers-slide")),
        ] {
            ui.selectable_value(&mut p.two_fingers, two, name)
                .on_hover_text(tr!("preferences-fingers.tip"));
        }
    });
    let teaches = p.hints.hint().is_some();
    let (name, hints) = match teaches {
        true => (tr!("preferences-lesson-skip"), HintsFollowed::ALL),
        false => (tr!("preferences-lesson-again"), HintsFollowed::default()),
    };
    if ui.button(name).clicked() {
        p.hints = hints;
    }
    rows::flow(ui, |ui| {
        if ui.button(tr!("preferences-keys")).on_hover_text(view.tip(Action::Keys)).clicked() {
            ui_state.keys.open = true;
        }
        if ui.button(tr!("preferences-help")).on_hover_text(view.tip(Action::Help)).clicked() {
            ui_state.help = true;
        }
    });
    if ui.button(tr!("preferences-search")).on_hover_text(view.tip(Action::Search)).clicked() {
        ui_state.search = Some(Default::default());
    }
    if view.session.is_none() {
        ui.colored_label(theme::quiet(ui), tr!("preferences-no-session"));
    }
}

/// Shows the language of the window; each language has its native name if the fonts can draw it.
fn language(ui: &mut egui::Ui, ui_state: &mut UiState, view: &View<'_>) {
    let now = view.translations.choose(&ui_state.prefs.language);
    let name = |ui: &egui::Ui, one: &Translation| {
        let (own, latin) = one.names();
        if fonts::can_draw(ui.ctx(), &own) { own } else { latin }
    };
    let system = name(ui, view.translations.choose(""));
    let system = tr!("preferences-language-system", name = system);
    let shown = if ui_state.prefs.language.is_empty() { system.clone() } else { name(ui, now) };
    let chosen = &mut ui_state.prefs.language;
    rows::list(ui, &tr!("preferences-language"), shown, |ui| {
        ui.selectable_value(chosen, String::new(), system);
        for one in view.translations.all() {
            let name = name(ui, one);
            ui.selectable_value(chosen, one.code().to_owned(), name);
        }
    });
    if ui_state.shown_language.fontless {
        let text = tr!("preferences-font", name = now.names().1);
        ui.colored_label(theme::alarm(ui), text);
    }
}
