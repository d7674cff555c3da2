//! What the panels see: plain data, gathered once a frame.

use std::sync::Arc;

use super::action::Action;
use super::key_map::KeyMap;
use super::tablet_keys::TabletKeys;
use super::views::Views;
use crate::language::{Translations, tr};
use sculptd_camera::camera_thread::CameraPreview;
use sculptd_daemon::Published;
use sculptd_daemon::present_latency::PresentLatency;
use sculptd_engine::camera::Camera;

/// Data that panels see.
#[derive(Debug)]
pub struct View<'a> {
    pub state: &'a Published,
    /// The languages that can be chosen.
    pub translations: &'a Translations,
    /// The keys that are in force.
    pub keys: &'a KeyMap,
    /// Initial settings of each brush.
    pub presets: &'a sculptd_clay::brush::Presets,
    /// The camera as the window has it: the world's own follows a tick later.
    pub camera: Camera,
    /// The views of the clay; `camera` is that of the one in which is worked.
    pub views: &'a Views,
    /// One line a device, as the adaptors describe themselves.
    pub devices: &'a [String],
    /// What the camera that watches hands saw last.
    pub camera_preview: Option<&'a Arc<CameraPreview>>,
    /// The controls of tablets; `None` in an installation.
    pub tablet: Option<TabletKeys>,
    /// The session that keeps the sculpture; `None`: nothing keeps it.
    pub session: Option<SessionView<'a>>,
    /// Bytes of pages sent to the card with the last frame.
    pub uploaded: u64,
    pub adapter: &'a str,
    /// Measurements of the window's frames.
    pub frame: FrameFigures,
    /// Latency from a sample to the screen.
    pub latency: PresentLatency,
    /// Link by which guests join in a browser; `None` if no page is served.
    pub invitation: Option<&'a sculptd_daemon::qr_code::Invitation>,
    /// The demo performs.
    pub demo_runs: bool,
}

/// The session's file, and whether it is well.
#[derive(Debug, Clone)]
pub struct SessionView<'a> {
    pub path: &'a str,
    /// Why its file takes nothing now.
    pub fault: Option<String>,
    /// Number of ticks whose input the file has lost.
    pub lost: u64,
}

impl SessionView<'_> {
    /// Returns true if the file holds all input up to now.
    pub fn keeps(&self) -> bool {
        self.fault.is_none() && self.lost == 0
    }
}

impl View<'_> {
    /// The keys of two actions, as a tooltip has them.
    pub fn both(&self, first: Action, second: Action) -> String {
        tr!("both-keys", first = self.keys.text(first), second = self.keys.text(second))
    }

    /// The name of an action, and its keys in brackets: for a tooltip.
    pub fn tip(&self, action: Action) -> String {
        let name = action.title();
        match self.keys.of(action) {
            Some(keys) => tr!("name-with-keys", name = name, keys = keys.shown()),
            None => name,
        }
    }
}

/// Measurements of the window's frames.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameFigures {
    /// Of the last frames, our own work on the processor, ms: without waiting for the card.
    pub cpu_ms: f64,
    pub worst_cpu_ms: f64,
    /// From a pointer's sample to the state that holds it, ms.
    pub input_to_snapshot_ms: f64,
    /// From a pointer's sample to the frame that shows it being handed to the card, ms.
    pub input_to_submit_ms: f64,
    /// Pages in view, of all.
    pub drawn: (usize, usize),
    /// Frames begun within the last second.
    pub frames_a_second: usize,
    /// Samples of this window's pointer sent.
    pub sent: u64,
    /// Time of the newest sample that a frame has shown, on the clock.
    pub newest_us: u64,
}
