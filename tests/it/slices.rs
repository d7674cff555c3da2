//! `sculptd slice`: what it prints and writes, and how it fails.

use std::process::{Command, Output};

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::shapes::{cuboid, torus};
use serde_json::Value;

fn slice(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.arg("slice").args(args).output().expect("the binary starts")
}

fn json(args: &[&str]) -> Value {
    let out = slice(&[args, &["--json"]].concat());
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("one JSON object")
}

#[test]
fn sections_in_faces_between_them_and_by_layers() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let put = |name: &str, mesh: &PolyMesh| {
        write_mesh(&folder.path().join(name), mesh).expect("written");
        path(name)
    };
    let block = put("block.stl", &cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0)));
    for height in ["0", "1e-9", "5", "20"] {
        let said = json(&[&block, "--height", height]);
        let layer = &said["layers"][0];
        let number = |name: &str| layer[name].as_f64().expect("a number");
        assert!((number("area") - 1200.0).abs() < 1e-9 * 1200.0, "{said}");
        assert!((number("perimeter") - 140.0).abs() < 1e-9 * 140.0, "{said}");
        assert_eq!((&layer["contours"], &layer["open"]), (&1.into(), &0.into()), "{said}");
    }
    let ring = put("ring.obj", &torus(9.0, 2.0, 48, 24));
    let drawing = path("ring.svg");
    let said = json(&[&ring, "--layers", "0.05", "--svg", &drawing]);
    let [whole, sum] = ["volume", "layer_volume"].map(|n| said[n].as_f64().expect("a volume"));
    assert!((sum - whole).abs() < 1e-3 * whole, "{sum} {whole}");
    let layers = said["layers"].as_array().expect("layers");
    assert_eq!(layers.len(), 80);
    assert!(layers.iter().all(|l| l["contours"] == 2 && l["open"] == 0));
    let drawing = std::fs::read_to_string(drawing).expect("a drawing");
    assert_eq!(drawing.matches("<path").count(), 80);
    let away = json(&[&ring, "--height", "-7", "--direction", "0,0,1"]);
    assert_eq!(away["layers"][0]["contours"], 0);
    assert!(away["warnings"][0].as_str().is_some_and(|w| w.contains("does not meet")), "{away}");
    for (args, code) in [
        (&[&ring[..]][..], 2),
        (&[&ring, "--layers", "0"], 2),
        (&[&ring, "--layers", "-1"], 2),
        (&[&ring, "--height", "nan"], 2),
        (&["none.stl", "--height", "1"], 6),
    ] {
        assert_eq!(slice(args).status.code(), Some(code), "{args:?}");
    }
}
