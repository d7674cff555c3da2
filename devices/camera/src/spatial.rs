//! From pixels to millimetres: how far a hand is, and where its joints are.
//!
//! The landmark model gives the joints' pixels, and a shape of the hand in mm. `palm_pose` fits a
//! rigid palm to the pixels. The pixels then place each joint across the line of sight, and the
//! palm and the shape of the fingers place it along.
//!
//! A camera cannot tell a small hand from a distant one, so depth is right up to one factor a
//! person: [`Calibration::scale`].

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::landmarks::{JOINTS, PALM_JOINTS, SeenHand};
use crate::lens::Lens;
use crate::palm_pose::fit_palm;

/// Nearest and farthest believed distance, mm.
const RANGE_MM: (f64, f64) = (80.0, 2500.0);

/// A person's hand as the camera measures it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Size of the hand as a share of what the model takes it to be.
    pub scale: f32,
    /// Correction added to each distance, mm. A hand that is small in the picture seems larger than
    /// it is, and so nearer.
    pub offset_mm: f32,
}

impl Default for Calibration {
    fn default() -> Self {
        Calibration { scale: 1.0, offset_mm: 0.0 }
    }
}

/// Least difference of the distances from which an offset follows, as a share.
const APART: f32 = 0.2;
/// Largest believed difference between the two scales, as a share.
const BENT: f32 = 0.25;

impl Calibration {
    /// Returns the calibration under which the measured distances are the true ones. Each pair is
    /// `(true, measured)`, measured under `self`. One pair gives the scale, two the offset too.
    pub fn corrected(&self, pairs: &[(f32, f32)]) -> Option<Calibration> {
        let own = |d: f32| d - self.offset_mm;
        let ratios: Vec<f32> = pairs.iter().map(|(d, m)| d / own(*m)).collect();
        let mean = ratios.iter().sum::<f32>() / ratios.len().max(1) as f32;
        let (mut by, mut offset_mm) = (mean, 0.0);
        if let [(far, seen_far), (near, seen_near)] = *pairs
            && (far - near).abs() > APART * far.max(near)
        {
            let slope = (far - near) / (own(seen_far) - own(seen_near));
            if (slope / mean - 1.0).abs() < BENT {
                (by, offset_mm) = (slope, far - slope * own(seen_far));
            }
        }
        let scale = self.scale * by;
        (scale.is_finite() && (0.4..=2.0).contains(&scale))
            .then_some(Calibration { scale, offset_mm })
    }
}

/// A hand in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedHand {
    /// Joints in the camera's axes, mm.
    pub joints: [Vec3; JOINTS],
    /// Distance of the hand's middle along the camera's axis, mm.
    pub depth: f32,
    /// Root mean square of the palm's missed pixels, as a share of its length.
    pub misfit: f32,
}

/// Places a hand; `left` as all its pictures together say. `None` if the pixels contradict any
/// place in front of the camera.
pub fn place(
    seen: &SeenHand,
    left: bool,
    size: Vec2,
    lens: &Lens,
    calibration: &Calibration,
) -> Option<PlacedHand> {
    let focal = lens.focal_px(size);
    let rays = seen.joints.map(|p| (p - size * 0.5) / focal);
    let palm = fit_palm(&rays, &seen.shape, left, calibration.scale)?;
    let depth = palm.joints.iter().map(|p| p.z).sum::<f64>() / 6.0;
    if depth < RANGE_MM.0 || depth > RANGE_MM.1 {
        return None;
    }
    let growth = palm.growth.clamp(0.6, 1.6);
    let root = seen.shape[0].as_dvec3();
    let mut joints = [Vec3::ZERO; JOINTS];
    for (i, (joint, ray)) in joints.iter_mut().zip(&rays).enumerate() {
        let z = match PALM_JOINTS.iter().position(|p| *p == i) {
            Some(own) => palm.joints[own].z,
            // Fingers are as the model sees them, on the palm as it was fitted.
            None => {
                let arm = palm.correction * (seen.shape[i].as_dvec3() - root) * growth;
                palm.wrist.z + arm.z
            }
        };
        let z = z.max(RANGE_MM.0 * 0.5) as f32;
        *joint = Vec3::new(ray.x * z, ray.y * z, z);
    }
    let placed = PlacedHand { joints, depth: depth as f32, misfit: palm.misfit as f32 };
    Some(placed.at_depth(placed.depth + calibration.offset_mm))
}

impl PlacedHand {
    /// The same hand at another distance; each joint stays on its pixel.
    pub fn at_depth(&self, depth: f32) -> PlacedHand {
        let by = depth - self.depth;
        let joints = self.joints.map(|p| p * ((p.z + by).max(1.0) / p.z.max(1.0)));
        PlacedHand { joints, depth, misfit: self.misfit }
    }
}

/// Across the line of sight, tips that are nearer than the first are one behind the other or touch;
/// beyond the second nothing is assumed. mm.
const TIPS_MM: (f32, f32) = (34.0, 62.0);
/// Share of the difference in depth that tips near each other keep: the model's depth of a closed
/// pinch is wrong by 20 to 40 mm, always the same way.
const TIPS_DEPTH: f32 = 0.3;
/// Landmarks are at the middle of a fingertip: tips that touch are this much nearer, mm.
const TIPS_FLESH_MM: f32 = 11.0;

impl PlacedHand {
    /// The same hand with the tips of thumb and index finger at nearly one depth, and nearer by the
    /// flesh between them, where they are near each other in the picture. Without it few closed
    /// pinches would look closed.
    pub fn with_tips_joined(mut self) -> PlacedHand {
        let (thumb, index) = (self.joints[4], self.joints[8]);
        let across = thumb.truncate().distance(index.truncate());
        let near = 1.0 - ((across - TIPS_MM.0) / (TIPS_MM.1 - TIPS_MM.0)).clamp(0.0, 1.0);
        let mut apart = index - thumb;
        apart.z *= 1.0 - (1.0 - TIPS_DEPTH) * near;
        let gap = apart.length().max(1e-3);
        apart *= (gap - TIPS_FLESH_MM * near).max(0.3 * gap) / gap;
        let by = (index - thumb - apart) * 0.5;
        // The last joints follow by half.
        for (joint, by) in [(4, by), (3, 0.5 * by), (8, -by), (7, -0.5 * by)] {
            self.joints[joint] += by;
        }
        self
    }
}

/// Smooths a hand's distance over time: a Kalman filter of place and speed (Kalman 1960), whose
/// hand accelerates little while it rests and as much as an arm can while it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthFilter {
    depth: f32,
    speed: f32,
    /// Covariance of the two: place, both, speed.
    covariance: [f32; 3],
    /// Smoothed surprise over its expectation, with its sign: a hand that moves is always behind.
    surprise: f32,
    t_us: u64,
}

/// Noise of one measurement, as a share of the distance.
const DEPTH_NOISE: f32 = 0.01;
/// Acceleration of a resting hand and of a moving one, mm/s².
const REST_MM_S2: f32 = 3.0;
const MOVING_MM_S2: f32 = 6_000.0;
/// Gap after which the filter restarts, microseconds.
const STALE_US: u64 = 300_000;

impl DepthFilter {
    /// A hand that appears at this distance.
    pub fn new(depth: f32, t_us: u64) -> Self {
        let noise = (DEPTH_NOISE * depth).powi(2);
        DepthFilter { depth, speed: 0.0, covariance: [noise, 0.0, 2_500.0], surprise: 0.0, t_us }
    }

    /// Takes one measurement and returns the smoothed distance.
    pub fn take(&mut self, measured: f32, t_us: u64) -> f32 {
        let gap = t_us.saturating_sub(self.t_us);
        if gap > STALE_US {
            *self = DepthFilter::new(measured, t_us);
            return measured;
        }
        let dt = gap as f32 * 1e-6;
        self.t_us = t_us;
        // A resting hand surprises by its noise alone, as often this way as that.
        let moves = ((self.surprise.abs() - 0.5) / 0.7).clamp(0.0, 1.0);
        let push = REST_MM_S2 + (MOVING_MM_S2 - REST_MM_S2) * moves * moves;
        let q = push * push;
        let [a, b, c] = self.covariance;
        let (a, b, c) = (
            a + dt * (2.0 * b + dt * c) + q * dt.powi(4) / 4.0,
            b + dt * c + q * dt.powi(3) / 2.0,
            c + q * dt * dt,
        );
        self.depth += self.speed * dt;
        let noise = (DEPTH_NOISE * self.depth).powi(2);
        let off = measured - self.depth;
        let sigma = (a + noise).sqrt();
        self.surprise += 0.25 * ((off / sigma).clamp(-4.0, 4.0) - self.surprise);
        let (gain, gain_speed) = (a / (a + noise), b / (a + noise));
        self.depth += gain * off;
        self.speed += gain_speed * off;
        self.covariance = [a * (1.0 - gain), b * (1.0 - gain), c - gain_speed * b];
        self.depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_makes_its_distances_right() {
        let before = Calibration { scale: 0.9, offset_mm: 12.0 };
        let measure = |c: &Calibration, raw: f32| c.scale * raw + c.offset_mm;
        let pairs = [(600.0, measure(&before, 640.0)), (350.0, measure(&before, 400.0))];
        let after = before.corrected(&pairs).expect("a calibration");
        assert!((measure(&after, 640.0) - 600.0).abs() < 0.1, "{after:?}");
        assert!((measure(&after, 400.0) - 350.0).abs() < 0.1, "{after:?}");
        let one = before.corrected(&pairs[..1]).expect("a calibration");
        assert!((measure(&one, 640.0) - 600.0).abs() < 0.1 && one.offset_mm == 0.0);
        assert!(before.corrected(&[]).is_none());
    }

    #[test]
    fn a_resting_hand_is_steady_and_a_moving_one_is_followed() {
        let mut filter = DepthFilter::new(450.0, 0);
        let noise = |i: u64| ((i * 7919 % 13) as f32 - 6.0) * 0.6;
        let mut worst = 0.0_f32;
        for i in 1..200_u64 {
            let got = filter.take(450.0 + noise(i), i * 33_333);
            if i > 30 {
                worst = worst.max((got - 450.0).abs());
            }
        }
        assert!(worst < 1.2, "{worst} mm at rest");
        let mut behind = 0.0_f32;
        for i in 200..260_u64 {
            let true_depth = 450.0 - (i - 200) as f32 * 10.0;
            let got = filter.take(true_depth + noise(i), i * 33_333);
            if i > 212 && true_depth > 100.0 {
                behind = behind.max((got - true_depth).abs());
            }
        }
        assert!(behind < 12.0, "{behind} mm behind at 300 mm/s");
    }
}
