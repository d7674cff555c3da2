//! The limits by process and material that the program carries: `config/thickness/*.toml`.

use sculptd_geometry::thickness::preset::{Preset, PresetError};

const EMBEDDED: [(&str, &str); 8] = [
    ("fdm.toml", include_str!("../../../config/thickness/fdm.toml")),
    ("sla.toml", include_str!("../../../config/thickness/sla.toml")),
    ("sls.toml", include_str!("../../../config/thickness/sls.toml")),
    ("abs.toml", include_str!("../../../config/thickness/abs.toml")),
    ("pc.toml", include_str!("../../../config/thickness/pc.toml")),
    ("pp.toml", include_str!("../../../config/thickness/pp.toml")),
    ("pa.toml", include_str!("../../../config/thickness/pa.toml")),
    ("pom.toml", include_str!("../../../config/thickness/pom.toml")),
];

/// Every embedded preset.
pub fn all() -> Result<Vec<Preset>, PresetError> {
    EMBEDDED.iter().map(|(name, text)| Preset::read(name, text)).collect()
}

/// The embedded preset of this name, or a sentence that names those that exist.
pub fn named(name: &str) -> Result<Preset, String> {
    let all = all().map_err(|e| e.to_string())?;
    let known = all.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
    all.into_iter()
        .find(|p| p.name == name)
        .ok_or_else(|| format!("no preset is called \"{name}\"; there are {known}"))
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
        assert!(named("bronze").is_err_and(|e| e.contains("fdm, sla")));
    }
}
