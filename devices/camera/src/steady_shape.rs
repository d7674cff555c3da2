//! Steadies what a single camera sees worst: the depth within a hand, and with it its turn.
//!
//! Pixels are good to a fraction of a millimetre, the model's shape to several. So the shape is a
//! low pass whose cutoff rises with the speed across the line of sight alone, after One Euro
//! (Casiez, Roussel and Vogel, CHI 2012): while no joint moves in the picture, none moves in
//! depth; a finger that bends or a hand that turns moves in the picture too.

use glam::{Vec2, Vec3};

use crate::landmarks::{JOINTS, SeenHand};

/// Cutoff of a joint that does not move, Hz.
const REST_HZ: f32 = 0.06;
/// Cutoff for each mm/s across the line of sight, Hz.
const HZ_PER_MM_S: f32 = 0.035;
/// Speed that pixel noise alone shows, mm/s.
const NOISE_MM_S: f32 = 16.0;
/// Cutoff of the speed itself, Hz.
const SPEED_HZ: f32 = 1.5;
/// Gap after which the memory is forgotten, microseconds.
const STALE_US: u64 = 250_000;
/// Length of a palm, mm: the scale of speeds, which needs no calibration.
const PALM_MM: f32 = 90.0;

/// Memory of one hand's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SteadyShape {
    shape: [Vec3; JOINTS],
    joints: [Vec2; JOINTS],
    speed: [Vec2; JOINTS],
    /// Pictures over which each joint is averaged.
    memory: [f32; JOINTS],
    t_us: u64,
}

fn share(cutoff: f32, dt: f32) -> f32 {
    let tau = 1.0 / (std::f32::consts::TAU * cutoff);
    1.0 / (1.0 + tau / dt)
}

impl SteadyShape {
    /// A hand that appears.
    pub(crate) fn new(seen: &SeenHand, t_us: u64) -> Self {
        SteadyShape {
            shape: seen.shape,
            joints: seen.joints,
            speed: [Vec2::ZERO; JOINTS],
            memory: [1.0; JOINTS],
            t_us,
        }
    }

    /// Takes the hand of the next picture and returns it with a steady shape.
    pub(crate) fn apply(&mut self, seen: &SeenHand, t_us: u64) -> SeenHand {
        let gap = t_us.saturating_sub(self.t_us);
        if gap > STALE_US || gap == 0 {
            *self = SteadyShape::new(seen, t_us);
            return *seen;
        }
        let dt = gap as f32 * 1e-6;
        let mm = PALM_MM / seen.palm_px().max(1.0);
        self.t_us = t_us;
        for i in 0..JOINTS {
            let speed = (seen.joints[i] - self.joints[i]) * (mm / dt);
            self.joints[i] = seen.joints[i];
            self.speed[i] = self.speed[i].lerp(speed, share(SPEED_HZ, dt));
            let moving = (self.speed[i].length() - NOISE_MM_S).max(0.0);
            let by = share(REST_HZ + HZ_PER_MM_S * moving, dt);
            // A plain mean until the low pass would remember less: it settles at once.
            self.memory[i] = (self.memory[i] + 1.0).min(1.0 / by);
            self.shape[i] = self.shape[i].lerp(seen.shape[i], 1.0 / self.memory[i]);
        }
        SeenHand { shape: self.shape, ..*seen }
    }
}
