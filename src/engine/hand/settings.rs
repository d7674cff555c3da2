//! What decides how a hand is read. Each number has its unit and its reason.

use serde::{Deserialize, Serialize};

use super::reach_box::ReachBox;
use sculptd_devices::filter::OneEuro;

/// Thresholds of the hand recognition and strengths of the hand tools.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HandSettings {
    /// Thumb tip to index tip, mm: fingers that touch are 15 to 22 mm apart at their centres, as
    /// trackers see them.
    pub pinch_on_mm: f32,
    /// A pinch lets go well after the tips part, so that it does not flutter while dragging.
    pub pinch_off_mm: f32,
    /// The tracker's grab strength, 0 to 1.
    pub grab_on: f32,
    /// Below this grab strength a fist lets go, 0 to 1.
    pub grab_off: f32,
    /// A closing fist brings thumb and index together: above this grab strength no pinch begins.
    pub pinch_max_grab: f32,
    /// Index tip to little finger's tip, mm, over the palm's width: below, fingers lie together (a
    /// flat palm), above, apart.
    pub spread: f32,
    /// A pose must hold this long before it acts, ms: two frames at 90 Hz.
    pub hold_ms: f32,
    /// Full strength this long after a change of pose, ms: slower than a slip of the hand, quicker
    /// than patience.
    pub pose_ramp_ms: f32,
    /// Full strength this long after a hand appears, ms: a hand that comes into view inside the
    /// clay must not tear it.
    pub appear_ramp_ms: f32,
    /// A hand lost for no longer is bridged, ms.
    pub bridge_ms: f32,
    /// Fingertip tool, mm: a fingertip is 14 to 18 mm wide and clay gives.
    pub tip_radius_mm: f32,
    /// Pinch tool, mm: what two fingertips can hold.
    pub pinch_radius_mm: f32,
    /// Palm tool, mm: half a palm's width.
    pub palm_radius_mm: f32,
    /// Motion smaller than this does not turn or move the view, mm; grows by `dwell_zone_mm` while
    /// the hand rests.
    pub dead_zone_mm: f32,
    /// Distance that the palm may drift and still count as resting, in mm.
    pub dwell_zone_mm: f32,
    /// After sculpting the view stays still this long, ms, whatever the hand does.
    pub view_rest_ms: f32,
    /// A fingertip in a menu's ball for so long opens a ring, ms, ...
    pub dwell_ms: f32,
    /// ... which closes in so long: time to see it and to leave.
    pub ring_ms: f32,
    /// The part of the tracked space that is laid over the work; a calibration finds a person's
    /// own.
    pub reach: ReachBox,
    /// Filter that smooths the joints.
    pub steady: OneEuro,
}

impl Default for HandSettings {
    fn default() -> Self {
        HandSettings {
            pinch_on_mm: 25.0,
            pinch_off_mm: 40.0,
            grab_on: 0.8,
            grab_off: 0.6,
            pinch_max_grab: 0.5,
            spread: 1.15,
            hold_ms: 20.0,
            pose_ramp_ms: 150.0,
            appear_ramp_ms: 750.0,
            bridge_ms: 100.0,
            tip_radius_mm: 12.0,
            pinch_radius_mm: 22.0,
            palm_radius_mm: 42.0,
            dead_zone_mm: 3.0,
            dwell_zone_mm: 5.0,
            view_rest_ms: 500.0,
            dwell_ms: 500.0,
            ring_ms: 600.0,
            reach: ReachBox::default(),
            steady: OneEuro::default(),
        }
    }
}
