//! What one frame of one hand looks like, before time is taken into account.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::settings::HandSettings;
use sculptd_devices::{Finger, Hand};

/// Pose of a hand.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, PartialOrd, Ord,
)]
#[serde(rename_all = "kebab-case")]
pub enum Pose {
    /// Does nothing, and shows that it does nothing.
    #[default]
    Neutral,
    /// The index fingertip is the tool.
    Point,
    /// Thumb and index hold the clay.
    Pinch,
    /// A fist holds the work.
    Grab,
    /// Fingers together: presses and smooths.
    Flat,
    /// Fingers apart: turns the work.
    Open,
}

impl Pose {
    /// All poses.
    pub const ALL: [Pose; 6] =
        [Pose::Neutral, Pose::Point, Pose::Pinch, Pose::Grab, Pose::Flat, Pose::Open];
}

/// Measurements of one frame. `None`: the fingers that it needs were not tracked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Features {
    /// Thumb tip to index tip, mm.
    pub pinch_mm: Option<f32>,
    /// 0 open to 1 a fist; the tracker's, else from how far the fingertips are from the palm.
    pub grab: f32,
    /// Index, middle, ring, little finger stretched out.
    pub extended: [bool; 4],
    /// Number of those four that the tracker did not see.
    pub hidden: usize,
    /// Index tip to little finger's tip over the palm's width.
    pub spread: Option<f32>,
}

/// Palm width if the tracker reports none: an adult's palm, in mm.
const PALM_WIDTH_MM: f32 = 85.0;

/// A finger less straight than this is bent, whatever its flag says. In recordings of real hands
/// 99 of 100 stretched fingers are straighter; the others belong to closing fists.
const BENT: f32 = 0.75;
/// A finger straighter than this, and farther out than [`STRETCHED_REACH`], is stretched.
const STRAIGHT: f32 = 0.985;
/// Tip to palm over the palm's width; bent fingers of real hands are nearer, up to 1.2, or less
/// straight.
const STRETCHED_REACH: f32 = 1.3;
/// Tip to palm over the palm's width, below which a finger cannot be stretched; real stretched
/// ones reach 0.85 and more.
const CURLED_REACH: f32 = 0.7;

impl Features {
    /// Measures one frame.
    pub fn of(hand: &Hand) -> Self {
        let tip = |i: usize| hand.fingers[i].map(|f| f.tip);
        let between = |a: Option<Vec3>, b: Option<Vec3>| a.zip(b).map(|(a, b)| (a - b).length());
        let width = hand.palm_width.filter(|w| (40.0..=150.0).contains(w)).unwrap_or(PALM_WIDTH_MM);
        let stretched =
            |i: usize| hand.fingers[i].is_some_and(|f| is_extended(&f, hand.palm, width));
        let extended = [stretched(1), stretched(2), stretched(3), stretched(4)];
        let curled = || {
            let known: f32 = (1..5).filter_map(tip).map(|t| (t - hand.palm).length() / width).sum();
            let count = (1..5).filter(|&i| tip(i).is_some()).count();
            // Open fingertips are 1.1 palm widths off, a fist's 0.5.
            if count == 0 { 0.0 } else { ((1.1 - known / count as f32) / 0.6).clamp(0.0, 1.0) }
        };
        Features {
            pinch_mm: between(tip(0), tip(1)),
            grab: hand.grab.unwrap_or_else(curled),
            extended,
            hidden: (1..5).filter(|&i| hand.fingers[i].is_none()).count(),
            spread: between(tip(1), tip(4)).map(|d| d / width),
        }
    }

    /// The pose of this frame, given the pose in force: entry and exit thresholds differ.
    pub fn pose(&self, now: Pose, s: &HandSettings) -> Pose {
        // Trackers give a hand seen from its edge a high grab strength though its fingers are out:
        // a fist has none to show.
        let out = self.extended.iter().filter(|e| **e).count();
        let fist = if now == Pose::Grab {
            self.grab >= s.grab_off
        } else {
            self.grab >= s.grab_on && out <= 1
        };
        if fist {
            return Pose::Grab;
        }
        let pinched = match (self.pinch_mm, now == Pose::Pinch) {
            (Some(d), true) => d < s.pinch_off_mm,
            (Some(d), false) => d < s.pinch_on_mm && self.grab < s.pinch_max_grab,
            (None, held) => held,
        };
        if pinched {
            return Pose::Pinch;
        }
        let [index, middle, ring, little] = self.extended;
        if index && !middle && !ring && !little {
            return Pose::Point;
        }
        // One finger may be hidden behind the others: a hand that was flat or open stays so.
        let hidden = self.hidden;
        if out + hidden == 4 && hidden <= 1 && self.grab < 0.3 {
            // A tenth of hysteresis on the boundary between lying together and being apart.
            let lean = match now {
                Pose::Flat => 0.1,
                Pose::Open => -0.1,
                _ => 0.0,
            };
            return match self.spread {
                Some(w) if w > s.spread + lean => Pose::Open,
                Some(_) => Pose::Flat,
                None if matches!(now, Pose::Flat | Pose::Open) => now,
                None => Pose::Neutral,
            };
        }
        Pose::Neutral
    }
}

/// Returns the tracker's flag, unless the bones contradict it: it may be stuck. Without a flag, the
/// distance of the tip from the palm decides.
fn is_extended(finger: &Finger, palm: Vec3, width: f32) -> bool {
    let reach = (finger.tip - palm).length() / width;
    let Some(word) = finger.extended else { return reach > 0.95 };
    match (word, straightness(finger)) {
        (true, Some(straight)) => straight >= BENT,
        (true, None) => reach >= CURLED_REACH,
        (false, Some(straight)) => straight > STRAIGHT && reach > STRETCHED_REACH,
        (false, None) => false,
    }
}

/// Returns the distance from knuckle to tip as a share of the bones between them, or `None` if
/// joints are missing.
pub(super) fn straightness(finger: &Finger) -> Option<f32> {
    let [_, knuckle, first, second, _] = finger.joints;
    let (knuckle, first, second) = (knuckle?, first?, second?);
    let bones = knuckle.distance(first) + first.distance(second) + second.distance(finger.tip);
    (bones > 1.0).then(|| knuckle.distance(finger.tip) / bones)
}
