//! `sculptd demo`: the main job with no hardware. Simulated devices perform a journal; their bytes
//! go through the real parsers, the real channel and the real loop. Headless, it ends by itself
//! with a summary and an exported mesh.

use std::path::PathBuf;

use super::display::{self, Shown};
use super::ending::{close_journal, export};
use super::live;
use super::run::{self, seconds};
use super::{Fail, Outcome};
use sculptd_camera::camera_thread::CameraChoice;
use sculptd_daemon::Summary;
use sculptd_daemon::camera_hands::{self, CameraFeed, CameraStartError};
use sculptd_daemon::config::Config;
use sculptd_daemon::demo_devices;
use sculptd_daemon::live_run::LiveOptions;
use sculptd_daemon::simulated_loop::{Feed, Pace, SimulatedLoop, SimulatedOptions, summary};
use sculptd_daemon::startup::Begun;
use sculptd_daemon::tick::Journal;
use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::{Clock, queue};
use sculptd_engine::world::World;

#[derive(Debug, Clone, clap::Args)]
pub struct DemoArgs {
    /// No window, even where there is a display.
    #[arg(long)]
    pub headless: bool,
    /// End after this many seconds of the loop's time.
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub limit_s: Option<f64>,
    /// Write the finished mesh to this file; its extension selects the format.
    #[arg(long, value_name = "FILE", default_value = "demo.stl")]
    pub export: PathBuf,
    /// Sculpt this mesh instead of the ball.
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Record everything into this new session file.
    #[arg(long, value_name = "FILE")]
    pub session: Option<PathBuf>,
    /// Drawn hands before a simulated camera sculpt, instead of the simulated tablet and tracker.
    /// Needs the hand models: `sculptd camera setup`.
    #[arg(long)]
    pub camera: bool,
    /// Speed of the headless demo; the hash is the same.
    #[arg(long, value_enum, default_value_t)]
    pub pace: Pace,
}

pub fn run(args: &DemoArgs, json: bool) -> Outcome {
    sculptd_geometry::io::writable_format(&args.export).map_err(|e| Fail::Usage(e.to_string()))?;
    if let Some(path) = args.session.as_ref().filter(|p| p.exists()) {
        let text =
            format!("{}: expected the name of a new session: the demo begins anew", path.display());
        return Err(Fail::Usage(text));
    }
    if args.camera {
        let models = camera_hands::load_models().map_err(CameraStartError::from);
        models.map_err(|e| super::camera_errors::failed(&e))?;
    }
    let config = Config::default();
    let begun = run::begin(args.mesh.as_slice(), args.session.as_deref(), &config)?;
    if !display::wanted(args.headless) {
        return headless(args, &config, begun, json);
    }
    let options = LiveOptions {
        presets: crate::presets().clone(),
        brushes: None,
        demo_devices: !args.camera,
        drawn_hands: args.camera,
        devices: true,
        limit_s: args.limit_s,
        ..Default::default()
    };
    let shown = Shown {
        window: true,
        fresh: true,
        export: Some(args.export.clone()),
        session: args.session.clone(),
        ..Default::default()
    };
    let catalogue = Catalogue::builtin().map_err(|e| Fail::Config(e.to_string()))?;
    let then = move |summary: Summary| run::report(&summary, None, json);
    live::run(options, &shown, &config, begun, catalogue, |_| Ok(()), then)
}

fn headless(args: &DemoArgs, config: &Config, begun: Begun, json: bool) -> Outcome {
    let mut world = begun.world;
    let (mut writer, thread) = begun.journal.unzip();
    let clock = Clock::manual();
    let (factory, mut receiver) = queue::channel(config.channel.capacity);
    let (mut feeds, adaptors) = if args.camera {
        let settings = config.devices.camera_settings;
        let feed = CameraFeed::open(&CameraChoice::Drawn, settings, factory.sender());
        let feed: Box<dyn Feed> = Box::new(feed.map_err(|e| super::camera_errors::failed(&e))?);
        (vec![feed], None)
    } else {
        let demo = demo_devices::simulated_feeds(&clock, &factory);
        let (feeds, adaptors) = demo.map_err(|e| Fail::Check(e.to_string()))?;
        (feeds, Some(adaptors))
    };
    let rate_hz = config.r#loop.rate_hz;
    let options = SimulatedOptions {
        rate_hz,
        pace: args.pace,
        max_ticks: args.limit_s.map(|s| (s * f64::from(rate_hz)).ceil() as u64),
        drain_per_tick: config.channel.drain_per_tick,
        verify: false,
    };
    let total = options.max_ticks.unwrap_or(u64::from(rate_hz) * 20);
    let mut progress = Progress::new(total, json);
    let stepped = SimulatedLoop {
        world: &mut world,
        feeds: &mut feeds,
        receiver: &mut receiver,
        clock: &clock,
        journal: writer.as_mut().map(|w| w as &mut dyn Journal),
        observer: &mut |tick, _, world| progress.tick(tick, world),
        script: &[],
    };
    let figures = stepped.run(&options).map_err(|e| Fail::Check(e.to_string()))?;
    progress.bar.finish_and_clear();
    drop((adaptors, writer));
    close_journal(thread);
    let export = export(Some(&args.export), &mut world)?;
    run::report(&summary(&figures, &world, &receiver, export), None, json)
}

/// The live line: on a terminal a bar, else a line every five seconds; with `--json` nothing.
struct Progress {
    bar: indicatif::ProgressBar,
    plain: bool,
}

impl Progress {
    fn new(total: u64, json: bool) -> Self {
        let bar = if json {
            indicatif::ProgressBar::hidden()
        } else {
            indicatif::ProgressBar::new(total)
        };
        let style = indicatif::ProgressStyle::with_template("{bar:30} {pos:>5}/{len} ticks  {msg}");
        if let Ok(style) = style {
            bar.set_style(style);
        }
        Progress { plain: bar.is_hidden() && !json, bar }
    }

    fn tick(&mut self, tick: u64, world: &World) {
        if !tick.is_multiple_of(12) {
            return;
        }
        let who: Vec<&str> = [
            (world.pens().next().is_some(), "pen"),
            (world.hands().is_some_and(|h| h.count > 0), "hand"),
        ]
        .iter()
        .filter_map(|(on, name)| on.then_some(*name))
        .collect();
        let message = format!("{}  {} steps to undo", who.join(" and "), world.mesh().undo_steps());
        self.bar.set_position(tick);
        self.bar.set_message(message.clone());
        if self.plain && tick.is_multiple_of(600) {
            eprintln!("tick {tick}: {message}");
        }
    }
}
