//! The connection to a tracker's service, with bounds that the WebSocket library does not have: the
//! time of the handshake, bytes a second, bytes without a whole message, time without a look at the
//! stop flag.
//!
//! The library reads frames in a loop until it has a whole message. A server that sends empty
//! continuation frames for ever (RFC 6455, section 5.4) keeps it in that loop; a server that sends
//! a byte now and then keeps it in the handshake. Every read passes here, so here it ends.

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::TcpStream;
use std::time::Duration;

use crate::clock::Clock;
use crate::device_thread::StopToken;
use crate::leap::frame::MAX_MESSAGE;

/// Timeout of one read or write. It is short, because kept samples are sent and the stop flag is
/// checked in between.
pub(super) const SLICE: Duration = Duration::from_millis(10);
/// The whole handshake, from the connection on.
const HANDSHAKE: Duration = Duration::from_millis(1500);
/// Bytes a second, on average. The fastest tracker known sends 200 frames of 14,000 bytes.
const BYTES_PER_SECOND: u64 = 16 << 20;
/// Bytes that may come at once.
const BURST: u64 = 4 << 20;
/// Bytes after which a message must have been whole: the longest one twice over, for the headers
/// of its frames, and what the library reads ahead.
const WITHOUT_MESSAGE: u64 = 2 * MAX_MESSAGE as u64 + (64 << 10);

#[derive(Debug)]
pub(super) struct BoundedStream {
    stream: TcpStream,
    stop: StopToken,
    /// The machine's own: these bounds are of its time, whatever the samples' clock says.
    clock: Clock,
    phase: Phase,
    /// Since the last whole message.
    bytes: u64,
    /// Time up to which the bytes that came have used the rate, microseconds.
    used_us: u64,
}

#[derive(Debug)]
enum Phase {
    Handshake,
    /// Since when the library has been reading, microseconds.
    Frames(u64),
}

impl BoundedStream {
    /// # Errors
    /// The system's error about the socket's options.
    pub(super) fn new(stream: TcpStream, stop: StopToken) -> Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(SLICE))?;
        stream.set_write_timeout(Some(SLICE))?;
        let clock = Clock::monotonic();
        Ok(BoundedStream { stream, stop, clock, phase: Phase::Handshake, bytes: 0, used_us: 0 })
    }

    /// Call it before each read of the library. `whole`: the last one gave a message.
    pub(super) fn begin_read(&mut self, whole: bool) {
        self.phase = Phase::Frames(self.clock.now_us());
        if whole {
            self.bytes = 0;
        }
    }

    fn check(&self) -> Result<()> {
        if self.stop.stopped() {
            return Err(Error::new(ErrorKind::ConnectionAborted, "stopped"));
        }
        let now = self.clock.now_us();
        match self.phase {
            Phase::Handshake if now >= HANDSHAKE.as_micros() as u64 => {
                Err(Error::new(ErrorKind::TimedOut, "the handshake takes too long"))
            }
            // The caller has had no turn for a while; the library keeps what it has.
            Phase::Frames(since) if now.saturating_sub(since) >= SLICE.as_micros() as u64 => {
                Err(ErrorKind::WouldBlock.into())
            }
            Phase::Frames(_) if self.bytes > WITHOUT_MESSAGE => {
                let text = format!("{WITHOUT_MESSAGE} bytes without a whole message");
                Err(Error::new(ErrorKind::InvalidData, text))
            }
            _ => Ok(()),
        }
    }

    /// Waits while more has come than the rate allows.
    fn hold_rate(&mut self) -> Result<()> {
        let burst_us = BURST * 1_000_000 / BYTES_PER_SECOND;
        while self.used_us > self.clock.now_us() + burst_us {
            self.stop.wait(SLICE);
            self.check()?;
        }
        Ok(())
    }
}

fn is_pause(e: &Error) -> bool {
    matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

impl Read for BoundedStream {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        loop {
            self.check()?;
            self.hold_rate()?;
            match self.stream.read(buffer) {
                Ok(n) => {
                    self.bytes += n as u64;
                    let now = self.clock.now_us();
                    let takes = n as u64 * 1_000_000 / BYTES_PER_SECOND;
                    self.used_us = self.used_us.max(now) + takes;
                    return Ok(n);
                }
                Err(e) if is_pause(&e) => {
                    if matches!(self.phase, Phase::Frames(_)) {
                        return Err(ErrorKind::WouldBlock.into());
                    }
                }
                Err(e) => return Err(e),
            }
        }
    }
}

impl Write for BoundedStream {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        loop {
            match self.stream.write(bytes) {
                Err(e) if is_pause(&e) => {
                    if matches!(self.phase, Phase::Frames(_)) {
                        return Err(ErrorKind::WouldBlock.into());
                    }
                    self.check()?;
                }
                other => return other,
            }
        }
    }

    fn flush(&mut self) -> Result<()> {
        self.stream.flush()
    }
}
