//! A virtual serial pen on a pseudo-terminal: answers the host's questions and streams packets.

mod encode;

use std::io::{self, ErrorKind, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use glam::{Vec2, vec2};
use serialport::{SerialPort, TTYPort};

use self::encode::Model;
use super::faults::{Faults, Rng};
use super::pen::PenScript;
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread};
use crate::sample::DeviceId;
use crate::serial::{Protocol, SerialDecoder, SerialFacts};

/// The packets that a pen on this script sends over a span of time, and the facts of its tablet.
/// For tests that need bytes and no port.
pub fn stream(
    protocol: Protocol,
    script: &PenScript,
    span_us: std::ops::Range<u64>,
) -> (SerialFacts, Vec<Vec<u8>>) {
    let mut model = Model::new(protocol, vec2(210.0, 148.0));
    let packets = span_us.step_by(7_500).flat_map(|t| model.packets(&script.at(t))).collect();
    (model.facts, packets)
}

/// Interval at which the line is read for questions of the host.
const LISTEN: Duration = Duration::from_millis(3);
/// Attempts of 100 ms each before a stalled reader is given up.
const WRITE_ATTEMPTS: usize = 20;

/// Configuration of a simulated serial pen and the faults of its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SerialPenConfig {
    /// The protocol.
    pub protocol: Protocol,
    /// Width and height of its active area in mm.
    pub area_mm: Vec2,
    /// Packets a second: 133 is what an ISDV4 screen gives, 38400 baud carry 400.
    pub rate: f32,
    /// The script begins again after so long.
    pub repeat_us: Option<u64>,
    /// Here `drop` and `duplicate` apply to one byte of a packet, and `tear` cuts the end off.
    pub faults: Faults,
}

impl SerialPenConfig {
    /// A pen at the usual rate on a good line.
    pub fn new(protocol: Protocol, area_mm: Vec2) -> Self {
        SerialPenConfig {
            protocol,
            area_mm,
            rate: 133.0,
            repeat_us: None,
            faults: Faults::default(),
        }
    }
}

/// The simulated device. Its owner advances it.
#[derive(Debug)]
pub struct SerialPen {
    config: SerialPenConfig,
    script: PenScript,
    model: Model,
    master: Option<TTYPort>,
    /// Held open so that the line stays up between two readers.
    _slave: TTYPort,
    name: String,
    streaming: Arc<AtomicBool>,
    rng: Rng,
    /// The last packet was damaged.
    spoilt: bool,
    next_us: u64,
    stalled_until_us: u64,
    backlog: Vec<u8>,
    /// Decodes the same bytes, to count the samples that a reader is expected to make.
    reader: SerialDecoder,
    listener: Option<DeviceThread>,
}

impl SerialPen {
    /// Opens a pseudo-terminal and begins to answer questions on it.
    ///
    /// # Errors
    /// If a pseudo-terminal or a thread cannot be created.
    pub fn new(script: PenScript, config: SerialPenConfig) -> io::Result<Self> {
        let (master, slave) = TTYPort::pair()?;
        let name =
            slave.name().ok_or_else(|| io::Error::other("a pseudo-terminal without a name"))?;
        let model = Model::new(config.protocol, config.area_mm);
        let streaming = Arc::new(AtomicBool::new(false));
        let mut ears = master.try_clone_native()?;
        ears.set_timeout(LISTEN)?;
        let (their_model, on) = (Mutex::new(model.clone()), streaming.clone());
        let listener = device_thread::spawn("sim-serial", move |stop| {
            let (mut said, mut buffer) = (Vec::new(), [0; 64]);
            while !stop.stopped() {
                match ears.read(&mut buffer) {
                    Ok(0) => return,
                    Ok(n) => said.extend_from_slice(&buffer[..n]),
                    Err(e) if waited(&e) => continue,
                    Err(_) => return,
                }
                let mut streams = on.load(SeqCst);
                let model = their_model.lock().unwrap_or_else(PoisonError::into_inner);
                let reply = model.answer(&mut said, &mut streams);
                on.store(streams, SeqCst);
                let _ = write_all(&mut ears, &reply);
            }
        })?;
        let reader = SerialDecoder::new(&model.facts, DeviceId(0));
        Ok(SerialPen {
            rng: Rng::new(config.faults.seed),
            spoilt: false,
            config,
            script,
            model,
            master: Some(master),
            _slave: slave,
            name,
            streaming,
            next_us: 0,
            stalled_until_us: 0,
            backlog: Vec::new(),
            reader,
            listener: Some(listener),
        })
    }

    /// The port that a reader opens.
    pub fn port(&self) -> &str {
        &self.name
    }

    /// Returns true if a reader has asked for the stream.
    pub fn streaming(&self) -> bool {
        self.streaming.load(SeqCst)
    }

    /// Waits until a reader has asked for the stream; false if none has in time.
    pub fn wait_for_reader(&self, patience: Duration) -> bool {
        let (_hold, stop) = device_thread::pair();
        let slices = patience.as_millis() / LISTEN.as_millis();
        (0..slices).any(|_| self.streaming() || stop.wait(LISTEN)) || self.streaming()
    }

    /// Leaves out everything before `us`.
    pub fn skip_to(&mut self, us: u64) {
        self.next_us = self.next_us.max(us);
    }

    /// Pulls the plug: a reader sees the line break, and a pen in range leaves. Returns the number
    /// of samples to expect.
    pub fn unplug(&mut self) -> u32 {
        self.streaming.store(false, SeqCst);
        self.listener = None;
        self.master = None;
        let mut n = 0;
        self.reader.leave(self.next_us, &mut |_| n += 1);
        n
    }

    /// Writes every packet due up to `until_us`, that one included; nothing before a reader has
    /// asked for the stream. Gives how many samples must come out of its adaptor for them.
    pub fn advance(&mut self, until_us: u64) -> u32 {
        let step = (1e6 / f64::from(self.config.rate.clamp(1.0, 100_000.0))) as u64;
        let mut bytes = Vec::new();
        let mut expected = 0;
        while self.next_us <= until_us {
            let at = self.next_us;
            self.next_us += step;
            if !self.streaming() {
                continue;
            }
            let when = self.config.repeat_us.filter(|p| *p > 0).map_or(at, |p| at % p);
            for packet in self.model.packets(&self.script.at(when)) {
                expected += self.transmit(packet, at, &mut bytes);
            }
        }
        if until_us >= self.stalled_until_us {
            bytes.append(&mut self.backlog);
        }
        let written = self.master.as_mut().is_some_and(|m| write_all(m, &bytes).is_ok());
        if written {
            let mut count = |_| expected += 1;
            self.reader.feed(&bytes, until_us, &mut count);
            self.reader.quiet(&mut count);
            self.reader.tick(until_us, &mut count);
        }
        expected
    }

    /// One packet over the faulty line; gives the samples that an unplug brings about.
    fn transmit(&mut self, packet: Vec<u8>, at: u64, out: &mut Vec<u8>) -> u32 {
        let f = self.config.faults;
        let [cut, lost, doubled, stall, unplug] =
            [f.tear, f.drop, f.duplicate, f.stall, f.unplug].map(|r| self.rng.unit() < r);
        let i = self.rng.below(packet.len() as u64) as usize;
        if stall {
            self.stalled_until_us = at + 20_000 + self.rng.below(280_000);
        }
        // Two faults in a row can make a whole packet out of two broken ones. No reader can
        // distinguish it from a good one, because these protocols have no checksum. A line's noise,
        // too, comes one fault at a time.
        self.spoilt = !self.spoilt && (cut || lost || doubled);
        let mut bytes = packet;
        if self.spoilt {
            if cut {
                bytes.truncate(i.max(1));
            } else if lost {
                bytes.remove(i);
            } else {
                bytes.insert(i, bytes[i]);
            }
        }
        self.emit(&bytes, at, out);
        if unplug { self.unplug() } else { 0 }
    }

    fn emit(&mut self, bytes: &[u8], at: u64, out: &mut Vec<u8>) {
        if at < self.stalled_until_us {
            self.backlog.extend_from_slice(bytes);
        } else {
            out.append(&mut self.backlog);
            out.extend_from_slice(bytes);
        }
    }

    /// Runs by itself on a clock, from now on, for as long as the result lives.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn play(mut self, clock: Clock) -> io::Result<PlayingPen> {
        let (port, start) = (self.name.clone(), clock.now_us());
        let thread = device_thread::spawn("sim-serial-pen", move |stop| {
            while !stop.wait(Duration::from_millis(2)) {
                self.advance(clock.now_us().saturating_sub(start));
            }
        })?;
        Ok(PlayingPen { port, _thread: thread })
    }
}

/// A simulated pen that runs by itself; dropping it unplugs it.
#[derive(Debug)]
pub struct PlayingPen {
    /// The port that a reader opens.
    pub port: String,
    _thread: DeviceThread,
}

fn waited(e: &io::Error) -> bool {
    matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// Writes everything, waiting for a slow reader, but not for ever.
fn write_all(port: &mut TTYPort, mut bytes: &[u8]) -> io::Result<()> {
    let mut attempts = 0;
    while !bytes.is_empty() {
        match port.write(bytes) {
            Ok(n) => bytes = &bytes[n..],
            Err(e) if waited(&e) && attempts < WRITE_ATTEMPTS => attempts += 1,
            Err(e) => return Err(e),
        }
    }
    Ok(())
}
