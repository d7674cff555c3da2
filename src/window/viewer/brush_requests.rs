//! What the panel of the brush asks of the window: a colour of the surface, and a brush that is
//! saved.

use std::path::PathBuf;
use std::sync::Arc;

use arc_swap::ArcSwap;
use glam::Vec2;

use super::state::WindowState;
use super::tasks::{TaskReport, Tasks, thread};
use super::wiring::Wiring;
use crate::language::tr;
use sculptd_clay::brush::own_brush::preset_number;
use sculptd_clay::brush::{Alpha, BrushSettings};
use sculptd_daemon::Published;
use sculptd_daemon::brush_folder::{self, SavedBrush};
use sculptd_daemon::command_queue::CommandSender;
use sculptd_engine::command::Command;

impl WindowState {
    /// Gives the brush the colour of the surface that is seen at a place of the window, points.
    pub(super) fn sample_colour(&mut self, at: egui::Pos2, state: &Published, wiring: &Wiring) {
        let at = Vec2::new(at.x, at.y) * self.egui.egui_ctx().pixels_per_point();
        let ray = self.camera.ray(self.view_point(at));
        match state.pick(ray) {
            Some(hit) => {
                let colour = state.mesh.colour_at(&hit);
                let brush = BrushSettings { colour, ..state.brush };
                let _ = wiring.commands.try_send(Command::Brush(brush));
            }
            None => self.ui_state.say(tr!("colour-nothing"), false),
        }
    }
}

impl Tasks {
    /// Saves the brush in hand as one of the person's own, which it then is.
    pub(super) fn save_brush(
        &mut self,
        (folder, name, replace): (PathBuf, String, bool),
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let say = self.say.clone();
        thread("sculptd-brush", move || {
            let state = shown.load_full();
            let brush = state.brush;
            let pressed = state.picture.as_ref().filter(|_| brush.alpha == Alpha::Picture);
            let saved = pressed.map(|p| p.encode()).transpose().and_then(|bytes| {
                let picture = bytes.as_deref().map(|bytes| ("png", bytes));
                let saved = SavedBrush { name: &name, picture, replace, ..SavedBrush::default() };
                brush_folder::save(&folder, &brush, &saved)
            });
            let report = match saved {
                Ok(_) => {
                    let preset = preset_number(&name);
                    let _ = commands.try_send(Command::Brush(BrushSettings { preset, ..brush }));
                    TaskReport::Message(tr!("task-brush-saved", name = name), false)
                }
                Err(e) => TaskReport::Message(tr!("task-brush-not-saved", error = e), true),
            };
            let _ = say.send(report);
        });
    }
}
