//! What the panel of layers holds between frames.

use sculptd_clay::LayerId;
use sculptd_daemon::Published;
use sculptd_engine::scene::ObjectId;

/// Unfinished input of the layer panel.
#[derive(Debug, Default)]
pub struct LayerPanel {
    /// The name that is being typed.
    pub renaming: Option<(LayerId, String)>,
    /// The intensity that is being dragged to.
    pub dragged: Option<(LayerId, f32)>,
    seen: Option<SeenLayers>,
}

/// The scene when its layers were last looked at.
#[derive(Debug, Clone, Copy)]
struct SeenLayers {
    /// The active object, the number of its clay and how many layers it had.
    active: ObjectId,
    clay: u32,
    count: usize,
    /// The newest of all objects.
    newest: ObjectId,
}

impl LayerPanel {
    /// Returns the former number of layers if the active object has lost them since the last call.
    /// It loses them when clay without layers, or a new object, replaces its clay.
    pub fn baked(&mut self, now: &Published) -> Option<usize> {
        let active = now.scene.active()?.id;
        let count = now.mesh.layers().map_or(0, |s| s.layers.len());
        let newest = now.scene.objects.iter().map(|o| o.id).max().unwrap_or(active);
        let clay = now.mesh.object_id();
        let was = self.seen.replace(SeenLayers { active, clay, count, newest })?;
        let replaced = was.active == active && was.clay != clay;
        let exchanged = now.scene.object(was.active).is_none() && active > was.newest;
        ((replaced || exchanged) && count == 0 && was.count > 0).then_some(was.count)
    }
}
