//! A virtual hand tracker: serves frames over a loopback WebSocket as the real service does.
//!
//! Unlike the services seen in the wild it binds the loopback interface only, lets in no web page
//! whose origin is not on a list, and reads no message longer than 4 KiB.

mod encode;
mod server;

use std::net::SocketAddr;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use self::server::Server;
use super::faults::{Event, Faults, Line};
use super::hand::HandScript;
use super::jitter::{Jitter, JitterState};
use crate::clock::Clock;
use crate::device_thread::{self, DeviceThread};
use crate::sample::Hands;

pub use self::encode::frame_json;

/// The tracker's own clock at the start of the simulation. Real trackers do not start at 0.
const CLOCK_ORIGIN_US: u64 = 3_600_000_000;

/// Behaviour of a simulated tracker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrackerConfig {
    /// 0: any free port. The real service has 6437.
    pub port: u16,
    /// Frames a second; 110 is what real recordings have.
    pub rate: f32,
    /// Web pages that may connect, as `scheme://host[:port]`. A client that names no origin is no
    /// web page.
    pub origins: Vec<String>,
    /// The script begins again after so long; `None` ends with it: no hands from then on.
    pub repeat_us: Option<u64>,
    /// Faults of its line.
    pub faults: Faults,
    /// Noise and lost hands.
    pub jitter: Jitter,
}

impl Default for TrackerConfig {
    fn default() -> Self {
        TrackerConfig {
            port: 0,
            rate: 110.0,
            origins: Vec::new(),
            repeat_us: None,
            faults: Faults::default(),
            jitter: Jitter::default(),
        }
    }
}

/// The simulated device. Its owner advances it.
#[derive(Debug)]
pub struct Tracker {
    config: TrackerConfig,
    script: HandScript,
    server: Server,
    line: Line<Packet>,
    jitter_state: JitterState,
    next_us: u64,
    frame: i64,
    /// By which the device's clock is off.
    jumped_us: i64,
    stalled_until_us: u64,
    backlog: Vec<Packet>,
    seen: ClientSeen,
}

#[derive(Debug, Clone)]
struct Packet {
    text: String,
    frame: i64,
    stamp: u64,
    hands: u8,
}

/// Frames that a correct client has received so far, to count the expected samples.
#[derive(Debug, Default)]
struct ClientSeen {
    last: Option<(i64, u64, u8)>,
}

impl ClientSeen {
    fn packet(&mut self, p: &Packet) -> u32 {
        if let Some((frame, stamp, _)) = self.last
            && (0..100).contains(&(frame - p.frame))
            && p.stamp <= stamp
        {
            return 0;
        }
        self.last = Some((p.frame, p.stamp, p.hands));
        1
    }

    /// The connection broke: a client reports that the hands have left.
    fn disconnected(&mut self) -> u32 {
        u32::from(self.last.take().is_some_and(|(_, _, hands)| hands > 0))
    }
}

impl Tracker {
    /// Binds its port; frames come with [`Tracker::advance`].
    ///
    /// # Errors
    /// If the port is taken or no thread can be started.
    pub fn new(script: HandScript, config: TrackerConfig) -> std::io::Result<Self> {
        let server = Server::bind(config.port, config.origins.clone())?;
        let line = Line::new(config.faults);
        let jitter_state = JitterState::new(config.jitter);
        Ok(Tracker {
            config,
            script,
            server,
            line,
            jitter_state,
            next_us: 0,
            frame: 0,
            jumped_us: 0,
            stalled_until_us: 0,
            backlog: Vec::new(),
            seen: ClientSeen::default(),
        })
    }

    /// Returns its address.
    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// The URL that a client is configured with.
    pub fn url(&self) -> String {
        format!("ws://{}/v6.json", self.address())
    }

    /// Waits until a client has connected; false if none has come in time.
    pub fn wait_for_client(&self, patience: Duration) -> bool {
        self.server.wait_for_clients(1, patience)
    }

    /// Returns the number of connected clients.
    pub fn clients(&self) -> usize {
        self.server.clients()
    }

    /// Every request that clients have sent, in order.
    pub fn requests(&self) -> Vec<String> {
        self.server.requests()
    }

    /// Every client is cut off, as when the service stops.
    pub fn unplug(&mut self) -> u32 {
        self.server.cut();
        self.seen.disconnected()
    }

    /// Sends a message that is not this simulator's own: for trying what a broken server may say.
    pub fn send_raw(&mut self, text: &str) {
        self.server.send(text);
    }

    /// Leaves out everything before `us`: the simulation goes on from there.
    pub fn skip_to(&mut self, us: u64) {
        self.next_us = self.next_us.max(us);
    }

    /// Sends every frame due up to `until_us`, that one included, since the simulation began. Gives
    /// how many samples must come out of one client's adaptor for them; that holds for steps of at
    /// most half a second (more frames at once are over the adaptor's cap on the rate).
    pub fn advance(&mut self, until_us: u64) -> u32 {
        let step = (1e6 / f64::from(self.config.rate.clamp(1.0, 10_000.0))) as u64;
        let mut expected = 0;
        while self.next_us <= until_us {
            let at = self.next_us;
            self.next_us += step;
            self.frame += 1;
            let stamp = (CLOCK_ORIGIN_US + self.jitter_state.stamp(at))
                .saturating_add_signed(self.jumped_us);
            let hands = self.hands_at(at);
            let text = frame_json(&hands, stamp, self.config.rate);
            let packet = Packet { text, frame: self.frame, stamp, hands: hands.count };
            let mut events = Vec::with_capacity(4);
            self.line.transmit(packet, |e| events.push(e));
            for event in events {
                expected += self.apply(event, at);
            }
        }
        if until_us >= self.stalled_until_us {
            expected += self.end_stall();
        }
        self.server.listen();
        expected
    }

    fn hands_at(&mut self, at: u64) -> Hands {
        let at = self.config.repeat_us.filter(|p| *p > 0).map_or(at, |p| at % p);
        self.jitter_state.apply(&self.script.at(at, self.frame))
    }

    fn apply(&mut self, event: Event<Packet>, at: u64) -> u32 {
        match event {
            Event::Stall(us) => self.stalled_until_us = at + us,
            Event::ClockJump(us) => self.jumped_us = self.jumped_us.saturating_add(us),
            Event::Unplug => return self.unplug(),
            Event::Torn(p, share) => {
                let cut = ((p.text.len() as f32 * share) as usize).min(p.text.len() - 1);
                self.server.send(&p.text[..cut]);
            }
            Event::Whole(p) if at < self.stalled_until_us => self.backlog.push(p),
            Event::Whole(p) => {
                let late = self.end_stall();
                return late + self.deliver(&p);
            }
        }
        0
    }

    fn end_stall(&mut self) -> u32 {
        let late = std::mem::take(&mut self.backlog);
        late.iter().map(|p| self.deliver(p)).sum()
    }

    fn deliver(&mut self, p: &Packet) -> u32 {
        if self.server.send(&p.text) == 0 {
            return 0;
        }
        self.seen.packet(p)
    }

    /// Runs by itself on a clock, from now on, for as long as the result lives.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn play(mut self, clock: Clock) -> std::io::Result<Playing> {
        let (address, start) = (self.address(), clock.now_us());
        let thread = device_thread::spawn("sim-tracker", move |stop| {
            while !stop.wait(Duration::from_millis(2)) {
                self.advance(clock.now_us().saturating_sub(start));
            }
        })?;
        Ok(Playing { address, _thread: thread })
    }
}

/// A simulated device that runs by itself; dropping it unplugs it.
#[derive(Debug)]
pub struct Playing {
    /// Its address.
    pub address: SocketAddr,
    _thread: DeviceThread,
}

#[cfg(test)]
mod leapjs_tests;
