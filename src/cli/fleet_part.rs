//! The part of an installation in a fleet, as its settings say (feature `network`).

use std::path::Path;

use super::Fail;
use super::log_ring::KeptLines;
use crate::settings::LANGUAGES;
use sculptd_daemon::kiosk::KioskConfig;
use sculptd_daemon::live_run::LiveRun;
use sculptd_daemon::local_time::unix_s;
use sculptd_network::fleet::access::FleetKey;
use sculptd_network::fleet::installation_thread::{FleetPart, RunInSight, start};
use sculptd_network::fleet::settings_files::{SettingsFiles, TrialStart};
use sculptd_network::fleet::state::fleet_name;
use sculptd_network::random::system_entropy;
use sculptd_network::zenoh_link::Endpoints;

/// Reads the settings of an installation. Settings on trial are reverted first if they ended the
/// program or cannot be read.
pub fn settings(path: &Path) -> Result<(KioskConfig, SettingsFiles, TrialStart), Fail> {
    let files = SettingsFiles::new(path);
    let mut trial = files.begin().map_err(Fail::Config)?;
    let mut config = KioskConfig::load(path);
    if let (Err(why), true) = (&config, files.is_on_trial()) {
        tracing::error!("settings on trial cannot be used: {why}");
        let revision = files.revision().unwrap_or_default();
        files.take_back(None).map_err(Fail::Config)?;
        trial = TrialStart::TakenBack { revision };
        config = KioskConfig::load(path);
    }
    if let TrialStart::TakenBack { revision } = &trial {
        tracing::error!("settings {revision} were taken back: they did not last their trial");
    }
    Ok((config.map_err(Fail::Config)?, files, trial))
}

/// The installation's part in its fleet; `None`: it is in none.
pub fn part(
    config: &KioskConfig,
    settings: (SettingsFiles, TrialStart),
) -> Result<Option<FleetPart>, Fail> {
    let fleet = &config.fleet;
    if fleet.name.is_empty() {
        return Ok(None);
    }
    let name = fleet_name(&fleet.name).map_err(|e| Fail::Config(format!("fleet.name: {e}")))?;
    let key = FleetKey::read(&fleet.key).map_err(|e| Fail::Config(format!("fleet.key: {e}")))?;
    let FleetKey::Installation { name: own, secret } = key else {
        let why = "fleet.key: this is the staff's key; `sculptd fleet key NAME` makes one for an \
                   installation";
        return Err(Fail::Config(why.into()));
    };
    let own = fleet_name(&own).map_err(|e| Fail::Config(format!("fleet.key: {e}")))?;
    let (listen, connect) = (fleet.listen.clone(), fleet.connect.clone());
    let check = |text: &str| {
        let config = KioskConfig::parse(text)?;
        super::display::check_screen(&config.screen)?;
        config.words(LANGUAGES).map(drop)
    };
    Ok(Some(FleetPart {
        fleet: name,
        name: own,
        secret,
        endpoints: Endpoints { listen, connect, multicast: fleet.multicast },
        settings,
        check: Box::new(check),
        log: Box::new(KeptLines),
        gallery: config.gallery.clone(),
        started_s: unix_s(),
        entropy: system_entropy(),
    }))
}

/// Starts the part of a run that has begun.
pub fn attend(part: FleetPart, run: &LiveRun) -> Result<(), Fail> {
    let Some(screen) = &run.kiosk else { return Ok(()) };
    let sight = RunInSight {
        published: run.live.published.clone(),
        desk: screen.desk.clone(),
        adaptors: run.adaptors.clone(),
        window: run.window.clone(),
        stop: run.stop.clone(),
    };
    start(part, sight).map(drop).map_err(|e| Fail::Config(format!("the fleet: {e}")))
}
