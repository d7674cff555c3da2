//! Members who are invited, withdrawn and expire while a sculpture is shared; two sculptures of one
//! name; messages that were recorded, changed or made up.

use sculptd_network::core::short_number;
use sculptd_network::keyring::fresh;
use sculptd_network::wire::frame::Role;
use sculptd_network::wire::greeting::{Greeting, Hello, VERSION};

use crate::attacks::Recorded;
use crate::faults::long;
use crate::simulated::{BAD, EPOCH_S, Faults, GOOD, Random, Simulation, undo};

fn refused(s: &Simulation, i: usize) -> String {
    s.replicas[i].refused.clone().unwrap_or_default()
}

fn told(s: &Simulation, i: usize) -> String {
    s.replicas[i].notes.join("\n")
}

/// Ada hosts, Bob has an invitation of his own, Cy the common one.
fn three(seed: u64) -> (Simulation, usize, usize) {
    let mut s = Simulation::new(seed, GOOD);
    let of_bob = s.invite("Bob", Role::Sculptor, None);
    let (members, now) = (s.members(2), s.now_us);
    s.replicas[0].station.take_members(members, now);
    let bob = s.join("Bob", Role::Sculptor, of_bob);
    let cy = s.join_sculptor();
    s.run(3.0, |_| true);
    assert!(s.replicas[1..].iter().all(|r| r.station.follows()), "{}", told(&s, bob));
    (s, bob, cy)
}

fn withdraw_bob(s: &mut Simulation, through: usize) {
    s.invitations.retain(|i| i.name.as_deref() != Some("Bob"));
    let (members, now) = (s.members(3), s.now_us);
    s.replicas[through].station.take_members(members, now);
}

#[test]
fn who_is_withdrawn_is_out_within_two_seconds_and_stays_out_under_a_successor() {
    let (mut s, bob, cy) = three(61);
    let (key, at) = (s.invitations[3].clone(), s.now_us);
    withdraw_bob(&mut s, 0);
    while refused(&s, bob).is_empty() {
        s.run(0.02, |_| true);
        assert!(s.now_us < at + 2_000_000, "Bob is still here");
    }
    assert!(refused(&s, bob).contains("withdrawn"), "{}", refused(&s, bob));
    // What did not reach the others is counted once, and taken once.
    let station = &mut s.replicas[bob].station;
    let (before, now) = (station.waiting(), at + 2_000_000);
    (0..3).for_each(|_| station.submit(vec![], undo(), now));
    assert_eq!(station.waiting(), before + 3);
    assert!(station.take_unstepped().len() as u64 >= before + 3);
    assert_eq!((station.waiting(), station.take_unstepped().len()), (0, 0));
    s.run(1.0, |i| i != bob);
    // Cy has the new list and takes over; Bob's key opens nothing there either.
    s.replicas[0].alive = false;
    s.run(4.0, |i| i != bob);
    assert_eq!(s.host(), Some(cy), "{}", told(&s, cy));
    let again = s.join("Bob", Role::Sculptor, key.clone());
    let as_other = s.join("Dan", Role::Sculptor, key);
    s.run(4.0, |i| i == cy);
    for i in [again, as_other] {
        assert!(!s.replicas[i].station.follows() && s.replicas[i].world.is_none());
        assert!(told(&s, i).contains("was withdrawn"), "{}", told(&s, i));
    }
}

#[test]
fn a_withdrawn_sculptor_is_no_host_to_anybody_who_has_the_new_list() {
    let (mut s, bob, cy) = three(62);
    // Bob is cut off, goes on alone as a host, and is withdrawn meanwhile.
    s.replicas[bob].part = 1;
    s.run(6.0, |_| true);
    assert!(s.replicas[bob].station.hosts());
    withdraw_bob(&mut s, 0);
    s.run(2.0, |_| true);
    s.replicas[bob].part = 0;
    s.run(6.0, |_| true);
    assert!(s.replicas[0].station.hosts() || s.replicas[cy].station.hosts());
    assert!(!s.replicas[bob].station.follows());
    // Who comes now is with Ada: only she has the newest list.
    let dan = s.join_sculptor();
    s.run(3.0, |i| i != bob);
    s.run(3.0, |_| false);
    assert!(s.replicas[dan].station.follows());
    s.replicas[bob].alive = false;
    s.verify_worlds();
}

#[test]
fn the_owner_withdraws_while_another_hosts() {
    let (mut s, bob, cy) = three(63);
    // Ada's daemon dies; Cy or Bob takes over; she comes back as a member.
    s.replicas[0].alive = false;
    s.run(4.0, |_| true);
    let ada = s.join_or_host("person 0");
    s.run(4.0, |_| true);
    assert!(s.replicas[ada].station.follows(), "{}", told(&s, ada));
    withdraw_bob(&mut s, ada);
    s.run(5.0, |_| true);
    assert!(refused(&s, bob).contains("withdrawn"), "{}", told(&s, bob));
    assert!(s.replicas[cy].station.follows() || s.replicas[cy].station.hosts());
    s.replicas[bob].alive = false;
    s.run(3.0, |_| true);
    s.run(4.0, |_| false);
    s.verify_worlds();
}

#[test]
fn an_invitation_ends_at_its_time() {
    let mut s = Simulation::new(64, GOOD);
    let until = EPOCH_S + s.now_us / 1_000_000 + 5;
    let guests = s.invite("Guest", Role::Viewer, Some(until));
    let (members, now) = (s.members(2), s.now_us);
    s.replicas[0].station.take_members(members, now);
    let guest = s.join("Guest", Role::Viewer, guests.clone());
    s.run(3.0, |i| i == 0);
    assert!(s.replicas[guest].station.follows(), "{}", told(&s, guest));
    s.run(3.5, |i| i == 0);
    assert!(refused(&s, guest).contains("expired"), "{}", refused(&s, guest));
    let again = s.join("Guest", Role::Viewer, guests);
    s.run(2.0, |i| i == 0);
    assert!(!s.replicas[again].station.follows());
    assert!(refused(&s, again).contains("expired"), "{}", told(&s, again));
}

#[test]
fn a_host_that_is_started_again_joins_its_own_sculpture() {
    let mut s = Simulation::new(65, GOOD);
    let bob = s.join_sculptor();
    s.run(3.0, |_| true);
    s.replicas[0].alive = false;
    s.run(3.0, |_| true);
    assert!(s.replicas[bob].station.hosts());
    let again = s.join_or_host("person 0");
    s.run(3.0, |_| true);
    s.run(3.0, |_| false);
    assert!(s.replicas[again].station.follows(), "{}", told(&s, again));
    s.verify();
}

#[test]
fn a_host_that_is_started_again_at_once_joins_its_own_sculpture() {
    for step in (0..20).step_by(20 / long("SCULPTD_NETWORK_HOSTS", 4).min(20) as usize) {
        // A chunk of a checkpoint that is lost would hold up a newcomer for ten seconds.
        let far = Faults { loss: 0.0, ..BAD };
        let mut s = Simulation::new(670 + step, if step % 2 == 0 { GOOD } else { far });
        s.join_sculptor();
        s.join_sculptor();
        s.run(8.0, |_| true);
        s.replicas[0].alive = false;
        s.run(0.1 * step as f64, |_| true);
        let again = s.join_or_host("person 0");
        s.run(10.0, |_| true);
        s.run(8.0, |_| false);
        let hosts = s.replicas.iter().filter(|r| r.alive && r.station.hosts()).count();
        assert_eq!(hosts, 1, "step {step}: {}", told(&s, again));
        assert!(s.replicas[again].station.follows(), "step {step}: {}", told(&s, again));
        s.verify_worlds();
    }
}

#[test]
fn of_two_who_begin_at_once_one_hosts() {
    for seed in 0..long("SCULPTD_NETWORK_HOSTS", 4) {
        let mut s = Simulation::new(700 + seed, if seed % 2 == 0 { GOOD } else { BAD });
        // The first is not there.
        s.replicas[0].alive = false;
        let one = s.join_or_host("one");
        s.run(0.07 * seed as f64, |_| false);
        let two = s.join_or_host("two");
        s.run(9.0, |_| true);
        s.run(5.0, |_| false);
        let hosts = [one, two].iter().filter(|i| s.replicas[**i].station.hosts()).count();
        assert_eq!(hosts, 1, "seed {seed}: {} | {}", told(&s, one), told(&s, two));
        s.replicas.remove(0);
        s.verify_worlds();
    }
}

#[test]
fn two_sculptures_of_one_name_are_told_apart_and_a_newcomer_is_asked() {
    let mut s = Simulation::new(66, GOOD);
    let bob = s.join_sculptor();
    s.run(3.0, |i| i == 0);
    let other = s.host_another("Eve");
    s.run(3.0, |_| false);
    for i in [0, other] {
        assert!(told(&s, i).contains("two sculptures are shared under this name"), "{i}");
        assert_eq!(s.replicas[i].station.others().len(), 1);
    }
    let number = short_number(s.replicas[0].station.sculpture());
    let newcomer = s.join_sculptor();
    s.run(2.0, |_| false);
    let why = refused(&s, newcomer);
    assert!(why.contains("2 sculptures") && why.contains("2 people"), "{why}");
    assert!(why.contains(&format!("{number:08x}")) && why.contains("1 person"), "{why}");
    // Bob belongs to the first, whichever answers him.
    let now = s.now_us;
    s.replicas[bob].station.restore_failed(now);
    s.run(3.0, |_| false);
    assert_eq!(s.replicas[bob].station.sculpture(), s.replicas[0].station.sculpture());
}

#[test]
fn a_split_between_a_new_list_and_an_old_one_heals() {
    let (mut s, _, cy) = three(67);
    s.replicas[cy].part = 1;
    s.run(6.0, |_| true);
    assert!(s.replicas[cy].station.hosts());
    // The key of the group is drawn anew on one side.
    withdraw_bob(&mut s, 0);
    s.run(2.0, |_| true);
    s.replicas[cy].part = 0;
    s.run(4.0, |_| true);
    s.run(4.0, |_| false);
    assert_eq!(s.replicas.iter().filter(|r| r.station.hosts()).count(), 1);
    s.replicas[1].alive = false;
    s.verify();
}

/// Every datagram that was ever sent comes again, to everybody, while the host dies.
#[test]
fn recorded_messages_stop_no_election_and_change_nothing() {
    for seed in 0..long("SCULPTD_NETWORK_REPLAYS", 1) {
        let mut s = Simulation::new(80 + seed, GOOD);
        s.tape = Some(Vec::new());
        s.join_sculptor();
        s.join_sculptor();
        s.run(3.0, |_| true);
        // An election and a successor are on the tape, too.
        s.replicas[0].alive = false;
        s.run(4.0, |_| true);
        let first = s.host().expect("a successor");
        let back = s.join("person 0", Role::Sculptor, s.of_owner());
        s.run(4.0, |_| true);
        assert!(s.replicas[back].station.follows(), "{}", told(&s, back));
        let tape = s.tape.take().unwrap_or_default();
        let kinds: std::collections::BTreeSet<u8> = tape.iter().map(|t| t.bytes[0]).collect();
        assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [0, 1, 2, 3], "every kind");
        s.replicas[first].alive = false;
        let (at, mut next, lively) = (s.now_us, 0, [1, 2, back]);
        while s.host().is_none() {
            for _ in 0..200 {
                let bytes = &tape[next % tape.len()].bytes;
                lively.iter().for_each(|i| s.inject(*i, bytes));
                next += 1;
            }
            s.run(0.004, |_| true);
            assert!(s.now_us < at + 2_000_000, "seed {seed}: nobody took over");
        }
        for round in 0..1000 {
            for k in 0..20 {
                let bytes = &tape[(round * 20 + k) % tape.len()].bytes;
                lively.iter().for_each(|i| s.inject(*i, bytes));
            }
            s.run(0.004, |_| true);
        }
        s.run(4.0, |_| false);
        s.verify_worlds();
    }
}

/// A message of each kind with one bit changed, and made up under the name of another.
#[test]
fn forged_messages_change_nothing() {
    let mut s = Simulation::new(90, GOOD);
    s.tape = Some(Vec::new());
    s.join_sculptor();
    s.run(3.0, |_| true);
    let tape = s.tape.take().unwrap_or_default();
    let mut random = Random(5);
    for round in 0..2000 {
        let Recorded { to, bytes, .. } = &tape[random.next() as usize % tape.len()];
        let mut bytes = bytes.clone();
        match round % 3 {
            0 => {
                let at = random.next() as usize % bytes.len();
                bytes[at] ^= 1 << (random.next() % 8);
            }
            1 => bytes[1..9].copy_from_slice(&s.replicas[0].station.address().to_le_bytes()),
            _ => {
                let at = 9.min(bytes.len() - 1);
                bytes[at..].iter_mut().for_each(|b| *b = random.next() as u8);
            }
        }
        s.inject(*to, &bytes);
        s.run(0.004, |_| true);
    }
    s.run(3.0, |_| false);
    s.verify();
    assert!(s.replicas.iter().all(|r| r.refused.is_none()));
}

#[test]
fn junk_greetings_keep_nobody_out() {
    let mut s = Simulation::new(91, GOOD);
    s.run(1.0, |_| true);
    let known = s.invitations[0].secret.public().name();
    let mut random = Random(6);
    let guest = s.join_sculptor();
    let at = s.now_us;
    while !s.replicas[guest].station.follows() {
        // Thousands a second: of unknown keys, and of a key that was seen, with a wrong signature.
        for k in 0..8 {
            let mut entropy = Random::entropy(random.next());
            let (mut nonce, mut value, mut key) = ([0; 16], [0; 32], [0; 8]);
            entropy(&mut nonce);
            entropy(&mut value);
            entropy(&mut key);
            let key = if k % 2 == 0 { key } else { known };
            let signature = fresh(&mut entropy).sign("sculptd hello 2", &value);
            let hello = Hello { version: VERSION, nonce, value, key, claims: false, signature };
            let mut bytes = vec![0];
            bytes.extend(random.next().to_le_bytes());
            bytes.extend(Greeting::Hello(hello).to_bytes());
            s.inject(0, &bytes);
        }
        s.run(0.004, |_| true);
        assert!(s.now_us < at + 4_000_000, "{}", told(&s, guest));
    }
    println!("let in after {:.2} s of junk", (s.now_us - at) as f64 / 1e6);
    s.run(3.0, |_| false);
    s.verify();
}
