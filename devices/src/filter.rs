//! The One-Euro filter for tracked hands (Casiez, Roussel and Vogel, CHI 2012) on every joint. Pens
//! are not filtered here: their strokes are smoothed later.
//!
//! A low pass whose cutoff rises with speed: at rest it takes the jitter away, in motion it hardly
//! lags. Units matter: speed is in mm a second, so `beta` is in Hz for each of them.

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::sample::{Finger, Hand, Hands, MAX_HANDS};

/// A direction is filtered like a position at the end of a lever of this length, in mm.
const LEVER: f32 = 100.0;
/// Gap, in microseconds, after which the filter restarts.
const STALE_US: u64 = 250_000;
/// Joints, tips and bones of one hand: three of the arm, six a finger.
const PLACES: usize = 3 + 5 * 6;
/// Palm normal, palm direction, and one a finger.
const DIRECTIONS: usize = 2 + 5;

/// The filter's three figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OneEuro {
    /// Hz at rest. Lower: steadier, and slower to set off.
    pub min_cutoff: f32,
    /// Hz more for each mm a second. Higher: less lag in motion, more jitter in slow motion.
    pub beta: f32,
    /// Hz of the speed's own low pass.
    pub speed_cutoff: f32,
}

impl Default for OneEuro {
    /// At 90 frames a second and 0.2 mm of noise these leave 0.04 mm at rest and lag 23 ms at 50
    /// mm/s, 12 ms at 150 and 5 ms at 500; the test prints the table.
    fn default() -> Self {
        OneEuro { min_cutoff: 1.0, beta: 0.04, speed_cutoff: 1.0 }
    }
}

/// Share of the new value in a first-order low pass.
fn alpha(cutoff: f32, dt: f32) -> f32 {
    let tau = 1.0 / (std::f32::consts::TAU * cutoff);
    1.0 / (1.0 + tau / dt)
}

/// One place's memory.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PlaceFilter {
    last: Option<(Vec3, Vec3)>,
}

impl PlaceFilter {
    /// The filtered position, `dt` seconds after the last one.
    pub fn apply(&mut self, f: &OneEuro, new: Vec3, dt: f32) -> Vec3 {
        let Some((place, speed)) = self.last else {
            self.last = Some((new, Vec3::ZERO));
            return new;
        };
        if dt <= 0.0 {
            return place;
        }
        let speed = speed.lerp((new - place) / dt, alpha(f.speed_cutoff, dt));
        let place = place.lerp(new, alpha(f.min_cutoff + f.beta * speed.length(), dt));
        self.last = Some((place, speed));
        place
    }

    /// The speed as the filter sees it, mm a second.
    pub fn speed(&self) -> f32 {
        self.last.map_or(0.0, |l| l.1.length())
    }
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct HandFilter {
    id: i32,
    t_us: u64,
    #[serde(with = "crate::long_array")]
    places: [PlaceFilter; PLACES],
    directions: [PlaceFilter; DIRECTIONS],
    turn: Option<(Quat, f32)>,
}

/// Filters every hand of a tracker. A hand that appears, or comes back with another id, starts
/// afresh.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HandsFilter {
    /// May be changed at any time.
    pub figures: OneEuro,
    hands: [Option<HandFilter>; MAX_HANDS],
}

impl HandsFilter {
    /// A filter that has seen no hand yet.
    pub fn new(figures: OneEuro) -> Self {
        HandsFilter { figures, hands: [None; MAX_HANDS] }
    }

    /// Filters every joint in place; `t_us` is the sample's. Allocates nothing.
    pub fn apply(&mut self, hands: &mut Hands, t_us: u64) {
        let count = (hands.count as usize).min(MAX_HANDS);
        let before = self.hands;
        for (slot, hand) in self.hands.iter_mut().zip(&mut hands.hands[..count]) {
            let known = before.iter().flatten().find(|f| f.id == hand.id);
            let mut filter = match known.filter(|f| t_us.saturating_sub(f.t_us) <= STALE_US) {
                Some(known) => *known,
                None => HandFilter {
                    id: hand.id,
                    t_us,
                    places: [PlaceFilter::default(); PLACES],
                    directions: [PlaceFilter::default(); DIRECTIONS],
                    turn: None,
                },
            };
            filter.apply(&self.figures, hand, t_us);
            *slot = Some(filter);
        }
        // A hand that one frame has lost goes on where it was.
        let missed = before.into_iter().flatten().filter(|f| {
            t_us.saturating_sub(f.t_us) <= STALE_US
                && !hands.hands[..count].iter().any(|h| h.id == f.id)
        });
        self.hands[count..].fill(None);
        for (slot, filter) in self.hands[count..].iter_mut().zip(missed) {
            *slot = Some(filter);
        }
    }
}

impl HandFilter {
    fn apply(&mut self, f: &OneEuro, hand: &mut Hand, t_us: u64) {
        let dt = t_us.saturating_sub(self.t_us) as f32 / 1e6;
        self.t_us = t_us;
        let (places, directions) = (&mut self.places, &mut self.directions);
        hand.palm = places[0].apply(f, hand.palm, dt);
        place(&mut places[1], f, &mut hand.wrist, dt);
        place(&mut places[2], f, &mut hand.elbow, dt);
        direction(&mut directions[0], f, &mut hand.palm_normal, dt);
        direction(&mut directions[1], f, &mut hand.direction, dt);
        for (i, finger) in hand.fingers.iter_mut().enumerate() {
            let own = &mut places[3 + 6 * i..9 + 6 * i];
            match finger {
                Some(Finger { joints, tip, direction: aim, .. }) => {
                    for (state, joint) in own.iter_mut().zip(joints) {
                        place(state, f, joint, dt);
                    }
                    *tip = own[5].apply(f, *tip, dt);
                    direction(&mut directions[2 + i], f, aim, dt);
                }
                None => {
                    own.fill(PlaceFilter::default());
                    directions[2 + i] = PlaceFilter::default();
                }
            }
        }
        self.turn(f, &mut hand.orientation, dt);
    }

    fn turn(&mut self, f: &OneEuro, orientation: &mut Option<Quat>, dt: f32) {
        let Some(new) = *orientation else {
            self.turn = None;
            return;
        };
        let Some((old, speed)) = self.turn else {
            self.turn = Some((new, 0.0));
            return;
        };
        if dt <= 0.0 {
            *orientation = Some(old);
            return;
        }
        let speed =
            speed + (old.angle_between(new) * LEVER / dt - speed) * alpha(f.speed_cutoff, dt);
        let turned = old.slerp(new, alpha(f.min_cutoff + f.beta * speed, dt)).normalize();
        self.turn = Some((turned, speed));
        *orientation = Some(turned);
    }
}

fn place(state: &mut PlaceFilter, f: &OneEuro, value: &mut Option<Vec3>, dt: f32) {
    match value {
        Some(v) => *v = state.apply(f, *v, dt),
        None => *state = PlaceFilter::default(),
    }
}

fn direction(state: &mut PlaceFilter, f: &OneEuro, value: &mut Option<Vec3>, dt: f32) {
    match value {
        Some(v) => *v = (state.apply(f, *v * LEVER, dt) / LEVER).normalize_or(*v),
        None => *state = PlaceFilter::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::faults::Rng;
    use crate::sim::hand::{HandKey, skeleton};

    /// Gaussian, by the sum of twelve.
    fn noise(rng: &mut Rng, sigma: f32) -> Vec3 {
        Vec3::from_array([0; 3].map(|_| ((0..12).map(|_| rng.unit()).sum::<f32>() - 6.0) * sigma))
    }

    /// Jitter left at rest (mm rms an axis) and lag in steady motion (ms).
    fn measure(f: &OneEuro, hz: f32, speed: f32) -> (f32, f32) {
        let (mut filter, mut rng, dt) = (PlaceFilter::default(), Rng::new(1), 1.0 / hz);
        let mut sum = 0.0;
        for i in 0..2000 {
            let p = filter.apply(f, noise(&mut rng, 0.2), dt);
            sum += if i >= 1000 { p.length_squared() / 3.0 } else { 0.0 };
        }
        let mut filter = PlaceFilter::default();
        let mut behind = 0.0;
        for i in 0..(3.0 * hz) as u32 {
            let at = Vec3::X * speed * i as f32 * dt;
            behind = (at - filter.apply(f, at, dt)).length();
        }
        ((sum / 1000.0).sqrt(), behind / speed * 1000.0)
    }

    #[test]
    fn the_trade_of_lag_against_jitter() {
        println!(
            "{:>6} {:>6} {:>5} {:>12} {:>9} {:>9} {:>9}",
            "min", "beta", "Hz", "rest mm rms", "50 mm/s", "150", "500"
        );
        for (min_cutoff, beta) in [(0.5, 0.04), (1.0, 0.01), (1.0, 0.04), (1.0, 0.1), (2.0, 0.04)] {
            for hz in [30.0, 90.0, 120.0] {
                let f = OneEuro { min_cutoff, beta, ..OneEuro::default() };
                let (jitter, lag) =
                    (measure(&f, hz, 50.0).0, [50.0, 150.0, 500.0].map(|v| measure(&f, hz, v).1));
                println!(
                    "{min_cutoff:6} {beta:6} {hz:5} {jitter:12.3} {:6.1} ms {:6.1} ms {:6.1} ms",
                    lag[0], lag[1], lag[2]
                );
            }
        }
        let f = OneEuro::default();
        let (jitter, lag) = measure(&f, 90.0, 150.0);
        assert!(jitter < 0.1 && lag < 30.0, "{jitter} mm, {lag} ms");
        assert!(measure(&f, 90.0, 500.0).1 < 10.0);
    }

    #[test]
    fn a_hand_is_steadied_whole_and_a_new_one_starts_afresh() {
        let (mut filter, mut rng) = (HandsFilter::new(OneEuro::default()), Rng::new(3));
        let pose = HandKey::flat(0, Vec3::new(0.0, 200.0, 0.0)).turned(0.3, 0.1, 0.2);
        let (mut spread, mut n) = ([0.0f32; 2], 0);
        for i in 0..400u64 {
            let mut hand =
                skeleton(&HandKey { palm: pose.palm + noise(&mut rng, 0.2), ..pose }, false);
            hand.id = 1;
            let mut hands = Hands { count: 1, ..Hands::default() };
            hands.hands[0] = hand;
            filter.apply(&mut hands, i * 11_111);
            if i > 200 {
                let at = |h: &Hand| {
                    h.fingers[1].unwrap().tip - skeleton(&pose, false).fingers[1].unwrap().tip
                };
                spread[0] += at(&hand).length_squared();
                spread[1] += at(&hands.hands[0]).length_squared();
                n += 1;
            }
            let turn = hands.hands[0].orientation.unwrap();
            assert!(turn.is_normalized() && hands.hands[0].palm_normal.unwrap().is_normalized());
        }
        let [raw, left] = spread.map(|s| (s / n as f32).sqrt());
        assert!(left < 0.35 * raw, "{left} of {raw}");
        let mut jump = Hands { count: 1, ..Hands::default() };
        jump.hands[0] = Hand { id: 2, palm: Vec3::splat(500.0), ..skeleton(&pose, false) };
        let want = jump;
        filter.apply(&mut jump, 400 * 11_111);
        assert_eq!(jump.hands[0].palm, want.hands[0].palm, "another id is another hand");
        assert_eq!(
            jump.hands[0].fingers[4].unwrap().joints,
            want.hands[0].fingers[4].unwrap().joints
        );
        jump.hands[0].fingers[1] = None;
        filter.apply(&mut jump, 401 * 11_111);
        assert_eq!(jump.hands[0].fingers[1], None);
    }

    #[test]
    fn the_same_instant_twice_changes_nothing() {
        let mut f = PlaceFilter::default();
        let a = f.apply(&OneEuro::default(), Vec3::ONE, 0.01);
        assert_eq!(f.apply(&OneEuro::default(), Vec3::splat(50.0), 0.0), a);
        assert_eq!(f.speed(), 0.0);
    }
}
