//! The provisional dab: what is led looks as what then comes, and the clay knows nothing of it.

use glam::Vec3;
use image::RgbaImage;
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_daemon::Published;
use sculptd_engine::camera::Camera;
use sculptd_geometry::shapes;
use sculptd_window::look::Look;
use sculptd_window::viewer::provisional::ProvisionalDabs;
use sculptd_window::viewer::renderer::{Beside, Scene};

use super::pictures::painter;
use super::published;
use crate::brushes::Studio;

/// Returns the mean difference of the pixels' channels, as a share of white.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let sum: f64 = a.iter().zip(b.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    sum / (a.len() as f64 * 255.0)
}

/// A stroke of a brush up to the middle, the pen on its way; what it does next, and what is led.
fn led(brush: BrushSettings) -> (Published, Published, ProvisionalDabs) {
    let mut studio = Studio::new(&shapes::sphere_of_about(20_000), brush, 1);
    let place = |i: i32| {
        let u = -0.5 + 0.02 * i as f32;
        Vec3::new(u, 0.1, (1.0 - 0.01 - u * u).sqrt())
    };
    for i in 0..25 {
        studio.sample(studio.view(place(i)), 0.8, true);
    }
    let before = published(&mut studio.world);
    let ahead = studio.view(place(30));
    let (device, pen) = before.pens.iter().flatten().next().expect("a pen");
    let led = ProvisionalDabs::lead(&before, &before.camera, (*device, pen), ahead);
    for i in 25..31 {
        studio.sample(studio.view(place(i)), 0.8, true);
    }
    let after = published(&mut studio.world);
    (before, after, led)
}

#[test]
fn what_is_led_looks_as_what_then_comes() {
    let Some(mut painter) = painter() else { return };
    for kind in [BrushKind::Draw, BrushKind::Inflate] {
        for negative in [false, true] {
            let preset = sculptd::presets().of(kind);
            let (before, after, led) = led(BrushSettings { negative, strength: 0.2, ..preset });
            assert!(!led.is_empty(), "{kind} is led");
            let mut paint = |state: &Published, led: Option<&ProvisionalDabs>| {
                let camera = Camera { yaw: 0.4, ..state.camera };
                let scene = Scene {
                    mesh: &state.mesh,
                    camera: &camera,
                    brush: None,
                    lines: &[],
                    look: Look { shade: 0.0, ..Look::default() },
                    values: None,
                    beside: Beside { led, ..Beside::default() },
                };
                painter.paint(&scene, 400, 300).expect("a picture")
            };
            let (bare, ahead) = (paint(&before, None), paint(&before, Some(&led)));
            let (again, real) = (paint(&before, None), paint(&after, None));
            assert_eq!(bare, again, "nothing of it stays");
            let (late, off) = (difference(&bare, &real), difference(&ahead, &real));
            println!("{kind}, {negative}: {late:.6} late without, {off:.6} with");
            if let Some(folder) = std::env::var_os("SCULPTD_PICTURES") {
                let folder = std::path::Path::new(&folder);
                for (name, picture) in [("bare", &bare), ("led", &ahead), ("real", &real)] {
                    picture
                        .save(folder.join(format!("{kind}-{negative}-{name}.png")))
                        .expect("kept");
                }
            }
            assert!(off < 0.5 * late, "{kind}, {negative}: {off} for {late}");
        }
    }
}

#[test]
fn nothing_is_led_where_it_is_not_known_what_comes() {
    assert!(led(sculptd::presets().of(BrushKind::Smooth)).2.is_empty());
    let mut roped = sculptd::presets().of(BrushKind::Draw);
    roped.path.rope = 0.1;
    assert!(led(roped).2.is_empty());
}
