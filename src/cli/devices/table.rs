//! The table of `devices watch`: one line a device.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::Arc;

use sculptd_devices::queue::Stats;
use sculptd_devices::{Body, DeviceId, Sample};
use serde::Serialize;

/// A gap longer than this is a pause, not jitter.
const PAUSE_US: u64 = 100_000;

#[derive(Debug)]
pub(super) struct Table {
    stats: Arc<Stats>,
    lines: BTreeMap<DeviceId, DeviceLine>,
}

#[derive(Debug, Default)]
struct DeviceLine {
    samples: u64,
    contacts: u64,
    last: Option<Sample>,
    /// Count, mean and sum of squared deviations of the intervals without pauses, in microseconds
    /// (Welford).
    intervals: (u64, f64, f64),
}

/// One device, in numbers.
#[derive(Debug, Serialize)]
pub(super) struct TickStatistics {
    device: u16,
    kind: &'static str,
    samples: u64,
    contacts: u64,
    rate_hz: f64,
    jitter_ms: f64,
    coalesced: u64,
    lost_motion: u64,
    lost_transitions: u64,
}

#[derive(Debug, Serialize)]
pub(super) struct Summary {
    devices: Vec<TickStatistics>,
}

impl Table {
    pub(super) fn new(stats: Arc<Stats>) -> Self {
        Table { stats, lines: BTreeMap::new() }
    }

    /// Returns true if no device has sent anything.
    pub(super) fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    pub(super) fn take(&mut self, sample: &Sample) {
        let line = self.lines.entry(sample.device).or_default();
        line.samples += 1;
        if let Some(last) = &line.last {
            let gap = sample.t_us.saturating_sub(last.t_us);
            if gap <= PAUSE_US {
                let (n, mean, spread) = &mut line.intervals;
                *n += 1;
                let d = gap as f64 - *mean;
                *mean += d / *n as f64;
                *spread += d * (gap as f64 - *mean);
            }
        }
        let pressed = |s: &Sample| matches!(&s.body, Body::Pen(p) if p.tip);
        line.contacts += u64::from(pressed(sample) && !line.last.as_ref().is_some_and(pressed));
        line.last = Some(*sample);
    }

    pub(super) fn summary(&self) -> Summary {
        Summary {
            devices: self.lines.iter().map(|(id, line)| self.numbers_of(*id, line)).collect(),
        }
    }

    fn numbers_of(&self, id: DeviceId, line: &DeviceLine) -> TickStatistics {
        let (n, mean, spread) = line.intervals;
        let lost = self.stats.of(id);
        TickStatistics {
            device: id.0,
            kind: match line.last.map(|s| s.body) {
                Some(Body::Pen(_)) => "pen",
                Some(Body::Hands(_)) => "hands",
                Some(Body::Pad(_)) => "pad",
                None => "",
            },
            samples: line.samples,
            contacts: line.contacts,
            rate_hz: if mean > 0.0 { 1e6 / mean } else { 0.0 },
            jitter_ms: if n > 1 { (spread / (n - 1) as f64).sqrt() / 1000.0 } else { 0.0 },
            coalesced: lost.coalesced,
            lost_motion: lost.lost_motion,
            lost_transitions: lost.lost_transition,
        }
    }

    /// `clear`: on a terminal, over the last one.
    pub(super) fn draw(&self, out: &mut dyn Write, clear: bool) -> io::Result<()> {
        if clear {
            write!(out, "\x1b[2J\x1b[H")?;
        }
        writeln!(out, "device kind  samples    Hz  jitter  coalesced  lost  now")?;
        for (id, line) in &self.lines {
            let f = self.numbers_of(*id, line);
            let lost = f.lost_motion + f.lost_transitions;
            write!(out, "{:>6} {:5} {:>7} {:>5.0} ", f.device, f.kind, f.samples, f.rate_hz)?;
            write!(out, "{:>4.1} ms  {:>9} {lost:>5}  ", f.jitter_ms, f.coalesced)?;
            match line.last.map(|s| s.body) {
                Some(Body::Pen(p)) if p.in_range => {
                    let tip = if p.tip { "down" } else { "over" };
                    let press =
                        p.pressure.map_or(String::new(), |p| format!(" {:.0} %", p * 100.0));
                    writeln!(
                        out,
                        "{:?} {tip} {:.1}, {:.1} mm{press}",
                        p.tool, p.pos_mm.x, p.pos_mm.y
                    )?;
                }
                Some(Body::Pen(_)) => writeln!(out, "away")?,
                Some(Body::Hands(h)) => writeln!(out, "{} hands", h.count)?,
                Some(Body::Pad(p)) => writeln!(out, "keys {:b}, wheels {:?}", p.keys, p.wheels)?,
                None => writeln!(out)?,
            }
        }
        out.flush()
    }
}
