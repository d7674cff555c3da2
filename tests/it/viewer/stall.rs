//! A renderer that stops costs the sculpture nothing.

use std::time::Duration;

use glam::Vec2;
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::live::Live;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample, Tool, queue};

/// Resident bytes of this process; 0 where the system does not tell.
fn resident() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|p| p.parse::<u64>().ok()).unwrap_or(0) * 4096
}

fn pen(t_us: u64, at: Vec2, tip: bool) -> Sample {
    let pen = Pen {
        tool: Tool::Pen,
        in_range: true,
        tip,
        pos_mm: at * 100.0,
        area_mm: Vec2::splat(100.0),
        pressure: Some(if tip { 0.5 } else { 0.0 }),
        ..Default::default()
    };
    Sample { device: DeviceId(0), t_us, device_t_us: None, body: Body::Pen(pen) }
}

/// The viewer holds one state and looks at nothing more, while a stroke goes on: one second, or ten
/// with `SCULPTD_LONG=1`.
#[test]
fn a_viewer_that_stalls_costs_no_sample_and_no_memory() {
    let long = std::env::var_os("SCULPTD_LONG").is_some_and(|v| v == "1");
    let seconds = if long { 10 } else { 1 };
    let clock = Clock::monotonic();
    let (factory, receiver) = queue::channel(4096);
    let mut sender = factory.sender();
    let live = Live::start(
        super::world(40_000),
        receiver,
        clock.clone(),
        LoopConfig::default(),
        1024,
        None,
    )
    .expect("the loop starts");
    let (_keep, quiet) = crossbeam_channel::bounded::<()>(1);
    let wait = |ms| {
        let _ = quiet.recv_timeout(Duration::from_millis(ms));
    };
    let mut stroke = |from: u64, samples: u64| {
        for i in from..from + samples {
            let turn = i as f32 * 0.02;
            let at = Vec2::new(0.5 + 0.12 * turn.cos(), 0.5 + 0.12 * turn.sin());
            sender.push(pen(clock.now_us(), at, true));
            sender.flush();
            wait(4);
        }
    };
    // Warm: pages and pools have their size.
    stroke(0, 100);
    let held = live.published.load_full();
    let (before, late_before) = (resident(), held.figures.overruns);
    let samples = seconds * 200;
    stroke(100, samples);
    wait(60);
    let now = live.published.load_full();
    let grown = resident().saturating_sub(before);
    println!(
        "{seconds} s: {} samples, {} dabs, {} late ticks of {}, {:.1} MB more",
        now.figures.samples,
        now.figures.dabs,
        now.figures.overruns - late_before,
        now.figures.ticks,
        grown as f64 / 1e6
    );
    assert_eq!(now.figures.samples, 100 + samples, "every sample was heard");
    assert_eq!(now.figures.losses, Default::default());
    assert!(now.mesh.revision() > held.mesh.revision());
    // The held state is whole still.
    assert_eq!(held.mesh.vertex_count(), now.mesh.vertex_count());
    // A stroke's undo memory is bounded by the size of the clay; published states do not
    // accumulate.
    assert!(grown < 64 << 20, "{grown} bytes");
    sender_lifts(&factory, &clock);
    wait(60);
    let ended = live.stop().expect("ends");
    ended.world.verify_invariants().expect("sound");
}

fn sender_lifts(factory: &queue::SenderFactory, clock: &Clock) {
    let mut sender = factory.sender();
    sender.push(pen(clock.now_us(), Vec2::splat(0.5), false));
    sender.flush();
}
