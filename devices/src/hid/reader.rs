//! A dedicated thread that reads one interface and does nothing else: Linux keeps the oldest 63
//! reports of a stalled reader and drops the newest, which may hold the end of a stroke.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use serde::Serialize;

use super::decoder::Decoder;
use super::transport::Transport;
use crate::catalogue::Found;
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread, StopToken};
use crate::latency::{Latency, Quantiles};
use crate::queue::Sender;
use crate::sample::{DeviceId, Sample};

/// Timeout of one read, in ms. After each timeout the reader checks for silence and sends kept
/// samples again.
const READ_MS: i32 = 10;
/// The same in microseconds.
const READ_US: u64 = READ_MS as u64 * 1000;
/// Longest report; hidraw's limit is 4096.
const MAX_REPORT: usize = 4096;

/// The state of a reader.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ReaderStatus {
    /// The device is there and its thread reads it.
    pub connected: bool,
    /// Reports that were read.
    pub reports: u64,
    /// Reports that are cut short or contradict themselves.
    pub broken: u64,
    /// Reports of another id: touch, mouse, battery.
    pub ignored: u64,
    /// Samples that were made of them.
    pub samples: u64,
    /// From the read of a report to its samples being in the channel.
    pub to_channel_us: Quantiles,
    /// Why the thread ended, if it did.
    pub last_error: Option<String>,
}

/// A running reader; dropping it ends its thread.
#[derive(Debug)]
pub struct ReaderHandle {
    shared: Arc<Mutex<ReaderShared>>,
    _thread: DeviceThread,
}

#[derive(Debug, Default)]
struct ReaderShared {
    status: ReaderStatus,
    to_channel: Latency,
}

impl ReaderHandle {
    /// A copy of the present state.
    pub fn status(&self) -> ReaderStatus {
        let shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        ReaderStatus { to_channel_us: shared.to_channel.quantiles(), ..shared.status.clone() }
    }
}

/// Reads an interface that was opened and identified, until it goes or the handle is dropped.
///
/// # Errors
/// Only if no thread can be started.
pub fn start(
    transport: Box<dyn Transport>,
    found: &Found,
    descriptor: &[u8],
    device: DeviceId,
    clock: Clock,
    sender: Sender,
) -> io::Result<ReaderHandle> {
    let status = ReaderStatus { connected: true, ..ReaderStatus::default() };
    let shared = Arc::new(Mutex::new(ReaderShared { status, ..ReaderShared::default() }));
    let theirs = shared.clone();
    let decoder = Decoder::new(found, descriptor, device);
    let thread = device_thread::spawn("hid-pen", move |stop| {
        let mut sender = sender;
        sender.stop_when(stop.flag());
        let listening = Listening::default();
        HidReader { transport, decoder, clock, sender, shared: theirs, listening }.run(&stop);
    })?;
    Ok(ReaderHandle { shared, _thread: thread })
}

struct HidReader {
    transport: Box<dyn Transport>,
    decoder: Decoder,
    clock: Clock,
    sender: Sender,
    shared: Arc<Mutex<ReaderShared>>,
    listening: Listening,
}

/// Time that the thread has listened since the pen's last report. A thread delayed by the system
/// receives reports late, and that does not count as silence of the pen.
#[derive(Debug, Default)]
struct Listening {
    /// Time at which the last read returned, in microseconds.
    read_us: Option<u64>,
    /// Time at which silence would end the visit; it changes with each report of the pen.
    due_us: Option<u64>,
    /// Time since the pen's last report in which the thread did not listen, microseconds.
    held_up_us: u64,
}

impl Listening {
    /// A read returned. Returns the time up to which silence is proved.
    fn heard_until(&mut self, now_us: u64, due_us: Option<u64>) -> u64 {
        if due_us != self.due_us {
            (self.due_us, self.held_up_us) = (due_us, 0);
        }
        let took = now_us.saturating_sub(self.read_us.replace(now_us).unwrap_or(now_us));
        if took > 2 * READ_US {
            self.held_up_us += took - READ_US;
        }
        now_us.saturating_sub(self.held_up_us)
    }
}

impl HidReader {
    fn run(&mut self, stop: &StopToken) {
        let (mut buffer, mut out) = (vec![0; MAX_REPORT], Vec::with_capacity(16));
        let mut error = None;
        self.ask_tool(&mut buffer, &mut out);
        while !stop.stopped() && error.is_none() {
            let read = self.transport.read(&mut buffer, READ_MS);
            let now_us = self.clock.now_us();
            let heard_us = self.listening.heard_until(now_us, self.decoder.due_us());
            self.decoder.tick(heard_us, &mut |s| out.push(s));
            match read {
                Ok(0) => drop(self.sender.flush()),
                Ok(n) => self.decoder.feed(&buffer[..n], now_us, &mut |s| out.push(s)),
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => error = Some(e.to_string()),
            }
            self.send(&mut out);
        }
        self.decoder.leave(self.clock.now_us(), &mut |s| out.push(s));
        self.send(&mut out);
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        shared.status.connected = false;
        shared.status.last_error = error;
    }

    /// The tool of a pen that is in range when its tablet is opened was reported before the reader
    /// started.
    fn ask_tool(&mut self, buffer: &mut [u8], out: &mut Vec<Sample>) {
        if let Some(id) = self.decoder.names_tool() {
            buffer[0] = id;
            if let Ok(n) = self.transport.get_feature(buffer) {
                let n = n.min(buffer.len());
                self.decoder.feed(&buffer[..n], self.clock.now_us(), &mut |s| out.push(s));
            }
        }
    }

    fn send(&mut self, out: &mut Vec<Sample>) {
        let (n, read_us) = (out.len() as u64, out.first().map(|s| s.t_us));
        for sample in out.drain(..) {
            self.sender.push(sample);
        }
        let counts = self.decoder.counts();
        let taken = read_us.map(|t| self.clock.now_us().saturating_sub(t));
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(us) = taken {
            shared.to_channel.record(us);
        }
        let status = &mut shared.status;
        (status.reports, status.broken, status.ignored) =
            (counts.reports, counts.broken, counts.ignored);
        status.samples += n;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_was_held_up_proves_no_silence() {
        let mut listening = Listening::default();
        let due = Some(50_000);
        assert_eq!(listening.heard_until(0, due), 0);
        // Five reads in vain.
        for i in 1..=5 {
            assert_eq!(listening.heard_until(i * READ_US, due), i * READ_US);
        }
        // The system held the thread up for 400 ms: only one read of that is silence.
        assert_eq!(listening.heard_until(450_000, due), 60_000);
        assert_eq!(listening.heard_until(460_000, due), 70_000);
        // The next report of the pen restarts the count.
        assert_eq!(listening.heard_until(461_000, Some(511_000)), 461_000);
    }
}
