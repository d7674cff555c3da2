//! Strokes of several people over bad networks, and hosts that die.

use crate::simulated::{BAD, Faults, GOOD, Random, Simulation, ball, undo};

/// Returns the length of a long run, in seconds, or the short default of every test run.
pub fn long(name: &str, short: u64) -> u64 {
    std::env::var(name).ok().and_then(|t| t.parse().ok()).unwrap_or(short)
}

fn together(people: usize, faults: Faults, seconds: f64, seed: u64) -> Simulation {
    let mut s = Simulation::new(seed, faults);
    s.run(0.5, |i| i == 0);
    (1..people).for_each(|_| {
        s.join_sculptor();
    });
    // Joiners come while the others sculpt.
    s.run(if faults.delay_us > 10_000 { 6.0 } else { 3.0 }, |_| true);
    assert!(s.replicas[1..].iter().all(|r| r.restored == 1), "{:?}", s.replicas[1].notes);
    let before: Vec<_> = s.replicas.iter().map(|r| r.bytes).collect();
    s.run(seconds, |_| true);
    for (i, (r, b)) in s.replicas.iter().zip(before).enumerate() {
        let bits = |n: u64| n as f64 * 8.0 / seconds / 1e3;
        let (up, down) = (bits(r.bytes.0 - b.0), bits(r.bytes.1 - b.1));
        println!("{people} people, replica {i}: {up:.1} kbit/s sent, {down:.1} kbit/s received");
        // The host sends to all.
        if i > 0 {
            assert!(up < 64.0 && down < 64.0, "{up} kbit/s sent, {down} kbit/s received");
        }
    }
    s
}

#[test]
fn two_people_over_a_good_network_have_one_sculpture() {
    let mut s = together(2, GOOD, 5.0, 1);
    s.run(1.5, |_| false);
    s.verify();
    let world = s.replicas[1].world.as_ref().expect("a world");
    assert_ne!(world.hash(), ball().hash(), "somebody sculpted");
    let compared = s.replicas[1].hashes.len();
    assert!(compared >= 6, "{compared} comparisons");
    // Undo goes through the log as all else does.
    let before = world.hash();
    let now = s.now_us;
    s.replicas[1].station.submit(vec![], undo(), now);
    s.run(1.0, |_| false);
    s.verify();
    assert_ne!(s.replicas[0].world.as_ref().map(|w| w.hash()), Some(before), "taken back");
}

#[test]
fn eight_people_over_a_bad_network_have_one_sculpture() {
    let seconds = long("SCULPTD_NETWORK_SECONDS", 10) as f64;
    let mut s = together(8, BAD, seconds, 2);
    // Nothing comes through for ten seconds, while all go on.
    s.replicas.iter_mut().for_each(|r| r.cut_off = true);
    s.run(long("SCULPTD_NETWORK_SILENCE", 4) as f64, |_| true);
    s.replicas.iter_mut().for_each(|r| r.cut_off = false);
    s.run(4.0, |_| true);
    s.run(12.0, |_| false);
    s.verify();
    let given: u64 = s.replicas.iter().map(|r| r.transitions_given).sum();
    assert!(given > 100);
}

#[test]
fn a_replica_that_differs_is_found_and_joins_anew() {
    let mut s = together(3, GOOD, 1.0, 3);
    let mut broken = ball();
    let tick = s.replicas[2].world.as_ref().map_or(0, |w| w.tick());
    broken.step(tick, &[], &[]);
    s.replicas[2].world = Some(broken);
    s.run(4.0, |i| i < 2);
    assert_eq!((s.replicas[2].differed, s.replicas[2].restored), (1, 2));
    s.replicas[2].differed = 0;
    s.replicas[2].hashes.clear();
    s.run(2.0, |_| false);
    s.verify();
}

#[test]
fn a_host_that_dies_is_followed_within_two_seconds_and_nothing_acknowledged_is_lost() {
    for seed in 0..long("SCULPTD_NETWORK_KILLS", 6) {
        let mut random = Random(seed);
        let faults = if seed % 2 == 0 { GOOD } else { BAD };
        let people = 2 + seed as usize % 3;
        let mut s = together(people, faults, 0.5, seed);
        s.run(random.share() * 2.0, |_| true);
        let host = s.host().expect("a host");
        let acknowledged: Vec<(u8, u64)> =
            s.lively().map(|r| (r.station.person(), r.station.outbox().acknowledged())).collect();
        s.replicas[host].alive = false;
        let at = s.now_us;
        while s.host().is_none() {
            s.run(0.01, |_| true);
            assert!(s.now_us < at + 2_000_000, "seed {seed}: nobody took over");
        }
        let took = (s.now_us - at) as f64 / 1e6;
        let next = s.host().expect("a host");
        println!("seed {seed}: {people} people, took over in {took:.2} s");
        for (person, through) in acknowledged {
            let applied = s.replicas[next].station.log().applied(person);
            assert!(applied >= through, "seed {seed}: {applied} of {through} of {person}");
        }
        s.run(4.0, |_| true);
        s.run(4.0, |_| false);
        // With two people, no third replica could have the survivor's input too.
        if people > 2 {
            s.verify()
        } else {
            s.verify_worlds()
        }
        // The old host returns under its old name, as a replica.
        let key = s.invitations[0].clone();
        let name = format!("person {host}");
        let back = s.join(&name, sculptd_network::wire::frame::Role::Sculptor, key);
        s.run(5.0, |_| true);
        s.run(4.0, |_| false);
        s.verify();
        assert_eq!(s.replicas[back].station.person(), host as u8 + 1);
    }
}

#[test]
fn a_host_that_was_cut_off_joins_the_one_that_took_over() {
    let mut s = together(3, GOOD, 1.0, 9);
    s.replicas[0].cut_off = true;
    s.run(6.0, |_| true);
    assert!(s.replicas[0].station.hosts(), "alone, it goes on");
    assert!(s.replicas[1..].iter().any(|r| r.station.hosts()), "so do the others");
    s.replicas[0].cut_off = false;
    s.run(3.0, |_| true);
    s.run(4.0, |_| false);
    assert!(!s.replicas[0].station.hosts());
    assert_eq!(s.replicas.iter().filter(|r| r.station.hosts()).count(), 1);
    s.verify();
}

#[test]
fn what_each_part_of_a_split_network_acknowledged_is_in_the_one_sculpture() {
    let mut s = together(4, GOOD, 1.0, 11);
    s.replicas[2..].iter_mut().for_each(|r| r.part = 1);
    s.run(8.0, |_| true);
    assert_eq!(s.replicas.iter().filter(|r| r.station.hosts()).count(), 2, "each part goes on");
    // Each learns that another replica has its input, although the log of one part is given up.
    for (i, r) in s.replicas.iter().enumerate() {
        let (outbox, notes) = (r.station.outbox(), r.notes.join("\n"));
        assert!(outbox.acknowledged() + 60 > outbox.last(), "replica {i}: {notes}");
    }
    s.replicas.iter_mut().for_each(|r| r.part = 0);
    s.run(4.0, |_| true);
    s.run(6.0, |_| false);
    assert_eq!(s.replicas.iter().filter(|r| r.station.hosts()).count(), 1);
    s.verify();
}

#[test]
fn a_successor_that_has_seen_no_frame_yet_goes_on_at_the_tick_of_its_checkpoint() {
    let mut s = Simulation::new(15, GOOD);
    s.run(5.0, |i| i == 0);
    let bob = s.join_sculptor();
    while s.replicas[bob].restored == 0 {
        s.run(0.004, |_| false);
    }
    s.replicas[0].alive = false;
    let tick = |s: &Simulation| s.replicas[bob].world.as_ref().map_or(0, |w| w.tick());
    let before = tick(&s);
    s.run(3.0, |i| i == bob);
    assert!(s.replicas[bob].station.hosts());
    let (world, log) = (tick(&s), s.replicas[bob].station.log().tick());
    assert!(before > 500 && world > before + 60, "{world} after {before}");
    assert_eq!(world, log, "the world and the order have one time");
}

#[test]
fn what_only_a_viewer_has_is_not_acknowledged() {
    let mut s = together(2, GOOD, 1.0, 14);
    let key = s.invitations[0].clone();
    let viewer = s.join("wall", sculptd_network::wire::frame::Role::Viewer, key);
    s.run(4.0, |_| false);
    let acknowledged = |s: &Simulation| s.replicas[0].station.outbox().acknowledged();
    let before = acknowledged(&s);
    assert_eq!(before, s.replicas[0].station.outbox().last());
    s.replicas[1].part = 1;
    s.run(1.0, |i| i == 0);
    let applied = s.replicas[viewer].station.log().applied(1);
    assert!(applied > before + 60, "the viewer has it: {applied}");
    assert_eq!(acknowledged(&s), before, "nobody who could take over has it");
}

#[test]
fn who_was_killed_and_is_back_at_once_is_let_in() {
    let mut s = together(3, GOOD, 1.0, 12);
    s.replicas[2].alive = false;
    let key = s.invitations[0].clone();
    let back = s.join("person 2", sculptd_network::wire::frame::Role::Sculptor, key);
    // Until the host is sure that the first is gone.
    s.run(1.0, |i| i < 2);
    let told = s.replicas[back].notes.join("\n");
    assert!(told.contains("'person 2' is here already"), "{told}");
    s.run(4.0, |_| true);
    s.run(3.0, |_| false);
    s.verify();
    assert_eq!((s.replicas[back].station.person(), s.replicas[back].refused.clone()), (3, None));
}

#[test]
fn who_is_cut_off_right_after_entering_counts_its_own_input() {
    let mut s = Simulation::new(13, GOOD);
    // The checkpoint of the one before is given to the next one, too.
    s.join_sculptor();
    s.run(3.0, |_| true);
    let late = s.join_sculptor();
    while !s.replicas[late].station.follows() {
        s.run(0.004, |i| i == 0);
    }
    let station = &s.replicas[late].station;
    assert!(station.log().person(station.person()).is_none(), "the frame of its arrival is late");
    s.replicas[late].part = 1;
    s.run(5.0, |i| i == late);
    s.run(1.0, |_| false);
    let station = &s.replicas[late].station;
    assert!(station.hosts() && station.outbox().last() > 100);
    assert_eq!(station.waiting(), 0, "all of it is ordered");
    s.replicas[late].part = 0;
    s.run(4.0, |_| true);
    s.run(4.0, |_| false);
    s.verify();
}
