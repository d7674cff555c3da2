//! Layers by the control protocol of a running loop, in files and in sessions.

use glam::{DVec3, Vec3};
use sculptd_geometry::io::{
    MAX_FILE, MorphTarget, MorphedMesh, SceneMesh, read_in_millimetres, write_scene,
};

use super::*;

/// A ball with two morph targets, as a file.
fn morphed(path: &Path) -> MorphedMesh {
    let ball = shapes::icosphere(1.0, 40).to_poly();
    let count = ball.positions.len() as u32;
    let offsets = |every: usize, by: Vec3| (0..count).step_by(every).map(|v| (v, by)).collect();
    let target = |name: &str, weight, visible, offsets| MorphTarget {
        name: name.into(),
        weight,
        visible,
        offsets,
    };
    let morphed = MorphedMesh {
        base: ball.positions.clone(),
        targets: vec![
            target("wrinkles", 0.5, true, offsets(3, Vec3::new(0.25, 0.0, -0.125))),
            target("scar", 1.5, false, offsets(5, Vec3::Y * 0.5)),
        ],
    };
    let mesh = SceneMesh {
        name: "head".into(),
        mesh: ball,
        shift: DVec3::ZERO,
        turn: glam::DQuat::IDENTITY,
        scale: 1.0,
        morphed: Some(morphed.clone()),
    };
    write_scene(path, &[mesh], &Job::default()).expect("written");
    morphed
}

impl Running {
    /// The layers, once the state that shows the last command is published.
    fn layers(&self) -> Value {
        self.objects();
        self.ask("layers.list", json!({}))
    }

    fn hash(&self) -> Value {
        self.objects();
        self.ask("hash", json!({}))["hash"].clone()
    }
}

#[test]
fn layers_come_from_a_file_are_edited_by_request_and_leave_again() {
    let dir = tempfile::tempdir().expect("a folder");
    let (file, session) = (dir.path().join("head.glb"), dir.path().join("s.sculpt"));
    let wanted = morphed(&file);
    let run = Running::begin(&[], &session);
    let bare = run.hash();
    run.ask("scene.add", json!({ "path": file }));
    let listed = run.layers();
    assert_eq!(listed["active"], Value::Null);
    assert_eq!(
        listed["layers"],
        json!([
            { "id": 0, "name": "wrinkles", "intensity": 0.5, "visible": true },
            { "id": 1, "name": "scar", "intensity": 1.5, "visible": false },
        ])
    );
    let begun = run.hash();

    // The export equals the import.
    let out = dir.path().join("out.gltf");
    run.ask("export", json!({ "path": out, "objects": "active" }));
    let read = read_in_millimetres(&out, MAX_FILE, &Job::default()).expect("readable");
    assert_eq!(read.targets, wanted.targets);
    let near = |a: &DVec3, b: &DVec3| (*a - *b).length() < 1e-6;
    assert!(read.mesh.positions.iter().zip(&wanted.base).all(|(a, b)| near(a, b)));
    // A format without morph targets gets the surface as it is seen.
    let flat = dir.path().join("out.obj");
    run.ask("export", json!({ "path": flat, "objects": "active" }));
    let seen = read_mesh(&flat, &Job::default()).expect("readable").mesh.positions;
    let by = wanted.base[0] + DVec3::new(0.125, 0.0, -0.0625);
    assert!(near(&seen[0], &by), "{} {by}", seen[0]);

    // Off and on again is the same to the bit.
    let of = |layer: u64| json!({ "layer": layer });
    let set = |layer: u64, intensity: f64| json!({ "layer": layer, "intensity": intensity });
    run.ask("layers.set", json!({ "layer": 0, "visible": false }));
    assert_ne!(run.hash(), begun);
    run.ask("layers.set", json!({ "layer": 0, "visible": true }));
    assert_eq!(run.hash(), begun);
    let steps = || run.live.published.load().undo_steps;
    let before = steps();
    for k in 0..20 {
        let intensity = f64::from(k) / 10.0;
        run.ask("layers.set", json!({ "layer": 0, "intensity": intensity, "live": true }));
    }
    run.ask("layers.set", set(0, -2.0));
    assert_eq!(run.layers()["layers"][0]["intensity"], -2.0);
    assert_eq!(steps(), before + 1);

    let made = run.ask("layers.add", json!({ "name": "pores" }));
    assert_eq!(made, json!({ "layer": 2 }));
    assert_eq!(run.layers()["active"], 2);
    run.ask("layers.rename", json!({ "layer": 2, "name": "spots" }));
    run.ask("layers.move", json!({ "layer": 2, "to": 0 }));
    run.ask("layers.activate", of(1));
    let listed = run.layers();
    assert_eq!(listed["layers"][0]["name"], "spots");
    assert_eq!((&listed["active"], &listed["takes_strokes"]), (&json!(1), &json!(false)));
    assert!(run.refused("layers.merge", of(1)).contains("hidden"));
    assert!(run.refused("layers.remove", of(9)).contains("no layer 9"));
    assert!(run.refused("layers.set", set(1, 3.0)).contains("-2 to 2"));
    assert!(run.refused("layers.add", json!({ "name": " " })).contains("name"));
    run.ask("layers.set", json!({ "layer": 1, "visible": true }));
    let seen = run.hash();
    assert_eq!(run.ask("layers.merge", of(1)), json!({ "layer": 0 }));
    assert_eq!(run.ask("layers.duplicate", of(0)), json!({ "layer": 3 }));
    run.ask("layers.clear", of(3));
    run.ask("layers.remove", of(3));
    run.ask("layers.activate", json!({}));
    assert_ne!(run.hash(), seen);
    let level = run.ask("level", json!({ "to": "up" }));
    assert_eq!(level["layers_baked"], 2);
    assert_eq!(run.layers()["layers"], json!([]));
    assert!(run.refused("layers.bake", json!({})).contains("no layers"));
    run.ask("undo", json!({}));
    assert_eq!(run.layers()["layers"].as_array().map(Vec::len), Some(2));
    assert_eq!(run.ask("layers.bake", json!({})), json!({ "layer": null }));

    let newest = run.hash();
    let steps = steps();
    for _ in 0..steps {
        run.ask("undo", json!({}));
    }
    assert_eq!(run.hash(), bare);
    for _ in 0..steps - 1 {
        run.ask("redo", json!({}));
    }
    assert_eq!(run.layers()["layers"].as_array().map(Vec::len), Some(2));
    assert_ne!(run.hash(), newest);
    let hash = run.end();
    let opened = session::open(&session).expect("a session");
    let replayed = session::replay::replay(&opened, None, Workers::new(3), &Job::default());
    assert_eq!(replayed.expect("replays").world.hash(), hash);
    let quick = session::reopen(&session, &opened, None, 1, &Job::default()).expect("a checkpoint");
    let world = quick.replayed.world;
    assert_eq!((world.hash(), world.mesh().layer_count()), (hash, 2));
    assert_eq!(world.verify_invariants(), Ok(()));
}
