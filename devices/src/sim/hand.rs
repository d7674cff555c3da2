//! A simulated hand: bones and joints moved by a few plain figures, as a pure function of time.
//!
//! The bone lengths are those of a medium adult hand in mm (means over men and women of Buryanov
//! and Kotiuk 2010 for the fingers, rounded to whole mm); the joints bend about one axis, the
//! distal one two thirds as far as the middle one, which is how a hand's tendons couple them.

use glam::{Mat3, Quat, Vec3, vec3};

use super::pen::smooth;
use crate::sample::{Finger, Hand, Hands, MAX_HANDS};

/// Metacarpal, proximal, middle and distal bone, thumb first; a thumb has no metacarpal in the
/// protocol.
const BONES: [[f32; 4]; 5] = [
    [0.0, 46.0, 32.0, 22.0],
    [68.0, 40.0, 23.0, 16.0],
    [65.0, 45.0, 27.0, 17.0],
    [58.0, 41.0, 26.0, 17.0],
    [54.0, 33.0, 18.0, 16.0],
];
/// Sideways position of each finger's root at the wrist, thumb side first: mm from the middle of a
/// right hand.
const ROOTS: [f32; 5] = [-24.0, -12.0, -3.0, 6.0, 15.0];
/// Degrees by which each finger spreads from the middle one.
const SPREAD: [f32; 5] = [-38.0, -7.0, 0.0, 7.0, 14.0];
const WIDTHS: [f32; 5] = [20.0, 18.5, 18.0, 17.5, 15.5];
/// From the wrist to the middle of the palm.
const PALM: f32 = 48.0;
const FOREARM: f32 = 260.0;

/// A hand at one instant of its script; between two keys everything is interpolated smoothly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandKey {
    /// When, in microseconds since the script began.
    pub t_us: u64,
    /// Seen from this key until the next one.
    pub present: bool,
    /// Middle of the palm in the tracker's mm.
    pub palm: Vec3,
    /// Radians: turn about the vertical, fingers up, thumb down.
    pub yaw_pitch_roll: [f32; 3],
    /// 0 straight to 1 in the palm, thumb first.
    pub curl: [f32; 5],
    /// 0 to 1: thumb and index finger meet, whatever their curl.
    pub pinch: f32,
    /// 0 fingers together to 1 as far apart as they go.
    pub spread: f32,
}

impl HandKey {
    /// A flat hand, palm down, fingers away from the user.
    pub fn flat(t_us: u64, palm: Vec3) -> Self {
        HandKey {
            t_us,
            present: true,
            palm,
            yaw_pitch_roll: [0.0; 3],
            curl: [0.1; 5],
            pinch: 0.0,
            spread: 0.0,
        }
    }

    /// The hand closes; 1 is a fist.
    pub fn curled(self, curl: f32) -> Self {
        HandKey { curl: [curl; 5], ..self }
    }

    /// The same with thumb and index finger pinched, 0 to 1.
    pub fn pinched(self, pinch: f32) -> Self {
        HandKey { pinch, ..self }
    }

    /// The fingers stretched out, this far apart.
    pub fn spread(self, spread: f32) -> Self {
        HandKey { curl: [0.05; 5], spread, ..self }
    }

    /// The same turned: yaw, pitch and roll in radians.
    pub fn turned(self, yaw: f32, pitch: f32, roll: f32) -> Self {
        HandKey { yaw_pitch_roll: [yaw, pitch, roll], ..self }
    }

    /// Out of sight from here on.
    pub fn gone(self) -> Self {
        HandKey { present: false, ..self }
    }

    /// The index finger points, the others are in the palm.
    pub fn pointing(self) -> Self {
        HandKey { curl: [0.7, 0.05, 0.95, 0.95, 0.95], ..self }
    }

    fn mix(&self, to: &HandKey, s: f32) -> HandKey {
        let f = |a: f32, b: f32| a + (b - a) * s;
        let mut out = *self;
        out.palm = self.palm.lerp(to.palm, s);
        for i in 0..3 {
            out.yaw_pitch_roll[i] = f(self.yaw_pitch_roll[i], to.yaw_pitch_roll[i]);
        }
        for i in 0..5 {
            out.curl[i] = f(self.curl[i], to.curl[i]);
        }
        out.pinch = f(self.pinch, to.pinch);
        out.spread = f(self.spread, to.spread);
        out
    }
}

/// One hand's life over the tracker.
#[derive(Debug, Clone, PartialEq)]
pub struct Performer {
    /// A left hand.
    pub left: bool,
    /// In order of time.
    pub keys: Vec<HandKey>,
}

impl Performer {
    /// The pose at `t_us`, and which visit it belongs to (0 the first); `None` while out of sight.
    pub fn at(&self, t_us: u64) -> Option<(HandKey, i32)> {
        let next = self.keys.partition_point(|k| k.t_us <= t_us);
        let key = self.keys.get(next.checked_sub(1)?)?;
        let visit =
            self.keys[..next].windows(2).filter(|w| !w[0].present && w[1].present).count() as i32;
        let pose = match self.keys.get(next) {
            Some(to) => {
                key.mix(to, smooth((t_us - key.t_us) as f32 / (to.t_us - key.t_us).max(1) as f32))
            }
            None => *key,
        };
        key.present.then_some((pose, visit))
    }
}

/// Every hand over one tracker.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HandScript {
    /// One for each hand, at most [`MAX_HANDS`].
    pub performers: Vec<Performer>,
}

impl HandScript {
    /// Returns the time of the last key, in microseconds.
    pub fn end_us(&self) -> u64 {
        self.performers.iter().filter_map(|p| p.keys.last()).map(|k| k.t_us).max().unwrap_or(0)
    }

    /// Everything that a tracker sees at `t_us`. A hand that comes back has a new id, as with a
    /// real tracker.
    pub fn at(&self, t_us: u64, frame: i64) -> Hands {
        let mut out = Hands { frame, ..Hands::default() };
        for (i, who) in self.performers.iter().take(MAX_HANDS).enumerate() {
            if let Some((pose, visit)) = who.at(t_us) {
                let before = who.at(t_us.saturating_sub(5_000)).map_or(pose, |b| b.0);
                let velocity = (pose.palm - before.palm) * 200.0;
                let mut hand = skeleton(&pose, who.left);
                hand.id = 1 + visit * MAX_HANDS as i32 + i as i32;
                hand.palm_velocity = Some(velocity);
                out.hands[out.count as usize] = hand;
                out.count += 1;
            }
        }
        out.hands[..out.count as usize].sort_by_key(|h| h.id);
        out
    }
}

/// Every joint of a hand in this pose, in the tracker's axes.
pub fn skeleton(pose: &HandKey, left: bool) -> Hand {
    let [yaw, pitch, roll] = pose.yaw_pitch_roll;
    let turn =
        Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Quat::from_rotation_z(roll);
    let side = if left { -1.0 } else { 1.0 };
    // In the hand's own axes the fingers run along -z and the back looks along +y; a left hand is
    // the mirror image.
    let place = |v: Vec3| pose.palm + turn * vec3(side * v.x, v.y, v.z);
    let aim = |v: Vec3| turn * vec3(side * v.x, v.y, v.z);
    let mut own = [0, 1, 2, 3, 4].map(|f| chain(f, pose.curl[f], pose.spread));
    if pose.pinch > 0.0 {
        pinch(&mut own, pose.pinch);
    }
    let gap = own[0][4].distance(own[1][4]);
    let fingers = [0, 1, 2, 3, 4].map(|f| {
        let j = own[f];
        Some(Finger {
            joints: j.map(|v| Some(place(v))),
            tip: place(j[4]),
            direction: Some(aim(j[4] - j[3]).normalize_or(Vec3::NEG_Z)),
            width: Some(WIDTHS[f]),
            extended: Some(pose.curl[f] < 0.45),
        })
    });
    let grab = pose.curl[1..].iter().sum::<f32>() / 4.0;
    Hand {
        id: 1,
        left: Some(left),
        palm: pose.palm,
        palm_normal: Some(turn * Vec3::NEG_Y),
        direction: Some(turn * Vec3::NEG_Z),
        palm_velocity: Some(Vec3::ZERO),
        grab: Some(((grab - 0.2) / 0.75).clamp(0.0, 1.0)),
        pinch: Some((1.0 - (gap - 12.0) / 50.0).clamp(0.0, 1.0)),
        confidence: Some(1.0),
        time_visible: Some(1.0),
        palm_width: Some(85.0),
        orientation: Some(turn),
        wrist: Some(place(vec3(0.0, 0.0, PALM))),
        elbow: Some(place(vec3(0.0, 0.0, PALM + FOREARM))),
        fingers,
    }
}

/// The five joints of one finger of a right hand, in the hand's own axes about the palm's middle.
fn chain(finger: usize, curl: f32, spread: f32) -> [Vec3; 5] {
    let thumb = finger == 0;
    // Spread on purpose, fingers stand two and a half times as far apart as at rest.
    let apart = (1.0 + 1.5 * spread) * (1.0 - 0.6 * curl);
    let yaw = Quat::from_rotation_y(
        -SPREAD[finger].to_radians() * if thumb { 1.0 - 0.6 * curl } else { apart },
    );
    // A thumb closes across the palm, the fingers into it.
    let axis = if thumb { vec3(0.35, 0.85, 0.0).normalize() } else { Vec3::X };
    let bend = if thumb { [0.0, -0.5, -0.6, -0.7] } else { [0.0, -1.45, -1.7, -1.15] };
    let mut at =
        vec3(ROOTS[finger], if thumb { -8.0 } else { 0.0 }, PALM - if thumb { 14.0 } else { 4.0 });
    let mut joints = [at; 5];
    let mut turn = yaw;
    for bone in 0..4 {
        // The metacarpals spread less than the fingers do.
        let spread = if bone == 0 { Quat::IDENTITY.slerp(yaw, 0.5) } else { yaw };
        turn =
            if bone == 0 { spread } else { turn * Quat::from_axis_angle(axis, bend[bone] * curl) };
        if bone == 1 {
            turn = yaw * Quat::from_axis_angle(axis, bend[1] * curl);
        }
        at += turn * vec3(0.0, 0.0, -BONES[finger][bone]);
        joints[bone + 1] = at;
    }
    joints
}

/// Brings the tips of thumb and index finger together, each joint by its share of the way, so that
/// bones keep nearly their lengths.
fn pinch(own: &mut [[Vec3; 5]; 5], by: f32) {
    let meet = (own[0][4] + own[1][4]) * 0.5 + vec3(0.0, -12.0, 8.0);
    for (finger, apart) in [(0, vec3(-4.0, -3.0, 0.0)), (1, vec3(4.0, 3.0, 0.0))] {
        let whole = (meet + apart - own[finger][4]) * by;
        for (joint, share) in [(2, 0.25), (3, 0.65), (4, 1.0)] {
            own[finger][joint] += whole * share;
        }
    }
}

/// The hand's basis as the protocol gives it: three rows, x across, y out of the back, z toward the
/// wrist.
pub(super) fn basis(hand: &Hand) -> Mat3 {
    hand.orientation.map_or(Mat3::IDENTITY, Mat3::from_quat)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bones_keep_their_lengths_and_a_fist_is_in_the_palm() {
        for curl in [0.0, 0.3, 0.7, 1.0] {
            let pose = HandKey::flat(0, vec3(10.0, 200.0, 5.0)).curled(curl).turned(0.4, -0.3, 1.0);
            for left in [false, true] {
                let h = skeleton(&pose, left);
                for (f, bones) in h.fingers.iter().flatten().zip(BONES) {
                    for (pair, length) in f.joints.windows(2).zip(bones) {
                        let d = pair[0].unwrap().distance(pair[1].unwrap());
                        assert!((d - length).abs() < 0.05, "{d} for {length}");
                    }
                }
                let reach = h.fingers[2].unwrap().tip.distance(h.palm);
                assert!(
                    if curl == 1.0 { reach < 60.0 } else { curl > 0.5 || reach > 75.0 },
                    "{curl}: {reach}"
                );
            }
        }
    }

    #[test]
    fn left_mirrors_right_and_the_thumb_is_on_the_inside() {
        let (r, l) = (
            skeleton(&HandKey::flat(0, Vec3::ZERO), false),
            skeleton(&HandKey::flat(0, Vec3::ZERO), true),
        );
        let (rt, lt) = (r.fingers[0].unwrap().tip, l.fingers[0].unwrap().tip);
        assert!(rt.x < 0.0, "a right hand, palm down, has its thumb on the left: {rt}");
        assert!((rt * vec3(-1.0, 1.0, 1.0)).distance(lt) < 1e-3);
    }

    #[test]
    fn a_pinch_closes_the_gap_and_a_script_gives_new_ids() {
        let open = HandKey::flat(0, Vec3::ZERO);
        let gap = |k: &HandKey| {
            let h = skeleton(k, false);
            h.fingers[0].unwrap().tip.distance(h.fingers[1].unwrap().tip)
        };
        assert!(
            gap(&open) > 40.0 && gap(&open.pinched(1.0)) < 25.0,
            "{} {}",
            gap(&open),
            gap(&open.pinched(1.0))
        );
        let keys = vec![open, HandKey { t_us: 100, ..open }.gone(), HandKey { t_us: 200, ..open }];
        let s = HandScript { performers: vec![Performer { left: false, keys }] };
        let ids = [50, 150, 250].map(|t| s.at(t, 1).as_slice().first().map(|h| h.id));
        assert_eq!(ids, [Some(1), None, Some(5)]);
    }
}
