//! Thirty visitors in a row: each finds what the first found.

use glam::Vec2;
use sculptd_clay::{Clay, Workers};
use sculptd_daemon::config::{LoopConfig, Resolved};
use sculptd_daemon::kiosk::staff::StaffRequest;
use sculptd_daemon::kiosk::start::{Start, StartForm};
use sculptd_daemon::kiosk::unrecorded::WithoutFilms;
use sculptd_daemon::kiosk::visit_journal::{self, VisitStart};
use sculptd_daemon::kiosk::{KioskConfig, Stage, gallery, keeper};
use sculptd_daemon::live::{Live, LiveInput};
use sculptd_daemon::session;
use sculptd_daemon::session::format::Settings;
use sculptd_daemon::session::replay::replay;
use sculptd_daemon::startup;
use sculptd_daemon::tick::Journal;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample, queue};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Beginning, Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::shapes;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use crate::allocations::{live_bytes, passed_alone};
use crate::waiting::{pause, until};

/// One visit of strokes, brushes, views, undo and a thing in the hands, different for each visitor.
fn visit(world: &mut World, visitor: u64, tick: &mut u64) {
    let mut brush = *world.brush();
    brush.radius = 0.1 + visitor as f32 * 0.005;
    let thing = Arc::new(shapes::sphere_of_about(500));
    let camera = Camera { yaw: visitor as f32, ..*world.camera() };
    *tick += 1;
    world.step(
        *tick,
        &[],
        &[Command::Brush(brush), Command::Camera(camera), Command::TakeUp(thing)],
    );
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
        let sample = Sample {
            device: DeviceId(0),
            t_us: *tick * 8333,
            device_t_us: None,
            body: Body::Pen(pen),
        };
        let commands = if i == 40 { vec![Command::Undo] } else { vec![] };
        world.step(*tick, &[sample], &commands);
    }
}

/// Bytes on the heap once helpers have put down what they still held of a build.
fn settled_bytes() -> f64 {
    let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
    let look = |_| {
        let _ = quiet.recv_timeout(Duration::from_millis(5));
        live_bytes()
    };
    (0..20).map(look).min().unwrap_or(0) as f64
}

#[test]
fn after_thirty_visitors_nothing_of_them_is_left() {
    if passed_alone("kiosk::after_thirty_visitors_nothing_of_them_is_left") {
        return;
    }
    let config = Resolved::defaults(sculptd::presets()).config;
    let plain = Arc::new(shapes::sphere_of_about(10_000));
    let mesh = Clay::build(&plain, &Default::default()).expect("a ball");
    let mut world = startup::world(mesh, &config);
    let (hash, camera, brush) = (world.hash(), *world.camera(), *world.brush());
    let mut heap = Vec::with_capacity(30);
    let mut tick = 0;
    for visitor in 0..30 {
        visit(&mut world, visitor, &mut tick);
        assert_ne!(world.hash(), hash, "visitor {visitor} did nothing");
        let built = Clay::build(&plain, &Default::default()).expect("a ball");
        let clay = NewClay::new(plain.clone(), false);
        let begin = Beginning { clay, camera: config.camera.camera(), brush: config.brush };
        tick += 1;
        let mut begin = Command::Begin(Box::new(begin));
        world.deliver(&mut begin, Payload::Clay(Box::new(built)));
        world.step(tick, &[], &[begin]);
        assert_eq!(world.hash(), hash, "the clay after visitor {visitor}");
        assert_eq!((*world.camera(), *world.brush()), (camera, brush));
        assert_eq!((world.undo_steps(), world.redo_steps()), (0, 0));
        assert_eq!(world.pens().count() + usize::from(world.thing().is_some()), 0);
        assert!(world.hands().is_none());
        world.verify_invariants().expect("sound");
        heap.push(settled_bytes());
    }
    println!("heap after each visitor, bytes: {heap:?}");
    let first = heap[0];
    for (visitor, bytes) in heap.iter().enumerate() {
        let off = (bytes - first).abs() / first;
        assert!(off <= 0.02, "{bytes} bytes after visitor {visitor}, {first} after the first");
    }
}

/// A hundred films between two visits: the session has the visits alone, and replays to the last
/// one's bits, numbers of the clay included.
#[test]
fn a_session_leaves_out_the_films_between_visits() {
    let dir = tempfile::tempdir().expect("a folder");
    let config = Resolved::defaults(sculptd::presets()).config;
    let plain = shapes::sphere_of_about(5_000);
    let path = dir.path().join("kiosk.sculpt");
    let settings = Settings {
        rate_hz: 120,
        dab_budget: config.r#loop.dab_budget,
        undo_bytes: 1 << 30,
        camera: config.camera.camera(),
        brush: config.brush,
        hands: config.hand,
    };
    let (writer, thread) = session::create(&path, &plain, &settings).expect("created");
    let film = Arc::new(AtomicBool::new(false));
    let mut journal = WithoutFilms::new(writer, film.clone());
    let mesh = Clay::build(&plain, &Default::default()).expect("a ball");
    let options = WorldOptions {
        dab_budget: settings.dab_budget,
        undo_bytes: settings.undo_bytes,
        hands: settings.hands,
    };
    let workers = Workers::new(1);
    let mut world = World::new(mesh, settings.camera, settings.brush, workers, options);
    let plain = Arc::new(plain);
    let mut tick = 0;
    let mut run = |is_film: bool, strokes: u64| {
        film.store(is_film, Relaxed);
        let clay = NewClay::new(plain.clone(), false);
        let beginning = Beginning { clay, camera: settings.camera, brush: settings.brush };
        for i in 0..=strokes * 12 {
            tick += 1;
            let pen = Pen {
                in_range: true,
                tip: i % 12 < 10,
                pos_mm: Vec2::new(45.0 + (i % 37) as f32 * 0.2, 50.0),
                area_mm: Vec2::splat(100.0),
                pressure: Some(0.6),
                ..Pen::default()
            };
            let (t_us, body) = (tick * 8333, Body::Pen(pen));
            let sample = Sample { device: DeviceId(0), t_us, device_t_us: None, body };
            let (begin, given) = ([Command::Begin(Box::new(beginning.clone()))], [sample]);
            let (samples, commands) = match i {
                0 => (&[][..], &begin[..]),
                _ => (&given[..], &[][..]),
            };
            world.step(tick, samples, commands);
            journal.tick(tick, samples, commands, &mut world);
        }
        (world.hash(), world.mesh().object_id())
    };
    (0..50).for_each(|_| _ = run(true, 1));
    run(false, 2);
    (0..50).for_each(|_| _ = run(true, 1));
    let live = run(false, 3);
    run(true, 1);
    drop(journal);
    assert_eq!(thread.finish(), None);
    let opened = session::open(&path).expect("opens");
    let samples: usize = opened.input.iter().map(|t| t.samples.len()).sum();
    assert_eq!(samples, 5 * 12, "the visits' alone");
    let size = path.metadata().expect("a file").len();
    assert!(size < 1 << 20, "{size} bytes for two visits");
    let replayed = replay(&opened, None, Workers::new(2), &Default::default()).expect("replays");
    assert_eq!((replayed.world.hash(), replayed.world.mesh().object_id()), live);
}

#[test]
fn a_visit_from_the_attract_loop_to_the_gallery_and_staff_lets_out() {
    let dir = tempfile::tempdir().expect("a folder");
    let config = Resolved::defaults(sculptd::presets()).config;
    let plain = Arc::new(shapes::sphere_of_about(5_000));
    let mesh = Clay::build(&plain, &Default::default()).expect("a ball");
    let world = startup::world(mesh, &config);
    let clean = world.hash();
    let camera = config.camera.camera();
    let start = Start::free(plain, camera, config.brush);
    let clock = Clock::monotonic();
    let (factory, receiver) = queue::channel(4096);
    let input =
        LiveInput { drain_per_tick: 1024, door: Some(start.door.clone()), ..LiveInput::default() };
    let live = Live::start_with(world, receiver, clock.clone(), LoopConfig::default(), input, None)
        .expect("a loop");
    let kiosk = KioskConfig {
        // Longer than the busiest machine needs to reset the clay.
        idle_s: 5.0,
        countdown_s: 1.0,
        gallery: dir.path().join("works"),
        audit: dir.path().join("audit.jsonl"),
        staff_pin: "4711".into(),
        share: "127.0.0.1:0".into(),
        // Two seconds.
        share_minutes: 2.0 / 60.0,
        ..KioskConfig::default()
    };
    let words = kiosk.words(sculptd::settings::LANGUAGES).expect("English");
    let stop = Arc::new(AtomicBool::new(false));
    let (published, commands) = (live.published.clone(), live.commands.clone());
    let keeper = keeper::start(
        (kiosk, std::slice::from_ref(&words)),
        start,
        published,
        commands,
        &factory,
        clock.clone(),
        stop.clone(),
    )
    .expect("keeps");
    let stage = || keeper.desk.view.lock().expect("a view").map(|v| v.stage);
    let shown = || live.published.load_full();
    until("the film sculpts", || shown().figures.dabs > 20 && shown().mesh.hash() != clean);
    assert_eq!(stage(), Some(Stage::Attract));
    // A visitor's pen: the film stops, the clay is clean, then it is the visitor's.
    let mut sender = factory.sender();
    let mut touch = |x: f32, tip: bool, in_range: bool| {
        let pen = Pen {
            in_range,
            tip,
            pos_mm: Vec2::new(x, 50.0),
            area_mm: Vec2::splat(100.0),
            pressure: Some(0.5),
            ..Pen::default()
        };
        let t_us = clock.now_us();
        sender.push(Sample { device: DeviceId(0), t_us, device_t_us: None, body: Body::Pen(pen) });
        sender.flush();
    };
    // One that only passes by in the air is nobody yet.
    touch(10.0, false, true);
    touch(12.0, false, true);
    until("the pen is seen", || shown().pens.iter().flatten().any(|(id, _)| *id == DeviceId(0)));
    let seen = shown().figures.dabs;
    until("the film goes on", || shown().figures.dabs > seen + 10);
    assert_eq!(stage(), Some(Stage::Attract));
    touch(10.0, true, true);
    until("a visit begins", || stage() == Some(Stage::Working));
    until("the film's work is gone", || shown().mesh.hash() == clean);
    let before = shown().figures.dabs;
    for i in 0..40 {
        touch(40.0 + i as f32 * 0.5, true, true);
        until("the loop goes on", || shown().figures.newest_us > 0);
    }
    until("the visitor sculpts", || shown().figures.dabs > before && shown().mesh.hash() != clean);
    touch(60.0, false, false);
    assert!(!keeper.desk.asks_consent.load(Relaxed));
    until("a countdown", || stage() == Some(Stage::Countdown));
    until("the visit ends", || {
        keeper.desk.view.lock().expect("a view").is_some_and(|v| v.visits == 1)
    });
    let audit = std::fs::read_to_string(dir.path().join("audit.jsonl")).expect("a line");
    let works = gallery::works(&dir.path().join("works")).unwrap_or_default();
    assert_eq!(works, ["work-000001.glb"], "{audit}");
    assert!(audit.contains("\"visit\":1") && audit.contains("\"kept\":true"), "{audit}");
    until("the film plays again", || stage() == Some(Stage::Attract));
    // A visitor who ends the visit is asked, and gets the code.
    until("the next film sculpts", || shown().figures.dabs > 20 && shown().mesh.hash() != clean);
    touch(10.0, true, true);
    until("a visit begins", || stage() == Some(Stage::Working));
    until("the film's work is gone", || shown().mesh.hash() == clean);
    for i in 0..40 {
        touch(40.0 + i as f32 * 0.5, true, true);
    }
    until("the visitor sculpts", || shown().mesh.hash() != clean);
    touch(60.0, false, false);
    keeper.desk.finished.store(true, Relaxed);
    until("the farewell", || stage() == Some(Stage::Farewell));
    until("the question", || keeper.desk.asks_consent.load(Relaxed));
    let audit = std::fs::read_to_string(dir.path().join("audit.jsonl")).expect("lines");
    assert_eq!(gallery::works(&dir.path().join("works")).expect("listed").len(), 2, "{audit}");
    #[cfg(unix)]
    {
        let link = || keeper.desk.link.lock().expect("a desk").clone();
        assert!(link().is_none(), "nobody consented yet");
        keeper.desk.consents.store(true, Relaxed);
        until("the code is on the screen", || link().is_some());
        let shown = link().expect("a link");
        assert!(shown.url.starts_with("http://127.0.0.1:") && shown.until_us > clock.now_us());
        until("a code that leads nowhere any more is gone", || link().is_none());
        assert!(clock.now_us() >= shown.until_us);
    }
    keeper.desk.finished.store(true, Relaxed);
    until("the film plays again", || stage() == Some(Stage::Attract));
    until("works of the day turn on the wall", || {
        keeper.desk.view.lock().expect("a view").is_some_and(|v| v.work.is_some())
    });
    let (work, yaw) = (shown().mesh.hash(), shown().camera.yaw);
    until("it turns", || shown().camera.yaw != yaw);
    assert_ne!(work, clean);
    touch(10.0, true, true);
    until("a visit begins on the wall", || stage() == Some(Stage::Working));
    until("nothing of the wall is left", || shown().mesh.hash() == clean);
    touch(60.0, false, false);
    let staff = || keeper.desk.view.lock().expect("a view").is_some_and(|v| v.staff);
    keeper.desk.ask(StaffRequest::End);
    pause(300);
    assert!(!stop.load(Relaxed), "nobody typed the PIN");
    *keeper.desk.typed.lock().expect("a desk") = Some("4711".into());
    until("the staff page opens", staff);
    let facts = || keeper.desk.staff.lock().expect("a desk").clone();
    until("it shows figures", || facts().free_bytes.is_some());
    // They agree with the audit file and the gallery.
    let lines = std::fs::read_to_string(dir.path().join("audit.jsonl")).expect("lines");
    let works = gallery::works(&dir.path().join("works")).expect("listed").len() as u64;
    let (all, shown) = (lines.lines().count() as u64, facts());
    let found = (shown.visits_today, shown.visits, shown.kept_today);
    assert_eq!(found, (all, all, works), "{shown:?}");
    keeper.desk.ask(StaffRequest::End);
    until("staff is let out", || stop.load(Relaxed));
    assert!(!keeper.desk.again.load(Relaxed));
    keeper.thread.join().expect("the keeper ends");
    live.stop().expect("ends").world.verify_invariants().expect("sound");
}

/// A stroke that is over before the keeper has seen it: the reset that begins the visit comes after
/// the whole stroke.
#[test]
fn the_first_stroke_is_whole_however_short_it_is() {
    let config = Resolved::defaults(sculptd::presets()).config;
    let plain = Arc::new(shapes::sphere_of_about(5_000));
    let mesh = Clay::build(&plain, &Default::default()).expect("a ball");
    let world = startup::world(mesh, &config);
    let clean = world.hash();
    let start = Start::free(plain, config.camera.camera(), config.brush);
    let clock = Clock::monotonic();
    let (factory, receiver) = queue::channel(4096);
    let door = Some(start.door.clone());
    let input = LiveInput { drain_per_tick: 1024, door, ..LiveInput::default() };
    let live = Live::start_with(world, receiver, clock.clone(), LoopConfig::default(), input, None)
        .expect("a loop");
    let kiosk = KioskConfig { idle_s: 3600.0, ..KioskConfig::default() };
    let words = kiosk.words(sculptd::settings::LANGUAGES).expect("English");
    let stop = Arc::new(AtomicBool::new(false));
    let given = (live.published.clone(), live.commands.clone());
    let keeper = keeper::start(
        (kiosk, std::slice::from_ref(&words)),
        start,
        given.0,
        given.1,
        &factory,
        clock.clone(),
        stop.clone(),
    )
    .expect("keeps");
    let stage = || keeper.desk.view.lock().expect("a view").map(|v| v.stage);
    let shown = || live.published.load_full();
    let mut sender = factory.sender();
    let mut made = Vec::new();
    for round in 0..4 {
        until("the film sculpts", || shown().figures.dabs > 20 && shown().mesh.hash() != clean);
        assert_eq!(stage(), Some(Stage::Attract));
        let t_us = clock.now_us();
        for i in 0..20_u64 {
            let pen = Pen {
                in_range: i < 19,
                tip: (1..18).contains(&i),
                pos_mm: Vec2::new(40.0 + i as f32, 50.0),
                area_mm: Vec2::splat(100.0),
                pressure: Some(0.5),
                ..Pen::default()
            };
            let (device, body) = (DeviceId(0), Body::Pen(pen));
            let t_us = t_us.saturating_sub((20 - i) * 5_000);
            sender.push(Sample { device, t_us, device_t_us: None, body });
        }
        sender.flush();
        until("a visit begins", || stage() == Some(Stage::Working));
        until("its stroke is there", || shown().undo_steps == 1);
        until("the stroke is over", || {
            let before = shown().mesh.hash();
            pause(100);
            shown().mesh.hash() == before
        });
        made.push(shown().mesh.hash());
        assert_ne!(made[0], clean);
        assert_eq!(made[round], made[0], "round {round}: the whole stroke, on clean clay");
        keeper.desk.finished.store(true, Relaxed);
        until("the visit is over", || stage() == Some(Stage::Attract));
    }
    stop.store(true, Relaxed);
    keeper.thread.join().expect("the keeper ends");
    live.stop().expect("ends").world.verify_invariants().expect("sound");
}

/// A pen presses an exhibit: its touch begins a visit with the form that is shown, the window's
/// press comes later. The visit goes on with the chosen one, and its file too.
#[test]
fn a_choice_that_comes_after_the_touch_is_the_visit_s() {
    let dir = tempfile::tempdir().expect("a folder");
    let config = Resolved::defaults(sculptd::presets()).config;
    let plains = [5_000, 8_000].map(|n| Arc::new(shapes::sphere_of_about(n)));
    let clay = |plain| Clay::build(plain, &Default::default()).expect("a ball");
    let hashes = [0, 1].map(|i| clay(&plains[i]).snapshot().hash());
    let world = startup::world(clay(&plains[0]), &config);
    let mut start = Start::free(plains[0].clone(), config.camera.camera(), config.brush);
    let second = StartForm { plain: plains[1].clone(), ..start.forms[0].clone() };
    start.forms.push(second);
    let settings = Settings {
        rate_hz: 120,
        dab_budget: config.r#loop.dab_budget,
        undo_bytes: 1 << 30,
        camera: start.camera,
        brush: config.brush,
        hands: config.hand,
    };
    let visit = VisitStart { plain: plains[0].clone(), settings, film: start.film.clone() };
    let recording = visit_journal::start(dir.path(), visit, None).expect("recorded");
    start.news = Some(recording.news);
    let clock = Clock::monotonic();
    let (factory, receiver) = queue::channel(4096);
    let journal: Box<dyn Journal> = Box::new(recording.journal);
    let rate = LoopConfig::default();
    let live = Live::start(world, receiver, clock.clone(), rate, 1024, Some(journal));
    let live = live.expect("a loop");
    let kiosk = KioskConfig { idle_s: 600.0, ..KioskConfig::default() };
    let words = kiosk.words(sculptd::settings::LANGUAGES).expect("English");
    let stop = Arc::new(AtomicBool::new(false));
    let keeper = keeper::start(
        (kiosk, std::slice::from_ref(&words)),
        start,
        live.published.clone(),
        live.commands.clone(),
        &factory,
        clock.clone(),
        stop.clone(),
    )
    .expect("keeps");
    let hash = || live.published.load_full().mesh.hash();
    until("the film sculpts", || live.published.load_full().figures.dabs > 20);
    // A window with other proportions than the settings: pens would miss by the difference.
    let camera = || live.published.load_full().camera;
    live.commands.try_send(Command::Camera(Camera { aspect: 1.25, ..camera() })).expect("taken");
    until("the window's proportions", || camera().aspect == 1.25);
    // As a press on the screen elsewhere.
    keeper.desk.touched.store(true, Relaxed);
    until("a visit begins with the form that is shown", || hash() == hashes[0]);
    keeper.desk.choose(1);
    until("it goes on with the chosen one", || hash() == hashes[1]);
    let mut sender = factory.sender();
    for i in 0..40 {
        let pen = Pen {
            in_range: true,
            tip: i < 39,
            pos_mm: Vec2::new(40.0 + i as f32 * 0.5, 50.0),
            area_mm: Vec2::splat(100.0),
            pressure: Some(0.5),
            ..Pen::default()
        };
        let t_us = clock.now_us();
        sender.push(Sample { device: DeviceId(0), t_us, device_t_us: None, body: Body::Pen(pen) });
    }
    sender.flush();
    until("the visitor sculpts", || hash() != hashes[1]);
    assert_eq!(camera().aspect, 1.25, "no reset changes the proportions");
    until("the input is in the file", || recording.health.written.load(Relaxed) > 0);
    stop.store(true, Relaxed);
    keeper.thread.join().expect("the keeper ends");
    live.stop().expect("ends").world.verify_invariants().expect("sound");
    recording.thread.join().expect("the files' thread ends");
    let left = std::fs::read_dir(dir.path()).expect("a folder").count();
    assert_eq!(left, 0, "the work was put away");
}
