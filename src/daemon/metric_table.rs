//! The daemon's figures, once: [`crate::metrics`] serves them to Prometheus, and
//! [`crate::telemetry`] sends them to a collector of OpenTelemetry, so that both say the same.

use std::sync::atomic::Ordering::Relaxed;

use crate::present_latency::{CLASSES_US, PresentLatency, STAGES};
use crate::systemd::Watched;
use sculptd_devices::latency::Latency;

/// Kind of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricKind {
    /// Counts from the start of the daemon, and never falls. Its name ends with `_total`.
    Counter,
    /// Goes up and down.
    Gauge,
}

/// One figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metric {
    /// Name in Prometheus, without the program's prefix; it includes any unit other than 1.
    pub name: &'static str,
    /// Kind of the metric.
    pub kind: MetricKind,
    /// Description for people.
    pub help: &'static str,
    /// Current value.
    pub value: f64,
}

/// Histogram of the time from a sample to the screen, at one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageHistogram {
    /// One of [`STAGES`].
    pub stage: &'static str,
    /// Inclusive upper bounds in seconds, each with the number of samples within it.
    pub at_most: Vec<(f64, u64)>,
    /// Sum of all times, in seconds.
    pub sum_s: f64,
    /// Number of samples.
    pub count: u64,
}

/// Name of the histograms in Prometheus, without the program's prefix.
pub const STAGES_NAME: &str = "sample_to_present_seconds";
/// See [`STAGES_NAME`].
pub const STAGES_HELP: &str = "From a sample to the frame that shows it, by stage.";

/// All figures but the histograms.
pub fn all_metrics(watched: &Watched) -> Vec<Metric> {
    let p = watched.published.load();
    let f = &p.figures;
    let counter =
        |name, help, value| Metric { name, kind: MetricKind::Counter, help, value: value as f64 };
    let gauge = |name, help, value: f64| Metric { name, kind: MetricKind::Gauge, help, value };
    let mut all = vec![
        counter("ticks_total", "Ticks stepped.", p.tick),
        counter("overruns_total", "Ticks that came late.", f.overruns),
        counter(
            "garbage_overflows_total",
            "Times that the queue of memory to be freed was full.",
            f.garbage_overflows,
        ),
        counter("samples_total", "Samples of pens and hands.", f.samples),
        counter("dabs_total", "Dabs of brushes.", f.dabs),
        counter("vertices_moved_total", "Vertices moved, each once a dab.", f.vertices_moved),
        counter("motion_lost_total", "Motion samples lost in the channel.", f.losses.motion),
        counter("transitions_lost_total", "Contact changes lost; always 0.", f.losses.transition),
        gauge("tick_seconds_p50", "Median time of a tick.", f.tick_ms.p50 / 1e3),
        gauge("tick_seconds_p99", "99th percentile of a tick's time.", f.tick_ms.p99 / 1e3),
        gauge("tick_seconds_max", "Longest tick.", f.tick_ms.max / 1e3),
        gauge(
            "input_to_snapshot_seconds",
            "Age of the newest input when it was shown.",
            f.input_to_snapshot_ms / 1e3,
        ),
        counter(
            "topology_dropped_total",
            "Places where dynamic topology was given up before it was done.",
            f.topology_dropped,
        ),
        gauge("vertices", "Vertices of the mesh.", p.mesh.vertex_count() as f64),
        gauge("triangles", "Triangles of the mesh.", p.mesh.triangle_count() as f64),
        gauge("undo_steps", "Steps that can be taken back.", p.undo_steps as f64),
    ];
    if let Some(h) = &watched.journal {
        let written = h.written.load(Relaxed) as f64;
        let fault = f64::from(u8::from(h.trouble().is_some()));
        all.extend([
            gauge("journal_tick", "Last tick that is on the disk.", written),
            counter(
                "journal_lost_ticks_total",
                "Ticks not in the session file.",
                h.lost.load(Relaxed),
            ),
            gauge("journal_fault", "1 while the session file takes nothing.", fault),
        ]);
    }
    all
}

/// The histogram of each stage between a sample and the screen.
pub fn stages(latency: &PresentLatency) -> Vec<StageHistogram> {
    let of = |(stage, counts): (&&'static str, &Latency)| {
        let at_most = |us: u64| (us as f64 / 1e6, counts.at_most(us));
        StageHistogram {
            stage,
            at_most: CLASSES_US.into_iter().map(at_most).collect(),
            sum_s: counts.sum_us() as f64 / 1e6,
            count: latency.frames(),
        }
    };
    STAGES.iter().zip(latency.stages()).map(of).collect()
}
