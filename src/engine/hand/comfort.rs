//! Arms get tired: a person's own reach is mapped to the space around the object, and how far the
//! arms are spent is followed.
//!
//! * [`ReachCalibration`]: five seconds of moving the hands about, standing or seated, say where a
//!   person can work without stretching.
//! * [`Fatigue`]: consumed endurance (Hincapié-Ramos, Guo, Moghadasian and Irani, CHI 2014): the
//!   torque at the shoulder as a share of the strongest, and how long it can be held (Rohmert
//!   1960). A hand with its elbow resting costs nothing.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::reach_box::ReachBox;
use sculptd_devices::Hand;
use sculptd_geometry::portable::PortableMath;

/// Duration of a calibration, in microseconds.
pub const CALIBRATION_US: u64 = 5_000_000;
/// Fewer places than a second of a slow tracker gives say nothing.
const ENOUGH: usize = 30;
/// Palms kept: 5 s of two hands at 120 Hz.
const MAX_PALMS: usize = 1200;

/// A calibration under way.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct ReachCalibration {
    since_us: Option<u64>,
    palms: Vec<Vec3>,
}

/// State of a calibration after a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Calibrated {
    /// Share of the calibration that is done, 0 to 1.
    Listening(f32),
    /// Box that the person can reach.
    Done(ReachBox),
    /// Too few palms were seen.
    TooLittle,
}

impl ReachCalibration {
    /// Takes one frame's palms; time begins with the first one.
    pub fn take(&mut self, t_us: u64, hands: &[Hand]) -> Calibrated {
        let since = *self.since_us.get_or_insert(t_us);
        for hand in hands {
            if self.palms.len() < MAX_PALMS {
                self.palms.push(hand.palm);
            }
        }
        let gone = t_us.saturating_sub(since);
        if gone < CALIBRATION_US {
            return Calibrated::Listening(gone as f32 / CALIBRATION_US as f32);
        }
        self.result().map_or(Calibrated::TooLittle, Calibrated::Done)
    }

    /// From the 5th to the 95th hundredth along each axis, so that one wild frame does not count.
    fn result(&self) -> Option<ReachBox> {
        if self.palms.len() < ENOUGH {
            return None;
        }
        let ends = |axis: usize| {
            let mut all: Vec<f32> = self.palms.iter().map(|p| p[axis]).collect();
            all.sort_unstable_by(f32::total_cmp);
            [all[all.len() / 20], all[all.len() - 1 - all.len() / 20]]
        };
        let [x, y, z] = [ends(0), ends(1), ends(2)];
        let middle_mm = Vec3::new(x[0] + x[1], y[0] + y[1], z[0] + z[1]) * 0.5;
        let widths = Vec3::new(x[1] - x[0], y[1] - y[0], z[1] - z[0]) * 0.5;
        // A person who hardly moved gets a small space, but not one in which a tremble crosses the
        // work.
        let half_mm = ((widths.x + widths.y + widths.z) / 3.0).clamp(60.0, 400.0);
        Some(ReachBox { middle_mm, half_mm })
    }
}

/// Mass of an arm, kg, and where its centre is, as shares of the way from shoulder to hand: an
/// average adult (Winter 2009).
const ARM_KG: f32 = 3.5;
/// The strongest torque of a shoulder, N m: the mean of women and men in the paper's model (male
/// 115.6, female 57.9).
const MAX_TORQUE: f32 = 86.7;
/// From the elbow up to the shoulder, m: an average upper arm.
const UPPER_ARM_M: f32 = 0.33;
/// Below this share of the strongest, rest is as fast as effort (the paper's asymptote).
const FREE_SHARE: f32 = 0.15;

/// Consumed endurance of one person, 0 fresh to 1 spent.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Fatigue {
    spent: f32,
    last_us: Option<u64>,
}

impl Fatigue {
    /// The share of the shoulder's strength that holding an arm so takes. The elbow, where the
    /// tracker does not say, is taken 260 mm behind the palm.
    pub fn effort(hand: &Hand) -> f32 {
        let elbow = hand.elbow.unwrap_or(hand.palm + Vec3::Z * 260.0);
        let forearm = (hand.palm - elbow) * 1e-3;
        // An elbow that is low rests on the table or hangs at the side; one that is lifted swings
        // the upper arm out.
        let lift = ((elbow.y - 60.0) / 240.0).clamp(0.0, 1.0);
        let out = UPPER_ARM_M * lift;
        let lever = (Vec3::new(forearm.x, 0.0, forearm.z).length() * 0.43 + out).max(0.0);
        let torque = ARM_KG * 9.81 * lever * if elbow.y < 60.0 { 0.3 } else { 1.0 };
        torque / MAX_TORQUE
    }

    /// Takes one frame of every hand seen; the harder arm counts.
    pub fn take(&mut self, t_us: u64, hands: &[Hand]) {
        // A gap in the feed is rest, a frame that came late is not more than a second of work.
        let dt = self.last_us.map_or(0.0, |last| t_us.saturating_sub(last) as f32 * 1e-6).min(1.0);
        self.last_us = Some(t_us);
        let effort = hands.iter().map(Fatigue::effort).fold(0.0, f32::max);
        if effort > FREE_SHARE {
            // Endurance in seconds at this share of the strongest.
            let endurance = (1236.5 / (effort * 100.0 - 15.0).portable_powf(0.618) - 72.5).max(5.0);
            self.spent = (self.spent + dt / endurance).min(1.0);
        } else {
            // Recovery: a spent arm is fresh after two minutes of rest.
            self.spent = (self.spent - dt / 120.0).max(0.0);
        }
    }

    /// 0 fresh to 1 spent.
    pub fn spent(&self) -> f32 {
        self.spent
    }

    /// Time to offer a lower plane of work: a third of the endurance is gone.
    pub fn wants_lower(&self) -> bool {
        self.spent > 0.33
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hand(palm: Vec3, elbow: Vec3) -> Hand {
        Hand { palm, elbow: Some(elbow), ..Hand::default() }
    }

    #[test]
    fn a_reach_is_what_the_hands_went_through_and_outliers_do_not_count() {
        let mut reach = ReachCalibration::default();
        let mut last = Calibrated::TooLittle;
        for i in 0..=500u64 {
            let a = i as f32 * 0.05;
            let palm = if i % 100 == 7 {
                Vec3::splat(900.0)
            } else {
                Vec3::new(20.0, 180.0, -30.0)
                    + 80.0 * Vec3::new(a.sin(), (1.3 * a).sin(), (0.7 * a).sin())
            };
            last = reach.take(i * 10_000, &[hand(palm, palm)]);
        }
        let Calibrated::Done(reach) = last else { panic!("{last:?}") };
        assert!(reach.middle_mm.distance(Vec3::new(20.0, 180.0, -30.0)) < 12.0, "{reach:?}");
        assert!((65.0..85.0).contains(&reach.half_mm), "{reach:?}");
        assert!(reach.is_sane() && reach.lowered().middle_mm.y < reach.middle_mm.y);
        let mut nobody = ReachCalibration::default();
        nobody.take(0, &[]);
        assert_eq!(nobody.take(CALIBRATION_US, &[]), Calibrated::TooLittle);
    }

    #[test]
    fn lifted_arms_tire_within_minutes_and_resting_elbows_recover() {
        let lifted = hand(Vec3::new(0.0, 350.0, 0.0), Vec3::new(0.0, 300.0, 250.0));
        let resting = hand(Vec3::new(0.0, 180.0, 0.0), Vec3::new(0.0, 20.0, 200.0));
        let mut arm = Fatigue::default();
        let seconds = (0..6000u64)
            .find(|i| {
                arm.take(i * 100_000, &[lifted]);
                arm.wants_lower()
            })
            .map(|i| i as f32 * 0.1);
        assert!(seconds.is_some_and(|s| (30.0..400.0).contains(&s)), "{seconds:?}");
        let spent = arm.spent();
        for i in 6000..6600u64 {
            arm.take(i * 100_000, &[resting]);
        }
        assert!(arm.spent() < spent && !arm.wants_lower(), "{} after {spent}", arm.spent());
    }
}
