//! `sculptd remesh`, `hollow` and `offset` of thin parts: what is printed about the new surface is
//! so in the file, and nothing is lost without a word.

use std::path::Path;
use std::process::{Command, Output};

use glam::{DMat3, DQuat, DVec3, Vec3};
use sculptd_geometry::bvh::nearest_on_triangle;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::shapes::{cuboid, cylinder, torus};
use sculptd_geometry::{CentredMesh, PolyMesh, TriMesh};
use serde_json::Value;

use crate::seeded::Random;

fn run(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.args(args).arg("--json").output().expect("the binary starts")
}

/// Both as one mesh of two shells.
fn both(mut a: PolyMesh, b: &PolyMesh) -> PolyMesh {
    let base = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    for face in b.faces() {
        let corners: Vec<u32> = face.iter().map(|v| v + base).collect();
        a.push_face(&corners);
    }
    a
}

/// A part about 100 mm large with a wall between 0.2 and 4 mm, turned.
fn thin_part(r: &mut Random) -> (PolyMesh, f64) {
    let wall = 0.2 * 20f64.powf(f64::from(r.part() as f32));
    let box_of = |half: DVec3| cuboid(-half, half);
    let mut part = match r.below(5) {
        0 => box_of(DVec3::new(50.0, 30.0, wall * 0.5)),
        1 => both(
            box_of(DVec3::new(40.0, 40.0, 10.0)),
            &cuboid(DVec3::new(-wall * 0.5, -30.0, 12.0), DVec3::new(wall * 0.5, 30.0, 40.0)),
        ),
        2 => cylinder(wall * 0.5, 100.0, 24),
        3 => torus(45.0, wall * 0.5, 96, 16),
        _ => both(
            box_of(DVec3::new(30.0, 30.0, 30.0)),
            &cuboid(
                DVec3::new(35.0, -wall * 0.5, -wall * 0.5),
                DVec3::new(60.0, wall * 0.5, wall * 0.5),
            ),
        ),
    };
    let axis = DVec3::new(r.part() - 0.5, r.part() - 0.5, 0.7).normalize();
    let turn = DMat3::from_quat(DQuat::from_axis_angle(axis, r.part() * 3.0));
    part.positions.iter_mut().for_each(|p| *p = turn * *p);
    (part, wall)
}

/// The distance of a place from a surface, by every triangle.
fn distance(p: Vec3, mesh: &TriMesh) -> f64 {
    let p = p.as_dvec3();
    let to =
        |t: usize| (p - nearest_on_triangle(p, mesh.corners(t).map(Vec3::as_dvec3)).0).length();
    (0..mesh.triangles.len()).map(to).fold(f64::INFINITY, f64::min)
}

/// The farthest of some places of a surface from another one.
fn farthest(from: &TriMesh, to: &TriMesh, places: usize) -> f64 {
    let step = (from.triangles.len() / places).max(1);
    let of = |t: usize| {
        let [a, b, c] = from.corners(t);
        [a, (a + b) * 0.5, (a + b + c) / 3.0]
            .map(|p| distance(p, to))
            .into_iter()
            .fold(0.0, f64::max)
    };
    (0..from.triangles.len()).step_by(step).map(of).fold(0.0, f64::max)
}

fn triangles(file: &Path) -> TriMesh {
    let mesh = read_mesh(file, &Job::default()).expect("a mesh").mesh;
    CentredMesh::about(&mesh, DVec3::ZERO, 1.0).mesh
}

#[test]
fn what_is_said_of_a_new_surface_is_so_in_its_file() {
    let parts = if std::env::var_os("SCULPTD_LONG").is_some() { 40 } else { 5 };
    let dir = tempfile::tempdir().expect("a folder");
    let path = |name: &str| dir.path().join(name);
    let mut r = Random(4747);
    let mut refused = 0;
    for n in 0..parts {
        let (part, wall) = thin_part(&mut r);
        let (old_file, new_file) = (path("old.obj"), path(["new.ply", "new.stl"][n % 2]));
        write_mesh(&old_file, &part).expect("written");
        let old = triangles(&old_file);
        let (side, thin) = (["64", "128"][n / 2 % 2], format!("{}", wall * 0.4));
        let inward = format!("--distance=-{thin}");
        let outward = format!("--distance={thin}");
        for how in [
            vec!["remesh"],
            vec!["remesh", "--sharp"],
            vec!["hollow", "--wall", &thin],
            vec!["offset", &inward],
            vec!["offset", &outward],
        ] {
            let case = format!("part {n}, wall {wall:.3}, --side {side}, {how:?}");
            let _ = std::fs::remove_file(&new_file);
            let (old_name, new_name) =
                (old_file.display().to_string(), new_file.display().to_string());
            let args = [&how[..], &[&old_name, "--side", side, "-o", &new_name]].concat();
            let out = run(&args);
            if !out.status.success() {
                let why = String::from_utf8_lossy(&out.stderr).into_owned();
                assert!(!why.trim().is_empty() && !new_file.exists(), "{case}: {why}");
                refused += 1;
                continue;
            }
            let said: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
            let number = |v: &Value| v.as_f64().expect("a number");
            let new = triangles(&new_file);
            let volume = measures(&new).volume;
            let off = (number(&said["volume"]) - volume).abs();
            assert!(off <= 1e-4 * volume.abs() + 1e-6, "{case}: volume {volume}, {said}");
            let beside = &said["beside_old"];
            let before = measures(&old).volume;
            assert!((number(&beside["volume"]) - before).abs() <= 1e-4 * before, "{case}");
            // A thousandth for the file's digits.
            let room = 1e-3;
            let bounds = |v: &Value| (number(&v["at_least"]), number(&v["at_most"]));
            let (least, most) = bounds(&beside["new_to_old"]);
            let seen = farthest(&new, &old, 4000);
            assert!(seen <= most + room && least <= most, "{case}: {seen} beyond {most}, {said}");
            let Some(back) = beside.get("old_to_new") else { continue };
            let (least, most) = bounds(back);
            let seen = farthest(&old, &new, 100);
            assert!(seen <= most + room && least <= most, "{case}: {seen} beyond {most}, {said}");
            // What is gone is told; cells two apart still touch the ones between them.
            let (lo, hi) = old.bounds();
            let spacing =
                f64::from((hi - lo).max_element()) / side.parse::<f64>().expect("a number");
            let warnings = said["warnings"].as_array().expect("warnings");
            assert!(
                least <= 3.5 * spacing || !warnings.is_empty(),
                "{case}: {least} away without a word, spacing {spacing}"
            );
        }
    }
    println!("{} commands, {refused} refused", parts * 5);
}
