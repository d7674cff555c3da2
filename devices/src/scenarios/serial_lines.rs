use std::time::Duration;

use super::until;
use crate::clock::Clock;
use crate::queue::{Receiver, channel};
use crate::sample::{Body, DeviceId, Pen, Sample, Tool};
use crate::serial::{Protocol, SerialConfig, SerialHandle, SerialStatus, start};
use crate::sim::{Faults, Journal, SerialPen, SerialPenConfig, journal};

const SOON: Duration = Duration::from_secs(60);
const ALL: [Protocol; 4] =
    [Protocol::Isdv4, Protocol::WacomIv, Protocol::WacomV, Protocol::SummaMm];

struct SerialSetup {
    pen: SerialPen,
    handle: SerialHandle,
    rx: Receiver,
    clock: Clock,
    got: Vec<Sample>,
}

fn setup(protocol: Protocol, faults: Faults, rate: f32, known: bool) -> SerialSetup {
    let Journal { pen, area_mm, .. } = journal();
    let sim = SerialPen::new(
        pen,
        SerialPenConfig { rate, faults, ..SerialPenConfig::new(protocol, area_mm) },
    )
    .unwrap();
    let (factory, rx) = channel(4096);
    let clock = Clock::manual();
    let config = SerialConfig {
        port: known.then(|| sim.port().to_owned()),
        probe: if known { Vec::new() } else { vec![sim.port().to_owned()] },
        protocol: known.then_some(protocol),
        device: DeviceId(9),
        ..SerialConfig::default()
    };
    let handle = start(config, clock.clone(), factory.sender()).unwrap();
    assert!(sim.wait_for_reader(Duration::from_secs(20)), "{protocol:?}: {:?}", handle.status());
    SerialSetup { pen: sim, handle, rx, clock, got: Vec::new() }
}

impl SerialSetup {
    fn step(&mut self, us: u64) {
        self.clock.set_us(us);
        for _ in 0..self.pen.advance(us) {
            self.got.push(self.rx.next_within(SOON).expect("the promised sample"));
        }
    }

    /// The status once it counts every sample that came: the adaptor counts after it has sent.
    fn status(&self) -> SerialStatus {
        until("every sample is counted", || self.handle.status().samples >= self.got.len() as u64);
        self.handle.status()
    }
}

fn pen(s: &Sample) -> Pen {
    let Body::Pen(p) = s.body else { panic!("{s:?}") };
    p
}

#[test]
fn the_journal_comes_out_of_every_protocol_as_it_went_in() {
    let script = journal().pen;
    for protocol in ALL {
        let mut setup = setup(protocol, Faults::default(), 133.0, true);
        (0..400).for_each(|i| setup.step(i * 20_000));
        assert_eq!(setup.rx.waiting(), 0);
        let (mut worst, mut contacts, mut erased) = (0.0f32, 0, 0);
        // A sample is stamped with the step in which it was read; the pose is that of one of the
        // packets in it.
        for s in &setup.got {
            let p = pen(s);
            assert!(p.in_range || !p.tip);
            if !p.in_range {
                continue;
            }
            contacts += usize::from(p.tip);
            erased += usize::from(p.tip && p.tool == Tool::Eraser);
            let near = (0..=20)
                .map(|k| script.at(s.t_us.saturating_sub(1000 * k)).pos_mm.distance(p.pos_mm));
            worst = worst.max(near.fold(f32::INFINITY, f32::min));
        }
        let status = setup.status();
        println!(
            "{protocol:?}: {} samples, {contacts} in contact, off by {worst:.3} mm at most",
            setup.got.len()
        );
        assert!(worst < 0.5 && contacts > 500, "{protocol:?}: {worst}");
        assert!(protocol == Protocol::SummaMm || erased > 50, "{protocol:?}: {erased}");
        assert_eq!(
            status.counts.cut + status.counts.suspect + status.counts.stray + status.counts.broken,
            0
        );
        assert_eq!(status.samples, setup.got.len() as u64);
        assert!(status.rate < 140.0, "{}", status.rate);
        if protocol != Protocol::SummaMm {
            assert!(setup.got.iter().any(|s| pen(s).pressure.unwrap() > 0.85));
            let tilted = setup.got.iter().find(|s| pen(s).tip).and_then(|s| pen(s).tilt).unwrap();
            assert!(tilted.distance(glam::vec2(0.3, 0.2)) < 0.02, "{tilted}");
        }
    }
}

#[test]
fn two_runs_give_the_same_bits() {
    let run = || {
        let mut setup = setup(
            Protocol::Isdv4,
            Faults { seed: 5, tear: 0.02, ..Faults::default() },
            133.0,
            true,
        );
        (0..300).for_each(|i| setup.step(i * 8_333));
        setup.got
    };
    assert_eq!(run(), run());
}

/// Packets with a byte cut off, lost or doubled: every point that comes out is one that was sent,
/// and each good packet between two bad ones is a point but for the one next to a fault.
#[test]
fn no_bogus_point_from_a_noisy_line() {
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    let packets = if long { 100_000 } else { 10_000 };
    for protocol in ALL {
        let faults =
            Faults { seed: 11, tear: 0.02, drop: 0.02, duplicate: 0.02, ..Faults::default() };
        let script = journal().pen;
        // Many packets a step, so that it takes no time: 2 us apart in the script.
        let rate = 20_000.0;
        let mut setup = setup(protocol, faults, rate, true);
        setup.pen.skip_to(300_000);
        let sent = |us: u64| script.at(us).pos_mm;
        let end = 300_000 + packets * 50;
        let mut at = 300_000;
        while at < end.min(script.end_us()) {
            at += 2_500;
            setup.step(at);
        }
        let status = setup.status();
        let c = status.counts;
        let (mut bogus, mut last) = (0, 0);
        for s in setup.got.iter().filter(|s| pen(s).in_range) {
            // One of the fifty packets of its step.
            let from = s.t_us.saturating_sub(2_600);
            let near = (0..=53).any(|k| sent(from + 50 * k).distance(pen(s).pos_mm) < 0.06);
            bogus += usize::from(!near);
            last = last.max(s.t_us);
        }
        let faulty = c.cut + c.suspect;
        println!("{protocol:?}: {c:?}, {} samples, {bogus} bogus", setup.got.len());
        assert_eq!((bogus, c.broken), (0, 0), "{protocol:?}");
        assert!(faulty > packets / 50, "{protocol:?}: {c:?}");
        // Each fault costs its packet and at most one more.
        let sent_packets = (at - 300_000) / 50;
        assert!(c.packets + 2 * faulty >= sent_packets, "{protocol:?}: {c:?} of {sent_packets}");
    }
}

#[test]
fn a_port_that_may_be_asked_is_asked_until_something_answers() {
    for protocol in [Protocol::WacomIv, Protocol::Isdv4] {
        let mut setup = setup(protocol, Faults::default(), 133.0, false);
        setup.step(1_000_000);
        assert_eq!(setup.status().protocol, Some(protocol));
    }
    // With nothing named and nothing allowed no port is touched.
    let (factory, _rx) = channel(4);
    let handle = start(SerialConfig::default(), Clock::manual(), factory.sender()).unwrap();
    assert!(!handle.status().connected);
}

#[test]
fn an_unplug_ends_the_visit() {
    let mut setup = setup(Protocol::Isdv4, Faults::default(), 133.0, true);
    setup.pen.skip_to(990_000);
    setup.step(1_000_000);
    assert!(pen(setup.got.last().unwrap()).tip);
    assert_eq!(setup.pen.unplug(), 1);
    let gone = pen(&setup.rx.next_within(SOON).unwrap());
    assert!(!gone.tip && !gone.in_range && gone.buttons == 0);
    until("the visit is over", || !setup.handle.status().connected);
}

/// Every byte of a packet cut, lost and doubled in turn: what comes out is only what was sent, and
/// the stream is whole again from the second packet after the fault at the latest.
#[test]
fn every_single_fault_is_followed_by_sync() {
    for protocol in ALL {
        let (facts, good) = crate::sim::serial::stream(protocol, &journal().pen, 600_000..800_000);
        let read = |packets: &[Vec<u8>]| {
            let (mut d, mut got) =
                (crate::serial::SerialDecoder::new(&facts, DeviceId(0)), Vec::new());
            for (i, p) in packets.iter().enumerate() {
                d.feed(p, i as u64, &mut |s| got.push(pen(&s)));
            }
            d.quiet(&mut |s| got.push(pen(&s)));
            got
        };
        let whole = read(&good);
        assert!(
            whole.len() > 15 && whole.len() == good.iter().filter(|p| p[0] & 0xfc != 0xc0).count()
        );
        let at = 8;
        for i in 0..good[at].len() {
            for fault in 0..3 {
                let mut packets = good.clone();
                match fault {
                    0 => packets[at].truncate(i),
                    1 => {
                        packets[at].remove(i);
                    }
                    _ => {
                        let b = packets[at][i];
                        packets[at].insert(i, b);
                    }
                }
                let got = read(&packets);
                assert!(
                    got.iter().all(|p| whole.contains(p)),
                    "{protocol:?} fault {fault} at byte {i}: a bogus point"
                );
                assert!(
                    got.len() + 2 >= whole.len(),
                    "{protocol:?} fault {fault} at byte {i}: {} lost",
                    whole.len() - got.len()
                );
                assert_eq!(got[got.len() - 4..], whole[whole.len() - 4..]);
            }
        }
    }
}

mod any_bytes {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn never_panic_and_never_leave_the_tablet(
            bytes in prop::collection::vec(any::<u8>(), 0..600), which in 0..4usize
        ) {
            let (facts, _) = crate::sim::serial::stream(ALL[which], &journal().pen, 0..1);
            let mut d = crate::serial::SerialDecoder::new(&facts, DeviceId(0));
            let mut got = Vec::new();
            for (t, chunk) in bytes.chunks(7).enumerate() {
                d.feed(chunk, t as u64 * 1000, &mut |s| got.push(pen(&s)));
            }
            d.leave(1 << 20, &mut |s| got.push(pen(&s)));
            for p in &got {
                let (low, high) = (glam::Vec2::ZERO, p.area_mm);
                prop_assert!(p.pos_mm.cmpge(low).all() && p.pos_mm.cmple(high).all());
                prop_assert!(p.pressure.is_none_or(|v| (0.0..=1.0).contains(&v)));
                prop_assert!(p.in_range || !p.tip);
            }
            prop_assert!(got.last().is_none_or(|p| !p.in_range), "every visit ends");
        }
    }
}
