//! The daemon's figures for Prometheus (text format 0.0.4) over HTTP, off unless asked for.
//!
//! A web page must not read them: a request with an `Origin`, or with a `Host` that is a name other
//! than `localhost` (a page that had its own name pointed here), is refused. What is asked for in
//! `Host` must be an address, with our port.

use std::fmt::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use hyper::{Request, StatusCode};

use crate::http::answer::permitted;
use crate::http::bounds::ConnectionTable;
use crate::http::{Answer, HttpServer};
use crate::present_latency::{CLASSES_US, PresentLatency, STAGES};
use crate::systemd::Watched;

/// The page, from what is watched, and how many connections ask for it.
pub fn page(watched: &Watched, connections: usize) -> String {
    let p = watched.published.load();
    let journal = watched.journal.as_ref();
    let f = &p.figures;
    let mut out = String::with_capacity(2048);
    let mut put = |name: &str, kind: &str, help: &str, value: f64| {
        let _ = write!(
            out,
            "# HELP sculptd_{name} {help}\n# TYPE sculptd_{name} {kind}\nsculptd_{name} {value}\n"
        );
    };
    put("ticks_total", "counter", "Ticks stepped.", p.tick as f64);
    put("overruns_total", "counter", "Ticks that came late.", f.overruns as f64);
    let text = "Times that the queue of memory to be freed was full.";
    put("garbage_overflows_total", "counter", text, f.garbage_overflows as f64);
    put("samples_total", "counter", "Samples of pens and hands.", f.samples as f64);
    put("dabs_total", "counter", "Dabs of brushes.", f.dabs as f64);
    put(
        "vertices_moved_total",
        "counter",
        "Vertices moved, each once a dab.",
        f.vertices_moved as f64,
    );
    put(
        "motion_lost_total",
        "counter",
        "Motion samples lost in the channel.",
        f.losses.motion as f64,
    );
    put(
        "transitions_lost_total",
        "counter",
        "Contact changes lost; always 0.",
        f.losses.transition as f64,
    );
    put("tick_seconds_p50", "gauge", "Median time of a tick.", f.tick_ms.p50 / 1e3);
    put("tick_seconds_p99", "gauge", "99th percentile of a tick's time.", f.tick_ms.p99 / 1e3);
    put("tick_seconds_max", "gauge", "Longest tick.", f.tick_ms.max / 1e3);
    put(
        "input_to_snapshot_seconds",
        "gauge",
        "Age of the newest input when it was shown.",
        f.input_to_snapshot_ms / 1e3,
    );
    let text = "Places where dynamic topology was given up before it was done.";
    put("topology_dropped_total", "counter", text, f.topology_dropped as f64);
    put("vertices", "gauge", "Vertices of the mesh.", p.mesh.vertex_count() as f64);
    put("triangles", "gauge", "Triangles of the mesh.", p.mesh.triangle_count() as f64);
    put("undo_steps", "gauge", "Steps that can be taken back.", p.undo_steps as f64);
    let text = "Connections to this page, this one counted in; at most 256.";
    put("metrics_connections", "gauge", text, connections as f64);
    if let Some(h) = journal {
        put(
            "journal_tick",
            "gauge",
            "Last tick that is on the disk.",
            h.written.load(Ordering::Relaxed) as f64,
        );
        put(
            "journal_lost_ticks_total",
            "counter",
            "Ticks not in the session file.",
            h.lost.load(Ordering::Relaxed) as f64,
        );
        put(
            "journal_fault",
            "gauge",
            "1 while the session file takes nothing.",
            f64::from(u8::from(h.trouble().is_some())),
        );
    }
    presented(&watched.window.present_latency(), &mut out);
    out
}

/// The histogram of each stage between a sample and the screen.
fn presented(latency: &PresentLatency, out: &mut String) {
    const NAME: &str = "sculptd_sample_to_present_seconds";
    let _ = write!(
        out,
        "# HELP {NAME} From a sample to the frame that shows it, by stage.\n\
         # TYPE {NAME} histogram\n"
    );
    for (stage, counts) in STAGES.iter().zip(latency.stages()) {
        for us in CLASSES_US {
            let (le, count) = (us as f64 / 1e6, counts.at_most(us));
            let _ = writeln!(out, "{NAME}_bucket{{stage=\"{stage}\",le=\"{le}\"}} {count}");
        }
        let (sum, all) = (counts.sum_us() as f64 / 1e6, latency.frames());
        let _ = write!(
            out,
            "{NAME}_bucket{{stage=\"{stage}\",le=\"+Inf\"}} {all}\n\
             {NAME}_sum{{stage=\"{stage}\"}} {sum}\n{NAME}_count{{stage=\"{stage}\"}} {all}\n"
        );
    }
}

/// Where to listen: `PORT` or `ADDRESS:PORT`; a port alone is on the loopback.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let text = text.trim();
    if let Ok(port) = text.trim_start_matches(':').parse::<u16>() {
        return Ok(SocketAddr::from(([127, 0, 0, 1], port)));
    }
    text.parse().map_err(|_| format!("expected PORT or ADDRESS:PORT, found '{text}'"))
}

/// A listening page; closed when dropped.
#[derive(Debug)]
pub struct Metrics(HttpServer);

impl Metrics {
    /// Listens.
    ///
    /// # Errors
    /// What the system says of the address.
    pub fn start(at: SocketAddr, watched: Watched) -> std::io::Result<Self> {
        let answer = |at, table: Arc<ConnectionTable>| {
            move |request: &Request<()>| answer(request, at, &watched, table.count())
        };
        HttpServer::start(at, "sculptd-metrics", answer).map(Metrics)
    }

    /// Where it listens; the port that was found free, if 0 was asked for.
    pub fn address(&self) -> SocketAddr {
        self.0.address()
    }
}

fn answer(request: &Request<()>, at: SocketAddr, watched: &Watched, connections: usize) -> Answer {
    match permitted(request, at, "") {
        Ok("/metrics") => {
            Answer::text("text/plain; version=0.0.4; charset=utf-8", page(watched, connections))
        }
        Ok(_) => Answer::from((StatusCode::NOT_FOUND, "the figures are at /metrics")),
        Err(refusal) => refusal.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_is_a_histogram_that_grows_to_its_count() {
        let mut latency = PresentLatency::default();
        for us in [100, 5_000, 900_000] {
            latency.record(&crate::present_latency::PresentedFrame {
                presented_us: us,
                ..Default::default()
            });
        }
        let mut page = String::new();
        presented(&latency, &mut page);
        let of = |text: &str| {
            let line = page.lines().find_map(|l| l.strip_prefix(text)).expect(text);
            line.trim().parse::<f64>().expect("a number")
        };
        let total = "sculptd_sample_to_present_seconds_";
        let bucket = |le: &str| of(&format!("{total}bucket{{stage=\"total\",le=\"{le}\"}}"));
        assert_eq!([bucket("0.000255"), bucket("0.008191"), bucket("+Inf")], [1.0, 2.0, 3.0]);
        assert_eq!(of(&format!("{total}count{{stage=\"total\"}}")), 3.0);
        assert!((of(&format!("{total}sum{{stage=\"total\"}}")) - 0.9051).abs() < 1e-9);
    }

    #[test]
    fn a_port_alone_is_on_the_loopback() {
        assert_eq!(address("9000"), Ok(SocketAddr::from(([127, 0, 0, 1], 9000))));
        assert_eq!(address("0.0.0.0:1"), Ok(SocketAddr::from(([0, 0, 0, 0], 1))));
        assert!(address("example.org:1").is_err());
    }
}
