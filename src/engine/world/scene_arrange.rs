//! How objects are listed, what their face sets are called, and the results of Booleans that follow
//! their operands.

use super::World;
use super::scene_steps::SceneResult;
use crate::scene::{
    LiveBoolean, Object, ObjectId, ObjectTransform, Recomputed, ReplacedClay, SceneError,
    SceneStep, clean_name,
};
use sculptd_clay::face_sets::MOST_SETS;

impl World {
    /// Returns true while an object is being dragged: no step was made or undone since.
    pub(super) fn is_dragged(&self) -> bool {
        self.dragged.is_some_and(|d| self.timeline.newest_step() == Some(d.1))
    }

    pub(super) fn is_dragged_object(&self, id: ObjectId) -> bool {
        self.is_dragged() && self.dragged.is_some_and(|d| d.0 == id)
    }

    /// An object stands here from now on; `goes_on`: as a part of the newest step.
    pub(super) fn put_at(
        &mut self,
        id: ObjectId,
        transform: ObjectTransform,
        goes_on: bool,
    ) -> SceneResult {
        if !goes_on {
            return self.set(id, |settings| settings.transform = transform);
        }
        let object = self.scene.object_mut(id).ok_or(SceneError::NoObject(id))?;
        object.settings.transform = transform;
        Ok(id)
    }

    pub(super) fn group(&mut self, ids: &[ObjectId], name: &str) -> SceneResult {
        let name = match name {
            "" => String::new(),
            name => clean_name(name).ok_or(SceneError::Name)?,
        };
        let first = *ids.first().ok_or(SceneError::Name)?;
        if let Some(id) = ids.iter().find(|id| self.scene.object(**id).is_none()) {
            return Err(SceneError::NoObject(*id));
        }
        let mut steps = Vec::new();
        for id in ids {
            let Some(object) = self.scene.object_mut(*id) else { continue };
            if object.settings.group != name {
                steps.push(SceneStep::Set(*id, Box::new(object.settings.clone())));
                object.settings.group.clone_from(&name);
            }
        }
        if !steps.is_empty() {
            self.push(SceneStep::Group(steps));
        }
        Ok(first)
    }

    pub(super) fn name_set(&mut self, set: u16, name: &str) -> SceneResult {
        if !(1..=MOST_SETS).contains(&set) {
            return Err(SceneError::SetNumber);
        }
        let id = self.scene.active().id;
        self.unlocked(id)?;
        let name = match name {
            "" => None,
            name => Some(clean_name(name).ok_or(SceneError::Name)?),
        };
        self.set(id, |settings| {
            match name {
                Some(name) => settings.set_names.insert(set, name),
                None => settings.set_names.remove(&set),
            };
        })
    }

    /// The result of a live Boolean, computed again: a part of the step that it follows from. Where
    /// an operand has gone on meanwhile, the result says what it is of and is computed once more.
    pub(super) fn recomputed(&mut self, again: &Recomputed) -> SceneResult {
        let id = again.id;
        let object = self.scene.object(id).ok_or(SceneError::NoObject(id))?;
        if object.live().is_none_or(|l| l.result != again.live.result) {
            return Err(SceneError::NotLive(id));
        }
        let mut clays = self.take_clays(again.new.built);
        let made = self.new_object(&again.new, clays.pop())?;
        let Object { clay, middle, extent, .. } = made;
        let live = LiveBoolean { result: clay.object_id(), ..again.live.clone() };
        let mut other = Box::new(ReplacedClay { clay, middle, extent });
        let object = self.scene.object_mut(id).ok_or(SceneError::NoObject(id))?;
        other.exchange(object);
        let old = object.settings.clone();
        object.settings.live = Some(Box::new(live));
        // A difference stands where its first operand does.
        object.settings.transform = again.new.transform;
        let step = SceneStep::Group(vec![
            SceneStep::Replaced(id, other),
            SceneStep::Set(id, Box::new(old)),
        ]);
        let World { timeline, scene, garbage, options, .. } = self;
        timeline.follow(step, scene, options.undo_bytes, garbage);
        Ok(id)
    }

    /// Applies a live Boolean: keeps the result and removes its operands, unless another live
    /// result uses them.
    pub(super) fn apply_live(&mut self, id: ObjectId) -> SceneResult {
        let object = self.unlocked(id)?;
        let live = object.live().cloned().ok_or(SceneError::NotLive(id))?;
        let used = |of: ObjectId| {
            let others = self.scene.objects().iter().filter(|o| o.id != id);
            others.filter_map(Object::live).any(|l| l.operands.iter().any(|o| o.id == of))
        };
        let mut operands: Vec<ObjectId> = live.operands.iter().map(|o| o.id).collect();
        operands.retain(|of| self.scene.object(*of).is_some() && !used(*of));
        for of in &operands {
            self.unlocked(*of)?;
        }
        let mut steps = Vec::with_capacity(operands.len() + 1);
        if let Some(object) = self.scene.object_mut(id) {
            steps.push(SceneStep::Set(id, Box::new(object.settings.clone())));
            object.settings.live = None;
        }
        for of in operands {
            steps.extend(self.cut_out(of).ok());
        }
        self.push(SceneStep::Group(steps));
        Ok(id)
    }
}
