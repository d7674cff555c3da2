//! Triangles cut while sculpting: always a surface, always whole, never slivers.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings, GaussianBrush, Measure, SmoothBrush};
use sculptd_clay::{Clay, Detail, Ray, Reach, Workers};
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::{Studio, s_curve};

/// Smallest angle of a triangle, degrees.
fn least_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    let at = |p: glam::DVec3, q: glam::DVec3, r: glam::DVec3| {
        (q - p).cross(r - p).length().atan2((q - p).dot(r - p))
    };
    at(a, b, c).min(at(b, c, a)).min(at(c, a, b)).to_degrees()
}

/// Closed, oriented, each vertex amid one fan; its Euler characteristic and its smallest angle.
pub(super) fn checked(mesh: &TriMesh) -> (i64, f64) {
    let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut about = vec![0u32; mesh.positions.len()];
    for t in &mesh.triangles {
        for k in 0..3 {
            let e = (t[k], t[(k + 1) % 3]);
            assert_eq!(edges.insert(e, t[(k + 2) % 3]), None, "edge {e:?} twice in one direction");
            about[t[k] as usize] += 1;
        }
    }
    for (a, b) in edges.keys() {
        assert!(edges.contains_key(&(*b, *a)), "edge {a}-{b} is open");
    }
    for &(v, first) in edges.keys() {
        // Round the fan: as many steps as triangles, no sooner.
        let (mut k, mut steps) = (first, 0);
        loop {
            k = edges[&(v, k)];
            steps += 1;
            if k == first || steps > 1000 {
                break;
            }
        }
        assert_eq!(steps, about[v as usize], "vertex {v} has several fans");
    }
    let least =
        (0..mesh.triangles.len()).map(|t| least_angle(mesh.corners(t))).fold(180.0, f64::min);
    assert!(about.iter().all(|n| *n > 0), "a vertex without triangles");
    (mesh.positions.len() as i64 - edges.len() as i64 / 2 + mesh.triangles.len() as i64, least)
}

#[test]
fn ten_thousand_random_dabs_leave_a_closed_surface_without_slivers() {
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 100 } else { 6 };
    for (start, euler) in
        [(shapes::icosphere(1.0, 24), 2), (shapes::torus(0.8, 0.3, 48, 24).triangulate().0, 0)]
    {
        let mut mesh = Clay::build(&start, &Job::default()).expect("builds");
        mesh.set_undo_bytes(64 << 20);
        let one = Workers::new(1);
        let mut dice = Dice(31);
        let (mut splits, mut collapses, mut flips) = (0, 0, 0);
        assert_eq!(checked(&mesh.to_tri()).0, euler);
        for round in 0..rounds {
            for _ in 0..100 {
                let from = dice.unit();
                let Some(hit) = mesh.pick(Ray { origin: from * 5.0, dir: -from }) else { continue };
                let radius = 0.08 + 0.25 * dice.next();
                let edge = 0.03 + 0.09 * dice.next();
                mesh.begin_step();
                let centre = hit.position;
                let detail = Detail { centre, radius, edge, split: true, collapse: true };
                let cuts = mesh.adapt_topology(&[detail], 2000, &one);
                splits += cuts.splits;
                collapses += cuts.collapses;
                flips += cuts.flips;
                let reach = Reach::Sphere { centre: hit.position, radius };
                if dice.next() < 0.4 {
                    mesh.dab(&reach, &SmoothBrush::new(hit.position, radius, 0.5), &one);
                } else {
                    let height = radius * (dice.next() - 0.5) * 0.06;
                    mesh.dab(
                        &reach,
                        &GaussianBrush::new(hit.position, radius, hit.normal, height),
                        &one,
                    );
                }
                mesh.end_step();
            }
            mesh.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
            let (now, least) = checked(&mesh.to_tri());
            assert_eq!(now, euler, "round {round}");
            assert!(least >= 1.0, "round {round}: an angle of {least} degrees");
            if round % 10 == 0 || round + 1 == rounds {
                println!(
                    "{} dabs: {splits} splits, {collapses} collapses, {flips} flips, {} vertices, \
                        {} pages, least angle {least:.2}",
                    (round + 1) * 100,
                    mesh.vertex_count(),
                    mesh.page_count()
                );
            }
        }
        assert!(splits > 100 && collapses > 100 && flips > 100, "{splits} {collapses} {flips}");
    }
}

#[test]
fn cuts_are_taken_back_by_undo_and_done_again_by_redo() {
    let brush = BrushSettings { radius: 0.15, ..sculptd::presets().of(BrushKind::Draw) };
    let mut brush = brush;
    brush.topology.by = Measure::Brush;
    brush.topology.edge = 0.12;
    let start = shapes::icosphere(1.0, 20);
    let run = |workers: usize| {
        let mut studio = Studio::new(&start, brush, workers);
        let mut hashes = vec![studio.world.hash()];
        for _ in 0..3 {
            studio.stroke(&s_curve());
            studio.world.verify_invariants().expect("in order");
            hashes.push(studio.world.hash());
        }
        (studio, hashes)
    };
    let (mut studio, hashes) = run(1);
    let grown = studio.world.mesh().vertex_count();
    assert!(grown > start.positions.len() + 500, "{grown}");
    assert_eq!(checked(&studio.world.mesh().to_tri()).0, 2);
    for hash in hashes.iter().rev().skip(1) {
        studio.tell(Command::Undo);
        assert_eq!(studio.world.hash(), *hash);
        studio.world.verify_invariants().expect("in order after undo");
    }
    assert_eq!(studio.world.mesh().to_tri(), start);
    for hash in &hashes[1..] {
        studio.tell(Command::Redo);
        assert_eq!(studio.world.hash(), *hash);
    }
    studio.world.verify_invariants().expect("in order after redo");
    for workers in [2, 3, 7, 16] {
        let other = std::thread::scope(|s| s.spawn(|| run(workers).1).join().expect("no panic"));
        assert_eq!(other, hashes, "with {workers} workers");
    }
}

#[test]
fn detail_is_what_was_asked_for_and_the_cost_is_local() {
    let start = shapes::icosphere(1.0, 16);
    let mut mesh = Clay::build(&start, &Job::default()).expect("builds");
    let detail = Detail { centre: Vec3::Z, radius: 0.6, edge: 0.04, split: true, collapse: true };
    let two = Workers::new(2);
    for _ in 0..3 {
        mesh.adapt_topology(&[detail], usize::MAX, &two);
    }
    mesh.verify_invariants().expect("in order");
    let end = mesh.to_tri();
    checked(&end);
    let (mut longest, mut edges) = (0.0f32, Vec::new());
    for t in &end.triangles {
        let p = t.map(|v| end.positions[v as usize]);
        for k in 0..3 {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            if (a - Vec3::Z).length() < 0.55 && (b - Vec3::Z).length() < 0.55 {
                longest = longest.max((a - b).length());
                edges.push((a - b).length());
            }
        }
    }
    edges.sort_by(f32::total_cmp);
    let median = edges[edges.len() / 2];
    assert!(longest < 0.04 * 1.34, "{longest}");
    assert!((0.02..0.05).contains(&median), "{median}");
    // The surface beyond is unchanged.
    let far = |m: &TriMesh| m.positions.iter().filter(|p| (**p - Vec3::Z).length() > 0.65).count();
    assert_eq!(far(&start), far(&end));
    // The other way: all of it drawn together.
    let coarse = Detail { edge: 0.2, split: false, ..detail };
    for _ in 0..6 {
        mesh.adapt_topology(&[coarse], usize::MAX, &two);
    }
    mesh.verify_invariants().expect("in order");
    let within =
        |m: &TriMesh| m.positions.iter().filter(|p| (**p - Vec3::Z).length() < 0.5).count();
    let coarse = mesh.to_tri();
    assert!(within(&coarse) * 4 < within(&end), "{} of {}", within(&coarse), within(&end));
    checked(&coarse);
}

#[test]
fn what_is_carried_over_is_done_within_half_a_second() {
    let mut brush = BrushSettings { radius: 0.2, ..sculptd::presets().of(BrushKind::Clay) };
    brush.topology.by = Measure::Brush;
    for edge in [0.15, 0.05] {
        brush.topology.edge = edge;
        let start = shapes::sphere_of_about(158_762);
        let mut studio = Studio::new(&start, brush, 2);
        for (view, pressure) in s_curve() {
            studio.sample(view, pressure, true);
        }
        let (last, _) = s_curve()[s_curve().len() - 1];
        studio.sample(last, 0.0, false);
        let mut ticks = 1;
        studio.rest(1);
        while studio.paused {
            studio.rest(1);
            ticks += 1;
            assert!(ticks <= 60, "with edge {edge}");
        }
        println!("edge {edge}: {ticks} ticks after the pen was lifted");
        studio.world.verify_invariants().expect("in order");
        assert_eq!(checked(&studio.world.mesh().to_tri()).0, 2);
        studio.tell(Command::Undo);
        assert_eq!(studio.world.mesh().to_tri(), start);
    }
}

#[test]
fn a_stroke_that_is_taken_back_at_once_is_whole_when_it_is_done_again() {
    let mut brush = BrushSettings { radius: 0.2, ..sculptd::presets().of(BrushKind::Clay) };
    brush.topology.by = Measure::Brush;
    brush.topology.edge = 0.06;
    let start = shapes::sphere_of_about(40_000);
    let draw = |studio: &mut Studio| {
        for (view, pressure) in s_curve() {
            studio.sample(view, pressure, true);
        }
        let (last, _) = s_curve()[s_curve().len() - 1];
        studio.sample(last, 0.0, false);
    };
    // Taken back while work waits, and done again.
    let mut hasty = Studio::new(&start, brush, 2);
    draw(&mut hasty);
    assert!(hasty.paused, "nothing was carried over");
    hasty.tell(Command::Undo);
    assert!(!hasty.paused);
    assert_eq!(hasty.world.mesh().to_tri(), start);
    hasty.tell(Command::Redo);
    assert_eq!(hasty.world.report().topology_dropped, 0);
    hasty.world.verify_invariants().expect("in order");
    // Nothing is left to be done where the stroke went: asking again changes next to nothing.
    let clay = hasty.world.mesh();
    let edges = |m: &TriMesh| {
        let mut lengths: Vec<f32> = Vec::new();
        for t in &m.triangles {
            let p = t.map(|v| m.positions[v as usize]);
            let near = |v: Vec3| (hasty.view(v) - Vec2::new(0.5, 0.5)).length() < 0.03 && v.z > 0.0;
            if p.iter().all(|v| near(*v)) {
                lengths.extend((0..3).map(|k| (p[k] - p[(k + 1) % 3]).length()));
            }
        }
        lengths.sort_by(f32::total_cmp);
        lengths
    };
    let lengths = edges(&clay.to_tri());
    let mut calm = Studio::new(&start, brush, 2);
    calm.stroke(&s_curve());
    let wanted = edges(&calm.world.mesh().to_tri());
    let median = |of: &[f32]| of[of.len() / 2];
    println!("median edge {} after undo and redo, {} else", median(&lengths), median(&wanted));
    assert!((median(&lengths) / median(&wanted) - 1.0).abs() < 0.1);
}
