//! Lists, groups, names, mirrored twins and Booleans that follow their operands, by the control
//! protocol of a running loop.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use super::*;
use sculptd_daemon::live_booleans;

/// A box of a running loop; its id.
fn add_box(run: &Running, size: f64, x: f64) -> u64 {
    let (sides, place) = ([size; 3], json!({ "shift": [x, 0.0, 0.0] }));
    let asked = json!({ "primitive": { "box": sides }, "edge": 0.25, "transform": place });
    run.ask("scene.add", asked)["id"].as_u64().expect("an id")
}

fn volume_of(run: &Running, id: u64, path: &Path) -> f64 {
    run.ask("export", json!({ "path": path, "objects": { "object": id } }));
    measures(&read_mesh(path, &Job::default()).expect("readable").mesh.triangulate().0).volume
}

#[test]
fn a_boolean_follows_its_operands_by_request_is_replayed_and_applied() {
    let dir = tempfile::tempdir().expect("a folder");
    let (session, out) = (dir.path().join("s.sculpt"), dir.path().join("out.ply"));
    let run = Running::begin(&[], &session);
    let stop = Arc::new(AtomicBool::new(false));
    let (commands, published) = (run.live.commands.clone(), run.live.published.clone());
    live_booleans::start(commands, published, stop.clone()).expect("a thread");
    let (a, b) = (add_box(&run, 2.0, 10.0), add_box(&run, 2.0, 11.0));
    let asked = json!({ "operation": "difference", "a": a, "b": b, "live": true });
    let made = run.ask("scene.boolean", asked)["id"].as_u64().expect("an id");
    let follows = |run: &Running| {
        let objects = run.objects();
        objects.iter().find(|o| o["id"] == made).expect("there")["follows"].clone()
    };
    assert_eq!(follows(&run), json!({ "operation": "difference", "a": a, "b": b }));
    let seen: Vec<Value> = run.objects().iter().map(|o| o["visible"].clone()).collect();
    assert_eq!(seen, [true, false, false, true]);
    let volume = |run: &Running| (volume_of(run, made, &out) * 1000.0).round() / 1000.0;
    assert_eq!(volume(&run), 4.0);
    run.ask("scene.transform", json!({ "id": b, "transform": { "shift": [11.5, 0.0, 0.0] } }));
    until("less is cut off", || volume(&run) == 6.0);
    // One step: the move and what followed from it.
    run.ask("undo", json!({}));
    until("both are taken back", || volume(&run) == 4.0);
    run.ask("redo", json!({}));
    until("both are done again", || volume(&run) == 6.0);
    // The operands stand where the result does.
    run.ask("scene.transform", json!({ "id": a, "transform": { "shift": [10.5, 0.0, 0.0] } }));
    until("it has moved", || volume(&run) == 4.0);
    run.ask("scene.apply", json!({ "id": made }));
    assert_eq!(run.objects().len(), 2);
    assert_eq!((volume(&run), follows(&run)), (4.0, Value::Null));
    assert!(run.refused("scene.apply", json!({ "id": made })).contains("does not follow"));
    stop.store(true, Relaxed);
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let quick = session::reopen(&session, &opened, None, 1, &Job::default()).expect("a checkpoint");
    assert_eq!(quick.replayed.world.hash(), hash);
}

#[test]
fn all_four_results_of_two_boxes_are_made_at_once() {
    let dir = tempfile::tempdir().expect("a folder");
    let (session, out) = (dir.path().join("s.sculpt"), dir.path().join("out.ply"));
    let run = Running::begin(&[], &session);
    let (a, b) = (add_box(&run, 2.0, 10.0), add_box(&run, 2.0, 11.5));
    let asked = json!({ "operation": "difference", "a": a, "b": b, "all": true });
    let made = run.ask("scene.boolean", asked);
    assert_eq!(made["objects"], 4);
    let objects = run.objects();
    let made = &objects[objects.len() - 4..];
    let names = ["box - box", "box + box", "box & box", "box - box"];
    let volumes = [6.0, 14.0, 2.0, 6.0];
    for ((object, name), volume) in made.iter().zip(names).zip(volumes) {
        assert_eq!(object["name"], name);
        let found = volume_of(&run, object["id"].as_u64().expect("an id"), &out);
        assert!((found - volume).abs() < 1e-4, "{name}: {found}");
    }
    run.end();
}

#[test]
fn objects_are_listed_elsewhere_grouped_mirrored_and_sets_named_and_a_session_keeps_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let (session, file) = (dir.path().join("s.sculpt"), dir.path().join("ring.obj"));
    let ring = unwrapped_ring();
    write_mesh(&file, &ring).expect("written");
    let run = Running::begin(std::slice::from_ref(&file), &session);
    let (a, b) = (add_box(&run, 2.0, 10.0), add_box(&run, 1.0, 20.0));
    run.ask("scene.move", json!({ "id": b, "to": 0 }));
    let order = |run: &Running| -> Vec<u64> {
        run.objects().iter().map(|o| o["id"].as_u64().expect("an id")).collect()
    };
    assert_eq!(order(&run), [b, 0, a]);
    assert_eq!(run.ask("scene.list", json!({}))["active"], b);
    run.ask("scene.group", json!({ "ids": [a, b], "name": "legs" }));
    let groups: Vec<Value> = run.objects().iter().map(|o| o["group"].clone()).collect();
    assert_eq!(groups, [json!("legs"), Value::Null, json!("legs")]);
    run.ask("scene.group", json!({ "ids": [a] }));
    assert_eq!(run.objects()[2]["group"], Value::Null);
    assert!(run.refused("scene.group", json!({ "ids": [77] })).contains("no object 77"));

    // A twin across the plane x = 0 of an object that is turned: bounds, volume and polygons.
    let turn = [0.1, 0.7, -0.3, 0.2];
    let place = json!({ "shift": [5.0, 1.0, -2.0], "turn": turn, "scale": 2.0 });
    run.ask("scene.transform", json!({ "id": 0, "transform": place }));
    let twin = run.ask("scene.mirror", json!({ "id": 0, "axis": "x" }))["id"].clone();
    let objects = run.objects();
    let find = |id: &Value| objects.iter().find(|o| o["id"] == *id).expect("there");
    let (own, other) = (find(&json!(0)), find(&twin));
    assert_eq!(other["name"], format!("{} mirrored", own["name"].as_str().expect("a name")));
    for (end, opposite) in [(0, 1), (1, 0)] {
        let bound =
            |o: &Value, end: usize, axis: usize| o["bounds"][end][axis].as_f64().expect("a number");
        assert!((bound(own, end, 0) + bound(other, opposite, 0)).abs() < 1e-4);
        assert!((bound(own, end, 1) - bound(other, end, 1)).abs() < 1e-4);
        assert!((bound(own, end, 2) - bound(other, end, 2)).abs() < 1e-4);
    }
    let path = dir.path().join("twin.obj");
    run.ask("export", json!({ "path": path, "objects": { "object": twin } }));
    let read = read_mesh(&path, &Job::default()).expect("readable").mesh;
    assert_eq!(read.face_count(), ring.face_count());
    assert_eq!((&read.groups, read.has_materials()), (&ring.groups, true));
    let volume = |mesh: &PolyMesh| measures(&mesh.triangulate().0).volume;
    assert!((volume(&read) / volume(&ring) - 8.0).abs() < 1e-3);

    run.ask("scene.activate", json!({ "id": 0 }));
    run.ask("mask", json!({ "action": "invert" }));
    let set = run.ask("sets.make", json!({ "from": "mask" }))["set"].clone();
    run.ask("sets.rename", json!({ "set": set, "name": "inner side" }));
    let named = |run: &Running| {
        run.objects();
        let list = run.ask("sets.list", json!({}))["sets"].as_array().expect("a list").clone();
        list.iter().find(|s| s["set"] == set).expect("the new one")["name"].clone()
    };
    assert_eq!(named(&run), "inner side");
    assert!(run.refused("sets.rename", json!({ "set": 0, "name": "x" })).contains("set"));
    run.ask("undo", json!({}));
    assert_eq!(named(&run), Value::Null);
    run.ask("redo", json!({}));
    let (listed, hash) = (run.objects(), run.end());
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(1), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let run = Running::begin(&[], &session);
    assert_eq!((run.objects(), named(&run)), (listed, json!("inner side")));
    run.end();
}
