//! Checks whether a client may ask, and builds the answer to a request.

use std::fs::File;
use std::io::Read;
use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use hyper::body::{Body, Bytes, Frame, SizeHint};
use hyper::header::{self, HeaderMap, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};

use super::bounds::{OutgoingRate, PIECE};
use super::upgrade::Upgrade;

/// Why a request gets nothing, in words for its sender.
pub type Refusal = (StatusCode, &'static str);

/// Answer to a request.
#[derive(Debug)]
pub struct Answer {
    status: StatusCode,
    kind: &'static str,
    content: Content,
    /// Value of `Content-Security-Policy`.
    policy: &'static str,
    /// What follows on the same connection.
    pub(super) upgrade: Option<Upgrade>,
}

/// Policy of an answer that loads nothing.
const LOADS_NOTHING: &str = "default-src 'none'; style-src 'unsafe-inline'";

#[derive(Debug)]
enum Content {
    Text(Bytes),
    File { file: File, bytes: u64 },
}

impl Answer {
    /// Status 200 with a text of this media type.
    pub fn text(kind: &'static str, text: String) -> Self {
        Answer::of(StatusCode::OK, kind, Content::Text(text.into()))
    }

    /// Status 200 with bytes of the program, which may load what this policy names.
    pub fn of_program(kind: &'static str, bytes: &'static [u8], policy: &'static str) -> Self {
        let content = Content::Text(Bytes::from_static(bytes));
        Answer { policy, ..Answer::of(StatusCode::OK, kind, content) }
    }

    /// Status 200 with a page that may load what this policy names.
    pub fn page(text: String, policy: &'static str) -> Self {
        Answer { policy, ..Answer::text("text/html; charset=utf-8", text) }
    }

    /// Status 101: the connection speaks another protocol from now on.
    pub fn switched(upgrade: Upgrade) -> Self {
        let nothing = Content::Text(Bytes::new());
        let switched = StatusCode::SWITCHING_PROTOCOLS;
        Answer { upgrade: Some(upgrade), ..Answer::of(switched, "", nothing) }
    }

    fn of(status: StatusCode, kind: &'static str, content: Content) -> Self {
        Answer { status, kind, content, policy: LOADS_NOTHING, upgrade: None }
    }

    /// Status 200 with the bytes that the file has now.
    ///
    /// # Errors
    /// Returns the system's error for the file.
    pub fn file(kind: &'static str, path: &Path) -> std::io::Result<Self> {
        let file = File::open(path)?;
        let facts = file.metadata()?;
        if !facts.is_file() {
            return Err(std::io::Error::other("not a regular file"));
        }
        let content = Content::File { file, bytes: facts.len() };
        Ok(Answer::of(StatusCode::OK, kind, content))
    }

    /// The response with the headers that keep a browser from guessing, storing and telling.
    pub(super) fn respond(self, pace: Arc<OutgoingRate>) -> Response<Pieces> {
        let mut response =
            Response::new(Pieces { rest: self.content.into(), pace, wait: None, reserved: false });
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        if let Some(upgrade) = &self.upgrade {
            upgrade.set_headers(headers);
            return response;
        }
        let mut set = |name, value| headers.insert(name, HeaderValue::from_static(value));
        set(header::CONNECTION, "close");
        set(header::CONTENT_TYPE, self.kind);
        set(header::X_CONTENT_TYPE_OPTIONS, "nosniff");
        set(header::REFERRER_POLICY, "no-referrer");
        set(header::CACHE_CONTROL, "no-store");
        set(header::CONTENT_SECURITY_POLICY, self.policy);
        response
    }
}

impl From<Refusal> for Answer {
    fn from((status, why): Refusal) -> Self {
        let content = Content::Text(format!("{why}\n").into());
        Answer::of(status, "text/plain; charset=utf-8", content)
    }
}

/// The part of the answer still to be sent.
#[derive(Debug)]
enum Rest {
    Text(Option<Bytes>),
    File { file: File, left: u64 },
}

impl From<Content> for Rest {
    fn from(content: Content) -> Self {
        match content {
            Content::Text(text) => Rest::Text(Some(text).filter(|t| !t.is_empty())),
            Content::File { file, bytes } => Rest::File { file, left: bytes },
        }
    }
}

/// A body that goes out piece by piece, at the pace of all.
#[derive(Debug)]
pub(super) struct Pieces {
    rest: Rest,
    pace: Arc<OutgoingRate>,
    wait: Option<Pin<Box<tokio::time::Sleep>>>,
    /// Time for the next piece is reserved.
    reserved: bool,
}

impl Body for Pieces {
    type Data = Bytes;
    type Error = std::io::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<std::io::Result<Frame<Bytes>>>> {
        let size = match &self.rest {
            Rest::Text(None) | Rest::File { left: 0, .. } => return Poll::Ready(None),
            Rest::Text(Some(text)) => text.len(),
            Rest::File { left, .. } => (*left).min(PIECE as u64) as usize,
        };
        if !self.reserved {
            let time = self.pace.reserve(size);
            self.wait = (!time.is_zero()).then(|| Box::pin(tokio::time::sleep(time)));
            self.reserved = true;
        }
        if let Some(wait) = &mut self.wait
            && wait.as_mut().poll(context).is_pending()
        {
            return Poll::Pending;
        }
        (self.wait, self.reserved) = (None, false);
        Poll::Ready(Some(match &mut self.rest {
            Rest::Text(text) => Ok(Frame::data(text.take().unwrap_or_default())),
            Rest::File { file, left } => {
                let mut piece = vec![0; size];
                // A file that became shorter ends the connection: its reader must not take a part
                // for the whole.
                file.read_exact(&mut piece).map(|()| {
                    *left -= size as u64;
                    Frame::data(piece.into())
                })
            }
        }))
    }

    fn is_end_stream(&self) -> bool {
        matches!(&self.rest, Rest::Text(None) | Rest::File { left: 0, .. })
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(match &self.rest {
            Rest::Text(text) => text.as_ref().map_or(0, |t| t.len() as u64),
            Rest::File { left, .. } => *left,
        })
    }
}

/// The path of a request that may have an answer: a GET of our own host, not by a web page. `at` is
/// where we listen, `name` one more name of ours (empty: none).
///
/// # Errors
/// The refusal that the sender gets.
pub fn permitted<'a>(
    request: &'a Request<()>,
    at: SocketAddr,
    name: &str,
) -> Result<&'a str, Refusal> {
    if request.headers().contains_key(header::ORIGIN) {
        return Err((StatusCode::FORBIDDEN, "no web page may read this"));
    }
    permitted_to_page(request, at, name)
}

/// As [`permitted_to_page`], for a POST: only a page that this server gave out may send it.
///
/// # Errors
/// The refusal that the sender gets.
pub fn permitted_post<'a>(
    request: &'a Request<()>,
    at: SocketAddr,
    name: &str,
) -> Result<&'a str, Refusal> {
    if !request.headers().contains_key(header::ORIGIN) {
        return Err((StatusCode::FORBIDDEN, "only a page of ours may ask for this"));
    }
    permitted_method(request, at, name, &Method::POST)
}

/// As [`permitted`], also for pages that this server gave out: an `Origin` must be our own.
///
/// # Errors
/// The refusal that the sender gets.
pub fn permitted_to_page<'a>(
    request: &'a Request<()>,
    at: SocketAddr,
    name: &str,
) -> Result<&'a str, Refusal> {
    permitted_method(request, at, name, &Method::GET)
}

fn permitted_method<'a>(
    request: &'a Request<()>,
    at: SocketAddr,
    name: &str,
    method: &Method,
) -> Result<&'a str, Refusal> {
    const BAD: Refusal = (StatusCode::BAD_REQUEST, "not a request");
    let headers = request.headers();
    let host = only_host(headers).ok_or(BAD)?;
    if !(ours(host, at) || named(host, at, name)) {
        return Err((StatusCode::FORBIDDEN, "another host was asked for"));
    }
    let mut origins = headers.get_all(header::ORIGIN).iter();
    let own = |o: &HeaderValue| o.to_str().is_ok_and(|o| o.strip_prefix("http://") == Some(host));
    if !origins.all(own) {
        return Err((StatusCode::FORBIDDEN, "a page of another origin may not read this"));
    }
    if request.method() != method {
        return Err((StatusCode::METHOD_NOT_ALLOWED, "not with this method"));
    }
    // A target that names a host is meant for proxies.
    let path = request.uri().path();
    let plain = request.uri().authority().is_none() && path.starts_with('/');
    plain.then_some(path).ok_or(BAD)
}

/// The value of `Host`, if there is exactly one and it is text.
fn only_host(headers: &HeaderMap) -> Option<&str> {
    let mut all = headers.get_all(header::HOST).iter();
    let host = all.next()?.to_str().ok()?.trim();
    all.next().is_none().then_some(host)
}

/// The name that the settings give us, with our port.
fn named(host: &str, at: SocketAddr, name: &str) -> bool {
    !name.is_empty()
        && host.rsplit_once(':').is_some_and(|(n, port)| {
            n.trim_matches(['[', ']']).eq_ignore_ascii_case(name) && port.parse() == Ok(at.port())
        })
}

/// An address that can be ours, or `localhost`, with our port: a name that somebody else gives out
/// is not.
fn ours(host: &str, at: SocketAddr) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
        _ => (host, Some(80)),
    };
    if port != Some(at.port()) {
        return false;
    }
    if name.eq_ignore_ascii_case("localhost") {
        return true;
    }
    let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']')).unwrap_or(name);
    bare.parse::<IpAddr>().is_ok_and(|ip| at.ip().is_unspecified() || ip == at.ip())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(method: &str, target: &str, fields: &[(&str, &str)]) -> Option<u16> {
        let at: SocketAddr = "127.0.0.1:9000".parse().expect("an address");
        let mut request = Request::builder().method(method).uri(target);
        for (name, value) in fields {
            request = request.header(*name, *value);
        }
        let request = request.body(()).expect("a request");
        permitted(&request, at, "").err().map(|(status, _)| status.as_u16())
    }

    #[test]
    fn only_our_own_host_and_no_origin() {
        let host = |host: &str| refusal("GET", "/metrics", &[("host", host)]);
        assert_eq!(host("127.0.0.1:9000"), None);
        assert_eq!(host("LOCALHOST:9000"), None);
        for foreign in [
            "evil.example:9000",
            "127.0.0.1",
            "127.0.0.1:80",
            "localhost.evil.example:9000",
            "10.0.0.1:9000",
            "[::1]:9000",
            "",
        ] {
            assert_eq!(host(foreign), Some(403), "{foreign}");
        }
        let ours = ("host", "127.0.0.1:9000");
        let origin = ("origin", "http://127.0.0.1:9000");
        assert_eq!(refusal("GET", "/metrics", &[ours, origin]), Some(403));
        assert_eq!(refusal("GET", "/metrics", &[ours, ("host", "evil.example")]), Some(400));
        assert_eq!(refusal("GET", "/metrics", &[("accept", "*/*")]), Some(400));
        assert_eq!(refusal("POST", "/metrics", &[ours]), Some(405));
        assert_eq!(refusal("GET", "http://evil.example/metrics", &[ours]), Some(400));
        let page = |origin: &str| {
            let request = Request::builder().uri("/").header("host", "127.0.0.1:9000");
            let request = request.header("origin", origin).body(()).expect("a request");
            let at = "127.0.0.1:9000".parse().expect("an address");
            permitted_to_page(&request, at, "").is_ok()
        };
        assert!(page("http://127.0.0.1:9000"));
        for foreign in ["http://127.0.0.1:9001", "https://127.0.0.1:9000", "null", ""] {
            assert!(!page(foreign), "{foreign}");
        }
        let v6: SocketAddr = "[::]:9000".parse().expect("an address");
        assert!(super::ours("[fe80::1]:9000", v6) && !super::ours("evil.example:9000", v6));
    }
}
