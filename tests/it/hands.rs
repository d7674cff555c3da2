//! Gestures over real recordings: which pose each one is read as, and how often a pinch or a grab
//! is seen that was not made.

use std::collections::BTreeMap;

use sculptd_devices::catalogue::Catalogue;
use sculptd_devices::recording::Player;
use sculptd_devices::{Body, DeviceId};
use sculptd_engine::hand::{HandSettings, HandTools, Pose};

use crate::corpus;

/// The poses of each recording, known from its name and from viewing it: the poses that may occur
/// besides neutral.
const MADE: [(&str, &[Pose], Option<Pose>); 12] = [
    ("pinch.jsonl.gz", &[Pose::Pinch, Pose::Flat, Pose::Open], Some(Pose::Pinch)),
    ("pinch-57fps.jsonl.gz", &[Pose::Pinch, Pose::Flat, Pose::Open], Some(Pose::Pinch)),
    ("pinch-half-res.jsonl.gz", &[Pose::Pinch, Pose::Flat, Pose::Open], Some(Pose::Pinch)),
    ("grab.jsonl.gz", &[Pose::Grab, Pose::Flat, Pose::Open], Some(Pose::Grab)),
    ("gun.jsonl.gz", &[Pose::Point], Some(Pose::Point)),
    ("wave.jsonl.gz", &[Pose::Open, Pose::Flat], None),
    ("flapping.jsonl.gz", &[Pose::Open, Pose::Flat], None),
    ("brian.jsonl.gz", &[Pose::Open, Pose::Flat, Pose::Point, Pose::Grab, Pose::Pinch], None),
    ("waiting-short.jsonl.gz", &[Pose::Point], None),
    ("Waiting-110fps.jsonl.gz", &[Pose::Point], None),
    ("rollAndPitchCropped.jsonl.gz", &[Pose::Open, Pose::Flat], None),
    ("rollAndPitchWithEntry.jsonl.gz", &[Pose::Open, Pose::Flat], None),
];

struct Seen {
    frames: BTreeMap<Pose, usize>,
    entries: BTreeMap<Pose, usize>,
    seconds: f64,
}

fn watch(path: &std::path::Path) -> Seen {
    let catalogue = Catalogue::builtin().expect("the embedded tablets are valid");
    let mut player = Player::open(path, DeviceId(0), &catalogue).expect("a recording");
    let mut tools = HandTools::new(HandSettings::default());
    let mut seen = Seen { frames: BTreeMap::new(), entries: BTreeMap::new(), seconds: 0.0 };
    let mut last: BTreeMap<i32, Pose> = BTreeMap::new();
    player.advance(u64::MAX, &mut |sample| {
        let Body::Hands(hands) = sample.body else { return };
        tools.take(sample.device, sample.t_us, &hands);
        while tools.next_act().is_some() {}
        seen.seconds = sample.t_us as f64 * 1e-6;
        for track in tools.tracks().filter(|t| t.seen_us == sample.t_us) {
            *seen.frames.entry(track.pose).or_default() += 1;
            if last.insert(track.id, track.pose) != Some(track.pose) {
                *seen.entries.entry(track.pose).or_default() += 1;
            }
        }
    });
    seen
}

#[test]
fn real_hands_are_read_as_what_they_do() {
    let Some(corpus) = corpus() else { return };
    let (mut false_entries, mut seconds) = (0, 0.0);
    println!(
        "{:<32}{:>6}{}",
        "recording",
        "s",
        Pose::ALL.map(|p| format!("{:>10}", format!("{p:?}"))).concat()
    );
    for (name, made, main) in MADE {
        let seen = watch(&corpus.join("devices/open/leap").join(name));
        let share = |p: Pose| {
            let all: usize = seen.frames.values().sum();
            *seen.frames.get(&p).unwrap_or(&0) as f64 / all.max(1) as f64
        };
        let cells: String = Pose::ALL
            .map(|p| {
                format!("{:>5.0}%/{:<3}", share(p) * 100.0, seen.entries.get(&p).unwrap_or(&0))
            })
            .concat();
        println!("{name:<32}{:>6.1}{cells}", seen.seconds);
        seconds += seen.seconds;
        for pose in [Pose::Pinch, Pose::Grab] {
            if !made.contains(&pose) {
                false_entries += seen.entries.get(&pose).unwrap_or(&0);
            }
        }
        if let Some(main) = main {
            assert!(
                share(main) > 0.15,
                "{name}: {main:?} is seen in {:.0} % of the frames",
                share(main) * 100.0
            );
        }
    }
    let a_minute = false_entries as f64 / (seconds / 60.0);
    println!("false pinches and grabs: {false_entries} in {seconds:.0} s, {a_minute:.2} a minute");
    assert!(a_minute <= 1.0, "{a_minute} a minute");
}
