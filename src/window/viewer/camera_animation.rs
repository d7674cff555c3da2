//! The camera's way to a place, so that one sees where one goes.

use glam::Vec3;

use sculptd_engine::camera::Camera;
use sculptd_engine::camera::MAX_PITCH;

/// Microseconds of a camera_animation.
const TAKES_US: u64 = 450_000;

#[derive(Debug, Clone, Copy)]
pub struct CameraAnimation {
    from: Camera,
    to: Camera,
    begun_us: u64,
}

impl CameraAnimation {
    /// To look at `place` from a side of it, at an object of this bounding radius.
    pub fn to_place(
        from: Camera,
        place: Vec3,
        side: Vec3,
        extent: f32,
        now_us: u64,
    ) -> CameraAnimation {
        let out = side.normalize_or(from.backward());
        let tau = std::f32::consts::TAU;
        let yaw = if out.x.abs() + out.z.abs() > 1e-4 { out.x.atan2(out.z) } else { from.yaw };
        // The short way round.
        let turn = (yaw - from.yaw + tau * 1.5).rem_euclid(tau) - tau * 0.5;
        let to = Camera {
            target: place,
            yaw: from.yaw + turn,
            pitch: out.y.asin().clamp(-MAX_PITCH, MAX_PITCH),
            distance: (extent * 1.6).max(1e-6),
            ..from
        };
        CameraAnimation { from, to, begun_us: now_us }
    }

    /// The camera when it has arrived.
    pub fn end(&self) -> Camera {
        self.to
    }

    /// The camera now, and whether it has arrived.
    pub fn at(&self, now_us: u64) -> (Camera, bool) {
        let x = (now_us.saturating_sub(self.begun_us) as f32 / TAKES_US as f32).min(1.0);
        let s = x * x * (3.0 - 2.0 * x);
        let mix = |a: f32, b: f32| a + (b - a) * s;
        let camera = Camera {
            target: self.from.target.lerp(self.to.target, s),
            yaw: mix(self.from.yaw, self.to.yaw).rem_euclid(std::f32::consts::TAU),
            pitch: mix(self.from.pitch, self.to.pitch),
            distance: mix(self.from.distance, self.to.distance),
            ..self.from
        };
        (camera, x >= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flight_ends_looking_at_the_place_from_outside() {
        let from = Camera { yaw: 6.0, ..Camera::default() };
        let place = Vec3::new(0.9, 0.1, 0.3);
        let camera_animation = CameraAnimation::to_place(from, place, place, 1.0, 5);
        let (camera, arrived) = camera_animation.at(5 + TAKES_US);
        assert!(arrived && camera.is_sane());
        assert!((camera.target - place).length() < 1e-6);
        assert!(camera.backward().dot(place.normalize()) > 0.999);
        // Never the long way round.
        let (half, _) = camera_animation.at(5 + TAKES_US / 2);
        let turn = std::f32::consts::TAU;
        let step = (half.yaw - from.yaw + 1.5 * turn).rem_euclid(turn) - 0.5 * turn;
        assert!(step.abs() < 1.6, "{step}");
    }
}
