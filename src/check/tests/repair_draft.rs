//! Draft added to upright walls: by formula, turned and moved.

mod common;

use common::*;
use glam::DVec3;
use sculptd_check::FindingKind::Draft;
use sculptd_check::repair::wall_draft::add_draft;
use sculptd_check::repair::{RepairError, ReshapedPart, remaining};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;

fn volume(mesh: &PolyMesh) -> f64 {
    sculptd_geometry::measure::measures(&mesh.triangulate().0).volume
}

fn drafted(part: &PolyMesh, pull: DVec3, angle: f64) -> ReshapedPart {
    let made = add_draft(part, pull, angle, &Job::default()).expect("walls without draft");
    let left = remaining(&made.mesh, pull, 0.05, false, &Job::default()).expect("a solid");
    assert!(left.closed && left.manifold && left.crossings == 0, "{left:?}");
    assert!(made.notes.is_empty(), "{:?}", made.notes);
    made
}

/// A frustum between two areas of one shape.
fn cut_cone(bottom: f64, top: f64, height: f64) -> f64 {
    height / 3.0 * (bottom + top + (bottom * top).sqrt())
}

#[test]
fn a_block_becomes_a_frustum_and_a_tube_opens_upwards() {
    for (turn, shift) in poses() {
        let pull = turn * DVec3::Z;
        for angle in [1.0f64, 2.5] {
            let lean = angle.to_radians().tan();
            let block = placed(&block([0.0; 3], [30.0, 20.0, 25.0]), turn, shift);
            let made = drafted(&block, pull, angle);
            let (w, d) = (30.0 - 50.0 * lean, 20.0 - 50.0 * lean);
            // Two sides that shrink alike: a prismatoid (Simpson's rule is exact).
            let middle = (30.0 - 25.0 * lean) * (20.0 - 25.0 * lean);
            let wanted = 25.0 / 6.0 * (600.0 + 4.0 * middle + w * d);
            assert!((volume(&made.mesh) - wanted).abs() < 1e-4 * wanted, "{angle}");
            assert!((made.area - 100.0 * 25.0).abs() < 0.1, "{}", made.area);
            let left = checked_with(&made.mesh, &settings("moulding", pull));
            assert!(of(&left, Draft).is_empty(), "{:#?}", of(&left, Draft));
            let tube = revolved(&[[8.0, 0.0], [14.0, 0.0], [14.0, 20.0], [8.0, 20.0]], 96);
            let made = drafted(&placed(&tube, turn, shift), pull, angle);
            // The facets move, not the corners.
            let corner = (std::f64::consts::PI / 96.0).cos();
            let by = 20.0 * lean / corner;
            let outer = cut_cone(ring_area(14.0, 96), ring_area(14.0 - by, 96), 20.0);
            let inner = cut_cone(ring_area(8.0, 96), ring_area(8.0 + by, 96), 20.0);
            let wanted = outer - inner;
            let got = volume(&made.mesh);
            assert!((got - wanted).abs() < 1e-3 * wanted, "{got} for {wanted}");
        }
    }
}

#[test]
fn a_pocket_that_opens_below_widens_downwards() {
    let cap = [[0.0, 16.0], [8.0, 16.0], [8.0, 0.0], [14.0, 0.0], [14.0, 20.0], [0.0, 20.0]];
    let cap = revolved(&cap, 96);
    let made = drafted(&cap, DVec3::Z, 2.0);
    let mouth = made.mesh.positions.iter().filter(|p| p.z < 0.1);
    let inner = mouth.map(|p| p.truncate().length()).fold(f64::INFINITY, f64::min);
    let by = 16.0 * 2f64.to_radians().tan();
    assert!((inner - 8.0 - by).abs() < 0.01, "{inner}");
    let answer = checked(&made.mesh, "moulding");
    assert!(of(&answer, Draft).is_empty(), "{:#?}", of(&answer, Draft));
}

#[test]
fn what_has_draft_or_a_bad_angle_is_refused() {
    let job = Job::default();
    let steep = frustum(20.0, 15.0, 10.0);
    let none = add_draft(&steep, DVec3::Z, 1.0, &job);
    assert!(matches!(none, Err(RepairError::NoFinding(_))), "{none:?}");
    let block = block([0.0; 3], [30.0, 20.0, 25.0]);
    for bad in [0.0, -1.0, 46.0, f64::NAN] {
        let refused = add_draft(&block, DVec3::Z, bad, &job);
        assert!(matches!(refused, Err(RepairError::OutOfRange { .. })), "{bad}");
    }
    // A wall that leans less than the angle is turned by the rest.
    let little = frustum(20.0, 20.0 - 10.0 * 0.5f64.to_radians().tan(), 10.0);
    let made = drafted(&little, DVec3::Z, 2.0);
    let top = 2.0 * (20.0 - 10.0 * 2f64.to_radians().tan());
    let wanted = cut_cone(1600.0, top * top, 10.0);
    assert!((volume(&made.mesh) - wanted).abs() < 1e-4 * wanted);
    let stopped = Job::default();
    stopped.cancel();
    assert!(add_draft(&block, DVec3::Z, 1.0, &stopped).is_err());
}
