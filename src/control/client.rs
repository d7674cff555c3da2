//! A client: blocking, one connection, with a time limit on every read and write.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;

use crate::event::EventNotice;
use crate::method::{Hello, Method};
use crate::status::{HelloParams, HelloReply, Versions};
use crate::wire::{Envelope, MAX_REPLY, Response, RpcError};

/// Events that are kept while an answer is waited for; the oldest are dropped beyond.
const KEPT_EVENTS: usize = 1024;

/// Why a call gave no reply.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// Nothing listens on the socket.
    #[error("no daemon is running (nothing listens on {}); start one with `sculptd run`",
        path.display())]
    Absent {
        /// The socket.
        path: PathBuf,
    },
    /// The socket is in a folder of the temporary directory that other users can access: any user's
    /// program may listen there.
    #[error("{}: {why}", path.display())]
    Foreign {
        /// The socket.
        path: PathBuf,
        /// The fault of the folder.
        why: String,
    },
    /// The daemon did not answer in time, or closed the connection.
    #[error("{}: the daemon did not answer: {source}", path.display())]
    Silent {
        /// The socket.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The daemon refused the request.
    #[error("the daemon refused: {0}")]
    Refused(RpcError),
    /// The answer is not what the protocol says.
    #[error("the daemon's answer does not fit the protocol: {0}")]
    Malformed(String),
}

/// A connection to a running daemon.
///
/// ```no_run
/// use std::time::Duration;
/// use sculptd_control::client::{Client, default_path};
/// use sculptd_control::method::Status;
///
/// let mut client = Client::connect(&default_path(), Duration::from_secs(5))?;
/// client.hello()?;
/// println!("tick {}", client.call::<Status>(&Default::default())?.tick);
/// # Ok::<(), sculptd_control::client::ClientError>(())
/// ```
#[derive(Debug)]
pub struct Client {
    path: PathBuf,
    lines: BufReader<UnixStream>,
    patience: Duration,
    sent: u64,
    events: VecDeque<EventNotice>,
}

impl Client {
    /// Connects. `patience` bounds each read and each write.
    ///
    /// # Errors
    /// [`ClientError::Absent`] where nothing listens, [`ClientError::Foreign`] where another user
    /// may.
    pub fn connect(path: &Path, patience: Duration) -> Result<Self, ClientError> {
        if let Some(why) = foreign_folder(path) {
            return Err(ClientError::Foreign { path: path.into(), why });
        }
        let stream =
            UnixStream::connect(path).map_err(|_| ClientError::Absent { path: path.into() })?;
        let silent = |source| ClientError::Silent { path: path.into(), source };
        stream.set_read_timeout(Some(patience)).map_err(silent)?;
        stream.set_write_timeout(Some(patience)).map_err(silent)?;
        let (path, lines, events) = (path.into(), BufReader::new(stream), VecDeque::new());
        Ok(Client { path, lines, patience, sent: 0, events })
    }

    /// Agrees on a version with the daemon.
    ///
    /// # Errors
    /// [`ClientError::Refused`] where there is none in common, and where the daemon is of version
    /// 1, which does not know `hello`.
    pub fn hello(&mut self) -> Result<HelloReply, ClientError> {
        self.call::<Hello>(&HelloParams { versions: Some(Versions::OURS) })
    }

    /// Calls a method and waits for its reply.
    ///
    /// # Errors
    /// The daemon refuses, does not answer in time, or gives an unexpected answer.
    pub fn call<M: Method>(&mut self, params: &M::Params) -> Result<M::Reply, ClientError> {
        let malformed = |e: serde_json::Error| ClientError::Malformed(e.to_string());
        let params = serde_json::to_value(params).map_err(malformed)?;
        let reply = self.call_by_name(M::NAME, params)?;
        serde_json::from_value(reply).map_err(malformed)
    }

    /// Calls a method by its name, with any parameters, and waits for its reply.
    ///
    /// # Errors
    /// As [`Client::call`].
    pub fn call_by_name(&mut self, method: &str, params: Value) -> Result<Value, ClientError> {
        self.sent += 1;
        let request = Envelope::new(self.sent, method, params);
        let mut line = serde_json::to_vec(&request)
            .map_err(|e| ClientError::Malformed(format!("the request: {e}")))?;
        line.push(b'\n');
        // A daemon that refuses a connection answers before it reads and closes: its answer is
        // worth more than the failed write.
        let written = self.lines.get_mut().write_all(&line);
        loop {
            let answer = match self.line(self.patience) {
                Ok(line) => line,
                Err(e) => return Err(written.err().map_or(e, |source| self.silent(source))),
            };
            if self.keep_event(&answer) {
                continue;
            }
            let response: Response = serde_json::from_value(answer)
                .map_err(|e| ClientError::Malformed(e.to_string()))?;
            // An answer to an earlier request, which nobody waited for any more. A refusal without
            // an id is about the line or the connection.
            if !response.id.is_null() && response.id != self.sent {
                continue;
            }
            return match (response.result, response.error) {
                (Some(value), None) => Ok(value),
                (_, Some(e)) => Err(ClientError::Refused(e)),
                // `null` is a result too.
                (None, None) => Ok(Value::Null),
            };
        }
    }

    /// The next event, after `subscribe`; `None` where none comes within `patience`.
    ///
    /// # Errors
    /// The daemon has closed the connection or sends something unexpected.
    pub fn next_event(&mut self, patience: Duration) -> Result<Option<EventNotice>, ClientError> {
        use std::io::ErrorKind::{TimedOut, WouldBlock};
        if let Some(event) = self.events.pop_front() {
            return Ok(Some(event));
        }
        let line = match self.line(patience) {
            Err(ClientError::Silent { source, .. })
                if matches!(source.kind(), WouldBlock | TimedOut) =>
            {
                return Ok(None);
            }
            line => line?,
        };
        self.keep_event(&line);
        Ok(self.events.pop_front())
    }

    fn silent(&self, source: std::io::Error) -> ClientError {
        ClientError::Silent { path: self.path.clone(), source }
    }

    /// Keeps a line that is an event; `false` where it is not one.
    fn keep_event(&mut self, line: &Value) -> bool {
        if line["method"] != "event" {
            return false;
        }
        // An event of a newer daemon that this crate has no type for is passed over.
        if let Ok(notice) = serde_json::from_value(line["params"].clone()) {
            if self.events.len() == KEPT_EVENTS {
                self.events.pop_front();
            }
            self.events.push_back(notice);
        }
        true
    }

    fn line(&mut self, patience: Duration) -> Result<Value, ClientError> {
        let path = self.path.clone();
        let silent = |source| ClientError::Silent { path: path.clone(), source };
        self.lines.get_ref().set_read_timeout(Some(patience)).map_err(silent)?;
        let mut line = Vec::new();
        self.lines.by_ref().take(MAX_REPLY).read_until(b'\n', &mut line).map_err(silent)?;
        if line.is_empty() {
            return Err(silent(std::io::ErrorKind::UnexpectedEof.into()));
        }
        serde_json::from_slice(&line).map_err(|e| {
            let text = String::from_utf8_lossy(&line[..line.len().min(200)]).into_owned();
            ClientError::Malformed(format!("{e}: {}", text.trim()))
        })
    }
}

/// Connects, calls one method by its name, and disconnects. `patience` bounds each read.
///
/// # Errors
/// As [`Client::call`].
pub fn call(
    path: &Path,
    method: &str,
    params: &Value,
    patience: Duration,
) -> Result<Value, ClientError> {
    Client::connect(path, patience)?.call_by_name(method, params.clone())
}

/// Returns the default socket path of a daemon: `$XDG_RUNTIME_DIR/sculptd.sock`, else in the user's
/// folder under the temporary folder.
pub fn default_path() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(dir) if !dir.is_empty() => PathBuf::from(dir).join("sculptd.sock"),
        _ => std::env::temp_dir().join(format!("sculptd-{}", user_id())).join("sculptd.sock"),
    }
}

/// Returns the fault of the fallback folder in the temporary directory, if the socket is in it:
/// another user may have made it, or may put a socket into it.
pub fn foreign_folder(path: &Path) -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    let folder = path.parent()?;
    let own = format!("sculptd-{}", user_id());
    if folder.parent() != Some(&std::env::temp_dir()) || folder.file_name()? != own.as_str() {
        return None;
    }
    // A missing folder belongs to nobody.
    let about = std::fs::symlink_metadata(folder).ok()?;
    let remedy = "set XDG_RUNTIME_DIR to a folder of your own";
    if !about.is_dir() || about.uid() != user_id() {
        return Some(format!("the folder belongs to another user; {remedy}"));
    }
    (about.mode() & 0o077 != 0).then(|| format!("the folder is open to others; {remedy}"))
}

/// The user that this process runs as, from `/proc/self/status`, which needs no system call that
/// the standard library lacks. Without `/proc` the owner of the home folder, else 0.
pub fn user_id() -> u32 {
    use std::os::unix::fs::MetadataExt;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let real = status
        .lines()
        .find_map(|line| line.strip_prefix("Uid:")?.split_ascii_whitespace().next()?.parse().ok());
    let of_home = || Some(PathBuf::from(std::env::var_os("HOME")?).metadata().ok()?.uid());
    real.or_else(of_home).unwrap_or(0)
}
