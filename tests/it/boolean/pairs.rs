//! Pairs with a name: what a person would cut, and what a file may bring.

use std::process::{Command, Output};

use glam::{DMat3, DVec3};
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, check, repair, shapes};
use serde_json::Value;

use super::solids::{cuboid, hollow, prism};

fn placed(mesh: &PolyMesh, scale: f64, turn: DMat3, shift: DVec3) -> PolyMesh {
    let mut out = mesh.clone();
    out.positions.iter_mut().for_each(|p| *p = turn * *p * scale + shift);
    out
}

fn turn() -> DMat3 {
    DMat3::from_axis_angle(DVec3::new(0.2, 0.9, -0.4).normalize(), 0.8)
}

/// All four results: inclusion and exclusion to 1e-12 of the volumes, closed, manifold. Components
/// and genus of each.
fn sound(name: &str, a: &PolyMesh, b: &PolyMesh) -> Vec<(usize, Option<i64>)> {
    let job = Job::default();
    let (made, report) = compute([a, b], &Operation::ALL, &BooleanOptions::default(), &job, || 0.0)
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(report.warnings.is_empty(), "{name}: {:?}", report.warnings);
    assert!(
        !report.cut.is_empty() && report.cut.iter().all(|l| l.first() == l.last()),
        "{name}: the cut is not closed"
    );
    let facts = |m: &PolyMesh| check::report(m, false, &job).expect("not cancelled");
    let (va, vb) = (facts(a).volume.expect("closed"), facts(b).volume.expect("closed"));
    let v: Vec<f64> = made.iter().map(|m| m.facts.volume).collect();
    for off in [v[0] + v[1] - va - vb, v[2] + v[1] - va, v[3] + v[1] - vb] {
        assert!(off.abs() <= 1e-12 * (va + vb), "{name}: off by {:e}", off / (va + vb));
    }
    made.iter()
        .map(|m| {
            let f = facts(&m.mesh);
            assert!(f.closed && f.manifold && f.oriented, "{name}, {}: {f:?}", m.operation.name());
            (f.components, f.genus)
        })
        .collect()
}

#[test]
fn a_ball_through_all_six_faces_of_a_cube() {
    let cube = cuboid([-1.; 3], [1.; 3]).mesh;
    for (name, at) in [("as it stands", DMat3::IDENTITY), ("turned", turn())] {
        let ball = placed(
            &shapes::icosphere(1.0, 16).to_poly(),
            1.2,
            DMat3::from_rotation_x(0.3),
            DVec3::ZERO,
        );
        let facts = sound(name, &placed(&cube, 1.0, at, DVec3::ZERO), &ball);
        // Cube without ball: its twelve edges, a frame with five handles. Ball without cube: six
        // caps.
        assert_eq!(facts, [(1, Some(0)), (1, Some(0)), (1, Some(5)), (6, Some(0))], "{name}");
    }
}

#[test]
fn a_cylinder_with_a_hook() {
    let post = shapes::cylinder(1.0, 4.0, 24);
    let (lo, hi) = post
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let middle = (lo + hi) * 0.5;
    // Open upwards: out of the post, up.
    let outline = [(0., -0.3), (2.2, -0.3), (2.2, 1.2), (1.7, 1.2), (1.7, 0.3), (0., 0.3)];
    let hook = placed(&prism(&outline, -0.25, 0.25, 1).mesh, 1.0, DMat3::IDENTITY, middle);
    for (name, at) in [("as it stands", DMat3::IDENTITY), ("turned", turn())] {
        let facts =
            sound(name, &placed(&post, 1.0, at, DVec3::ZERO), &placed(&hook, 1.0, at, DVec3::ZERO));
        assert_eq!(facts[0], (1, Some(0)), "{name}");
        assert_eq!(facts[1].0, 1, "{name}");
    }
}

/// A mesh of the corpus, closed where it is open, without what encloses nothing, in a box of size
/// 1.
fn real(file: &str) -> Option<PolyMesh> {
    let folder = crate::corpus()?;
    let job = Job::default();
    let mut mesh = read_mesh(&folder.join("meshes").join(file), &job).expect("readable").mesh;
    repair::weld(&mut mesh, 0.0);
    repair::remove_degenerate(&mut mesh);
    repair::fill_holes(&mut mesh, usize::MAX);
    repair::orient(&mut mesh);
    let (lo, hi) = mesh
        .positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).max_element());
    mesh.positions.iter_mut().for_each(|p| *p = (*p - middle) / size);
    let facts = check::report(&mesh, true, &job).expect("not cancelled");
    if !(facts.closed
        && facts.manifold
        && facts.self_intersections == Some(0)
        && facts.volume > Some(0.0))
    {
        println!("{file}: {:?} crossings, closed {}", facts.self_intersections, facts.closed);
        mesh =
            sculptd_geometry::boolean::solve(&mesh, &job).unwrap_or_else(|e| panic!("{file}: {e}"));
    }
    Some(mesh)
}

#[test]
fn a_pig_and_a_box_the_teapot_and_a_ball_armadillo_and_bunny() {
    let (Some(pig), Some(pot)) = (real("cgal_pig.off"), real("ajc_teapot.obj")) else { return };
    let cube = shapes::cuboid(DVec3::splat(-0.2), DVec3::splat(0.2));
    sound("pig and box", &pig, &placed(&cube, 1.0, turn(), DVec3::new(0.1, 0.05, 0.0)));
    let ball = shapes::icosphere(0.25, 5).to_poly();
    let body = sculptd_geometry::boolean::shells(&pot);
    let body = body.iter().max_by(|a, b| a.face_count().cmp(&b.face_count())).expect("a shell");
    sound("teapot and ball", body, &placed(&ball, 1.0, turn(), DVec3::new(0.2, 0.1, 0.15)));
    let (Some(armadillo), Some(bunny)) = (real("igl_armadillo.obj"), real("irmb_bunny100k.obj"))
    else {
        return;
    };
    let placed = placed(&bunny, 0.8, turn(), DVec3::new(0.05, 0.1, -0.02));
    let facts = sound("armadillo and bunny", &armadillo, &placed);
    println!("armadillo and bunny, components and genus: {facts:?}");
}

fn cli(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sculptd")).args(args).output().expect("the binary starts")
}

fn json(out: &Output) -> Value {
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("one JSON object")
}

#[test]
fn the_command_says_what_it_made_and_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let put = |name: &str, mesh: &PolyMesh| {
        write_mesh(&folder.path().join(name), mesh).expect("written");
        path(name)
    };
    let a = put("a.obj", &cuboid([0.; 3], [2.; 3]).mesh);
    let b = put("b.obj", &cuboid([1.; 3], [3.; 3]).mesh);
    let out = path("out.obj");
    let said = json(&cli(&["boolean", "all", &a, &b, "-o", &out, "--json", "--details"]));
    for (r, volume) in said["results"].as_array().expect("four").iter().zip([15.0, 1.0, 7.0, 7.0]) {
        assert!((r["volume"].as_f64().expect("a volume") - volume).abs() < 1e-12, "{r}");
        assert_eq!(
            (&r["genus"], &r["components"], &r["closed"]),
            (&0.into(), &1.into(), &true.into()),
            "{r}"
        );
        assert_eq!(
            r["origins"].as_array().map(Vec::len),
            r["faces"].as_u64().map(|f| f as usize),
            "{r}"
        );
    }
    let cut = &said["cut"][0];
    assert_eq!((&cut["closed"], cut["length"].as_f64()), (&true.into(), Some(6.0)));
    assert_eq!(cut["points"].as_array().map(Vec::len), Some(7));
    assert!(
        said["phases"]["intersect"].is_number()
            && said["warnings"].as_array().is_some_and(Vec::is_empty)
    );

    let said = json(&cli(&["boolean", "split", &a, "-o", &out, "--json", "--plane", "1,1,0,2"]));
    assert_eq!(
        (&said["results"][0]["volume"], &said["results"][1]["name"]),
        (&4.0.into(), &"below".into())
    );
    let two = put("two.obj", &cuboid([0.; 3], [1.; 3]).and(cuboid([2.; 3], [3.; 3])).mesh);
    let said = json(&cli(&["boolean", "shells", &two, "-o", &out, "--json"]));
    assert_eq!(
        (said["results"].as_array().map(Vec::len), &said["results"][1]["volume"]),
        (Some(2), &1.0.into())
    );

    // Only in contact: nothing, unless contact is kept.
    let c = put("c.obj", &cuboid([0.5, 0.5, 2.], [1., 1., 3.]).mesh);
    let said = json(&cli(&["boolean", "intersection", &a, &c, "-o", &out, "--json"]));
    assert_eq!(
        (&said["results"][0]["faces"], &said["warnings"][0]),
        (&0.into(), &"the intersection is empty".into())
    );
    let said =
        json(&cli(&["boolean", "intersection", &a, &c, "-o", &out, "--json", "--keep-contact"]));
    assert_eq!(
        (&said["results"][0]["faces"], &said["results"][0]["area"]),
        (&2.into(), &0.5.into())
    );

    // Broken operands are refused by name; mended where asked.
    let mut open = cuboid([0.; 3], [2.; 3]).mesh;
    open.face_starts.pop();
    open.corners.truncate(20);
    let mut turned = cuboid([0.; 3], [2.; 3]).mesh;
    repair::flip(&mut turned);
    let (open, turned) = (put("open.obj", &open), put("turned.obj", &turned));
    for (file, why) in [(&open, "A is open: 4 edges"), (&turned, "A is inside out")] {
        let said = cli(&["boolean", "union", file, &b, "-o", &out, "--json"]);
        assert_eq!(said.status.code(), Some(6));
        assert!(
            String::from_utf8_lossy(&said.stderr).contains(why),
            "{}",
            String::from_utf8_lossy(&said.stderr)
        );
        let mended =
            json(&cli(&["boolean", "union", file, &b, "-o", &out, "--json", "--solve", "winding"]));
        let volume = mended["results"][0]["volume"].as_f64().expect("a volume");
        assert!((volume - 15.0).abs() < 1e-9, "{file}: {volume}");
    }
    // Two cubes in one file that cross: counted once.
    let crossed = put(
        "crossed.obj",
        &cuboid([0.; 3], [2.; 3]).and(cuboid([0.9, 1.1, -1.], [3.1, 3.2, 0.95])).mesh,
    );
    let far = put("far.obj", &hollow([8.; 3], [12.; 3], 1.).mesh);
    let said = json(&cli(&["boolean", "union", &crossed, &far, "-o", &out, "--json"]));
    assert!(said["warnings"][0].as_str().is_some_and(|w| w.contains("cross")), "{said}");
    let said = json(&cli(&[
        "boolean", "union", &crossed, &far, "-o", &out, "--json", "--solve", "winding",
    ]));
    let volume = said["results"][0]["volume"].as_f64().expect("a volume");
    assert!(
        (volume - (8.0 + 2.2 * 2.1 * 1.95 - 1.1 * 0.9 * 0.95 + 64.0 - 8.0)).abs() < 1e-9,
        "{volume}"
    );
}

#[test]
fn an_operand_whose_own_pieces_cross_is_solved_where_the_result_does_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let put = |name: &str, mesh: &PolyMesh| {
        write_mesh(&folder.path().join(name), mesh).expect("written");
        path(name)
    };
    let goblet = cuboid([0.; 3], [2.; 3]).and(cuboid([0.5, 0.5, 1.], [1.5, 1.5, 4.])).mesh;
    let a = put("a.obj", &goblet);
    let b = put("b.obj", &cuboid([-1., -1., -1.], [3., 3., 0.]).mesh);
    let out = path("out.obj");
    let said = json(&cli(&["boolean", "all", &a, &b, "-o", &out, "--json"]));
    let union = &said["results"][0];
    assert_eq!((&union["components"], &union["self_intersections"]), (&1.into(), &0.into()));
    assert!((union["volume"].as_f64().expect("a volume") - 26.0).abs() < 1e-9, "{said}");
    let warnings = said["warnings"].to_string();
    assert!(warnings.contains("solved by winding") && !warnings.contains("Filled"), "{warnings}");
}
