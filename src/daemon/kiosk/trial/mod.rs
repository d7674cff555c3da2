//! `sculptd kiosk try`: causes faults on a running installation and reports what happened.
//!
//! Laws kept here:
//! * A report states only what was seen: the process, the sculpture and the window that answered.
//! * What cannot be caused here is reported as not tried, with the reason.
//! * Everything that a trial changes is undone, also if the process is killed; only the clock needs
//!   the process for that.

mod faults;
mod running;

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use running::Running;
use sculptd_devices::Clock;

/// A fault that is caused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TriedFault {
    /// The program is killed.
    Kill,
    /// The X server is killed.
    Screen,
    /// The disk of the visit's file is full.
    Disk,
    /// The system's clock jumps an hour ahead and back.
    Clock,
    /// The tablet or the tracker is missing.
    Devices,
}

impl TriedFault {
    /// Every fault, in the order of the trials.
    pub const ALL: [TriedFault; 5] = [
        TriedFault::Kill,
        TriedFault::Screen,
        TriedFault::Disk,
        TriedFault::Clock,
        TriedFault::Devices,
    ];

    /// Names the trial.
    pub fn describe(self) -> &'static str {
        match self {
            TriedFault::Kill => "kill the program",
            TriedFault::Screen => "end the X server",
            TriedFault::Disk => "fill the disk",
            TriedFault::Clock => "move the clock",
            TriedFault::Devices => "unplug the devices",
        }
    }
}

/// Outcome of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrialOutcome {
    /// The installation did what the guide promises.
    Passed,
    Failed,
    NotTried,
}

/// A trial and what was seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialReport {
    pub fault: TriedFault,
    pub outcome: TrialOutcome,
    /// The observation, or the reason why it was not tried.
    pub seen: String,
    /// Time that the trial took, seconds.
    pub seconds: f64,
}

/// Why a trial has no good end.
enum TrialEnd {
    Failed(String),
    NotTried(String),
}

/// Settings of the trials.
pub struct TrialSettings<'a> {
    /// The runtime folder of the installation's user, where the program listens.
    pub runtime: &'a Path,
    /// Longest time in which the installation must be back, or report a fault.
    pub patience: Duration,
    /// Moves the system's clock by so many seconds.
    pub move_clock: &'a dyn Fn(i64) -> io::Result<()>,
}

/// Causes these faults, one after the other, and passes each report to `each`. Every trial begins
/// a visit with a stroke.
pub fn run(settings: &TrialSettings, faults: &[TriedFault], each: &mut dyn FnMut(TrialReport)) {
    let clock = Clock::monotonic();
    for &fault in faults {
        let begun = clock.now_us();
        let running = Running::find(settings, &clock);
        let done = running.and_then(|mut running| match fault {
            TriedFault::Kill => faults::kill_program(&mut running),
            TriedFault::Screen => faults::screen(&mut running),
            TriedFault::Disk => faults::disk(&mut running),
            TriedFault::Clock => faults::clock(&mut running),
            TriedFault::Devices => Err(TrialEnd::NotTried(
                "no command unplugs a device: pull its cable, look at the devices on the staff \
                 page, plug it in again"
                    .into(),
            )),
        });
        let (outcome, seen) = match done {
            Ok(seen) => (TrialOutcome::Passed, seen),
            Err(TrialEnd::Failed(why)) => (TrialOutcome::Failed, why),
            Err(TrialEnd::NotTried(why)) => (TrialOutcome::NotTried, why),
        };
        let seconds = (clock.now_us() - begun) as f64 / 1e6;
        each(TrialReport { fault, outcome, seen, seconds });
    }
}

impl std::fmt::Debug for TrialSettings<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TrialSettings").field("runtime", &self.runtime).finish_non_exhaustive()
    }
}

/// Moves the system's clock by so many seconds.
///
/// # Errors
/// The error of the system, as a rule that the right to do it is missing.
pub fn move_system_clock(seconds: i64) -> io::Result<()> {
    use rustix::time::{ClockId, clock_gettime, clock_settime};
    let mut time = clock_gettime(ClockId::Realtime);
    time.tv_sec += seconds;
    Ok(clock_settime(ClockId::Realtime, time)?)
}
