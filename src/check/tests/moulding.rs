//! Draft, undercuts, parting, thick sections and estimates: parts made by formula.

mod common;

use common::*;
use glam::DVec3;
use sculptd_check::CheckSettings;
use sculptd_check::FindingKind::{ClampingForce, Draft, ShotVolume, Sink, ThickSection, Undercut};

/// A block of half-width 20 at the bottom, whose sides lean in by `angle` degrees.
fn drafted(angle: f64) -> sculptd_geometry::PolyMesh {
    frustum(20.0, 20.0 - 10.0 * angle.to_radians().tan(), 10.0)
}

#[test]
fn a_face_with_little_draft_is_found_with_its_angle() {
    for angle in [0.3f64, 0.5, 0.9] {
        let side = 20.0 - 5.0 * angle.to_radians().tan();
        found_everywhere(&drafted(angle), "moulding", Draft, angle, |p| {
            (p.x.abs().max(p.y.abs()) - side).abs() < 2.0
        });
        let answer = checked(&drafted(angle), "moulding");
        assert_eq!(of(&answer, Draft).len(), 1, "the four sides hang together");
        let top = 20.0 - 10.0 * angle.to_radians().tan();
        let slant = 10.0 / angle.to_radians().cos();
        let area = 4.0 * (20.0 + top) * slant;
        let found = of(&answer, Draft)[0].area.expect("an area");
        assert!((found - area).abs() < 1e-3 * area, "{found} {area}");
    }
    let upright = checked(&drafted(0.0), "moulding");
    assert!(of(&upright, Draft)[0].value.expect("an angle").abs() < 1e-3);
    assert!(!upright.ok);
}

#[test]
fn enough_draft_passes_and_so_does_a_tie() {
    for angle in [1.0, 2.0, 5.0, -2.0] {
        found_nowhere(&drafted(angle), "moulding", Draft);
    }
}

/// A block with a slot of `deep` and `gap` in its side, drawn out by `length`.
fn slotted(deep: f64, gap: f64, length: f64) -> sculptd_geometry::PolyMesh {
    let (lo, hi) = (10.0, 10.0 + gap);
    let profile = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, lo],
        [40.0 - deep, lo],
        [40.0 - deep, hi],
        [40.0, hi],
        [40.0, 10.0 + hi],
        [0.0, 10.0 + hi],
    ];
    drawn_out(&profile, length)
}

#[test]
fn a_slot_in_the_side_is_an_undercut_with_its_area() {
    for (deep, gap) in [(5.0, 4.0), (10.0, 2.0), (3.0, 6.0)] {
        let area = (2.0 * deep + gap) * 25.0;
        found_everywhere(&slotted(deep, gap, 25.0), "moulding", Undercut, area, |p| {
            p.x > 39.9 - deep && p.z > 9.9 && p.z < 10.1 + gap
        });
        let answer = checked(&slotted(deep, gap, 25.0), "moulding");
        let left = answer.facts.parting_undercut.expect("an area");
        assert!(left < 0.5, "parted another way nothing is left: {left}");
        let d = DVec3::from(answer.facts.parting_direction.expect("a direction"));
        assert!(d.z.abs() < 0.2, "{d}");
        assert!(!answer.ok);
    }
}

#[test]
fn what_a_half_releases_is_no_undercut() {
    found_nowhere(&drafted(2.0), "moulding", Undercut);
    found_nowhere(&sculptd_geometry::shapes::torus(9.0, 3.0, 48, 24), "moulding", Undercut);
    let tube = revolved(&[[8.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0]], 64);
    found_nowhere(&tube, "moulding", Undercut);
    // The slot along the pull.
    let along = slotted(5.0, 4.0, 25.0);
    let turn = glam::DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    found_nowhere(&placed(&along, turn, DVec3::ZERO), "moulding", Undercut);
}

#[test]
fn a_thick_section_is_found_where_it_is() {
    // A plate of 2.5 mm with a cube on it.
    for cube in [4.5, 6.0, 9.0] {
        let plate = [
            [0.0, 0.0],
            [80.0, 0.0],
            [80.0, 2.5],
            [40.0 + cube, 2.5],
            [40.0 + cube, cube],
            [40.0, cube],
            [40.0, 2.5],
            [0.0, 2.5],
        ];
        let part = drawn_out(&plate, 60.0);
        let in_cube = |p: DVec3| p.x > 39.0 && p.x < 41.0 + cube;
        found_everywhere(&part, "moulding", ThickSection, cube, in_cube);
        found_everywhere(&part, "moulding", Sink, cube / 2.5, in_cube);
    }
    for wall in [1.2, 2.5, 3.56] {
        let part = block([0.0; 3], [80.0, 60.0, wall]);
        found_nowhere(&part, "moulding", ThickSection);
        found_nowhere(&part, "moulding", Sink);
        let facts = checked(&part, "moulding").facts;
        let thickest = facts.thickest_wall.expect("a wall");
        assert!((thickest - wall).abs() < 1e-3 * wall, "{thickest}");
        // ABS: t = s2 / (pi2 a) ln(4/pi (Tm - Tw) / (Te - Tw)).
        let pi = std::f64::consts::PI;
        let known = wall * wall / (pi * pi * 0.10) * (4.0 / pi * (240.0 - 60.0) / 30.0f64).ln();
        let time = facts.cooling_time.expect("a time");
        assert!((time - known).abs() < 0.01 * known, "{time} {known}");
    }
}

#[test]
fn force_and_shot_are_compared_with_the_machine() {
    let library = library();
    let process = library.process("moulding").expect("known");
    let machine = library.printer("press-1000").expect("known");
    let settings =
        CheckSettings::new(&library, process, Some(machine), None, DVec3::Z).expect("settings");
    for (side, thick, force, shot) in
        [(100.0, 3.0, false, false), (170.0, 3.0, true, false), (160.0, 7.0, false, true)]
    {
        let part = block([0.0; 3], [side, side, thick]);
        let answer = checked_with(&part, &settings);
        assert_eq!(!of(&answer, ClampingForce).is_empty(), force, "{side}");
        assert_eq!(!of(&answer, ShotVolume).is_empty(), shot, "{side}");
        let known = side * side * 35.0 * 1e-3;
        let found = answer.facts.clamping_force.expect("a force");
        assert!((found - known).abs() < 0.01 * known, "{found} {known}");
        let weight = answer.facts.weight.expect("a weight");
        assert!((weight - side * side * thick * 1.05e-3).abs() < 1e-3 * weight);
    }
}
