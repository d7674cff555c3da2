use std::io::{Read, Write};
use std::net::TcpListener;
use std::time::Duration;

use super::*;
use crate::queue::{Receiver, channel};
use crate::sim::{Faults, Tracker, TrackerConfig, journal};

const SOON: Duration = Duration::from_secs(60);

struct LeapSetup {
    tracker: Tracker,
    handle: LeapHandle,
    rx: Receiver,
    clock: Clock,
    got: Vec<Sample>,
}

fn setup(config: TrackerConfig) -> LeapSetup {
    let mut tracker = Tracker::new(journal().hands, config).unwrap();
    tracker.skip_to(6_500_000);
    let (factory, rx) = channel(4096);
    let clock = Clock::manual();
    let config = LeapConfig { url: tracker.url(), device: DeviceId(5), ..LeapConfig::default() };
    let handle = start(config, clock.clone(), factory.sender()).unwrap();
    assert!(tracker.wait_for_client(SOON));
    LeapSetup { tracker, handle, rx, clock, got: Vec::new() }
}

impl LeapSetup {
    /// Steps the tracker and takes in what it promises.
    fn step(&mut self, us: u64) {
        self.clock.set_us(us);
        for _ in 0..self.tracker.advance(us) {
            self.got.push(self.rx.next_within(SOON).expect("the promised sample"));
        }
    }
}

#[test]
fn every_frame_of_the_journal_comes_out_as_it_went_in_and_twice_the_same() {
    let run = || {
        let mut setup = setup(TrackerConfig::default());
        (0..1200).for_each(|i| setup.step(6_500_000 + i * 8_000));
        assert_eq!(setup.rx.waiting(), 0);
        let status = setup.handle.status();
        assert_eq!((status.errors, status.stale, status.version), (0, 0, Some(6)), "{status:?}");
        setup.got
    };
    let got = run();
    assert_eq!(got, run(), "the same bits");
    let script = journal().hands;
    assert!(got.len() > 1000, "{}", got.len());
    let mut seen = 0;
    for s in &got {
        let Body::Hands(hands) = s.body else { panic!("{s:?}") };
        assert!(s.device == DeviceId(5));
        let taken = s.device_t_us.unwrap() - 3_600_000_000;
        let want = script.at(taken, hands.frame);
        assert_eq!(hands.count, want.count);
        for (a, b) in hands.as_slice().iter().zip(want.as_slice()) {
            seen += 1;
            assert_eq!(
                (a.id, a.left, a.palm, a.grab, a.wrist, a.elbow),
                (b.id, b.left, b.palm, b.grab, b.wrist, b.elbow)
            );
            assert!(a.orientation.unwrap().angle_between(b.orientation.unwrap()) < 1e-3);
            for (f, g) in a.fingers.iter().flatten().zip(b.fingers.iter().flatten()) {
                assert_eq!(
                    (f.joints, f.tip, f.extended, f.width),
                    (g.joints, g.tip, g.extended, g.width)
                );
            }
        }
    }
    assert!(seen > 900, "{seen} hands");
}

#[test]
fn a_bad_line_costs_frames_and_nothing_else() {
    let faults = Faults {
        seed: 3,
        drop: 0.05,
        duplicate: 0.05,
        reorder: 0.05,
        tear: 0.05,
        stall: 0.01,
        clock_jump: 0.01,
        unplug: 0.0,
    };
    let mut setup = setup(TrackerConfig { faults, ..TrackerConfig::default() });
    (0..1600).for_each(|i| setup.step(6_500_000 + i * 5_000));
    let status = setup.handle.status();
    assert!(status.errors > 20 && status.stale > 20, "{status:?}");
    assert!(setup.got.windows(2).all(|w| w[0].t_us <= w[1].t_us), "time never runs back");
    assert!(setup.got.iter().all(|s| s.t_us <= setup.clock.now_us()));
    let count = setup.rx.stats().of(DeviceId(5));
    assert_eq!((count.sent, count.lost_transition), (count.received, 0));
}

#[test]
fn a_server_that_goes_takes_its_hands_along_and_is_found_again() {
    let mut setup = setup(TrackerConfig::default());
    setup.tracker.skip_to(9_000_000);
    setup.step(9_000_000);
    let Body::Hands(before) = setup.got.last().unwrap().body else { panic!() };
    assert!(before.count > 0);
    assert_eq!(setup.tracker.unplug(), 1);
    let gone = setup.rx.next_within(SOON).unwrap();
    assert!(matches!(gone.body, Body::Hands(h) if h.count == 0));
    assert!(setup.tracker.wait_for_client(SOON), "it comes back by itself");
    setup.step(9_100_000);
    assert_eq!(setup.handle.status().connections, 2);
    assert!(matches!(setup.got.last().unwrap().body, Body::Hands(h) if h.count > 0));
}

#[test]
fn silence_ends_the_hands_and_the_greeting_is_short() {
    let mut setup = setup(TrackerConfig::default());
    setup.tracker.skip_to(9_000_000);
    setup.step(9_000_000);
    setup.clock.set_us(9_200_000);
    assert!(setup.rx.next_within(Duration::from_millis(60)).is_none(), "not yet");
    setup.clock.set_us(9_300_000);
    assert!(matches!(setup.rx.next_within(SOON).unwrap().body, Body::Hands(h) if h.count == 0));
    setup.step(9_310_000);
    let requests = setup.tracker.requests();
    assert_eq!(
        requests,
        [r#"{"background":true}"#, r#"{"optimizeHMD":false}"#, r#"{"focused":true}"#]
    );
    assert!(requests.iter().all(|w| w.len() < 32));
}

/// A server of the worst kind: each connection gets the next of these answers.
fn hostile(answers: Vec<Vec<u8>>) -> (String, std::thread::JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("ws://{}/v6.json", listener.local_addr().unwrap());
    let server = std::thread::spawn(move || {
        let mut open = Vec::new();
        for answer in answers {
            let (mut stream, _) = listener.accept().unwrap();
            let mut request = [0; 1024];
            let n = stream.read(&mut request).unwrap();
            let text = String::from_utf8_lossy(&request[..n]).into_owned();
            assert!(!text.to_ascii_lowercase().contains("origin:"), "no web page");
            let key = text
                .lines()
                .find_map(|l| l.strip_prefix("Sec-WebSocket-Key: "))
                .unwrap_or("")
                .trim();
            let accept = tungstenite::handshake::derive_accept_key(key.as_bytes());
            let answer = match answer.strip_prefix(b"WS") {
                Some(frames) => {
                    let head = format!(
                        "HTTP/1.1 101 Switching Protocols\r\nConnection: Upgrade\r\n\
                         Upgrade: websocket\r\nSec-WebSocket-Accept: {accept}\r\n\r\n"
                    );
                    [head.as_bytes(), frames].concat()
                }
                None => answer,
            };
            let _ = stream.write_all(&answer);
            let _ = stream.shutdown(std::net::Shutdown::Write);
            open.push(stream);
        }
    });
    (url, server)
}

/// A server's text frame, unmasked as the protocol wants it.
fn text(payload: &[u8]) -> Vec<u8> {
    let n = payload.len();
    let mut f = match n {
        0..126 => vec![0x81, n as u8],
        126..65536 => vec![0x81, 126, (n >> 8) as u8, n as u8],
        _ => [&[0x81, 127][..], &(n as u64).to_be_bytes()].concat(),
    };
    f.extend_from_slice(payload);
    f
}

fn ws(frames: &[Vec<u8>]) -> Vec<u8> {
    let mut out = b"WS".to_vec();
    frames.iter().for_each(|f| out.extend_from_slice(f));
    out
}

#[test]
fn a_server_that_breaks_every_rule_is_survived() {
    let good = br#"{"id":1,"timestamp":1,"hands":[{"id":1,"palmPosition":[0,200,0]}]}"#;
    let big = vec![b' '; MAX_MESSAGE + 1];
    let answers = vec![
        b"SSH-2.0-OpenSSH_9\r\n".to_vec(),
        b"HTTP/1.1 404 Not Found\r\n\r\n".to_vec(),
        b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
          Sec-WebSocket-Accept: no\r\n\r\n"
            .to_vec(),
        b"HTTP/1.1 101 Sw".to_vec(),
        ws(&[text(br#"{"version":5}"#)]),
        ws(&[vec![0x81, 127, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]]),
        ws(&[text(&big)]),
        ws(&[vec![0xf1, 0x00]]),
        ws(&[vec![0x81, 0x82, 1, 2, 3, 4, 5, 6]]),
        ws(&[vec![0x81, 3, 0xff, 0xfe, 0xfd]]),
        ws(&[vec![0x89, 126, 0, 200]]),
        ws(&[
            text(b"{\"hands\":["),
            text(&b"[".repeat(100_000)),
            text(br#"{"hands":[{"id":1,"palmPosition":[nan,1,1]}]}"#),
            text(br#"{"hands":5}"#),
            text(b"\0\0\0"),
            text(br#"{"version":"six"}"#),
            vec![0x82, 2, 1, 2],
            text(good),
            vec![0x88, 0],
        ]),
    ];
    let n = answers.len() as u64;
    let (url, server) = hostile(answers);
    let (factory, mut rx) = channel(64);
    let mut client = Client::new(
        LeapConfig { url, ..LeapConfig::default() },
        Clock::monotonic(),
        factory.sender(),
        Arc::new(Mutex::new(LeapStatus::default())),
    );
    let mut reasons = Vec::new();
    for _ in 0..n {
        // Each attempt by hand: the back-off has a separate test and would take a minute here.
        let (_hold, stop) = device_thread::pair();
        let why = match connect(&client.config, &stop) {
            Ok(socket) => client.serve(socket, &stop),
            Err(why) => why,
        };
        client.hands_gone();
        reasons.push(why);
    }
    server.join().unwrap();
    println!("{reasons:#?}");
    let mut got = Vec::new();
    rx.drain(100, &mut got);
    let counts: Vec<u8> =
        got.iter().map(|s| if let Body::Hands(h) = s.body { h.count } else { 9 }).collect();
    assert_eq!(counts, [0, 1, 0], "the repaired frame without its hand, the good one, and its end");
    let status = client.status.lock().unwrap().clone();
    assert!(status.errors >= 4 && status.repaired == 1, "{status:?}");
}

#[test]
fn another_machine_is_not_asked_unless_allowed_and_only_ws_is_spoken() {
    let (_hold, stop) = device_thread::pair();
    let to = |url: &str| {
        connect(&LeapConfig { url: url.into(), ..LeapConfig::default() }, &stop).unwrap_err()
    };
    assert!(to("ws://192.0.2.1:6437/v6.json").contains("Forward port 6437"));
    assert!(to("wss://127.0.0.1:6437/v6.json").contains("only ws://"));
    assert!(to("::::").contains("::::"));
    assert!(to("ws:///v6.json").len() > 4);
}

#[test]
fn a_page_of_another_origin_and_a_strange_path_are_turned_away() {
    let config =
        TrackerConfig { origins: vec!["http://localhost:8080".into()], ..TrackerConfig::default() };
    let tracker = Tracker::new(journal().hands, config).unwrap();
    for (origin, path, welcome) in [
        (None, "/v6.json", true),
        (None, "/v7.json", true),
        (Some("http://localhost:8080"), "/v6.json", true),
        (Some("https://evil.example"), "/v6.json", false),
        (Some("null"), "/v6.json", false),
        (None, "/", false),
    ] {
        let mut request =
            format!("ws://{}{path}", tracker.address()).into_client_request().unwrap();
        if let Some(o) = origin {
            request.headers_mut().insert("Origin", o.parse().unwrap());
        }
        let stream = TcpStream::connect(tracker.address()).unwrap();
        assert_eq!(tungstenite::client(request, stream).is_ok(), welcome, "{origin:?} {path}");
    }
}
