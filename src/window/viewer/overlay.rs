//! Lines over the clay: the brush ring and its mirror images, pens, tracked hands.

use glam::{Vec2, Vec3};

use super::renderer::LineEnd;
use super::wall_probe::{ProbedWall, WallBall};
use crate::look::linear;
use crate::panels::check_values::RING_SHARE;
use sculptd_clay::Ray;
use sculptd_daemon::Published;
use sculptd_daemon::people::colour_of;
use sculptd_devices::Hands;
use sculptd_engine::camera::Camera;
use sculptd_engine::hand::{HeldObject, Volume};

const RING: [u8; 4] = [255, 236, 190, 255];
const CARVING: [u8; 4] = [150, 190, 255, 255];
const MIRRORED: [u8; 4] = [150, 205, 255, 190];
const HELD: [u8; 4] = [255, 214, 140, 110];
const BONE: [u8; 4] = [190, 225, 255, 200];
/// Of a marked finding: the colours, and the opacity behind a surface.
const MARK: [u8; 4] = [255, 190, 20, 255];
/// The ray of the wall under the pointer.
const PROBE: [u8; 4] = [255, 255, 255, 255];
/// The ball in that wall.
const BALL: [u8; 4] = [120, 220, 255, 255];
const DARK: [u8; 4] = [4, 2, 2, 255];
const MARK_THROUGH: f32 = 0.45;
/// Corners of a ring: smooth to the eye at any size.
const CORNERS: usize = 72;

fn segment(out: &mut Vec<LineEnd>, a: Vec3, b: Vec3, colour: [u8; 4]) {
    out.push(LineEnd::new(a, colour));
    out.push(LineEnd::new(b, colour));
}

/// Appearance of a ring.
#[derive(Debug, Clone, Copy)]
pub struct Ring {
    /// Mesh units.
    pub radius: f32,
    /// The brush takes clay away.
    pub carve: bool,
    pub mirrored: bool,
    /// The pen touches; before contact the ring is fainter.
    pub down: bool,
    /// Colour of another person, if the ring is theirs; `None`: it is the local person's.
    pub of: Option<[u8; 3]>,
}

/// A circle of the brush's true radius about `centre`, laid on the surface: each corner is dropped
/// along the normal onto the clay. Where there is none within reach, past an edge or over a hole,
/// the circle goes on evenly between the corners beside the gap.
pub fn ring(out: &mut Vec<LineEnd>, state: &Published, centre: Vec3, normal: Vec3, ring: &Ring) {
    let radius = ring.radius;
    let mut colour = match (ring.of, ring.mirrored, ring.carve) {
        (Some(colour), ..) => of_person(colour, 255),
        (None, true, _) => MIRRORED,
        (None, false, true) => CARVING,
        (None, false, false) => RING,
    };
    if !ring.down {
        colour[3] = colour[3] / 4 * 3;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let flat = |i: usize| {
        let (s, c) = (i as f32 / CORNERS as f32 * std::f32::consts::TAU).sin_cos();
        centre + (u * c + v * s) * radius
    };
    let found = std::array::from_fn(|i| {
        let above = Ray { origin: flat(i) + normal * radius, dir: -normal };
        let height = state.pick(above).map(|hit| radius - hit.t)?;
        (height.abs() < 0.6 * radius).then_some(height)
    });
    let heights = even_heights(&found);
    let corner = |i: usize| flat(i) + normal * (heights[i % CORNERS] + radius * 0.01);
    let mut last = corner(0);
    for i in 1..=CORNERS {
        let next = corner(i);
        segment(out, last, next, colour);
        last = next;
    }
    segment(out, centre, centre + normal * radius * 0.4, colour);
}

/// The colour of a person as lines have it: light adds up linearly where they are drawn.
fn of_person(colour: [u8; 3], alpha: u8) -> [u8; 4] {
    let [r, g, b, _] = linear(colour).map(|c| (c * 255.0).round() as u8);
    [r, g, b, alpha]
}

/// The rings of the others who share the sculpture, each in the colour of its person.
pub fn others(out: &mut Vec<LineEnd>, state: &Published) {
    for pen in state.others.iter().flatten() {
        let ring = Ring {
            radius: pen.radius,
            carve: pen.carves,
            mirrored: false,
            down: pen.down,
            of: Some(colour_of(pen.person)),
        };
        self::ring(out, state, pen.position, pen.normal, &ring);
    }
}

/// The heights of a ring's corners over its plane, without a jump: gaps are bridged from corner to
/// corner, and what stands out between two steps of relief is rounded off. All 0 where nothing was
/// found.
fn even_heights(found: &[Option<f32>; CORNERS]) -> [f32; CORNERS] {
    let next = |from: usize| (1..=CORNERS).find_map(|k| Some((k, found[(from + k) % CORNERS]?)));
    let before =
        |from: usize| (1..=CORNERS).find_map(|k| Some((k, found[(from + CORNERS - k) % CORNERS]?)));
    let mut heights: [f32; CORNERS] = std::array::from_fn(|i| {
        let bridged = || {
            let ((a, low), (b, high)) = (before(i)?, next(i)?);
            Some(low + (high - low) * (a as f32 / (a + b) as f32))
        };
        found[i].or_else(bridged).unwrap_or_default()
    });
    for _ in 0..2 {
        let rough = heights;
        heights = std::array::from_fn(|i| {
            let [a, b] = [rough[(i + CORNERS - 1) % CORNERS], rough[(i + 1) % CORNERS]];
            0.5 * rough[i] + 0.25 * (a + b)
        });
    }
    heights
}

/// The pen itself as it leans: from its tip along its barrel. `tilt` in radians, x to the right and
/// y towards the person.
pub fn barrel(out: &mut Vec<LineEnd>, camera: &Camera, tip: Vec3, tilt: Vec2, radius: f32) {
    let (right, up) = camera.axes();
    let along = camera.backward() + right * tilt.x.clamp(-1.4, 1.4).tan()
        - up * tilt.y.clamp(-1.4, 1.4).tan();
    segment(out, tip, tip + along.normalize_or_zero() * radius * 2.0, BONE);
}

/// The floor: squares of a round number of units, ten times as far as the object is wide at most.
pub fn grid(out: &mut Vec<LineEnd>, middle: Vec3, floor: f32, extent: f32, pale: bool) {
    const HALF: i32 = 10;
    let step = 10f32.powf((extent * 0.3).max(1e-30).log10().floor());
    let step = if extent * 0.3 / step >= 5.0 {
        step * 5.0
    } else if extent * 0.3 / step >= 2.0 {
        step * 2.0
    } else {
        step
    };
    let centre = (middle / step).round() * step;
    let ink = if pale { 60 } else { 190 };
    let reach = HALF as f32 * step;
    for i in -HALF..=HALF {
        let at = i as f32 * step;
        for (from, to, axis) in [
            (Vec3::new(at, 0.0, -reach), Vec3::new(at, 0.0, reach), centre.x + at),
            (Vec3::new(-reach, 0.0, at), Vec3::new(reach, 0.0, at), centre.z + at),
        ] {
            let colour = match (axis.abs() < step * 0.01, from.x == to.x) {
                (true, true) => [70, 110, 210, 190],
                (true, false) => [200, 70, 70, 190],
                _ => [ink, ink, ink, 70],
            };
            let base = Vec3::new(centre.x, floor, centre.z);
            segment(out, base + from, base + to, colour);
        }
    }
}

/// A ring around a place that a check has found, as large in every view, with four strokes that
/// point at the place. Behind a surface it is faint.
pub fn finding_mark(out: &mut Vec<LineEnd>, camera: &Camera, place: Vec3) {
    let (right, up) = camera.axes();
    let depth = (camera.eye() - place).dot(camera.backward());
    let radius = camera.world_per_view(depth) * RING_SHARE;
    let at = |angle: f32, far: f32| {
        let (s, c) = angle.sin_cos();
        place + (right * c + up * s) * far
    };
    let mut line = |a: Vec3, b: Vec3, colour: [u8; 4]| {
        let end = |p| LineEnd { through: MARK_THROUGH, ..LineEnd::new(p, colour) };
        out.extend([end(a), end(b)]);
    };
    let turn = std::f32::consts::TAU;
    // Lines are a pixel wide. Several beside each other are seen, and a dark and a pale one on any
    // clay.
    for (share, colour) in [(0.92, DARK), (0.96, MARK), (1.0, MARK), (1.04, MARK), (1.08, DARK)] {
        for i in 0..CORNERS {
            let [a, b] = [i, i + 1].map(|i| at(i as f32 / CORNERS as f32 * turn, share * radius));
            line(a, b, colour);
        }
    }
    for quarter in 0..4 {
        let angle = quarter as f32 * 0.25 * turn;
        line(at(angle, radius * 0.25), at(angle, radius * 1.4), MARK);
    }
}

/// The ray through a wall, with a cross on the side where it leaves; seen through the clay.
pub fn wall(out: &mut Vec<LineEnd>, wall: &ProbedWall) {
    let far = wall.place - wall.normal * wall.thickness;
    let (u, v) = wall.opposite.any_orthonormal_pair();
    let arm = 0.25 * wall.thickness;
    let lines = [(wall.place, far), (far - u * arm, far + u * arm), (far - v * arm, far + v * arm)];
    for (a, b) in lines {
        out.extend([a, b].map(|p| LineEnd { through: 1.0, ..LineEnd::new(p, PROBE) }));
    }
}

/// The largest ball in a wall: its outline and two circles through the places that it touches.
pub fn ball(out: &mut Vec<LineEnd>, camera: &Camera, ball: &WallBall) {
    let radius = 0.5 * ball.diameter;
    let centre = ball.place - ball.normal * radius;
    let view = (camera.eye() - centre).normalize_or(camera.backward());
    let (u, v) = ball.normal.any_orthonormal_pair();
    let (right, up) = view.any_orthonormal_pair();
    for (x, y) in [(right, up), (ball.normal, u), (ball.normal, v)] {
        let at = |i: usize| {
            let (s, c) = (i as f32 / CORNERS as f32 * std::f32::consts::TAU).sin_cos();
            centre + (x * c + y * s) * radius
        };
        for i in 0..CORNERS {
            out.extend(
                [at(i), at(i + 1)].map(|p| LineEnd { through: 1.0, ..LineEnd::new(p, BALL) }),
            );
        }
    }
}

/// A hand's bones, in the world. `of`: the colour of another person, whose hands they are.
pub fn hands(out: &mut Vec<LineEnd>, hands: &Hands, volume: &Volume, of: Option<[u8; 3]>) {
    let bone = of.map_or(BONE, |colour| of_person(colour, BONE[3]));
    for hand in hands.as_slice() {
        let mut knuckles: Vec<Vec3> = Vec::with_capacity(5);
        for finger in hand.fingers.iter().flatten() {
            let joints = finger.joints.iter().flatten().copied().chain([finger.tip]);
            let mut last: Option<Vec3> = None;
            for mm in joints {
                let p = volume.to_world(mm);
                if let Some(last) = last {
                    segment(out, last, p, bone);
                }
                last = Some(p);
            }
            if let Some(knuckle) = finger.joints[1].or(finger.joints[2]) {
                knuckles.push(volume.to_world(knuckle));
            }
            diamond(out, volume.to_world(finger.tip), 5.0 * volume.scale);
        }
        for pair in knuckles.windows(2) {
            segment(out, pair[0], pair[1], bone);
        }
        if let (Some(wrist), Some(first), Some(last)) =
            (hand.wrist, knuckles.first(), knuckles.last())
        {
            segment(out, volume.to_world(wrist), *first, bone);
            segment(out, volume.to_world(wrist), *last, bone);
        }
    }
}

/// A held object as its edges: what it would cut shows through it.
pub fn held_object(out: &mut Vec<LineEnd>, thing: &HeldObject) {
    // Of a large one, some: it is its place that counts.
    const MOST: usize = 2600;
    let triangles = &thing.plain.triangles;
    let step = triangles.len().div_ceil(MOST).max(1);
    for t in triangles.iter().step_by(step) {
        let [a, b, c] = t.map(|v| thing.place.apply(thing.plain.positions[v as usize]));
        for (from, to, lower) in [(a, b, t[0] < t[1]), (b, c, t[1] < t[2]), (c, a, t[2] < t[0])] {
            if lower || step > 1 {
                segment(out, from, to, HELD);
            }
        }
    }
}

fn diamond(out: &mut Vec<LineEnd>, p: Vec3, r: f32) {
    let corners = [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y].map(|d| p + d * r);
    for i in 0..4 {
        segment(out, corners[i], corners[(i + 1) % 4], BONE);
        segment(out, corners[i], p + Vec3::Z * r, BONE);
    }
}

/// A view point from a pointer's place in a window.
pub fn view_point(at: Vec2, size: Vec2) -> Vec2 {
    at / size.max(Vec2::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_bridges_a_gap_evenly_and_lies_flat_over_nothing() {
        assert_eq!(even_heights(&[None; CORNERS]), [0.0; CORNERS]);
        // Half of the ring is over a slope, the other half hangs over an edge.
        let found = std::array::from_fn(|i| (i < CORNERS / 2).then_some(0.01 * i as f32));
        let heights = even_heights(&found);
        let steps = (0..CORNERS).map(|i| (heights[(i + 1) % CORNERS] - heights[i]).abs());
        assert!(steps.fold(0.0, f32::max) < 0.011, "{heights:?}");
        assert!((heights[CORNERS / 4] - 0.01 * (CORNERS / 4) as f32).abs() < 1e-6);
        let alone = even_heights(&std::array::from_fn(|i| (i == 5).then_some(0.3)));
        assert!(alone.iter().all(|h| (h - 0.3).abs() < 1e-6), "{alone:?}");
    }
}
