//! The live map: after a stroke it equals a new map, at a cost that follows the change.

use glam::{DVec3, Vec3};
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::live_thickness::{LiveMap, Rebuild};
use sculptd_clay::{Clay, Reach, Workers};
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::changes::EarlierVersion;
use sculptd_geometry::thickness::{MeasuredSide, ThicknessSettings};
use sculptd_geometry::{TriMesh, shapes};

use crate::thickness_shapes::{Random, join, shell, slab, sphere};

#[test]
fn after_a_stroke_the_map_equals_a_new_one() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let rings = if long { 350 } else { 60 };
    let job = Job::default();
    let mut mesh = Clay::build(&shell(10.0, 8.5, rings), &job).expect("a good mesh");
    let mut map = LiveMap::new(&mesh.snapshot(), MeasuredSide::Wall, &job).expect("not cancelled");
    assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
    let workers = Workers::new(1);
    let clock = Clock::monotonic();
    mesh.begin_step();
    for i in 0..12 {
        let centre = Vec3::new(10.0, i as f32 * 0.1, 1.0).normalize() * 10.0;
        let radius = 0.6;
        let dab = GaussianBrush::new(centre, radius, centre.normalize(), 0.05);
        mesh.dab(&Reach::Sphere { centre, radius }, &dab, &workers);
    }
    mesh.end_step();
    let newer = mesh.snapshot();
    let start = clock.now_us();
    assert_eq!(map.advance(&newer), Ok(()));
    let (stale, all) = (map.stale(), map.values().len());
    // Nearest first, within a budget, then the rest.
    let brush = Vec3::X * 10.0;
    let was = map.is_stale().to_vec();
    let left = map.work(brush, stale / 2, &job).expect("not cancelled");
    assert_eq!((left, map.stale()), (stale - stale / 2, left));
    let is = map.is_stale().to_vec();
    assert_eq!(map.work(brush, usize::MAX, &job), Ok(0));
    let took = clock.now_us() - start;
    println!("{all} vertices: {stale} measured again in {took} us");
    let positions = newer.to_tri().positions;
    let far = |v: usize| positions[v].distance(brush);
    let nearest_left = (0..all).filter(|&v| is[v]).map(far).fold(f32::INFINITY, f32::min);
    let farthest_done = (0..all).filter(|&v| was[v] && !is[v]).map(far).fold(0.0, f32::max);
    assert!(farthest_done <= nearest_left, "{farthest_done} {nearest_left}");
    assert!(stale > 0 && stale < all / 3, "{stale} of {all}");
    let mut anew = LiveMap::new(&newer, MeasuredSide::Wall, &job).expect("not cancelled");
    assert_eq!(anew.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
    let bits = |m: &LiveMap| m.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert!(bits(&map) == bits(&anew), "the map differs from one made anew");
    assert!(map.values().iter().all(|v| v.is_finite()));
}

#[test]
fn another_topology_asks_for_a_new_map() {
    let job = Job::default();
    let mut a = Clay::build(&shell(10.0, 8.5, 12), &job).expect("a good mesh");
    let mut b = Clay::build(&shell(10.0, 8.5, 14), &job).expect("a good mesh");
    let mut map = LiveMap::new(&a.snapshot(), MeasuredSide::Wall, &job).expect("not cancelled");
    assert_eq!(map.advance(&b.snapshot()), Err(Rebuild));
}

#[test]
fn the_live_map_has_the_ball_in_a_wall_and_the_change_of_walls() {
    let job = Job::default();
    let mut plate = slab(40.0, 2.0, 24);
    let before = plate.clone();
    // A hill of 1 in the middle of the top.
    let inside = |p: &Vec3| (p.truncate() - 20.0).abs().max_element() < 8.0 && p.z > 1.0;
    plate.positions.iter_mut().filter(|p| inside(p)).for_each(|p| p.z += 1.0);
    let mut clay = Clay::build(&plate, &job).expect("a good mesh");
    let mut map = LiveMap::new(&clay.snapshot(), MeasuredSide::Wall, &job).expect("not cancelled");
    assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
    let earlier = EarlierVersion::new(&before, 1e-3, &ThicknessSettings::default(), &job);
    let found = map.changes(&earlier.expect("prepared"), &job).expect("not cancelled");
    let mut seen = [0, 0];
    for (p, change) in plate.positions.iter().zip(&found) {
        let from_middle = (p.truncate() - 20.0).abs().max_element();
        // Beside the hill's flank, rays meet the flank.
        if from_middle < 5.0 {
            assert!((change - 1.0).abs() < 1e-3, "{p}: {change}");
            seen[0] += 1;
        } else if (11.0..19.0).contains(&from_middle) {
            assert!(change.abs() < 1e-3, "{p}: {change}");
            seen[1] += 1;
        }
    }
    assert!(seen.into_iter().all(|n| n > 40), "{seen:?}");
    for (place, ball) in [(Vec3::new(20.3, 20.4, 3.0), 3.0), (Vec3::new(5.3, 20.4, 2.0), 2.0)] {
        let found = map.ball(place).expect("a wall");
        assert!((found - ball).abs() < 1e-3, "{place}: {found}");
    }
}

fn whole_map(clay: &mut Clay, side: MeasuredSide) -> LiveMap {
    let job = Job::default();
    let mut map = LiveMap::new(&clay.snapshot(), side, &job).expect("not cancelled");
    assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
    map
}

/// All vertices of a coarse part are on its sharp edges, where vertex normals point askew.
#[test]
fn the_vertices_of_a_coarse_part_have_its_walls() {
    let job = Job::default();
    let build = |part: &TriMesh| Clay::build(part, &job).expect("a good mesh");
    let plate = shapes::cuboid(DVec3::ZERO, DVec3::new(40.0, 20.0, 5.0)).triangulate().0;
    let map = whole_map(&mut build(&plate), MeasuredSide::Wall);
    assert!(map.values().iter().all(|v| (v - 5.0).abs() < 1e-4), "{:?}", map.values());
    let area: f32 = map.areas().iter().sum();
    assert!((area / 2200.0 - 1.0).abs() < 1e-5, "{area}");
    // A block of 9 with a ledge of 1.5.
    let outline = [[0, 0], [60, 0], [60, 15], [40, 15], [40, 90], [0, 90]];
    let outline = outline.map(|[x, y]| Vec3::new(x as f32, y as f32 * 0.1, 0.0));
    let mut block = TriMesh {
        positions: outline.iter().flat_map(|p| [*p, *p + Vec3::Z * 30.0]).collect(),
        triangles: (0..6u32)
            .flat_map(|i| {
                let (a, b) = (2 * i, 2 * ((i + 1) % 6));
                [[a, b, b + 1], [a, b + 1, a + 1]]
            })
            .collect(),
        ..TriMesh::default()
    };
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]].map(|t| t.map(|i| 2 * i)) {
        block.triangles.extend([[a, c, b], [a + 1, b + 1, c + 1]]);
    }
    let map = whole_map(&mut build(&block), MeasuredSide::Wall);
    for (p, v) in block.positions.iter().zip(map.values()) {
        let wall = if p.x > 39.0 && p.y < 2.0 { 1.5 } else { 9.0 };
        assert!((v - wall).abs() < 1e-3, "{p}: {v}");
    }
}

#[test]
fn on_sharp_edges_too_the_map_equals_a_new_one_after_a_stroke() {
    let job = Job::default();
    let workers = Workers::new(1);
    for side in [MeasuredSide::Wall, MeasuredSide::Gap] {
        let mut clay = Clay::build(&slab(40.0, 2.0, 24), &job).expect("a good mesh");
        let mut map = whole_map(&mut clay, side);
        for i in 0..20 {
            clay.begin_step();
            let centre = Vec3::new(40.0, 2.0 * i as f32, 2.0 * (i % 2) as f32);
            let towards = Vec3::new(-0.6, 0.0, if i % 2 == 0 { 0.8 } else { -0.8 });
            let dab = GaussianBrush::new(centre, 4.0, towards, 0.6);
            clay.dab(&Reach::Sphere { centre, radius: 4.0 }, &dab, &workers);
            clay.end_step();
            assert_eq!(map.advance(&clay.snapshot()), Ok(()));
            assert_eq!(map.work(centre, usize::MAX, &job), Ok(0));
            let anew = whole_map(&mut clay, side);
            let bits = |m: &LiveMap| m.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert!(
                bits(&map) == bits(&anew),
                "{side:?}, after {i} the map differs from a new one"
            );
            assert_eq!(map.areas(), anew.areas());
        }
    }
}

/// Two balls beside each other and a fork of two prongs.
fn parts_with_gaps() -> [TriMesh; 2] {
    let moved = |mut mesh: TriMesh, by: Vec3| {
        mesh.positions.iter_mut().for_each(|p| *p += by);
        mesh
    };
    let balls = join(sphere(5.0, 24, 48), &moved(sphere(5.0, 24, 48), Vec3::X * 11.0));
    let fork = join(slab(20.0, 2.0, 20), &moved(slab(20.0, 2.0, 20), Vec3::Z * 3.0));
    [balls, fork]
}

/// The nearest face that looks towards the vertex, along its normal, without a tree.
fn gap_by_force(mesh: &TriMesh, v: u32, out: Vec3) -> f32 {
    let from = mesh.positions[v as usize].as_dvec3();
    let out = out.as_dvec3();
    let mut least = f64::INFINITY;
    for t in mesh.triangles.iter().filter(|t| !t.contains(&v)) {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let normal = (b - a).cross(c - a);
        if normal.normalize_or_zero().dot(out) > -2e-4 {
            continue;
        }
        let reach = (a - from).dot(normal) / out.dot(normal);
        let at = from + out * reach;
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(p, q)| (*q - *p).cross(at - *p).dot(normal) >= 0.0);
        if inside && reach > 0.0 {
            least = least.min(reach);
        }
    }
    if least.is_finite() { least as f32 } else { f32::NAN }
}

/// The vertices of edges whose faces are turned from each other by more than 40 degrees.
fn sharp_vertices(mesh: &TriMesh) -> Vec<bool> {
    let mut sharp = vec![false; mesh.positions.len()];
    let mut sides = std::collections::BTreeMap::new();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            let other = sides.insert((u.min(v), u.max(v)), normal);
            if other.is_some_and(|other: Vec3| other.dot(normal) < 40f32.to_radians().cos()) {
                [u, v].iter().for_each(|v| sharp[*v as usize] = true);
            }
        }
    }
    sharp
}

#[test]
fn after_random_strokes_the_map_of_gaps_is_that_of_brute_force() {
    let job = Job::default();
    let strokes = if std::env::var_os("SCULPTD_LONG").is_some() { 40 } else { 6 };
    let mut random = Random(54);
    for mesh in parts_with_gaps() {
        let mut clay = Clay::build(&mesh, &job).expect("a good mesh");
        let mut map =
            LiveMap::new(&clay.snapshot(), MeasuredSide::Gap, &job).expect("not cancelled");
        assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
        let workers = Workers::new(1);
        let (mut open, mut again) = (0, 0);
        for _ in 0..strokes {
            clay.begin_step();
            let now = clay.snapshot().to_tri();
            let v = random.below(now.positions.len());
            let (mut centre, radius) = (now.positions[v], 0.8 + 1.5 * random.unit());
            let along = random.direction();
            for _ in 0..4 {
                let height = (random.unit() - 0.4) * 0.6;
                let dab = GaussianBrush::new(centre, radius, random.direction(), height);
                clay.dab(&Reach::Sphere { centre, radius }, &dab, &workers);
                centre += along * (0.4 * radius);
            }
            clay.end_step();
            let newer = clay.snapshot();
            assert_eq!(map.advance(&newer), Ok(()));
            again += map.stale();
            assert_eq!(map.work(centre, usize::MAX, &job), Ok(0));
            let mut anew = LiveMap::new(&newer, MeasuredSide::Gap, &job).expect("not cancelled");
            assert_eq!(anew.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
            let bits = |m: &LiveMap| m.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert!(bits(&map) == bits(&anew), "the map differs from a new one");
            open = map.values().iter().filter(|v| v.is_nan()).count();
        }
        let all = map.values().len();
        assert!(open > all / 4, "{open} of {all} rays hit nothing");
        assert!(again < strokes * all / 4, "{again} of {all} in {strokes} strokes");
        // Values at every tenth vertex; a ray along an edge may pass on either side of it.
        let now = clay.snapshot().to_tri();
        let (mut same, mut compared) = (0, 0);
        let sharp = sharp_vertices(&now);
        // On a sharp edge the gap is that in front of the faces.
        for v in (0..all as u32).step_by(10).filter(|v| !sharp[*v as usize]) {
            let value = map.values()[v as usize];
            let wanted = gap_by_force(&now, v, map.normals()[v as usize]);
            compared += 1;
            same += usize::from(
                value.is_nan() && wanted.is_nan() || (value - wanted).abs() < 1e-4 * wanted.abs(),
            );
        }
        assert!(same * 100 >= compared * 98, "{same} of {compared}");
    }
}

#[test]
fn a_thousand_dabs_measure_as_few_gaps_at_the_end_as_at_the_start() {
    let job = Job::default();
    let [balls, _] = parts_with_gaps();
    let mut clay = Clay::build(&balls, &job).expect("a good mesh");
    let mut map = LiveMap::new(&clay.snapshot(), MeasuredSide::Gap, &job).expect("not cancelled");
    assert_eq!(map.work(Vec3::ZERO, usize::MAX, &job), Ok(0));
    let workers = Workers::new(1);
    // On the side that looks away from the other ball: nearly all rays there hit nothing.
    let (mut stale, mut moved) = (Vec::new(), Vec::new());
    for i in 0..1000 {
        let turn = i as f32 * 0.31;
        let centre = Vec3::new(-1.0, 0.4 * turn.sin(), 0.4 * turn.cos()).normalize() * 5.0;
        let (radius, height) = (0.7, if i % 2 == 0 { 0.01 } else { -0.01 });
        let before = clay.snapshot().to_tri().positions;
        clay.begin_step();
        let dab = GaussianBrush::new(centre, radius, centre.normalize(), height);
        clay.dab(&Reach::Sphere { centre, radius }, &dab, &workers);
        clay.end_step();
        let newer = clay.snapshot();
        let after = newer.to_tri().positions;
        moved.push(before.iter().zip(&after).filter(|(a, b)| a != b).count());
        assert_eq!(map.advance(&newer), Ok(()));
        stale.push(map.stale());
        assert_eq!(map.work(centre, usize::MAX, &job), Ok(0));
    }
    let sum = |of: &[usize]| of.iter().sum::<usize>();
    let (first, last) = (sum(&stale[..100]), sum(&stale[900..]));
    println!("measured again: {first} in the first 100 dabs, {last} in the last 100");
    assert!(last * 10 <= first * 12, "{first} {last}");
    // The dab's vertices with their neighbours, not all whose rays hit nothing.
    assert!(sum(&stale) <= 8 * sum(&moved), "{} for {}", sum(&stale), sum(&moved));
}
