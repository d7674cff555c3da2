//! Colours and sizes of the panels.

use egui::{Color32, CornerRadius, Stroke, TextStyle, Visuals};

/// The sizes of text, points: there are no others but those that a drawn label needs.
const TYPE_SCALE: [(TextStyle, f32); 5] = [
    (TextStyle::Heading, 16.0),
    (TextStyle::Body, 13.0),
    (TextStyle::Button, 13.0),
    (TextStyle::Monospace, 12.0),
    (TextStyle::Small, 11.0),
];

/// Quiet greys that leave the clay the strongest colour of the screen; text at least 4.5:1 on its
/// ground, held by a test.
pub fn apply(ctx: &egui::Context, light: bool) {
    let grey = |v: u8| Color32::from_rgb(v, v.saturating_add(1), v.saturating_add(5));
    let mut v = if light { Visuals::light() } else { Visuals::dark() };
    let tone = |dark: u8, pale: u8| grey(if light { pale } else { dark });
    v.panel_fill = tone(27, 240);
    v.window_fill = tone(32, 246);
    v.extreme_bg_color = tone(18, 250);
    v.faint_bg_color = tone(35, 232);
    v.override_text_color = None;
    v.selection.bg_fill =
        if light { Color32::from_rgb(236, 190, 164) } else { Color32::from_rgb(140, 76, 48) };
    v.selection.stroke = Stroke::new(1.0, tone(250, 10));
    v.weak_text_color = Some(quiet_of(light));
    v.hyperlink_color =
        if light { Color32::from_rgb(20, 80, 150) } else { Color32::from_rgb(140, 190, 255) };
    let w = &mut v.widgets;
    let text = tone(226, 24);
    for (state, fill, weak) in [
        (&mut w.noninteractive, tone(27, 240), tone(27, 240)),
        (&mut w.inactive, tone(60, 206), tone(48, 220)),
        (&mut w.hovered, tone(74, 196), tone(64, 208)),
        (&mut w.active, tone(88, 184), tone(80, 196)),
        (&mut w.open, tone(54, 214), tone(44, 224)),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = weak;
        state.fg_stroke = Stroke::new(1.0, text);
        state.corner_radius = CornerRadius::same(4);
    }
    w.noninteractive.bg_stroke = Stroke::new(1.0, tone(48, 210));
    ctx.set_visuals(v);
    ctx.global_style_mut(|s| {
        s.spacing.slider_width = 92.0;
        s.spacing.item_spacing = egui::vec2(8.0, 4.0);
        s.spacing.button_padding = egui::vec2(8.0, 2.0);
        s.spacing.interact_size = egui::vec2(40.0, 22.0);
        s.interaction.tooltip_delay = 0.4;
        for (style, size) in TYPE_SCALE {
            if let Some(font) = s.text_styles.get_mut(&style) {
                font.size = size;
            }
        }
    });
}

/// For a screen in a hall: text at least 7:1 on its ground.
pub fn clear(ctx: &egui::Context) {
    let dark = ctx.global_style().visuals.dark_mode;
    ctx.global_style_mut(|s| {
        let v = &mut s.visuals;
        v.weak_text_color = Some(Color32::from_gray(if dark { 196 } else { 68 }));
        if dark {
            v.selection.bg_fill = Color32::from_rgb(112, 58, 34);
        }
    });
}

/// For people who see little: white on black, outlines of two points, what is chosen in yellow.
pub fn strong(ctx: &egui::Context) {
    let mut v = Visuals::dark();
    (v.panel_fill, v.window_fill, v.extreme_bg_color) =
        (Color32::BLACK, Color32::BLACK, Color32::BLACK);
    v.override_text_color = None;
    v.selection.bg_fill = Color32::from_rgb(255, 221, 0);
    v.selection.stroke = Stroke::new(2.0, Color32::BLACK);
    v.window_stroke = Stroke::new(2.0, Color32::WHITE);
    let w = &mut v.widgets;
    for state in
        [&mut w.noninteractive, &mut w.inactive, &mut w.hovered, &mut w.active, &mut w.open]
    {
        (state.bg_fill, state.weak_bg_fill) = (Color32::BLACK, Color32::BLACK);
        state.bg_stroke = Stroke::new(2.0, Color32::WHITE);
        state.fg_stroke = Stroke::new(2.0, Color32::WHITE);
    }
    ctx.set_visuals(v);
}

fn quiet_of(light: bool) -> Color32 {
    if light { Color32::from_rgb(84, 88, 98) } else { Color32::from_rgb(164, 168, 178) }
}

/// Text that explains, still 4.5:1 on the panel.
pub fn quiet(ui: &egui::Ui) -> Color32 {
    quiet_of(!ui.visuals().dark_mode)
}

/// Controls that cannot be pressed now.
pub fn faint(ui: &egui::Ui) -> Color32 {
    quiet(ui).gamma_multiply(if ui.visuals().dark_mode { 0.58 } else { 0.7 })
}

/// Something is wrong.
pub fn alarm(ui: &egui::Ui) -> Color32 {
    if ui.visuals().dark_mode {
        Color32::from_rgb(255, 150, 120)
    } else {
        Color32::from_rgb(160, 40, 16)
    }
}

/// The accent of curves and live values.
pub fn accent(ui: &egui::Ui) -> Color32 {
    accent_of(ui.visuals().dark_mode)
}

/// The same on dark or on light panels.
pub fn accent_of(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(224, 140, 96) } else { Color32::from_rgb(170, 84, 44) }
}
