//! What others may see of the world, and what goes into it besides samples and commands.

use std::sync::Arc;

use glam::Vec3;

use super::{StepReport, World, WorldOptions};
use crate::answer::CommandResult;
use crate::camera::Camera;
use crate::command::{Command, Jump, SceneJump};
use crate::hand::{HandTools, HeldObject, Pose, Volume};
use crate::payload::{Payload, PayloadId};
use crate::scene::{Scene, SceneView};
use crate::stroke::{CurveStroke, PenPoint};
use sculptd_clay::brush::{BrushSettings, Picture};
use sculptd_clay::{Clay, GarbageSink, PageSupply};
use sculptd_devices::{DeviceId, Hands};

impl World {
    /// The pose of every hand that is followed.
    pub fn poses(&self) -> impl Iterator<Item = (DeviceId, i32, Pose)> + '_ {
        self.hands.tracks().map(|t| (t.device, t.id, t.pose))
    }

    /// Returns the result of the last step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// Starts the workers, so that the first large dab does not have to. To be called by the thread
    /// that steps this world.
    pub fn warm(&self) {
        self.workers.warm();
    }

    /// Returns the options, which are fixed for the life of this world.
    pub fn options(&self) -> &WorldOptions {
        &self.options
    }

    /// The tick of the last step.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The active object's clay, in its own frame.
    pub fn mesh(&self) -> &Clay {
        &self.scene.active().clay
    }

    /// The objects.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the number of steps that undo can reach, over all objects. With several people,
    /// those of the person that the world is shown to, blocked or not.
    pub fn undo_steps(&self) -> usize {
        self.shown_person().map_or(self.timeline.past(), |p| self.timeline.steps_of(p).0)
    }

    /// Returns the number of steps that redo can reach, over all objects; with several people as
    /// [`World::undo_steps`].
    pub fn redo_steps(&self) -> usize {
        self.shown_person().map_or(self.timeline.future(), |p| self.timeline.steps_of(p).1)
    }

    /// The active object's clay, for publishing only: nothing of it changes.
    pub fn snapshot(&mut self) -> sculptd_clay::Snapshot {
        self.scene.active_mut().clay.snapshot()
    }

    /// The list of objects as others see it, for publishing only: nothing of them changes.
    pub fn scene_view(&mut self) -> Arc<SceneView> {
        self.scene.view(&self.garbage)
    }

    /// The view that pens draw in.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The brush and its settings.
    pub fn brush(&self) -> &BrushSettings {
        &self.brush
    }

    /// The picture of heights of the alpha `picture`, where one was loaded.
    pub fn picture(&self) -> Option<&Arc<Picture>> {
        self.scratch.picture.as_ref()
    }

    /// Returns the settings of each brush at the time another replaced it, by its key
    /// ([`BrushSettings::key`]): a person's custom brush does not share them with others of its
    /// kind. The brush in use is absent, or has the settings from its last replacement.
    pub fn kept_brushes(&self) -> &Arc<Vec<BrushSettings>> {
        &self.kept_brushes
    }

    /// Keeps the settings of the brush in use, if it is to be exchanged for another than itself.
    pub(super) fn keep_brush(&mut self, next: &BrushSettings) {
        if self.brush.key() == next.key() {
            return;
        }
        let now = self.brush;
        let kept = Arc::make_mut(&mut self.kept_brushes);
        match kept.iter_mut().find(|k| k.key() == now.key()) {
            Some(old) => *old = now,
            None => kept.push(now),
        }
    }

    /// The brush's radius at full pressure, world units.
    pub fn brush_radius(&self) -> f32 {
        self.brush.radius * self.extent()
    }

    /// Bounding radius of the active object when it was put in place, world units.
    pub fn extent(&self) -> f32 {
        self.scene.active().world_extent()
    }

    /// The centre of the active object's bounding box when it was put in place: where mirrors
    /// stand, in the world.
    pub fn middle(&self) -> Vec3 {
        self.scene.active().world_middle()
    }

    /// The tracked volume of hands over the object.
    pub fn volume(&self) -> &Volume {
        self.hands.volume()
    }

    /// Returns the position of each pen in range, over the view.
    pub fn pens(&self) -> impl Iterator<Item = (DeviceId, PenPoint)> + '_ {
        let shown = self.pens.iter().filter(|s| self.is_shown(s.device));
        shown.filter_map(|s| s.track.seen.map(|at| (s.device, at)))
    }

    /// Returns the world position and normal of the last dab of each drawing pen. For the brushes
    /// that measure there, they are those of the surface as the stroke found it.
    pub fn last_dabs(&self) -> impl Iterator<Item = (DeviceId, [Vec3; 2])> + '_ {
        let to_world = self.scene.active().settings.transform;
        let open = self.pens.iter().filter(|s| self.is_shown(s.device) && s.track.is_open());
        open.filter_map(move |s| {
            let (at, normal) = (s.stroke.last_measured?, s.stroke.last_normal);
            Some((s.device, [to_world.point(at), to_world.direction(normal)]))
        })
    }

    /// Returns the devices whose pens press.
    pub fn pressing(&self) -> impl Iterator<Item = DeviceId> + '_ {
        let open = self.pens.iter().filter(|s| self.is_shown(s.device) && s.track.is_open());
        open.map(|s| s.device)
    }

    /// Returns the position of each pen in range on its tablet: shares of the tablet's area.
    pub fn tablets(&self) -> impl Iterator<Item = (DeviceId, glam::Vec2)> + '_ {
        let shown = self.pens.iter().filter(|s| self.is_shown(s.device));
        shown.filter_map(|s| s.track.on_tablet.map(|at| (s.device, at)))
    }

    /// The curve that a pen has laid and not drawn yet; of several, the first pen's.
    pub fn curve_stroke(&self) -> Option<&CurveStroke> {
        let shown = self.pens.iter().filter(|s| self.is_shown(s.device));
        shown.map(|s| s.track.curve_stroke()).find(|d| !d.is_empty())
    }

    /// Returns the object held by the hands, with its place.
    pub fn thing(&self) -> Option<&HeldObject> {
        self.thing.as_ref()
    }

    /// Returns the state of the hand tools.
    pub fn hand_tools(&self) -> &HandTools {
        &self.hands
    }

    /// The newest frame of hands.
    pub fn hands(&self) -> Option<&Hands> {
        self.last_hands.as_ref()
    }

    /// From now on, what is no longer needed goes to this sink. A new world frees it in place.
    pub fn set_garbage_sink(&mut self, sink: GarbageSink) {
        for object in self.scene.objects_mut() {
            object.clay.set_garbage_sink(sink.clone());
        }
        self.garbage = sink;
    }

    /// Pages that dynamic topology needs come from this supply from now on, whatever clay is in
    /// place. A new world makes them in place.
    pub fn set_page_supply(&mut self, supply: PageSupply) {
        for object in self.scene.objects_mut() {
            object.clay.set_page_supply(supply.clone());
        }
        self.pages = supply;
    }

    /// Keeps the payload that goes with a command of the next step, and writes its name into the
    /// command. A payload that the command cannot use, or for which there is no room, goes to the
    /// garbage sink; the world then builds what the command needs, or ignores a jump.
    pub fn deliver(&mut self, command: &mut Command, payload: Payload) {
        if let Command::Rebased(rebased) = command {
            self.deliver(&mut rebased.command, payload);
        } else if let Command::Jump(jump) = command {
            self.deliver_for_jump(jump, payload);
        } else if let Command::JumpScene(jump) = command {
            self.deliver_for_scene_jump(jump, payload);
        } else if let Command::Scene(scene) = command
            && let Some(new) = scene.new_objects_mut().first_mut()
        {
            let id = *new.built.insert(self.payloads.number());
            self.keep_payload(id, payload);
        } else if let Some(new) = command.new_clay_mut() {
            let id = *new.built.insert(self.payloads.number());
            self.keep_payload(id, payload);
        } else {
            self.garbage.discard_owned(payload);
        }
    }

    /// The same for a jump, which names its payload itself: one that was read from a file works
    /// like one that was sent.
    pub fn deliver_for_jump(&mut self, jump: &Jump, payload: Payload) {
        self.keep_payload(jump.payload_id(), payload);
    }

    /// The same for a jump to another scene.
    pub fn deliver_for_scene_jump(&mut self, jump: &SceneJump, payload: Payload) {
        self.keep_payload(jump.payload_id(), payload);
    }

    fn keep_payload(&mut self, id: PayloadId, payload: Payload) {
        if let Err(left) = self.payloads.insert(id, payload) {
            self.garbage.discard_owned(left);
        }
    }

    /// Returns what came of each command of the last step, at the command's place.
    pub fn answers(&self) -> &[CommandResult] {
        &self.answers
    }

    /// One number for the whole state of all objects; costs as much as they are large. That of one
    /// object that stands where it is, is that of its clay.
    pub fn hash(&self) -> u64 {
        self.scene.hash()
    }

    /// Checks everything that must hold of the world. Costs as much as the clay is large.
    ///
    /// # Errors
    /// Says what does not hold.
    pub fn verify_invariants(&self) -> Result<(), String> {
        if !self.camera.is_sane() {
            return Err(format!("the camera is not sane: {:?}", self.camera));
        }
        for object in self.scene.objects().iter().filter(|o| !o.clay.is_in_step()) {
            object.clay.verify_layers().map_err(|e| format!("object {}: {e}", object.id))?;
        }
        self.scene.verify_invariants()
    }
}
