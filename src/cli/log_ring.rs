//! The newest lines of the log, kept in memory for the staff of a fleet, and how many were errors.

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};

use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

use sculptd_network::fleet::installation_thread::LogLines;

/// Lines that are kept.
const KEPT: usize = 1000;
/// Bytes of a line.
const MAX_LINE: usize = 2000;

static KEPT_LOG: Mutex<KeptLog> =
    Mutex::new(KeptLog { lines: VecDeque::new(), errors: 0, warnings: 0, last: None });

#[derive(Debug)]
struct KeptLog {
    lines: VecDeque<String>,
    errors: u64,
    warnings: u64,
    last: Option<String>,
}

/// The layer that keeps lines.
#[derive(Debug, Clone, Copy, Default)]
pub struct LogRing;

#[derive(Default)]
struct LineText(String);

impl Visit for LineText {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        // Writing to a text cannot fail.
        let _ = match field.name() {
            "message" => write!(self.0, "{value:?}"),
            name => write!(self.0, " {name}={value:?}"),
        };
    }
}

impl<S: Subscriber> Layer<S> for LogRing {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let mut text = LineText::default();
        event.record(&mut text);
        let mut text = text.0.replace(['\n', '\r'], " ");
        let level = *event.metadata().level();
        let mut end = MAX_LINE.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        text.truncate(end);
        let mut log = KEPT_LOG.lock().unwrap_or_else(PoisonError::into_inner);
        match level {
            Level::ERROR => {
                log.errors += 1;
                log.last = Some(text.clone());
            }
            Level::WARN => log.warnings += 1,
            _ => {}
        }
        if log.lines.len() >= KEPT {
            log.lines.pop_front();
        }
        log.lines.push_back(format!("{level} {}: {text}", event.metadata().target()));
    }
}

/// What [`LogRing`] has kept.
#[derive(Debug, Clone, Copy, Default)]
pub struct KeptLines;

impl LogLines for KeptLines {
    fn counts(&self) -> (u64, u64, Option<String>) {
        let log = KEPT_LOG.lock().unwrap_or_else(PoisonError::into_inner);
        (log.errors, log.warnings, log.last.clone())
    }

    fn lines(&self, most: usize) -> Vec<String> {
        let log = KEPT_LOG.lock().unwrap_or_else(PoisonError::into_inner);
        let skipped = log.lines.len().saturating_sub(most);
        log.lines.iter().skip(skipped).cloned().collect()
    }
}
