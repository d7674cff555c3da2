//! What lights the clay: pictures of lit balls, surroundings, a reference behind it; in pictures by
//! the renderer and by the command.

use std::path::Path;
use std::process::Command;

use glam::Vec3;
use image::{Rgba, RgbaImage};
use sculptd_engine::camera::Camera;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes;
use sculptd_window::look::{Light, Look, Map, RAISED};
use sculptd_window::viewer::environment::Environment;
use sculptd_window::viewer::objects::OtherObject;
use sculptd_window::viewer::picture::Painter;
use sculptd_window::viewer::renderer::{Beside, Scene};

use super::pictures::{framed, painter};
use crate::clay::sphere;

/// A picture of a ball from the front, bare of all that is not light.
fn ball(painter: &mut Painter, look: Look, backdrop: f32) -> RgbaImage {
    let mut mesh = sphere(20_000);
    let camera = Camera { yaw: 0.0, pitch: 0.0, ..framed(&mesh, 1.0) };
    let scene = Scene {
        mesh: &mesh.snapshot(),
        camera: &camera,
        brush: None,
        lines: &[],
        look: Look { cavity: 0.0, shade: 0.0, ..look },
        values: None,
        beside: Beside { backdrop, ..Beside::default() },
    };
    painter.paint(&scene, 200, 200).expect("a picture")
}

/// Brightness of a pixel, of 765.
fn bright(picture: &RgbaImage, x: u32, y: u32) -> i32 {
    picture.get_pixel(x, y).0[..3].iter().map(|c| i32::from(*c)).sum()
}

#[test]
fn a_picture_of_a_lit_ball_lights_the_clay_as_its_normals_look() {
    let Some(mut painter) = painter() else { return };
    let (green, red) = (Rgba([20, 200, 30, 255]), Rgba([200, 20, 30, 255]));
    let halves = RgbaImage::from_fn(64, 64, |_, y| if y < 32 { green } else { red });
    painter.set_matcap(&halves);
    let seen = ball(&mut painter, Look { light: Light::Matcap, ..Look::default() }, 0.0);
    // As stored, above and below the middle: nothing of the studio's lights is in it.
    for (y, asked) in [(70, green), (130, red)] {
        let found = seen.get_pixel(100, y).0;
        let off = found.iter().zip(asked.0).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off.is_some_and(|off| off < 6), "{found:?} for {asked:?}");
    }
}

#[test]
fn surroundings_light_the_side_that_faces_their_light() {
    let Some(mut painter) = painter() else { return };
    // A bright patch at the right, level with the eye.
    let mut sky = vec![0.05f32; 64 * 32 * 3];
    for y in 12..20 {
        for x in 44..52 {
            sky[3 * (64 * y + x)..][..3].fill(40.0);
        }
    }
    let sky = Environment::of_picture(64, 32, &sky).expect("a picture");
    painter.set_environment(&sky);
    let look = Look { light: Light::Environment, material: 1, ..Look::default() };
    let plain = ball(&mut painter, look, 0.0);
    let (left, right) = (bright(&plain, 55, 100), bright(&plain, 145, 100));
    assert!(right > left + 100, "{left} at the left, {right} at the right");
    let turned = ball(&mut painter, Look { turned: 180.0, ..look }, 0.0);
    let (left, right) = (bright(&turned, 55, 100), bright(&turned, 145, 100));
    assert!(left > right + 100, "{left} at the left, {right} at the right");
    // Metal mirrors the patch and is dark beside it; clay scatters the light.
    let steel = Look { light: Light::Environment, material: 7, ..Look::default() };
    let steel = ball(&mut painter, steel, 0.0);
    let brightest = |p: &RgbaImage| (40..160).map(|x| bright(p, x, 100)).max().unwrap_or(0);
    assert!(brightest(&steel) > 700, "{}", brightest(&steel));
    assert!(bright(&steel, 80, 100) < bright(&plain, 80, 100));
}

#[test]
fn a_reference_lies_behind_the_clay_and_nowhere_else() {
    let Some(mut painter) = painter() else { return };
    let without = ball(&mut painter, Look::default(), 0.0);
    painter.set_reference(&RgbaImage::from_pixel(80, 40, Rgba([0, 0, 255, 255])));
    let with = ball(&mut painter, Look::default(), 1.0);
    assert_eq!(with.get_pixel(100, 100), without.get_pixel(100, 100), "the clay is before it");
    assert_eq!(with.get_pixel(2, 100).0, [0, 0, 255, 255]);
    // Twice as wide as high: it is whole in the view, and above it is the ground.
    assert_eq!(with.get_pixel(2, 10), without.get_pixel(2, 10));
}

fn render(args: &[&str], folder: &Path) -> (Option<i32>, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .arg("render")
        .args(args)
        .current_dir(folder)
        .output()
        .expect("it runs");
    (out.status.code(), String::from_utf8_lossy(&out.stderr).into_owned())
}

#[test]
fn the_command_draws_by_name_by_ball_and_by_surroundings() {
    if painter().is_none() {
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    write_mesh(&at("ball.obj"), &shapes::sphere_of_about(2_000).to_poly()).expect("written");
    RgbaImage::from_pixel(8, 8, Rgba([250, 0, 0, 255])).save(at("red.png")).expect("written");
    let common = ["ball.obj", "--size", "64x64", "-o"];
    let middle = |name: &str| image::open(at(name)).expect("a PNG").to_rgba8().get_pixel(32, 32).0;
    for (name, more) in [
        ("usual.png", &[][..]),
        ("steel.png", &["--material", "steel", "--room"]),
        ("ball.png", &["--matcap", "red.png"]),
    ] {
        let args = [&common[..], &[name], more].concat();
        let (code, said) = render(&args, dir.path());
        assert_eq!(code, Some(0), "{name}: {said}");
        assert!(middle(name)[3] == 255);
    }
    let [r, g, _, _] = middle("ball.png");
    assert!(r > 200 && g < 40, "the ball's own colour, {r} {g}");
    assert_ne!(middle("usual.png"), middle("steel.png"));
    let args = [&common[..], &["none.png", "--environment", "ball.obj"]].concat();
    let (code, said) = render(&args, dir.path());
    assert_eq!(code, Some(6), "{said}");
    assert!(said.contains("ball.obj") && !at("none.png").exists(), "{said}");
    let args = [&common[..], &["none.png", "--material", "glass"]].concat();
    assert_eq!(render(&args, dir.path()).0, Some(2));
}

/// A ball from the front, and a smaller one, if `between`, on the way from the main light to it.
fn in_the_light(painter: &mut Painter, look: Look, between: bool) -> RgbaImage {
    let mut mesh = sphere(20_000);
    let clay = mesh.snapshot();
    let camera = Camera { yaw: 0.0, pitch: 0.0, ..framed(&mesh, 1.0) };
    let towards = Vec3::from(look.main_light()).as_dvec3();
    let transform = ObjectTransform { shift: towards * 1.6, scale: 0.2, ..ObjectTransform::NONE };
    let others = [OtherObject { id: 7, clay: &clay, transform }];
    let others = if between { &others[..] } else { &[] };
    let scene = Scene {
        mesh: &clay,
        camera: &camera,
        brush: None,
        lines: &[],
        look: Look { cavity: 0.0, shade: 0.0, ..look },
        values: None,
        beside: Beside { others, ..Beside::default() },
    };
    painter.paint(&scene, 300, 300).expect("a picture")
}

#[test]
fn what_stands_in_the_main_light_casts_a_shadow() {
    let Some(mut painter) = painter() else { return };
    for (turned, raised) in [(0.0, RAISED), (-60.0, 20.0), (-25.0, 55.0)] {
        let plain = Look { turned, raised, material: 1, ..Look::default() };
        let cast = Look { shadow: 1.0, ..plain };
        let without = in_the_light(&mut painter, plain, true);
        let with = in_the_light(&mut painter, cast, true);
        // The point where the line from the light through the small ball meets the large one. The
        // camera looks along the third axis, and a ball of radius one is this many pixels wide.
        let mesh = sphere(2_000);
        let camera = Camera { yaw: 0.0, pitch: 0.0, ..framed(&mesh, 1.0) };
        let seen = |p: Vec3| {
            let v = camera.project(p).expect("before the eye");
            ((v.x * 300.0) as u32, (v.y * 300.0) as u32)
        };
        let towards = Vec3::from(cast.main_light());
        assert!(
            towards.z > 0.5,
            "{turned} {raised}: the light is before the eye's side of the ball"
        );
        let (x, y) = seen(towards);
        let (lit, dark) = (bright(&without, x, y), bright(&with, x, y));
        assert!(dark * 4 < lit * 3, "{turned} {raised}: {dark} in the shadow, {lit} without");
        // A fifth of the radius to the side of the rim is nothing of it.
        let beside = (towards + Vec3::new(0.5, -0.35, 0.0)).normalize();
        let (x, y) = seen(beside);
        let (lit, other) = (bright(&without, x, y), bright(&with, x, y));
        assert!((lit - other).abs() <= 6, "{turned} {raised}: {other} beside it, {lit} without");
    }
}

#[test]
fn a_ball_does_not_shade_itself() {
    let Some(mut painter) = painter() else { return };
    for turned in [0.0, 70.0, 140.0] {
        let plain = Look { turned, ..Look::default() };
        let without = in_the_light(&mut painter, plain, false);
        let with = in_the_light(&mut painter, Look { shadow: 1.0, ..plain }, false);
        let off = without
            .pixels()
            .zip(with.pixels())
            .flat_map(|(a, b)| (0..3).map(|k| a.0[k].abs_diff(b.0[k])))
            .max();
        assert!(off.is_some_and(|off| off <= 8), "turned by {turned}: {off:?} of 255");
    }
}

#[test]
fn shadows_are_the_studio_s_alone() {
    let bare = Look { shadow: 0.7, ..Look::default() };
    assert_eq!(bare.cast(), 0.7);
    for light in [Light::Room, Light::Environment, Light::Matcap] {
        assert_eq!(Look { light, ..bare }.cast(), 0.0);
    }
    assert_eq!(Look { map: Map::Mask, ..bare }.cast(), 0.0, "a map's colours are to be read");
    for odd in [f32::NAN, f32::INFINITY, -3.0] {
        let look = Look { shadow: odd, turned: odd, raised: odd, ..bare };
        assert!((0.0..=1.0).contains(&look.cast()));
        let length = Vec3::from(look.main_light()).length();
        assert!((length - 1.0).abs() < 1e-5, "{odd}: {length}");
    }
}
