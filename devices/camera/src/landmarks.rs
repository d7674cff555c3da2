//! Finds the 21 joints of one hand in a crop of the picture, with the landmark model of MediaPipe
//! (Zhang and others, "MediaPipe Hands: on-device real-time hand tracking", 2020).

use glam::{Vec2, Vec3};

use crate::inference::{ModelError, Network};
use crate::picture::{Border, Crop, Picture};

/// Joints of a hand: wrist, then four a finger, thumb first.
pub const JOINTS: usize = 21;
/// Wrist and knuckles, which move as one: the palm.
pub const PALM_JOINTS: [usize; 6] = [0, 1, 5, 9, 13, 17];
/// Side of the model's input.
const SIDE: usize = 224;

/// One hand in one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenHand {
    /// Joints in the picture, pixels.
    pub joints: [Vec2; JOINTS],
    /// Joints about the hand's middle, mm as an average adult has them, in the camera's axes: x
    /// right, y down, z away from the camera.
    pub shape: [Vec3; JOINTS],
    /// Sureness that the crop shows a hand, 0 to 1.
    pub presence: f32,
    /// Sureness that it is a left hand, 0 to 1.
    pub left: f32,
    /// The crop that was looked at.
    pub crop: Crop,
}

/// The landmark model.
#[derive(Debug)]
pub struct LandmarkModel {
    network: Network,
}

impl LandmarkModel {
    /// Loads the model from the bytes of `hand_landmark_*.tflite`.
    ///
    /// # Errors
    /// Returns an error if the bytes are not such a model.
    pub fn new(bytes: &[u8]) -> Result<Self, ModelError> {
        let network = Network::load(bytes)?;
        let input = network.input_shape();
        let fits = (input.h, input.w, input.c) == (SIDE, SIDE, 3)
            && [0, 1, 2, 3].map(|i| network.output(i).len()) == [63, 1, 1, 63];
        if !fits {
            return Err(ModelError::Inconsistent("this is not a landmark model".into()));
        }
        Ok(LandmarkModel { network })
    }

    /// Looks at one crop.
    pub fn look(&mut self, picture: &Picture, crop: &Crop) -> SeenHand {
        crop.sample(picture, Border::Nearest, SIDE, self.network.input_mut());
        self.network.run();
        let turn = Vec2::from_angle(crop.angle);
        let (mut joints, mut shape) = ([Vec2::ZERO; JOINTS], [Vec3::ZERO; JOINTS]);
        let flat = self.network.output(0).chunks_exact(3);
        for (joint, at) in joints.iter_mut().zip(flat) {
            *joint = crop.to_picture(Vec2::new(at[0], at[1]) / SIDE as f32);
        }
        let metres = self.network.output(3).chunks_exact(3);
        for (joint, at) in shape.iter_mut().zip(metres) {
            let across = turn.rotate(Vec2::new(at[0], at[1]));
            *joint = Vec3::new(across.x, across.y, at[2]) * 1000.0;
        }
        let one = |i: usize| self.network.output(i).first().map_or(0.0, |v| v.clamp(0.0, 1.0));
        // The model says how sure it is of a right hand in a picture that is not mirrored.
        SeenHand { joints, shape, presence: one(1), left: 1.0 - one(2), crop: *crop }
    }
}

impl SeenHand {
    /// Returns true if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.joints.iter().all(|p| p.is_finite()) && self.shape.iter().all(|p| p.is_finite())
    }

    /// Returns the mean of the palm's joints, pixels.
    pub fn palm(&self) -> Vec2 {
        PALM_JOINTS.iter().map(|i| self.joints[*i]).sum::<Vec2>() / PALM_JOINTS.len() as f32
    }

    /// Returns the distance from the wrist to the middle knuckle or across the knuckles, whichever
    /// is longer, pixels: a length that no turn of the hand makes small.
    pub fn palm_px(&self) -> f32 {
        let long = self.joints[0].distance(self.joints[9]);
        long.max(1.2 * self.joints[5].distance(self.joints[17]))
    }

    /// The crop for the next picture: turned so that the fingers point up, twice the size of the
    /// palm and the thumb, as MediaPipe does it.
    pub fn next_crop(&self) -> Crop {
        let knuckles = (self.joints[5] + self.joints[13]) * 0.25 + self.joints[9] * 0.5;
        let up = knuckles - self.joints[0];
        let angle = up.y.atan2(up.x) + std::f32::consts::FRAC_PI_2;
        let back = Vec2::from_angle(-angle);
        let used = [0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18];
        let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
        for i in used {
            let p = back.rotate(self.joints[i]);
            (low, high) = (low.min(p), high.max(p));
        }
        let (middle, size) = ((low + high) * 0.5, high - low);
        let middle = middle - Vec2::new(0.0, 0.1 * size.y);
        let side = 2.0 * size.max_element().max(8.0);
        Crop { centre: Vec2::from_angle(angle).rotate(middle), side, angle }
    }
}
