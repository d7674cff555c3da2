//! The scene by the control protocol of a running loop: objects, Booleans, files, replay.

mod arranged;
mod face_sets;
mod layers;
mod local_remesh;
mod wall_figures;

use std::path::Path;
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};

use crate::waiting::until;
use sculptd_clay::Workers;
use sculptd_daemon::config::{Config, LoopConfig};
use sculptd_daemon::control::Host;
use sculptd_daemon::control::handler::call;
use sculptd_daemon::control::stroke::VirtualPen;
use sculptd_daemon::live::Live;
use sculptd_daemon::session;
use sculptd_daemon::session::writer::WriterThread;
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Clock, queue};
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::measure::measures;
use sculptd_geometry::shapes;
use sculptd_geometry::{FaceAttributes, GroupName, PolyMesh};

/// A loop that runs, and its host.
struct Running {
    live: Live,
    host: Host,
    thread: Option<WriterThread>,
    _senders: queue::SenderFactory,
}

impl Running {
    fn begin(meshes: &[std::path::PathBuf], session: &Path) -> Running {
        let config = Config {
            r#loop: LoopConfig { workers: 1, ..Default::default() },
            ..Default::default()
        };
        let begun = startup::begin_with(meshes, Some(session), &config, &Job::default());
        let begun = begun.expect("begins");
        let (writer, thread) = begun.journal.unzip();
        let journal = writer.map(|w| Box::new(w) as Box<dyn Journal>);
        let (factory, receiver) = queue::channel(4096);
        let clock = Clock::monotonic();
        let pen = Arc::new(Mutex::new(VirtualPen::new(&factory, clock.clone())));
        let live = Live::start(begun.world, receiver, clock, config.r#loop, 4096, journal);
        let live = live.expect("runs");
        let presets = sculptd::presets().clone();
        let host = Host {
            pen: Some(pen),
            ..Host::new(live.commands.clone(), live.published.clone(), presets)
        };
        Running { live, host, thread, _senders: factory }
    }

    fn ask(&self, method: &str, params: Value) -> Value {
        call(&self.host, method, params).unwrap_or_else(|e| panic!("{method}: {}", e.message))
    }

    fn refused(&self, method: &str, params: Value) -> String {
        call(&self.host, method, params).expect_err(method).message
    }

    fn objects(&self) -> Vec<Value> {
        // The reply to a command comes before the state that shows it.
        let tick = self.live.published.load().tick;
        until("two ticks more", || self.live.published.load().tick >= tick + 2);
        self.ask("scene.list", json!({}))["objects"].as_array().expect("a list").clone()
    }

    /// Ends it; the hash of the world.
    fn end(self) -> u64 {
        let hash = self.live.stop().expect("ends").world.hash();
        assert_eq!(self.thread.and_then(WriterThread::finish), None);
        hash
    }
}

fn names(objects: &[Value]) -> Vec<&str> {
    objects.iter().map(|o| o["name"].as_str().expect("a name")).collect()
}

#[test]
fn objects_are_added_moved_combined_and_written_by_request() {
    let dir = tempfile::tempdir().expect("a folder");
    let (ball, session) = (dir.path().join("pig.ply"), dir.path().join("s.sculpt"));
    write_mesh(&ball, &shapes::icosphere(1.0, 24).to_poly()).expect("written");
    let run = Running::begin(std::slice::from_ref(&ball), &session);
    let plain = run.ask("hash", json!({}));
    assert_eq!(names(&run.objects()), ["object"]);

    let added = run.ask("scene.add", json!({ "primitive": { "box": [1, 1, 1] }, "edge": 0.1 }));
    let id = added["id"].as_u64().expect("an id");
    let objects = run.objects();
    assert_eq!(names(&objects), ["object", "box"]);
    assert_eq!((objects[1]["active"].clone(), objects[1]["id"].clone()), (json!(true), json!(id)));
    assert_eq!(objects[1]["primitive"], json!({ "box": [1.0, 1.0, 1.0] }));
    assert_eq!(objects[1]["bounds"], json!([[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]));
    run.ask("scene.reshape", json!({ "id": id, "primitive": { "box": [2, 1, 1] }, "edge": 0.1 }));
    let place = json!({ "shift": [1.0, 0.0, 0.0] });
    run.ask("scene.transform", json!({ "id": id, "transform": place }));
    run.ask("scene.rename", json!({ "id": id, "name": "slot" }));
    let slot = &run.objects()[1];
    assert_eq!(slot["bounds"], json!([[0.0, -0.5, -0.5], [2.0, 0.5, 0.5]]));
    assert_eq!(slot["name"], "slot");
    let file = run.ask("scene.add", json!({ "path": ball, "name": "twin" }));
    let twin = file["id"].as_u64().expect("an id");
    run.ask("scene.show", json!({ "id": twin, "visible": false }));

    // The ball without the box, the operands kept and hidden.
    let made = json!({ "operation": "difference", "a": 0, "b": id, "keep": true });
    let made = run.ask("scene.boolean", made);
    let objects = run.objects();
    assert_eq!(objects.len(), 4);
    assert_eq!(objects[3]["id"], made["id"]);
    let seen: Vec<&Value> = objects.iter().map(|o| &o["visible"]).collect();
    assert_eq!(seen, [false, false, false, true]);
    let path = dir.path().join("out.ply");
    run.ask("export", json!({ "path": path }));
    let read = |path: &Path| read_mesh(path, &Job::default()).expect("readable").mesh;
    let volume = |path: &Path| measures(&read(path).triangulate().0).volume;
    let whole = measures(&shapes::icosphere(1.0, 24)).volume;
    // The box covers x of 0 to 1 of the ball, and y and z of half a unit to either side.
    let cut = whole - volume(&path);
    assert!(cut > 0.75 && cut < 1.0, "{cut}");

    // Two operands that are gone in one step, and come back in one.
    run.ask("undo", json!({}));
    assert_eq!(names(&run.objects()), ["object", "slot", "twin"]);
    let made = run.ask("scene.merge", json!({ "ids": [0, twin] }));
    assert_eq!(run.objects().len(), 2);
    let split = run.ask("scene.split", json!({ "id": made["id"] }));
    assert_eq!(split["objects"], 2);
    assert_eq!(names(&run.objects()), ["slot", "object 1", "object 2"]);

    // glTF keeps the nodes, below one that turns millimetres into the format's metres.
    let glb = dir.path().join("scene.gltf");
    run.ask("export", json!({ "path": glb, "objects": "all" }));
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    let text = std::fs::read(&glb).expect("there");
    let json: Value = serde_json::from_slice(&text).expect("JSON");
    let nodes: Vec<&Value> = json["nodes"].as_array().expect("nodes").iter().collect();
    assert_eq!(nodes.len(), 4);
    assert_eq!(json["scenes"][0]["nodes"], json!([3]));
    assert_eq!(
        (&nodes[3]["scale"], &nodes[3]["children"]),
        (&json!([0.001, 0.001, 0.001]), &json!([0, 1, 2]))
    );
    assert_eq!(
        (&nodes[0]["name"], &nodes[0]["translation"]),
        (&json!("slot"), &json!([1.0, 0.0, 0.0]))
    );

    // Impossible requests return an error.
    let of = |id: u64| json!({ "id": id });
    run.ask("scene.lock", json!({ "id": id, "locked": true }));
    assert_eq!(run.refused("scene.remove", of(id)), format!("object {id} is locked"));
    assert_eq!(run.refused("scene.remove", of(77)), "there is no object 77");
    assert!(run.refused("scene.add", json!({})).contains("expected one of"));
    assert!(run.refused("scene.add", json!({ "primitive": { "ball": -1 } })).contains("lengths"));
    let wrong = json!({ "id": id, "transform": { "turn": [0, 0, 0, 0] } });
    assert!(run.refused("scene.transform", wrong).contains("rotation"));
    let same = json!({ "operation": "union", "a": id, "b": id });
    assert!(run.refused("scene.boolean", same).contains("two different"));

    // After undoing everything, the start has the same bits.
    let steps = run.live.published.load().undo_steps;
    for _ in 0..steps {
        run.ask("undo", json!({}));
    }
    assert_eq!(names(&run.objects()), ["object"]);
    assert_eq!(run.ask("hash", json!({}))["hash"], plain["hash"]);
    for _ in 0..steps {
        run.ask("redo", json!({}));
    }
    assert_eq!(names(&run.objects()), ["slot", "object 1", "object 2"]);
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let quick = session::reopen(&session, &opened, None, 1, &Job::default()).expect("a checkpoint");
    assert_eq!(quick.replayed.world.hash(), hash);
}

#[test]
fn what_the_hands_hold_becomes_an_object_where_they_hold_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let (ball, session) = (dir.path().join("ball.ply"), dir.path().join("s.sculpt"));
    write_mesh(&ball, &shapes::icosphere(1.0, 12).to_poly()).expect("written");
    let run = Running::begin(std::slice::from_ref(&ball), &session);
    assert!(run.refused("scene.add", json!({ "held": true })).contains("nothing is in the hands"));
    run.ask("take-up", json!({ "path": ball }));
    run.objects();
    let held = run.live.published.load().thing.clone().expect("held");
    let (lo, hi) = held.placed().bounds();
    run.ask("scene.add", json!({ "held": true, "name": "snout" }));
    let objects = run.objects();
    assert_eq!(names(&objects), ["object", "snout"]);
    assert!(run.live.published.load().thing.is_none());
    for (corner, want) in [lo, hi].iter().enumerate() {
        for axis in 0..3 {
            let found = objects[1]["bounds"][corner][axis].as_f64().expect("a number");
            // The box of the placed ball lies within that of its turned box.
            let off = (found - f64::from(want[axis])) * if corner == 0 { -1.0 } else { 1.0 };
            assert!((-1e-5..0.3).contains(&off), "{found} {want}");
        }
    }
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(1), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}

#[test]
fn several_files_stand_in_their_true_size_and_place() {
    let dir = tempfile::tempdir().expect("a folder");
    let (pot, lid) = (dir.path().join("pot.ply"), dir.path().join("lid.ply"));
    let solid = |lo: f64, hi: f64| {
        shapes::cuboid(glam::DVec3::new(-20.0, lo, -20.0), glam::DVec3::new(20.0, hi, 20.0))
    };
    write_mesh(&pot, &solid(0.0, 30.0)).expect("written");
    write_mesh(&lid, &solid(30.0, 35.0)).expect("written");
    let session = dir.path().join("s.sculpt");
    let run = Running::begin(&[pot, lid], &session);
    let objects = run.objects();
    assert_eq!(names(&objects), ["pot", "lid"]);
    assert_eq!(objects[0]["bounds"], json!([[-20.0, 0.0, -20.0], [20.0, 30.0, 20.0]]));
    assert_eq!(objects[1]["bounds"], json!([[-20.0, 30.0, -20.0], [20.0, 35.0, 20.0]]));
    assert_eq!(objects[0]["active"], true);
    // They touch in a square: their union is one box.
    let made = json!({ "operation": "union", "a": objects[0]["id"], "b": objects[1]["id"] });
    run.ask("scene.boolean", made);
    let path = dir.path().join("both.stl");
    run.objects();
    run.ask("export", json!({ "path": path }));
    let mesh = read_mesh(&path, &Job::default()).expect("readable").mesh;
    let (volume, want) = (measures(&mesh.triangulate().0).volume, 40.0 * 40.0 * 35.0);
    assert!((volume - want).abs() < 1e-3 * want, "{volume}");
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(1), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}

#[test]
fn an_object_is_placed_flush_by_request_and_joined_without_a_gap() {
    let dir = tempfile::tempdir().expect("a folder");
    let (pot, session) = (dir.path().join("pot.ply"), dir.path().join("s.sculpt"));
    let solid = shapes::cuboid(glam::DVec3::new(-20.0, 0.0, -20.0), glam::DVec3::splat(20.0));
    write_mesh(&pot, &solid).expect("written");
    let run = Running::begin(std::slice::from_ref(&pot), &session);
    let added = run.ask("scene.add", json!({ "primitive": { "box": [8, 4, 6] }, "edge": 2.0 }));
    let lid = added["id"].clone();
    let turn = [0.1, 0.7, -0.3, 0.2];
    let place = json!({ "shift": [50.0, 33.0, -7.0], "turn": turn });
    run.ask("scene.transform", json!({ "id": lid, "transform": place }));
    let before = run.objects();
    // The lid's lower face, where it stands now, onto the top of the pot, middle on middle.
    let of = sculptd_engine::scene::ObjectTransform {
        shift: glam::DVec3::new(50.0, 33.0, -7.0),
        turn: glam::DQuat::from_array(turn).normalize(),
        scale: 1.0,
    };
    let face = of.apply(glam::DVec3::new(0.5, -2.0, 0.3)).to_array();
    let asked = json!({
        "id": lid, "at": face, "to": 0, "to_at": [3.0, 20.0, -4.0], "align": "centre"
    });
    let done = run.ask("scene.snap", asked);
    let areas: Vec<f64> = (0..2).map(|i| done["areas"][i].as_f64().expect("a number")).collect();
    assert!((areas[0] - 48.0).abs() < 1e-9 && (areas[1] - 1600.0).abs() < 1e-9, "{areas:?}");
    assert!(done["off"].as_f64().expect("a number") < 1e-9);
    let bounds = run.objects()[1]["bounds"].clone();
    assert!((bounds[0][1].as_f64().expect("a number") - 20.0).abs() < 1e-5, "{bounds}");
    let same = json!({ "id": lid, "at": [0, 0, 0], "to": lid, "to_at": [0, 0, 0] });
    assert!(run.refused("scene.snap", same).contains("two different"));
    let made = json!({ "operation": "union", "a": 0, "b": lid });
    run.ask("scene.boolean", made);
    run.objects();
    let path = dir.path().join("both.ply");
    run.ask("export", json!({ "path": path }));
    let mesh = read_mesh(&path, &Job::default()).expect("readable").mesh;
    let (volume, want) = (measures(&mesh.triangulate().0).volume, 40.0 * 20.0 * 40.0 + 192.0);
    assert!((volume - want).abs() < 1e-3, "{volume} of {want}");
    run.ask("undo", json!({}));
    run.ask("undo", json!({}));
    assert_eq!(run.objects(), before);
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(1), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
}

/// A ring of quads with texture coordinates that have a seam, groups and materials.
fn unwrapped_ring() -> PolyMesh {
    let (round, tube) = (48u32, 24u32);
    let mut quads = shapes::torus(3.0, 1.0, round, tube);
    quads.positions.iter_mut().for_each(|p| *p += glam::DVec3::splat(0.1));
    // A row and a column more of texture coordinates than of vertices: the seams.
    let at = |i: u32| [f64::from(i % (tube + 1)) / 24.0, f64::from(i / (tube + 1)) / 48.0];
    let uvs: Vec<[f64; 2]> = (0..(round + 1) * (tube + 1)).map(at).collect();
    let count = uvs.len() as u32;
    let uv_corners = (0..quads.corners.len() as u32).map(|c| (c * 7 + c / 4) % count).collect();
    let name = |object: &str, group: &str, material: &str| GroupName {
        object: object.into(),
        group: group.into(),
        material: material.into(),
    };
    let groups = vec![
        name("ring", "outer side", "brass"),
        name("ring", "outer side", "gold leaf"),
        name("ring", "inner", "gold leaf"),
    ];
    let group_of = (0..quads.face_count() as u32).map(|f| f / 400 % 3).collect();
    quads.groups = Some(group_of);
    let libraries = vec!["ring.mtl".into()];
    quads.attributes = Some(Arc::new(FaceAttributes { uvs, uv_corners, groups, libraries }));
    quads
}

#[test]
fn a_quad_file_leaves_as_it_came_after_strokes_and_after_the_session_is_reopened() {
    let dir = tempfile::tempdir().expect("a folder");
    let (file, session) = (dir.path().join("ring.obj"), dir.path().join("s.sculpt"));
    let quads = unwrapped_ring();
    write_mesh(&file, &quads).expect("written");
    let text = |path: &Path| sculptd_geometry::io::read_regular(path, 1 << 30).expect("there");
    let run = Running::begin(std::slice::from_ref(&file), &session);
    let same = dir.path().join("same.obj");
    assert_eq!(run.ask("export", json!({ "path": same }))["warnings"], json!([]));
    assert!(text(&same) == text(&file), "nothing was done");
    let before = run.live.published.load().mesh.to_tri();
    let points = [[0.3, 0.45, 0.8, 0.0], [0.5, 0.5, 0.9, 200.0], [0.7, 0.55, 0.8, 400.0]];
    run.ask("stroke", json!({ "points": points, "space": "view" }));
    run.objects();
    let after = run.live.published.load().mesh.to_tri();
    assert_ne!(before.positions, after.positions);
    // A file loaded while the session runs has separate faces.
    let (second, lid) = (shapes::torus(2.0, 0.5, 30, 12), dir.path().join("lid.obj"));
    write_mesh(&lid, &second).expect("written");
    let lid = run.ask("scene.add", json!({ "path": lid }))["id"].clone();
    let read = |path: &Path| read_mesh(path, &Job::default()).expect("readable").mesh;
    let check = |run: &Running, name: &str| {
        let path = dir.path().join(name);
        run.ask("export", json!({ "path": path, "objects": { "object": 0 } }));
        let now = read(&path);
        assert_eq!((&now.corners, &now.face_starts), (&quads.corners, &quads.face_starts));
        assert_eq!((&now.groups, &now.attributes), (&quads.groups, &quads.attributes));
        let places = now.positions.iter().zip(&after.positions);
        assert!(places.clone().all(|(a, b)| a.as_vec3() == *b), "{name}");
        let exact = now.positions.iter().zip(&quads.positions).filter(|(a, b)| a == b).count();
        assert!(exact > 600 && exact < now.positions.len(), "{exact}");
        let path = dir.path().join(format!("lid-{name}"));
        run.ask("export", json!({ "path": path, "objects": { "object": lid } }));
        assert_eq!(read(&path), second);
    };
    check(&run, "strokes.obj");
    // Both in one file: their names, their own groups, and every face of both.
    let both = dir.path().join("both.obj");
    run.ask("export", json!({ "path": both, "objects": "all" }));
    let all = read(&both);
    assert_eq!(all.face_count(), quads.face_count() + second.face_count());
    let names = &all.attributes.as_ref().expect("names").groups;
    let objects: Vec<&str> = names.iter().map(|g| g.object.as_str()).collect();
    assert_eq!(objects, ["object", "object", "object", "lid"]);
    assert_eq!((names[2].group.as_str(), names[2].material.as_str()), ("inner", "gold leaf"));
    let (uvs, corners) = all.uvs().expect("texture coordinates");
    let (own, theirs) = quads.uvs().expect("texture coordinates");
    assert_eq!((uvs, &corners[..theirs.len()]), (own, theirs));
    // Properties that a format does not support are reported.
    let stl = run.ask("export", json!({ "path": dir.path().join("all.stl") }))["warnings"].clone();
    let said = stl.to_string();
    for lost in ["groups", "materials", "texture", "polygons", "one mesh"] {
        assert!(said.contains(lost), "{lost}: {said}");
    }
    run.end();
    let run = Running::begin(&[], &session);
    check(&run, "reopened.obj");
    run.end();
    // Another process, which never saw the file.
    for from in [&["--from-checkpoint"][..], &[]] {
        let path = dir.path().join("replayed.obj");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sculptd"));
        command.arg("replay").arg(&session).args(from).arg("--export").arg(&path);
        assert!(command.output().expect("runs").status.success());
        assert!(text(&path) == text(&both), "{from:?}");
    }
}
