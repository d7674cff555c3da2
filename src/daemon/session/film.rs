//! A session as a film where there is no GPU: a picture every so many ticks while it is replayed,
//! drawn on the CPU, in parallel projection.

use std::path::{Path, PathBuf};

use sculptd_engine::world::World;
use sculptd_geometry::io::write_beside;
use sculptd_geometry::picture::{Camera, draw};

/// Pictures of one replay. The same session gives the same bytes on every machine of one kind.
#[derive(Debug)]
pub struct ReplayFrames {
    folder: PathBuf,
    every: u64,
    size: (u32, u32),
    next: u64,
    /// Pictures written.
    pub frames: u32,
}

impl ReplayFrames {
    /// A picture of `size` pixels every `every` ticks, as `frame-00000.png`, ... in `folder`, which
    /// is made.
    ///
    /// # Errors
    /// In words, where the folder cannot be made.
    pub fn new(folder: &Path, every: u64, size: (u32, u32)) -> Result<ReplayFrames, String> {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        Ok(ReplayFrames { folder: folder.into(), every: every.max(1), size, next: 0, frames: 0 })
    }

    /// Takes the pictures that are due: one for every step of time, also where nothing happened, so
    /// that time runs evenly.
    ///
    /// # Errors
    /// In words, where a picture cannot be written.
    pub fn see(&mut self, tick: u64, world: &World) -> Result<(), String> {
        if tick < self.next {
            return Ok(());
        }
        let now = world.camera();
        let camera = Camera {
            target: now.target,
            towards_eye: now.backward(),
            up: glam::Vec3::Y,
            // Half the height of the view, at the distance of its pivot.
            half_height: now.world_per_view(now.distance) * 0.5,
        };
        let plain = world.mesh().to_tri();
        let colours: Option<Vec<[u8; 3]>> =
            plain.colours.as_ref().map(|all| all.iter().map(|c| [c[0], c[1], c[2]]).collect());
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let png = draw(&plain, colours.as_deref(), &camera, width, height)
            .png()
            .map_err(|e| e.to_string())?;
        while self.next <= tick {
            let path = self.folder.join(format!("frame-{:05}.png", self.frames));
            write_beside(&path, |out| out.write_all(&png))
                .map_err(|e| format!("{}: {e}", path.display()))?;
            self.frames += 1;
            self.next += self.every;
        }
        Ok(())
    }
}
