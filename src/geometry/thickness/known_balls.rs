//! Balls by formula, at random places of turned parts.

use glam::{DQuat, DVec3};

use super::known_walls::drawn_out;
use super::probe::WallProber;
use super::ready::ReadyPart;
use super::{ThicknessMethod, ThicknessSettings};
use crate::job::Job;
use crate::{PolyMesh, TriMesh, shapes};

/// Numbers from 0 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Random places of the triangles.
fn places(mesh: &TriMesh, count: usize, seed: u64) -> Vec<DVec3> {
    let mut random = numbers(seed);
    let corner = |v: u32| mesh.positions[v as usize].as_dvec3();
    (0..count)
        .map(|_| {
            let t = mesh.triangles[(random() * mesh.triangles.len() as f64) as usize];
            let [a, b, c] = t.map(corner);
            let (u, v) = (random(), random());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        })
        .collect()
}

/// The balls at random places of a part, turned; ascending.
fn diameters(part: &PolyMesh) -> Vec<f32> {
    let settings =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    let mut all = Vec::new();
    for turn in 0..4u32 {
        let way = DVec3::new(1.0, f64::from(turn), 0.3).normalize();
        let turned = DQuat::from_axis_angle(way, 0.7 * f64::from(turn));
        let mut part = part.clone();
        part.positions.iter_mut().for_each(|p| *p = turned * *p);
        let mesh = part.triangulate().0;
        let prober = WallProber::new(&mesh, &settings, &Job::default()).expect("measurable");
        for place in places(&mesh, 300, u64::from(turn) + 1) {
            // Beside a sharp edge of 60 degrees nothing is a wall.
            all.extend(prober.at(place).and_then(|p| p.thickness));
        }
    }
    assert!(all.len() > 200, "{} of 1,200 places have a ball", all.len());
    all.sort_by(f32::total_cmp);
    all
}

fn range(part: &PolyMesh) -> (f64, f64) {
    let all = diameters(part);
    (f64::from(all[0]), f64::from(all[all.len() - 1]))
}

fn all_near(name: &str, part: &PolyMesh, right: f64) {
    let (least, most) = range(part);
    let off = (least - right).abs().max((most - right).abs());
    assert!(off < right * 1e-3, "{name}: {least} to {most}, not {right}");
}

/// Between an end of a prism and an edge a ball may settle before it is as large as the prism
/// holds.
/// None is larger.
fn none_larger(name: &str, part: &PolyMesh, right: f64) {
    let (least, most) = range(part);
    let fits = least > right * 0.6 && (most - right).abs() < right * 1e-3;
    assert!(fits, "{name}: {least} to {most}, not {right}");
}

#[test]
fn the_ball_of_a_box_and_of_prisms_is_the_largest_that_fits() {
    all_near("box", &shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 20.0, 5.0)), 5.0);
    all_near("cube", &shapes::cuboid(DVec3::ZERO, DVec3::splat(10.0)), 10.0);
    // The circle inside an equilateral triangle has the diameter side / sqrt 3.
    let half = 40.0 / 2.0;
    let triangle = [[-half, 0.0], [half, 0.0], [0.0, half * 3f64.sqrt()]];
    none_larger("60 degree prism", &drawn_out(&triangle, 100.0), 40.0 / 3f64.sqrt());
    // Legs of 30 and a right angle: legs + legs - hypotenuse.
    let right = [[0.0, 0.0], [30.0, 0.0], [0.0, 30.0]];
    let diameter = 60.0 - 30.0 * 2f64.sqrt();
    none_larger("45 degree prism", &drawn_out(&right, 100.0), diameter);
}

#[test]
fn the_sides_of_a_notch_say_what_the_plate_says() {
    let notched = [
        [0.0, 0.0],
        [60.0, 0.0],
        [60.0, 20.0],
        [30.0, 20.0],
        [30.0, 40.0],
        [60.0, 40.0],
        [60.0, 60.0],
        [0.0, 60.0],
    ];
    all_near("plate with a notch", &drawn_out(&notched, 5.0), 5.0);
}

#[test]
fn a_rib_is_as_thick_as_it_is_wide_also_on_its_top() {
    let outline = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 6.0],
        [22.0, 6.0],
        [22.0, 30.0],
        [18.0, 30.0],
        [18.0, 6.0],
        [0.0, 6.0],
    ];
    let part = drawn_out(&outline, 50.0);
    let settings =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    let mesh = part.triangulate().0;
    let prober = WallProber::new(&mesh, &settings, &Job::default()).expect("measurable");
    let at = |x: f64, y: f64, z: f64| {
        let probe = prober.at(DVec3::new(x, z, y)).expect("a place");
        f64::from(probe.thickness.expect("a ball"))
    };
    for (x, y, right) in [
        (20.0, 30.0, 4.0),
        (18.1, 30.0, 4.0),
        (22.0, 29.9, 4.0),
        (22.0, 15.0, 4.0),
        (5.0, 0.0, 6.0),
        (0.0, 1.0, 6.0),
        (39.9, 6.0, 6.0),
    ] {
        for z in [25.0, 0.3, 49.9] {
            let found = at(x, y, z);
            assert!((found - right).abs() < right * 1e-3, "{x} {y} {z}: {found}, not {right}");
        }
    }
    // Under the rib the ball is larger than the plate: it reaches into the root.
    let root = at(20.0, 0.0, 25.0);
    assert!(root > 6.2 && root < 7.5, "{root}");
}

/// The ball begins as large as the distance from the edge, down to what single precision tells.
#[test]
fn a_place_very_near_an_edge_says_what_the_plate_says() {
    let size = DVec3::new(40.0, 20.0, 5.0);
    let settings =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    for shift in [DVec3::ZERO, size * -0.5] {
        let mesh = shapes::cuboid(shift, shift + size).triangulate().0;
        let prober = WallProber::new(&mesh, &settings, &Job::default()).expect("measurable");
        let mut random = numbers(17);
        for _ in 0..2000 {
            let from_edge = 1e-4 * 200f64.powf(random());
            let at = DVec3::new(size.x - from_edge, 0.0, size.z * random());
            let found = prober.at(shift + at).and_then(|p| p.thickness).expect("a ball");
            assert!((found - 5.0).abs() < 1e-3, "{found} at {at}");
        }
    }
}

/// Tens of thousands of places on each plate.
#[test]
fn no_place_of_a_plate_is_thinner_or_thicker_than_the_plate() {
    let mut random = numbers(17);
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 400 } else { 20 };
    let settings =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    let mut bad = Vec::new();
    for round in 0..rounds {
        let wall = 1.0 + 9.0 * random();
        let size = DVec3::new(wall * (2.0 + 8.0 * random()), wall * (1.5 + 3.0 * random()), wall);
        let mut part = shapes::cuboid(size * -0.5, size * 0.5);
        let way = DVec3::new(random(), random(), random()).normalize();
        let turned = DQuat::from_axis_angle(way, if round % 2 == 0 { 0.0 } else { 3.0 * random() });
        part.positions.iter_mut().for_each(|p| *p = turned * *p);
        let ready = ReadyPart::new(&part, 1.0, None, settings.crease, &Job::default());
        let found = ready.expect("a part").measure(&settings, None, &Job::default());
        let found = found.expect("measured");
        let least = found.least.expect("a wall");
        let most = found.samples.iter().map(|s| s.value).fold(0.0, f32::max);
        if [least.value, f64::from(most)].iter().any(|found| (found / wall - 1.0).abs() > 1e-3) {
            let at = turned.inverse() * DVec3::from(least.position);
            bad.push(format!("{round}: {size} has {} to {most}, at {at}", least.value));
        }
    }
    assert!(bad.is_empty(), "{} of {rounds}: {bad:#?}", bad.len());
}
