//! The log: to standard error, as text for a person or one JSON object a line for a machine.

use std::io::IsTerminal;

use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum LogFormat {
    #[default]
    Text,
    Json,
}

/// Begins logging. `SCULPTD_LOG` says how much: a level, or levels by crate and module (`debug`,
/// `info,sculptd_daemon::session=trace`). Without it, and where it cannot be read, `info`.
pub fn begin(format: LogFormat) {
    let wanted = std::env::var("SCULPTD_LOG").unwrap_or_default();
    // The network library reports every lost connection as an error. The program reports those that
    // concern a person itself.
    let usual = || {
        let all = Targets::new().with_default(LevelFilter::INFO);
        all.with_target("zenoh", LevelFilter::OFF)
    };
    let parsed = match wanted.trim() {
        "" => Ok(usual()),
        wanted => wanted.parse(),
    };
    let (filter, refused) = match parsed {
        Ok(filter) => (filter, None),
        Err(e) => (usual(), Some(e)),
    };
    let lines = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let log = tracing_subscriber::registry();
    // The log lines that fleet staff may request, independent of the filter here.
    #[cfg(feature = "network")]
    let log = log.with(super::log_ring::LogRing.with_filter(usual()));
    #[cfg(unix)]
    let log = log.with(super::telemetry::ExportLayer.with_filter(usual()));
    // A second begin in one process (tests) keeps the first.
    let _ = match format {
        LogFormat::Text => log
            .with(lines.with_ansi(std::io::stderr().is_terminal()).with_filter(filter))
            .try_init(),
        LogFormat::Json => log.with(lines.json().with_filter(filter)).try_init(),
    };
    if let Some(e) = refused {
        tracing::warn!("SCULPTD_LOG={wanted:?} is not a filter ({e}): logging at info");
    }
}
