//! Rates of distance queries beside parry3d's, in the same run: `cargo bench --bench field
//! [MESH...]`. One thread unless said. A line: what, ours, the peer's, per query or whole.
#![allow(clippy::print_stdout)]

use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use parry3d::math::Vector;
use parry3d::query::PointQuery;
use parry3d::shape::{TriMesh as Peer, TriMeshFlags};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::{DistanceSolid, Sign};
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;
use sculptd_geometry::march::default_epsilon;
use sculptd_geometry::projection::{PointTest, ProjectionPlane, outline, sample};
use sculptd_geometry::remesh::{RemeshSettings, remesh};
use sculptd_geometry::shapes::icosphere;

/// Median of five, seconds.
#[allow(clippy::disallowed_methods)]
fn median(mut work: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[2]
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

fn rates(name: &str, mesh: &TriMesh) {
    let job = Job::default();
    let solid = DistanceSolid::build(mesh, &job).unwrap();
    let normal = solid.clone().with_sign(Sign::Pseudonormal);
    let peer = Peer::with_flags(
        mesh.positions.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect(),
        mesh.triangles.clone(),
        TriMeshFlags::ORIENTED,
    )
    .ok();
    let (lo, hi) = mesh.bounds();
    let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
    let mut seed = 1;
    let mut r = || random(&mut seed);
    let volume: Vec<DVec3> =
        (0..10_000).map(|_| lo + (hi - lo) * DVec3::new(r(), r(), r())).collect();
    let size = (hi - lo).length();
    let near: Vec<DVec3> = (0..10_000)
        .map(|_| {
            let t = (r() * mesh.triangles.len() as f64) as usize;
            let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
            a.lerp(b, r()).lerp(c, r()) + (DVec3::new(r(), r(), r()) - 0.5) * (0.02 * size)
        })
        .collect();
    println!("{name}: {} triangles, closed {}", mesh.triangles.len(), solid.topology.closed);
    for (what, points) in [("volume", &volume), ("near", &near)] {
        let each = 1e9 / points.len() as f64;
        let sum = |f: &dyn Fn(DVec3) -> f64| {
            std::hint::black_box(points.iter().map(|&p| f(p)).sum::<f64>())
        };
        let ours = median(|| {
            sum(&|p| solid.tree.nearest(p, f64::INFINITY).unwrap().distance_squared);
        });
        let signed = median(|| {
            sum(&|p| normal.signed_distance(p));
        });
        let winding = median(|| {
            sum(&|p| solid.winding(p));
        });
        let theirs = peer.as_ref().map(|peer| {
            median(|| {
                sum(&|p| {
                    let p = Vector::new(p.x as f32, p.y as f32, p.z as f32);
                    peer.project_local_point(p, false).point.x as f64
                });
            })
        });
        println!(
            "  {what:8} nearest {:.0} ns, signed by normal {:.0} ns, winding number {:.0} ns; \
                parry3d {:.0} ns",
            ours * each,
            signed * each,
            winding * each,
            theirs.unwrap_or(f64::NAN) * each
        );
    }
    let pools = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    for side in [30, 64] {
        let [one, two] = [0, 1].map(|i| {
            median(|| {
                pools[i].install(|| {
                    std::hint::black_box(
                        DistanceGrid::sample(&solid, DistanceGrid::layout((lo, hi), side, 1), &job)
                            .unwrap(),
                    );
                })
            })
        });
        println!("  grid of {side} a side, signed: {:.4} s, two threads {:.4} s", one, two);
    }
    let [one, two] = [0, 1].map(|i| {
        median(|| {
            pools[i].install(|| drop(std::hint::black_box(solid.nearest(&volume, &job).unwrap())))
        })
    });
    let plane = ProjectionPlane::along(DVec3::new(0.3, 0.5, -1.0), 0.0).unwrap();
    let field = DistanceGrid::sample(&solid, DistanceGrid::layout((lo, hi), 128, 1), &job).unwrap();
    pools[0].install(|| {
        for (what, plane) in
            [("turned", plane), ("along z", ProjectionPlane::along(DVec3::NEG_Z, 0.0).unwrap())]
        {
            let exact = median(|| drop(std::hint::black_box(outline(&solid.topology, &plane))));
            println!("  exact silhouette, {what}: {:.3} ms", exact * 1e3);
        }
        let rays =
            median(|| drop(sample(&solid, &plane, 25_000, 1, PointTest::Rays, &job).unwrap()));
        let by = PointTest::Marching(&field, default_epsilon(&field));
        let march = median(|| drop(sample(&solid, &plane, 25_000, 1, by, &job).unwrap()));
        println!("  25,000 points by rays {:.2} ms, by marching {:.2} ms", rays * 1e3, march * 1e3);
    });
    let new = median(|| {
        pools[1].install(|| {
            let solid = DistanceSolid::build(mesh, &job).unwrap();
            let _ = std::hint::black_box(remesh(mesh, &solid, RemeshSettings::default(), &job));
        })
    });
    println!("  remesh at 256 a side, two threads, tree included: {new:.2} s");
    println!("  10,000 nearest points on two threads: {:.2} times faster", one / two);
}

fn main() {
    let files: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if files.is_empty() {
        rates("sphere", &icosphere(1.0, 25));
        rates("fine sphere", &icosphere(1.0, 81));
        rates("clay", &icosphere(1.0, 224));
    }
    for f in files {
        match read_mesh(Path::new(&f), &Job::default()) {
            Ok(loaded) => rates(&f, &loaded.mesh.triangulate().0),
            Err(e) => println!("{e}"),
        }
    }
}
