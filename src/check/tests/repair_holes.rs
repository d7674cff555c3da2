//! Drain holes and vents: by formula, turned and moved, on a plate and without one.

mod common;

use std::f64::consts::PI;

use common::*;
use glam::DVec3;
use sculptd_check::repair::holes::{HolePlan, HoleSettings, SealedKind, plan_holes};
use sculptd_check::repair::{Remaining, RepairError, combined, remaining, solid_of};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

fn settings(kind: SealedKind, up: DVec3, plate: bool) -> HoleSettings {
    HoleSettings {
        kind,
        diameter: 3.0,
        inlet: false,
        least: 0.0,
        pocket: None,
        near: None,
        up,
        layer: 0.05,
        plate,
    }
}

/// The plan, the part with its holes, and what is left.
fn drilled(part: &PolyMesh, asked: &HoleSettings) -> (HolePlan, PolyMesh, Remaining) {
    let job = Job::default();
    let solid = solid_of(part, &job).expect("a solid");
    let plan = plan_holes(&solid, asked, &job).expect("a hole");
    let (made, _) = combined(&solid, &plan.tool, Operation::Difference, &job).expect("a result");
    let left = remaining(&made, asked.up, asked.layer, asked.plate, &job).expect("a solid");
    assert!(left.closed && left.manifold && left.crossings == 0, "{left:?}");
    (plan, made, left)
}

fn volume(mesh: &PolyMesh) -> f64 {
    sculptd_geometry::measure::measures(&mesh.triangulate().0).volume
}

fn hollow_cube(wall: f64) -> PolyMesh {
    let inner = block([wall; 3], [40.0 - wall; 3]);
    joined(&block([0.0; 3], [40.0; 3]), &flipped(&inner))
}

#[test]
fn a_hollow_cube_drains_through_its_floor_in_powder_and_at_its_side_on_a_plate() {
    for (turn, shift) in poses() {
        let up = turn * DVec3::Z;
        let part = placed(&hollow_cube(3.0), turn, shift);
        for plate in [false, true] {
            let asked = settings(SealedKind::Trapped, up, plate);
            let before = remaining(&part, up, 0.05, plate, &Job::default()).expect("a solid");
            assert_eq!(before.trapped.len(), 1);
            let (plan, made, left) = drilled(&part, &asked);
            let kept: f64 = left.cups.iter().map(|c| c.volume).sum();
            assert!(left.trapped.is_empty() && kept < 0.01, "plate {plate}: {left:?}");
            assert_eq!((plan.voids, plan.holes.len()), (1, 1));
            let removed = volume(&part) - volume(&made);
            let cylinder = PI * 1.5 * 1.5 * 3.0;
            assert!((removed - cylinder).abs() < 0.01 * cylinder, "{removed} for {cylinder}");
            let hole = plan.holes[0];
            let along = turn.inverse() * (hole.to - hole.from);
            assert!((along.length() - 3.0).abs() < 1e-3 && !hole.sealed, "{hole:?}");
            let down = along.normalize().dot(DVec3::NEG_Z);
            assert!((down - if plate { 0.0 } else { 1.0 }).abs() < 1e-3, "{along}");
        }
    }
}

#[test]
fn an_air_inlet_is_at_the_highest_point() {
    for (turn, shift) in poses() {
        let up = turn * DVec3::Z;
        let part = placed(&hollow_cube(3.0), turn, shift);
        let asked = HoleSettings { inlet: true, ..settings(SealedKind::Trapped, up, false) };
        let (plan, made, left) = drilled(&part, &asked);
        assert!(left.trapped.is_empty(), "{left:?}");
        assert_eq!(plan.holes.iter().map(|h| h.inlet).collect::<Vec<_>>(), [false, true]);
        let removed = volume(&part) - volume(&made);
        let cylinders = 2.0 * PI * 1.5 * 1.5 * 3.0;
        assert!((removed - cylinders).abs() < 0.01 * cylinders, "{removed} for {cylinders}");
        let top = turn.inverse() * (plan.holes[1].to - shift);
        assert!((top.z - 40.0).abs() < 1e-3, "{top}");
    }
}

#[test]
fn every_cavity_gets_a_hole_or_the_named_one_alone() {
    let outer = block([0.0; 3], [60.0, 40.0, 30.0]);
    let low = flipped(&block([5.0, 5.0, 4.0], [25.0, 25.0, 20.0]));
    let high = flipped(&block([35.0, 10.0, 12.0], [55.0, 30.0, 26.0]));
    let cell = block([10.0, 10.0, 6.0], [14.0, 14.0, 10.0]);
    // A loose block in the first cavity is no wall to drill through.
    let part = joined(&joined(&joined(&outer, &low), &high), &cell);
    for plate in [false, true] {
        let asked = settings(SealedKind::Trapped, DVec3::Z, plate);
        let (plan, _, left) = drilled(&part, &asked);
        assert_eq!((plan.voids, left.trapped.len()), (2, 0), "plate {plate}: {left:?}");
        assert!(left.cups.is_empty(), "plate {plate}: {:?}", left.cups);
        let near = HoleSettings { near: Some(DVec3::new(45.0, 20.0, 19.0)), ..asked };
        let (plan, _, left) = drilled(&part, &near);
        assert_eq!((plan.voids, left.trapped.len()), (1, 1));
        // The other cavity is still closed, and is said to be.
        let rest = left.trapped[0].volume;
        assert!((rest - (20.0 * 20.0 * 16.0 - 64.0)).abs() < 1.0, "{rest}");
    }
}

#[test]
fn a_round_cavity_drains_at_its_lowest_point() {
    let inner = flipped(&shapes::icosphere(17.0, 24).to_poly());
    let part = joined(&shapes::icosphere(20.0, 24).to_poly(), &inner);
    for (turn, shift) in poses() {
        let (part, up) = (placed(&part, turn, shift), turn * DVec3::Z);
        for plate in [false, true] {
            let asked = settings(SealedKind::Trapped, up, plate);
            let (plan, made, left) = drilled(&part, &asked);
            assert!(left.trapped.is_empty(), "plate {plate}: {left:?}");
            // Less than a drop stays behind the lip of the hole.
            let kept: f64 = left.cups.iter().map(|c| c.volume).sum();
            assert!(kept < 1.0, "plate {plate}: {:?}", left.cups);
            let removed = volume(&part) - volume(&made);
            let wall = plan.holes[0].from.distance(plan.holes[0].to);
            let cylinder = PI * 1.5 * 1.5 * wall;
            assert!((removed - cylinder).abs() < 0.12 * cylinder, "{removed} for {cylinder}");
            assert!(wall < 8.0, "plate {plate}: {wall}");
        }
    }
}

#[test]
fn a_sharp_keel_and_a_tip_drain_too() {
    // A cavity with a lowest edge, and one with a lowest corner.
    let roof = [[0.0, 0.0], [15.0, 20.0], [-15.0, 20.0]];
    let mut keel = flipped(&drawn_out(&roof, 30.0));
    keel.positions.iter_mut().for_each(|p| *p += DVec3::new(20.0, 5.0, 6.0));
    let mut tip = flipped(&shapes::cone(12.0, 20.0, 24));
    tip.positions.iter_mut().for_each(|p| *p = DVec3::new(p.x + 20.0, 20.0 - p.y, 26.0 - p.z));
    for cavity in [keel, tip] {
        let part = joined(&block([0.0; 3], [40.0; 3]), &cavity);
        for plate in [false, true] {
            let asked = settings(SealedKind::Trapped, DVec3::Z, plate);
            let (plan, _, left) = drilled(&part, &asked);
            assert!(left.trapped.is_empty(), "plate {plate}: {left:?}");
            let kept: f64 = left.cups.iter().map(|c| c.volume).sum();
            assert!(kept < 1.0 && !plan.holes[0].sealed, "plate {plate}: {:?}", left.cups);
        }
    }
}

#[test]
fn each_foot_of_a_cavity_drains_where_pockets_count() {
    // Two feet, of which the higher one holds 10 x 12 x 20 up to the ridge between them.
    let feet = [
        [5.0, 5.0],
        [15.0, 5.0],
        [15.0, 20.0],
        [25.0, 20.0],
        [25.0, 8.0],
        [35.0, 8.0],
        [35.0, 30.0],
        [5.0, 30.0],
    ];
    let mut cavity = flipped(&drawn_out(&feet, 20.0));
    cavity.positions.iter_mut().for_each(|p| p.y += 5.0);
    let part = joined(&block([0.0; 3], [40.0, 30.0, 36.0]), &cavity);
    for (turn, shift) in poses() {
        let (part, up) = (placed(&part, turn, shift), turn * DVec3::Z);
        let asked = settings(SealedKind::Trapped, up, true);
        let (plan, _, left) = drilled(&part, &asked);
        assert_eq!((plan.holes.len(), left.trapped.len()), (1, 0));
        assert!((left.cups[0].volume - 2400.0).abs() < 3.0, "{:?}", left.cups);
        let (plan, _, left) = drilled(&part, &HoleSettings { pocket: Some(100.0), ..asked });
        assert_eq!((plan.holes.len(), plan.voids, plan.found), (2, 1, 1));
        let kept: f64 = left.cups.iter().map(|c| c.volume).sum();
        assert!(left.trapped.is_empty() && kept < 1.0, "{:?}", left.cups);
    }
}

const AROUND: u32 = 96;

#[test]
fn cups_are_vented_where_they_begin() {
    let open = [[0.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0], [8.0, 2.0], [0.0, 2.0]];
    let mouth = [[0.0, 18.0], [8.0, 18.0], [8.0, 0.0], [10.0, 0.0], [10.0, 20.0], [0.0, 20.0]];
    for profile in [open, mouth] {
        let cup = revolved(&profile, AROUND);
        for (turn, shift) in poses() {
            let (part, up) = (placed(&cup, turn, shift), turn * DVec3::Z);
            let before = remaining(&part, up, 0.05, true, &Job::default()).expect("a solid");
            assert!(before.cups[0].volume > 3000.0);
            let asked = HoleSettings { least: 100.0, ..settings(SealedKind::Cup, up, true) };
            let (plan, made, left) = drilled(&part, &asked);
            assert_eq!(plan.holes.len(), 1);
            let kept: f64 = left.cups.iter().map(|c| c.volume).sum();
            assert!(kept < 1.0, "{:?}", left.cups);
            // A wall of 2; a hole on the plate is open below, and its ends are round.
            let removed = volume(&part) - volume(&made);
            let cylinder = PI * 1.5 * 1.5 * 2.0;
            assert!((removed - cylinder).abs() < 0.1 * cylinder, "{removed} for {cylinder}");
        }
    }
}

#[test]
fn what_has_no_finding_is_refused() {
    let job = Job::default();
    let plan = |part: &PolyMesh, asked: &HoleSettings| plan_holes(part, asked, &job);
    let cube = block([0.0; 3], [9.0; 3]);
    let trapped = settings(SealedKind::Trapped, DVec3::Z, true);
    assert_eq!(plan(&cube, &trapped), Err(RepairError::NoFinding("trapped volume")));
    let cup = settings(SealedKind::Cup, DVec3::Z, true);
    assert_eq!(plan(&cube, &cup), Err(RepairError::NoFinding("suction cup")));
    let hollow = hollow_cube(3.0);
    let small = HoleSettings { least: 1e6, ..trapped };
    assert_eq!(plan(&hollow, &small), Err(RepairError::NoFinding("trapped volume")));
    for diameter in [0.0, -1.0, f64::NAN] {
        let refused = plan(&hollow, &HoleSettings { diameter, ..trapped });
        assert!(matches!(refused, Err(RepairError::OutOfRange { .. })), "{diameter}");
    }
    let mut open = PolyMesh { positions: hollow.positions.clone(), ..PolyMesh::new() };
    hollow.faces().skip(1).for_each(|f| open.push_face(f));
    assert!(matches!(solid_of(&open, &job), Err(RepairError::NotSolid(_))));
}

#[test]
fn the_same_holes_give_the_same_bits() {
    let part = hollow_cube(3.0);
    let asked = HoleSettings { inlet: true, ..settings(SealedKind::Trapped, DVec3::Z, true) };
    let (a, b) = (drilled(&part, &asked), drilled(&part, &asked));
    assert!(a == b);
}
