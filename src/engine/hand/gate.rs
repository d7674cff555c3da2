//! Filters a tracker's frames before anything acts on them: it decides which hand is which, and
//! drops what cannot be true.
//!
//! * Hands are associated by **place**; side and id are weaker evidence. A tracker that swaps or
//!   renumbers two hands changes nothing here.
//! * A hand that accelerates faster than an arm can is not where the frame says. The gate drops
//!   the frame and bridges the hand. A second frame that continues the motion is a strike, and the
//!   hand is believed; a hand that stays at the new place is another hand, and appears as one.
//! * A hand that appears within a known one is the same hand, found twice.
//! * A finger or an orientation that jumps while the palm does not keeps its last value, and so
//!   does the `extended` flag of a finger that neither stretched nor bent.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::pose::straightness;
use sculptd_devices::sample::MAX_HANDS;
use sculptd_devices::{Finger, Hand, Hands};

/// Half of the greatest acceleration of a palm, mm/s²: 15 g, above what a strike reaches.
const HALF_ACCELERATION: f32 = 75_000.0;
/// Greatest believed speed of a palm, mm/s; the fastest on record move at 1,300.
const SPEED: f32 = 2_500.0;
/// Greatest speed of a strike, mm/s: a boxer's fist reaches 9,000, a hand over clay half of it.
const STRIKE_SPEED: f32 = 5_000.0;
/// How much the speed of a strike may change between two frames, as a share of it.
const STRIKE_CHANGE: f32 = 0.5;
/// A tracker's own noise, mm.
const NOISE_MM: f32 = 10.0;
/// Greatest speed of a fingertip relative to its palm, mm/s.
const FINGER_SPEED: f32 = 2_500.0;
/// Noise of a fingertip, mm.
const FINGER_NOISE_MM: f32 = 12.0;
/// Greatest angular speed of a hand, radians a second.
const TURN_SPEED: f32 = 20.0;
/// Noise of an orientation, radians.
const TURN_NOISE: f32 = 0.2;
/// Longest extrapolation of a speed, seconds: a hand may stop.
const CARRIED_ON_S: f32 = 0.05;
/// Cost of a tracker id that differs, in mm of distance.
const OTHER_NUMBER_MM: f32 = 15.0;
/// Cost of a side that differs, in mm of distance.
const OTHER_SIDE_MM: f32 = 60.0;
/// A hand that appears nearer than this to a known one is the same hand, mm: two palms that touch
/// are at least a hand's thickness apart.
const TWIN_MM: f32 = 60.0;
/// Time after which a place that no hand can have reached is believed, microseconds.
const PERSISTS_US: u64 = 120_000;
/// Time after which a doubted hand that is no longer seen is forgotten, microseconds.
const DOUBT_LAPSES_US: u64 = 40_000;
/// Time after which a known hand that is no longer seen is forgotten, microseconds.
const FORGOTTEN_US: u64 = 300_000;
/// Changes of a finger's straightness and of its distance from the palm, mm, below which it
/// neither stretched nor bent.
const SAME_SHAPE: (f32, f32) = (0.06, 6.0);
/// Longest time for which a part of a hand that jumps keeps its last value, microseconds.
const HELD_US: u64 = 100_000;

/// One hand as it was believed last.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Known {
    /// The id that the hand keeps, whatever id its tracker gives it.
    id: i32,
    /// The id that the tracker gave it last.
    tracker_id: i32,
    hand: Hand,
    speed: Vec3,
    t_us: u64,
    /// When each finger was last believed, microseconds.
    finger_us: [u64; 5],
    turn_us: u64,
    /// The shape of each finger when its flag last agreed with the believed one.
    shapes: [(f32, f32); 5],
}

/// A hand at a place that no known hand can have reached.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Doubted {
    palm: Vec3,
    since_us: u64,
    t_us: u64,
}

impl Doubted {
    /// Returns true if a hand at `palm` is the doubted one.
    fn continues(&self, t_us: u64, palm: Vec3) -> bool {
        let by = palm.distance(self.palm);
        self.t_us < t_us && by <= reachable(NOISE_MM, SPEED, seconds(self.t_us, t_us))
    }
}

/// The hands of one tracker, as believed so far.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct HandGate {
    known: Vec<Known>,
    doubted: Vec<Doubted>,
}

impl HandGate {
    /// Adds a hand that is being followed, after its state was restored.
    pub fn follow(&mut self, id: i32, left: Option<bool>, palm: Vec3, seen_us: u64) {
        let hand = Hand { id, left, palm, ..Hand::default() };
        self.known.push(Known::new(id, &hand, seen_us));
    }

    /// Returns true if there is nothing to compare a later frame with.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty() && self.doubted.is_empty()
    }

    /// Returns the hands of a frame that can be true, each under the id that it keeps. Allocates
    /// only when more hands are known than ever before.
    pub fn filter(&mut self, t_us: u64, hands: &Hands) -> Hands {
        self.known.retain(|k| t_us.saturating_sub(k.t_us) <= FORGOTTEN_US);
        let seen = hands.as_slice();
        let of_known = self.associate(t_us, seen);
        let mut out = Hands { frame: hands.frame, ..Hands::default() };
        let mut pass = |hand: Hand| {
            out.hands[usize::from(out.count)] = hand;
            out.count += 1;
        };
        let is_twin = |palm: Vec3| {
            let mut known = seen.iter().zip(&of_known).filter(|(_, k)| k.is_some());
            known.any(|(h, _)| h.palm.distance(palm) < TWIN_MM)
        };
        for (hand, known) in seen.iter().zip(&of_known) {
            match known {
                Some(i) => pass(self.known[*i].take(t_us, hand)),
                None if is_twin(hand.palm) => {}
                None if self.may_be_new(t_us, hand, &of_known) => {
                    let known = Known::new(self.free_id(hand.id), hand, t_us);
                    pass(known.named(*hand));
                    self.known.push(known);
                }
                None => {}
            }
        }
        let lapses = |d: &Doubted| t_us.saturating_sub(d.t_us) > DOUBT_LAPSES_US;
        self.doubted.retain(|d| d.t_us == t_us || seen.is_empty() && !lapses(d));
        out
    }

    /// Returns the known hand that each hand of a frame is; the nearest pairs match first.
    fn associate(&self, t_us: u64, seen: &[Hand]) -> [Option<usize>; MAX_HANDS] {
        let mut of_known = [None; MAX_HANDS];
        for _ in 0..seen.len() {
            let mut best: Option<(f32, usize, usize)> = None;
            for (s, hand) in seen.iter().enumerate().filter(|(s, _)| of_known[*s].is_none()) {
                // A place that no known hand can have reached does not become likelier with time.
                let doubted = self.doubted.iter().filter(|d| d.continues(t_us, hand.palm));
                let doubted = doubted.map(|d| d.palm.distance(hand.palm)).min_by(f32::total_cmp);
                for (k, known) in self.known.iter().enumerate() {
                    let near = doubted.is_none_or(|d| known.off(t_us, hand) <= d);
                    let cost = known.cost(t_us, hand).filter(|_| near).or_else(|| {
                        let strikes = self.doubted.iter().any(|d| known.strikes(d, t_us, hand));
                        strikes.then_some(NOISE_MM)
                    });
                    let cost = cost.filter(|_| !of_known.contains(&Some(k)));
                    if let Some(cost) = cost.filter(|c| best.is_none_or(|b| *c < b.0)) {
                        best = Some((cost, s, k));
                    }
                }
            }
            let Some((_, s, k)) = best else { break };
            of_known[s] = Some(k);
        }
        of_known
    }

    /// Returns true if a hand that is not a known one may act: at once if no known hand is missing,
    /// otherwise after it has stayed for [`PERSISTS_US`].
    fn may_be_new(&mut self, t_us: u64, hand: &Hand, of_known: &[Option<usize>]) -> bool {
        let missed = |(k, known): (usize, &Known)| {
            let same = known.tracker_id == hand.id
                || known.hand.left.zip(hand.left).is_none_or(|(a, b)| a == b);
            same && !of_known.contains(&Some(k))
        };
        if !self.known.iter().enumerate().any(missed) {
            return true;
        }
        match self.doubted.iter_mut().find(|d| d.continues(t_us, hand.palm)) {
            Some(d) => {
                (d.palm, d.t_us) = (hand.palm, t_us);
                t_us - d.since_us >= PERSISTS_US
            }
            None => {
                self.doubted.push(Doubted { palm: hand.palm, since_us: t_us, t_us });
                false
            }
        }
    }

    /// Returns the tracker's id, or one that no other hand has.
    fn free_id(&self, wanted: i32) -> i32 {
        let taken = |id: i32| self.known.iter().any(|k| k.id == id);
        if !taken(wanted) {
            return wanted;
        }
        let most = self.known.iter().map(|k| k.id).max().unwrap_or(wanted);
        most.checked_add(1).filter(|id| !taken(*id)).unwrap_or(i32::MIN)
    }
}

fn seconds(from_us: u64, to_us: u64) -> f32 {
    to_us.saturating_sub(from_us) as f32 * 1e-6
}

/// Returns a finger's straightness and its tip's distance from the palm, mm.
fn shape(hand: &Hand, finger: usize) -> (f32, f32) {
    let of = |f: &Finger| (straightness(f).unwrap_or(0.0), f.tip.distance(hand.palm));
    hand.fingers[finger].as_ref().map_or((0.0, 0.0), of)
}

/// Returns the greatest believed distance from the extrapolated place, mm.
fn reachable(noise_mm: f32, speed: f32, dt: f32) -> f32 {
    noise_mm + (HALF_ACCELERATION * dt * dt).min(speed * dt)
}

impl Known {
    fn new(id: i32, hand: &Hand, t_us: u64) -> Known {
        Known {
            id,
            tracker_id: hand.id,
            hand: *hand,
            speed: Vec3::ZERO,
            t_us,
            finger_us: [t_us; 5],
            turn_us: t_us,
            shapes: [0, 1, 2, 3, 4].map(|i| shape(hand, i)),
        }
    }

    fn named(&self, hand: Hand) -> Hand {
        Hand { id: self.id, ..hand }
    }

    /// Returns the distance of a hand from this one's expected or last place, mm.
    fn off(&self, t_us: u64, hand: &Hand) -> f32 {
        let dt = seconds(self.t_us, t_us);
        let expected = self.hand.palm + self.speed * dt.min(CARRIED_ON_S);
        expected.distance(hand.palm).min(self.hand.palm.distance(hand.palm))
    }

    /// Returns how badly a hand fits, mm, or `None` if this hand cannot have moved there.
    fn cost(&self, t_us: u64, hand: &Hand) -> Option<f32> {
        let off = self.off(t_us, hand);
        if off > reachable(NOISE_MM, SPEED, seconds(self.t_us, t_us)) {
            return None;
        }
        let number = if self.tracker_id == hand.id { 0.0 } else { OTHER_NUMBER_MM };
        let other = self.hand.left.zip(hand.left).is_some_and(|(a, b)| a != b);
        Some(off + number + if other { OTHER_SIDE_MM } else { 0.0 })
    }

    /// Returns true if a hand continues the motion that led from this one to a doubted place.
    fn strikes(&self, doubted: &Doubted, t_us: u64, hand: &Hand) -> bool {
        let (first, second) = (seconds(self.t_us, doubted.t_us), seconds(doubted.t_us, t_us));
        let before = (doubted.palm - self.hand.palm) / first;
        let after = (hand.palm - doubted.palm) / second;
        let sides = self.hand.left.zip(hand.left).is_none_or(|(a, b)| a == b);
        first > 0.0
            && second > 0.0
            && sides
            && before.length().max(after.length()) <= STRIKE_SPEED
            && (after - before).length() <= STRIKE_CHANGE * before.length()
    }

    /// Takes the next frame and returns the parts of it that can be true.
    fn take(&mut self, t_us: u64, hand: &Hand) -> Hand {
        let mut believed = *hand;
        // A side that changes in place is an error of the tracker.
        believed.left = self.hand.left.or(hand.left);
        let by = hand.palm - self.hand.palm;
        for i in 0..5 {
            let (Some(was), Some(now)) = (self.hand.fingers[i], hand.fingers[i]) else {
                self.finger_us[i] = t_us;
                continue;
            };
            let dt = seconds(self.t_us, t_us);
            let far = (now.tip - was.tip - by).length() > FINGER_NOISE_MM + FINGER_SPEED * dt;
            if far && t_us.saturating_sub(self.finger_us[i]) < HELD_US {
                let mut kept = was;
                kept.tip += by;
                for joint in kept.joints.iter_mut().flatten() {
                    *joint += by;
                }
                believed.fingers[i] = Some(kept);
            } else {
                self.finger_us[i] = t_us;
            }
        }
        self.believe_flags(&mut believed);
        match self.hand.orientation.zip(hand.orientation) {
            Some((was, now)) if self.turns_too_fast(was, now, t_us) => {
                believed.orientation = Some(was);
                believed.palm_normal = self.hand.palm_normal;
                believed.direction = self.hand.direction;
            }
            _ => self.turn_us = t_us,
        }
        let dt = seconds(self.t_us, t_us);
        self.speed = if dt > 0.0 { by / dt } else { self.speed };
        (self.hand, self.tracker_id, self.t_us) = (believed, hand.id, t_us);
        self.named(believed)
    }

    /// Keeps the last flag of a finger whose shape did not change.
    fn believe_flags(&mut self, hand: &mut Hand) {
        for i in 0..5 {
            let now = shape(hand, i);
            let was = self.hand.fingers[i].and_then(|f| f.extended);
            let Some(finger) = &mut hand.fingers[i] else { continue };
            let same = (now.0 - self.shapes[i].0).abs() < SAME_SHAPE.0
                && (now.1 - self.shapes[i].1).abs() < SAME_SHAPE.1;
            if finger.extended != was && was.is_some() && same {
                finger.extended = was;
            } else {
                self.shapes[i] = now;
            }
        }
    }

    fn turns_too_fast(&self, was: Quat, now: Quat, t_us: u64) -> bool {
        let dt = seconds(self.t_us, t_us);
        was.angle_between(now) > TURN_NOISE + TURN_SPEED * dt
            && t_us.saturating_sub(self.turn_us) < HELD_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_devices::sim::hand::{HandKey, skeleton};

    /// Frames of a 110 Hz tracker.
    const FRAME_US: u64 = 9_090;

    fn hand(id: i32, left: bool, palm: Vec3) -> Hand {
        Hand { id, ..skeleton(&HandKey::flat(0, palm), left) }
    }

    fn frame(all: &[Hand]) -> Hands {
        let mut out = Hands { count: all.len() as u8, ..Hands::default() };
        out.hands[..all.len()].copy_from_slice(all);
        out
    }

    fn passed(gate: &mut HandGate, i: u64, all: &[Hand]) -> Vec<(i32, Vec3)> {
        let out = gate.filter(i * FRAME_US, &frame(all));
        out.as_slice().iter().map(|h| (h.id, h.palm)).collect()
    }

    /// A hand that moves at 150 mm/s.
    fn at(i: u64) -> Vec3 {
        Vec3::new(i as f32 * 1.36, 200.0, 0.0)
    }

    #[test]
    fn one_bad_frame_is_left_out_and_the_hand_goes_on() {
        for off in [20.0, 40.0, 85.0, 300.0] {
            let mut gate = HandGate::default();
            for i in 0..60 {
                let bad = if i == 30 { Vec3::new(off, 0.0, 0.0) } else { Vec3::ZERO };
                let got = passed(&mut gate, i, &[hand(5, false, at(i) + bad)]);
                let expected = if i == 30 { vec![] } else { vec![(5, at(i))] };
                assert_eq!(got, expected, "{off} mm at {i}");
            }
        }
    }

    #[test]
    fn swapped_and_new_numbers_change_nothing() {
        let mut gate = HandGate::default();
        for i in 0..60 {
            let (a, b) = (at(i), at(i) + Vec3::new(0.0, 0.0, 180.0));
            let (x, y) = match i {
                20..25 => (9, 5),
                40.. => (31, 32),
                _ => (5, 9),
            };
            let got = passed(&mut gate, i, &[hand(x, false, a), hand(y, true, b)]);
            assert_eq!(got, [(5, a), (9, b)], "frame {i}");
        }
    }

    #[test]
    fn a_hand_found_twice_is_one_hand() {
        let mut gate = HandGate::default();
        for i in 0..60 {
            let twin = hand(9, true, at(i) + Vec3::new(22.0, 0.0, 0.0));
            let all = [hand(5, false, at(i)), twin];
            let seen = if (20..40).contains(&i) { &all[..] } else { &all[..1] };
            assert_eq!(passed(&mut gate, i, seen), [(5, at(i))], "frame {i}");
        }
    }

    #[test]
    fn a_hand_that_stays_where_it_cannot_have_got_to_is_another_hand() {
        let mut gate = HandGate::default();
        let mut first = None;
        for i in 0..60 {
            let palm = if i < 20 { at(0) } else { at(0) + Vec3::new(150.0, 0.0, 0.0) };
            let got = passed(&mut gate, i, &[hand(5, false, palm)]);
            if i >= 20 && !got.is_empty() && first.is_none() {
                first = Some((i, got[0].0));
            }
        }
        let (i, id) = first.unwrap();
        assert!(id != 5 && (33..36).contains(&i), "hand {id} from frame {i}");
    }

    #[test]
    fn a_fast_strike_is_believed() {
        // 1.3 m/s within 60 ms, at 30 and at 110 frames a second.
        for rate in [30.0f32, 57.0, 110.0] {
            let (mut gate, mut n) = (HandGate::default(), 0);
            for i in 0..100 {
                let t = i as f32 / rate;
                let x = if t < 0.06 { 10_833.0 * t * t } else { 1300.0 * t - 39.0 };
                let all = frame(&[hand(5, false, Vec3::new(x.min(700.0), 200.0, 0.0))]);
                n += gate.filter((t * 1e6) as u64, &all).count;
            }
            assert!(n >= 98, "{n} of 100 frames at {rate} Hz");
        }
    }

    #[test]
    fn a_strike_that_starts_within_one_frame_is_believed_with_its_second() {
        let mut gate = HandGate::default();
        for i in 0..40u64 {
            // Still, then 3 m/s, which no arm reaches within a frame, then still again.
            let palm = Vec3::new(33.0 * i.clamp(20, 24) as f32, 200.0, 0.0);
            let got = passed(&mut gate, i, &[hand(5, false, palm)]);
            let expected = if i == 21 { vec![] } else { vec![(5, palm)] };
            assert_eq!(got, expected, "frame {i}");
        }
    }

    #[test]
    fn a_finger_and_a_turn_that_jump_are_kept() {
        let mut gate = HandGate::default();
        for i in 0..40 {
            let good = hand(5, false, at(i));
            let mut bad = good;
            if (20..24).contains(&i) {
                if let Some(finger) = &mut bad.fingers[1] {
                    finger.tip += Vec3::new(0.0, 80.0, 0.0);
                }
                bad.orientation = Some(Quat::from_rotation_z(2.0));
            }
            let out = gate.filter(i * FRAME_US, &frame(&[bad]));
            let got = out.as_slice()[0];
            let off = got.fingers[1].unwrap().tip.distance(good.fingers[1].unwrap().tip);
            assert!(off < 0.01, "the tip is {off} mm off at {i}");
            assert!(got.orientation.unwrap().angle_between(good.orientation.unwrap()) < 1e-3);
        }
    }
}
