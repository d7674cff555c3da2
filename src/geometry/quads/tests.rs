use super::*;
use crate::check::{MeshReport, report};
use crate::{repair, shapes};

fn remeshed(mesh: &PolyMesh, quads: usize, creases: Option<f64>) -> (PolyMesh, QuadMetrics) {
    let job = Job::default();
    let settings = QuadSettings { quads, creases, guides: Vec::new() };
    let out = quad_remesh(mesh, &settings, &job).expect("a quad mesh").mesh;
    let metrics = metrics(&out, mesh, &job).unwrap();
    println!("{metrics:?}");
    (out, metrics)
}

/// Returns true if there is such an angle, of at most this many degrees.
fn at_most(angle: Option<f64>, degrees: f64) -> bool {
    angle.is_some_and(|a| a <= degrees)
}

#[test]
fn a_mesh_without_quads_has_no_angles_of_quads() {
    let ball = shapes::icosphere(1.0, 4).to_poly();
    let f = metrics(&ball, &ball, &Job::default()).unwrap();
    assert_eq!((f.quads, f.least_angle, f.greatest_angle, f.mean_deviation), (0, None, None, None));
}

fn facts(mesh: &PolyMesh) -> MeshReport {
    report(mesh, true, &Job::default()).unwrap()
}

/// Checks for a closed, manifold, oriented mesh with these handles, nearly all quads, and about
/// this many of them.
fn sound(mesh: &PolyMesh, metrics: &QuadMetrics, genus: i64, quads: usize) {
    let r = facts(mesh);
    assert!(r.closed && r.manifold && r.oriented && r.unused_vertices == 0, "{r:?}");
    assert_eq!((r.genus, r.self_intersections), (Some(genus), Some(0)));
    assert!(r.volume.unwrap() > 0.0);
    assert!(metrics.other == 0 && metrics.triangles * 100 <= metrics.quads, "{metrics:?}");
    assert!(metrics.quads.abs_diff(quads) * 10 <= quads, "{metrics:?}");
}

fn joined(a: &PolyMesh, b: &PolyMesh, shift: DVec3) -> PolyMesh {
    let mut out = a.clone();
    let n = a.positions.len() as u32;
    out.positions.extend(b.positions.iter().map(|&p| p + shift));
    for face in b.faces() {
        let moved: Vec<u32> = face.iter().map(|&v| v + n).collect();
        out.push_face(&moved);
    }
    out
}

#[test]
fn a_sphere_becomes_quads_near_it() {
    let sphere = shapes::icosphere(10.0, 24).to_poly();
    let (mesh, f) = remeshed(&sphere, 1500, None);
    sound(&mesh, &f, 0, 1500);
    assert!(f.least_angle > Some(30.0) && at_most(f.greatest_angle, 165.0), "{f:?}");
    assert!(at_most(f.mean_deviation, 9.0), "{f:?}");
    // A side is 0.92; the arc over a diagonal rises by 0.021.
    assert!(f.hausdorff.iter().all(|&d| d < 0.06), "{f:?}");
    assert!(f.regular > 0.9, "{f:?}");
    let volume = facts(&mesh).volume.unwrap();
    assert!((volume / 4188.79 - 1.0).abs() < 0.01, "{volume}");
}

#[test]
fn a_torus_keeps_its_hole() {
    let torus = shapes::torus(10.0, 4.0, 64, 32);
    let (mesh, f) = remeshed(&torus, 2000, None);
    sound(&mesh, &f, 1, 2000);
    assert!(f.regular > 0.9, "{f:?}");
}

#[test]
fn a_box_with_creases_is_a_box() {
    let cuboid = shapes::cuboid(DVec3::ZERO, DVec3::new(3.0, 2.0, 1.0));
    let (mesh, f) = remeshed(&cuboid, 600, Some(30.0));
    sound(&mesh, &f, 0, 600);
    // The corners are kept, every vertex is on a face, and the volume is that of the box.
    for corner in &cuboid.positions {
        assert!(mesh.positions.iter().any(|p| p.distance(*corner) < 1e-6));
    }
    assert!((facts(&mesh).volume.unwrap() - 6.0).abs() < 1e-4);
    // An edge of the box is between two vertices of the grid at a few places.
    let [new, old] = f.hausdorff;
    assert!(new < 1e-4 && old < 3e-3, "{f:?}");
    assert!(at_most(f.mean_deviation, 6.0), "{f:?}");
}

/// A block of 5 by 3 by 1 unit cubes without two of them: two holes go through.
fn block_with_two_holes() -> PolyMesh {
    let solid =
        |x: i32, y: i32| (0..5).contains(&x) && (0..3).contains(&y) && !(y == 1 && x % 2 == 1);
    let mut out = PolyMesh::new();
    let v = |x: i32, y: i32, z: i32| ((z * 4 + y) * 6 + x) as u32;
    for z in 0..2 {
        for y in 0..4 {
            for x in 0..6 {
                out.positions.push(DVec3::new(x as f64, y as f64, z as f64));
            }
        }
    }
    for y in 0..3 {
        for x in (0..5).filter(|&x| solid(x, y)) {
            out.push_face(&[v(x, y, 1), v(x + 1, y, 1), v(x + 1, y + 1, 1), v(x, y + 1, 1)]);
            out.push_face(&[v(x, y, 0), v(x, y + 1, 0), v(x + 1, y + 1, 0), v(x + 1, y, 0)]);
            let sides = [
                (x, y - 1, [(x, y), (x + 1, y)]),
                (x + 1, y, [(x + 1, y), (x + 1, y + 1)]),
                (x, y + 1, [(x + 1, y + 1), (x, y + 1)]),
                (x - 1, y, [(x, y + 1), (x, y)]),
            ];
            for (i, j, [(a, b), (c, d)]) in sides {
                if !solid(i, j) {
                    out.push_face(&[v(a, b, 0), v(c, d, 0), v(c, d, 1), v(a, b, 1)]);
                }
            }
        }
    }
    out
}

#[test]
fn two_holes_stay_with_and_without_creases() {
    let block = block_with_two_holes();
    assert_eq!(facts(&block).genus, Some(2));
    // Each of the 14 faces between creases may leave a triangle or two without a partner.
    let (mesh, f) = remeshed(&block, 1500, Some(40.0));
    let r = facts(&mesh);
    assert!(r.closed && r.manifold && r.genus == Some(2) && r.self_intersections == Some(0));
    assert!(f.triangles <= 28 && at_most(f.mean_deviation, 5.0) && f.hausdorff[0] < 1e-3, "{f:?}");
    assert!((facts(&mesh).volume.unwrap() - 13.0).abs() < 1e-3);
    let (mesh, f) = remeshed(&block, 1500, None);
    sound(&mesh, &f, 2, 1500);
}

#[test]
fn an_open_plate_stays_open_with_a_straight_border() {
    let plate = shapes::grid(4.0, 2.0, 3, 3);
    let (mesh, f) = remeshed(&plate, 400, None);
    let r = facts(&mesh);
    assert!(!r.closed && r.manifold && r.oriented && r.self_intersections == Some(0), "{r:?}");
    assert!(f.triangles <= 4 && f.quads.abs_diff(400) < 40, "{f:?}");
    assert!((r.area - 8.0).abs() < 1e-3 && at_most(f.mean_deviation, 5.0), "{r:?} {f:?}");
}

#[test]
fn two_shells_stay_two() {
    let ball = shapes::icosphere(1.0, 12).to_poly();
    let both = joined(&ball, &shapes::torus(2.0, 0.7, 32, 16), DVec3::X * 5.0);
    let (mesh, f) = remeshed(&both, 2000, None);
    sound(&mesh, &f, 1, 2000);
    assert_eq!(facts(&mesh).components, 2);
}

#[test]
fn sizes_do_not_matter() {
    for size in [1e-30, 1e-9, 1e9, 1e30] {
        let mut torus = shapes::torus(10.0, 4.0, 32, 16);
        torus.positions.iter_mut().for_each(|p| *p *= size);
        let settings = QuadSettings { quads: 300, ..QuadSettings::default() };
        let mut out = quad_remesh(&torus, &settings, &Job::default()).unwrap().mesh;
        out.positions.iter_mut().for_each(|p| *p /= size);
        let r = facts(&out);
        assert!(r.closed && r.manifold && r.genus == Some(1), "{size}: {r:?}");
    }
}

#[test]
fn slivers_and_faces_without_area_do_no_harm() {
    // A long thin cylinder of two rings, and a sphere whose poles are slivers.
    for (mesh, genus) in
        [(shapes::cylinder(1.0, 30.0, 200), 0), (shapes::uv_sphere(1.0, 8, 300), 0)]
    {
        let (out, f) = remeshed(&mesh, 800, None);
        let r = facts(&out);
        assert!(r.closed && r.manifold && r.genus == Some(genus), "{r:?}");
        assert!(f.triangles * 50 <= f.quads, "{f:?}");
    }
    // A vertex in the middle of an edge, on one side only: a face without area closes the gap.
    let mut cuboid = shapes::cuboid(DVec3::ZERO, DVec3::ONE).triangulate().0.to_poly();
    let (a, b) = (cuboid.corners[0], cuboid.corners[1]);
    let m = cuboid.positions.len() as u32;
    cuboid.positions.push(cuboid.positions[a as usize].midpoint(cuboid.positions[b as usize]));
    let c = cuboid.corners[2];
    cuboid.corners[1] = m;
    cuboid.push_face(&[m, b, c]);
    cuboid.push_face(&[a, b, m]);
    let r = facts(&cuboid);
    assert!(r.closed && r.manifold && r.degenerate_faces == 1, "{r:?}");
    let (out, _) = remeshed(&cuboid, 200, None);
    assert!(facts(&out).closed && facts(&out).manifold);
}

#[test]
fn what_is_no_surface_is_refused() {
    let job = Job::default();
    let settings = QuadSettings { quads: 100, ..QuadSettings::default() };
    let ask = |mesh: &PolyMesh| quad_remesh(mesh, &settings, &job).unwrap_err();
    let mut fan = shapes::cuboid(DVec3::ZERO, DVec3::ONE).triangulate().0.to_poly();
    let n = fan.positions.len() as u32;
    fan.positions.push(DVec3::splat(3.0));
    let (a, b) = (fan.corners[0], fan.corners[1]);
    fan.push_face(&[a, b, n]);
    assert_eq!(ask(&fan), QuadError::NonManifold(1));
    assert_eq!(ask(&PolyMesh::new()), QuadError::Empty);
    let mut bad = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    bad.positions[3].x = f64::NAN;
    assert_eq!(ask(&bad), QuadError::NotFinite);
    let settings = QuadSettings { quads: 5, ..QuadSettings::default() };
    let cuboid = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    assert_eq!(quad_remesh(&cuboid, &settings, &job), Err(QuadError::Count(5)));
    job.cancel();
    let settings = QuadSettings { quads: 100, ..QuadSettings::default() };
    assert_eq!(quad_remesh(&cuboid, &settings, &job), Err(QuadError::Cancelled(Cancelled)));
}

#[test]
fn faces_that_disagree_are_turned_and_a_touching_vertex_is_split() {
    let settings = QuadSettings { quads: 200, ..QuadSettings::default() };
    let mut turned = shapes::icosphere(1.0, 6).to_poly();
    turned.corners.swap(0, 1);
    let out = quad_remesh(&turned, &settings, &Job::default()).unwrap();
    assert!(out.warnings.len() == 1 && facts(&out.mesh).closed, "{:?}", out.warnings);
    // Two boxes that share one corner.
    let cuboid = shapes::cuboid(DVec3::ZERO, DVec3::ONE);
    let mut two = joined(&cuboid, &cuboid, DVec3::ONE);
    repair::weld(&mut two, 0.0);
    assert!(!facts(&two).manifold);
    let out = quad_remesh(&two, &settings, &Job::default()).unwrap();
    let r = facts(&out.mesh);
    assert!(r.closed && r.manifold && r.components == 2 && out.warnings.len() == 1, "{r:?}");
}

#[test]
fn a_guide_turns_the_quads() {
    // A round plate gives no direction except at its rim; a chord across the middle gives it one.
    let mut plate = shapes::grid(20.0, 20.0, 20, 20);
    let angle = 0.4f64;
    let along = DVec3::new(angle.cos(), angle.sin(), 0.0);
    plate.positions.iter_mut().for_each(|p| p.z = -0.001 * p.length_squared());
    let guide = vec![along * -4.0, along * 4.0];
    // The deviation of the edges in the middle from the guide's cross, in degrees.
    let off = |guides: Vec<Vec<DVec3>>| {
        let settings = QuadSettings { quads: 1600, creases: None, guides };
        let out = quad_remesh(&plate, &settings, &Job::default()).unwrap().mesh;
        let (mut sum, mut n) = (0.0, 0.0);
        for face in out.faces() {
            for k in 0..face.len() {
                let p = out.positions[face[k] as usize];
                let d = out.positions[face[(k + 1) % face.len()] as usize] - p;
                let across = p.x * along.y - p.y * along.x;
                if p.length() < 4.0 && across.abs() < 0.8 {
                    let turn = (d.y.atan2(d.x) - angle).rem_euclid(std::f64::consts::FRAC_PI_2);
                    sum += turn.min(std::f64::consts::FRAC_PI_2 - turn).to_degrees();
                    n += 1.0;
                }
            }
        }
        sum / n
    };
    let (with, without) = (off(vec![guide]), off(Vec::new()));
    println!("{with} {without}");
    assert!(with < 6.0 && without > 12.0, "{with} {without}");
}

#[test]
fn the_bits_do_not_depend_on_the_workers() {
    let torus = shapes::torus(10.0, 4.0, 48, 24);
    let settings = QuadSettings { quads: 900, ..QuadSettings::default() };
    let with = |workers| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(workers).build().unwrap();
        pool.install(|| quad_remesh(&torus, &settings, &Job::default()).unwrap().mesh)
    };
    let one = with(1);
    for workers in [2, 3, 7, 16] {
        assert!(with(workers) == one, "{workers} workers");
    }
}

#[test]
fn random_surfaces_stay_manifold_of_their_genus() {
    let mut state = 7u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    for round in 0..12 {
        let mut mesh = match round % 3 {
            0 => shapes::icosphere(5.0, 4 + round as u32).to_poly(),
            1 => shapes::torus(5.0, 2.0, 10 + round as u32, 8),
            _ => shapes::cuboid(DVec3::ZERO, DVec3::new(5.0, 1.0, 0.3)),
        };
        let noise = unit() * 0.6;
        for p in &mut mesh.positions {
            *p += (DVec3::new(unit(), unit(), unit()) - 0.5) * noise;
        }
        let quads = 20 + (unit() * 600.0) as usize;
        let creases = (round % 2 == 0).then(|| unit() * 60.0);
        let before = facts(&mesh);
        let settings = QuadSettings { quads, creases, guides: Vec::new() };
        let out = quad_remesh(&mesh, &settings, &Job::default()).unwrap().mesh;
        let r = facts(&out);
        assert!(r.closed && r.manifold && r.oriented, "round {round}: {r:?}");
        assert_eq!((r.genus, r.components), (before.genus, before.components), "round {round}");
        assert!(r.degenerate_faces == 0, "round {round}: {r:?}");
    }
}
