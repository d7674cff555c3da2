//! Random dabs with dynamic topology leave a closed surface whatever the budget and the workers.

use std::collections::BTreeMap;

use glam::Vec3;

use crate::brush::stamp::Lens;
use crate::brush::{
    BrushKind, BrushSettings, Dab, GaussianBrush, Grip, Scratch, SmoothBrush, Tool,
};
use crate::{
    Clay, Cuts, DabReport, Detail, Hit, LEAST_TOPOLOGY_BUDGET, PAGE_SCAN, Ray, Reach, Workers,
};
use sculptd_geometry::{TriMesh, job::Job, shapes};

/// Numbers between 0 and 1 that only the seed decides.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let p = Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

/// Asserts that the mesh is closed, oriented and a manifold; its Euler characteristic, its smallest
/// angle in degrees, and its largest valence.
fn checked(mesh: &TriMesh) -> (i64, f64, u32) {
    let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut about = vec![0u32; mesh.positions.len()];
    let mut least = 180.0f64;
    for t in &mesh.triangles {
        let p = t.map(|v| mesh.positions[v as usize].as_dvec3());
        for k in 0..3 {
            let twice = edges.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
            assert_eq!(twice, None, "an edge twice in one direction");
            about[t[k] as usize] += 1;
            let (u, v) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            least = least.min(u.angle_between(v).to_degrees());
        }
    }
    for &(a, b) in edges.keys() {
        assert!(edges.contains_key(&(b, a)), "edge {a}-{b} is open");
    }
    for &(v, first) in edges.keys() {
        let (mut k, mut steps) = (edges[&(v, first)], 1);
        while k != first && steps < 1000 {
            (k, steps) = (edges[&(v, k)], steps + 1);
        }
        assert_eq!(steps, about[v as usize], "vertex {v} has several fans");
    }
    assert!(about.iter().all(|n| *n > 0), "a vertex without triangles");
    let euler = mesh.positions.len() as i64 - edges.len() as i64 / 2 + mesh.triangles.len() as i64;
    (euler, least, about.into_iter().max().unwrap_or(0))
}

/// Applies one random dab with dynamic topology and a separate budget.
fn dab(clay: &mut Clay, dice: &mut Dice, workers: &Workers, sum: &mut Cuts) {
    let from = dice.direction();
    let Some(hit) = clay.pick(Ray { origin: from * 5.0, dir: -from }) else { return };
    let radius = 0.06 + 0.25 * dice.next();
    let edge = 0.02 + 0.09 * dice.next();
    let budget = if dice.next() < 0.3 { 60 + (dice.next() * 400.0) as usize } else { 100_000 };
    clay.begin_step();
    let detail = Detail { centre: hit.position, radius, edge, split: true, collapse: true };
    let cuts = clay.adapt_topology(&[detail], budget, workers);
    sum.splits += cuts.splits;
    sum.collapses += cuts.collapses;
    sum.flips += cuts.flips;
    let reach = Reach::Sphere { centre: hit.position, radius };
    if dice.next() < 0.4 {
        clay.dab(&reach, &SmoothBrush::new(hit.position, radius, 0.5), workers);
    } else {
        let height = radius * (dice.next() - 0.5) * 0.06;
        clay.dab(&reach, &GaussianBrush::new(hit.position, radius, hit.normal, height), workers);
    }
    clay.end_step();
}

/// Applies one dab of a random brush with the surface grip, at its default strength.
fn random_brush(clay: &mut Clay, hit: &Hit, radius: f32, dice: &mut Dice, workers: &Workers) {
    let kinds: Vec<_> = BrushKind::ALL.iter().filter(|k| k.grip() == Grip::Surface).collect();
    let kind = *kinds[(dice.next() * kinds.len() as f32) as usize];
    let settings = BrushSettings { radius, ..BrushSettings::new(kind) };
    let along = hit.normal.any_orthonormal_vector();
    let right = hit.normal.cross(along);
    let lens = Lens {
        eye: hit.position + hit.normal * 3.0,
        right,
        up: along,
        back: hit.normal,
        half: 0.4,
        parallel: false,
    };
    let dab = Dab {
        settings: &settings,
        centre: hit.position,
        normal: hit.normal,
        touch: hit.position,
        found: false,
        radius,
        strength: settings.strength * 0.5,
        span: 1.0,
        pace: 0.0,
        heading: along * 0.5,
        course: along,
        bend: Vec3::ZERO,
        pass: 0,
        sign: if dice.next() < 0.5 { 1.0 } else { -1.0 },
        motion: along * (0.2 * radius),
        last: Vec3::ZERO,
        eye: hit.normal,
        right,
        lens,
        hand: 1.0,
        image: 0,
        travelled: radius,
        stroke: 1,
        set: 0,
        draws: None,
    };
    let dab = Dab { pace: dab.pace_of(settings.strength * 0.5), ..dab };
    let mut scratch = Scratch::default();
    let mut tool =
        Tool { mesh: clay, workers, scratch: &mut scratch, report: DabReport::default() };
    kind.apply(&[dab], &mut tool);
}

#[test]
fn random_brushes_leave_a_closed_surface() {
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 1000 } else { 8 };
    let start = shapes::sphere_of_about(8_000);
    let mut clay = Clay::build(&start, &Job::default()).unwrap();
    clay.set_undo_bytes(64 << 20);
    let workers = Workers::new(2);
    let (mut dice, mut sum, mut worst) = (Dice(77), Cuts::default(), (180.0f64, 0));
    for round in 0..rounds {
        let (before, steps) = (clay.hash(), clay.undo_steps());
        for _ in 0..100 {
            let from = dice.direction();
            let Some(hit) = clay.pick(Ray { origin: from * 5.0, dir: -from }) else { continue };
            let radius = 0.06 + 0.2 * dice.next();
            let edge = radius * (0.08 + 0.2 * dice.next());
            let ball = Detail { centre: hit.position, radius, edge, split: true, collapse: true };
            clay.begin_step();
            random_brush(&mut clay, &hit, radius, &mut dice, &workers);
            let budget = 500 + (dice.next() * 4000.0) as usize;
            let cuts = clay.adapt_topology(&[ball], budget, &workers);
            sum.splits += cuts.splits;
            sum.collapses += cuts.collapses;
            sum.flips += cuts.flips;
            clay.end_step();
        }
        clay.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
        let (euler, least, valence) = checked(&clay.to_tri());
        assert_eq!(euler, 2, "round {round}");
        worst = (worst.0.min(least), worst.1.max(valence));
        if round % 50 == 1 && clay.undo_steps() >= steps + 90 {
            let (after, made) = (clay.hash(), clay.undo_steps() - steps);
            (0..made).for_each(|_| assert!(clay.undo()));
            assert_eq!(clay.hash(), before);
            (0..made).for_each(|_| assert!(clay.redo()));
            assert_eq!(clay.hash(), after);
        }
    }
    println!("{} dabs: {sum:?}, {} vertices, {worst:?}", rounds * 100, clay.vertex_count());
    assert!(worst.1 <= 12, "{} neighbours", worst.1);
    assert!(sum.splits > 100 && sum.collapses > 100 && sum.flips > 100, "{sum:?}");
}

#[test]
fn random_dabs_leave_a_closed_surface_whatever_the_budget() {
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 500 } else { 6 };
    let starts = [
        (shapes::icosphere(1.0, 24), 2),
        (shapes::torus(0.8, 0.3, 48, 24).triangulate().0, 0),
        (shapes::sphere_of_about(20_000), 2),
    ];
    for (start, euler) in starts {
        let mut clay = Clay::build(&start, &Job::default()).unwrap();
        clay.set_undo_bytes(64 << 20);
        let workers = Workers::new(2);
        let (mut dice, mut sum) = (Dice(31), Cuts::default());
        let mut worst = (180.0f64, 0);
        for round in 0..rounds {
            let before = clay.hash();
            let steps = clay.undo_steps();
            for k in 0..100 {
                dab(&mut clay, &mut dice, &workers, &mut sum);
                if round < 2 && k % 10 == 0 {
                    clay.verify_invariants().unwrap_or_else(|e| panic!("{round} {k}: {e}"));
                }
            }
            clay.verify_invariants().unwrap_or_else(|e| panic!("round {round}: {e}"));
            let (now, least, valence) = checked(&clay.to_tri());
            assert_eq!(now, euler, "round {round}");
            worst = (worst.0.min(least), worst.1.max(valence));
            if round == 3 {
                let after = clay.hash();
                let made = clay.undo_steps() - steps;
                (0..made).for_each(|_| assert!(clay.undo()));
                assert_eq!(clay.hash(), before);
                clay.verify_invariants().unwrap();
                (0..made).for_each(|_| assert!(clay.redo()));
                assert_eq!(clay.hash(), after);
            }
        }
        println!(
            "{} dabs: {sum:?}, {} vertices in {} pages, least angle {:.2}, valence {}",
            rounds * 100,
            clay.vertex_count(),
            clay.page_count(),
            worst.0,
            worst.1
        );
        assert!(worst.0 >= 1.0, "an angle of {} degrees", worst.0);
        assert!(worst.1 <= 12, "{} neighbours", worst.1);
        assert!(sum.splits > 100 && sum.collapses > 100 && sum.flips > 100, "{sum:?}");
    }
}

#[test]
fn topology_is_the_same_bits_with_any_number_of_workers() {
    let run = |workers: usize| {
        let mut clay = Clay::build(&shapes::sphere_of_about(40_000), &Job::default()).unwrap();
        let workers = Workers::new(workers);
        let mut dice = Dice(5);
        for _ in 0..60 {
            dab(&mut clay, &mut dice, &workers, &mut Cuts::default());
        }
        let pages: Vec<_> = (0..clay.page_count() as u32)
            .map(|i| {
                let page = clay.page(i);
                let t = page.topology();
                (page.to_bytes(), t.triangles.clone(), t.rings.clone(), t.triangle_ids.clone())
            })
            .collect();
        (clay.hash(), pages)
    };
    let one = run(1);
    for workers in [2, 3, 7, 16] {
        let other = std::thread::scope(|s| s.spawn(|| run(workers)).join().unwrap());
        assert!(other == one, "with {workers} workers");
    }
}

#[test]
fn a_small_budget_comes_to_the_same_detail_in_several_calls() {
    let detail = Detail { centre: Vec3::Z, radius: 0.6, edge: 0.02, split: true, collapse: true };
    let one = Workers::new(1);
    let mut clay = Clay::build(&shapes::icosphere(1.0, 16), &Job::default()).unwrap();
    let mut calls = 0;
    loop {
        let cuts = clay.adapt_topology(&[detail], LEAST_TOPOLOGY_BUDGET, &one);
        assert!(cuts.work < 2 * LEAST_TOPOLOGY_BUDGET, "{cuts:?}");
        calls += 1;
        if !cuts.unfinished {
            break;
        }
        assert!(calls < 200, "{cuts:?}");
    }
    assert!(calls > 5, "{calls}");
    clay.verify_invariants().unwrap();
    let mesh = clay.to_tri();
    checked(&mesh);
    let inside = |v: u32| (mesh.positions[v as usize] - Vec3::Z).length() < 0.55;
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut lengths: Vec<f32> = edges
        .filter(|e| inside(e.0) && inside(e.1))
        .map(|(a, b)| (mesh.positions[a as usize] - mesh.positions[b as usize]).length())
        .collect();
    lengths.sort_by(f32::total_cmp);
    assert!(lengths[lengths.len() - 1] < 0.02 * 1.34, "{:?}", lengths.last());
    assert!((0.01..0.025).contains(&lengths[lengths.len() / 2]));
    // Nothing is changed to and fro: another pass finds nothing to split or collapse.
    // It is another ball, or pages that were looked through would be passed over.
    let other = Detail { radius: 0.599, ..detail };
    let again = clay.adapt_topology(&[other], 100_000, &one);
    assert!(again.work > PAGE_SCAN, "{again:?}");
    assert_eq!((again.splits, again.collapses), (0, 0), "{again:?}");
}

#[test]
fn pages_that_lie_apart_are_changed_by_several_threads_alone_and_to_the_same_bits() {
    let start = shapes::sphere_of_about(20_000);
    let run = |workers: usize| {
        let mut clay = Clay::build(&start, &Job::default()).unwrap();
        let workers = Workers::new(workers);
        let old: Vec<u64> =
            (0..clay.page_count() as u32).map(|p| clay.page(p).revision()).collect();
        let apart = clay.pages_apart(0..clay.page_count() as u32, 3);
        assert_eq!(apart.len(), 3);
        let ball = |page: u32| {
            let (lo, hi) = clay.page(page).bounds();
            let (centre, radius) = ((lo + hi) * 0.5, (hi - lo).length() * 0.6);
            (page, Detail { centre, radius, edge: 0.012, split: true, collapse: true })
        };
        let mut wanted: Vec<_> = apart.iter().map(|&p| ball(p)).collect();
        let (cuts, unfinished) = clay.adapt_pages(&mut wanted, None, 100_000, &workers);
        assert!(cuts.splits > 2000 && unfinished == 0 && !cuts.tangled, "{cuts:?}");
        // Nobody else was written: not even those two pages away.
        for page in (0..old.len() as u32).filter(|p| clay.page(*p).revision() != old[*p as usize]) {
            let beside = apart.iter().filter(|&&a| {
                let near = clay.page(page).topology().neighbours.iter().any(|n| n.page == a);
                a == page || near
            });
            let near_a_part = clay.page(page).topology().neighbours.iter();
            assert!(beside.count() > 0 || near_a_part.clone().any(|n| n.page >= old.len() as u32));
        }
        clay.verify_invariants().unwrap();
        assert_eq!(checked(&clay.to_tri()).0, 2);
        (clay.hash(), clay.page_count())
    };
    let one = run(1);
    for workers in [2, 3, 7, 16] {
        let other = std::thread::scope(|s| s.spawn(|| run(workers)).join().unwrap());
        assert_eq!(other, one, "with {workers} workers");
    }
}

#[test]
fn slivers_are_mended_though_their_edges_have_their_length() {
    let mut ball = shapes::icosphere(1.0, 16);
    let near = |p: &Vec3| (*p - Vec3::Z).length() < 0.3;
    // Squeezed along x, as by a pinch.
    for p in ball.positions.iter_mut().filter(|p| near(p)) {
        p.x *= 0.005;
    }
    let mut clay = Clay::build(&ball, &Job::default()).unwrap();
    let before = checked(&clay.to_tri()).1;
    assert!(before < 2.0, "{before}");
    let detail = Detail { centre: Vec3::Z, radius: 0.5, edge: 0.1, split: false, collapse: false };
    let mut sum = 0;
    loop {
        let cuts = clay.adapt_topology(&[detail], 100_000, &Workers::new(1));
        assert_eq!(cuts.splits, 0);
        sum += cuts.changes();
        if !cuts.unfinished {
            break;
        }
    }
    let (euler, least, _) = checked(&clay.to_tri());
    assert!(sum > 10 && euler == 2 && least >= 3.0, "{sum} changes, an angle of {least}");
    clay.verify_invariants().unwrap();
}
