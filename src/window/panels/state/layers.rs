//! What the panel of layers holds between frames.

use sculptd_clay::LayerId;
use sculptd_daemon::Published;
use sculptd_engine::scene::ObjectId;

/// What a person has begun in the panel of layers and not finished.
#[derive(Debug, Default)]
pub struct LayerPanel {
    /// The name that is being typed.
    pub renaming: Option<(LayerId, String)>,
    /// The intensity that is being dragged to.
    pub dragged: Option<(LayerId, f32)>,
    /// The active object, the number of its clay and how many layers it had when it was last looked
    /// at.
    seen: Option<(ObjectId, u32, usize)>,
}

impl LayerPanel {
    /// How many layers the active object had, where other clay without any has taken the place of
    /// its own since this was last asked.
    pub fn baked(&mut self, now: &Published) -> Option<usize> {
        let count = now.mesh.layers().map_or(0, |s| s.layers.len());
        let now = (now.scene.active()?.id, now.mesh.object_id(), count);
        let (id, clay, had) = self.seen.replace(now)?;
        (id == now.0 && clay != now.1 && count == 0 && had > 0).then_some(had)
    }
}
