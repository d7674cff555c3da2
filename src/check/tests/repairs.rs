//! Flat bases, and splits with pegs and sockets: by formula, turned and moved.

mod common;

use std::f64::consts::{PI, TAU};

use common::*;
use glam::DVec3;
use sculptd_check::repair::flat_base::base_tool;
use sculptd_check::repair::split::{PegSettings, SplitParts, SplitPlane, split_part};
use sculptd_check::repair::{Remaining, RepairError, combined, remaining};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;

/// Sides of a peg.
const SIDES: f64 = 48.0;

fn looked_at(mesh: &PolyMesh, up: DVec3) -> Remaining {
    let left = remaining(mesh, up, 0.05, true, &Job::default()).expect("a solid");
    assert!(left.closed && left.manifold && left.crossings == 0, "{left:?}");
    left
}

fn close(value: f64, wanted: f64, share: f64) {
    assert!((value - wanted).abs() <= share * wanted.abs(), "{value} for {wanted}");
}

#[test]
fn a_ball_gets_a_base_of_the_area_of_its_section() {
    let ball = shapes::uv_sphere(10.0, 96, 96);
    for (turn, shift) in poses() {
        let (part, up) = (placed(&ball, turn, shift), turn * DVec3::Z);
        let whole = looked_at(&part, up).volume;
        for height in [0.5, 2.0, 7.0] {
            let tool = base_tool(&part, up, height).expect("a plane through the ball");
            let (made, _) =
                combined(&part, &tool, Operation::Difference, &Job::default()).expect("a result");
            let left = looked_at(&made, up);
            // The section and the cap of a ball of radius 10.
            close(left.base_area, PI * (20.0 * height - height * height), 0.01);
            let cap = PI * height * height * (10.0 - height / 3.0);
            assert!((whole - left.volume - cap).abs() < 0.02 * cap, "{height}");
        }
    }
}

#[test]
fn a_base_outside_of_the_part_is_refused() {
    let ball = shapes::uv_sphere(10.0, 24, 24);
    for bad in [0.0, -1.0, 20.5, f64::NAN, f64::INFINITY] {
        let refused = base_tool(&ball, DVec3::Z, bad);
        assert!(matches!(refused, Err(RepairError::OutOfRange { .. })), "{bad}: {refused:?}");
    }
    assert!(base_tool(&ball, DVec3::ZERO, 1.0).is_err());
}

fn volume(mesh: &PolyMesh) -> f64 {
    sculptd_geometry::measure::measures(&mesh.triangulate().0).volume
}

/// The area of the prism in a circle, and of the one around it.
fn prisms(inner: f64, outer: f64) -> (f64, f64) {
    let around = SIDES * outer * outer * (PI / SIDES).tan();
    (0.5 * SIDES * inner * inner * (TAU / SIDES).sin(), around)
}

/// Both parts are solids, and their volumes are those of the formula.
fn fits(part: &PolyMesh, made: &SplitParts, pegs: &PegSettings, normal: DVec3) {
    looked_at(&made.below, normal);
    looked_at(&made.above, normal);
    let n = made.pegs.len() as f64;
    let (peg, socket) = prisms(pegs.radius, pegs.radius + pegs.clearance);
    let added = n * peg * pegs.length;
    let removed = n * socket * (pegs.length + pegs.clearance);
    let wanted = volume(part) + added - removed;
    let got = volume(&made.below) + volume(&made.above);
    assert!((got - wanted).abs() < 1e-5 * wanted, "{got} for {wanted} with {n} pegs");
}

/// The least distance between the sides of the pegs and the sockets: from points on the pegs
/// beyond the plane to the upper part.
fn least_gap(made: &SplitParts, pegs: &PegSettings, normal: DVec3) -> f64 {
    let above = made.above.triangulate().0;
    let solid = DistanceSolid::build(&above, &Job::default()).expect("a tree");
    let (x, y) = normal.any_orthonormal_pair();
    let mut least = f64::INFINITY;
    for peg in &made.pegs {
        for i in 0..48 {
            let (s, c) = (TAU * f64::from(i) / SIDES).sin_cos();
            for up in [0.3, 0.7, 1.0] {
                let rim = (x * c + y * s) * pegs.radius;
                let p = *peg + rim + normal * (up * pegs.length);
                let far = solid.signed_distance(p);
                least = least.min(far);
            }
        }
    }
    least
}

#[test]
fn a_block_is_split_with_pegs_that_fit_their_sockets() {
    let part = block([0.0; 3], [40.0, 30.0, 50.0]);
    for (turn, shift) in poses() {
        let turned = placed(&part, turn, shift);
        for (pegs, tilt) in [
            (PegSettings::default(), DVec3::Z),
            (PegSettings { radius: 3.0, length: 8.0, clearance: 0.15, most: 2 }, DVec3::Z),
            (PegSettings::default(), DVec3::new(0.2, -0.1, 1.0).normalize()),
        ] {
            let normal = turn * tilt;
            let plane = SplitPlane { point: turn * DVec3::new(20.0, 15.0, 21.0) + shift, normal };
            let made = split_part(&turned, plane, pegs, &Job::default()).expect("two parts");
            assert_eq!(made.pegs.len(), pegs.most, "{:?}", made.notes);
            fits(&turned, &made, &pegs, normal);
            let gap = least_gap(&made, &pegs, normal);
            let sagitta = pegs.radius * (1.0 - (PI / SIDES).cos());
            assert!(
                gap > pegs.clearance - 1e-4 && gap < pegs.clearance + sagitta + 1e-3,
                "{gap} for {}",
                pegs.clearance
            );
            close(made.section_area, 1200.0 / tilt.z, 1e-5);
        }
    }
}

#[test]
fn pegs_stay_in_the_section_and_apart() {
    // A tube has room for pegs only in its wall.
    let tube = revolved(&[[8.0, 0.0], [20.0, 0.0], [20.0, 40.0], [8.0, 40.0]], 96);
    let pegs = PegSettings { most: 6, ..Default::default() };
    let plane = SplitPlane { point: DVec3::Z * 17.0, normal: DVec3::Z };
    let made = split_part(&tube, plane, pegs, &Job::default()).expect("two parts");
    assert_eq!(made.pegs.len(), 6, "{:?}", made.notes);
    let need = 2.0 * pegs.radius + pegs.clearance;
    for (i, p) in made.pegs.iter().enumerate() {
        let r = p.truncate().length();
        assert!(r > 8.0 + need - 0.05 && r < 20.0 - need + 0.05, "{r}");
        assert!(made.pegs[..i].iter().all(|q| q.distance(*p) >= 2.0 * need - 1e-9));
    }
    fits(&tube, &made, &pegs, DVec3::Z);
}

#[test]
fn a_section_without_room_gets_no_peg_and_says_why() {
    let plane = SplitPlane { point: DVec3::Z * 20.0, normal: DVec3::Z };
    let pegs = PegSettings::default();
    let thin = block([0.0; 3], [60.0, 8.0, 50.0]);
    let made = split_part(&thin, plane, pegs, &Job::default()).expect("two parts");
    assert!(made.pegs.is_empty() && made.notes[0].contains("8.000 wide"), "{:?}", made.notes);
    fits(&thin, &made, &pegs, DVec3::Z);
    // Wide enough for one.
    let rod = block([0.0; 3], [9.0, 9.0, 50.0]);
    let made = split_part(&rod, plane, pegs, &Job::default()).expect("two parts");
    assert_eq!(made.pegs.len(), 1, "{:?}", made.notes);
    assert!(made.pegs[0].truncate().distance(glam::DVec2::splat(4.5)) < 0.3, "{:?}", made.pegs);
    fits(&rod, &made, &pegs, DVec3::Z);
    // Wide enough, and not deep enough above the plane.
    let plate = block([0.0; 3], [60.0, 60.0, 25.0]);
    let made = split_part(&plate, plane, pegs, &Job::default()).expect("two parts");
    assert!(made.pegs.is_empty() && made.notes[0].contains("deep"), "{:?}", made.notes);
    // None asked for.
    let none = PegSettings { most: 0, ..pegs };
    let made = split_part(&plate, plane, none, &Job::default()).expect("two parts");
    assert!(made.pegs.is_empty() && made.notes.is_empty(), "{:?}", made.notes);
}

#[test]
fn a_plane_beside_the_part_and_bad_pegs_are_refused() {
    let part = block([0.0; 3], [40.0, 30.0, 50.0]);
    let split = |z: f64, normal: DVec3, pegs: PegSettings| {
        let plane = SplitPlane { point: DVec3::Z * z, normal };
        split_part(&part, plane, pegs, &Job::default()).map(|_| ())
    };
    let pegs = PegSettings::default();
    for z in [-1.0, 0.0, 50.0, 51.0, f64::NAN] {
        assert!(matches!(split(z, DVec3::Z, pegs), Err(RepairError::BesidePart { .. })), "{z}");
    }
    assert!(split(20.0, DVec3::ZERO, pegs).is_err());
    for bad in [
        PegSettings { radius: 0.0, ..pegs },
        PegSettings { length: -1.0, ..pegs },
        PegSettings { clearance: f64::NAN, ..pegs },
        PegSettings { most: 17, ..pegs },
    ] {
        assert!(matches!(split(20.0, DVec3::Z, bad), Err(RepairError::OutOfRange { .. })));
    }
    let stopped = Job::default();
    stopped.cancel();
    let plane = SplitPlane { point: DVec3::Z * 20.0, normal: DVec3::Z };
    assert!(split_part(&part, plane, pegs, &stopped).is_err());
}

#[test]
fn the_same_split_gives_the_same_bits() {
    let part = shapes::icosphere(30.0, 8).to_poly();
    let plane = SplitPlane { point: DVec3::new(0.0, 0.0, 3.0), normal: DVec3::new(0.3, 0.2, 1.0) };
    let made =
        || split_part(&part, plane, PegSettings::default(), &Job::default()).expect("two parts");
    let (a, b) = (made(), made());
    assert_eq!(a.pegs.len(), 4);
    assert!(a == b);
}
