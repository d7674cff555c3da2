//! Whether there is a screen to show a window on, and why not.

/// `Err` holds the reason, in words for a person.
pub fn available() -> Result<(), String> {
    if cfg!(not(feature = "viewer")) {
        return Err("this build has no viewer (the feature `viewer` is off)".into());
    }
    let named = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    if cfg!(all(unix, not(target_os = "macos"))) && !named("DISPLAY") && !named("WAYLAND_DISPLAY") {
        return Err("no display: neither DISPLAY nor WAYLAND_DISPLAY is set".into());
    }
    Ok(())
}
