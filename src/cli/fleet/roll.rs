//! `sculptd fleet rollout`.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use super::{FleetArgs, remember};
use crate::cli::{Fail, Outcome, answer};
use sculptd_daemon::kiosk::KioskConfig;
use sculptd_network::fleet::rollout::{Rollout, RolloutEnd, RolloutPlan, RolloutStep};
use sculptd_network::fleet::settings_files::revision_of;

/// An installation that does not answer a step of a roll-out by then does not answer.
const PATIENCE: Duration = Duration::from_secs(20);

pub fn rollout(args: &FleetArgs, file: &Path, canary: &str, watch_s: f64, json: bool) -> Outcome {
    let text = std::fs::read_to_string(file).map_err(|e| Fail::io(file, &e))?;
    let named = |e: String| Fail::Config(format!("{}: {e}", file.display()));
    KioskConfig::parse(&text).map_err(named)?;
    let revision = revision_of(&text).map_err(named)?;
    let (fleet, mut console) = args.console()?;
    let others = console.registry.all().map(|(name, _)| name.to_owned()).collect();
    let (canary, watch_us) = (canary.to_owned(), (watch_s * 1e6) as u64);
    let plan = RolloutPlan { text, revision: revision.clone(), canary, others, watch_us };
    eprintln!("sculptd: rolling out {revision}");
    let mut rollout = Rollout::new(plan, &console.registry, console.now_us());
    let mut asked = BTreeMap::new();
    let end = loop {
        let now_us = console.now_us();
        for step in rollout.advance(&console.registry, now_us) {
            match step {
                RolloutStep::Note(text) => eprintln!("sculptd: {text}"),
                RolloutStep::Ask { installation, action } => {
                    asked.insert(console.ask(&installation, action, PATIENCE), installation);
                }
            }
        }
        if let Some(end) = rollout.end() {
            break end.clone();
        }
        console.advance();
        while let Some((id, end)) = console.take_ended() {
            if let Some(installation) = asked.remove(&id) {
                rollout.ended(&installation, &end);
            }
        }
    };
    remember(&fleet, &console);
    let mut shown = serde_json::to_value(&end).unwrap_or_default();
    shown["revision"] = revision.into();
    answer(json, &shown, |out| match &end {
        RolloutEnd::Kept { kept, missed } => {
            writeln!(out, "kept by {}: {}", kept.len(), kept.join(", "))?;
            match missed.is_empty() {
                true => Ok(()),
                false => writeln!(
                    out,
                    "not there: {}; the same roll-out again brings it to them",
                    missed.join(", ")
                ),
            }
        }
        RolloutEnd::TakenBack { failed, why, taken_back, silent } => {
            writeln!(out, "taken back: {failed}: {why}")?;
            writeln!(out, "as before: {}", taken_back.join(", "))?;
            match silent.is_empty() {
                true => Ok(()),
                false => {
                    writeln!(out, "no answer: {}; their trial ends by itself", silent.join(", "))
                }
            }
        }
    });
    match end {
        RolloutEnd::Kept { .. } => Ok(()),
        RolloutEnd::TakenBack { failed, why, .. } => {
            Err(Fail::Check(format!("taken back, for {failed} failed: {why}")))
        }
    }
}
