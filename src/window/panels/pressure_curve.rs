//! How pressure becomes strength, and how it becomes radius: two curves, each edited by its two
//! ends, with the pen's live trace on it.

use egui::{Pos2, Rect, Sense, Stroke, pos2, vec2};

use super::rows;
use super::state::{PenTrace, UiRequest, View};
use super::theme;
use crate::language::tr;
use sculptd_clay::brush::PressureCurve;
use sculptd_engine::command::Command;

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, trace: &PenTrace, out: &mut Vec<UiRequest>) {
    let mut brush = view.state.brush;
    let title = egui::CollapsingHeader::new(tr!("pressure-heading")).id_salt("pressure-heading");
    title.default_open(false).show(ui, |ui| {
        edited(ui, trace, &mut brush.pressure_strength, &tr!("pressure-curve"));
        let curve = &mut brush.pressure_strength;
        let lightest = egui::Slider::new(&mut curve.at_zero, 0.0..=1.0);
        rows::slider(ui, lightest, &tr!("pressure-lightest"));
        let bend = egui::Slider::new(&mut curve.gamma, 0.1..=10.0).logarithmic(true);
        rows::slider(ui, bend, &tr!("pressure-bend"));
        edited(ui, trace, &mut brush.pressure_radius, &tr!("pressure-radius-curve"));
        let radius = egui::Slider::new(&mut brush.pressure_radius.at_zero, 0.0..=1.0);
        rows::slider(ui, radius, &tr!("pressure-radius")).on_hover_text(tr!("pressure-radius.tip"));
        let bend = egui::Slider::new(&mut brush.pressure_radius.gamma, 0.1..=10.0);
        rows::slider(ui, bend.logarithmic(true), &tr!("pressure-radius-bend"));
    });
    if brush != view.state.brush {
        out.push(UiRequest::World(Command::Brush(brush.clamped())));
    }
}

/// One curve, drawn, and bent by dragging it; `name` is for those who do not see it.
fn edited(ui: &mut egui::Ui, trace: &PenTrace, curve: &mut PressureCurve, name: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(196.0, 92.0), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, name));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    let at = |p: f32, f: f32| place(rect, p, f);
    // Pressures felt lately, fading with age.
    for (age, p) in trace.recent().enumerate() {
        let fade = 1.0 - age as f32 / PenTrace::KEPT as f32;
        let colour = theme::accent(ui).gamma_multiply(fade * 0.6);
        painter.circle_filled(at(p, curve.factor(p)), 2.0 + 2.0 * fade, colour);
    }
    let line: Vec<Pos2> =
        (0..=48).map(|i| i as f32 / 48.0).map(|p| at(p, curve.factor(p))).collect();
    painter.add(egui::Shape::line(line, Stroke::new(2.0, ui.visuals().text_color())));
    if let Some(p) = trace.recent().next() {
        painter.circle_filled(at(p, curve.factor(p)), 5.0, theme::accent(ui));
    }
    if let Some(to) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        let x = ((to.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        let y = ((rect.bottom() - to.y) / rect.height()).clamp(0.0, 1.0);
        if x < 0.15 {
            curve.at_zero = y;
        } else if x < 0.95 {
            // The exponent that leads the curve through the pointer.
            let share = ((y - curve.at_zero) / (1.0 - curve.at_zero).max(1e-3)).clamp(0.001, 0.999);
            curve.gamma = (share.ln() / x.ln()).clamp(0.1, 10.0);
        }
    }
    response.on_hover_text(tr!("pressure-curve.tip"));
}

fn place(rect: Rect, p: f32, f: f32) -> Pos2 {
    let inner = rect.shrink(6.0);
    pos2(inner.left() + p * inner.width(), inner.bottom() - f * inner.height())
}
