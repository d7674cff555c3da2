//! The settings of an installation, as the command line names them.

use std::path::{Path, PathBuf};

use super::{Fail, display};
use crate::settings::LANGUAGES;
use sculptd_daemon::kiosk::KioskConfig;
#[cfg(feature = "network")]
use sculptd_network::fleet::installation_thread::FleetPart;

/// The part of the command line that names an installation.
#[derive(Debug)]
pub struct KioskArgs<'a> {
    pub kiosk: bool,
    /// The file of settings; `None`: the built-in ones.
    pub file: Option<&'a Path>,
    /// Exhibits beside those of the settings.
    pub exhibits: &'a [PathBuf],
}

/// The installation's settings, if it is one; what cannot be shown to visitors is said before any
/// come.
#[cfg(not(feature = "network"))]
pub fn read(named: &KioskArgs) -> Result<Option<KioskConfig>, Fail> {
    if !named.kiosk {
        return Ok(None);
    }
    let mut config = match named.file {
        Some(path) => KioskConfig::load(path).map_err(Fail::Config)?,
        None => KioskConfig::default(),
    };
    if !config.fleet.name.is_empty() {
        let text = "[fleet]: this program was built without the feature `network`";
        return Err(Fail::Config(text.into()));
    }
    config.exhibits.extend(named.exhibits.iter().cloned());
    can_be_shown(&config)?;
    Ok(Some(config))
}

/// The same, with its part in a fleet.
#[cfg(feature = "network")]
pub fn read(named: &KioskArgs) -> Result<Option<(KioskConfig, Option<FleetPart>)>, Fail> {
    let mut both = match (named.file, named.kiosk) {
        (_, false) => return Ok(None),
        (None, true) => (KioskConfig::default(), None),
        (Some(path), true) => {
            let (config, files, trial) = super::fleet_part::settings(path)?;
            let part = super::fleet_part::part(&config, (files, trial))?;
            (config, part)
        }
    };
    both.0.exhibits.extend(named.exhibits.iter().cloned());
    can_be_shown(&both.0)?;
    Ok(Some(both))
}

fn can_be_shown(config: &KioskConfig) -> Result<(), Fail> {
    config.words(LANGUAGES).map_err(Fail::Config)?;
    display::check_screen(&config.screen).map_err(Fail::Config)
}
