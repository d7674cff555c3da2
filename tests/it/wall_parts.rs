//! `sculptd thickness --parts` and `--skeleton`: what they print and write, and how they fail.

use std::f64::consts::TAU;
use std::path::Path;
use std::process::{Command, Output};

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::{cuboid, torus};
use serde_json::Value;

fn thickness(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.arg("thickness").args(args).output().expect("the binary starts")
}

fn json(args: &[&str]) -> Value {
    let out = thickness(&[args, &["--json"]].concat());
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("one JSON object")
}

/// A slab of 60 x 40 at `far`, of 2 mm up to its middle and of 5 mm from there.
fn slab(far: DVec3) -> PolyMesh {
    let profile = [[0.0, 0.0], [60.0, 0.0], [60.0, 5.0], [30.0, 5.0], [30.0, 2.0], [0.0, 2.0]];
    let mut mesh = PolyMesh::new();
    for y in [0.0, 40.0] {
        mesh.positions.extend(profile.map(|[x, z]| far + DVec3::new(x, y, z)));
    }
    let mut faces: Vec<Vec<u32>> = vec![(0..6).collect(), (6..12).rev().collect()];
    faces.extend((0..6).map(|i| vec![i, i + 6, (i + 1) % 6 + 6, (i + 1) % 6]));
    for corners in faces {
        mesh.corners.extend(corners);
        mesh.face_starts.push(mesh.corners.len() as u32);
    }
    mesh
}

fn near(found: &Value, expected: f64, by: f64) -> bool {
    found.as_f64().is_some_and(|f| (f - expected).abs() <= by)
}

#[test]
fn a_part_is_divided_at_its_step_and_each_file_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (part, ply, png) = (path("slab.obj"), path("slab.ply"), path("slab.png"));
    let far = DVec3::new(4000.0, -250.0, 90.0);
    write_mesh(Path::new(&part), &slab(far)).expect("written");
    let said = json(&[&part, "--parts", "--levels", "3", "--ply", &ply, "--png", &png]);
    let parts = said["partition"]["parts"].as_array().expect("parts");
    assert_eq!(parts.len(), 2, "{said}");
    for (part, (wall, x)) in parts.iter().zip([(5.0, 45.4), (2.0, 14.5)]) {
        assert!(near(&part["median"], wall, 1e-3), "{part}");
        assert!(near(&part["centre"][0], far.x + x, 1.5), "{part}");
        assert!(near(&part["borders"][0]["length"], 84.0, 16.0), "{part}");
    }
    let area = |p: &Value| p["area"].as_f64().expect("an area");
    let all = said["area"].as_f64().expect("an area");
    assert!((parts.iter().map(area).sum::<f64>() / all - 1.0).abs() < 1e-6);
    // The map has the number of each triangle's part, and is a mesh that others read.
    let map = std::fs::read(&ply).expect("a map");
    assert!(String::from_utf8_lossy(&map[..600]).contains("property int part\nend_header"));
    let triangles = read_mesh(Path::new(&ply), &Job::default()).expect("reads").mesh.face_count();
    let told: u64 = parts.iter().filter_map(|p| p["triangles"].as_u64()).sum();
    assert_eq!(triangles as u64, told);
    // Two colours of parts, which no map of thickness has.
    let picture = image::open(&png).expect("a picture").to_rgb8();
    let blue = picture.pixels().filter(|p| p[2] > p[0] + 20).count();
    let orange = picture.pixels().filter(|p| p[0] > p[2] + 40).count();
    assert!(blue > 20_000 && orange > 20_000, "{blue} {orange}");
    let text = thickness(&[&part, "--parts", "--levels", "3"]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.contains("parts      2, of levels"), "{text}");
}

#[test]
fn the_lines_of_a_ring_are_written_where_its_file_has_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (part, lines) = (path("ring.stl"), path("lines.obj"));
    let mut ring = torus(20.0, 3.0, 160, 32);
    let far = DVec3::new(700.0, 300.0, -40.0);
    ring.positions.iter_mut().for_each(|p| *p += far);
    write_mesh(Path::new(&part), &ring).expect("written");
    let said = json(&[&part, "--skeleton", &lines]);
    let branches = said["skeleton"]["branches"].as_array().expect("branches");
    assert_eq!(branches.len(), 1, "{branches:?}");
    assert!(near(&branches[0]["length"], TAU * 20.0, 0.03 * TAU * 20.0), "{branches:?}");
    assert!(near(&branches[0]["mean"], 6.0, 0.1));
    let written = std::fs::read_to_string(&lines).expect("lines");
    let nodes = said["skeleton"]["nodes"].as_array().expect("nodes").len();
    let points: Vec<DVec3> = written
        .lines()
        .filter_map(|l| l.strip_prefix("v "))
        .map(|l| {
            let n: Vec<f64> = l.split(' ').map(|x| x.parse().expect("a number")).collect();
            DVec3::new(n[0], n[1], n[2])
        })
        .collect();
    assert_eq!(points.len(), nodes);
    for p in points {
        let p = p - far;
        assert!((p.truncate().length() - 20.0).hypot(p.z) < 1.6, "{p}");
    }
    let line = written.lines().find_map(|l| l.strip_prefix("l ")).expect("a line");
    let corners: Vec<&str> = line.split(' ').collect();
    assert_eq!((corners.len(), corners[0]), (nodes + 1, corners[nodes]), "it is closed");
}

#[test]
fn what_cannot_be_divided_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let part = path("slab.obj");
    write_mesh(Path::new(&part), &slab(DVec3::ZERO)).expect("written");
    let (lines, out) = (path("lines.obj"), path("out"));
    for args in [
        &["--parts", "--levels", "0"][..],
        &["--parts", "--levels", "17"],
        &["--parts", "--smoothing", "nan"],
        &["--levels", "3"],
        &["--at", "1,1,1", "--parts"],
        &["--at", "1,1,1", "--skeleton", &lines],
        &["--out", &out, "--skeleton", &lines],
        &["--out", &out, "--parts"],
    ] {
        let said = thickness(&[&[&part[..]], args].concat());
        assert_eq!(said.status.code(), Some(2), "{args:?}");
        assert!(!said.stderr.is_empty(), "{args:?}");
        assert!(!Path::new(&lines).exists() && !Path::new(&out).exists(), "{args:?}");
    }
}

#[test]
fn a_later_version_is_compared_with_the_one_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (old, new) = (path("old.obj"), path("new.obj"));
    let (ply, png, report) = (path("map.ply"), path("map.png"), path("report.html"));
    let far = DVec3::new(4000.0, -250.0, 90.0);
    let plate = cuboid(far, far + DVec3::new(60.0, 40.0, 5.0));
    write_mesh(Path::new(&old), &plate).expect("written");
    write_mesh(Path::new(&new), &slab(far)).expect("written");
    let files = ["--ply", &ply, "--png", &png, "--report", &report];
    let args = [&old[..], "--compare", &new, "--fail-below", "3", "--json"];
    let out = thickness(&[&args[..], &files].concat());
    assert_eq!(out.status.code(), Some(1), "{}", String::from_utf8_lossy(&out.stderr));
    let said: Value = serde_json::from_slice(&out.stdout).expect("one JSON object");
    assert!(near(&said["before"]["min"], 5.0, 1e-3) && near(&said["after"]["min"], 2.0, 1e-3));
    assert!(near(&said["before"]["below"]["area_percent"], 0.0, 0.0), "{said}");
    let changes = &said["changes"];
    // Over half of the plate on both sides by 3.
    assert!(near(&changes["newly_below_area"], 2.0 * 30.0 * 40.0, 24.0), "{changes}");
    let spot = &changes["spots"][0];
    assert!(near(&spot["before"], 5.0, 1e-3) && near(&spot["after"], 2.0, 1e-3), "{spot}");
    assert!(near(&spot["position"][0], far.x + 15.0, 15.0), "{spot}");
    let map = std::fs::read(&ply).expect("a map");
    assert!(String::from_utf8_lossy(&map[..600]).contains("property float difference"));
    read_mesh(Path::new(&ply), &Job::default()).expect("others read it");
    // Thinner is red, unchanged pale.
    let picture = image::open(&png).expect("a picture").to_rgb8();
    let red = picture.pixels().filter(|p| p[0] > p[2] + 30).count();
    assert!(red > 20_000, "{red}");
    let page = std::fs::read_to_string(&report).expect("a report");
    assert!(page.contains("Came below the limit") && page.contains("new.obj"));
    let text = thickness(&args[..5]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.contains("came below") && text.contains("verdict    fail"), "{text}");
    let several = thickness(&[&old, &new, "--compare", &new]);
    assert_eq!(several.status.code(), Some(2));
}
