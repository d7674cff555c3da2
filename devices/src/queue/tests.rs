use std::time::Duration;

use glam::vec2;
use proptest::prelude::*;

use super::*;
use crate::sample::{Body, Pen};

fn pen(device: u16, t_us: u64, tip: bool) -> Sample {
    let pen = Pen { in_range: true, tip, pos_mm: vec2(t_us as f32, 0.0), ..Pen::default() };
    Sample { device: DeviceId(device), t_us, device_t_us: None, body: Body::Pen(pen) }
}

fn tip(s: &Sample) -> bool {
    matches!(s.body, Body::Pen(p) if p.tip)
}

#[test]
fn a_full_channel_coalesces_motion_and_keeps_every_edge() {
    let (factory, mut rx) = channel(2);
    let mut tx = factory.sender();
    for t in 0..100 {
        tx.push(pen(0, t, t / 10 % 2 == 1));
    }
    let mut got = Vec::new();
    while !(tx.flush() && rx.waiting() == 0) {
        rx.drain(1, &mut got);
    }
    // The two that fitted, the newest motion of the first run, then an edge and the newest motion
    // of each later run.
    let times: Vec<u64> = got.iter().map(|s| s.t_us).collect();
    let mut want = vec![0, 1, 9];
    want.extend((1..10).flat_map(|run| [run * 10, run * 10 + 9]));
    assert_eq!(times, want);
    let count = rx.stats().of(DeviceId(0));
    assert_eq!((count.sent, count.received, count.coalesced, count.on_the_way()), (100, 21, 79, 0));
}

#[test]
fn when_everything_is_full_motion_goes_and_the_reader_waits_for_edges() {
    let (factory, mut rx) = channel(1);
    let stats = rx.stats();
    let edges = 2 * MAX_PENDING as u64;
    let reader = std::thread::spawn(move || {
        let mut tx = factory.sender();
        for t in 0..edges {
            tx.push(pen(3, 2 * t, t % 2 == 0));
            tx.push(pen(3, 2 * t + 1, t % 2 == 0));
        }
        while !tx.flush() {
            std::thread::yield_now();
        }
    });
    while stats.of(DeviceId(3)).waits == 0 {
        std::thread::yield_now();
    }
    let mut got = Vec::new();
    while let Some(s) = rx.next_within(Duration::from_secs(5)) {
        got.push(s);
    }
    reader.join().unwrap();
    let seen: Vec<u64> = got.iter().filter(|s| s.t_us % 2 == 0).map(|s| s.t_us / 2).collect();
    assert_eq!(seen, (0..edges).collect::<Vec<_>>(), "every edge, in order");
    let count = stats.of(DeviceId(3));
    assert!(count.waits > 0 && count.lost_motion > 0, "{count:?}");
    assert_eq!((count.lost_transition, count.on_the_way()), (0, 0));
}

#[test]
fn a_stopped_reader_does_not_hang_on_a_dead_consumer() {
    let (factory, rx) = channel(1);
    let mut tx = factory.sender();
    tx.stop_when(Arc::new(AtomicBool::new(true)));
    for t in 0..2000 {
        tx.push(pen(1, t, t % 2 == 0));
    }
    drop(tx);
    let count = rx.stats().of(DeviceId(1));
    assert!(count.lost_transition > 0);
    assert_eq!(count.on_the_way(), 1, "the one in the channel");
}

#[test]
fn a_consumer_that_has_gone_is_counted_apart() {
    let (factory, rx) = channel(4);
    let stats = rx.stats();
    drop(rx);
    let mut tx = factory.sender();
    for t in 0..10 {
        tx.push(pen(7000, t, true));
    }
    let count = stats.of(DeviceId(7000));
    assert_eq!((count.sent, count.closed, count.on_the_way()), (10, 10, 0));
    assert_eq!(stats.total(), count, "ids beyond the table share its last slot");
}

#[test]
fn draining_takes_at_most_what_was_asked_and_allocates_nothing() {
    let (factory, mut rx) = channel(64);
    let mut tx = factory.sender();
    for t in 0..50 {
        tx.push(pen(0, t, true));
    }
    let mut out = Vec::with_capacity(64);
    let place = out.as_ptr();
    assert_eq!(rx.drain(20, &mut out), 20);
    assert_eq!(rx.drain(100, &mut out), 30);
    assert_eq!(rx.drain(100, &mut out), 0);
    assert_eq!(place, out.as_ptr());
}

#[test]
fn what_a_person_set_for_a_tablet_holds_for_that_tablet() {
    let (factory, mut rx) = channel(8);
    let mut tx = factory.sender();
    let turned = Calibration { left_handed: true, ..Calibration::default() };
    tx.calibrate(DeviceId(1), turned);
    let mut got = Vec::new();
    let mut at = |device| {
        let mut s = pen(device, 3, true);
        if let Body::Pen(p) = &mut s.body {
            p.area_mm = vec2(10.0, 10.0);
        }
        tx.push(s);
        rx.drain(1, &mut got);
        let Some(Sample { body: Body::Pen(p), .. }) = got.pop() else { panic!() };
        p.pos_mm
    };
    assert_eq!((at(0), at(1)), (vec2(3.0, 0.0), vec2(7.0, 10.0)));
    tx.calibrate(DeviceId(1), Calibration::default());
    tx.push(pen(1, 4, true));
    assert!(tx.calibrations.is_empty());
}

/// Operation of a test on the channel: one device moves or toggles its tip, or the consumer takes
/// some samples.
#[derive(Debug, Clone)]
enum Op {
    Move(u16),
    Edge(u16),
    Drain(usize),
}

fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        4 => (0..3u16).prop_map(Op::Move),
        2 => (0..3u16).prop_map(Op::Edge),
        1 => (0..6usize).prop_map(Op::Drain),
    ]
}

proptest! {
    #[test]
    fn no_order_of_events_breaks_the_laws(
        ops in prop::collection::vec(op(), 1..400), capacity in 1..8usize
    ) {
        let (factory, mut rx) = channel(capacity);
        let mut tx = factory.sender();
        let mut down = [false; 3];
        let mut sent: Vec<Sample> = Vec::new();
        let mut got = Vec::new();
        for (i, op) in ops.iter().enumerate() {
            match *op {
                Op::Move(d) | Op::Edge(d) => {
                    down[d as usize] ^= matches!(op, Op::Edge(_));
                    sent.push(pen(d, i as u64, down[d as usize]));
                    tx.push(sent[sent.len() - 1]);
                }
                Op::Drain(n) => { rx.drain(n, &mut got); }
            }
            prop_assert_eq!(rx.stats().total().on_the_way(), (rx.waiting() + tx.pending()) as u64);
        }
        loop {
            let done = tx.flush();
            if rx.drain(usize::MAX, &mut got) == 0 && done { break }
        }
        for d in 0..3 {
            let of = |v: &[Sample]| {
                v.iter().filter(|s| s.device.0 == d).copied().collect::<Vec<_>>()
            };
            let (sent, got) = (of(&sent), of(&got));
            prop_assert!(got.windows(2).all(|w| w[0].t_us < w[1].t_us), "order and no doubles");
            let edges = |v: &[Sample]| {
                let mut e: Vec<u64> = v.first().map(|s| s.t_us).into_iter().collect();
                e.extend(v.windows(2).filter(|w| tip(&w[0]) != tip(&w[1])).map(|w| w[1].t_us));
                e
            };
            prop_assert_eq!(edges(&sent), edges(&got), "each edge at its own instant");
            let newest = |v: &[Sample]| v.last().map(|s| s.t_us);
            prop_assert_eq!(newest(&sent), newest(&got), "the newest sample arrives");
            let c = rx.stats().of(DeviceId(d));
            prop_assert_eq!(c.sent, sent.len() as u64);
            prop_assert_eq!((c.received, c.lost_motion + c.lost_transition), (got.len() as u64, 0));
        }
    }
}
