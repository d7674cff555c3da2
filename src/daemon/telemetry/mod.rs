//! Exports the daemon's metrics and warnings to an OpenTelemetry collector: OTLP over HTTP, as JSON
//! (OpenTelemetry protocol 1.x, `/v1/metrics` and `/v1/logs`). Off by default.
//!
//! Laws kept here:
//! * Only the sending thread (`sculptd-telemetry`) waits for a collector; the tick thread does not
//!   know of it.
//! * An unreachable collector costs no memory: counters are sums, and continue when it returns.
//!   [`log_queue`] keeps a limited number of log records, which are sent then.
//! * A failure is logged once, and so is the recovery.

pub mod endpoint;
pub mod log_queue;
pub mod otlp;
mod post;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

use self::endpoint::Endpoint;
use self::log_queue::LogQueue;
use self::otlp::Resource;
use self::post::{PostError, Poster};
use crate::metric_table::{all_metrics, stages};
use crate::systemd::Watched;

/// A collector may take so long for one request, and at the end of the daemon for all.
const PATIENCE: Duration = Duration::from_secs(3);
/// See [`PATIENCE`].
const LAST_PATIENCE: Duration = Duration::from_millis(900);
/// Path for metrics.
const METRICS: &str = "/v1/metrics";
/// See [`METRICS`].
const LOGS: &str = "/v1/logs";
/// Records of one request.
const BATCH: usize = 512;

/// Destination, interval and identity of the export.
#[derive(Debug, Clone)]
pub struct TelemetryOptions {
    /// The collector.
    pub endpoint: Endpoint,
    /// Interval between two exports.
    pub every: Duration,
    /// Identity of the sender.
    pub resource: Resource,
    /// Nanoseconds since 1970, from outside.
    pub now_ns: fn() -> u64,
    /// Queue that the logging layer fills.
    pub logs: Arc<LogQueue>,
}

/// Returns the name of this computer.
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// The export; it ends, with a last one, when this is dropped.
#[derive(Debug)]
pub struct Telemetry {
    /// Set to abandon the request in progress.
    ending: Arc<AtomicBool>,
    stop: Option<cc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Telemetry {
    /// Begins to export.
    ///
    /// # Errors
    /// Returns an error if the thread or its runtime cannot start.
    pub fn start(options: TelemetryOptions, watched: Watched) -> std::io::Result<Telemetry> {
        let poster = Poster::new(options.endpoint.clone())?;
        let (stop, stopped) = cc::bounded(0);
        options.logs.open();
        let begun_ns = (options.now_ns)();
        let ending = Arc::new(AtomicBool::new(false));
        let (poster, failing) = (poster.until(ending.clone()), [false; 2]);
        let mut exporter = Exporter { options, watched, poster, begun_ns, failing };
        let thread =
            std::thread::Builder::new().name("sculptd-telemetry".into()).spawn(move || {
                let passed = cc::RecvTimeoutError::Timeout;
                while stopped.recv_timeout(exporter.options.every) == Err(passed) {
                    exporter.export(PATIENCE, None);
                }
                exporter.poster.go_on();
                exporter.export(PATIENCE, Some(LAST_PATIENCE));
                exporter.options.logs.close();
            })?;
        Ok(Telemetry { ending, stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Telemetry {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Exporter {
    options: TelemetryOptions,
    watched: Watched,
    poster: Poster,
    begun_ns: u64,
    /// True if the last request failed and that was reported, for metrics and for logs: a collector
    /// may accept one and not the other.
    failing: [bool; 2],
}

impl Exporter {
    /// All figures as they are now, then what the log holds.
    /// Each request may take `patience`; `last`: all together.
    fn export(&mut self, patience: Duration, mut last: Option<Duration>) {
        let (options, watched) = (&self.options, &self.watched);
        let latency = stages(&watched.window.present_latency());
        let times = (self.begun_ns, (options.now_ns)());
        let body = otlp::metrics(&options.resource, &all_metrics(watched), &latency, times);
        let (mut each, of) = (patience, &mut last);
        let sent = self.poster.post(METRICS, body, of.as_mut().unwrap_or(&mut each));
        if self.report(METRICS, sent) {
            return;
        }
        loop {
            let records = self.options.logs.oldest(BATCH);
            if records.is_empty() {
                return;
            }
            let body = otlp::logs(&self.options.resource, &records);
            let mut each = patience;
            let sent = self.poster.post(LOGS, body, last.as_mut().unwrap_or(&mut each));
            // Records that the collector will never accept must not block the others.
            let done = !matches!(&sent, Err(e) if e.may_pass());
            if done {
                self.options.logs.remove(&records);
            }
            if self.report(LOGS, sent) {
                return;
            }
        }
    }

    /// Logs a failure, or its end, once. Returns true if it failed.
    fn report(&mut self, path: &str, result: Result<(), PostError>) -> bool {
        let (to, failed) = (self.options.endpoint.shown() + path, result.is_err());
        let failing = std::mem::replace(&mut self.failing[usize::from(path == LOGS)], failed);
        match result {
            Err(e) if !failing => {
                tracing::warn!("no telemetry goes to the collector at {to}: {e}; it is tried again")
            }
            Ok(()) if failing => tracing::info!("the collector at {to} takes telemetry again"),
            _ => {}
        }
        failed
    }
}
