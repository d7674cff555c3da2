//! The eight-wide tree against brute force, against itself without AVX2, and against the light that
//! must not leak.

use glam::Vec3;
use sculptd_geometry::TriMesh;
use sculptd_geometry::bvh::{Bvh8, Ray, TraversalStack, TreeHit};
use sculptd_geometry::job::{Cancelled, Job};

use crate::thickness_shapes::{Random, sphere};

fn rays(random: &mut Random, n: usize) -> Vec<Ray> {
    (0..n).map(|_| Ray::new(random.direction() * 2.0 * random.unit(), random.direction())).collect()
}

fn hits(tree: &Bvh8, rays: &[Ray]) -> Vec<Option<TreeHit>> {
    rays.iter().map(|&r| tree.closest_hit(r, |t| t % 7 != 3)).collect()
}

#[test]
fn equals_brute_force_and_its_own_scalar_twin_bit_for_bit() {
    let mesh = sphere(1.0, 40, 60);
    let tree = Bvh8::build(&mesh, &Job::default()).unwrap();
    let scalar = tree.clone().without_simd();
    let mut random = Random(7);
    let rays = rays(&mut random, 4000);
    let (fast, slow) = (hits(&tree, &rays), hits(&scalar, &rays));
    assert_eq!(fast, slow);
    // Each triangle alone in a separate tree: no walk, no culling, only the triangle test.
    let single: Vec<Bvh8> = (0..mesh.triangles.len())
        .map(|t| {
            let one = TriMesh { triangles: vec![mesh.triangles[t]], ..mesh.clone() };
            Bvh8::build(&one, &Job::default()).unwrap()
        })
        .collect();
    let mut found = 0;
    for (ray, hit) in rays.iter().zip(&fast).take(400) {
        let brute = (0..single.len() as u32)
            .filter(|t| t % 7 != 3)
            .filter_map(|t| {
                single[t as usize].closest_hit(*ray, |_| true).map(|h| TreeHit { triangle: t, ..h })
            })
            .min_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        assert_eq!(*hit, brute);
        found += hit.is_some() as usize;
    }
    assert!((100..400).contains(&found), "{found} of 400");
}

/// A tree that the caches hold casts rays one by one, a larger one lets them take turns: the
/// answers are the same.
#[test]
fn many_rays_at_once_meet_what_each_meets_alone() {
    let mut random = Random(5);
    for (across, along) in [(40, 60), (600, 360)] {
        let tree = Bvh8::build(&sphere(1.0, across, along), &Job::default()).unwrap();
        let mut stack = TraversalStack::new();
        let mut many = Vec::new();
        for n in [0, 1, 3, 4, 5, 500, 0, 7] {
            let rays = rays(&mut random, n);
            let accept = |ray: usize, t: u32| !(t as usize + ray).is_multiple_of(5);
            tree.closest_hits(&mut stack, &rays, accept, &mut many);
            let alone: Vec<_> = rays
                .iter()
                .enumerate()
                .map(|(i, &r)| tree.closest_hit(r, |t| accept(i, t)))
                .collect();
            assert_eq!(many, alone);
            assert!(n < 500 || many.iter().flatten().count() > 100);
            tree.clone().without_simd().closest_hits(&mut stack, &rays, accept, &mut many);
            assert_eq!(many, alone);
        }
    }
}

#[test]
fn no_ray_leaks_out_of_a_closed_sphere() {
    let mesh = sphere(1.0, 64, 128);
    let tree = Bvh8::build(&mesh, &Job::default()).unwrap();
    let mut random = Random(11);
    let n = if std::env::var_os("SCULPTD_LONG").is_some() { 10_000_000 } else { 300_000 };
    let mut leaks = 0;
    for i in 0..n {
        let origin = random.direction() * 0.5;
        // A third each: anywhere, exactly at a vertex, exactly at the middle of an edge.
        let [a, b, _] = mesh.corners(random.below(mesh.triangles.len()));
        let at = [random.direction(), a, (a + b) * 0.5][i % 3];
        let forward = tree.closest_hit(Ray::new(origin, at - origin), |_| true).is_some();
        leaks += !forward as usize;
    }
    println!("{leaks} leaks in {n} rays");
    assert_eq!(leaks, 0);
}

#[test]
fn a_line_through_a_solid_enters_as_often_as_it_leaves() {
    let tree = Bvh8::build(&sphere(1.0, 64, 128), &Job::default()).unwrap();
    let mut random = Random(3);
    for _ in 0..20_000 {
        let dir = random.direction();
        let ray = Ray::new(random.direction() * 0.9 - dir * 3.0, dir);
        let hits = tree.all_hits(ray);
        assert!(hits.len() >= 2, "{ray:?} {hits:?}");
        assert!(hits.windows(2).all(|w| w[0].t <= w[1].t));
        assert_eq!(tree.any_hit(ray, |_| true), !hits.is_empty());
        assert_eq!(
            tree.closest_hit(ray, |_| true).map(|h| h.triangle),
            hits.first().map(|h| h.triangle)
        );
        assert!(!tree.any_hit(Ray { t_max: hits[0].t * 0.999, ..ray }, |_| true));
    }
}

#[test]
fn broken_triangles_are_left_out_and_an_empty_mesh_has_a_tree() {
    let mut mesh = sphere(1.0, 8, 8);
    mesh.positions.push(Vec3::NAN);
    let nan = mesh.positions.len() as u32 - 1;
    mesh.triangles.insert(0, [0, 1, nan]);
    mesh.triangles.insert(0, [0, 1, nan + 1]);
    mesh.triangles.insert(0, [4, 4, 4]);
    let tree = Bvh8::build(&mesh, &Job::default()).unwrap();
    let hit = tree.closest_hit(Ray::new(Vec3::ZERO, Vec3::new(0.3, 0.4, 0.5)), |_| true).unwrap();
    assert!(hit.triangle >= 3);
    let nothing = Bvh8::build(&TriMesh::default(), &Job::default()).unwrap();
    assert!(
        nothing.is_empty()
            && nothing.closest_hit(Ray::new(Vec3::ZERO, Vec3::X), |_| true).is_none()
    );
    let job = Job::default();
    job.cancel();
    assert_eq!(Bvh8::build(&mesh, &job).err(), Some(Cancelled));
}

/// A plate 9,000 long, 60 wide and 2.4 thick, its large faces fans of slivers: the weights of a
/// sliver's corners are known to 1e-5 in single precision, which is a tenth of the wall along the
/// ray. The distance must be good to the rounding of the corners all the same.
#[test]
fn distances_to_slivers_are_as_good_as_the_corners() {
    use glam::{DQuat, DVec3};
    let (long, wide, thick) = (9_000.0, 60.0, 2.4);
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7);
    let many = 40;
    let mut positions = Vec::new();
    for z in [0.0, thick] {
        positions.push(DVec3::new(0.0, 0.0, z));
        for i in 0..=many {
            let along = f64::from(i) / f64::from(many);
            positions.push(DVec3::new(long - 200.0 * along, wide * along, z));
        }
    }
    let ring = many as u32 + 2;
    let fan = |first: u32| (1..=many as u32).map(move |i| [first, first + i, first + i + 1]);
    let mesh = TriMesh {
        positions: positions.iter().map(|&p| (turn * p).as_vec3()).collect(),
        triangles: fan(0).chain(fan(ring)).collect(),
        ..TriMesh::default()
    };
    let tree = Bvh8::build(&mesh, &Job::default()).unwrap();
    let scalar = tree.clone().without_simd();
    let mut random = Random(3);
    let (mut worst, mut met) = (0.0f64, 0);
    for _ in 0..4_000 {
        let unit = |random: &mut Random| f64::from(random.unit());
        let x = 500.0 + 8_000.0 * unit(&mut random);
        let y = x / long * wide * (0.1 + 0.8 * unit(&mut random));
        let dir = DVec3::new(unit(&mut random) - 0.5, unit(&mut random) - 0.5, 1.0).normalize();
        let origin = (turn * DVec3::new(x, y, thick * 0.5)).as_vec3();
        let ray = Ray::new(origin, (turn * dir).as_vec3());
        let hit = tree.closest_hit(ray, |_| true);
        assert_eq!(hit, scalar.closest_hit(ray, |_| true));
        let Some(hit) = hit else { continue };
        met += 1;
        // The point at which the rounded ray leaves the plate.
        let (o, d) = (turn.inverse() * ray.origin.as_dvec3(), turn.inverse() * ray.dir.as_dvec3());
        worst = worst.max((f64::from(hit.t) - (thick - o.z) / d.z).abs());
    }
    assert!(met > 3_500, "{met} of 4,000 rays met the plate");
    assert!(worst < 2e-3, "off by {worst}");
}
