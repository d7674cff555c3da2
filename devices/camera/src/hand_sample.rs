//! From 21 joints to a hand as a tracker reports it.

use glam::{Mat3, Quat, Vec3};

use crate::landmarks::JOINTS;
use sculptd_devices::{Finger, Hand};

/// Widths of the fingers, thumb first, mm, of an average adult.
const WIDTHS: [f32; 5] = [20.0, 18.0, 18.0, 17.0, 15.0];
/// From wrist to elbow, mm.
const FOREARM_MM: f32 = 250.0;
/// Palm over the distance of the outer knuckles: a palm is wider than its bones.
const PALM_OVER_KNUCKLES: f32 = 1.25;
/// Below this confidence a pinch can neither begin nor end: the thumb is not reported.
const PINCH_CONFIDENCE: f32 = 0.4;

/// Facts about a hand besides its joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandFacts {
    /// Number of the hand.
    pub id: i32,
    /// A left hand.
    pub left: bool,
    /// 0 to 1.
    pub confidence: f32,
    /// Speed of the palm, mm/s.
    pub velocity: Vec3,
    /// Seconds since the hand appeared.
    pub visible_s: f32,
}

/// Returns the middle of the palm.
pub fn palm_of(joints: &[Vec3; JOINTS]) -> Vec3 {
    [0, 5, 9, 13, 17].iter().map(|i| joints[*i]).sum::<Vec3>() * 0.2
}

/// Builds the hand; joints are in the tracker's axes, mm.
pub fn hand_of(joints: &[Vec3; JOINTS], facts: &HandFacts) -> Hand {
    let (wrist, index, middle, little) = (joints[0], joints[5], joints[9], joints[17]);
    let palm = palm_of(joints);
    let direction = (middle - wrist).normalize_or(Vec3::NEG_Z);
    let out = (index - wrist).cross(little - wrist) * if facts.left { -1.0 } else { 1.0 };
    // At right angles to the direction, as the orientation needs it.
    let normal = (out - direction * out.dot(direction)).try_normalize();
    let width = (index.distance(little) * PALM_OVER_KNUCKLES).max(40.0);
    let tips = [8, 12, 16, 20].map(|i| joints[i].distance(palm) / width);
    let reach = tips.iter().sum::<f32>() / 4.0;
    let gap = joints[4].distance(joints[8]);
    let mut fingers = [0, 1, 2, 3, 4].map(|f| Some(finger_of(joints, f, direction)));
    if facts.confidence < PINCH_CONFIDENCE {
        fingers[0] = None;
    }
    Hand {
        id: facts.id,
        left: Some(facts.left),
        palm,
        palm_normal: normal,
        direction: Some(direction),
        palm_velocity: Some(facts.velocity),
        // Open fingertips are 1.1 palm widths off, a fist's 0.5.
        grab: Some(((1.1 - reach) / 0.6).clamp(0.0, 1.0)),
        pinch: Some((1.0 - (gap - 12.0) / 50.0).clamp(0.0, 1.0)),
        confidence: Some(facts.confidence.clamp(0.0, 1.0)),
        time_visible: Some(facts.visible_s),
        palm_width: Some(width),
        orientation: normal.map(|n| orientation(direction, n)),
        wrist: Some(wrist),
        // A camera does not see the elbow: it is where a straight wrist puts it, on the table for
        // a hand in the middle of the picture.
        elbow: Some(wrist - direction * FOREARM_MM),
        fingers,
    }
}

/// From the tracker's axes to the hand's: x across the palm, y out of its back, z to the wrist.
fn orientation(direction: Vec3, normal: Vec3) -> Quat {
    let (y, z) = (-normal, -direction);
    Quat::from_mat3(&Mat3::from_cols(y.cross(z), y, z)).normalize()
}

fn finger_of(joints: &[Vec3; JOINTS], finger: usize, direction: Vec3) -> Finger {
    let first = 1 + 4 * finger;
    let own = [joints[first], joints[first + 1], joints[first + 2], joints[first + 3]];
    // A metacarpal begins beside the wrist; a thumb's first two joints are one.
    let root = if finger == 0 { own[0] } else { joints[0].lerp(own[0], 0.16) };
    let bones: f32 = own.windows(2).map(|w| w[0].distance(w[1])).sum();
    let straight = own[0].distance(own[3]) / bones.max(1e-3);
    Finger {
        joints: [Some(root), Some(own[0]), Some(own[1]), Some(own[2]), Some(own[3])],
        tip: own[3],
        direction: Some((own[3] - own[2]).normalize_or(direction)),
        width: Some(WIDTHS[finger]),
        extended: Some(straight > 0.9),
    }
}
