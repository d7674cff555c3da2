//! The built-in tablet files. A test holds this list to the folder.

pub(crate) const TABLETS: &[(&str, &str)] =
    &[("wacom-ptk-440.toml", include_str!("../tablets/wacom-ptk-440.toml"))];
