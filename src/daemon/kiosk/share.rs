//! A visitor's sculpture on the local network, for a while: a link that nobody can guess, and its
//! QR code for the screen.
//!
//! Only the file that the link names is served, to whoever has the link, until it expires; there is
//! no list. `Host` must be an address of ours or the name in the settings, and a request with an
//! `Origin` is refused: no web page reads sculptures.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use hyper::{Request, StatusCode};

use crate::http::answer::permitted;
use crate::http::{Answer, HttpServer, Refusal};
use crate::qr_code::Code;
use crate::random_token::random_token;
use sculptd_devices::Clock;

/// Links that are good at a time; the oldest goes first.
const LINKS: usize = 1024;

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
    server: HttpServer,
    name: String,
    lasts: Duration,
    links: Arc<Mutex<BTreeMap<String, ServedFile>>>,
    clock: Clock,
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
        let links: Arc<Mutex<BTreeMap<String, ServedFile>>> = Arc::default();
        let (known, good, time) = (name.to_owned(), links.clone(), clock.clone());
        let server = HttpServer::start(at, "sculptd-share", |at, _| {
            // Without a name the address that is listened on is the only one.
            let known = if known.is_empty() { at.ip().to_string() } else { known };
            move |request: &Request<()>| {
                answer(request, at, &known, &good, &time).unwrap_or_else(Answer::from)
            }
        })?;
        let ip = || server.address().ip().to_string();
        let name = if name.is_empty() { ip() } else { name.to_owned() };
        Ok(Share { server, name, lasts, links, clock })
    }

    /// Returns the address of the listening socket.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Returns a link to a file, valid from now on.
    pub fn link(&self, file: &Path) -> std::io::Result<Link> {
        let token = random_token()?;
        let host = match self.name.parse::<IpAddr>() {
            Ok(IpAddr::V6(ip)) => format!("[{ip}]"),
            _ => self.name.clone(),
        };
        let url = format!("http://{host}:{}/{token}", self.server.address().port());
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

/// Answers a request: `/TOKEN` returns a page, `/TOKEN/work-000001.glb` the sculpture.
fn answer(
    request: &Request<()>,
    at: SocketAddr,
    name: &str,
    links: &Mutex<BTreeMap<String, ServedFile>>,
    clock: &Clock,
) -> Result<Answer, Refusal> {
    const GONE: Refusal = (StatusCode::NOT_FOUND, "there is nothing here, or no longer");
    let path = permitted(request, at, name)?;
    let mut parts = path.trim_start_matches('/').splitn(2, '/');
    let token = parts.next().unwrap_or("");
    let good = links.lock().ok().and_then(|l| l.get(token).cloned());
    let good = good.filter(|g| g.until_us > clock.now_us()).ok_or(GONE)?;
    let file = good.file.file_name().and_then(|n| n.to_str()).ok_or(GONE)?;
    match parts.next() {
        None | Some("") => {
            // Names are digits and fixed letters, the token is digits: nothing to escape.
            let page = format!(
                "<!doctype html><meta charset=\"utf-8\"><meta name=\"viewport\" \
                 content=\"width=device-width\"><title>sculptd</title><style>body{{font:1.4em \
                 sans-serif;margin:2em}}</style><h1>sculptd</h1><p><a href=\"/{token}/{file}\" \
                 download>{file}</a></p>"
            );
            Ok(Answer::text("text/html; charset=utf-8", page))
        }
        // Only the one file that the link was made for, whatever is asked for.
        Some(asked) if asked == file => {
            Answer::file("model/gltf-binary", &good.file).map_err(|_| GONE)
        }
        Some(_) => Err(GONE),
    }
}
