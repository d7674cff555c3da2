//! What the panel of face sets holds between frames.

use sculptd_daemon::Published;
use sculptd_engine::scene::ObjectId;

/// The face sets as they were last counted, and what the next ones are made with.
#[derive(Debug)]
pub struct FaceSetPanel {
    /// The clay and its revision when they were counted.
    seen: Option<(u32, u64)>,
    /// Each with its number, its vertices, and how many of them are hidden.
    sets: Vec<(u16, u64, u64)>,
    had: Option<HadSets>,
    /// The name that is being typed for a set.
    pub renaming: Option<(u16, String)>,
    /// Angle of creases and turns that separate sets, in degrees.
    pub degrees: f32,
    /// Of what is extracted, as a share of the object's longest side; below 0 inwards.
    pub thickness: f64,
}

/// The active object when it was last looked at.
#[derive(Debug, Clone, Copy)]
struct HadSets {
    active: ObjectId,
    clay: u32,
    revision: u64,
    any: bool,
}

impl Default for FaceSetPanel {
    fn default() -> Self {
        FaceSetPanel {
            seen: None,
            sets: Vec::new(),
            had: None,
            renaming: None,
            degrees: 40.0,
            thickness: 0.02,
        }
    }
}

impl FaceSetPanel {
    /// Whether, since this was last asked, other clay without face sets has taken the place of the
    /// active object's, which had some.
    pub fn dropped(&mut self, now: &Published) -> bool {
        let Some(active) = now.scene.active().map(|o| o.id) else { return false };
        let (clay, revision) = (now.mesh.object_id(), now.mesh.revision());
        if self.had.is_some_and(|h| (h.active, h.clay, h.revision) == (active, clay, revision)) {
            return false;
        }
        let any = now.mesh.pages().any(|p| p.sets().is_some());
        let was = self.had.replace(HadSets { active, clay, revision, any });
        was.is_some_and(|w| w.active == active && w.clay != clay && w.any && !any)
    }

    /// Returns the face sets of the active object; recounts them only after a change.
    pub fn sets(&mut self, now: &Published) -> &[(u16, u64, u64)] {
        let seen = Some((now.mesh.object_id(), now.mesh.revision()));
        if self.seen != seen {
            (self.seen, self.sets) = (seen, now.mesh.face_sets());
        }
        &self.sets
    }
}
