//! Whether there is a screen to show a window on, why not, and showing it.

use std::path::PathBuf;

#[cfg(feature = "viewer")]
use sculptd_daemon::event_clock::EventClock;
use sculptd_daemon::live_run::LiveRun;

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

/// Returns true if a window should open: not if `headless`, and not without a screen, which is
/// printed in one line.
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

/// Outputs of a run: its window and its files.
#[derive(Debug, Default)]
pub struct Shown {
    /// True if there is a window.
    pub window: bool,
    pub full_screen: bool,
    /// Folder of the user's brushes; `None` if there is none.
    pub brushes: Option<PathBuf>,
    /// A large mesh for the window to load; it replaces the initial ball.
    pub open_first: Option<PathBuf>,
    /// True if the sculpture begins with this run.
    pub fresh: bool,
    /// File to write the mesh to at the end.
    pub export: Option<PathBuf>,
    /// The session's file, for the window's title.
    pub session: Option<PathBuf>,
    /// Sessions to offer, the newest first, and the one that a person chose to open next.
    pub recent: Vec<PathBuf>,
    pub open_next: super::library::OpenNext,
}

/// Answers that wait for the window: more than it sends commands between two looks.
#[cfg(feature = "viewer")]
const ANSWERS: usize = 1024;

/// Gives what shows the window until it is closed or the run ends; its `Err` says why there is
/// none. It holds nothing of the run but handles.
#[cfg(feature = "viewer")]
pub fn window(
    run: &LiveRun,
    shown: &Shown,
    rate_hz: u32,
) -> Result<impl FnOnce() -> Result<(), String> + use<>, String> {
    let (adaptors, cameras) = (run.adaptors.clone(), run.adaptors.clone());
    let (reports, answers) = crossbeam_channel::bounded(ANSWERS);
    let events = EventClock::new(run.clock.clone());
    let wiring = sculptd_window::viewer::Wiring {
        commands: run.live.commands.of_window(reports, events.clone()),
        answers,
        published: run.live.published.clone(),
        pen_trail: run.live.pen_trail.clone(),
        pointer: run.factory.sender(),
        pointer_id: sculptd_daemon::adaptors::POINTER_ID,
        translations: translations(),
        presets: crate::presets().clone(),
        brushes: shown.brushes.clone(),
        clock: run.clock.clone(),
        events,
        stop: run.stop.clone(),
        devices: Box::new(move || adaptors.describe()),
        camera: Box::new(move || cameras.camera()?.preview()),
        session: shown.session.as_ref().map(|p| p.display().to_string()),
        journal: run.health.clone(),
        history: run.history.clone().map(|h| (h, rate_hz)),
        recent: shown.recent.clone(),
        open_next: shown.open_next.clone(),
        demo_until_us: run.demo_ends_us(),
        controls: run.controls.clone(),
        full_screen: shown.full_screen,
        open_first: shown.open_first.clone(),
        fresh: shown.fresh,
        link: run.window.clone(),
        check_presets: super::check_presets::all().map_err(|e| e.to_string())?,
        kiosk: run.kiosk.clone(),
        invitation: invitation(run),
    };
    Ok(move || sculptd_window::viewer::run(wiring).map_err(|e| e.to_string()))
}

/// The newest link by which guests sculpt, or else any.
#[cfg(all(feature = "viewer", unix))]
fn invitation(run: &LiveRun) -> Option<sculptd_daemon::qr_code::Invitation> {
    use sculptd_daemon::qr_code::{Code, Invitation};
    let web = run.web.as_ref()?;
    let keys = web.state.keys.all(run.clock.now_us());
    let sculptor = keys.iter().rfind(|k| k.role == sculptd_daemon::web::WebRole::Sculptor);
    let key = sculptor.or(keys.first())?;
    let url = web.link(key);
    Some(Invitation { code: Code::of(&url)?, url })
}

#[cfg(all(feature = "viewer", not(unix)))]
fn invitation(_: &LiveRun) -> Option<sculptd_daemon::qr_code::Invitation> {
    None
}

/// Checks that the window has the material that the screen of an installation uses.
///
/// # Errors
/// Returns an error that names the unknown material and the known ones.
#[cfg(feature = "viewer")]
pub fn check_screen(screen: &sculptd_daemon::kiosk::ScreenSettings) -> Result<(), String> {
    use sculptd_window::look::{MATERIALS, material_index};
    if material_index(&screen.material).is_some() {
        return Ok(());
    }
    let names = MATERIALS.map(|m| m.short_name());
    Err(format!("screen.material = \"{}\": expected {}", screen.material, names.join(", ")))
}

/// Nothing is shown without a window.
///
/// # Errors
/// None.
#[cfg(not(feature = "viewer"))]
pub fn check_screen(_: &sculptd_daemon::kiosk::ScreenSettings) -> Result<(), String> {
    Ok(())
}

/// Returns the window's languages: the built-in ones, and those of the user's folder,
/// `languages/CODE/window.ftl` beside the preferences. The initial language comes from the
/// environment, in the order of `setlocale`.
#[cfg(feature = "viewer")]
fn translations() -> sculptd_window::language::Translations {
    let set = |name: &&str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let locale = ["LC_ALL", "LC_MESSAGES", "LANG"].iter().find_map(set).unwrap_or_default();
    let folder = directories::ProjectDirs::from("", "", "sculptd")
        .map(|dirs| dirs.config_dir().join("languages"));
    let texts = crate::settings::WINDOW_TEXTS;
    sculptd_window::language::Translations::new(texts, folder.as_deref(), &locale)
}

#[cfg(not(feature = "viewer"))]
pub fn window(
    _: &LiveRun,
    _: &Shown,
    _: u32,
) -> Result<impl FnOnce() -> Result<(), String> + use<>, String> {
    available().map(|()| || Ok(()))
}
