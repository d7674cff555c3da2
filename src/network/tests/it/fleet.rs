//! A thousand installations on a simulated network; roll-outs that are kept and that are not;
//! requests that nobody may make.

use crate::fleet_simulated::{Fleet, HOUR, InAir, S};
use crate::simulated::Random;
use sculptd_network::fleet::access::{FleetKey, FleetSeal, FleetWay};
use sculptd_network::fleet::registry::FleetRegistry;
use sculptd_network::fleet::request::{FleetAction, to_json};
use sculptd_network::fleet::requester::{RequestEnd, Requester};
use sculptd_network::fleet::rollout::RolloutEnd;

/// Hours that are simulated: a month by `SCULPTD_LONG`, which takes half an hour, or as many as
/// `SCULPTD_FLEET_HOURS` says.
fn hours() -> u64 {
    let said = std::env::var("SCULPTD_FLEET_HOURS").ok().and_then(|t| t.parse().ok());
    let long = std::env::var_os("SCULPTD_LONG").is_some();
    said.unwrap_or(if long { 30 * 24 } else { 1 })
}

#[test]
fn the_list_of_a_thousand_installations_is_right_within_ten_seconds_of_every_change() {
    let mut fleet = Fleet::new(1000, 31);
    let hours = hours();
    for hour in 0..hours {
        fleet.run(HOUR);
        if hour % 24 == 23 {
            println!("day {}: {:?}", hour / 24 + 1, fleet.counts);
        }
    }
    let [changes, published, cuts, crashes] = fleet.counts;
    println!(
        "{hours} hours of 1000 installations: {changes} changes, {published} publications, {cuts} \
         cuts of the network, {crashes} crashes"
    );
    assert!(changes > 3_000 * hours && published > 1_500_000 * hours && cuts > 0);
    // Quiet: all is as it is.
    fleet.troubles = false;
    fleet.run(2 * HOUR);
    for i in 0..fleet.units.len() {
        fleet.check(i);
        assert!(fleet.registry.get(&fleet.units[i].name).is_some_and(|e| e.is_here()));
    }
}

#[test]
fn a_roll_out_is_stopped_by_a_canary_that_fails_and_reaches_nobody_else() {
    let mut fleet = Fleet::new(200, 32);
    fleet.troubles = false;
    fleet.run(30 * S);
    let old = fleet.units[7].disk.text.clone();
    let bad = "idle_s = 50.0\nbad_for = \"hall-0007\"\n";
    let (end, offered) = fleet.roll_out(bad, 7, 30);
    let RolloutEnd::TakenBack { failed, why, taken_back, silent } = end else {
        panic!("it is stopped: {end:?}");
    };
    assert_eq!((failed.as_str(), offered), ("hall-0007", vec!["hall-0007".to_owned()]));
    assert!(why.contains("logs an error"), "{why}");
    assert_eq!((taken_back, silent), (vec!["hall-0007".to_owned()], vec![]));
    fleet.run(30 * S);
    assert!(fleet.units.iter().all(|u| u.disk.text == old && u.disk.on_trial.is_none()));
    assert!(fleet.units.iter().enumerate().all(|(i, u)| u.runs == if i == 7 { 3 } else { 1 }));
}

#[test]
fn a_roll_out_that_fails_among_the_others_is_taken_back_by_all() {
    let mut fleet = Fleet::new(100, 33);
    fleet.troubles = false;
    fleet.run(30 * S);
    let bad = "idle_s = 50.0\nbad_for = \"hall-0055\"\n";
    let (end, offered) = fleet.roll_out(bad, 7, 30);
    assert_eq!(offered.len(), 100);
    let RolloutEnd::TakenBack { failed, taken_back, .. } = end else { panic!("{end:?}") };
    assert_eq!((failed.as_str(), taken_back.len()), ("hall-0055", 100));
    fleet.run(30 * S);
    assert!(fleet.units.iter().all(|u| u.disk.text.contains("60.0")));
}

#[test]
fn a_roll_out_reaches_all_that_are_there_and_the_next_one_those_that_were_not() {
    let mut fleet = Fleet::new(100, 34);
    fleet.troubles = false;
    fleet.run(30 * S);
    let new = "idle_s = 50.0\n";
    (40..50).for_each(|i| fleet.units[i].cut = true);
    (40..50).for_each(|i| fleet.changed(i));
    fleet.run(20 * S);
    let (end, _) = fleet.roll_out(new, 7, 30);
    let RolloutEnd::Kept { kept, missed } = end else { panic!("{end:?}") };
    assert_eq!((kept.len(), missed.len()), (90, 10));
    (40..50).for_each(|i| fleet.units[i].cut = false);
    (40..50).for_each(|i| fleet.changed(i));
    fleet.run(20 * S);
    let (end, offered) = fleet.roll_out(new, 7, 30);
    assert_eq!(offered.len(), 10, "who has it is left alone");
    assert!(matches!(end, RolloutEnd::Kept { kept, missed }
        if kept.len() == 100 && missed.is_empty()));
    fleet.run(HOUR);
    assert!(fleet.units.iter().all(|u| u.disk.text == new && u.disk.on_trial.is_none()));
}

#[test]
fn an_installation_that_is_cut_off_in_its_trial_takes_the_settings_back_by_itself() {
    let mut fleet = Fleet::new(20, 35);
    fleet.troubles = false;
    fleet.run(30 * S);
    let plan = "idle_s = 50.0\n";
    // The whole network goes while the canary is watched: the staff's computer is off.
    let id = "0123456789abcdef".to_owned();
    let action = FleetAction::TrySettings { text: plan.into(), trial_s: 120 };
    fleet.requester.ask(id, "hall-0003", action, fleet.now_us + 20 * S);
    fleet.run(20 * S);
    assert!(matches!(fleet.requester.take_ended(), Some((_, RequestEnd::Answered(_)))));
    assert_eq!(fleet.units[3].disk.text, plan);
    fleet.units[3].cut = true;
    fleet.changed(3);
    fleet.run(150 * S);
    assert!(fleet.units[3].disk.text.contains("60.0"), "taken back");
    fleet.units[3].cut = false;
    fleet.changed(3);
    fleet.run(20 * S);
    fleet.check(3);
    assert!(fleet.registry.get("hall-0003").is_some_and(|e| !e.state.settings.trial));
}

#[test]
fn recorded_states_show_nobody_to_a_list_that_knows_them_nor_to_one_that_restarts() {
    let mut fleet = Fleet::new(60, 37);
    fleet.tape = Some(Vec::new());
    fleet.run(HOUR / 4);
    // Each begins a second run, and a third of them end for good.
    (0..60).for_each(|i| fleet.stop(i, fleet.now_us + S));
    fleet.run(HOUR / 4);
    fleet.troubles = false;
    (0..60).step_by(3).for_each(|i| fleet.stop(i, fleet.now_us + 10 * HOUR));
    fleet.run(60 * S);
    let tape = fleet.tape.take().expect("recorded");
    let mut random = Random(38);
    for restarts in [false, true] {
        if restarts {
            let known: Vec<_> = fleet.registry.all().map(|(_, e)| (*e.state).clone()).collect();
            fleet.registry = FleetRegistry::remembering(known);
            fleet.requester = Requester::new(39);
        }
        for second in 0..300 {
            for _ in 0..300 {
                let state = tape[random.next() as usize % tape.len()].clone();
                fleet.deliver(InAir::State(state));
            }
            fleet.run(S);
            for i in (0..60).filter(|i| second > 20 || i % 3 == 0) {
                fleet.check(i);
            }
        }
        let here = fleet.registry.all().filter(|(_, e)| e.is_here()).count();
        assert_eq!(here, 40);
    }
}

#[test]
fn forged_and_repeated_requests_do_nothing() {
    let mut fleet = Fleet::new(2, 36);
    fleet.troubles = false;
    fleet.run(30 * S);
    let stranger = FleetKey::staff(&mut Random::entropy(99));
    let request = |fleet: &Fleet, sequence| {
        let run = fleet.registry.get("hall-0000").expect("here").state.run.clone();
        let action = FleetAction::Message { text: "hello".into() };
        to_json(&sculptd_network::fleet::request::FleetRequest {
            id: format!("{sequence:016x}"),
            run,
            sequence,
            action,
        })
    };
    let sealed = |key: &FleetKey, name: &str, plain: &[u8]| {
        let secret = key.secret_of(name).expect("staff make all keys");
        FleetSeal::new(&secret, FleetWay::Request, &mut Random::entropy(5)).seal(plain)
    };
    // A wrong key; the key of another installation.
    let plain = request(&fleet, 1);
    for bytes in [
        sealed(&stranger, "hall-0000", &plain),
        sealed(&fleet.staff, "hall-0001", &plain),
        plain.clone(),
        Vec::new(),
    ] {
        fleet.deliver(InAir::Request(0, bytes));
    }
    assert!(fleet.units[0].disk.shown.is_empty());
    let right = sealed(&fleet.staff, "hall-0000", &plain);
    (0..5).for_each(|_| fleet.deliver(InAir::Request(0, right.clone())));
    assert_eq!(fleet.units[0].disk.shown, ["hello"]);
    // Recorded, and sent to the run that comes after it.
    fleet.stop(0, fleet.now_us + S);
    fleet.run(5 * S);
    fleet.deliver(InAir::Request(0, right));
    assert_eq!(fleet.units[0].disk.shown, ["hello"]);
    // A flood is bounded: what comes after it is heard all the same.
    let mut random = Random(3);
    for _ in 0..100_000 {
        let bytes = (0..random.next() % 100).map(|_| random.next() as u8).collect();
        fleet.deliver(InAir::Request(0, bytes));
    }
    let refused = fleet.units[0].part.as_ref().map_or(0, |p| p.refused);
    assert_eq!(refused, 100_000);
    fleet.run(10 * S);
    let bytes = sealed(&fleet.staff, "hall-0000", &request(&fleet, 9));
    fleet.deliver(InAir::Request(0, bytes));
    assert_eq!(fleet.units[0].disk.shown, ["hello", "hello"]);
}
