//! The brush: kind, radius, strength, mirrors, undo.

use super::View;
use super::theme::QUIET;
use crate::brush::{BrushKind, BrushSettings};
use crate::command::Command;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<Command>) {
    let mut brush: BrushSettings = view.state.brush;
    ui.strong("Brush");
    ui.horizontal(|ui| {
        ui.selectable_value(&mut brush.kind, BrushKind::Gaussian, "Draw")
            .on_hover_text("Raises a bell of clay (1)");
        ui.selectable_value(&mut brush.kind, BrushKind::Smooth, "Smooth")
            .on_hover_text("Evens the surface (2, or hold Shift)");
    });
    let radius = egui::Slider::new(&mut brush.radius, 0.005..=1.0).logarithmic(true).text("Radius");
    ui.add(radius).on_hover_text("Share of the work's size ([ and ])");
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0).text("Strength");
    ui.add(strength).on_hover_text("Height of one dab as a share of the radius (Shift+[ and Shift+])");
    ui.checkbox(&mut brush.negative, "Carve").on_hover_text("The other way round (X, or hold Ctrl)");
    ui.horizontal(|ui| {
        ui.label("Mirror");
        for (axis, name) in brush.symmetry.iter_mut().zip(["x", "y", "z"]) {
            ui.toggle_value(axis, name)
                .on_hover_text(format!("Sculpt on both sides of the plane {name} = 0"));
        }
    });
    ui.horizontal(|ui| {
        let s = view.state;
        let undo = ui.add_enabled(s.undo_steps > 0, egui::Button::new("Undo")).on_hover_text("Ctrl+Z");
        let redo = ui.add_enabled(s.redo_steps > 0, egui::Button::new("Redo")).on_hover_text("Ctrl+Shift+Z");
        if undo.clicked() {
            out.push(Command::Undo);
        }
        if redo.clicked() {
            out.push(Command::Redo);
        }
        ui.colored_label(QUIET, format!("{} steps", s.undo_steps));
    });
    if brush != view.state.brush {
        out.push(Command::Brush(brush));
    }
}
