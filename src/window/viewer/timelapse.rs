//! A session as a film: a picture of the clay every so many ticks while it is replayed.

use std::path::{Path, PathBuf};

use super::picture::{Painter, write_png};
use super::renderer::Scene;
use crate::look::Look;
use sculptd_engine::camera::Camera;
use sculptd_engine::world::World;

/// Pictures of one replay.
#[derive(Debug)]
pub struct Timelapse {
    painter: Painter,
    folder: PathBuf,
    every: u64,
    size: (u32, u32),
    next: u64,
    /// Pictures written.
    pub frames: u32,
}

impl Timelapse {
    /// A picture of `size` pixels every `every` ticks, as `frame-00000.png`, ... in `folder`, which
    /// is made.
    pub fn new(folder: &Path, every: u64, size: (u32, u32)) -> Result<Timelapse, String> {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let painter = Painter::new().map_err(|e| e.to_string())?;
        Ok(Timelapse {
            painter,
            folder: folder.into(),
            every: every.max(1),
            size,
            next: 0,
            frames: 0,
        })
    }

    /// Takes the pictures that are due: one for every step of time, also where nothing happened, so
    /// that time runs evenly.
    pub fn see(&mut self, tick: u64, world: &mut World) -> Result<(), String> {
        if tick < self.next {
            return Ok(());
        }
        let snapshot = world.snapshot();
        let aspect = self.size.0 as f32 / self.size.1 as f32;
        let camera = Camera { aspect, ..*world.camera() };
        let scene = Scene {
            mesh: &snapshot,
            camera: &camera,
            brush: None,
            lines: &[],
            look: Look::default(),
            values: None,
            beside: Default::default(),
        };
        let picture =
            self.painter.paint(&scene, self.size.0, self.size.1).map_err(|e| e.to_string())?;
        while self.next <= tick {
            let path = self.folder.join(format!("frame-{:05}.png", self.frames));
            write_png(&path, &picture).map_err(|e| format!("{}: {e}", path.display()))?;
            self.frames += 1;
            self.next += self.every;
        }
        Ok(())
    }
}
