//! The log: to standard error, as text for a person or one JSON object a line for a machine.

use tracing_subscriber::EnvFilter;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum LogFormat {
    #[default]
    Text,
    Json,
}

/// Begins logging. `SCULPTD_LOG` says how much (e.g. `debug`, or `sculptd::daemon=trace`); without
/// it, `info`.
pub fn begin(format: LogFormat) {
    let filter = EnvFilter::try_from_env("SCULPTD_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    let log = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    // A second begin in one process (tests) keeps the first.
    let _ = match format {
        LogFormat::Text => {
            log.with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr())).try_init()
        }
        LogFormat::Json => log.json().try_init(),
    };
}
