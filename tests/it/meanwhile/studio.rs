//! A running loop with a pen that draws on the left half of a ball, and a record of its input.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use glam::{DVec3, Vec2, Vec3};

use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_clay::{Clay, Ray, Workers};
use sculptd_daemon::Published;
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::live::Live;
use sculptd_daemon::operations::{self, Computed, Installed, OperationError, Target};
use sculptd_daemon::session::format::Settings;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample, queue};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;

/// Room in the channel of samples: more than a pen sends while the input is held.
const ROOM: usize = 1024;
/// Time between two samples.
const EVERY: Duration = Duration::from_millis(2);

/// Input of one tick.
type Input = (u64, Vec<Sample>, Vec<Command>);

/// Records what the world was given, and passes it on to a session.
struct Recorder {
    all: Arc<Mutex<Vec<Input>>>,
    session: Option<Box<dyn Journal>>,
}

impl Journal for Recorder {
    fn tick(&mut self, tick: u64, samples: &[Sample], commands: &[Command], world: &mut World) {
        self.all.lock().expect("whole").push((tick, samples.to_vec(), commands.to_vec()));
        if let Some(session) = &mut self.session {
            session.tick(tick, samples, commands, world);
        }
    }

    fn has_waiting(&self) -> bool {
        self.session.as_ref().is_some_and(|s| s.has_waiting())
    }
}

/// How the pen draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// A stroke of 60 samples, a gap of 4, and so on.
    Many,
    /// One stroke without an end.
    One,
}

/// The pen's thread: it draws until it is told to stop. Returns the number of contact changes.
pub struct Drawing {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<(queue::Sender, u64)>,
}

pub struct Studio {
    pub live: Live,
    start: (TriMesh, BrushSettings),
    record: Arc<Mutex<Vec<Input>>>,
    pen: Option<queue::Sender>,
    contacts: u64,
    clock: Clock,
    /// The middle of what the pen draws on, on the unit ball.
    pub under: Vec3,
}

pub fn wait(time: Duration) {
    let _ = crossbeam_channel::never::<()>().recv_timeout(time);
}

pub fn brush() -> BrushSettings {
    let brush = sculptd::presets().of(BrushKind::Draw);
    BrushSettings { radius: 0.12, strength: 0.06, ..brush }
}

pub fn options() -> WorldOptions {
    WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 30, hands: Default::default() }
}

/// The settings of a session of such a world.
pub fn settings(brush: BrushSettings) -> Settings {
    let WorldOptions { dab_budget, undo_bytes, hands } = options();
    let rate_hz = LoopConfig::default().rate_hz;
    Settings { rate_hz, dab_budget, undo_bytes, camera: Camera::default(), brush, hands }
}

fn world(plain: &TriMesh, brush: BrushSettings, workers: usize) -> World {
    let clay = Clay::build(plain, &Job::default()).expect("a ball");
    World::new(clay, Camera::default(), brush, Workers::new(workers), options())
}

/// The pen's path in the view: on the left half, never twice at the same place.
fn path(i: u64) -> Vec2 {
    let t = i as f32;
    Vec2::new(0.43 + 0.03 * (t * 0.0113).cos(), 0.5 + 0.12 * (t * 0.0071).sin())
}

impl Studio {
    pub fn new(plain: TriMesh, brush: BrushSettings, workers: usize) -> Studio {
        Studio::kept(plain, brush, workers, None)
    }

    /// As [`Studio::new`]; everything also goes to a session.
    pub fn kept(
        plain: TriMesh,
        brush: BrushSettings,
        workers: usize,
        session: Option<Box<dyn Journal>>,
    ) -> Studio {
        let world = world(&plain, brush, workers);
        let Ray { origin, dir } = world.camera().ray(Vec2::new(0.43, 0.5));
        let under =
            world.mesh().pick(Ray { origin, dir }).expect("the pen is on the ball").position;
        let (factory, receiver) = queue::channel(ROOM);
        let record: Arc<Mutex<Vec<Input>>> = Arc::default();
        let recorder = Box::new(Recorder { all: record.clone(), session });
        let clock = Clock::monotonic();
        let live =
            Live::start(world, receiver, clock.clone(), LoopConfig::default(), 256, Some(recorder));
        let pen = Some(factory.sender());
        let live = live.expect("runs");
        Studio { live, start: (plain, brush), record, pen, contacts: 0, clock, under }
    }

    pub fn to(&self) -> Target<'_> {
        Target { published: &self.live.published, commands: &self.live.commands }
    }

    pub fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    pub fn shown(&self) -> Arc<Published> {
        self.live.published.load_full()
    }

    pub fn tell(&self, command: Command) {
        let done = self.live.commands.carry_out(command, Duration::from_secs(30));
        done.expect("answered").result.expect("done");
    }

    /// Starts the pen, and waits until it has sculpted.
    pub fn draw(&mut self, pace: Pace) -> Drawing {
        let mut sender = self.pen.take().expect("one pen");
        let stop: Arc<AtomicBool> = Arc::default();
        let (stopped, clock) = (stop.clone(), self.clock.clone());
        let thread = std::thread::spawn(move || {
            let (mut i, mut down, mut contacts) = (0u64, false, 0);
            while !stopped.load(Relaxed) {
                let tip = pace == Pace::One || i % 64 < 60;
                contacts += u64::from(tip != down);
                down = tip;
                sender.push(sample(&clock, i, tip, true));
                i += 1;
                wait(EVERY);
            }
            contacts += u64::from(down);
            sender.push(sample(&clock, i, false, true));
            sender.push(sample(&clock, i, false, false));
            while !sender.flush() {
                wait(EVERY);
            }
            (sender, contacts)
        });
        let dabs = self.shown().figures.dabs;
        self.comes("the pen sculpts", |shown| shown.figures.dabs > dabs + 3);
        Drawing { stop, thread }
    }

    /// Lets the pen draw on for a moment, lifts it and waits until all that it did is seen.
    pub fn end(&mut self, drawing: Drawing) {
        wait(Duration::from_millis(60));
        drawing.stop.store(true, Relaxed);
        let (sender, contacts) = drawing.thread.join().expect("the pen's thread ends");
        self.contacts += contacts;
        let stats = sender.stats();
        self.pen = Some(sender);
        let begun = self.now_us();
        while stats.total().on_the_way() > 0 {
            assert!(self.now_us() - begun < 30_000_000, "samples never arrive");
            wait(EVERY);
        }
        assert_eq!(stats.total().lost_transition, 0);
        self.tell(Command::LiftAll);
    }

    pub fn comes(&self, what: &str, is: impl Fn(&Published) -> bool) {
        let begun = self.now_us();
        while !is(&self.shown()) {
            assert!(self.now_us() - begun < 30_000_000, "never: {what}");
            wait(EVERY);
        }
    }

    /// Has an operation carried out while the pen draws.
    pub fn operate<T>(
        &mut self,
        pace: Pace,
        compute: impl Fn(&Published, &Job) -> Result<Computed<T>, OperationError>,
    ) -> Result<Installed<T>, OperationError> {
        let drawing = self.draw(pace);
        let job = Job::default();
        let done = operations::carry_out(self.to(), &job, |now| compute(now, &job));
        self.end(drawing);
        done
    }

    /// Ends the loop, and checks what must hold of every run: no contact is lost; a replay gives
    /// the same; and undo brings back the very bits from before each change of a whole object.
    pub fn check(self) -> Checked {
        let Studio { live, start: (plain, brush), record, contacts, .. } = self;
        let mut ended = live.stop().expect("ends");
        let record = std::mem::take(&mut *record.lock().expect("whole"));
        ended.world.verify_invariants().expect("sound");
        let mut tip = false;
        let mut seen = 0;
        for sample in record.iter().flat_map(|r| &r.1) {
            if let Body::Pen(pen) = &sample.body {
                seen += u64::from(pen.tip != tip);
                tip = pen.tip;
            }
        }
        assert_eq!(seen, contacts, "contacts came");
        // With it, and as if nobody had asked for a change of the whole object.
        let mut again = world(&plain, brush, 1);
        let mut without = world(&plain, brush, 2);
        let mut before = Vec::new();
        // The world before a tick, with every stroke ended.
        let lifted = |until: u64| {
            let mut early = world(&plain, brush, 1);
            for (tick, samples, commands) in record.iter().take_while(|r| r.0 < until) {
                early.step(*tick, samples, commands);
            }
            early.step(until, &[], &[Command::LiftAll]);
            (early.undo_steps(), early.hash())
        };
        for (tick, samples, commands) in &record {
            let was = commands.iter().any(is_change).then(|| (again.undo_steps(), again.hash()));
            let open = again.mesh().is_in_step();
            again.step(*tick, samples, commands);
            // One that was refused has changed nothing.
            let done = |i: usize| is_change(&commands[i]) && again.answers()[i].is_ok();
            if let Some(first) = (0..commands.len()).find(|i| done(*i)) {
                assert_eq!(first, 0, "what comes before it in its tick is undone with it");
                // A local cut and an exchange end a stroke themselves.
                before.extend(if open { Some(lifted(*tick)) } else { was });
            }
            let commands: Vec<_> = commands.iter().filter(|c| !is_change(c)).cloned().collect();
            without.step(*tick, samples, &commands);
        }
        assert_eq!(again.hash(), ended.world.hash(), "a replay gives the same");
        let hash = ended.world.hash();
        let masks = without.snapshot().masks();
        let reference = without.mesh().to_tri();
        let result = ended.world.mesh().to_tri();
        let mut tick = ended.world.tick();
        for (steps, hash) in before.iter().rev() {
            while ended.world.undo_steps() > *steps {
                tick += 1;
                ended.world.step(tick, &[], &[Command::Undo]);
            }
            assert_eq!(ended.world.hash(), *hash, "undo gives the bits from before");
        }
        Checked { hash, reference, masks, result, installed: before.len() }
    }
}

fn is_change(command: &Command) -> bool {
    use sculptd_engine::scene::SceneCommand;
    match command {
        Command::Rebased(_) => true,
        Command::OfClay(of) => !matches!(of.command, Command::LiftAll),
        Command::Scene(SceneCommand::Exchange(_) | SceneCommand::ExchangeLive(_)) => true,
        _ => false,
    }
}

/// What a run gave.
pub struct Checked {
    /// Of the world at the end.
    pub hash: u64,
    /// The strokes without the operations, and their masks.
    pub reference: TriMesh,
    pub masks: Option<Vec<f32>>,
    pub result: TriMesh,
    /// Number of changes of whole objects that the world was given.
    pub installed: usize,
}

impl Checked {
    /// The strokes are in the result: where the pen was, it follows the surface without the
    /// operations within `within`, or 15 % of the strokes' height if that is more, and is as high.
    pub fn has_the_strokes(&self, under: Vec3, within: f64) {
        let near = |p: &&Vec3| p.normalize_or_zero().dot(under.normalize()) > 0.75;
        let here: Vec<DVec3> =
            self.reference.positions.iter().filter(near).map(|p| p.as_dvec3()).collect();
        let solid = DistanceSolid::build(&self.result, &Job::default()).expect("a solid");
        let nearest = solid.nearest(&here, &Job::default()).expect("not cancelled");
        let off = nearest.iter().flatten().map(|n| n.distance_squared.sqrt()).fold(0.0, f64::max);
        let top = |mesh: &TriMesh| {
            let all = mesh.positions.iter().filter(near);
            all.map(|p| f64::from(p.length())).fold(0.0, f64::max) - 1.0
        };
        let (want, got) = (top(&self.reference), top(&self.result));
        // On a busy machine more strokes come meanwhile, and a new mesh follows a higher ridge less
        // closely.
        let within = within.max(0.15 * want);
        println!("height {got:.4} of {want:.4}, off by {off:.4} of {within:.4}");
        assert!(want > 2.0 * within, "a stroke of height {want}: nothing is shown by it");
        assert!(off < within, "off by {off}, more than {within}");
        assert!((got - want).abs() < within, "height {got} of {want}");
    }
}

fn sample(clock: &Clock, i: u64, tip: bool, in_range: bool) -> Sample {
    let area_mm = Vec2::new(160.0, 100.0);
    let pen = Pen {
        in_range,
        tip,
        pos_mm: path(i) * area_mm,
        area_mm,
        pressure: Some(if tip { 0.7 } else { 0.0 }),
        ..Pen::default()
    };
    Sample { device: DeviceId(3), t_us: clock.now_us(), device_t_us: None, body: Body::Pen(pen) }
}
