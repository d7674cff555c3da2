//! A station's thread, `sculptd-shared`: messages of the network and of the tick thread go in, and
//! what follows from them goes out.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use crossbeam_channel as cc;

use crate::core::{Event, Outgoing};
use crate::executor::{Executor, HashView};
use crate::keyring::OwnerFolder;
use crate::loop_messages::{FromLoop, NumberedFrame, ToLoop, Told};
use crate::people_here::{changes_people, own_input, people_here, standing};
use crate::replica_worker::{Done, Job};
use crate::station::Station;
use crate::transport::Transport;
use crate::wire::frame::Mark;
use sculptd_daemon::people::{OwnInput, SharedEnd, SharedStanding};
use sculptd_devices::Clock;

/// Jobs of the worker beyond which no state is hashed: it misses a comparison.
const MAX_JOBS: usize = 64;
/// Interval of reports about the local input, in microseconds.
const TOLD_US: u64 = 100_000;
/// Compared states that are kept for a dump.
const KEPT_VIEWS: usize = 8;

/// After the end of the run the last input is on its way for so long at most, in microseconds.
const DELIVERY_US: u64 = 2_500_000;
/// Between two looks at the owner's folder, in microseconds.
const FOLDER_US: u64 = 1_000_000;

/// What the thread is connected to.
pub struct ThreadEnds {
    /// The network.
    pub transport: Box<dyn Transport>,
    /// The loop's clock.
    pub clock: Clock,
    /// From the tick thread.
    pub from_loop: cc::Receiver<FromLoop>,
    /// To the tick thread.
    pub to_loop: cc::Sender<ToLoop>,
    /// To the run.
    pub tell: cc::Sender<Told>,
    /// To the worker.
    pub jobs: cc::Sender<Job>,
    /// From the worker.
    pub done: cc::Receiver<Done>,
    /// True while the station hosts.
    pub hosts: Arc<AtomicBool>,
    /// The thread ends once this is true.
    pub ended: Arc<AtomicBool>,
}

impl std::fmt::Debug for ThreadEnds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ThreadEnds")
    }
}

/// The thread's state.
#[derive(Debug)]
pub struct StationThread {
    station: Station,
    ends: ThreadEnds,
    /// Frames that wait for the world that they follow.
    restoring: Option<Vec<NumberedFrame>>,
    /// Own commands with lower numbers are in that world, or lost.
    waiting_from: u64,
    /// Bytes of the newest checkpoint.
    came: u64,
    views: BTreeMap<u64, HashView>,
    /// Frame with a different state: the host's state is written once it arrives.
    differs: Option<u64>,
    dumps: PathBuf,
    /// Last report to the loop about the local input and the connection, and its time.
    told_input: (u64, OwnInput, SharedStanding),
    /// The connection's state, and since when it is so.
    since: (u64, SharedStanding),
    folder: Option<OwnerFolder>,
    /// When the folder is looked at next.
    look_us: u64,
    /// The run ends: until when input is delivered.
    closing_us: Option<u64>,
    /// Own batches that the others never got.
    undelivered: u64,
    sent_away: Option<String>,
    /// Other sculptures of the name that were told of.
    others: usize,
}

impl StationThread {
    /// The thread of a station. `dumps`: the folder for both worlds if they differ; `folder`: the
    /// invitations, if this daemon's person owns the sculpture.
    pub fn new(
        station: Station,
        ends: ThreadEnds,
        dumps: PathBuf,
        folder: Option<OwnerFolder>,
    ) -> StationThread {
        StationThread {
            station,
            ends,
            restoring: None,
            waiting_from: 0,
            came: 0,
            views: BTreeMap::new(),
            differs: None,
            dumps,
            told_input: (0, OwnInput::default(), SharedStanding::default()),
            since: (0, SharedStanding::default()),
            folder,
            look_us: 0,
            closing_us: None,
            undelivered: 0,
            sent_away: None,
            others: 0,
        }
    }

    /// Runs until it is to end.
    pub fn run(mut self) {
        let incoming = self.ends.transport.incoming();
        while !self.ends.ended.load(Relaxed) {
            let now_us = self.ends.clock.now_us();
            let wait = self.station.next_us(now_us).saturating_sub(now_us);
            cc::select! {
                recv(incoming) -> bytes => if let Ok(bytes) = bytes {
                    self.station.receive(&bytes, self.ends.clock.now_us());
                },
                recv(self.ends.from_loop) -> from => match from {
                    Ok(from) => self.take(from),
                    Err(_) => break,
                },
                recv(self.ends.done) -> done => if let Ok(done) = done {
                    self.finished(done);
                },
                default(Duration::from_micros(wait.clamp(500, 50_000))) => {}
            }
            // A flood must not keep time from passing.
            incoming.try_iter().take(512).for_each(|b| {
                self.station.receive(&b, self.ends.clock.now_us());
            });
            while let Ok(from) = self.ends.from_loop.try_recv() {
                self.take(from);
            }
            self.look_at_folder();
            self.station.advance(self.ends.clock.now_us());
            self.tell_events();
            self.tell_input();
            self.close();
            self.send();
        }
        self.station.leave();
        self.send();
    }

    /// A list of members that has changed in the owner's folder goes to all.
    fn look_at_folder(&mut self) {
        let now_us = self.ends.clock.now_us();
        let Some(folder) = self.folder.as_mut().filter(|_| now_us >= self.look_us) else { return };
        self.look_us = now_us + FOLDER_US;
        match folder.look_again() {
            Ok(None) => {}
            Ok(Some(members)) => {
                let count = folder.invitations.len();
                self.station.take_members(members, now_us);
                self.note(format!("the invitations have changed: {count} are valid now"));
            }
            Err(e) => {
                // It is told once, and looked at again.
                self.look_us = now_us + 30 * FOLDER_US;
                tracing::warn!("the invitations stay as they were: {e}");
            }
        }
    }

    /// The run ends once all input is delivered, or cannot be.
    fn close(&mut self) {
        let Some(until_us) = self.closing_us else { return };
        let waiting = match &self.station {
            ended if ended.has_ended() => 0,
            // A host has ordered its own input: what counts is that somebody else has it.
            host if host.hosts() => host.outbox().len() as u64,
            member => member.waiting(),
        };
        if waiting > 0 && self.ends.clock.now_us() < until_us {
            return;
        }
        if waiting > 0 {
            self.go_on_alone(waiting);
        }
        let end = SharedEnd { sent_away: self.sent_away.clone(), undelivered: self.undelivered };
        let _ = self.ends.to_loop.send(ToLoop::Closed(end));
        self.closing_us = None;
    }

    /// What nobody has ordered is stepped here.
    fn go_on_alone(&mut self, undelivered: u64) {
        self.undelivered += undelivered;
        let _ = self.ends.to_loop.send(ToLoop::Alone(self.station.take_unstepped()));
    }

    fn send(&mut self) {
        while let Some(Outgoing { to, kind, bytes }) = self.station.take_outgoing() {
            tracing::trace!(kind, bytes = bytes.len(), "sent");
            self.ends.transport.send(to, bytes);
        }
    }

    fn take(&mut self, from: FromLoop) {
        match from {
            FromLoop::Input(samples, commands, first) => {
                let now_us = self.ends.clock.now_us();
                self.station.submit_numbered(samples, commands, first, now_us);
                if self.station.has_ended() && self.station.person() != 0 {
                    self.go_on_alone(self.station.waiting());
                }
            }
            FromLoop::Host { rate_hz, tick } => {
                if let Some(folder) = &self.folder {
                    let now_us = self.ends.clock.now_us();
                    self.station.begin_to_host(folder.membership(), rate_hz, tick, now_us);
                }
            }
            FromLoop::Close => self.closing_us = Some(self.ends.clock.now_us() + DELIVERY_US),
            FromLoop::Stepped { frame, asked, at_rest } => {
                self.station.after_step(at_rest);
                if let Some(view) = asked.hash.filter(|_| self.ends.jobs.len() < MAX_JOBS) {
                    let _ = self.ends.jobs.send(Job::Hash(view));
                }
                if frame.mark == Mark::Checkpoint && self.station.hosts() {
                    match asked.captured {
                        Some(captured) => {
                            let job = Job::Checkpoint(frame.index, Box::new(captured));
                            let _ = self.ends.jobs.send(job);
                        }
                        None => {
                            self.station.checkpoint_failed(frame.index, self.ends.clock.now_us())
                        }
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
                self.station.restore_failed(self.ends.clock.now_us());
            }
            Done::Restored(Some((mut world, journal))) => {
                self.station.restored(world.tick());
                if let Some(index) = self.differs.take() {
                    let (scene, active) = (world.scene_view(), world.snapshot());
                    let view = HashView { index, tick: world.tick(), scene, active };
                    let name = format!("differs-frame-{index}-host.ply");
                    let job = Job::Dump(Box::new(view), self.dumps.join(name));
                    let _ = self.ends.jobs.send(job);
                }
                let executor = Executor::new(self.station.rate_hz(), self.station.person());
                let journal = journal.unwrap_or_else(|why| {
                    tracing::error!("the sculpture is not recorded from here on: {why}");
                    let _ = self.ends.tell.try_send(Told::NoSession(why));
                    None
                });
                let waiting_from = self.waiting_from;
                let _ =
                    self.ends.to_loop.send(ToLoop::World(world, executor, journal, waiting_from));
                for frame in self.restoring.take().unwrap_or_default() {
                    let _ = self.ends.to_loop.send(ToLoop::Frame(frame));
                }
            }
        }
    }

    fn tell_input(&mut self) {
        let (now_us, own) = (self.ends.clock.now_us(), own_input(&self.station));
        let mut standing = standing(&self.station, self.undelivered);
        if standing.state != self.since.1.state {
            self.since = (now_us, standing);
        }
        standing.since_s = now_us.saturating_sub(self.since.0) / 1_000_000;
        let (told_us, told, told_standing) = self.told_input;
        if (own, standing) != (told, told_standing) && now_us >= told_us + TOLD_US {
            self.told_input = (now_us, own, standing);
            let bytes = self.station.outbox().waiting_bytes();
            let _ = self.ends.to_loop.send(ToLoop::Input(own, standing, bytes));
        }
    }

    fn note(&self, text: String) {
        tracing::info!("{text}");
        let _ = self.ends.tell.try_send(Told::Note(text));
    }

    fn tell_events(&mut self) {
        let mut people = false;
        while let Some(event) = self.station.take_event() {
            people |= changes_people(&event);
            match event {
                Event::Frame(frame) => {
                    let (own, refused) = self.station.own_commands(&frame);
                    let frame = (frame, own, refused);
                    match &mut self.restoring {
                        Some(waiting) => waiting.push(frame),
                        None => {
                            let _ = self.ends.to_loop.send(ToLoop::Frame(frame));
                        }
                    }
                }
                Event::NobodyHosts => {
                    let _ = self.ends.to_loop.send(ToLoop::NobodyHosts);
                }
                Event::RestorePart { first, bytes } => {
                    let before = if first { 0 } else { self.came };
                    self.came = before + bytes.len() as u64;
                    let _ = self.ends.to_loop.send(ToLoop::Coming(self.came));
                    let _ = self.ends.jobs.send(Job::RestorePart { first, bytes });
                }
                Event::Restore { .. } => {
                    self.restoring = Some(Vec::new());
                    self.waiting_from = self.station.waiting_from();
                    let _ = self.ends.jobs.send(Job::Restore(self.station.rate_hz()));
                }
                Event::Entered { person, rate_hz } => {
                    let _ = self.ends.to_loop.send(ToLoop::Entered(person, rate_hz));
                }
                Event::Hosting(on) => {
                    self.ends.transport.hosts(on);
                    self.ends.hosts.store(on, Relaxed);
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
                        let _ = self.ends.jobs.send(job);
                    }
                    self.differs = Some(index);
                }
                Event::Note(text) => self.note(text),
                Event::Refused(why) => {
                    if self.station.person() != 0 {
                        tracing::error!(
                            "sent away from the shared sculpture: {why}. This daemon goes on alone"
                        );
                        self.sent_away = Some(why.clone());
                        people = true;
                        self.go_on_alone(self.station.waiting());
                    }
                    let _ = self.ends.tell.try_send(Told::Refused(why));
                }
            }
        }
        if people || self.station.others().len() != self.others {
            self.others = self.station.others().len();
            let mut here = people_here(&self.station);
            here.sent_away = self.sent_away.clone();
            if here.sent_away.is_some() {
                // Who of them is still there, this daemon does not know any more.
                let own = here.own;
                here.all.iter_mut().for_each(|p| p.here &= p.number == own);
            }
            let _ = self.ends.to_loop.send(ToLoop::People(Arc::new(here)));
        }
    }
}
