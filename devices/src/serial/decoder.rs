//! Bytes of a serial line to samples: framing, then the layout, then the pen's state. No IO; live
//! lines, simulators and tests use the same object.

use serde::Serialize;

use super::{SerialFacts, SerialLayout};
use crate::pen_state::{PenConfig, PenScale, PenState};
use crate::report::Parsed;
use crate::sample::{DeviceId, Sample};

/// Longest packet of any protocol (two fingers over ISDV4).
const MAX_PACKET: usize = 16;

/// All these protocols report when the pen leaves, and stream while it is near. After a lost last
/// packet, this much silence ends the visit.
const SILENCE_US: u64 = 300_000;

/// Counts of bytes and packets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct SerialCounts {
    /// Packets that were read.
    pub packets: u64,
    /// Begun and cut short by the next.
    pub cut: u64,
    /// Followed by a byte that belongs to none: a byte was lost or doubled.
    pub suspect: u64,
    /// Bytes outside any packet.
    pub stray: u64,
    /// Complete packets with a position outside the tablet.
    pub broken: u64,
}

/// Reads the bytes of one serial tablet.
#[derive(Debug, Clone)]
pub struct SerialDecoder {
    layout: SerialLayout,
    pen: PenState,
    packet: [u8; MAX_PACKET],
    have: usize,
    /// A whole packet, not yet confirmed by what follows, and when its last byte was read.
    held: Option<(usize, u64)>,
    /// Counts of the bytes so far.
    pub counts: SerialCounts,
}

impl SerialDecoder {
    /// A decoder for a tablet with these facts.
    pub fn new(facts: &SerialFacts, device: DeviceId) -> Self {
        let pen = PenState::new(PenConfig {
            device,
            scale: PenScale {
                min: [0; 2],
                max: facts.max,
                area_mm: facts.area_mm,
                max_pressure: facts.max_pressure,
                max_distance: 0,
            },
            silence_us: Some(SILENCE_US),
            contact_silence_us: SILENCE_US,
            tilts: facts.layout.tilts(),
        });
        SerialDecoder {
            layout: facts.layout.clone(),
            pen,
            packet: [0; MAX_PACKET],
            have: 0,
            held: None,
            counts: SerialCounts::default(),
        }
    }

    /// Bytes as they came, read at `t_us`.
    pub fn feed(&mut self, bytes: &[u8], t_us: u64, emit: &mut dyn FnMut(Sample)) {
        for &b in bytes {
            self.byte(b, t_us, emit);
        }
    }

    /// Nothing came for longer than a byte takes: a packet that is held is a good one.
    pub fn quiet(&mut self, emit: &mut dyn FnMut(Sample)) {
        self.release(emit);
    }

    /// Returns true if a packet waits for [`SerialDecoder::quiet`].
    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// Time passed.
    pub fn tick(&mut self, now_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.pen.tick(now_us, emit);
    }

    /// The tablet went: whatever was in range leaves.
    pub fn leave(&mut self, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        self.release(emit);
        self.have = 0;
        self.pen.leave(t_us, emit);
    }

    /// Returns true if the pen is in proximity.
    pub fn in_range(&self) -> bool {
        self.pen.in_range()
    }

    fn byte(&mut self, b: u8, t_us: u64, emit: &mut dyn FnMut(Sample)) {
        if b & 0x80 != 0 {
            self.release(emit);
            self.counts.cut += u64::from(self.have > 0);
            self.have = 0;
        } else if self.held.take().is_some() {
            self.counts.suspect += 1;
            return;
        } else if self.have == 0 {
            self.counts.stray += 1;
            return;
        }
        self.packet[self.have] = b;
        self.have += 1;
        if self.have >= self.layout.length(self.packet[0]).min(MAX_PACKET) {
            self.held = Some((self.have, t_us));
            self.have = 0;
        }
    }

    fn release(&mut self, emit: &mut dyn FnMut(Sample)) {
        let Some((length, t_us)) = self.held.take() else { return };
        self.counts.packets += 1;
        match self.layout.parse(&self.packet[..length]) {
            Parsed::Pen(r) => {
                self.pen.tick(t_us, emit);
                self.pen.report(&r, t_us, emit);
            }
            Parsed::Away => self.pen.leave(t_us, emit),
            Parsed::Broken => self.counts.broken += 1,
            Parsed::Nothing | Parsed::Pad(_) => {}
        }
    }
}
