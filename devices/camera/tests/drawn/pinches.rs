//! Pinches and dropouts, through the hand tools' own poses.

use glam::Vec3;
use sculptd_camera::drawn_hand::DrawnHand;
use sculptd_camera::hand_camera::HandCameraSettings;
use sculptd_devices::DeviceId;
use sculptd_devices::sim::hand::HandKey;
use sculptd_engine::hand::{Act, HandSettings, HandTools, Pose};

use crate::stage::{Stage, long, upright};

const CAMERA: DeviceId = DeviceId(210);

/// A small repeatable generator.
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
}

fn pose(tools: &HandTools) -> Option<Pose> {
    tools.tracks().map(|t| t.pose).next()
}

#[test]
fn pinches_are_seen_and_none_is_invented() {
    let Some(mut stage) = Stage::new(HandCameraSettings::default()) else { return };
    let count = if long() { 10_000 } else { 40 };
    let mut dice = Dice(7);
    let mut tools = HandTools::new(HandSettings::default());
    let (mut seen, mut invented, mut stuck) = (0, 0, 0);
    let mut gaps = (Vec::new(), Vec::new());
    for i in 0..count {
        if i % 20 == 0 {
            stage.scene.skin =
                [[224, 172, 140], [205, 150, 120], [160, 110, 84], [120, 80, 60]][i / 20 % 4];
            stage.scene.noise = dice.between(3.0, 8.0);
        }
        let base = HandKey {
            palm: Vec3::new(
                dice.between(-60.0, 60.0),
                dice.between(180.0, 240.0),
                dice.between(-80.0, 80.0),
            ),
            yaw_pitch_roll: [
                dice.between(-0.3, 0.3),
                dice.between(1.2, 1.6),
                dice.between(-0.3, 0.3),
            ],
            ..upright(450.0)
        };
        let size = dice.between(0.9, 1.1);
        let steps = 14;
        let (mut pinched, mut false_one) = (false, false);
        for step in 0..steps {
            // Open, closing, closed, opening, open.
            let amount = match step {
                0..=2 => 0.0,
                3 => 0.5,
                4..=8 => 1.0,
                9 => 0.5,
                _ => 0.0,
            };
            let hand = DrawnHand::new(&base.pinched(amount), false, size);
            let hands = stage.see(&[hand]);
            tools.take(CAMERA, stage.t_us, &hands);
            while tools.next_act().is_some() {}
            let is = pose(&tools) == Some(Pose::Pinch);
            pinched |= is && (4..=10).contains(&step);
            false_one |= is && step <= 2 && i > 0 && step > 0;
            stuck += usize::from(is && step == steps - 1);
            if let Some([Some(thumb), Some(index)]) =
                hands.as_slice().first().map(|h| [h.fingers[0], h.fingers[1]])
            {
                let gap = thumb.tip.distance(index.tip);
                if step == 7 {
                    gaps.0.push(gap);
                }
                if step == 13 {
                    gaps.1.push(gap);
                }
            }
        }
        seen += usize::from(pinched);
        invented += usize::from(false_one);
    }
    for all in [&mut gaps.0, &mut gaps.1] {
        all.sort_by(f32::total_cmp);
        let at = |q: f32| all.get((all.len() as f32 * q) as usize).copied().unwrap_or(f32::NAN);
        println!("gap mm: 1% {:.1} 50% {:.1} 99% {:.1}", at(0.01), at(0.5), at(0.99));
    }
    println!(
        "{seen} of {count} pinches seen, {invented} invented, {stuck} still closed at the end"
    );
    assert!(seen * 100 >= count * 99, "{seen} of {count} pinches seen");
    assert_eq!((invented, stuck), (0, 0), "invented, stuck");
}

#[test]
fn no_grab_is_stuck_after_a_dropout() {
    let Some(mut stage) = Stage::new(HandCameraSettings::default()) else { return };
    let count = if long() { 1000 } else { 20 };
    let mut tools = HandTools::new(HandSettings::default());
    let mut dice = Dice(3);
    let mut stuck = 0;
    for i in 0..count {
        let closed =
            if i % 2 == 0 { upright(450.0).pinched(1.0) } else { upright(450.0).curled(1.0) };
        for _ in 0..6 {
            let hands = stage.see(&[DrawnHand::new(&closed, false, 1.0)]);
            tools.take(CAMERA, stage.t_us, &hands);
        }
        // Gone, from one picture to a third of a second.
        for _ in 0..1 + (dice.unit() * 10.0) as usize {
            let hands = stage.see(&[]);
            tools.take(CAMERA, stage.t_us, &hands);
        }
        // Back and open, or not back at all.
        for _ in 0..10 {
            let back = DrawnHand::new(&upright(450.0), false, 1.0);
            let hands = if i % 3 == 0 { stage.see(&[]) } else { stage.see(&[back]) };
            tools.take(CAMERA, stage.t_us, &hands);
        }
        while tools.next_act().is_some() {}
        stuck += usize::from(matches!(pose(&tools), Some(Pose::Pinch | Pose::Grab)));
        stuck += usize::from(tools.is_gripping());
    }
    assert_eq!(stuck, 0, "stuck after {count} dropouts");
}

#[test]
fn the_performance_pushes_pinches_smooths_turns_and_zooms() {
    let Some(mut stage) = Stage::new(HandCameraSettings::default()) else { return };
    let script = sculptd_camera::performance::performance();
    let mut tools = HandTools::new(HandSettings::default());
    let mut acts = [0; 5];
    let mut t_us = 0;
    while t_us < script.end_us() {
        let hands = stage.see(&DrawnHand::of_script(&script, t_us));
        tools.take(CAMERA, stage.t_us, &hands);
        t_us += crate::stage::FRAME_US;
        while let Some(act) = tools.next_act() {
            match act {
                Act::Push(_) => acts[0] += 1,
                Act::Drag(_) => acts[1] += 1,
                Act::Palm(_) => acts[2] += 1,
                Act::Orbit(_) => acts[3] += 1,
                Act::Zoom(_) => acts[4] += 1,
                _ => {}
            }
        }
    }
    println!("pushes, drags, palms, turns, zooms: {acts:?}");
    assert!(acts.iter().all(|n| *n >= 10), "{acts:?}");
}
