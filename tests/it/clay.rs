//! The clay: what a dab leaves behind must be what a mesh built from scratch would say.

use glam::Vec3;
use sculptd_clay::brush::{GaussianBrush, SmoothBrush};
use sculptd_clay::{Clay, Ray, Reach, Workers};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

/// Numbers that are the same on every run.
pub(crate) struct Dice(pub u64);

impl Dice {
    pub(crate) fn next(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    pub(crate) fn unit(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
            if v.length_squared() > 0.01 && v.length_squared() < 1.0 {
                return v.normalize();
            }
        }
    }
}

pub(crate) fn sphere(vertices: usize) -> Clay {
    Clay::build(&shapes::sphere_of_about(vertices), &Job::default()).expect("a sphere builds")
}

/// One dab where a random ray from outside meets the clay.
pub(crate) fn random_dab(mesh: &mut Clay, dice: &mut Dice, workers: &Workers) -> usize {
    let from = dice.unit();
    let radius = 0.02 + 0.2 * dice.next();
    let smooth = dice.next() < 0.4;
    let Some(hit) = mesh.pick(Ray { origin: from * 5.0, dir: -from }) else { return 0 };
    let reach = Reach::Sphere { centre: hit.position, radius };
    let report = if smooth {
        mesh.dab(&reach, &SmoothBrush::new(hit.position, radius, 0.5), workers)
    } else {
        let height = radius * (dice.next() - 0.4) * 0.5;
        mesh.dab(&reach, &GaussianBrush::new(hit.position, radius, hit.normal, height), workers)
    };
    report.moved
}

#[test]
fn a_mesh_comes_out_as_it_went_in() {
    let plain = shapes::sphere_of_about(5_000);
    let mesh = Clay::build(&plain, &Job::default()).expect("builds");
    mesh.verify_invariants().expect("sound");
    assert_eq!(mesh.to_tri(), plain);
    assert!(mesh.warnings().is_empty(), "{:?}", mesh.warnings());
    assert_eq!(mesh.bounds(), plain.bounds());
}

#[test]
fn any_soup_loads() {
    let mut dice = Dice(7);
    let mut soup = TriMesh::default();
    for _ in 0..2_000 {
        soup.positions.push(dice.unit() * dice.next());
    }
    for _ in 0..4_000 {
        let mut v = || (dice.next() * 1_990.0) as u32;
        let t = [v(), v(), v()];
        soup.triangles.push(t);
    }
    // Three triangles at one edge, one turned over, one twice, one without a side.
    soup.triangles.extend([[0, 1, 2], [0, 1, 3], [1, 0, 4], [0, 1, 2], [5, 5, 6]]);
    let mut mesh = Clay::build(&soup, &Job::default()).expect("builds");
    mesh.verify_invariants().expect("sound");
    let text = mesh.warnings().join("; ");
    for part in ["non-manifold", "name one vertex twice", "belong to no triangle"] {
        assert!(text.contains(part), "{text}");
    }
    let one = Workers::new(1);
    for _ in 0..50 {
        random_dab(&mut mesh, &mut dice, &one);
    }
    mesh.verify_invariants().expect("sound after dabs");
    let back = mesh.to_tri();
    assert_eq!(back.positions.len(), soup.positions.len());
    let kept: Vec<[u32; 3]> =
        soup.triangles.iter().copied().filter(|[a, b, c]| a != b && b != c && c != a).collect();
    assert_eq!(back.triangles, kept);
}

#[test]
fn bad_input_is_refused_with_a_reason() {
    let build = |t: &TriMesh| Clay::build(t, &Job::default()).map(|_| ()).unwrap_err().to_string();
    let mut tri = TriMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 7]],
        colours: None,
    };
    assert_eq!(build(&tri), "triangle 0 names vertex 7, but there are 3");
    tri.triangles.clear();
    assert_eq!(build(&tri), "there are no triangles");
    tri.triangles.push([0, 1, 2]);
    tri.positions[1].x = f32::NAN;
    assert_eq!(build(&tri), "vertex 1 is not a finite point");
}

#[test]
fn everything_agrees_after_many_dabs_and_undo_takes_them_back() {
    let mut mesh = sphere(30_000);
    let workers = Workers::new(2);
    let mut dice = Dice(1);
    let mut hashes = vec![mesh.hash()];
    let mut held = Vec::new();
    for step in 0..12 {
        mesh.begin_step();
        let mut moved = 0;
        while moved == 0 {
            for _ in 0..5 {
                moved += random_dab(&mut mesh, &mut dice, &workers);
            }
        }
        mesh.end_step();
        mesh.verify_invariants().unwrap_or_else(|e| panic!("step {step}: {e}"));
        let snapshot = mesh.snapshot();
        assert_eq!(snapshot.hash(), mesh.hash());
        hashes.push(mesh.hash());
        held.push((snapshot, mesh.hash()));
    }
    for (i, hash) in hashes.iter().enumerate().rev().skip(1) {
        assert!(mesh.undo());
        assert_eq!(mesh.hash(), *hash, "undo to step {i}");
        mesh.verify_invariants().unwrap_or_else(|e| panic!("after undo to {i}: {e}"));
    }
    assert!(!mesh.undo());
    for hash in &hashes[1..] {
        assert!(mesh.redo());
        assert_eq!(mesh.hash(), *hash);
    }
    assert!(!mesh.redo());
    for (snapshot, hash) in held {
        assert_eq!(snapshot.hash(), hash, "a snapshot never changes");
    }
}

#[test]
fn undo_is_bounded_and_forgets_the_oldest() {
    let mut mesh = sphere(20_000);
    mesh.set_undo_bytes(2_000_000);
    let mut dice = Dice(3);
    let one = Workers::new(1);
    for _ in 0..60 {
        mesh.begin_step();
        random_dab(&mut mesh, &mut dice, &one);
        mesh.end_step();
    }
    assert!(mesh.memory().undo <= 2_000_000, "{}", mesh.memory().undo);
    assert!(mesh.undo_steps() > 3 && mesh.undo_steps() < 60, "{}", mesh.undo_steps());
}

#[test]
fn a_pick_is_the_nearest_hit_of_all_triangles() {
    let mut mesh = sphere(4_000);
    let one = Workers::new(1);
    let mut dice = Dice(11);
    for _ in 0..60 {
        random_dab(&mut mesh, &mut dice, &one);
    }
    let plain = mesh.to_tri();
    let snapshot = mesh.snapshot();
    let mut hits = 0;
    for i in 0..400 {
        let origin = dice.unit() * 3.0;
        // Every other ray goes exactly for a vertex: the hardest case.
        let target = if i % 2 == 0 {
            plain.positions[(dice.next() * (plain.positions.len() - 1) as f32) as usize]
        } else {
            dice.unit() * 0.9
        };
        let ray = Ray { origin, dir: (target - origin).normalize() };
        // Single precision may place a ray on either side of an edge it nearly meets: the truth
        // lies between the mesh with all triangles a little smaller and the mesh with all a little
        // larger. But a gap there must not be.
        let (mut surely, mut perhaps) = (f64::INFINITY, f64::INFINITY);
        for t in 0..plain.triangles.len() {
            let [a, b, c] = plain.corners(t).map(|p| p.as_dvec3());
            let (o, d) = (origin.as_dvec3(), ray.dir.as_dvec3());
            let n = (b - a).cross(c - a);
            let along = (a - o).dot(n) / d.dot(n);
            let p = o + d * along;
            let margin = [(a, b), (b, c), (c, a)]
                .iter()
                .map(|(q, r)| (*r - *q).cross(p - *q).dot(n) / n.length_squared())
                .fold(f64::INFINITY, f64::min);
            if along > 0.0 && margin >= -1e-3 {
                perhaps = perhaps.min(along);
            }
            if along > 0.0 && margin >= 1e-3 {
                surely = surely.min(along);
            }
        }
        let hit = mesh.pick(ray);
        assert_eq!(hit, snapshot.pick(ray));
        match hit {
            Some(hit) => {
                hits += 1;
                let t = f64::from(hit.t);
                assert!(
                    t > perhaps - 2e-5 && t < surely + 2e-5,
                    "ray {i}: {t}, not within {perhaps} to {surely}"
                );
                assert!((hit.normal.length() - 1.0).abs() < 1e-4);
                // From outside a closed surface the first hit is on a front: a back well behind it
                // means that the front leaked. (On an outline a front and a back meet at the same
                // distance.)
                let [a, b, c] = mesh.page(hit.page).corners(hit.triangle as usize);
                let facing = (b - a).cross(c - a).normalize_or_zero().dot(ray.dir);
                assert!(
                    facing < 0.02 || t < perhaps + 1e-4,
                    "ray {i} came out at a back: {facing}"
                );
            }
            None => assert!(surely.is_infinite(), "ray {i} slipped through at {perhaps}"),
        }
    }
    assert!(hits > 300);
}

#[test]
fn the_same_bits_with_any_number_of_workers() {
    let dabs = if std::env::var_os("SCULPTD_LONG").is_some() { 1_000 } else { 150 };
    let hashes: Vec<u64> = [1, 2, 3, 7, 16]
        .into_iter()
        .map(|count| {
            std::thread::spawn(move || {
                let mut mesh = sphere(60_000);
                let workers = Workers::new(count);
                let mut dice = Dice(5);
                for _ in 0..dabs {
                    random_dab(&mut mesh, &mut dice, &workers);
                }
                mesh.hash()
            })
            .join()
            .expect("no panic")
        })
        .collect();
    assert!(hashes.iter().all(|h| *h == hashes[0]), "{hashes:x?}");
    assert_ne!(hashes[0], sphere(60_000).hash());
}

#[test]
fn clay_at_rest_takes_at_most_120_bytes_a_vertex() {
    let mesh = sphere(400_000);
    let memory = mesh.memory();
    let each = memory.at_rest() as f64 / mesh.vertex_count() as f64;
    println!("{each:.1} bytes a vertex: {memory:?}");
    assert!(each <= 120.0, "{each} bytes a vertex: {memory:?}");
}
