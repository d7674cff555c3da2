//! A live run put together: the loop on the wall's clock, the devices that feed it, the session,
//! the control socket, the figures for others, the kiosk. The command line says what is wanted and
//! shows what there is; what belongs together is decided here.

use std::path::PathBuf;
use std::sync::Arc;
#[cfg(unix)]
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::adaptors::{self, Adaptors};
use crate::brush_folder::BrushFolder;
use crate::camera_hands::{self, CameraStartError};
use crate::config::{Config, DevicesConfig};
use crate::demo_devices::{self, DemoError, Playing};
use crate::kiosk::desk::Screen;
use crate::kiosk::settings::LanguageTexts;
use crate::kiosk::start::Start;
use crate::kiosk::unrecorded::WithoutFilms;
use crate::kiosk::{KioskConfig, keeper, recovery};
use crate::live::{Live, LiveError, LiveInput};
use crate::live_booleans;
use crate::people::SharedEnd;
#[cfg(unix)]
use crate::qr_code::{Code, Invitation};
use crate::session::Health;
use crate::session::history::Handle;
use crate::session::writer::WriterThread;
use crate::shared_input::SharedInput;
use crate::simulated_loop::{Feed, summary};
use crate::startup::{Area, Begun, RecordingFeed};
use crate::tablet_actions::TabletActions;
use crate::tablet_controls::TabletControls;
use crate::tablet_models::ModelTables;
use crate::tick::Journal;
use crate::tick_statistics::Summary;
#[cfg(unix)]
use crate::web::WebRole;
use crate::window_link::{WindowLink, WindowStanding};
use sculptd_camera::camera_thread::{CameraChoice, CameraHandle};
use sculptd_clay::brush::Presets;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue::{self, SenderFactory};
use sculptd_devices::recording::Player;
use sculptd_devices::{Body, Clock, Pen, Sample, Tool};
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// Options of a live run.
#[derive(Debug, Default)]
pub struct LiveOptions {
    /// Presets of each brush.
    pub presets: Presets,
    /// The user's brushes, already read; the folder is watched during the run.
    pub brushes: Option<BrushFolder>,
    /// Texts of an installation's screen, by language code.
    pub languages: LanguageTexts<'static>,
    /// Settings of an installation; `None`: no visitors.
    pub kiosk: Option<KioskConfig>,
    /// Folder of the file of the visit in progress; `None`: visits are not recorded one by one.
    pub visits: Option<PathBuf>,
    /// True if simulated devices perform the demo.
    pub demo_devices: bool,
    /// True if drawn hands perform the camera's demo.
    pub drawn_hands: bool,
    /// True to listen to real devices.
    pub devices: bool,
    /// Recordings that are played at their own speed, and the part of the tablet that each uses.
    pub players: Vec<(Player, Option<Area>)>,
    /// The run ends after so many seconds.
    pub limit_s: Option<f64>,
    /// The user's bindings of tablet controls, which may change during the run.
    pub controls: TabletControls,
    /// The file of `--config`, for reading it again on SIGHUP.
    pub settings: Option<PathBuf>,
    /// Address at which metrics are served; `None`: not served.
    #[cfg(unix)]
    pub metrics: Option<std::net::SocketAddr>,
    /// The page on which others join; `None`: not served.
    #[cfg(unix)]
    pub web: Option<crate::web::WebOptions>,
    /// Options for exporting metrics and logs to a collector.
    #[cfg(unix)]
    pub telemetry: Option<crate::telemetry::TelemetryOptions>,
    /// State of the window. Without a session a lost window cannot be replaced.
    pub window: WindowLink,
    /// The shared sculpture; `None`: not shared.
    pub shared: Option<Box<dyn SharedInput>>,
}

/// Why a live run could not be put together.
#[derive(Debug, thiserror::Error)]
pub enum LiveRunError {
    #[error(transparent)]
    Loop(#[from] LiveError),
    #[error("{what}: {source}")]
    Service { what: String, source: std::io::Error },
    #[cfg(unix)]
    #[error(transparent)]
    Control(#[from] crate::control::server::ServeError),
    #[error(transparent)]
    DemoDevices(#[from] DemoError),
    #[error(transparent)]
    Camera(#[from] CameraStartError),
    #[error("{0}")]
    Kiosk(String),
}

/// A live run. Its devices stop when it is finished or dropped.
#[derive(Debug)]
pub struct LiveRun {
    pub live: Live,
    pub clock: Clock,
    pub adaptors: Arc<Adaptors>,
    /// Makes senders for more devices: a window's pointer.
    pub factory: SenderFactory,
    /// Raised by a signal, a closed window, `shutdown`, or the end of the time that was given.
    pub stop: Arc<AtomicBool>,
    /// The session's history, if one is kept.
    pub history: Option<Handle>,
    /// State of the session's file, if one is kept.
    pub health: Option<Health>,
    /// The screen of an installation, which replaces the panels.
    pub kiosk: Option<Screen>,
    /// The user's bindings of tablet controls.
    pub controls: TabletControls,
    /// The page by which guests join; `None` if it is not served.
    #[cfg(unix)]
    pub web: Option<Arc<crate::web::Web>>,
    /// State of the window.
    pub window: WindowLink,
    /// Notices about how the run began, one sentence each.
    pub notices: Vec<String>,
    demo: Option<Playing>,
    /// The camera of the demo's drawn hands.
    drawn: Option<CameraHandle>,
    writing: Option<WriterThread>,
    /// The keeper of an installation, which puts the last visitor's work away at the end.
    keeper: Option<JoinHandle<()>>,
    /// The thread of the visits' files.
    recording: Option<JoinHandle<()>>,
    #[cfg(unix)]
    _served: Served,
}

/// A live run that has ended.
#[derive(Debug)]
pub struct FinishedRun {
    pub world: World,
    /// Without the name of a file: nothing was written yet.
    pub summary: Summary,
    /// End of the part in a shared sculpture.
    pub shared: SharedEnd,
    writing: Vec<WriterThread>,
    /// Others are answered until the session is closed.
    #[cfg(unix)]
    _served: Served,
}

impl FinishedRun {
    /// Waits for the session's last group. `Some`: the disk did not take it, and why.
    pub fn close_session(self) -> Option<String> {
        // The world's memory is freed before the last wait.
        drop(self.world);
        let troubles: Vec<String> =
            self.writing.into_iter().filter_map(WriterThread::finish).collect();
        (!troubles.is_empty()).then(|| troubles.join("; "))
    }
}

/// Interval at which a run checks whether to end: a signal handler may only set a flag.
const LOOK: Duration = Duration::from_millis(200);
/// Interval at which recordings are checked.
const PLAY: Duration = Duration::from_millis(2);

impl LiveRun {
    /// Starts everything. `stop`: set by the caller to end the run.
    ///
    /// # Errors
    /// Returns an error if a thread, a socket or a port is unavailable, or if the installation's
    /// settings are invalid. A device that cannot be opened is no error: [`Adaptors::describe`]
    /// reports it.
    pub fn start(
        mut options: LiveOptions,
        config: &Config,
        begun: Begun,
        catalogue: Catalogue,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, LiveRunError> {
        let clock = Clock::monotonic();
        let (factory, receiver) = queue::channel(config.channel.capacity);
        let none = DevicesConfig { hid: false, ..Default::default() };
        let devices = if options.devices { &config.devices } else { &none };
        let models = ModelTables::new(&catalogue, &config.devices);
        let adaptors = Arc::new(adaptors::start(devices, catalogue, &clock, &factory));
        let mut notices = Vec::new();
        // Without exhibits every visitor finds what the first one found.
        let plain = || begun.started_with.clone().unwrap_or_else(|| begun.world.mesh().to_tri());
        let first = options.kiosk.as_ref().map(|kiosk| {
            let settings = (&options.presets, *begun.world.brush(), config.camera.camera());
            Start::new(kiosk, settings, plain)
        });
        let mut first = first.transpose().map_err(LiveRunError::Kiosk)?;
        let (begun, visits) = match (&options.visits, &mut first) {
            (Some(folder), Some(first)) => {
                let audit = options.kiosk.as_ref().map(|kiosk| kiosk.audit.clone());
                let folders = (&**folder, &*audit.unwrap_or_default());
                recovery::begin(folders, first, begun, config, &mut notices)
            }
            _ => (begun, None),
        };
        let drawn = options.drawn_hands.then(|| {
            let settings = config.devices.camera_settings;
            camera_hands::start_choice(CameraChoice::Drawn, settings, &clock, factory.sender())
        });
        let drawn = drawn.transpose()?;
        let (writer, writing) = begun.journal.unzip();
        let (mut health, mut history) = (None, None);
        if let Some(thread) = &writing {
            health = Some(thread.health.clone());
            history = thread.history.as_ref().map(|k| k.handle.clone());
        }
        // The thread of a visit's file ends with the visit.
        let watched = health.clone();
        let (mut journal, mut recording, mut visit_history) = (None, None, None);
        if let Some(visits) = visits {
            health = Some(visits.health);
            visit_history = visits.history;
            recording = Some(visits.thread);
            journal = Some(Box::new(visits.journal) as Box<dyn Journal>);
        } else if let Some(writer) = writer {
            journal = Some(match &first {
                Some(first) => Box::new(WithoutFilms::new(writer, first.film.clone())),
                None => Box::new(writer) as Box<dyn Journal>,
            });
        }
        let actions = TabletActions::new(config.devices.actions.clone(), options.presets.clone())
            .with_controls(options.controls.clone())
            .with_models(models.of(adaptors.clone()));
        let input = LiveInput {
            drain_per_tick: config.channel.drain_per_tick,
            actions: Some(actions),
            door: first.as_ref().map(|first| first.door.clone()),
            shared: options.shared.take(),
        };
        let (rate, followed) = (config.r#loop, input.shared.is_none());
        let live = Live::start_with(begun.world, receiver, clock.clone(), rate, input, journal)?;
        for history in history.iter().chain(&visit_history) {
            history.connect(live.commands.clone());
        }
        if followed {
            // In a shared sculpture each daemon would compute the same.
            let (commands, published) = (live.commands.clone(), live.published.clone());
            let started = live_booleans::start(commands, published, stop.clone());
            started.map_err(|source| LiveRunError::Service {
                what: "sculptd-follow".into(),
                source,
            })?;
        }
        if let Some(folder) = options.brushes.take() {
            notices.extend(folder.problems().iter().map(|e| format!("brush not taken: {e}")));
            folder.watch(stop.clone()).map_err(|source| LiveRunError::Service {
                what: "sculptd-brushes".into(),
                source,
            })?;
        }
        // Before anybody is answered: a touch that comes later is seen.
        #[cfg_attr(not(unix), allow(unused_mut))]
        let (mut kiosk, keeper) = match options.kiosk.take().zip(first) {
            Some((kiosk, first)) => {
                screen((kiosk, options.languages), first, &live, &factory, &clock, &stop)?
            }
            None => (None, None),
        };
        #[cfg(unix)]
        let mut web = None;
        #[cfg(unix)]
        let _served = {
            let pen = crate::control::stroke::VirtualPen::new(&factory, clock.clone());
            let host = crate::control::Host {
                stop: stop.clone(),
                journal: health.clone(),
                history: history.clone(),
                pen: Some(Arc::new(Mutex::new(pen))),
                window: options.window.clone(),
                ..crate::control::Host::new(
                    live.commands.clone(),
                    live.published.clone(),
                    options.presets.clone(),
                )
            };
            if let Some(wanted) = options.web.take() {
                let (page, links) = serve_page(&wanted, &live, &factory, &clock, &options, &stop)?;
                for (role, url) in links {
                    notices.push(format!("{}: {url}", purpose(role)));
                    if let (Some(screen), WebRole::Viewer) = (&mut kiosk, role) {
                        screen.watch = Code::of(&url).map(|code| Invitation { url, code });
                    }
                }
                web = Some(page);
            }
            let host = crate::control::Host { web: web.clone(), ..host };
            Served::start(&options, config, host, watched, &mut notices)?
        };
        #[cfg(not(unix))]
        let _: Option<Health> = watched;
        let window = options.window.clone();
        let demo = match options.demo_devices {
            true => Some(demo_devices::playing(&clock, &factory)?),
            false => None,
        };
        play(options.players, &clock, &factory, &stop)?;
        if let Some(seconds) = options.limit_s {
            end_after(seconds, &stop)?;
        }
        Ok(LiveRun {
            live,
            clock,
            adaptors,
            factory,
            stop,
            history,
            health,
            kiosk,
            controls: options.controls,
            #[cfg(unix)]
            web,
            window,
            notices,
            demo,
            drawn,
            writing,
            keeper,
            recording,
            #[cfg(unix)]
            _served,
        })
    }

    /// Returns the time at which the demo's devices end, in microseconds on the clock; 0 without
    /// them.
    pub fn demo_ends_us(&self) -> u64 {
        self.demo.as_ref().map_or(0, |d| d.ends_us)
    }

    /// Waits until `stop` is set or the loop ends.
    pub fn wait(&self) {
        let quiet = crossbeam_channel::never::<()>();
        while self.live.is_running() && !self.stop.load(Relaxed) {
            let _ = quiet.recv_timeout(LOOK);
        }
    }

    /// Handles the unexpected loss of the window: reverts the window's settings and ends every
    /// stroke as if the pen were lifted. The run continues.
    pub fn window_lost(&self) {
        self.window.set_standing(WindowStanding::Lost);
        let claims = self.window.claims();
        let shown = self.live.published.load_full();
        let own = [adaptors::POINTER_ID, adaptors::CONTROL_PEN_ID];
        let pens = shown.tablets.iter().flatten().map(|t| t.0).filter(|id| !own.contains(id));
        let lent = claims.lent.map(Command::Brush);
        let desktop = Command::DesktopLayout(claims.desktop_without_window(pens));
        for command in lent.into_iter().chain([desktop, Command::LiftAll]) {
            if self.live.commands.send(command).is_err() {
                return;
            }
        }
        // The pointer has left, as a pen leaves its tablet.
        let mut sender = self.factory.sender();
        let body = Body::Pen(Pen { tool: Tool::Touch, ..Pen::default() });
        let t_us = self.clock.now_us();
        sender.push(Sample { device: adaptors::POINTER_ID, t_us, device_t_us: None, body });
        sender.flush();
    }

    /// Stops the devices, then the loop, and returns the sculpture.
    ///
    /// # Errors
    /// Returns an error if the tick thread panicked.
    pub fn finish(self) -> Result<FinishedRun, LiveError> {
        drop((self.demo, self.drawn, self.adaptors));
        if let Some(keeper) = self.keeper {
            self.stop.store(true, Relaxed);
            let _ = keeper.join();
        }
        let ended = self.live.stop()?;
        if let Some(recording) = self.recording {
            let _ = recording.join();
        }
        let mut summary = summary(&ended.figures, &ended.world, &ended.receiver, None);
        summary.sample_to_present = self.window.present_latency().summary();
        Ok(FinishedRun {
            world: ended.world,
            summary,
            shared: ended.shared,
            writing: self.writing.into_iter().chain(ended.writing).collect(),
            #[cfg(unix)]
            _served: self._served,
        })
    }
}

/// Servers through which others reach the run; closed when dropped.
#[cfg(unix)]
#[derive(Debug)]
struct Served {
    _control: Option<crate::control::Server>,
    _metrics: Option<crate::metrics::Metrics>,
    _telemetry: Option<crate::telemetry::Telemetry>,
    _service: crate::service::Service,
}

#[cfg(unix)]
impl Served {
    fn start(
        options: &LiveOptions,
        config: &Config,
        host: crate::control::Host,
        journal: Option<Health>,
        notices: &mut Vec<String>,
    ) -> Result<Self, LiveRunError> {
        use crate::control::server::ServeError;
        use crate::metrics::Metrics;
        use crate::service::{Reload, Service};
        let (published, window) = (host.published.clone(), options.window.clone());
        let watched = crate::systemd::Watched { published, journal, window };
        let commands = host.commands.clone();
        let control = match crate::control::Server::start(&crate::control::default_path(), host) {
            Ok(server) => Some(server),
            // A second daemon sculpts all the same; `sculptd ctl` talks to the first.
            Err(e @ ServeError::Taken { .. }) => {
                notices.push(format!("no control socket: {e}"));
                None
            }
            Err(e) => return Err(e.into()),
        };
        let failed = |what: String| move |source| LiveRunError::Service { what, source };
        let metrics = match options.metrics {
            None => None,
            Some(at) => {
                let page = Metrics::start(at, watched.clone());
                let page = page.map_err(failed(format!("metrics on {at}")))?;
                notices.push(format!("figures at http://{}/metrics", page.address()));
                Some(page)
            }
        };
        let telemetry = match options.telemetry.clone() {
            None => None,
            Some(telemetry) => {
                let to = telemetry.endpoint.shown();
                let export = crate::telemetry::Telemetry::start(telemetry, watched.clone());
                let export = export.map_err(failed(format!("telemetry for {to}")))?;
                notices.push(format!("telemetry goes to the collector at {to}"));
                Some(export)
            }
        };
        let reload = Reload { extra: options.settings.clone(), now: config.clone(), commands };
        let service = Service::start(watched, reload).map_err(failed("SIGHUP".into()))?;
        Ok(Served {
            _control: control,
            _metrics: metrics,
            _telemetry: telemetry,
            _service: service,
        })
    }
}

/// A link of the page, and the role that it gives.
#[cfg(unix)]
type FirstLink = (WebRole, String);

/// What a link is for.
#[cfg(unix)]
fn purpose(role: WebRole) -> &'static str {
    match role {
        WebRole::Sculptor => "to sculpt together",
        WebRole::Viewer => "to watch",
        WebRole::Device => "to use a tablet or a telephone as your pen",
    }
}

/// Starts to serve the page on which others join. Returns it, and its first links.
#[cfg(unix)]
fn serve_page(
    web: &crate::web::WebOptions,
    live: &Live,
    factory: &SenderFactory,
    clock: &Clock,
    options: &LiveOptions,
    stop: &Arc<AtomicBool>,
) -> Result<(Arc<crate::web::Web>, Vec<FirstLink>), LiveRunError> {
    use crate::web::{Web, WebState};
    let state = WebState {
        published: live.published.clone(),
        commands: live.commands.clone(),
        factory: factory.clone(),
        presets: options.presets.clone(),
        clock: clock.clone(),
        stop: stop.clone(),
        keys: Default::default(),
        own_views: web.own_views,
        downloads: Default::default(),
        walls: Default::default(),
        window: options.window.clone(),
        guests: crate::web::GuestList::shown_by(live.guests.clone()),
    };
    let failed = |source| LiveRunError::Service { what: format!("page on {}", web.at), source };
    let page = Web::start(web, state).map_err(failed)?;
    let mut links = Vec::new();
    for role in [WebRole::Sculptor, WebRole::Viewer, WebRole::Device] {
        if web.own_views || role != WebRole::Sculptor {
            let key = page.state.keys.issue(role, web.lasts, clock.now_us()).map_err(failed)?;
            links.push((role, page.link(&key)));
        }
    }
    Ok((Arc::new(page), links))
}

/// Starts the keeper of an installation.
fn screen(
    (kiosk, languages): (KioskConfig, LanguageTexts<'_>),
    first: Start,
    live: &Live,
    factory: &SenderFactory,
    clock: &Clock,
    stop: &Arc<AtomicBool>,
) -> Result<(Option<Screen>, Option<JoinHandle<()>>), LiveRunError> {
    let words = kiosk.every_language(languages).map_err(LiveRunError::Kiosk)?;
    let (staff, show) = (!kiosk.staff_pin.is_empty(), kiosk.screen.clone());
    let (published, commands) = (live.published.clone(), live.commands.clone());
    let (clock, stop) = (clock.clone(), stop.clone());
    let share_minutes = kiosk.share_minutes;
    let exhibits = first.forms.iter().filter_map(|form| form.exhibit.clone()).collect();
    let settings = (kiosk, &words[..]);
    let keeper = keeper::start(settings, first, published, commands, factory, clock, stop)
        .map_err(LiveRunError::Kiosk)?;
    let desk = keeper.desk;
    let screen = Screen { desk, words, staff, show, watch: None, exhibits, share_minutes };
    Ok((Some(screen), Some(keeper.thread)))
}

/// Plays recordings at their own speed on a thread of their own, from now on.
fn play(
    players: Vec<(Player, Option<Area>)>,
    clock: &Clock,
    factory: &SenderFactory,
    stop: &Arc<AtomicBool>,
) -> Result<(), LiveRunError> {
    if players.is_empty() {
        return Ok(());
    }
    let start = clock.now_us();
    let feed = |(mut player, area): (Player, Option<Area>)| {
        player.start_at(start);
        RecordingFeed::new(player, factory.sender(), area)
    };
    let mut feeds: Vec<RecordingFeed> = players.into_iter().map(feed).collect();
    let (clock, stop) = (clock.clone(), stop.clone());
    spawn("sculptd-player", move || {
        let quiet = crossbeam_channel::never::<()>();
        while !stop.load(Relaxed) && !feeds.iter().all(|f| f.finished()) {
            let now = clock.now_us();
            for feed in &mut feeds {
                feed.advance(now);
            }
            let _ = quiet.recv_timeout(PLAY);
        }
    })
}

/// Raises `stop` after so many seconds.
fn end_after(seconds: f64, stop: &Arc<AtomicBool>) -> Result<(), LiveRunError> {
    let stop = stop.clone();
    let wait = Duration::from_secs_f64(seconds);
    spawn("sculptd-limit", move || {
        let _ = crossbeam_channel::never::<()>().recv_timeout(wait);
        stop.store(true, Relaxed);
    })
}

fn spawn(name: &str, run: impl FnOnce() + Send + 'static) -> Result<(), LiveRunError> {
    let thread = std::thread::Builder::new().name(name.into()).spawn(run);
    thread.map(drop).map_err(|source| LiveRunError::Service { what: name.into(), source })
}
