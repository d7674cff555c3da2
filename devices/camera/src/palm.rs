//! Finds palms in a whole picture (Bazarevsky and Zhang, "On-device, real-time hand tracking with
//! MediaPipe", 2019): a single-shot detector over a fixed grid of anchors.

use glam::Vec2;

use crate::inference::{ModelError, Network};
use crate::picture::{Border, Crop, Picture};

/// A palm in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palm {
    /// 0 to 1.
    pub score: f32,
    /// Middle of the box around the palm, pixels.
    pub centre: Vec2,
    /// Sides of the box, pixels.
    pub size: Vec2,
    /// Wrist, knuckles of index, middle, ring and little finger, two joints of the thumb; pixels.
    pub points: [Vec2; 7],
}

/// Scores below this are not palms.
const MIN_SCORE: f32 = 0.5;
/// Two boxes that overlap by more than this, as a share of their union, are one palm.
const SAME_PALM: f32 = 0.3;
/// Side of the model's input; its grid depends on it.
const SIDE: usize = 192;
/// Numbers of each anchor: a box and seven points.
const NUMBERS: usize = 18;
/// Cells of each grid, and anchors in each of its cells.
const GRIDS: [(usize, usize); 2] = [(24, 2), (12, 6)];

/// The detector with its model.
#[derive(Debug)]
pub struct PalmDetector {
    network: Network,
    anchors: Vec<Vec2>,
}

impl PalmDetector {
    /// Loads the model from the bytes of `palm_detection_*.tflite`.
    ///
    /// # Errors
    /// Returns an error if the bytes are not such a model.
    pub fn new(bytes: &[u8]) -> Result<Self, ModelError> {
        let network = Network::load(bytes)?;
        let mut anchors = Vec::new();
        for (cells, each) in GRIDS {
            for cell in 0..cells * cells {
                let at = Vec2::new((cell % cells) as f32, (cell / cells) as f32) + 0.5;
                anchors.extend(std::iter::repeat_n(at / cells as f32, each));
            }
        }
        let input = network.input_shape();
        let fits = (input.h, input.w, input.c) == (SIDE, SIDE, 3)
            && network.output(0).len() == anchors.len() * NUMBERS
            && network.output(1).len() == anchors.len();
        if !fits {
            return Err(ModelError::Inconsistent("this is not a palm detector".into()));
        }
        Ok(PalmDetector { network, anchors })
    }

    /// Returns the palms of a picture, the surest first.
    pub fn detect(&mut self, picture: &Picture) -> Vec<Palm> {
        let crop = Crop::around(picture);
        crop.sample(picture, Border::Black, SIDE, self.network.input_mut());
        self.network.run();
        let (numbers, scores) = (self.network.output(0), self.network.output(1));
        let mut found = Vec::new();
        let anchors = self.anchors.iter().zip(scores).zip(numbers.chunks_exact(NUMBERS));
        for ((anchor, score), row) in anchors {
            let score = 1.0 / (1.0 + (-score.clamp(-100.0, 100.0)).exp());
            if score < MIN_SCORE {
                continue;
            }
            let pair = |k: usize| Vec2::new(row[2 * k], row[2 * k + 1]) / SIDE as f32;
            let mut points = [Vec2::ZERO; 7];
            for (k, point) in points.iter_mut().enumerate() {
                *point = crop.to_picture(*anchor + pair(k + 2));
            }
            found.push(Palm {
                score,
                centre: crop.to_picture(*anchor + pair(0)),
                size: pair(1) * crop.side,
                points,
            });
        }
        found.retain(|p| p.size.min_element() > 0.0 && p.points.iter().all(|p| p.is_finite()));
        merge(found)
    }
}

/// Boxes of one palm become their mean, weighted by their scores (weighted non-maximum
/// suppression, as in BlazeFace, Bazarevsky and others, 2019).
fn merge(mut found: Vec<Palm>) -> Vec<Palm> {
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut palms = Vec::new();
    while let Some(best) = found.first().copied() {
        let (same, other): (Vec<Palm>, Vec<Palm>) =
            found.into_iter().partition(|p| overlap(&best, p) > SAME_PALM || *p == best);
        let total: f32 = same.iter().map(|p| p.score).sum();
        let mean =
            |of: &dyn Fn(&Palm) -> Vec2| same.iter().map(|p| of(p) * p.score).sum::<Vec2>() / total;
        let mut palm = best;
        (palm.centre, palm.size) = (mean(&|p| p.centre), mean(&|p| p.size));
        for k in 0..palm.points.len() {
            palm.points[k] = mean(&|p| p.points[k]);
        }
        palms.push(palm);
        found = other;
    }
    palms
}

/// Intersection of two boxes over their union.
fn overlap(a: &Palm, b: &Palm) -> f32 {
    let (low, high) = (
        (a.centre - a.size * 0.5).max(b.centre - b.size * 0.5),
        (a.centre + a.size * 0.5).min(b.centre + b.size * 0.5),
    );
    let shared = (high - low).max(Vec2::ZERO).element_product();
    shared / (a.size.element_product() + b.size.element_product() - shared).max(1e-6)
}

impl Palm {
    /// The square in which the landmarks of the whole hand are looked for: turned so that the
    /// fingers point up, 2.6 times the palm, and moved toward the fingers by half of it.
    pub fn hand_crop(&self) -> Crop {
        let up = self.points[2] - self.points[0];
        let angle = up.y.atan2(up.x) + std::f32::consts::FRAC_PI_2;
        let side = self.size.max_element();
        let toward = Vec2::from_angle(angle).rotate(Vec2::new(0.0, -0.5 * self.size.y));
        Crop { centre: self.centre + toward, side: side * 2.6, angle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn palm(x: f32, score: f32) -> Palm {
        let points = [Vec2::new(x, 0.0); 7];
        Palm { score, centre: Vec2::new(x, 0.0), size: Vec2::splat(10.0), points }
    }

    #[test]
    fn boxes_of_one_palm_become_one() {
        let palms = merge(vec![palm(100.0, 0.6), palm(0.0, 0.9), palm(2.0, 0.9)]);
        assert_eq!(palms.len(), 2);
        assert!((palms[0].centre.x - 1.0).abs() < 1e-5 && palms[1].centre.x == 100.0);
    }

    #[test]
    fn an_upright_palm_has_an_upright_crop_above_its_wrist() {
        let mut one = palm(50.0, 0.9);
        one.points[0] = Vec2::new(50.0, 20.0);
        let crop = one.hand_crop();
        assert!(crop.angle.abs() < 1e-6 && crop.side == 26.0);
        assert!((crop.centre - Vec2::new(50.0, -5.0)).length() < 1e-4, "{crop:?}");
    }
}
