//! The settings of an installation, as the command line names them.

#[cfg(feature = "network")]
use super::fleet_part::FleetPart;
use super::run::RunArgs;
use super::{Fail, display};
use crate::settings::LANGUAGES;
use sculptd_daemon::kiosk::KioskConfig;

/// The installation's settings, if it is one; what cannot be shown to visitors is said before any
/// come.
#[cfg(not(feature = "network"))]
pub fn read(args: &RunArgs) -> Result<Option<KioskConfig>, Fail> {
    if !args.kiosk {
        return Ok(None);
    }
    let mut config = match &args.kiosk_config {
        Some(path) => KioskConfig::load(path).map_err(Fail::Config)?,
        None => KioskConfig::default(),
    };
    if !config.fleet.name.is_empty() {
        let text = "[fleet]: this program was built without the feature `network`";
        return Err(Fail::Config(text.into()));
    }
    config.exhibits.extend(args.exhibit.iter().cloned());
    can_be_shown(&config)?;
    Ok(Some(config))
}

/// The same, with its part in a fleet.
#[cfg(feature = "network")]
pub fn read(args: &RunArgs) -> Result<Option<(KioskConfig, Option<FleetPart>)>, Fail> {
    let mut both = match (&args.kiosk_config, args.kiosk) {
        (_, false) => return Ok(None),
        (None, true) => (KioskConfig::default(), None),
        (Some(path), true) => {
            let (config, files, trial) = super::fleet_part::settings(path)?;
            let part = super::fleet_part::part(&config, (files, trial))?;
            (config, part)
        }
    };
    both.0.exhibits.extend(args.exhibit.iter().cloned());
    can_be_shown(&both.0)?;
    Ok(Some(both))
}

fn can_be_shown(config: &KioskConfig) -> Result<(), Fail> {
    config.words(LANGUAGES).map_err(Fail::Config)?;
    display::check_screen(&config.screen).map_err(Fail::Config)
}
