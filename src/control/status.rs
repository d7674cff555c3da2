//! Versions, the list of methods, the state of the daemon, its end.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::brush::BrushSettings;

/// The newest version of the protocol that these types describe.
///
/// * 1: the methods up to `shutdown`, as strings.
/// * 2: `hello`, `stroke`; `join` and `boolean` share the words of [`crate::edit::Operation`].
pub const PROTOCOL: u32 = 2;
/// The oldest version whose requests are still answered as they were.
pub const OLDEST_PROTOCOL: u32 = 1;

/// A range of versions, both ends counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Versions {
    /// The oldest version.
    pub min: u32,
    /// The newest version.
    pub max: u32,
}

impl Versions {
    /// Protocol versions of this build of the crate.
    pub const OURS: Versions = Versions { min: OLDEST_PROTOCOL, max: PROTOCOL };

    /// The newest version that both sides speak.
    ///
    /// ```
    /// use sculptd_control::status::Versions;
    /// let theirs = Versions { min: 2, max: 9 };
    /// assert_eq!(Versions { min: 1, max: 3 }.newest_in_common(theirs), Some(3));
    /// assert_eq!(Versions { min: 1, max: 1 }.newest_in_common(theirs), None);
    /// ```
    pub fn newest_in_common(self, other: Versions) -> Option<u32> {
        let newest = self.max.min(other.max);
        (newest >= self.min.max(other.min)).then_some(newest)
    }
}

/// No parameters. Any is refused by name.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct NoParams {}

/// Parameters of `hello`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct HelloParams {
    /// The versions that the client speaks; without it, whatever the daemon prefers.
    pub versions: Option<Versions>,
}

/// Reply of `hello`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HelloReply {
    /// The version to use: the newest that both sides speak.
    pub protocol: u32,
    /// Every version that the daemon speaks.
    pub versions: Versions,
    /// The daemon's own version, for people.
    pub version: String,
}

/// Reply of `methods`: each method's name, and what it does.
pub type MethodsReply = BTreeMap<String, String>;

/// Parameters of `status`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct StatusParams {
    /// The version that the client speaks; one that the daemon does not speak is refused.
    pub version: Option<u32>,
}

/// Reply of `status`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StatusReply {
    /// The newest version of the protocol that the daemon speaks.
    pub protocol: u32,
    /// Every version that the daemon speaks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub versions: Option<Versions>,
    /// The daemon's own version, for people.
    pub version: String,
    /// Ticks that the loop has made.
    pub tick: u64,
    /// The last tick that took input from a device.
    pub heard: u64,
    /// Samples of pens and hands that were taken.
    pub samples: u64,
    /// Dabs that were made.
    pub dabs: u64,
    /// Vertices that were moved, each counted once a dab.
    pub vertices_moved: u64,
    /// Ticks that came late.
    pub overruns: u64,
    /// Samples that were lost between a device and the loop.
    pub losses: Losses,
    /// Duration of a tick, in milliseconds.
    pub tick_ms: Percentiles,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Number of steps that `undo` can reach.
    pub undo_steps: u64,
    /// Number of steps that `redo` can reach.
    pub redo_steps: u64,
    /// The brush and all its settings.
    pub brush: BrushSettings,
    /// Handles of the curve that a pen has laid; 0 without one.
    pub curve_points: u64,
    /// The session file; `null` where nothing is recorded.
    pub journal: Option<JournalStatus>,
    /// The connection to the others at a shared sculpture; `null` if nothing is shared.
    #[serde(default)]
    pub shared: Option<crate::people::SharedLink>,
    /// Pens that are in range where a stroke may begin: those whose ring is shown.
    #[serde(default)]
    pub pens: Vec<PenStatus>,
    /// Tablets that the desktop's pointer follows, and where the window has found that it puts
    /// them.
    #[serde(default)]
    pub tablets: Vec<TabletStatus>,
    /// Frames of the window that have shown a sample which none before them has.
    #[serde(default)]
    pub frames: u64,
    /// State of the window.
    #[serde(default)]
    pub window: WindowStatus,
    /// The path of the session file, where the daemon may open a window for it.
    #[serde(default)]
    pub session: Option<String>,
}

/// Position of a pen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PenStatus {
    /// The number of its device.
    pub device: u16,
    /// Its place in the view: from the top left, in widths and heights of the view.
    pub view: [f32; 2],
    /// Position of its ring, in pixels of the desktop (of the window under Wayland); absent without
    /// a window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixel: Option<[f64; 2]>,
}

/// Mapping of a tablet by the desktop.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TabletStatus {
    /// The number of its device.
    pub device: u16,
    /// State of its mapping.
    pub place: TabletPlace,
    /// Its area: the top left corner, the upper edge from left to right, the left edge from top to
    /// bottom, in pixels of the desktop (of the window under Wayland). Present once it is learned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<[[f64; 2]; 3]>,
}

/// State of knowledge about the desktop's mapping of a tablet.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum TabletPlace {
    /// Its whole area covers the view.
    Area,
    /// It is not known yet, or no longer: the pointer sculpts instead of the pen.
    #[default]
    Unknown,
    /// It was learned from the desktop's pointer.
    Learned,
    /// The window shows the form cut, which is only looked at: the pen does nothing.
    Cut,
}

/// State of the daemon's window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum WindowStatus {
    /// None was asked for, or it could not be opened.
    #[default]
    Headless,
    /// It is being made.
    Opening,
    /// It is shown.
    Open,
    /// Its X server or compositor has ended; `window` opens another.
    Lost,
}

/// Samples that were lost between a device and the loop.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Losses {
    /// Samples that only moved; some are lost where a device sends more than the channel holds.
    pub motion: u64,
    /// Samples in which contact or proximity changed: always 0.
    pub transition: u64,
}

/// The distribution of a duration, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Percentiles {
    /// The median.
    pub p50: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The longest.
    pub max: f64,
}

/// State of the session file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JournalStatus {
    /// The last tick that is on the disk.
    pub written: u64,
    /// Ticks that are not in the file.
    pub lost: u64,
    /// Why nothing can be written at present.
    pub fault: Option<String>,
}

/// Parameters of `window`: the variables of the environment that name the screen. `display` or
/// `wayland_display` must be given.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct WindowParams {
    /// `DISPLAY`: the X server.
    pub display: Option<String>,
    /// `WAYLAND_DISPLAY`: the compositor, as the whole path of its socket.
    pub wayland_display: Option<String>,
    /// `XAUTHORITY`: the file that holds the X server's cookie.
    pub xauthority: Option<String>,
}

/// Reply of `window`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WindowReply {
    /// The session that the new window shows.
    pub session: String,
}

/// Reply of `shutdown`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ShutdownReply {
    /// Always true.
    pub stopping: bool,
}

/// Reply of a method that only hands a command to the loop, which carries it out at its next tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SentReply {
    /// Always true.
    pub sent: bool,
}
