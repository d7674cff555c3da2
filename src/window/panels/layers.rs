//! The layers of the active object, the highest on top: which one strokes change, which are seen
//! and how strongly, and what can be done to the active one.
//!
//! While an intensity is dragged, each value is sent as it comes, so that the surface follows; all
//! of them are one step of undo.

use super::icons::{self, Icon};
use super::rows;
use super::state::{LayerPanel, UiRequest, UiState, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::Measure;
use sculptd_clay::layers::{Layer, MAX_INTENSITY, MAX_LAYERS};
use sculptd_clay::{LayerEdit, LayerStack};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;

fn ask(out: &mut Vec<UiRequest>, edit: LayerEdit) {
    out.push(UiRequest::World(Command::Scene(SceneCommand::Layers(edit))));
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let none = LayerStack::default();
    let stack = view.state.mesh.layers().map_or(&none, |s| s);
    let locked = view.state.scene.active().is_some_and(|o| o.settings.locked);
    rows::flow(ui, |ui| {
        ui.strong(tr!("layers-heading"));
        let room = !locked && stack.layers.len() < MAX_LAYERS;
        let add = ui.add_enabled(room, egui::Button::new(tr!("layers-add")));
        if add.on_hover_text(tr!("layers-add.tip")).clicked() {
            ask(out, LayerEdit::Add(tr!("layers-name", number = stack.next + 1)));
        }
    });
    if stack.layers.is_empty() {
        ui.separator();
        return;
    }
    ui.add_enabled_ui(!locked, |ui| {
        for layer in stack.layers.iter().rev() {
            row(ui, layer, stack, &mut ui_state.layers, out);
        }
        let base = icons::row(ui, stack.active.is_none(), &tr!("layers-base"));
        if ui.add(base).on_hover_text(tr!("layers-base.tip")).clicked() {
            ask(out, LayerEdit::Activate(None));
        }
        match stack.active() {
            Some(active) => buttons(ui, active, stack, &mut ui_state.layers, out),
            None => bake(ui, out),
        }
    });
    if !stack.takes_strokes() {
        ui.colored_label(theme::quiet(ui), tr!("layers-unseen"));
    }
    if view.state.brush.topology.by != Measure::Off {
        ui.colored_label(theme::quiet(ui), tr!("layers-topology"));
    }
    ui.separator();
}

fn row(
    ui: &mut egui::Ui,
    layer: &Layer,
    stack: &LayerStack,
    panel: &mut LayerPanel,
    out: &mut Vec<UiRequest>,
) {
    let id = layer.id;
    let named = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let eyes = [Icon::Eye, Icon::EyeOff];
        let eye = icons::switch(ui, eyes, &tr!("layers-eye"), layer.visible);
        if eye.on_hover_text(tr!("layers-eye.tip")).clicked() {
            let visible = Some(!layer.visible);
            ask(out, LayerEdit::Set { id, intensity: None, visible, live: false });
        }
        if let Some((renamed, text)) = panel.renaming.as_mut().filter(|r| r.0 == id) {
            let field = ui.text_edit_singleline(text);
            if field.lost_focus() {
                ask(out, LayerEdit::Rename(*renamed, text.clone()));
                panel.renaming = None;
            } else {
                field.request_focus();
            }
            return None;
        }
        let active = stack.active == Some(id);
        let name = ui.add(icons::row(ui, active, &layer.name));
        if name.double_clicked() {
            panel.renaming = Some((id, layer.name.clone()));
        } else if name.clicked() && !active {
            ask(out, LayerEdit::Activate(Some(id)));
        }
        Some(name.id)
    });
    let mut shown = panel.dragged.filter(|d| d.0 == id).map_or(layer.intensity, |d| d.1);
    let slider = egui::Slider::new(&mut shown, -MAX_INTENSITY..=MAX_INTENSITY).fixed_decimals(2);
    let add = |ui: &mut egui::Ui| {
        ui.spacing_mut().slider_width = ui.available_width() - 56.0;
        ui.add(slider)
    };
    let mut slider = ui.push_id(id.0, add).inner;
    if let Some(name) = named.inner {
        slider = slider.labelled_by(name);
    }
    let set = |live| LayerEdit::Set { id, intensity: Some(shown), visible: None, live };
    if slider.drag_stopped() {
        panel.dragged = None;
        ask(out, set(false));
    } else if slider.changed() {
        let live = slider.dragged();
        panel.dragged = live.then_some((id, shown));
        ask(out, set(live));
    }
}

fn buttons(
    ui: &mut egui::Ui,
    active: &Layer,
    stack: &LayerStack,
    panel: &mut LayerPanel,
    out: &mut Vec<UiRequest>,
) {
    let id = active.id;
    let Some(place) = stack.index_of(id) else { return };
    let below = place.checked_sub(1).map(|below| &stack.layers[below]);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        if icons::button(ui, Icon::Pencil, &tr!("layers-rename")).clicked() {
            panel.renaming = Some((id, active.name.clone()));
        }
        // By the message of its name, whose attribute `tip` says what it does.
        let mut button = |ui: &mut egui::Ui, can: bool, (icon, name): (Icon, &str), edit| {
            let add = |ui: &mut egui::Ui| icons::button(ui, icon, &tr!(name));
            let button = ui.add_enabled_ui(can, add).inner;
            let tip = format!("{}: {}", tr!(name), tr!(&format!("{name}.tip")));
            if button.on_hover_text(tip).clicked() {
                ask(out, edit);
            }
        };
        let highest = place + 1 == stack.layers.len();
        let to = |place: usize| LayerEdit::Move(id, place as u32);
        button(ui, !highest, (Icon::ArrowUp, "layers-up"), to(place + 1));
        let lower = to(place.saturating_sub(1));
        button(ui, place > 0, (Icon::ArrowDown, "layers-down"), lower);
        let seen = active.visible && below.is_none_or(|l| l.visible);
        let merge = (Icon::ArrowDownToLine, "layers-merge");
        button(ui, seen, merge, LayerEdit::MergeDown(id));
        let room = stack.layers.len() < MAX_LAYERS;
        button(ui, room, (Icon::Copy, "layers-duplicate"), LayerEdit::Duplicate(id));
        button(ui, true, (Icon::Eraser, "layers-clear"), LayerEdit::Clear(id));
        button(ui, true, (Icon::Trash2, "layers-remove"), LayerEdit::Remove(id));
    });
    bake(ui, out);
}

fn bake(ui: &mut egui::Ui, out: &mut Vec<UiRequest>) {
    let button = ui.button(tr!("layers-bake"));
    if button.on_hover_text(tr!("layers-bake.tip")).clicked() {
        ask(out, LayerEdit::Bake);
    }
}
