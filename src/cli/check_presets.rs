//! The processes, printers and materials that the program carries: `config/check/*.toml`.

use sculptd_check::PresetLibrary;
use sculptd_check::preset::CheckPreset;

use super::embedded_presets::CHECKS;
use super::{Fail, thickness_presets};

/// Every embedded preset.
pub fn all() -> Result<PresetLibrary, Fail> {
    let read = |(name, text): &(&str, &str)| {
        CheckPreset::read(name, text).map_err(|e| Fail::Config(e.to_string()))
    };
    let checks = CHECKS.iter().map(read).collect::<Result<_, _>>()?;
    Ok(PresetLibrary { checks, walls: thickness_presets::all()? })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use sculptd_check::CheckSettings;

    use super::*;

    #[test]
    fn every_embedded_preset_is_valid_and_fits_the_others() {
        let library = all().expect("valid");
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/config/check");
        assert_eq!(std::fs::read_dir(folder).expect("a folder").count(), CHECKS.len());
        assert!(library.checks.iter().all(|p| p.source().len() > 10));
        for preset in &library.checks {
            let (process, printer, material) = match preset {
                CheckPreset::Process(p) => (p.name.as_str(), None, None),
                CheckPreset::Printer(p) => (p.process.as_str(), Some(&**p), None),
                CheckPreset::Material(m) if m.walls.is_some() => ("moulding", None, Some(&**m)),
                CheckPreset::Material(m) => ("fdm", None, Some(&**m)),
            };
            let process = library.process(process).expect("known");
            let made = CheckSettings::new(&library, process, printer, material, DVec3::Z);
            assert!(made.is_ok_and(|s| s.walls.is_some()), "{}", preset.name());
        }
    }
}
