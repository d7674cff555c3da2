//! Eight tablets at 1,000 reports a second each, through their own reader threads, and a consumer
//! that stands still for 300 ms at random.

use std::time::Duration;

use crate::catalogue::{Catalogue, Identification};
use crate::clock::Clock;
use crate::device_thread;
use crate::hid::reader;
use crate::queue::channel;
use crate::sample::{Body, DeviceId, Sample};
use crate::sim::faults::Rng;
use crate::sim::tablet::{self, SimTablet, TabletConfig};
use crate::sim::{PenScript, Shape, Stroke};

const TABLETS: usize = 8;
const RATE: f32 = 1000.0;
/// A quarter of what the daemon is configured with: what gathers in 300 ms does not fit.
const CAPACITY: usize = 1024;
const TICK: Duration = Duration::from_micros(8_333);

/// Short strokes without end: a transition every 25 ms.
fn tapping(seconds: u64) -> PenScript {
    let at = |i: u64| glam::vec2(10.0 + (i % 50) as f32, 20.0);
    let stroke = |i: u64| Stroke {
        from_us: 200_000 + i * 50_000,
        to_us: 225_000 + i * 50_000,
        shape: Shape::Line(at(i), at(i) + glam::vec2(5.0, 5.0)),
        pressure: 0.9,
        tilt: glam::Vec2::ZERO,
        eraser: false,
        buttons: 0,
    };
    PenScript::new((0..seconds.saturating_sub(1) * 20).map(stroke).collect())
}

fn down(s: &Sample) -> bool {
    matches!(s.body, Body::Pen(p) if p.tip)
}

#[test]
fn nothing_but_motion_is_ever_lost() {
    let seconds = if std::env::var_os("SCULPTD_LONG").is_some() { 60 } else { 3 };
    let catalogue = Catalogue::builtin().unwrap();
    let Identification::Identified(found) =
        catalogue.identify(&tablet::identity(&catalogue, "Wacom PTK-440").unwrap())
    else {
        panic!("the model is known")
    };
    let (clock, script) = (Clock::monotonic(), tapping(seconds));
    let (factory, mut rx) = channel(CAPACITY);
    let (mut tablets, mut readers) = (Vec::new(), Vec::new());
    for i in 0..TABLETS {
        // On a loaded machine the flood itself comes in bursts: its loss would hide the channel's.
        let config = TabletConfig { rate: RATE, keeps: 4096, ..TabletConfig::default() };
        let (tablet, end) = SimTablet::new(&found, script.clone(), config);
        let id = DeviceId(i as u16);
        readers.push(
            reader::start(Box::new(end), &found, &[], id, clock.clone(), factory.sender()).unwrap(),
        );
        tablets.push(tablet);
    }
    let stats = rx.stats();
    let (tablet_clock, start) = (clock.clone(), clock.now_us());
    let device = device_thread::spawn("flood", move |stop| {
        while !stop.wait(Duration::from_millis(1)) {
            let now = tablet_clock.now_us() - start;
            tablets.iter_mut().for_each(|t| {
                t.advance(now);
            });
        }
    })
    .unwrap();
    let (_hold, stop) = device_thread::pair();
    let (mut rng, mut got) = (Rng::new(9), Vec::with_capacity(CAPACITY));
    let (mut edges, mut is_down, mut stalls) = ([0u32; TABLETS], [false; TABLETS], 0);
    let mut take = |got: &mut Vec<Sample>| {
        for s in got.drain(..) {
            let d = s.device.0 as usize;
            edges[d] += u32::from(std::mem::replace(&mut is_down[d], down(&s)) != down(&s));
        }
    };
    while clock.now_us() - start < seconds * 1_000_000 {
        let stalled = rng.unit() < 0.02;
        stalls += u32::from(stalled);
        stop.wait(if stalled { Duration::from_millis(300) } else { TICK });
        rx.drain(CAPACITY, &mut got);
        take(&mut got);
    }
    drop(device);
    let p99 = readers.iter().map(|r| r.status().to_channel_us).max_by_key(|q| q.p99).unwrap();
    let ends = std::thread::spawn(move || drop(readers));
    while stats.total().on_the_way() > 0 || !ends.is_finished() {
        stop.wait(Duration::from_millis(1));
        rx.drain(CAPACITY, &mut got);
        take(&mut got);
    }
    let total = stats.total();
    println!(
        "{seconds} s, {stalls} stalls of 300 ms: {total:?}; from read to channel {p99:?} us in \
         the slowest of 8"
    );
    assert_eq!(total.sent, total.received + total.coalesced + total.lost_motion);
    assert_eq!((total.lost_transition, total.closed), (0, 0));
    assert!(total.sent > 500 * seconds * TABLETS as u64, "{total:?}");
    let strokes = script.strokes().len() as u32;
    assert_eq!(edges, [2 * strokes; TABLETS], "every tip down and every tip up of each pen");
}
