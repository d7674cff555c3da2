//! The limits by process and material that the program carries: `config/thickness/*.toml`.

use sculptd_geometry::thickness::preset::Preset;

use super::Fail;

const EMBEDDED: [(&str, &str); 8] = [
    ("fdm.toml", include_str!("../../config/thickness/fdm.toml")),
    ("sla.toml", include_str!("../../config/thickness/sla.toml")),
    ("sls.toml", include_str!("../../config/thickness/sls.toml")),
    ("abs.toml", include_str!("../../config/thickness/abs.toml")),
    ("pc.toml", include_str!("../../config/thickness/pc.toml")),
    ("pp.toml", include_str!("../../config/thickness/pp.toml")),
    ("pa.toml", include_str!("../../config/thickness/pa.toml")),
    ("pom.toml", include_str!("../../config/thickness/pom.toml")),
];

/// Every embedded preset.
pub fn all() -> Result<Vec<Preset>, Fail> {
    let read = |(name, text): &(&str, &str)| {
        Preset::read(name, text).map_err(|e| Fail::Config(e.to_string()))
    };
    EMBEDDED.iter().map(read).collect()
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
