//! A station beside the tick loop, on a separate thread (`sculptd-shared`), and work longer than a
//! tick on another (`sculptd-replica`): hashes, checkpoints, worlds built from them.
//!
//! The tick thread sends its input and steps the returned frames; it waits for neither thread. It
//! does allocate a little for each of its samples that is shared.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

use crate::core::Event;
use crate::executor::{Asked, Executor, HashView};
use crate::local_echo::LocalEcho;
use crate::people_here::{changes_people, own_input, people_here};
use crate::policy;
use crate::replica_worker::{Done, Job, work_on};
use crate::shared_error::SharedError;
use crate::shared_session::SharedSession;
use crate::station::Station;
use crate::transport::Transport;
use crate::wire::frame::{Frame, Mark, PersonId};
use crate::wire::samples::rounded;
use sculptd_daemon::command_queue::QueuedCommand;
use sculptd_daemon::people::{OwnInput, PeopleHere};
use sculptd_daemon::shared_input::{NextTick, SharedInput, SharedJournal, SharedTick};
use sculptd_devices::{Clock, DeviceId, Sample};
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// Greatest number of messages between the threads; local input beyond it is reported as lost.
const WAITING: usize = 4096;
/// Devices of one person.
const MAX_DEVICES: usize = 16;
/// Time without an entry after which a host's refusal of the key is accepted.
const ENOUGH: Duration = Duration::from_secs(3);
/// Jobs of the worker beyond which no state is hashed: it misses a comparison.
const MAX_JOBS: usize = 64;
/// Interval of reports about the local input, in microseconds.
const TOLD_US: u64 = 100_000;
/// Compared states that are kept for a dump.
const KEPT_VIEWS: usize = 8;

/// From the tick thread.
enum FromLoop {
    Input(Vec<Sample>, Vec<Command>),
    Stepped { frame: Arc<Frame>, asked: Box<Asked>, at_rest: bool },
}

/// To the tick thread.
enum ToLoop {
    Frame(Arc<Frame>),
    World(Box<World>, Executor, Option<SharedJournal>),
    Entered(PersonId, u32),
    /// Bytes of a checkpoint that have come.
    Coming(u64),
    People(Arc<PeopleHere>),
    Input(OwnInput),
}

/// Reports to the run about its shared sculpture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Told {
    /// For a person.
    Note(String),
    /// The host admits nobody any more.
    Refused(String),
    /// The sculpture cannot be recorded.
    NoSession(String),
}

/// A world of the others, and the session that records it.
pub type EnteredWorld = (Box<World>, Option<SharedJournal>);

/// Settings of a shared run.
#[derive(Debug)]
pub struct SharedSettings {
    /// Threads that step a dab, for a world that comes as a checkpoint.
    pub workers: usize,
    /// Folder for both worlds if they differ.
    pub dumps: PathBuf,
    /// Recording of each world received as a checkpoint.
    pub session: Option<SharedSession>,
}

/// The tick thread's end.
#[derive(Debug)]
pub struct SharedLink {
    to: cc::Sender<FromLoop>,
    from: cc::Receiver<ToLoop>,
    executor: Executor,
    echo: LocalEcho,
    /// The own devices, by their number on the wire.
    devices: Vec<DeviceId>,
    frames: VecDeque<Arc<Frame>>,
    /// The frame whose own tick is being stepped.
    stepping: Option<Arc<Frame>>,
    hosting: Arc<AtomicBool>,
    own_input: OwnInput,
    people: Arc<PeopleHere>,
    /// Frames come here: a device is sent none, and its world stands still.
    sees: bool,
    lost: u64,
    _thread: SharedThread,
}

impl std::fmt::Debug for ToLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ToLoop")
    }
}

impl std::fmt::Debug for FromLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FromLoop")
    }
}

/// The station's thread; it leaves the sculpture and ends when this is dropped.
#[derive(Debug)]
struct SharedThread {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for SharedThread {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A station that runs.
#[derive(Debug)]
pub struct Shared {
    /// For the loop.
    pub link: SharedLink,
    /// Reports to the run.
    pub told: cc::Receiver<Told>,
}

impl Shared {
    /// Starts a station's threads.
    ///
    /// # Errors
    /// [`SharedError::Start`]
    pub fn start(
        station: Station,
        mut transport: Box<dyn Transport>,
        clock: Clock,
        settings: SharedSettings,
    ) -> Result<Shared, SharedError> {
        let failed = |e: std::io::Error| SharedError::Start(format!("no thread: {e}"));
        transport.listen(station.address()).map_err(SharedError::Start)?;
        let (to, from_loop) = cc::bounded(WAITING);
        let (to_loop, from) = cc::unbounded();
        let (tell, told) = cc::bounded(1024);
        let (jobs, work) = cc::unbounded();
        let (finished, done) = cc::bounded(64);
        let (workers, session) = (settings.workers, settings.session);
        std::thread::Builder::new()
            .name("sculptd-replica".into())
            .spawn(move || work_on(&work, &finished, workers, session))
            .map_err(failed)?;
        let (stop, hosting) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let running = Running {
            station,
            transport,
            clock,
            from_loop,
            to_loop,
            tell,
            jobs,
            done,
            restoring: None,
            came: 0,
            views: BTreeMap::new(),
            differs: None,
            dumps: settings.dumps,
            hosting: hosting.clone(),
            told_input: (0, OwnInput::default()),
            stop: stop.clone(),
        };
        let thread = std::thread::Builder::new()
            .name("sculptd-shared".into())
            .spawn(move || running.run())
            .map_err(failed)?;
        let link = SharedLink {
            to,
            from,
            executor: Executor::new(1, 0),
            echo: LocalEcho::new(1, 0),
            devices: Vec::new(),
            frames: VecDeque::new(),
            stepping: None,
            hosting,
            own_input: OwnInput::default(),
            people: Arc::default(),
            sees: true,
            lost: 0,
            _thread: SharedThread { stop, thread: Some(thread) },
        };
        Ok(Shared { link, told })
    }

    /// Waits until the station is admitted, and returns its first world and the host's rate.
    /// Without a world (a device sees none), it returns as soon as it has a number. `coming`
    /// receives the number of bytes of the world so far.
    ///
    /// # Errors
    /// [`SharedError::Refused`], [`SharedError::Silent`]
    pub fn enter(
        &mut self,
        name: &str,
        sees: bool,
        patience: Duration,
        mut coming: impl FnMut(u64),
    ) -> Result<(Option<EnteredWorld>, u32), SharedError> {
        let clock = Clock::monotonic();
        let mut last_us = 0;
        let enough = |last: &str, passed| last.starts_with("not let in") && passed > ENOUGH;
        let (mut last, mut rate) = (String::from("no word"), 0);
        loop {
            // As long as something comes, more is waited for.
            let passed = Duration::from_micros(clock.now_us().saturating_sub(last_us));
            while let Ok(told) = self.told.try_recv() {
                match told {
                    Told::Note(text) => last = text,
                    Told::Refused(why) => return Err(SharedError::Refused(why)),
                    Told::NoSession(why) => return Err(SharedError::Session(why)),
                }
            }
            match self.link.from.recv_timeout(Duration::from_millis(50)) {
                Ok(ToLoop::Entered(person, rate_hz)) => {
                    self.link.executor = Executor::new(rate_hz, person);
                    self.link.echo.reset(rate_hz, person);
                    self.link.sees = sees;
                    rate = rate_hz;
                    if !sees {
                        return Ok((None, rate));
                    }
                }
                Ok(ToLoop::World(world, executor, journal)) => {
                    // An obstacle to the session was reported before.
                    let told = self.told.try_iter();
                    let no_session =
                        |t| if let Told::NoSession(why) = t { Some(why) } else { None };
                    if let Some(why) = told.filter_map(no_session).next() {
                        return Err(SharedError::Session(why));
                    }
                    self.link.executor = executor;
                    return Ok((Some((world, journal)), rate));
                }
                Ok(ToLoop::Frame(frame)) => self.link.frames.push_back(frame),
                Ok(ToLoop::People(people)) => self.link.people = people,
                Ok(ToLoop::Input(own)) => self.link.own_input = own,
                Ok(ToLoop::Coming(bytes)) => {
                    last_us = clock.now_us();
                    coming(bytes);
                }
                Err(_) if passed >= patience || enough(&last, passed) => {
                    return Err(SharedError::Silent { name: name.into(), last });
                }
                Err(_) => {}
            }
        }
    }
}

impl SharedInput for SharedLink {
    fn refuses(&mut self, command: &QueuedCommand) -> bool {
        let why = policy::refused_command(&command.command).or_else(|| {
            let large = command.command.owns_memory() && policy::is_too_large(&command.command);
            large.then_some("it is larger than what can be shared at once")
        });
        if let Some(why) = why {
            tracing::warn!("not done in a shared sculpture: {why}");
        }
        why.is_some()
    }

    fn submit(&mut self, world: &World, samples: &mut Vec<Sample>, commands: &mut Vec<Command>) {
        let mut own = Vec::new();
        for mut sample in samples.drain(..).filter_map(|s| rounded(&s)) {
            let known = self.devices.iter().position(|d| *d == sample.device);
            let number = known.or_else(|| {
                self.devices.push(sample.device);
                (self.devices.len() <= MAX_DEVICES).then(|| self.devices.len() - 1)
            });
            let Some(number) = number else {
                self.devices.truncate(MAX_DEVICES);
                continue;
            };
            sample.device = DeviceId(number as u16);
            own.push(sample);
        }
        for command in commands.iter_mut() {
            let Command::DesktopLayout(desktop) = command else { continue };
            for entry in &mut desktop.tablets {
                // A tablet that has sent nothing yet has no number on the wire.
                let device = entry.and_then(|(d, _)| self.devices.iter().position(|o| *o == d));
                *entry = entry.zip(device).map(|((_, at), n)| (DeviceId(n as u16), at));
            }
        }
        if self.sees {
            self.echo.take(world, &own, commands);
        }
        if own.is_empty() && commands.is_empty() {
            return;
        }
        let input = FromLoop::Input(own, std::mem::take(commands));
        if self.to.try_send(input).is_err() {
            self.lost += 1;
            tracing::warn!("input of {} ticks was lost on its way to the network", self.lost);
        }
    }

    fn next(&mut self, world: &World) -> NextTick {
        loop {
            if let Some(frame) = self.frames.front() {
                if let Some(tick) = self.executor.empty_ticks(world, frame).next() {
                    return NextTick::Step(SharedTick { tick, ..SharedTick::default() });
                }
                let input = self.executor.input(frame, world);
                self.stepping = self.frames.pop_front();
                return NextTick::Step(SharedTick {
                    tick: input.tick,
                    samples: input.samples,
                    commands: input.commands,
                    own: input.own,
                });
            }
            match self.from.try_recv() {
                Ok(ToLoop::Frame(frame)) => self.frames.push_back(frame),
                Ok(ToLoop::People(people)) => self.people = people,
                Ok(ToLoop::Input(own)) => self.own_input = own,
                Ok(ToLoop::World(world, executor, journal)) => {
                    self.executor = executor;
                    self.echo.reset(self.executor.rate_hz(), self.executor.person());
                    return NextTick::World(world, journal);
                }
                Ok(ToLoop::Entered(person, rate_hz)) => {
                    self.executor.set_person(person, rate_hz);
                    self.echo.reset(rate_hz, person);
                }
                Ok(ToLoop::Coming(_)) => {}
                Err(_) => return NextTick::Wait,
            }
        }
    }

    fn after_step(&mut self, world: &mut World) {
        let frame = self.stepping.take();
        let asked = Box::new(self.executor.after_step(world, frame.as_deref()));
        if let Some(frame) = frame {
            self.echo.ordered(&frame);
            let at_rest = world.is_at_rest();
            // A station that is too far behind misses a comparison.
            let _ = self.to.try_send(FromLoop::Stepped { frame, asked, at_rest });
        }
    }

    fn ahead(&mut self, world: &World) -> Option<&mut World> {
        self.echo.advance(world);
        self.echo.ahead()
    }

    fn people(&self) -> Arc<PeopleHere> {
        self.people.clone()
    }

    fn own_input(&self) -> OwnInput {
        self.own_input
    }

    fn hosts(&self) -> bool {
        self.hosting.load(Relaxed)
    }
}

/// The station's thread.
struct Running {
    station: Station,
    transport: Box<dyn Transport>,
    clock: Clock,
    from_loop: cc::Receiver<FromLoop>,
    to_loop: cc::Sender<ToLoop>,
    tell: cc::Sender<Told>,
    jobs: cc::Sender<Job>,
    done: cc::Receiver<Done>,
    /// Frames that wait for the world that they follow.
    restoring: Option<Vec<Arc<Frame>>>,
    /// Bytes of the newest checkpoint.
    came: u64,
    views: BTreeMap<u64, HashView>,
    /// Frame with a different state: the host's state is written once it arrives.
    differs: Option<u64>,
    dumps: PathBuf,
    hosting: Arc<AtomicBool>,
    /// Last report to the loop about the local input, and its time.
    told_input: (u64, OwnInput),
    stop: Arc<AtomicBool>,
}

impl Running {
    fn run(mut self) {
        let incoming = self.transport.incoming();
        while !self.stop.load(Relaxed) {
            let now_us = self.clock.now_us();
            let wait = self.station.next_us(now_us).saturating_sub(now_us);
            cc::select! {
                recv(incoming) -> bytes => if let Ok(bytes) = bytes {
                    self.station.receive(&bytes, self.clock.now_us());
                },
                recv(self.from_loop) -> from => match from {
                    Ok(from) => self.take(from),
                    Err(_) => break,
                },
                recv(self.done) -> done => if let Ok(done) = done {
                    self.finished(done);
                },
                default(Duration::from_micros(wait.clamp(500, 50_000))) => {}
            }
            // A flood must not keep time from passing.
            incoming.try_iter().take(512).for_each(|b| {
                self.station.receive(&b, self.clock.now_us());
            });
            while let Ok(from) = self.from_loop.try_recv() {
                self.take(from);
            }
            self.station.advance(self.clock.now_us());
            self.tell_events();
            self.tell_input();
            self.send();
        }
        self.station.leave();
        self.send();
    }

    fn send(&mut self) {
        while let Some((to, bytes)) = self.station.take_outgoing() {
            self.transport.send(to, bytes);
        }
    }

    fn take(&mut self, from: FromLoop) {
        match from {
            FromLoop::Input(samples, commands) => {
                self.station.submit(samples, commands, self.clock.now_us());
            }
            FromLoop::Stepped { frame, asked, at_rest } => {
                self.station.after_step(at_rest);
                if let Some(view) = asked.hash.filter(|_| self.jobs.len() < MAX_JOBS) {
                    let _ = self.jobs.send(Job::Hash(view));
                }
                if frame.mark == Mark::Checkpoint && self.station.hosts() {
                    match asked.captured {
                        Some(captured) => {
                            let job = Job::Checkpoint(frame.index, Box::new(captured));
                            let _ = self.jobs.send(job);
                        }
                        None => self.station.checkpoint_failed(frame.index, self.clock.now_us()),
                    }
                }
            }
        }
    }

    fn finished(&mut self, done: Done) {
        match done {
            Done::Hash(view, hash) => {
                self.station.own_hash(view.index, hash);
                self.views.insert(view.index, view);
                while self.views.len() > KEPT_VIEWS {
                    self.views.pop_first();
                }
            }
            Done::CheckpointPart(index, part, last) => {
                self.station.checkpoint_part(index, &part, last);
            }
            Done::Restored(None) => {
                self.note("the checkpoint could not be read: asking for another".into());
                self.restoring = None;
                self.station.restore_failed(self.clock.now_us());
            }
            Done::Restored(Some((mut world, journal))) => {
                if let Some(index) = self.differs.take() {
                    let (scene, active) = (world.scene_view(), world.snapshot());
                    let view = HashView { index, tick: world.tick(), scene, active };
                    let name = format!("differs-frame-{index}-host.ply");
                    let job = Job::Dump(Box::new(view), self.dumps.join(name));
                    let _ = self.jobs.send(job);
                }
                let executor = Executor::new(self.station.rate_hz(), self.station.person());
                let journal = journal.unwrap_or_else(|why| {
                    tracing::error!("the sculpture is not recorded from here on: {why}");
                    let _ = self.tell.try_send(Told::NoSession(why));
                    None
                });
                let _ = self.to_loop.send(ToLoop::World(world, executor, journal));
                for frame in self.restoring.take().unwrap_or_default() {
                    let _ = self.to_loop.send(ToLoop::Frame(frame));
                }
            }
        }
    }

    fn tell_input(&mut self) {
        let (now_us, own) = (self.clock.now_us(), own_input(&self.station));
        if own != self.told_input.1 && now_us >= self.told_input.0 + TOLD_US {
            self.told_input = (now_us, own);
            let _ = self.to_loop.send(ToLoop::Input(own));
        }
    }

    fn note(&self, text: String) {
        tracing::info!("{text}");
        let _ = self.tell.try_send(Told::Note(text));
    }

    fn tell_events(&mut self) {
        let mut people = false;
        while let Some(event) = self.station.take_event() {
            people |= changes_people(&event);
            match event {
                Event::Frame(frame) => match &mut self.restoring {
                    Some(waiting) => waiting.push(frame),
                    None => {
                        let _ = self.to_loop.send(ToLoop::Frame(frame));
                    }
                },
                Event::RestorePart { first, bytes } => {
                    let before = if first { 0 } else { self.came };
                    self.came = before + bytes.len() as u64;
                    let _ = self.to_loop.send(ToLoop::Coming(self.came));
                    let _ = self.jobs.send(Job::RestorePart { first, bytes });
                }
                Event::Restore { .. } => {
                    self.restoring = Some(Vec::new());
                    let _ = self.jobs.send(Job::Restore(self.station.rate_hz()));
                }
                Event::Entered { person, rate_hz } => {
                    let _ = self.to_loop.send(ToLoop::Entered(person, rate_hz));
                }
                Event::Hosting(on) => {
                    self.transport.hosts(on);
                    self.hosting.store(on, Relaxed);
                }
                Event::Differs { index, hashes: (own, host) } => {
                    let view = self.views.get(&index);
                    let tick = view.map_or(0, |v| v.tick);
                    self.note(format!(
                        "this replica differs from the host's at tick {tick}: {own:016x} here, \
                         {host:016x} there; both are written to {} and it joins anew",
                        self.dumps.display()
                    ));
                    if let Some(view) = view {
                        let name = format!("differs-frame-{index}-own.ply");
                        let job = Job::Dump(Box::new(view.clone()), self.dumps.join(name));
                        let _ = self.jobs.send(job);
                    }
                    self.differs = Some(index);
                }
                Event::Note(text) => self.note(text),
                Event::Refused(why) => {
                    tracing::warn!("the host lets this daemon in no more: {why}");
                    let _ = self.tell.try_send(Told::Refused(why));
                }
            }
        }
        if people {
            let _ = self.to_loop.send(ToLoop::People(Arc::new(people_here(&self.station))));
        }
    }
}
