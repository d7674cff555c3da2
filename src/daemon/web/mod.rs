//! A page that any browser on the network can open by a link: it shows the sculpture, and its
//! pens sculpt.
//!
//! Laws kept here:
//! * Nobody joins without a key. A key has a role and an expiry, and can be revoked at any time;
//!   who holds one is disconnected then.
//! * Every guest is a person of the world, with a view, a brush and an undo of their own; a pen of
//!   a page is a device like any tablet.
//! * A slow page slows nobody: each connection has a thread, sends no more than its page has
//!   acknowledged room for, and skips the states between.
//! * Everything a page sends is bounded: bytes of a message, messages a second, connections.
//! * A connection that is cut lifts its pen. The page that comes back within [`RESUMES`] is sent
//!   only what it has not received.
//!
//! Read first: [`keys`] (who may join), [`connection`] (one page), [`delivery`] (what it is sent
//! next), [`page_code`] (as which bytes), [`walls`] (the map of wall thickness), [`downloads`]
//! (the work as a file).

use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use arc_swap::ArcSwap;
use hyper::{Request, StatusCode};

use crate::Published;
use crate::command_queue::CommandSender;
use crate::http::answer::permitted_to_page;
use crate::http::upgrade::Upgrade;
use crate::http::{Answer, HttpServer, Refusal};
use crate::window_link::WindowLink;
use sculptd_clay::brush::Presets;
use sculptd_devices::Clock;
use sculptd_devices::queue::SenderFactory;

pub mod connection;
pub mod delivery;
pub mod downloads;
pub mod guests;
pub mod keys;
pub mod messages;
pub mod page_code;
mod rate;
pub mod walls;

pub use downloads::Downloads;
pub use guests::{Guest, GuestList};
pub use keys::{KeyRing, WebKey, WebRole};

/// Pages at a time.
pub const MAX_PAGES: usize = 32;
/// Time for which a page that was cut off can go on where it was.
pub const RESUMES: Duration = Duration::from_secs(30);

/// A file of the page.
#[derive(Debug, Clone, Copy)]
pub struct PageFile {
    /// Path in the address, with its slash.
    pub path: &'static str,
    /// Media type.
    pub kind: &'static str,
    /// The bytes.
    pub bytes: &'static [u8],
}

/// The page may load from here and from nowhere else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
                      connect-src 'self'; manifest-src 'self'; base-uri 'none'; \
                      form-action 'none'; frame-ancestors 'none'";

/// Options of the page.
#[derive(Debug, Clone)]
pub struct WebOptions {
    /// Address to listen on; port 0: the system chooses.
    pub at: SocketAddr,
    /// Name or address by which others reach this machine; empty: the one that is listened on.
    pub name: String,
    /// The page itself.
    pub files: &'static [PageFile],
    /// Time for which the first keys are valid; `None`: as long as the program runs.
    pub lasts: Option<Duration>,
    /// Guests may sculpt in views of their own. Not in an installation: the file of a visit holds
    /// the visitor's view alone.
    pub own_views: bool,
}

/// What every connection needs.
#[derive(Debug)]
pub struct WebState {
    pub published: Arc<ArcSwap<Published>>,
    pub commands: CommandSender,
    pub factory: SenderFactory,
    pub presets: Presets,
    pub clock: Clock,
    /// Set when the daemon ends.
    pub stop: Arc<AtomicBool>,
    pub keys: KeyRing,
    /// See [`WebOptions::own_views`].
    pub own_views: bool,
    pub guests: GuestList,
    pub downloads: Downloads,
    /// The map of walls for the pages that show it.
    pub walls: Arc<walls::Walls>,
    /// Where the window says that it shows the map.
    pub window: WindowLink,
}

/// The page, being served; closed when dropped.
#[derive(Debug)]
pub struct Web {
    pub state: Arc<WebState>,
    server: HttpServer,
    name: String,
}

impl Web {
    /// Starts to serve.
    ///
    /// # Errors
    /// Returns the system's error for the address or the thread.
    pub fn start(options: &WebOptions, state: WebState) -> std::io::Result<Web> {
        let state = Arc::new(state);
        let (given, files, shared) = (options.name.clone(), options.files, state.clone());
        let server = HttpServer::start(options.at, "sculptd-web", |at, _| {
            move |request: &Request<()>| {
                answer(request, at, &given, files, &shared).unwrap_or_else(Answer::from)
            }
        })?;
        let name = match (options.name.as_str(), server.address().ip()) {
            ("", ip) if ip.is_unspecified() => own_address().unwrap_or(ip).to_string(),
            ("", ip) => ip.to_string(),
            (name, _) => name.to_owned(),
        };
        Ok(Web { state, server, name })
    }

    /// Returns the address of the listening socket.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Returns the link of a key. The key is behind `#`: a browser does not send it along with a
    /// request for the page, so it is in no log.
    pub fn link(&self, key: &WebKey) -> String {
        let host = match self.name.parse::<IpAddr>() {
            Ok(IpAddr::V6(ip)) => format!("[{ip}]"),
            _ => self.name.clone(),
        };
        format!("http://{host}:{}/#{}", self.server.address().port(), key.secret)
    }
}

/// Returns the address that this machine has in its network, by asking the system for the way to
/// an address that is never reached; no packet is sent.
pub(crate) fn own_address() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind("0.0.0.0:0").ok()?;
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().ok()?.ip()).filter(|ip| !ip.is_unspecified())
}

fn answer(
    request: &Request<()>,
    at: SocketAddr,
    name: &str,
    files: &[PageFile],
    state: &Arc<WebState>,
) -> Result<Answer, Refusal> {
    const NOTHING: Refusal = (StatusCode::NOT_FOUND, "there is nothing here");
    const NO_SOCKET: Refusal = (StatusCode::BAD_REQUEST, "a WebSocket of version 13 is expected");
    const FULL: Refusal = (StatusCode::SERVICE_UNAVAILABLE, "too many pages are connected");
    let path = permitted_to_page(request, at, name)?;
    if path == "/join" {
        // A program without a page sends no origin, and needs a key all the same.
        let state = state.clone();
        let place = state.guests.enter().ok_or(FULL)?;
        let follow = move |stream, read| {
            let run = move || connection::run(stream, read, &state, place);
            let thread = std::thread::Builder::new().name("sculptd-page".into()).spawn(run);
            if let Err(e) = thread {
                tracing::error!("web: a page cannot be served: {e}");
            }
        };
        let upgrade = Upgrade::accept(request, Box::new(follow)).ok_or(NO_SOCKET)?;
        return Ok(Answer::switched(upgrade));
    }
    if path.starts_with(downloads::PLACE) {
        return state.downloads.answer(path, state.clock.now_us());
    }
    let path = if path == "/" { "/index.html" } else { path };
    let file = files.iter().find(|f| f.path == path).ok_or(NOTHING)?;
    Ok(Answer::of_program(file.kind, file.bytes, POLICY))
}

/// Entries are written as a whole: a panic leaves none half written.
fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
