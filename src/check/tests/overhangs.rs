//! Overhangs, bridges and support: parts made by formula, and rays against every triangle.

mod common;

use common::*;
use glam::{DQuat, DVec3};
use sculptd_check::FindingKind::{Bridge, Overhang};
use sculptd_check::columns::{CELLS, cell_area};
use sculptd_check::layers::overhangs::{overhang_faces, overhangs};
use sculptd_check::part::PreparedPart;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// A block that leans out at `angle` degrees from the vertical over `height`.
fn leaning(angle: f64, height: f64, length: f64) -> PolyMesh {
    let out = height * angle.to_radians().tan();
    drawn_out(&[[0.0, 0.0], [30.0, 0.0], [30.0 + out, height], [0.0, height]], length)
}

#[test]
fn a_leaning_face_is_found_with_its_angle_area_and_support() {
    for angle in [46.0f64, 60.0, 75.0] {
        let (height, length) = (10.0, 20.0);
        let part = leaning(angle, height, length);
        let out = height * angle.to_radians().tan();
        let on_face = |p: DVec3| (p.x - 30.0 - p.z * out / height).abs() < 0.01;
        found_everywhere(&part, "fdm", Overhang, angle, on_face);
        let answer = checked(&part, "fdm");
        let found = of(&answer, Overhang);
        let area = height / angle.to_radians().cos() * length;
        assert!((found[0].area.expect("an area") - area).abs() < 1e-3 * area);
        let support = answer.facts.support_volume.expect("a volume");
        let known = height * out * 0.5 * length;
        let error = answer.facts.support_error.expect("an error");
        assert!((support - known).abs() < 0.002 * known + error, "{support} {known} {error}");
        assert!(!answer.ok);
    }
}

#[test]
fn a_steep_face_and_what_lies_on_the_plate_are_no_overhangs() {
    for angle in [0.0, 30.0, 45.0] {
        found_nowhere(&leaning(angle, 10.0, 20.0), "fdm", Overhang);
    }
    found_nowhere(&frustum(20.0, 10.0, 15.0), "fdm", Overhang);
    // Upside down for the process, which allows 70 degrees.
    found_nowhere(&leaning(65.0, 10.0, 20.0), "sla", Overhang);
    let ok = checked(&block([0.0; 3], [20.0, 15.0, 10.0]), "fdm");
    assert!(ok.ok && ok.findings.is_empty(), "{:#?}", ok.findings);
    assert_eq!(ok.facts.support_volume, Some(0.0));
}

/// Two legs and a ceiling between them.
fn portal(span: f64) -> PolyMesh {
    let profile = [
        [0.0, 0.0],
        [5.0, 0.0],
        [5.0, 10.0],
        [5.0 + span, 10.0],
        [5.0 + span, 0.0],
        [10.0 + span, 0.0],
        [10.0 + span, 15.0],
        [0.0, 15.0],
    ];
    drawn_out(&profile, 40.0)
}

#[test]
fn a_bridge_is_found_with_its_span() {
    for span in [10.5, 15.0, 30.0] {
        found_everywhere(&portal(span), "fdm", Bridge, span, |p| {
            (p.z - 10.0).abs() < 0.01 && p.x > 5.0 && p.x < 5.0 + span
        });
        found_nowhere(&portal(span), "fdm", Overhang);
        let answer = checked(&portal(span), "fdm");
        assert!(!answer.ok && of(&answer, Bridge).len() == 1);
        let support = answer.facts.support_volume.expect("a volume");
        assert!((support - span * 400.0).abs() < 1e-3 * support, "{support}");
    }
    // The ceiling of a round pit from below: its diameter.
    let pit = [[0.0, 18.0], [8.0, 18.0], [8.0, 0.0], [12.0, 0.0], [12.0, 20.0], [0.0, 20.0]];
    found_everywhere(&revolved(&pit, 96), "fdm", Bridge, 16.0, |p| (p.z - 18.0).abs() < 0.01);
    // Held on four sides: the shorter way.
    let outer = block([0.0; 3], [60.0, 40.0, 20.0]);
    let room = joined(&outer, &flipped(&block([5.0, 5.0, 5.0], [55.0, 17.0, 15.0])));
    found_everywhere(&room, "fdm", Bridge, 12.0, |p| (p.z - 15.0).abs() < 0.01);
}

#[test]
fn a_short_span_passes_and_a_ceiling_held_on_one_side_is_an_overhang() {
    for span in [4.0, 9.9, 10.0] {
        found_nowhere(&portal(span), "fdm", Bridge);
        found_nowhere(&portal(span), "fdm", Overhang);
    }
    let arm = [[0.0, 0.0], [10.0, 0.0], [10.0, 30.0], [14.0, 30.0], [14.0, 40.0], [0.0, 40.0]];
    let arm = drawn_out(&arm, 8.0);
    found_nowhere(&arm, "fdm", Bridge);
    found_everywhere(&arm, "fdm", Overhang, 90.0, |p| (p.z - 30.0).abs() < 0.01);
    let answer = checked(&arm, "fdm");
    assert!((of(&answer, Overhang)[0].area.expect("an area") - 32.0).abs() < 1e-3);
    assert!((answer.facts.support_volume.expect("a volume") - 960.0).abs() < 0.1);
}

#[test]
fn support_agrees_with_rays_against_every_triangle() {
    let turn = |m: &PolyMesh, x: f64, y: f64| {
        placed(m, DQuat::from_rotation_x(x) * DQuat::from_rotation_y(y), DVec3::ZERO)
    };
    let torus = shapes::torus(9.0, 3.0, 40, 20);
    let ball = shapes::icosphere(8.0, 8).to_poly();
    let cup =
        revolved(&[[0.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0], [8.0, 2.0], [0.0, 2.0]], 48);
    let stack = joined(&torus, &block([-20.0, -20.0, -8.0], [20.0, 20.0, -5.0]));
    let mut parts = vec![
        torus.clone(),
        turn(&torus, 1.2, 0.3),
        ball.clone(),
        cup.clone(),
        turn(&cup, 2.0, 0.4),
        turn(&cup, 1.4, -0.9),
        stack.clone(),
        turn(&stack, 0.5, 0.2),
        portal(14.0),
        turn(&portal(14.0), 0.8, 0.9),
        turn(&portal(25.0), -1.8, 0.2),
        leaning(60.0, 12.0, 15.0),
        turn(&leaning(60.0, 12.0, 15.0), 2.1, 1.0),
        frustum(4.0, 12.0, 10.0),
        turn(&frustum(4.0, 12.0, 10.0), 0.6, 0.1),
        shapes::cone(8.0, 15.0, 40),
        turn(&shapes::cone(8.0, 15.0, 40), std::f64::consts::PI, 0.0),
    ];
    for i in 0..3 {
        let mut lump = ball.clone();
        for p in &mut lump.positions {
            let bump = (p.x * 0.9 + f64::from(i)).sin() * (p.y * 0.8).cos() * (p.z * 1.1).sin();
            *p *= 1.0 + 0.2 * bump;
        }
        parts.push(lump);
    }
    assert_eq!(parts.len(), 20);
    let job = Job::default();
    for (n, mesh) in parts.iter().enumerate() {
        let part = PreparedPart::new(mesh, 1.0, &job).expect("prepared");
        let stand = part.standing(DVec3::Z, 0.2).expect("faces");
        let cell = cell_area(&part, CELLS);
        let found = overhangs(&part, &stand, 45.0, true, cell, &job).expect("not cancelled");
        let own: f64 = found.iter().map(|o| o.support.total).sum();
        let own_area: f64 = found.iter().map(|o| o.region.area).sum();
        let RaySupport { volume: known, area, .. } = by_rays(mesh, 45.0, 30_000);
        assert!((own_area - area).abs() <= 1e-4 * area.max(1.0), "{n}: area {own_area} {area}");
        assert!((own - known).abs() <= 0.01 * known + 1e-3, "{n}: {own} by rays {known}");
        let faces = overhang_faces(&part, &stand, 45.0);
        assert_eq!(faces.len(), found.iter().map(|o| o.region.triangles.len()).sum::<usize>());
    }
}
