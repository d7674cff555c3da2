//! A station beside the tick loop, on a separate thread (`sculptd-shared`), and work longer than a
//! tick on another (`sculptd-replica`): hashes, checkpoints, worlds built from them.
//!
//! The tick thread sends its input and steps the returned frames; it waits for neither thread. It
//! does allocate a little for each of its samples that is shared.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

use crate::executor::Executor;
use crate::host_limits::{BYTES, LARGE_SHARE};
use crate::keyring::OwnerFolder;
use crate::local_echo::LocalEcho;
use crate::loop_messages::{FromLoop, NumberedFrame, ToLoop, Told};
use crate::policy;
use crate::replica_worker::work_on;
use crate::shared_error::SharedError;
use crate::shared_session::SharedSession;
use crate::station::Station;
use crate::station_thread::{StationThread, ThreadEnds};
use crate::transport::Transport;
use crate::wire::frame::{Batch, Frame};
use crate::wire::samples::rounded;
use sculptd_daemon::command_queue::QueuedCommand;
use sculptd_daemon::people::{OwnInput, PeopleHere, SharedEnd, SharedStanding};
use sculptd_daemon::shared_input::{NextTick, SharedInput, SharedJournal, SharedTick};
use sculptd_devices::{Clock, DeviceId, Sample};
use sculptd_engine::answer::CommandResult;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneError;
use sculptd_engine::world::World;

/// Greatest number of messages between the threads; local input beyond it is reported as lost.
const WAITING: usize = 4096;
/// Devices of one person.
const MAX_DEVICES: usize = 16;
/// Time without an entry after which a host's refusal of the key is accepted.
const ENOUGH: Duration = Duration::from_secs(3);
/// A number that no person has.
const NOBODY: u8 = u8::MAX;
/// A world of the others, and the session that records it.
pub type EnteredWorld = (Box<World>, Option<SharedJournal>);

/// Result of looking for a host.
#[derive(Debug)]
pub enum Entered {
    /// The sculpture of the others, and the host's rate.
    World(EnteredWorld, u32),
    /// No world, and the host's rate: a device sees none.
    Device(u32),
    /// Nobody hosts: [`Shared::host`] begins to.
    NobodyHosts,
}

/// Settings of a shared run.
#[derive(Debug)]
pub struct SharedSettings {
    /// Threads that step a dab, for a world that comes as a checkpoint.
    pub workers: usize,
    /// Folder for both worlds if they differ.
    pub dumps: PathBuf,
    /// Recording of each world received as a checkpoint.
    pub session: Option<SharedSession>,
    /// The invitations, if this daemon's person owns the sculpture.
    pub folder: Option<OwnerFolder>,
    /// This daemon's person looks on.
    pub is_viewer: bool,
}

/// The tick thread's end.
#[derive(Debug)]
pub struct SharedLink {
    to: cc::Sender<FromLoop>,
    from: cc::Receiver<ToLoop>,
    executor: Executor,
    echo: LocalEcho,
    /// The commands of a viewer are refused.
    is_viewer: bool,
    /// The camera of a viewer, once it is known.
    view: Option<Camera>,
    /// The own devices, by their number on the wire.
    devices: Vec<DeviceId>,
    frames: VecDeque<NumberedFrame>,
    /// The number of the next local command.
    next_command: u64,
    /// Bytes of large local commands on their way.
    waiting_bytes: usize,
    standing: SharedStanding,
    /// Nobody orders the local input any more: it is stepped as it comes.
    alone: bool,
    /// Local input to be stepped alone, with the number of its first command.
    local: VecDeque<(Vec<Sample>, Vec<Command>, u64)>,
    /// A tick of the loop is due.
    due: bool,
    end: Option<SharedEnd>,
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
        mut station: Station,
        mut transport: Box<dyn Transport>,
        clock: Clock,
        settings: SharedSettings,
    ) -> Result<Shared, SharedError> {
        let failed = |e: std::io::Error| SharedError::Start(format!("no thread: {e}"));
        transport.listen(station.address()).map_err(SharedError::Start)?;
        if station.hears_greetings() {
            transport.hosts(true);
        }
        if let Some(folder) = &settings.folder {
            // It may be newer than that of whoever hosts.
            station.take_members(folder.membership(), clock.now_us());
        }
        let (to, from_loop) = cc::bounded(WAITING);
        let (to_loop, from) = cc::unbounded();
        let (tell, told) = cc::bounded(1024);
        let (jobs, work) = cc::unbounded();
        let (finished, done) = cc::bounded(64);
        let (workers, session) = (settings.workers, settings.session);
        let is_viewer = settings.is_viewer;
        std::thread::Builder::new()
            .name("sculptd-replica".into())
            .spawn(move || work_on(&work, &finished, workers, session.as_ref()))
            .map_err(failed)?;
        let (stop, hosting) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let (ended, hosts) = (stop.clone(), hosting.clone());
        let ends =
            ThreadEnds { transport, clock, from_loop, to_loop, tell, jobs, done, hosts, ended };
        let running = StationThread::new(station, ends, settings.dumps, settings.folder);
        let thread = std::thread::Builder::new()
            .name("sculptd-shared".into())
            .spawn(move || running.run())
            .map_err(failed)?;
        let link = SharedLink {
            to,
            from,
            executor: Executor::new(1, 0),
            echo: LocalEcho::new(1, 0),
            is_viewer,
            view: None,
            devices: Vec::new(),
            frames: VecDeque::new(),
            next_command: 0,
            waiting_bytes: 0,
            standing: SharedStanding::default(),
            alone: false,
            local: VecDeque::new(),
            due: false,
            end: None,
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
    ) -> Result<Entered, SharedError> {
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
                        return Ok(Entered::Device(rate));
                    }
                }
                Ok(ToLoop::NobodyHosts) => return Ok(Entered::NobodyHosts),
                Ok(ToLoop::World(mut world, executor, journal, _)) => {
                    // An obstacle to the session was reported before.
                    let told = self.told.try_iter();
                    let no_session =
                        |t| if let Told::NoSession(why) = t { Some(why) } else { None };
                    if let Some(why) = told.filter_map(no_session).next() {
                        return Err(SharedError::Session(why));
                    }
                    self.link.executor = executor;
                    self.link.show_to_own(&mut world);
                    return Ok(Entered::World((world, journal), rate));
                }
                Ok(ToLoop::Frame(frame)) => self.link.frames.push_back(frame),
                Ok(ToLoop::People(people)) => self.link.people = people,
                Ok(ToLoop::Input(own, standing, _)) => {
                    (self.link.own_input, self.link.standing) = (own, standing);
                }
                Ok(ToLoop::Alone(_) | ToLoop::Closed(_)) => {}
                Ok(ToLoop::Coming(bytes)) => {
                    last_us = clock.now_us();
                    coming(bytes);
                }
                Err(_) if passed >= patience || enough(&last, passed) => {
                    let name = name.into();
                    return Err(match last.strip_prefix("not let in: ") {
                        Some(why) => SharedError::NotLetIn { name, why: why.into() },
                        None => SharedError::Silent { name, last },
                    });
                }
                Err(_) => {}
            }
        }
    }
}

impl SharedLink {
    /// Shows a received world to this daemon's person: it arrives with another person's view. A
    /// newcomer gets a view of the whole object, because the initial view of the world may belong
    /// to another sculpture.
    fn show_to_own(&mut self, world: &mut World) {
        let person = self.executor.person();
        let view = world.first_view_of(person);
        world.show_to(person);
        if self.is_viewer {
            // The view is no part of the world, which may know the person by an earlier visit.
            let view = self.view.or_else(|| world.first_view_of(NOBODY));
            self.view = view.filter(|view| world.look_from(*view).is_ok());
        } else if let Some(view) = view {
            // At once, for whoever asks before the command is stepped; no stroke comes before it.
            let _sane = world.look_from(view);
            self.submit(world, &mut Vec::new(), &mut vec![Command::Camera(view)]);
        }
    }

    /// Returns the input of one tick as a frame, if no host orders it any more.
    fn local_frame(&mut self, world: &World) -> Option<NumberedFrame> {
        let (samples, commands, first) = self.local.pop_front()?;
        let numbers = (first..first + commands.len() as u64).collect();
        let person = self.executor.person();
        let batches = vec![Batch { person, number: 0, samples, commands }];
        let frame = Frame { tick: world.tick() + 1, batches, ..Frame::default() };
        Some((Arc::new(frame), numbers, Vec::new()))
    }
}

impl Shared {
    /// After [`Entered::NobodyHosts`]: shares the local world, which is at this tick.
    pub fn host(&mut self, rate_hz: u32, tick: u64) {
        let _ = self.link.to.send(FromLoop::Host { rate_hz, tick });
    }
}

impl SharedInput for SharedLink {
    fn result_here(&mut self, world: &mut World, command: &QueuedCommand) -> Option<CommandResult> {
        if self.is_viewer {
            let Command::Camera(view) = command.command else {
                return Some(Err(SceneError::LooksOn));
            };
            let looks = world.look_from(view);
            self.view = looks.is_ok().then_some(view).or(self.view);
            return Some(looks);
        }
        if let Some(why) = policy::refused_command(&command.command) {
            tracing::warn!("not done in a shared sculpture: {why}");
            return Some(Err(SceneError::NotShared));
        }
        if self.alone || !command.command.owns_memory() {
            return None;
        }
        let Some(bytes) = policy::size(&command.command) else {
            return Some(Err(SceneError::TooLarge));
        };
        self.waiting_bytes += bytes;
        let is_much = self.waiting_bytes as f64 > BYTES.0 * LARGE_SHARE;
        is_much.then(|| {
            self.waiting_bytes -= bytes;
            Err(SceneError::Congested)
        })
    }

    fn submit(
        &mut self,
        world: &World,
        samples: &mut Vec<Sample>,
        commands: &mut Vec<Command>,
    ) -> u64 {
        self.due = true;
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
        let first = self.next_command;
        if self.alone {
            self.next_command += commands.len() as u64;
            if !own.is_empty() || !commands.is_empty() {
                self.local.push_back((own, std::mem::take(commands), first));
            }
            return first;
        }
        if self.sees {
            self.echo.take(world, &own, commands);
        }
        if own.is_empty() && commands.is_empty() {
            return first;
        }
        self.next_command += commands.len() as u64;
        let input = FromLoop::Input(own, std::mem::take(commands), first);
        if self.to.try_send(input).is_err() {
            self.lost += 1;
            tracing::warn!("input of {} ticks was lost on its way to the network", self.lost);
        }
        first
    }

    fn next(&mut self, world: &World) -> NextTick {
        loop {
            if self.frames.is_empty() && self.alone {
                let local = self.local_frame(world);
                self.frames.extend(local);
            }
            if let Some((frame, _, _)) = self.frames.front() {
                if let Some(tick) = self.executor.empty_ticks(world, frame).next() {
                    return NextTick::Step(SharedTick { tick, ..SharedTick::default() });
                }
                let input = self.executor.input(frame, world);
                let Some((frame, own, refused)) = self.frames.pop_front() else { continue };
                self.stepping = Some(frame);
                return NextTick::Step(SharedTick {
                    tick: input.tick,
                    samples: input.samples,
                    commands: input.commands,
                    own: input.own.into_iter().zip(own).collect(),
                    refused,
                });
            }
            match self.from.try_recv() {
                Ok(ToLoop::Frame(frame)) => self.frames.push_back(frame),
                Ok(ToLoop::People(people)) => self.people = people,
                Ok(ToLoop::Input(own, standing, bytes)) => {
                    (self.own_input, self.standing, self.waiting_bytes) = (own, standing, bytes);
                }
                Ok(ToLoop::World(mut world, executor, journal, waiting_from)) => {
                    self.executor = executor;
                    self.show_to_own(&mut world);
                    self.echo.reset(self.executor.rate_hz(), self.executor.person());
                    return NextTick::World(world, journal, waiting_from);
                }
                Ok(ToLoop::Entered(person, rate_hz)) => {
                    self.executor.set_person(person, rate_hz);
                    self.echo.reset(rate_hz, person);
                }
                Ok(ToLoop::Alone(batches)) => {
                    self.echo.reset(self.executor.rate_hz(), self.executor.person());
                    self.alone = true;
                    for (batch, first) in batches.into_iter().rev() {
                        self.local.push_front((batch.samples, batch.commands, first));
                    }
                }
                Ok(ToLoop::Closed(end)) => self.end = Some(end),
                Ok(ToLoop::Coming(_) | ToLoop::NobodyHosts) => {}
                // One tick for each tick of the loop, as in a sculpture that nobody shares.
                Err(_) if self.alone && std::mem::take(&mut self.due) => {
                    let tick = world.tick() + 1;
                    return NextTick::Step(SharedTick { tick, ..SharedTick::default() });
                }
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

    fn standing(&self) -> SharedStanding {
        self.standing
    }

    fn close(&mut self) {
        let _ = self.to.send_timeout(FromLoop::Close, Duration::from_secs(1));
    }

    fn closed(&self) -> Option<SharedEnd> {
        let is_done = self.frames.is_empty() && self.local.is_empty() && self.from.is_empty();
        self.end.clone().filter(|_| is_done)
    }

    fn hosts(&self) -> bool {
        self.hosting.load(Relaxed)
    }
}
