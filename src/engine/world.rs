//! The world: clay, camera, brush, strokes. [`World::step`] is the only writer.
//!
//! Laws kept here:
//! * Two things change the world: a `Sample` and a `Command`. Both are plain data.
//! * `step` has no clock and no IO, starts no threads, and cannot fail: same start, same samples
//!   and commands, same bits, with any number of workers.
//! * One step is bounded: dabs stop at the budget and go on in the next step, and so does dynamic
//!   topology, whose budget is what dabs leave. Edits of layers, of the whole mask, of face sets
//!   and of triangles in place go through the pages in portions.

mod begin;
mod fork;
mod hands;
mod held;
mod images;
mod in_hand;
mod layers;
mod local_camera;
mod others;
mod own_undo;
mod people;
mod saved;
mod scene_arrange;
mod scene_steps;
mod state;
mod stroke_context;
mod surface_edits;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use self::in_hand::ObjectsInHand;
use self::local_camera::LocalCamera;
pub use self::others::{MAX_OTHERS, OthersPen};
use self::people::People;
pub use self::people::UndoRefusal;
pub use self::saved::{BadState, HistoryEntry, HistoryEvent, Saved, SavedScene, SideData};
pub use self::scene_steps::SceneResult;
use self::stroke_context::{Stroke, StrokeContext, goes_on_by_time};
use crate::answer::{Answer, CommandResult};
use crate::camera::Camera;
use crate::command::{Carving, Command};
use crate::desktop_layout::DesktopLayout;
use crate::hand::{HandSettings, HandTools, HeldObject, MenuItem};
use crate::layer_work::LayerWork;
use crate::payload::PayloadStore;
use crate::scene::{ObjectId, Scene, SceneError, Timeline};
use crate::stroke::{CurveAction, PenTrack};
use crate::surface_edit::SurfaceWork;
use crate::topology_work::TopologyWork;
use sculptd_clay::brush::{BrushSettings, Grip, Measure, Method, Scratch};
use sculptd_clay::{Author, Clay, Garbage, GarbageSink, PageSupply, VertexState, Workers};
use sculptd_devices::{Body, DeviceId, Hands, Sample};

/// Devices that may sculpt at once. A device beyond them is heard but does not sculpt;
/// `StepReport::ignored` counts it.
pub const MAX_PENS: usize = 32;

/// Result of one step. Reused from step to step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepReport {
    /// Number of samples passed to the step.
    pub samples: u64,
    /// Dabs that moved a vertex.
    pub dabs: u64,
    /// Summed over dabs: a vertex moved by two dabs counts twice.
    pub vertices_moved: u64,
    /// Path points or dynamic topology still waiting because the budget was spent.
    pub paused: bool,
    /// A pen rests on the clay and its brush goes on by time: ticks without input matter.
    pub resting: bool,
    /// Samples of devices beyond [`MAX_PENS`].
    pub ignored: u64,
    /// A hand asked for the object that it holds to be joined with the clay: for a worker, see
    /// [`World::thing`].
    pub join: Option<MenuItem>,
    /// A hand has put an object of the scene down: a worker may lay it flush on a face near it.
    pub put_down: Option<ObjectId>,
    /// Number of undo requests (negative) or redo requests (positive) that no step in memory could
    /// serve: for a caller that keeps the history outside.
    pub missed: i32,
    /// Balls in which dynamic topology was still to be done and was given up: more waited than the
    /// list holds, or than could be done before a command that ends strokes.
    pub topology_dropped: u64,
    /// Jumps within the history that were made.
    pub jumps: u64,
    /// Jumps that fitted the sculpture and were not made, because their pages were not delivered.
    pub jumps_missing: u64,
}

/// Fixed for the life of a world.
#[derive(Debug, Clone, Copy)]
pub struct WorldOptions {
    /// Vertices that the dabs of one step may visit.
    pub dab_budget: u64,
    /// Bytes that undo may hold; the oldest steps go first.
    pub undo_bytes: u64,
    /// Settings of the hand recognition.
    pub hands: HandSettings,
}

/// One pen at work.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct PenSlot {
    device: DeviceId,
    track: PenTrack,
    stroke: Stroke,
}

/// The whole state. [`World::step`] is the only writer.
#[derive(Debug)]
pub struct World {
    tick: u64,
    /// The objects; strokes and Booleans act on the active one.
    scene: Scene,
    workers: Workers,
    options: WorldOptions,
    brush: BrushSettings,
    /// Settings of each brush at the time another replaced it.
    kept_brushes: Arc<Vec<BrushSettings>>,
    camera: Camera,
    pens: Vec<PenSlot>,
    /// Mapping of the pens to the view, and where they may begin.
    desktop: DesktopLayout,
    scratch: Scratch,
    /// Areas whose triangles are still to be resized.
    topology: TopologyWork,
    /// Pages that are still to follow an edit of layers, or a stroke on one.
    layers: LayerWork,
    /// Pages that are still to follow an edit of the whole mask or of face sets.
    surface: SurfaceWork,
    /// Strokes begun.
    strokes: u32,
    hands: HandTools,
    last_hands: Option<Hands>,
    /// Object held by the hands.
    thing: Option<HeldObject>,
    /// The object of the scene that they carry.
    in_hand: ObjectsInHand,
    report: StepReport,
    /// Steps to undo and redo, over all objects.
    timeline: Timeline,
    /// Takes what is no longer needed: clay that was replaced, payloads that no command took.
    garbage: GarbageSink,
    /// Gives pages that dynamic topology needs.
    pages: PageSupply,
    payloads: PayloadStore,
    /// Of a [`Command::Rebased`] that is carried out.
    rebased: Option<Arc<Vec<Vec<VertexState>>>>,
    /// Results of the commands of this tick, each at its command's index.
    answers: Vec<CommandResult>,
    late_answer: Option<CommandResult>,
    /// Number of clays put in place so far; each gets a unique number.
    lineages: u32,
    /// The object that is dragged, and the step that the drag is.
    dragged: Option<(ObjectId, u64)>,
    /// Changes of this tick, for the session's history; `None`: no history is kept.
    moments: Option<Vec<HistoryEntry>>,
    /// The settings of those who share the world; nobody in a world of one person.
    people: People,
}

impl World {
    /// A world at tick 0 around this clay; the camera frames it.
    pub fn new(
        clay: Clay,
        camera: Camera,
        brush: BrushSettings,
        workers: Workers,
        options: WorldOptions,
    ) -> Self {
        World::around(Scene::new(clay), camera, brush, workers, options)
    }

    /// A world at tick 0 around these objects; the camera frames the active one.
    fn around(
        mut scene: Scene,
        camera: Camera,
        brush: BrushSettings,
        workers: Workers,
        options: WorldOptions,
    ) -> Self {
        for object in scene.objects_mut() {
            // The timeline bounds the steps of all objects together.
            object.clay.set_undo_bytes(u64::MAX);
        }
        let mut world = World {
            tick: 0,
            scene,
            workers,
            options,
            brush: brush.clamped(),
            kept_brushes: Arc::default(),
            camera,
            pens: Vec::with_capacity(MAX_PENS),
            desktop: DesktopLayout::default(),
            scratch: Scratch::default(),
            topology: TopologyWork::new(),
            layers: LayerWork::new(),
            surface: SurfaceWork::new(),
            strokes: 0,
            hands: HandTools::new(options.hands),
            last_hands: None,
            thing: None,
            in_hand: ObjectsInHand::default(),
            report: StepReport::default(),
            timeline: Timeline::new(),
            garbage: GarbageSink::default(),
            pages: PageSupply::default(),
            payloads: PayloadStore::new(),
            rebased: None,
            answers: Vec::with_capacity(PayloadStore::CAPACITY),
            late_answer: None,
            lineages: 0,
            dragged: None,
            moments: None,
            people: People::default(),
        };
        world.lay_hands();
        world.frame();
        world
    }

    /// One tick: commands first, in order, then samples in order of time (ties by device), then
    /// the path points that the budget of the tick before left over.
    pub fn step(&mut self, tick: u64, samples: &[Sample], commands: &[Command]) -> &StepReport {
        self.tick = tick;
        self.report = StepReport { samples: samples.len() as u64, ..StepReport::default() };
        self.answers.clear();
        self.late_answer = None;
        self.surface.next_tick();
        self.let_entries_go();
        self.act_as_hands();
        self.timeline.set_person(self.person());
        self.author(None);
        for command in commands {
            self.act_for(command);
            let answer = self.apply_command(command);
            self.author(None);
            self.answers.push(answer);
        }
        for sample in samples {
            self.apply_sample(sample);
        }
        self.act_as_hands();
        self.sculpt();
        self.act_as_shown();
        self.payloads.clear(&self.garbage);
        &self.report
    }

    fn apply_command(&mut self, command: &Command) -> CommandResult {
        match command {
            Command::Brush(brush) => self.take_brush(brush),
            // A curve that a pen has laid is newer than the last step.
            Command::Undo if self.put_away() || self.take_back_remesh() => {}
            Command::CurveStroke(act) => match act {
                CurveAction::Apply => self.own_pens().for_each(|s| s.track.apply()),
                CurveAction::Cancel => {
                    self.put_away();
                }
                CurveAction::Delete(handle) => {
                    if !self.own_pens().any(|s| s.track.delete(*handle)) {
                        return Err(SceneError::Value("the number of a handle of the curve"));
                    }
                }
            },
            Command::Camera(camera) if camera.is_sane() => self.camera = *camera,
            Command::DesktopLayout(desktop) if desktop.is_sane() => self.desktop = *desktop,
            Command::Camera(_) | Command::DesktopLayout(_) => {
                return Err(SceneError::Value("values that are finite"));
            }
            Command::Undo | Command::Redo => return self.go_in_history(command),
            Command::LiftAll => {
                self.lift_own();
            }
            Command::TakeUp(plain) => return self.take_up(plain.clone()),
            Command::PutDown => self.put_down(),
            Command::CalibrateReach => self.hands.calibrate(),
            Command::Reach(reach) => return self.set_reach(*reach),
            Command::Picture(picture) => {
                if !picture.is_sane() {
                    return Err(SceneError::Value("a picture whose heights fill its size"));
                }
                if let Some(old) = self.scratch.picture.replace(picture.clone()) {
                    self.garbage.discard(Garbage::Shared(old));
                }
            }
            Command::Begin(new) => return self.begin_anew(new),
            Command::Mask(action) => return self.mask(*action),
            Command::MaskRegion(region) => return self.mask_seen(region),
            Command::Place(place) => match self.thing.as_mut() {
                Some(thing) if place.is_sane() => thing.place = *place,
                Some(_) => return Err(SceneError::Transform),
                None => return Err(SceneError::NothingHeld),
            },
            Command::Cut(carving) => return self.cut(carving),
            Command::Replace(new) => return self.replace(new, &[]),
            Command::ReplaceMasked(new, masks) => return self.replace(new, masks),
            Command::Jump(jump) => return self.jump(jump),
            Command::Scene(scene) => return self.apply_scene(scene),
            Command::OfClay(of) => return self.apply_of_clay(of),
            Command::Rebased(rebased) => return self.apply_rebased(rebased),
            Command::OfPerson(of) => return self.apply_of_person(of),
            Command::OnePerson => self.forget_people(),
            Command::JumpScene(jump) => return self.jump_scene(jump),
            Command::Reopened => {
                self.lift_all();
                // The layout came from a window that is gone; a new window sends another.
                self.forget_desktops();
                self.forget_steps();
            }
        }
        Ok(Answer::Done)
    }

    fn take_brush(&mut self, brush: &BrushSettings) {
        self.keep_brush(brush);
        self.brush = brush.clamped();
        if self.brush.topology.by != Measure::Off && self.brush.kind.cuts() {
            self.scene.active_mut().clay.prepare_topology();
        }
        let lays =
            self.brush.kind.grip() == Grip::Surface && self.brush.path.method == Method::Curve;
        if !lays {
            self.put_away();
        }
    }

    /// Undoes or redoes one step.
    fn go_in_history(&mut self, command: &Command) -> CommandResult {
        let redo = matches!(command, Command::Redo);
        self.lift_for_undo(redo);
        let done = if redo { self.redo_step() } else { self.undo_step() };
        if done {
            self.note(if redo { HistoryEvent::Redo } else { HistoryEvent::Undo });
            return Ok(Answer::Done);
        }
        if self.has_people() {
            return match self.people.take_refusal() {
                true => Err(SceneError::OthersStep),
                false => Ok(Answer::NothingInMemory),
            };
        }
        self.report.missed += if redo { 1 } else { -1 };
        Ok(Answer::NothingInMemory)
    }

    /// The pens of the person whose command is applied.
    fn own_pens(&mut self) -> impl Iterator<Item = &mut PenSlot> {
        let people = &self.people;
        self.pens.iter_mut().filter(move |s| people.is_current(s.device))
    }

    /// Discards the curves that pens have laid. False: there were none.
    fn put_away(&mut self) -> bool {
        self.own_pens().fold(false, |any, s| s.track.cancel() | any)
    }

    fn cut(&mut self, carving: &Carving) -> CommandResult {
        self.lift_all();
        let active = self.scene.active();
        if active.settings.locked {
            return Err(SceneError::Locked(active.id));
        }
        let clay = &mut self.scene.active_mut().clay;
        clay.begin_step();
        let made = clay.graft(&carving.cut);
        self.close();
        let made = made.ok_or(SceneError::Stale)?;
        if carving.put_down {
            self.put_down();
        }
        Ok(Answer::Cut(made))
    }

    /// Lifts every pen and does every waiting dab, whatever the budget: the next command must see
    /// the strokes ended. Finishes carried-over topology too, as a part of the stroke's undo step:
    /// an undone and redone stroke is complete.
    fn lift_all(&mut self) {
        self.author(None);
        self.end_surface_edit();
        self.end_layer_edit();
        for seat in &mut self.pens {
            seat.track.lift();
        }
        self.hands.lift();
        self.advance_strokes(u64::MAX);
        self.let_go();
        self.topology.finish(&mut self.scene.active_mut().clay, &self.workers);
        self.close();
        self.author(self.person());
    }

    /// Closes the open step, with all that is still to be done to layers.
    fn close(&mut self) {
        let event = self.finish_layers();
        let World { timeline, scene, garbage, options, .. } = self;
        if timeline.end_step(scene, options.undo_bytes, garbage) {
            self.note(event);
        }
    }

    /// Index of the slot of a pen. A new one takes a free slot, or that of a pen which is away.
    /// `None`: every pen is in range or has dabs to lay.
    fn pen_slot(&mut self, device: DeviceId) -> Option<usize> {
        let known = self.pens.iter().position(|s| s.device == device);
        if known.is_some() {
            return known;
        }
        let new = PenSlot { device, track: PenTrack::default(), stroke: Stroke::default() };
        if self.pens.len() < MAX_PENS {
            self.pens.push(new);
            return Some(self.pens.len() - 1);
        }
        let away = self.pens.iter().position(|s| s.track.is_away());
        if let Some(at) = away {
            self.pens[at] = new;
        }
        away
    }

    fn apply_sample(&mut self, sample: &Sample) {
        match &sample.body {
            Body::Pen(pen) => {
                let index = self.pen_slot(sample.device);
                if !self.people.is_nobody() {
                    self.act_as(self.people.of_device(sample.device));
                }
                match index {
                    Some(i) => {
                        let on = (&self.desktop, self.desktop.place(sample.device));
                        let (brush, aspect) = (&self.brush, self.camera.aspect);
                        self.pens[i].track.take(pen, brush, aspect, on);
                    }
                    None => self.report.ignored += 1,
                }
            }
            Body::Hands(hands) => {
                self.hands_of(sample.device);
                self.act_as_hands();
                self.hands.follow(self.camera.target, self.camera.yaw);
                let before = self.hands.settings.reach;
                self.hands.take(sample.device, sample.t_us, hands);
                self.last_hands = Some(*hands);
                if let Some(choice) = self.hands.take_choice() {
                    self.timeline.set_person(self.person());
                    self.author(self.person());
                    self.choose(choice);
                    self.author(None);
                }
                if before != self.hands.settings.reach {
                    self.lay_hands();
                }
            }
            Body::Pad(_) => {}
        }
    }

    fn sculpt(&mut self) {
        if !self.surface_may_wait() || !self.layers_may_wait() {
            self.report.paused = true;
            return;
        }
        let left = self.advance_strokes(self.options.dab_budget);
        if !self.topology.is_empty() {
            let visited = self.options.dab_budget - left;
            self.topology.run(&mut self.scene.active_mut().clay, &self.workers, visited);
            self.report.paused |= !self.topology.is_empty();
        }
        self.report.topology_dropped += self.topology.take_dropped();
        self.let_go_of_what_no_hand_holds();
        let active = self.pens.iter().any(|s| s.track.is_open() || !s.track.is_idle())
            || self.hands.is_touching()
            || !self.topology.is_empty();
        match active {
            true => self.close_ended(),
            false => self.all_ended(),
        }
        self.settle_layers(active);
    }

    /// Advances the stroke of every pen in turn, then the hands, until `budget` vertices were
    /// visited. Returns what is left of it.
    fn advance_strokes(&mut self, budget: u64) -> u64 {
        let (mut left, mut from) = (budget, 0);
        while let Some(pen) = self.advance_pens(from, &mut left) {
            self.close_between_strokes(pen);
            from = pen;
        }
        self.author(None);
        while left > 0 {
            let Some(act) = self.hands.next_act() else { return left };
            left = self.by_hand(&act, left);
        }
        self.report.paused |= self.hands.has_waiting();
        left
    }

    /// Advances the strokes of the pens in turn, beginning with this one. Stops at a pen whose
    /// stroke has ended and whose next one waits, and returns its index: a slow line delivers
    /// several strokes at once, and each is a step.
    fn advance_pens(&mut self, from: usize, left: &mut u64) -> Option<usize> {
        let shared = self.has_people();
        let object = self.scene.active_mut();
        let transform = object.settings.transform;
        let mut clay = StrokeContext {
            editable: object.takes_strokes(),
            camera: LocalCamera::new(&self.camera, &transform),
            middle: object.middle,
            extent: object.extent,
            mesh: &mut object.clay,
            workers: &self.workers,
            scratch: &mut self.scratch,
            stroke: Stroke::default(),
            brush: self.brush,
            report: &mut self.report,
            left: *left,
            topology: &mut self.topology,
        };
        let mut between = None;
        for (index, seat) in self.pens.iter_mut().enumerate().skip(from) {
            if seat.track.begins() {
                self.strokes = self.strokes.wrapping_add(1);
                seat.stroke.begin(self.strokes);
            }
            // Each with the view and the brush of the person whose pen it is.
            let person = self.people.of_device(seat.device);
            let other = self.people.other(person);
            if shared {
                clay.mesh.set_author(Author::Person(person));
            }
            let now = other.map_or(&self.brush, |o| &o.brush);
            clay.brush = *seat.track.brush(now);
            let camera = other.map_or(&self.camera, |o| &o.camera);
            clay.camera = LocalCamera::new(camera, &transform);
            clay.stroke = seat.stroke;
            clay.stroke.rested += 1;
            while let Some(walked) = seat.track.walk_one(clay.camera.aspect(), &mut clay) {
                if walked.paused {
                    clay.report.paused = true;
                    break;
                }
                if walked.ended && seat.track.begins() {
                    between = Some(index);
                    break;
                }
                clay.brush = *seat.track.brush(now);
            }
            let goes_on = between.is_none() && goes_on_by_time(&clay.brush);
            let every = clay.brush.path.every_ticks as u32;
            if goes_on && seat.track.is_open() {
                clay.report.resting = true;
                if seat.track.is_idle() && clay.stroke.rested >= every {
                    seat.track.rest(&mut clay);
                }
            }
            seat.stroke = clay.stroke;
            if between.is_some() {
                break;
            }
        }
        *left = clay.left;
        between
    }
}

#[cfg(test)]
mod checkpoint_tests;
#[cfg(test)]
mod face_set_tests;
#[cfg(test)]
mod hand_damage_tests;
#[cfg(test)]
mod layer_tests;
#[cfg(test)]
mod local_remesh_tests;
#[cfg(test)]
mod own_undo_tests;
#[cfg(test)]
mod people_tests;
#[cfg(test)]
mod scene_combine_tests;
#[cfg(test)]
mod scene_tests;
#[cfg(test)]
mod surface_edit_tests;
#[cfg(test)]
mod tap_tests;
#[cfg(test)]
mod tests;
