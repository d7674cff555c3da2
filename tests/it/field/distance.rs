//! Distances against an exhaustive search, signs against the whole sum of solid angles.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use sculptd_geometry::TriMesh;
use sculptd_geometry::bvh::nearest_on_triangle;
use sculptd_geometry::distance::{DistanceSolid, Sign};
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes::{cuboid, icosphere, torus};

use super::{Random, bounds, long, meshes};

/// The distance to the nearest of all triangles.
fn exhaustive(mesh: &TriMesh, p: DVec3) -> f64 {
    let each =
        |t| p.distance_squared(nearest_on_triangle(p, mesh.corners(t).map(Vec3::as_dvec3)).0);
    (0..mesh.triangles.len()).map(each).fold(f64::INFINITY, f64::min).sqrt()
}

/// Returns the solid angle of a triangle seen from the origin, over 4 pi, by a separate arc tangent
/// for each (Van Oosterom and Strackee 1983); positive if its front faces away.
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let up = a.dot(b.cross(c));
    let down = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    up.atan2(down) / std::f64::consts::TAU
}

/// The sum of all solid angles, in turns.
fn turns(mesh: &TriMesh, p: DVec3) -> f64 {
    (0..mesh.triangles.len()).map(|t| solid_angle(mesh.corners(t).map(|c| c.as_dvec3() - p))).sum()
}

/// In the box, twice as far, on vertices, on edges, on faces, and next to all three by a
/// ten-millionth of the size.
fn points(mesh: &TriMesh, count: usize) -> Vec<DVec3> {
    let (lo, hi) = bounds(mesh);
    let size = (hi - lo).length();
    let mut r = Random(count as u64);
    (0..count)
        .map(|i| {
            let t = r.next() as usize % mesh.triangles.len();
            let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
            let off = (r.within(DVec3::NEG_ONE, DVec3::ONE)).normalize_or_zero() * size;
            let s = r.unit();
            match i % 8 {
                0..3 => r.within(lo, hi),
                3 => r.within(lo - (hi - lo), hi + (hi - lo)),
                4 => a.lerp(b, s) + off * 1e-7,
                5 => b + off * 1e-7,
                6 => a.lerp(b, s).lerp(c, r.unit()) + off * 1e-3,
                _ => c.lerp(b, s),
            }
        })
        .collect()
}

#[test]
fn distances_and_signs_equal_an_exhaustive_search() {
    let job = Job::default();
    let (most, count) = if long() { (400_000, 10_000) } else { (3_000, 300) };
    let mut all = meshes(most);
    all.push(("sphere".into(), icosphere(1.0, 8)));
    all.push(("box".into(), cuboid(DVec3::NEG_ONE, DVec3::ONE).triangulate().0));
    all.push(("torus".into(), torus(1.0, 0.3, 24, 12).triangulate().0));
    let (mut worst, mut checked, mut closed) = (0.0f64, 0, 0);
    for (name, mesh) in &all {
        let solid = DistanceSolid::build(mesh, &job).unwrap();
        closed += solid.topology.closed as usize;
        let by_normal = solid.clone().with_sign(Sign::Pseudonormal);
        let (lo, hi) = bounds(mesh);
        let size = (hi - lo).length();
        // A solid angle takes four times as long as a distance: on large meshes only some points
        // get the whole sum, the others the tree's.
        let summed = 60_000_000 / mesh.triangles.len();
        let wrong: Vec<String> = points(mesh, count)
            .into_par_iter()
            .enumerate()
            .map(|(i, p)| {
                let d = exhaustive(mesh, p);
                let w = if i < summed { turns(mesh, p) } else { solid.winding(p) };
                let found = solid.tree.nearest(p, f64::INFINITY).unwrap();
                let error = (found.distance() - d).abs();
                assert!(
                    error <= 1e-6 * d.max(1e-9 * size),
                    "{name} at {p}: {} not {d}",
                    found.distance()
                );
                let fast = solid.winding(p);
                assert!((fast - w).abs() < 0.1, "{name} at {p}: winding {fast} not {w}");
                let mut wrong = None;
                if solid.topology.closed && d > 1e-9 * size {
                    let inside = w.abs() > 0.5;
                    assert_eq!(
                        solid.signed_distance(p) < 0.0,
                        inside,
                        "{name} at {p}: winding {w}"
                    );
                    if (by_normal.signed_distance(p) < 0.0) != inside {
                        wrong = Some(format!("{name} {p} {d} {w} {:?}", found.feature));
                    }
                }
                (error / d.max(1e-9 * size), wrong)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .filter_map(|(e, w)| {
                worst = worst.max(e);
                w
            })
            .collect();
        checked += count;
        if !wrong.is_empty() {
            println!(
                "{name}: the pseudonormal differs from the winding number at {} points: {}",
                wrong.len(),
                wrong[0]
            );
        }
        if ["sphere", "box", "torus"].contains(&name.as_str()) {
            assert!(wrong.is_empty(), "{wrong:?}");
        }
    }
    println!(
        "{} meshes ({closed} closed), {checked} points, worst relative error {worst:e}",
        all.len()
    );
}

#[test]
fn a_box_is_exact() {
    let half = DVec3::new(1.0, 2.0, 3.0);
    let solid =
        DistanceSolid::build(&cuboid(-half, half).triangulate().0, &Job::default()).unwrap();
    let mut r = Random(7);
    for _ in 0..3000 {
        let p = r.within(half * -2.0, half * 2.0);
        let q = p.abs() - half;
        let truth = q.max(DVec3::ZERO).length() + q.max_element().min(0.0);
        let found = solid.signed_distance(p);
        assert!((found - truth).abs() < 1e-14, "{p}: {found} not {truth}");
    }
    // Out of range is no panic.
    for p in [
        DVec3::NAN,
        DVec3::NEG_INFINITY,
        DVec3::splat(-1e300),
        DVec3::splat(1e38),
        DVec3::splat(-1e16),
    ] {
        assert!(solid.signed_distance(p).is_infinite(), "{p}");
        assert_eq!(solid.winding(p), 0.0);
    }
    let mut huge = icosphere(1.0, 2);
    huge.positions.iter_mut().for_each(|p| *p = p.signum() * f32::MAX);
    let solid = DistanceSolid::build(&huge, &Job::default()).unwrap();
    assert!(solid.tree.nearest(DVec3::ZERO, f64::INFINITY).is_none());
}

#[test]
fn grids_hold_the_same_distances_and_survive_the_file() {
    let job = Job::default();
    let mesh = torus(1.0, 0.3, 40, 20).triangulate().0;
    let solid = DistanceSolid::build(&mesh, &job).unwrap();
    let grid =
        DistanceGrid::sample(&solid, DistanceGrid::layout(bounds(&mesh), 30, 2), &job).unwrap();
    for k in 0..grid.size[2] {
        for j in 0..grid.size[1] {
            for i in 0..grid.size[0] {
                let p = grid.origin + DVec3::new(i as f64, j as f64, k as f64) * grid.spacing;
                assert_eq!(grid.value(i, j, k), solid.signed_distance(p) as f32);
            }
        }
    }
    let p = DVec3::new(0.9, 0.5, 0.1);
    assert!((grid.interpolate(p) as f64 - solid.signed_distance(p)).abs() < 0.02);
    let slope = (grid.interpolate(p + DVec3::X * 1e-3) - grid.interpolate(p - DVec3::X * 1e-3))
        as f64
        / 2e-3;
    assert!((grid.gradient(p).x - slope).abs() < 1e-3);
    let file = tempfile::tempdir().unwrap().path().join("grid.npy");
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    sculptd_geometry::io::write_beside(&file, |w| grid.write_npy(w)).unwrap();
    assert_eq!(DistanceGrid::read_npy(&file).unwrap(), grid);
    job.cancel();
    assert!(
        DistanceGrid::sample(&solid, DistanceGrid::layout(bounds(&mesh), 30, 2), &job).is_err()
    );
}
