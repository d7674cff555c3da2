//! Ticks of a stroke with and without the live thickness map beside them, and how long after pen-up
//! the map is right; or with and without the live score of an exhibit.
//!
//!     cargo run --release --no-default-features --example live [-- SECONDS [VERTICES [gap|score]]]
//!
//! A hollow ball of VERTICES (500,000: a million triangles) is sculpted at 120 ticks a second, a
//! dab of about 5,000 vertices each, out and in by turns. The map's thread gets each tick's
//! snapshot, the newest wins, as in the viewer. The map is of walls, or with `gap` of gaps: the
//! rays of half of the vertices then hit nothing. With `score` the clay is the block of the exhibit
//! `figurine`, and its score is measured as during a visit.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use crossbeam_channel as cc;
use glam::Vec3;
use sculptd_clay::brush::GaussianBrush;
use sculptd_clay::live_thickness::LiveMap;
use sculptd_clay::{Clay, Reach, Snapshot, Workers};
use sculptd_daemon::kiosk::exhibit;
use sculptd_daemon::kiosk::exhibit::score::Goal;
use sculptd_daemon::pacer::Pacer;
use sculptd_daemon::priority::raise_priority;
use sculptd_devices::Clock;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::{TriMesh, shapes};

const HZ: u32 = 120;

fn hollow(vertices: usize) -> TriMesh {
    let mut ball = shapes::sphere_of_about(vertices / 2);
    let count = ball.positions.len() as u32;
    let inner: Vec<Vec3> = ball.positions.iter().map(|p| *p * 0.85).collect();
    let flipped: Vec<[u32; 3]> =
        ball.triangles.iter().map(|&[a, b, c]| [a, c, b].map(|v| v + count)).collect();
    ball.positions.extend(inner);
    ball.triangles.extend(flipped);
    ball
}

/// The measurement beside the ticks.
#[derive(Debug, Clone)]
enum Beside {
    Map(MeasuredSide),
    Score(Arc<Goal>),
}

/// Time between two scores during a visit.
const SCORE_REST: Duration = Duration::from_millis(300);

/// Scores the newest snapshot, then rests.
fn score(goal: &Goal, newest: &cc::Receiver<(Snapshot, Vec3)>, stop: &AtomicBool) {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    while !stop.load(Relaxed) {
        let Ok((snapshot, _)) = newest.recv_timeout(Duration::from_millis(20)) else { continue };
        let _ = pool.install(|| goal.score(&snapshot.to_tri(), &Job::default()));
        let _ = cc::never::<()>().recv_timeout(SCORE_REST);
    }
}

struct Ticks {
    us: Vec<u64>,
    /// From pen-up to a map of the last snapshot with nothing stale.
    right_ms: Vec<f64>,
}

/// What the map's thread does: the newest snapshot, until nothing is stale.
fn follow(
    mut map: LiveMap,
    newest: &cc::Receiver<(Snapshot, Vec3)>,
    right: &cc::Sender<u64>,
    stop: &AtomicBool,
) {
    let job = Job::default();
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    while !stop.load(Relaxed) {
        let Ok((mut snapshot, mut near)) = newest.recv_timeout(Duration::from_millis(20)) else {
            continue;
        };
        loop {
            let left = pool.install(|| {
                map.advance(&snapshot)
                    .is_ok()
                    .then(|| map.work(near, 40_000, &job).ok())
                    .flatten()
                    .unwrap_or(0)
            });
            match newest.try_recv() {
                Ok(newer) => (snapshot, near) = newer,
                Err(_) if left > 0 => {}
                Err(_) => break,
            }
        }
        let _ = right.send(map.revision());
    }
}

fn stroke(plain: &TriMesh, seconds: f64, clock: &Clock, beside: Option<Beside>) -> Option<Ticks> {
    let job = Job::default();
    let mut mesh = Clay::build(plain, &job).ok()?;
    let workers = Workers::new(1);
    let (lo, hi) = mesh.bounds();
    let size = (hi - lo).max_element() * 0.5;
    // Of the outer shell, half the vertices: a cap of 5,000.
    let radius = size * (4.0 * 5000.0 / (mesh.vertex_count() as f32 * 0.5)).sqrt();
    let (send, newest) = cc::bounded(1);
    let (right, rights) = cc::unbounded();
    let stop = Arc::new(AtomicBool::new(false));
    let maps = matches!(beside, Some(Beside::Map(_)));
    let thread = if let Some(Beside::Score(goal)) = beside {
        let (stop, drain) = (stop.clone(), newest.clone());
        Some(std::thread::spawn(move || score(&goal, &drain, &stop)))
    } else if let Some(Beside::Map(side)) = beside {
        let mut map = LiveMap::new(&mesh.snapshot(), side, &job).ok()?;
        map.work(Vec3::ZERO, usize::MAX, &job).ok()?;
        let (stop, drain) = (stop.clone(), newest.clone());
        Some(std::thread::spawn(move || follow(map, &drain, &right, &stop)))
    } else {
        None
    };
    let mut out = Ticks { us: Vec::new(), right_ms: Vec::new() };
    // The helper has started: only the ticks are urgent, as in the loop.
    raise_priority();
    let sleeper = spin_sleep::SpinSleeper::default();
    let mut pacer = Pacer::new(HZ, clock.now_us());
    let ticks = (seconds * f64::from(HZ)) as usize;
    for i in 0..ticks {
        pacer.wait(clock, &sleeper);
        let start = clock.now_us();
        mesh.begin_step();
        let t = (i / 2) as f32 * 0.02;
        let towards = Vec3::new(t.cos(), (t * 0.37).sin() * 0.7, t.sin()).normalize();
        let centre = towards * size;
        let height = radius * if i % 2 == 0 { 0.02 } else { -0.02 };
        mesh.dab(
            &Reach::Sphere { centre, radius },
            &GaussianBrush::new(centre, radius, towards, height),
            &workers,
        );
        let last = i % 240 == 239;
        if last {
            mesh.end_step();
        }
        let snapshot = mesh.snapshot();
        out.us.push(clock.now_us() - start);
        let revision = snapshot.revision();
        pacer.done(clock.now_us());
        // One place: what was not taken yet is old.
        let _ = newest.try_recv();
        let _ = send.try_send((snapshot, centre));
        if last && maps {
            let up = clock.now_us();
            let done = rights.iter().find(|r| *r >= revision);
            out.right_ms.extend(done.map(|_| (clock.now_us() - up) as f64 * 1e-3));
            pacer = Pacer::new(HZ, clock.now_us());
        }
    }
    stop.store(true, Relaxed);
    if let Some(thread) = thread {
        let _ = thread.join();
    }
    Some(out)
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize, or: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (seconds, vertices) = (number(1, 10.0), number(2, 500_000.0) as usize);
    let clock = Clock::monotonic();
    let (plain, kind) = match args.get(3).map(String::as_str) {
        Some("score") => {
            let exhibit = exhibit::open(Path::new("figurine"), &Job::default());
            let Ok(exhibit) = exhibit else { return };
            let Some(goal) = exhibit.steps[0].goal.clone() else { return };
            ((*exhibit.start).clone(), Beside::Score(goal))
        }
        Some("gap") => (hollow(vertices), Beside::Map(MeasuredSide::Gap)),
        _ => (hollow(vertices), Beside::Map(MeasuredSide::Wall)),
    };
    // In turns, so that a busy machine is busy for both.
    for _ in 0..3 {
        for beside in [None, Some(kind.clone())] {
            let what = if beside.is_some() { "with   " } else { "without" };
            let measured =
                std::thread::scope(|s| s.spawn(|| stroke(&plain, seconds, &clock, beside)).join());
            let Ok(Some(Ticks { mut us, mut right_ms })) = measured else {
                return;
            };
            us.sort_unstable();
            right_ms.sort_by(f64::total_cmp);
            let at = |q: f64| us.get((us.len() as f64 * q) as usize).copied().unwrap_or(0);
            let _ = writeln!(
                std::io::stdout(),
                "{what}: tick p50 {} us, p90 {}, p99 {}, max {}; right after pen-up in ms: \
                    {right_ms:.1?}",
                at(0.5),
                at(0.9),
                at(0.99),
                us.last().copied().unwrap_or(0),
            );
        }
    }
}
