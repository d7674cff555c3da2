//! Colours and sizes of the panels.

use egui::{Color32, Visuals};

/// Quiet greys that leave the clay the strongest colour of the screen; text at least 7:1 on its ground.
pub fn apply(ctx: &egui::Context) {
    let mut v = Visuals::dark();
    v.panel_fill = Color32::from_rgb(27, 29, 34);
    v.window_fill = Color32::from_rgb(32, 34, 40);
    v.override_text_color = Some(Color32::from_rgb(226, 228, 232));
    v.selection.bg_fill = Color32::from_rgb(160, 92, 62);
    v.widgets.inactive.weak_bg_fill = Color32::from_rgb(48, 51, 59);
    v.widgets.inactive.bg_fill = Color32::from_rgb(58, 61, 70);
    ctx.set_visuals(v);
}

/// Text that explains, still 4.5:1 on the panel.
pub const QUIET: Color32 = Color32::from_rgb(164, 168, 178);
