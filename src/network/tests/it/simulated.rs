//! Stations around worlds, and a network between them that is moved by hand.

use std::collections::{BTreeMap, VecDeque};

use glam::Vec2;
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::checkpoint::Restoring;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::scene::KnownHashes;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;
use sculptd_network::core::{Event, Outgoing, To};
use sculptd_network::executor::Executor;
use sculptd_network::keyring::{Entropy, Invitation, fresh};
use sculptd_network::local_echo::LocalEcho;
use sculptd_network::membership::{Membership, SignedMembership};
use sculptd_network::seal::Secret;
use sculptd_network::station::{Identity, Station};
use sculptd_network::wire::frame::{Batch, Frame, Mark, Role};
use sculptd_network::wire::samples::rounded;

use crate::attacks::{Attacker, Recorded};

pub const RATE: u32 = 120;
/// Seconds since 1970 at the beginning.
pub const EPOCH_S: u64 = 1_800_000_000;
/// Microseconds that a step of the simulation takes.
pub const STEP_US: u64 = 4_000;

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 to 1.
    pub fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn entropy(seed: u64) -> Entropy {
        let mut random = Random(seed);
        Box::new(move |bytes| bytes.iter_mut().for_each(|b| *b = random.next() as u8))
    }
}

/// Faults of a network's datagrams.
#[derive(Debug, Clone, Copy, Default)]
pub struct Faults {
    pub delay_us: u64,
    pub loss: f64,
    /// The share of datagrams that come up to as late again.
    pub reorder: f64,
    pub twice: f64,
}

/// As the issue asks for.
pub const BAD: Faults = Faults { delay_us: 200_000, loss: 0.01, reorder: 0.02, twice: 0.005 };
pub const GOOD: Faults = Faults { delay_us: 500, loss: 0.0, reorder: 0.0, twice: 0.0 };

/// One daemon.
pub struct Replica {
    pub station: Station,
    pub world: Option<World>,
    pub executor: Executor,
    pub known: KnownHashes,
    /// Parts of its checkpoints that another thread would still be making.
    making: VecDeque<(u64, Vec<u8>, bool)>,
    restoring: Restoring,
    /// Shows the local strokes before they are ordered; `None`: without.
    pub echo: Option<LocalEcho>,
    /// Ticks with a tip down in which the world that was shown moved, and in which it did not.
    pub shown: (u64, u64),
    /// A world that nobody shares, which takes the same strokes, and the same count of it.
    pub alone: (World, (u64, u64)),
    pub alive: bool,
    /// Nothing comes to it or from it.
    pub cut_off: bool,
    /// Of a network that is split, the part it is in.
    pub part: u8,
    pub notes: Vec<String>,
    pub refused: Option<String>,
    pub differed: usize,
    pub restored: usize,
    /// Bytes sent and received.
    pub bytes: (u64, u64),
    /// Samples with another tip than the one before that were given.
    pub transitions_given: u64,
    /// The hash after each frame that was compared.
    pub hashes: BTreeMap<u64, u64>,
    tip: bool,
}

pub struct Simulation {
    pub replicas: Vec<Replica>,
    pub now_us: u64,
    pub faults: Faults,
    pub owner: Secret,
    /// One for each role: sculptor, viewer, device.
    pub invitations: Vec<Invitation>,
    random: Random,
    seed: u64,
    air: BTreeMap<(u64, u64), (usize, Vec<u8>)>,
    sent: u64,
    /// Every datagram that was sent, and to whom, while it is `Some`.
    pub tape: Option<Vec<Recorded>>,
    /// Somebody on the network who has no key.
    pub attacker: Option<Attacker>,
    /// Transitions that were stepped, by person, on the log of the first replica that stepped them.
    pub stroke_s: f64,
}

pub fn ball() -> World {
    let mesh = Clay::build(&shapes::sphere_of_about(1500), &Job::default()).expect("a ball");
    let options =
        WorldOptions { dab_budget: 400_000, undo_bytes: 64 << 20, hands: HandSettings::default() };
    World::new(mesh, Camera::default(), BrushSettings::default(), Workers::new(1), options)
}

impl Simulation {
    /// A host, and nobody else yet.
    pub fn new(seed: u64, faults: Faults) -> Simulation {
        let mut entropy = Random::entropy(seed ^ 0xabcd);
        let owner = fresh(&mut entropy);
        let of = |role| Invitation {
            role,
            name: None,
            expires_s: None,
            secret: fresh(&mut entropy),
            owner: owner.public(),
        };
        let invitations = [Role::Sculptor, Role::Viewer, Role::Device].map(of).to_vec();
        let mut simulation = Simulation {
            replicas: Vec::new(),
            now_us: 1_000_000,
            faults,
            owner: owner.clone(),
            invitations,
            random: Random(seed),
            seed,
            air: BTreeMap::new(),
            sent: 0,
            tape: None,
            attacker: None,
            stroke_s: 0.8,
        };
        let identity = simulation.identity("person 0", Role::Sculptor, simulation.of_owner());
        let (world, members) = (ball(), simulation.members(1));
        let station = Station::host(identity, members, RATE, world.tick(), simulation.now_us);
        simulation.add(station, Some(world));
        simulation
    }

    pub fn identity(&self, name: &str, role: Role, invitation: Invitation) -> Identity {
        let entropy =
            Random::entropy(self.seed.wrapping_mul(1000) + self.replicas.len() as u64 + 1);
        Identity { name: name.into(), role, invitation, epoch_s: EPOCH_S, entropy }
    }

    /// The owner's own key.
    pub fn of_owner(&self) -> Invitation {
        let (secret, owner) = (self.owner.clone(), self.owner.public());
        Invitation { role: Role::Sculptor, name: None, expires_s: None, secret, owner }
    }

    /// The list of all invitations, signed.
    pub fn members(&self, version: u64) -> SignedMembership {
        let keys = self.invitations.iter().map(Invitation::member_key).collect();
        Membership { owner: self.owner.public(), version, keys }.signed(&self.owner)
    }

    fn add(&mut self, station: Station, world: Option<World>) -> usize {
        self.replicas.push(Replica {
            station,
            world,
            executor: Executor::new(RATE, 0),
            known: KnownHashes::default(),
            making: VecDeque::new(),
            restoring: Restoring::default(),
            echo: None,
            shown: (0, 0),
            alone: (ball(), (0, 0)),
            alive: true,
            cut_off: false,
            part: 0,
            notes: Vec::new(),
            refused: None,
            differed: 0,
            restored: 0,
            bytes: (0, 0),
            transitions_given: 0,
            hashes: BTreeMap::new(),
            tip: false,
        });
        self.replicas.len() - 1
    }

    pub fn join(&mut self, name: &str, role: Role, invitation: Invitation) -> usize {
        let station = Station::join(self.identity(name, role, invitation), None, self.now_us);
        self.add(station, None)
    }

    pub fn join_sculptor(&mut self) -> usize {
        let key = self.invitations[0].clone();
        self.join(&format!("person {}", self.replicas.len()), Role::Sculptor, key)
    }

    /// Another sculpture of the same owner under the same name.
    pub fn host_another(&mut self, name: &str) -> usize {
        let identity = self.identity(name, Role::Sculptor, self.of_owner());
        let (world, members) = (ball(), self.members(1));
        let station = Station::host(identity, members, RATE, world.tick(), self.now_us);
        self.add(station, Some(world))
    }

    /// The owner, who joins whoever hosts and else hosts.
    pub fn join_or_host(&mut self, name: &str) -> usize {
        let identity = self.identity(name, Role::Sculptor, self.of_owner());
        let station = Station::join_or_host(identity, self.now_us);
        self.add(station, None)
    }

    /// An invitation for one person, which is in the list from its next version on.
    pub fn invite(&mut self, name: &str, role: Role, expires_s: Option<u64>) -> Invitation {
        let secret = fresh(&mut Random::entropy(self.seed ^ self.invitations.len() as u64 ^ 0x77));
        let (name, owner) = (Some(name.into()), self.owner.public());
        let invitation = Invitation { role, name, expires_s, secret, owner };
        self.invitations.push(invitation.clone());
        invitation
    }

    pub fn host(&self) -> Option<usize> {
        self.replicas.iter().position(|r| r.alive && !r.cut_off && r.station.hosts())
    }

    /// Draws one stroke and pause after the other, for each replica on a separate part of the ball.
    fn strokes(&mut self, i: usize) {
        let (now, stroke_s) = (self.now_us as f64 / 1e6 + i as f64 * 0.37, self.stroke_s);
        let replica = &mut self.replicas[i];
        let (turn, part) = ((now / (stroke_s + 0.3)).floor(), now % (stroke_s + 0.3));
        let tip = part < stroke_s;
        let angle = part * 4.0 + turn * 1.3 + i as f64;
        let radius = 30.0 + 6.0 * (turn + i as f64).sin();
        let at = Vec2::new(
            (112.0 + radius * angle.cos()) as f32,
            (74.0 + 0.7 * radius * angle.sin()) as f32,
        );
        let pen = Pen {
            in_range: true,
            tip,
            pos_mm: at,
            area_mm: Vec2::new(224.0, 148.0),
            pressure: Some((0.4 + 0.3 * (part * 5.0).sin()) as f32),
            tilt: Some(Vec2::new((part * 0.9).sin() as f32 * 0.3, 0.2)),
            ..Pen::default()
        };
        let sample =
            Sample { device: DeviceId(0), t_us: 0, device_t_us: None, body: Body::Pen(pen) };
        if replica.station.person() != 0 && tip != replica.tip {
            (replica.tip, replica.transitions_given) = (tip, replica.transitions_given + 1);
        }
        let samples: Vec<Sample> = rounded(&sample).into_iter().collect();
        if let (Some(echo), Some(world)) = (&mut replica.echo, &mut replica.world) {
            let hash = |echo: &mut LocalEcho, world: &World| {
                echo.ahead().map_or_else(|| world.hash(), |ahead| ahead.hash())
            };
            let before = hash(echo, world);
            echo.take(world, &samples, &[]);
            let after = hash(echo, world);
            let (alone, counts) = &mut replica.alone;
            let before_alone = alone.hash();
            let (person, number, commands) = (replica.station.person(), 0, Vec::new());
            let batches = vec![Batch { person, number, samples: samples.clone(), commands }];
            let frame = Frame { tick: alone.tick() + 1, batches, ..Frame::default() };
            Executor::new(RATE, person).execute(alone, &frame);
            if tip {
                let count = |counts: &mut (u64, u64), moved| match moved {
                    true => counts.0 += 1,
                    false => counts.1 += 1,
                };
                count(&mut replica.shown, after != before);
                count(counts, alone.hash() != before_alone);
            }
        }
        replica.station.submit(samples, Vec::new(), self.now_us);
    }

    /// Passes time; everybody of `sculpts` sculpts.
    pub fn run(&mut self, seconds: f64, sculpts: impl Fn(usize) -> bool) {
        let until = self.now_us + (seconds * 1e6) as u64;
        while self.now_us < until {
            self.now_us += STEP_US;
            let later = self.air.split_off(&(self.now_us, 0));
            for (_, (to, bytes)) in std::mem::replace(&mut self.air, later) {
                let replica = &mut self.replicas[to];
                if replica.alive && !replica.cut_off {
                    replica.bytes.1 += bytes.len() as u64;
                    replica.station.receive(&bytes, self.now_us);
                }
            }
            self.attack();
            let tick = self.now_us / STEP_US % 2 == 0;
            for i in 0..self.replicas.len() {
                if !self.replicas[i].alive {
                    continue;
                }
                if tick && sculpts(i) {
                    self.strokes(i);
                }
                self.replicas[i].station.advance(self.now_us);
                self.events(i);
                let replica = &mut self.replicas[i];
                if let (true, Some(echo), Some(world)) = (tick, &mut replica.echo, &replica.world) {
                    echo.advance(world);
                }
                while let Some(outgoing) = self.replicas[i].station.take_outgoing() {
                    self.send(i, outgoing);
                }
            }
        }
    }

    fn events(&mut self, i: usize) {
        let now_us = self.now_us;
        let members = self.members(1);
        let replica = &mut self.replicas[i];
        if let Some((index, part, last)) = replica.making.pop_front() {
            replica.station.checkpoint_part(index, &part, last);
        }
        while let Some(event) = replica.station.take_event() {
            match event {
                Event::Frame(frame) => {
                    let world = replica.world.as_mut().expect("a frame comes after a checkpoint");
                    let asked = replica.executor.execute(world, &frame);
                    if let Some(view) = asked.hash {
                        let hash = view.hash(&mut replica.known);
                        replica.hashes.insert(frame.index, hash);
                        replica.station.own_hash(frame.index, hash);
                    }
                    if frame.mark == Mark::Checkpoint {
                        let captured =
                            asked.captured.expect("a checkpoint's tick ends all strokes");
                        if replica.station.hosts() {
                            // In pieces, so that who joins is ahead of what is made.
                            captured.write(|part, last| {
                                for piece in part.chunks(9_000) {
                                    let piece = (frame.index, piece.to_vec(), false);
                                    replica.making.push_back(piece);
                                }
                                if last {
                                    replica.making.push_back((frame.index, Vec::new(), true));
                                }
                            });
                        }
                    }
                    replica.station.after_step(world.is_at_rest());
                    if let Some(echo) = &mut replica.echo {
                        echo.ordered(&frame);
                    }
                }
                Event::RestorePart { first, bytes } => {
                    if first {
                        replica.restoring = Restoring::default();
                    }
                    replica.restoring.take(&bytes).expect("parts of a checkpoint");
                }
                Event::Restore { .. } => {
                    let whole = std::mem::take(&mut replica.restoring);
                    let world = whole.finish(Workers::new(1)).expect("whole");
                    world.verify_invariants().expect("sound");
                    replica.station.restored(world.tick());
                    replica.world = Some(world);
                    replica.executor = Executor::new(RATE, replica.station.person());
                    if let Some(echo) = &mut replica.echo {
                        echo.reset(RATE, replica.station.person());
                    }
                    replica.hashes.clear();
                    replica.restored += 1;
                }
                Event::Entered { person, rate_hz } => {
                    replica.executor.set_person(person, rate_hz);
                    if let Some(echo) = &mut replica.echo {
                        echo.reset(rate_hz, person);
                    }
                }
                // A host's own turn may be given up: its frames are nobody else's.
                Event::Hosting(_) => replica.hashes.clear(),
                Event::Differs { .. } => replica.differed += 1,
                Event::Note(text) => {
                    replica.notes.push(format!("{:.3} {text}", now_us as f64 / 1e6));
                }
                Event::Refused(why) => replica.refused = Some(why),
                Event::NobodyHosts => {
                    let members = members.clone();
                    let world = ball();
                    replica.station.begin_to_host(members, RATE, world.tick(), now_us);
                    replica.world = Some(world);
                }
            }
        }
    }

    fn send(&mut self, from: usize, Outgoing { to, kind, bytes }: Outgoing) {
        self.replicas[from].bytes.0 += bytes.len() as u64;
        let all: Vec<usize> = (0..self.replicas.len())
            .filter(|&k| k != from && self.replicas[k].part == self.replicas[from].part)
            .filter(|&k| match to {
                To::Host => self.replicas[k].station.hears_greetings(),
                To::Heirs => true,
                To::Peer(address) | To::Bulk(address) => {
                    self.replicas[k].station.address() == address
                }
            })
            .collect();
        if self.replicas[from].cut_off {
            return;
        }
        for to in all {
            if let Some(tape) = &mut self.tape {
                tape.push(Recorded { to, kind, bytes: bytes.clone() });
            }
            let late_us = self.attacker.as_mut().map_or(0, |a| a.hears(to, kind, &bytes));
            let copies = 1 + usize::from(self.random.share() < self.faults.twice);
            for _ in 0..copies {
                if self.random.share() < self.faults.loss {
                    continue;
                }
                let mut at = self.now_us + self.faults.delay_us + late_us;
                if self.random.share() < self.faults.reorder {
                    at += (self.random.share() * self.faults.delay_us.max(20_000) as f64) as u64;
                }
                self.sent += 1;
                self.air.insert((at, self.sent), (to, bytes.clone()));
            }
        }
    }

    /// What the attacker sends in a step.
    fn attack(&mut self) {
        let Some(mut attacker) = self.attacker.take() else { return };
        for (to, bytes) in attacker.step(&self.replicas) {
            if self.replicas[to].alive && !self.replicas[to].cut_off {
                self.inject(to, &bytes);
            }
        }
        self.attacker = Some(attacker);
    }

    /// Bytes of somebody else on their way to a replica.
    pub fn inject(&mut self, to: usize, bytes: &[u8]) {
        self.replicas[to].station.receive(bytes, self.now_us);
    }

    pub fn lively(&self) -> impl Iterator<Item = &Replica> {
        self.replicas.iter().filter(|r| r.alive)
    }

    /// All worlds are one, to the bit, and everything that was given is in them.
    pub fn verify(&self) {
        self.verify_worlds();
        for (i, r) in self.replicas.iter().enumerate().filter(|(_, r)| r.alive) {
            let waits = r.station.outbox().len();
            assert_eq!(waits, 0, "replica {i}: {}", r.notes.join("\n"));
            let (given, lost) = (r.station.outbox().last(), r.station.outbox().counts.lost);
            let ordered = r.station.log().applied(r.station.person());
            assert_eq!((ordered, lost), (given, 0), "replica {i}: {}", r.notes.join("\n"));
        }
    }

    /// All worlds are one, to the bit, and nobody lacks a batch that another has.
    pub fn verify_worlds(&self) {
        let host = self.host().expect("somebody hosts");
        let log = self.replicas[host].station.log();
        let hash = self.replicas[host].world.as_ref().map(World::hash);
        for (i, r) in self.replicas.iter().enumerate().filter(|(_, r)| r.alive) {
            let told = r.notes.join("\n");
            assert_eq!(r.world.as_ref().map(World::hash), hash, "replica {i} differs:\n{told}");
            assert_eq!(r.station.outbox().counts.dropped, 0);
            assert_eq!(r.differed, 0, "replica {i}:\n{told}");
            for (person, applied) in log.people() {
                let own = r.station.log().applied(person.person);
                assert_eq!(own, applied, "replica {i} of {}:\n{told}", person.name);
            }
            for (at, own) in &self.replicas[host].hashes {
                if let Some(other) = r.hashes.get(at) {
                    assert_eq!(own, other, "replica {i} at frame {at}");
                }
            }
        }
    }
}

/// An undo of one's own.
pub fn undo() -> Vec<Command> {
    vec![Command::Undo]
}
