//! Connections without a place: who has said nothing yet needs none, and who asks something while
//! all places are taken waits until somebody gives way.
//!
//! Newcomers are let in by how little their process has asked lately, then in the order in which
//! they asked. `shutdown` and `cancel` are answered without a place.

use std::collections::VecDeque;
use std::io::Write;
use std::os::unix::net::{UnixListener, UnixStream};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::net::RecvFlags;
use serde_json::Value;

use super::MAX_CLIENTS;
use super::host::Host;
use super::places::{ClientPlace, ClientPlaces};
use sculptd_control::RpcError;
use sculptd_control::method::ALWAYS_ANSWERED;
use sculptd_control::wire::{Envelope, Response, parse};
use sculptd_devices::Clock;

/// Connections that have said nothing, at most; then the oldest is closed.
const MOST_SILENT: usize = 256;
/// Connections that ask and have no place, at most; then a new one is refused.
const MOST_ASKING: usize = 256;
/// Longest wait for a place, in microseconds.
const PATIENCE_US: u64 = 2_000_000;
/// Time between two looks at the places while somebody waits for one.
const LOOK: Duration = Duration::from_millis(2);

const TOO_MANY: &str = "too many clients at a time; only 'shutdown' and 'cancel' are answered";

/// A connection without a place.
#[derive(Debug)]
struct Newcomer {
    stream: UnixStream,
    /// Its process.
    pid: i32,
    /// Time since when it waits for what it waits for, in microseconds.
    since_us: u64,
}

#[derive(Debug)]
pub(super) struct WaitingRoom {
    /// Who has said nothing, oldest first.
    silent: VecDeque<Newcomer>,
    /// Who asks, oldest first.
    asking: VecDeque<Newcomer>,
    places: ClientPlaces,
    clock: Clock,
    idle: Duration,
}

impl WaitingRoom {
    /// `idle`: time after which a connection that says nothing is closed.
    pub fn new(idle: Duration) -> WaitingRoom {
        WaitingRoom {
            silent: VecDeque::new(),
            asking: VecDeque::new(),
            places: ClientPlaces::new(MAX_CLIENTS),
            clock: Clock::monotonic(),
            idle,
        }
    }

    /// Waits until somebody connects, asks or hangs up, or the next look at the places is due.
    pub fn wait(&mut self, listener: &UnixListener) {
        let now = self.clock.now_us();
        let silence = self.silent.front().map(|c| {
            Duration::from_micros((c.since_us + self.idle.as_micros() as u64).saturating_sub(now))
        });
        let most = if self.asking.is_empty() { silence } else { Some(LOOK) };
        let most =
            most.map(|d| Timespec { tv_sec: d.as_secs() as i64, tv_nsec: d.subsec_nanos().into() });
        let speaks: Vec<bool> = {
            let streams = self.silent.iter().map(|c| PollFd::new(&c.stream, PollFlags::IN));
            let mut all: Vec<_> =
                std::iter::once(PollFd::new(listener, PollFlags::IN)).chain(streams).collect();
            // A failed call, as by a signal, is a call in which nobody spoke.
            match poll(&mut all, most.as_ref()) {
                Ok(_) => all[1..].iter().map(|fd| !fd.revents().is_empty()).collect(),
                Err(_) => vec![false; self.silent.len()],
            }
        };
        let now = self.clock.now_us();
        let idle_us = self.idle.as_micros() as u64;
        for (newcomer, speaks) in std::mem::take(&mut self.silent).into_iter().zip(speaks) {
            if speaks && self.asking.len() < MOST_ASKING {
                self.asking.push_back(Newcomer { since_us: now, ..newcomer });
            } else if speaks {
                refuse(&newcomer.stream);
            } else if now < newcomer.since_us + idle_us {
                self.silent.push_back(newcomer);
            }
        }
    }

    /// Closes half of the connections that have said nothing, as no more can be accepted.
    pub fn make_room(&mut self) {
        self.silent.drain(..self.silent.len().div_ceil(2));
        let _ = crossbeam_channel::never::<()>().recv_timeout(LOOK);
    }

    /// A client of process `pid` has connected.
    pub fn enter(&mut self, stream: UnixStream, pid: i32) {
        if self.silent.len() >= MOST_SILENT {
            self.silent.pop_front();
        }
        self.silent.push_back(Newcomer { stream, pid, since_us: self.clock.now_us() });
    }

    /// Answers what needs no place, refuses who has waited too long, and returns whoever can be
    /// served now.
    pub fn next(&mut self, host: &Host) -> Option<(UnixStream, ClientPlace)> {
        let lately = self.places.asked_lately();
        let best = (0..self.asking.len()).min_by_key(|k| lately(self.asking[*k].pid))?;
        let first = &self.asking[best];
        if let Some(place) = self.places.take(first.stream.try_clone().ok(), first.pid) {
            return self.asking.remove(best).map(|served| (served.stream, place));
        }
        let now = self.clock.now_us();
        self.asking.retain(|c| {
            let is_late = now >= c.since_us + PATIENCE_US;
            let asked = match first_request(&c.stream) {
                FirstRequest::Gone => return false,
                FirstRequest::Whole(asked) => asked,
                FirstRequest::Unreadable => {
                    is_late.then(|| refuse(&c.stream));
                    return !is_late;
                }
            };
            let id = asked.id.unwrap_or(Value::Null);
            let needs_none = ALWAYS_ANSWERED.contains(&asked.method.as_str());
            let result = match needs_none {
                true => super::handler::call(host, &asked.method, asked.params),
                false if is_late => Err(RpcError::failed(TOO_MANY)),
                false => return true,
            };
            write_line(&c.stream, &Response::new(id, result));
            false
        });
        None
    }
}

/// The first request of a connection.
enum FirstRequest {
    Whole(Envelope),
    /// It is not there as a whole, too long to be looked at, or wrong.
    Unreadable,
    /// The client has hung up.
    Gone,
}

/// Looks at the first request of a connection, which stays to be read.
fn first_request(stream: &UnixStream) -> FirstRequest {
    let mut start = [0; 512];
    let flags = RecvFlags::PEEK | RecvFlags::DONTWAIT;
    let n = match rustix::net::recv(stream, &mut start[..], flags) {
        Ok((0, _)) => return FirstRequest::Gone,
        Ok((n, _)) => n,
        Err(_) => return FirstRequest::Unreadable,
    };
    let end = start[..n].iter().position(|b| *b == b'\n');
    let asked = end.and_then(|end| parse(start[..end].trim_ascii()).ok());
    asked.map_or(FirstRequest::Unreadable, FirstRequest::Whole)
}

fn refuse(stream: &UnixStream) {
    write_line(stream, &Response::new(Value::Null, Err(RpcError::failed(TOO_MANY))));
}

/// `false`: nobody reads.
pub(super) fn write_line(mut out: &UnixStream, response: &Response) -> bool {
    let Ok(mut bytes) = serde_json::to_vec(response) else { return false };
    bytes.push(b'\n');
    out.write_all(&bytes).is_ok()
}
