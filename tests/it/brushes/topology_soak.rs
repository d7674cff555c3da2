//! Random brushes with dynamic topology, through the world: the surface stays one, undo leads back
//! to the first bit, and the count of workers changes nothing.
//!
//! A hundred thousand dabs where `SCULPTD_LONG` is set, about two thousand else.

use sculptd_clay::brush::{BrushKind, BrushSettings, Measure, Method};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::Studio;
use super::properties::{any_brush, any_stroke};
use super::topology::checked;

/// A random brush that changes topology, with edges of a size that keeps the mesh small.
fn any_cutting_brush(dice: &mut Dice) -> BrushSettings {
    loop {
        let mut brush = any_brush(dice);
        if !brush.kind.cuts() || brush.kind == BrushKind::SnakeHook && dice.next() < 0.5 {
            continue;
        }
        if matches!(brush.path.method, Method::Anchored | Method::DragDot | Method::Curve) {
            brush.path.method = Method::Space;
        }
        brush.saturation = 0.0;
        brush.mirror.radial = 1;
        // The form must last for thousands of strokes.
        brush.strength *= 0.5;
        brush.topology.by = Measure::Work;
        brush.topology.edge = 0.015 + 0.03 * dice.next();
        brush.topology.split = true;
        brush.topology.collapse = dice.next() < 0.9;
        return brush.clamped();
    }
}

/// Result of a run.
#[derive(Debug)]
struct Outcome {
    /// Of the world at the start and at the end of each window.
    hashes: Vec<u64>,
    dabs: u64,
    dropped: u64,
    /// The least angle that was seen, degrees.
    least: f64,
}

/// The least angle of a triangle once a stroke's work is done, degrees: brushes squeeze triangles,
/// and the few that cannot be brought to 3 degrees stay above this (1.0 on the ball and 0.6 on the
/// ring were seen).
const LEAST_ANGLE: f64 = 0.25;
/// Strokes between two looks at the whole surface.
const WINDOW: usize = 25;
/// A window ends with fewer strokes where its undo steps weigh this much: all must be kept.
const WINDOW_BYTES: usize = 700 << 20;
/// Random strokes make the form swell: above this number of vertices a run restarts, or it would
/// become slow.
const MOST_VERTICES: usize = 25_000;

/// Draws until this number of dabs is reached. `look`: checks the surface, and undoes each window.
fn run(start: &TriMesh, euler: i64, dabs: u64, workers: usize, look: bool) -> Outcome {
    let mut dice = Dice(77);
    let first = any_cutting_brush(&mut dice);
    let mut studio = Studio::new(start, first, workers);
    let mut out = Outcome { hashes: vec![], dabs: 0, dropped: 0, least: 180.0 };
    while out.dabs < dabs {
        if studio.world.mesh().vertex_count() > MOST_VERTICES {
            studio = Studio::new(start, first, workers);
        }
        // Earlier steps can no longer be undone.
        studio.tell(Command::Reopened);
        let before = studio.world.hash();
        for stroke in 0..WINDOW {
            studio.tell(Command::Brush(any_cutting_brush(&mut dice)));
            out.dabs += studio.stroke(&any_stroke(&mut dice));
            out.dropped += studio.world.report().topology_dropped;
            if stroke % 4 == 0 {
                // The hand turns the form under the pen.
                let camera = *studio.world.camera();
                let yaw = camera.yaw + 0.9 * dice.next();
                let pitch = 1.2 * (dice.next() - 0.5);
                studio.tell(Command::Camera(Camera { yaw, pitch, ..camera }));
            }
            if studio.world.mesh().memory().undo > WINDOW_BYTES {
                break;
            }
        }
        let now = studio.world.hash();
        out.hashes.extend([before, now]);
        if look {
            studio.world.verify_invariants().unwrap_or_else(|e| panic!("{} dabs: {e}", out.dabs));
            let (found, least) = checked(&studio.world.mesh().to_tri());
            assert_eq!(found, euler, "{} dabs", out.dabs);
            out.least = out.least.min(least);
            let steps = studio.world.mesh().undo_steps();
            (0..steps).for_each(|_| studio.tell(Command::Undo));
            assert_eq!(studio.world.hash(), before, "taken back after {} dabs", out.dabs);
            (0..steps).for_each(|_| studio.tell(Command::Redo));
            assert_eq!(studio.world.hash(), now, "done again after {} dabs", out.dabs);
            println!(
                "{} dabs: {} vertices in {} pages, {steps} steps, least angle {least:.4} degrees",
                out.dabs,
                studio.world.mesh().vertex_count(),
                studio.world.mesh().page_count()
            );
        }
    }
    out
}

#[test]
fn random_brushes_with_dynamic_topology_keep_the_surface_whole() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let dabs = if long { 50_000 } else { 1_000 };
    for (start, euler) in
        [(shapes::icosphere(1.0, 24), 2), (shapes::torus(0.8, 0.3, 64, 32).triangulate().0, 0)]
    {
        let one = run(&start, euler, dabs, 1, true);
        println!("{} dabs, {} balls dropped, least angle {}", one.dabs, one.dropped, one.least);
        assert_eq!(one.dropped, 0);
        // Brushes squeeze triangles to nothing; below 3 degrees they are mended where that can be.
        assert!(one.least >= LEAST_ANGLE, "an angle of {} degrees", one.least);
        for workers in [2, 3, 7, 16] {
            let start = &start;
            // The workers' pool belongs to the first thread that uses it: each run has a separate
            // one.
            let other = std::thread::scope(|s| {
                s.spawn(|| run(start, euler, dabs, workers, false)).join().expect("no panic")
            });
            // Taking a window back and doing it again leaves no trace either.
            assert_eq!(other.hashes, one.hashes, "with {workers} workers");
            println!("{} dabs: the same bits with {workers} workers", other.dabs);
        }
    }
}
