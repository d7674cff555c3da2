//! What the keys, rings and buttons of a tablet do: one is pressed, and its action is chosen.

use sculptd_clay::brush::BrushKind;
use sculptd_daemon::tablet_vocabulary::choices;
use sculptd_devices::pad_actions::{ActionTable, Binding, Control};

use super::state::Action;
use super::state::action::brush_title;
use super::state::{UiRequest, UiState, View};
use super::{rows, theme};
use crate::language::tr;

/// Returns the name of a control: `key-3` is `Key 3`.
fn title(control: Control) -> String {
    match control {
        Control::Key(n) => tr!("control-key", number = n),
        Control::Barrel(n) => tr!("control-barrel", number = n),
        Control::Wheel(n) => tr!("control-wheel", number = n),
        Control::Ring(n) => tr!("control-ring", number = n),
        Control::Strip(n) => tr!("control-strip", number = n),
        Control::Eraser => tr!("control-eraser"),
    }
}

/// Returns the text of a binding: in words if it is one of the choices, else as a file has it.
fn words(control: Control, binding: Option<&Binding>) -> String {
    let turns = matches!(control, Control::Wheel(_) | Control::Ring(_) | Control::Strip(_));
    let brush = |name: &str| {
        let kind: Option<BrushKind> = name.strip_prefix("brush.")?.parse().ok();
        kind.map(brush_title)
    };
    match binding {
        None | Some(Binding::Nothing) => tr!("tablet-nothing"),
        Some(Binding::NextMode) => tr!("tablet-next-mode"),
        Some(Binding::Press(name)) => match name.as_str() {
            "undo" => Action::Undo.title(),
            "redo" => Action::Redo.title(),
            "view.fit" => Action::Frame.title(),
            "brush.invert" => Action::Carve.title(),
            other => brush(other).map_or(name.clone(), |b| tr!("tablet-brush", brush = b)),
        },
        Some(Binding::Hold(name)) => match name.as_str() {
            "view.turn" => tr!("tablet-turn"),
            "view.slide" => tr!("tablet-slide"),
            "view.zoom" => tr!("tablet-zoom"),
            "brush.radius-and-strength" => tr!("tablet-radius-and-strength"),
            "brush.invert" => tr!("tablet-carve"),
            other => brush(other).map_or(name.clone(), |b| tr!("tablet-brush.held", brush = b)),
        },
        Some(Binding::Turn { value, step }) => match (value.as_str(), turns, *step < 0.0) {
            ("brush.radius", true, false) => tr!("tablet-radius"),
            ("brush.radius", true, true) => tr!("tablet-radius.back"),
            ("brush.strength", true, false) => tr!("tablet-strength"),
            ("brush.strength", true, true) => tr!("tablet-strength.back"),
            ("brush.radius", false, false) => Action::Larger.title(),
            ("brush.radius", false, true) => Action::Smaller.title(),
            ("brush.strength", false, false) => Action::Stronger.title(),
            ("brush.strength", false, true) => Action::Weaker.title(),
            _ => value.clone(),
        },
    }
}

/// Nobody listens for a control whose page is not shown.
pub fn leave(ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    if ui_state.tablet_keys.listens_from.take().is_some() {
        out.push(UiRequest::TabletListen(false));
    }
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let Some(tablet) = &view.tablet else { return };
    let page = &mut ui_state.tablet_keys;
    ui.strong(tr!("tablet-heading"));
    if page.listens_from.is_some_and(|from| tablet.last.map_or(0, |l| l.count) != from) {
        page.chosen = tablet.last.map(|l| l.control);
        page.listens_from = None;
    }
    let listens = page.listens_from.is_some();
    let text = if listens { tr!("tablet-listening") } else { tr!("tablet-choose") };
    let button = ui.add(egui::Button::new(text).selected(listens));
    let button = button.on_hover_text(tr!("tablet-choose.tip"));
    if button.clicked() {
        page.listens_from = (!listens).then(|| tablet.last.map_or(0, |l| l.count));
        out.push(UiRequest::TabletListen(!listens));
    }
    if let Some(control) = page.chosen {
        let own = tablet.own.controls.get(&control);
        ui.label(title(control));
        let usual = ActionTable::defaults();
        let usual = words(control, usual.binding(control, 0));
        let usual = tr!("tablet-usual", action = usual);
        let now = own.map_or_else(|| usual.clone(), |b| words(control, Some(b)));
        let list = egui::ComboBox::from_id_salt("tablet action").selected_text(now).width(190.0);
        let list = list.show_ui(ui, |ui| {
            if ui.selectable_label(own.is_none(), usual.as_str()).clicked() {
                out.push(UiRequest::TabletBinding(control, None));
            }
            for (_, binding) in choices(control) {
                let text = words(control, Some(&binding));
                if ui.selectable_label(own == Some(&binding), text).clicked() {
                    out.push(UiRequest::TabletBinding(control, Some(binding)));
                }
            }
        });
        list.response.widget_info(|| {
            let name = tr!("tablet-action", control = title(control));
            egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name)
        });
    }
    for (control, binding) in &tablet.own.controls {
        rows::flow(ui, |ui| {
            let action = words(*control, Some(binding));
            let text = tr!("tablet-line", control = title(*control), action = action);
            let chosen = page.chosen == Some(*control);
            if ui.selectable_label(chosen, text).clicked() {
                page.chosen = Some(*control);
            }
            if ui.small_button(tr!("tablet-reset")).on_hover_text(tr!("tablet-reset.tip")).clicked()
            {
                out.push(UiRequest::TabletBinding(*control, None));
            }
        });
    }
    if tablet.own.controls.is_empty() {
        ui.colored_label(theme::quiet(ui), tr!("tablet-none"));
    }
}
