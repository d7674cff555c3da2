//! What the log has told and no collector has yet: bounded, the oldest goes first.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Records that wait; an hour of one a second.
const MOST: usize = 3600;
/// Bytes of a record's text.
const MAX_TEXT: usize = 4000;

/// Fields of a record, and bytes of each.
const MAX_FIELDS: usize = 16;
/// See [`MAX_FIELDS`].
const MAX_FIELD: usize = 250;

fn shorten(text: &mut String, most: usize) {
    let mut end = most.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    text.truncate(end);
}

/// One line of the log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogRecord {
    /// Counts records, from 1.
    pub number: u64,
    /// Nanoseconds since 1970.
    pub at_ns: u64,
    /// As `tracing` has it.
    pub level: tracing::Level,
    /// The module.
    pub target: String,
    /// The message.
    pub text: String,
    /// Other fields.
    pub fields: Vec<(String, String)>,
}

#[derive(Debug, Default)]
struct QueuedLog {
    open: bool,
    records: VecDeque<LogRecord>,
    last: u64,
    dropped: u64,
}

/// Lines that wait for a collector.
#[derive(Debug, Default)]
pub struct LogQueue(Mutex<QueuedLog>);

impl LogQueue {
    fn waiting(&self) -> std::sync::MutexGuard<'_, QueuedLog> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Starts keeping records.
    pub fn open(&self) {
        self.waiting().open = true;
    }

    /// Returns true if records are kept.
    pub fn is_open(&self) -> bool {
        self.waiting().open
    }

    /// Stops keeping records.
    pub fn close(&self) {
        let last = self.waiting().last;
        *self.waiting() = QueuedLog { last, ..QueuedLog::default() };
    }

    /// Puts a record at the end; its number is given here. Where too many wait, the oldest goes.
    pub fn push(&self, mut record: LogRecord) {
        let mut waiting = self.waiting();
        if !waiting.open {
            return;
        }
        shorten(&mut record.text, MAX_TEXT);
        record.fields.truncate(MAX_FIELDS);
        record.fields.iter_mut().for_each(|(_, value)| shorten(value, MAX_FIELD));
        waiting.last += 1;
        record.number = waiting.last;
        if waiting.records.len() >= MOST {
            waiting.records.pop_front();
            waiting.dropped += 1;
        }
        waiting.records.push_back(record);
    }

    /// The oldest records, at most `most`; they stay until [`LogQueue::remove`].
    pub fn oldest(&self, most: usize) -> Vec<LogRecord> {
        self.waiting().records.iter().take(most).cloned().collect()
    }

    /// These have gone where they should.
    pub fn remove(&self, sent: &[LogRecord]) {
        let Some(last) = sent.last().map(|r| r.number) else { return };
        let mut waiting = self.waiting();
        while waiting.records.front().is_some_and(|r| r.number <= last) {
            waiting.records.pop_front();
        }
    }

    /// Records that were let go because too many waited.
    pub fn dropped(&self) -> u64 {
        self.waiting().dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(text: &str) -> LogRecord {
        let (level, target) = (tracing::Level::WARN, "clay".to_owned());
        LogRecord { number: 0, at_ns: 7, level, target, text: text.into(), fields: Vec::new() }
    }

    #[test]
    fn the_newest_stay_and_what_was_sent_goes() {
        let queue = LogQueue::default();
        queue.push(record("nobody sends it"));
        queue.open();
        for k in 0..MOST + 10 {
            queue.push(record(&k.to_string()));
        }
        let first = queue.oldest(3);
        assert_eq!((first[0].text.as_str(), queue.dropped()), ("10", 10));
        // Some were let go while the first were on their way.
        (0..5).for_each(|_| queue.push(record("late")));
        queue.remove(&first);
        assert_eq!(queue.oldest(1)[0].text, "15");
        queue.remove(&queue.oldest(MOST));
        assert!(queue.oldest(1).is_empty());
        queue.push(record(&"é".repeat(MAX_TEXT)));
        assert!(queue.oldest(1)[0].text.len() <= MAX_TEXT);
    }
}
