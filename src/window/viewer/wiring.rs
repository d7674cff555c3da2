//! Connection of the window to the daemon.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex};

use crate::language::Translations;
use arc_swap::ArcSwap;
use crossbeam_channel as cc;
use sculptd_camera::camera_thread::CameraPreview;
use sculptd_check::PresetLibrary;
use sculptd_clay::brush::Presets;
use sculptd_daemon::Published;
use sculptd_daemon::command_queue::{CommandAnswer, CommandSender};
use sculptd_daemon::event_clock::EventClock;
use sculptd_daemon::pen_trail::PenTrail;
use sculptd_daemon::session::Health;
use sculptd_daemon::tablet_controls::TabletControls;
use sculptd_daemon::window_link::{NextSculpture, WindowLink};
use sculptd_devices::queue::Sender;
use sculptd_devices::{Clock, DeviceId};

/// Everything that joins the window to the daemon.
pub struct Wiring {
    pub commands: CommandSender,
    /// Answers to the commands that no caller waits for.
    pub answers: cc::Receiver<CommandAnswer>,
    pub published: Arc<ArcSwap<Published>>,
    /// Positions of the tablets' pens, each once.
    pub pen_trail: PenTrail,
    /// The pointer's own way into the channel.
    pub pointer: Sender,
    pub pointer_id: DeviceId,
    /// The languages of the window.
    pub translations: Translations,
    /// Initial settings of each brush.
    pub presets: Presets,
    /// Folder of the person's brushes; `None`: nowhere.
    pub brushes: Option<PathBuf>,
    /// Limits by process, machine and material, for the pages Walls and Check.
    pub check_presets: PresetLibrary,
    pub clock: Clock,
    /// The same clock; while an event is handled, the time of the event.
    pub events: EventClock,
    /// Raised from outside, or by closing the window.
    pub stop: Arc<AtomicBool>,
    /// One line a device; asked for once a second.
    pub devices: Box<dyn Fn() -> Vec<String>>,
    /// The newest picture of the camera that watches hands; asked for while its page is open.
    pub camera: Box<dyn Fn() -> Option<Arc<CameraPreview>>>,
    pub session: Option<String>,
    /// State of the session's file.
    pub journal: Option<Health>,
    /// The session's history, and the ticks a second that its versions are counted in.
    pub history: Option<(sculptd_daemon::session::history::Handle, u32)>,
    /// Sessions to offer at the start, the newest first.
    pub recent: Vec<PathBuf>,
    /// Takes the sculpture that a person chooses to open next; the window then ends.
    pub open_next: Arc<Mutex<Option<NextSculpture>>>,
    /// The time on the clock at which the demo ends, microseconds; 0 without a demo.
    pub demo_until_us: u64,
    /// Bindings of the tablets' controls.
    pub controls: TabletControls,
    pub full_screen: bool,
    /// A large mesh to load as soon as there is a window, so that its progress is seen.
    pub open_first: Option<PathBuf>,
    /// The sculpture begins here: nobody has chosen a view of it.
    pub fresh: bool,
    /// State that the run keeps in case this window is lost.
    pub link: WindowLink,
    /// The screen of an installation, which replaces the panels.
    pub kiosk: Option<sculptd_daemon::kiosk::desk::Screen>,
    /// Link by which guests join in a browser; `None` if no page is served.
    pub invitation: Option<sculptd_daemon::qr_code::Invitation>,
}

impl Wiring {
    /// Returns why the session's file takes nothing now, and the number of ticks that it has lost.
    pub(super) fn session_state(&self) -> (Option<String>, u64) {
        self.journal.as_ref().map_or((None, 0), |h| (h.trouble(), h.lost.load(Relaxed)))
    }
}

impl std::fmt::Debug for Wiring {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wiring").finish_non_exhaustive()
    }
}
