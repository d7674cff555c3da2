//! Scratch.
use drawn::{DrawnScene, draw};
use drawn_hand::DrawnHand;
use glam::*;
use hand_tracks::HandTracks;
use sculptd_camera::*;
use sculptd_devices::sim::hand::HandKey;
fn main() {
    let rd = |n: &str| std::fs::read(format!("/tmp/hm/models/{n}.tflite")).unwrap();
    let up = |d: f32| {
        HandKey::flat(0, Vec3::new(10.0, 210.0, d - 450.0))
            .turned(0.0, std::f32::consts::FRAC_PI_2, 0.0)
            .spread(0.3)
    };
    let new = || HandTracks::new(&rd("palm_detection_lite"), &rd("hand_landmark_full")).unwrap();
    if std::env::args().nth(1).as_deref() == Some("rest") {
        for (skin, lamp, light) in [
            ([205, 150, 120], Vec3::new(-0.4, -0.5, -0.76), 1.0),
            ([84, 56, 44], Vec3::new(0.0, -0.9, -0.4), 0.8),
        ] {
            let mut t = new();
            let hand = DrawnHand::new(&up(450.0), false, 1.0);
            for i in 0..60u64 {
                let sc = DrawnScene { seed: i + 9, skin, lamp, light, ..Default::default() };
                let p = draw(&sc, &[hand]);
                let tr = t.look(&p).to_vec();
                if let Some(h) = tr.first() {
                    let s = p.size();
                    let pl = spatial::place(&h.seen, h.is_left(), s, &sc.lens, &Default::default())
                        .unwrap();
                    let c = &h.seen.shape;
                    let n = (c[5] - c[0]).cross(c[17] - c[0]).normalize();
                    let q = &pl.joints;
                    let m = (q[5] - q[0]).cross(q[17] - q[0]).normalize();
                    if i % 3 == 0 {
                        println!(
                            "{i} depth {:.1} palm {:.2} px {:.2} misfit {:.3} model n {:.2?} fit n {:.2?} pres {:.3} left {:.2} crop {:.1} {:.3} {:.1?}",
                            pl.depth,
                            h.seen.palm_px(),
                            h.seen.joints[8].x,
                            pl.misfit,
                            n.to_array(),
                            m.to_array(),
                            h.seen.presence,
                            h.seen.left,
                            h.seen.crop.side,
                            h.seen.crop.angle,
                            h.seen.crop.centre.to_array()
                        );
                    }
                } else {
                    println!("{i} none");
                }
            }
        }
    } else {
        let mut t = new();
        let mut k = 0.0f32;
        for i in 0..30 {
            let mut r = |a: f32, b: f32| {
                k += 1.0;
                a + (b - a) * ((k * 12.9898).sin() * 43758.547).fract().abs()
            };
            let base = HandKey {
                palm: Vec3::new(r(-60., 60.), r(180., 240.), r(-80., 80.)),
                yaw_pitch_roll: [r(-0.3, 0.3), r(1.2, 1.6), r(-0.3, 0.3)],
                ..up(450.0)
            };
            let mut line = String::new();
            for a in [0.0, 0.0, 0.5, 1.0, 1.0, 1.0] {
                let hand = DrawnHand::new(&base.pinched(a), false, 1.0);
                let sc = DrawnScene { seed: i * 10 + k as u64, ..Default::default() };
                let p = draw(&sc, &[hand]);
                if a == 1.0 && line.len() < 70 {
                    std::fs::write(
                        format!("/tmp/hm/p_{i:02}.ppm"),
                        [format!("P6 {} {} 255\n", p.width, p.height).into_bytes(), p.rgb.clone()]
                            .concat(),
                    )
                    .unwrap();
                }
                let tr = t.look(&p).to_vec();
                if let Some(h) = tr.first() {
                    let s = p.size();
                    let pl = spatial::place(&h.seen, h.is_left(), s, &sc.lens, &Default::default())
                        .unwrap();
                    let d = pl.joints[4] - pl.joints[8];
                    let tc = hand.joints.map(|q| sc.lens.to_camera(q));
                    let td = tc[4] - tc[8];
                    line += &format!(
                        " | {:.0},{:.0} ({:.0},{:.0})",
                        d.truncate().length(),
                        d.z,
                        td.truncate().length(),
                        td.z
                    );
                }
            }
            println!("{i}{line}");
        }
    }
}
