//! Pictures of the clay without the panels: a screenshot, or a whole turn of it, a frame at a time
//! so that the window stays alive.

use std::path::PathBuf;

use super::objects::{self, Stance};
use super::picture::paint;
use super::renderer::{Beside, Scene};
use super::state::WindowState;
use super::tasks::free_name;
use super::turntable::Turntable;
use crate::language::tr;
use sculptd_daemon::Published;
use sculptd_engine::camera::Camera;

/// Returns the folder of screenshots.
fn folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|d| d.picture_dir().map(PathBuf::from))
        .filter(|d| d.is_dir())
        .unwrap_or_default()
}

impl WindowState {
    pub(super) fn begin_turntable(&mut self) {
        let folder = free_name(&folder(), "sculptd-turntable", "");
        match std::fs::create_dir_all(&folder) {
            Ok(()) => {
                let frames = self.ui_state.files.frames.max(1);
                self.turning = Some(Turntable { folder, frames, next: 0, from: self.camera });
            }
            Err(e) => {
                let path = folder.display().to_string();
                self.ui_state.say(tr!("task-failed", path = path, error = e.to_string()), true);
            }
        }
    }

    /// Takes the pictures that are due: at most one a frame.
    pub(super) fn shots(&mut self, state: &Published) {
        if std::mem::take(&mut self.screenshot) {
            let path = free_name(&folder(), "sculptd", ".png");
            let camera = self.camera;
            self.shot(state, camera, path, false);
        }
        let Some(t) = &mut self.turning else { return };
        let turn = t.next as f32 / t.frames as f32 * std::f32::consts::TAU;
        let camera =
            Camera { yaw: (t.from.yaw + turn).rem_euclid(std::f32::consts::TAU), ..t.from };
        let path = t.folder.join(format!("frame-{:03}.png", t.next));
        t.next += 1;
        if t.next == t.frames {
            let folder = t.folder.display().to_string();
            let said = tr!("task-frames", frames = t.frames, folder = folder);
            self.turning = None;
            self.ui_state.say(said, false);
        }
        self.shot(state, camera, path, true);
        self.pacing.want();
    }

    fn shot(&mut self, state: &Published, camera: Camera, path: PathBuf, quiet: bool) {
        let (_, size) = self.view_rect();
        let (width, height) = (size.x as u32, size.y as u32);
        let others = objects::others(state);
        let scene = Scene {
            mesh: &state.mesh,
            camera: &camera,
            brush: None,
            lines: &[],
            look: self.ui_state.look,
            values: super::clay_frame::shown(
                &self.ui_state,
                [&self.values, &self.distances, &self.wall_changes],
            ),
            beside: Beside { stance: Stance::of(state), others: &others, ..Beside::default() },
        };
        match paint(&self.gpu, &mut self.renderer, &scene, width, height) {
            Ok(picture) => self.tasks.picture(path, picture, quiet),
            Err(e) => self.ui_state.say(e.to_string(), true),
        }
    }
}
