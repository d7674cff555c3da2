//! The labels of the hands' menu, and the ring that closes while a fingertip stays in an item. The
//! items themselves are balls in the world.

use egui::{Color32, FontId, Rect, Stroke, pos2, vec2};
use glam::Vec3;

use super::state::View;
use crate::language::tr;
use sculptd_daemon::Published;
use sculptd_engine::hand::MenuItem;
use sculptd_engine::hand::menu::{Menu, RADIUS_MM, ball_mm};

/// An item of the menu as it is now: a ball in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MenuBall {
    pub choice: MenuItem,
    /// In the world.
    pub place: Vec3,
    pub radius: f32,
    /// A fingertip is in it, and 0 to 1 how far its ring has closed.
    pub ring: Option<f32>,
}

/// The menu's items, while there are hands to choose with.
pub fn menu_balls(state: &Published) -> Vec<MenuBall> {
    if state.hands.is_none() {
        return Vec::new();
    }
    let one = |(i, choice): (usize, &MenuItem)| MenuBall {
        choice: *choice,
        place: state.volume.to_world(ball_mm(i)),
        radius: RADIUS_MM * state.volume.scale,
        ring: state.menu.filter(|m| m.0 == i).map(|m| m.1),
    };
    Menu::choices(state.thing.is_some() || state.picking).iter().enumerate().map(one).collect()
}

/// Returns the name of an item.
pub fn title(item: MenuItem) -> String {
    tr!(match item {
        MenuItem::Add => "menu-add",
        MenuItem::Carve => "menu-carve",
        MenuItem::Keep => "menu-keep",
        MenuItem::PutAway => "menu-put-away",
        MenuItem::Ball => "menu-ball",
        MenuItem::Box => "menu-box",
        MenuItem::Cylinder => "menu-cylinder",
        MenuItem::Undo => "menu-undo",
        MenuItem::Redo => "menu-redo",
        MenuItem::PickUp => "menu-pick-up",
    })
}

pub fn ui(ctx: &egui::Context, view: &View<'_>, free: Rect) {
    let seen = |p: Vec3| view.camera.project(p).map(|v| free.lerp_inside(vec2(v.x, v.y)));
    let (right, up) = view.camera.axes();
    for ball in menu_balls(view.state) {
        let (Some(at), Some(side), Some(above)) = (
            seen(ball.place),
            seen(ball.place + right * ball.radius),
            seen(ball.place + up * ball.radius),
        ) else {
            continue;
        };
        let reach = (side - at).length().max((above - at).length());
        // The label of an item outside the view is at the border nearest to it.
        if !free.y_range().contains(at.y) {
            continue;
        }
        let below = pos2(at.x, at.y + reach + 10.0);
        let word = title(ball.choice);
        let id = egui::Id::unique(("ball", ball.choice.label()));
        let area = egui::Area::new(id).fixed_pos(at).interactable(false).constrain(false);
        area.show(ctx, |ui| {
            let v = ui.visuals();
            let (text, ground) = match ball.ring {
                Some(_) => (Color32::from_rgb(28, 18, 6), Color32::from_rgb(255, 206, 110)),
                None => (v.text_color(), v.window_fill),
            };
            let painter = ui.painter().clone().with_clip_rect(free);
            let font = FontId::proportional(13.0);
            let size = painter.layout_no_wrap(word.clone(), font.clone(), text).size();
            // Wholly in view where the item is at the side.
            let room = free.shrink2(size * 0.5 + vec2(8.0, 4.0));
            if !room.is_positive() {
                return;
            }
            let rect = Rect::from_center_size(room.clamp(below), size);
            painter.rect_filled(rect.expand2(vec2(6.0, 2.0)), 6.0, ground);
            let label = egui::RichText::new(word).font(font).color(text);
            ui.put(rect, egui::Label::new(label).selectable(false).extend());
            if let Some(ring) = ball.ring.filter(|_| free.contains(at)) {
                let corner = |k: usize| {
                    let turn = k as f32 / 48.0 * std::f32::consts::TAU;
                    at + vec2(turn.sin(), -turn.cos()) * (reach + 4.0)
                };
                let arc = (0..=(ring * 48.0).round() as usize).map(corner).collect();
                painter.add(egui::Shape::line(
                    arc,
                    Stroke::new(3.0, Color32::from_rgb(255, 206, 110)),
                ));
            }
        });
    }
}
