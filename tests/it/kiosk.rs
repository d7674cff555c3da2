//! Thirty visitors in a row: each finds what the first found.

use glam::Vec2;
use sculptd::command::{Beginning, Command, NewClay};
use sculptd::config::Resolved;
use sculptd::daemon::rig;
use sculptd::devices::{Body, DeviceId, Pen, Sample};
use sculptd::mesh::{Mesh, shapes};
use sculptd::stroke::Camera;
use std::sync::Arc;

/// One visit of strokes, brushes, views, undo and a thing in the hands, different for each visitor.
fn visit(world: &mut sculptd::world::World, visitor: u64, tick: &mut u64) {
    let mut brush = *world.brush();
    brush.radius = 0.1 + visitor as f32 * 0.005;
    let thing = Arc::new(shapes::sphere_of_about(500));
    let camera = Camera { yaw: visitor as f32, ..*world.camera() };
    *tick += 1;
    world.step(*tick, &[], &[Command::Brush(brush), Command::Camera(camera), Command::TakeUp(thing)]);
    for i in 0..60 {
        *tick += 1;
        let phase = i as f32 * 0.1 + visitor as f32;
        let pen = Pen {
            in_range: true,
            tip: i % 20 < 17 || visitor % 3 == 0,
            pos_mm: Vec2::new(112.0 + 35.0 * phase.sin(), 70.0 + 25.0 * phase.cos()),
            area_mm: Vec2::new(224.0, 140.0),
            pressure: Some(0.7),
            ..Pen::default()
        };
        let sample =
            Sample { device: DeviceId(0), t_us: *tick * 8333, device_t_us: None, body: Body::Pen(pen) };
        let commands = if i == 40 { vec![Command::Undo] } else { vec![] };
        world.step(*tick, &[sample], &commands);
    }
}

#[test]
fn after_thirty_visitors_nothing_of_them_is_left() {
    let config = Resolved::defaults().config;
    let plain = Arc::new(shapes::sphere_of_about(10_000));
    let mesh = Mesh::build(&plain, &Default::default()).expect("a ball");
    let mut world = rig::world(mesh, &config);
    let (hash, camera, brush) = (world.hash(), *world.camera(), *world.brush());
    let mut first = None;
    let mut tick = 0;
    for visitor in 0..30 {
        visit(&mut world, visitor, &mut tick);
        assert_ne!(world.hash(), hash, "visitor {visitor} did nothing");
        let built = Mesh::build(&plain, &Default::default()).expect("a ball");
        let clay = NewClay::new(plain.clone(), built, false);
        let begin = Beginning { clay, camera: config.camera.camera(), brush: config.brush };
        tick += 1;
        world.step(tick, &[], &[Command::Begin(Box::new(begin))]);
        while world.take_retired().is_some() {}
        assert_eq!(world.hash(), hash, "the clay after visitor {visitor}");
        assert_eq!((*world.camera(), *world.brush()), (camera, brush));
        assert_eq!((world.undo_steps(), world.redo_steps()), (0, 0));
        assert_eq!(world.pens().count() + usize::from(world.thing().is_some()), 0);
        assert!(world.hands().is_none());
        world.verify_invariants().expect("sound");
        let bytes = world.mesh().memory().at_rest() as f64;
        let before = *first.get_or_insert(bytes);
        assert!(
            (bytes - before).abs() <= before * 0.02,
            "{bytes} bytes after visitor {visitor}, {before} after the first"
        );
    }
}
