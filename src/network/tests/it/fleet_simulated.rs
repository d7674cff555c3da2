//! A fleet on a simulated network: installations with random visitors, errors, crashes and
//! partitions, all from a seed, and the staff's end.
//!
//! The test checks that the list shows every change within ten seconds, and never shows a state
//! that did not hold within the last ten seconds.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use crate::simulated::Random;
use sculptd_network::fleet::access::{FleetKey, FleetSeal, FleetWay, open_sealed};
use sculptd_network::fleet::installation::{Installation, InstallationIdentity, InstallationPort};
use sculptd_network::fleet::registry::{FleetChange, FleetRegistry};
use sculptd_network::fleet::request::{FleetAction, StaffOrder, from_json, to_json};
use sculptd_network::fleet::requester::Requester;
use sculptd_network::fleet::rollout::{Rollout, RolloutEnd, RolloutPlan, RolloutStep};
use sculptd_network::fleet::settings_files::{TrialStart, revision_of};
use sculptd_network::fleet::state::{InstallationState, VisitStage};
use sculptd_network::fleet::{PERIOD_US, SPACING_US};

/// Microseconds of a step.
const STEP_US: u64 = 250_000;
/// The list is right after so long.
const RIGHT_US: u64 = 10_000_000;
pub const S: u64 = 1_000_000;
pub const HOUR: u64 = 3600 * S;
/// Mean interval of each event at an installation.
const VISIT_EVERY_US: f64 = 1200e6;
const ERROR_EVERY_US: f64 = 86_400e6;
const CRASH_EVERY_US: f64 = 4.0 * 86_400e6;
/// Mean interval of network partitions.
const CUT_EVERY_US: f64 = 900e6;

/// Disk of an installation, with its history.
#[derive(Debug, Clone, Default)]
pub struct Disk {
    pub text: String,
    pub before: Option<String>,
    pub on_trial: Option<(u32, u32)>,
    pub shown: Vec<String>,
    pub visits_ended: u64,
}

impl InstallationPort for Disk {
    fn show(&mut self, text: &str) -> Result<String, String> {
        self.shown.push(text.into());
        Ok("shown".into())
    }

    fn restart_visit(&mut self) -> Result<String, String> {
        self.visits_ended += 1;
        Ok("ended".into())
    }

    fn staff(&mut self, order: StaffOrder) -> Result<String, String> {
        Err(format!("{order:?}: there is no page"))
    }

    fn log_lines(&mut self, most: usize) -> Vec<String> {
        (0..most.min(3)).map(|k| format!("line {k}")).collect()
    }

    fn try_settings(&mut self, text: &str, trial_s: u32) -> Result<bool, String> {
        if self.text == text {
            return Ok(false);
        }
        if self.on_trial.is_some() {
            return Err("other settings are on trial".into());
        }
        self.before = Some(std::mem::replace(&mut self.text, text.into()));
        self.on_trial = Some((trial_s, 0));
        Ok(true)
    }

    fn keep_settings(&mut self, revision: &str) -> Result<(), String> {
        if revision_of(&self.text).as_deref() != Ok(revision) {
            return Err("another revision is in place".into());
        }
        self.on_trial = None;
        Ok(())
    }

    fn take_back_settings(&mut self, revision: Option<&str>) -> Result<bool, String> {
        if revision.is_some_and(|r| revision_of(&self.text).as_deref() != Ok(r)) {
            return Ok(false);
        }
        self.on_trial = None;
        let before = self.before.as_mut().ok_or("there are none before")?;
        std::mem::swap(before, &mut self.text);
        Ok(true)
    }
}

impl Disk {
    /// As the files of an installation do at each start.
    fn begin(&mut self) -> TrialStart {
        match self.on_trial {
            None => TrialStart::Settled,
            Some((_, starts)) if starts > 0 => {
                let revision = revision_of(&self.text).expect("TOML");
                self.take_back_settings(None).expect("one was before");
                TrialStart::TakenBack { revision }
            }
            Some((trial_s, starts)) => {
                self.on_trial = Some((trial_s, starts + 1));
                TrialStart::OnTrial { trial_s }
            }
        }
    }
}

/// The state that the list must show.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    here: bool,
    stage: VisitStage,
    visits: u64,
    errors: u64,
    revision: String,
}

pub struct Unit {
    pub name: String,
    pub disk: Disk,
    pub part: Option<Installation>,
    pub measured: InstallationState,
    pub cut: bool,
    /// The program starts again then.
    pub starts_us: Option<u64>,
    pub publish_us: u64,
    pub runs: u64,
    /// States and their start times; the last one is current.
    pub truths: VecDeque<(u64, Truth)>,
    pub check_us: Option<u64>,
}

impl Unit {
    fn truth(&self) -> Truth {
        Truth {
            here: self.part.is_some() && !self.cut,
            stage: self.measured.visit.stage,
            visits: self.measured.visit.visits,
            errors: self.measured.errors.errors,
            revision: self.measured.settings.revision.clone(),
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub enum Befalls {
    Publish,
    Visit,
    VisitEnds,
    Error,
    Crash,
    Start,
    Check,
}

pub enum InAir {
    State(Arc<InstallationState>),
    Request(usize, Vec<u8>),
    Answer(usize, Vec<u8>),
}

pub struct Fleet {
    pub now_us: u64,
    pub random: Random,
    pub units: Vec<Unit>,
    pub staff: FleetKey,
    pub events: BTreeMap<(u64, u64), (usize, Befalls)>,
    pub air: BTreeMap<(u64, u64), InAir>,
    pub count: u64,
    pub registry: FleetRegistry,
    pub requester: Requester,
    pub seals: BTreeMap<usize, FleetSeal>,
    pub cut_us: u64,
    pub heals: BTreeMap<u64, Vec<usize>>,
    pub troubles: bool,
    /// Every state that was published, while it is `Some`: what anybody can record.
    pub tape: Option<Vec<Arc<InstallationState>>>,
    /// Counts: changes of the truth, received publications, cuts, crashes.
    pub counts: [u64; 4],
}

impl Fleet {
    pub fn new(installations: usize, seed: u64) -> Fleet {
        let staff = FleetKey::staff(&mut Random::entropy(seed));
        let mut fleet = Fleet {
            now_us: S,
            random: Random(seed),
            units: Vec::new(),
            staff,
            events: BTreeMap::new(),
            air: BTreeMap::new(),
            count: 0,
            registry: FleetRegistry::default(),
            requester: Requester::new(seed),
            seals: BTreeMap::new(),
            cut_us: u64::MAX,
            heals: BTreeMap::new(),
            troubles: true,
            tape: None,
            counts: [0; 4],
        };
        fleet.cut_us = fleet.now_us + fleet.after(CUT_EVERY_US);
        for i in 0..installations {
            let disk = Disk { text: "idle_s = 60.0\n".into(), ..Disk::default() };
            fleet.units.push(Unit {
                name: format!("hall-{i:04}"),
                disk,
                part: None,
                measured: InstallationState::default(),
                cut: false,
                starts_us: None,
                publish_us: 0,
                runs: 0,
                truths: VecDeque::new(),
                check_us: None,
            });
            let truth = fleet.units[i].truth();
            fleet.units[i].truths.push_back((0, truth));
            let at = fleet.now_us + fleet.random.next() % (10 * S);
            fleet.start_at(i, at);
            for (befalls, every) in [
                (Befalls::Visit, VISIT_EVERY_US),
                (Befalls::Error, ERROR_EVERY_US),
                (Befalls::Crash, CRASH_EVERY_US),
            ] {
                let at = fleet.now_us + fleet.after(every);
                fleet.at(at, i, befalls);
            }
        }
        fleet
    }

    /// A time until something that happens so often on average.
    fn after(&mut self, every_us: f64) -> u64 {
        (-(1.0 - self.random.share()).ln() * every_us) as u64 + 1
    }

    fn at(&mut self, at_us: u64, i: usize, befalls: Befalls) {
        self.count += 1;
        self.events.insert((at_us, self.count), (i, befalls));
    }

    fn start_at(&mut self, i: usize, at_us: u64) {
        self.units[i].starts_us = Some(at_us);
        self.at(at_us, i, Befalls::Start);
    }

    /// Sends; the network is that of a connection: what is late is late by a repetition.
    fn send(&mut self, message: InAir) {
        let share = self.random.share();
        let late = match share {
            s if s < 0.0001 => return,
            s if s < 0.01 => 1_000_000,
            _ => 0,
        };
        let at = self.now_us + 1_000 + (self.random.share() * 200_000.0) as u64 + late;
        self.count += 1;
        self.air.insert((at, self.count), message);
    }

    /// Something has become so, or is so no longer.
    pub fn changed(&mut self, i: usize) {
        let unit = &mut self.units[i];
        let truth = unit.truth();
        if unit.truths.back().is_some_and(|(_, t)| *t == truth) {
            return;
        }
        self.counts[0] += 1;
        while unit.truths.len() > 1 && unit.truths[1].0 + RIGHT_US < self.now_us {
            unit.truths.pop_front();
        }
        unit.truths.push_back((self.now_us, truth));
        if unit.check_us.is_none() {
            let at = self.now_us + RIGHT_US;
            unit.check_us = Some(at);
            self.at(at, i, Befalls::Check);
        }
        // A change is published at once, as the thread of a daemon looks often.
        self.publish(i);
    }

    fn publish(&mut self, i: usize) {
        let (unit, now_us) = (&mut self.units[i], self.now_us);
        let Some(part) = &mut unit.part else { return };
        unit.measured.settings.trial = unit.disk.on_trial.is_some();
        let may_us = (part.due_us() + SPACING_US).saturating_sub(PERIOD_US);
        let state = part.advance(unit.measured.clone(), &mut unit.disk, now_us);
        // A change soon after a publication waits a little.
        let waits = state.is_none() && now_us < may_us;
        let next_us = if waits { may_us } else { part.due_us().max(now_us + 1) };
        let restarts = part.restarts();
        unit.publish_us = next_us;
        let cut = unit.cut;
        self.at(next_us, i, Befalls::Publish);
        if let Some(state) = state.filter(|_| !cut).map(Arc::new) {
            self.tape.iter_mut().for_each(|tape| tape.push(state.clone()));
            self.send(InAir::State(state));
        }
        if restarts {
            self.stop(i, now_us + 3 * S);
        }
    }

    pub fn stop(&mut self, i: usize, again_us: u64) {
        self.units[i].part = None;
        self.start_at(i, again_us);
        self.changed(i);
    }

    fn start(&mut self, i: usize) {
        let secret = self.staff.secret_of(&self.units[i].name).expect("staff make all keys");
        let run = format!("{:016x}", self.random.next());
        let started_s = self.now_us / S;
        let unit = &mut self.units[i];
        unit.starts_us = None;
        unit.runs += 1;
        let trial = unit.disk.begin();
        let name = unit.name.clone();
        let identity = InstallationIdentity { name, secret, run, started_s };
        let mut entropy = Random::entropy((i as u64) << 32 | unit.runs);
        unit.part = Some(Installation::new(identity, &trial, &mut entropy, self.now_us));
        unit.measured = InstallationState::default();
        unit.measured.settings.revision = revision_of(&unit.disk.text).expect("TOML");
        unit.measured.settings.trial = matches!(trial, TrialStart::OnTrial { .. });
        if matches!(trial, TrialStart::TakenBack { .. }) {
            unit.measured.errors.errors = 1;
        }
        // A file that does not do well in this place.
        if unit.disk.text.contains("bad_for") && unit.disk.text.contains(&unit.name) {
            let at = self.now_us + 5 * S + self.random.next() % (15 * S);
            self.at(at, i, Befalls::Error);
        }
        self.publish(i);
        self.changed(i);
    }

    fn befall(&mut self, at_us: u64, i: usize, befalls: Befalls) {
        let runs = self.units[i].part.is_some();
        match befalls {
            Befalls::Publish => {
                // Only the newest of the planned publications.
                if self.units[i].publish_us == at_us {
                    self.publish(i);
                }
            }
            Befalls::Visit => {
                let free = self.units[i].measured.visit.stage == VisitStage::Attract;
                if self.troubles && runs && free {
                    self.units[i].measured.visit.stage = VisitStage::Working;
                    self.changed(i);
                    let at = self.now_us + self.after(180e6);
                    self.at(at, i, Befalls::VisitEnds);
                }
                let at = self.now_us + self.after(VISIT_EVERY_US);
                self.at(at, i, Befalls::Visit);
            }
            Befalls::VisitEnds => {
                let visit = &mut self.units[i].measured.visit;
                if runs && visit.stage == VisitStage::Working {
                    (visit.stage, visit.visits) = (VisitStage::Attract, visit.visits + 1);
                    self.changed(i);
                }
            }
            Befalls::Error => {
                if runs {
                    self.units[i].measured.errors.errors += 1;
                    self.changed(i);
                }
                if self.troubles {
                    let at = self.now_us + self.after(ERROR_EVERY_US);
                    self.at(at, i, Befalls::Error);
                }
            }
            Befalls::Crash => {
                if self.troubles && runs {
                    self.counts[3] += 1;
                    let again = self.now_us + S + self.after(120e6);
                    self.stop(i, again);
                }
                let at = self.now_us + self.after(CRASH_EVERY_US);
                self.at(at, i, Befalls::Crash);
            }
            Befalls::Start => {
                if self.units[i].starts_us.is_some_and(|at| at <= self.now_us) {
                    self.start(i);
                }
            }
            Befalls::Check => {
                self.units[i].check_us = None;
                self.check(i);
                // A later change is checked in its turn.
                let last = self.units[i].truths.back().map_or(0, |(at, _)| *at);
                if last + RIGHT_US > self.now_us {
                    self.units[i].check_us = Some(last + RIGHT_US);
                    self.at(last + RIGHT_US, i, Befalls::Check);
                }
            }
        }
    }

    /// The list says of an installation what is so, or was within the last ten seconds.
    pub fn check(&self, i: usize) {
        let unit = &self.units[i];
        let entry = self.registry.get(&unit.name);
        let says = entry.map(|e| Truth {
            here: e.is_here(),
            stage: e.state.visit.stage,
            visits: e.state.visit.visits,
            errors: e.state.errors.errors,
            revision: e.state.settings.revision.clone(),
        });
        let fits = |truth: &Truth| match &says {
            None => !truth.here,
            Some(says) => says.here == truth.here && (!says.here || says == truth),
        };
        // The end of each is the beginning of the next.
        let until = unit.truths.iter().skip(1).map(|(at, _)| *at).chain([u64::MAX]);
        let recent = |end: u64| end.saturating_add(RIGHT_US) >= self.now_us;
        assert!(
            unit.truths.iter().zip(until).any(|((_, t), end)| recent(end) && fits(t)),
            "{:.2} s: the list says {says:?} of {}, and these were so: {:?}",
            self.now_us as f64 / 1e6,
            unit.name,
            unit.truths
        );
    }

    /// A part of the network is cut off for a while: from seconds to an hour.
    fn cut(&mut self) {
        let share = self.random.share() * 0.2;
        let lasts = S + self.after(300e6).min(HOUR);
        let cut: Vec<usize> = (0..self.units.len())
            .filter(|&i| !self.units[i].cut && (i % 97) as f64 / 97.0 < share)
            .collect();
        self.counts[2] += 1;
        for &i in &cut {
            self.units[i].cut = true;
            self.changed(i);
        }
        self.heals.insert(self.now_us + lasts, cut);
    }

    pub fn deliver(&mut self, message: InAir) {
        match message {
            InAir::State(state) => {
                self.counts[1] += 1;
                self.registry.observe(state, self.now_us);
            }
            InAir::Request(i, bytes) => {
                let unit = &mut self.units[i];
                let Some(part) = unit.part.as_mut().filter(|_| !unit.cut) else { return };
                let answer = part.receive(&bytes, &mut unit.disk, self.now_us);
                if let Some(answer) = answer {
                    self.send(InAir::Answer(i, answer));
                }
                self.publish(i);
            }
            InAir::Answer(i, bytes) => {
                if self.units[i].cut {
                    return;
                }
                let name = self.units[i].name.clone();
                let secret = self.staff.secret_of(&name).expect("staff make all keys");
                let plain = open_sealed(&secret, FleetWay::Answer, &bytes).expect("sealed");
                let answer = from_json(&plain).expect("an answer");
                if let Some(run) = self.requester.answer(&name, answer) {
                    self.registry.prove(&name, &run, self.now_us);
                }
            }
        }
    }

    /// Passes one step.
    fn step(&mut self) {
        self.now_us += STEP_US;
        let now = self.now_us;
        if now >= self.cut_us {
            if self.troubles {
                self.cut();
            }
            self.cut_us = now + self.after(CUT_EVERY_US);
        }
        while let Some((_, healed)) = self.heals.first_key_value().filter(|(at, _)| **at <= now) {
            for i in healed.clone() {
                self.units[i].cut = false;
                self.changed(i);
            }
            self.heals.pop_first();
        }
        while self.events.first_key_value().is_some_and(|(at, _)| at.0 <= now) {
            if let Some(((at_us, _), (i, befalls))) = self.events.pop_first() {
                self.befall(at_us, i, befalls);
            }
        }
        while self.air.first_key_value().is_some_and(|(at, _)| at.0 <= now) {
            if let Some((_, message)) = self.air.pop_first() {
                self.deliver(message);
            }
        }
        self.registry.advance(now);
        while let Some(change) = self.registry.take_change() {
            let (FleetChange::Came(name) | FleetChange::Lost(name) | FleetChange::Changed(name)) =
                change;
            let i = self.index(&name);
            self.check(i);
        }
        for (name, request) in self.requester.advance(&self.registry, now) {
            let i = self.index(&name);
            let secret = self.staff.secret_of(&name).expect("staff make all keys");
            let seal = self.seals.entry(i).or_insert_with(|| {
                FleetSeal::new(&secret, FleetWay::Request, &mut Random::entropy(i as u64))
            });
            let bytes = seal.seal(&to_json(&request));
            self.send(InAir::Request(i, bytes));
        }
    }

    fn index(&self, name: &str) -> usize {
        name.trim_start_matches("hall-").parse().expect("a number")
    }

    pub fn run(&mut self, us: u64) {
        let until = self.now_us + us;
        while self.now_us < until {
            self.step();
        }
    }

    /// Rolls settings out; how it ended, and the installations that were offered them.
    pub fn roll_out(
        &mut self,
        text: &str,
        canary: usize,
        watch_s: u64,
    ) -> (RolloutEnd, Vec<String>) {
        let plan = RolloutPlan {
            text: text.into(),
            revision: revision_of(text).expect("TOML"),
            canary: self.units[canary].name.clone(),
            others: self.units.iter().map(|u| u.name.clone()).collect(),
            watch_us: watch_s * S,
        };
        let mut rollout = Rollout::new(plan, &self.registry, self.now_us);
        let (mut asked, mut offered) = (BTreeMap::new(), Vec::new());
        let until = self.now_us + HOUR;
        loop {
            for step in rollout.advance(&self.registry, self.now_us) {
                let RolloutStep::Ask { installation, action } = step else { continue };
                if matches!(action, FleetAction::TrySettings { .. }) {
                    offered.push(installation.clone());
                }
                let id = format!("{:016x}", self.random.next());
                self.requester.ask(id.clone(), &installation, action, self.now_us + 20 * S);
                asked.insert(id, installation);
            }
            if let Some(end) = rollout.end() {
                return (end.clone(), offered);
            }
            self.step();
            while let Some((id, end)) = self.requester.take_ended() {
                let installation: &String = &asked[&id];
                rollout.ended(installation, &end);
            }
            assert!(self.now_us < until, "a roll-out ends");
        }
    }
}
