//! Ghosts: simulated devices that perform the demo's journal. They speak bytes (HID reports,
//! packets on a pseudo-terminal, frames on a loopback WebSocket), and the same adaptors read them
//! that read real devices.

use std::time::Duration;

use crate::adaptors::DEMO_IDS;
use crate::simulated_loop::Feed;
use sculptd_devices::catalogue::{Catalogue, Found, Identification};
use sculptd_devices::queue::SenderFactory;
use sculptd_devices::{Clock, DeviceId, hid, leap, serial, sim};

/// Ids of the ghosts, apart from those of real devices (see [`super::adaptors`]).
const TABLET: DeviceId = DEMO_IDS[0];
const SERIAL: DeviceId = DEMO_IDS[1];
const HANDS: DeviceId = DEMO_IDS[2];

/// The tablet that the ghost holds: a common one with tilt, hover distance and an eraser.
const MODEL: &str = "Wacom PTK-440";

/// Time limit for an adaptor to find its simulated device on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(20);
/// Time after the journal's last act: long enough to detect that a silent pen has left.
const AFTER_US: u64 = 200_000;

#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    #[error("a simulated {device} could not be started: {source}")]
    Start { device: &'static str, source: std::io::Error },
    #[error("the adaptor did not find the simulated {0}")]
    NotFound(&'static str),
    #[error("the tablet {MODEL} is not in the catalogue")]
    NoTablet,
}

/// The ghosts and the adaptors that read them, connected.
#[derive(Debug)]
struct DemoDevices {
    tablet: sim::SimTablet,
    serial: sim::SerialPen,
    tracker: sim::Tracker,
    adaptors: DemoAdaptors,
    end_us: u64,
}

/// The adaptors that read the ghosts; they stop when this is dropped.
#[derive(Debug)]
pub struct DemoAdaptors {
    _tablet: hid::reader::ReaderHandle,
    _serial: serial::SerialHandle,
    _leap: leap::LeapHandle,
}

fn model(catalogue: &Catalogue) -> Option<Found> {
    match catalogue.identify(&sim::tablet::identity(catalogue, MODEL)?) {
        Identification::Identified(found) => Some(found),
        Identification::Ambiguous(all) => all.into_iter().find(|f| f.tablet.name == MODEL),
        Identification::Declined(_) => None,
    }
}

fn summon(clock: &Clock, factory: &SenderFactory) -> Result<DemoDevices, DemoError> {
    let journal = sim::journal();
    let start = |device| move |source| DemoError::Start { device, source };
    let catalogue = Catalogue::builtin().map_err(|_| DemoError::NoTablet)?;
    let found = model(&catalogue).ok_or(DemoError::NoTablet)?;

    let (tablet, end) = sim::SimTablet::new(&found, journal.pen, sim::TabletConfig::default());
    let descriptor = sim::tablet::descriptor(&found);
    let _tablet = hid::reader::start(
        Box::new(end),
        &found,
        descriptor,
        TABLET,
        clock.clone(),
        factory.sender(),
    )
    .map_err(start("tablet"))?;

    let config = sim::SerialPenConfig::new(serial::Protocol::Isdv4, journal.area_mm);
    let pen = sim::SerialPen::new(journal.serial_pen, config).map_err(start("serial pen"))?;
    let config = serial::SerialConfig {
        port: Some(pen.port().into()),
        protocol: Some(serial::Protocol::Isdv4),
        device: SERIAL,
        ..Default::default()
    };
    let _serial =
        serial::start(config, clock.clone(), factory.sender()).map_err(start("serial pen"))?;

    let tracker = sim::Tracker::new(journal.hands, sim::TrackerConfig::default())
        .map_err(start("tracker"))?;
    let config = leap::LeapConfig { url: tracker.url(), device: HANDS, ..Default::default() };
    let _leap = leap::start(config, clock.clone(), factory.sender()).map_err(start("tracker"))?;

    if !pen.wait_for_reader(PATIENCE) {
        return Err(DemoError::NotFound("serial pen"));
    }
    if !tracker.wait_for_client(PATIENCE) {
        return Err(DemoError::NotFound("tracker"));
    }
    let adaptors = DemoAdaptors { _tablet, _serial, _leap };
    Ok(DemoDevices {
        tablet,
        serial: pen,
        tracker,
        adaptors,
        end_us: journal.duration_us + AFTER_US,
    })
}

/// A simulated device stepped tick by tick.
struct SimFeed<S> {
    sim: S,
    advance: fn(&mut S, u64) -> u32,
    expected: u64,
    now_us: u64,
    end_us: u64,
}

impl<S> SimFeed<S> {
    fn new(sim: S, advance: fn(&mut S, u64) -> u32, end_us: u64) -> Self {
        SimFeed { sim, advance, expected: 0, now_us: 0, end_us }
    }
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

/// The ghosts for a stepped run.
pub fn simulated_feeds(
    clock: &Clock,
    factory: &SenderFactory,
) -> Result<(Vec<Box<dyn Feed>>, DemoAdaptors), DemoError> {
    let g = summon(clock, factory)?;
    let feeds: Vec<Box<dyn Feed>> = vec![
        Box::new(SimFeed::new(g.tablet, sim::SimTablet::advance, g.end_us)),
        Box::new(SimFeed::new(g.serial, sim::SerialPen::advance, g.end_us)),
        Box::new(SimFeed::new(g.tracker, sim::Tracker::advance, g.end_us)),
    ];
    Ok((feeds, g.adaptors))
}

/// A tracker alone, stepped, and the adaptor that reads it: for lessons and tests with a hand of
/// one's own making.
pub fn tracker(
    script: sim::HandScript,
    config: sim::TrackerConfig,
    clock: &Clock,
    factory: &SenderFactory,
) -> Result<(Box<dyn Feed>, leap::LeapHandle), DemoError> {
    let start = |source| DemoError::Start { device: "tracker", source };
    let end_us = script.end_us() + AFTER_US;
    let tracker = sim::Tracker::new(script, config).map_err(start)?;
    let config = leap::LeapConfig { url: tracker.url(), device: HANDS, ..Default::default() };
    let handle = leap::start(config, clock.clone(), factory.sender()).map_err(start)?;
    if !tracker.wait_for_client(PATIENCE) {
        return Err(DemoError::NotFound("tracker"));
    }
    Ok((Box::new(SimFeed::new(tracker, sim::Tracker::advance, end_us)), handle))
}

/// Ghosts that play by themselves; they are gone when this is dropped.
#[derive(Debug)]
pub struct Playing {
    _tablet: sim::tablet::PlayingTablet,
    _serial: sim::serial::PlayingPen,
    _tracker: sim::tracker::Playing,
    _adaptors: DemoAdaptors,
    /// Microseconds on the clock at which the journal is over.
    pub ends_us: u64,
}

/// The ghosts for a live loop, from now on.
pub fn playing(clock: &Clock, factory: &SenderFactory) -> Result<Playing, DemoError> {
    let g = summon(clock, factory)?;
    let start = |device| move |source| DemoError::Start { device, source };
    Ok(Playing {
        ends_us: clock.now_us() + g.end_us,
        _tablet: g.tablet.play(clock.clone()).map_err(start("tablet"))?,
        _serial: g.serial.play(clock.clone()).map_err(start("serial pen"))?,
        _tracker: g.tracker.play(clock.clone()).map_err(start("tracker"))?,
        _adaptors: g.adaptors,
    })
}
