//! The limits by process and material that the program carries: `config/thickness/*.toml`.

use sculptd_geometry::thickness::preset::Preset;

use super::Fail;
use super::embedded_presets::WALLS;

/// Every embedded preset.
pub fn all() -> Result<Vec<Preset>, Fail> {
    let read = |(name, text): &(&str, &str)| {
        Preset::read(name, text).map_err(|e| Fail::Config(e.to_string()))
    };
    WALLS.iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_preset_is_valid_and_named_once() {
        let all = all().expect("valid");
        let mut names: Vec<_> = all.iter().map(|p| p.name.clone()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all.len());
        assert!(all.iter().all(|p| p.source.len() > 10));
    }
}
