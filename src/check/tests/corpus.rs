//! Support, orientation and slices of real parts: against rays, the six axes, and the volume.

mod common;

use common::*;
use glam::{DQuat, DVec3};
use sculptd_check::columns::{CELLS, cell_area};
use sculptd_check::layers::overhangs::overhangs;
use sculptd_check::orientation::{measured, orientations};
use sculptd_check::part::PreparedPart;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::section::Slicer;
use sculptd_geometry::shapes;

#[test]
fn overhang_and_support_of_real_parts_agree_with_rays() {
    let job = Job::default();
    for (name, mesh) in corpus_parts() {
        let part = PreparedPart::new(&mesh, 1.0, &job).expect("prepared");
        let stand = part.standing(DVec3::Z, 0.2).expect("faces");
        let cell = cell_area(&part, CELLS);
        let found = overhangs(&part, &stand, 45.0, true, cell, &job).expect("not cancelled");
        let own: f64 = found.iter().map(|o| o.support.total).sum();
        let error = found.iter().map(|o| o.support.variance).sum::<f64>().sqrt();
        let own_area: f64 = found.iter().map(|o| o.region.area).sum();
        let rays = by_rays(&mesh, 45.0, 20_000);
        let (known, area) = (rays.volume, rays.area);
        let error = error.hypot(rays.error);
        println!(
            "{name}: {own:.3} mm3, by rays {known:.3} ± {error:.3}; {own_area:.4} mm2, {area:.4}"
        );
        assert!((own_area - area).abs() <= 1e-4 * area.max(1.0), "{name}: {own_area} {area}");
        assert!((own - known).abs() <= 1e-3 * known + 4.0 * error, "{name}: {own} {known}");
    }
}

#[test]
fn no_axis_is_better_than_the_orientation_of_a_real_part() {
    let job = Job::default();
    let settings = settings("fdm", DVec3::Z);
    for (name, mesh) in corpus_parts() {
        let part = PreparedPart::new(&mesh, 1.0, &job).expect("prepared");
        let found = orientations(&part, &settings, &job).expect("not cancelled").expect("faces");
        assert!(found.tried >= 1000);
        let best = found.orientations[0];
        let slack = 1e-6 * part.sizes.dimensions.iter().product::<f64>();
        let mut axes = f64::INFINITY;
        for d in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|d| [d, -d]) {
            let axis = measured(&part, &settings, d, &job).expect("run").expect("faces");
            axes = axes.min(axis.support_volume);
            assert!(best.support_volume <= axis.support_volume + slack, "{name}: {axis:?}");
        }
        println!("{name}: {:.1} mm3 of support, best axis {axes:.1}", best.support_volume);
    }
}

/// The integral of the areas over the height. Between the heights of two vertices that follow each
/// other the area is a polynomial of degree two, of which Gauss's two points give the exact
/// integral.
fn volume_of_slices(mesh: &PolyMesh, normal: DVec3) -> f64 {
    let normal = normal.normalize();
    let mut heights: Vec<f64> = mesh.positions.iter().map(|p| p.dot(normal)).collect();
    heights.sort_by(f64::total_cmp);
    let slicer = Slicer::new(mesh, normal).expect("a direction");
    let away = 0.5 / 3f64.sqrt();
    let (mut at, mut weights) = (Vec::new(), Vec::new());
    for w in heights.windows(2).filter(|w| w[1] > w[0]) {
        let (middle, height) = (0.5 * (w[0] + w[1]), w[1] - w[0]);
        at.extend([middle - away * height, middle + away * height]);
        weights.extend([0.5 * height; 2]);
    }
    let sections = slicer.all(&at, &Job::default()).expect("not cancelled");
    sections.iter().zip(weights).map(|(s, w)| s.area * w).sum()
}

#[test]
fn the_slices_sum_to_the_volume() {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, 2.0);
    let torus = shapes::torus(9.0, 3.0, 40, 20);
    let ball = shapes::icosphere(8.0, 6).to_poly();
    let cavity = joined(&block([0.0; 3], [9.0; 3]), &flipped(&block([3.0; 3], [6.0; 3])));
    let formula = [torus, ball, frustum(4.0, 12.0, 10.0), cavity];
    let parts = formula.into_iter().map(|m| ("by formula".to_string(), m));
    for (name, mesh) in parts.chain(corpus_parts()) {
        let job = Job::default();
        let facts = sculptd_geometry::check::report(&mesh, false, &job).expect("not cancelled");
        let volume = facts.volume.expect("closed");
        // Two sections for each vertex: of the large parts one direction.
        let directions = if mesh.positions.len() < 2000 { 2 } else { 1 };
        for normal in [turn * DVec3::Z, DVec3::Z].into_iter().take(directions) {
            let sum = volume_of_slices(&mesh, normal);
            println!("{name}: {sum} of {volume}, {:.1e}", (sum - volume).abs() / volume);
            assert!((sum - volume).abs() <= 1e-6 * volume, "{name}: {sum} {volume}");
        }
    }
}
