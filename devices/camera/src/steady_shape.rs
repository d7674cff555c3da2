//! Steadies what a single camera sees worst: how far each joint is before or behind the palm.
//!
//! Pixels are good to a fraction of a millimetre, depth within the hand to several. So depth is a
//! low pass whose cutoff rises with the speed across the line of sight alone, after One Euro
//! (Casiez, Roussel and Vogel, CHI 2012): while no joint moves in the picture, none moves in
//! depth; a finger that bends or a hand that turns moves in the picture too.

use glam::Vec2;

use crate::landmarks::JOINTS;
use crate::spatial::PlacedHand;

/// Cutoff of a joint that does not move, Hz.
const REST_HZ: f32 = 0.15;
/// Cutoff for each mm/s across the line of sight, Hz.
const HZ_PER_MM_S: f32 = 0.035;
/// Speed that pixel noise alone shows, mm/s.
const NOISE_MM_S: f32 = 8.0;
/// Cutoff of the speed itself, Hz.
const SPEED_HZ: f32 = 1.5;
/// Gap after which the memory is forgotten, microseconds.
const STALE_US: u64 = 250_000;

/// Memory of one hand's joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SteadyShape {
    /// Depth of each joint relative to the hand, mm.
    relative: [f32; JOINTS],
    across: [Vec2; JOINTS],
    speed: [Vec2; JOINTS],
    t_us: u64,
}

fn share(cutoff: f32, dt: f32) -> f32 {
    let tau = 1.0 / (std::f32::consts::TAU * cutoff);
    1.0 / (1.0 + tau / dt)
}

impl SteadyShape {
    /// A hand that appears.
    pub(crate) fn new(hand: &PlacedHand, t_us: u64) -> Self {
        SteadyShape {
            relative: hand.joints.map(|p| p.z - hand.depth),
            across: hand.joints.map(|p| p.truncate()),
            speed: [Vec2::ZERO; JOINTS],
            t_us,
        }
    }

    /// Takes the next picture's hand and returns it with steady depths.
    pub(crate) fn apply(&mut self, hand: &PlacedHand, t_us: u64) -> PlacedHand {
        let gap = t_us.saturating_sub(self.t_us);
        if gap > STALE_US || gap == 0 {
            *self = SteadyShape::new(hand, t_us);
            return *hand;
        }
        let dt = gap as f32 * 1e-6;
        self.t_us = t_us;
        let mut steady = *hand;
        for (i, joint) in steady.joints.iter_mut().enumerate() {
            let across = joint.truncate();
            let speed = (across - self.across[i]) / dt;
            self.across[i] = across;
            self.speed[i] = self.speed[i].lerp(speed, share(SPEED_HZ, dt));
            let moving = (self.speed[i].length() - NOISE_MM_S).max(0.0);
            let by = share(REST_HZ + HZ_PER_MM_S * moving, dt);
            self.relative[i] += (joint.z - hand.depth - self.relative[i]) * by;
            let z = (hand.depth + self.relative[i]).max(1.0);
            *joint *= z / joint.z.max(1.0);
        }
        steady
    }
}
