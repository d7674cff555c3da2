//! The people present, and undo of a person's steps, the same in every replica.

use crate::simulated::{BAD, Faults, GOOD, Random, Simulation};
use sculptd_engine::command::Command;
use sculptd_network::wire::frame::Frame;
use std::sync::Arc;

/// Returns the names of the people present, from a replica's log.
fn here(s: &Simulation, replica: usize) -> Vec<String> {
    s.replicas[replica].station.log().here().map(|a| a.name.clone()).collect()
}

#[test]
fn everybody_knows_who_is_here_and_who_has_gone() {
    let mut s = Simulation::new(61, GOOD);
    let (bob, cyd) = (s.join_sculptor(), s.join_sculptor());
    s.run(2.0, |_| false);
    for replica in [0, bob, cyd] {
        assert_eq!(here(&s, replica), ["person 0", "person 1", "person 2"]);
    }
    // One says goodbye in the middle of a stroke, and is killed afterwards.
    s.stroke_s = 1e6;
    s.run(0.5, |i| i == cyd);
    let rests = |s: &Simulation| s.replicas[0].world.as_ref().is_some_and(|w| w.is_at_rest());
    assert!(!rests(&s));
    s.replicas[cyd].station.leave();
    s.run(0.02, |_| false);
    s.replicas[cyd].alive = false;
    s.run(6.0, |_| false);
    assert_eq!(here(&s, 0), ["person 0", "person 1"]);
    assert_eq!(here(&s, bob), here(&s, 0));
    assert!(rests(&s), "a pen that is gone is lifted");
    // The same person comes back.
    let key = s.invitations[0].clone();
    let again = s.join("person 2", sculptd_network::wire::frame::Role::Sculptor, key);
    s.run(2.0, |_| false);
    for replica in [0, bob, again] {
        assert_eq!(here(&s, replica), ["person 0", "person 1", "person 2"]);
        assert_eq!(s.replicas[replica].station.log().people().len(), 3, "with the same number");
    }
    // The host is killed: its successor tells that it is gone.
    s.replicas[0].alive = false;
    s.run(12.0, |_| false);
    for replica in [bob, again] {
        assert_eq!(here(&s, replica), ["person 1", "person 2"]);
    }
}

#[test]
fn who_was_killed_in_a_stroke_and_is_back_has_no_pen_on_the_clay() {
    let mut s = Simulation::new(64, GOOD);
    let bob = s.join_sculptor();
    s.run(2.0, |_| false);
    s.stroke_s = 1e6;
    s.run(0.5, |i| i == bob);
    s.replicas[bob].alive = false;
    // The newest checkpoint is given to whoever comes within the next seconds: none is made.
    s.run(2.5, |_| false);
    let rests = |s: &Simulation| s.replicas[0].world.as_ref().is_some_and(|w| w.is_at_rest());
    assert!(!rests(&s));
    let key = s.invitations[0].clone();
    let again = s.join("person 1", sculptd_network::wire::frame::Role::Sculptor, key);
    s.run(1.0, |_| false);
    assert!(s.replicas[again].station.follows());
    assert!(rests(&s), "the pen of the process that was killed is lifted");
    assert_eq!(here(&s, 0), ["person 0", "person 1"]);
    s.stroke_s = 0.3;
    s.run(2.0, |i| i == again);
    s.run(2.0, |_| false);
    s.verify();
}

#[test]
fn a_result_that_was_computed_among_strokes_of_others_still_fits() {
    let mut s = Simulation::new(65, GOOD);
    let (bob, cyd) = (s.join_sculptor(), s.join_sculptor());
    s.run(2.0, |_| false);
    s.stroke_s = 1e6;
    s.run(0.5, |i| i != bob);
    let from = s.replicas[0].station.log().last() + 1;
    let now_us = s.now_us;
    s.replicas[bob].station.submit(vec![], vec![Command::LiftAll], now_us);
    s.run(0.2, |i| i != bob);
    let now_us = s.now_us;
    s.replicas[bob].station.submit(vec![], vec![Command::Undo], now_us);
    s.run(0.3, |i| i != bob);
    let person = s.replicas[bob].station.person();
    let frames = s.replicas[0].station.log().from(from, 1000).expect("kept");
    let of_bob = |f: &Arc<Frame>| f.batches.iter().any(|b| b.person == person);
    let at: Vec<usize> = (0..frames.len()).filter(|k| of_bob(&frames[*k])).collect();
    assert_eq!(at.len(), 2, "the command that holds, and the result");
    assert!(at[1] > at[0] + 10, "a network takes its time");
    let others = |frames: &[_]| {
        let batches = |f: &Arc<Frame>| f.batches.len();
        frames.iter().map(batches).sum::<usize>()
    };
    assert_eq!(others(&frames[at[0] + 1..at[1]]), 0, "what the others do waits");
    assert!(others(&frames[..at[0]]) > 5 && others(&frames[at[1] + 1..]) > 30);
    s.run(2.0, |_| false);
    s.verify();
    for i in [0, cyd] {
        assert_eq!(s.replicas[i].station.waiting(), 0, "and none of it is lost");
    }
}

/// Strokes, undo and redo of four people, of whom one comes late.
fn taken_back(faults: Faults, seed: u64) {
    let mut s = Simulation::new(seed, faults);
    s.stroke_s = 0.3;
    s.join_sculptor();
    s.join_sculptor();
    s.run(6.0, |_| false);
    let mut random = Random(seed);
    let mut changed = 0;
    for round in 0..40 {
        if round == 15 {
            s.join_sculptor();
        }
        let sculpts = random.next();
        s.run(0.3 + 0.5 * random.share(), |i| sculpts >> i & 1 == 1);
        let before = s.replicas[0].world.as_ref().map(|w| w.hash());
        for i in 0..s.replicas.len() {
            let way = match random.next() % 4 {
                0 | 1 => Command::Undo,
                2 => Command::Redo,
                _ => continue,
            };
            let now = s.now_us;
            s.replicas[i].station.submit(vec![], vec![way], now);
        }
        s.run(0.2, |_| false);
        changed += usize::from(s.replicas[0].world.as_ref().map(|w| w.hash()) != before);
    }
    s.run(10.0, |_| false);
    s.verify();
    assert!(changed > 5, "{changed} rounds changed something");
    for r in &s.replicas {
        let world = r.world.as_ref().expect("a world");
        world.verify_invariants().expect("sound");
        world.mesh().verify_invariants().expect("sound");
        assert!(r.hashes.len() > 5, "{} comparisons", r.hashes.len());
    }
}

#[test]
fn undo_of_ones_own_is_the_same_in_every_replica() {
    taken_back(GOOD, 62);
    taken_back(BAD, 63);
}
