//! What the loop counts and times, and the summary that `run` and `demo` print.

use hdrhistogram::Histogram;
use serde::Serialize;

use crate::present_latency::PresentSummary;
use sculptd_engine::world::StepReport;

/// Longest tick that the histogram tells apart: 10 s, in nanoseconds.
const LONGEST_NS: u64 = 10_000_000_000;

/// Figures of a loop, filled without allocating.
#[derive(Debug)]
pub struct TickStatistics {
    pub ticks: u64,
    pub samples: u64,
    pub dabs: u64,
    pub vertices_moved: u64,
    pub overruns: u64,
    tick_ns: Histogram<u64>,
}

/// Milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Percentiles {
    pub p50: f64,
    pub p99: f64,
    pub max: f64,
}

/// Losses over all devices. `transition` is always 0, or the channel's law is broken.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Losses {
    pub motion: u64,
    pub transition: u64,
}

/// What `run` and `demo` print with `--json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Summary {
    pub ticks: u64,
    pub samples: u64,
    pub samples_sent: u64,
    pub samples_coalesced: u64,
    pub dabs: u64,
    pub vertices_moved: u64,
    pub losses: Losses,
    pub tick_ms: Percentiles,
    pub overruns: u64,
    pub vertices: u64,
    pub triangles: u64,
    /// Of the world's clay at the end, 16 hexadecimal digits.
    pub hash: String,
    /// Where the mesh was written, if it was.
    pub export: Option<String>,
    /// How long samples took to the screen, where there was a window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_to_present: Option<PresentSummary>,
}

impl Default for TickStatistics {
    fn default() -> Self {
        // Bounds within what the histogram allows; three digits are 0.1 %.
        let tick_ns = Histogram::new_with_bounds(1, LONGEST_NS, 3).unwrap_or_else(|_| {
            // Unreachable with these constants; an auto-resizing histogram serves as well.
            #[allow(clippy::unwrap_used)]
            Histogram::new(3).unwrap()
        });
        TickStatistics { ticks: 0, samples: 0, dabs: 0, vertices_moved: 0, overruns: 0, tick_ns }
    }
}

impl TickStatistics {
    pub fn tick(&mut self, report: &StepReport, took_ns: u64) {
        self.ticks += 1;
        self.samples += report.samples;
        self.dabs += report.dabs;
        self.vertices_moved += report.vertices_moved;
        self.tick_ns.saturating_record(took_ns.clamp(1, LONGEST_NS));
    }

    pub fn tick_ms(&self) -> Percentiles {
        let ms = |ns: u64| ns as f64 / 1e6;
        Percentiles {
            p50: ms(self.tick_ns.value_at_quantile(0.5)),
            p99: ms(self.tick_ns.value_at_quantile(0.99)),
            max: ms(self.tick_ns.max()),
        }
    }
}
