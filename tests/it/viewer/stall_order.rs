//! A window that stalls hands its events over late and in bursts: the bits stay the same.

use std::time::Duration;

use crossbeam_channel as cc;
use glam::Vec2;

use crate::seeded::Random;
use sculptd_clay::brush::{BrushKind, BrushSettings, Presets};
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::event_clock::EventClock;
use sculptd_daemon::live::Live;
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample, Tool, queue};
use sculptd_engine::command::Command;

/// What the window does, in order.
enum Event {
    Brush(BrushSettings),
    Pointer(Pen),
}

/// Strokes over the ball: most with a brush that a modifier key lends for one stroke, some with a
/// setting that changes while the pointer is down.
fn events(r: &mut Random, strokes: u64) -> Vec<(u64, Event)> {
    let presets = Presets::default();
    let draw = presets.of(BrushKind::Draw);
    let (mut t_us, mut out) = (1_000, Vec::new());
    let mut push = |out: &mut Vec<(u64, Event)>, event| {
        t_us += 500;
        out.push((t_us, event));
    };
    for _ in 0..strokes {
        let lent = match r.below(4) {
            0 => Some(BrushSettings { negative: true, ..draw }),
            1 | 2 => Some(BrushSettings { radius: draw.radius, ..presets.of(BrushKind::Smooth) }),
            _ => None,
        };
        if let Some(lent) = lent {
            push(&mut out, Event::Brush(lent));
        }
        let (from, way) = (Vec2::splat(0.4 + 0.2 * r.part() as f32), 0.1 * r.part() as f32);
        let points = 5 + r.below(20);
        let changes = r.below(6) == 0;
        for i in 0..=points {
            let at = from + Vec2::new(way, 0.02) * i as f32 / points as f32;
            let pen = Pen {
                tool: Tool::Touch,
                in_range: true,
                tip: i < points,
                pos_mm: at * 100.0,
                area_mm: Vec2::splat(100.0),
                pressure: Some(if i < points { 0.6 } else { 0.0 }),
                ..Default::default()
            };
            if changes && i == points / 2 {
                push(&mut out, Event::Brush(BrushSettings { radius: 0.3, ..draw }));
            }
            push(&mut out, Event::Pointer(pen));
        }
        if lent.is_some() || changes {
            push(&mut out, Event::Brush(draw));
        }
    }
    out
}

fn sample(t_us: u64, pen: Pen) -> Sample {
    Sample { device: DeviceId(7), t_us, device_t_us: None, body: Body::Pen(pen) }
}

/// Each event alone in its tick.
fn without_stalls(events: &[(u64, Event)]) -> u64 {
    let mut world = super::world(3_000);
    for (t_us, event) in events {
        let tick = world.tick() + 1;
        match event {
            Event::Brush(brush) => world.step(tick, &[], &[Command::Brush(*brush)]),
            Event::Pointer(pen) => world.step(tick, &[sample(*t_us, *pen)], &[]),
        };
    }
    let last = world.tick() + 1;
    (last..last + 8).for_each(|tick| _ = world.step(tick, &[], &[]));
    world.hash()
}

/// Through the live loop, in bursts with rests between.
fn with_stalls(events: &[(u64, Event)], seed: u64) -> u64 {
    let (factory, receiver) = queue::channel(4096);
    let (mut pointer, clock) = (factory.sender(), Clock::monotonic());
    let config = LoopConfig { rate_hz: 1000, ..LoopConfig::default() };
    let world = super::world(3_000);
    let live = Live::start(world, receiver, clock.clone(), config, 64, None).expect("starts");
    let (answers, answered) = cc::unbounded();
    let times = EventClock::new(clock);
    let commands = live.commands.of_window(answers, times.clone());
    let quiet = cc::never::<()>();
    let (mut r, mut asked, mut sent) = (Random(seed), 0, 0);
    for burst in events.chunk_by(|_, _| r.below(60) != 0) {
        for (t_us, event) in burst {
            times.set_event(Some(*t_us));
            match event {
                Event::Brush(brush) => {
                    commands.send(Command::Brush(*brush)).expect("the loop runs");
                    asked += 1;
                }
                Event::Pointer(pen) => {
                    pointer.push(sample(*t_us, *pen));
                    sent += 1;
                }
            }
        }
        let _ = quiet.recv_timeout(Duration::from_micros(3_000));
    }
    for _ in 0..asked {
        let answer = answered.recv_timeout(crate::waiting::PATIENCE).expect("an answer");
        assert!(answer.result.is_ok());
    }
    crate::waiting::until("all is stepped", || {
        let shown = live.published.load_full();
        shown.figures.samples == sent && !shown.is_behind
    });
    let ended = live.stop().expect("ends");
    assert_eq!(ended.figures.samples, sent);
    ended.world.hash()
}

/// 60 strokes, or 1,000 with `SCULPTD_LONG=1`.
#[test]
fn strokes_have_the_same_bits_however_the_window_stalls() {
    let strokes = if crate::field::long() { 1_000 } else { 60 };
    let events = events(&mut Random(0x57a11), strokes);
    let expected = without_stalls(&events);
    for seed in 1..=3 {
        assert_eq!(with_stalls(&events, seed), expected, "stalls of seed {seed}");
    }
}

/// The brush that comes back at the release draws nothing of the lent brush's stroke: over an
/// untouched ball, smoothing moves nothing.
#[test]
fn a_smooth_stroke_ends_as_it_began() {
    let presets = Presets::default();
    let smooth = presets.of(BrushKind::Smooth);
    let draw = presets.of(BrushKind::Draw);
    let stroke = |back: bool| {
        let mut world = super::world(40_000);
        world.step(1, &[], &[Command::Brush(smooth)]);
        for i in 0..=40u64 {
            let at = Vec2::new(0.4 + 0.005 * i as f32, 0.5);
            let pen = Pen {
                tool: Tool::Touch,
                in_range: true,
                tip: i < 40,
                pos_mm: at * 100.0,
                area_mm: Vec2::splat(100.0),
                pressure: Some(0.6),
                ..Default::default()
            };
            let given_back = [Command::Brush(draw)];
            let commands = if back && i == 40 { &given_back[..] } else { &[] };
            world.step(i + 2, &[sample(i * 4_000, pen)], commands);
        }
        world.step(50, &[], &[Command::Brush(draw)]);
        world.hash()
    };
    assert_eq!(stroke(true), stroke(false));
}
