//! Thin walls made thicker: by formula, turned and moved.

mod common;

use common::*;
use glam::DVec3;
use sculptd_check::FindingKind::{ThinPin, ThinWall};
use sculptd_check::repair::thickening::{thicken, thin_regions};
use sculptd_check::repair::{RepairError, ReshapedPart, remaining};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::shapes::icosphere;

fn volume(mesh: &PolyMesh) -> f64 {
    measures(&mesh.triangulate().0).volume
}

/// The part with walls of `limit`, as it is after a file has rounded it.
fn thicker(part: &PolyMesh, limit: f64) -> ReshapedPart {
    let job = Job::default();
    let mut made = thicken(part, limit, &job).expect("thin walls");
    made.mesh.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    let left = remaining(&made.mesh, DVec3::Z, 0.05, false, &job).expect("a solid");
    assert!(left.closed && left.manifold && left.crossings == 0, "{left:?}");
    assert_eq!((made.kept, thin_regions(&made.mesh, limit, &job)), (0, Ok(0)), "{:?}", made.notes);
    made
}

fn plate(wide: f64, thick: f64) -> PolyMesh {
    block([0.0; 3], [wide, 20.0, thick])
}

#[test]
fn a_plate_becomes_thicker_and_no_longer_or_wider() {
    for (turn, shift) in poses() {
        for thick in [0.1, 0.5, 1.1] {
            let made = thicker(&placed(&plate(30.0, thick), turn, shift), 1.2);
            let (got, wanted) = (volume(&made.mesh), 30.0 * 20.0 * 1.2);
            assert!((got - wanted).abs() < 2e-3 * wanted, "{got} for {wanted}");
            assert!((made.area - 2.0 * 600.0).abs() < 1.0, "{}", made.area);
        }
    }
}

#[test]
fn a_fin_becomes_thicker_and_its_base_stays() {
    let fin = |thick: f64| {
        let (a, b) = (20.0 - thick / 2.0, 20.0 + thick / 2.0);
        let profile = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 5.0],
            [b, 5.0],
            [b, 20.0],
            [a, 20.0],
            [a, 5.0],
            [0.0, 5.0],
        ];
        drawn_out(&profile, 30.0)
    };
    for (turn, shift) in poses() {
        let made = thicker(&placed(&fin(0.4), turn, shift), 1.2);
        let wanted = fin(1.2);
        for (got, p) in made.mesh.positions.iter().zip(&wanted.positions) {
            let got = turn.inverse() * (*got - shift);
            assert!(got.distance(*p) < 3e-3, "{got} for {p}");
        }
        let left = checked_with(&made.mesh, &settings("fdm", turn * DVec3::Z));
        assert!(of(&left, ThinWall).is_empty(), "{:#?}", of(&left, ThinWall));
    }
}

/// The floor of a pocket is above a large face, which has no corner there.
#[test]
fn the_floor_of_a_pocket_moves_where_the_face_opposite_has_no_corner() {
    let profile = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 10.0],
        [25.0, 10.0],
        [25.0, 0.6],
        [15.0, 0.6],
        [15.0, 10.0],
        [0.0, 10.0],
    ];
    for (turn, shift) in poses() {
        let made = thicker(&placed(&drawn_out(&profile, 30.0), turn, shift), 2.0);
        let (got, wanted) = (volume(&made.mesh), (40.0 * 10.0 - 10.0 * 8.0) * 30.0);
        assert!((got - wanted).abs() < 2e-3 * wanted, "{got} for {wanted}");
    }
}

#[test]
fn a_pin_and_a_shell_become_thicker() {
    let pin = |r: f64| {
        let p = [[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [r, 5.0], [r, 15.0], [0.0, 15.0]];
        revolved(&p, 64)
    };
    for (turn, shift) in poses() {
        let made = thicker(&placed(&pin(0.3), turn, shift), 1.2);
        let left = checked_with(&made.mesh, &settings("fdm", turn * DVec3::Z));
        assert!(of(&left, ThinPin).is_empty(), "{:#?}", of(&left, ThinPin));
        let (got, wanted) = (volume(&made.mesh), volume(&pin(0.602)));
        assert!((got - wanted).abs() < 5e-3 * wanted, "{got} for {wanted}");
    }
    let ball = |r: f32| icosphere(r, 24).to_poly();
    let shell = joined(&ball(20.0), &flipped(&ball(19.4)));
    let made = thicker(&shell, 1.2);
    let full = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
    let (got, wanted) = (volume(&made.mesh), full(20.3) - full(19.1));
    assert!((got - wanted).abs() < 0.02 * wanted, "{got} for {wanted}");
}

#[test]
fn what_stays_thin_is_named_and_a_thick_part_is_no_finding() {
    let job = Job::default();
    // A blade that runs out to an edge.
    let blade = drawn_out(&[[0.0, 0.0], [20.0, 0.0], [20.0, 6.0]], 30.0);
    let made = thicken(&blade, 1.0, &job).expect("a thin edge");
    assert!(made.kept > 0 && made.notes[0].contains("stayed at 0.0"), "{:?}", made.notes);
    assert!(thin_regions(&made.mesh, 1.0, &job).expect("counted") > 0);
    let none = thicken(&plate(30.0, 2.0), 2.0, &job);
    assert_eq!(none, Err(RepairError::NoFinding("wall below this limit")));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = thicken(&plate(30.0, 2.0), bad, &job);
        assert!(matches!(refused, Err(RepairError::OutOfRange { .. })), "{bad}: {refused:?}");
    }
}
