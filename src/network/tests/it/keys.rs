//! Refused entries, and the limits of admitted members.

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
    let wrong = Invitation { secret, ..s.invitations[0].clone() };
    let stranger = s.join("stranger", Role::Sculptor, wrong);
    s.run(3.0, |_| true);
    assert!(!s.replicas[stranger].station.follows() && s.replicas[stranger].world.is_none());
    assert!(noted(&s, 0, "not let in: the key is not one of this sculpture"));
    assert!(noted(&s, stranger, "the key is not one of this sculpture"));
}

#[test]
fn a_key_for_viewers_lets_nobody_sculpt() {
    let mut s = Simulation::new(22, GOOD);
    let viewers = s.invitations[1].clone();
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
    let key = s.invitations[2].clone();
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
    let key = s.invitations[0].clone();
    let first = s.join("Ada", Role::Sculptor, key.clone());
    s.run(2.0, |_| false);
    let second = s.join("Ada", Role::Sculptor, key);
    s.run(4.0, |_| false);
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
}

#[test]
fn who_holds_a_key_and_floods_is_bounded_and_the_others_go_on() {
    let mut s = Simulation::new(26, GOOD);
    let (flooder, other) = (s.join_sculptor(), s.join_sculptor());
    s.run(3.0, |_| true);
    let person = s.replicas[flooder].station.person();
    let pen = |k: u32| Sample {
        device: DeviceId(0),
        t_us: 0,
        device_t_us: None,
        // Another button each time: none of them is motion that may be left out.
        body: Body::Pen(Pen { in_range: true, buttons: k, ..Pen::default() }),
    };
    let given = |s: &Simulation, i: usize| s.replicas[i].transitions_given;
    let applied = |s: &Simulation, of: u8| s.replicas[0].station.log().applied(of);
    let (begun_us, others) = (s.now_us, given(&s, other));
    let frames = s.replicas[0].station.log().last();
    let own = s.replicas[other].station.person();
    let mut worst = 0;
    for k in 0..1_000u32 {
        let now = s.now_us;
        for n in 0..200 {
            let k = k * 400 + n * 2;
            s.replicas[flooder].station.submit(vec![pen(k), pen(k + 1)], vec![], now);
        }
        let before = applied(&s, own);
        s.run(0.02, |i| i != flooder);
        worst = worst.max(s.replicas[other].station.outbox().len());
        assert!(applied(&s, own) >= before);
    }
    let seconds = (s.now_us - begun_us) as f64 / 1e6;
    // Every tick has its frame, as without the flood.
    let made = s.replicas[0].station.log().last() - frames;
    assert!(made as f64 > seconds * 115.0, "{made} frames in {seconds} s");
    assert!(given(&s, other) - others > 20, "the other sculpts");
    // Its input is acknowledged as fast as ever: a quarter of a second waits, not more.
    assert!(worst < 40, "{worst} batches of the other waited");
    let taken = applied(&s, person);
    let told = s.replicas[0].notes.join("\n");
    println!("{taken} of 200000 batches taken in {seconds} s; {worst} of the other's waited");
    assert!((taken as f64) < 30_000.0, "{taken} batches of the flood were taken");
    assert!(told.contains("sends more input than is allowed"));
    let refused = s.replicas[flooder].refused.clone();
    assert!(refused.is_some_and(|why| why.contains("more")), "it is sent away, and told why");
    // The others have one sculpture.
    s.replicas[flooder].alive = false;
    s.run(5.0, |_| false);
    s.verify();
}
