//! `sculptd fleet`: installations looked after from a distance (feature `network`).

mod print;
mod roll;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::json;

use super::run::seconds;
use super::shared::data_folder;
use super::{Fail, Outcome, answer};
use sculptd_geometry::io::write_beside;
use sculptd_network::fleet::access::FleetKey;
use sculptd_network::fleet::fleet_console::FleetConsole;
use sculptd_network::fleet::fleet_link::StaffLink;
use sculptd_network::fleet::registry::FleetChange;
use sculptd_network::fleet::request::{FleetAction, FleetOutcome, StaffOrder};
use sculptd_network::fleet::requester::RequestEnd;
use sculptd_network::fleet::state::{InstallationState, fleet_name};
use sculptd_network::random::system_entropy;
use sculptd_network::zenoh_link::Endpoints;

/// An installation that does not answer a request by then does not answer.
const PATIENCE: Duration = Duration::from_secs(10);

#[derive(Debug, clap::Args)]
pub struct FleetArgs {
    /// The fleet's name; without it, the only one that you hold the key of.
    #[arg(long, value_name = "NAME", value_parser = fleet_name, global = true)]
    pub fleet: Option<String>,
    /// The staff's key; without it, `fleets/NAME/staff.key` in the user's data folder.
    #[arg(long, value_name = "FILE", global = true)]
    pub key: Option<PathBuf>,
    /// Listen for installations on this endpoint, as tcp/0.0.0.0:7447. May be repeated.
    #[arg(long, value_name = "ENDPOINT", global = true)]
    pub listen: Vec<String>,
    /// Connect to this endpoint, as tcp/hall.example:7447. May be repeated. Installations on the
    /// local network are found without it.
    #[arg(long, value_name = "ENDPOINT", global = true)]
    pub connect: Vec<String>,
    /// Do not look for installations on the local network.
    #[arg(long, global = true)]
    pub no_multicast: bool,
    /// Installations are listened for so long before anything is said or asked.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "4",
        global = true)]
    pub wait: f64,
    #[command(subcommand)]
    pub command: FleetCommand,
}

#[derive(Debug, clap::Subcommand)]
pub enum FleetCommand {
    /// Begin a fleet: make the staff's key.
    Create {
        #[arg(value_parser = fleet_name)]
        name: String,
    },
    /// Create the key of an installation. Copy the file to it, and name it in its settings.
    Key {
        /// The installation's name.
        #[arg(value_parser = fleet_name)]
        installation: String,
        /// Write the key to this file; default: NAME.key in the current folder.
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// List every installation, connected or not.
    List,
    /// Print every change as it happens; with --json one object per line.
    Follow {
        /// End after so many seconds.
        #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
        limit_s: Option<f64>,
    },
    /// Show a text to the staff on site until somebody dismisses it; an empty text removes it.
    Message {
        text: String,
        #[command(flatten)]
        to: Recipients,
    },
    /// End the visit as if the visitor had pressed "finished".
    RestartVisit {
        #[command(flatten)]
        to: Recipients,
    },
    /// Close for cleaning: a still screen, and no visitor may come.
    Clean {
        #[command(flatten)]
        to: Recipients,
    },
    /// Open again after cleaning.
    Open {
        #[command(flatten)]
        to: Recipients,
    },
    /// Pack the works of today into one file in each gallery.
    Export {
        #[command(flatten)]
        to: Recipients,
    },
    /// Restart the programs.
    Restart {
        #[command(flatten)]
        to: Recipients,
    },
    /// End the programs for good: somebody on site must start them again.
    End {
        #[command(flatten)]
        to: Recipients,
    },
    /// Print the newest lines of the logs.
    Logs {
        #[command(flatten)]
        to: Recipients,
        #[arg(long, value_name = "N", default_value_t = 100)]
        lines: u32,
    },
    /// Roll out a settings file (keys of kiosk.toml that are not an installation's own) to all
    /// installations: to one first, which is watched, then to the others. A failure on one reverts
    /// all. Exits with 1 if reverted.
    Rollout {
        file: PathBuf,
        /// The installation to change first.
        #[arg(long, value_name = "INSTALLATION")]
        canary: String,
        /// Time to watch each installation, in seconds.
        #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "300")]
        watch: f64,
    },
    /// Restore the settings that were in use before the last ones.
    Rollback {
        #[command(flatten)]
        to: Recipients,
    },
}

#[derive(Debug, clap::Args)]
pub struct Recipients {
    /// Names of the installations.
    #[arg(required_unless_present = "all")]
    pub installations: Vec<String>,
    /// Address all connected installations.
    #[arg(long, conflicts_with = "installations")]
    pub all: bool,
}

fn folder(fleet: &str) -> PathBuf {
    data_folder("fleets").join(fleet)
}

impl FleetArgs {
    fn name(&self) -> Result<String, Fail> {
        if let Some(name) = &self.fleet {
            return Ok(name.clone());
        }
        let entries = std::fs::read_dir(data_folder("fleets")).ok().into_iter().flatten();
        let known = entries.flatten().filter(|e| e.path().join("staff.key").is_file());
        let mut names: Vec<String> =
            known.filter_map(|e| e.file_name().into_string().ok()).collect();
        match (names.len(), names.pop()) {
            (1, Some(name)) => Ok(name),
            (0, _) => Err(Fail::Usage("name the fleet: --fleet NAME --key FILE".into())),
            _ => Err(Fail::Usage("there are keys of several fleets: name one by --fleet".into())),
        }
    }

    fn key(&self, fleet: &str) -> Result<FleetKey, Fail> {
        let path = self.key.clone().unwrap_or_else(|| folder(fleet).join("staff.key"));
        let key = FleetKey::read(&path).map_err(|e| Fail::Config(e.to_string()))?;
        match key {
            FleetKey::Staff(_) => Ok(key),
            FleetKey::Installation { .. } => {
                let why = format!("{}: this is an installation's key", path.display());
                Err(Fail::Permission(why))
            }
        }
    }

    /// A console that has listened for a while.
    fn console(&self) -> Result<(String, FleetConsole), Fail> {
        let fleet = self.name()?;
        let key = self.key(&fleet)?;
        let (listen, connect) = (self.listen.clone(), self.connect.clone());
        let endpoints = Endpoints { listen, connect, multicast: !self.no_multicast };
        let link = StaffLink::open(&fleet, &endpoints);
        let link = link.map_err(|e| Fail::Usage(format!("the network: {e}")))?;
        let mut console = FleetConsole::new(link, key, known(&fleet), system_entropy());
        console.advance_for(Duration::from_secs_f64(self.wait), |_| false);
        Ok((fleet, console))
    }
}

/// The states that were last heard, as the list before has kept them.
fn known(fleet: &str) -> Vec<InstallationState> {
    let text = std::fs::read(folder(fleet).join("known.json")).unwrap_or_default();
    serde_json::from_slice(&text).unwrap_or_default()
}

/// Keeps the states for the next list.
fn remember(fleet: &str, console: &FleetConsole) {
    let states: Vec<&InstallationState> = console.registry.all().map(|(_, e)| &*e.state).collect();
    let path = folder(fleet).join("known.json");
    let text = serde_json::to_vec(&states).unwrap_or_default();
    let made = std::fs::create_dir_all(folder(fleet));
    let written = made.and_then(|()| write_beside(&path, |out| out.write_all(&text)));
    if let Err(e) = written {
        tracing::warn!("{}: {e}", path.display());
    }
}

pub fn run(args: &FleetArgs, json: bool) -> Outcome {
    match &args.command {
        FleetCommand::Create { name } => create(name, json),
        FleetCommand::Key { installation, output } => {
            make_key(args, installation, output.as_deref(), json)
        }
        FleetCommand::List => {
            let (fleet, console) = args.console()?;
            remember(&fleet, &console);
            print::list(&fleet, &console.registry, json);
            Ok(())
        }
        FleetCommand::Follow { limit_s } => follow(args, *limit_s, json),
        FleetCommand::Message { text, to } => {
            ask_all(args, to, &FleetAction::Message { text: text.clone() }, json)
        }
        FleetCommand::RestartVisit { to } => ask_all(args, to, &FleetAction::RestartVisit, json),
        FleetCommand::Clean { to } => order(args, to, StaffOrder::Clean, json),
        FleetCommand::Open { to } => order(args, to, StaffOrder::Open, json),
        FleetCommand::Export { to } => order(args, to, StaffOrder::Export, json),
        FleetCommand::Restart { to } => order(args, to, StaffOrder::Restart, json),
        FleetCommand::End { to } => order(args, to, StaffOrder::End, json),
        FleetCommand::Logs { to, lines } => {
            ask_all(args, to, &FleetAction::Logs { lines: *lines }, json)
        }
        FleetCommand::Rollout { file, canary, watch } => {
            roll::rollout(args, file, canary, *watch, json)
        }
        FleetCommand::Rollback { to } => {
            ask_all(args, to, &FleetAction::TakeBackSettings { revision: None }, json)
        }
    }
}

fn order(args: &FleetArgs, to: &Recipients, order: StaffOrder, json: bool) -> Outcome {
    ask_all(args, to, &FleetAction::Staff { order }, json)
}

fn create(name: &str, json: bool) -> Outcome {
    let folder = folder(name);
    std::fs::create_dir_all(&folder).map_err(|e| Fail::io(&folder, &e))?;
    let path = folder.join("staff.key");
    let made = FleetKey::staff(&mut system_entropy()).write(&path);
    made.map_err(|e| Fail::Config(e.to_string()))?;
    answer(json, &json!({ "fleet": name, "key": path }), |out| {
        writeln!(out, "the staff's key of '{name}': {}", path.display())
    });
    Ok(())
}

fn make_key(args: &FleetArgs, name: &str, output: Option<&Path>, json: bool) -> Outcome {
    let fleet = args.name()?;
    let key = args.key(&fleet)?.for_installation(name);
    let key = key.ok_or_else(|| Fail::Permission("only staff make keys".into()))?;
    let path = output.map_or_else(|| PathBuf::from(format!("{name}.key")), Path::to_path_buf);
    key.write(&path).map_err(|e| Fail::Config(e.to_string()))?;
    let shown = json!({ "fleet": fleet, "installation": name, "key": path });
    answer(json, &shown, |out| {
        let path = path.display();
        writeln!(out, "the key of '{name}': {path}")?;
        writeln!(out, "in its kiosk.toml:\n[fleet]\nname = \"{fleet}\"\nkey = \"{path}\"")
    });
    Ok(())
}

fn follow(args: &FleetArgs, limit_s: Option<f64>, json: bool) -> Outcome {
    let (fleet, mut console) = args.console()?;
    let limit_us = limit_s.map_or(u64::MAX, |s| (s * 1e6) as u64);
    let until_us = console.now_us().saturating_add(limit_us);
    loop {
        while let Some(change) = console.registry.take_change() {
            let (what, name) = match &change {
                FleetChange::Came(name) => ("came", name),
                FleetChange::Lost(name) => ("lost", name),
                FleetChange::Changed(name) => ("changed", name),
            };
            if let Some(entry) = console.registry.get(name) {
                print::change(what, name, entry, json);
            }
        }
        if console.now_us() >= until_us {
            remember(&fleet, &console);
            return Ok(());
        }
        console.advance();
    }
}

/// Asks installations for the same, and waits for all of them.
fn ask_all(args: &FleetArgs, to: &Recipients, action: &FleetAction, json: bool) -> Outcome {
    action.check().map_err(Fail::Usage)?;
    let (fleet, mut console) = args.console()?;
    remember(&fleet, &console);
    let names: Vec<String> = match to.all {
        true => {
            let here = console.registry.all().filter(|(_, e)| e.is_here());
            here.map(|(name, _)| name.to_owned()).collect()
        }
        false => to.installations.clone(),
    };
    if names.is_empty() {
        return Err(Fail::Device(format!("no installation of '{fleet}' is there")));
    }
    let mut open: BTreeMap<String, String> = BTreeMap::new();
    for name in &names {
        open.insert(console.ask(name, action.clone(), PATIENCE), name.clone());
    }
    let mut ends = BTreeMap::new();
    while !open.is_empty() {
        console.advance();
        while let Some((id, end)) = console.take_ended() {
            if let Some(name) = open.remove(&id) {
                ends.insert(name, end);
            }
        }
    }
    print::answers(&ends, json);
    let done = |end: &RequestEnd| {
        matches!(end, RequestEnd::Answered(FleetOutcome::Done { .. } | FleetOutcome::Logs { .. }))
    };
    let failed: Vec<&str> =
        ends.iter().filter(|(_, end)| !done(end)).map(|(name, _)| name.as_str()).collect();
    match failed.is_empty() {
        true => Ok(()),
        false => Err(Fail::Check(format!("not done by: {}", failed.join(", ")))),
    }
}
