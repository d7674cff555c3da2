//! The live port: finds the tablet, reads it, and looks for it again after it was unplugged.

use std::io::ErrorKind;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::session::{self, PROBE_ORDER, Wire};
use super::{Protocol, SerialCounts, SerialDecoder, SerialFacts};
use crate::calibration::Calibration;
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread, StopToken};
use crate::queue::Sender;
use crate::sample::{DeviceId, Sample};

/// A line that is silent for this long has ended its packet: about the time of four bytes at 19200
/// baud or three at 9600.
const QUIET: Duration = Duration::from_millis(2);
/// Timeout of a read while no packet is held back.
const READ_SLICE: Duration = Duration::from_millis(20);
/// First and longest wait before the ports are tried again.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(500), Duration::from_secs(4));

/// Ports that may be opened, and the expected devices.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SerialConfig {
    /// The port that a tablet is on, such as `/dev/ttyS0` or `COM3`.
    pub port: Option<String>,
    /// Ports that may be asked when none is named; a name may end in `*`. Empty: none. Asking
    /// writes to the port, which may disturb another device there.
    pub probe: Vec<String>,
    /// The protocol. `None`: the tablet is asked, which takes up to five seconds a port.
    pub protocol: Option<Protocol>,
    /// Fingers on an ISDV4 screen become samples too.
    pub touch: bool,
    /// The person's calibration for the tablet there.
    pub calibration: Calibration,
    /// The device number of its samples.
    #[serde(skip)]
    pub device: DeviceId,
}

/// The state of the reader.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct SerialStatus {
    /// A tablet was found and is read.
    pub connected: bool,
    /// The port that it is on.
    pub port: Option<String>,
    /// The protocol.
    pub protocol: Option<Protocol>,
    /// Model name reported by the device.
    pub model: Option<String>,
    /// Width and height of the active area.
    pub area_mm: Option<[f32; 2]>,
    /// Counts of its bytes and packets.
    pub counts: SerialCounts,
    /// Samples that were made of them.
    pub samples: u64,
    /// Packets in the last full second.
    pub rate: f32,
    /// Times that a tablet was found.
    pub connections: u64,
    /// Why no tablet is read, or what was wrong last.
    pub last_error: Option<String>,
}

/// A running reader; dropping it ends its thread.
#[derive(Debug)]
pub struct SerialHandle {
    status: Arc<Mutex<SerialStatus>>,
    _thread: DeviceThread,
}

impl SerialHandle {
    /// A copy of the present state.
    pub fn status(&self) -> SerialStatus {
        self.status.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Starts the reader's thread. It goes on looking for the tablet for as long as the handle lives.
///
/// # Errors
/// Only if no thread can be started.
pub fn start(config: SerialConfig, clock: Clock, sender: Sender) -> std::io::Result<SerialHandle> {
    let status = Arc::new(Mutex::new(SerialStatus::default()));
    let shared = status.clone();
    let thread = device_thread::spawn("serial-pen", move |stop| {
        let mut sender = sender;
        sender.stop_when(stop.flag());
        sender.calibrate(config.device, config.calibration);
        SerialReader { config, clock, sender, status: shared, second: (0, 0) }.run(&stop);
    })?;
    Ok(SerialHandle { status, _thread: thread })
}

struct SerialReader {
    config: SerialConfig,
    clock: Clock,
    sender: Sender,
    status: Arc<Mutex<SerialStatus>>,
    /// Start of the present second of counting, and the packets by then.
    second: (u64, u64),
}

impl SerialReader {
    fn note(&self, change: impl FnOnce(&mut SerialStatus)) {
        change(&mut self.status.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn run(&mut self, stop: &StopToken) {
        let mut wait = BACK_OFF.0;
        while !stop.stopped() {
            let mut why = "no port is named, and none that may be asked is there".to_owned();
            for name in self.ports() {
                why = match self.find(&name, stop) {
                    Ok((mut wire, facts)) => {
                        wait = BACK_OFF.0;
                        self.found(&name, &facts);
                        let why = self.read(wire.as_mut(), &facts, stop);
                        self.note(|s| s.connected = false);
                        why
                    }
                    Err(why) => why,
                };
                tracing::debug!(port = name, %why, "no serial tablet");
                if stop.stopped() {
                    return;
                }
            }
            self.note(|s| s.last_error = Some(why));
            self.sender.flush();
            if stop.wait(wait) {
                return;
            }
            wait = (wait * 2).min(BACK_OFF.1);
        }
    }

    fn found(&self, name: &str, facts: &SerialFacts) {
        self.note(|s| {
            s.connected = true;
            s.connections += 1;
            s.port = Some(name.to_owned());
            s.protocol = Some(facts.layout.protocol());
            s.model = Some(facts.model.clone());
            s.area_mm = Some(facts.area_mm.to_array());
            s.last_error = None;
        });
    }

    /// Returns the named port, else the allowed ports that exist.
    fn ports(&self) -> Vec<String> {
        if let Some(name) = &self.config.port {
            return vec![name.clone()];
        }
        let allowed = |name: &str| {
            self.config.probe.iter().any(|p| match p.strip_suffix('*') {
                Some(start) => !start.is_empty() && name.starts_with(start),
                None => name == p,
            })
        };
        if self.config.probe.is_empty() {
            return Vec::new();
        }
        let mut names: Vec<String> = serialport::available_ports()
            .unwrap_or_default()
            .into_iter()
            .map(|p| p.port_name)
            .collect();
        // A pseudo-terminal or a link that is named in full is no "available port", but allowed is
        // allowed.
        names.extend(self.config.probe.iter().filter(|p| !p.ends_with('*')).cloned());
        names.sort();
        names.dedup();
        names.retain(|n| allowed(n));
        names
    }

    fn find(&self, name: &str, stop: &StopToken) -> Result<(Box<dyn Wire>, SerialFacts), String> {
        let port = serialport::new(name, 9600)
            .timeout(READ_SLICE)
            .open()
            .map_err(|e| format!("{name}: {e}"))?;
        let mut wire: Box<dyn Wire> = Box::new(port);
        let asked = match &self.config.protocol {
            Some(one) => std::slice::from_ref(one),
            None => &PROBE_ORDER[..],
        };
        for &protocol in asked {
            let found = session::open(wire.as_mut(), protocol, self.config.touch, stop);
            if let Some(facts) = found.map_err(|e| format!("{name}: {e}"))? {
                return Ok((wire, facts));
            }
        }
        Err(format!("{name}: nothing that answers {asked:?}"))
    }

    /// Reads until the line breaks; returns why it did.
    fn read(&mut self, wire: &mut dyn Wire, facts: &SerialFacts, stop: &StopToken) -> String {
        let mut decoder = SerialDecoder::new(facts, self.config.device);
        let (mut buffer, mut out) = ([0; 512], Vec::with_capacity(64));
        let mut patience = Duration::ZERO;
        let why = loop {
            if stop.stopped() {
                break "stopped".to_owned();
            }
            let wanted = if decoder.holds() { QUIET } else { READ_SLICE };
            if wanted != patience {
                if let Err(e) = wire.set_patience(wanted) {
                    break e.to_string();
                }
                patience = wanted;
            }
            let mut emit = |s| out.push(s);
            match wire.read(&mut buffer) {
                Ok(0) => break "the port closed".to_owned(),
                Ok(n) => decoder.feed(&buffer[..n], self.clock.now_us(), &mut emit),
                Err(e) if matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {
                    decoder.quiet(&mut emit);
                    decoder.tick(self.clock.now_us(), &mut emit);
                    self.sender.flush();
                }
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => break e.to_string(),
            }
            self.send(&mut out, &decoder);
        };
        decoder.leave(self.clock.now_us(), &mut |s| out.push(s));
        self.send(&mut out, &decoder);
        why
    }

    fn send(&mut self, out: &mut Vec<Sample>, decoder: &SerialDecoder) {
        let n = out.len() as u64;
        for sample in out.drain(..) {
            self.sender.push(sample);
        }
        let (now, (from, before), packets) =
            (self.clock.now_us(), self.second, decoder.counts.packets);
        let rate = (now >= from + 1_000_000).then(|| {
            self.second = (now, packets);
            // A new connection counts from 0 again.
            packets.saturating_sub(before) as f32 * 1e6 / (now - from) as f32
        });
        self.note(|s| {
            s.samples += n;
            s.rate = rate.unwrap_or(s.rate);
            s.counts = decoder.counts;
        });
    }
}
