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
    /// As [`StepReport::topology_dropped`], summed.
    pub topology_dropped: u64,
    tick_ns: Histogram<u64>,
    /// Processor time of the tick thread alone.
    tick_cpu_ns: Histogram<u64>,
    /// From the time of each sample to the end of the tick that it was part of; of live input only.
    sample_ns: Histogram<u64>,
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
    /// As `tick_ms`, in processor time of the tick thread: what a busy machine does not lengthen.
    /// All 0 where the system cannot tell.
    pub tick_cpu_ms: Percentiles,
    pub overruns: u64,
    /// Balls in which dynamic topology was still to be done and was given up.
    pub topology_dropped: u64,
    pub vertices: u64,
    pub triangles: u64,
    /// Of the world's clay at the end, 16 hexadecimal digits.
    pub hash: String,
    /// Path of the exported mesh, if one was written.
    pub export: Option<String>,
    /// Time from device samples to the end of their tick; absent in a simulated run, which has no
    /// clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_to_tick_ms: Option<Percentiles>,
    /// Time from samples to the screen, if there was a window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_to_present: Option<PresentSummary>,
}

impl Default for TickStatistics {
    fn default() -> Self {
        TickStatistics {
            ticks: 0,
            samples: 0,
            dabs: 0,
            vertices_moved: 0,
            overruns: 0,
            topology_dropped: 0,
            tick_ns: histogram(),
            tick_cpu_ns: histogram(),
            sample_ns: histogram(),
        }
    }
}

fn histogram() -> Histogram<u64> {
    // Bounds within what the histogram allows; three digits are 0.1 %.
    Histogram::new_with_bounds(1, LONGEST_NS, 3).unwrap_or_else(|_| {
        // Unreachable with these constants; an auto-resizing histogram serves as well.
        #[allow(clippy::unwrap_used)]
        Histogram::new(3).unwrap()
    })
}

/// Processor time that the calling thread has used, nanoseconds; 0 where the system cannot tell.
pub fn thread_cpu_ns() -> u64 {
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    {
        use rustix::time::{ClockId, clock_gettime};
        let now = clock_gettime(ClockId::ThreadCPUTime);
        now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
    }
    #[cfg(not(any(target_os = "linux", target_os = "macos")))]
    0
}

fn percentiles_ms(of: &Histogram<u64>) -> Percentiles {
    let ms = |ns: u64| ns as f64 / 1e6;
    Percentiles {
        p50: ms(of.value_at_quantile(0.5)),
        p99: ms(of.value_at_quantile(0.99)),
        max: ms(of.max()),
    }
}

impl TickStatistics {
    /// `took_ns`: on the wall's clock; `cpu_ns`: of the tick thread's processor time.
    pub fn tick(&mut self, report: &StepReport, took_ns: u64, cpu_ns: u64) {
        self.ticks += 1;
        self.samples += report.samples;
        self.dabs += report.dabs;
        self.vertices_moved += report.vertices_moved;
        self.topology_dropped += report.topology_dropped;
        self.tick_ns.saturating_record(took_ns.clamp(1, LONGEST_NS));
        self.tick_cpu_ns.saturating_record(cpu_ns.min(LONGEST_NS));
    }

    /// A sample was part of a tick that ended so long after its time, microseconds.
    pub fn sample(&mut self, took_us: u64) {
        self.sample_ns.saturating_record((took_us.saturating_mul(1000)).clamp(1, LONGEST_NS));
    }

    /// From a sample's time to the end of its tick; `None` without live input.
    pub fn sample_to_tick_ms(&self) -> Option<Percentiles> {
        (!self.sample_ns.is_empty()).then(|| percentiles_ms(&self.sample_ns))
    }

    pub fn tick_ms(&self) -> Percentiles {
        percentiles_ms(&self.tick_ns)
    }

    /// As [`TickStatistics::tick_ms`], in the tick thread's processor time.
    pub fn tick_cpu_ms(&self) -> Percentiles {
        percentiles_ms(&self.tick_cpu_ns)
    }
}
