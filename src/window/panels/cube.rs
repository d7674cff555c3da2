//! The view cube's six sides as balls on their axes: how the object lies, and a click to look along
//! an axis.

use std::f32::consts::PI;

use egui::{Color32, Rect, Sense, Stroke, pos2, vec2};
use glam::Vec3;

use super::state::{Action, UiRequest, View, ViewKind};
use sculptd_engine::camera::Camera;
use sculptd_engine::camera::MAX_PITCH;

const RADIUS: f32 = 40.0;
const BALL: f32 = 10.0;

/// Direction, letter, what it does, colour.
const SIDES: [(Vec3, &str, Action, Color32); 6] = [
    (Vec3::X, "X", Action::Right, Color32::from_rgb(176, 48, 48)),
    (Vec3::NEG_X, "", Action::Left, Color32::from_rgb(176, 48, 48)),
    (Vec3::Y, "Y", Action::Top, Color32::from_rgb(58, 104, 24)),
    (Vec3::NEG_Y, "", Action::Bottom, Color32::from_rgb(58, 104, 24)),
    (Vec3::Z, "Z", Action::Front, Color32::from_rgb(48, 92, 184)),
    (Vec3::NEG_Z, "", Action::Back, Color32::from_rgb(48, 92, 184)),
];

/// Yaw and pitch that look along an axis, where the action is to.
pub fn side(action: Action, camera: &Camera) -> Option<(f32, f32)> {
    Some(match action {
        Action::Front => (0.0, 0.0),
        Action::Back => (PI, 0.0),
        Action::Right => (PI * 0.5, 0.0),
        Action::Left => (PI * 1.5, 0.0),
        Action::Top => (camera.yaw, MAX_PITCH),
        Action::Bottom => (camera.yaw, -MAX_PITCH),
        _ => return None,
    })
}

pub fn ui(ctx: &egui::Context, view: &View<'_>, free: Rect, out: &mut Vec<UiRequest>) {
    if free.width() < 150.0 || free.height() < 200.0 {
        return;
    }
    // In the corner of the view that turns.
    let free_camera = view.views.camera(ViewKind::Free, &view.camera);
    let camera = if view.views.are_four() { free_camera } else { view.camera };
    let (right, up) = camera.axes();
    let back = camera.backward();
    let corner = pos2(free.right() - 2.0 * RADIUS - 30.0, free.top() + 8.0);
    let area = egui::Area::new(egui::Id::unique("cube")).fixed_pos(corner).movable(false);
    area.show(ctx, |ui| {
        let size = 2.0 * (RADIUS + BALL);
        let (rect, _) = ui.allocate_exact_size(vec2(size, size), Sense::hover());
        let centre = rect.center();
        let mut sides: Vec<_> = SIDES
            .iter()
            .map(|s| (s, s.0.dot(back), centre + vec2(s.0.dot(right), -s.0.dot(up)) * RADIUS))
            .collect();
        // The far ones first.
        sides.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (mut camera, mut turned) = (camera, false);
        for ((_, letter, action, colour), depth, at) in sides {
            let ball = Rect::from_center_size(at, vec2(BALL, BALL) * 2.0);
            let response = ui.interact(ball, ui.scope_id().with(action), Sense::click());
            response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, action.title())
            });
            let fade = 0.55 + 0.45 * (depth * 0.5 + 0.5);
            // Letters keep their ground; the far balls fade.
            let solid = response.hovered() || !letter.is_empty();
            let colour = colour.gamma_multiply(if solid { 1.0 } else { fade });
            if !letter.is_empty() {
                ui.painter().line_segment([centre, at], Stroke::new(2.0, colour));
                ui.painter().circle_filled(at, BALL, colour);
                let font = egui::FontId::proportional(12.0);
                ui.painter().text(at, egui::Align2::CENTER_CENTER, letter, font, Color32::WHITE);
            } else {
                ui.painter().circle_filled(at, BALL * 0.7, colour.gamma_multiply(0.5));
                ui.painter().circle_stroke(at, BALL * 0.7, Stroke::new(1.5, colour));
            }
            if response.has_focus() {
                ui.painter().circle_stroke(
                    at,
                    BALL + 1.0,
                    Stroke::new(1.5, ui.visuals().text_color()),
                );
            }
            if response.on_hover_text(view.tip(*action)).clicked() {
                (camera.yaw, camera.pitch) =
                    side(*action, &camera).unwrap_or((camera.yaw, camera.pitch));
                turned = true;
            }
        }
        if turned {
            out.push(UiRequest::Camera(camera));
        }
    });
}
