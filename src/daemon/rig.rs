//! Putting a world together: the work, the settings, the workers.

use std::path::Path;

use crate::analysis::cancel::Job;
use crate::config::Config;
use crate::devices::queue::Sender;
use crate::devices::recording::Player;
use crate::mesh::io::{ReadError, read_mesh};
use crate::mesh::{BuildError, Mesh, TriMesh, Workers, shapes};
use crate::world::{World, WorldOptions};

use super::stepped::Feed;

/// The work that one starts with: a ball of this many vertices, fine enough for detail, light on any machine.
pub const START_VERTICES: usize = 160_000;

#[derive(Debug, thiserror::Error)]
pub enum RigError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("{path}: {source}")]
    Build { path: String, source: BuildError },
}

/// A work as it was loaded.
#[derive(Debug)]
pub struct Loaded {
    pub plain: TriMesh,
    pub mesh: Mesh,
    pub warnings: Vec<String>,
}

/// Reads a work from a file, or makes the ball that a session starts with.
pub fn load(path: Option<&Path>, job: &Job) -> Result<Loaded, RigError> {
    let (plain, mut warnings, name) = match path {
        Some(path) => {
            let loaded = read_mesh(path, job)?;
            let (plain, _) = loaded.mesh.triangulate();
            (plain, loaded.warnings, path.display().to_string())
        }
        None => (shapes::sphere_of_about(START_VERTICES), vec![], "the start ball".into()),
    };
    let mesh = Mesh::build(&plain, job).map_err(|source| RigError::Build { path: name, source })?;
    warnings.extend(mesh.warnings().iter().cloned());
    Ok(Loaded { plain, mesh, warnings })
}

/// The world of a fresh session.
pub fn world(mesh: Mesh, config: &Config) -> World {
    let options = WorldOptions { dab_budget: config.r#loop.dab_budget, undo_bytes: config.undo.bytes };
    let workers = Workers::new(config.r#loop.worker_count());
    World::new(mesh, config.camera.camera(), config.brush, workers, options)
}

/// A recording, fed through its parser into the channel.
#[derive(Debug)]
pub struct RecordingFeed {
    player: Player,
    sender: Sender,
    sent: u64,
}

impl RecordingFeed {
    pub fn new(player: Player, sender: Sender) -> Self {
        RecordingFeed { player, sender, sent: 0 }
    }
}

impl Feed for RecordingFeed {
    fn advance(&mut self, until_us: u64) -> u64 {
        let (sender, sent) = (&mut self.sender, &mut self.sent);
        self.player.advance(until_us, &mut |sample| {
            sender.push(sample);
            *sent += 1;
        });
        sender.flush();
        *sent
    }

    fn finished(&self) -> bool {
        self.player.finished()
    }
}
