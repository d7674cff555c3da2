//! One live run, with or without a window: what was asked for is handed to the daemon, what the
//! daemon says is printed.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex, PoisonError};

use super::display::{self, Shown};
use super::ending::{export, stop_signal, warn_of_fault};
use super::window_guard::guarded;
use super::{Fail, Outcome, exit_code};
use sculptd_daemon::Summary;
use sculptd_daemon::command_queue::QueuedCommand;
use sculptd_daemon::config::Config;
use sculptd_daemon::live_run::{LiveOptions, LiveRun, LiveRunError};
use sculptd_daemon::startup::{self, Begun};
use sculptd_daemon::window_link::WindowStanding;
use sculptd_devices::catalogue::Catalogue;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_geometry::job::Job;

/// Why the run could not start.
fn not_started(e: LiveRunError) -> Fail {
    match e {
        LiveRunError::DemoDevices(_) => Fail::Check(e.to_string()),
        LiveRunError::Kiosk(_) => Fail::Config(e.to_string()),
        e => Fail::Permission(e.to_string()),
    }
}

/// Work left once a run is over.
struct Closing<F> {
    run: LiveRun,
    export: Option<PathBuf>,
    then: F,
}

impl<F: FnOnce(Summary) -> Outcome> Closing<F> {
    /// Waits for the end of the run, closes it, and goes on with `then`.
    fn close(self) -> Outcome {
        self.run.wait();
        let handed_on = self.run.window.wanted().is_some();
        let mut ended = self.run.finish().map_err(|e| Fail::Check(e.to_string()))?;
        let mut summary = std::mem::take(&mut ended.summary);
        let path = self.export.as_deref().filter(|_| !handed_on);
        summary.export = export(path, &mut ended.world)?;
        let trouble = ended.shared.trouble();
        warn_of_fault(ended.close_session());
        (self.then)(summary)?;
        trouble.map_or(Ok(()), |trouble| Err(Fail::Check(trouble)))
    }

    /// The same for a run whose window is lost; the exit code. An installation without its screen
    /// serves nobody: it ends, and whoever watches over it starts it again.
    fn close_without_window(self) -> u8 {
        self.run.window_lost();
        let kiosk = end_installation(&self.run);
        if kiosk {
            eprintln!(
                "sculptd: the screen is gone: the installation ends, and the visit goes on at the \
                 next start"
            );
        } else if self.run.window.session().is_some() {
            eprintln!(
                "sculptd: the screen is gone: going on without a window; `sculptd window` opens a \
                 new one"
            );
        } else {
            eprintln!("sculptd: the screen is gone: going on without a window");
        }
        let code = exit_code(self.close());
        let _ = std::io::stdout().flush();
        if kiosk { code.max(1) } else { code }
    }
}

/// Ends an installation without a screen, and leaves its visit for the next start. Returns false
/// for other runs.
fn end_installation(run: &LiveRun) -> bool {
    let Some(screen) = &run.kiosk else { return false };
    screen.desk.screen_gone.store(true, Relaxed);
    run.stop.store(true, Relaxed);
    true
}

/// Loads the mesh that no window can show loading.
fn load(run: &LiveRun, path: &Path) -> Result<(), Fail> {
    let loaded = startup::load(Some(path), &Job::default()).map_err(super::not_begun)?;
    let new = NewClay::new(Arc::new(loaded.plain), false);
    let built = Payload::Clay(Box::new(loaded.mesh));
    let command = QueuedCommand::with_payload(Command::Replace(new), built);
    run.live.commands.send(command).map_err(|e| Fail::Check(e.to_string()))
}

/// Runs until the end, then calls `then`. `begun_run` is called once the run has begun. Everything
/// runs in the window's thread. If the window is lost, another thread continues and ends the
/// process.
pub fn run(
    options: LiveOptions,
    shown: &Shown,
    config: &Config,
    begun: Begun,
    catalogue: Catalogue,
    begun_run: impl FnOnce(&LiveRun) -> Outcome,
    then: impl FnOnce(Summary) -> Outcome + Send + 'static,
) -> Outcome {
    let link = options.window.clone();
    link.set_standing(if shown.window {
        WindowStanding::Opening
    } else {
        WindowStanding::Headless
    });
    let run =
        LiveRun::start(options, config, begun, catalogue, stop_signal()).map_err(not_started)?;
    begun_run(&run)?;
    for notice in &run.notices {
        eprintln!("sculptd: {notice}");
    }
    if !shown.window {
        for line in run.adaptors.describe() {
            eprintln!("sculptd: {line}");
        }
        eprintln!("sculptd: sculpting; end with Ctrl-C");
        return Closing { run, export: shown.export.clone(), then }.close();
    }
    let window = display::window(&run, shown, config.r#loop.rate_hz);
    let closing = Closing { run, export: shown.export.clone(), then };
    let closing = Arc::new(Mutex::new(Some(closing)));
    let take = |all: &Mutex<Option<_>>| all.lock().unwrap_or_else(PoisonError::into_inner).take();
    let survivor = {
        let closing = closing.clone();
        move || take(&closing).map_or(101, Closing::close_without_window)
    };
    let seen = window.and_then(|show| guarded(show, survivor));
    let Some(closing) = take(&closing) else { return Ok(()) };
    if let Err(why) = &seen
        && closing.run.kiosk.is_some()
    {
        // An installation without its screen serves nobody: whoever watches over it starts it
        // again, and finds the port free.
        closing.run.window_lost();
        end_installation(&closing.run);
        let why = format!("the installation ends, for it has no screen: {why}");
        return closing.close().and(Err(Fail::Check(why)));
    }
    if let Err(why) = seen {
        eprintln!("sculptd: going on without a window: {why}");
        match link.standing() {
            // It was shown, so it may have set something.
            WindowStanding::Open => closing.run.window_lost(),
            _ => {
                link.set_standing(WindowStanding::Headless);
                if let Some(path) = &shown.open_first {
                    load(&closing.run, path)?;
                }
            }
        }
    }
    // After a window that could not open; a closed one has raised `stop`.
    closing.close()
}
