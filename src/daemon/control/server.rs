//! Listening: one thread that accepts, one a client, all bounded.

use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::{DirBuilderExt, FileTypeExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use arc_swap::ArcSwap;
use serde_json::Value;

use super::protocol::{Code, Response, RpcError, parse};
use super::{MAX_CLIENTS, MAX_MESSAGE, MAX_RATE, events, methods, user_id};
use crate::Published;
use crate::command_queue::CommandSender;
use sculptd_devices::Clock;

/// What a request may touch.
#[derive(Debug, Clone)]
pub struct Host {
    pub commands: CommandSender,
    pub published: Arc<ArcSwap<Published>>,
    /// What each brush begins with.
    pub presets: sculptd_clay::brush::Presets,
    /// The wall thickness of the work, as last asked for.
    pub thickness: Arc<Mutex<Option<sculptd_clay::live_thickness::LiveMap>>>,
    /// The Boolean under way.
    pub joining: Arc<Mutex<Option<Arc<sculptd_geometry::job::Job>>>>,
    /// How the session file stands; `None`: the run is not recorded.
    pub journal: Option<crate::session::Health>,
    /// The history of the session, if one is kept.
    pub history: Option<crate::session::history::Handle>,
    /// Raised by `shutdown`.
    pub stop: Arc<AtomicBool>,
}

#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    #[error("{path}: a daemon is listening here already")]
    Taken { path: PathBuf },
    #[error("{path}: {source}")]
    Io { path: PathBuf, source: std::io::Error },
}

/// A listening socket; closed and removed when dropped.
#[derive(Debug)]
pub struct Server {
    path: PathBuf,
    closing: Arc<AtomicBool>,
}

impl Server {
    pub fn start(path: &Path, host: Host) -> Result<Self, ServeError> {
        let io = |source| ServeError::Io { path: path.into(), source };
        if let Some(dir) = path.parent().filter(|d| !d.exists()) {
            std::fs::DirBuilder::new().recursive(true).mode(0o700).create(dir).map_err(io)?;
        }
        // A socket that nobody answers is what a killed daemon left behind.
        if path.symlink_metadata().is_ok_and(|m| m.file_type().is_socket()) {
            if UnixStream::connect(path).is_ok() {
                return Err(ServeError::Taken { path: path.into() });
            }
            std::fs::remove_file(path).map_err(io)?;
        }
        let listener = UnixListener::bind(path).map_err(io)?;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).map_err(io)?;
        let closing = Arc::new(AtomicBool::new(false));
        let closed = closing.clone();
        std::thread::Builder::new()
            .name("sculptd-control".into())
            .spawn(move || accept(&listener, &host, &closed))
            .map_err(io)?;
        Ok(Server { path: path.into(), closing })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.closing.store(true, SeqCst);
        // Wakes the accepting thread, which then sees that it should end.
        let _ = UnixStream::connect(&self.path);
        let _ = std::fs::remove_file(&self.path);
    }
}

fn accept(listener: &UnixListener, host: &Host, closing: &AtomicBool) {
    let clients = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming() {
        if closing.load(SeqCst) {
            return;
        }
        let Ok(mut stream) = stream else { continue };
        let refuse = |stream: &mut UnixStream, why: &str| {
            let r = Response::of(Value::Null, Err(RpcError::new(Code::Failed, why)));
            let _ = serde_json::to_writer(&mut *stream, &r);
            let _ = stream.write_all(b"\n");
        };
        if !allowed(&stream, user_id()) {
            refuse(&mut stream, "another user's daemon");
            continue;
        }
        if clients.load(SeqCst) >= MAX_CLIENTS {
            refuse(&mut stream, "too many clients at a time");
            continue;
        }
        clients.fetch_add(1, SeqCst);
        let (host, counter) = (host.clone(), clients.clone());
        let started = std::thread::Builder::new().name("sculptd-client".into()).spawn(move || {
            serve(stream, &host);
            counter.fetch_sub(1, SeqCst);
        });
        if started.is_err() {
            clients.fetch_sub(1, SeqCst);
        }
    }
}

/// Only the daemon's own user and root, as the kernel names the peer.
pub fn allowed(stream: &UnixStream, owner: u32) -> bool {
    match rustix::net::sockopt::socket_peercred(stream) {
        Ok(peer) => permitted(peer.uid.as_raw(), owner),
        Err(_) => false,
    }
}

/// Whether user `peer` may drive the daemon of user `owner`.
pub fn permitted(peer: u32, owner: u32) -> bool {
    peer == owner || peer == 0
}

fn serve(stream: UnixStream, host: &Host) {
    // A client that sends half a line and sleeps is let go after a minute; one that is merely quiet
    // is not.
    let _ = stream.set_write_timeout(Some(Duration::from_secs(5)));
    let Ok(out) = stream.try_clone() else { return };
    // Answers and events take turns, a line each.
    let out = Arc::new(Mutex::new(out));
    let gone = Arc::new(AtomicBool::new(false));
    let _leaving = Leaving(gone.clone());
    let mut subscribed = false;
    let mut lines = BufReader::new(stream);
    let clock = Clock::monotonic();
    let (mut second, mut asked) = (0, 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        match lines.by_ref().take(MAX_MESSAGE as u64 + 2).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let whole = line.ends_with(b"\n");
        let now = clock.now_us() / 1_000_000;
        (second, asked) = if now == second { (second, asked + 1) } else { (now, 1) };
        let (response, subscribes) = if asked > MAX_RATE {
            let slow = RpcError::new(Code::Slow, format!("at most {MAX_RATE} requests a second"));
            (Some(Response::of(Value::Null, Err(slow))), false)
        } else {
            answer(host, line.trim_ascii())
        };
        // Taken before the client is told: nothing after its answer is missed.
        let before =
            (subscribes && !std::mem::replace(&mut subscribed, true)).then(|| events::look(host));
        if let Some(response) = response {
            let Ok(mut bytes) = serde_json::to_vec(&response) else { return };
            bytes.push(b'\n');
            if out.lock().map_or(true, |mut o| o.write_all(&bytes).is_err()) {
                return;
            }
        }
        if let Some(before) = before {
            let _ = events::start(host, before, out.clone(), gone.clone());
        }
        // What follows an oversized line cannot be told apart from it.
        if !whole {
            return;
        }
    }
}

/// Raises its flag when the client has gone, however that came.
struct Leaving(Arc<AtomicBool>);

impl Drop for Leaving {
    fn drop(&mut self) {
        self.0.store(true, SeqCst);
    }
}

/// The answer, if one is wanted, and whether events follow it.
fn answer(host: &Host, line: &[u8]) -> (Option<Response>, bool) {
    if line.is_empty() {
        return (None, false);
    }
    match parse(line) {
        Err(e) => (Some(Response::of(Value::Null, Err(e))), false),
        Ok(request) => {
            let result = methods::call(host, &request.method, request.params);
            let subscribes = request.method == "subscribe" && result.is_ok();
            (request.id.map(|id| Response::of(id, result)), subscribes)
        }
    }
}
