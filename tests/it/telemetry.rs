//! Telemetry, as a collector of OpenTelemetry meets it: one that is well, and some that are not.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};

use serde_json::Value;

use crate::hostile::{Daemon, memory_kib};
use crate::waiting::{PATIENCE, until};
use sculptd_daemon::telemetry::otlp::name_and_unit;

/// Behaviour of a collector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Manner {
    Well,
    /// Closes in the middle of a request.
    Closes,
    /// Answers with this status.
    Answers(u16),
    /// Takes figures, and no logs.
    NoLogs,
    /// Never answers.
    Silent,
    /// Answers well, and at a length that nobody reads.
    Endless,
}

/// A collector: the requests that it took, by path.
struct Collector {
    at: SocketAddr,
    manner: Arc<Mutex<Manner>>,
    taken: crossbeam_channel::Receiver<(String, Value)>,
    /// Connections of any kind.
    met: Arc<Mutex<usize>>,
}

impl Collector {
    fn start(manner: Manner) -> Collector {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let at = listener.local_addr().expect("bound");
        let (tell, taken) = crossbeam_channel::unbounded();
        let (manner, met) = (Arc::new(Mutex::new(manner)), Arc::new(Mutex::new(0)));
        let collector = Collector { at, manner: manner.clone(), taken, met: met.clone() };
        std::thread::spawn(move || {
            let mut silent = Vec::new();
            for stream in listener.incoming().map_while(Result::ok) {
                *met.lock().expect("no panic") += 1;
                let manner = *manner.lock().expect("no panic");
                match manner {
                    Manner::Closes => drop(stream),
                    Manner::Silent => silent.push(stream),
                    _ => answer(stream, manner, &tell),
                }
            }
        });
        collector
    }

    fn behaves(&self, manner: Manner) {
        *self.manner.lock().expect("no panic") = manner;
        *self.met.lock().expect("no panic") = 0;
    }

    fn met(&self) -> usize {
        *self.met.lock().expect("no panic")
    }

    fn next(&self, path: &str) -> Value {
        loop {
            let (of, body) = self.taken.recv_timeout(PATIENCE).expect("a request comes");
            if of == path {
                return body;
            }
        }
    }
}

fn answer(stream: TcpStream, manner: Manner, tell: &crossbeam_channel::Sender<(String, Value)>) {
    let mut reader = BufReader::new(stream.try_clone().expect("cloned"));
    let (mut head, mut length, mut json, mut secret) = (String::new(), 0, false, false);
    reader.read_line(&mut head).expect("a request");
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).expect("a header");
        let (name, value) = line.split_once(':').unwrap_or_default();
        match (name.to_ascii_lowercase().as_str(), value.trim()) {
            ("content-length", n) => length = n.parse().expect("a number"),
            ("content-type", kind) => json = kind == "application/json",
            ("x-key", value) => secret = value == "clay & key",
            ("", _) => break,
            _ => {}
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).expect("all of it");
    assert!(json && secret, "{head}");
    let mut stream = stream;
    let status = match manner {
        Manner::Answers(status) => status,
        Manner::NoLogs if head.contains("/v1/logs") => 404,
        _ => 200,
    };
    let _ = write!(stream, "HTTP/1.1 {status} So\r\n");
    if manner == Manner::Endless {
        let _ = stream.write_all(b"Transfer-Encoding: chunked\r\n\r\n");
        while stream.write_all(b"8\r\nendless \r\n").is_ok() {}
    } else {
        let _ = stream.write_all(b"Content-Length: 2\r\n\r\n{}");
    }
    if status != 503 && status != 500 {
        let path = head.split(' ').nth(1).expect("a path").to_owned();
        let _ = tell.send((path, serde_json::from_slice(&body).expect("JSON")));
    }
}

const VARS: [(&str, &str); 3] = [
    ("OTEL_METRIC_EXPORT_INTERVAL", "100"),
    ("OTEL_EXPORTER_OTLP_HEADERS", "x-key=clay%20%26%20key"),
    ("OTEL_RESOURCE_ATTRIBUTES", "service.instance.id=hall-3"),
];

fn daemon(collector: &Collector) -> Daemon {
    let url = format!("http://{}/in", collector.at);
    let arguments = ["run", "--headless", "--metrics", "0", "--telemetry", &url];
    Daemon::start_in(&arguments, "", &VARS)
}

/// The page for Prometheus: each figure that has no labels.
fn page(at: SocketAddr) -> BTreeMap<String, f64> {
    let mut stream = TcpStream::connect(at).expect("listens");
    let head = format!("GET /metrics HTTP/1.1\r\nHost: {at}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).expect("sent");
    let mut text = String::new();
    let _ = stream.read_to_string(&mut text);
    let figure = |line: &str| {
        let (name, value) = line.strip_prefix("sculptd_")?.split_once(' ')?;
        (!name.contains('{')).then_some((name.to_owned(), value.parse().ok()?))
    };
    text.lines().filter_map(figure).collect()
}

fn points(body: &Value) -> BTreeMap<String, f64> {
    let metrics = &body["resourceMetrics"][0]["scopeMetrics"][0]["metrics"];
    let of = |m: &Value| {
        let name = m["name"].as_str().expect("a name").to_owned();
        let sum = m["sum"]["dataPoints"][0]["asInt"].as_str().and_then(|t| t.parse().ok());
        let value = sum.or(m["gauge"]["dataPoints"][0]["asDouble"].as_f64());
        Some((name, value?))
    };
    metrics.as_array().expect("metrics").iter().filter_map(of).collect()
}

#[test]
fn a_collector_gets_the_figures_of_the_page_for_prometheus() {
    let collector = Collector::start(Manner::Well);
    let mut daemon = daemon(&collector);
    // None is left from before the first page.
    let before = page(daemon.figures_at());
    collector.taken.try_iter().for_each(drop);
    let body = collector.next("/in/v1/metrics");
    let after = page(daemon.figures_at());
    let sent = points(&body);
    let mut expected: Vec<String> = before
        .keys()
        .filter(|name| *name != "metrics_connections")
        .map(|name| name_and_unit(name).0)
        .collect();
    expected.sort();
    assert_eq!(sent.keys().cloned().collect::<Vec<_>>(), expected);
    let ticks = sent["sculptd.ticks"];
    for name in ["ticks_total", "vertices", "samples_total", "undo_steps"] {
        let (low, value, high) = (before[name], sent[&name_and_unit(name).0], after[name]);
        assert!((low..=high).contains(&value), "{name}: {low}, {value}, {high}");
    }
    // An idle loop ticks once a second.
    let counts_on = |_| points(&collector.next("/in/v1/metrics"))["sculptd.ticks"] > ticks;
    assert!((0..100).any(counts_on), "it counts on");
    let histogram = &body["resourceMetrics"][0]["scopeMetrics"][0]["metrics"];
    let stages = histogram.as_array().and_then(|all| all.last()).expect("the histogram");
    assert_eq!(stages["histogram"]["dataPoints"].as_array().map(Vec::len), Some(5));
    let attributes = body["resourceMetrics"][0]["resource"]["attributes"].to_string();
    for text in ["sculptd", "hall-3", "service.version", "host.name"] {
        assert!(attributes.contains(text), "{text}: {attributes}");
    }
    // The last figures come at the end.
    collector.taken.try_iter().for_each(drop);
    assert!(daemon.end() < 30.0);
    assert!(points(&collector.next("/in/v1/metrics"))["sculptd.ticks"] > 0.0);
}

#[test]
fn a_collector_that_is_away_is_told_of_once_and_catches_up() {
    let collector = Collector::start(Manner::Closes);
    let mut daemon = daemon(&collector);
    until("it has failed some times", || collector.met() >= 5);
    let memory = memory_kib(daemon.id());
    for manner in [Manner::Answers(503), Manner::Answers(500), Manner::Closes] {
        collector.behaves(manner);
        until("it has failed some times", || collector.met() >= 5);
    }
    collector.behaves(Manner::Well);
    let mut told = Vec::new();
    until("the log of the time before comes", || {
        if let Ok((path, body)) = collector.taken.try_recv()
            && path == "/in/v1/logs"
        {
            let records = &body["resourceLogs"][0]["scopeLogs"][0]["logRecords"];
            for record in records.as_array().expect("records") {
                let text = record["body"]["stringValue"].as_str().expect("a text").to_owned();
                told.push((record["severityText"].as_str().expect("one").to_owned(), text));
            }
        }
        told.iter().any(|(_, text)| text.contains("takes telemetry again"))
    });
    let failed: Vec<_> = told.iter().filter(|t| t.1.contains("no telemetry goes to")).collect();
    assert_eq!(failed.len(), 1, "{told:?}");
    assert_eq!(failed[0].0, "WARN");
    let grown = memory_kib(daemon.id()).saturating_sub(memory);
    assert!(grown < 8 << 10, "{grown} KiB for a collector that was away");
    assert!(daemon.end() < 30.0);
}

#[test]
fn a_collector_that_takes_no_logs_makes_none() {
    let collector = Collector::start(Manner::Answers(503));
    let daemon = daemon(&collector);
    until("it has failed some times", || collector.met() >= 3);
    collector.behaves(Manner::NoLogs);
    let (mut exports, mut lines) = (0, 0);
    while exports < 20 {
        match collector.taken.recv_timeout(PATIENCE).expect("a request comes") {
            (path, _) if path == "/in/v1/metrics" => exports += 1,
            (_, body) => {
                let records = &body["resourceLogs"][0]["scopeLogs"][0]["logRecords"];
                lines += records.as_array().map_or(0, Vec::len);
            }
        }
    }
    // That none went, that figures go again, and that logs do not.
    assert!(lines <= 3, "{lines} lines in {exports} exports");
    drop(daemon);
}

#[test]
fn a_collector_that_never_answers_or_never_ends_holds_up_nothing() {
    for manner in [Manner::Silent, Manner::Endless] {
        let collector = Collector::start(manner);
        let mut daemon = daemon(&collector);
        until("it was met", || collector.met() >= 1);
        let ticks = page(daemon.figures_at())["ticks_total"];
        until("the loop ticks", || page(daemon.figures_at())["ticks_total"] > ticks);
        assert!(daemon.end() < 30.0, "{manner:?}");
    }
}

#[test]
fn what_is_no_collector_is_refused_before_anything_begins() {
    let ran = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .args(["run", "--headless", "--telemetry", "https://collector.example"])
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(2), "{said}");
    assert!(said.contains("expected http://HOST:PORT"), "{said}");
}
