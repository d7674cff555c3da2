//! Drawn hands that perform a script: the demo's camera.

use super::{CameraError, PictureSource, USUAL_RATE};
use crate::drawn::{DrawnScene, draw};
use crate::drawn_hand::DrawnHand;
use crate::picture::Picture;
use sculptd_devices::sim::hand::HandScript;

/// Pictures of a script.
#[derive(Debug, Clone)]
pub struct DrawnScript {
    script: HandScript,
    scene: DrawnScene,
    next: u64,
}

impl DrawnScript {
    /// Draws the script's hands in this scene.
    pub fn new(script: HandScript, scene: DrawnScene) -> Self {
        DrawnScript { script, scene, next: 0 }
    }
}

impl PictureSource for DrawnScript {
    fn next_picture(&mut self) -> Result<Option<(u64, Picture)>, CameraError> {
        let t_us = (self.next as f64 * 1e6 / USUAL_RATE) as u64;
        if t_us > self.script.end_us() {
            return Ok(None);
        }
        self.next += 1;
        let scene = DrawnScene { seed: self.scene.seed.wrapping_add(self.next), ..self.scene };
        Ok(Some((t_us, draw(&scene, &DrawnHand::of_script(&self.script, t_us)))))
    }

    fn describe(&self) -> String {
        let (w, h) = self.scene.size;
        format!("drawn hands, {w} by {h} pixels, {USUAL_RATE} a second")
    }
}
