//! The cycle at work: a thread looks at what the loop publishes, plays the attract recordings, and
//! sends what the cycle asks for.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::desk::{KioskDesk, VisitResult};
use super::exhibit::score_thread::{self, WantedScore};
use super::exhibit::{Exhibit, ExhibitStep};
use super::film::AttractRecording;
use super::gallery::{self, VisitLine};
use super::hours::Hours;
#[cfg(unix)]
use super::share;
use super::speech::Speech;
use super::spool::Spool;
use super::staff::{StaffRequest, VisitFigures, export, hottest_celsius};
use super::start::{BuiltForms, Start};
use super::visit_journal::{PutAway, VisitNews};
use super::{Cycle, Interrupted, KioskAct, KioskConfig, Language, Stage};
use crate::Published;
use crate::adaptors::ATTRACT_IDS;
use crate::command_queue::CommandSender;
use crate::disk_space::free_bytes;
use crate::local_time::{LocalClock, LocalTime};
use crate::session::Health;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue::{Sender, SenderFactory};
use sculptd_devices::{Clock, DeviceId};
use sculptd_geometry::job::Job;

/// Looks a second.
const RATE_HZ: f64 = 50.0;
/// Id of the hands in the list of touching pens.
const HAND: u16 = u16::MAX;
/// Interval at which the calendar and the staff page are looked at, microseconds.
const SLOW_US: u64 = 1_000_000;

/// A running keeper; it ends once `stop` is set.
#[derive(Debug)]
pub struct KioskKeeper {
    pub desk: Arc<KioskDesk>,
    pub thread: JoinHandle<()>,
}

/// The file of an export, or why there is none.
type Exported = Result<PathBuf, String>;

struct KioskThread {
    config: KioskConfig,
    start: Start,
    built: BuiltForms,
    /// Index of the form in the world; `None`: that of an interrupted visit, which is gone.
    form: Option<usize>,
    /// Index of the exhibit's step.
    step: usize,
    hours: Hours,
    calendar: Option<LocalClock>,
    wall: Option<LocalTime>,
    cleaning: bool,
    looked_us: u64,
    figures: VisitFigures,
    /// It is known that the visit is not stored.
    unstored: bool,
    /// Takes the goal that the newest clay is scored against; `None`: no exhibit has a goal.
    goals: Option<cc::Sender<Option<WantedScore>>>,
    /// Results of exports.
    exported: (cc::Sender<Exported>, cc::Receiver<Exported>),
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
    /// Index of the form that the next film shows; `None`: the one after the form in the world.
    next_form: Option<usize>,
    /// The clay was reset for the time in which the installation is closed.
    rests: bool,
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
    let built = BuiltForms::build(&start).map_err(|e| e.to_string())?;
    let desk = Arc::new(KioskDesk::default());
    let exhibits = start.forms.iter().filter_map(|form| form.exhibit.as_ref());
    let has_goal = exhibits.flat_map(|exhibit| &exhibit.steps).any(|step| step.goal.is_some());
    let goals = has_goal.then(|| score_thread::start(published.clone(), desk.score.clone()));
    let goals = goals.transpose().map_err(|e| e.to_string())?;
    let hours = Hours::parse(&config.hours.open)?;
    let calendar = LocalClock::new().inspect_err(|e| {
        tracing::error!("kiosk: no calendar, so there are no opening hours: {e}");
    });
    let form = start.interrupted.map_or(Some(0), |visit| visit.form);
    let mut keeping = KioskThread {
        config,
        start,
        built,
        form,
        step: 0,
        hours,
        calendar: calendar.ok(),
        wall: None,
        cleaning: false,
        looked_us: 0,
        figures: VisitFigures::default(),
        unstored: false,
        goals,
        exported: cc::unbounded(),
        published,
        commands,
        sender: factory.sender(),
        clock,
        stop,
        desk: desk.clone(),
        films,
        film: 0,
        playing: false,
        next_form: form.or(Some(0)),
        rests: false,
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
        self.look(&mut cycle);
        if self.start.interrupted.is_some() {
            cycle = cycle.resumed();
            cycle.limit(self.minutes());
            self.send_goal(None);
            if self.config.interrupted == Interrupted::Gallery {
                let act = cycle.interrupt();
                self.carry_out(act, &mut cycle);
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
            self.carry_out(act, &mut cycle);
            self.follow_choice(&mut cycle);
            if self.desk.next_step.swap(false, Relaxed) {
                self.next_step(&mut cycle);
            }
            let typed = self.desk.typed.lock().ok().and_then(|mut t| t.take());
            if let Some(number) = typed {
                cycle.type_pin(&number, &self.config.staff_pin);
                // The page opens with figures of now.
                self.look(&mut cycle);
            }
            self.staff(&mut cycle);
            if self.clock.now_us().saturating_sub(self.looked_us) >= SLOW_US {
                self.look(&mut cycle);
            }
            match cycle.view().stage {
                Stage::Attract if !cycle.view().staff => {
                    self.attract();
                    #[cfg(unix)]
                    self.drop_expired();
                }
                Stage::Closed => self.rest(),
                _ => {}
            }
            self.speech.say(&cycle.view());
            self.show(&cycle);
            let _ = quiet.recv_timeout(Duration::from_secs_f64(1.0 / RATE_HZ));
        }
        // The program ends, the visitor's work is put away. Who has lost the screen alone is still
        // there.
        if !self.desk.screen_gone.load(Relaxed) {
            let act = cycle.interrupt();
            self.carry_out(act, &mut cycle);
        }
    }

    /// Shows the state to the screen.
    fn show(&self, cycle: &Cycle) {
        let mut now = cycle.view();
        now.exhibit = self.exhibit().and(self.form);
        now.step = self.step;
        now.cleaning = self.cleaning;
        now.opens_at = self.wall.and_then(|wall| self.hours.opens_next(wall));
        if let Ok(mut view) = self.desk.view.lock() {
            *view = Some(now);
        }
    }

    /// The exhibit in the world.
    fn exhibit(&self) -> Option<&Arc<Exhibit>> {
        self.built.get(self.form?).exhibit.as_ref()
    }

    fn exhibit_step(&self) -> Option<&ExhibitStep> {
        self.exhibit()?.steps.get(self.step)
    }

    /// Longest time for a visit, minutes; 0: no limit.
    fn minutes(&self) -> f64 {
        self.exhibit().map_or(0.0, |exhibit| exhibit.manifest.minutes)
    }

    /// Has the newest clay scored against the goal of the step, from now on. `not`: the clay before
    /// a reset that is on its way.
    fn send_goal(&self, not: Option<u32>) {
        let goal = self.exhibit_step().and_then(|step| step.goal.clone());
        if let Some(goals) = &self.goals {
            // The thread ends after this one.
            let _ = goals.send(goal.map(|goal| WantedScore { goal, not }));
        }
    }

    fn next_step(&mut self, cycle: &mut Cycle) {
        let steps = self.exhibit().map_or(0, |exhibit| exhibit.steps.len());
        if cycle.view().stage == Stage::Working && self.step + 1 < steps {
            self.step += 1;
            self.send_goal(None);
        }
    }

    /// Looks at the calendar, and refreshes the staff page if it is open.
    fn look(&mut self, cycle: &mut Cycle) {
        self.looked_us = self.clock.now_us();
        self.wall = self.calendar.as_ref().and_then(LocalClock::now);
        let open = self.wall.is_none_or(|wall| self.hours.is_open(wall));
        cycle.set_closed(self.cleaning || !open);
        let fault = self.start.health.as_ref().and_then(Health::trouble);
        if let (false, Some(why)) = (self.unstored, &fault) {
            self.figures.error(format!("the visit is not stored: {why}"));
        }
        self.unstored = fault.is_some();
        if !cycle.view().staff {
            return;
        }
        if let Ok(mut facts) = self.desk.staff.lock() {
            let day = self.wall.map(|wall| wall.day);
            self.figures.show(day, &mut facts);
            facts.up_s = self.clock.now_us() / 1_000_000;
            let gallery = &self.config.gallery;
            facts.free_bytes =
                if gallery.as_os_str().is_empty() { None } else { free_bytes(gallery) };
            facts.celsius = hottest_celsius();
            facts.cleaning = self.cleaning;
            if let Ok(result) = self.exported.1.try_recv() {
                facts.exported = Some(result);
            }
        }
    }

    /// Carries out the requests of the staff page. They count only while it is open.
    fn staff(&mut self, cycle: &mut Cycle) {
        let requests = self.desk.requests.lock().map(|mut all| std::mem::take(&mut *all));
        for request in requests.unwrap_or_default() {
            if !cycle.view().staff {
                continue;
            }
            tracing::info!("kiosk: staff: {request:?}");
            match request {
                StaffRequest::Leave => cycle.leave_staff(),
                StaffRequest::Cleaning(cleaning) => self.cleaning = cleaning,
                StaffRequest::Exhibit(index) if index < self.built.len() => {
                    let act = cycle.interrupt();
                    self.carry_out(act, cycle);
                    self.next_form = Some(index);
                    self.stop_film();
                    cycle.leave_staff();
                }
                StaffRequest::Exhibit(_) => {}
                StaffRequest::Export => self.export(),
                StaffRequest::Restart => {
                    self.desk.again.store(true, Relaxed);
                    self.stop.store(true, Relaxed);
                }
                StaffRequest::End => self.stop.store(true, Relaxed),
            }
            self.look(cycle);
        }
    }

    /// Packs the works of today on a separate thread: copying a day's works takes a while.
    fn export(&self) {
        let (gallery, done) = (self.config.gallery.clone(), self.exported.0.clone());
        let since = self.calendar.as_ref().map_or(0, LocalClock::midnight);
        let pack = move || {
            let packed = export(&gallery, since);
            let _ = done.send(packed.map_err(|e| format!("{}: {e}", gallery.display())));
        };
        if let Err(e) = std::thread::Builder::new().name("sculptd-export".into()).spawn(pack) {
            let _ = self.exported.0.send(Err(e.to_string()));
        }
    }

    fn carry_out(&mut self, act: Option<KioskAct>, cycle: &mut Cycle) {
        match act {
            None => {}
            Some(KioskAct::Begin) => {
                tracing::info!("kiosk: a visit begins");
                self.stop_film();
                #[cfg(unix)]
                self.show_link(None);
                self.show_result(None);
                let chosen = self.desk.take_choice().filter(|&index| index < self.built.len());
                self.begin_with(chosen.or(self.form).unwrap_or(0), cycle);
            }
            Some(KioskAct::End { seconds }) => self.end_visit(seconds, cycle.view().visits),
        }
    }

    /// Begins with a form.
    fn begin_with(&mut self, form: usize, cycle: &mut Cycle) {
        self.dabs_before = self.published.load().figures.dabs;
        let before = self.published.load().mesh.object_id();
        self.put_back(form, false);
        cycle.limit(self.minutes());
        self.send_goal(Some(before));
    }

    /// A pen that presses an exhibit begins the visit by its touch, with the exhibit that is shown;
    /// the window's press comes when the pen is lifted.
    fn follow_choice(&mut self, cycle: &mut Cycle) {
        // While nobody is there the choice waits for the visit that it begins.
        if cycle.view().stage == Stage::Attract {
            return;
        }
        let chosen = self.desk.take_choice().filter(|&index| index < self.built.len());
        if let Some(form) = chosen
            && cycle.view().stage == Stage::Working
            && self.form != Some(form)
        {
            self.begin_with(form, cycle);
        }
    }

    /// Puts a visitor's work away.
    fn end_visit(&mut self, seconds: u64, visit: u64) {
        let state = self.published.load_full();
        let interrupted = self.start.interrupted.take().is_some();
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
                Err(e) => self.figures.error(format!("{}: {e}", self.config.gallery.display())),
            }
        }
        // The score of the work as it is put away, not of one that is a moment older.
        let goal = self.exhibit_step().and_then(|step| step.goal.clone());
        let goal = goal.filter(|_| dabs > 0 || interrupted);
        let score = goal.and_then(|goal| goal.score(&state.mesh.to_tri(), &Job::default()).ok());
        self.show_result(
            self.form.zip(score).map(|(exhibit, score)| VisitResult { exhibit, score }),
        );
        if let Some(goals) = &self.goals {
            let _ = goals.send(None);
        }
        let exhibit = self.exhibit().map(|exhibit| exhibit.name.clone());
        let percent = score.map(|score| score.percent());
        let line = VisitLine { visit, seconds, dabs, kept, interrupted, exhibit, percent };
        let file = &self.config.audit;
        if !file.as_os_str().is_empty()
            && let Err(e) = gallery::audit(file, &line)
        {
            self.figures.error(format!("{}: {e}", file.display()));
        }
        self.figures.ended(self.wall.map(|wall| wall.day), seconds, kept);
        // The attract film that follows begins with a reset.
        if let Some(news) = &self.start.news {
            let refused = keeps && !kept;
            let work = if refused { PutAway::Refused } else { PutAway::Done };
            let _ = news.send(VisitNews::PutAway(work));
        }
    }

    fn show_result(&self, result: Option<VisitResult>) {
        if let Ok(mut shown) = self.desk.result.lock() {
            *shown = result;
        }
    }

    /// The work is in the gallery: on to where it is kept for good, and to the visitor.
    fn pass_on(&mut self, path: &std::path::Path) {
        if let Some(spool) = &self.spool {
            spool.wake();
        }
        #[cfg(unix)]
        if let Some(share) = &self.share {
            match share.link(path) {
                Ok(link) => self.show_link(Some(link)),
                Err(e) => self.figures.error(format!("{}: {e}", path.display())),
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

    /// Resets everything to a form, for a film or for a visit.
    fn put_back(&mut self, form: usize, film: bool) {
        (self.form, self.step) = (Some(form), 0);
        self.rests = self.rests && film;
        self.start.film.store(film, Relaxed);
        let command = self.built.reset(form);
        // The loop takes 64 commands a tick: it has room again before long.
        if self.commands.send_timeout(command, Duration::from_secs(2)).is_err() {
            let text = "the reset was not carried out; the loop takes no commands";
            return self.figures.error(text.into());
        }
        if let Some(news) = self.start.news.as_ref().filter(|_| !film) {
            let form = self.built.get(form);
            let _ = news.send(VisitNews::Begins(form.plain.clone(), Box::new(form.brush)));
        }
    }

    fn attract(&mut self) {
        if !self.playing {
            // Each film begins on clean clay, and shows the next exhibit.
            let after = self.form.map_or(0, |form| (form + 1) % self.built.len());
            let next = self.next_form.take().unwrap_or(after);
            self.rests = false;
            self.put_back(next, true);
            if let Some(exhibit) = self.exhibit() {
                tracing::info!("kiosk: the film shows {}", exhibit.name);
            }
            self.films[self.film].rewind();
            (self.playing, self.began_us) = (true, self.clock.now_us());
        }
        let now = self.clock.now_us().saturating_sub(self.began_us);
        if !self.films[self.film].play(self.began_us, now, &mut self.sender) {
            self.film = (self.film + 1) % self.films.len();
            self.playing = false;
        }
    }

    /// Stops the film, if one is played.
    fn stop_film(&mut self) {
        if std::mem::take(&mut self.playing) {
            self.films[self.film].stop(self.clock.now_us(), &mut self.sender);
        }
    }

    /// While it is closed nothing moves, on clean clay.
    fn rest(&mut self) {
        if !std::mem::replace(&mut self.rests, true) {
            self.stop_film();
            self.put_back(self.form.unwrap_or(0), true);
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
