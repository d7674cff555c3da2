//! Shadows by three methods.

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec3};
use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::grid::DistanceGrid;
use sculptd_geometry::job::Job;
use sculptd_geometry::march::default_epsilon;
use sculptd_geometry::measure::projected_area;
use sculptd_geometry::projection::{
    PointTest, ProjectionPlane, area, classify, outline, png, rectangle, sample, shadow_areas,
    spread_directions, svg,
};
use sculptd_geometry::shapes::{cuboid, cylinder, icosphere, torus};

use super::{Random, bounds, long, meshes};

fn solid(mesh: &TriMesh) -> DistanceSolid {
    DistanceSolid::build(mesh, &Job::default()).unwrap()
}

fn shadow(solid: &DistanceSolid, d: DVec3) -> f64 {
    area(&outline(&solid.topology, &ProjectionPlane::along(d, 0.3).unwrap()))
}

#[test]
fn known_shadows_with_holes_and_disjoint_parts() {
    let block = solid(&cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).triangulate().0);
    assert!((shadow(&block, DVec3::X) - 6.0).abs() < 1e-7);
    assert!((shadow(&block, DVec3::NEG_Z) - 2.0).abs() < 1e-7);
    // Cauchy: of a box, the sum of the faces' areas by the direction's components.
    let d = DVec3::new(1.0, -2.0, 0.5).normalize();
    assert!(
        (shadow(&block, d) - (6.0 * d.x.abs() + 3.0 * d.y.abs() + 2.0 * d.z.abs())).abs() < 1e-7
    );

    let ring = solid(&torus(2.0, 0.5, 100, 50).triangulate().0);
    let down = outline(&ring.topology, &ProjectionPlane::along(DVec3::NEG_Z, 0.0).unwrap());
    assert_eq!((down.len(), down[0].holes.len()), (1, 1));
    let n = 100.0;
    let polygon = n / 2.0 * (2.0 * PI / n).sin();
    assert!((area(&down) - polygon * (2.5f64.powi(2) - 1.5f64.powi(2))).abs() < 1e-6);
    let side = outline(&ring.topology, &ProjectionPlane::along(DVec3::X, 0.0).unwrap());
    assert_eq!((side.len(), side[0].holes.len()), (1, 0));
    assert!(svg(&down).contains("evenodd"));
    let picture = image::load_from_memory(&png(&down, None, 200).unwrap()).unwrap().to_rgb8();
    assert_eq!(picture.get_pixel(picture.width() / 2, picture.height() / 2).0, [255; 3]);

    let mut two = icosphere(1.0, 6);
    let other = icosphere(1.0, 6);
    let base = two.positions.len() as u32;
    two.positions.extend(other.positions.iter().map(|p| *p + Vec3::X * 3.0));
    two.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
    let two = solid(&two);
    let apart = outline(&two.topology, &ProjectionPlane::along(DVec3::Y, 0.0).unwrap());
    assert_eq!(apart.len(), 2);
    assert!((shadow(&two, DVec3::X) - area(&apart) / 2.0).abs() < 0.05);
    assert_eq!(outline(&two.topology, &ProjectionPlane::along(DVec3::X, 0.0).unwrap()).len(), 1);
}

#[test]
fn the_three_methods_agree() {
    let job = Job::default();
    let mesh = torus(2.0, 0.5, 80, 40).triangulate().0;
    let solid = solid(&mesh);
    let grid =
        DistanceGrid::sample(&solid, DistanceGrid::layout(bounds(&mesh), 96, 1), &job).unwrap();
    for d in [DVec3::NEG_Z, DVec3::new(0.3, 0.5, -1.0)] {
        let plane = ProjectionPlane::along(d, 0.0).unwrap();
        let exact = area(&outline(&solid.topology, &plane));
        for by in [PointTest::Rays, PointTest::Marching(&grid, default_epsilon(&grid))] {
            let s = sample(&solid, &plane, 25_000, 5, by, &job).unwrap();
            assert!(
                (s.area - exact).abs() < 4.0 * s.standard_error,
                "{} {exact} {}",
                s.area,
                s.standard_error
            );
            let (polygons, alpha) = s.shape(s.alpha);
            assert!((alpha / exact - 1.0).abs() < 0.06, "{alpha} {exact}");
            assert_eq!(polygons.iter().map(|p| p.holes.len()).filter(|&h| h > 0).count(), 1);
        }
    }
}

#[test]
fn marching_agrees_with_rays_but_next_to_the_outline() {
    let job = Job::default();
    let mesh = torus(2.0, 0.5, 80, 40).triangulate().0;
    let solid = solid(&mesh);
    let grid =
        DistanceGrid::sample(&solid, DistanceGrid::layout(bounds(&mesh), 128, 1), &job).unwrap();
    let plane = ProjectionPlane::along(DVec3::new(0.3, 0.5, -1.0), 0.0).unwrap();
    let (lo, hi) = rectangle(&solid, &plane).unwrap();
    let mut r = Random(3);
    let points: Vec<DVec2> =
        (0..50_000).map(|_| lo + (hi - lo) * DVec2::new(r.unit(), r.unit())).collect();
    let by_ray = classify(&solid, &plane, &points, PointTest::Rays, &job).unwrap();
    let by_step =
        classify(&solid, &plane, &points, PointTest::Marching(&grid, default_epsilon(&grid)), &job)
            .unwrap();
    let outline = outline(&solid.topology, &plane);
    let mut differ = 0;
    for (i, p) in points.iter().enumerate() {
        if by_ray[i] == by_step[i] {
            continue;
        }
        differ += 1;
        let edges = outline.iter().flat_map(|p| p.rings()).flat_map(|r| r.windows(2));
        let near = edges
            .map(|e| {
                let along = e[1] - e[0];
                let t = ((p - e[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
                p.distance(e[0] + along * t)
            })
            .fold(f64::INFINITY, f64::min);
        println!("differs at {p}, {near:.5} from the outline; a voxel is {:.5}", grid.spacing);
        assert!(near < grid.spacing, "{p} {near}");
    }
    println!("{differ} of {} rays differ", points.len());
    assert!(differ * 1000 <= points.len());
}

#[test]
fn every_direction_of_every_mesh_has_a_shadow() {
    let job = Job::default();
    let (most, count) = if long() { (200_000, 100) } else { (2_500, 10) };
    let mut all = meshes(most);
    all.push(("cylinder".into(), cylinder(1.0, 2.0, 64).triangulate().0));
    let mut directions = spread_directions(count);
    directions.extend([DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0)]);
    let mut worst = (0.0f64, String::new());
    for (name, mesh) in &all {
        let solid = solid(mesh);
        let areas = shadow_areas(&solid, &directions, &job).unwrap();
        let back: Vec<DVec3> = directions.iter().map(|d| -*d).collect();
        let (lo, hi) = bounds(mesh);
        let size = (hi - lo).length_squared();
        let behind = shadow_areas(&solid, &back, &job).unwrap();
        for i in 0..areas.len() {
            let error = (areas[i] - behind[i]).abs() / areas[i].max(1e-9 * size);
            assert!(error < 1e-6, "{name} {:?}: {} {}", directions[i], areas[i], behind[i]);
        }
        // Another way altogether: strips.
        for i in [0, count - 1, count, count + 1, count + 2] {
            let strips = projected_area(mesh, directions[i].as_vec3(), &job).unwrap();
            let error = (areas[i] - strips).abs() / strips.max(1e-3 * size);
            if error > worst.0 {
                worst = (error, format!("{name} {:?}", directions[i]));
            }
            assert!(error < 2e-3, "{name} {:?}: {} by strips {strips}", directions[i], areas[i]);
        }
    }
    println!(
        "{} meshes, {} directions; worst against strips {worst:?}",
        all.len(),
        directions.len()
    );
}
