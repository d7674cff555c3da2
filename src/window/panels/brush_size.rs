//! The radius of the brush, in the scene's unit or in pixels of the screen.

use glam::Vec2;

use super::rows;
use super::state::{Action, UiState, View};
use crate::language::tr;
use sculptd_clay::brush::BrushSettings;

/// The least and the greatest radius of the slider, as [`BrushSettings::radius`] counts them.
const RANGE: [f32; 2] = [0.005, 1.0];

/// Points beside the bar of the slider: a number with its unit, and the gaps.
const NUMBER: f32 = 88.0;

/// World units of one pixel on the surface under the pointer, or else in the middle of the view, or
/// else where the view turns about; 0 where that is not known. Measured while the view moves: a
/// pointer that goes to what is further away leaves the brush as large as it is.
fn unit_a_pixel(ctx: &egui::Context, view: &View<'_>, ui_state: &mut UiState) -> f32 {
    let panel = &mut ui_state.brush_panel;
    let Some(free) = panel.free.filter(|free| free.is_positive()) else { return 0.0 };
    let (camera, pixels) = (&view.camera, free.height() * ctx.pixels_per_point());
    panel.screen.scale(camera, pixels, || {
        let pointer = ctx.input(|i| i.pointer.latest_pos()).filter(|at| free.contains(*at));
        let depth = [pointer, Some(free.center())].into_iter().flatten().find_map(|at| {
            let share = (at - free.min) / free.size();
            let hit = view.state.pick(camera.ray(Vec2::new(share.x, share.y)))?;
            Some((camera.eye() - hit.position).dot(camera.backward()))
        });
        camera.world_per_view(depth.unwrap_or(camera.distance)) / pixels
    })
}

/// World units of a radius of 1, as [`BrushSettings::radius`] counts them.
fn unit_of_setting(view: &View<'_>) -> f32 {
    let one = view.state.brush_radius / view.state.brush.radius;
    if one.is_finite() && one > 0.0 { one } else { 1.0 }
}

/// Returns a radius as text, with its unit.
pub fn radius_text(
    ctx: &egui::Context,
    view: &View<'_>,
    ui_state: &mut UiState,
    setting: f32,
) -> String {
    let world = setting * unit_of_setting(view);
    let pixel = unit_a_pixel(ctx, view, ui_state);
    match ui_state.prefs.brushes.radius_in_pixels && pixel > 0.0 {
        true => format!("{:.0} {}", world / pixel, tr!("unit-pixel")),
        false => format!("{world:.3} {}", tr!("unit-mm")),
    }
}

/// Shows the slider and its unit. While the radius is in pixels, a zoom changes it on the object.
pub fn radius(
    ui: &mut egui::Ui,
    view: &View<'_>,
    ui_state: &mut UiState,
    brush: &mut BrushSettings,
) {
    let (one, pixel) = (unit_of_setting(view), unit_a_pixel(ui.ctx(), view, ui_state));
    let in_pixels = ui_state.prefs.brushes.radius_in_pixels && pixel > 0.0;
    let time = ui.input(|i| i.time);
    if in_pixels && ui_state.modal.is_none() {
        let screen = &mut ui_state.brush_panel.screen;
        if let Some(world) = screen.follow(view.state.brush_radius, pixel, time) {
            brush.radius = world / one;
            // Looked at once more when the answer has come.
            ui.ctx().request_repaint();
        }
    } else {
        ui_state.brush_panel.screen = Default::default();
    }
    let unit = if in_pixels { pixel } else { 1.0 };
    let name = if in_pixels { tr!("unit-pixel") } else { tr!("unit-mm") };
    let mut value = brush.radius * one / unit;
    let range = RANGE.map(|r| r * one / unit);
    let slider = egui::Slider::new(&mut value, range[0]..=range[1]);
    let slider = slider.logarithmic(true).clamping(egui::SliderClamping::Edits);
    let slider = slider.max_decimals(if in_pixels { 0 } else { 3 }).suffix(format!(" {name}"));
    let keys = view.both(Action::Smaller, Action::Larger);
    let drag = view.keys.text(Action::DragRadius);
    let response = rows::slider_beside(ui, slider, &tr!("brush-radius"), NUMBER);
    if response.changed() {
        brush.radius = value * unit / one;
        ui_state.brush_panel.screen.set(value * unit, unit, time);
    }
    response.on_hover_text(tr!("brush-radius.tip", keys = keys, drag = drag));
}
