//! A virtual pen tablet: report bytes of its family behind the transport that a real one is read
//! through.

mod encode;
mod reports;

use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crossbeam_channel as cc;

use self::encode::Encoder;
use super::faults::{Event, Faults, Line};
use super::pen::PenScript;
use crate::catalogue::{Catalogue, Found, Identity};
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread};
use crate::hid::decoder::Decoder;
use crate::hid::transport::Transport;
use crate::sample::DeviceId;
use crate::tablet::Family;

/// Reports that wait for a reader: as many as Linux hidraw keeps. As there, the newest one is
/// dropped.
const KERNEL_KEEPS: usize = 63;

/// Behaviour of a simulated tablet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TabletConfig {
    /// Reports a second: 133 to 330 in real ones.
    pub rate: f32,
    /// The script begins again after so long.
    pub repeat_us: Option<u64>,
    /// Reports that wait for a reader before the newest are dropped.
    pub keeps: usize,
    /// Faults of its line.
    pub faults: Faults,
}

impl Default for TabletConfig {
    fn default() -> Self {
        TabletConfig {
            rate: 200.0,
            repeat_us: None,
            keeps: KERNEL_KEEPS,
            faults: Faults::default(),
        }
    }
}

/// The identity that a model has on the bus by its file, for [`Catalogue::identify`]. `None` where
/// no model has this name.
pub fn identity(catalogue: &Catalogue, name: &str) -> Option<Identity> {
    let tablet = catalogue.tablets().iter().find(|t| t.name == name)?;
    let id = tablet.id.first()?;
    Some(Identity {
        vid: id.vid,
        pid: id.pid,
        interface: id.interface,
        name: name.to_owned(),
        seen_lengths: vec![usize::from(id.length)],
        ..Identity::default()
    })
}

/// A tablet that no file describes: it is read by its report descriptor alone. A5, tilt, 8192
/// levels of pressure.
pub fn generic_identity() -> Identity {
    Identity {
        vid: 0x1209, // The id that is lent to projects without their own.
        pid: 0x0001,
        name: "simulated digitiser".to_owned(),
        descriptor: reports::GENERIC_DESCRIPTOR.to_vec(),
        seen_lengths: vec![10],
        ..Identity::default()
    }
}

/// The simulated device. Its owner advances it.
#[derive(Debug)]
pub struct SimTablet {
    config: TabletConfig,
    script: PenScript,
    encoder: Encoder,
    line: Line<Vec<u8>>,
    tx: Option<cc::Sender<Vec<u8>>>,
    next_us: u64,
    stalled_until_us: u64,
    backlog: Vec<Vec<u8>>,
    /// Decodes the same bytes, to count the samples that a reader is expected to make.
    reader: Decoder,
    /// Reports that were dropped because no reader took them.
    pub dropped: u64,
    asked: Arc<Mutex<Vec<Vec<u8>>>>,
}

/// The report descriptor that a reader of a simulated tablet is given: empty but for the generic
/// one, which is read by it.
pub fn descriptor(found: &Found) -> &'static [u8] {
    if found.id().parser == Family::Digitiser { reports::GENERIC_DESCRIPTOR } else { &[] }
}

/// The reader's end.
#[derive(Debug)]
pub struct TabletEnd {
    rx: cc::Receiver<Vec<u8>>,
    asked: Arc<Mutex<Vec<Vec<u8>>>>,
}

impl SimTablet {
    /// A tablet as its file describes it, and the end that a reader is given.
    pub fn new(found: &Found, script: PenScript, config: TabletConfig) -> (Self, TabletEnd) {
        let (tx, rx) = cc::bounded(config.keeps.max(1));
        let asked = Arc::new(Mutex::new(Vec::new()));
        let tablet = SimTablet {
            encoder: Encoder::new(found),
            line: Line::new(config.faults),
            config,
            script,
            tx: Some(tx),
            next_us: 0,
            stalled_until_us: 0,
            backlog: Vec::new(),
            reader: Decoder::new(found, descriptor(found), DeviceId(0)),
            dropped: 0,
            asked: asked.clone(),
        };
        (tablet, TabletEnd { rx, asked })
    }

    /// Returns true if its reports show when the pen leaves. Otherwise only silence does, and
    /// [`SimTablet::advance`] relies on a reader that checks its clock.
    pub fn says_away(&self) -> bool {
        self.encoder.says_away()
    }

    /// Output and feature reports that came, in order.
    pub fn asked(&self) -> Vec<Vec<u8>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Leaves out everything before `us`.
    pub fn skip_to(&mut self, us: u64) {
        self.next_us = self.next_us.max(us);
    }

    /// Pulls the plug: a reader gets an error, and what was in range leaves. Gives the samples to
    /// expect.
    pub fn unplug(&mut self) -> u32 {
        self.tx = None;
        let mut n = 0;
        self.reader.leave(self.next_us, &mut |_| n += 1);
        n
    }

    /// Sends every report due up to `until_us`, that one included. Gives how many samples must come
    /// out of its reader for them; that holds while the reader keeps up.
    pub fn advance(&mut self, until_us: u64) -> u32 {
        let step = (1e6 / f64::from(self.config.rate.clamp(1.0, 100_000.0))) as u64;
        let mut expected = 0;
        while self.next_us <= until_us {
            let at = self.next_us;
            self.next_us += step;
            let when = self.config.repeat_us.filter(|p| *p > 0).map_or(at, |p| at % p);
            for report in self.encoder.reports(&self.script.at(when)) {
                let mut events = Vec::with_capacity(4);
                self.line.transmit(report, |e| events.push(e));
                for event in events {
                    expected += self.apply(event, at, until_us);
                }
            }
        }
        if until_us >= self.stalled_until_us {
            expected += self.end_stall(until_us);
        }
        self.reader.tick(until_us, &mut |_| expected += 1);
        expected
    }

    fn apply(&mut self, event: Event<Vec<u8>>, at: u64, now: u64) -> u32 {
        match event {
            Event::Stall(us) => self.stalled_until_us = at + us,
            // A tablet has no clock.
            Event::ClockJump(_) => {}
            Event::Unplug => return self.unplug(),
            Event::Whole(r) if at < self.stalled_until_us => self.backlog.push(r),
            Event::Whole(r) => return self.end_stall(now) + self.send(r, now),
            Event::Torn(mut r, share) => {
                r.truncate(((r.len() as f32 * share) as usize).max(1));
                return self.send(r, now);
            }
        }
        0
    }

    fn end_stall(&mut self, now: u64) -> u32 {
        std::mem::take(&mut self.backlog).into_iter().map(|r| self.send(r, now)).sum()
    }

    fn send(&mut self, report: Vec<u8>, now: u64) -> u32 {
        let Some(tx) = &self.tx else { return 0 };
        let mut n = 0;
        self.reader.feed(&report, now, &mut |_| n += 1);
        match tx.try_send(report) {
            Ok(()) => n,
            Err(_) => {
                self.dropped += 1;
                0
            }
        }
    }

    /// Runs by itself on a clock, from now on, for as long as the result lives.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn play(mut self, clock: Clock) -> io::Result<PlayingTablet> {
        let start = clock.now_us();
        let thread = device_thread::spawn("sim-tablet", move |stop| {
            while !stop.wait(Duration::from_millis(2)) {
                self.advance(clock.now_us().saturating_sub(start));
            }
        })?;
        Ok(PlayingTablet { _thread: thread })
    }
}

/// A simulated tablet that runs by itself; dropping it unplugs it.
#[derive(Debug)]
pub struct PlayingTablet {
    _thread: DeviceThread,
}

impl Transport for TabletEnd {
    fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize> {
        let patience = Duration::from_millis(u64::try_from(timeout_ms).unwrap_or(60_000));
        match self.rx.recv_timeout(patience) {
            Ok(report) => {
                let n = report.len().min(buf.len());
                buf[..n].copy_from_slice(&report[..n]);
                Ok(n)
            }
            Err(cc::RecvTimeoutError::Timeout) => Ok(0),
            Err(cc::RecvTimeoutError::Disconnected) => Err(io::ErrorKind::NotConnected.into()),
        }
    }

    fn write(&mut self, report: &[u8]) -> io::Result<()> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner).push(report.to_vec());
        Ok(())
    }

    fn send_feature(&mut self, report: &[u8]) -> io::Result<()> {
        self.write(report)
    }
}

#[cfg(test)]
mod tests;
