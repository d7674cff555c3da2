//! What a checkpoint is made of.

use std::sync::Arc;

use sculptd_clay::Snapshot;
use sculptd_engine::scene::SceneView;
use sculptd_engine::world::{Saved, World};

/// The world's state, and the live sculpture that an opening must give again.
#[derive(Debug)]
pub struct WorldAtRest {
    pub saved: Saved,
    pub scene: Arc<SceneView>,
    pub active: Snapshot,
}

impl WorldAtRest {
    /// Returns nothing while a stroke or an edit is under way.
    pub fn of(world: &mut World) -> Option<WorldAtRest> {
        let saved = world.save()?;
        Some(WorldAtRest { saved, scene: world.scene_view(), active: world.snapshot() })
    }
}
