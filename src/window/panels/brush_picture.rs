//! The pictures of the brushes: the stroke of each, drawn by the program
//! (`every_brush_looks_as_it_did` in `tests/it/brushes`), one behind the other in one file.

use egui::{ColorImage, Rect, TextureHandle, TextureOptions, pos2, vec2};
use sculptd_clay::brush::BrushKind;

/// The file: [`COLUMNS`] pictures a row, in the order of [`BrushKind::ALL`].
const FILE: &[u8] = include_bytes!("brush_pictures.png");
const COLUMNS: usize = 6;

/// The pictures of all brushes, for the card.
pub fn load(ctx: &egui::Context) -> TextureHandle {
    let decoded = image::load_from_memory_with_format(FILE, image::ImageFormat::Png);
    let image = decoded.map_or_else(
        |_| ColorImage::filled([1, 1], egui::Color32::GRAY),
        |picture| {
            let rgb = picture.into_rgb8();
            let size = [rgb.width() as usize, rgb.height() as usize];
            ColorImage::from_rgb(size, rgb.as_raw())
        },
    );
    ctx.load_texture("brushes", image, TextureOptions::LINEAR)
}

/// Paints the picture of a brush; `round`: the radius of its corners, points.
pub fn paint(ui: &egui::Ui, all: &TextureHandle, kind: BrushKind, rect: Rect, round: u8) {
    let place = BrushKind::ALL.iter().position(|k| *k == kind).unwrap_or(0);
    let rows = BrushKind::ALL.len().div_ceil(COLUMNS);
    let size = vec2(1.0 / COLUMNS as f32, 1.0 / rows as f32);
    let first = pos2((place % COLUMNS) as f32 * size.x, (place / COLUMNS) as f32 * size.y);
    let image = egui::Image::new(all).uv(Rect::from_min_size(first, size));
    image.corner_radius(round).paint_at(ui, rect);
}
