//! A visitor's work on the local network, for a while: a link that nobody can guess, and its QR
//! code for the screen.
//!
//! Only what the link names is served, to whoever has it, until it expires; there is no list.
//! `Host` must be an address of ours or the name in the settings, and a request with an `Origin` is
//! refused: no web page reads works.

use std::collections::BTreeMap;
use std::io::Write;
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::metrics::{PATIENCE, read_head, request};
use sculptd_devices::Clock;

/// Links that are good at a time; the oldest goes first.
const LINKS: usize = 1024;

/// A QR code (ISO/IEC 18004), as squares.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Code {
    /// Squares a side, the quiet border not counted.
    pub side: usize,
    /// Row by row; true is dark.
    pub dark: Vec<bool>,
}

impl Code {
    /// `None` for a text that no code holds.
    pub fn of(text: &str) -> Option<Code> {
        let code = qrcodegen::QrCode::encode_text(text, qrcodegen::QrCodeEcc::Medium).ok()?;
        let side = code.size();
        let dark = (0..side)
            .flat_map(|y| (0..side).map(move |x| (x, y)))
            .map(|(x, y)| code.get_module(x, y));
        Some(Code { side: side as usize, dark: dark.collect() })
    }
}

/// A link, for the screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    pub url: String,
    pub code: Code,
    /// On the clock, when it expires.
    pub until_us: u64,
}

#[derive(Debug, Clone)]
struct ServedFile {
    file: PathBuf,
    until_us: u64,
}

/// The listener; closed when dropped.
#[derive(Debug)]
pub struct Share {
    at: SocketAddr,
    name: String,
    lasts: Duration,
    links: Arc<Mutex<BTreeMap<String, ServedFile>>>,
    clock: Clock,
    closing: Arc<AtomicBool>,
}

/// 128 bits that nobody can guess, as hexadecimal digits.
fn token() -> std::io::Result<String> {
    let mut bytes = [0u8; 16];
    #[cfg(unix)]
    std::io::Read::read_exact(&mut std::fs::File::open("/dev/urandom")?, &mut bytes)?;
    #[cfg(not(unix))]
    for half in bytes.chunks_mut(8) {
        use std::hash::{BuildHasher, Hasher};
        // Keyed by the system's random numbers.
        half.copy_from_slice(&std::hash::RandomState::new().build_hasher().finish().to_le_bytes());
    }
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

impl Share {
    /// Listens. `name`: the address that visitors' telephones reach this machine by; empty: the one
    /// that is listened on.
    pub fn start(
        at: SocketAddr,
        name: &str,
        lasts: Duration,
        clock: Clock,
    ) -> std::io::Result<Share> {
        let listener = TcpListener::bind(at)?;
        let at = listener.local_addr()?;
        let name = if name.is_empty() { at.ip().to_string() } else { name.to_owned() };
        let links: Arc<Mutex<BTreeMap<String, ServedFile>>> = Arc::default();
        let closing = Arc::new(AtomicBool::new(false));
        let (closed, good, known, time) =
            (closing.clone(), links.clone(), name.clone(), clock.clone());
        std::thread::Builder::new().name("sculptd-share".into()).spawn(move || {
            for stream in listener.incoming() {
                if closed.load(Ordering::SeqCst) {
                    return;
                }
                if let Ok(stream) = stream {
                    let _ = serve(stream, at, &known, &good, &time);
                }
            }
        })?;
        Ok(Share { at, name, lasts, links, clock, closing })
    }

    pub fn address(&self) -> SocketAddr {
        self.at
    }

    /// A link to a work, good from now on.
    pub fn link(&self, file: &Path) -> std::io::Result<Link> {
        let token = token()?;
        let host = match self.name.parse::<IpAddr>() {
            Ok(IpAddr::V6(ip)) => format!("[{ip}]"),
            _ => self.name.clone(),
        };
        let url = format!("http://{host}:{}/{token}", self.at.port());
        let code = Code::of(&url)
            .ok_or_else(|| std::io::Error::other("the link is too long for a code"))?;
        let now = self.clock.now_us();
        let until_us = now + self.lasts.as_micros() as u64;
        if let Ok(mut links) = self.links.lock() {
            links.retain(|_, l| l.until_us > now);
            while links.len() >= LINKS {
                let Some(oldest) = links.iter().min_by_key(|l| l.1.until_us).map(|l| l.0.clone())
                else {
                    break;
                };
                links.remove(&oldest);
            }
            links.insert(token, ServedFile { file: file.to_path_buf(), until_us });
        }
        Ok(Link { url, code, until_us })
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::SeqCst);
        let ip =
            if self.at.ip().is_unspecified() { IpAddr::from([127, 0, 0, 1]) } else { self.at.ip() };
        let _ = TcpStream::connect_timeout(&(ip, self.at.port()).into(), PATIENCE);
    }
}

fn serve(
    mut stream: TcpStream,
    at: SocketAddr,
    name: &str,
    links: &Mutex<BTreeMap<String, ServedFile>>,
    clock: &Clock,
) -> std::io::Result<()> {
    let Some(head) = read_head(&mut stream)? else { return Ok(()) };
    let (status, kind, body) = match answer(&head, at, name, links, clock) {
        Ok((kind, body)) => ("200 OK", kind, body),
        Err((status, why)) => {
            (status, "text/plain; charset=utf-8", format!("{why}\n").into_bytes())
        }
    };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nX-Content-Type-Options: \
            \
            nosniff\r\nReferrer-Policy: no-referrer\r\nContent-Security-Policy: default-src \
            'none'; style-src 'unsafe-inline'\r\nCache-Control: no-store\r\nConnection: \
            close\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(&body)
}

/// What a request gets: `/TOKEN` a page, `/TOKEN/work-000001.glb` the work.
fn answer(
    head: &[u8],
    at: SocketAddr,
    name: &str,
    links: &Mutex<BTreeMap<String, ServedFile>>,
    clock: &Clock,
) -> Result<(&'static str, Vec<u8>), (&'static str, &'static str)> {
    const GONE: (&str, &str) = ("404 Not Found", "there is nothing here, or no longer");
    let path = request(head, at, name)?;
    let mut parts = path.trim_start_matches('/').splitn(2, '/');
    let token = parts.next().unwrap_or("");
    let good = links.lock().ok().and_then(|l| l.get(token).cloned());
    let good = good.filter(|g| g.until_us > clock.now_us()).ok_or(GONE)?;
    let file = good.file.file_name().and_then(|n| n.to_str()).ok_or(GONE)?;
    match parts.next() {
        None | Some("") => {
            // Names are digits and fixed letters, the token is digits: nothing to escape.
            let page = format!(
                "<!doctype html><meta charset=\"utf-8\"><meta \
                    name=\"viewport\" \
                    content=\"width=device-width\"><title>sculptd</title><style>body{{font:1.4em \
                    sans-serif;margin:2em}}</style><h1>sculptd</h1><p><a href=\"/{token}/{file}\" \
                    download>{file}</a></p>"
            );
            Ok(("text/html; charset=utf-8", page.into_bytes()))
        }
        // Only the one file that the link was made for, whatever is asked for.
        Some(asked) if asked == file => {
            Ok(("model/gltf-binary", std::fs::read(&good.file).map_err(|_| GONE)?))
        }
        Some(_) => Err(GONE),
    }
}
