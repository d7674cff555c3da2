//! The live map: after a stroke it equals a new map, at a cost that follows the change.

use glam::Vec3;
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::live_thickness::{LiveMap, Rebuild};
use sculptd_clay::{Clay, Reach, Workers};
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;

use crate::thickness_shapes::shell;

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
