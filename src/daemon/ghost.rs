//! Ghosts: simulated devices that perform the demo's journal. They speak bytes (HID reports, packets on a pseudo-terminal,
//! frames on a loopback WebSocket), and the same adaptors read them that read real devices.

use std::time::Duration;

use super::stepped::Feed;
use crate::devices::queue::SenderFactory;
use crate::devices::{Clock, DeviceId, leap, serial, sim};

/// Ids of the ghosts, in the order of their appearance.
const SERIAL: DeviceId = DeviceId(1);
const HANDS: DeviceId = DeviceId(2);

/// How long an adaptor may take to find its simulated device on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(20);

#[derive(Debug, thiserror::Error)]
pub enum GhostError {
    #[error("a simulated {device} could not be started: {source}")]
    Start { device: &'static str, source: std::io::Error },
    #[error("the adaptor did not find the simulated {0}")]
    NotFound(&'static str),
}

/// The adaptors that read the ghosts; they stop when this is dropped.
#[derive(Debug)]
pub struct Adaptors {
    _serial: serial::Handle,
    _leap: leap::Handle,
}

/// A simulated device stepped tick by tick.
struct SimFeed<S> {
    sim: S,
    advance: fn(&mut S, u64) -> u32,
    expected: u64,
    now_us: u64,
    end_us: u64,
}

impl<S> Feed for SimFeed<S> {
    fn advance(&mut self, until_us: u64) -> u64 {
        self.expected += u64::from((self.advance)(&mut self.sim, until_us.min(self.end_us)));
        self.now_us = until_us;
        self.expected
    }

    fn finished(&self) -> bool {
        self.now_us >= self.end_us
    }
}

/// The ghosts for a stepped run, with the adaptors already connected.
pub fn stepped(clock: &Clock, factory: &SenderFactory) -> Result<(Vec<Box<dyn Feed>>, Adaptors), GhostError> {
    let journal = sim::journal();
    let end_us = journal.duration_us + 200_000;
    let start = |device| move |source| GhostError::Start { device, source };

    let config = sim::SerialPenConfig::new(serial::Protocol::Isdv4, journal.area_mm);
    let pen = sim::SerialPen::new(journal.serial_pen, config).map_err(start("serial pen"))?;
    let tracker =
        sim::Tracker::new(journal.hands, sim::TrackerConfig::default()).map_err(start("tracker"))?;

    let config = serial::Config {
        port: Some(pen.port().into()),
        protocol: Some(serial::Protocol::Isdv4),
        device: SERIAL,
        ..Default::default()
    };
    let _serial = serial::start(config, clock.clone(), factory.sender()).map_err(start("serial pen"))?;
    let config = leap::Config { url: tracker.url(), device: HANDS, ..Default::default() };
    let _leap = leap::start(config, clock.clone(), factory.sender()).map_err(start("tracker"))?;
    if !pen.wait_for_reader(PATIENCE) {
        return Err(GhostError::NotFound("serial pen"));
    }
    if !tracker.wait_for_client(PATIENCE) {
        return Err(GhostError::NotFound("tracker"));
    }
    let feeds: Vec<Box<dyn Feed>> = vec![
        Box::new(SimFeed { sim: pen, advance: sim::SerialPen::advance, expected: 0, now_us: 0, end_us }),
        Box::new(SimFeed { sim: tracker, advance: sim::Tracker::advance, expected: 0, now_us: 0, end_us }),
    ];
    Ok((feeds, Adaptors { _serial, _leap }))
}
