//! `sculptd run`: the daemon. With a display a window, without one headless; with recordings to
//! play and nothing else, a stepped run that gives the same bits every time.

#[cfg(unix)]
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::display::{self, Shown};
use super::ending::{close_journal, export};
use super::{Fail, Outcome, answer};
use super::{kiosk_settings, library, live};
use crate::settings::LANGUAGES;
use sculptd_camera::camera_thread::CameraChoice;
use sculptd_clay::brush::BrushKind;
use sculptd_daemon::Summary;
use sculptd_daemon::brush_folder::{self, BrushFolder};
use sculptd_daemon::camera_hands::{self, CameraFeed, CameraStartError};
use sculptd_daemon::config::{Config, ConfigError, Resolved};
use sculptd_daemon::kiosk::desk::KioskDesk;
use sculptd_daemon::live_run::{LiveOptions, LiveRun};
use sculptd_daemon::simulated_loop::{Feed, Pace, SimulatedLoop, SimulatedOptions, summary};
use sculptd_daemon::startup;
use sculptd_daemon::startup::{Area, BeginError, Begun, RecordingFeed};
use sculptd_daemon::tablet_controls::TabletControls;
use sculptd_daemon::tick::Journal;
use sculptd_daemon::window_link::WindowLink;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::{Player, RecordingError};
use sculptd_devices::{Clock, DeviceId, queue};
use sculptd_geometry::io::write_beside;
use sculptd_geometry::job::Job;

#[derive(Debug, Clone, Default, clap::Args)]
pub struct RunArgs {
    /// The mesh to sculpt (OBJ, STL, PLY, OFF, glTF, 3MF). Without it, a ball. May be repeated:
    /// each file is an object in its true size and place, and the first is active.
    #[arg(long, value_name = "FILE")]
    pub mesh: Vec<PathBuf>,
    /// Record everything into this session file, or go on with it if it exists.
    #[arg(long, value_name = "FILE")]
    pub session: Option<PathBuf>,
    /// More settings, laid over the system's and the user's.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// The brush to begin with; `sculptd ctl brushes` lists them.
    #[arg(long, value_name = "NAME")]
    pub brush: Option<BrushKind>,
    /// The folder of your own brushes (TOML files, their pictures beside them); without it,
    /// `brushes` in the user's data folder.
    #[arg(long, value_name = "FOLDER")]
    pub brushes: Option<PathBuf>,
    /// No window, even where there is a display.
    #[arg(long)]
    pub headless: bool,
    /// Full screen, for an installation.
    #[arg(long)]
    pub kiosk: bool,
    /// Settings of the installation, instead of the built-in config/kiosk.toml.
    #[arg(long, value_name = "FILE", requires = "kiosk")]
    pub kiosk_config: Option<PathBuf>,
    /// An exhibit for visitors, a folder or a .zip file, beside those of the settings. May be
    /// repeated.
    #[arg(long, value_name = "PACK", requires = "kiosk")]
    pub exhibit: Vec<PathBuf>,
    /// Nothing of the visits is kept, not even for a restart.
    #[arg(skip)]
    pub preview: bool,
    /// End after this many seconds of the loop's time.
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub limit_s: Option<f64>,
    /// Play a recording (hid-recorder text, Leap frames, or our own) as if its device were here.
    /// May be repeated.
    #[arg(long, value_name = "RECORDING")]
    pub play_device: Vec<PathBuf>,
    /// Sculpt with bare hands before this camera: its number, a device node, or a recorded file (a
    /// folder of PNG or JPEG pictures, Motion JPEG, Y4M).
    #[arg(long, value_name = "INDEX|FILE", num_args = 0..=1, default_missing_value = "0")]
    pub camera: Option<String>,
    /// Part of the tablet that a played recording maps to the view: the part that it uses, or the
    /// whole area.
    #[arg(long, value_enum, default_value_t)]
    pub play_area: PlayArea,
    /// Write the mesh to this file at the end; its extension selects the format.
    #[arg(long, value_name = "FILE")]
    pub export: Option<PathBuf>,
    /// Write the summary to this file at the end, as JSON.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Playback speed of recordings. The default is as fast as the machine can without a window,
    /// and the recorded speed with one.
    #[arg(long, value_enum)]
    pub pace: Option<Pace>,
    /// Serve metrics for Prometheus at this address, under /metrics; a port alone means the
    /// loopback. Without this option nothing is served.
    #[cfg(unix)]
    #[arg(long, value_name = "PORT|ADDRESS:PORT", value_parser = sculptd_daemon::metrics::address)]
    pub metrics: Option<std::net::SocketAddr>,
    /// Send metrics and the log to an OpenTelemetry collector: OTLP over HTTP. The default URL is
    /// that of the environment, OTEL_EXPORTER_OTLP_ENDPOINT, or http://127.0.0.1:4318.
    #[cfg(unix)]
    #[arg(long, value_name = "URL", num_args = 0..=1, default_missing_value = "")]
    pub telemetry: Option<String>,
    #[cfg(unix)]
    #[command(flatten)]
    pub web: super::web_page::WebArgs,
    #[cfg(feature = "network")]
    #[command(flatten)]
    pub shared: super::shared::SharedArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum PlayArea {
    /// The area of the recording's contacts.
    #[default]
    Used,
    /// The whole active area.
    Full,
}

/// A positive, finite number of seconds, at most ten years.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if s > 0.0 && s <= 3.2e8 => Ok(s),
        _ => Err(format!("expected a number of seconds above 0, found '{text}'")),
    }
}

pub fn run(args: &RunArgs, json: bool) -> Outcome {
    let mut config = load_config(args.config.as_deref())?;
    if let Some(kind) = args.brush.filter(|k| *k != config.brush.kind) {
        config.brush = config.presets.switched(&config.brush, kind);
    }
    if let Some(camera) = &args.camera {
        config.devices.camera.clone_from(camera);
        let choice = CameraChoice::from_text(camera);
        // What cannot work is said before anything is opened. A camera that is unplugged may come.
        let models = camera_hands::load_models().map_err(CameraStartError::from);
        models.map_err(|e| super::camera_errors::failed(&e))?;
        if choice.is_recorded() {
            let opened = choice.open(&Clock::manual()).map_err(CameraStartError::from);
            opened.map_err(|e| super::camera_errors::failed(&e))?;
        }
    }
    if let Some(path) = &args.export {
        sculptd_geometry::io::writable_format(path).map_err(|e| Fail::Usage(e.to_string()))?;
    }
    if !args.mesh.is_empty() && args.session.as_ref().is_some_and(|s| s.exists()) {
        let text =
            "a session that exists brings its own mesh: leave out --mesh, or name another session";
        return Err(Fail::Usage(text.into()));
    }
    let window = display::wanted(args.headless);
    #[cfg(unix)]
    if window && follows_lost_window(args) {
        eprintln!("sculptd: a daemon that has lost its window is running: it opens one here");
        return super::window::run(json);
    }
    // Recordings that are played without a window and without visitors are stepped, so that they
    // give the same bits every time.
    #[cfg(feature = "network")]
    let (is_shared, looks_on) = (args.shared.is_on(), args.shared.looks_on());
    #[cfg(not(feature = "network"))]
    let (is_shared, looks_on) = (false, false);
    let recorded = args.camera.as_deref().map(CameraChoice::from_text);
    let recorded = recorded.filter(CameraChoice::is_recorded);
    let is_played = !args.play_device.is_empty() || recorded.is_some();
    let on_the_wall_clock = window || !is_played || args.kiosk || is_shared;
    #[cfg(unix)]
    if args.metrics.is_some() && !on_the_wall_clock {
        let text = "--metrics needs a run on the wall's clock, and a recording that is played \
                    headless runs on a simulated one: leave out --metrics, or --headless";
        return Err(Fail::Usage(text.into()));
    }
    #[cfg(unix)]
    if args.telemetry.is_some() && !on_the_wall_clock {
        let text = "--telemetry needs a run on the wall's clock, and a recording that is played \
                    headless runs on a simulated one: leave out --telemetry, or --headless";
        return Err(Fail::Usage(text.into()));
    }
    #[cfg(unix)]
    let telemetry = args.telemetry.as_deref().map(super::telemetry::options).transpose()?;
    let mut catalogue = Catalogue::builtin().map_err(|e| Fail::Config(e.to_string()))?;
    for dir in &config.devices.tablets {
        catalogue = catalogue.with_dir(dir).map_err(|e| Fail::Config(e.to_string()))?;
    }
    let players = open_players(args, &config, &catalogue)?;
    let named = kiosk_settings::KioskArgs {
        kiosk: args.kiosk,
        file: args.kiosk_config.as_deref(),
        exhibits: &args.exhibit,
    };
    #[cfg(not(feature = "network"))]
    let kiosk = kiosk_settings::read(&named)?;
    #[cfg(feature = "network")]
    let (kiosk, fleet) =
        kiosk_settings::read(&named)?.map_or((None, None), |(kiosk, part)| (Some(kiosk), part));
    #[cfg(unix)]
    let web = args.web.options(kiosk.as_ref()).map_err(Fail::Config)?;
    #[cfg(unix)]
    if web.is_some() && (is_shared || !on_the_wall_clock) {
        let text = "--web (or web in kiosk.toml) cannot be used with a sculpture shared over the \
                    network, nor with recordings that are played headless: leave out one of them";
        return Err(Fail::Usage(text.into()));
    }
    if let Some(kiosk) = &kiosk {
        config.undo.bytes = config.undo.bytes.min(kiosk.undo_bytes);
    }
    // In a window a session is always on.
    let own = (window && args.session.is_none() && kiosk.is_none() && !is_played && !looks_on)
        .then(|| library::begin(args.mesh.first().map(PathBuf::as_path)))
        .flatten();
    let session = args.session.as_ref().or(own.as_ref());
    let fresh = !session.is_some_and(|s| s.exists());
    // A large mesh is loaded after the window opens, with visible progress.
    let (meshes, later) = match args.mesh.clone() {
        m if m.len() == 1 && window && fresh && kiosk.is_none() && is_large(&m[0]) => {
            (Vec::new(), m.into_iter().next())
        }
        meshes => (meshes, None),
    };
    #[cfg(not(feature = "network"))]
    let (begun, shared) = (begin(&meshes, session.map(PathBuf::as_path), &config)?, None);
    #[cfg(feature = "network")]
    let (begun, shared) = {
        let session = session.map(PathBuf::as_path);
        let own = |config: &Config| begin(&meshes, session, config);
        let alone = |config: &Config| begin(&[], None, config);
        match args.shared.is_on() {
            true => {
                let (begun, shared) = args.shared.begin(&mut config, session, own, alone)?;
                (begun, Some(shared))
            }
            false => (own(&config)?, None),
        }
    };
    let objects = begun.world.scene().objects();
    let found: usize = objects.iter().map(|o| o.clay.triangle_count()).sum();
    if let Some(kiosk) = kiosk.as_ref().filter(|k| found > k.max_triangles) {
        let words = kiosk.words(LANGUAGES).map_err(Fail::Config)?;
        let most = kiosk.max_triangles;
        return Err(Fail::Input(format!(
            "{}: {found} triangles, at most {most} (max_triangles)",
            words.too_large
        )));
    }
    let open_next = library::OpenNext::default();
    if on_the_wall_clock {
        let options = LiveOptions {
            presets: crate::presets().clone(),
            brushes: own_brushes(args.brushes.as_deref())?,
            languages: LANGUAGES,
            // The people of a shared sculpture hold its work already.
            visits: (args.kiosk && !args.preview && session.is_none() && !is_shared)
                .then(library::visits)
                .flatten(),
            kiosk,
            demo_devices: false,
            drawn_hands: false,
            devices: true,
            players,
            limit_s: args.limit_s,
            controls: tablet_controls(),
            settings: args.config.clone(),
            #[cfg(unix)]
            metrics: args.metrics,
            #[cfg(unix)]
            telemetry,
            #[cfg(unix)]
            web,
            window: WindowLink::new(session.map(PathBuf::as_path)),
            shared,
        };
        let shown = Shown {
            window,
            full_screen: args.kiosk,
            open_first: later,
            fresh,
            export: args.export.clone(),
            brushes: options.brushes.as_ref().map(|folder| folder.path().to_path_buf()),
            session: session.cloned(),
            recent: library::recent(session.map(PathBuf::as_path)),
            open_next: open_next.clone(),
        };
        let (link, args) = (options.window.clone(), args.clone());
        let desk = std::sync::Arc::new(std::sync::OnceLock::new());
        let begun_run = {
            let desk = desk.clone();
            move |run: &LiveRun| {
                if let Some(screen) = &run.kiosk {
                    desk.get_or_init(|| screen.desk.clone());
                }
                #[cfg(feature = "network")]
                if let Some(part) = fleet {
                    return super::fleet_part::attend(part, run);
                }
                Ok(())
            }
        };
        let then = move |summary: Summary| {
            let desk: Option<&std::sync::Arc<KioskDesk>> = desk.get();
            if desk.is_some_and(|desk| desk.again.load(std::sync::atomic::Ordering::Relaxed)) {
                return Err(super::ending::begin_again());
            }
            #[cfg(unix)]
            if let Some((screen, session)) = link.wanted().zip(link.session()) {
                let next = next_arguments(&session, &args, json);
                return super::window::go_on(&session, &screen, &next);
            }
            if let Some(own) = &own {
                library::remove_untouched(own);
            }
            if let Some(next) = open_next.lock().ok().and_then(|n| n.clone()) {
                return library::open(&next, args.config.as_deref());
            }
            if args.preview {
                eprintln!("sculptd: the preview has ended; nothing was kept");
                return Ok(());
            }
            // A restart in place sends nothing: the manager would wait for an end.
            #[cfg(unix)]
            sculptd_daemon::systemd::Notifier::from_env().send("STOPPING=1");
            report(&summary, args.stats.as_deref(), json)
        };
        return live::run(options, &shown, &config, begun, catalogue, begun_run, then);
    }
    eprintln!("sculptd: recordings run on a simulated clock: no control socket, no devices");
    let summary = run_stepped(args, &config, begun, players, recorded.as_ref())?;
    report(&summary, args.stats.as_deref(), json)
}

/// The folder of a person's own brushes, read. One that was named must be there.
fn own_brushes(named: Option<&Path>) -> Result<Option<BrushFolder>, Fail> {
    if let Some(folder) = named {
        std::fs::read_dir(folder).map_err(|e| Fail::io(folder, &e))?;
    }
    let folder = named.map(Path::to_path_buf).or_else(brush_folder::default_folder);
    Ok(folder.map(|folder| {
        let mut folder = BrushFolder::new(folder, crate::presets().clone());
        folder.refresh();
        folder
    }))
}

/// Reads the user's bindings of tablet controls.
fn tablet_controls() -> TabletControls {
    let Some(file) = TabletControls::default_file() else { return TabletControls::default() };
    let (controls, told) = TabletControls::of_file(&file);
    if let Some(told) = told {
        eprintln!("sculptd: keys of tablets not taken: {told}");
    }
    controls
}

/// Bytes of a file of a mesh from which on its loading takes a while.
const LARGE_FILE: u64 = 16 << 20;

fn is_large(mesh: &Path) -> bool {
    std::fs::metadata(mesh).is_ok_and(|m| m.is_file() && m.len() >= LARGE_FILE)
}

/// Returns true if a daemon that has lost its window already shows the requested sculpture.
#[cfg(unix)]
fn follows_lost_window(args: &RunArgs) -> bool {
    let plain =
        args.mesh.is_empty() && args.play_device.is_empty() && args.camera.is_none() && !args.kiosk;
    let whole = |p: &Path| p.canonicalize().ok();
    let same =
        |session: PathBuf| args.session.as_deref().is_none_or(|s| whole(s) == whole(&session));
    plain && super::window::lost().is_some_and(same)
}

/// The arguments of the process that follows a run, to show the same session in a window: what was
/// asked for stays, but for what the session holds already.
#[cfg(unix)]
fn next_arguments(session: &Path, args: &RunArgs, json: bool) -> Vec<OsString> {
    let mut all: Vec<OsString> = Vec::new();
    if json {
        all.push("--json".into());
    }
    all.extend(["run".into(), "--session".into(), session.into()]);
    let paths = [
        ("--config", &args.config),
        ("--brushes", &args.brushes),
        ("--export", &args.export),
        ("--stats", &args.stats),
    ];
    for (name, path) in paths {
        all.extend(path.iter().flat_map(|p| [name.into(), p.into()]));
    }
    if let Some(camera) = &args.camera {
        all.push(format!("--camera={camera}").into());
    }
    if let Some(seconds) = args.limit_s {
        all.extend(["--for".into(), seconds.to_string().into()]);
    }
    if let Some(at) = args.metrics {
        all.extend(["--metrics".into(), at.to_string().into()]);
    }
    #[cfg(unix)]
    if let Some(at) = args.web.web {
        all.push(format!("--web={at}").into());
        all.push(format!("--web-name={}", args.web.web_name).into());
    }
    if let Some(url) = &args.telemetry {
        all.push(format!("--telemetry={url}").into());
    }
    all
}

pub fn load_config(extra: Option<&Path>) -> Result<Config, Fail> {
    match Resolved::load(extra, crate::presets()) {
        Ok(resolved) => Ok(resolved.config),
        Err(ConfigError::Unreadable { path, source })
            if source.kind() == std::io::ErrorKind::PermissionDenied =>
        {
            Err(Fail::io(&path, &source))
        }
        Err(e) => Err(Fail::Config(e.to_string())),
    }
}

pub fn begin(meshes: &[PathBuf], session: Option<&Path>, config: &Config) -> Result<Begun, Fail> {
    let begun = startup::begin_with(meshes, session, config, &Job::default());
    let begun = begun.map_err(|e| match e {
        BeginError::Rig(e) => super::not_begun(e),
        e => Fail::Input(e.to_string()),
    })?;
    for warning in &begun.warnings {
        eprintln!("sculptd: warning: {warning}");
    }
    Ok(begun)
}

/// Opens every recording, and finds the part of the tablet that each one uses.
fn open_players(
    args: &RunArgs,
    config: &Config,
    catalogue: &Catalogue,
) -> Result<Vec<(Player, Option<Area>)>, Fail> {
    let open = |i: usize, path: &Path| {
        Player::open(path, DeviceId(i as u16), catalogue).map_err(|e| match e {
            RecordingError::Unknown { .. } => Fail::Device(e.to_string()),
            e => Fail::Input(e.to_string()),
        })
    };
    let players = args.play_device.iter().enumerate();
    players
        .map(|(i, path)| {
            let area = match args.play_area {
                PlayArea::Full => None,
                PlayArea::Used => startup::used_area(open(i, path)?, config.camera.aspect),
            };
            Ok((open(i, path)?, area))
        })
        .collect()
}

fn run_stepped(
    args: &RunArgs,
    config: &Config,
    begun: Begun,
    players: Vec<(Player, Option<Area>)>,
    recorded: Option<&CameraChoice>,
) -> Result<Summary, Fail> {
    let (factory, mut receiver) = queue::channel(config.channel.capacity);
    let mut feeds: Vec<Box<dyn Feed>> = players
        .into_iter()
        .map(|(p, area)| Box::new(RecordingFeed::new(p, factory.sender(), area)) as Box<dyn Feed>)
        .collect();
    if let Some(choice) = recorded {
        let settings = config.devices.camera_settings;
        let feed = CameraFeed::open(choice, settings, factory.sender());
        feeds.push(Box::new(feed.map_err(|e| super::camera_errors::failed(&e))?));
    }
    let clock = Clock::manual();
    let mut world = begun.world;
    let (mut writer, thread) = begun.journal.unzip();
    let options = SimulatedOptions {
        rate_hz: config.r#loop.rate_hz,
        pace: args.pace.unwrap_or(Pace::Fast),
        max_ticks: args.limit_s.map(|s| (s * f64::from(config.r#loop.rate_hz)).ceil() as u64),
        drain_per_tick: config.channel.drain_per_tick,
        verify: false,
    };
    let stepped = SimulatedLoop {
        world: &mut world,
        feeds: &mut feeds,
        receiver: &mut receiver,
        clock: &clock,
        journal: writer.as_mut().map(|w| w as &mut dyn Journal),
        observer: &mut |_, _, _| {},
        script: &[],
    };
    let figures = stepped.run(&options).map_err(|e| Fail::Check(e.to_string()))?;
    drop(writer);
    close_journal(thread);
    let export = export(args.export.as_deref(), &mut world)?;
    Ok(summary(&figures, &world, &receiver, export))
}

pub fn report(summary: &Summary, stats: Option<&Path>, json: bool) -> Outcome {
    if let Some(path) = stats {
        write_beside(path, |out| {
            serde_json::to_writer_pretty(&mut *out, summary)?;
            writeln!(out)
        })
        .map_err(|e| Fail::io(path, &e))?;
    }
    answer(json, summary, |out| {
        let s = summary;
        writeln!(out, "ticks           {:>12}   {} late", s.ticks, s.overruns)?;
        writeln!(
            out,
            "samples         {:>12}   {} coalesced, {} motion lost, {} transitions lost",
            s.samples, s.samples_coalesced, s.losses.motion, s.losses.transition
        )?;
        writeln!(out, "dabs            {:>12}", s.dabs)?;
        writeln!(
            out,
            "vertices moved  {:>12}   of {} (a vertex counts once a dab)",
            s.vertices_moved, s.vertices
        )?;
        writeln!(
            out,
            "tick time       p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms",
            s.tick_ms.p50, s.tick_ms.p99, s.tick_ms.max
        )?;
        let cpu = &s.tick_cpu_ms;
        writeln!(
            out,
            "of it processor p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms",
            cpu.p50, cpu.p99, cpu.max
        )?;
        if let Some(taken) = &s.sample_to_tick_ms {
            writeln!(
                out,
                "sample to clay  p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms",
                taken.p50, taken.p99, taken.max
            )?;
        }
        if let Some(shown) = &s.sample_to_present {
            writeln!(out, "sample to screen {:>11} frames, ms p50, p99, max:", shown.frames)?;
            for stage in &shown.stages {
                let [p50, p99, max] =
                    [stage.quantiles.p50, stage.quantiles.p99, stage.quantiles.max]
                        .map(|us| us as f64 / 1e3);
                writeln!(out, "  {:<13} {p50:>12.1} {p99:>9.1} {max:>9.1}", stage.name)?;
            }
        }
        writeln!(out, "hash            {}", s.hash)?;
        if let Some(path) = &s.export {
            writeln!(out, "mesh            {path}")?;
        }
        Ok(())
    });
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_for_stays_but_for_what_the_session_holds() {
        let args = RunArgs {
            mesh: vec!["pig.stl".into()],
            session: Some("old.sculpt".into()),
            stats: Some("s.json".into()),
            headless: true,
            limit_s: Some(2.5),
            play_device: vec!["pen.hid".into()],
            ..RunArgs::default()
        };
        let words = next_arguments(Path::new("/a b.sculpt"), &args, true);
        let words: Vec<_> = words.iter().map(|w| w.to_string_lossy()).collect();
        let expected =
            ["--json", "run", "--session", "/a b.sculpt", "--stats", "s.json", "--for", "2.5"];
        assert_eq!(words, expected);
    }
}
