//! The WebSocket end of the virtual tracker.

use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

use crate::device_thread::{self, DeviceThread, StopToken};

/// Nothing that a client may say is longer than a few dozen bytes.
const MAX_FROM_CLIENT: usize = 4096;
const MAX_CLIENTS: usize = 8;
/// Most requests that are kept; later ones are not.
const MAX_REQUESTS: usize = 64;
/// Interval at which waiting connections are accepted.
const ACCEPT_SLICE: Duration = Duration::from_millis(5);
/// For each step of the handshake, and for a frame to be taken.
const PATIENCE: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
struct ServerShared {
    clients: Mutex<Clients>,
    arrived: Condvar,
}

#[derive(Debug, Default)]
struct Clients {
    open: Vec<WebSocket<TcpStream>>,
    requests: Vec<String>,
}

#[derive(Debug)]
pub(super) struct Server {
    address: SocketAddr,
    shared: Arc<ServerShared>,
    _thread: DeviceThread,
}

impl Server {
    pub(super) fn bind(port: u16, origins: Vec<String>) -> std::io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let shared = Arc::new(ServerShared::default());
        let theirs = shared.clone();
        let thread = device_thread::spawn("sim-ws", move |stop| {
            accept(&listener, &origins, &theirs, &stop)
        })?;
        Ok(Server { address, shared, _thread: thread })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    fn lock(&self) -> MutexGuard<'_, Clients> {
        self.shared.clients.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn clients(&self) -> usize {
        self.lock().open.len()
    }

    pub(super) fn requests(&self) -> Vec<String> {
        self.lock().requests.clone()
    }

    pub(super) fn wait_for_clients(&self, n: usize, patience: Duration) -> bool {
        let guard = self.lock();
        let waited = self.shared.arrived.wait_timeout_while(guard, patience, |c| c.open.len() < n);
        waited.unwrap_or_else(PoisonError::into_inner).0.open.len() >= n
    }

    /// Writes to every client and returns how many took it. A client that does not take it is
    /// disconnected.
    pub(super) fn send(&self, text: &str) -> usize {
        let mut clients = self.lock();
        clients.open.retain_mut(|c| c.send(Message::text(text)).is_ok());
        clients.open.len()
    }

    /// Reads the messages that clients have sent since the last call.
    pub(super) fn listen(&self) {
        let mut clients = self.lock();
        let Clients { open, requests } = &mut *clients;
        open.retain_mut(|c| receive(c, requests).is_ok());
    }

    pub(super) fn cut(&self) {
        self.lock().open.clear();
    }
}

fn receive(
    client: &mut WebSocket<TcpStream>,
    requests: &mut Vec<String>,
) -> Result<(), tungstenite::Error> {
    client.get_ref().set_nonblocking(true)?;
    let heard = loop {
        match client.read() {
            Ok(Message::Text(text)) if requests.len() < MAX_REQUESTS => {
                requests.push(text.to_string())
            }
            Ok(Message::Close(_)) => break Err(tungstenite::Error::ConnectionClosed),
            Ok(_) => {}
            Err(tungstenite::Error::Io(e)) if e.kind() == std::io::ErrorKind::WouldBlock => {
                break Ok(());
            }
            Err(e) => break Err(e),
        }
    };
    client.get_ref().set_nonblocking(false)?;
    heard
}

fn accept(listener: &TcpListener, origins: &[String], shared: &ServerShared, stop: &StopToken) {
    while !stop.wait(ACCEPT_SLICE) {
        while let Ok((stream, _)) = listener.accept() {
            match welcome(stream, origins) {
                Ok(client) => {
                    let mut clients = shared.clients.lock().unwrap_or_else(PoisonError::into_inner);
                    if clients.open.len() < MAX_CLIENTS {
                        clients.open.push(client);
                        shared.arrived.notify_all();
                    }
                }
                Err(why) => tracing::debug!(%why, "turned away"),
            }
        }
    }
}

/// Does the WebSocket handshake, then sends the version and the event of an attached tracker.
fn welcome(stream: TcpStream, origins: &[String]) -> Result<WebSocket<TcpStream>, String> {
    let prepared = stream
        .set_nonblocking(false)
        .and_then(|()| stream.set_nodelay(true))
        .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
        .and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
    prepared.map_err(|e| e.to_string())?;
    let limits = WebSocketConfig::default()
        .max_message_size(Some(MAX_FROM_CLIENT))
        .max_frame_size(Some(MAX_FROM_CLIENT));
    let mut version = 6;
    #[allow(clippy::result_large_err)] // The library's callback is of this type.
    let check = |request: &Request, response: Response| match refuse(request, origins) {
        Some(status) => {
            let mut no = ErrorResponse::new(None);
            *no.status_mut() = status;
            Err(no)
        }
        None => {
            version = if request.uri().path() == "/v7.json" { 7 } else { 6 };
            Ok(response)
        }
    };
    let mut client = tungstenite::accept_hdr_with_config(stream, check, Some(limits))
        .map_err(|e| e.to_string())?;
    for hello in [
        format!(r#"{{"serviceVersion":"sculptd","version":{version}}}"#),
        concat!(
            r#"{"event":{"type":"deviceEvent","state":{"attached":true,"id":"SIM","#,
            r#""streaming":true,"type":"peripheral"}}}"#
        )
        .to_owned(),
    ] {
        client.send(Message::text(hello)).map_err(|e| e.to_string())?;
    }
    Ok(client)
}

/// Why a request is not answered: a page of another origin, or a path that is none of the
/// protocol's.
fn refuse(request: &Request, origins: &[String]) -> Option<StatusCode> {
    if let Some(origin) = request.headers().get("origin")
        && !origins.iter().any(|o| o.as_bytes() == origin.as_bytes())
    {
        return Some(StatusCode::FORBIDDEN);
    }
    (!matches!(request.uri().path(), "/v6.json" | "/v7.json")).then_some(StatusCode::NOT_FOUND)
}
