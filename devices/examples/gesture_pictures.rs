//! Pictures of the gestures, drawn from the same simulated hands that tests feed to the parsers.
//!
//! `cargo run --release -p sculptd-devices --example gesture_pictures -- FOLDER` writes one SVG a
//! gesture: a right hand (or two) as its owner sees it, from above and behind.

use std::fmt::Write as _;
use std::path::PathBuf;

use glam::{Quat, Vec2, Vec3, vec2, vec3};
use sculptd_devices::sample::Hand;
use sculptd_devices::sim::hand::{HandKey, skeleton};

/// Width and height of a picture, and its pixels a millimetre.
const SIZE: [f32; 2] = [260.0, 240.0];
const SCALE: f32 = 0.9;
const SKIN: &str = "#c98d6b";
const EDGE: &str = "#5b3a29";
const HINT: &str = "#d2622a";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("expected a folder")?);
    std::fs::create_dir_all(&folder)?;
    let at = |x: f32| HandKey::flat(0, vec3(x, 200.0, 40.0));
    // The other fingers out of the way, so that the two that meet are seen.
    let pinching =
        |x: f32| HandKey { curl: [0.2, 0.3, 0.1, 0.1, 0.1], ..at(x).spread(0.3).pinched(1.0) };
    let right = |key: HandKey| skeleton(&key, false);
    let left = |key: HandKey| skeleton(&key, true);
    let push = Arrow { from: vec3(14.0, 200.0, -45.0), to: vec3(14.0, 200.0, -105.0) };
    let across = Arrow { from: vec3(-60.0, 175.0, -75.0), to: vec3(60.0, 175.0, -75.0) };
    let turn = Arrow { from: vec3(-85.0, 200.0, 40.0), to: vec3(-85.0, 200.0, -70.0) };
    let shift = Arrow { from: vec3(40.0, 200.0, 20.0), to: vec3(100.0, 200.0, 20.0) };
    let pull = Arrow { from: vec3(-80.0, 190.0, -30.0), to: vec3(-80.0, 190.0, 40.0) };
    let apart = [
        Arrow { from: vec3(30.0, 200.0, -75.0), to: vec3(95.0, 200.0, -75.0) },
        Arrow { from: vec3(-30.0, 200.0, -75.0), to: vec3(-95.0, 200.0, -75.0) },
    ];
    let gestures = [
        ("point", vec![right(at(0.0).pointing())], vec![push]),
        ("pinch", vec![right(pinching(0.0))], vec![pull]),
        ("flat", vec![right(at(0.0))], vec![across]),
        ("open", vec![right(at(0.0).spread(1.0))], vec![turn]),
        ("fist", vec![right(at(0.0).curled(0.95))], vec![shift]),
        ("two-pinches", vec![left(pinching(-62.0)), right(pinching(62.0))], apart.into()),
    ];
    for (name, hands, arrows) in gestures {
        #[allow(clippy::disallowed_methods)] // A picture that is half written is made again.
        std::fs::write(folder.join(format!("gesture-{name}.svg")), picture(&hands, &arrows))?;
    }
    Ok(())
}

/// A movement, in the tracker's mm.
struct Arrow {
    from: Vec3,
    to: Vec3,
}

/// Projects a point into the picture, with its depth: seen from above and behind, without
/// perspective.
fn seen(p: Vec3) -> (Vec2, f32) {
    let view = Quat::from_rotation_x(0.9) * (p - vec3(0.0, 200.0, 15.0));
    (vec2(SIZE[0] * 0.5 + view.x * SCALE, SIZE[1] * 0.5 - view.y * SCALE), view.z)
}

/// A stroke with an edge, later drawn far ones first.
struct Limb {
    near: f32,
    svg: String,
}

fn line(a: Vec3, b: Vec3, width: f32, colour: &str) -> String {
    let ((a, _), (b, _)) = (seen(a), seen(b));
    format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{colour}\" stroke-width=\"{width:.1}\"/>\n",
        a.x, a.y, b.x, b.y
    )
}

/// A bone as a round stroke with a dark edge.
fn limb(a: Vec3, b: Vec3, width_mm: f32) -> Limb {
    let width = width_mm * SCALE;
    let svg = line(a, b, width + 2.4, EDGE) + &line(a, b, width, SKIN);
    Limb { near: (seen(a).1 + seen(b).1) * 0.5, svg }
}

fn limbs(hand: &Hand) -> Vec<Limb> {
    let mut out = Vec::new();
    let wrist = hand.wrist.unwrap_or(hand.palm);
    let elbow = hand.elbow.unwrap_or(wrist);
    let mut palm = vec![wrist];
    for (i, finger) in hand.fingers.iter().flatten().enumerate() {
        let joints: Vec<Vec3> = finger.joints.iter().flatten().copied().collect();
        let width = finger.width.unwrap_or(17.0);
        // The bones of the palm of four fingers are one surface.
        let first = if i == 0 { 0 } else { 1 };
        out.extend(joints.windows(2).skip(first).map(|j| limb(j[0], j[1], width)));
        palm.extend(joints.get(usize::from(i > 0)));
    }
    // Drawn as one closed stroke, so that no seam shows between its bones.
    let mut shape = String::new();
    for (i, p) in palm.iter().enumerate() {
        let p = seen(*p).0;
        let _ = write!(shape, "{}{:.1} {:.1}", if i == 0 { "M" } else { "L" }, p.x, p.y);
    }
    let middle = palm.iter().map(|p| seen(*p).1).sum::<f32>() / palm.len() as f32;
    let mut svg = String::new();
    for (colour, width) in [(EDGE, 20.4), (SKIN, 18.0)] {
        let _ = writeln!(
            svg,
            "<path d=\"{shape}Z\" stroke=\"{colour}\" stroke-width=\"{width}\" fill=\"{colour}\"/>"
        );
    }
    out.push(Limb { near: middle, svg });
    out.push(limb(wrist, wrist + (elbow - wrist) * 0.35, 42.0));
    out
}

fn picture(hands: &[Hand], arrows: &[Arrow]) -> String {
    let [width, height] = SIZE;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" fill=\"none\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\">\n"
    );
    let mut all: Vec<Limb> = hands.iter().flat_map(limbs).collect();
    all.sort_by(|a, b| a.near.total_cmp(&b.near));
    all.iter().for_each(|limb| out.push_str(&limb.svg));
    for arrow in arrows {
        out.push_str(&line(arrow.from, arrow.to, 4.0, HINT));
        let (from, to) = (seen(arrow.from).0, seen(arrow.to).0);
        let back = (from - to).normalize_or_zero() * 12.0;
        for side in [0.5f32, -0.5] {
            let end = to + Vec2::from_angle(side).rotate(back);
            let _ = writeln!(
                out,
                "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{HINT}\" stroke-width=\"4\"/>",
                to.x, to.y, end.x, end.y
            );
        }
    }
    out.push_str("</svg>\n");
    out
}
