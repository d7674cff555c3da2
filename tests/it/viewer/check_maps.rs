//! Maps of overhang and draft: each face on its side of the limit, wherever the object stands, and
//! at once after a dab.

use glam::{DQuat, DVec3, Vec3};
use image::RgbaImage;
use sculptd_clay::{Clay, Snapshot};
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;
use sculptd_window::look::{AngleMap, Look, Map, linear};
use sculptd_window::viewer::objects::Stance;
use sculptd_window::viewer::picture::Painter;
use sculptd_window::viewer::renderer::{Beside, Scene};

use super::pictures::{dab, framed, painter};
use crate::clay::sphere;

const SIZE: u32 = 240;
/// Matt, so that a highlight does not whiten a colour.
const STONE: usize = 3;

fn look(map: Map, angles: AngleMap) -> Look {
    Look { map, angles, material: STONE, shade: 0.0, ..Look::default() }
}

fn drawn(
    painter: &mut Painter,
    mesh: &Snapshot,
    camera: &Camera,
    look: Look,
    transform: ObjectTransform,
) -> RgbaImage {
    let beside = Beside { stance: Stance { transform, ..Stance::default() }, ..Beside::default() };
    let scene = Scene { mesh, camera, brush: None, lines: &[], look, values: None, beside };
    painter.paint(&scene, SIZE, SIZE).expect("a picture")
}

/// Returns true where a pixel has a colour from beyond the limit: these have next to no blue.
fn is_beyond(p: &RgbaImage, x: u32, y: u32) -> bool {
    let c = p.get_pixel(x, y).0;
    let [red, _, blue, _] = linear([c[0], c[1], c[2]]);
    blue < 0.25 * red
}

/// A square of two triangles with this normal, and a camera straight before it.
fn square(normal: Vec3) -> (Clay, Camera) {
    let (u, v) = normal.any_orthonormal_pair();
    let positions = vec![-u - v, u - v, u + v, -u + v];
    let mut triangles = vec![[0u32, 1, 2], [0, 2, 3]];
    if u.cross(v).dot(normal) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let mesh = TriMesh { positions, triangles, ..TriMesh::default() };
    let clay = Clay::build(&mesh, &Job::default()).expect("builds");
    let mut camera = framed(&clay, 1.0);
    (camera.yaw, camera.pitch) = (normal.x.atan2(normal.z), normal.y.asin());
    (clay, camera)
}

#[test]
fn a_tilted_plane_is_on_its_side_of_the_limit() {
    let Some(mut painter) = painter() else { return };
    let mut beyond = |map: Map, limit: f32, angle: f32, around: f32| {
        // The angle of the face above the horizon; below 0 it looks down.
        let (sine, cosine) = angle.to_radians().sin_cos();
        let (x, z) = around.to_radians().sin_cos();
        let normal = Vec3::new(cosine * x, sine, cosine * z);
        let (mut clay, camera) = square(normal);
        let angles = AngleMap { limit, ..AngleMap::default() };
        let none = ObjectTransform::NONE;
        let picture = drawn(&mut painter, &clay.snapshot(), &camera, look(map, angles), none);
        let all = [(120, 120), (100, 100), (140, 110), (110, 140)].map(|(x, y)| {
            assert_ne!(picture.get_pixel(x, y), picture.get_pixel(2, 2), "the square is there");
            is_beyond(&picture, x, y)
        });
        assert!(all.iter().all(|a| *a == all[0]), "one face, one side");
        all[0]
    };
    for around in [0.0, 37.0, 200.0] {
        for limit in [30.0f32, 45.0, 70.0] {
            assert!(!beyond(Map::Overhang, limit, -(limit - 0.1), around), "{limit}");
            // A tie passes.
            assert!(!beyond(Map::Overhang, limit, -limit, around), "{limit}");
            assert!(beyond(Map::Overhang, limit, -(limit + 0.1), around), "{limit}");
            assert!(!beyond(Map::Overhang, limit, limit + 0.1, around), "it looks up");
        }
        for limit in [1.0f32, 3.0] {
            for side in [-1.0, 1.0] {
                assert!(beyond(Map::Draft, limit, side * (limit - 0.1), around), "{limit}");
                assert!(!beyond(Map::Draft, limit, side * limit, around), "{limit}");
                assert!(!beyond(Map::Draft, limit, side * (limit + 0.1), around), "{limit}");
            }
        }
    }
}

#[test]
fn a_ball_is_coloured_by_its_own_angle_in_every_direction_and_stance() {
    let Some(mut painter) = painter() else { return };
    let mut mesh = sphere(40_000);
    let snapshot = mesh.snapshot();
    let turned = ObjectTransform {
        shift: DVec3::new(30.0, -4.0, 7.0),
        turn: DQuat::from_rotation_x(1.1) * DQuat::from_rotation_z(-0.7),
        scale: 3.0,
    };
    for transform in [ObjectTransform::NONE, turned] {
        for up in [Vec3::Y, Vec3::NEG_Z, Vec3::new(0.48, -0.6, 0.64)] {
            for (map, limit) in [(Map::Overhang, 45.0f32), (Map::Draft, 10.0)] {
                let (lo, hi) = transform.bounds(snapshot.bounds());
                let mut camera = Camera { aspect: 1.0, ..Camera::default() };
                // From a side on which both colours are.
                let side = (up.any_orthonormal_vector() - up * 0.4).normalize();
                (camera.yaw, camera.pitch) = (side.x.atan2(side.z), side.y.asin());
                camera.frame(lo, hi);
                let angles = AngleMap { up: up.to_array(), limit, plate: None };
                let picture = drawn(&mut painter, &snapshot, &camera, look(map, angles), transform);
                let (mut seen, mut wrong, mut sides) = (0, 0, [0; 2]);
                let (middle, radius) = (transform.shift.as_vec3(), transform.scale as f32);
                for y in (0..SIZE).step_by(3) {
                    for x in (0..SIZE).step_by(3) {
                        let at = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / SIZE as f32;
                        let ray = camera.ray(at);
                        let near = (middle - ray.origin).dot(ray.dir);
                        let off = (ray.origin + ray.dir * near - middle).length() / radius;
                        // Not at the outline.
                        if off > 0.95 {
                            continue;
                        }
                        let t = near - radius * (1.0 - off * off).sqrt();
                        let normal = (ray.origin + ray.dir * t - middle).normalize();
                        let rise = normal.dot(up);
                        let angle = if map == Map::Overhang { -rise } else { rise.abs() };
                        let angle = angle.asin().to_degrees();
                        // A facet is up to a degree off the ball.
                        if (angle - limit).abs() < 1.5 {
                            continue;
                        }
                        let beyond = (angle > limit) == (map == Map::Overhang);
                        seen += 1;
                        sides[usize::from(beyond)] += 1;
                        wrong += u32::from(is_beyond(&picture, x, y) != beyond);
                    }
                }
                println!("{map:?} along {up}: {seen} places, {sides:?} within and beyond");
                assert!(wrong == 0 && sides.iter().all(|n| *n > 20), "{map:?}: {wrong} of {seen}");
            }
        }
    }
}

#[test]
fn faces_of_a_box_have_their_own_angles_and_the_plate_needs_no_support() {
    let Some(mut painter) = painter() else { return };
    let profile: Vec<Vec3> = (0..8u32)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32))
        .collect();
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let mesh = TriMesh { positions: profile, triangles, ..TriMesh::default() };
    let mut clay = Clay::build(&mesh, &Job::default()).expect("builds");
    let camera = Camera { yaw: 0.4, pitch: -0.6, ..framed(&clay, 1.0) };
    let pixel = |p: Vec3| {
        let at = camera.project(p).expect("before the eye") * SIZE as f32;
        (at.x as u32, at.y as u32)
    };
    for plate in [None, Some(0.001)] {
        let angles = AngleMap { plate, ..AngleMap::default() };
        let look = look(Map::Overhang, angles);
        let picture = drawn(&mut painter, &clay.snapshot(), &camera, look, ObjectTransform::NONE);
        // All over the bottom, and all over the front, near their edges too.
        for u in [0.1f32, 0.5, 0.9] {
            for v in [0.1f32, 0.5, 0.9] {
                let (x, y) = pixel(Vec3::new(u, 0.0, v));
                assert_eq!(is_beyond(&picture, x, y), plate.is_none(), "bottom at {u} {v}");
                let (x, y) = pixel(Vec3::new(u, v, 1.0));
                assert!(!is_beyond(&picture, x, y), "front at {u} {v}");
            }
        }
    }
}

#[test]
fn a_map_of_angles_follows_a_dab_at_once_and_sends_nothing_for_it() {
    let Some(mut painter) = painter() else { return };
    let camera = framed(&sphere(1_000), 1.0);
    // Where the dab is, the ball looks straight down; the flanks of what is raised do not.
    let down = Vec3::new(0.3, 0.5, 0.8).normalize();
    let camera = Camera { yaw: down.x.atan2(down.z), pitch: down.y.asin(), ..camera };
    let angles = AngleMap { up: (-down).to_array(), limit: 60.0, plate: None };
    let on = look(Map::Overhang, angles);
    let mut sent = Vec::new();
    for look in [on, Look { map: Map::None, ..on }] {
        // The same strokes on the same ball, each time to a renderer that has the ball.
        let mut mesh = sphere(100_000);
        let mut draw = |mesh: &mut Clay| {
            let none = ObjectTransform::NONE;
            let picture = drawn(&mut painter, &mesh.snapshot(), &camera, look, none);
            let all = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
            let beyond = all.filter(|(x, y)| is_beyond(&picture, *x, *y)).count();
            (beyond, painter.renderer().uploaded)
        };
        let (before, _) = draw(&mut mesh);
        for _ in 0..3 {
            dab(&mut mesh, 0.2);
        }
        let (after, bytes) = draw(&mut mesh);
        if look.map == Map::Overhang {
            println!("{after} pixels beyond the limit, {before} before the dabs");
            assert!(before > 1_000 && after + 100 < before, "{before} {after}");
        }
        assert_eq!(draw(&mut mesh).1, 0, "nothing changed");
        sent.push(bytes);
    }
    assert!(sent[0] > 0 && sent[0] == sent[1], "with and without the map: {sent:?}");
}
