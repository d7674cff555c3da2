//! The live map: after a stroke it equals a new map, at a cost that follows the change.

use glam::Vec3;
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::live_thickness::{LiveMap, Rebuild};
use sculptd_clay::{Clay, Reach, Workers};
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::ThicknessSettings;
use sculptd_geometry::thickness::changes::EarlierVersion;

use crate::thickness_shapes::{shell, slab};

#[test]
fn after_a_stroke_the_map_equals_a_new_one() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let rings = if long { 350 } else { 60 };
    let job = Job::default();
    let mut mesh = Clay::build(&shell(10.0, 8.5, rings), &job).expect("a good mesh");
    let mut map = LiveMap::new(&mesh.snapshot(), &job).expect("not cancelled");
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
    let mut anew = LiveMap::new(&newer, &job).expect("not cancelled");
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
    let mut map = LiveMap::new(&a.snapshot(), &job).expect("not cancelled");
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
    let mut map = LiveMap::new(&clay.snapshot(), &job).expect("not cancelled");
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
