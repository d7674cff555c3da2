//! Hand trackers that break every rule: the daemon continues, stays small, and ends on request.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use sculptd_devices::Clock;

use crate::hostile::{Daemon, most_memory_kib, thread_seconds};
use crate::waiting::until;

/// Longest time from SIGTERM to the end.
const END_S: f64 = 2.0;
/// Most memory of the daemon. A start ball of 160,000 vertices takes a sixth of it.
const MEMORY_KIB: u64 = 1 << 20;
/// Duration of each before the daemon is stopped, in seconds.
const ENDURED_S: f64 = 1.5;

/// Behaviour of a tracker on one connection, until `ended` is set at the end of the test.
type Behaviour = fn(&mut TcpStream, &AtomicBool) -> std::io::Result<()>;

/// Reads the request and answers it as RFC 6455 wants it.
pub fn shake_hands(stream: &mut TcpStream) -> std::io::Result<()> {
    let mut request = Vec::new();
    while !request.windows(4).any(|w| w == b"\r\n\r\n") {
        let mut part = [0; 1024];
        let n = stream.read(&mut part)?;
        if n == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        request.extend_from_slice(&part[..n]);
    }
    let text = String::from_utf8_lossy(&request);
    let key = text.lines().find_map(|l| l.strip_prefix("Sec-WebSocket-Key: ")).unwrap_or("");
    let accept = accept_key(key.trim());
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Accept: {accept}\r\n\r\n"
    )
}

/// The proof that a server has read the key (RFC 6455, section 4.2.2): Base64 of a SHA-1.
fn accept_key(key: &str) -> String {
    let digest = sha1(format!("{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11").as_bytes());
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for part in digest.chunks(3) {
        let word = part.iter().fold(0u32, |w, b| w << 8 | u32::from(*b)) << (8 * (3 - part.len()));
        for i in 0..4 {
            let digit = digits[(word >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= part.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

/// SHA-1 (RFC 3174).
fn sha1(text: &[u8]) -> [u8; 20] {
    let mut padded = text.to_vec();
    padded.push(0x80);
    padded.resize((padded.len() + 8).div_ceil(64) * 64 - 8, 0);
    padded.extend_from_slice(&(text.len() as u64 * 8).to_be_bytes());
    let mut h: [u32; 5] = [0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476, 0xC3D2E1F0];
    for block in padded.chunks(64) {
        let mut w = [0u32; 80];
        for (i, word) in block.chunks(4).enumerate() {
            w[i] = u32::from_be_bytes([word[0], word[1], word[2], word[3]]);
        }
        for i in 16..80 {
            w[i] = (w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16]).rotate_left(1);
        }
        let [mut a, mut b, mut c, mut d, mut e] = h;
        for (i, word) in w.iter().enumerate() {
            let (f, k) = match i {
                0..20 => (b & c | !b & d, 0x5A827999),
                20..40 => (b ^ c ^ d, 0x6ED9EBA1),
                40..60 => (b & c | b & d | c & d, 0x8F1BBCDC),
                _ => (b ^ c ^ d, 0xCA62C1D6),
            };
            let next = a.rotate_left(5).wrapping_add(f).wrapping_add(e);
            let next = next.wrapping_add(k).wrapping_add(*word);
            (e, d, c, b, a) = (d, c, b.rotate_left(30), a, next);
        }
        for (sum, part) in h.iter_mut().zip([a, b, c, d, e]) {
            *sum = sum.wrapping_add(part);
        }
    }
    let mut out = [0; 20];
    out.chunks_mut(4).zip(h).for_each(|(to, word)| to.copy_from_slice(&word.to_be_bytes()));
    out
}

/// Sends the same bytes again and again.
fn flood(stream: &mut TcpStream, ended: &AtomicBool, bytes: &[u8]) -> std::io::Result<()> {
    let many = bytes.repeat((64 << 10) / bytes.len().max(1) + 1);
    while !ended.load(Relaxed) {
        stream.write_all(&many)?;
    }
    Ok(())
}

/// Sends the same bytes every few milliseconds.
fn trickle(
    stream: &mut TcpStream,
    ended: &AtomicBool,
    bytes: &[u8],
    every_ms: u64,
) -> std::io::Result<()> {
    while !ended.load(Relaxed) {
        stream.write_all(bytes)?;
        rest(every_ms);
    }
    Ok(())
}

pub fn rest(ms: u64) {
    let _ = crossbeam_channel::never::<()>().recv_timeout(Duration::from_millis(ms));
}

fn say_nothing(ended: &AtomicBool) {
    while !ended.load(Relaxed) {
        rest(20);
    }
}

/// A whole text frame.
pub fn text(payload: &[u8]) -> Vec<u8> {
    let n = payload.len();
    let mut frame = match n {
        0..126 => vec![0x81, n as u8],
        126..65536 => vec![0x81, 126, (n >> 8) as u8, n as u8],
        _ => [&[0x81, 127][..], &(n as u64).to_be_bytes()].concat(),
    };
    frame.extend_from_slice(payload);
    frame
}

/// Frames of hands that come and go: every one is a transition, which is never dropped.
fn coming_and_going(stream: &mut TcpStream, ended: &AtomicBool) -> std::io::Result<()> {
    for id in 1u64.. {
        let hand = r#"{"id":7,"type":"right","palmPosition":[0,200,0],"grabStrength":1}"#;
        let hands = if id % 2 == 0 { hand } else { "" };
        let frame = format!(r#"{{"id":{id},"timestamp":{},"hands":[{hands}]}}"#, id * 10);
        stream.write_all(&text(frame.as_bytes()))?;
        if ended.load(Relaxed) {
            break;
        }
    }
    Ok(())
}

/// Bytes without a pattern (xorshift, Marsaglia 2003).
fn noise(stream: &mut TcpStream, ended: &AtomicBool) -> std::io::Result<()> {
    let mut x = 88_172_645_463_325_252u64;
    while !ended.load(Relaxed) {
        let mut bytes = Vec::with_capacity(8192);
        for _ in 0..1024 {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            bytes.extend_from_slice(&x.to_le_bytes());
        }
        stream.write_all(&bytes)?;
    }
    Ok(())
}

const TRACKERS: [(&str, Behaviour); 24] = [
    ("accepts and says nothing", |_, ended| {
        say_nothing(ended);
        Ok(())
    }),
    ("closes each connection at once", |_, _| Ok(())),
    ("a byte of the handshake now and then", |s, ended| trickle(s, ended, b"H", 50)),
    ("a header of the handshake now and then", |s, ended| {
        s.write_all(b"HTTP/1.1 101 Switching Protocols\r\n")?;
        trickle(s, ended, b"X: y\r\n", 50)
    }),
    ("headers without end", |s, ended| {
        s.write_all(b"HTTP/1.1 101 Switching Protocols\r\n")?;
        flood(s, ended, b"X: y\r\n")
    }),
    ("a header line without end", |s, ended| {
        s.write_all(b"HTTP/1.1 101 Switching Protocols\r\nX: ")?;
        flood(s, ended, b"y")
    }),
    ("another protocol", |s, ended| flood(s, ended, b"SSH-2.0-OpenSSH_9\r\n")),
    ("shakes hands and says nothing", |s, ended| {
        shake_hands(s)?;
        say_nothing(ended);
        Ok(())
    }),
    ("empty continuation frames without end", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x01, 0])?;
        flood(s, ended, &[0x00, 0])
    }),
    ("continuation frames of a byte without end", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x01, 0])?;
        flood(s, ended, &[0x00, 1, b' '])
    }),
    ("a continuation frame every 2 ms", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x01, 0])?;
        trickle(s, ended, &[0x00, 0], 2)
    }),
    ("continuation frames and pings in turn", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x01, 0])?;
        flood(s, ended, &[0x00, 0, 0x89, 0])
    }),
    ("pings without end", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &[0x89, 0])
    }),
    ("pings of 125 bytes, and nobody reads the answers", |s, ended| {
        shake_hands(s)?;
        let ping = [&[0x89, 125][..], &[b'p'; 125]].concat();
        flood(s, ended, &ping)
    }),
    ("pongs without end", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &[0x8A, 0])
    }),
    ("a frame of 2^63 bytes", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x81, 127, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff])?;
        flood(s, ended, b" ")
    }),
    ("a frame of 200,000 bytes, a byte now and then", |s, ended| {
        shake_hands(s)?;
        s.write_all(&[0x81, 127, 0, 0, 0, 0, 0, 3, 0x0d, 0x40])?;
        trickle(s, ended, b" ", 5)
    }),
    ("frames of 16 MiB", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &text(&vec![b' '; 16 << 20]))
    }),
    ("binary messages without end", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &[0x82, 1, 0])
    }),
    ("empty texts without end", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &text(b"{}"))
    }),
    ("texts of 250,000 nested brackets", |s, ended| {
        shake_hands(s)?;
        flood(s, ended, &text(&b"[".repeat(250_000)))
    }),
    ("hands that come and go without end", |s, ended| {
        shake_hands(s)?;
        coming_and_going(s, ended)
    }),
    ("bytes without a pattern", |s, ended| {
        shake_hands(s)?;
        noise(s, ended)
    }),
    ("a good frame, then it breaks off, again and again", |s, _| {
        shake_hands(s)?;
        s.write_all(&text(br#"{"id":1,"timestamp":1,"hands":[{"id":1,"palmPosition":[0,1,0]}]}"#))?;
        s.write_all(&[0xff; 64])
    }),
];

/// A listening tracker. Returns its address and how often it was connected to.
fn listen(behaviour: Behaviour, ended: &Arc<AtomicBool>) -> (String, Arc<AtomicU64>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("listens");
    let url = format!("ws://{}/v6.json", listener.local_addr().expect("an address"));
    listener.set_nonblocking(true).expect("set");
    let met = Arc::new(AtomicU64::new(0));
    let (count, ended) = (met.clone(), ended.clone());
    std::thread::spawn(move || {
        while !ended.load(Relaxed) {
            let Ok((mut stream, _)) = listener.accept() else {
                rest(5);
                continue;
            };
            count.fetch_add(1, Relaxed);
            let _ = stream.set_nonblocking(false);
            let _ = stream.set_write_timeout(Some(Duration::from_millis(200)));
            let ended = ended.clone();
            std::thread::spawn(move || {
                // A full socket is waited for, a closed one ends it.
                let _ = behaviour(&mut stream, &ended);
            });
        }
    });
    (url, met)
}

#[test]
fn the_daemon_ends_in_time_and_stays_small_under_every_hostile_tracker() {
    println!("{:<52} {:>6} {:>6} {:>8} {:>6}", "tracker", "met", "CPU %", "MiB", "end s");
    let mut failed = Vec::new();
    // A few at a time: every daemon has a tick thread.
    for group in TRACKERS.chunks(4) {
        let ended = Arc::new(AtomicBool::new(false));
        let threads: Vec<_> = group
            .iter()
            .map(|&(name, behaviour)| {
                let ended = ended.clone();
                std::thread::spawn(move || (name, endure(behaviour, &ended)))
            })
            .collect();
        for thread in threads {
            let (name, (met, share, kib, end_s)) = thread.join().expect("endured");
            let percent = share * 100.0;
            println!("{name:<52} {met:>6} {percent:>6.1} {:>8} {end_s:>6.2}", kib >> 10);
            if met == 0 || share > 0.5 || kib > MEMORY_KIB || end_s > END_S {
                failed.push(name);
            }
        }
        ended.store(true, Relaxed);
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// Runs a daemon against a tracker. Returns how often they met, the share of a core that the
/// client's thread used, the most memory in KiB, and the seconds from SIGTERM to the end.
fn endure(behaviour: Behaviour, ended: &Arc<AtomicBool>) -> (u64, f64, u64, f64) {
    let (url, met) = listen(behaviour, ended);
    let settings = format!("[devices]\nhid = false\nleap = \"{url}\"\n");
    let mut daemon = Daemon::start(&["run", "--headless"], &settings);
    until("they meet", || met.load(Relaxed) > 0);
    let (clock, before) = (Clock::monotonic(), thread_seconds(daemon.id(), "leap"));
    rest((ENDURED_S * 1e3) as u64);
    let used = thread_seconds(daemon.id(), "leap") - before;
    let share = used / (clock.now_us() as f64 * 1e-6);
    let kib = most_memory_kib(daemon.id());
    (met.load(Relaxed), share, kib, daemon.end())
}
