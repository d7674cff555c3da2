//! What a session file records of a shared sculpture is enough: a world that steps the recorded
//! input, shown to nobody, comes to the same sculpture.

use glam::Vec2;

use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::shapes;
use sculptd_network::executor::Executor;
use sculptd_network::wire::frame::{Arrival, Batch, Frame, Role};

fn world() -> World {
    let clay = Clay::build(&shapes::sphere_of_about(3000), &Job::default()).expect("a ball");
    let options =
        WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 30, hands: HandSettings::default() };
    let brush = BrushSettings { radius: 0.1, strength: 0.8, ..BrushSettings::default() };
    World::new(clay, Camera::default(), brush, Workers::new(1), options)
}

fn pen(at: Vec2, tip: bool) -> Sample {
    let area_mm = Vec2::new(160.0, 100.0);
    let pos_mm = area_mm * (Vec2::splat(0.5) + at);
    let pressure = Some(0.7);
    let pen = Pen { in_range: true, tip, pos_mm, area_mm, pressure, ..Pen::default() };
    Sample { device: DeviceId(1), t_us: 0, device_t_us: None, body: Body::Pen(pen) }
}

/// A step of a person: a short stroke, or a command.
#[derive(Debug, Clone)]
enum Act {
    Stroke(u8, Vec2),
    Ask(u8, Box<Command>),
}

/// Steps the acts as the replica of `person` does. Returns the hash of its sculpture, and the one
/// that its recorded input gives.
fn live_and_replayed(person: u8, acts: &[Act]) -> (u64, u64) {
    let (mut live, mut executor) = (world(), Executor::new(120, person));
    let mut recorded = Vec::new();
    let mut step = |batches: Vec<Batch>, arrivals: Vec<Arrival>| {
        let frame = Frame { tick: live.tick() + 1, batches, arrivals, ..Frame::default() };
        let input = executor.input(&frame, &live);
        live.step(input.tick, &input.samples, &input.commands);
        executor.after_step(&mut live, Some(&frame));
        recorded.push(input);
        live.hash()
    };
    let arrival =
        |person: u8| Arrival { person, name: "A".into(), role: Role::Sculptor, here: true };
    step(Vec::new(), vec![arrival(1), arrival(2)]);
    let batch = |person, samples, commands| Batch { person, number: 0, samples, commands };
    for act in acts {
        match act {
            Act::Stroke(person, at) => {
                for k in 0..8 {
                    let sample = pen(*at + Vec2::new(0.005 * k as f32, 0.0), k < 7);
                    step(vec![batch(*person, vec![sample], vec![])], vec![]);
                }
            }
            Act::Ask(person, command) => {
                step(vec![batch(*person, vec![], vec![(**command).clone()])], vec![]);
            }
        }
        for _ in 0..3 {
            step(Vec::new(), Vec::new());
        }
    }
    let hash = step(Vec::new(), Vec::new());
    let mut replay = world();
    for input in recorded {
        replay.step(input.tick, &input.samples, &input.commands);
    }
    (hash, replay.hash())
}

#[test]
fn a_member_s_undo_takes_back_the_same_step_in_a_replay() {
    let (left, right) = (Vec2::new(-0.1, 0.0), Vec2::new(0.1, 0.0));
    let untouched = world().hash();
    for (undo, redo) in [(2, None), (1, None), (2, Some(2)), (1, Some(1))] {
        let mut acts = vec![Act::Stroke(1, left), Act::Stroke(2, right)];
        acts.push(Act::Ask(undo, Box::new(Command::Undo)));
        acts.extend(redo.map(|person| Act::Ask(person, Box::new(Command::Redo))));
        for person in [1, 2] {
            let (live, replayed) = live_and_replayed(person, &acts);
            assert_eq!(live, replayed, "undo by {undo}, redo by {redo:?}, seen by {person}");
            assert_ne!(live, untouched);
        }
    }
}
