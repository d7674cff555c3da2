//! What the world does with its scene: commands to it, undo over all objects, jumps to where it was
//! another.

use super::{HistoryEvent, World};
use crate::answer::{Answer, CommandResult};
use crate::command::{Command, JumpObject, NewClay, OfClay, Rebased, SceneJump};
use crate::hand::ReachBox;
use crate::payload::{Payload, PayloadId};
use crate::scene::{
    Exchange, LiveBoolean, MAX_OBJECTS, NewObject, Object, ObjectId, ObjectSettings, ObjectSource,
    Operand, Presence, ReplacedClay, Scene, SceneCommand, SceneError, SceneEvent, SceneStep,
    clean_name,
};
use sculptd_clay::Clay;

/// Result of a scene command: the object that it made or changed. For [`SceneCommand::Layers`] it
/// holds the number of the layer made or edited instead, `u32::MAX` for the base. For
/// [`SceneCommand::Sets`] it holds the number of the face set, 0 for none. For
/// [`SceneCommand::RemeshLocal`] it holds the number of changed edges.
pub type SceneResult = Result<ObjectId, SceneError>;

impl World {
    /// Carries out a command to the scene.
    pub(super) fn apply_scene(&mut self, command: &SceneCommand) -> CommandResult {
        let before = self.stance();
        let result = self.scene_command(command);
        let noted = matches!(
            command,
            SceneCommand::Layers(_)
                | SceneCommand::Sets(_)
                | SceneCommand::SetsRegion(_)
                | SceneCommand::MaskMeasured(_)
                | SceneCommand::RemeshLocal(_)
        );
        if result.is_ok() && !noted {
            self.scene.touch();
            self.stand(before);
            // A change under way is recorded when it ends.
            let follows = matches!(command, SceneCommand::Recomputed(_)) && self.is_dragged();
            if !follows && !matches!(command, SceneCommand::Drag(..)) {
                self.note(HistoryEvent::Scene(event_of(command)));
            }
        }
        let id = result?;
        Ok(if self.follows_later() { Answer::UnderWay } else { Answer::Object(id) })
    }

    fn scene_command(&mut self, command: &SceneCommand) -> SceneResult {
        if let SceneCommand::Layers(edit) = command {
            return self.edit_layers(edit);
        }
        // Every stroke ends first, because it belongs to the active object. The exception is a
        // recomputation of another object, which no person requested.
        let active = self.scene.active().id;
        if !matches!(command, SceneCommand::Recomputed(again) if again.id != active) {
            self.lift_all();
        }
        match command {
            SceneCommand::Add(new) => {
                let mut clays = self.take_clays(new.built);
                let object = self.new_object(new, clays.pop())?;
                Ok(self.add(self.scene.objects().len(), object))
            }
            SceneCommand::Remove(id) => {
                self.unlocked(*id)?;
                self.remove(*id).map(|_| *id)
            }
            SceneCommand::Duplicate(id) => {
                let index = self.scene.index_of(*id).ok_or(SceneError::NoObject(*id))?;
                self.room(1)?;
                let twin = self.scene.fresh_id();
                let number = self.fresh_clay_number();
                let of = self.scene.object(*id).ok_or(SceneError::NoObject(*id))?;
                let settings = ObjectSettings { locked: false, live: None, ..of.settings.clone() };
                let (middle, extent) = (of.middle, of.extent);
                let clay = of.clay.duplicate(number);
                let clay = self.adopted(clay);
                Ok(self.add(index + 1, Object { id: twin, settings, clay, middle, extent }))
            }
            SceneCommand::Rename(id, name) => {
                let name = clean_name(name).ok_or(SceneError::Name)?;
                self.set(*id, |settings| settings.name = name)
            }
            SceneCommand::Transform(id, transform) => {
                self.unlocked(*id)?;
                if !transform.is_sane() {
                    return Err(SceneError::Transform);
                }
                let goes_on = self.is_dragged_object(*id);
                self.dragged = None;
                self.put_at(*id, *transform, goes_on)
            }
            SceneCommand::Drag(id, transform) => {
                self.unlocked(*id)?;
                if !transform.is_sane() {
                    return Err(SceneError::Transform);
                }
                let (before, goes_on) = (self.timeline.newest_step(), self.is_dragged_object(*id));
                let done = self.put_at(*id, *transform, goes_on);
                // Without an earlier move there is no step to continue.
                let now = self.timeline.newest_step().filter(|now| goes_on || Some(*now) != before);
                self.dragged = now.map(|step| (*id, step));
                done
            }
            SceneCommand::Show(id, visible) => self.set(*id, |s| s.visible = *visible),
            SceneCommand::Lock(id, locked) => self.set(*id, |s| s.locked = *locked),
            SceneCommand::Activate(id) => {
                let before = self.scene.active().id;
                if !self.scene.activate(*id) {
                    return Err(SceneError::NoObject(*id));
                }
                if before != *id {
                    self.push(SceneStep::Active(before));
                }
                Ok(*id)
            }
            SceneCommand::Exchange(exchange) => self.exchange(exchange, None),
            SceneCommand::Snap(placing) => {
                self.as_it_was(&placing.moved)?;
                self.as_it_was(&placing.target)?;
                self.unlocked(placing.moved.id)?;
                if !placing.transform.is_sane() {
                    return Err(SceneError::Transform);
                }
                self.set(placing.moved.id, |settings| settings.transform = placing.transform)
            }
            SceneCommand::Reshape(id, new) => {
                self.unlocked(*id)?;
                let object = self.scene.object(*id).ok_or(SceneError::NoObject(*id))?;
                let same = object.clay.revision() == 0 && object.settings.primitive.is_some();
                let ObjectSource::Primitive(primitive) = new.source else {
                    return Err(SceneError::NotAPrimitive(*id));
                };
                if !same {
                    return Err(SceneError::NotAPrimitive(*id));
                }
                let mut clays = self.take_clays(new.built);
                let Object { clay, middle, extent, .. } = self.new_object(new, clays.pop())?;
                let mut other = Box::new(ReplacedClay { clay, middle, extent });
                let object = self.scene.object_mut(*id).ok_or(SceneError::NoObject(*id))?;
                other.exchange(object);
                let old = object.settings.clone();
                object.settings.primitive = Some(primitive);
                self.push(SceneStep::Group(vec![
                    SceneStep::Replaced(*id, other),
                    SceneStep::Set(*id, Box::new(old)),
                ]));
                Ok(*id)
            }
            SceneCommand::Move(id, place) => {
                let from = self.scene.move_to(*id, *place as usize);
                let from = from.ok_or(SceneError::NoObject(*id))?;
                if self.scene.index_of(*id) != Some(from) {
                    self.push(SceneStep::Moved(*id, from));
                }
                Ok(*id)
            }
            SceneCommand::Group(ids, name) => self.group(ids, name),
            SceneCommand::NameSet(set, name) => self.name_set(*set, name),
            SceneCommand::ExchangeLive(asked) => self.exchange(&asked.0, Some(&asked.1)),
            SceneCommand::Recomputed(again) => self.recomputed(again),
            SceneCommand::ApplyLive(id) => self.apply_live(*id),
            SceneCommand::Sets(edit) => self.edit_sets(edit),
            SceneCommand::SetsRegion(asked) => self.edit_sets_seen(asked),
            SceneCommand::MaskMeasured(mask) => self.mask_measured(mask),
            SceneCommand::RemeshLocal(asked) => self.remesh_locally(asked),
            // Carried out above.
            SceneCommand::Layers(_) => Ok(self.scene.active().id),
        }
    }

    /// An object of the scene that is not locked.
    pub(super) fn unlocked(&self, id: ObjectId) -> Result<&Object, SceneError> {
        let object = self.scene.object(id).ok_or(SceneError::NoObject(id))?;
        if object.settings.locked { Err(SceneError::Locked(id)) } else { Ok(object) }
    }

    fn room(&self, more: usize) -> Result<(), SceneError> {
        let fits = self.scene.objects().len() + more <= MAX_OBJECTS;
        if fits { Ok(()) } else { Err(SceneError::Full) }
    }

    pub(super) fn set(
        &mut self,
        id: ObjectId,
        change: impl FnOnce(&mut ObjectSettings),
    ) -> SceneResult {
        let object = self.scene.object_mut(id).ok_or(SceneError::NoObject(id))?;
        let old = object.settings.clone();
        change(&mut object.settings);
        if old != object.settings {
            self.push(SceneStep::Set(id, Box::new(old)));
        }
        Ok(id)
    }

    /// One step of undo for what an object was set to before.
    pub(super) fn push_settings(&mut self, id: ObjectId, before: ObjectSettings) {
        self.push(SceneStep::Set(id, Box::new(before)));
    }

    pub(super) fn push(&mut self, step: SceneStep) {
        let World { timeline, scene, garbage, options, .. } = self;
        timeline.push(step, scene, options.undo_bytes, garbage);
    }

    /// Puts an object into the list and makes it active, as one step.
    fn add(&mut self, index: usize, object: Object) -> ObjectId {
        let (id, step) = self.put(index, object);
        self.push(step);
        id
    }

    fn put(&mut self, index: usize, object: Object) -> (ObjectId, SceneStep) {
        let (id, other_active) = (object.id, self.scene.active().id);
        self.scene.insert(index, object);
        self.scene.activate(id);
        (id, SceneStep::Present(Box::new(Presence { id, index, object: None, other_active })))
    }

    fn remove(&mut self, id: ObjectId) -> Result<(), SceneError> {
        let step = self.cut_out(id)?;
        self.push(step);
        Ok(())
    }

    pub(super) fn cut_out(&mut self, id: ObjectId) -> Result<SceneStep, SceneError> {
        let index = self.scene.index_of(id).ok_or(SceneError::NoObject(id))?;
        let other_active = self.scene.active().id;
        let object = Some(self.scene.take(id).ok_or(SceneError::Last)?);
        Ok(SceneStep::Present(Box::new(Presence { id, index, object, other_active })))
    }

    /// Refuses where an object has changed since something was computed from it.
    pub(super) fn as_it_was(&self, from: &Operand) -> Result<(), SceneError> {
        let same = self.scene.object(from.id).is_some_and(|o| {
            (o.clay.object_id(), o.clay.revision()) == (from.clay, from.revision)
                && o.settings.transform == from.transform
        });
        if same { Ok(()) } else { Err(SceneError::Changed(from.id)) }
    }

    /// `live`: the first new object follows its operands from now on.
    fn exchange(&mut self, exchange: &Exchange, live: Option<&LiveBoolean>) -> SceneResult {
        for from in &exchange.from {
            self.as_it_was(from)?;
        }
        for id in &exchange.remove {
            self.unlocked(*id)?;
        }
        let Some(first) = exchange.add.first() else { return Err(SceneError::Build) };
        self.room(exchange.add.len())?;
        let mut clays = self.take_clays(first.built).into_iter();
        let made: Result<Vec<Object>, SceneError> = exchange
            .add
            .iter()
            .enumerate()
            .map(|(k, new)| {
                let built = clays.next().or_else(|| self.rebased_clay(k, new));
                self.new_object(new, built)
            })
            .collect();
        let mut made = made?;
        if let (Some(live), Some(first)) = (live, made.first_mut()) {
            let result = first.clay.object_id();
            first.settings.live = Some(Box::new(LiveBoolean { result, ..live.clone() }));
        }
        let mut steps = Vec::with_capacity(made.len() + exchange.remove.len() + 2);
        let mut ids = Vec::with_capacity(made.len());
        for object in made {
            let (id, step) = self.put(self.scene.objects().len(), object);
            ids.push(id);
            steps.push(step);
        }
        let shown = self.scene.active().id;
        self.scene.activate(ids[0]);
        steps.push(SceneStep::Active(shown));
        for id in &exchange.remove {
            // The new objects are already added, so that none of these is the last.
            steps.extend(self.cut_out(*id).ok());
        }
        for id in &exchange.hide {
            if let Some(object) = self.scene.object_mut(*id) {
                let old = object.settings.clone();
                object.settings.visible = false;
                steps.push(SceneStep::Set(*id, Box::new(old)));
            }
        }
        self.push(SceneStep::Group(steps));
        Ok(ids[0])
    }

    /// The clay of a new object with its vertices of a [`Command::Rebased`], where that is carried
    /// out without the clay.
    fn rebased_clay(&self, k: usize, new: &NewObject) -> Option<Clay> {
        let states = self.rebased.as_ref()?.get(k)?;
        let ObjectSource::Mesh(plain) = &new.source else { return None };
        Some(Clay::build(plain, &Default::default()).ok()?.with_vertices(states))
    }

    pub(super) fn new_object(
        &mut self,
        new: &NewObject,
        built: Option<Clay>,
    ) -> Result<Object, SceneError> {
        self.room(1)?;
        if !new.transform.is_sane() {
            return Err(SceneError::Transform);
        }
        let name = clean_name(&new.name).ok_or(SceneError::Name)?;
        let mut clay = match (built, &new.source) {
            (Some(clay), _) => clay,
            (None, ObjectSource::Mesh(plain)) => {
                Clay::build(plain, &Default::default()).map_err(|_| SceneError::Build)?
            }
            (None, ObjectSource::Primitive(p)) => {
                let plain = p.triangles().map_err(|_| SceneError::Build)?;
                Clay::build(&plain, &Default::default()).map_err(|_| SceneError::Build)?
            }
        };
        clay.set_object_id(self.fresh_clay_number());
        let primitive = match new.source {
            ObjectSource::Primitive(p) => Some(p),
            ObjectSource::Mesh(_) => None,
        };
        let settings =
            ObjectSettings { name, transform: new.transform, primitive, ..Default::default() };
        let id = self.scene.fresh_id();
        let clay = self.adopted(clay);
        Ok(Object::new(id, settings, clay))
    }

    /// A number that no clay of this world has had.
    pub(super) fn fresh_clay_number(&mut self) -> u32 {
        self.lineages += 1;
        self.lineages
    }

    /// Clay that hands its garbage to the world's sink and takes pages from its supply. Its steps
    /// are bounded by the timeline.
    pub(super) fn adopted(&self, mut clay: Clay) -> Clay {
        clay.set_garbage_sink(self.garbage.clone());
        clay.set_page_supply(self.pages.clone());
        clay.set_undo_bytes(u64::MAX);
        clay
    }

    pub(super) fn take_clays(&mut self, built: Option<PayloadId>) -> Vec<Clay> {
        match built.and_then(|id| self.payloads.take(id)) {
            Some(Payload::Clay(clay)) => vec![*clay],
            Some(Payload::Clays(clays)) => clays,
            Some(other) => {
                self.garbage.discard_owned(other);
                Vec::new()
            }
            None => Vec::new(),
        }
    }

    /// Takes the newest step back, in memory; of several people that of whoever acts now. False:
    /// there is none, or somebody else's is in the way.
    pub(super) fn undo_step(&mut self) -> bool {
        let before = self.stance();
        let done = match self.person() {
            None => self.timeline.undo(&mut self.scene),
            Some(person) => {
                let way = self.timeline.undo_own(person, &mut self.scene);
                self.record_undo(way, false)
            }
        };
        self.stand(before);
        done
    }

    /// Redoes the step that was undone last. Returns false if there is none, or if somebody else's
    /// step blocks it.
    pub(super) fn redo_step(&mut self) -> bool {
        let before = self.stance();
        let done = match self.person() {
            None => self.timeline.redo(&mut self.scene),
            Some(person) => {
                let way = self.timeline.redo_own(person, &mut self.scene);
                self.record_undo(way, true)
            }
        };
        self.stand(before);
        done
    }

    /// Returns the middle and the size of the active object, onto which hands are mapped.
    fn stance(&self) -> (glam::Vec3, f32) {
        let active = self.scene.active();
        (active.world_middle(), active.world_extent())
    }

    /// Remaps the hands if the active object has moved or changed size.
    fn stand(&mut self, before: (glam::Vec3, f32)) {
        if self.stance() != before {
            self.lay_hands();
        }
    }

    /// Lays the tracked volume over the active object.
    pub(super) fn lay_hands(&mut self) {
        let (middle, extent) = self.stance();
        self.hands.place_volume(middle, extent, self.camera.yaw);
    }

    pub(super) fn set_reach(&mut self, reach: ReachBox) -> CommandResult {
        if !reach.is_sane() {
            return Err(SceneError::Value("a place within 2 m and half a side of 30 to 1000 mm"));
        }
        self.hands.settings.reach = reach;
        self.lay_hands();
        Ok(Answer::Done)
    }

    /// Turns the camera to the active object as a whole.
    pub(super) fn frame(&mut self) {
        if let Some((lo, hi)) = self.active_bounds() {
            self.camera.frame(lo, hi);
        }
    }

    /// The box of the active object in the world; `None`: it has no vertices.
    pub(super) fn active_bounds(&self) -> Option<(glam::Vec3, glam::Vec3)> {
        let active = self.scene.active();
        let (lo, hi) = active.settings.transform.bounds(active.clay.bounds());
        lo.cmple(hi).all().then_some((lo, hi))
    }

    /// Another command, where the clay that it was computed for is the active one.
    pub(super) fn apply_of_clay(&mut self, of: &OfClay) -> CommandResult {
        if matches!(of.command, Command::OfClay(_) | Command::Rebased(_)) {
            return Err(SceneError::Value("a command of one clay"));
        }
        let now = &self.scene.active().clay;
        let fits = now.object_id() == of.clay
            && of.revision.is_none_or(|r| r == now.revision() && !now.is_in_step());
        if fits { self.apply_command(&of.command) } else { Err(SceneError::Stale) }
    }

    /// Another command, whose new clay has other vertices than its triangles.
    pub(super) fn apply_rebased(&mut self, rebased: &Rebased) -> CommandResult {
        if !matches!(rebased.command, Command::OfClay(_) | Command::Scene(_)) {
            return Err(SceneError::Value("a command of one clay or of the scene"));
        }
        self.rebased = Some(rebased.vertices.clone());
        let done = self.apply_command(&rebased.command);
        // The command keeps the list.
        self.rebased = None;
        done
    }

    /// Other clay takes the place of the active object's: a Boolean's result, or a file.
    pub(super) fn replace(&mut self, new: &NewClay, masks: &[f32]) -> CommandResult {
        self.lift_all();
        let active = self.scene.active();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        let mut clay = self.built(new, masks).ok_or(SceneError::Build)?;
        clay.set_levels(new.levels.clone());
        clay.set_object_id(self.fresh_clay_number());
        let clay = self.adopted(clay);
        let World { timeline, scene, garbage, options, .. } = self;
        timeline.forget_future(scene, garbage);
        if !new.keep_camera {
            timeline.forget(scene, garbage);
        }
        let object = scene.active_mut();
        let (id, middle, extent) = (object.id, object.middle, object.extent);
        let old = std::mem::replace(&mut object.clay, clay);
        // The numbers of a primitive say nothing of other clay.
        let settings = object.settings.clone();
        let shaped = object.settings.primitive.take().is_some();
        if new.keep_camera {
            let other = ReplacedClay { clay: old, middle, extent };
            let mut step = SceneStep::Replaced(id, Box::new(other));
            if shaped {
                step = SceneStep::Group(vec![step, SceneStep::Set(id, Box::new(settings))]);
            }
            timeline.push(step, scene, options.undo_bytes, garbage);
        } else {
            garbage.discard_owned(old);
            object.measure();
            self.lay_hands();
            self.frame();
        }
        if shaped || !new.keep_camera && !self.scene.is_plain() {
            self.scene.touch();
        }
        self.note(HistoryEvent::Replace);
        Ok(Answer::Done)
    }

    /// The clay of a new object: the payload where there is one, else built here.
    pub(super) fn built(&mut self, new: &NewClay, masks: &[f32]) -> Option<Clay> {
        match new.built.and_then(|id| self.payloads.take(id)) {
            Some(Payload::Clay(clay)) => return Some(*clay),
            Some(other) => self.garbage.discard_owned(other),
            None => {}
        }
        let clay = Clay::build_masked(&new.plain, masks, &Default::default()).ok()?;
        Some(match self.rebased.as_ref().and_then(|all| all.first()) {
            Some(states) => clay.with_vertices(states),
            None => clay,
        })
    }

    /// The scene as it was at another node.
    pub(super) fn jump_scene(&mut self, jump: &SceneJump) -> CommandResult {
        let from = |world: &World| {
            let clay = &world.scene.active().clay;
            (clay.object_id(), clay.revision())
        };
        if jump.from != from(self) {
            return Err(SceneError::Stale);
        }
        let Some(payload) = self.payloads.take(jump.payload_id()) else {
            self.report.jumps_missing += 1;
            return Err(SceneError::NotInHistory);
        };
        self.lift_all();
        let Payload::Clays(clays) = payload else {
            self.garbage.discard_owned(payload);
            return Err(SceneError::NotInHistory);
        };
        // A stroke that ended here has changed the object after all.
        if jump.from != from(self) || clays.len() != jump.objects.len() {
            self.garbage.discard_owned(clays);
            return Err(SceneError::Stale);
        }
        let object = |(of, clay): (&JumpObject, Clay)| Object {
            id: of.id,
            settings: of.settings.clone(),
            clay: self.adopted(clay),
            middle: of.clay.middle,
            extent: of.clay.extent,
        };
        let objects = jump.objects.iter().zip(clays).map(object).collect();
        let next_id = self.scene.next_id();
        let scene = Scene::restored(objects, jump.active as usize, next_id);
        let scene = scene.ok_or(SceneError::NotInHistory)?;
        let World { timeline, garbage, .. } = self;
        timeline.forget(&mut self.scene, garbage);
        self.garbage.discard_owned(std::mem::replace(&mut self.scene, scene));
        self.lay_hands();
        self.report.jumps += 1;
        self.note(HistoryEvent::Jump(jump.node));
        Ok(Answer::Done)
    }
}

fn event_of(command: &SceneCommand) -> SceneEvent {
    match command {
        SceneCommand::Add(_) => SceneEvent::Add,
        SceneCommand::Remove(_) => SceneEvent::Remove,
        SceneCommand::Duplicate(_) => SceneEvent::Duplicate,
        SceneCommand::Rename(..) => SceneEvent::Rename,
        SceneCommand::Transform(..) | SceneCommand::Drag(..) => SceneEvent::Transform,
        SceneCommand::Activate(_) => SceneEvent::Activate,
        SceneCommand::Show(..) => SceneEvent::Show,
        SceneCommand::Lock(..) => SceneEvent::Lock,
        SceneCommand::Reshape(..) => SceneEvent::Reshape,
        SceneCommand::Snap(_) => SceneEvent::Snap,
        SceneCommand::Exchange(exchange) => exchange.event,
        SceneCommand::Layers(_) => SceneEvent::Layers,
        // Noted where the edit ends.
        SceneCommand::Sets(_) | SceneCommand::SetsRegion(_) => SceneEvent::Sets,
        SceneCommand::MaskMeasured(_) => SceneEvent::Mask,
        SceneCommand::RemeshLocal(_) => SceneEvent::Remesh,
        SceneCommand::Move(..) | SceneCommand::Group(..) => SceneEvent::Arrange,
        SceneCommand::NameSet(..) => SceneEvent::NameSet,
        SceneCommand::ExchangeLive(asked) => asked.0.event,
        SceneCommand::Recomputed(_) => SceneEvent::Follow,
        SceneCommand::ApplyLive(_) => SceneEvent::Apply,
    }
}
