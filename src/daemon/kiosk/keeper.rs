//! The cycle at work: a thread looks at what the loop publishes, plays the attract recordings, and
//! sends what the cycle asks for.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::attract::{AttractAct, AttractLoop};
use super::desk::{KioskDesk, VisitResult};
use super::exhibit::score_thread::{self, WantedScore};
use super::exhibit::{Exhibit, ExhibitStep};
use super::farewell::Farewell;
use super::felt::{is_at_work, touch};
use super::gallery::{self, VisitLine};
use super::hours::{DimHours, Hours};
use super::speech::Speech;
use super::spool::Spool;
use super::staff::{StaffRequest, VisitFigures, export, hottest_celsius};
use super::start::{BuiltForms, Start};
use super::visit_journal::{PutAway, VisitNews};
use super::{Cycle, Interrupted, KioskAct, KioskConfig, Language, Stage};
use crate::Published;
use crate::command_queue::{CommandSender, QueuedCommand};
use crate::disk_space::free_bytes;
use crate::local_time::{LocalClock, LocalTime};
use crate::session::Health;
use sculptd_devices::Clock;
use sculptd_devices::queue::{Sender, SenderFactory};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::Job;

/// Looks a second.
const RATE_HZ: f64 = 50.0;
/// Most ticks that a turn makes up for: nobody is sent away whose touches were not looked at.
const MOST_LATE: f64 = 5.0;
/// Longest wait for the end of a film, microseconds.
const FILM_ENDS_US: u64 = 200_000;
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
    /// Times at which nothing plays and nothing is spoken.
    quiet: Hours,
    dim: DimHours,
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
    attract: AttractLoop,
    /// Index of the form that the next film shows; `None`: the one after the form in the world.
    next_form: Option<usize>,
    /// The clay was reset for the time in which the installation is closed.
    rests: bool,
    dabs_before: u64,
    spool: Option<Spool>,
    farewell: Farewell,
    speech: Speech,
}

/// Starts keeping. A recording that cannot be played is an error here and not in front of visitors.
pub fn start(
    (config, languages): (KioskConfig, &[Language]),
    start: Start,
    published: Arc<ArcSwap<Published>>,
    commands: CommandSender,
    factory: &SenderFactory,
    clock: Clock,
    stop: Arc<AtomicBool>,
) -> Result<KioskKeeper, String> {
    let attract = AttractLoop::new(&config, start.camera, start.forms[0].brush)?;
    let spool = match config.gallery_store.as_str() {
        "" => None,
        place => Some(Spool::start(&config.gallery, place)?),
    };
    let farewell = Farewell::start(&config, languages, spool.as_ref(), &clock)?;
    let words = languages.first().ok_or("no language")?;
    let countdown = format!("{} {}", words.countdown, words.go_on);
    let speech = Speech::new(&config.speak, &words.welcome, &countdown);
    let built = BuiltForms::build(&start).map_err(|e| e.to_string())?;
    let desk = Arc::new(KioskDesk::default());
    let exhibits = start.forms.iter().filter_map(|form| form.exhibit.as_ref());
    let has_goal = exhibits.flat_map(|exhibit| &exhibit.steps).any(|step| step.goal.is_some());
    let goals = has_goal.then(|| score_thread::start(published.clone(), desk.score.clone()));
    let goals = goals.transpose().map_err(|e| e.to_string())?;
    let hours = Hours::parse(&config.hours.open)?;
    let quiet = Hours::parse(&config.hours.quiet)?;
    let dim = DimHours::parse(&config.hours.dim_at)?;
    let calendar = LocalClock::new().inspect_err(|e| {
        tracing::error!("kiosk: no calendar, so there are no opening hours: {e}");
    });
    let form = start.interrupted.map_or(Some(0), |visit| visit.form);
    let now = calendar.as_ref().ok().and_then(|c| Some((c.midnight(), c.now()?.day)));
    let resumed = |(since, day)| VisitFigures::resumed(day, &config.gallery, since);
    let figures = now.map(resumed).unwrap_or_default();
    let mut keeping = KioskThread {
        config,
        start,
        built,
        form,
        step: 0,
        hours,
        quiet,
        dim,
        calendar: calendar.ok(),
        wall: None,
        cleaning: false,
        looked_us: 0,
        figures,
        unstored: false,
        goals,
        exported: cc::unbounded(),
        published,
        commands,
        sender: factory.sender(),
        clock,
        stop,
        desk: desk.clone(),
        attract,
        next_form: form.or(Some(0)),
        rests: false,
        dabs_before: 0,
        spool,
        farewell,
        speech,
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
        let cycle = Cycle::new(RATE_HZ, self.config.idle_s, self.config.countdown_s);
        let mut cycle = cycle.with_farewell(!self.config.share.is_empty());
        let (mut turn_us, mut late) = (self.clock.now_us(), 0.0);
        if !self.config.gallery.as_os_str().is_empty()
            && let Err(e) = gallery::takes_files(&self.config.gallery)
        {
            let gallery = self.config.gallery.display();
            self.figures.error(format!("{gallery}: works cannot be kept: {e}"));
        }
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
            let knocked = self.start.door.take_knock();
            let moved = now.is_some() && now != felt;
            // A pen in the air keeps a visit going, but begins none: a pointer that stands where
            // the window opens is no visitor.
            let comes = now.as_ref().is_some_and(|felt| felt.iter().any(is_at_work));
            let touched =
                pressed || knocked || moved && (comes || cycle.view().stage != Stage::Attract);
            felt = now;
            let done = self.desk.finished.swap(false, Relaxed);
            let before = cycle.view().stage;
            let act = cycle.step(touched, done);
            let acted = act.is_some();
            self.carry_out(act, &mut cycle);
            // A minute is a minute, though a turn of this loop takes longer than a tick. The time
            // that a beginning or an end takes is not the visitor's.
            let now_us = self.clock.now_us();
            let ticks = (now_us - turn_us) as f64 * 1e-6 * RATE_HZ;
            late = if acted { 0.0 } else { (late + ticks - 1.0).clamp(0.0, MOST_LATE) };
            turn_us = now_us;
            while late >= 1.0 {
                late -= 1.0;
                let act = cycle.step(false, false);
                self.carry_out(act, &mut cycle);
            }
            if before == Stage::Farewell && cycle.view().stage != Stage::Farewell {
                self.farewell.clear(&self.desk);
            }
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
                Stage::Attract if self.is_quiet() => self.rest(),
                Stage::Attract if !cycle.view().staff => {
                    self.attract();
                }
                Stage::Farewell => {
                    if let Err(e) = self.farewell.share(&self.desk) {
                        self.figures.error(e);
                    }
                }
                Stage::Closed => self.rest(),
                _ => {}
            }
            if !self.is_quiet() {
                self.speech.say(&cycle.view());
            }
            let now = cycle.view();
            self.start.door.set_nobody(now.stage == Stage::Attract && !now.staff);
            self.start.door.set_locked(now.stage == Stage::Closed);
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
        now.work = self.attract.work();
        now.exhibit = self.exhibit().and(self.form).filter(|_| now.work.is_none());
        now.step = self.step;
        now.cleaning = self.cleaning;
        now.opens_next = self.wall.and_then(|wall| self.hours.opens_next(wall));
        let dim = match now.stage {
            Stage::Closed => self.config.hours.dim,
            Stage::Attract => self.wall.map_or(0.0, |wall| self.dim.at(wall)),
            _ => 0.0,
        };
        now.dim_percent = (dim * 100.0).round() as u8;
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

    /// Looks at the calendar, and refreshes the figures for staff.
    fn look(&mut self, cycle: &mut Cycle) {
        self.looked_us = self.clock.now_us();
        self.wall = self.calendar.as_ref().and_then(LocalClock::now);
        let open = self.wall.is_none_or(|wall| self.hours.is_open(wall));
        cycle.set_closed(self.cleaning || !open);
        self.farewell.drop_expired(&self.desk);
        let fault = self.start.health.as_ref().and_then(Health::trouble);
        if let (false, Some(why)) = (self.unstored, &fault) {
            self.figures.error(format!("the visit is not stored: {why}"));
        }
        self.unstored = fault.is_some();
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

    /// Carries out the requests of staff.
    fn staff(&mut self, cycle: &mut Cycle) {
        for request in self.desk.take_requests(cycle.view().staff) {
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
                self.show_result(None);
                let chosen = self.desk.take_choice().filter(|&index| index < self.built.len());
                self.begin_with(chosen.or(self.form).unwrap_or(0), cycle);
            }
            Some(KioskAct::End { seconds }) => {
                let kept = self.end_visit(seconds, cycle.view().visits);
                self.desk.kept.store(kept.is_some(), Relaxed);
                let result = self.desk.result.lock().is_ok_and(|result| result.is_some());
                if kept.is_none() && !result {
                    cycle.end_farewell();
                }
                if let (Stage::Farewell, Some(work)) = (cycle.view().stage, kept)
                    && !self.config.share.is_empty()
                {
                    self.farewell.ask(work, &self.desk);
                }
            }
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

    /// Puts a visitor's work away, and returns its file in the gallery.
    fn end_visit(&mut self, seconds: u64, visit: u64) -> Option<PathBuf> {
        let state = self.published.load_full();
        let interrupted = self.start.interrupted.take().is_some();
        let dabs = state.figures.dabs.saturating_sub(self.dabs_before);
        let mut kept = None;
        let keeps = !self.config.gallery.as_os_str().is_empty();
        let keeps = keeps && (dabs > 0 || interrupted);
        if keeps {
            match self.keep(&state.mesh.to_tri()) {
                Ok(path) => {
                    if let Some(spool) = &self.spool {
                        spool.wake();
                    }
                    kept = Some(path);
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
        let work = kept.as_ref().and_then(|path| path.file_name());
        let work = work.map(|name| name.to_string_lossy().into_owned());
        let kept_it = kept.is_some();
        let line =
            VisitLine { visit, seconds, dabs, kept: kept_it, work, interrupted, exhibit, percent };
        let file = &self.config.audit;
        if !file.as_os_str().is_empty()
            && let Err(e) = gallery::audit(file, &line)
        {
            self.figures.error(format!("{}: {e}", file.display()));
        }
        self.figures.ended(self.wall.map(|wall| wall.day), seconds, kept_it);
        // The attract film that follows begins with a reset.
        if let Some(news) = &self.start.news {
            let refused = keeps && !kept_it;
            let work = if refused { PutAway::Refused } else { PutAway::Done };
            let _ = news.send(VisitNews::PutAway(work));
        }
        kept
    }

    /// Puts a work into the gallery. A note beside the visit's file names it first: if the program
    /// is killed before that file is removed, the next start does not keep the work twice.
    fn keep(&self, mesh: &TriMesh) -> std::io::Result<PathBuf> {
        let path = gallery::next(&self.config.gallery)?;
        if let Some(note) = &self.start.putting_away {
            let name = path.as_os_str().as_encoded_bytes();
            write_beside(note, |out| out.write_all(name))?;
        }
        gallery::keep_as(&path, &mesh.to_poly())?;
        Ok(path)
    }

    fn show_result(&self, result: Option<VisitResult>) {
        if let Ok(mut shown) = self.desk.result.lock() {
            *shown = result;
        }
    }

    /// Resets everything to a form, for a film or for a visit.
    fn put_back(&mut self, form: usize, film: bool) {
        (self.form, self.step) = (Some(form), 0);
        self.rests = self.rests && film;
        self.start.film.store(film, Relaxed);
        // The window has its proportions, whatever the settings say.
        let aspect = self.published.load().camera.aspect;
        let reset = self.built.reset(form, Camera { aspect, ..self.start.camera });
        if !self.send(QueuedCommand { begins_visit: !film, ..reset }) {
            return;
        }
        if let Some(news) = self.start.news.as_ref().filter(|_| !film) {
            let form = self.built.get(form);
            let _ = news.send(VisitNews::Begins(form.plain.clone(), Box::new(form.brush), aspect));
        }
    }

    /// Sends a reset; `false`: the loop takes none.
    fn send(&mut self, reset: QueuedCommand) -> bool {
        // The loop takes 64 commands a tick: it has room again before long.
        let sent = self.commands.send_timeout(reset, Duration::from_secs(2)).is_ok();
        if !sent {
            let text = "the reset was not carried out; the loop takes no commands";
            self.figures.error(text.into());
        }
        sent
    }

    /// Returns true in the quiet hours.
    fn is_quiet(&self) -> bool {
        !self.config.hours.quiet.is_empty()
            && self.wall.is_some_and(|wall| self.quiet.is_open(wall))
    }

    fn attract(&mut self) {
        let midnight = || self.calendar.as_ref().map_or(0, LocalClock::midnight);
        let given = (self.published.load().camera.aspect, midnight);
        let act = self.attract.step(self.clock.now_us(), &mut self.sender, given);
        match act {
            None => {}
            Some(AttractAct::Film) => {
                // Each film begins on clean clay, and shows the next exhibit.
                let after = self.form.map_or(0, |form| (form + 1) % self.built.len());
                let next = self.next_form.take().unwrap_or(after);
                self.rests = false;
                self.put_back(next, true);
                if let Some(exhibit) = self.exhibit() {
                    tracing::info!("kiosk: the film shows {}", exhibit.name);
                }
            }
            Some(AttractAct::Work(command)) => {
                self.rests = false;
                self.start.film.store(true, Relaxed);
                self.send(*command);
            }
            // Another turn follows in a moment.
            Some(AttractAct::Turn(camera)) => {
                let _ = self.commands.try_send(Command::Camera(camera));
            }
        }
    }

    /// Stops what plays, and waits until the loop has taken the film's last sample: a tick takes
    /// commands first, so a film would sculpt on the clay of the reset that follows.
    fn stop_film(&mut self) {
        let now = self.clock.now_us();
        if !self.attract.stop(now, &mut self.sender) {
            return;
        }
        let quiet = cc::never::<()>();
        while self.published.load().figures.newest_us < now
            && self.clock.now_us() < now + FILM_ENDS_US
        {
            let _ = quiet.recv_timeout(Duration::from_millis(1));
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
