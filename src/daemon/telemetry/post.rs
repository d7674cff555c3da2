//! One request to a collector, within a time.

use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use hyper::body::{Body, Incoming};
use hyper::client::conn::http1;
use hyper::header::{CONTENT_TYPE, HOST, HeaderValue, USER_AGENT};
use hyper::{Request, StatusCode};
use hyper_util::rt::TokioIo;

use super::endpoint::Endpoint;

/// Bytes of an answer that are read; more is cut off.
const MAX_ANSWER: usize = 64 << 10;
/// Interval at which a request checks whether to abort.
const STEP: Duration = Duration::from_millis(50);
/// Reported characters of an answer.
const TOLD: usize = 200;

/// Reason that a request failed.
#[derive(Debug, thiserror::Error)]
pub enum PostError {
    /// The collector cannot be reached, or does not answer in time.
    #[error("{0}")]
    Unreachable(String),
    /// The collector refused the request.
    #[error("it answers {0} {1}")]
    Refused(StatusCode, String),
}

impl PostError {
    /// Returns true if the same request may succeed later (OTLP/HTTP, "Retryable Response Codes").
    pub fn may_pass(&self) -> bool {
        match self {
            PostError::Unreachable(_) => true,
            PostError::Refused(status, _) => matches!(status.as_u16(), 429 | 502 | 503 | 504),
        }
    }
}

/// Sends requests one after the other, each over a separate connection.
#[derive(Debug)]
pub struct Poster {
    endpoint: Endpoint,
    runtime: Option<tokio::runtime::Runtime>,
    /// Set to abandon the request in progress.
    ending: Arc<AtomicBool>,
}

impl Drop for Poster {
    fn drop(&mut self) {
        // The look-up of a name cannot be aborted, so it is not waited for.
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl Poster {
    /// A sender.
    ///
    /// # Errors
    /// Returns the system's error for the runtime.
    pub fn new(endpoint: Endpoint) -> std::io::Result<Poster> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        Ok(Poster { endpoint, runtime: Some(runtime), ending: Arc::default() })
    }

    /// Abandons the request in progress once `ending` is set.
    pub fn until(mut self, ending: Arc<AtomicBool>) -> Poster {
        self.ending = ending;
        self
    }

    /// Sends on although it ends.
    pub fn go_on(&mut self) {
        self.ending = Arc::default();
    }

    /// Sends a body of JSON. Waits for at most `patience`, which becomes less by that.
    ///
    /// # Errors
    /// [`PostError`]
    pub fn post(&self, path: &str, body: String, patience: &mut Duration) -> Result<(), PostError> {
        let Some(runtime) = &self.runtime else {
            return Err(PostError::Unreachable("it has ended".into()));
        };
        let (status, answer) = runtime.block_on(async {
            let mut exchange = pin!(exchange(&self.endpoint, path, body));
            loop {
                if let Ok(done) = tokio::time::timeout(STEP, exchange.as_mut()).await {
                    return done;
                }
                *patience = patience.saturating_sub(STEP);
                if patience.is_zero() || self.ending.load(Relaxed) {
                    return Err(PostError::Unreachable("no answer in time".into()));
                }
            }
        })?;
        match status.is_success() {
            true => Ok(()),
            false => Err(PostError::Refused(status, answer.chars().take(TOLD).collect())),
        }
    }
}

async fn exchange(
    endpoint: &Endpoint,
    path: &str,
    body: String,
) -> Result<(StatusCode, String), PostError> {
    let failed = |e: &dyn std::fmt::Display| PostError::Unreachable(e.to_string());
    let stream = tokio::net::TcpStream::connect(&endpoint.authority).await;
    let stream = stream.map_err(|e| failed(&e))?;
    let (mut sender, connection) =
        http1::handshake::<_, String>(TokioIo::new(stream)).await.map_err(|e| failed(&e))?;
    // It ends with its request: the sender is dropped then.
    let driven = tokio::spawn(connection);
    let target = format!("{}{path}", endpoint.path);
    let mut request = Request::post(target)
        .header(HOST, &endpoint.authority)
        .header(CONTENT_TYPE, HeaderValue::from_static("application/json"))
        .header(USER_AGENT, concat!("sculptd/", env!("CARGO_PKG_VERSION")));
    for (name, value) in &endpoint.headers {
        request = request.header(name, value);
    }
    let request = request.body(body).map_err(|e| failed(&e))?;
    let response = sender.send_request(request).await.map_err(|e| failed(&e))?;
    let status = response.status();
    let answer = read(response.into_body()).await;
    driven.abort();
    Ok((status, answer))
}

/// The beginning of an answer, as text.
async fn read(mut body: Incoming) -> String {
    let mut bytes = Vec::new();
    while let Some(Ok(frame)) = poll_fn(|cx| Pin::new(&mut body).poll_frame(cx)).await {
        bytes.extend(frame.into_data().unwrap_or_default());
        if bytes.len() > MAX_ANSWER {
            break;
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
