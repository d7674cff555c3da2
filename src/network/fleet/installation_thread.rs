//! An installation's end of the fleet beside its daemon, on a separate thread (`sculptd-fleet`): it
//! measures the published state, and carries out the requests of staff.
//!
//! The daemon never waits for it. A lost network costs it nothing: it keeps measuring, and its
//! publications arrive again when the network is back.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::ArcSwap;

use super::access::state_tag;
use super::fleet_link::InstallationLink;
use super::installation::{Installation, InstallationIdentity, InstallationPort};
use super::request::StaffOrder;
use super::settings_files::{SettingsFiles, TrialStart};
use super::state::{
    DeviceKind, DeviceLine, ErrorCounts, FrameTimes, InstallationState, SettingsState, TickTimes,
    VisitStage, VisitState, shortened,
};
use crate::keyring::Entropy;
use crate::seal::Secret;
use crate::zenoh_link::Endpoints;
use sculptd_daemon::Published;
use sculptd_daemon::adaptors::{Adaptors, DeviceStanding, StandingKind};
use sculptd_daemon::disk_space::free_bytes;
use sculptd_daemon::kiosk::Stage;
use sculptd_daemon::kiosk::desk::KioskDesk;
use sculptd_daemon::kiosk::staff::StaffRequest;
use sculptd_daemon::window_link::{WindowLink, WindowStanding};
use sculptd_devices::Clock;

/// Interval at which changes are measured.
const LOOK: Duration = Duration::from_millis(200);
/// Interval at which disk and devices are checked, in microseconds.
const SLOW_US: u64 = 1_000_000;
/// Bytes of the newest error, and of a device's line.
const MAX_LINE: usize = 500;
/// Lines of devices.
const MAX_DEVICES: usize = 32;
/// Bytes of the log that one answer brings.
const MAX_LOG: usize = 256 << 10;

/// The log of the program, for staff.
pub trait LogLines: Send {
    /// Errors and warnings so far, and the newest error.
    fn counts(&self) -> (u64, u64, Option<String>);
    /// The newest lines, the oldest first.
    fn lines(&self, most: usize) -> Vec<String>;
}

/// Says what is wrong with the text of a settings file.
pub type SettingsCheck = Box<dyn Fn(&str) -> Result<(), String> + Send>;

/// Data that an installation shows to its fleet, and the resources that the fleet may change.
pub struct FleetPart {
    /// The fleet's name.
    pub fleet: String,
    /// The installation's.
    pub name: String,
    /// Its key.
    pub secret: Secret,
    /// Endpoints of the others.
    pub endpoints: Endpoints,
    /// The settings file, and what the start of the program found of a trial.
    pub settings: (SettingsFiles, TrialStart),
    /// Looks at settings before they are tried.
    pub check: SettingsCheck,
    /// The log.
    pub log: Box<dyn LogLines>,
    /// Folder of the sculptures.
    pub gallery: PathBuf,
    /// Seconds since 1970 (UTC) at the start.
    pub started_s: u64,
    /// Random bytes.
    pub entropy: Entropy,
}

impl std::fmt::Debug for FleetPart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut part = f.debug_struct("FleetPart");
        part.field("fleet", &self.fleet).field("name", &self.name).finish_non_exhaustive()
    }
}

/// The parts of a run that the thread observes.
#[derive(Debug)]
pub struct RunInSight {
    /// The loop's newest state.
    pub published: Arc<ArcSwap<Published>>,
    /// The screen of the installation.
    pub desk: Arc<KioskDesk>,
    /// The devices.
    pub adaptors: Arc<Adaptors>,
    /// State of the window.
    pub window: WindowLink,
    /// Ends the run.
    pub stop: Arc<AtomicBool>,
}

/// Starts the thread; it ends with the run.
///
/// # Errors
/// The network or a thread is not available; the text says why.
pub fn start(mut part: FleetPart, run: RunInSight) -> Result<JoinHandle<()>, String> {
    let mut id = [0; 8];
    (part.entropy)(&mut id);
    let id: String = id.iter().map(|b| format!("{b:02x}")).collect();
    let link = InstallationLink::open(&part.fleet, &part.name, &part.endpoints)?;
    let clock = Clock::monotonic();
    let identity = InstallationIdentity {
        name: part.name.clone(),
        secret: part.secret.clone(),
        run: id,
        started_s: part.started_s,
    };
    let (trial, now_us) = (&part.settings.1, clock.now_us());
    let installation = Installation::new(identity, trial, &mut part.entropy, now_us);
    let settings = part.settings.0.state();
    let port = DaemonPort { part, run, settings, slow: None };
    let thread = std::thread::Builder::new().name("sculptd-fleet".into());
    let thread = thread.spawn(move || look_after(installation, port, &link, &clock));
    thread.map_err(|e| format!("no thread: {e}"))
}

fn look_after(
    mut installation: Installation,
    mut port: DaemonPort,
    link: &InstallationLink,
    clock: &Clock,
) {
    while !port.run.stop.load(Relaxed) {
        if let Ok(sealed) = link.requests.recv_timeout(LOOK) {
            let waiting = link.requests.try_iter().take(64);
            for sealed in std::iter::once(sealed).chain(waiting) {
                if let Some(answer) = installation.receive(&sealed, &mut port, clock.now_us()) {
                    link.answer(answer);
                }
            }
        }
        let now_us = clock.now_us();
        let measured = port.measure(now_us);
        if let Some(state) = installation.advance(measured, &mut port, now_us) {
            let json = state.to_json();
            let tag = state_tag(&port.part.secret, &json);
            link.publish(json, &tag);
        }
        if installation.restarts() {
            tracing::info!("the fleet's staff begin a new run with other settings");
            port.run.desk.again.store(true, Relaxed);
            port.run.stop.store(true, Relaxed);
        }
    }
}

/// The daemon as requests see it.
struct DaemonPort {
    part: FleetPart,
    run: RunInSight,
    /// Settings with which the run started.
    settings: SettingsState,
    /// Slow measurements, and their time.
    slow: Option<(u64, Option<u64>, Vec<DeviceLine>)>,
}

impl DaemonPort {
    fn measure(&mut self, now_us: u64) -> InstallationState {
        let state = self.run.published.load();
        let view = self.run.desk.view.lock().unwrap_or_else(PoisonError::into_inner);
        let visit = view.map_or_else(VisitState::default, |v| VisitState {
            stage: match v.stage {
                Stage::Attract | Stage::Farewell | Stage::Closed => VisitStage::Attract,
                Stage::Working => VisitStage::Working,
                Stage::Countdown => VisitStage::Countdown,
            },
            visits: v.visits,
            closed: v.stage == Stage::Closed,
            ..VisitState::default()
        });
        drop(view);
        let facts = self.run.desk.staff.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let (today, kept_today) = (facts.visits_today, facts.kept_today);
        let (mean_s, cleaning) = (facts.mean_s, facts.cleaning);
        let visit = VisitState { today, kept_today, mean_s, cleaning, ..visit };
        let exported = facts.exported.map(|done| match done {
            Ok(file) => file.display().to_string(),
            Err(why) => why,
        });
        let slow = self.slow.take().filter(|(at, ..)| now_us < at + SLOW_US);
        let (at, disk_free_bytes, devices) = slow.unwrap_or_else(|| {
            let lines = self.run.adaptors.standing().into_iter().take(MAX_DEVICES);
            (now_us, free_bytes(&self.part.gallery), lines.map(|d| device_line(&d)).collect())
        });
        self.slow = Some((at, disk_free_bytes, devices.clone()));
        let (errors, warnings, last) = self.part.log.counts();
        let last = last.map(|text| shortened(&text, MAX_LINE).to_owned());
        let figures = &state.figures;
        let latency = self.run.window.present_latency();
        let total = latency.stages().last().filter(|_| latency.frames() > 0);
        InstallationState {
            version: env!("CARGO_PKG_VERSION").into(),
            visit,
            errors: ErrorCounts { errors, warnings, last },
            celsius: facts.celsius,
            exported: exported.map(|text| shortened(&text, MAX_LINE).to_owned()),
            disk_free_bytes,
            devices,
            ticks: TickTimes {
                p50_ms: figures.tick_ms.p50,
                p99_ms: figures.tick_ms.p99,
                max_ms: figures.tick_ms.max,
                late: figures.overruns,
            },
            frames: total.map(|total| FrameTimes {
                count: latency.frames(),
                p50_ms: total.quantiles().p50 as f64 / 1e3,
                p99_ms: total.quantiles().p99 as f64 / 1e3,
            }),
            settings: self.settings.clone(),
            ..InstallationState::default()
        }
    }
}

fn device_line(device: &DeviceStanding) -> DeviceLine {
    let kind = match device.kind {
        StandingKind::Tablet => DeviceKind::Tablet,
        StandingKind::SerialPen => DeviceKind::SerialPen,
        StandingKind::Tracker | StandingKind::Camera => DeviceKind::Tracker,
    };
    let text = shortened(&device.text, MAX_LINE).to_owned();
    DeviceLine { kind, text, connected: device.connected }
}

impl InstallationPort for DaemonPort {
    fn show(&mut self, text: &str) -> Result<String, String> {
        let text: String = text.chars().filter(|c| !c.is_control() || *c == '\n').collect();
        if !text.is_empty() {
            tracing::info!("a message of the fleet's staff: {text}");
            if self.run.window.standing() != WindowStanding::Open {
                return Err("it has no screen: the message is in its log only".into());
            }
        }
        let mut shown = self.run.desk.message.lock().unwrap_or_else(PoisonError::into_inner);
        let (what, text) = match text.is_empty() {
            true => ("nothing is shown", None),
            false => ("it is shown", Some(text)),
        };
        *shown = text;
        Ok(what.into())
    }

    fn restart_visit(&mut self) -> Result<String, String> {
        let view = self.run.desk.view.lock().unwrap_or_else(PoisonError::into_inner);
        if view.is_none_or(|v| !matches!(v.stage, Stage::Working | Stage::Countdown)) {
            return Ok("nobody was there".into());
        }
        drop(view);
        self.run.desk.finished.store(true, Relaxed);
        Ok("the visit ends".into())
    }

    fn staff(&mut self, order: StaffOrder) -> Result<String, String> {
        let (request, note) = match order {
            StaffOrder::Clean => (
                StaffRequest::Cleaning(true),
                "it was told to close for cleaning; the list shows when it has",
            ),
            StaffOrder::Open => {
                (StaffRequest::Cleaning(false), "it was told to open; the list shows when it has")
            }
            StaffOrder::Export if self.part.gallery.as_os_str().is_empty() => {
                return Err("it has no gallery".into());
            }
            StaffOrder::Export => {
                (StaffRequest::Export, "it was told to pack today's works; the list names the file")
            }
            StaffOrder::Restart => (StaffRequest::Restart, "it was told to restart"),
            StaffOrder::End => (StaffRequest::End, "it was told to end for good"),
        };
        self.run.desk.ask_from_fleet(request);
        Ok(note.into())
    }

    fn log_lines(&mut self, most: usize) -> Vec<String> {
        let mut lines = self.part.log.lines(most);
        let mut bytes = 0;
        let fits = |line: &&String| {
            bytes += line.len();
            bytes <= MAX_LOG
        };
        let kept = lines.iter().rev().take_while(fits).count();
        lines.drain(..lines.len() - kept);
        lines
    }

    fn try_settings(&mut self, text: &str, trial_s: u32) -> Result<bool, String> {
        (self.part.check)(text)?;
        self.part.settings.0.try_settings(text, trial_s)
    }

    fn keep_settings(&mut self, revision: &str) -> Result<(), String> {
        self.part.settings.0.keep(revision)?;
        self.settings = self.part.settings.0.state();
        Ok(())
    }

    fn take_back_settings(&mut self, revision: Option<&str>) -> Result<bool, String> {
        let taken = self.part.settings.0.take_back(revision)?;
        if taken {
            tracing::warn!("the settings before these are in place again");
        }
        Ok(taken)
    }
}
