//! The live tracker: connects, greets, reads frames, and comes back when the server does.

use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error as WsError, Message as WsMessage, WebSocket};

use super::bounded_stream::{BoundedStream, SLICE};
use super::clock_map::ClockMap;
use super::frame::{Frame, MAX_MESSAGE, Message, parse_message};
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread, StopToken};
use crate::queue::Sender;
use crate::sample::{Body, DeviceId, Hands, Sample};

/// For the connection.
const PATIENCE: Duration = Duration::from_secs(1);
/// Silence, on our clock, after which the hands are taken to have left. A tracker that
/// works sends a frame at least each 52 ms (the longest gap in real recordings).
const SILENCE_US: u64 = 300_000;
/// Silence after which the server is asked whether it lives; after twice as much it is given up.
const PING_US: u64 = 3_000_000;
/// First and longest wait before another attempt to connect; it doubles in between.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(8));
/// Life of a connection after which the first wait is the shortest again: a server that sends one
/// good frame and then breaks the rules is not asked four times a second.
const GOOD_LIFE_US: u64 = 5_000_000;
/// Frames that may come at once, before the rate is held to its cap.
const BURST: f64 = 100.0;
/// Messages a second of the machine's time, of whatever kind, and how many may come at once. Beyond
/// it the connection is read more slowly, and the server's sends wait.
const MESSAGES_PER_SECOND: u64 = 5_000;
const MESSAGES_AT_ONCE: u64 = 5_000;
/// Most bytes that wait to be sent to the server.
const WRITE_BYTES: usize = 64 << 10;

/// Address of the tracker's service, and the requests to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LeapConfig {
    /// The service; the path names the protocol's version, `/v6.json` or `/v7.json`.
    pub url: String,
    /// True if a service on another machine may be used. Frames are neither encrypted nor signed.
    pub allow_remote: bool,
    /// Frames wanted while another program has the focus. A sculptor's hands are wanted always.
    pub background: bool,
    /// The tracker is worn on the head and looks down the fingers.
    pub optimize_hmd: bool,
    /// Frames a second beyond which motion is coalesced and counted; transitions never are. The
    /// fastest tracker known gives 200.
    pub max_rate: f32,
    /// Under which id its samples go out.
    #[serde(skip)]
    pub device: DeviceId,
}

impl Default for LeapConfig {
    fn default() -> Self {
        LeapConfig {
            url: "ws://127.0.0.1:6437/v6.json".into(),
            allow_remote: false,
            background: true,
            optimize_hmd: false,
            max_rate: 400.0,
            device: DeviceId(0),
        }
    }
}

/// State of the connection.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LeapStatus {
    /// A server is connected.
    pub connected: bool,
    /// The protocol's version as the server stated it.
    pub version: Option<i64>,
    /// True if a tracker is attached, as the service last reported it.
    pub attached: Option<bool>,
    /// True if the tracker streams, as the service last reported it.
    pub streaming: Option<bool>,
    /// Frames decoded and sent on.
    pub frames: u64,
    /// Messages that gave nothing: not JSON, too large, too deep.
    pub errors: u64,
    /// Frames with `nan` or `inf` in them, used all the same.
    #[serde(rename = "mended")] // The name in status output, which is stable.
    pub repaired: u64,
    /// Frames that repeated or preceded one that was already here.
    pub stale: u64,
    /// Frames over the rate cap; the channel counts them as coalesced.
    pub over_rate: u64,
    /// Hands left out of frames.
    pub dropped_hands: u64,
    /// Times that a connection was made.
    pub connections: u64,
    /// Frames a second, smoothed over about a second.
    pub rate: f32,
    /// Delay of the last frame relative to the quickest one, in microseconds.
    pub delay_us: u64,
    /// Why there is no connection, or what was wrong last.
    pub last_error: Option<String>,
}

/// A running client; dropping it ends its thread.
#[derive(Debug)]
pub struct LeapHandle {
    status: Arc<Mutex<LeapStatus>>,
    _thread: DeviceThread,
}

impl LeapHandle {
    /// A copy of the present state.
    pub fn status(&self) -> LeapStatus {
        self.status.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Starts the client's thread. It goes on trying to connect for as long as the handle lives.
///
/// # Errors
/// Only if no thread can be started.
pub fn start(config: LeapConfig, clock: Clock, sender: Sender) -> std::io::Result<LeapHandle> {
    let status = Arc::new(Mutex::new(LeapStatus::default()));
    let shared = status.clone();
    let thread = device_thread::spawn("leap", move |stop| {
        let mut sender = sender;
        sender.stop_when(stop.flag());
        Client::new(config, clock, sender, shared).run(&stop);
    })?;
    Ok(LeapHandle { status, _thread: thread })
}

struct Client {
    config: LeapConfig,
    clock: Clock,
    sender: Sender,
    status: Arc<Mutex<LeapStatus>>,
    map: ClockMap,
    /// The newest sample of this connection.
    last: Option<Sample>,
    /// Motion over the rate cap: replaced by the next motion, sent before anything else and when
    /// the rate allows it. So the last of a flood arrives, and every frame is counted.
    held: Option<Sample>,
    /// Time of the last frame, on our clock.
    framed_us: u64,
    tokens: f64,
    tokens_at_us: u64,
}

impl Client {
    fn new(
        config: LeapConfig,
        clock: Clock,
        sender: Sender,
        status: Arc<Mutex<LeapStatus>>,
    ) -> Self {
        let tokens_at_us = clock.now_us();
        Client {
            config,
            clock,
            sender,
            status,
            map: ClockMap::default(),
            last: None,
            held: None,
            framed_us: 0,
            tokens: BURST,
            tokens_at_us,
        }
    }

    fn note(&self, change: impl FnOnce(&mut LeapStatus)) {
        change(&mut self.status.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn run(&mut self, stop: &StopToken) {
        let mut wait = BACK_OFF.0;
        while !stop.stopped() {
            let begun = self.clock.now_us();
            let why = match connect(&self.config, stop) {
                Ok(socket) => {
                    self.note(|s| {
                        s.connected = true;
                        s.connections += 1;
                        s.last_error = None;
                    });
                    let before = self.frames();
                    let why = self.serve(socket, stop);
                    let lived = self.clock.now_us().saturating_sub(begun);
                    if self.frames() > before && lived >= GOOD_LIFE_US {
                        wait = BACK_OFF.0;
                    }
                    why
                }
                Err(why) => why,
            };
            self.hands_gone();
            tracing::debug!(url = %self.config.url, %why, "no tracker");
            self.note(|s| {
                s.connected = false;
                s.rate = 0.0;
                s.last_error = Some(why);
            });
            // Kept samples are sent while there is nothing to read.
            let slices = (wait.as_millis() / SLICE.as_millis()) as u32;
            for _ in 0..slices {
                self.sender.flush();
                if stop.wait(SLICE) {
                    return;
                }
            }
            wait = (wait * 2).min(BACK_OFF.1);
        }
        self.hands_gone();
    }

    fn frames(&self) -> u64 {
        self.status.lock().unwrap_or_else(PoisonError::into_inner).frames
    }

    /// Greets, then reads until something ends the connection; returns what did.
    fn serve(&mut self, mut socket: TrackerSocket, stop: &StopToken) -> String {
        self.map = ClockMap::default();
        let (mut heard, mut pinged, mut greeted) = (self.clock.now_us(), false, false);
        let mut rate = MessageRate::begin();
        let (mut whole, mut was_silent) = (false, false);
        while !stop.stopped() {
            if rate.exceeded() {
                self.sender.flush();
                stop.wait(SLICE);
                continue;
            }
            socket.get_mut().begin_read(whole);
            let read = socket.read();
            whole = read.is_ok();
            if whole {
                rate.count();
            }
            match read {
                Ok(WsMessage::Text(text)) => {
                    (heard, pinged) = (self.clock.now_us(), false);
                    if let Err(why) = self.message(&text) {
                        return why;
                    }
                }
                Ok(WsMessage::Close(_)) => return "the server closed the connection".into(),
                // A binary message is none of this protocol's; pings are answered by the library.
                Ok(WsMessage::Binary(_)) => self.note(|s| s.errors += 1),
                Ok(_) => (heard, pinged) = (self.clock.now_us(), false),
                Err(WsError::Io(e)) if waited(&e) => {
                    self.sender.flush();
                    self.send_held();
                    let silence = self.clock.now_us().saturating_sub(heard);
                    if silence >= 2 * PING_US {
                        return "the server fell silent".into();
                    }
                    if silence >= PING_US && !std::mem::replace(&mut pinged, true) {
                        // A failure shows in the next read.
                        let _ = socket.send(WsMessage::Ping(Vec::new().into()));
                    }
                }
                Err(e) => return e.to_string(),
            }
            // Whatever else the server sends meanwhile: without frames there are no hands. Seen
            // twice, so that a process that was stopped reads first what came meanwhile.
            let silent = self.clock.now_us().saturating_sub(self.framed_us) >= SILENCE_US;
            if silent && was_silent {
                self.hands_gone();
            }
            was_silent = silent;
            if !greeted && (self.last.is_some() || self.version().is_some()) {
                greeted = true;
                // A server that refuses the settings may still send frames.
                if let Err(why) = self.greet(&mut socket) {
                    tracing::debug!(%why, "greeting not taken");
                }
            }
        }
        let _ = socket.close(None);
        "stopped".into()
    }

    fn version(&self) -> Option<i64> {
        self.status.lock().unwrap_or_else(PoisonError::into_inner).version
    }

    /// One setting a message, each under 32 bytes: one known server copies them into a buffer of
    /// that size.
    fn greet(&self, socket: &mut TrackerSocket) -> Result<(), WsError> {
        let (background, hmd) = (self.config.background, self.config.optimize_hmd);
        for wish in [
            format!(r#"{{"background":{background}}}"#),
            format!(r#"{{"optimizeHMD":{hmd}}}"#),
            r#"{"focused":true}"#.into(),
        ] {
            socket.send(WsMessage::text(wish))?;
        }
        Ok(())
    }

    fn message(&mut self, text: &str) -> Result<(), String> {
        match parse_message(text) {
            Ok(Message::Frame(frame)) => self.frame(&frame),
            Ok(Message::Version(version)) => {
                if version.is_some_and(|v| v != 6 && v != 7) {
                    return Err(format!(
                        "the server speaks version {}, not 6 or 7",
                        version.unwrap_or(0)
                    ));
                }
                self.note(|s| s.version = version);
            }
            Ok(Message::Device { attached, streaming }) => {
                self.note(|s| {
                    s.attached = attached.or(s.attached);
                    s.streaming = streaming.or(s.streaming);
                });
                if attached == Some(false) || streaming == Some(false) {
                    self.hands_gone();
                }
            }
            Ok(Message::Other) => {}
            Err(why) => self.note(|s| {
                s.errors += 1;
                s.last_error = Some(why.to_string());
            }),
        }
        Ok(())
    }

    fn frame(&mut self, frame: &Frame) {
        let now = self.clock.now_us();
        self.framed_us = now;
        if self.is_stale(frame) {
            return self.note(|s| s.stale += 1);
        }
        let t_us = self.map.map(frame.device_t_us, now);
        let sample = Sample {
            device: self.config.device,
            t_us,
            device_t_us: frame.device_t_us,
            body: Body::Hands(frame.hands),
        };
        let moved = self.last.is_some_and(|l| sample.only_moved_since(&l));
        let since = self.last.map(|l| t_us.saturating_sub(l.t_us));
        self.last = Some(sample);
        let within = self.within_rate(now);
        if moved && self.held.take().is_some() {
            self.sender.count_coalesced(sample.device);
        }
        if moved && !within {
            self.held = Some(sample);
            return self.note(|s| s.over_rate += 1);
        }
        if let Some(before) = self.held.take() {
            self.sender.push(before);
        }
        self.sender.push(sample);
        let delay = self.map.delay_us(now);
        self.note(|s| {
            s.frames += 1;
            s.repaired += u64::from(frame.repaired);
            s.dropped_hands += u64::from(frame.dropped_hands);
            s.delay_us = delay;
            if let Some(us) = since.filter(|us| *us > 0) {
                // One hundredth a frame: about a second at the usual rate.
                s.rate += (1e6 / us as f32 - s.rate) * if s.rate == 0.0 { 1.0 } else { 0.01 };
            }
        });
    }

    /// A frame that came twice or out of order adds nothing: each holds the whole state, and the
    /// newer one is here. A number far back is a tracker that started again.
    fn is_stale(&self, frame: &Frame) -> bool {
        let Some(Sample { body: Body::Hands(last), device_t_us, .. }) = self.last else {
            return false;
        };
        let back = last.frame.saturating_sub(frame.hands.frame);
        let older = frame.device_t_us.zip(device_t_us).is_none_or(|(new, old)| new <= old);
        (0..100).contains(&back) && frame.hands.frame != 0 && older
    }

    /// A bucket of tokens: filled at the capped rate, emptied by frames.
    fn within_rate(&mut self, now: u64) -> bool {
        let passed = now.saturating_sub(self.tokens_at_us) as f64 / 1e6;
        self.tokens_at_us = now;
        self.tokens = (self.tokens + passed * f64::from(self.config.max_rate.max(1.0))).min(BURST);
        let within = self.tokens >= 1.0;
        if within {
            self.tokens -= 1.0;
        }
        within
    }

    /// Sends the motion that was over the rate, as soon as the rate allows it.
    fn send_held(&mut self) {
        if self.held.is_some()
            && self.within_rate(self.clock.now_us())
            && let Some(sample) = self.held.take()
        {
            self.sender.push(sample);
        }
    }

    /// Sends a sample without hands if the last one had any.
    fn hands_gone(&mut self) {
        if let Some(sample) = self.held.take() {
            self.sender.push(sample);
        }
        let Some(Sample { body: Body::Hands(last), .. }) = self.last else { return };
        self.last = None;
        if last.count > 0 {
            self.sender.push(Sample {
                device: self.config.device,
                t_us: self.clock.now_us(),
                device_t_us: None,
                body: Body::Hands(Hands { frame: last.frame, ..Hands::default() }),
            });
        }
    }
}

fn waited(e: &std::io::Error) -> bool {
    matches!(
        e.kind(),
        std::io::ErrorKind::WouldBlock
            | std::io::ErrorKind::TimedOut
            | std::io::ErrorKind::Interrupted
    )
}

/// A connection to a tracker's service.
type TrackerSocket = WebSocket<BoundedStream>;

/// Messages of one connection over the machine's time.
#[derive(Debug)]
struct MessageRate {
    clock: Clock,
    /// Time up to which the messages that came have used the rate, microseconds.
    used_us: u64,
}

impl MessageRate {
    fn begin() -> Self {
        MessageRate { clock: Clock::monotonic(), used_us: 0 }
    }

    fn count(&mut self) {
        self.used_us = self.used_us.max(self.clock.now_us()) + 1_000_000 / MESSAGES_PER_SECOND;
    }

    fn exceeded(&self) -> bool {
        let ahead = MESSAGES_AT_ONCE * 1_000_000 / MESSAGES_PER_SECOND;
        self.used_us > self.clock.now_us() + ahead
    }
}

/// Connects and shakes hands, every step with a time-out; `stop` ends it too.
fn connect(config: &LeapConfig, stop: &StopToken) -> Result<TrackerSocket, String> {
    let request =
        config.url.as_str().into_client_request().map_err(|e| format!("{}: {e}", config.url))?;
    if request.uri().scheme_str() != Some("ws") {
        return Err(format!("{}: only ws:// is spoken", config.url));
    }
    let host = request.uri().host().unwrap_or_default().trim_matches(['[', ']']);
    let port = request.uri().port_u16().unwrap_or(80);
    let places = (host, port).to_socket_addrs().map_err(|e| format!("{host}:{port}: {e}"))?;
    let allowed = |a: &SocketAddr| config.allow_remote || IpAddr::is_loopback(&a.ip());
    let place = places.into_iter().find(allowed).ok_or_else(|| {
        format!(
            "{host} is another machine, and trackers are read from this one only. Forward \
                 port {port} here, for example with ssh -L"
        )
    })?;
    let stream =
        TcpStream::connect_timeout(&place, PATIENCE).map_err(|e| format!("{place}: {e}"))?;
    let limits = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE))
        .max_frame_size(Some(MAX_MESSAGE))
        .read_buffer_size(32 * 1024)
        .write_buffer_size(0)
        .max_write_buffer_size(WRITE_BYTES);
    let stream = BoundedStream::new(stream, stop.clone()).map_err(|e| format!("{place}: {e}"))?;
    let (socket, _) = tungstenite::client::client_with_config(request, stream, Some(limits))
        .map_err(|e| format!("{place}: {e}"))?;
    Ok(socket)
}

#[cfg(test)]
#[path = "client_tests.rs"]
mod tests;
