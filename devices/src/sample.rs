//! The type that this crate produces: the state of a device at one instant.
//!
//! Rules:
//! * A `Sample` is **complete state**, never a delta: losing one loses resolution, not meaning.
//! * A field the device does not have is `None`; a field it has is always within its stated range.
//! * Plain data: `Copy`, no pointers, serialises. Moving one through the channel allocates nothing.

use glam::{Quat, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Most hands that one tracker frame may carry; further hands are dropped and counted.
/// Four: two people over one tracker. A Leap tracks two reliably.
pub const MAX_HANDS: usize = 4;

/// A device as the daemon knows it while it runs. Dense, small, reused after a replug of the *same*
/// device.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, Default,
)]
pub struct DeviceId(pub u16);

/// The state of a device at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// The device.
    pub device: DeviceId,
    /// Microseconds on the daemon's monotonic clock, stamped when the bytes were read. For a
    /// tracker that stamps its frames: when the frame was taken, brought onto our clock
    /// ([`crate::leap::ClockMap`]); never later than the read.
    pub t_us: u64,
    /// Microseconds on the device's own clock, where it has one (its origin is unknown).
    pub device_t_us: Option<u64>,
    /// The state.
    pub body: Body,
}

/// The state of a device, by its kind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
// Copied inline on purpose: a box would be freed on the consumer's thread.
#[allow(clippy::large_enum_variant)]
pub enum Body {
    /// A pen over or on its surface.
    Pen(Pen),
    /// Every hand that a tracker saw.
    Hands(Hands),
    /// Keys, wheels and strips of a tablet.
    Pad(Pad),
}

/// Tool that touches or hovers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, Default)]
pub enum Tool {
    /// The tip of a pen.
    #[default]
    Pen,
    /// The other end of a pen.
    Eraser,
    /// A puck or mouse on the tablet: it moves, it never presses.
    Mouse,
    /// The window's own pointer, or a finger.
    Touch,
}

/// A pen over or on its surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Default)]
pub struct Pen {
    /// Tool in use. It does not change within a visit.
    pub tool: Tool,
    /// The pen is in proximity: position is meaningful. `false` in the last sample of a visit.
    pub in_range: bool,
    /// The tip touches. Implies `in_range`. Decided by [`crate::pen_state`], hover never presses.
    pub tip: bool,
    /// Position in mm from the top left of the active area; +x right, +y toward the user.
    pub pos_mm: Vec2,
    /// Size of the active area in mm, so that a consumer needs no device table.
    pub area_mm: Vec2,
    /// Position in device counts, before any calibration.
    pub raw: [i32; 2],
    /// 0 to 1. `None`: the device has no pressure, and `tip` alone says whether it touches.
    pub pressure: Option<f32>,
    /// Radians from the vertical, +x leaning right, +y leaning toward the user; each within ±π/2.
    pub tilt: Option<Vec2>,
    /// Radians about the pen's own axis, clockwise seen from above, in `-π..π`.
    pub twist: Option<f32>,
    /// Height over the surface in the device's own counts (no device states mm); absent on contact.
    pub distance: Option<f32>,
    /// Barrel buttons, bit 0 the lower one.
    pub buttons: u32,
}

/// Keys, wheels, rings and strips of a tablet's own pad, as complete state.
///
/// The pen's barrel buttons and its eraser are in [`Pen::buttons`] and [`Pen::tool`].
/// [`crate::pad_actions`] turns consecutive states into presses, releases and steps. A mode of the
/// pad, with its LED, is no state of the device: it is the consumer's, see
/// [`crate::pad_actions::ActionState`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Default)]
pub struct Pad {
    /// Pressed keys, bit 0 the first. The order is that of the device's reports; keys in the middle
    /// of a ring or dial come after those of the frame.
    pub keys: u32,
    /// Steps turned since the device appeared, clockwise positive, one counter a wheel. A counter
    /// and not a step, so that a coalesced sample loses nothing.
    pub wheels: [i32; 2],
    /// Position of the finger along each touch strip or ring, 0 to 1; `None` while not touched. A
    /// ring counts clockwise, and 0 and 1 are the same place. A strip counts from its far end, or
    /// from its left one, as the device does.
    pub strips: [Option<f32>; 2],
}

/// Every hand that a tracker saw in one frame. mm, right-handed, origin on the tracker, +y up, +z
/// toward the user.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hands {
    /// The tracker's own frame number.
    pub frame: i64,
    /// Number of used entries of `hands`, at most [`MAX_HANDS`].
    pub count: u8,
    /// The hands. Entries from `count` on have no meaning.
    pub hands: [Hand; MAX_HANDS],
}

impl Hands {
    /// The hands that were seen.
    pub fn as_slice(&self) -> &[Hand] {
        &self.hands[..(self.count as usize).min(MAX_HANDS)]
    }
}

impl Default for Hands {
    fn default() -> Self {
        Hands { frame: 0, count: 0, hands: [Hand::default(); MAX_HANDS] }
    }
}

/// One hand. Positions are in mm in the tracker's axes; `None` is what the tracker did not report.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Default)]
pub struct Hand {
    /// The tracker's id; it changes when the tracker loses and finds the hand again.
    pub id: i32,
    /// `None` where the tracker does not say.
    pub left: Option<bool>,
    /// Middle of the palm.
    pub palm: Vec3,
    /// Out of the palm; unit length, or `None`.
    pub palm_normal: Option<Vec3>,
    /// From the wrist to the fingers; unit length, or `None`.
    pub direction: Option<Vec3>,
    /// mm a second.
    pub palm_velocity: Option<Vec3>,
    /// 0 open to 1 a fist.
    pub grab: Option<f32>,
    /// 0 to 1 as the tracker judges it; gestures use the thumb-to-index distance instead.
    pub pinch: Option<f32>,
    /// 0 to 1.
    pub confidence: Option<f32>,
    /// Seconds; the first value after a hand appears is known to be garbage in real recordings.
    pub time_visible: Option<f32>,
    /// Width over the knuckles.
    pub palm_width: Option<f32>,
    /// Of the palm, from the tracker's axes to the hand's; absent where neither basis nor normal
    /// came.
    pub orientation: Option<Quat>,
    /// Middle of the wrist.
    pub wrist: Option<Vec3>,
    /// Middle of the elbow.
    pub elbow: Option<Vec3>,
    /// Thumb to little finger. A finger that the tracker did not report is `None`.
    pub fingers: [Option<Finger>; 5],
}

/// One finger. Positions are in mm in the tracker's axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Default)]
pub struct Finger {
    /// Carpal-metacarpal, knuckle, first and second joint, and the end of the last bone; absent
    /// joints are `None`.
    pub joints: [Option<Vec3>; 5],
    /// The finger's tip.
    pub tip: Vec3,
    /// Unit length, along the last bone.
    pub direction: Option<Vec3>,
    /// mm.
    pub width: Option<f32>,
    /// The finger is stretched out, as the tracker judges it.
    pub extended: Option<bool>,
}

impl Sample {
    /// Two samples of one device differ in nothing but motion: the older may be dropped when the
    /// channel is full. Contact, proximity, tool, buttons, keys, the set of hands: a change of any
    /// is a **transition** and is never dropped.
    pub fn only_moved_since(&self, older: &Sample) -> bool {
        if self.device != older.device {
            return false;
        }
        match (&self.body, &older.body) {
            (Body::Pen(a), Body::Pen(b)) => {
                a.tool == b.tool
                    && a.in_range == b.in_range
                    && a.tip == b.tip
                    && a.buttons == b.buttons
            }
            (Body::Pad(a), Body::Pad(b)) => {
                a.keys == b.keys && a.strips.map(|s| s.is_some()) == b.strips.map(|s| s.is_some())
            }
            (Body::Hands(a), Body::Hands(b)) => {
                a.count == b.count
                    && a.as_slice().iter().zip(b.as_slice()).all(|(x, y)| x.id == y.id)
            }
            _ => false,
        }
    }
}
