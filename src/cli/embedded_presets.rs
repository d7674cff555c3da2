//! The preset files that programs carry: `config/check` and `config/thickness`, each with its name.
//! The Python module includes this file too.

/// A file's name and its text.
pub type EmbeddedPreset = (&'static str, &'static str);

macro_rules! texts {
    ($folder:literal, $($name:literal,)*) => {
        &[$(($name, include_str!(concat!("../../config/", $folder, "/", $name)))),*]
    };
}

/// Processes, printers and materials of `sculptd check`.
pub const CHECKS: &[EmbeddedPreset] = texts![
    "check",
    "fdm.toml",
    "sla.toml",
    "sls.toml",
    "moulding.toml",
    "fdm-220.toml",
    "fdm-256.toml",
    "sla-145.toml",
    "msla-10k.toml",
    "sls-165.toml",
    "press-1000.toml",
    "pla.toml",
    "petg.toml",
    "resin.toml",
    "pa12.toml",
    "abs.toml",
    "pc.toml",
    "pp.toml",
    "pa.toml",
    "pom.toml",
];

/// Limits of walls by process and material.
pub const WALLS: &[EmbeddedPreset] = texts![
    "thickness",
    "fdm.toml",
    "sla.toml",
    "sls.toml",
    "abs.toml",
    "pc.toml",
    "pp.toml",
    "pa.toml",
    "pom.toml",
];
