//! Listening: one thread that accepts, one a client, all bounded.

use std::io::{BufRead, BufReader, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, FileTypeExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serde_json::Value;

use super::host::{Host, locked};
use super::places::ClientPlace;
use super::waiting_room::{WaitingRoom, write_line};
use super::{IDLE_SECONDS, MAX_MESSAGE, MAX_RATE, events, user_id};
use sculptd_control::client::foreign_folder;
use sculptd_control::method;
use sculptd_control::wire::{Code, Response, parse};
use sculptd_control::{Request, RpcError};
use sculptd_devices::Clock;

/// Longest that a reply may wait for its reader.
const WRITE_PATIENCE: Duration = Duration::from_secs(5);
/// Pause after each refusal of a client that asks too often.
const FLOOD_PAUSE: Duration = Duration::from_millis(5);

#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    #[error("{path}: a daemon is listening here already")]
    Taken { path: PathBuf },
    #[error("{path}: {why}")]
    Foreign { path: PathBuf, why: String },
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
    /// Listens on the socket at `path`. A client that sends nothing for [`IDLE_SECONDS`] is
    /// disconnected unless it is subscribed.
    ///
    /// # Errors
    /// Returns an error if another daemon listens there, if another user owns the folder, or if the
    /// system reports one.
    pub fn start(path: &Path, host: Host) -> Result<Self, ServeError> {
        Server::start_with_idle(path, host, Duration::from_secs(IDLE_SECONDS))
    }

    /// As [`Server::start`], with a different idle time.
    ///
    /// # Errors
    /// As [`Server::start`].
    pub fn start_with_idle(path: &Path, host: Host, idle: Duration) -> Result<Self, ServeError> {
        let io = |source| ServeError::Io { path: path.into(), source };
        if let Some(dir) = path.parent().filter(|d| !d.exists()) {
            std::fs::DirBuilder::new().recursive(true).mode(0o700).create(dir).map_err(io)?;
        }
        if let Some(why) = foreign_folder(path) {
            return Err(ServeError::Foreign { path: path.into(), why });
        }
        // A socket that nobody answers is what a killed daemon left behind.
        if path.symlink_metadata().is_ok_and(|m| m.file_type().is_socket()) {
            if UnixStream::connect(path).is_ok() {
                return Err(ServeError::Taken { path: path.into() });
            }
            std::fs::remove_file(path).map_err(io)?;
        }
        let listener = UnixListener::bind(path).map_err(io)?;
        listener.set_nonblocking(true).map_err(io)?;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).map_err(io)?;
        let closing = Arc::new(AtomicBool::new(false));
        let closed = closing.clone();
        std::thread::Builder::new()
            .name("sculptd-control".into())
            .spawn(move || accept(&listener, &host, idle, &closed))
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

fn accept(listener: &UnixListener, host: &Host, idle: Duration, closing: &AtomicBool) {
    let mut room = WaitingRoom::new(idle);
    loop {
        room.wait(listener);
        loop {
            let stream = match listener.accept() {
                Ok((stream, _)) => stream,
                Err(e) if e.kind() == ErrorKind::WouldBlock => break,
                Err(_) => {
                    room.make_room();
                    break;
                }
            };
            if closing.load(SeqCst) {
                return;
            }
            // A client that does not read must not delay the clients that wait to be accepted.
            let _ = stream.set_write_timeout(Some(WRITE_PATIENCE));
            match peer(&stream) {
                Some((user, process)) if permitted(user, user_id()) => room.enter(stream, process),
                _ => {
                    let error = RpcError::failed("another user's daemon");
                    write_line(&stream, &Response::new(Value::Null, Err(error)));
                }
            }
        }
        while let Some((stream, place)) = room.next(host) {
            let host = host.for_client();
            start(place, move |place| serve(stream, &host, idle, &place));
        }
    }
}

/// Serves a client on a separate thread, which owns the place.
fn start(place: ClientPlace, serve: impl FnOnce(ClientPlace) + Send + 'static) {
    // If the thread cannot start, the closure is dropped, and with it the place and the stream.
    let client = std::thread::Builder::new().name("sculptd-client".into());
    let _ = client.spawn(move || serve(place));
}

/// Returns user and process of the other end, as the kernel names them.
fn peer(stream: &UnixStream) -> Option<(u32, i32)> {
    let peer = rustix::net::sockopt::socket_peercred(stream).ok()?;
    Some((peer.uid.as_raw(), peer.pid.as_raw_nonzero().get()))
}

/// Returns true if user `peer` may control the daemon of user `owner`.
pub fn permitted(peer: u32, owner: u32) -> bool {
    peer == owner || peer == 0
}

fn serve(stream: UnixStream, host: &Host, idle: Duration, place: &ClientPlace) {
    if stream.set_read_timeout(Some(idle)).is_err() {
        return;
    }
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
        if !read_line(&mut lines, &mut line, idle, subscribed) {
            return;
        }
        let whole = line.ends_with(b"\n");
        let now = clock.now_us() / 1_000_000;
        (second, asked) = if now == second { (second, asked + 1) } else { (now, 1) };
        place.set_busy(true);
        place.set_flooding(asked > MAX_RATE);
        let (response, subscribes) = answer(host, line.trim_ascii(), asked > MAX_RATE);
        // Who does not read its replies keeps nobody out.
        place.set_busy(false);
        // The state is read before the reply is sent, so that no later change is missed.
        let before =
            (subscribes && !std::mem::replace(&mut subscribed, true)).then(|| events::look(host));
        if response.is_some_and(|r| !write_line(&locked(&out), &r)) {
            return;
        }
        if let Some(before) = before {
            place.set_subscribed();
            let _ = events::start(host, before, out.clone(), gone.clone());
        }
        if asked > MAX_RATE {
            let _ = crossbeam_channel::never::<()>().recv_timeout(FLOOD_PAUSE);
        }
        // After an oversized line, the start of the next request is unknown.
        if !whole {
            return;
        }
    }
}

/// Reads one line, or as much of it as a message may have. Returns `false` if the client has
/// disconnected, was silent too long (unless subscribed), or takes too long for one line.
fn read_line(
    lines: &mut BufReader<UnixStream>,
    line: &mut Vec<u8>,
    idle: Duration,
    subscribed: bool,
) -> bool {
    let clock = Clock::monotonic();
    let mut until = u64::MAX;
    loop {
        let found = match lines.fill_buf() {
            Ok(found) => found,
            Err(e) if e.kind() == ErrorKind::Interrupted => continue,
            Err(e) => {
                let silent = matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut);
                if silent && subscribed && line.is_empty() {
                    continue;
                }
                return false;
            }
        };
        let room = MAX_MESSAGE + 2 - line.len();
        let end = found.iter().take(room).position(|b| *b == b'\n').map(|i| i + 1);
        let taken = end.unwrap_or(found.len().min(room));
        line.extend_from_slice(&found[..taken]);
        lines.consume(taken);
        if taken == 0 || end.is_some() || line.len() == MAX_MESSAGE + 2 {
            return !line.is_empty();
        }
        until = until.min(clock.now_us() + idle.as_micros() as u64);
        if clock.now_us() > until {
            return false;
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

/// The answer, if one is wanted, and whether events follow it. `flood`: the client has asked too
/// often in this second.
fn answer(host: &Host, line: &[u8], flood: bool) -> (Option<Response>, bool) {
    if line.is_empty() {
        return (None, false);
    }
    let asked = match parse(line) {
        Err(e) => return (Some(Response::new(Value::Null, Err(e))), false),
        Ok(asked) => asked,
    };
    let mut subscribes = false;
    host.commands.take_effect();
    let result = if flood {
        let text = format!("at most {MAX_RATE} requests a second");
        Err(RpcError::new(Code::TooManyRequests, text))
    } else {
        Request::read(&asked.method, asked.params).and_then(|request| {
            let wanted = matches!(request, Request::Subscribe(_));
            let reply = method::answer(host, request);
            subscribes = wanted && reply.is_ok();
            reply
        })
    };
    // The reply says that it is done: not even a kill takes it back.
    if host.journal.as_ref().is_some_and(|journal| !journal.wait_until_safe()) {
        tracing::debug!("{}: a reply did not wait for the session any longer", asked.method);
    }
    let effect = host.commands.take_effect();
    (asked.id.map(|id| Response::new(id, result).with_effect(effect)), subscribes)
}

#[cfg(test)]
mod tests {
    use super::super::places::ClientPlaces;
    use super::*;

    #[test]
    fn a_panic_in_a_client_s_thread_gives_its_place_back() {
        let places = ClientPlaces::new(1);
        let place = places.take(None, 1).expect("free");
        assert!(places.take(None, 2).is_none());
        let (ended, wait) = crossbeam_channel::bounded::<()>(0);
        start(place, move |_place| {
            let _ended = ended;
            panic!("a bug in a method (expected in this test)");
        });
        // Disconnected by the panic; the place is given back right after.
        assert!(wait.recv().is_err());
        let free = (0..1000).any(|_| {
            let _ = crossbeam_channel::never::<()>().recv_timeout(Duration::from_millis(5));
            places.take(None, 2).is_some()
        });
        assert!(free, "the place is lost");
    }
}
