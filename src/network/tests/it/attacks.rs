//! Somebody on the network who has no key, hears everything and sends what he likes; and a table of
//! every kind of message and everything that he can do with it.

use std::collections::BTreeMap;

use sculptd_network::wire::frame::{PersonId, Role};
use sculptd_network::wire::greeting::{Greeting, Refusal};
use sculptd_network::wire::keys::PublicKey;
use sculptd_network::wire::message::{Address, FromHost, FromMember, HeirsWord, Nonce};

use crate::faults::long;
use crate::simulated::{EPOCH_S, GOOD, Random, Replica, Simulation, ball};

/// A datagram that was sent, to whom, and what was in it.
#[derive(Debug, Clone)]
pub struct Recorded {
    pub to: usize,
    pub kind: &'static str,
    pub bytes: Vec<u8>,
}

/// An attack on the messages of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attack {
    /// Each comes again later, to its receiver and to the others.
    Replay,
    /// Each is held back at random, so that later ones overtake it.
    Reorder,
    /// With a bit changed, under another name, cut, or with other content; and each greeting is
    /// refused at once in the host's name.
    Forge,
    /// All of these, some thousands a second.
    Flood,
}

/// The kind of a refused greeting: see [`Greeting::KINDS`].
const REFUSED: &str = Greeting::KINDS[2];

const ATTACKS: [Attack; 4] = [Attack::Replay, Attack::Reorder, Attack::Forge, Attack::Flood];

#[derive(Debug)]
pub struct Attacker {
    /// Of the messages that he attacks; `None`: all.
    kind: Option<&'static str>,
    attack: Attack,
    heard: Vec<(usize, Vec<u8>)>,
    /// Greetings that he has not refused yet: from whom, and their nonces.
    greeted: Vec<(Address, Nonce)>,
    /// The key of a host, from its answers.
    host: PublicKey,
    random: Random,
    injected: usize,
}

impl Attacker {
    fn new(kind: Option<&'static str>, attack: Attack, seed: u64) -> Attacker {
        let (heard, greeted, host) = (Vec::new(), Vec::new(), PublicKey([0; 32]));
        Attacker { kind, attack, heard, greeted, host, random: Random(seed), injected: 0 }
    }

    /// Hears a datagram that is sent. Returns for how long he holds it back.
    pub fn hears(&mut self, to: usize, kind: &'static str, bytes: &[u8]) -> u64 {
        let forges = matches!(self.attack, Attack::Forge | Attack::Flood);
        if forges && self.kind.is_none_or(|own| own == REFUSED) {
            self.hears_greeting(bytes);
        }
        if self.kind.is_some_and(|own| own != kind) {
            return 0;
        }
        if self.attack == Attack::Reorder {
            let held = self.injected == 0 || self.random.next().is_multiple_of(2);
            self.injected += usize::from(held);
            return if held { self.random.next() % 120_000 } else { 0 };
        }
        self.heard.push((to, bytes.to_vec()));
        0
    }

    fn hears_greeting(&mut self, bytes: &[u8]) {
        let Some((&[0, from @ ..], greeting)) = bytes.split_first_chunk::<9>() else { return };
        match Greeting::from_bytes(greeting) {
            Ok(Greeting::Hello(hello)) => {
                self.greeted.push((Address::from_le_bytes(from), hello.nonce));
            }
            Ok(Greeting::Challenge(challenge)) => self.host = challenge.host,
            _ => {}
        }
    }

    /// Refuses all greetings that he has heard, in the host's name.
    fn refuse(&mut self, replicas: &[Replica]) -> Vec<(usize, Vec<u8>)> {
        let mut out = Vec::new();
        for (from, to) in std::mem::take(&mut self.greeted) {
            let reason = "the key is not one of this sculpture, or was withdrawn".into();
            let mut signature = [0; 64];
            signature.iter_mut().for_each(|b| *b = self.random.next() as u8);
            let refusal = Refusal { to, reason, host: self.host, signature };
            let forged = Greeting::Refused(Box::new(refusal)).to_bytes();
            let sender = replicas[self.random.next() as usize % replicas.len()].station.address();
            let bytes = [&[0][..], &sender.to_le_bytes(), &forged].concat();
            let receiver = replicas.iter().position(|r| r.alive && r.station.address() == from);
            out.extend(receiver.map(|receiver| (receiver, bytes)));
        }
        out
    }

    /// Returns the receivers and datagrams of a step.
    pub fn step(&mut self, replicas: &[Replica]) -> Vec<(usize, Vec<u8>)> {
        let mut out = self.refuse(replicas);
        self.injected += out.len();
        if self.heard.is_empty() {
            return out;
        }
        let (count, refused) = (if self.attack == Attack::Flood { 12 } else { 2 }, out.len());
        for k in 0..count {
            let (to, bytes) = &self.heard[self.random.next() as usize % self.heard.len()];
            let forges = match self.attack {
                Attack::Forge => true,
                Attack::Flood => k % 2 == 0,
                _ => false,
            };
            if forges {
                let forged = forged(bytes.clone(), replicas, &mut self.random);
                out.push((*to, forged));
            } else {
                let other = self.random.next() as usize % replicas.len();
                out.push((*to, bytes.clone()));
                out.push((other, bytes.clone()));
            }
        }
        self.injected += out.len() - refused;
        out
    }
}

fn forged(mut bytes: Vec<u8>, replicas: &[Replica], random: &mut Random) -> Vec<u8> {
    let at = |random: &mut Random, n: usize| random.next() as usize % n.max(1);
    match random.next() % 4 {
        0 => {
            let at = at(random, bytes.len());
            bytes[at] ^= 1 << (random.next() % 8);
        }
        1 => {
            let other = &replicas[at(random, replicas.len())];
            bytes[1..9].copy_from_slice(&other.station.address().to_le_bytes());
            // Its own name would make it the very message again.
            let last = bytes.len() - 1;
            bytes[last] ^= 1;
        }
        2 => bytes.truncate(at(random, bytes.len())),
        _ => {
            let from = 9.min(bytes.len() - 1);
            bytes[from..].iter_mut().for_each(|b| *b = random.next() as u8);
        }
    }
    bytes
}

/// The state after an afternoon.
#[derive(Debug, PartialEq, Eq)]
struct Outcome {
    /// The sculpture of each.
    hashes: Vec<Option<u64>>,
    /// The last applied batch of each person, at each station.
    applied: Vec<BTreeMap<PersonId, u64>>,
    /// The reason for each who was sent away.
    refused: Vec<Option<String>>,
    hosts: Vec<bool>,
    differed: Vec<usize>,
    restored: Vec<usize>,
}

/// An afternoon in which every kind of message is sent: people come, are invited, withdrawn and
/// refused, one differs and joins again, one leaves, the host is killed, the owner comes back and
/// brings a new list. Returns the outcome, and the seconds for which nobody hosted.
fn afternoon(s: &mut Simulation) -> (Outcome, f64) {
    let of_bob = s.invite("Bob", Role::Sculptor, None);
    let (members, now) = (s.members(2), s.now_us);
    s.replicas[0].station.take_members(members, now);
    let bob = s.join("Bob", Role::Sculptor, of_bob.clone());
    let cy = s.join_sculptor();
    let di = s.join_sculptor();
    s.run(3.0, |_| true);
    // Bob is withdrawn, and knocks again.
    s.invitations.retain(|i| i.name.as_deref() != Some("Bob"));
    let (members, now) = (s.members(3), s.now_us);
    s.replicas[0].station.take_members(members, now);
    s.run(1.0, |_| true);
    let again = s.join("Bob", Role::Sculptor, of_bob);
    s.run(1.0, |_| true);
    s.replicas[again].alive = false;
    // Di differs.
    let mut broken = ball();
    broken.step(s.replicas[di].world.as_ref().map_or(0, |w| w.tick()), &[], &[]);
    s.replicas[di].world = Some(broken);
    s.run(3.0, |i| i != di);
    // Cy leaves.
    s.replicas[cy].station.leave();
    s.run(0.2, |_| true);
    s.replicas[cy].alive = false;
    let ed = s.join_sculptor();
    s.run(2.0, |_| true);
    // The host is killed.
    s.replicas[0].alive = false;
    let at = s.now_us;
    while s.host().is_none() && s.now_us < at + 4_000_000 {
        s.run(0.01, |_| true);
    }
    let without_host_s = (s.now_us - at) as f64 / 1e6;
    s.run(1.0, |_| true);
    // The owner comes back and invites somebody.
    let owner = s.join_or_host("person 0");
    s.run(3.0, |_| true);
    s.invite("Flo", Role::Viewer, Some(EPOCH_S + 3600));
    let (members, now) = (s.members(4), s.now_us);
    s.replicas[owner].station.take_members(members, now);
    s.run(2.0, |_| true);
    s.run(4.0, |_| false);
    for i in [bob, cy, again] {
        s.replicas[i].alive = false;
    }
    let all = [bob, cy, di, again, ed, owner].map(|i| &s.replicas[i]);
    let outcome = Outcome {
        hashes: all.iter().map(|r| r.world.as_ref().map(|w| w.hash())).collect(),
        applied: all
            .iter()
            .map(|r| r.station.log().people().into_iter().map(|(p, n)| (p.person, n)).collect())
            .collect(),
        refused: all.iter().map(|r| r.refused.clone()).collect(),
        hosts: all.iter().map(|r| r.station.hosts()).collect(),
        differed: all.iter().map(|r| r.differed).collect(),
        restored: all.iter().map(|r| r.restored).collect(),
    };
    s.replicas.iter_mut().for_each(|r| r.differed = 0);
    s.verify_worlds();
    (outcome, without_host_s)
}

/// Compares the state after an attack with the expected one. Returns the faults.
fn refusals(kind: &str, attack: Attack, got: &(Outcome, f64), expected: &Outcome) -> Vec<String> {
    let mut out = Vec::new();
    let (outcome, without_host_s) = got;
    if *without_host_s > 2.0 {
        out.push(format!("{kind} {attack:?}: nobody hosted for {without_host_s} s"));
    }
    let facts = |o: &Outcome| (o.refused.clone(), o.differed.clone(), o.restored.clone());
    if facts(outcome) != facts(expected) {
        out.push(format!("{kind} {attack:?}: {:?}", facts(outcome)));
    }
    // Delays, and questions to the host, move input by a tick. Other attacks change no bit.
    let is_exact = matches!(attack, Attack::Replay | Attack::Forge) && kind != "host";
    if is_exact && outcome != expected {
        out.push(format!("{kind} {attack:?}: {outcome:?}"));
    }
    out
}

#[test]
fn a_flood_of_all_that_was_ever_said_changes_nothing() {
    let (expected, _) = afternoon(&mut Simulation::new(7000, GOOD));
    let mut s = Simulation::new(7000, GOOD);
    s.attacker = Some(Attacker::new(None, Attack::Flood, 1));
    let got = afternoon(&mut s);
    let injected = s.attacker.as_ref().map_or(0, |a| a.injected);
    println!("{injected} messages, {:.2} s without a host", got.1);
    assert!(injected > 50_000);
    assert_eq!(refusals("all", Attack::Flood, &got, &expected), [""; 0]);
}

/// A table of every kind of message and every attack: nothing is accepted that its sender has not
/// sent just now, and a dead host is followed within two seconds. A seed takes four minutes.
#[test]
fn each_kind_of_message_replayed_reordered_forged_and_flooding_changes_nothing() {
    let kinds: Vec<&str> = Greeting::KINDS
        .into_iter()
        .chain(FromMember::KINDS)
        .chain(FromHost::KINDS)
        .chain(HeirsWord::KINDS)
        .collect();
    for seed in 0..long("SCULPTD_NETWORK_ATTACKS", 0) {
        let mut s = Simulation::new(7000 + seed, GOOD);
        s.tape = Some(Vec::new());
        let (expected, without_host_s) = afternoon(&mut s);
        let tape = s.tape.take().unwrap_or_default();
        println!("seed {seed}: {without_host_s:.2} s without a host, {expected:?}");
        println!("| message | sent | {ATTACKS:?}: sent by the attacker, s without a host |");
        let mut all = Vec::new();
        for kind in &kinds {
            let sent = tape.iter().filter(|r| r.kind == *kind).count();
            assert!(sent > 0, "no '{kind}' was sent");
            let mut row = format!("| {kind} | {sent} |");
            for attack in ATTACKS {
                let mut s = Simulation::new(7000 + seed, GOOD);
                s.attacker = Some(Attacker::new(Some(kind), attack, seed));
                let got = afternoon(&mut s);
                let injected = s.attacker.as_ref().map_or(0, |a| a.injected);
                row.push_str(&format!(" {injected}, {:.2} |", got.1));
                all.extend(refusals(kind, attack, &got, &expected));
            }
            println!("{row}");
        }
        assert!(all.is_empty(), "seed {seed}: {all:#?}");
    }
}
