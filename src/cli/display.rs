//! Whether there is a screen to show a window on, why not, and showing it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use sculptd_daemon::adaptors::Adaptors;
use sculptd_daemon::live::Live;
use sculptd_devices::Clock;
use sculptd_devices::queue::SenderFactory;

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

/// Whether to open a window: not if it is not wanted, and not where there is no screen (which is
/// said in one line).
pub fn wanted(headless: bool) -> bool {
    if headless {
        return false;
    }
    match available() {
        Ok(()) => true,
        Err(why) => {
            eprintln!("sculptd: headless: {why}");
            false
        }
    }
}

/// What joins a window to a live run.
#[derive(Debug)]
pub struct Wired<'a> {
    pub live: &'a Live,
    pub factory: &'a SenderFactory,
    pub clock: &'a Clock,
    pub stop: &'a Arc<AtomicBool>,
    pub adaptors: Arc<Adaptors>,
    pub session: Option<String>,
    /// The session's history, and the ticks a second.
    pub history: Option<(sculptd_daemon::session::history::Handle, u32)>,
    /// On the clock; 0 without ghosts.
    pub ghosts_until_us: u64,
    pub full_screen: bool,
    /// The screen of an installation, in the place of the panels.
    pub kiosk: Option<sculptd_daemon::kiosk::keeper::Screen>,
}

/// Shows the window until it is closed or the run ends; `Err` says why there is none.
#[cfg(feature = "viewer")]
pub fn show(wired: &Wired<'_>) -> Result<(), String> {
    let adaptors = wired.adaptors.clone();
    let wiring = sculptd_window::viewer::Wiring {
        commands: wired.live.commands.clone(),
        published: wired.live.published.clone(),
        pointer: wired.factory.sender(),
        pointer_id: sculptd_daemon::adaptors::POINTER_ID,
        presets: crate::presets().clone(),
        clock: wired.clock.clone(),
        stop: wired.stop.clone(),
        devices: Box::new(move || adaptors.describe()),
        session: wired.session.clone(),
        history: wired.history.clone(),
        ghosts_until_us: wired.ghosts_until_us,
        full_screen: wired.full_screen,
        presets: super::thickness::presets::all().map_err(|e| e.to_string())?,
        kiosk: wired.kiosk.clone(),
    };
    sculptd_window::viewer::run(wiring).map_err(|e| e.to_string())
}

#[cfg(not(feature = "viewer"))]
pub fn show(_: &Wired<'_>) -> Result<(), String> {
    available()
}
