//! `sculptd check`: what it prints and writes, and how it fails.

use std::path::Path;
use std::process::{Command, Output};

use glam::{DQuat, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::{cone, cuboid, torus};
use serde_json::Value;

fn check(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sculptd"));
    command.arg("check").args(args).output().expect("the binary starts")
}

/// The exit code and the object.
fn json(args: &[&str]) -> (i32, Value) {
    let out = check(&[args, &["--json"]].concat());
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(!said.contains("panicked"), "{said}");
    let object = serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {said}"));
    (out.status.code().expect("a code"), object)
}

fn put(folder: &Path, name: &str, mesh: &PolyMesh) -> String {
    let path = folder.join(name);
    write_mesh(&path, mesh).expect("written");
    path.to_string_lossy().into_owned()
}

/// A plate on a column in its middle.
fn table() -> PolyMesh {
    let mut mesh = cuboid(DVec3::new(-20.0, -15.0, 20.0), DVec3::new(20.0, 15.0, 24.0));
    let leg = cuboid(DVec3::new(-5.0, -5.0, 0.0), DVec3::new(5.0, 5.0, 21.0));
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&leg.positions);
    leg.faces().for_each(|f| mesh.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
    sculptd_geometry::boolean::solve(&mesh, &Job::default()).expect("a union")
}

#[test]
fn a_good_part_passes_and_a_bad_one_says_where_and_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let block = put(folder.path(), "block.stl", &cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0)));
    for process in ["fdm", "sla", "sls"] {
        let (code, said) = json(&[&block, "--process", process]);
        assert_eq!((code, &said["ok"]), (0, &Value::Bool(true)), "{said}");
        assert_eq!(said["findings"], Value::Array(Vec::new()));
        assert_eq!(said["process"], process);
        let volume = said["volume"].as_f64().expect("a volume");
        assert!((volume - 24000.0).abs() < 0.1 && said["seconds"].as_f64().is_some(), "{said}");
        assert!(said["checks"].as_array().is_some_and(|c| c.iter().all(|c| c["ran"] == true)));
    }
    let (code, said) = json(&[&put(folder.path(), "table.stl", &table())]);
    assert_eq!((code, &said["ok"]), (1, &Value::Bool(false)), "{said}");
    let found = said["findings"].as_array().expect("findings");
    let overhang = found.iter().find(|f| f["kind"] == "overhang").expect("an overhang");
    for field in ["kind", "severity", "position", "value", "limit", "unit", "message"] {
        assert!(!overhang[field].is_null(), "{field}: {overhang}");
    }
    assert_eq!((&overhang["severity"], &overhang["unit"]), (&"error".into(), &"degrees".into()));
    assert!((overhang["area"].as_f64().expect("an area") - 1100.0).abs() < 0.1, "{overhang}");
    let support = said["support_volume"].as_f64().expect("a volume");
    assert!((support - 22000.0).abs() < 22.0, "{support}");
    let said = check(&[&put(folder.path(), "table.stl", &table())]);
    assert!(String::from_utf8_lossy(&said.stdout).contains("overhang"));
    assert!(String::from_utf8_lossy(&said.stderr).contains("overhang"));
}

#[test]
fn the_same_part_in_other_units_and_turned_gives_the_same_findings() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = table();
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 0.8, -1.9);
    let mut turned = mesh.clone();
    turned.positions.iter_mut().for_each(|p| *p = turn * *p);
    let mut inches = mesh.clone();
    inches.positions.iter_mut().for_each(|p| *p /= 25.4);
    let up = turn * DVec3::Z;
    let up = format!("{},{},{}", up.x, up.y, up.z);
    let summary = |said: &Value| -> Vec<(String, i64)> {
        let found = said["findings"].as_array().expect("findings");
        let value = |f: &Value| (f["value"].as_f64().unwrap_or(0.0) * 100.0).round() as i64;
        found.iter().map(|f| (f["kind"].to_string(), value(f))).collect()
    };
    for process in ["fdm", "sla", "moulding"] {
        let own = json(&[&put(folder.path(), "a.stl", &mesh), "--process", process]).1;
        let other = put(folder.path(), "b.stl", &turned);
        let other = json(&[&other, "--process", process, "--up", &up]).1;
        let small = put(folder.path(), "c.stl", &inches);
        let small = json(&[&small, "--process", process, "--unit", "in"]).1;
        assert_eq!(summary(&own), summary(&other), "{process}");
        assert_eq!(summary(&own), summary(&small), "{process}");
    }
}

#[test]
fn the_turned_part_is_written_and_has_what_was_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let part = put(folder.path(), "table.stl", &table());
    let turned = folder.path().join("turned.stl").to_string_lossy().into_owned();
    let (code, said) = json(&[&part, "--orient", &turned]);
    assert_eq!(code, 1, "the part as it is has an overhang");
    let all = said["orientations"].as_array().expect("orientations");
    let best = &all[0];
    for field in ["direction", "support_volume", "height", "contact_area"] {
        assert!(!best[field].is_null(), "{field}: {best}");
    }
    assert!(said["reasons"].as_array().is_some_and(|r| !r.is_empty()));
    let (_, again) = json(&[&turned]);
    let (a, b) = (again["support_volume"].as_f64(), best["support_volume"].as_f64());
    let (a, b) = (a.expect("a volume"), b.expect("a volume"));
    assert!((a - b).abs() <= 0.01 * b + 0.1 && b < 22000.0, "{a} {b}");
    let mesh = read_mesh(Path::new(&turned), &Job::default()).expect("readable").mesh;
    let low = mesh.positions.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    assert!(low.abs() < 1e-5, "on the plate: {low}");
}

#[test]
fn reports_presets_and_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let ring = put(folder.path(), "ring.obj", &torus(9.0, 3.0, 48, 24));
    let (page, junit) = (path("ring.html"), path("ring.xml"));
    let out = check(&[&ring, "--report", &page, "--junit", &junit]);
    assert_eq!(out.status.code(), Some(1));
    let page = std::fs::read_to_string(page).expect("a page");
    assert!(page.contains("overhang") && page.contains("<img") && page.ends_with("</html>\n"));
    assert!(!page.contains(&*folder.path().to_string_lossy()), "no local path");
    let junit = std::fs::read_to_string(junit).expect("a page");
    assert!(junit.contains("failures=\"1\""), "{junit}");

    let text =
        include_str!("../../config/check/fdm.toml").replace("overhang = 45.0", "overhang = 89.9");
    let own = path("own.toml");
    let write = |path: &str, text: &str| {
        sculptd_geometry::io::write_beside(Path::new(path), |w| w.write_all(text.as_bytes()))
            .expect("written");
    };
    write(&own, &text.replace("name = \"fdm\"", "name = \"mine\""));
    let (_, said) = json(&[&ring, "--process", &own]);
    assert_eq!(said["process"], "mine");
    assert!(said["findings"].as_array().is_some_and(|f| f.iter().all(|f| f["kind"] != "overhang")));

    let broken = path("broken.stl");
    write(&broken, "solid nothing\n");
    let bad = path("bad.toml");
    write(&bad, "kind = \"process\"\n");
    for (args, code) in [
        (&[&broken[..]][..], 6),
        (&["none.stl"], 6),
        (&[&ring, "--process", "casting"], 2),
        (&[&ring, "--printer", "sla-145", "--process", "fdm"], 2),
        (&[&ring, "--material", "wood"], 2),
        (&[&ring, "--up", "0,0,0"], 2),
        (&[&ring, "--process", &bad], 3),
        (&[&ring, "--printer", &own], 3),
        (&[&ring, "--orient", "turned.xyz"], 2),
        (&[&ring, "--orient", &ring], 2),
        (&[], 2),
    ] {
        let out = check(args);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(code), "{args:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
    }
    let several = json(&[&ring, &put(folder.path(), "cone.stl", &cone(8.0, 9.0, 24))]).1;
    assert_eq!(several["parts"].as_array().map(Vec::len), Some(2));
    // The machine of the printer is the process.
    assert_eq!(json(&[&ring, "--printer", "sls-165"]).1["process"], "sls");
}

#[test]
fn a_batch_is_resumed_and_its_shards_make_one_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let parts = folder.path().join("parts");
    std::fs::create_dir(&parts).expect("made");
    for i in 0..7 {
        let height = 5.0 + f64::from(i);
        put(&parts, &format!("p{i}.stl"), &cuboid(DVec3::ZERO, DVec3::new(20.0, 15.0, height)));
    }
    put(&parts, "table.stl", &table());
    sculptd_geometry::io::write_beside(&parts.join("torn.stl"), |w| w.write_all(b"solid"))
        .expect("written");
    let from = parts.to_string_lossy().into_owned();
    let out = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (code, said) = json(&[&from, "--out", &out("whole")]);
    assert_eq!((code, said["parts"].as_array().map(Vec::len)), (1, Some(9)), "{said}");
    assert_eq!(said["reused"], 0);
    let (_, said) = json(&[&from, "--out", &out("whole"), "--jobs", "1"]);
    assert_eq!(said["reused"], 8, "all but the torn file");
    // A part that changed is checked again.
    put(&parts, "p3.stl", &cuboid(DVec3::ZERO, DVec3::new(21.0, 15.0, 8.0)));
    assert_eq!(json(&[&from, "--out", &out("whole")]).1["reused"], 7);
    for shard in ["1/3", "2/3", "3/3"] {
        json(&[&from, "--out", &out("shards"), "--shard", shard]);
    }
    let (_, merged) = json(&["--merge", "--out", &out("shards")]);
    assert_eq!(merged["parts"].as_array().map(Vec::len), Some(9));
    let table = |name: &str| {
        let path = folder.path().join(name).join("results.csv");
        std::fs::read_to_string(path).expect("a table")
    };
    assert_eq!(table("whole"), table("shards"));
    assert!(folder.path().join("shards/index.html").is_file());
    assert_eq!(check(&["--merge", "--out", &out("nothing")]).status.code(), Some(6));
}

#[cfg(target_os = "linux")]
#[test]
fn a_batch_that_is_killed_and_started_again_gives_the_same_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let parts = folder.path().join("parts");
    std::fs::create_dir(&parts).expect("made");
    for i in 0..100u32 {
        let mesh = torus(9.0 + f64::from(i % 7), 2.0, 96, 48);
        put(&parts, &format!("ring{i}.stl"), &mesh);
    }
    let from = parts.to_string_lossy().into_owned();
    let out = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let rows = |name: &str| {
        let entries = std::fs::read_dir(folder.path().join(name)).into_iter().flatten().flatten();
        let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
        names.filter(|n| n.ends_with(".row.json")).count()
    };
    // A whole run says how long a kill may wait; `kill` sends SIGKILL.
    let clock = sculptd_devices::Clock::monotonic();
    json(&[&from, "--out", &out("whole")]);
    let whole_us = clock.now_us();
    let kills = if std::env::var_os("SCULPTD_LONG").is_some() { 24 } else { 2 };
    let mut random = crate::seeded::Random(54_2026);
    let mut done = Vec::new();
    for _ in 0..kills {
        let mut running = Command::new(env!("CARGO_BIN_EXE_sculptd"))
            .args(["check", &from, "--out", &out("killed")])
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("the binary starts");
        let wait = whole_us as f64 * 1e-3 * random.part() * 1.5 / f64::from(kills);
        crate::waiting::pause(wait as u64);
        running.kill().expect("killed, or ended by itself");
        running.wait().expect("it ended");
        done.push(rows("killed"));
    }
    println!("rows after each kill: {done:?}");
    assert!(done.is_sorted(), "no row is lost: {done:?}");
    let (_, said) = json(&[&from, "--out", &out("killed")]);
    let reused = said["reused"].as_u64().expect("a count") as usize;
    assert_eq!(Some(&reused), done.last(), "{said}");
    let table = |name: &str| {
        let path = folder.path().join(name).join("results.csv");
        std::fs::read_to_string(path).expect("a table")
    };
    assert_eq!(table("killed"), table("whole"));
    assert_eq!(table("whole").lines().count(), 101);

    // The example for a cluster: each task of the array takes its share.
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/config/batch/slurm.sh");
    for task in ["4", "5", "6"] {
        let ran = Command::new("bash")
            .args([script, &from, &out("array"), "--process", "fdm"])
            .env("SCULPTD", env!("CARGO_BIN_EXE_sculptd"))
            .env("SLURM_ARRAY_TASK_ID", task)
            .env("SLURM_ARRAY_TASK_MIN", "4")
            .env("SLURM_ARRAY_TASK_COUNT", "3")
            .env("SLURM_CPUS_PER_TASK", "2")
            .output()
            .expect("bash starts");
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    }
    json(&["--merge", "--out", &out("array")]);
    assert_eq!(table("array"), table("whole"));
    // The command of the indexed job, as its shell runs it.
    let job = include_str!("../../config/batch/kubernetes.yaml");
    let lines = job.lines().skip_while(|l| !l.contains("sculptd check /parts")).take(2);
    let command: Vec<&str> = lines.map(str::trim).collect();
    let command = command.join(" ").replace("/parts", &from).replace("/out", &out("pods"));
    let command =
        command.replace("sculptd check", &format!("{} check", env!("CARGO_BIN_EXE_sculptd")));
    for index in ["0", "1"] {
        let ran = Command::new("sh")
            .args(["-c", &command])
            .env("JOB_COMPLETION_INDEX", index)
            .env("SHARDS", "2")
            .output()
            .expect("sh starts");
        assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
    }
    json(&["--merge", "--out", &out("pods")]);
    assert_eq!(table("pods"), table("whole"));
}
