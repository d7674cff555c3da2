//! The built-in presets: `config/brushes/NAME.toml`, embedded.

use std::sync::OnceLock;

use sculptd_clay::brush::Presets;

macro_rules! texts {
    ($($name:literal,)*) => {
        &[$(($name, include_str!(concat!("../config/brushes/", $name, ".toml"))),)*]
    };
}

/// The name of each brush with a preset, and its text.
pub const TEXTS: &[(&str, &str)] = texts![
    "gaussian",
    "smooth",
    "draw",
    "clay",
    "clay-strips",
    "inflate",
    "layer",
    "crease",
    "pinch",
    "blob",
    "flatten",
    "fill",
    "scrape",
    "trim",
    "grab",
    "elastic",
    "topological",
    "snake-hook",
    "twist",
    "thumb",
    "nudge",
    "relax",
    "mask",
    "mask-blur",
    "paint",
    "texture",
    "density",
    "simplify",
    "slide-relax",
    "plane",
    "multiplane-scrape",
    "sharpen",
    "surface-smooth",
    "boundary",
    "erase-layer",
    "draw-face-sets",
];

/// The embedded presets, read once.
pub fn presets() -> &'static Presets {
    static PRESETS: OnceLock<Presets> = OnceLock::new();
    // A test reads every text; a build with a broken one falls back to the defaults of the code.
    PRESETS.get_or_init(|| Presets::read(TEXTS).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use sculptd_clay::brush::BrushKind;

    use super::*;

    #[test]
    fn every_brush_has_a_valid_preset_that_says_what_it_does() {
        let presets = Presets::read(TEXTS).unwrap_or_else(|e| panic!("{e}"));
        for kind in BrushKind::ALL {
            assert!(TEXTS.iter().any(|(name, _)| *name == kind.name()), "{kind}: no preset");
            let preset = presets.get(*kind);
            assert!(preset.about().len() > 20, "{kind}: says too little");
            assert_eq!(preset.settings().clamped(), preset.settings(), "{kind}");
        }
    }
}
