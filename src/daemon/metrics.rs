//! The daemon's figures for Prometheus (text format 0.0.4) over the least HTTP there is, off unless
//! asked for.
//!
//! A web page must not read them: a request with an `Origin`, or with a `Host` that is a name other
//! than `localhost` (a page that had its own name pointed here), is refused. What is asked for in
//! `Host` must be an address, with our port.

use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::Published;
use crate::systemd::Watched;
use sculptd_devices::Clock;

/// Longest request head, bytes.
const MAX_HEAD: usize = 4096;
/// Longest time that one client may take.
pub(super) const PATIENCE: Duration = Duration::from_secs(2);

/// The page, from what the loop published and how the journal stands.
pub fn page(p: &Published, journal: Option<&super::session::Health>) -> String {
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
    put("vertices", "gauge", "Vertices of the work.", p.mesh.vertex_count() as f64);
    put("triangles", "gauge", "Triangles of the work.", p.mesh.triangle_count() as f64);
    put("undo_steps", "gauge", "Steps that can be taken back.", p.undo_steps as f64);
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
    out
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
pub struct Metrics {
    at: SocketAddr,
    closing: Arc<AtomicBool>,
}

impl Metrics {
    pub fn start(at: SocketAddr, watched: Watched) -> std::io::Result<Self> {
        let listener = TcpListener::bind(at)?;
        let at = listener.local_addr()?;
        let closing = Arc::new(AtomicBool::new(false));
        let closed = closing.clone();
        std::thread::Builder::new().name("sculptd-metrics".into()).spawn(move || {
            for stream in listener.incoming() {
                if closed.load(Ordering::SeqCst) {
                    return;
                }
                // One after the other: whoever reads figures can wait for another who does.
                if let Ok(stream) = stream {
                    let _ = serve(stream, at, &watched);
                }
            }
        })?;
        Ok(Metrics { at, closing })
    }

    /// Where it listens; the port that was found free, if 0 was asked for.
    pub fn address(&self) -> SocketAddr {
        self.at
    }
}

impl Drop for Metrics {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::SeqCst);
        // Wakes the accepting thread. An unspecified address is reached by the loopback.
        let ip =
            if self.at.ip().is_unspecified() { IpAddr::from([127, 0, 0, 1]) } else { self.at.ip() };
        let _ = TcpStream::connect_timeout(&(ip, self.at.port()).into(), PATIENCE);
    }
}

/// The head of a request; `None` where nobody says anything in time.
pub(super) fn read_head(stream: &mut TcpStream) -> std::io::Result<Option<Vec<u8>>> {
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut head = Vec::new();
    let mut part = [0; 512];
    while !head.windows(4).any(|w| w == b"\r\n\r\n") && head.len() <= MAX_HEAD {
        let n = stream.read(&mut part)?;
        // Also one that sends a byte a second.
        if n == 0 || clock.now_us() - begun > PATIENCE.as_micros() as u64 {
            return Ok(None);
        }
        head.extend_from_slice(&part[..n]);
    }
    Ok(Some(head))
}

fn serve(mut stream: TcpStream, at: SocketAddr, watched: &Watched) -> std::io::Result<()> {
    let Some(head) = read_head(&mut stream)? else { return Ok(()) };
    let (status, body) = match judge(&head, at) {
        Ok(()) => ("200 OK", page(&watched.published.load(), watched.journal.as_ref())),
        Err((status, why)) => (status, format!("{why}\n")),
    };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4; \
            charset=utf-8\r\nContent-Length: {}\r\nX-Content-Type-Options: nosniff\r\nConnection: \
            close\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body.as_bytes())
}

type Refusal = (&'static str, &'static str);

/// Whether a request may have the page.
fn judge(head: &[u8], at: SocketAddr) -> Result<(), Refusal> {
    match request(head, at, "")? {
        "/metrics" => Ok(()),
        _ => Err(("404 Not Found", "the figures are at /metrics")),
    }
}

/// The path of a request that may have an answer: a GET of our own host, not by a web page. `name`:
/// one more name of ours.
pub(super) fn request<'a>(head: &'a [u8], at: SocketAddr, name: &str) -> Result<&'a str, Refusal> {
    const BAD: Refusal = ("400 Bad Request", "not a request");
    if head.len() > MAX_HEAD {
        return Err(("431 Request Header Fields Too Large", "too long"));
    }
    let text = std::str::from_utf8(head).map_err(|_| BAD)?;
    let mut lines = text.split("\r\n");
    let mut first = lines.next().unwrap_or("").split(' ');
    let (method, path, version) = (first.next(), first.next(), first.next());
    if !version.is_some_and(|v| v.starts_with("HTTP/1.")) || first.next().is_some() {
        return Err(BAD);
    }
    let (mut hosts, mut origin) = (Vec::new(), false);
    for line in lines.take_while(|l| !l.is_empty()) {
        let (name, value) = line.split_once(':').ok_or(BAD)?;
        match name.to_ascii_lowercase().as_str() {
            "host" => hosts.push(value.trim()),
            "origin" => origin = true,
            _ => {}
        }
    }
    if origin {
        return Err(("403 Forbidden", "no web page may read this"));
    }
    match hosts[..] {
        [host] if ours(host, at) || named(host, at, name) => {}
        [_] => return Err(("403 Forbidden", "another host was asked for")),
        _ => return Err(BAD),
    }
    if method != Some("GET") {
        return Err(("405 Method Not Allowed", "GET only"));
    }
    path.filter(|p| p.starts_with('/')).ok_or(BAD)
}

/// The name that the settings give us, with our port.
fn named(host: &str, at: SocketAddr, name: &str) -> bool {
    !name.is_empty()
        && host.rsplit_once(':').is_some_and(|(n, port)| {
            n.trim_matches(['[', ']']).eq_ignore_ascii_case(name) && port.parse() == Ok(at.port())
        })
}

/// An address that can be ours, or `localhost`, with our port: a name that somebody else gives out
/// is not.
fn ours(host: &str, at: SocketAddr) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
        _ => (host, Some(80)),
    };
    if port != Some(at.port()) {
        return false;
    }
    if name.eq_ignore_ascii_case("localhost") {
        return true;
    }
    let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']')).unwrap_or(name);
    bare.parse::<IpAddr>().is_ok_and(|ip| at.ip().is_unspecified() || ip == at.ip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_own_host_and_no_origin() {
        let at: SocketAddr = "127.0.0.1:9000".parse().expect("an address");
        let ask = |rest: &str| {
            judge(format!("GET /metrics HTTP/1.1\r\n{rest}\r\n\r\n").as_bytes(), at)
                .err()
                .map(|e| &e.0[..3])
        };
        assert_eq!(ask("Host: 127.0.0.1:9000"), None);
        assert_eq!(ask("host: LOCALHOST:9000"), None);
        for foreign in [
            "evil.example:9000",
            "127.0.0.1",
            "127.0.0.1:80",
            "localhost.evil.example:9000",
            "10.0.0.1:9000",
            "[::1]:9000",
            "",
        ] {
            assert_eq!(ask(&format!("Host: {foreign}")), Some("403"), "{foreign}");
        }
        assert_eq!(ask("Host: 127.0.0.1:9000\r\nOrigin: http://127.0.0.1:9000"), Some("403"));
        assert_eq!(ask("Host: 127.0.0.1:9000\r\nHost: evil.example"), Some("400"));
        assert_eq!(ask("Accept: */*"), Some("400"));
        assert_eq!(
            judge(b"POST /metrics HTTP/1.1\r\nHost: localhost:9000\r\n\r\n", at)
                .err()
                .map(|e| &e.0[..3]),
            Some("405")
        );
        assert_eq!(
            judge(b"GET / HTTP/1.1\r\nHost: localhost:9000\r\n\r\n", at).err().map(|e| &e.0[..3]),
            Some("404")
        );
        assert_eq!(judge(&vec![b'x'; MAX_HEAD + 1], at).err().map(|e| &e.0[..3]), Some("431"));
        let v6: SocketAddr = "[::]:9000".parse().expect("an address");
        assert!(ours("[fe80::1]:9000", v6) && !ours("evil.example:9000", v6));
    }

    #[test]
    fn a_port_alone_is_on_the_loopback() {
        assert_eq!(address("9000"), Ok(SocketAddr::from(([127, 0, 0, 1], 9000))));
        assert_eq!(address("0.0.0.0:1"), Ok(SocketAddr::from(([0, 0, 0, 0], 1))));
        assert!(address("example.org:1").is_err());
    }
}
