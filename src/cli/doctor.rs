//! `sculptd doctor`: whether this machine can sculpt, and what to type where it cannot.

use std::path::PathBuf;

use serde::Serialize;

use super::{Fail, Outcome, answer, display};
use sculptd_daemon::config;
use sculptd_daemon::config::{Config, Resolved};
use sculptd_daemon::doctor;
use sculptd_daemon::doctor::{Check, Places, Verdict};

#[derive(Debug, clap::Args)]
pub struct DoctorArgs {
    /// Lay this file over the usual settings.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct DoctorAnswer {
    good: bool,
    checks: Vec<Check>,
}

pub fn run(args: &DoctorArgs, json: bool) -> Outcome {
    let (settings, first) = match Resolved::load(args.config.as_deref(), crate::presets()) {
        Ok(resolved) => {
            (resolved.config, Check::pass("settings", "every file and key is understood"))
        }
        Err(e) => {
            let repair = "mend the line named, then: sculptd config check";
            (Config::default(), Check::fail("settings", e.to_string(), repair))
        }
    };
    let places = Places {
        dev: "/dev".into(),
        state: config::state_dir(),
        #[cfg(unix)]
        socket: sculptd_daemon::control::default_path(),
        #[cfg(not(unix))]
        socket: PathBuf::new(),
    };
    let mut checks = vec![first];
    checks.push(match display::available() {
        Ok(()) => Check::pass("display", "a window can be opened"),
        Err(why) => Check::warn(
            "display",
            why,
            "log in to a desktop, or go on with: sculptd run --headless",
        ),
    });
    checks.extend(doctor::all(&settings, &places));
    let failed = checks.iter().filter(|c| c.verdict == Verdict::Fail).count();
    let answer_ = DoctorAnswer { good: failed == 0, checks };
    answer(json, &answer_, |out| {
        for c in &answer_.checks {
            let word = match c.verdict {
                Verdict::Pass => "pass",
                Verdict::Warn => "WARN",
                Verdict::Fail => "FAIL",
                Verdict::Skip => "skip",
            };
            writeln!(
                out,
                "{word}  {:<16} {}",
                c.name,
                c.cause.trim_end().replace('\n', "\n      ")
            )?;
            if let Some(repair) = &c.repair {
                writeln!(out, "      {:<16} {repair}", "repair:")?;
            }
        }
        Ok(())
    });
    match failed {
        0 => Ok(()),
        n => Err(Fail::Check(format!("{n} of {} checks failed", answer_.checks.len()))),
    }
}
