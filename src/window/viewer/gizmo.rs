//! The gizmo of the active object: three axes to move it along, three circles to turn it about, and
//! a corner to scale it, drawn as lines in the world and dragged by the pointer.
//!
//! A drag is one step of undo: the transform is sent when the button is released. With the snapping
//! key down, places fall on a grid, turns on whole steps of an angle, and scales on tenths. All
//! numbers are in double precision.

use glam::{DQuat, DVec3, Vec2, Vec3};

use super::renderer::LineEnd;
use sculptd_clay::Ray;
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::{ObjectTransform, ObjectView};

/// Part of the gizmo that is dragged. Axes: 0 x, 1 y, 2 z of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GizmoHandle {
    /// Along an axis.
    Move(usize),
    /// About an axis.
    Turn(usize),
    /// Larger and smaller about the middle.
    Scale,
}

/// Steps that a drag falls on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GizmoSteps {
    /// World units.
    pub grid: f64,
    /// Radians.
    pub angle: f64,
    /// Of the scale.
    pub scale: f64,
}

impl GizmoSteps {
    /// A twentieth of an object of this size, as a round number (1, 2 or 5 times a power of ten);
    /// 15 degrees; a tenth.
    pub fn of(extent: f64) -> GizmoSteps {
        let wanted = (extent * 0.05).max(1e-9);
        let power = 10f64.powf(wanted.log10().floor());
        let factor = [5.0, 2.0, 1.0].into_iter().find(|f| f * power <= wanted * 1.000_001);
        GizmoSteps { grid: factor.unwrap_or(1.0) * power, angle: 15f64.to_radians(), scale: 0.1 }
    }
}

/// A drag that has begun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GizmoDrag {
    pub handle: GizmoHandle,
    /// The ray of the press.
    pub from: Ray,
    /// Transform of the object at the start.
    pub before: ObjectTransform,
    /// Transform of the object if the button were released now.
    pub now: ObjectTransform,
}

/// Position and size of the gizmo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gizmo {
    /// The middle of the object, in the world.
    pub centre: DVec3,
    /// The length of an axis, world units: the same on the screen from near and far.
    pub size: f64,
}

const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];
const COLOURS: [[u8; 4]; 3] = [[235, 90, 80, 255], [120, 205, 90, 255], [90, 150, 245, 255]];
const SCALING: [u8; 4] = [235, 235, 235, 255];
const HOT: [u8; 4] = [255, 220, 120, 255];
/// The length of an axis as a share of the view's height.
const SHARE: f64 = 0.16;
/// The radius of the circles, and where the corner for scaling is, in lengths of an axis.
const RING: f64 = 0.75;
const CORNER: f64 = 0.45;
/// Distance at which the pointer hits a handle, in view heights.
const REACH: f32 = 0.018;
const CORNERS: usize = 48;
/// Opacity of the gizmo behind other surfaces, so that it can be used inside a larger object.
const THROUGH: f32 = 0.55;

impl Gizmo {
    /// Returns the gizmo of an object with this `transform`.
    pub fn of(object: &ObjectView, transform: &ObjectTransform, camera: &Camera) -> Gizmo {
        let centre = transform.apply(object.middle.as_dvec3());
        let depth = (camera.eye() - centre.as_vec3()).dot(camera.backward());
        let view = f64::from(camera.world_per_view(depth.max(1e-6)));
        Gizmo { centre, size: view * SHARE }
    }

    fn ring(&self, axis: usize) -> impl Iterator<Item = Vec3> {
        let (u, v) = (AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]);
        let (centre, radius) = (self.centre, self.size * RING);
        (0..=CORNERS).map(move |i| {
            let (s, c) = (i as f64 / CORNERS as f64 * std::f64::consts::TAU).sin_cos();
            (centre + (u * c + v * s) * radius).as_vec3()
        })
    }

    /// The corner that scales, and the line to it.
    fn corner(&self) -> Vec3 {
        (self.centre + DVec3::splat(self.size * CORNER)).as_vec3()
    }

    /// The lines of each handle.
    fn strokes(&self) -> Vec<(GizmoHandle, Vec<Vec3>)> {
        let centre = self.centre.as_vec3();
        let mut out = vec![(GizmoHandle::Scale, vec![centre, self.corner()])];
        for axis in 0..3 {
            let end = (self.centre + AXES[axis] * self.size).as_vec3();
            out.push((GizmoHandle::Move(axis), vec![centre, end]));
            out.push((GizmoHandle::Turn(axis), self.ring(axis).collect()));
        }
        out
    }

    /// Adds its lines; `hot`: the handle under the pointer or in hand.
    pub fn lines(&self, out: &mut Vec<LineEnd>, hot: Option<GizmoHandle>) {
        for (handle, points) in self.strokes() {
            let colour = match handle {
                _ if hot == Some(handle) => HOT,
                GizmoHandle::Move(axis) | GizmoHandle::Turn(axis) => COLOURS[axis],
                GizmoHandle::Scale => SCALING,
            };
            for pair in points.windows(2) {
                out.extend(
                    pair.iter().map(|p| LineEnd { through: THROUGH, ..LineEnd::new(*p, colour) }),
                );
            }
        }
        // The corner as a small cross, the ends of the axes as arrows.
        let tip = self.size as f32 * 0.06;
        let mut cross = |p: Vec3, colour| {
            for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                let ends = [p - axis * tip, p + axis * tip];
                out.extend(ends.map(|p| LineEnd { through: THROUGH, ..LineEnd::new(p, colour) }));
            }
        };
        cross(self.corner(), SCALING);
        for axis in 0..3 {
            cross((self.centre + AXES[axis] * self.size).as_vec3(), COLOURS[axis]);
        }
    }

    /// The handle at a place in the view, the nearest of those in reach.
    pub fn handle_at(&self, camera: &Camera, view: Vec2) -> Option<GizmoHandle> {
        let flat = |p: Vec2| Vec2::new(p.x * camera.aspect, p.y);
        let at = flat(view);
        let mut best: Option<(f32, GizmoHandle)> = None;
        for (handle, points) in self.strokes() {
            for pair in points.windows(2) {
                let (Some(a), Some(b)) = (camera.project(pair[0]), camera.project(pair[1])) else {
                    continue;
                };
                let (a, b) = (flat(a), flat(b));
                let way = b - a;
                let t = ((at - a).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
                // All lines but the circles begin in the middle, which is nobody's.
                if !matches!(handle, GizmoHandle::Turn(_)) && t < 0.25 {
                    continue;
                }
                let off = (a + way * t).distance(at);
                if off < REACH && best.is_none_or(|(least, _)| off < least) {
                    best = Some((off, handle));
                }
            }
        }
        best.map(|(_, handle)| handle)
    }

    /// Returns the transform of the object after a drag from one ray to another. Returns `None` if
    /// the handle is seen too flat to decide.
    pub fn drag(
        &self,
        handle: GizmoHandle,
        before: &ObjectTransform,
        from: Ray,
        to: Ray,
        steps: Option<GizmoSteps>,
    ) -> Option<ObjectTransform> {
        let moved = match handle {
            GizmoHandle::Move(axis) => {
                let way = self.along(axis, to)? - self.along(axis, from)?;
                let mut shift = before.shift;
                shift[axis] += way;
                if let Some(steps) = steps {
                    shift[axis] = (shift[axis] / steps.grid).round() * steps.grid;
                }
                ObjectTransform { shift, ..*before }
            }
            GizmoHandle::Turn(axis) => {
                let (a, b) = (self.spoke(axis, from)?, self.spoke(axis, to)?);
                let mut angle = a.cross(b).dot(AXES[axis]).atan2(a.dot(b));
                if let Some(steps) = steps {
                    angle = (angle / steps.angle).round() * steps.angle;
                }
                let turn = DQuat::from_axis_angle(AXES[axis], angle);
                let shift = self.centre + turn * (before.shift - self.centre);
                ObjectTransform { shift, turn: (turn * before.turn).normalize(), ..*before }
            }
            GizmoHandle::Scale => {
                let normal = -from.dir.as_dvec3().normalize();
                let off = |ray| self.intersect(normal, ray).map(|p| (p - self.centre).length());
                let (a, b) = (off(from)?, off(to)?);
                let mut scale = before.scale * b / a.max(self.size * 1e-3);
                if let Some(steps) = steps {
                    scale = (scale / steps.scale).round().max(1.0) * steps.scale;
                }
                let shift = self.centre + (before.shift - self.centre) * (scale / before.scale);
                ObjectTransform { shift, scale, ..*before }
            }
        };
        moved.is_sane().then_some(moved)
    }

    /// Returns the position along an axis through the middle that is nearest to a ray.
    fn along(&self, axis: usize, ray: Ray) -> Option<f64> {
        let (axis, dir) = (AXES[axis], ray.dir.as_dvec3().normalize());
        let between = ray.origin.as_dvec3() - self.centre;
        let lean = axis.dot(dir);
        let steep = 1.0 - lean * lean;
        (steep > 1e-6).then(|| (between.dot(axis) - between.dot(dir) * lean) / steep)
    }

    /// Returns the point where a ray meets the plane through the middle.
    fn intersect(&self, normal: DVec3, ray: Ray) -> Option<DVec3> {
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let fall = dir.dot(normal);
        (fall.abs() > 1e-4 * dir.length())
            .then(|| origin + dir * ((self.centre - origin).dot(normal) / fall))
    }

    /// From the middle to where a ray meets the plane of a circle.
    fn spoke(&self, axis: usize, ray: Ray) -> Option<DVec3> {
        (self.intersect(AXES[axis], ray)? - self.centre).try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera { yaw: 0.5, pitch: 0.4, distance: 12.0, aspect: 1.5, ..Camera::default() }
    }

    fn gizmo() -> Gizmo {
        Gizmo { centre: DVec3::new(1.0, 0.5, -0.5), size: 2.0 }
    }

    /// The ray of the view through a point of the world.
    fn through(p: DVec3) -> Ray {
        camera().ray(camera().project(p.as_vec3()).expect("before the eye"))
    }

    fn before() -> ObjectTransform {
        let turn = DQuat::from_rotation_z(0.3);
        ObjectTransform { shift: DVec3::new(1.2, 0.1, -0.7), turn, scale: 1.5 }
    }

    #[test]
    fn each_handle_is_found_where_it_is_drawn_and_nothing_in_the_middle() {
        let (g, camera) = (gizmo(), camera());
        let at = |p: Vec3| g.handle_at(&camera, camera.project(p).expect("before the eye"));
        for axis in 0..3 {
            let end = (g.centre + AXES[axis] * g.size * 0.95).as_vec3();
            assert_eq!(at(end), Some(GizmoHandle::Move(axis)));
            let half = g.ring(axis).nth(CORNERS / 8 * 5).expect("a corner");
            assert_eq!(at(half), Some(GizmoHandle::Turn(axis)));
        }
        assert_eq!(at(g.corner()), Some(GizmoHandle::Scale));
        assert_eq!(at(g.centre.as_vec3()), None);
        assert_eq!(at((g.centre - DVec3::splat(3.0)).as_vec3()), None);
    }

    #[test]
    fn a_drag_goes_with_the_pointer_and_falls_on_steps() {
        let (g, before) = (gizmo(), before());
        let steps = GizmoSteps { grid: 0.5, angle: 15f64.to_radians(), scale: 0.1 };
        for axis in 0..3 {
            let end = g.centre + AXES[axis] * g.size;
            let (from, to) = (through(end), through(end + AXES[axis] * 0.7));
            let handle = GizmoHandle::Move(axis);
            let moved = g.drag(handle, &before, from, to, None).expect("seen");
            let want = before.shift + AXES[axis] * 0.7;
            assert!(moved.shift.distance(want) < 1e-4, "{} of {want}", moved.shift);
            assert_eq!((moved.turn, moved.scale), (before.turn, before.scale));
            let moved = g.drag(handle, &before, from, to, Some(steps)).expect("seen");
            assert_eq!(moved.shift[axis] % 0.5, 0.0);
            let turned = |angle: f64, steps| {
                let spoke = AXES[(axis + 1) % 3] * g.size * RING;
                let turn = DQuat::from_axis_angle(AXES[axis], angle);
                let (from, to) = (through(g.centre + spoke), through(g.centre + turn * spoke));
                g.drag(GizmoHandle::Turn(axis), &before, from, to, steps).expect("seen")
            };
            let by = |t: ObjectTransform| t.turn.angle_between(before.turn);
            assert!((by(turned(0.6, None)) - 0.6).abs() < 1e-4);
            assert!((by(turned(0.6, Some(steps))) - 30f64.to_radians()).abs() < 1e-9);
            // A rotated object keeps its distance from the middle.
            let far = |t: ObjectTransform| t.shift.distance(g.centre);
            assert!((far(turned(0.6, None)) - far(before)).abs() < 1e-12);
        }
        let corner = g.corner().as_dvec3();
        let (from, to) = (through(corner), through(g.centre + (corner - g.centre) * 2.0));
        let scaled = g.drag(GizmoHandle::Scale, &before, from, to, None).expect("seen");
        // Seen in perspective, twice as far in the world is about twice as far in the view.
        assert!((scaled.scale / before.scale - 2.0).abs() < 0.35, "{}", scaled.scale);
        let scaled = g.drag(GizmoHandle::Scale, &before, from, to, Some(steps)).expect("seen");
        assert!((scaled.scale * 10.0 - (scaled.scale * 10.0).round()).abs() < 1e-9);
    }

    #[test]
    fn steps_are_round_numbers_of_the_objects_size() {
        let grid = |extent: f64| GizmoSteps::of(extent).grid;
        for (extent, want) in [(1.0, 0.05), (60.0, 2.0), (100.0, 5.0), (0.5, 0.02), (399.0, 10.0)] {
            assert!((grid(extent) / want - 1.0).abs() < 1e-9, "{} of {want}", grid(extent));
        }
    }
}
