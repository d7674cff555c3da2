//! The camera that a tablet is mapped through: a point of the active area is a point of the view,
//! and a view point is a ray.
//!
//! View coordinates run from (0, 0) at the top left to (1, 1) at the bottom right, whatever the
//! window's size.

use glam::{Mat4, Vec2, Vec3, camera::rh};
use serde::{Deserialize, Serialize};

use sculptd_clay::Ray;
use sculptd_clay::brush::stamp::Lens;
use sculptd_geometry::portable::PortableMath;

/// A turntable camera. Right-handed world, +y up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Point that the camera orbits.
    pub target: Vec3,
    /// Radians about +y; 0 looks along -z.
    pub yaw: f32,
    /// Radians; positive looks down. Within ±[`MAX_PITCH`].
    pub pitch: f32,
    /// From the target to the eye, mesh units, > 0.
    pub distance: f32,
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// Width over height of the view.
    pub aspect: f32,
    /// Parallel rays: everything keeps its size however far away it is.
    pub orthographic: bool,
}

/// Just short of the poles, where "up" would be undefined: 89 degrees.
pub const MAX_PITCH: f32 = 1.553_343;

impl Default for Camera {
    fn default() -> Self {
        Camera {
            target: Vec3::ZERO,
            yaw: 0.5,
            pitch: 0.35,
            distance: 3.0,
            // 40 degrees: long enough that form is not distorted, the habit of sculpting programs.
            fov_y: 0.698_131_7,
            aspect: 1.6,
            orthographic: false,
        }
    }
}

impl Camera {
    /// Backward: from the target to the eye, unit length.
    pub fn backward(&self) -> Vec3 {
        let (sy, cy) = self.yaw.portable_sin_cos();
        let (sp, cp) = self.pitch.portable_sin_cos();
        Vec3::new(sy * cp, sp, cy * cp)
    }

    /// Returns the position of the eye, in world units.
    pub fn eye(&self) -> Vec3 {
        self.target + self.backward() * self.distance
    }

    /// Right and up of the view, unit length.
    pub fn axes(&self) -> (Vec3, Vec3) {
        let back = self.backward();
        let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
        (right, back.cross(right))
    }

    /// Returns the view data that a brush needs.
    pub fn lens(&self) -> Lens {
        let (right, up) = self.axes();
        let (back, half) = (self.backward(), self.half_height(1.0));
        Lens { eye: self.eye(), right, up, back, half, parallel: self.orthographic }
    }

    /// Half the view's height at `depth` before the eye, mesh units.
    fn half_height(&self, depth: f32) -> f32 {
        let at = if self.orthographic { self.distance } else { depth };
        at * (self.fov_y * 0.5).portable_tan()
    }

    /// World length of a step of one whole view height at `depth` before the eye.
    pub fn world_per_view(&self, depth: f32) -> f32 {
        2.0 * self.half_height(depth)
    }

    /// The ray through a view point.
    pub fn ray(&self, view: Vec2) -> Ray {
        let (right, up) = self.axes();
        let ndc = Vec2::new(view.x * 2.0 - 1.0, 1.0 - view.y * 2.0);
        let h = self.half_height(self.distance);
        let offset = right * (ndc.x * h * self.aspect) + up * (ndc.y * h);
        if self.orthographic {
            // From far behind, so that nothing near the eye is cut off.
            let back = self.backward();
            Ray { origin: self.target + offset + back * (self.distance * 8.0), dir: -back }
        } else {
            let eye = self.eye();
            Ray { origin: eye, dir: (self.target + offset - eye).normalize() }
        }
    }

    /// Projects a world point into the view; returns `None` behind the eye.
    pub fn project(&self, p: Vec3) -> Option<Vec2> {
        self.projection().project(p)
    }

    /// The same of many points: what follows from the camera alone is computed once.
    pub fn projection(&self) -> Projection {
        let (right, up) = self.axes();
        let (orthographic, aspect) = (self.orthographic, self.aspect);
        let tan = (self.fov_y * 0.5).portable_tan();
        let distance = orthographic.then_some(self.distance);
        Projection { eye: self.eye(), back: self.backward(), right, up, tan, distance, aspect }
    }

    /// Moves back or forth until a box fills the view, and turns about its middle.
    pub fn frame(&mut self, lo: Vec3, hi: Vec3) {
        self.target = (lo + hi) * 0.5;
        let (right, up) = self.axes();
        let back = self.backward();
        let half = (hi - lo) * 0.5;
        let tan = (self.fov_y * 0.5).portable_tan();
        let mut distance = half.length().max(1e-6) * 0.1;
        for corner in 0..8 {
            let sign = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let d = half * Vec3::new(sign(0), sign(1), sign(2));
            let reach = (d.dot(up).abs() / tan).max(d.dot(right).abs() / (tan * self.aspect));
            let ahead = if self.orthographic { 0.0 } else { d.dot(back) };
            distance = f32::max(distance, reach + ahead);
        }
        // 5 % of margin.
        self.distance = distance * 1.05;
    }

    /// Turns about the target; view fractions, a whole view width is a half turn.
    pub fn orbit(&mut self, by: Vec2) {
        let tau = std::f32::consts::TAU;
        self.yaw = (self.yaw - by.x * std::f32::consts::PI).rem_euclid(tau);
        self.pitch = (self.pitch + by.y * std::f32::consts::PI).clamp(-MAX_PITCH, MAX_PITCH);
    }

    /// Slides the view; view fractions.
    pub fn pan(&mut self, by: Vec2) {
        let (right, up) = self.axes();
        let h = self.world_per_view(self.distance);
        self.target += right * (-by.x * h * self.aspect) + up * (by.y * h);
    }

    /// Zooms by a factor: above 1 comes nearer.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            self.distance = (self.distance / factor).clamp(1e-6, 1e9);
        }
    }

    /// Zooms by a factor about a view point: what is seen there, at whatever depth, stays there.
    pub fn zoom_at(&mut self, factor: f32, view: Vec2) {
        if !view.is_finite() {
            return;
        }
        let before = self.distance;
        self.zoom(factor);
        let ndc = Vec2::new(view.x * 2.0 - 1.0, 1.0 - view.y * 2.0);
        let (right, up) = self.axes();
        // Along the ray through the view point every depth asks for the same step of the target.
        let step = (self.fov_y * 0.5).portable_tan() * (before - self.distance);
        self.target += (right * (ndc.x * self.aspect) + up * ndc.y) * step;
    }

    /// The least and the largest depth before the eye that [`Camera::view_projection`] keeps.
    pub fn depth_range(&self, radius: f32) -> (f32, f32) {
        let far = (self.distance + radius * 2.0).max(1e-3);
        // As far away as the work allows: what depth tells apart at the work goes with it.
        let near = (self.distance - radius * 2.0)
            .max((far * 5e-3).min(self.distance * 0.1))
            .max(far * 1e-5);
        if self.orthographic { (-far, far) } else { (near, far) }
    }

    /// World to clip space, depth 0 to 1, near and far set about a sphere of `radius` round the
    /// target.
    pub fn view_projection(&self, radius: f32) -> Mat4 {
        let eye = self.eye();
        let view = rh::view::look_at_mat4(eye, self.target, Vec3::Y);
        let (near, far) = self.depth_range(radius);
        let proj = if self.orthographic {
            let h = self.half_height(self.distance);
            let w = h * self.aspect;
            rh::proj::directx::orthographic(-w, w, -h, h, near, far)
        } else {
            rh::proj::directx::perspective(self.fov_y, self.aspect, near, far)
        };
        proj * view
    }

    /// Refuses what no view can be made of.
    pub fn is_sane(&self) -> bool {
        let finite =
            self.target.is_finite() && self.yaw.is_finite() && self.pitch.abs() <= MAX_PITCH;
        finite
            && (1e-6..=1e9).contains(&self.distance)
            && (0.01..=3.0).contains(&self.fov_y)
            && (0.05..=20.0).contains(&self.aspect)
    }
}

/// Projection of a camera, precomputed for many points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    eye: Vec3,
    back: Vec3,
    right: Vec3,
    up: Vec3,
    /// Of half the angle of view.
    tan: f32,
    /// Of a parallel view: from which the size of what is seen follows.
    distance: Option<f32>,
    aspect: f32,
}

impl Projection {
    /// Projects a world point into the view; returns `None` behind the eye.
    pub fn project(&self, p: Vec3) -> Option<Vec2> {
        let d = p - self.eye;
        let depth = -d.dot(self.back);
        if depth <= 0.0 && self.distance.is_none() {
            return None;
        }
        let h = self.distance.unwrap_or(depth) * self.tan;
        let (x, y) = (d.dot(self.right), d.dot(self.up));
        Some(Vec2::new(0.5 + 0.5 * x / (h * self.aspect), 0.5 - 0.5 * y / h))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projected_point_lies_on_its_own_ray() {
        for orthographic in [false, true] {
            let mut camera = Camera { orthographic, yaw: 1.1, pitch: -0.4, ..Camera::default() };
            camera.frame(Vec3::splat(-1.0), Vec3::new(2.0, 1.0, 3.0));
            for p in [Vec3::ZERO, Vec3::new(1.5, 0.5, 2.0), Vec3::new(-0.9, 0.9, -0.3)] {
                let view = camera.project(p).expect("in front of the eye");
                assert!(
                    view.cmpge(Vec2::ZERO).all() && view.cmple(Vec2::ONE).all(),
                    "framed: {view}"
                );
                let ray = camera.ray(view);
                let along = (p - ray.origin).dot(ray.dir);
                assert!((ray.origin + ray.dir * along - p).length() < 1e-3 * camera.distance);
            }
        }
    }

    #[test]
    fn what_is_under_the_cursor_stays_there() {
        for orthographic in [false, true] {
            let begun = Camera { orthographic, yaw: 0.7, pitch: 0.3, ..Camera::default() };
            for p in [Vec3::ZERO, Vec3::new(0.5, -0.3, 0.8), Vec3::new(-0.4, 0.6, -0.7)] {
                let view = begun.project(p).expect("in front of the eye");
                for factor in [0.5, 1.12, 1.8] {
                    let mut camera = begun;
                    camera.zoom_at(factor, view);
                    let now = camera.project(p).expect("in front of the eye");
                    assert!(now.distance(view) < 1e-4, "{p} by {factor}: {view} became {now}");
                    assert_eq!(camera.distance, begun.distance / factor);
                }
            }
        }
    }

    #[test]
    fn the_matrix_and_the_projection_agree() {
        let camera = Camera::default();
        let p = Vec3::new(0.2, 0.1, -0.3);
        let clip = camera.view_projection(1.0) * p.extend(1.0);
        let ndc = clip / clip.w;
        let view = camera.project(p).expect("in front");
        assert!(
            (ndc.x - (view.x * 2.0 - 1.0)).abs() < 1e-5
                && (ndc.y - (1.0 - view.y * 2.0)).abs() < 1e-5
        );
        assert!((0.0..=1.0).contains(&ndc.z));
    }
}
