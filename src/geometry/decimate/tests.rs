use super::*;
use crate::check::report;
use crate::shapes::{cuboid, grid, icosphere, torus};
use crate::subdivide::loop_;

fn down(mesh: &PolyMesh, triangles: usize, error: f64) -> PolyMesh {
    quadric(mesh, DecimationTarget { triangles, error, single: false }, &Job::default()).unwrap()
}

#[test]
fn a_ball_stays_a_ball_and_a_ring_a_ring() {
    let job = Job::default();
    let ball = icosphere(1.0, 30).to_poly();
    let few = report(&down(&ball, 600, f64::INFINITY), true, &job).unwrap();
    assert!(few.closed && few.manifold && few.genus == Some(0) && few.triangles <= 600, "{few:?}");
    assert_eq!(few.self_intersections, Some(0));
    let sphere = 4.0 / 3.0 * std::f64::consts::PI;
    assert!((few.volume.unwrap() - sphere).abs() < 0.02 * sphere, "{few:?}");
    let ring = report(&down(&torus(3., 1., 80, 40), 300, f64::INFINITY), true, &job).unwrap();
    assert!(
        ring.closed && ring.manifold && ring.genus == Some(1) && ring.triangles <= 300,
        "{ring:?}"
    );
}

#[test]
fn flat_faces_cost_nothing_and_the_bound_holds_the_edges() {
    let cube = cuboid(DVec3::ZERO, DVec3::ONE);
    let mut fine = cube;
    // Cut only, not smoothed: each level halves every edge.
    for _ in 0..4 {
        let sharp = loop_(&fine, 1, &Job::default()).unwrap();
        let mut middle = sharp.clone();
        let (tri, _) = fine.triangulate();
        for (v, p) in fine.positions.iter().enumerate() {
            middle.positions[v] = *p;
        }
        let flat = PolyMesh {
            corners: tri.triangles.iter().flatten().copied().collect(),
            face_starts: (0..=tri.triangles.len() as u32).map(|t| t * 3).collect(),
            positions: fine.positions.clone(),
            ..PolyMesh::new()
        };
        for (e, s) in EdgeTable::of(&flat).each().enumerate() {
            let (u, v) = s[0].ends;
            middle.positions[fine.positions.len() + e] =
                (fine.positions[u as usize] + fine.positions[v as usize]) / 2.0;
        }
        fine = middle;
    }
    assert_eq!(fine.face_count(), 12 * 256);
    let r = report(&down(&fine, 0, 1e-6), true, &Job::default()).unwrap();
    assert!(r.closed && r.manifold && r.triangles <= 40, "{r:?}");
    assert!((r.volume.unwrap() - 1.0).abs() < 1e-6 && (r.area - 6.0).abs() < 1e-5, "{r:?}");
    let sheet = report(&down(&grid(2., 3., 20, 20), 0, 1e-6), true, &Job::default()).unwrap();
    assert!((sheet.area - 6.0).abs() < 1e-6 && sheet.triangles <= 20, "{sheet:?}");
}

#[test]
fn two_sheets_close_to_each_other_do_not_cross() {
    // Two nested balls a hundredth apart: the error alone would let one through the other.
    let (outer, inner) = (icosphere(1.0, 30).to_poly(), icosphere(0.99, 30).to_poly());
    let mut both = outer;
    let n = both.positions.len() as u32;
    both.positions.extend(&inner.positions);
    for face in inner.faces() {
        let turned: Vec<u32> = face.iter().rev().map(|&v| v + n).collect();
        both.push_face(&turned);
    }
    let target = DecimationTarget { triangles: 800, error: f64::INFINITY, single: false };
    let out = decimate(&both, None, target, &Job::default()).unwrap();
    assert!(out.repeated > 0, "the bound was not needed: {out:?}");
    let facts = report(&out.mesh, true, &Job::default()).unwrap();
    assert_eq!((out.new_crossings, facts.self_intersections), (0, Some(0)));
    assert!(facts.closed && facts.manifold && facts.triangles < both.face_count() / 2, "{facts:?}");
}

#[test]
fn what_crossed_before_is_not_counted_as_new() {
    let mut both = icosphere(1.0, 20).to_poly();
    let other = both.clone();
    let n = both.positions.len() as u32;
    both.positions.extend(other.positions.iter().map(|&p| p + DVec3::X));
    for face in other.faces() {
        let moved: Vec<u32> = face.iter().map(|&v| v + n).collect();
        both.push_face(&moved);
    }
    let target = DecimationTarget { triangles: 1000, error: f64::INFINITY, single: false };
    let out = decimate(&both, None, target, &Job::default()).unwrap();
    assert_eq!((out.new_crossings, out.mesh.face_count() <= 1000), (0, true));
}

#[test]
fn the_border_of_a_mask_and_of_groups_stays_where_it_is() {
    let ball = icosphere(1.0, 30).to_poly();
    let marked: Vec<bool> = ball.positions.iter().map(|p| p.z > 0.3).collect();
    let is_marked = |f: &[u32]| f.iter().filter(|&&v| marked[v as usize]).count() >= 2;
    let groups: Vec<u32> = ball.faces().map(|f| u32::from(is_marked(f))).collect();
    let grouped = PolyMesh { groups: Some(groups), ..ball };
    let target = DecimationTarget { triangles: 500, error: f64::INFINITY, single: false };
    let area = |m: &PolyMesh| -> f64 {
        let groups = m.groups.as_ref().unwrap();
        let each = m.faces().zip(groups).filter(|(_, g)| **g == 1).map(|(f, _)| {
            let [a, b, c] = [0, 1, 2].map(|k| m.positions[f[k] as usize]);
            (b - a).cross(c - a).length() / 2.0
        });
        each.sum()
    };
    let out = decimate(&grouped, Some(&marked), target, &Job::default()).unwrap().mesh;
    assert!(out.face_count() <= 500, "{}", out.face_count());
    let (before, after) = (area(&grouped), area(&out));
    assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
    // Each border point lies near the old border, a zigzag around z = 0.3.
    let groups = out.groups.as_ref().unwrap();
    let mut sides = vec![[false; 2]; out.positions.len()];
    for (f, g) in out.faces().zip(groups) {
        f.iter().for_each(|&v| sides[v as usize][*g as usize] = true);
    }
    let border: Vec<f64> =
        (0..sides.len()).filter(|&v| sides[v] == [true; 2]).map(|v| out.positions[v].z).collect();
    assert!(border.len() > 10 && border.iter().all(|z| (z - 0.3).abs() < 0.05), "{border:?}");
}

/// Sixteen million from the origin single precision knows whole numbers only: a ball of radius 1
/// crosses itself once it is rounded, and that must be told.
#[test]
fn crossings_are_counted_in_the_precision_that_is_kept() {
    let mut ball = icosphere(1.0, 12).to_poly();
    ball.positions.iter_mut().for_each(|p| *p += DVec3::new(1.6e7, 0.0, 0.0));
    let job = Job::default();
    let target = DecimationTarget { triangles: 200, error: f64::INFINITY, single: true };
    let done = decimate(&ball, None, target, &job).unwrap();
    assert!(done.mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p));
    let triangles = done.mesh.triangles().0;
    let found = self_intersection::pairs(&done.mesh.positions, &triangles, &job).unwrap().len();
    assert!(found > 0 && found == done.new_crossings, "{found} and {}", done.new_crossings);
    let exact = decimate(&ball, None, DecimationTarget { single: false, ..target }, &job).unwrap();
    assert_eq!(exact.new_crossings, 0);
}
