//! Repairs: what `sculptd repair` writes and says, and the method `repair` on a running loop.

use std::path::Path;
use std::process::{Command, Output};

use glam::DVec3;
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::live::Live;
use sculptd_devices::{Clock, queue};
use sculptd_engine::camera::Camera;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::write_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::cuboid;
use serde_json::{Value, json};

use crate::waiting::comes;

fn repair(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.arg("repair").args(args).output().expect("the binary starts")
}

/// The exit code and the object.
fn reported(args: &[&str]) -> (i32, Value) {
    let out = repair(&[args, &["--json"]].concat());
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(!said.contains("panicked"), "{said}");
    let object = serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {said}"));
    (out.status.code().expect("a code"), object)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

/// A cube of 40 with walls of 3 around a cavity.
fn hollow() -> PolyMesh {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(40.0));
    let mut inner = cuboid(DVec3::splat(3.0), DVec3::splat(37.0));
    sculptd_geometry::repair::flip(&mut inner);
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&inner.positions);
    inner.faces().for_each(|f| mesh.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
    mesh
}

fn put(folder: &Path, name: &str, mesh: &PolyMesh) -> String {
    let path = folder.join(name);
    write_mesh(&path, mesh).expect("written");
    path.to_string_lossy().into_owned()
}

#[test]
fn the_file_is_read_and_checked_again() {
    let dir = tempfile::tempdir().expect("a folder");
    let part = put(dir.path(), "part.stl", &hollow());
    let out = dir.path().join("out.stl").to_string_lossy().into_owned();
    for (process, down) in [("sla", false), ("sls", true)] {
        let (code, said) = reported(&[&part, &out, "--drain", "3", "--process", process]);
        assert_eq!((code, &said["repaired"]), (0, &json!(true)), "{said}");
        let made = &said["parts"][0];
        assert_eq!((&made["closed"], &made["self_intersections"]), (&json!(true), &json!(0)));
        let found = made["findings"].as_array().expect("findings");
        assert!(found.iter().all(|f| f["kind"] != "trapped-volume"), "{said}");
        let removed = 40f64.powi(3) - 34f64.powi(3) - number(&made["volume"]);
        let cylinder = std::f64::consts::PI * 1.5 * 1.5 * 3.0;
        assert!((removed - cylinder).abs() < 0.01 * cylinder, "{removed}");
        let hole = &said["holes"][0];
        let fall = number(&hole["from"][2]) - number(&hole["to"][2]);
        assert!((fall - if down { 3.0 } else { 0.0 }).abs() < 1e-3, "{hole}");
    }
    // Inches are converted: the same part, with the same hole in millimetres.
    let mut inches = hollow();
    inches.positions.iter_mut().for_each(|p| *p /= 25.4);
    let inches = put(dir.path(), "inches.ply", &inches);
    let to = dir.path().join("inches-out.ply").to_string_lossy().into_owned();
    let (code, said) =
        reported(&[&inches, &to, "--drain", "3", "--process", "sls", "--unit", "in"]);
    let removed = 40f64.powi(3) - 34f64.powi(3) - number(&said["parts"][0]["volume"]);
    let cylinder = std::f64::consts::PI * 1.5 * 1.5 * 3.0;
    assert!(code == 0 && (removed - cylinder).abs() < 0.01 * cylinder, "{removed}: {said}");
    let (code, said) = reported(&[&part, &out, "--base", "5", "--process", "fdm"]);
    assert_eq!(code, 0, "{said}");
    let base = number(&said["parts"][0]["base_area"]);
    assert!((base - (1600.0 - 34.0 * 34.0)).abs() < 0.1, "{base}");
}

#[test]
fn a_split_writes_two_files_and_draft_turns_the_walls() {
    let dir = tempfile::tempdir().expect("a folder");
    let block = put(dir.path(), "block.stl", &cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 50.0)));
    let out = dir.path().join("half.stl").to_string_lossy().into_owned();
    let (code, said) = reported(&[&block, &out, "--split", "0,0,20,0,0,1", "--pegs", "2"]);
    assert_eq!((code, &said["repaired"]), (0, &json!(true)), "{said}");
    assert_eq!(said["pegs"].as_array().map(Vec::len), Some(2));
    let names: Vec<&str> =
        said["parts"].as_array().expect("two").iter().filter_map(|p| p["file"].as_str()).collect();
    assert!(names[0].ends_with("half-below.stl") && names[1].ends_with("half-above.stl"));
    assert!(names.iter().all(|n| Path::new(n).is_file()));
    let sum: f64 = (0..2).map(|i| number(&said["parts"][i]["volume"])).sum();
    // Two pegs of radius 2 and length 5, and sockets that are 0.2 larger.
    let peg = 24.0 * 4.0 * (std::f64::consts::TAU / 48.0).sin() * 5.0;
    let socket = 48.0 * 2.2 * 2.2 * (std::f64::consts::PI / 48.0).tan() * 5.2;
    let wanted = 60_000.0 + 2.0 * (peg - socket);
    assert!((sum - wanted).abs() < 0.1, "{sum} for {wanted}");
    let drafted = dir.path().join("drafted.stl").to_string_lossy().into_owned();
    let (code, said) = reported(&[&block, &drafted, "--draft", "2", "--process", "moulding"]);
    let found = said["parts"][0]["findings"].as_array().expect("findings");
    assert!(code == 0 && found.iter().all(|f| f["kind"] != "draft"), "{said}");
    let lean = 50.0 * 2f64.to_radians().tan();
    let (w, d) = (40.0 - 2.0 * lean, 30.0 - 2.0 * lean);
    let wanted = 50.0 / 6.0 * (1200.0 + 4.0 * (40.0 - lean) * (30.0 - lean) + w * d);
    let got = number(&said["parts"][0]["volume"]);
    assert!((got - wanted).abs() < 1e-4 * wanted, "{got} for {wanted}");
    let rod = put(dir.path(), "rod.stl", &cuboid(DVec3::ZERO, DVec3::new(5.0, 5.0, 50.0)));
    let (code, said) = reported(&[&rod, &out, "--split", "0,0,20,0,0,1"]);
    assert!(code == 0 && said["pegs"] == json!([]), "{said}");
    assert!(said["warnings"][0].as_str().is_some_and(|w| w.contains("no pegs")), "{said}");
}

#[test]
fn thin_walls_become_thicker_and_a_blade_stays_and_is_named() {
    let dir = tempfile::tempdir().expect("a folder");
    let plate = put(dir.path(), "plate.stl", &cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 0.5)));
    let out = dir.path().join("thicker.stl").to_string_lossy().into_owned();
    let (code, said) = reported(&[&plate, &out, "--thicken", "1.2"]);
    assert_eq!((code, &said["repaired"]), (0, &json!(true)), "{said}");
    let got = number(&said["parts"][0]["volume"]);
    assert!((got - 40.0 * 30.0 * 1.2).abs() < 0.5, "{got}");
    // Half a unit is 12.7 mm.
    let (code, said) = reported(&[&plate, &out, "--thicken", "25.4", "--unit", "in"]);
    let got = number(&said["parts"][0]["volume"]);
    assert!(
        code == 0 && (got / (40.0 * 30.0 * 25.4f64.powi(3)) - 1.0).abs() < 1e-3,
        "{got}: {said}"
    );
    assert_eq!(repair(&[&plate, &out, "--thicken", "0.5"]).status.code(), Some(1));
    let (code, said) = reported(&[
        &plate,
        &out,
        "--text",
        "No.\\n8",
        "--at",
        "20,15,0.5",
        "--letter-height",
        "6",
        "--relief",
        "-0.2",
    ]);
    assert_eq!((code, &said["repaired"]), (0, &json!(true)), "{said}");
    let got = number(&said["parts"][0]["volume"]);
    assert!(got < 600.0 - 4.0 && got > 600.0 - 20.0, "{got}");
    // Far from the origin and turned, where single precision is coarse beside the letters' curves.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, 2.0);
    let mut far = cuboid(DVec3::ZERO, DVec3::new(60.0, 30.0, 4.0));
    far.positions.iter_mut().for_each(|p| *p = turn * *p + DVec3::new(300.0, -500.0, 200.0));
    let far = put(dir.path(), "far.stl", &far);
    let [x, y, z] = (turn * DVec3::new(30.0, 15.0, 4.0) + DVec3::new(300.0, -500.0, 200.0)).into();
    let at = format!("{x},{y},{z}");
    for relief in ["0.6", "-0.6"] {
        let args = [&far, &out, "--text", "No. 8 &", "--at", &at, "--relief", relief];
        let (code, said) = reported(&args);
        assert_eq!((code, &said["repaired"]), (0, &json!(true)), "{said}");
    }
    for at in ["0,0,0.5", "20,15"] {
        let args = [&plate, &out, "--text", "x", "--at", at];
        assert_eq!(repair(&args).status.code(), Some(2), "{at}");
    }
    let mut blade = cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 8.0));
    blade.positions.iter_mut().filter(|p| p.x == 0.0).for_each(|p| p.z = 0.0);
    sculptd_geometry::repair::weld(&mut blade, 0.0);
    let blade = put(dir.path(), "blade.stl", &blade);
    let (code, said) = reported(&[&blade, &out, "--thicken", "1.2"]);
    let left = said["left"][0].as_str().expect("a sentence");
    assert!(code == 1 && left.contains("thinner than 1.2 mm"), "{said}");
    assert!(said["warnings"].to_string().contains("stayed at 0.0"), "{said}");
}

#[test]
fn what_cannot_be_repaired_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let part = put(dir.path(), "part.stl", &hollow());
    let out = dir.path().join("out.stl").to_string_lossy().into_owned();
    let absent = dir.path().join("absent.stl").to_string_lossy().into_owned();
    for (args, code) in [
        (vec![&part[..], &out], 2),
        (vec![&part, &out, "--base", "1", "--drain", "3"], 2),
        (vec![&part, &out, "--base", "41"], 2),
        (vec![&part, &out, "--drain", "0"], 2),
        (vec![&part, &out, "--vent", "3", "--process", "fdm"], 2),
        (vec![&part, &out, "--vent", "3", "--process", "sla"], 1),
        (vec![&part, &out, "--split", "0,0,90,0,0,1"], 2),
        (vec![&part, &out, "--split", "0,0,20,0,0,0"], 2),
        (vec![&part, &part, "--base", "1"], 2),
        (vec![&absent, &out, "--base", "1"], 6),
    ] {
        let done = repair(&args);
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(code), "{args:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
    }
    assert!(!Path::new(&out).exists(), "nothing was written");
}

fn live(mesh: &PolyMesh) -> (Live, Host) {
    let clay = Clay::build(&mesh.triangulate().0, &Job::default()).expect("builds");
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 28, hands: Default::default() };
    let brush = sculptd::presets().of(sculptd_clay::brush::BrushKind::Draw);
    let world = World::new(clay, Camera::default(), brush, Workers::new(1), options);
    let (_factory, receiver) = queue::channel(64);
    let clock = Clock::monotonic();
    let live = Live::start(world, receiver, clock, LoopConfig::default(), 64, None).expect("runs");
    let presets = sculptd::presets().clone();
    let host = Host::new(live.commands.clone(), live.published.clone(), presets);
    (live, host)
}

#[test]
fn each_repair_of_the_loop_is_one_step_of_undo() {
    let (_live, host) = live(&hollow());
    let ask = |method: &str, params: Value| call(&host, method, params).expect(method);
    let hash = || ask("hash", Value::Null)["hash"].clone();
    let objects = || ask("scene.list", Value::Null)["objects"].as_array().map_or(0, Vec::len);
    let before = hash();
    let done = ask("repair", json!({ "repair": { "drain": { "diameter": 3.0 } } }));
    assert_eq!(done["repaired"], true, "{done}");
    assert_eq!(done["objects"][0]["trapped"], json!([]), "{done}");
    let hole = &done["holes"][0];
    // Up is y: on a plate the hole leads out level.
    assert!((number(&hole["from"][1]) - number(&hole["to"][1])).abs() < 1e-3, "{hole}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before));
    let done = ask("repair", json!({ "repair": { "base": 5.0 }, "up": [0, 0, 1] }));
    let base = number(&done["objects"][0]["base_area"]);
    assert!(done["repaired"] == true && (base - 444.0).abs() < 0.1, "{done}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before));
    let plane = json!({ "point": [0, 0, 1.5], "normal": [0, 0, 1], "radius": 0.3, "length": 0.5 });
    let done = ask("repair", json!({ "repair": { "split": plane } }));
    assert!(done["repaired"] == true && objects() == 2, "{done}");
    assert_eq!(done["objects"].as_array().map(Vec::len), Some(2));
    let volume: f64 = (0..2).map(|i| number(&done["objects"][i]["volume"])).sum();
    assert!((volume - (40f64.powi(3) - 34f64.powi(3))).abs() < 5.0, "{volume}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before && objects() == 1));
    let done = ask("repair", json!({ "repair": { "draft": 2.0 } }));
    // The cavity is closed in both directions: its walls stay, and are named.
    assert!(done["repaired"] == true && done["notes"][0].is_string(), "{done}");
    let lean = 40.0 * 2f64.to_radians().tan();
    let (top, middle) = ((40.0 - 2.0 * lean).powi(2), (40.0 - lean).powi(2));
    let outer = 40.0 / 6.0 * (1600.0 + 4.0 * middle + top);
    let got = number(&done["objects"][0]["volume"]);
    assert!((got - (outer - 34f64.powi(3))).abs() < 1.0, "{got}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before));
    let done = ask("repair", json!({ "repair": { "thicken": 5.0 } }));
    let got = number(&done["objects"][0]["volume"]);
    // The outer faces have no corner over the cavity: the inner ones move.
    let wanted = 40f64.powi(3) - 30f64.powi(3);
    assert!(done["repaired"] == true && (got - wanted).abs() < 10.0, "{got}: {done}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before));
    let text = json!({ "text": "No. 8", "at": [20, 20, 99], "height": 6, "relief": 1.5 });
    let done = ask("repair", json!({ "repair": { "text": text } }));
    let got = number(&done["objects"][0]["volume"]);
    let solid = 40f64.powi(3) - 34f64.powi(3);
    assert!(done["repaired"] == true && got > solid + 50.0 && got < solid + 200.0, "{got}: {done}");
    ask("undo", Value::Null);
    assert!(comes(|| hash() == before));
    for bad in [
        json!({ "repair": { "text": { "text": "x", "at": [0, 0, 0], "height": 90, "relief": 1 }}}),
        json!({ "repair": { "text": { "text": "", "at": [0, 0, 0], "height": 1, "relief": 1 } } }),
        json!({ "repair": { "draft": 60.0 } }),
        json!({ "repair": { "thicken": 2.0 } }),
        json!({ "repair": { "base": 90.0 } }),
        json!({ "repair": { "vent": { "diameter": 3.0 } } }),
        json!({ "repair": { "base": 1.0 }, "up": [0, 0, 0] }),
        json!({ "repair": { "base": -1.0 } }),
        json!({ "repair": { "split": { "point": [0, 0, 99], "normal": [0, 0, 1] } } }),
    ] {
        call(&host, "repair", bad.clone()).expect_err(&bad.to_string());
    }
    assert_eq!(hash(), before);
}

#[test]
fn an_object_that_is_turned_and_scaled_is_repaired_in_the_units_of_the_world() {
    let mut small = hollow();
    small.positions.iter_mut().for_each(|p| *p /= 10.0);
    let (_live, host) = live(&small);
    let ask = |method: &str, params: Value| call(&host, method, params).expect(method);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let place = json!({ "shift": [5.0, 7.0, -3.0], "turn": [half, 0.0, 0.0, half], "scale": 10.0 });
    ask("scene.transform", json!({ "id": 0, "transform": place }));
    let done = ask("repair", json!({ "repair": { "drain": { "diameter": 3.0 } }, "plate": false }));
    assert_eq!(done["repaired"], true, "{done}");
    let cylinder = std::f64::consts::PI * 1.5 * 1.5 * 3.0;
    let removed = 40f64.powi(3) - 34f64.powi(3) - number(&done["objects"][0]["volume"]);
    assert!((removed - cylinder).abs() < 0.02 * cylinder, "{removed}");
    ask("undo", Value::Null);
    let y = 7.0 - 1.5;
    let plane = json!({ "point": [0, y, 0], "normal": [0, 1, 0], "radius": 0.3, "length": 0.5 });
    let done = ask("repair", json!({ "repair": { "split": plane } }));
    assert!(done["pegs"].as_array().is_some_and(|p| !p.is_empty()), "{done}");
    for peg in done["pegs"].as_array().expect("pegs") {
        assert!((number(&peg[1]) - y).abs() < 1e-4, "{peg}");
    }
}
