//! A brush that keeps its size on the screen while the view is zoomed.

use sculptd_engine::camera::Camera;

/// Seconds after a radius was asked for in which another one is an earlier answer, and not a
/// person's own wish.
const PATIENCE_S: f64 = 0.5;
/// Relative changes of the scale below this are roundings.
const SAME: f32 = 1e-4;

/// The radius on the screen, and when it was last asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ScreenRadius {
    /// World units a pixel where the surface is seen; 0: not known yet.
    scale: f32,
    /// Inputs of the last measurement: the camera, and the height of the view in pixels.
    measured: Option<(Camera, f32, f32)>,
    /// The radius that is kept, pixels.
    pixels: f32,
    /// Time of the last radius request, in seconds of the context's time.
    asked: Option<f64>,
}

impl ScreenRadius {
    /// Returns the world units per pixel. Measures them again if the camera or the height of the
    /// view, in pixels, has changed.
    pub fn scale(&mut self, camera: &Camera, pixels: f32, measure: impl FnOnce() -> f32) -> f32 {
        match self.measured {
            Some((of, high, scale)) if of == *camera && high == pixels => scale,
            _ => {
                let scale = measure();
                self.measured = Some((*camera, pixels, scale));
                scale
            }
        }
    }

    /// Looks at the radius, in world units, at a scale and a time. The radius that keeps the
    /// brush's size on the screen, where the scale has changed.
    pub fn follow(&mut self, radius: f32, scale: f32, time: f64) -> Option<f32> {
        let known = self.scale > 0.0;
        let zoomed = known && (scale / self.scale - 1.0).abs() > SAME;
        if zoomed {
            (self.scale, self.asked) = (scale, Some(time));
            return Some(self.pixels * scale);
        }
        if !known || self.asked.is_none_or(|since| time - since > PATIENCE_S) {
            (self.scale, self.pixels, self.asked) = (scale, radius / scale, None);
        }
        None
    }

    /// A person asks for another radius, in world units.
    pub fn set(&mut self, radius: f32, scale: f32, time: f64) {
        (self.scale, self.pixels, self.asked) = (scale, radius / scale, Some(time));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zoom_keeps_the_pixels_and_other_changes_are_taken_over() {
        let mut kept = ScreenRadius::default();
        assert_eq!(kept.follow(0.2, 0.01, 0.0), None);
        // Twice as near, while the first answer is still on its way.
        assert_eq!(kept.follow(0.2, 0.005, 1.0), Some(20.0 * 0.005));
        assert_eq!(kept.follow(0.2, 0.0025, 1.1), Some(20.0 * 0.0025));
        assert_eq!(kept.follow(0.1, 0.0025, 1.2), None);
        assert_eq!(kept.follow(0.05, 0.0025, 1.3), None);
        // A key makes it larger, later: that is what is kept from then on.
        assert_eq!(kept.follow(0.06, 0.0025, 2.0), None);
        assert_eq!(kept.follow(0.06, 0.005, 2.1), Some(24.0 * 0.005));
        // The slider, in the middle of a zoom.
        kept.set(0.5, 0.005, 2.2);
        assert_eq!(kept.follow(0.12, 0.005, 2.25), None);
        assert_eq!(kept.follow(0.5, 0.01, 2.3), Some(100.0 * 0.01));
    }
}
