//! Door 2: what the loop shows to everybody else, once a tick.
//!
//! Readers never block the loop and the loop never frees for them: published states come from a
//! small pool and go back to it; a state that a reader still holds is left to that reader.

use std::sync::Arc;

use arc_swap::ArcSwap;
use glam::Vec3;

use crate::people::{OwnInput, PeopleHere, PersonRole, SharedStanding};
use crate::tick_statistics::{Losses, Percentiles};
use sculptd_clay::brush::{BrushSettings, Picture};
use sculptd_clay::{GarbageSink, Hit, Ray, Snapshot};
use sculptd_devices::sample::MAX_HANDS;
use sculptd_devices::{DeviceId, Hands};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::{HeldObject, Pose, Volume};
use sculptd_engine::scene::{ObjectId, ObjectTransform, SceneView};
use sculptd_engine::stroke::{CurveStroke, PenPoint};
use sculptd_engine::world::{MAX_OTHERS, OthersPen, UndoRefusal, World};

/// Pens shown to a viewer.
pub const SHOWN_PENS: usize = 4;

/// The state of the world at the end of a tick, immutable.
#[derive(Debug, Clone)]
pub struct Published {
    pub tick: u64,
    /// The active object's clay, in its own frame.
    pub mesh: Snapshot,
    /// All objects; the same list as before, where none was added, removed, set or made active.
    pub scene: Arc<SceneView>,
    pub camera: Camera,
    pub brush: BrushSettings,
    /// The last settings of each brush that another one replaced.
    pub kept_brushes: Arc<Vec<BrushSettings>>,
    /// The height picture of the alpha `picture`, if one was loaded.
    pub picture: Option<Arc<Picture>>,
    /// Brush radius at full pressure, world units.
    pub brush_radius: f32,
    /// Bounding radius of the active object when it was put in place, world units.
    pub extent: f32,
    /// Middle of the active object when it was put in place, in the world: where the mirrors stand.
    pub middle: Vec3,
    /// The tracked volume over the work.
    pub volume: Volume,
    pub pens: [Option<(DeviceId, PenPoint)>; SHOWN_PENS],
    /// The devices whose pens press.
    pub pressing: [Option<DeviceId>; SHOWN_PENS],
    /// Position and normal of the last dab of each drawing pen; see [`World::last_dabs`].
    pub last_dabs: [Option<(DeviceId, [Vec3; 2])>; SHOWN_PENS],
    /// Position of each pen in range, as shares of its tablet's area.
    pub tablets: [Option<(DeviceId, glam::Vec2)>; SHOWN_PENS],
    /// The curve that a pen has laid; empty: none.
    pub draft: CurveStroke,
    pub hands: Option<Hands>,
    /// Pose of each tracked hand.
    pub poses: [Option<Pose>; MAX_HANDS],
    /// Number of the person whose hands these are; `None`: the sculpture is not shared.
    pub hands_of: Option<u8>,
    /// The tracker of each hand.
    pub hand_devices: [Option<DeviceId>; MAX_HANDS],
    /// The held object and its placement.
    pub thing: Option<HeldObject>,
    /// True if pinches pick up objects of the scene.
    pub picking: bool,
    /// The object of the scene that hands hold or held last.
    pub object_in_hand: Option<ObjectId>,
    /// The ball of the hand menu that a fingertip is in, and how far its ring has closed, from 0 to
    /// 1.
    pub menu: Option<(usize, f32)>,
    /// 0 fresh to 1 spent; and whether a lower plane of work should be offered.
    pub fatigue: (f32, bool),
    /// The next hands are measured for their reach.
    pub calibrating: bool,
    /// Dabs, or triangles under them, still wait for a tick that has time for them.
    pub is_behind: bool,
    /// Number of undo steps, including an edit in progress.
    pub undo_steps: usize,
    pub redo_steps: usize,
    /// The people who share the sculpture; `None`: it is not shared.
    pub people: Option<Arc<PeopleHere>>,
    /// Counts of the local input, if the sculpture is shared.
    pub own_input: OwnInput,
    /// The connection to the others, if the sculpture is shared.
    pub standing: SharedStanding,
    /// The newest undo or redo of the local person that was refused because another person's step
    /// blocks it.
    pub undo_refused: Option<UndoRefusal>,
    /// Contact points of the other people's pens with the clay.
    pub others: [Option<OthersPen>; MAX_OTHERS],
    pub figures: PublishedFigures,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct PublishedFigures {
    pub ticks: u64,
    pub samples: u64,
    pub dabs: u64,
    pub vertices_moved: u64,
    pub overruns: u64,
    /// Balls in which dynamic topology was still to be done and was given up.
    pub topology_dropped: u64,
    /// Number of times that the garbage queue was full and the overflow queue was used.
    pub garbage_overflows: u64,
    /// Number of times that input was held back for an operation, and the longest such time in
    /// microseconds.
    pub input_holds: u64,
    pub longest_hold_us: u64,
    pub tick_ms: Percentiles,
    pub losses: Losses,
    /// Duration of the newest tick, ms.
    pub last_tick_ms: f64,
    /// Time of the newest sample in this state, on the clock; 0 before the first.
    pub newest_us: u64,
    /// The tick that took it.
    pub newest_tick: u64,
    /// From that sample's time to the end of the tick that took it, ms.
    pub input_to_snapshot_ms: f64,
}

/// The pens in range, their last dabs, and where they are on their tablets.
type ShownPens = (
    [Option<(DeviceId, PenPoint)>; SHOWN_PENS],
    [Option<(DeviceId, [Vec3; 2])>; SHOWN_PENS],
    [Option<(DeviceId, glam::Vec2)>; SHOWN_PENS],
);

fn pressing(world: &World) -> [Option<DeviceId>; SHOWN_PENS] {
    let mut all = world.pressing();
    std::array::from_fn(|_| all.next())
}

fn shown_pens(world: &World) -> ShownPens {
    let (mut pens, mut last_dabs, mut tablets) =
        ([None; SHOWN_PENS], [None; SHOWN_PENS], [None; SHOWN_PENS]);
    for (slot, pen) in pens.iter_mut().zip(world.pens()) {
        *slot = Some(pen);
    }
    for (slot, dab) in last_dabs.iter_mut().zip(world.last_dabs()) {
        *slot = Some(dab);
    }
    for (slot, tablet) in tablets.iter_mut().zip(world.tablets()) {
        *slot = Some(tablet);
    }
    (pens, last_dabs, tablets)
}

impl Published {
    pub fn of(world: &mut World, figures: PublishedFigures) -> Self {
        let (pens, last_dabs, tablets) = shown_pens(world);
        let mut poses = [None; MAX_HANDS];
        let mut hand_devices = [None; MAX_HANDS];
        for ((pose, by), (device, _, now)) in
            poses.iter_mut().zip(&mut hand_devices).zip(world.poses())
        {
            (*pose, *by) = (Some(now), Some(device));
        }
        let mut others = [None; MAX_OTHERS];
        for (slot, pen) in others.iter_mut().zip(world.pens_of_others()) {
            *slot = Some(pen);
        }
        let mesh = world.snapshot();
        let scene = world.scene_view();
        let tools = world.hand_tools();
        Published {
            tick: world.tick(),
            mesh,
            scene,
            camera: *world.camera(),
            brush: *world.brush(),
            kept_brushes: world.kept_brushes().clone(),
            picture: world.picture().cloned(),
            brush_radius: world.brush_radius(),
            extent: world.extent(),
            middle: world.middle(),
            volume: *world.volume(),
            pens,
            pressing: pressing(world),
            last_dabs,
            tablets,
            draft: world.curve_stroke().cloned().unwrap_or_default(),
            hands: world.hands().copied(),
            poses,
            hands_of: world.person_of_hands(),
            hand_devices,
            thing: world.thing().cloned(),
            picking: world.is_picking(),
            object_in_hand: world.object_in_hand(),
            menu: tools.menu().showing(),
            fatigue: (tools.fatigue().spent(), tools.fatigue().wants_lower()),
            calibrating: tools.is_calibrating(),
            is_behind: world.report().paused,
            undo_steps: world.undo_steps() + usize::from(world.is_taken_back_by(&Command::Undo)),
            redo_steps: world.redo_steps(),
            people: None,
            own_input: OwnInput::default(),
            standing: SharedStanding::default(),
            undo_refused: world.undo_refused(),
            others,
            figures,
        }
    }

    /// Shows the local state of a world that runs ahead: the active clay, pens, brush and view.
    pub fn show_ahead(&mut self, ahead: &mut World) {
        self.mesh = ahead.snapshot();
        (self.camera, self.brush) = (*ahead.camera(), *ahead.brush());
        self.kept_brushes = ahead.kept_brushes().clone();
        self.brush_radius = ahead.brush_radius();
        self.draft = ahead.curve_stroke().cloned().unwrap_or_default();
        (self.pens, self.last_dabs, self.tablets) = shown_pens(ahead);
        self.pressing = pressing(ahead);
    }

    /// Returns the person whose hands are tracked, if not the local person.
    pub fn others_hands(&self) -> Option<u8> {
        let own = self.people.as_ref()?.own;
        self.hands_of.filter(|of| *of != own && *of != 0)
    }

    /// Returns the transform of the active object.
    pub fn transform(&self) -> ObjectTransform {
        self.scene.active().map_or(ObjectTransform::NONE, |o| o.settings.transform)
    }

    /// Returns the object id and the revision of the active clay.
    pub fn clay_revision(&self) -> (u32, u64) {
        (self.mesh.object_id(), self.mesh.revision())
    }

    /// Returns the nearest point of the active object on a ray, both in the world's frame.
    pub fn pick(&self, ray: Ray) -> Option<Hit> {
        let transform = self.transform();
        if transform.is_none() {
            return self.mesh.pick(ray);
        }
        let own = transform.inverse().ray(ray);
        let hit = self.mesh.pick(own)?;
        let t = (f64::from(hit.t) * transform.scale) as f32;
        let (position, normal) = (transform.point(hit.position), transform.direction(hit.normal));
        Some(Hit { position, normal, t, ..hit })
    }

    /// The box in the world around all visible objects; around the active one where none is.
    pub fn world_bounds(&self) -> (Vec3, Vec3) {
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let seen = self.scene.each(&self.mesh).filter(|(o, _)| o.settings.visible);
        let all = seen.fold(none, |(lo, hi), (o, clay)| {
            let (a, b) = o.settings.transform.bounds(clay.bounds());
            (lo.min(a), hi.max(b))
        });
        if all.0.cmple(all.1).all() { all } else { self.transform().bounds(self.mesh.bounds()) }
    }

    /// Returns true if this daemon's person only looks on at a shared sculpture.
    pub fn looks_on(&self) -> bool {
        // Without a network this person has number 0, as guests who only watch on a page have.
        let shared = self.people.as_ref().filter(|people| people.own != 0);
        let person = shared.and_then(|people| people.person(people.own));
        person.is_some_and(|person| person.role == PersonRole::Viewer)
    }

    /// Returns one hash of all objects; the cost grows with their size.
    pub fn hash(&self) -> u64 {
        self.scene.hash(&self.mesh)
    }

    /// Returns true if this state holds memory that `newer` does not share.
    fn holds_other(&self, newer: &Published) -> bool {
        let people = |state: &Published| state.people.as_ref().map(Arc::as_ptr);
        let held = |state: &Published| state.thing.as_ref().map(|held| Arc::as_ptr(&held.plain));
        self.mesh.object_id() != newer.mesh.object_id()
            || !Arc::ptr_eq(&self.scene, &newer.scene)
            || people(self) != people(newer)
            || held(self) != held(newer)
    }
}

/// The loop's end of door 2.
#[derive(Debug)]
pub struct Publisher {
    shown: Arc<ArcSwap<Published>>,
    /// States that were shown before; reused once no reader holds them.
    pool: Vec<Arc<Published>>,
}

/// States kept for reuse: the one shown, one in a reader's hands a viewer and a worker each, and
/// two to spare.
const POOL: usize = 6;

impl Publisher {
    pub fn new(first: Published) -> Self {
        Publisher { shown: Arc::new(ArcSwap::from_pointee(first)), pool: Vec::with_capacity(POOL) }
    }

    /// The reader's end: `load_full` gives the newest state.
    pub fn reader(&self) -> Arc<ArcSwap<Published>> {
        self.shown.clone()
    }

    /// Shows a new state. What an old one held goes to the sink where it may be the last that holds
    /// it: the pages of another object, the triangles of what a hand has put down.
    pub fn publish(&mut self, state: Published, sink: &GarbageSink) {
        let free = self.pool.iter_mut().position(|old| Arc::get_mut(old).is_some());
        let next = match free {
            Some(i) => {
                let mut next = self.pool.swap_remove(i);
                if let Some(slot) = Arc::get_mut(&mut next) {
                    let other = slot.holds_other(&state);
                    let old = std::mem::replace(slot, state);
                    if other {
                        sink.discard_owned(old);
                    }
                }
                next
            }
            None => Arc::new(state),
        };
        let old = self.shown.swap(next);
        if self.pool.len() < POOL {
            self.pool.push(old);
        }
    }
}
