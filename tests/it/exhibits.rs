//! Exhibits of an installation: the command line's scores beside `sculptd distance`, and a visit to
//! one at work.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use sculptd_geometry::TriMesh;
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;

/// Runs the program and returns its answer.
fn sculptd(arguments: &[&str]) -> Value {
    let out = Command::new(env!("CARGO_BIN_EXE_sculptd"))
        .arg("--json")
        .args(arguments)
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{arguments:?}: {said}");
    serde_json::from_slice(&out.stdout).expect("JSON")
}

/// Signed distances of the vertices of `mesh` to the solid in `file`, by the command.
fn distances(file: &Path, mesh: &TriMesh, folder: &Path) -> Vec<f64> {
    let text: String =
        mesh.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    let points = folder.join("points.txt");
    #[allow(clippy::disallowed_methods)] // Input of a test.
    std::fs::write(&points, text).expect("written");
    let [file, points] = [file, &points].map(|p| p.display().to_string());
    let answer = sculptd(&["distance", &file, "--points", &points]);
    let all = answer["distances"].as_array().expect("distances").iter();
    all.map(|d| d.as_f64().expect("a number")).collect()
}

/// The share of the area within `tolerance`, the mean distance beyond it, and the largest distance.
fn share(mesh: &TriMesh, distances: &[f64], tolerance: f64) -> [f64; 3] {
    let mut areas = vec![0.0; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
        t.iter().for_each(|&v| areas[v as usize] += (b - a).cross(c - a).length() / 6.0);
    }
    let near = areas.iter().zip(distances).filter(|(_, d)| d.abs() <= tolerance);
    let near: f64 = near.map(|(area, _)| area).sum();
    let all = areas.iter().sum::<f64>();
    let off = areas.iter().zip(distances).map(|(area, d)| area * (d.abs() - tolerance).max(0.0));
    [near / all, off.sum::<f64>() / all, distances.iter().copied().fold(0.0, f64::max)]
}

#[test]
fn the_score_is_what_the_distance_command_measures() {
    let dir = tempfile::tempdir().expect("a folder");
    for name in ["figurine", "pot", "relief"] {
        let pack = dir.path().join(name);
        let place = pack.display().to_string();
        let facts = sculptd(&["kiosk", "pack", name, &place]);
        let tolerance = facts["steps"][0]["tolerance"].as_f64().expect("a tolerance");
        let [start, goal] = ["start.ply", "goal-1.ply"].map(|file| pack.join(file));
        let work = start.display().to_string();
        let score = sculptd(&["kiosk", "score", &place, &work]);
        assert_eq!(score, facts["steps"][0]["at_start"], "{name}");
        let mesh =
            |path: &Path| read_mesh(path, &Job::default()).expect("a mesh").mesh.triangulate().0;
        let (of_start, of_goal) = (mesh(&start), mesh(&goal));
        let there = share(&of_start, &distances(&goal, &of_start, dir.path()), tolerance);
        let back = share(&of_goal, &distances(&start, &of_goal, dir.path()), tolerance);
        for (key, expected) in [
            ("near", (there[0] + back[0]) / 2.0),
            ("off", (there[1] + back[1]) / 2.0),
            ("too_much", there[2]),
            ("too_little", back[2]),
        ] {
            let found = score[key].as_f64().expect("a number");
            assert!((found - expected).abs() < 1e-3, "{name} {key}: {found}, expected {expected}");
        }
    }
}

#[test]
fn an_exhibit_is_made_from_a_mesh_and_told_what_is_wrong() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name).display().to_string();
    let ring = sculptd_geometry::shapes::torus(20.0, 6.0, 64, 32);
    sculptd_geometry::io::write_mesh(&dir.path().join("ring.stl"), &ring).expect("written");
    let made = sculptd(&["kiosk", "new-exhibit", &at("ring.stl"), "-o", &at("ring.zip")]);
    assert_eq!(made["title"], "ring");
    assert!(made["notes"].to_string().contains("through: 1"), "{made}");
    let more =
        ["--title", "A ring", "--title", "de=Ein Ring", "--text=de=Finde ihn", "--tools=carve"];
    let (from, to) = (at("ring.stl"), at("ring"));
    let both = [&["kiosk", "new-exhibit", &from, "-o", &to][..], &more].concat();
    sculptd(&both);
    let text = std::fs::read_to_string(dir.path().join("ring/exhibit.toml")).expect("a text");
    for line in
        ["de = \"Ein Ring\"", "en = \"A ring\"", "de = \"Finde ihn\"", "tools = [\"carve\"]"]
    {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(text.contains("en = \"It is hidden"), "the usual text in other languages: {text}");
    let shown = sculptd(&["kiosk", "show", &at("ring.zip")]);
    assert_eq!(shown["steps"], made["steps"]);
    assert!(made["steps"][0]["at_start"]["too_little"].as_f64() == Some(0.0), "{made}");
    for (arguments, code, expected) in [
        (vec!["kiosk", "show", "a vase"], 6, "figurine, pot, relief"),
        (vec!["kiosk", "score", "relief", &at("ring.stl"), "--step", "2"], 2, "from 1 to 1"),
        (vec!["kiosk", "new-exhibit", &at("ring.stl"), "-o", &at("x"), "--size=-1"], 2, "--size"),
        (vec!["kiosk", "new-exhibit", &at("none.stl"), "-o", &at("x")], 6, "none.stl"),
        (vec!["run", "--kiosk", "--headless", "--exhibit", "a vase"], 3, "a vase"),
    ] {
        let out = Command::new(env!("CARGO_BIN_EXE_sculptd")).args(&arguments).output();
        let out = out.expect("it runs");
        let said = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}
