//! Copies every report that is read from a bus, without delaying it: how live devices are recorded.

use std::io;

use crossbeam_channel as cc;

use super::bus::{Bus, Node, read_more};
use super::transport::Transport;
use crate::catalogue::Identity;
use crate::clock::Clock;

/// One event of a recorded bus.
#[derive(Debug, Clone, PartialEq)]
pub enum Tapped {
    /// An interface was opened; later reports carry its number.
    Opened {
        /// Number of the interface, from 0 in the order of opening.
        number: usize,
        /// Data read from it, its strings included.
        who: Identity,
        /// Serial number; empty where the device has none.
        serial: String,
    },
    /// A report was read.
    Report {
        /// Number of the interface.
        number: usize,
        /// Time of the read, in microseconds on the clock of the bus.
        t_us: u64,
        /// The report, its id first where the device has ids.
        bytes: Vec<u8>,
    },
}

/// A bus whose reports are also sent to `out`. They are dropped when `out` is full: reading comes
/// first.
#[derive(Debug)]
pub struct TapBus<B> {
    /// The bus that is read.
    pub bus: B,
    /// The clock that stamps reports.
    pub clock: Clock,
    /// Receiver of copies. A full channel drops them.
    pub out: cc::Sender<Tapped>,
    opened: usize,
}

impl<B: Bus> TapBus<B> {
    /// Copies what is read from `bus` to `out`.
    pub fn new(bus: B, clock: Clock, out: cc::Sender<Tapped>) -> Self {
        TapBus { bus, clock, out, opened: 0 }
    }
}

impl<B: Bus> Bus for TapBus<B> {
    fn nodes(&mut self) -> io::Result<Vec<Node>> {
        self.bus.nodes()
    }

    fn open(&mut self, node: &Node) -> io::Result<Box<dyn Transport>> {
        let mut inner = self.bus.open(node)?;
        let (number, mut who) = (self.opened, node.who.clone());
        self.opened += 1;
        read_more(&mut who, inner.as_mut());
        let _ = self.out.send(Tapped::Opened { number, who, serial: node.serial.clone() });
        Ok(Box::new(Tap { inner, number, clock: self.clock.clone(), out: self.out.clone() }))
    }

    fn stamp(&self) -> Option<u64> {
        self.bus.stamp()
    }
}

struct Tap {
    inner: Box<dyn Transport>,
    number: usize,
    clock: Clock,
    out: cc::Sender<Tapped>,
}

impl Transport for Tap {
    fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize> {
        let n = self.inner.read(buf, timeout_ms)?;
        if n > 0 {
            let bytes = buf[..n.min(buf.len())].to_vec();
            let _ = self.out.try_send(Tapped::Report {
                number: self.number,
                t_us: self.clock.now_us(),
                bytes,
            });
        }
        Ok(n)
    }

    fn write(&mut self, report: &[u8]) -> io::Result<()> {
        self.inner.write(report)
    }

    fn send_feature(&mut self, report: &[u8]) -> io::Result<()> {
        self.inner.send_feature(report)
    }

    fn get_feature(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.inner.get_feature(buf)
    }

    fn descriptor(&mut self) -> Option<Vec<u8>> {
        self.inner.descriptor()
    }

    fn string(&mut self, index: u8) -> Option<String> {
        self.inner.string(index)
    }
}
