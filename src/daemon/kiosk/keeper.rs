//! The cycle at work: a thread looks at what the loop publishes, plays the attract recordings, and
//! sends what the cycle asks for.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::film::AttractRecording;
use super::gallery::{self, VisitLine};
#[cfg(unix)]
use super::share;
use super::speech::Speech;
use super::spool::Spool;
use super::visit_journal::PutAway;
use super::{Cycle, Interrupted, KioskAct, KioskConfig, Language, ScreenSettings, Stage, View};
use crate::Published;
use crate::adaptors::ATTRACT_IDS;
use crate::command_queue::{CommandSender, QueuedCommand};
use crate::qr_code::Invitation;
use sculptd_clay::Clay;
use sculptd_clay::brush::BrushSettings;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue::{Sender, SenderFactory};
use sculptd_devices::{Clock, DeviceId};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Beginning, Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// Looks a second.
const RATE_HZ: f64 = 50.0;
/// Id of the hands in the list of touching pens.
const HAND: u16 = u16::MAX;

/// Initial state for every visitor.
#[derive(Debug, Clone)]
pub struct Start {
    pub plain: Arc<TriMesh>,
    pub camera: Camera,
    pub brush: BrushSettings,
    /// Set while a reset begins an attract film, which no session records; cleared for a visit.
    pub film: Arc<AtomicBool>,
    /// A visit that the last run did not end; its work is in the world.
    pub interrupted: bool,
    /// See [`VisitRecording::put_away`]; `None`: visits are not recorded one by one.
    ///
    /// [`VisitRecording::put_away`]: super::visit_journal::VisitRecording::put_away
    pub put_away: Option<cc::Sender<PutAway>>,
}

impl Start {
    /// Returns the command that resets everything, with a copy of the clay that was built from
    /// `plain`: a reset costs by the number of pages, so a visitor's first stroke is not lost.
    fn command(&self, built: &Clay) -> QueuedCommand {
        let clay = NewClay::new(self.plain.clone(), false);
        let beginning = Beginning { clay, camera: self.camera, brush: self.brush };
        let command = Command::Begin(Box::new(beginning));
        let copy = built.duplicate(built.object_id());
        QueuedCommand::with_payload(command, Payload::Clay(Box::new(copy)))
    }
}

/// State exchanged with the screen.
#[derive(Debug, Default)]
pub struct KioskDesk {
    pub view: Mutex<Option<View>>,
    /// True if something on the screen itself was pressed.
    pub touched: AtomicBool,
    /// The visitor pressed "finished".
    pub finished: AtomicBool,
    /// Input typed by staff.
    pub typed: Mutex<Option<String>>,
    /// Message from the fleet's staff to those on site, until dismissed.
    pub message: Mutex<Option<String>>,
    /// Link to the last visitor's sculpture, until another visitor comes.
    #[cfg(unix)]
    pub link: Mutex<Option<share::Link>>,
}

/// Content of an installation's window.
#[derive(Debug, Clone)]
pub struct Screen {
    pub desk: Arc<KioskDesk>,
    /// Never empty; the first is shown to each new visitor.
    pub words: Vec<Language>,
    /// True if staff can exit with a PIN.
    pub staff: bool,
    /// Display settings of the screen.
    pub show: ScreenSettings,
    /// The page on which visitors watch.
    pub watch: Option<Invitation>,
}

/// A running keeper; it ends once `stop` is set.
#[derive(Debug)]
pub struct KioskKeeper {
    pub desk: Arc<KioskDesk>,
    pub thread: JoinHandle<()>,
}

struct KioskThread {
    config: KioskConfig,
    start: Start,
    /// Built from the start, never changed.
    built: Clay,
    published: Arc<ArcSwap<Published>>,
    commands: CommandSender,
    sender: Sender,
    clock: Clock,
    stop: Arc<AtomicBool>,
    desk: Arc<KioskDesk>,
    /// Recordings to play while no visitor is present; never empty.
    films: Vec<AttractRecording>,
    film: usize,
    playing: bool,
    began_us: u64,
    dabs_before: u64,
    spool: Option<Spool>,
    speech: Speech,
    #[cfg(unix)]
    share: Option<share::Share>,
}

/// Starts keeping. A recording that cannot be played is an error here and not in front of visitors.
pub fn start(
    (config, words): (KioskConfig, &Language),
    start: Start,
    published: Arc<ArcSwap<Published>>,
    commands: CommandSender,
    factory: &SenderFactory,
    clock: Clock,
    stop: Arc<AtomicBool>,
) -> Result<KioskKeeper, String> {
    let catalogue = Catalogue::builtin().map_err(|e| e.to_string())?;
    let mut films = Vec::new();
    for (path, id) in config.attract.iter().zip(ATTRACT_IDS.cycle()) {
        let film = AttractRecording::open(path, DeviceId(id), start.camera.aspect, &catalogue)
            .map_err(|e| e.to_string())?;
        if film.is_empty() {
            return Err(format!("{}: nothing in it touches the work", path.display()));
        }
        films.push(film);
    }
    if films.is_empty() {
        films.push(AttractRecording::own(DeviceId(ATTRACT_IDS.start)));
    }
    let spool = match config.gallery_store.as_str() {
        "" => None,
        place => Some(Spool::start(&config.gallery, place)?),
    };
    #[cfg(unix)]
    let share = match config.share.as_str() {
        "" => None,
        at => {
            let lasts = Duration::from_secs_f64(config.share_minutes * 60.0);
            let at = crate::metrics::address(at).map_err(|e| format!("share: {e}"))?;
            let share = share::Share::start(at, &config.share_name, lasts, clock.clone());
            Some(share.map_err(|e| format!("share {at}: {e}"))?)
        }
    };
    let countdown = format!("{} {}", words.countdown, words.go_on);
    let speech = Speech::new(&config.speak, &words.welcome, &countdown);
    let built = Clay::build(&start.plain, &Job::default()).map_err(|e| e.to_string())?;
    let desk = Arc::new(KioskDesk::default());
    let mut keeping = KioskThread {
        config,
        start,
        built,
        published,
        commands,
        sender: factory.sender(),
        clock,
        stop,
        desk: desk.clone(),
        films,
        film: 0,
        playing: false,
        began_us: 0,
        dabs_before: 0,
        spool,
        speech,
        #[cfg(unix)]
        share,
    };
    let run = move || keeping.run();
    let thread = std::thread::Builder::new()
        .name("sculptd-kiosk".into())
        .spawn(run)
        .map_err(|e| e.to_string())?;
    Ok(KioskKeeper { desk, thread })
}

impl KioskThread {
    fn run(&mut self) {
        let mut cycle = Cycle::new(RATE_HZ, self.config.idle_s, self.config.countdown_s);
        if self.start.interrupted {
            cycle = cycle.resumed();
            if self.config.interrupted == Interrupted::Gallery {
                let act = cycle.interrupt();
                self.carry_out(act, &cycle);
            }
        }
        let mut felt = None;
        let (_keep, quiet) = cc::bounded::<()>(1);
        while !self.stop.load(Relaxed) {
            let now = touch(&self.published.load());
            // Something that lies still on the tablet is nobody.
            let pressed = self.desk.touched.swap(false, Relaxed);
            let moved = now.is_some() && now != felt;
            // A pen in the air keeps a visit going, but begins none: a pointer that stands where
            // the window opens is no visitor.
            let comes = now.as_ref().is_some_and(|felt| felt.iter().any(is_at_work));
            let touched = pressed || moved && (comes || cycle.view().stage != Stage::Attract);
            felt = now;
            let done = self.desk.finished.swap(false, Relaxed);
            let act = cycle.step(touched, done);
            self.carry_out(act, &cycle);
            let typed = self.desk.typed.lock().ok().and_then(|mut t| t.take());
            if let Some(number) = typed {
                let act = cycle.staff(&number, &self.config.staff_pin);
                self.carry_out(act, &cycle);
            }
            if cycle.view().stage == Stage::Attract {
                self.attract();
                #[cfg(unix)]
                self.drop_expired();
            }
            self.speech.say(&cycle.view());
            if let Ok(mut view) = self.desk.view.lock() {
                *view = Some(cycle.view());
            }
            let _ = quiet.recv_timeout(Duration::from_secs_f64(1.0 / RATE_HZ));
        }
        // The program ends, the visitor's work is put away.
        let act = cycle.interrupt();
        self.carry_out(act, &cycle);
    }

    fn carry_out(&mut self, act: Option<KioskAct>, cycle: &Cycle) {
        match act {
            None => {}
            Some(KioskAct::Quit) => self.stop.store(true, Relaxed),
            Some(KioskAct::Begin) => {
                tracing::info!("kiosk: a visit begins");
                if std::mem::take(&mut self.playing) {
                    self.films[self.film].stop(self.clock.now_us(), &mut self.sender);
                }
                #[cfg(unix)]
                self.show_link(None);
                self.dabs_before = self.published.load().figures.dabs;
                self.put_back(false);
            }
            Some(KioskAct::End { seconds }) => {
                let state = self.published.load_full();
                let interrupted = std::mem::take(&mut self.start.interrupted);
                let dabs = state.figures.dabs.saturating_sub(self.dabs_before);
                let mut kept = false;
                let keeps = !self.config.gallery.as_os_str().is_empty();
                let keeps = keeps && (dabs > 0 || interrupted);
                if keeps {
                    let mesh = state.mesh.to_tri().to_poly();
                    match gallery::keep(&self.config.gallery, &mesh) {
                        Ok(path) => {
                            kept = true;
                            self.pass_on(&path);
                        }
                        Err(e) => tracing::error!("{}: {e}", self.config.gallery.display()),
                    }
                }
                let file = &self.config.audit;
                let visit = cycle.view().visits;
                let line = VisitLine { visit, seconds, dabs, kept, interrupted };
                if !file.as_os_str().is_empty()
                    && let Err(e) = gallery::audit(file, &line)
                {
                    tracing::error!("{}: {e}", file.display());
                }
                // The attract film that follows begins with a reset.
                if let Some(put_away) = &self.start.put_away {
                    let refused = keeps && !kept;
                    let _ = put_away.send(if refused { PutAway::Refused } else { PutAway::Done });
                }
            }
        }
    }

    /// The work is in the gallery: on to where it is kept for good, and to the visitor.
    fn pass_on(&self, path: &std::path::Path) {
        if let (Some(spool), Some(name)) = (&self.spool, path.file_name().and_then(|n| n.to_str()))
            && let Err(e) = spool.offer(name)
        {
            tracing::error!("{}: {e}", path.display());
        }
        #[cfg(unix)]
        if let Some(share) = &self.share {
            match share.link(path) {
                Ok(link) => self.show_link(Some(link)),
                Err(e) => tracing::error!("{}: {e}", path.display()),
            }
        }
    }

    #[cfg(unix)]
    fn show_link(&self, link: Option<share::Link>) {
        if let Ok(mut shown) = self.desk.link.lock() {
            *shown = link;
        }
    }

    /// A code that leads nowhere any more is not shown.
    #[cfg(unix)]
    fn drop_expired(&self) {
        if let Ok(mut link) = self.desk.link.lock()
            && link.as_ref().is_some_and(|l| l.until_us <= self.clock.now_us())
        {
            *link = None;
        }
    }

    /// Resets everything, for a film or for a visit.
    fn put_back(&self, film: bool) {
        self.start.film.store(film, Relaxed);
        let command = self.start.command(&self.built);
        // The loop takes 64 commands a tick: it has room again before long.
        if self.commands.send_timeout(command, Duration::from_secs(2)).is_err() {
            tracing::error!("kiosk: the reset was not carried out; the loop takes no commands");
        }
    }

    fn attract(&mut self) {
        if !self.playing {
            // Each film begins on clean clay.
            self.put_back(true);
            self.films[self.film].rewind();
            (self.playing, self.began_us) = (true, self.clock.now_us());
        }
        let now = self.clock.now_us().saturating_sub(self.began_us);
        if !self.films[self.film].play(self.began_us, now, &mut self.sender) {
            self.film = (self.film + 1) % self.films.len();
            self.playing = false;
        }
    }
}

/// A pen that presses, or a hand over the tracker: bare hands touch nothing.
fn is_at_work(felt: &(u16, [f32; 3])) -> bool {
    felt.0 == HAND || felt.1[2] > 0.0
}

/// Returns what visitors touch now: their pens and hands, without those of the attract loop. `None`
/// if they touch nothing.
fn touch(state: &Published) -> Option<Vec<(u16, [f32; 3])>> {
    let mut felt: Vec<(u16, [f32; 3])> = Vec::new();
    for (id, pen) in state.pens.iter().flatten() {
        if !ATTRACT_IDS.contains(&id.0) {
            felt.push((id.0, [pen.view.x, pen.view.y, pen.pressure]));
        }
    }
    let visitors = state.hand_devices.iter().flatten().any(|id| !ATTRACT_IDS.contains(&id.0));
    if let Some(hands) = state.hands.as_ref().filter(|_| visitors) {
        felt.extend(hands.as_slice().iter().map(|h| (HAND, h.palm.to_array())));
    }
    (!felt.is_empty()).then_some(felt)
}
