//! Connections that go on as WebSockets (RFC 6455) after the first request.

use std::net::TcpStream;

use hyper::Request;
use hyper::header::{self, HeaderMap, HeaderValue};
use tungstenite::handshake::derive_accept_key;

/// Takes the socket, and what has been read from it beyond the request.
pub type Follow = Box<dyn FnOnce(TcpStream, Vec<u8>) + Send>;

/// The change of a connection to a WebSocket.
pub struct Upgrade {
    accept: HeaderValue,
    follow: Option<Follow>,
}

impl std::fmt::Debug for Upgrade {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Upgrade").finish_non_exhaustive()
    }
}

impl Upgrade {
    /// Accepts a request for a WebSocket. `follow` gets the socket; it must return at once.
    ///
    /// `None`: the request asks for no WebSocket of version 13.
    pub fn accept(request: &Request<()>, follow: Follow) -> Option<Upgrade> {
        let headers = request.headers();
        let has = |name, word: &str| {
            let value = headers.get(name).and_then(|v: &HeaderValue| v.to_str().ok());
            value.is_some_and(|v| v.split(',').any(|w| w.trim().eq_ignore_ascii_case(word)))
        };
        let key = headers.get(header::SEC_WEBSOCKET_KEY)?;
        let asked = has(header::CONNECTION, "upgrade") && has(header::UPGRADE, "websocket");
        if !asked || !has(header::SEC_WEBSOCKET_VERSION, "13") {
            return None;
        }
        let accept = derive_accept_key(key.as_bytes());
        let accept = HeaderValue::from_str(&accept).ok()?;
        Some(Upgrade { accept, follow: Some(follow) })
    }

    pub(super) fn take(&mut self) -> Option<Follow> {
        self.follow.take()
    }

    pub(super) fn set_headers(&self, headers: &mut HeaderMap) {
        headers.insert(header::CONNECTION, HeaderValue::from_static("Upgrade"));
        headers.insert(header::UPGRADE, HeaderValue::from_static("websocket"));
        headers.insert(header::SEC_WEBSOCKET_ACCEPT, self.accept.clone());
    }
}
