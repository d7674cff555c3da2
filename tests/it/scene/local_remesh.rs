//! Triangles of one size in place, by the control protocol of a running loop.

use super::*;
use sculptd_geometry::check;

#[test]
fn what_was_stretched_is_remeshed_by_request_taken_back_and_replayed() {
    let dir = tempfile::tempdir().expect("a folder");
    let (file, session) = (dir.path().join("drawn-out.ply"), dir.path().join("s.sculpt"));
    let mut mesh = shapes::icosphere(10.0, 60);
    for p in mesh.positions.iter_mut().filter(|p| p.x > 0.0) {
        p.x *= 1.0 + 0.05 * p.x * p.x;
    }
    write_mesh(&file, &mesh.to_poly()).expect("written");
    let run = Running::begin(std::slice::from_ref(&file), &session);
    let (start, before) = (run.bits(), run.live.published.load().undo_steps);
    let far = run.refused("remesh.local", json!({ "edge": 100.0 }));
    assert!(far.contains("16 times of the object's usual one"), "{far}");
    let none = json!({ "region": { "polygon": [[0.0, 0.0], [1.0, 1.0]] } });
    let none = run.refused("remesh.local", none);
    assert!(none.contains("region") && none.contains("3"), "{none}");
    assert_eq!((run.bits(), run.live.published.load().undo_steps), (start.clone(), before));

    let wanted = json!({ "edge": 0.25, "stretched_only": true });
    let changed = run.ask("remesh.local", wanted.clone())["changed"].as_u64().expect("a number");
    assert!(changed > 5_000, "{changed}");
    let refined = run.bits();
    assert_ne!(refined, start);
    let shown = run.live.published.load_full();
    assert_eq!(shown.undo_steps, before + 1);
    let made = shown.mesh.to_tri();
    let facts = check::report(&made.to_poly(), true, &Job::default()).expect("not cancelled");
    assert!(facts.closed && facts.manifold && facts.self_intersections == Some(0), "{facts:?}");
    assert!(facts.vertices > mesh.positions.len() * 2, "{facts:?}");
    let lengths = made.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| made.positions[v as usize]);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    });
    let longest = lengths.fold(0.0, f32::max);
    assert!(longest < 0.25 * 1.5, "{longest}");
    // All have their size now: nothing is changed, and there is no step.
    assert_eq!(run.ask("remesh.local", wanted)["changed"], 0);
    assert_eq!(run.live.published.load().undo_steps, before + 1);

    run.ask("undo", json!({}));
    assert_eq!(run.bits(), start);
    // A box in the middle of the view.
    let part = json!({ "edge": 0.2, "region": { "box": [0.4, 0.4, 0.6, 0.6] } });
    assert!(run.ask("remesh.local", part)["changed"].as_u64() > Some(100));
    run.ask("undo", json!({}));
    assert_eq!(run.bits(), start);
    let id = run.objects()[0]["id"].clone();
    let refused = || run.refused("remesh.local", json!({}));
    run.ask("scene.show", json!({ "id": id, "visible": false }));
    assert!(refused().contains("is hidden"));
    run.ask("scene.show", json!({ "id": id, "visible": true }));
    run.ask("scene.lock", json!({ "id": id, "locked": true }));
    assert!(refused().contains("locked"));
    run.ask("scene.lock", json!({ "id": id, "locked": false }));
    // An undo does not wait for the end of the edit that it undoes.
    let (begun, count) = (run.bits(), || run.live.published.load().mesh.triangle_count());
    let (steps, triangles) = (run.live.published.load().undo_steps, count());
    std::thread::scope(|scope| {
        let long = json!({ "edge": 0.04 });
        let asked = scope.spawn(|| run.refused("remesh.local", long));
        while count() == triangles && !asked.is_finished() {
            std::thread::yield_now();
        }
        run.ask("undo", json!({}));
        let said = asked.join().expect("it ends");
        assert!(said.contains("taken back by an undo"), "{said}");
    });
    assert!(run.bits() == begun, "to the bit");
    assert_eq!(run.live.published.load().undo_steps, steps);

    run.ask("remesh.local", json!({}));
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}
