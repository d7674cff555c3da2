//! Errors of a tracker: noise, hands lost and found under another number, hidden fingers, a
//! drifting clock. Seeded: the same frames for the same seed.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::faults::Rng;
use crate::sample::{Finger, Hand, Hands, MAX_HANDS};

/// Strength of the errors. All zero by default: a tracker that sees everything.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Jitter {
    /// The same seed gives the same noise.
    pub seed: u64,
    /// Standard deviation of every joint of a hand at rest, mm along each axis. Trackers of the
    /// Leap kind: 0.2 (Weichert et al., Sensors 2013).
    pub rest_mm: f32,
    /// The same of a hand in motion (from [`FAST_MM_S`] on); 1.2 in the same measurements.
    pub moving_mm: f32,
    /// Share of frames in which a hand begins to be lost; it is back after 1 to 7 frames.
    pub dropout: f32,
    /// Share of frames at which a hand's number changes though it never left.
    pub new_id: f32,
    /// Share of frames in which a finger other than thumb and index begins to be hidden, for 1 to 7
    /// frames.
    pub occlude: f32,
    /// By which the tracker's clock runs fast, parts in a million.
    pub skew_ppm: f32,
}

/// From this speed of the palm on the noise is that of motion, mm a second.
pub const FAST_MM_S: f32 = 200.0;

/// The jitter over time.
#[derive(Debug, Clone)]
pub struct JitterState {
    figures: Jitter,
    rng: Rng,
    /// For each performer: frames for which the hand is still lost, the hidden finger and for how
    /// long, the last number given by the script, and the number in its place.
    hands: [Fate; MAX_HANDS],
    ids: i32,
}

#[derive(Debug, Clone, Copy, Default)]
struct Fate {
    lost: u32,
    hidden: Option<(usize, u32)>,
    id: Option<(i32, i32)>,
}

impl JitterState {
    /// A tracker with these figures that has seen nothing yet.
    pub fn new(figures: Jitter) -> Self {
        JitterState { figures, rng: Rng::new(figures.seed), hands: Default::default(), ids: 1000 }
    }

    /// A stamp on the tracker's own clock.
    pub fn stamp(&self, us: u64) -> u64 {
        us.saturating_add_signed((us as f64 * f64::from(self.figures.skew_ppm) * 1e-6) as i64)
    }

    /// Roughly normal, standard deviation 1: the sum of twelve uniform numbers.
    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.rng.unit()).sum::<f32>() - 6.0
    }

    fn off(&mut self, sigma: f32) -> Vec3 {
        Vec3::new(self.normal(), self.normal(), self.normal()) * sigma
    }

    /// Returns the hands as the tracker sees them.
    pub fn apply(&mut self, hands: &Hands) -> Hands {
        let mut seen = Hands { frame: hands.frame, ..Hands::default() };
        for hand in hands.as_slice() {
            let slot = (hand.id - 1).rem_euclid(MAX_HANDS as i32) as usize;
            if let Some(hand) = self.one(slot, hand) {
                seen.hands[seen.count as usize] = hand;
                seen.count += 1;
            }
        }
        seen.hands[..seen.count as usize].sort_by_key(|h| h.id);
        seen
    }

    fn one(&mut self, slot: usize, hand: &Hand) -> Option<Hand> {
        let f = self.figures;
        // Every random number is drawn whether or not it is needed, so that one ratio does not
        // change the outcome of another.
        let [drop, renamed, occluded] =
            [f.dropout, f.new_id, f.occlude].map(|r| self.rng.unit() < r);
        let (span, which) = (1 + self.rng.below(7) as u32, 2 + self.rng.below(3) as usize);
        let fate = &mut self.hands[slot];
        if fate.lost > 0 || drop {
            fate.lost = if fate.lost > 0 { fate.lost - 1 } else { span };
            // A hand that is found again has a new number.
            fate.id = None;
            return None;
        }
        let mut out = *hand;
        if f.dropout > 0.0 || f.new_id > 0.0 {
            let known =
                fate.id.filter(|(script, _)| *script == hand.id && !renamed).map(|(_, id)| id);
            out.id = known.unwrap_or_else(|| {
                self.ids += 1;
                self.ids
            });
            fate.id = Some((hand.id, out.id));
        }
        fate.hidden = match fate.hidden {
            Some((finger, left)) if left > 1 => Some((finger, left - 1)),
            _ => occluded.then_some((which, span)),
        };
        let hidden = fate.hidden.map(|(finger, _)| finger);
        let speed = hand.palm_velocity.map_or(0.0, Vec3::length);
        let sigma = f.rest_mm + (f.moving_mm - f.rest_mm).max(0.0) * (speed / FAST_MM_S).min(1.0);
        if sigma > 0.0 {
            out.palm += self.off(sigma);
            for place in [&mut out.wrist, &mut out.elbow] {
                let off = self.off(sigma);
                *place = place.map(|p| p + off);
            }
        }
        for (i, finger) in out.fingers.iter_mut().enumerate() {
            if hidden == Some(i) {
                *finger = None;
            } else if let Some(Finger { joints, tip, .. }) = finger
                && sigma > 0.0
            {
                for joint in joints.iter_mut() {
                    let off = self.off(sigma);
                    *joint = joint.map(|p| p + off);
                }
                *tip += self.off(sigma);
            }
        }
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::hand::{HandKey, skeleton};

    #[test]
    fn the_noise_is_as_large_as_stated_and_repeats_by_its_seed() {
        let hand = skeleton(&HandKey::flat(0, Vec3::new(0.0, 200.0, 0.0)), false);
        let mut hands = Hands { count: 1, ..Hands::default() };
        hands.hands[0] = hand;
        let figures = Jitter { seed: 3, rest_mm: 0.2, moving_mm: 1.2, ..Jitter::default() };
        let run = |f: Jitter| {
            let mut t = JitterState::new(f);
            (0..4000).map(|_| t.apply(&hands).hands[0].palm - hand.palm).collect::<Vec<_>>()
        };
        let all = run(figures);
        let sigma =
            (all.iter().map(|o| o.length_squared()).sum::<f32>() / (3.0 * all.len() as f32)).sqrt();
        assert!((sigma - 0.2).abs() < 0.01, "{sigma} mm");
        assert_eq!(all, run(figures));
        assert_ne!(all, run(Jitter { seed: 4, ..figures }));
    }

    #[test]
    fn hands_are_lost_for_a_while_and_found_under_another_number() {
        let mut hands = Hands { count: 1, ..Hands::default() };
        hands.hands[0] = skeleton(&HandKey::flat(0, Vec3::ZERO), false);
        let mut t =
            JitterState::new(Jitter { seed: 1, dropout: 0.02, occlude: 0.05, ..Jitter::default() });
        let (mut gaps, mut longest, mut gap, mut hidden) = (0, 0, 0, 0);
        let mut ids = std::collections::BTreeSet::new();
        for _ in 0..5000 {
            let seen = t.apply(&hands);
            match seen.as_slice() {
                [] => gap += 1,
                [hand, ..] => {
                    gaps += usize::from(gap > 0);
                    longest = longest.max(gap);
                    gap = 0;
                    ids.insert(hand.id);
                    hidden += usize::from(hand.fingers.iter().any(Option::is_none));
                    assert!(hand.fingers[0].is_some() && hand.fingers[1].is_some());
                }
            }
        }
        assert!(
            gaps > 50 && longest <= 8 && ids.len() == gaps + 1 && hidden > 300,
            "{gaps} {longest} {hidden}"
        );
    }
}
