//! The brush: kind, radius, strength, spacing.

use egui::{Color32, Pos2, Sense, Stroke, vec2};

use super::action::Action;
use super::{Ask, View, theme};
use crate::brush::{BrushKind, BrushSettings};
use crate::command::Command;

/// Every brush: its kind, name, what it does.
pub const BRUSHES: &[(BrushKind, &str, &str)] = &[
    (BrushKind::Gaussian, "Draw", "Raises a bell of clay"),
    (BrushKind::Smooth, "Smooth", "Evens the surface (hold Shift)"),
];

pub fn ui(ui: &mut egui::Ui, view: &View<'_>, out: &mut Vec<Ask>) {
    let mut brush: BrushSettings = view.state.brush;
    ui.strong("Brush");
    ui.horizontal_wrapped(|ui| {
        for (kind, name, tip) in BRUSHES {
            if picture(ui, *kind, name, brush.kind == *kind).on_hover_text(*tip).clicked() {
                brush.kind = *kind;
            }
        }
    });
    let keys = |a: Action, b: Action| {
        let of = |a: Action| a.entry().keys.map_or(String::new(), |k| k.to_string());
        format!("{} and {}", of(a), of(b))
    };
    let radius = egui::Slider::new(&mut brush.radius, 0.005..=1.0).logarithmic(true).text("Radius");
    ui.add(radius).on_hover_text(format!(
        "Share of the work's size ({}, or F and drag)",
        keys(Action::Smaller, Action::Larger)
    ));
    let strength = egui::Slider::new(&mut brush.strength, 0.0..=1.0).text("Strength");
    ui.add(strength).on_hover_text(format!(
        "Height of one dab as a share of the radius ({}, or Shift+F and drag)",
        keys(Action::Weaker, Action::Stronger)
    ));
    let spacing = egui::Slider::new(&mut brush.spacing, 0.02..=1.0).text("Spacing");
    ui.add(spacing).on_hover_text("Distance between dabs as a share of the radius");
    ui.checkbox(&mut brush.negative, "Carve")
        .on_hover_text(format!("{}; hold Ctrl for one stroke", Action::Carve.tip()));
    if brush != view.state.brush {
        out.push(Ask::World(Command::Brush(brush.clamped())));
    }
}

/// A button with the profile that the brush leaves.
fn picture(ui: &mut egui::Ui, kind: BrushKind, name: &str, chosen: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(96.0, 50.0), Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, ui.is_enabled(), chosen, name));
    let style = ui.style().interact_selectable(&response, chosen);
    let fill = if chosen { style.bg_fill } else { style.weak_bg_fill };
    ui.painter().rect(rect, 5.0, fill, style.bg_stroke, egui::StrokeKind::Inside);
    let line: Vec<Pos2> = (0..=40)
        .map(|i| {
            let x = i as f32 / 40.0;
            let d = (x - 0.5) * 2.0;
            let y = match kind {
                BrushKind::Smooth => 0.18 * (-d * d * 3.0).exp() + 0.06 * (d * 22.0).sin() * d * d,
                _ => (-d * d * 12.5).exp() * 0.8,
            };
            Pos2::new(rect.left() + 10.0 + x * (rect.width() - 20.0), rect.top() + 27.0 - y * 20.0)
        })
        .collect();
    let ink = if chosen { style.fg_stroke.color } else { theme::accent(ui) };
    ui.painter().add(egui::Shape::line(line, Stroke::new(2.0, ink)));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let at = rect.center_bottom() - vec2(0.0, 3.0);
    let colour: Color32 = style.fg_stroke.color;
    ui.painter().text(at, egui::Align2::CENTER_BOTTOM, name, font, colour);
    response
}
