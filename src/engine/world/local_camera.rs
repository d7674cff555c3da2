//! The camera as the active object's own frame sees it.
//!
//! Strokes are made in the frame of the object: rays and directions are carried into it, and
//! lengths with them. An object that stands where it is sees the camera itself, to the bit.

use glam::{Mat3, Vec2, Vec3};

use crate::camera::Camera;
use crate::scene::ObjectTransform;
use sculptd_clay::Ray;
use sculptd_clay::brush::stamp::Lens;

/// A camera seen from an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalCamera<'a> {
    camera: &'a Camera,
    /// From the world to the object; `None` where they are the same.
    own: Option<ObjectTransform>,
}

impl<'a> LocalCamera<'a> {
    /// `transform`: from the object to the world.
    pub(super) fn new(camera: &'a Camera, transform: &ObjectTransform) -> Self {
        let own = (!transform.is_none()).then(|| transform.inverse());
        LocalCamera { camera, own }
    }

    /// Width over height of the view.
    pub(super) fn aspect(&self) -> f32 {
        self.camera.aspect
    }

    fn direction(&self, d: Vec3) -> Vec3 {
        self.own.map_or(d, |own| own.direction(d))
    }

    /// As [`Camera::ray`].
    pub(super) fn ray(&self, view: Vec2) -> Ray {
        let ray = self.camera.ray(view);
        let Some(own) = self.own else { return ray };
        let ray = own.ray(ray);
        Ray { dir: ray.dir.normalize(), ..ray }
    }

    /// As [`Camera::axes`].
    pub(super) fn axes(&self) -> (Vec3, Vec3) {
        let (right, up) = self.camera.axes();
        (self.direction(right), self.direction(up))
    }

    /// As [`Camera::backward`].
    pub(super) fn backward(&self) -> Vec3 {
        self.direction(self.camera.backward())
    }

    /// As [`Camera::eye`].
    pub(super) fn eye(&self) -> Vec3 {
        let eye = self.camera.eye();
        self.own.map_or(eye, |own| own.point(eye))
    }

    /// As [`Camera::lens`].
    pub(super) fn lens(&self) -> Lens {
        let lens = self.camera.lens();
        let Some(own) = self.own else { return lens };
        let m = Mat3::from_quat(own.turn.as_quat());
        let seen = Lens { eye: Vec3::ZERO, ..lens }.image(m, own.point(lens.eye));
        // Without perspective it is a length.
        let half = if lens.parallel { lens.half * own.scale as f32 } else { lens.half };
        Lens { half, ..seen }
    }

    /// The object's length of a step of one whole view height at `depth`, in the object's unit,
    /// before the eye.
    pub(super) fn world_per_view(&self, depth: f32) -> f32 {
        let Some(own) = self.own else { return self.camera.world_per_view(depth) };
        let scale = own.scale as f32;
        self.camera.world_per_view(depth / scale) * scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    #[test]
    fn a_place_is_seen_alike_from_the_world_and_from_the_object() {
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.1);
        let to_world = ObjectTransform { shift: DVec3::new(5.0, -2.0, 3.0), turn, scale: 2.5 };
        for orthographic in [false, true] {
            let camera = Camera { orthographic, ..Camera::default() };
            let local = LocalCamera::new(&camera, &to_world);
            for view in [Vec2::new(0.2, 0.7), Vec2::splat(0.5), Vec2::new(0.9, 0.1)] {
                let (ray, own) = (camera.ray(view), local.ray(view));
                let p = ray.origin + ray.dir * 2.0;
                let q = to_world.point(own.origin + own.dir * (2.0 / 2.5));
                assert!((p - q).length() < 1e-4, "{p} {q}");
                let depth = (camera.eye() - p).dot(camera.backward());
                let at = own.origin + own.dir * (2.0 / 2.5);
                let own_depth = (local.eye() - at).dot(local.backward());
                assert!((own_depth * 2.5 - depth).abs() < 1e-4);
                let (a, b) = (camera.world_per_view(depth), local.world_per_view(own_depth) * 2.5);
                assert!((a - b).abs() < 1e-4 * a, "{a} {b}");
                let (seen, own_seen) = (camera.lens().seen(p), local.lens().seen(at));
                let (seen, own_seen) = (seen.expect("before"), own_seen.expect("before"));
                assert!((seen - own_seen).length() < 1e-4, "{seen} {own_seen}");
            }
        }
    }
}
