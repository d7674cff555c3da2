//! Pens, fingers and mice of a web page, from the bytes that the page sends to samples.
//!
//! A page batches what its browser reports (the coalesced events of Pointer Events, level 3). Each
//! record is 20 bytes, little endian:
//!
//! | bytes | field |
//! |---|---|
//! | 8 | time on the page's clock, µs (f64) |
//! | 2, 2 | place in the view, x and y: 0 to 65535 across the view |
//! | 2 | pressure, 0 to 65535 |
//! | 1, 1 | tilt to the right and toward the user, degrees (i8) |
//! | 2 | twist, degrees clockwise, 0 to 359 |
//! | 1 | bits: 1 in range, 2 tip, 4 eraser, 8 and 16 barrel buttons, 32 has pressure, 64 has tilt |
//! | 1 | 0 pen, 1 mouse, 2 finger |
//!
//! Rules: nothing that a page can send panics, allocates without bound or yields a number that is
//! not finite. A pen that left in the middle of a stroke is lifted ([`BrowserPen::leave`]).

use glam::Vec2;

use crate::{Body, DeviceId, Pen, Sample, Tool};

/// Bytes of a record.
pub const RECORD: usize = 20;
/// Most records of a batch. A pen at 1,000 Hz fills half of it in a quarter of a second.
pub const MAX_RECORDS: usize = 512;
/// Height of the virtual tablet, mm; the width follows from the view's aspect.
const HEIGHT_MM: f32 = 200.0;

const IN_RANGE: u8 = 1;
const TIP: u8 = 2;
const ERASER: u8 = 4;
const HAS_PRESSURE: u8 = 32;
const HAS_TILT: u8 = 64;

/// Reason for refusing a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// Not a whole number of records.
    #[error("a batch of {0} bytes: records of {RECORD} bytes are expected")]
    Length(usize),
    /// Too many records.
    #[error("a batch of {0} records: at most {MAX_RECORDS} are taken")]
    Records(usize),
}

/// A pen of a web page.
#[derive(Debug)]
pub struct BrowserPen {
    device: DeviceId,
    clock: PageClock,
    last: Option<Pen>,
}

impl BrowserPen {
    /// Creates a pen with this id that is out of range.
    pub fn new(device: DeviceId) -> BrowserPen {
        BrowserPen { device, clock: PageClock::default(), last: None }
    }

    /// Returns the samples of a batch. `aspect`: width over height of the page's view. `read_us`:
    /// when the batch was read; no sample is later.
    ///
    /// # Errors
    /// [`BatchError`]; then nothing of the batch is taken.
    pub fn take(
        &mut self,
        batch: &[u8],
        aspect: f32,
        read_us: u64,
    ) -> Result<Vec<Sample>, BatchError> {
        let (records, rest) = batch.as_chunks::<RECORD>();
        if !rest.is_empty() {
            return Err(BatchError::Length(batch.len()));
        }
        if records.len() > MAX_RECORDS {
            return Err(BatchError::Records(records.len()));
        }
        // The newest was on its way for the shortest time.
        if let Some(newest) = records.iter().filter_map(|r| page_time(time_of(r))).max() {
            self.clock.learn(newest, read_us);
        }
        Ok(records.iter().map(|r| self.sample(r, aspect, read_us)).collect())
    }

    /// Returns the sample that lifts a pen in range; `None` if it is not.
    pub fn leave(&mut self, now_us: u64) -> Option<Sample> {
        let last = self.last.take()?;
        let pen = Pen {
            in_range: false,
            tip: false,
            buttons: 0,
            pressure: last.pressure.map(|_| 0.0),
            ..last
        };
        Some(self.of(pen, None, now_us))
    }

    /// Returns the time of an event of the page on the clock of the samples.
    pub fn time(&mut self, page_us: f64, read_us: u64) -> u64 {
        if let Some(page_us) = page_time(page_us) {
            self.clock.learn(page_us, read_us);
        }
        self.clock.map(page_time(page_us), read_us)
    }

    fn sample(&mut self, record: &[u8; RECORD], aspect: f32, read_us: u64) -> Sample {
        let two = |at: usize| u16::from_le_bytes([record[at], record[at + 1]]);
        let bits = record[18];
        let share = |at: usize| f32::from(two(at)) / 65_535.0;
        let area = Vec2::new(HEIGHT_MM * aspect.clamp(0.1, 10.0), HEIGHT_MM);
        // A pen touches only where it is in range.
        let in_range = bits & (IN_RANGE | TIP) != 0;
        let tip = bits & TIP != 0;
        let pressure = (bits & HAS_PRESSURE != 0).then(|| if tip { share(12) } else { 0.0 });
        let tilts = bits & HAS_TILT != 0;
        let lean = |at: usize| f32::from((record[at] as i8).clamp(-89, 89)).to_radians();
        let twist = || {
            let degrees = f32::from(two(16) % 360);
            (if degrees >= 180.0 { degrees - 360.0 } else { degrees }).to_radians()
        };
        let tool = match record[19] {
            1 | 2 => Tool::Touch,
            _ if bits & ERASER != 0 => Tool::Eraser,
            _ => Tool::Pen,
        };
        let pen = Pen {
            tool: self.last.filter(|l| l.tip && tip).map_or(tool, |l| l.tool),
            in_range,
            tip,
            pos_mm: Vec2::new(share(8), share(10)) * area,
            area_mm: area,
            raw: [i32::from(two(8)), i32::from(two(10))],
            pressure,
            tilt: tilts.then(|| Vec2::new(lean(14), lean(15))),
            twist: tilts.then(twist),
            distance: None,
            buttons: u32::from(bits >> 3 & 3),
        };
        self.last = in_range.then_some(pen);
        self.of(pen, page_time(time_of(record)), read_us)
    }

    fn of(&mut self, pen: Pen, page_us: Option<u64>, read_us: u64) -> Sample {
        let t_us = self.clock.map(page_us, read_us);
        Sample { device: self.device, t_us, device_t_us: page_us, body: Body::Pen(pen) }
    }
}

/// Beyond this the page's clock is held to have jumped, µs.
const JUMP_US: i64 = 1_000_000;
/// Greatest drift between the two clocks: 200 parts in a million.
const DRIFT_PARTS: i64 = 5_000;

/// The map from the page's clock to ours: the least delay seen is the best estimate of the offset,
/// so the events of a burst keep their times.
#[derive(Debug, Default)]
struct PageClock {
    /// The newest time of the page, and our time minus the page's.
    seen: Option<(i64, i64)>,
    last_us: u64,
}

impl PageClock {
    fn learn(&mut self, page_us: u64, read_us: u64) {
        let page = page_us as i64;
        let apart = read_us as i64 - page;
        let offset = match self.seen {
            Some((_, offset)) if (apart - offset).abs() > JUMP_US => apart,
            Some((at, offset)) => apart.min(offset + (page - at).max(0) / DRIFT_PARTS),
            None => apart,
        };
        let newest = self.seen.map_or(page, |(at, _)| at.max(page));
        self.seen = Some((newest, offset));
    }

    /// Never later than `read_us`, never before the time returned last.
    fn map(&mut self, page_us: Option<u64>, read_us: u64) -> u64 {
        let known = page_us.zip(self.seen);
        let at = known.map_or(read_us as i64, |(page, (_, offset))| page as i64 + offset);
        self.last_us = (at.max(0) as u64).clamp(self.last_us.min(read_us), read_us);
        self.last_us
    }
}

/// The time of a record, µs on the page's clock.
fn time_of(record: &[u8; RECORD]) -> f64 {
    let mut time = [0; 8];
    time.copy_from_slice(&record[..8]);
    f64::from_le_bytes(time)
}

/// A time that a page reports; `None` if it cannot be one.
fn page_time(us: f64) -> Option<u64> {
    (us.is_finite() && (0.0..9e15).contains(&us)).then_some(us as u64)
}

#[cfg(test)]
mod tests;
