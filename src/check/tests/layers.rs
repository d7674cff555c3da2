//! Islands, enclosed voids and cups: parts made by formula, good and bad.

mod common;

use common::*;
use glam::DVec3;
use sculptd_check::FindingKind::{Island, SuctionCup, TrappedVolume};
use sculptd_check::Severity;

/// A column with an arm from which a tooth hangs down to `low`.
fn hook(low: f64) -> sculptd_geometry::PolyMesh {
    let profile = [
        [0.0, 0.0],
        [10.0, 0.0],
        [10.0, 30.0],
        [20.0, 30.0],
        [20.0, low],
        [26.0, low],
        [26.0, 40.0],
        [0.0, 40.0],
    ];
    drawn_out(&profile, 8.0)
}

#[test]
fn an_island_begins_where_a_tooth_hangs() {
    for low in [3.0, 11.3, 27.5] {
        let part = hook(low);
        found_everywhere(&part, "fdm", Island, low, |p| {
            (p.x - 23.0).abs() < 0.1 && (p.z - low).abs() < 0.01
        });
        let answer = checked(&part, "fdm");
        let island = of(&answer, Island)[0];
        assert!((island.area.expect("an area") - 48.0).abs() < 0.1, "{island:?}");
        // Layers of 0.2 mm are cut at half their height.
        let layer = (low / 0.2 - 0.5).floor() as usize + 2;
        assert!(island.message.starts_with(&format!("layer {layer} ")), "{}", island.message);
        assert_eq!(of(&answer, Island).len(), 1);
    }
    // A ball that floats above a plate begins in a point.
    let ball = sculptd_geometry::shapes::icosphere(4.0, 12).to_poly();
    let mut ball = ball;
    ball.positions.iter_mut().for_each(|p| *p += DVec3::new(0.0, 0.0, 9.0));
    let part = joined(&block([-9.0, -9.0, 0.0], [9.0, 9.0, 2.0]), &ball);
    found_everywhere(&part, "fdm", Island, 5.0, |p| p.distance(DVec3::new(0.0, 0.0, 5.0)) < 0.3);
}

#[test]
fn what_stands_or_hangs_from_the_start_is_no_island() {
    let arm = [[0.0, 0.0], [10.0, 0.0], [10.0, 30.0], [26.0, 30.0], [26.0, 40.0], [0.0, 40.0]];
    found_nowhere(&drawn_out(&arm, 8.0), "fdm", Island);
    found_nowhere(&hook(0.0), "fdm", Island);
    found_nowhere(&frustum(10.0, 30.0, 20.0), "fdm", Island);
    // A pit is no island, and neither is a bump lower than a layer.
    found_nowhere(&cup(false), "fdm", Island);
    found_nowhere(&hook(29.95), "fdm", Island);
}

const AROUND: u32 = 96;

/// A cup of inner radius 8 and depth 18, open at the top, or standing on its mouth.
fn cup(turned: bool) -> sculptd_geometry::PolyMesh {
    if turned {
        let p = [[0.0, 18.0], [8.0, 18.0], [8.0, 0.0], [10.0, 0.0], [10.0, 20.0], [0.0, 20.0]];
        return revolved(&p, AROUND);
    }
    let p = [[0.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0], [8.0, 2.0], [0.0, 2.0]];
    revolved(&p, AROUND)
}

#[test]
fn a_cup_is_sealed_until_its_lowest_rim() {
    let area = ring_area(8.0, AROUND);
    let axis = |z: f64| move |p: DVec3| p.truncate().length() < 1.0 && (p.z - z).abs() < 0.2;
    found_everywhere(&cup(false), "sla", SuctionCup, area * 18.0, axis(11.0));
    found_everywhere(&cup(true), "sla", SuctionCup, area * 18.0, axis(9.0));
    // The rim is slanted: what is above its lowest point is open.
    let mut slanted = cup(false);
    for p in slanted.positions.iter_mut().filter(|p| p.z > 19.0) {
        p.z += p.x * 0.5;
    }
    let deep = 20.0 - 8.0 * 0.5 - 2.0;
    found_everywhere(&slanted, "sla", SuctionCup, area * deep, axis(2.0 + deep * 0.5));
    // A ball that floats in a cup takes room from it.
    let mut ball = sculptd_geometry::shapes::icosphere(4.0, 12).to_poly();
    ball.positions.iter_mut().for_each(|p| *p += DVec3::new(0.0, 0.0, 10.0));
    let own = sculptd_geometry::measure::measures(&ball.triangulate().0).volume;
    let with_ball = joined(&cup(false), &ball);
    found_everywhere(&with_ball, "sla", SuctionCup, area * 18.0 - own, axis(11.0));
    let answer = checked(&cup(false), "sla");
    assert!(!answer.ok && of(&answer, SuctionCup)[0].severity == Severity::Error);
}

#[test]
fn what_is_open_below_or_beside_is_no_cup() {
    // A trough, open at its ends; a solid; a cup too small to matter.
    let u = [
        [0.0, 0.0],
        [20.0, 0.0],
        [20.0, 20.0],
        [16.0, 20.0],
        [16.0, 4.0],
        [4.0, 4.0],
        [4.0, 20.0],
        [0.0, 20.0],
    ];
    found_nowhere(&drawn_out(&u, 30.0), "sla", SuctionCup);
    found_nowhere(&block([0.0; 3], [9.0, 8.0, 7.0]), "sla", SuctionCup);
    let small = [[0.0, 0.0], [10.0, 0.0], [10.0, 20.0], [2.0, 20.0], [2.0, 15.0], [0.0, 15.0]];
    found_nowhere(&revolved(&small, AROUND), "sla", SuctionCup);
    // A table: the room under it is open.
    let table = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 16.0],
        [16.0, 16.0],
        [16.0, 0.0],
        [20.0, 0.0],
        [20.0, 20.0],
        [0.0, 20.0],
    ];
    found_nowhere(&drawn_out(&table, 30.0), "sla", SuctionCup);
    // Only the plate seals a tube: a warning.
    let tube = revolved(&[[8.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0]], AROUND);
    let answer = checked(&tube, "sla");
    let found = of(&answer, SuctionCup);
    assert!(found.len() == 1 && found[0].severity == Severity::Warning, "{found:?}");
    let value = found[0].value.expect("a volume");
    assert!((value - ring_area(8.0, AROUND) * 20.0).abs() < 0.01 * value, "{value}");
}

#[test]
fn an_enclosed_cavity_is_found_with_its_volume() {
    let outer = block([0.0; 3], [40.0, 30.0, 20.0]);
    let hollow = joined(&outer, &flipped(&block([5.0; 3], [15.0, 13.0, 11.0])));
    let inside = |p: DVec3| p.distance(DVec3::new(10.0, 9.0, 8.0)) < 0.1;
    for process in ["sla", "sls", "moulding", "fdm"] {
        found_everywhere(&hollow, process, TrappedVolume, 480.0, inside);
    }
    // With a loose block in it.
    let loose = joined(&hollow, &block([7.0; 3], [9.0, 9.0, 9.0]));
    found_everywhere(&loose, "sls", TrappedVolume, 472.0, inside);
    // Two of them, the larger first.
    let two = joined(&hollow, &flipped(&block([20.0, 5.0, 5.0], [35.0, 25.0, 15.0])));
    found_everywhere(&two, "sla", TrappedVolume, 3000.0, |p| (p.x - 27.5).abs() < 0.1);
    assert_eq!(of(&checked(&two, "sla"), TrappedVolume).len(), 2);
    assert!(!checked(&two, "sla").ok && !checked(&two, "sls").ok);
}

#[test]
fn what_opens_somewhere_is_not_trapped() {
    for process in ["sla", "sls", "moulding", "fdm"] {
        found_nowhere(&cup(false), process, TrappedVolume);
        found_nowhere(&cup(true), process, TrappedVolume);
    }
    let tube = revolved(&[[8.0, 0.0], [10.0, 0.0], [10.0, 20.0], [8.0, 20.0]], AROUND);
    found_nowhere(&tube, "sla", TrappedVolume);
    found_nowhere(&sculptd_geometry::shapes::torus(9.0, 2.0, 48, 24), "sls", TrappedVolume);
}
