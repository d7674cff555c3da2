//! The daemon's figures for Prometheus (text format 0.0.4) over HTTP, off unless asked for.
//!
//! A web page must not read them. A request with an `Origin` is refused, and so is a `Host` with a
//! name other than `localhost`, which a page could have pointed here. An address in `Host` must
//! have our port.

use std::fmt::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;

use hyper::{Request, StatusCode};

use crate::http::answer::permitted;
use crate::http::bounds::ConnectionTable;
use crate::http::{Answer, HttpServer};
use crate::metric_table::{
    Metric, MetricKind, STAGES_HELP, STAGES_NAME, StageHistogram, all_metrics, stages,
};
use crate::systemd::Watched;

/// The page, from what is watched, and how many connections ask for it.
pub fn page(watched: &Watched, connections: usize) -> String {
    let mut out = String::with_capacity(2048);
    let text = "Connections to this page, this one counted in; at most 256.";
    let (name, kind) = ("metrics_connections", MetricKind::Gauge);
    let own = Metric { name, kind, help: text, value: connections as f64 };
    for Metric { name, kind, help, value } in all_metrics(watched).into_iter().chain([own]) {
        let kind = match kind {
            MetricKind::Counter => "counter",
            MetricKind::Gauge => "gauge",
        };
        let _ = write!(
            out,
            "# HELP sculptd_{name} {help}\n# TYPE sculptd_{name} {kind}\nsculptd_{name} {value}\n"
        );
    }
    presented(&stages(&watched.window.present_latency()), &mut out);
    out
}

/// The histogram of each stage between a sample and the screen.
fn presented(stages: &[StageHistogram], out: &mut String) {
    let name = format!("sculptd_{STAGES_NAME}");
    let _ = write!(out, "# HELP {name} {STAGES_HELP}\n# TYPE {name} histogram\n");
    for StageHistogram { stage, at_most, sum_s, count } in stages {
        for (le, upto) in at_most {
            let _ = writeln!(out, "{name}_bucket{{stage=\"{stage}\",le=\"{le}\"}} {upto}");
        }
        let _ = write!(
            out,
            "{name}_bucket{{stage=\"{stage}\",le=\"+Inf\"}} {count}\n\
             {name}_sum{{stage=\"{stage}\"}} {sum_s}\n{name}_count{{stage=\"{stage}\"}} {count}\n"
        );
    }
}

/// Parses a listening address: `PORT` or `ADDRESS:PORT`. A port alone means the loopback.
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
    /// Returns the system's error for the address.
    pub fn start(at: SocketAddr, watched: Watched) -> std::io::Result<Self> {
        let answer = |at, table: Arc<ConnectionTable>| {
            move |request: &Request<()>| answer(request, at, &watched, table.count())
        };
        HttpServer::start(at, "sculptd-metrics", answer).map(Metrics)
    }

    /// Returns the listening address, with the port that the system chose if 0 was requested.
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
    use crate::present_latency::{PresentLatency, PresentedFrame};

    #[test]
    fn each_stage_is_a_histogram_that_grows_to_its_count() {
        let mut latency = PresentLatency::default();
        for presented_us in [100, 5_000, 900_000] {
            latency.record(&PresentedFrame { presented_us, ..PresentedFrame::default() });
        }
        let mut page = String::new();
        presented(&stages(&latency), &mut page);
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
