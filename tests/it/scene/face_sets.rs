//! Face sets by the control protocol of a running loop, in files and in sessions.

use super::*;

impl Running {
    /// The face sets, once the state that shows the last command is published.
    fn sets(&self) -> Value {
        self.objects();
        self.ask("sets.list", json!({}))
    }

    fn set_numbers(&self) -> Vec<u64> {
        let sets = self.sets()["sets"].as_array().expect("a list").clone();
        sets.iter().map(|s| s["set"].as_u64().expect("a number")).collect()
    }

    pub(super) fn bits(&self) -> Value {
        self.objects();
        self.ask("hash", json!({}))["hash"].clone()
    }
}

#[test]
fn face_sets_are_made_hidden_extracted_by_request_and_come_back_from_a_session() {
    let dir = tempfile::tempdir().expect("a folder");
    let session = dir.path().join("s.sculpt");
    let run = Running::begin(&[], &session);
    let start = run.bits();
    let steps = || run.live.published.load().undo_steps;
    let vertices = run.sets()["sets"][0]["vertices"].as_u64().expect("all are in none");
    assert_eq!(run.set_numbers(), [0]);
    assert!(run.refused("sets.make", json!({ "from": "mask" })).contains("nothing is masked"));
    assert!(run.refused("sets.hide", json!({ "set": 3 })).contains("no face set 3"));
    assert!(run.refused("sets.hide", json!({})).contains("expected one of"));
    assert!(run.refused("sets.extract", json!({ "thickness": 0.1 })).contains("no triangle"));

    // The left half of the view is masked, all the way through.
    run.ask("mask-region", json!({ "region": { "box": [0, 0, 0.5, 1] }, "front_faces": false }));
    assert_eq!(run.ask("sets.make", json!({ "from": "mask" })), json!({ "set": 1, "made": 1 }));
    let listed = run.sets();
    let half = listed["sets"][1]["vertices"].as_u64().expect("some");
    assert!(half > vertices / 3 && half < vertices * 2 / 3, "{listed}");
    let before = steps();
    assert_eq!(run.ask("sets.hide", json!({ "at": [0.45, 0.5] }))["set"], 1);
    assert_eq!(run.sets()["hidden"], half);
    run.ask("sets.invert", json!({}));
    assert_eq!(run.sets()["hidden"], vertices - half);
    run.ask("sets.isolate", json!({ "set": 0 }));
    run.ask("sets.show", json!({}));
    assert_eq!((&run.sets()["hidden"], steps()), (&json!(0), before + 4));

    // Hidden parts are still exported to the file.
    run.ask("sets.hide", json!({ "masked": true }));
    let out = dir.path().join("out.obj");
    let written = run.ask("export", json!({ "path": out, "objects": "active" }));
    assert_eq!(written["vertices"], vertices);

    // A shell of the other half, as a separate object; one step.
    let before = steps();
    let made = run.ask("sets.extract", json!({ "thickness": 0.2, "set": 0, "name": "half" }));
    let shell = run.objects().iter().find(|o| o["id"] == made["id"]).expect("there").clone();
    assert_eq!((&shell["name"], &shell["active"]), (&json!("half"), &json!(true)));
    assert!(shell["vertices"].as_u64() > Some(vertices / 2));
    assert_eq!(steps(), before + 1);
    let parts = run.ask("sets.make", json!({ "from": "crease", "degrees": 50 }));
    assert!(parts["made"].as_u64() >= Some(2), "{parts}");
    assert!(run.refused("sets.make", json!({ "from": "crease", "degrees": 200 })).contains("180"));
    let walls = run.ask("sets.make", json!({ "from": "walls", "levels": 2 }));
    assert!(walls["made"].as_u64() >= Some(1), "{walls}");
    assert!(run.refused("sets.make", json!({ "from": "walls", "levels": 17 })).contains("16"));

    // Another level has other vertices: the sets are dropped, and that is said.
    run.ask("scene.activate", json!({ "id": 0 }));
    assert_eq!(run.set_numbers(), [0, 1]);
    assert_eq!(run.ask("level", json!({ "to": "up" }))["sets_dropped"], 1);
    assert_eq!(run.set_numbers(), [0]);
    run.ask("undo", json!({}));
    assert_eq!(run.sets()["hidden"], half);

    let all = steps();
    for _ in 0..all {
        run.ask("undo", json!({}));
    }
    assert_eq!(run.bits(), start, "undo of everything");
    for _ in 0..all {
        run.ask("redo", json!({}));
    }
    assert_eq!((run.set_numbers(), &run.sets()["hidden"]), (vec![0, 1], &json!(half)));
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let quick = session::reopen(&session, &opened, None, 1, &Job::default()).expect("a checkpoint");
    let mut world = quick.replayed.world;
    assert_eq!((world.hash(), world.verify_invariants()), (hash, Ok(())));
    assert_eq!(world.snapshot().face_sets(), [(0, vertices - half, 0), (1, half, half)]);
}

#[test]
fn face_sets_are_drawn_by_strokes_and_made_of_regions_by_request_and_replayed() {
    let dir = tempfile::tempdir().expect("a folder");
    let session = dir.path().join("s.sculpt");
    let run = Running::begin(&[], &session);
    let start = run.bits();
    let vertices = run.sets()["sets"][0]["vertices"].as_u64().expect("all are in none");
    let steps = || run.live.published.load().undo_steps;
    let stroke = |brush: Value| {
        let before = steps();
        let at = |i: u32| json!([0.45 + 0.01 * f64::from(i), 0.5, 1.0, 8 * i]);
        let points: Vec<Value> = (0..10).map(at).collect();
        run.ask("stroke", json!({ "points": points, "space": "view", "brush": brush }));
        until("the stroke is a step", || steps() == before + 1);
    };
    stroke(json!({ "kind": "draw-face-sets" }));
    assert_eq!(run.set_numbers(), [0, 1]);
    stroke(json!({ "kind": "draw-face-sets", "radius": 0.05 }));
    assert_eq!(run.set_numbers(), [0, 1, 2]);
    stroke(json!({ "kind": "draw-face-sets", "extra": [9, 0, 0, 0] }));
    assert_eq!(run.set_numbers().last(), Some(&9));
    let lasso = json!({ "polygon": [[0.4, 0.4], [0.6, 0.4], [0.5, 0.7]] });
    let made = run.ask("sets.region", json!({ "region": lasso, "action": "make" }));
    assert_eq!(made, json!({ "set": 10, "made": 1 }));
    let front =
        json!({ "region": { "box": [0, 0, 0.5, 1] }, "action": "hide", "front_faces": true });
    assert_eq!(run.ask("sets.region", front), json!({ "set": null, "made": 0 }));
    let half = run.sets()["hidden"].as_u64().expect("a number");
    assert!(half > vertices / 8 && half < vertices * 3 / 8, "{half} of {vertices}");
    run.ask("sets.region", json!({ "region": { "line": [0.5, 1, 0.5, 0] }, "action": "isolate" }));
    assert!(run.sets()["hidden"].as_u64() > Some(vertices / 2));
    let none = json!({ "region": { "line": [0.5, 0, 0.5, 0] }, "action": "hide" });
    assert!(run.refused("sets.region", none).contains("a line of two places"));
    let all = steps();
    for _ in 0..all {
        run.ask("undo", json!({}));
    }
    assert_eq!(run.bits(), start, "undo of everything");
    for _ in 0..all {
        run.ask("redo", json!({}));
    }
    run.objects();
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let quick = session::reopen(&session, &opened, None, 1, &Job::default()).expect("a checkpoint");
    assert_eq!(quick.replayed.world.hash(), hash);
}

#[test]
fn requests_wait_in_their_order_while_an_edit_takes_several_ticks() {
    let dir = tempfile::tempdir().expect("a folder");
    let (ball, session) = (dir.path().join("ball.ply"), dir.path().join("s.sculpt"));
    write_mesh(&ball, &shapes::icosphere(1.0, 150).to_poly()).expect("written");
    let run = Running::begin(std::slice::from_ref(&ball), &session);
    let start = run.bits();
    let tick = || run.live.published.load().tick;
    let vertices = run.sets()["sets"][0]["vertices"].as_u64().expect("all are in none");

    // The mask has nothing to tell: its request is answered before the last page has followed, and
    // what is asked next sees all of it.
    let before = tick();
    run.ask("mask", json!({ "action": "fill" }));
    let left = json!({ "region": { "box": [0, 0, 0.5, 1] }, "mask": 0, "front_faces": false });
    run.ask("mask-region", left);
    assert_eq!(run.ask("sets.make", json!({ "from": "mask" })), json!({ "set": 1, "made": 1 }));
    assert!(tick() >= before + 6, "three edits of three ticks at least");
    let right = run.sets()["sets"][1]["vertices"].as_u64().expect("some");
    assert!(right > vertices / 3 && right < vertices * 2 / 3, "{right} of {vertices}");

    // An undo during an edit undoes the whole edit; the next commands continue from there.
    run.ask("mask", json!({ "action": "invert" }));
    run.ask("undo", json!({}));
    run.ask("sets.hide", json!({ "masked": true }));
    assert_eq!(run.sets()["hidden"], right, "the mask was not inverted");
    assert!(run.refused("sets.hide", json!({ "set": 7 })).contains("no face set 7"));
    run.ask("sets.show", json!({}));
    run.ask("mask", json!({ "action": "clear" }));

    // A stroke that is drawn meanwhile is drawn afterwards, whole.
    let points: Vec<Value> =
        (0..10).map(|i| json!([0.45 + 0.01 * f64::from(i), 0.5, 1.0, 8 * i])).collect();
    run.ask("stroke", json!({ "points": points, "space": "view", "brush": { "kind": "draw" } }));
    until("six edits and a stroke", || run.live.published.load().undo_steps == 7);
    let end = run.bits();
    for _ in 0..7 {
        run.ask("undo", json!({}));
    }
    assert_eq!(run.bits(), start, "undo of everything");
    for _ in 0..7 {
        run.ask("redo", json!({}));
    }
    assert_eq!(run.bits(), end);
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(2), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}

#[test]
fn what_is_thin_or_sheltered_is_masked_by_request_taken_back_and_replayed() {
    let dir = tempfile::tempdir().expect("a folder");
    let (lens, session) = (dir.path().join("lens.ply"), dir.path().join("s.sculpt"));
    let mut mesh = shapes::icosphere(10.0, 40);
    mesh.positions.iter_mut().for_each(|p| p.z *= 0.2);
    write_mesh(&lens, &mesh.to_poly()).expect("written");
    let run = Running::begin(std::slice::from_ref(&lens), &session);
    let (start, before) = (run.bits(), run.live.published.load().undo_steps);
    assert!(run.refused("mask-measured", json!({ "by": { "thin": 0 } })).contains("more than 0"));
    let dark = json!({ "by": { "occlusion": 0.5 } });
    assert!(run.refused("mask-measured", dark).contains("nothing of the object"));
    let masked = run.ask("mask-measured", json!({ "by": { "thin": 2.0 } }));
    let protected = masked["protected"].as_u64().expect("some");
    let all = mesh.positions.len() as u64;
    assert!(protected > all / 10 && protected < all * 2 / 3, "{protected} of {all}");
    // A set of what is masked has as many.
    run.ask("sets.make", json!({ "from": "mask" }));
    assert_eq!(run.sets()["sets"][1]["vertices"], protected);
    assert_eq!(run.live.published.load().undo_steps, before + 2);
    run.ask("undo", json!({}));
    run.ask("undo", json!({}));
    assert_eq!(run.bits(), start);
    run.ask("redo", json!({}));
    let id = run.objects()[0]["id"].clone();
    let thin = || run.refused("mask-measured", json!({ "by": { "thin": 2.0 } }));
    run.ask("scene.show", json!({ "id": id, "visible": false }));
    assert!(thin().contains("is hidden"));
    run.objects();
    let fill = || run.refused("mask", json!({ "action": "fill" }));
    let all = || run.refused("mask-region", json!({ "region": { "box": [0, 0, 1, 1] } }));
    assert!(fill().contains("is hidden") && all().contains("is hidden"));
    run.ask("scene.show", json!({ "id": id, "visible": true }));
    run.ask("scene.lock", json!({ "id": id, "locked": true }));
    assert!(thin().contains("locked"));
    run.objects();
    assert!(fill().contains("locked") && all().contains("locked"));
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}
