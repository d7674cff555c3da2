//! The world: clay, camera, brush, strokes. [`World::step`] is the only writer.
//!
//! Laws kept here:
//! * Two things change the world: a `Sample` and a `Command`. Both are plain data.
//! * `step` has no clock, no IO, no threads of its own making, and cannot fail: same start, same
//!   samples and commands, same bits, with any number of workers.
//! * One step is bounded: dabs stop at the budget and go on in the next step, and so does dynamic
//!   topology, whose budget is what dabs leave.

mod saved;
mod state;
mod stroke_context;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

pub use self::saved::{BadState, HistoryEntry, HistoryEvent, Saved, SideData};
use self::stroke_context::{Stroke, StrokeContext};
use crate::camera::Camera;
use crate::command::{Carving, Command, NewClay};
use crate::desktop_layout::DesktopLayout;
use crate::hand::{Act, HandSettings, HandTools, HeldObject, MenuItem, ReachBox, Similarity};
use crate::mask_region::MaskSeen;
use crate::payload::{Payload, PayloadStore};
use crate::replaced::ReplacedClay;
use crate::stroke::{CurveAction, PenTrack};
use crate::topology_work::TopologyWork;
use sculptd_clay::brush::mask_all::MaskAll;
use sculptd_clay::brush::{BrushSettings, Grip, Measure, Method, Scratch};
use sculptd_clay::{Clay, Garbage, GarbageSink, Grafted, Kernel, PageSupply, Reach, Workers};
use sculptd_devices::{Body, DeviceId, Hands, Sample};
use sculptd_geometry::portable::turn_about;
use sculptd_geometry::{PolyMesh, TriMesh, shapes};

/// Devices that may sculpt at once. A device beyond them is heard but does not sculpt;
/// `StepReport::ignored` counts it.
pub const MAX_PENS: usize = 16;

/// What one step did. Reused from step to step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepReport {
    /// Samples that the step was given.
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
    /// Undo or redo was asked for, and nothing in memory answers to it: for whoever keeps the
    /// history outside.
    pub missed: Option<HistoryEvent>,
    /// Balls in which dynamic topology was still to be done and was given up: more waited than the
    /// list holds, or than could be done before a command that ends strokes.
    pub topology_dropped: u64,
    /// Jumps within the history that were made.
    pub jumps: u64,
}

/// Fixed for the life of a world.
#[derive(Debug, Clone, Copy)]
pub struct WorldOptions {
    /// Vertices that the dabs of one step may visit.
    pub dab_budget: u64,
    /// Bytes that undo may hold; the oldest steps go first.
    pub undo_bytes: u64,
    /// How hands are read.
    pub hands: HandSettings,
}

/// One pen at work.
#[derive(Debug, Serialize, Deserialize)]
struct PenSlot {
    device: DeviceId,
    track: PenTrack,
    stroke: Stroke,
}

/// The whole state. [`World::step`] is the only writer.
#[derive(Debug)]
pub struct World {
    tick: u64,
    mesh: Clay,
    workers: Workers,
    options: WorldOptions,
    brush: BrushSettings,
    /// What each brush was set to when it was last exchanged for another.
    kept_brushes: Arc<Vec<BrushSettings>>,
    camera: Camera,
    /// Centre and bounding radius of the object when it was put in place: the measure of brushes,
    /// mirrors and hands.
    middle: Vec3,
    extent: f32,
    pens: Vec<PenSlot>,
    /// Where the pens are in the view, and where they may begin.
    desktop: DesktopLayout,
    scratch: Scratch,
    /// Where triangles are still to be brought to their size.
    topology: TopologyWork,
    /// Strokes begun.
    strokes: u32,
    hands: HandTools,
    last_hands: Option<Hands>,
    /// What the hands hold.
    thing: Option<HeldObject>,
    report: StepReport,
    /// Clay before and after this one, for undo.
    works: ReplacedClay,
    /// Takes what is no longer needed: clay that was replaced, payloads that no command took.
    garbage: GarbageSink,
    /// Gives pages that dynamic topology needs.
    pages: PageSupply,
    payloads: PayloadStore,
    /// What came of the cuts of this tick, in the order of their commands.
    cuts: Vec<Option<Grafted>>,
    /// Objects put in place so far.
    lineages: u32,
    /// What was done in this tick, for the session's history; `None`: no history is kept.
    moments: Option<Vec<HistoryEntry>>,
}

impl World {
    /// A world at tick 0 around this clay; the camera frames it.
    pub fn new(
        mut mesh: Clay,
        camera: Camera,
        brush: BrushSettings,
        workers: Workers,
        options: WorldOptions,
    ) -> Self {
        mesh.set_undo_bytes(options.undo_bytes);
        let mut world = World {
            tick: 0,
            mesh,
            workers,
            options,
            brush: brush.clamped(),
            kept_brushes: Arc::default(),
            camera,
            middle: Vec3::ZERO,
            extent: 1.0,
            pens: Vec::with_capacity(MAX_PENS),
            desktop: DesktopLayout::default(),
            scratch: Scratch::default(),
            topology: TopologyWork::new(),
            strokes: 0,
            hands: HandTools::new(options.hands),
            last_hands: None,
            thing: None,
            report: StepReport::default(),
            works: ReplacedClay::default(),
            garbage: GarbageSink::default(),
            pages: PageSupply::default(),
            payloads: PayloadStore::new(),
            cuts: Vec::with_capacity(PayloadStore::CAPACITY),
            lineages: 0,
            moments: None,
        };
        world.measure();
        world.frame();
        world
    }

    fn measure(&mut self) {
        let (lo, hi) = self.mesh.bounds();
        let (lo, hi) = if lo.cmple(hi).all() { (lo, hi) } else { (Vec3::splat(-1.0), Vec3::ONE) };
        self.middle = (lo + hi) * 0.5;
        self.extent = ((hi - lo).length() * 0.5).max(1e-12);
        self.hands.lay(self.middle, self.extent, self.camera.yaw);
    }

    fn frame(&mut self) {
        let (lo, hi) = self.mesh.bounds();
        if lo.cmple(hi).all() {
            self.camera.frame(lo, hi);
        }
    }

    /// One tick: commands first, in order, then samples in order of time (ties by device), then
    /// the path points that the budget of the tick before left over.
    pub fn step(&mut self, tick: u64, samples: &[Sample], commands: &[Command]) -> &StepReport {
        self.tick = tick;
        self.report = StepReport { samples: samples.len() as u64, ..StepReport::default() };
        self.cuts.clear();
        let (object_id, garbage) = (self.mesh.object_id(), &self.garbage);
        for entry in self.moments.iter_mut().flat_map(|m| m.drain(..)) {
            // It may be the last that holds the pages of an object that was replaced.
            if entry.work.object_id() != object_id {
                garbage.discard_owned(entry);
            }
        }
        for command in commands {
            self.apply_command(command);
        }
        for sample in samples {
            self.apply_sample(sample);
        }
        self.sculpt();
        if self.report.vertices_moved > 0 {
            self.works.forget_future(&self.garbage);
        }
        self.payloads.clear(&self.garbage);
        &self.report
    }

    fn apply_command(&mut self, command: &Command) {
        match command {
            Command::Brush(brush) => {
                self.keep_brush(brush);
                self.brush = brush.clamped();
                if self.brush.topology.by != Measure::Off && self.brush.kind.cuts() {
                    self.mesh.prepare_topology();
                }
                let lays = self.brush.kind.grip() == Grip::Surface
                    && self.brush.path.method == Method::Curve;
                if !lays {
                    self.put_away();
                }
            }
            // A curve that a pen has laid is newer than the last step.
            Command::Undo if self.put_away() => {}
            Command::CurveStroke(act) => match act {
                CurveAction::Apply => self.pens.iter_mut().for_each(|s| s.track.apply()),
                CurveAction::Cancel => {
                    self.put_away();
                }
                CurveAction::Delete(handle) => {
                    let _ = self.pens.iter_mut().any(|s| s.track.delete(*handle));
                }
            },
            Command::Camera(camera) => {
                if camera.is_sane() {
                    self.camera = *camera;
                }
            }
            Command::DesktopLayout(desktop) => {
                if desktop.is_sane() {
                    self.desktop = *desktop;
                }
            }
            Command::Undo => {
                self.lift_all();
                match self.mesh.undo() || self.works.back(&mut self.mesh) {
                    true => self.note(HistoryEvent::Undo),
                    false => self.report.missed = Some(HistoryEvent::Undo),
                }
            }
            Command::Redo => {
                self.lift_all();
                match self.mesh.redo() || self.works.forth(&mut self.mesh) {
                    true => self.note(HistoryEvent::Redo),
                    false => self.report.missed = Some(HistoryEvent::Redo),
                }
            }
            Command::LiftAll => self.lift_all(),
            Command::TakeUp(plain) => self.take_up(plain.clone()),
            Command::PutDown => self.put_down(),
            Command::CalibrateReach => self.hands.calibrate(),
            Command::Reach(reach) => self.set_reach(*reach),
            Command::Picture(picture) => {
                if picture.is_sane()
                    && let Some(old) = self.scratch.picture.replace(picture.clone())
                {
                    self.garbage.discard(Garbage::Shared(old));
                }
            }
            Command::Begin(new) => {
                self.lift_all();
                if new.camera.is_sane()
                    && let Some(mesh) = self.built(&new.clay, &[])
                {
                    let workers = std::mem::replace(&mut self.workers, Workers::new(1));
                    let fresh = World::new(mesh, new.camera, new.brush, workers, self.options);
                    let mut old = std::mem::replace(self, fresh);
                    self.lineages = old.lineages + 1;
                    self.mesh.set_object_id(self.lineages);
                    self.moments = old.moments.take();
                    self.desktop = old.desktop;
                    self.tick = old.tick;
                    self.report = old.report;
                    std::mem::swap(&mut self.payloads, &mut old.payloads);
                    std::mem::swap(&mut self.cuts, &mut old.cuts);
                    self.set_garbage_sink(old.garbage.clone());
                    self.set_page_supply(old.pages.clone());
                    self.garbage.discard_owned(old);
                    self.note(HistoryEvent::Begin);
                }
            }
            Command::Mask(action) => {
                self.mask(&MaskAll { action: *action, extent: self.extent });
            }
            Command::MaskRegion(region) => {
                let camera = self.camera;
                if region.is_sane() {
                    self.mask(&MaskSeen { region, camera: &camera });
                }
            }
            Command::Place(place) => {
                if let Some(thing) = self.thing.as_mut().filter(|_| place.is_sane()) {
                    thing.place = *place;
                }
            }
            Command::Cut(carving) => self.cut(carving),
            Command::Replace(new) => self.replace(new, &[]),
            Command::ReplaceMasked(new, masks) => self.replace(new, masks),
            Command::Jump(jump) => self.jump(jump),
            Command::Reopened => {
                self.lift_all();
                // It was of a window that is gone: who opens the session says its own.
                self.desktop = DesktopLayout::default();
                self.forget_steps();
            }
        }
    }

    /// Discards the curves that pens have laid. False: there were none.
    fn put_away(&mut self) -> bool {
        self.pens.iter_mut().fold(false, |any, s| s.track.cancel() | any)
    }

    fn replace(&mut self, new: &NewClay, masks: &[f32]) {
        self.lift_all();
        let Some(mut mesh) = self.built(new, masks) else { return };
        mesh.set_garbage_sink(self.garbage.clone());
        mesh.set_page_supply(self.pages.clone());
        mesh.set_undo_bytes(self.options.undo_bytes);
        mesh.set_levels(new.levels.clone());
        self.lineages += 1;
        mesh.set_object_id(self.lineages);
        let World { works, garbage, mesh: now, options, .. } = self;
        if new.keep_camera {
            works.replace(now, mesh, options.undo_bytes, garbage);
        } else {
            works.forget(garbage);
            garbage.discard_owned(std::mem::replace(now, mesh));
            self.measure();
            self.frame();
        }
        self.note(HistoryEvent::Replace);
    }

    /// The clay of a new object: the payload where there is one, else built here.
    fn built(&mut self, new: &NewClay, masks: &[f32]) -> Option<Clay> {
        match new.built.and_then(|id| self.payloads.take(id)) {
            Some(Payload::Clay(clay)) => return Some(*clay),
            Some(other) => self.garbage.discard_owned(other),
            None => {}
        }
        Clay::build_masked(&new.plain, masks, &Default::default()).ok()
    }

    fn cut(&mut self, carving: &Carving) {
        self.lift_all();
        self.mesh.begin_step();
        let made = self.mesh.graft(&carving.cut);
        self.close();
        if made.is_some() {
            self.works.forget_future(&self.garbage);
            if carving.put_down {
                self.put_down();
            }
        }
        self.cuts.push(made);
    }

    /// Every pen is lifted and every waiting dab is done, whatever the budget: what follows must
    /// see the strokes ended. So is topology that was carried over, as a part of the stroke's undo
    /// step: a stroke that is taken back and done again is whole.
    fn lift_all(&mut self) {
        for seat in &mut self.pens {
            seat.track.lift();
        }
        self.hands.lift();
        self.advance_strokes(u64::MAX);
        self.topology.finish(&mut self.mesh, &self.workers);
        self.close();
    }

    /// Closes the open step.
    fn close(&mut self) {
        if self.mesh.end_step() {
            self.note(HistoryEvent::Step);
        }
    }

    /// An object appears beside the clay, a third as large as it, for the hands to carry.
    fn take_up(&mut self, plain: Arc<TriMesh>) {
        let (lo, hi) = plain.bounds();
        let size = (hi - lo).length() * 0.5;
        if !(size.is_finite() && size > 0.0) {
            return;
        }
        let scale = self.extent / 3.0 / size;
        let turn = turn_about(Vec3::Y, self.camera.yaw);
        let at = self.middle + turn * Vec3::new(self.extent * 1.2, self.extent * 0.4, 0.0);
        let place = Similarity { shift: at - turn * ((lo + hi) * 0.5 * scale), turn, scale };
        if place.is_sane() {
            self.put_down();
            self.thing = Some(HeldObject { plain, place });
            self.hands.carrying = true;
        }
    }

    fn put_down(&mut self) {
        if let Some(held) = self.thing.take() {
            self.garbage.discard(Garbage::Shared(held.plain));
        }
        self.hands.carrying = false;
    }

    fn set_reach(&mut self, reach: ReachBox) {
        if reach.is_sane() {
            self.hands.settings.reach = reach;
            self.hands.lay(self.middle, self.extent, self.camera.yaw);
        }
    }

    fn choose(&mut self, choice: MenuItem) {
        let primitive = |solid: PolyMesh| Arc::new(solid.triangulate().0);
        match choice {
            MenuItem::Undo => self.apply_command(&Command::Undo),
            MenuItem::Redo => self.apply_command(&Command::Redo),
            MenuItem::PutAway => self.put_down(),
            MenuItem::Ball => self.take_up(primitive(shapes::uv_sphere(1.0, 24, 48))),
            MenuItem::Box => self.take_up(primitive(shapes::cuboid(DVec3::NEG_ONE, DVec3::ONE))),
            MenuItem::Cylinder => self.take_up(primitive(shapes::cylinder(1.0, 2.0, 48))),
            MenuItem::Add | MenuItem::Carve | MenuItem::Keep => self.report.join = Some(choice),
        }
    }

    fn apply_sample(&mut self, sample: &Sample) {
        match &sample.body {
            Body::Pen(pen) => {
                let index =
                    self.pens.iter().position(|s| s.device == sample.device).or_else(|| {
                        (self.pens.len() < MAX_PENS).then(|| {
                            self.pens.push(PenSlot {
                                device: sample.device,
                                track: PenTrack::default(),
                                stroke: Stroke::default(),
                            });
                            self.pens.len() - 1
                        })
                    });
                match index {
                    Some(i) => {
                        let on = (&self.desktop, self.desktop.place(sample.device));
                        let (path, aspect) = (&self.brush.path, self.camera.aspect);
                        self.pens[i].track.take(pen, path, aspect, on);
                    }
                    None => self.report.ignored += 1,
                }
            }
            Body::Hands(hands) => {
                self.hands.follow(self.camera.target, self.camera.yaw);
                let before = self.hands.settings.reach;
                self.hands.take(sample.device, sample.t_us, hands);
                self.last_hands = Some(*hands);
                if let Some(choice) = self.hands.take_choice() {
                    self.choose(choice);
                }
                if before != self.hands.settings.reach {
                    self.set_reach(self.hands.settings.reach);
                }
            }
            Body::Pad(_) => {}
        }
    }

    fn sculpt(&mut self) {
        let left = self.advance_strokes(self.options.dab_budget);
        if !self.topology.is_empty() {
            let visited = self.options.dab_budget - left;
            self.topology.run(&mut self.mesh, &self.workers, visited);
            self.report.paused |= !self.topology.is_empty();
        }
        self.report.topology_dropped += self.topology.take_dropped();
        let active = self.pens.iter().any(|s| s.track.is_open() || !s.track.is_idle())
            || self.hands.is_touching()
            || !self.topology.is_empty();
        if !active {
            self.close();
        }
    }

    /// Advances the stroke of every pen in turn, then the hands, until `budget` vertices were
    /// visited. Returns what is left of it.
    fn advance_strokes(&mut self, budget: u64) -> u64 {
        let goes_on = self.goes_on_by_time();
        let every = self.brush.path.every_ticks as u32;
        let mut clay = StrokeContext {
            mesh: &mut self.mesh,
            workers: &self.workers,
            scratch: &mut self.scratch,
            stroke: Stroke::default(),
            camera: &self.camera,
            brush: &self.brush,
            middle: self.middle,
            extent: self.extent,
            report: &mut self.report,
            left: budget,
            topology: &mut self.topology,
        };
        for seat in &mut self.pens {
            if seat.track.begins() {
                self.strokes = self.strokes.wrapping_add(1);
                seat.stroke.begin(self.strokes);
            }
            clay.stroke = seat.stroke;
            clay.stroke.rested += 1;
            while let Some(walked) = seat.track.walk_one(clay.camera.aspect, &mut clay) {
                if walked.paused {
                    clay.report.paused = true;
                    break;
                }
                if walked.ended && seat.track.begins() {
                    self.strokes = self.strokes.wrapping_add(1);
                    clay.stroke.begin(self.strokes);
                }
            }
            if goes_on && seat.track.is_open() {
                clay.report.resting = true;
                if seat.track.is_idle() && clay.stroke.rested >= every {
                    seat.track.rest(&mut clay);
                }
            }
            seat.stroke = clay.stroke;
        }
        let mut left = clay.left;
        while left > 0 {
            let Some(act) = self.hands.next_act() else { return left };
            left = self.by_hand(&act, left);
        }
        self.report.paused |= self.hands.has_waiting();
        left
    }

    /// Whether dabs go on while a pen rests.
    fn goes_on_by_time(&self) -> bool {
        let path = &self.brush.path;
        let spaced = matches!(path.method, Method::Space | Method::Airbrush | Method::Dots);
        self.brush.kind.grip() == Grip::Surface
            && spaced
            && (path.continuous || path.method == Method::Airbrush)
    }

    /// One act of a hand; returns what is left of the budget.
    fn by_hand(&mut self, act: &Act, left: u64) -> u64 {
        let camera = &mut self.camera;
        match act {
            Act::Orbit(by) => camera.orbit(*by),
            Act::Zoom(factor) => camera.zoom(*factor),
            Act::Move(by) => camera.target -= *by,
            Act::Hold { before, after } => {
                // The camera keeps its place among the hands.
                let mm = before.turn.inverse() * (camera.target - before.origin) / before.scale;
                camera.target = after.to_world(mm);
                camera.distance = (camera.distance * after.scale / before.scale).clamp(1e-6, 1e9);
            }
            Act::Carry(by) => {
                if let Some(thing) = &mut self.thing {
                    thing.carry(by);
                }
            }
            Act::Push(a) => return self.touch(&a.reach(), &a.kernel(), left),
            Act::Drag(a) => return self.touch(&a.reach(), &a.kernel(), left),
            Act::Palm(a) => return self.touch(&a.reach(), &a.kernel(), left),
        }
        left
    }

    fn touch<K: Kernel>(&mut self, reach: &Reach, kernel: &K, left: u64) -> u64 {
        self.mesh.begin_step();
        let report = self.mesh.dab(reach, kernel, &self.workers);
        if report.moved > 0 {
            self.report.dabs += 1;
            self.hands.sculpted();
        }
        self.report.vertices_moved += report.moved as u64;
        left.saturating_sub(report.affected as u64 + 1)
    }
}

#[cfg(test)]
mod tap_tests;
#[cfg(test)]
mod tests;
