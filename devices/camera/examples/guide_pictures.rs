//! Draws the pictures of the guide's chapter "First strokes with your hands": drawn hands with the
//! skeleton that the camera sees in them.
//!
//!     cargo run --release -p sculptd-camera --example guide_pictures -- MODELS FOLDER

use std::path::PathBuf;

use glam::{Vec2, Vec3};
use sculptd_camera::drawn::{DrawnScene, draw};
use sculptd_camera::drawn_hand::DrawnHand;
use sculptd_camera::hand_camera::{HandCamera, HandCameraSettings};
use sculptd_camera::picture::Picture;
use sculptd_camera::{models, skeleton};
use sculptd_devices::DeviceId;
use sculptd_devices::sim::hand::HandKey;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(PathBuf::from);
    let (Some(models), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("expected the folder of the models and the folder of the pictures".into());
    };
    let upright = HandKey::flat(0, Vec3::new(0.0, 215.0, -40.0))
        .turned(0.0, std::f32::consts::FRAC_PI_2, 0.0)
        .spread(0.3);
    let poses = [
        ("open", upright.spread(0.9)),
        ("point", upright.pointing()),
        ("pinch", upright.pinched(1.0)),
    ];
    for (name, key) in poses {
        let tracks = models::load(&models)?;
        let mut camera = HandCamera::new(tracks, HandCameraSettings::default(), DeviceId(0));
        let hand = DrawnHand::new(&key, false, 1.0);
        let mut picture = Picture::default();
        for seed in 1..8_u64 {
            let scene = DrawnScene { size: (480, 360), seed, noise: 2.0, ..DrawnScene::default() };
            picture = draw(&scene, &[hand]);
            camera.look(picture.clone(), seed * 33_333);
        }
        for joints in camera.view().joints.iter().flatten() {
            skeleton::paint(&mut picture, &joints.map(|p| p * Vec2::new(480.0, 360.0)));
        }
        // As in a mirror, as the window shows it.
        let mut mirrored = image::RgbImage::new(480, 360);
        for (x, y, pixel) in mirrored.enumerate_pixels_mut() {
            pixel.0 = picture.pixel(479 - x as usize, y as usize);
        }
        mirrored.save(folder.join(format!("camera-{name}.png")))?;
    }
    Ok(())
}
