//! Who is not let in, and what those who are may not do.

use crate::simulated::{GOOD, Random, Simulation};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::command::Command;
use sculptd_network::keyring::{Invitation, fresh};
use sculptd_network::wire::frame::Role;

fn noted(s: &Simulation, i: usize, what: &str) -> bool {
    s.replicas[i].notes.iter().any(|n| n.contains(what))
}

#[test]
fn a_stranger_is_not_let_in_and_both_are_told() {
    let mut s = Simulation::new(21, GOOD);
    let secret = fresh(&mut Random::entropy(99));
    let wrong = Invitation { role: Role::Sculptor, name: None, secret };
    let stranger = s.join("stranger", Role::Sculptor, wrong);
    s.run(3.0, |_| true);
    assert!(!s.replicas[stranger].station.follows() && s.replicas[stranger].world.is_none());
    assert!(noted(&s, 0, "not let in: the key is not one of this sculpture"));
    assert!(noted(&s, stranger, "the key is not one of this sculpture"));
}

#[test]
fn a_key_for_viewers_lets_nobody_sculpt() {
    let mut s = Simulation::new(22, GOOD);
    let viewers = s.keyring.0[1].clone();
    let would = s.join("would sculpt", Role::Sculptor, viewers.clone());
    let views = s.join("wall", Role::Viewer, viewers);
    s.run(3.0, |i| i == 0);
    let why = s.replicas[would].refused.clone().expect("told");
    assert!(why.contains("the key is for a viewer, and a sculptor was asked for"), "{why}");
    assert!(noted(&s, 0, "the key is for a viewer"));
    assert!(s.replicas[views].station.follows());
    let now = s.now_us;
    s.replicas[views].station.submit(vec![], vec![Command::Undo], now);
    s.run(2.0, |_| false);
    s.replicas.remove(would);
    s.verify();
}

#[test]
fn a_device_sends_and_is_sent_no_frames() {
    let mut s = Simulation::new(23, GOOD);
    let key = s.keyring.0[2].clone();
    let device = s.join("tablet", Role::Device, key);
    s.run(1.0, |_| false);
    let before = s.replicas[0].world.as_ref().map(|w| w.hash());
    s.run(3.0, |i| i == device);
    s.run(2.0, |_| false);
    assert!(s.replicas[device].world.is_none());
    assert!(s.replicas[device].station.outbox().is_empty(), "all of it arrived");
    assert_ne!(s.replicas[0].world.as_ref().map(|w| w.hash()), before, "it sculpts");
}

#[test]
fn a_name_is_had_by_one_at_a_time() {
    let mut s = Simulation::new(24, GOOD);
    let key = s.keyring.0[0].clone();
    let first = s.join("Ada", Role::Sculptor, key.clone());
    s.run(2.0, |_| false);
    let second = s.join("Ada", Role::Sculptor, key);
    s.run(2.0, |_| false);
    assert!(s.replicas[first].station.follows());
    assert!(s.replicas[second].refused.as_ref().is_some_and(|w| w.contains("here already")));
}

#[test]
fn floods_and_nonsense_are_bounded_and_the_sculpture_goes_on() {
    let mut s = Simulation::new(25, GOOD);
    let guest = s.join_sculptor();
    s.run(2.0, |_| true);
    let mut random = Random(7);
    for round in 0..200 {
        for _ in 0..50 {
            let mut bytes: Vec<u8> =
                (0..random.next() % 200).map(|_| random.next() as u8).collect();
            if let Some(kind) = bytes.first_mut() {
                *kind = (random.next() % 5) as u8;
            }
            // As if another sent it.
            let as_if = s.replicas[guest].station.address().to_le_bytes();
            if random.next() % 2 == 0 && bytes.len() > 9 {
                bytes[1..9].copy_from_slice(&as_if);
            }
            s.inject((round % 2) as usize, &bytes);
        }
        s.run(0.008, |_| true);
    }
    s.run(3.0, |_| false);
    s.verify();
    // Who holds a key and floods is sent away, and told why.
    let pen = |k: u32| Sample {
        device: DeviceId(0),
        t_us: 0,
        device_t_us: None,
        body: Body::Pen(Pen { in_range: true, buttons: k, ..Pen::default() }),
    };
    for k in 0..60_000 {
        let now = s.now_us;
        s.replicas[guest].station.submit(vec![pen(k), pen(k + 1)], vec![], now);
        if k % 2_000 == 0 {
            s.run(0.1, |i| i == 0);
        }
    }
    s.run(20.0, |i| i == 0);
    let told = s.replicas[0].notes.join("\n");
    let bounded =
        s.replicas[guest].refused.is_some() || s.replicas[guest].station.outbox().is_empty();
    assert!(bounded, "{told}");
    assert!(s.replicas[0].station.hosts());
}
