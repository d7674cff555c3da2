//! What the keys, rings and buttons of a tablet do: one is pressed, and its action is chosen.

use sculptd_daemon::tablet_vocabulary::choices;
use sculptd_devices::pad_actions::{ActionTable, Binding, Control};

use super::state::{UiRequest, UiState, View};
use super::theme;

/// What a control is called: `key-3` becomes `Key 3`.
fn title(control: Control) -> String {
    let name = control.to_string().replace('-', " ");
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
}

/// What a binding does, in the words of the choices, else as a file has it.
fn words(control: Control, binding: Option<&Binding>) -> String {
    let Some(binding) = binding else { return "Nothing".into() };
    let known = choices(control).into_iter().find(|(_, b)| b == binding).map(|c| c.0);
    known.unwrap_or_else(|| match binding {
        Binding::Press(name) | Binding::Hold(name) | Binding::Turn { value: name, .. } => {
            name.clone()
        }
        Binding::NextMode => "Next mode".into(),
        Binding::Nothing => "Nothing".into(),
    })
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
    ui.strong("Keys of the tablet");
    if page.listens_from.is_some_and(|from| tablet.last.map_or(0, |l| l.count) != from) {
        page.chosen = tablet.last.map(|l| l.control);
        page.listens_from = None;
    }
    let listens = page.listens_from.is_some();
    let text = if listens { "Press a key of the tablet now..." } else { "Choose by pressing it" };
    let button = ui.add(egui::Button::new(text).selected(listens)).on_hover_text(
        "Then press the tablet's key or the pen's button, or turn the ring. It does nothing else \
         meanwhile",
    );
    if button.clicked() {
        page.listens_from = (!listens).then(|| tablet.last.map_or(0, |l| l.count));
        out.push(UiRequest::TabletListen(!listens));
    }
    if let Some(control) = page.chosen {
        let own = tablet.own.controls.get(&control);
        ui.label(title(control));
        let usual = ActionTable::defaults();
        let usual = words(control, usual.binding(control, 0));
        let usual = format!("As usual ({})", usual.to_lowercase());
        let now = own.map_or_else(|| usual.clone(), |b| words(control, Some(b)));
        let list = egui::ComboBox::from_id_salt("tablet action").selected_text(now).width(190.0);
        let list = list.show_ui(ui, |ui| {
            if ui.selectable_label(own.is_none(), usual.as_str()).clicked() {
                out.push(UiRequest::TabletBinding(control, None));
            }
            for (words, binding) in choices(control) {
                if ui.selectable_label(own == Some(&binding), words).clicked() {
                    out.push(UiRequest::TabletBinding(control, Some(binding)));
                }
            }
        });
        list.response.widget_info(|| {
            let name = format!("Action of {}", title(control));
            egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name)
        });
    }
    for (control, binding) in &tablet.own.controls {
        ui.horizontal(|ui| {
            let text = format!("{}: {}", title(*control), words(*control, Some(binding)));
            let chosen = page.chosen == Some(*control);
            if ui.selectable_label(chosen, text).clicked() {
                page.chosen = Some(*control);
            }
            if ui.small_button("Reset").on_hover_text("As usual again").clicked() {
                out.push(UiRequest::TabletBinding(*control, None));
            }
        });
    }
    if tablet.own.controls.is_empty() {
        ui.colored_label(theme::quiet(ui), "Everything does what it usually does.");
    }
}
