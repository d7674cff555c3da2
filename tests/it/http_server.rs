//! The HTTP server behind metrics and downloads, as a hostile network meets it.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::time::Duration;

use sculptd_daemon::http::bounds::{CONNECTIONS, HEAD_BYTES, HEAD_TIME};
use sculptd_daemon::kiosk::share::{Share, ShareTexts};
use sculptd_devices::Clock;

use crate::hostile::{Daemon, descriptors, memory_kib, more_descriptors};
use crate::waiting::{PATIENCE, until};

/// A share of one file of this many bytes: its address, the file's path on it, the file.
fn share_of(bytes: usize) -> (tempfile::TempDir, Share, String, Vec<u8>) {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("work-000001.glb");
    let content: Vec<u8> = (0..bytes).map(|i| (i % 251) as u8).collect();
    #[allow(clippy::disallowed_methods)] // Any file serves.
    std::fs::write(&path, &content).expect("written");
    let at = "127.0.0.1:0".parse().expect("an address");
    let hour = Duration::from_secs(3600);
    let texts = ShareTexts { languages: vec![], deleted: Box::new(|_| Ok(())) };
    let share = Share::start(at, "", (hour, Clock::monotonic()), texts).expect("listens");
    let link = share.link(&path).expect("a link");
    let token = link.url.rsplit('/').next().expect("a token").to_owned();
    (dir, share, format!("/{token}/work-000001.glb"), content)
}

fn send(at: SocketAddr, request: &[u8]) -> TcpStream {
    let mut stream = TcpStream::connect(at).expect("listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("set");
    // A server that has seen enough may close before all was sent.
    let _ = stream.write_all(request);
    stream
}

/// The whole answer; empty where the connection was closed without one.
fn answer(mut stream: TcpStream) -> Vec<u8> {
    let mut all = Vec::new();
    let _ = stream.read_to_end(&mut all);
    all
}

/// Seconds, on a machine with much else to do; less than `STALLED` of `sculptd_daemon::http`, so
/// nobody waited until a slow reader was cut off.
const AT_ONCE: f64 = 8.0;

fn get(at: SocketAddr, path: &str) -> Vec<u8> {
    answer(send(at, format!("GET {path} HTTP/1.1\r\nHost: {at}\r\n\r\n").as_bytes()))
}

#[test]
fn a_quick_reader_is_served_at_once_beside_a_hundred_slow_ones() {
    more_descriptors();
    let (_dir, share, path, content) = share_of(1 << 20);
    let at = share.address();
    let request = format!("GET {path} HTTP/1.1\r\nHost: {at}\r\n\r\n");
    let mut slow: Vec<TcpStream> = (0..100).map(|_| send(at, request.as_bytes())).collect();
    for reader in &mut slow {
        // Each has the head of its answer, and reads no further.
        reader.read_exact(&mut [0; 12]).expect("an answer begins");
    }
    let clock = Clock::monotonic();
    let reply = get(at, &path);
    let seconds = clock.now_us() as f64 * 1e-6;
    println!("1 MiB beside 100 slow readers: {seconds:.3} s");
    assert!(reply.ends_with(&content) && reply.starts_with(b"HTTP/1.1 200 OK\r\n"));
    assert!(seconds < AT_ONCE, "{seconds} s");
    // The slow readers are still there, and get the rest when they want it.
    for mut reader in slow.into_iter().take(8) {
        let mut rest = Vec::new();
        reader.read_to_end(&mut rest).expect("read");
        assert!(rest.ends_with(&content), "a slow reader was cut off");
    }
}

#[test]
fn three_hundred_slow_readers_take_no_more_than_the_places_there_are() {
    more_descriptors();
    // Longer than what the kernel holds of it for a reader who does not read.
    let (_dir, share, path, content) = share_of(1 << 20);
    let at = share.address();
    let request = format!("GET {path} HTTP/1.1\r\nHost: {at}\r\n\r\n");
    let slow: Vec<TcpStream> = (0..300).map(|_| send(at, request.as_bytes())).collect();
    let clock = Clock::monotonic();
    assert!(get(at, &path).ends_with(&content));
    let seconds = clock.now_us() as f64 * 1e-6;
    let whole = slow.into_iter().map(answer).filter(|a| a.ends_with(&content)).count();
    println!("1 MiB beside 300 slow readers: {seconds:.3} s; {whole} of them kept their place");
    assert!(whole <= CONNECTIONS && seconds < AT_ONCE, "{whole}, {seconds} s");
    // Those that are read last may have stood still for too long by then.
    assert!(whole > 0, "nobody kept a place");
}

#[test]
fn a_thousand_idle_connections_cost_a_bounded_number_of_descriptors_and_bytes() {
    more_descriptors();
    let daemon = Daemon::start(&["run", "--headless", "--metrics", "0"], "");
    let at = daemon.figures_at();
    assert!(get(at, "/metrics").starts_with(b"HTTP/1.1 200"));
    let (descriptors_before, kib_before) = (descriptors(daemon.id()), memory_kib(daemon.id()));
    let idle: Vec<TcpStream> = (0..1000).map(|_| send(at, b"GET /metr")).collect();
    let clock = Clock::monotonic();
    let reply = get(at, "/metrics");
    let seconds = clock.now_us() as f64 * 1e-6;
    assert!(reply.starts_with(b"HTTP/1.1 200") && seconds < AT_ONCE, "{seconds} s");
    let (most, kib) = (descriptors(daemon.id()), memory_kib(daemon.id()));
    println!(
        "1,000 idle connections: {} descriptors more, {} KiB more, an answer in {seconds:.3} s",
        most - descriptors_before,
        kib.saturating_sub(kib_before)
    );
    assert!(most <= descriptors_before + CONNECTIONS + 1, "{most}");
    assert!(kib < kib_before + 32 * 1024, "{kib_before} KiB, then {kib} KiB");
    // Nobody keeps a place by silence.
    until("the idle connections are closed", || descriptors(daemon.id()) <= descriptors_before + 1);
    drop(idle);
}

#[test]
fn every_kind_of_request_gets_an_answer_or_the_end_in_time() {
    let (_dir, share, path, content) = share_of(1000);
    let at = share.address();
    let status = |request: &[u8]| {
        let reply = answer(send(at, request));
        reply.get(9..12).and_then(|s| std::str::from_utf8(s).ok()?.parse::<u16>().ok())
    };
    // Lines that end with a line feed alone (RFC 9112, section 2.2, lets a recipient take them).
    let reply = answer(send(at, format!("GET {path} HTTP/1.1\nHost: {at}\n\n").as_bytes()));
    assert!(reply.starts_with(b"HTTP/1.1 200") && reply.ends_with(&content));
    let long = format!("GET {path} HTTP/1.1\r\nHost: {at}\r\nA: {}\r\n\r\n", "x".repeat(1 << 20));
    assert!(long.len() > HEAD_BYTES);
    assert_eq!(status(long.as_bytes()), Some(431));
    let many = format!("GET / HTTP/1.1\r\nHost: {at}\r\n{}\r\n", "a: b\r\n".repeat(500));
    assert_eq!(status(many.as_bytes()), Some(431));
    for (request, expected) in [
        (format!("GET {path} HTTP/1.1\r\n\r\n"), 400),
        (format!("GET {path} HTTP/1.1\r\nHost: {at}\r\nHost: {at}\r\n\r\n"), 400),
        (format!("GET {path} HTTP/1.1\r\nHost: evil.example\r\n\r\n"), 403),
        (format!("GET {path} HTTP/1.1\r\nHost: {at}\r\nOrigin: null\r\n\r\n"), 403),
        (format!("DELETE {path} HTTP/1.1\r\nHost: {at}\r\n\r\n"), 405),
        (format!("GET http://evil.example{path} HTTP/1.1\r\nHost: {at}\r\n\r\n"), 400),
        ("\u{0}\u{1}\u{2}\r\n\r\n".into(), 400),
        ("GET\r\n\r\n".into(), 400),
        (format!("GET {path}\r\n\r\n"), 400),
        (format!("GET {path} HTTP/9.9\r\nHost: {at}\r\n\r\n"), 400),
        (format!("GET {path} HTTP/1.1\r\nHost {at}\r\n\r\n"), 400),
    ] {
        assert_eq!(status(request.as_bytes()), Some(expected), "{request:?}");
    }
    // Another protocol: an answer or the end, and no silence.
    for hello in [&b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..], b"PRI * HTTP/2.0\r\n\r\nSM"]
    {
        answer(send(at, hello));
    }
    // A byte every now and then: the head has two seconds, not two seconds a byte.
    let clock = Clock::monotonic();
    let mut trickle = send(at, b"GET / HTTP/1.1\r\nA: ");
    trickle.set_read_timeout(Some(Duration::from_millis(300))).expect("set");
    loop {
        let _ = trickle.write_all(b"x");
        match trickle.read(&mut [0; 64]) {
            Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
            _ => break,
        }
        assert!(clock.now_us() < 20_000_000, "the trickle goes on");
    }
    assert!(clock.now_us() as u128 >= HEAD_TIME.as_micros() / 2);
    let _ = trickle.shutdown(Shutdown::Both);
}
