//! Thickness against shapes of which it is known.

use glam::{Quat, Vec3};
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::{
    Correction, Outliers, Reason, ThicknessMethod, ThicknessSettings, measure,
};
use sculptd_geometry::{CentredMesh, TriMesh};

use crate::thickness_shapes::{ribbed, shell, slab, tube, wedge};

/// A shape, and at each vertex the exact thickness, or nothing where an edge is nearer than that.
struct Known {
    name: &'static str,
    mesh: TriMesh,
    exact: Vec<Option<f32>>,
}

fn known(name: &'static str, mesh: TriMesh, exact: impl Fn(Vec3) -> Option<f32>) -> Known {
    let exact = mesh.positions.iter().map(|&p| exact(p)).collect();
    // Turned, so that nothing is aligned with an axis.
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
    let mesh = TriMesh { positions: mesh.positions.iter().map(|&p| turn * p).collect(), ..mesh };
    Known { name, mesh, exact }
}

fn shapes() -> Vec<Known> {
    let tan = 10f32.to_radians().tan();
    let between = |x: f32, lo: f32, hi: f32| x > lo && x < hi;
    vec![
        known("slab 2", slab(40.0, 2.0, 80), |p| {
            (between(p.x, 2.01, 37.99) && between(p.y, 2.01, 37.99)).then_some(2.0)
        }),
        known("shell 1.5", shell(10.0, 8.5, 100), |_| Some(1.5)),
        known("tube 2", tube(10.0, 8.0, 30.0, 256, 30, 4), |p| {
            let r = p.truncate().length();
            (between(p.z, 2.01, 27.99) && (r > 9.99 || r < 8.01)).then_some(2.0)
        }),
        // The way along the normal: d tan(angle) from the base, and from the slope, both at
        // distance d from the tip.
        known("wedge 10 deg", wedge(10f32.to_radians(), 80), |p| {
            let d = (p.x * p.x + p.z * p.z).sqrt();
            let t = d * tan;
            let inside = between(p.x, 20.0 + 2.0 * t, 60.0 - 2.0 * t);
            (inside && between(p.y, 2.0 * t, 40.0 - 2.0 * t)).then_some(t)
        }),
        known("rib flank", ribbed(), |p| {
            let flank =
                [10.0f32, 12.0, 22.0, 24.0, 34.0, 36.0].iter().any(|x| (p.x - x).abs() < 1e-3);
            (flank && between(p.z, 5.01, 12.99) && between(p.y, 2.01, 27.99)).then_some(2.0)
        }),
    ]
}

/// Median and largest of the errors, per cent.
fn errors(shape: &Known, settings: &ThicknessSettings) -> (f32, f32) {
    let found = measure(&shape.mesh, settings, &Job::default()).expect("sane settings");
    let mut off: Vec<f32> = shape
        .exact
        .iter()
        .zip(&found.values)
        .filter_map(|(e, v)| e.map(|e| (v / e - 1.0) * 100.0))
        .map(|e| if e.is_finite() { e } else { 1e9 })
        .collect();
    assert!(off.len() > 200, "{}: {} vertices", shape.name, off.len());
    off.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let largest = off[off.len() - 1];
    off.sort_by(f32::total_cmp);
    (off[off.len() / 2], largest)
}

#[test]
fn the_error_tables() {
    let one = ThicknessSettings::default();
    let cone = |opening, correction| ThicknessSettings {
        method: ThicknessMethod::Cone,
        rays: 25,
        opening,
        correction,
        ..ThicknessSettings::default()
    };
    let sphere =
        ThicknessSettings { method: ThicknessMethod::Sphere, ..ThicknessSettings::default() };
    let rows = [
        ("one ray", one, [0.01; 5]),
        ("cone 60 x 25, plain", cone(60.0, Correction::None), [9.0; 5]),
        ("cone 60 x 25, hit angle", cone(60.0, Correction::Angle), [0.1, 1.0, 1.0, 1.6, 0.1]),
        ("cone 60 x 25, chord", cone(60.0, Correction::Chord), [0.01, 0.15, 0.1, 0.01, 0.01]),
        ("cone 120 x 25, plain", cone(120.0, Correction::None), [33.0; 5]),
        ("cone 120 x 25, hit angle", cone(120.0, Correction::Angle), [0.1, 4.5, 2.0, 1.6, 0.1]),
        ("cone 120 x 25, chord", cone(120.0, Correction::Chord), [0.01, 0.15, 0.1, 0.01, 0.01]),
        ("inscribed sphere", sphere, [0.05; 5]),
    ];
    let shapes = shapes();
    println!("error of the median / largest error, per cent");
    print!("{:28}", "");
    shapes.iter().for_each(|s| print!("{:>20}", s.name));
    println!();
    let mut bad = Vec::new();
    for (name, settings, limits) in rows {
        print!("{name:28}");
        for (shape, limit) in shapes.iter().zip(limits) {
            let (mut median, mut largest) = errors(shape, &settings);
            if settings.method == ThicknessMethod::Sphere && shape.name.starts_with("wedge") {
                // The ball that touches both sides of a wedge at distance d from its tip: 2 d
                // tan(angle / 2).
                let ball = 2.0 * 5f32.to_radians().tan() / 10f32.to_radians().tan();
                (median, largest) = ((median / 100.0 + 1.0) / ball, (largest / 100.0 + 1.0) / ball);
                (median, largest) = ((median - 1.0) * 100.0, (largest - 1.0) * 100.0);
            }
            print!("{:>20}", format!("{median:.4} / {largest:.3}"));
            // Ours hold at every vertex, the others' at the median.
            let worst =
                if name.ends_with("plain") || name.ends_with("angle") { median } else { largest };
            if worst.abs() > limit {
                bad.push(format!("{name} on {}: {worst} > {limit}", shape.name));
            }
        }
        println!();
    }
    assert!(bad.is_empty(), "{bad:#?}");
}

#[test]
fn on_a_closed_mesh_every_value_is_there() {
    for shape in shapes() {
        for method in [ThicknessMethod::Ray, ThicknessMethod::Cone, ThicknessMethod::Sphere] {
            for rays in [1, 25] {
                let settings = ThicknessSettings {
                    method,
                    rays,
                    outliers: Outliers::SigmaMean,
                    ..ThicknessSettings::default()
                };
                let found =
                    measure(&shape.mesh, &settings, &Job::default()).expect("sane settings");
                let missing = found.values.iter().filter(|v| !v.is_finite()).count();
                assert_eq!(missing, 0, "{} {method:?} {rays}", shape.name);
                assert!(found.reasons.iter().all(|r| matches!(r, Reason::Measured | Reason::Edge)));
            }
        }
    }
}

/// No mesh that people have is refused by a panic, and no wall is less than nothing.
#[test]
fn every_mesh_of_the_corpus_is_measured_by_every_definition() {
    let Some(dir) = crate::corpus() else { return };
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let most = if long { usize::MAX } else { 14_000 };
    let folder = dir.join("meshes");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("meshes").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let mut measured = 0;
    for file in files.into_iter().step_by(if long { 1 } else { 3 }) {
        let Ok(read) = sculptd_geometry::io::read_mesh(&file, &Job::default()) else { continue };
        let part = CentredMesh::new(&read.mesh, 1.0);
        if part.mesh.triangles.len() > most {
            continue;
        }
        for method in [ThicknessMethod::Ray, ThicknessMethod::Cone, ThicknessMethod::Sphere] {
            let settings = ThicknessSettings { method, ..ThicknessSettings::default() };
            let found = measure(&part.mesh, &settings, &Job::default());
            let found = found.unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            let below = |v: &&f32| v.is_sign_negative() && !v.is_nan();
            assert_eq!(found.values.iter().find(below), None, "{} {method:?}", file.display());
            measured += 1;
        }
    }
    assert!(measured >= 30, "{measured}");
}
