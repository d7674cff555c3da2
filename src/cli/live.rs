//! One live run, with or without a window: what was asked for is handed to the daemon, what the
//! daemon says is printed.

use super::Fail;
use super::display::{self, Shown};
use super::ending::{export, stop_signal, warn_of_fault};
use sculptd_daemon::Summary;
use sculptd_daemon::config::Config;
use sculptd_daemon::live_run::{LiveOptions, LiveRun, LiveRunError};
use sculptd_daemon::startup::Begun;
use sculptd_devices::catalogue::Catalogue;

impl From<LiveRunError> for Fail {
    fn from(e: LiveRunError) -> Self {
        match e {
            LiveRunError::DemoDevices(_) => Fail::Check(e.to_string()),
            LiveRunError::Kiosk(_) => Fail::Config(e.to_string()),
            e => Fail::Permission(e.to_string()),
        }
    }
}

pub fn run(
    options: LiveOptions,
    shown: &Shown,
    config: &Config,
    begun: Begun,
    catalogue: Catalogue,
) -> Result<Summary, Fail> {
    let run = LiveRun::start(options, config, begun, catalogue, stop_signal())?;
    for notice in &run.notices {
        eprintln!("sculptd: {notice}");
    }
    if shown.window {
        if let Err(why) = display::show(&run, shown, config.r#loop.rate_hz) {
            eprintln!("sculptd: going on without a window: {why}");
        }
    } else {
        for line in run.adaptors.describe() {
            eprintln!("sculptd: {line}");
        }
        eprintln!("sculptd: sculpting; end with Ctrl-C");
    }
    // Without a window, or after one that could not open. A closed window has raised `stop`.
    run.wait();
    let mut ended = run.finish().map_err(|e| Fail::Check(e.to_string()))?;
    let mut summary = std::mem::take(&mut ended.summary);
    summary.export = export(shown.export.as_deref(), &ended.world)?;
    warn_of_fault(ended.close_session());
    Ok(summary)
}
