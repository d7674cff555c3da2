//! The face sets of the active object: making them, hiding parts of the surface, and parts of it
//! as objects of their own.

use std::collections::BTreeMap;

use super::icons::{self, Icon};
use super::region;
use super::rows;
use super::state::region::RegionPurpose;
use super::state::{UiRequest, UiState, View};
use crate::language::tr;
use crate::look::{Material, with_set};
use sculptd_clay::brush::{BrushKind, BrushSettings, draw_face_sets};
use sculptd_clay::face_sets::{FaceSetPart, Partition, SetsEdit};
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneCommand;

/// Sets that the list shows; of an object with more of them the first.
const ROWS: usize = 64;

fn ask(out: &mut Vec<UiRequest>, edit: SetsEdit) {
    out.push(UiRequest::World(Command::Scene(SceneCommand::Sets(edit))));
}

/// A button by the message of its name, whose attribute `tip` says what it does.
fn button(ui: &mut egui::Ui, can: bool, name: &str) -> bool {
    let button = ui.add_enabled(can, egui::Button::new(tr!(name)));
    button.on_hover_text(tr!(&format!("{name}.tip"))).clicked()
}

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let title = egui::CollapsingHeader::new(tr!("sets-heading")).id_salt("sets-heading");
    title.default_open(false).show(ui, |ui| {
        let locked = view.state.scene.active().is_some_and(|o| o.settings.locked);
        ui.add_enabled_ui(!locked, |ui| {
            list(ui, view, ui_state, out);
            make(ui, ui_state, out);
            extract(ui, view, ui_state, out);
        });
    });
    ui.separator();
}

/// A button that is down while it holds, in the same way.
fn choice(ui: &mut egui::Ui, on: bool, name: &str) -> bool {
    let button = ui.add(egui::Button::selectable(on, tr!(name)));
    button.on_hover_text(tr!(&format!("{name}.tip"))).clicked()
}

/// The colour in which a set is shown on this material.
fn swatch(ui: &mut egui::Ui, material: &Material, set: u16) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
    let tint = with_set([u8::MAX; 4], set);
    let [r, g, b] =
        std::array::from_fn(|i| (material.base[i].powf(1.0 / 2.2) * f32::from(tint[i])) as u8);
    ui.painter().rect_filled(rect, 3.0, egui::Color32::from_rgb(r, g, b));
}

/// The brush that draws a set; where it is `drawn` already, new ones.
fn drawing(view: &View<'_>, drawn: Option<u16>, set: u16) -> BrushSettings {
    let (now, kept) = (&view.state.brush, &view.state.kept_brushes);
    let mut brush = match drawn {
        Some(_) => *now,
        None => view.presets.recalled(now, kept, BrushKind::DrawFaceSets),
    };
    let goes_on = drawn == Some(set);
    brush.extra[draw_face_sets::SET] = if goes_on { 0.0 } else { f32::from(set) };
    brush.clamped()
}

/// The sets, what is in none first.
fn list(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let sets = ui_state.face_sets.sets(view.state).to_vec();
    let hidden: u64 = sets.iter().map(|s| s.2).sum();
    let plain = sets.iter().all(|s| s.0 == 0);
    let none = BTreeMap::new();
    let names = view.state.scene.active().map_or(&none, |o| &o.settings.set_names);
    let brush = &view.state.brush;
    let drawn =
        (brush.kind == BrushKind::DrawFaceSets).then(|| brush.extra[draw_face_sets::SET] as u16);
    if !plain {
        ui.checkbox(&mut ui_state.look.sets, tr!("sets-colours"));
        for &(set, vertices, hidden) in sets.iter().take(ROWS) {
            ui.push_id(set, |ui| {
                ui.horizontal(|ui| {
                    let shown = hidden < vertices;
                    let eyes = [Icon::Eye, Icon::EyeOff];
                    let eye = icons::switch(ui, eyes, &tr!("layers-eye"), shown);
                    if eye.on_hover_text(tr!("sets-eye-tip")).clicked() {
                        ask(out, if shown { SetsEdit::Hide(set) } else { SetsEdit::Show(set) });
                    }
                    if button(ui, true, "sets-isolate") {
                        ask(out, SetsEdit::Isolate(set));
                    }
                    if set > 0 && choice(ui, drawn == Some(set), "sets-draw") {
                        out.push(UiRequest::World(Command::Brush(drawing(view, drawn, set))));
                    }
                    let name = match set {
                        0 => tr!("sets-none", count = vertices),
                        _ => {
                            swatch(ui, ui_state.look.material(), set);
                            tr!("sets-row", number = set, count = vertices)
                        }
                    };
                    let short = match (set, names.get(&set)) {
                        (0, _) => name.clone(),
                        (_, Some(own)) => own.clone(),
                        _ => set.to_string(),
                    };
                    let panel = &mut ui_state.face_sets;
                    if let Some((_, text)) = panel.renaming.as_mut().filter(|r| r.0 == set) {
                        let field = ui.text_edit_singleline(text);
                        if field.lost_focus() {
                            let named = SceneCommand::NameSet(set, text.trim().into());
                            out.push(UiRequest::World(Command::Scene(named)));
                            panel.renaming = None;
                        } else {
                            field.request_focus();
                        }
                        return;
                    }
                    let label = egui::Label::new(short).truncate().sense(egui::Sense::click());
                    let label = ui.add(label).on_hover_text(name);
                    if set > 0 && label.double_clicked() {
                        panel.renaming = Some((set, names.get(&set).cloned().unwrap_or_default()));
                    }
                });
            });
        }
    }
    rows::flow(ui, |ui| {
        if button(ui, true, "sets-hide-masked") {
            ask(out, SetsEdit::HideMasked);
        }
        if button(ui, true, "sets-invert") {
            ask(out, SetsEdit::Invert);
        }
        if button(ui, hidden > 0, "sets-show-all") {
            ask(out, SetsEdit::ShowAll);
        }
        if button(ui, !plain, "sets-clear") {
            ask(out, SetsEdit::Clear);
        }
    });
}

fn make(ui: &mut egui::Ui, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    rows::flow(ui, |ui| {
        if button(ui, true, "sets-from-mask") {
            ask(out, SetsEdit::FromMask);
        }
        if button(ui, true, "sets-from-visible") {
            ask(out, SetsEdit::FromVisible);
        }
        let free = !ui_state.joining;
        let degrees = ui_state.face_sets.degrees;
        for (by, name) in [
            (Partition::Loose, "sets-loose"),
            (Partition::Normals(degrees), "sets-normals"),
            (Partition::Crease(degrees), "sets-crease"),
            (Partition::Walls(None), "sets-walls"),
        ] {
            if button(ui, free, name) {
                out.push(UiRequest::MakeSets(by));
            }
        }
    });
    let degrees = egui::Slider::new(&mut ui_state.face_sets.degrees, 1.0..=180.0);
    rows::slider(ui, degrees.suffix("°"), &tr!("sets-degrees"));
    region::buttons(ui, &mut ui_state.region, RegionPurpose::FaceSet);
}

fn extract(ui: &mut egui::Ui, view: &View<'_>, ui_state: &mut UiState, out: &mut Vec<UiRequest>) {
    let share = egui::Slider::new(&mut ui_state.face_sets.thickness, -0.2..=0.2);
    rows::slider(ui, share.fixed_decimals(3), &tr!("sets-thickness"))
        .on_hover_text(tr!("sets-thickness.tip"));
    let (lo, hi) = view.state.mesh.bounds();
    let scale = view.state.scene.active().map_or(1.0, |o| o.settings.transform.scale);
    let thickness =
        ui_state.face_sets.thickness * f64::from((hi - lo).max_element().max(0.0)) * scale;
    let can = !ui_state.joining && thickness != 0.0;
    if button(ui, can, "sets-extract-mask") {
        out.push(UiRequest::Extract(FaceSetPart::Masked, thickness));
    }
}
