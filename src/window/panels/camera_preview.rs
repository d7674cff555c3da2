//! What the camera that watches hands sees, as in a mirror, with the skeleton over it.

use std::sync::Arc;

use super::theme;
use crate::language::tr;
use sculptd_camera::camera_thread::CameraPreview;
use sculptd_camera::skeleton::BONES;

/// Width of the picture, points.
const WIDTH: f32 = 230.0;
/// Confidence below which a hand is drawn faint, because its tool has little force.
const CLEAR: f32 = 0.4;

/// The texture and the picture that it shows.
type ShownPicture = (usize, egui::TextureHandle);

pub fn ui(ui: &mut egui::Ui, preview: &Arc<CameraPreview>) {
    let picture = &preview.picture;
    if picture.width == 0 || picture.height == 0 {
        return;
    }
    ui.add_space(8.0);
    ui.strong(tr!("devices-camera"));
    let (key, address) = (egui::Id::unique("camera-preview"), Arc::as_ptr(preview) as usize);
    let known: Option<ShownPicture> = ui.data(|d| d.get_temp(key));
    let texture = match known.filter(|(shown, _)| *shown == address) {
        Some((_, texture)) => texture,
        None => {
            let image = egui::ColorImage::from_rgb([picture.width, picture.height], &picture.rgb);
            let texture = ui.ctx().load_texture(String::new(), image, egui::TextureOptions::LINEAR);
            ui.data_mut(|d| d.insert_temp(key, (address, texture.clone())));
            texture
        }
    };
    let size = egui::vec2(WIDTH, WIDTH * picture.height as f32 / picture.width as f32);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let mirrored = egui::Rect::from_min_max(egui::pos2(1.0, 0.0), egui::pos2(0.0, 1.0));
    let painter = ui.painter_at(rect);
    painter.image(texture.id(), rect, mirrored, egui::Color32::WHITE);
    for (joints, confidence) in preview.view.joints.iter().zip(preview.view.confidence) {
        let Some(joints) = joints else { continue };
        let at =
            |i: usize| rect.min + egui::vec2((1.0 - joints[i].x) * size.x, joints[i].y * size.y);
        let alpha = if confidence < CLEAR { 90 } else { 255 };
        let bone = egui::Color32::from_rgba_unmultiplied(90, 220, 160, alpha);
        for (a, b) in BONES {
            painter.line_segment([at(a), at(b)], egui::Stroke::new(1.5, bone));
        }
        for i in 0..joints.len() {
            painter.circle_filled(at(i), 2.0, bone);
        }
    }
    ui.label(preview.view.advice.text());
    ui.colored_label(theme::quiet(ui), tr!("devices-camera.privacy"));
}
