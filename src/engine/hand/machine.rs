//! One hand over time: its pose with hold and hysteresis, and how strongly it may act.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::pose::{Features, Pose};
use super::settings::HandSettings;
use sculptd_devices::{DeviceId, Hand};

/// One hand as it is followed from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// The tracker.
    pub device: DeviceId,
    /// The tracker's id of the moment.
    pub id: i32,
    /// A left hand; `None`: the tracker does not say.
    pub left: Option<bool>,
    /// The pose in force.
    pub pose: Pose,
    /// The pose that is about to be, and since when.
    candidate: Pose,
    candidate_us: u64,
    /// Since when the pose in force is in force.
    pub pose_us: u64,
    /// Time at which the hand came into view, in microseconds.
    pub appeared_us: u64,
    /// Time at which the hand was last seen, in microseconds.
    pub seen_us: u64,
    /// The middle of the palm, mm over the tracker.
    pub palm: Vec3,
    /// Out of the palm, unit length.
    pub palm_normal: Option<Vec3>,
    /// Orientation of the hand.
    pub orientation: Option<Quat>,
    /// The tip of the index finger, mm.
    pub index_tip: Option<Vec3>,
    /// Midway between thumb and index tips.
    pub pinch_point: Option<Vec3>,
    /// Thumb tip to index tip, mm.
    pub pinch_mm: Option<f32>,
    /// The tracker's confidence in the hand, 0 to 1.
    pub confidence: f32,
}

fn ms(from_us: u64, to_us: u64) -> f32 {
    to_us.saturating_sub(from_us) as f32 * 1e-3
}

impl Track {
    /// A hand that appears now, in the neutral pose.
    pub fn new(device: DeviceId, t_us: u64, hand: &Hand) -> Self {
        let mut track = Track {
            device,
            id: hand.id,
            left: hand.left,
            pose: Pose::Neutral,
            candidate: Pose::Neutral,
            candidate_us: t_us,
            pose_us: t_us,
            appeared_us: t_us,
            seen_us: t_us,
            palm: hand.palm,
            palm_normal: None,
            orientation: None,
            index_tip: None,
            pinch_point: None,
            pinch_mm: None,
            confidence: 0.0,
        };
        track.place(hand);
        track
    }

    fn place(&mut self, hand: &Hand) {
        let tip = |i: usize| hand.fingers[i].map(|f| f.tip);
        self.id = hand.id;
        self.left = hand.left.or(self.left);
        self.palm = hand.palm;
        self.palm_normal = hand.palm_normal;
        self.orientation = hand.orientation;
        self.index_tip = tip(1);
        self.pinch_point = tip(0).zip(tip(1)).map(|(a, b)| (a + b) * 0.5);
        self.pinch_mm = tip(0).zip(tip(1)).map(|(a, b)| (a - b).length());
        self.confidence = hand.confidence.unwrap_or(1.0).clamp(0.0, 1.0);
    }

    /// Takes the next frame. Returns whether the pose changed.
    pub fn take(&mut self, t_us: u64, hand: &Hand, s: &HandSettings) -> bool {
        // A gap restarts the hold, not the pose: the hand was bridged.
        self.place(hand);
        self.seen_us = t_us;
        // A pinch that has been seen once goes on by the wider threshold: a camera's fingertips
        // tremble by more than the two thresholds differ.
        let now = if self.candidate == Pose::Pinch { Pose::Pinch } else { self.pose };
        let seen = Features::of(hand).pose(now, s);
        if seen != self.candidate {
            (self.candidate, self.candidate_us) = (seen, t_us);
        }
        if self.candidate != self.pose && ms(self.candidate_us, t_us) >= s.hold_ms {
            (self.pose, self.pose_us) = (self.candidate, t_us);
            return true;
        }
        false
    }

    /// Ends a pinch whose fingers parted while the hand was unseen. The next frames decide the
    /// pose anew.
    pub fn open_unseen(&mut self, t_us: u64) {
        if self.pose == Pose::Pinch {
            (self.pose, self.pose_us) = (Pose::Neutral, t_us);
            (self.candidate, self.candidate_us) = (Pose::Neutral, t_us);
        }
    }

    /// Returns true if this may be the same hand that another track lost: the same side, and near
    /// enough for the time elapsed.
    pub fn may_continue(&self, t_us: u64, hand: &Hand, s: &HandSettings) -> bool {
        let gap = ms(self.seen_us, t_us);
        // The fastest palms on record move at 1.3 m/s; 60 mm more for the tracker's own jump.
        let far = 60.0 + gap * 1.3;
        let sides = self.left.zip(hand.left).is_none_or(|(a, b)| a == b);
        gap <= s.bridge_ms && sides && (self.palm - hand.palm).length() <= far
    }

    /// The fingers of a pinch are parting: what they held stays where it is.
    pub fn lets_go(&self, s: &HandSettings) -> bool {
        self.pinch_mm.is_none_or(|gap| gap > s.pinch_on_mm + (s.pinch_off_mm - s.pinch_on_mm) / 3.0)
    }

    /// 0 to 1: how strongly the hand may act now.
    pub fn strength(&self, t_us: u64, s: &HandSettings) -> f32 {
        let ramp = |from: u64, over: f32| (ms(from, t_us) / over.max(1e-3)).min(1.0);
        ramp(self.appeared_us, s.appear_ramp_ms)
            * ramp(self.pose_us, s.pose_ramp_ms)
            * self.confidence
    }
}
