//! The keys: which action a press is, and the window in which a person changes them.

use super::rows;
use super::state::action;
use super::state::key_map::{KeyMap, KeySet, Press};
use super::state::{Action, KeyCombination, UiState, View};
use super::theme;
use crate::language::tr;

/// Points that the keys of an action take in its row, and the button that takes a change back.
const KEYS: f32 = 112.0;
const RESET: f32 = 104.0;

/// Actions whose keys went down this frame, while nobody types. While the window of the keys
/// listens, a press is the answer to it and no action.
pub fn pressed(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState) -> Vec<Action> {
    let presses = Press::all(ctx);
    if let Some(action) = ui_state.keys.listening {
        if let Some(press) = presses.first() {
            ui_state.keys.listening = None;
            listen(action, press, ui_state);
        }
        return Vec::new();
    }
    // The field of the search has the keyboard from the frame after it was opened.
    let typing = ctx.text_edit_focused() || ui_state.search.is_some();
    let heard = presses.iter().filter(|p| !typing || p.modifiers.command || p.modifiers.ctrl);
    heard.filter_map(|p| view.keys.pressed(p)).filter(|a| !typing || *a != Action::Redo).collect()
}

/// The answer to "press a key": Escape leaves them, Delete and Backspace take them away.
fn listen(action: Action, press: &Press, ui_state: &mut UiState) {
    let m = press.modifiers;
    let plain = m.is_none();
    let keys = match press.key {
        egui::Key::Escape if plain => return,
        egui::Key::Delete | egui::Key::Backspace if plain => None,
        key => Some(KeyCombination { key, ctrl: m.command || m.ctrl, shift: m.shift, alt: m.alt }),
    };
    ui_state.prefs.keys.bind(action, keys);
}

/// The window with every action and its keys.
pub fn ui(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState, free: egui::Rect) {
    if !ui_state.keys.open {
        return;
    }
    let mut open = true;
    let size = (free.size() - egui::vec2(40.0, 80.0)).max(egui::vec2(180.0, 160.0));
    egui::Window::new(tr!("keys-heading"))
        .id(egui::Id::unique("keys"))
        .open(&mut open)
        .collapsible(false)
        .constrain_to(free)
        .default_pos(free.min + egui::vec2(16.0, 16.0))
        .default_size(size.min(egui::vec2(400.0, 460.0)))
        .max_size(size)
        .show(ctx, |ui| content(ui, view, ui_state));
    ui_state.keys.open = open;
    if !open {
        ui_state.keys.listening = None;
    }
}

fn content(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState) {
    let now = &mut ui_state.prefs.keys;
    rows::flow(ui, |ui| {
        let name = KeySet::ALL.iter().find(|s| s.0 == now.set).map_or("", |s| s.1);
        egui::ComboBox::from_label(tr!("keys-set")).selected_text(name).show_ui(ui, |ui| {
            for (set, name) in KeySet::ALL {
                ui.selectable_value(&mut now.set, set, name);
            }
        });
        let changed = !now.own.is_empty();
        let all = ui.add_enabled(changed, egui::Button::new(tr!("keys-as-in-set")));
        if all.on_hover_text(tr!("keys-as-in-set.tip")).clicked() {
            now.own.clear();
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label(tr!("keys-find"));
        ui.text_edit_singleline(&mut ui_state.keys.filter).labelled_by(label.id);
    });
    let clashes = view.keys.bindings().iter().filter(|b| view.keys.conflicts(b).next().is_some());
    match clashes.count() {
        0 => ui.colored_label(theme::quiet(ui), tr!("keys-note")),
        n => ui.colored_label(theme::alarm(ui), tr!("keys-shared", count = n)),
    };
    for wrong in &view.keys.wrong {
        ui.colored_label(theme::alarm(ui), wrong);
    }
    ui.separator();
    let found = action::search(&ui_state.keys.filter);
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let all = view.keys.bindings();
        for binding in all.iter().filter(|b| found.iter().any(|f| f.action == b.action)) {
            row(ui, view.keys, binding.action, ui_state);
        }
    });
}

/// One action: its name, its keys, and who else has them.
fn row(ui: &mut egui::Ui, keys: &KeyMap, action: Action, ui_state: &mut UiState) {
    let Some(binding) = keys.bindings().iter().find(|b| b.action == action) else { return };
    let others: Vec<String> = keys.conflicts(binding).map(Action::title).collect();
    let name = action.title();
    ui.horizontal(|ui| {
        let wrong = theme::alarm(ui);
        let text = egui::RichText::new(&name);
        let text = if others.is_empty() { text } else { text.color(wrong) };
        // The keys, and the button that resets a change, are at the right.
        let room = KEYS + if binding.own { RESET } else { 0.0 };
        ui.scope(|ui| {
            ui.set_max_width((ui.available_width() - room).max(40.0));
            ui.add(egui::Label::new(text).truncate());
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let listens = ui_state.keys.listening == Some(action);
            let text = match (listens, binding.keys) {
                (true, _) => tr!("keys-press"),
                (false, Some(keys)) => keys.shown(),
                (false, None) => tr!("none"),
            };
            let button = egui::Button::new(text).selected(listens).min_size([96.0, 20.0].into());
            let button = ui.add(button).on_hover_text(tr!("keys-of.tip"));
            let label = tr!("keys-of", action = name.as_str());
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, label.as_str())
            });
            if button.clicked() {
                ui_state.keys.listening = (!listens).then_some(action);
                // The press that answers is no text.
                ui.memory_mut(|m| m.stop_text_input());
            }
            if binding.own && ui.small_button(tr!("reset")).clicked() {
                ui_state.prefs.keys.own.remove(&action.id());
            }
        });
    });
    if !others.is_empty() {
        let id = if binding.own { "keys-also.own" } else { "keys-also" };
        let text = tr!(id, actions = others.join(", "));
        ui.colored_label(theme::alarm(ui), text);
    }
}
