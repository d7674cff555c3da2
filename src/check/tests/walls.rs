//! Walls, pins, gaps, holes, the first layer and the mesh itself: parts made by formula.

mod common;

use common::*;
use glam::{DVec3, Vec3};
use sculptd_check::FindingKind::{
    Contact, Gap, Hole, NestedShell, NotChecked, Open, Orientation, SelfIntersection, Size, Sliver,
    ThinPin, ThinWall, Tipping,
};
use sculptd_check::{CheckSettings, Severity};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::bvh::Bvh8;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::{cuboid, icosphere};
use sculptd_geometry::thickness::ray::{Caster, Site};
use sculptd_geometry::thickness::side_cones::SideCones;
use sculptd_geometry::thickness::{Cone, Correction, Outliers, Weights};

/// A base with a fin of this thickness on it.
fn fin(thick: f64) -> PolyMesh {
    let profile = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 5.0],
        [20.0 + thick, 5.0],
        [20.0 + thick, 20.0],
        [20.0, 20.0],
        [20.0, 5.0],
        [0.0, 5.0],
    ];
    drawn_out(&profile, 30.0)
}

#[test]
fn a_thin_wall_is_found_where_it_is() {
    for thick in [0.3, 0.5, 0.79] {
        found_everywhere(&fin(thick), "fdm", ThinWall, thick, |p| p.x > 19.9 && p.x < 21.0);
        assert!(!checked(&fin(thick), "fdm").ok);
    }
    let advised = checked(&fin(1.0), "fdm");
    let found = of(&advised, ThinWall);
    assert!(advised.ok && found[0].severity == Severity::Warning, "{found:?}");
    for thick in [1.2, 2.0, 9.0] {
        found_nowhere(&fin(thick), "fdm", ThinWall);
    }
    // A tie with the failing limit is a warning only.
    assert!(checked(&fin(0.8), "fdm").ok);
}

/// A base with a round pin on it.
fn pin(radius: f64) -> PolyMesh {
    let p = [[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [radius, 5.0], [radius, 15.0], [0.0, 15.0]];
    revolved(&p, 64)
}

#[test]
fn a_thin_pin_is_found_where_it_is() {
    for radius in [0.2, 0.3, 0.39] {
        let at_pin = |p: DVec3| p.truncate().length() < radius * 1.1 && p.z > 4.9;
        found_everywhere(&pin(radius), "fdm", ThinPin, 2.0 * radius, at_pin);
    }
    for radius in [0.7, 1.0, 3.0] {
        found_nowhere(&pin(radius), "fdm", ThinPin);
    }
}

/// Two blocks on a base with a slot between them.
fn slot(wide: f64) -> PolyMesh {
    let profile = [
        [0.0, 0.0],
        [40.0 + wide, 0.0],
        [40.0 + wide, 20.0],
        [20.0 + wide, 20.0],
        [20.0 + wide, 5.0],
        [20.0, 5.0],
        [20.0, 20.0],
        [0.0, 20.0],
    ];
    drawn_out(&profile, 30.0)
}

/// A block of revolution with a hole through it.
fn bored(radius: f64) -> PolyMesh {
    revolved(&[[radius, 0.0], [10.0, 0.0], [10.0, 8.0], [radius, 8.0]], 64)
}

#[test]
fn narrow_gaps_and_holes_are_found_where_they_are() {
    for wide in [0.1, 0.2, 0.39] {
        found_everywhere(&slot(wide), "fdm", Gap, wide, |p| p.x > 19.9 && p.x < 20.5);
        found_nowhere(&slot(wide), "fdm", Hole);
    }
    for radius in [0.2, 0.4, 0.48] {
        let inside = |p: DVec3| p.truncate().length() < radius * 1.1;
        found_everywhere(&bored(radius), "fdm", Hole, 2.0 * radius, inside);
        found_nowhere(&bored(radius), "fdm", Gap);
    }
    for wide in [0.4, 0.5, 3.0] {
        found_nowhere(&slot(wide), "fdm", Gap);
        found_nowhere(&slot(wide), "fdm", Hole);
    }
    for radius in [0.51, 1.0, 4.0] {
        found_nowhere(&bored(radius), "fdm", Hole);
        found_nowhere(&bored(radius), "fdm", Gap);
    }
}

#[test]
fn a_small_first_layer_is_found_and_so_is_a_part_that_falls() {
    for side in [2.0, 3.0, 4.9] {
        let tower = block([0.0; 3], [side, side, 8.0]);
        found_everywhere(&tower, "fdm", Contact, side * side, |p| p.z < 0.2);
    }
    for side in [5.0, 6.0, 20.0] {
        found_nowhere(&block([0.0; 3], [side, side, 8.0]), "fdm", Contact);
    }
    // An L on its foot: the arm pulls the centre of mass over the edge.
    let gallows = |arm: f64| {
        let profile = [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 30.0],
            [10.0 + arm, 30.0],
            [10.0 + arm, 40.0],
            [0.0, 40.0],
        ];
        drawn_out(&profile, 10.0)
    };
    for arm in [40.0f64, 60.0, 90.0] {
        let (post, beam) = (400.0, arm * 10.0);
        let x = (post * 5.0 + beam * (10.0 + arm * 0.5)) / (post + beam);
        let z = (post * 20.0 + beam * 35.0) / (post + beam);
        let angle = (10.0f64 - x).atan2(z).to_degrees();
        found_everywhere(&gallows(arm), "fdm", Tipping, angle, |p| (p.x - x).abs() < 0.1);
    }
    for arm in [2.0, 5.0, 10.0] {
        found_nowhere(&gallows(arm), "fdm", Tipping);
    }
}

#[test]
fn a_part_larger_than_its_printer_is_found() {
    let library = library();
    let process = library.process("fdm").expect("known");
    let printer = library.printer("fdm-220").expect("known");
    let settings =
        CheckSettings::new(&library, process, Some(printer), None, DVec3::Z).expect("settings");
    let size = |x: f64, y: f64, z: f64| {
        let answer = checked_with(&block([0.0; 3], [x, y, z]), &settings);
        of(&answer, Size).first().and_then(|f| f.value)
    };
    assert_eq!(size(220.0, 220.0, 250.0), None);
    assert_eq!(size(100.0, 219.0, 10.0), None);
    assert_eq!(size(290.0, 10.0, 10.0), None, "along the diagonal of the plate");
    for (x, y, z, value) in
        [(221.0, 220.0, 10.0, 221.0), (10.0, 10.0, 260.0, 260.0), (320.0, 10.0, 10.0, 233.345)]
    {
        let found = size(x, y, z).expect("too large");
        assert!((found - value).abs() < 0.01 * value, "{found} {value}");
    }
}

#[test]
fn a_mesh_that_is_no_solid_is_found_and_nothing_else_is_claimed() {
    let cube = block([0.0; 3], [20.0, 20.0, 20.0]);
    let mut open = PolyMesh::new();
    open.positions.clone_from(&cube.positions);
    cube.faces().skip(1).for_each(|f| open.push_face(f));
    let mut torn = cube.triangulate().0.to_poly();
    torn.corners.truncate(33);
    torn.face_starts.truncate(12);
    let sheet = sculptd_geometry::shapes::grid(10.0, 10.0, 3, 3);
    for mesh in [&open, &torn, &sheet] {
        for process in ["fdm", "sla", "sls", "moulding"] {
            let answer = checked(mesh, process);
            assert!(!answer.ok && of(&answer, Open).len() == 1, "{:#?}", answer.findings);
            let skipped = answer.checks.iter().filter(|c| !c.ran).count();
            assert!(skipped > 1 && of(&answer, NotChecked).len() == skipped);
        }
    }
    let mut single = PolyMesh::new();
    single.positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    single.push_face(&[0, 1, 2]);
    let mut nan = cube.clone();
    nan.positions[3].y = f64::NAN;
    let mut flat = cube.clone();
    flat.positions.iter_mut().for_each(|p| p.z = 0.0);
    let mut huge = cube.clone();
    huge.positions.iter_mut().for_each(|p| *p *= 1e30);
    for mesh in [&PolyMesh::new(), &single, &nan, &flat, &huge] {
        for process in ["fdm", "sla", "sls", "moulding"] {
            assert!(!checked(mesh, process).ok);
        }
    }
    for good in [cube, fin(2.0), sculptd_geometry::shapes::torus(9.0, 3.0, 48, 24)] {
        found_nowhere(&good, "fdm", Open);
        found_nowhere(&good, "fdm", Orientation);
        found_nowhere(&good, "fdm", SelfIntersection);
        found_nowhere(&good, "fdm", NestedShell);
        found_nowhere(&good, "fdm", Sliver);
    }
}

#[test]
fn orientation_crossings_and_nested_shells_are_found() {
    let cube = block([0.0; 3], [20.0; 3]);
    let answer = checked(&flipped(&cube), "fdm");
    let found = of(&answer, Orientation);
    assert!(found.len() == 1 && !answer.ok, "{:#?}", answer.findings);
    assert_eq!(found[0].value, Some(-8000.0));
    assert!(answer.checks.iter().all(|c| c.ran), "the other checks look at the turned part");
    let mut one = cube.clone();
    one.turn_face(2);
    let answer = checked(&one, "fdm");
    assert_eq!(of(&answer, Orientation)[0].value, Some(4.0), "{:#?}", answer.findings);
    let mut several = cube.clone();
    several.turn_face(0);
    several.turn_face(1);
    assert!(!of(&checked(&several, "fdm"), Orientation).is_empty());

    for shift in [5.0, 12.0, 19.5] {
        let other = block([shift, 3.0, 4.0], [20.0 + shift, 23.0, 24.0]);
        let answer = checked(&joined(&cube, &other), "fdm");
        let found = of(&answer, SelfIntersection);
        assert!(found.len() == 1 && !answer.ok, "{:#?}", answer.findings);
        // The other checks look at the union.
        let volume = answer.facts.volume.expect("a volume");
        let known = 16000.0 - (20.0 - shift) * 17.0 * 16.0;
        assert!((volume - known).abs() < 1e-3 * known, "{volume} {known}");
    }
    for side in [2.0, 5.0, 9.0] {
        let inner = block([5.0; 3], [5.0 + side; 3]);
        let answer = checked(&joined(&cube, &inner), "fdm");
        let found = of(&answer, NestedShell);
        assert!(found.len() == 1 && !answer.ok, "{:#?}", answer.findings);
        let value = found[0].value.expect("a volume");
        assert!((value - side.powi(3)).abs() < 1e-3 * value);
        assert_eq!(answer.facts.volume.map(f64::round), Some(8000.0));
    }
    // Apart, and as a cavity, a second shell is none.
    let apart = joined(&cube, &block([30.0, 0.0, 0.0], [50.0, 20.0, 20.0]));
    found_nowhere(&apart, "sls", NestedShell);
    let cavity = joined(&cube, &flipped(&block([5.0; 3], [9.0; 3])));
    found_nowhere(&cavity, "sls", NestedShell);
    found_nowhere(&cavity, "sls", Orientation);
    found_nowhere(&joined(&cavity, &block([6.0; 3], [8.0; 3])), "sls", NestedShell);
}

#[test]
fn slivers_are_a_warning() {
    let mut mesh = block([0.0; 3], [20.0; 3]).triangulate().0.to_poly();
    // A vertex just beside an edge.
    let (a, b, c) = (mesh.corners[0], mesh.corners[1], mesh.corners[2]);
    let at = |v: u32| mesh.positions[v as usize];
    let middle = (at(a) + at(b)) * 0.5 + (at(c) - at(a)) * 1e-6;
    let m = mesh.positions.len() as u32;
    mesh.positions.push(middle);
    mesh.corners[2] = m;
    mesh.push_face(&[b, c, m]);
    mesh.push_face(&[c, a, m]);
    let answer = checked(&mesh, "fdm");
    let found = of(&answer, Sliver);
    assert!(found.len() == 1 && answer.ok, "{:#?}", answer.findings);
    assert!(DVec3::from(found[0].position.expect("a place")).distance(middle) < 10.0);
}

#[test]
fn a_ball_is_the_same_with_and_without_cones() {
    let mut lump = icosphere(10.0, 24);
    for p in &mut lump.positions {
        *p *= 1.0 + 0.3 * ((p.x * 0.9).sin() * (p.y * 0.8).cos() * (p.z * 1.1).sin());
    }
    // A triangle without area has no normal, and yet holds balls.
    lump.triangles.push([0, 0, 5]);
    let block = cuboid(DVec3::ZERO, DVec3::new(9.0, 4.0, 2.0)).triangulate().0;
    for mesh in [lump, block] {
        let tree = Bvh8::build(&mesh, &Job::default()).expect("built");
        let normals: Vec<Vec3> = (0..mesh.triangles.len())
            .map(|t| {
                let [a, b, c] = mesh.corners(t);
                (b - a).cross(c - a).normalize_or_zero()
            })
            .collect();
        let cones = SideCones::new(&tree, &normals);
        for sign in [1.0, -1.0] {
            let caster = Caster {
                tree: &tree,
                face_normals: &normals,
                corner_normals: &[],
                sign,
                cone: &Cone::new(1, 0.0, Weights::Plain),
                outliers: Outliers::Keep,
                correction: Correction::None,
                acute: None,
            };
            let mut balls = 0;
            for t in (0..mesh.triangles.len()).filter(|&t| normals[t] != Vec3::ZERO) {
                let [a, b, c] = mesh.corners(t);
                let site = Site {
                    point: (a + b + c) / 3.0,
                    away: normals[t] * sign,
                    along: b - a,
                    own: &[t as u32],
                    clear: f32::INFINITY,
                };
                let plain = caster.ball(&site);
                assert_eq!(caster.ball_above(&site, f32::NEG_INFINITY, &cones), plain);
                if let Some(ball) = plain {
                    balls += 1;
                    let d = ball.diameter;
                    assert_eq!(caster.ball_above(&site, d, &cones), None);
                    assert_eq!(caster.ball_above(&site, d.next_down(), &cones), plain);
                }
            }
            assert!(balls > 0 || sign < 0.0);
        }
    }
}
