//! `sculptd kiosk try`: faults of a running installation, and what happened.

use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_daemon::kiosk::setup;
use sculptd_daemon::kiosk::trial::{self, TrialOutcome, TrialReport, TrialSettings, TriedFault};

#[derive(Debug, clap::Args)]
pub struct TryArgs {
    /// Try only these; may be repeated.
    #[arg(long, value_enum, value_name = "FAULT")]
    pub only: Vec<TriedFault>,
    /// Folder of the program's control socket: its XDG_RUNTIME_DIR.
    #[arg(long, value_name = "FOLDER", default_value = setup::RUNTIME)]
    pub runtime: PathBuf,
    /// Longest time in which the installation must be back, seconds, from 1 to 3600.
    #[arg(long, value_name = "SECONDS", default_value_t = 60,
        value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub patience: u64,
}

#[derive(Debug, Serialize)]
struct TryAnswer {
    trials: Vec<TrialReport>,
}

pub fn run(args: &TryArgs, json: bool) -> Outcome {
    let settings = TrialSettings {
        runtime: &args.runtime,
        patience: Duration::from_secs(args.patience),
        move_clock: &trial::move_system_clock,
    };
    let faults = if args.only.is_empty() { &TriedFault::ALL[..] } else { &args.only };
    let mut trials = Vec::new();
    // A line as soon as it is known: the next trial may take a minute.
    trial::run(&settings, faults, &mut |report| {
        if !json {
            let _ = writeln!(std::io::stdout().lock(), "{}", line(&report));
        }
        trials.push(report);
    });
    let failures = trials.iter().filter(|t| t.outcome == TrialOutcome::Failed).count();
    let all = trials.len();
    if json {
        answer(json, &TryAnswer { trials }, |_| Ok(()));
    }
    match failures {
        0 => Ok(()),
        n => Err(Fail::Check(format!("kiosk try: {n} of {all} trials failed"))),
    }
}

fn line(report: &TrialReport) -> String {
    let word = match report.outcome {
        TrialOutcome::Passed => "as promised",
        TrialOutcome::Failed => "FAILED",
        TrialOutcome::NotTried => "not tried",
    };
    let (what, seconds) = (report.fault.describe(), report.seconds);
    format!("{word:<12} {what}: {} ({seconds:.1} s in all)", report.seen)
}
