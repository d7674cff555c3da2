//! A QR code as squares, dark on white whatever the theme is.

use egui::{Color32, Rect, Sense, Vec2, vec2};

use sculptd_daemon::qr_code::Code;

/// Draws a code about `side` points wide. A reader needs squares of four points at least.
pub fn ui(ui: &mut egui::Ui, code: &Code, side: f32) {
    // Four squares of quiet on each side, as the standard asks.
    let squares = code.side + 8;
    let square = (side / squares as f32).floor().max(4.0);
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(square * squares as f32), Sense::hover());
    let paint = ui.painter();
    paint.rect_filled(rect, 0.0, Color32::WHITE);
    for (i, _) in code.dark.iter().enumerate().filter(|(_, dark)| **dark) {
        let (x, y) = (i % code.side + 4, i / code.side + 4);
        let min = rect.min + vec2(x as f32, y as f32) * square;
        let one = Rect::from_min_size(min, Vec2::splat(square));
        paint.rect_filled(one, 0.0, Color32::BLACK);
    }
}
