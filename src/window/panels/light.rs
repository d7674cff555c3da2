//! What lights the clay: materials drawn by formula, a person's own pictures of lit balls and of
//! surroundings, and a reference picture.

use super::rows;
use super::state::{Action, UiState, View};
use crate::language::tr;
use crate::look::{Light, MATERIALS};

/// Points along a side of a material's button, and of a picture in it.
const BUTTON: f32 = 24.0;

/// One button of a row of balls; `paint` draws what is in it.
fn ball(
    ui: &mut egui::Ui,
    name: &str,
    chosen: bool,
    paint: impl FnOnce(&egui::Ui, egui::Rect),
) -> bool {
    let (rect, response) = ui.allocate_exact_size(egui::Vec2::splat(BUTTON), egui::Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, chosen, name));
    paint(ui, rect);
    if chosen || response.hovered() || response.has_focus() {
        let stroke = egui::Stroke::new(2.0, ui.visuals().text_color());
        ui.painter().circle_stroke(rect.center(), 11.0, stroke);
    }
    response.on_hover_text(name).clicked()
}

/// The materials and the person's own lit balls.
pub fn materials(ui: &mut egui::Ui, ui_state: &mut UiState) {
    let UiState { look, prefs, light, .. } = ui_state;
    let by_picture = look.light == Light::Matcap;
    ui.strong(tr!("look-material"));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (i, m) in MATERIALS.iter().enumerate() {
            let [r, g, b] = m.base.map(|c| (c.powf(1.0 / 2.2) * 255.0) as u8);
            let chosen = !by_picture && look.material == i;
            let pressed = ball(ui, &tr!(m.name), chosen, |ui, rect| {
                let painter = ui.painter();
                painter.circle_filled(rect.center(), 10.0, egui::Color32::from_rgb(r, g, b));
                let shine = rect.center() - egui::vec2(4.0, 4.0);
                painter.circle_filled(shine, 2.5, egui::Color32::from_white_alpha(110));
            });
            if pressed {
                look.material = i;
                if by_picture {
                    look.light = Light::Studio;
                }
            }
        }
        for (name, picture) in &light.matcaps {
            let chosen = by_picture && prefs.matcap == *name;
            let pressed = ball(ui, name, chosen, |ui, rect| {
                let round = egui::Image::new(picture).corner_radius(11);
                round.paint_at(ui, rect.shrink(2.0));
            });
            if pressed {
                look.light = Light::Matcap;
                prefs.matcap.clone_from(name);
            }
        }
    });
}

/// The name of what lights the clay.
fn title(light: Light, environment: &str) -> String {
    match light {
        Light::Studio => tr!("light-studio"),
        Light::Room => tr!("light-room"),
        Light::Environment => environment.to_owned(),
        Light::Matcap => tr!("light-matcap"),
    }
}

/// Lights and surroundings.
pub fn lights(ui: &mut egui::Ui, ui_state: &mut UiState, view: &View<'_>) {
    let UiState { look, prefs, light, .. } = ui_state;
    let now = title(look.light, &prefs.environment);
    rows::list(ui, &tr!("light-name"), now, |ui| {
        for one in [Light::Studio, Light::Room] {
            ui.selectable_value(&mut look.light, one, title(one, ""));
        }
        for name in &light.environments {
            let chosen = look.light == Light::Environment && prefs.environment == *name;
            if ui.selectable_label(chosen, name).clicked() {
                look.light = Light::Environment;
                prefs.environment.clone_from(name);
            }
        }
    })
    .on_hover_text(tr!("light-name.tip"));
    if look.light != Light::Matcap {
        let turned = egui::Slider::new(&mut look.turned, -180.0..=180.0).suffix("°");
        rows::slider(ui, turned, &tr!("light-turned"));
    }
    if look.light == Light::Studio {
        let raised = egui::Slider::new(&mut look.raised, -20.0..=90.0).suffix("°");
        rows::slider(ui, raised, &tr!("light-raised"));
        let shadow = egui::Slider::new(&mut look.shadow, 0.0..=1.0);
        rows::slider(ui, shadow, &tr!("light-shadow"))
            .on_hover_text(tr!("light-shadow.tip", action = view.tip(Action::Shadows)));
    }
    if look.light.is_around() {
        let bright = egui::Slider::new(&mut look.bright, 0.1..=4.0).logarithmic(true);
        rows::slider(ui, bright, &tr!("light-bright"));
    }
}

/// A picture to look at while one sculpts.
pub fn reference(ui: &mut egui::Ui, ui_state: &mut UiState) {
    let (shown, offered) = (&mut ui_state.prefs.reference, &ui_state.light.references);
    let none = tr!("reference-none");
    let now = if shown.file.is_empty() { none.clone() } else { shown.file.clone() };
    rows::list(ui, &tr!("reference-name"), now, |ui| {
        ui.selectable_value(&mut shown.file, String::new(), none);
        for name in offered {
            ui.selectable_value(&mut shown.file, name.clone(), name);
        }
    })
    .on_hover_text(tr!("reference-name.tip"));
    if !shown.file.is_empty() {
        ui.checkbox(&mut shown.behind, tr!("reference-behind"));
        let opacity = egui::Slider::new(&mut shown.opacity, 0.05..=1.0);
        rows::slider(ui, opacity, &tr!("reference-opacity"));
    }
}

/// The reference picture beside the clay, in a window that is dragged and sized; its title closes
/// it.
pub fn beside(ctx: &egui::Context, ui_state: &mut UiState, free: egui::Rect) {
    let UiState { prefs, light, .. } = ui_state;
    let Some(picture) = &light.reference else { return };
    if prefs.reference.file.is_empty() || prefs.reference.behind {
        return;
    }
    let mut open = true;
    let natural = picture.size_vec2();
    let width = (free.width() * 0.35).min(natural.x).max(80.0);
    let tint = egui::Color32::WHITE.gamma_multiply(prefs.reference.opacity.clamp(0.05, 1.0));
    egui::Window::new(prefs.reference.file.clone())
        .id(egui::Id::unique("reference"))
        .open(&mut open)
        .default_pos(free.left_top() + egui::vec2(12.0, 12.0))
        .default_width(width)
        .constrain_to(free)
        .show(ctx, |ui| {
            let width = ui.available_width();
            let size = egui::vec2(width, width * natural.y / natural.x.max(1.0));
            ui.add(egui::Image::new((picture.id(), size)).tint(tint));
        });
    if !open {
        prefs.reference.file.clear();
    }
}
