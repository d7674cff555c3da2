//! Time that does not pass as it should: a process that is stopped in the middle of a stroke,
//! clocks that step, a machine that sleeps, midnight.

use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use glam::Vec2;
use sculptd::cli::library;
use sculptd_daemon::pacer::{Due, Pacer};
use sculptd_daemon::tick::in_order_of_time;
use sculptd_devices::leap::ClockMap;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample};
use serde_json::Value;

use crate::hostile::Daemon;
use crate::hostile_trackers::{rest, shake_hands, text};
use crate::waiting::until;

/// One frame of a closed hand that moves: nothing in it is a transition but the first.
fn frame(id: u64) -> Vec<u8> {
    let x = (id as f64 * 0.05).sin() * 60.0;
    let json = format!(
        r#"{{"id":{id},"timestamp":{},"hands":[{{"id":3,"type":"right",
        "palmPosition":[{x:.3},220,10],"palmNormal":[0,-1,0],"direction":[0,0,-1],
        "grabStrength":1,"confidence":1}}]}}"#,
        id * 9_091
    );
    text(json.as_bytes())
}

/// SIGSTOP for five seconds while a hand sculpts. The tracker sends on; what waits in the socket
/// comes at once afterwards, more than the rate allows. Every frame is received, coalesced or lost,
/// and counted as such.
#[test]
fn a_process_that_is_stopped_during_a_stroke_accounts_for_every_frame() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("listens");
    let url = format!("ws://{}/v6.json", listener.local_addr().expect("an address"));
    let sent = Arc::new(AtomicU64::new(0));
    let stop = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let (counted, ended) = (sent.clone(), stop.clone());
    let tracker = std::thread::spawn(move || {
        use std::io::Write;
        let (mut stream, _) = listener.accept().expect("a client");
        shake_hands(&mut stream).expect("hands shaken");
        let clock = Clock::monotonic();
        while !ended.load(Relaxed) {
            // 110 a second, as real trackers have it.
            let due = clock.now_us() / 9_091;
            while counted.load(Relaxed) < due {
                stream.write_all(&frame(counted.load(Relaxed) + 1)).expect("taken");
                counted.fetch_add(1, Relaxed);
            }
            rest(3);
        }
        stream
    });
    let folder = tempfile::tempdir().expect("a folder");
    let stats = folder.path().join("stats.json");
    let settings = format!("[devices]\nhid = false\nleap = \"{url}\"\n");
    let stats_at = stats.display().to_string();
    let mut daemon = Daemon::start(&["run", "--headless", "--stats", &stats_at], &settings);
    until("the hand is seen", || sent.load(Relaxed) > 110);
    daemon.signal("STOP");
    let before = sent.load(Relaxed);
    until("five seconds pass", || sent.load(Relaxed) >= before + 550);
    daemon.signal("CONT");
    let continued = sent.load(Relaxed);
    until("a second passes", || sent.load(Relaxed) >= continued + 110);
    stop.store(true, Relaxed);
    let _open = tracker.join().expect("the tracker ends");
    // The data in the socket is read.
    rest(700);
    daemon.end();
    let frames = sent.load(Relaxed);
    let text = std::fs::read_to_string(&stats).expect("the summary");
    let summary: Value = serde_json::from_str(&text).expect("one JSON object");
    let number = |name: &str| summary[name].as_u64().expect("a number");
    let (received, coalesced) = (number("samples"), number("samples_coalesced"));
    let lost = summary["losses"]["motion"].as_u64().expect("a number");
    println!(
        "{frames} frames: {received} received, {coalesced} coalesced, {lost} lost, {} told as sent",
        number("samples_sent")
    );
    assert_eq!(received + coalesced + lost, number("samples_sent"), "{summary}");
    // And one sample that says that the hand has left; another where the daemon, continued, looked
    // at the time since the last frame before it read what waited in the socket.
    let left = number("samples_sent") - frames;
    assert!((1..=2).contains(&left), "{frames} frames: {summary}");
    assert_eq!(summary["losses"]["transition"], 0);
    assert!(coalesced > 0, "the stop was shorter than the burst");
}

#[test]
fn a_machine_that_sleeps_for_a_night_wakes_with_one_late_tick() {
    let mut pacer = Pacer::new(120, 1_000);
    let night = 8 * 3600 * 1_000_000;
    let mut now = 1_000;
    for _ in 0..100 {
        if let Due::In(wait) = pacer.due(now) {
            now += wait.as_micros() as u64;
        }
        assert_eq!(pacer.done(now + 2_000), 0);
    }
    now += night + 4_000;
    assert!(matches!(pacer.due(now), Due::Now { late_us } if late_us > night - 20_000));
    let missed = pacer.done(now);
    assert!(missed.abs_diff(8 * 3600 * 120) < 3, "{missed} slots are left out, not caught up");
    assert_eq!(pacer.overruns, 1);
    assert!(matches!(pacer.due(now), Due::In(wait) if wait < Duration::from_millis(9)));
}

#[test]
fn a_tracker_s_clock_may_step_and_times_never_run_back_nor_ahead() {
    let mut map = ClockMap::default();
    let (mut ours, mut theirs) = (0u64, 3_600_000_000u64);
    let mut before = 0;
    // Steps of the tracker's clock, and nights that only ours has seen, in between.
    for (step, night) in [
        (0i64, 0u64),
        (3_600_000_000, 0),
        (-7_200_000_000, 0),
        (0, 8 * 3_600_000_000),
        (-1, 0),
        (i64::MAX / 2, 0),
        (i64::MIN / 2, 0),
        (0, 30 * 86_400_000_000),
    ] {
        theirs = theirs.saturating_add_signed(step);
        ours += night;
        for n in 0..200u64 {
            ours += 9_000;
            theirs = theirs.saturating_add(9_000);
            // Read up to 4 ms after it was taken.
            let read = ours + n * 7919 % 4_000;
            let at = map.map(Some(theirs), read);
            assert!(at >= before && at <= read, "step {step}, frame {n}: {before}, {at}, {read}");
            assert!(n < 100 || read - at < 20_000, "step {step}: {} us late", read - at);
            before = at;
        }
    }
}

/// A pen whose stamps leap by hours within a stroke: the order is that of the stamps, and a stroke
/// goes on.
#[test]
fn stamps_that_leap_within_a_stroke_keep_the_world_sound() {
    let pen = |n: u64, t_us: u64| {
        let area_mm = Vec2::new(160.0, 100.0);
        let pen = Pen {
            in_range: true,
            tip: true,
            pos_mm: area_mm * 0.5
                + Vec2::new((n as f32 * 0.1).cos(), (n as f32 * 0.1).sin()) * 15.0,
            area_mm,
            pressure: Some(0.5),
            ..Pen::default()
        };
        Sample { device: DeviceId(2), t_us, device_t_us: Some(t_us), body: Body::Pen(pen) }
    };
    let run = || {
        let mesh = sculptd_geometry::shapes::sphere_of_about(5_000);
        let clay = sculptd_clay::Clay::build(&mesh, &Default::default()).expect("a ball");
        let config = sculptd_daemon::config::Config::default();
        let mut world = sculptd_daemon::startup::world(clay, &config);
        let mut t_us = 1_000_000;
        for tick in 1..=300u64 {
            t_us += match tick {
                60 => 8 * 3_600_000_000,
                120 => 86_400_000_000,
                180 => u64::MAX / 4,
                _ => 0,
            };
            let mut samples: Vec<Sample> = (0..4)
                .map(|k| {
                    t_us += 2_000;
                    // Every now and then a device repeats itself or lags.
                    pen(tick * 4 + k, if k == 3 { t_us - 3_000 } else { t_us })
                })
                .collect();
            in_order_of_time(&mut samples);
            world.step(tick, &samples, &[]);
            world.verify_invariants().unwrap_or_else(|e| panic!("tick {tick}: {e}"));
        }
        (world.hash(), world.undo_steps())
    };
    let first = run();
    assert_eq!(first, run(), "the same bits");
    assert_ne!(first.0, 0);
}

#[test]
fn a_session_begun_around_midnight_has_a_name_of_its_own_whatever_the_calendar_does() {
    let folder = tempfile::tempdir().expect("a folder");
    // date -u -d '2026-12-31 23:59:59' +%s
    let last = 1_798_761_599;
    let mut names = Vec::new();
    // Over midnight, back by an hour (a clock that was set), and again the same second.
    for now in [last, last + 1, last + 60, last - 3_600, last, last + 1, 0] {
        let path = library::new_path(folder.path(), now, "ball");
        assert!(!path.exists(), "{}", path.display());
        std::fs::File::create(&path).expect("made");
        names.push(path.file_name().expect("a name").to_string_lossy().into_owned());
    }
    assert_eq!(names[0], "2026-12-31_2359_ball.sculpt");
    assert_eq!(names[1], "2027-01-01_0000_ball.sculpt");
    assert_eq!(names[4], "2026-12-31_2359_ball-2.sculpt");
    assert_eq!(library::entries(folder.path()).len(), 7);
    // A calendar before the sessions' own times makes none of them old.
    let limits = library::LibraryLimits { keep: 0, age_s: 1, bytes: u64::MAX };
    assert!(library::prune(folder.path(), 0, &limits).is_empty());
}
