//! What `sculptd fleet` prints.

use std::collections::BTreeMap;
use std::io::Write;

use serde_json::{Value, json};

use crate::cli::answer;
use sculptd_network::fleet::registry::{FleetRegistry, RegistryEntry};
use sculptd_network::fleet::request::FleetOutcome;
use sculptd_network::fleet::requester::RequestEnd;
use sculptd_network::fleet::state::{InstallationState, VisitStage};

fn stage(state: &InstallationState) -> &'static str {
    match state.visit.stage {
        _ if state.visit.cleaning => "cleaning",
        VisitStage::Attract if state.visit.closed => "closed",
        VisitStage::Attract => "attract",
        VisitStage::Working => "working",
        VisitStage::Countdown => "countdown",
    }
}

fn duration(seconds: u64) -> String {
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        7200..172_800 => format!("{} h", seconds / 3600),
        _ => format!("{} d", seconds / 86_400),
    }
}

fn entry_json(name: &str, entry: &RegistryEntry) -> Value {
    json!({ "name": name, "here": entry.is_here(), "state": *entry.state })
}

/// The list as a table, or as one object.
pub fn list(fleet: &str, registry: &FleetRegistry, json: bool) {
    let all: Vec<Value> = registry.all().map(|(name, e)| entry_json(name, e)).collect();
    let here = registry.all().filter(|(_, e)| e.is_here()).count();
    let shown = json!({ "fleet": fleet, "here": here, "installations": all });
    answer(json, &shown, |out| {
        let head = [
            "installation",
            "state",
            "today",
            "visits",
            "errors",
            "disk free",
            "devices",
            "tick p99",
        ];
        write!(out, "{:<20} {:<10}", head[0], head[1])?;
        head[2..].iter().try_for_each(|h| write!(out, " {h:>9}"))?;
        writeln!(out, " {:>8}  version  settings", "up")?;
        for (name, e) in registry.all() {
            let s = &*e.state;
            let what = if e.is_here() { stage(s) } else { "LOST" };
            let disk = s.disk_free_bytes.map_or("?".into(), |b| format!("{} GiB", b >> 30));
            let today = s.visit.today;
            let connected = s.devices.iter().filter(|d| d.connected).count();
            writeln!(
                out,
                "{name:<20} {what:<10} {today:>9} {:>9} {:>9} {disk:>9} {:>9} {:>6.2} ms {:>8}  \
                 {:<7}  {}{}",
                s.visit.visits,
                s.errors.errors,
                format!("{connected}/{}", s.devices.len()),
                s.ticks.p99_ms,
                duration(s.uptime_s),
                s.version,
                s.settings.revision,
                if s.settings.trial { " (on trial)" } else { "" },
            )?;
        }
        writeln!(out, "{here} of {} are there", registry.all().count())
    });
}

/// A change of the list, as one line.
pub fn change(what: &str, name: &str, entry: &RegistryEntry, json: bool) {
    let mut value = entry_json(name, entry);
    value["change"] = what.into();
    answer(json, &value, |out| {
        let s = &*entry.state;
        let trial = if s.settings.trial { ", settings on trial" } else { "" };
        let (stage, visits, errors) = (stage(s), s.visit.visits, s.errors.errors);
        write!(out, "{name}: {what}: {stage}, {visits} visits, {errors} errors{trial}")?;
        match &s.errors.last {
            Some(last) => writeln!(out, ", the last: {last}"),
            None => writeln!(out),
        }
    });
    // Whoever reads along through a pipe sees each line at once.
    let _ = std::io::stdout().flush();
}

/// Prints the results of requests.
pub fn answers(ends: &BTreeMap<String, RequestEnd>, json: bool) {
    let of = |(name, end): (&String, &RequestEnd)| {
        let mut value = match end {
            RequestEnd::Answered(outcome) => serde_json::to_value(outcome).unwrap_or_default(),
            RequestEnd::Silent => json!({ "outcome": "silent" }),
        };
        value["installation"] = name.as_str().into();
        value
    };
    let all: Vec<Value> = ends.iter().map(of).collect();
    answer(json, &json!({ "answers": all }), |out| {
        for (name, end) in ends {
            match end {
                RequestEnd::Answered(FleetOutcome::Done { note }) => {
                    writeln!(out, "{name}: {note}")?;
                }
                RequestEnd::Answered(FleetOutcome::Logs { lines }) => {
                    lines.iter().try_for_each(|line| writeln!(out, "{name}: {line}"))?;
                }
                RequestEnd::Answered(FleetOutcome::Refused { why }) => {
                    writeln!(out, "{name}: refused: {why}")?;
                }
                RequestEnd::Answered(FleetOutcome::Stale { .. }) | RequestEnd::Silent => {
                    writeln!(out, "{name}: no answer")?;
                }
            }
        }
        Ok(())
    });
}
