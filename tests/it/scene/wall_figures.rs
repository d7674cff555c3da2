//! The walls of one part have the same figures in the command, by the control protocol and in the
//! live map.

use glam::{DQuat, DVec3, Vec3};
use sculptd_clay::Snapshot;
use sculptd_clay::live_thickness::LiveMap;
use sculptd_clay::measured_mask::{MaskMeasure, MeasuredMask};
use sculptd_geometry::TriMesh;
use sculptd_geometry::thickness::MeasuredSide;

use super::*;
use crate::thickness_shapes::{ribbed, shell, slab, tube, wedge};

/// Twenty parts: of hard edges and of none, turned, coarse and fine.
fn parts() -> Vec<PolyMesh> {
    let own = |m: TriMesh| m.to_poly();
    let mut all = vec![
        own(slab(40.0, 2.0, 24)),
        own(shell(10.0, 8.5, 40)),
        own(tube(10.0, 8.0, 30.0, 64, 12, 3)),
        own(wedge(10f32.to_radians(), 24)),
        own(ribbed()),
        shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 20.0, 5.0)),
        shapes::cylinder(6.0, 20.0, 48),
        shapes::cone(8.0, 20.0, 60),
        shapes::torus(20.0, 3.0, 90, 24),
        shapes::uv_sphere(12.0, 24, 48),
    ];
    for i in 0..10 {
        let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.7, 0.2) * (i + 1) as f64);
        let mut part = all[i].clone();
        // In single precision, as the clay has it.
        part.positions.iter_mut().for_each(|p| *p = (turn * *p).as_vec3().as_dvec3());
        all.push(part);
    }
    all
}

/// The thickness and the reason of each vertex, from the map that `--ply` writes.
fn map_of(file: &Path, vertices: usize) -> Vec<(f32, u8)> {
    let bytes = std::fs::read(file).expect("a map");
    let end = b"end_header\n";
    let head = bytes.windows(end.len()).position(|w| w == end).expect("a header") + end.len();
    let rows = bytes[head..].chunks_exact(32).take(vertices);
    rows.map(|r| (f32::from_le_bytes(r[27..31].try_into().expect("four bytes")), r[31])).collect()
}

/// Masks what is thinner than the file's median, and compares the mask with the file's values;
/// returns how many vertices agree, all but `others`.
fn masked(snapshot: &Snapshot, of_file: &[(f32, u8)], others: usize) -> usize {
    let known = |v: &&(f32, u8)| v.1 == 0 && v.0.is_finite();
    let mut values: Vec<f32> = of_file.iter().filter(known).map(|v| v.0).collect();
    if values.is_empty() {
        return 0;
    }
    values.sort_unstable_by(f32::total_cmp);
    let limit = values[values.len() / 2];
    let mask = MeasuredMask::new(snapshot, MaskMeasure::Thin(limit), &Job::default());
    let mask = mask.expect("half of it is so thin");
    let (ranks, mut same, mut different) = (snapshot.ranks(), 0, 0);
    for (number, page) in snapshot.pages().enumerate() {
        let own = mask.pages.iter().find(|p| p.0 as usize == number).map(|p| &p.1);
        for v in 0..page.own() {
            let at = ranks.find(page.topology().ids[v]).expect("a vertex");
            let (value, reason) = of_file[at as usize];
            // Half of the soft border, and no ties with it.
            let border = limit * 1.125;
            if reason != 0 || !value.is_finite() || (value / border - 1.0).abs() < 1e-3 {
                continue;
            }
            let masked = own.is_some_and(|own| own[v] >= 128);
            if masked == (value < border) { same += 1 } else { different += 1 }
        }
    }
    assert!(different <= others, "{different} of {same} are masked otherwise");
    same
}

#[test]
fn one_part_has_one_thickness_in_the_command_the_protocol_the_live_map_and_the_mask() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut compared = 0;
    for (i, part) in parts().iter().enumerate() {
        let path = dir.path().join(format!("part-{i}.obj"));
        write_mesh(&path, part).expect("written");
        let command = |args: &[&str]| -> Value {
            let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"));
            let out = run.arg("thickness").arg(&path).args(args).arg("--json").output();
            let out = out.expect("the binary starts");
            assert!(out.status.success(), "part {i}: {}", String::from_utf8_lossy(&out.stderr));
            serde_json::from_slice(&out.stdout).expect("one JSON object")
        };
        let run = Running::begin(std::slice::from_ref(&path), &dir.path().join(format!("{i}.s")));
        for (args, params) in [
            (&["--method", "ray"][..], json!({ "rays": 1 })),
            (&["--method", "cone", "--rays", "10"], json!({ "rays": 10 })),
            (&["--method", "sphere"], json!({ "method": "sphere" })),
        ] {
            let (file, live) = (command(args), run.ask("thickness", params));
            let digits = |v: &Value| v.as_f64().map(|x| format!("{x:.4}"));
            for name in ["min", "max", "mean", "median"] {
                let same = digits(&file[name]) == digits(&live[name]);
                assert!(same, "part {i}, {args:?}: {name} {} and {}", file[name], live[name]);
            }
            for name in ["lower", "upper"] {
                let (a, b) = (&file["least"][name], &live[name]);
                assert_eq!(digits(a), digits(b), "part {i}, {args:?}: {name}");
            }
            let certified = file["least"]["certified"].as_bool().unwrap_or(false);
            assert_eq!(json!(certified), live["certified"], "part {i}, {args:?}");
            compared += 1;
        }
        // Vertex by vertex, where the map and the live map mean the same: off the sharp edges.
        let ply = dir.path().join("map.ply");
        let ply_path = ply.to_string_lossy().into_owned();
        command(&["--method", "ray", "--spacing", "0", "--ply", &ply_path]);
        let snapshot = run.live.published.load().mesh.clone();
        let job = Job::default();
        let mut map = LiveMap::new(&snapshot, MeasuredSide::Wall, &job).expect("not cancelled");
        assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
        let of_file = map_of(&ply, map.values().len());
        assert_eq!(of_file.len(), map.values().len());
        let (mut same, mut other) = (0, Vec::new());
        for (v, (live, (file, reason))) in map.values().iter().zip(of_file).enumerate() {
            if reason != 0 || !file.is_finite() {
                continue;
            }
            if (live - file).abs() < 5e-5 * file.max(1.0) {
                same += 1;
            } else {
                other.push((v, *live, file));
            }
        }
        // Turned, a ray along a rib's very flank meets it or not by a rounding.
        let jumps = [4, 14].contains(&i);
        assert!(other.len() * 50 <= if jumps { same } else { 0 }, "part {i}: {same}, {other:?}");
        compared += same;
        compared += masked(&snapshot, &map_of(&ply, map.values().len()), other.len());
    }
    assert!(compared > 10_000, "{compared}");
}
