//! New surfaces from the field.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::offset::{hollow, offset, smooth_union};
use sculptd_geometry::remesh::dual::extract;
use sculptd_geometry::remesh::{RemeshError, RemeshSettings, remesh};
use sculptd_geometry::self_intersection::pairs;
use sculptd_geometry::shapes::{cuboid, icosphere, torus};

use super::{Random, bounds, long, manifold, meshes};

fn solid(mesh: &TriMesh) -> DistanceSolid {
    DistanceSolid::build(mesh, &Job::default()).unwrap()
}

/// The furthest that a face's middle or corner of `a` is from the surface of `b`.
fn apart(a: &TriMesh, b: &DistanceSolid) -> f64 {
    let far = |p: DVec3| b.tree.nearest(p, f64::INFINITY).unwrap().distance();
    (0..a.triangles.len())
        .map(|t| {
            let c = a.corners(t).map(Vec3::as_dvec3);
            c.into_iter().chain([(c[0] + c[1] + c[2]) / 3.0]).map(far).fold(0.0, f64::max)
        })
        .fold(0.0, f64::max)
}

#[test]
fn noise_gives_a_closed_manifold() {
    // Every pattern of inside corners next to every other.
    for seed in 0..4 {
        let mut r = Random(seed);
        let n = 24;
        let mut grid = DistanceGrid {
            origin: DVec3::ZERO,
            spacing: 1.0,
            size: [n; 3],
            values: vec![1.0; n * n * n],
        };
        for k in 1..n - 1 {
            for j in 1..n - 1 {
                for i in 1..n - 1 {
                    grid.values[(k * n + j) * n + i] = (r.unit() - 0.3 - 0.1 * seed as f64) as f32;
                }
            }
        }
        let middle = |p: &[DVec3]| p.iter().sum::<DVec3>() / p.len() as f64;
        let (positions, triangles) = extract(&grid, middle, &Job::default()).unwrap();
        let mesh = TriMesh { positions, triangles, colours: None };
        assert!(manifold(&mesh), "seed {seed}");
        // One fan a vertex: around each, the faces' opposite edges make one ring.
        let mut around = vec![Vec::new(); mesh.positions.len()];
        for &[a, b, c] in &mesh.triangles {
            around[a as usize].push((b, c));
            around[b as usize].push((c, a));
            around[c as usize].push((a, b));
        }
        for ring in around {
            let mut at = ring[0].1;
            let mut steps = 1;
            while at != ring[0].0 {
                at = ring.iter().find(|e| e.0 == at).unwrap().1;
                steps += 1;
            }
            assert_eq!(steps, ring.len(), "a vertex of several fans");
        }
        assert!(measures(&mesh).volume > 0.0);
    }
}

#[test]
fn shapes_are_remeshed_within_half_a_voxel() {
    let job = Job::default();
    for (name, mesh, sharp) in [
        ("sphere", icosphere(1.0, 20), false),
        ("torus", torus(1.0, 0.4, 60, 30).triangulate().0, false),
        ("box", cuboid(DVec3::NEG_ONE, DVec3::new(1.0, 0.7, 0.9)).triangulate().0, true),
    ] {
        let old = solid(&mesh);
        let settings = RemeshSettings { side: 64, sharp };
        let made = remesh(&mesh, &old, settings, &job).unwrap();
        assert_eq!(made.crossings, 0, "{name}");
        let new = made.mesh;
        assert!(manifold(&new), "{name}");
        let (lo, hi) = bounds(&mesh);
        let voxel = (hi - lo).max_element() / 57.0;
        let (there, back) = (apart(&new, &old), apart(&mesh, &solid(&new)));
        println!(
            "{name}: {} triangles, {there:.5} and {back:.5} apart, a voxel is {voxel:.5}",
            new.triangles.len()
        );
        assert!(there < voxel * 0.5 && back < voxel * 0.5, "{name} {there} {back} {voxel}");
        let (a, b) = (measures(&mesh).volume, measures(&new).volume);
        assert!((a / b - 1.0).abs() < 0.01, "{name} {a} {b}");
    }
    let mut coloured = icosphere(1.0, 20);
    coloured.colours = Some(
        coloured
            .positions
            .iter()
            .map(|p| if p.x > 0.0 { [200, 0, 0, 255] } else { [0, 0, 90, 255] })
            .collect(),
    );
    let new = remesh(&coloured, &solid(&coloured), RemeshSettings { side: 32, sharp: false }, &job)
        .unwrap()
        .mesh;
    for (p, c) in new.positions.iter().zip(new.colours.as_ref().unwrap()) {
        assert!(p.x.abs() < 0.15 || (c[0] == 200) == (p.x > 0.0), "{p} {c:?}");
    }
    assert_eq!(
        remesh(&coloured, &solid(&coloured), RemeshSettings { side: 4, sharp: false }, &job).err(),
        Some(RemeshError::Side(4))
    );
    job.cancel();
    assert!(remesh(&coloured, &solid(&coloured), RemeshSettings::default(), &job).is_err());
}

#[test]
fn soups_and_crossed_meshes_become_one_solid() {
    let job = Job::default();
    let (most, side) = if long() { (120_000, 128) } else { (3_000, 40) };
    let mut count = 0;
    for (name, mesh) in meshes(most) {
        let old = solid(&mesh);
        match remesh(&mesh, &old, RemeshSettings { side, sharp: false }, &job) {
            Ok(made) => {
                let new = made.mesh;
                assert!(manifold(&new), "{name}");
                let (lo, hi) = bounds(&mesh);
                let voxel = (hi - lo).max_element() / (side - 7) as f64;
                let there = apart(&new, &old);
                if old.topology.closed {
                    println!("{name}: {:.3} voxels from the old surface", there / voxel);
                }
                count += 1;
            }
            // A sheet has no inside, and walls thinner than a voxel may fall between the samples.
            Err(RemeshError::Empty) => {
                let (lo, hi) = bounds(&mesh);
                let m = measures(&mesh);
                let voxel = (hi - lo).max_element() / (side - 7) as f64;
                assert!(!old.topology.closed || m.volume.abs() < m.area * voxel, "{name}");
            }
            Err(e) => panic!("{name}: {e}"),
        }
    }
    println!("{count} meshes");
}

#[test]
fn solids_grow_shrink_hollow_and_melt() {
    let job = Job::default();
    let ball = icosphere(10.0, 20);
    let old = solid(&ball);
    let volume = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
    for d in [2.0, -3.0] {
        let made = offset(&old, d, 64, &job).unwrap();
        assert!(made.least >= d.abs());
        let new = made.mesh;
        assert!(manifold(&new));
        assert!((measures(&new).volume / volume(10.0 + d) - 1.0).abs() < 0.01);
        for p in new.positions.iter().step_by(17) {
            let found = old.signed_distance(p.as_dvec3());
            // Farther by what the triangles cut across.
            assert!((-1e-4..0.01).contains(&((found - d) * d.signum())), "{found} {d}");
        }
    }
    let Err(RemeshError::TooDeep { asked, deepest }) = offset(&old, -11.0, 64, &job) else {
        panic!("nothing is left of a ball of radius 10");
    };
    assert!(asked == 11.0 && (9.5..=10.0).contains(&deepest), "{asked}, {deepest}");

    let hollowed = hollow(&ball, &old, 2.0, 64, &job).unwrap();
    assert!(manifold(&hollowed.mesh));
    assert_eq!(hollowed.mesh.positions[..ball.positions.len()], ball.positions[..]);
    let wall = volume(10.0) - volume(8.0);
    assert!((measures(&hollowed.mesh).volume / wall - 1.0).abs() < 0.02);

    let moved =
        TriMesh { positions: ball.positions.iter().map(|p| *p + Vec3::X * 15.0).collect(), ..ball };
    let other = solid(&moved);
    let plain = smooth_union(&old, &other, 0.0, 64, &job).unwrap();
    let melted = smooth_union(&old, &other, 3.0, 64, &job).unwrap();
    assert!(manifold(&plain) && manifold(&melted));
    let overlap =
        PI * (20.0 - 15.0f64).powi(2) * (15.0f64.powi(2) + 4.0 * 15.0 * 10.0) / (12.0 * 15.0);
    let truth = 2.0 * volume(10.0) - overlap;
    assert!((measures(&plain).volume / truth - 1.0).abs() < 0.01);
    assert!(measures(&melted).volume > measures(&plain).volume * 1.002);
}

/// Two balls that melt into each other, and a block with edges: their cavities have ridges and
/// points.
#[test]
fn a_cavity_folds_nowhere_and_keeps_its_depth() {
    let job = Job::default();
    let ball = icosphere(10.0, 24);
    let moved = TriMesh {
        positions: ball.positions.iter().map(|p| *p + Vec3::X * 18.0).collect(),
        ..ball.clone()
    };
    let melted = smooth_union(&solid(&ball), &solid(&moved), 1.0, 96, &job).unwrap();
    let block = cuboid(DVec3::splat(-10.0), DVec3::new(10.0, 8.0, 25.0)).triangulate().0;
    for (mesh, wall) in [(melted, 3.0), (block, 2.0)] {
        let old = solid(&mesh);
        let hollowed = hollow(&mesh, &old, wall, 96, &job).unwrap();
        assert!(manifold(&hollowed.mesh));
        let at: Vec<DVec3> = hollowed.mesh.positions.iter().map(|p| p.as_dvec3()).collect();
        let crossing = pairs(&at, &hollowed.mesh.triangles, &job).unwrap();
        assert!(crossing.is_empty(), "{} pairs", crossing.len());
        let inner = &hollowed.mesh.positions[mesh.positions.len()..];
        assert!(inner.len() > 1000);
        for p in inner {
            let depth = -old.signed_distance(p.as_dvec3());
            assert!(depth > wall - 0.05 * hollowed.spacing, "{depth} under a wall of {wall}");
        }
    }
}
