//! One live run, with or without a window: the wall's clock, real devices, ghosts or recordings
//! beside them.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::run::{export, stop_signal};
use super::{Fail, display};
use crate::settings::LANGUAGES;
use sculptd_daemon::config::Config;
use sculptd_daemon::kiosk::{KioskConfig, keeper};
use sculptd_daemon::live::Live;
use sculptd_daemon::session::Health;
use sculptd_daemon::session::history::Handle;
use sculptd_daemon::session::writer::WriterThread;
use sculptd_daemon::simulated_loop::{Feed, summary};
use sculptd_daemon::startup::{Area, Begun, RecordingFeed};
use sculptd_daemon::tick::Journal;
use sculptd_daemon::{Summary, adaptors, demo_devices};
use sculptd_devices::Clock;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::queue;
use sculptd_devices::queue::SenderFactory;
use sculptd_devices::recording::Player;

/// What makes one live run different from another.
#[derive(Debug, Default)]
pub struct LiveRun {
    pub window: bool,
    pub full_screen: bool,
    /// Visitors come and go.
    pub kiosk: Option<KioskConfig>,
    /// Simulated devices perform the demo's journal.
    pub ghosts: bool,
    /// Real devices are listened to.
    pub devices: bool,
    pub players: Vec<(Player, Option<Area>)>,
    pub limit_s: Option<f64>,
    pub export: Option<PathBuf>,
    pub session: Option<PathBuf>,
    /// Sessions that the window offers to open, the newest first.
    pub recent: Vec<PathBuf>,
    /// The session that a person chose to open next.
    pub open_next: super::library::OpenNext,
    /// The file of `--config`, for reading it again.
    pub settings: Option<PathBuf>,
    /// Where the figures are served, if anywhere.
    #[cfg(unix)]
    pub metrics: Option<std::net::SocketAddr>,
}

/// How often a run without a window looks whether it should end.
const LOOK: Duration = Duration::from_millis(20);

pub fn run(
    run: LiveRun,
    config: &Config,
    begun: Begun,
    catalogue: Catalogue,
) -> Result<Summary, Fail> {
    let clock = Clock::monotonic();
    let (factory, receiver) = queue::channel(config.channel.capacity);
    let mut settings = config.devices.clone();
    if !run.devices {
        settings = sculptd_daemon::config::DevicesConfig { hid: false, ..Default::default() };
    }
    let adaptors = Arc::new(adaptors::start(&settings, catalogue, &clock, &factory));
    // As the world is now, so every visitor finds it.
    let start = run.kiosk.is_some().then(|| keeper::Start {
        plain: Arc::new(begun.world.mesh().to_tri()),
        camera: config.camera.camera(),
        brush: *begun.world.brush(),
    });
    let (writer, thread) = begun.journal.unzip();
    let health = thread.as_ref().map(|t| t.health.clone());
    let history = thread.as_ref().and_then(|t| t.history.as_ref()).map(|k| k.handle.clone());
    let journal = writer.map(|w| Box::new(w) as Box<dyn Journal>);
    let drain = config.channel.drain_per_tick;
    let live = Live::start(begun.world, receiver, clock.clone(), config.r#loop, drain, journal)
        .map_err(|e| Fail::Permission(e.to_string()))?;
    if let Some(history) = &history {
        history.connect(live.commands.clone());
    }
    let stop = stop_signal();
    let _control = control(&live, &factory, &clock, health.clone(), history.clone(), &stop)?;
    #[cfg(unix)]
    let _service = service(&run, &live, health, config)?;
    let ghosts = match run.ghosts {
        true => {
            Some(demo_devices::playing(&clock, &factory).map_err(|e| Fail::Check(e.to_string()))?)
        }
        false => None,
    };
    let _players = play(run.players, &clock, &factory, &stop);
    let keeper = match run.kiosk.zip(start) {
        None => None,
        Some((kiosk, start)) => {
            let words = kiosk.every_language(LANGUAGES).map_err(Fail::Config)?;
            let staff = !kiosk.staff_pin.is_empty();
            let (published, commands) = (live.published.clone(), live.commands.clone());
            let keeper = keeper::start(
                kiosk,
                start,
                published,
                commands,
                &factory,
                clock.clone(),
                stop.clone(),
            );
            let keeper = keeper.map_err(Fail::Config)?;
            Some(keeper::Screen { desk: keeper.desk, words, staff })
        }
    };
    let _limit = run.limit_s.map(|s| end_after(s, &stop));
    if run.window {
        let wired = display::Wired {
            live: &live,
            factory: &factory,
            clock: &clock,
            stop: &stop,
            adaptors: adaptors.clone(),
            session: run.session.as_ref().map(|p| p.display().to_string()),
            history: history.map(|h| (h, config.r#loop.rate_hz)),
            recent: run.recent.clone(),
            open_next: run.open_next.clone(),
            ghosts_until_us: ghosts.as_ref().map_or(0, |g| g.ends_us),
            full_screen: run.full_screen,
            kiosk: keeper,
        };
        if let Err(why) = display::show(&wired) {
            eprintln!("sculptd: going on without a window: {why}");
        }
    } else {
        for line in adaptors.describe() {
            eprintln!("sculptd: {line}");
        }
        eprintln!("sculptd: sculpting; end with Ctrl-C");
    }
    // Without a window, or after one that could not open: until a signal. A closed window has
    // raised `stop`.
    let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
    while live.is_running() && !stop.load(Relaxed) {
        let _ = quiet.recv_timeout(LOOK);
    }
    drop((ghosts, adaptors));
    let ended = live.stop().map_err(|e| Fail::Check(e.to_string()))?;
    let path = export(run.export.as_deref(), &ended.world)?;
    let summary = summary(&ended.figures, &ended.world, &ended.receiver, path);
    drop(ended);
    close_journal(thread);
    Ok(summary)
}

/// Waits for the journal's last group, and says so if the disk did not take it.
pub fn close_journal(thread: Option<WriterThread>) {
    if let Some(fault) = thread.and_then(WriterThread::finish) {
        eprintln!("sculptd: warning: {fault}");
    }
}

#[cfg(unix)]
fn service(
    run: &LiveRun,
    live: &Live,
    journal: Option<Health>,
    config: &Config,
) -> Result<(sculptd_daemon::service::Service, Option<sculptd_daemon::metrics::Metrics>), Fail> {
    use sculptd_daemon::metrics::Metrics;
    use sculptd_daemon::service;
    use sculptd_daemon::systemd::Watched;
    let watched = Watched { published: live.published.clone(), journal };
    let metrics = match run.metrics {
        None => None,
        Some(at) => {
            let page = Metrics::start(at, watched.clone())
                .map_err(|e| Fail::Permission(format!("metrics on {at}: {e}")))?;
            eprintln!("sculptd: figures at http://{}/metrics", page.address());
            Some(page)
        }
    };
    let reload = service::Reload {
        extra: run.settings.clone(),
        now: config.clone(),
        commands: live.commands.clone(),
    };
    let service = service::Service::start(watched, reload)
        .map_err(|e| Fail::Permission(format!("SIGHUP: {e}")))?;
    Ok((service, metrics))
}

#[cfg(unix)]
fn control(
    live: &Live,
    factory: &SenderFactory,
    clock: &Clock,
    journal: Option<Health>,
    history: Option<Handle>,
    stop: &Arc<AtomicBool>,
) -> Result<Option<sculptd_daemon::control::Server>, Fail> {
    use sculptd_daemon::control::server::ServeError;
    use sculptd_daemon::control::stroke::VirtualPen;
    use sculptd_daemon::control::{Host, Server, default_path};
    let pen = VirtualPen::new(factory, clock.clone());
    let host = Host {
        stop: stop.clone(),
        journal,
        history,
        pen: Some(Arc::new(Mutex::new(pen))),
        ..Host::new(live.commands.clone(), live.published.clone(), crate::presets().clone())
    };
    match Server::start(&default_path(), host) {
        Ok(server) => Ok(Some(server)),
        // A second daemon sculpts all the same; `sculptd ctl` talks to the first.
        Err(e @ ServeError::Taken { .. }) => {
            eprintln!("sculptd: no control socket: {e}");
            Ok(None)
        }
        Err(e) => Err(Fail::Permission(e.to_string())),
    }
}

#[cfg(not(unix))]
fn control(
    _: &Live,
    _: &SenderFactory,
    _: &Clock,
    _: Option<Health>,
    _: Option<Handle>,
    _: &Arc<AtomicBool>,
) -> Result<Option<()>, Fail> {
    Ok(None)
}

/// Plays recordings at their own speed on a thread of their own, from now on.
fn play(
    players: Vec<(Player, Option<Area>)>,
    clock: &Clock,
    factory: &SenderFactory,
    stop: &Arc<AtomicBool>,
) -> Option<std::thread::JoinHandle<()>> {
    if players.is_empty() {
        return None;
    }
    let start = clock.now_us();
    let mut feeds: Vec<RecordingFeed> = players
        .into_iter()
        .map(|(mut player, area)| {
            player.start_at(start);
            RecordingFeed::new(player, factory.sender(), area)
        })
        .collect();
    let (clock, stop) = (clock.clone(), stop.clone());
    let thread = std::thread::Builder::new().name("sculptd-player".into()).spawn(move || {
        let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
        while !stop.load(Relaxed) && !feeds.iter().all(|f| f.finished()) {
            let now = clock.now_us();
            for feed in &mut feeds {
                feed.advance(now);
            }
            let _ = quiet.recv_timeout(Duration::from_millis(2));
        }
    });
    thread.ok()
}

/// Raises `stop` after so many seconds.
fn end_after(seconds: f64, stop: &Arc<AtomicBool>) -> Option<std::thread::JoinHandle<()>> {
    let stop = stop.clone();
    let wait = Duration::from_secs_f64(seconds);
    let thread = std::thread::Builder::new().name("sculptd-limit".into()).spawn(move || {
        let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
        let _ = quiet.recv_timeout(wait);
        stop.store(true, Relaxed);
    });
    thread.ok()
}
