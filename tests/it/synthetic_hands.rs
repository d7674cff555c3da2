//! A simulated hand with an anatomist's bones, seen by a tracker that trembles, loses hands,
//! renames them and hides fingers: every gesture at every frame rate, through the wire's text and
//! the real parser.

use glam::{Vec3, vec3};
use sculptd_devices::leap::parse_frame;
use sculptd_devices::sim::hand::skeleton;
use sculptd_devices::sim::tracker::frame_json;
use sculptd_devices::sim::{HandKey, HandScript, Jitter, JitterState, Performer};
use sculptd_devices::{Body, DeviceId, Hands, Sample};
use sculptd_engine::hand::{Act, HandSettings, HandTools, Pose, ReachBox};

const RATES: [f32; 4] = [30.0, 60.0, 90.0, 120.0];

/// The tracker of the measurements: 0.2 mm at rest, 1.2 mm moving, and everything that goes wrong
/// besides.
fn tracker(seed: u64) -> Jitter {
    Jitter {
        seed,
        rest_mm: 0.2,
        moving_mm: 1.2,
        dropout: 0.002,
        new_id: 0.002,
        occlude: 0.005,
        skew_ppm: 200.0,
    }
}

/// Each frame as it comes out of the parser: time in us on the tracker's clock, hands.
fn frames(script: &HandScript, rate: f32, jitter: Jitter) -> Vec<(u64, Hands)> {
    let mut trembling = JitterState::new(jitter);
    let step = f64::from(1e6 / rate);
    (0..)
        .map(|i| (i, (f64::from(i) * step) as u64))
        .take_while(|(_, t)| *t <= script.end_us())
        .map(|(i, t)| {
            let seen = trembling.apply(&script.at(t, i64::from(i)));
            let stamp = trembling.stamp(t);
            let frame = parse_frame(&frame_json(&seen, stamp, rate))
                .expect("the simulator speaks the protocol");
            (stamp, frame.hands)
        })
        .collect()
}

fn s(seconds: f32) -> u64 {
    (f64::from(seconds) * 1e6) as u64
}

type Shape = fn(HandKey) -> HandKey;

/// The poses as a person takes them.
const SHAPES: [(Pose, Shape); 6] = [
    (Pose::Neutral, |k| k.curled(0.55)),
    (Pose::Point, HandKey::pointing),
    (Pose::Pinch, |k| k.pinched(1.0)),
    (Pose::Grab, |k| k.curled(1.0)),
    (Pose::Flat, |k| k.spread(0.0)),
    (Pose::Open, |k| k.spread(1.0)),
];

/// Comes, takes the shape within 0.3 s, holds it while moving about and turning, lets go.
fn performance(left: bool, shape: Shape) -> Performer {
    let x = if left { -70.0 } else { 70.0 };
    let at = |t: f32, dx: f32, dy: f32| HandKey::flat(s(t), vec3(x + dx, 210.0 + dy, 0.0));
    let keys = vec![
        at(0.0, 0.0, 0.0).curled(0.55),
        at(1.0, 0.0, 0.0).curled(0.55),
        shape(at(1.3, 0.0, 0.0)),
        shape(at(2.0, 30.0, 10.0)).turned(0.3, 0.1, 0.2),
        shape(at(2.5, 30.0, 10.0)).turned(0.3, 0.1, 0.2),
        shape(at(3.2, -20.0, -15.0)).turned(-0.2, -0.2, -0.3),
        shape(at(3.8, 0.0, 0.0)),
        at(4.1, 0.0, 0.0).curled(0.55),
        at(5.0, 0.0, 0.0).curled(0.55),
    ];
    Performer { left, keys }
}

/// From here to there the shape is held; a pose is asked for 0.1 s after it was taken.
const HELD_US: [u64; 2] = [1_400_000, 3_800_000];

#[test]
fn every_gesture_is_recognised_at_every_frame_rate() {
    println!("{:<10}{}", "", RATES.map(|r| format!("{r:>9} Hz")).concat());
    let (mut right, mut all) = (0usize, 0usize);
    for (pose, shape) in SHAPES {
        let mut line = format!("{:<10}", format!("{pose:?}"));
        for rate in RATES {
            let (mut good, mut count) = (0usize, 0usize);
            for seed in 0..12 {
                let script = HandScript { performers: vec![performance(seed % 2 == 1, shape)] };
                let mut tools = HandTools::new(HandSettings::default());
                for (t, hands) in frames(&script, rate, tracker(seed)) {
                    tools.take(DeviceId(0), t, &hands);
                    while tools.next_act().is_some() {}
                    if (HELD_US[0]..HELD_US[1]).contains(&t) {
                        for track in tools.tracks().filter(|k| k.seen_us == t) {
                            count += 1;
                            good += usize::from(track.pose == pose);
                        }
                    }
                }
            }
            line += &format!("{:>10.2} %", good as f64 / count as f64 * 100.0);
            (right, all) = (right + good, all + count);
        }
        println!("{line}");
    }
    let share = right as f64 / all as f64;
    println!("of all {all} frames {:.2} %", share * 100.0);
    assert!(share >= 0.99, "{share}");
}

#[test]
fn two_hands_hold_and_zoom_at_every_frame_rate() {
    for (pose, wanted) in [(Pose::Pinch, "hold"), (Pose::Open, "zoom")] {
        let shape = SHAPES.iter().find(|(p, _)| *p == pose).expect("listed").1;
        for rate in RATES {
            let (mut good, mut count) = (0usize, 0usize);
            for seed in 0..8 {
                let script = HandScript {
                    performers: vec![performance(false, shape), performance(true, shape)],
                };
                let mut tools = HandTools::new(HandSettings::default());
                for (t, hands) in frames(&script, rate, tracker(seed)) {
                    tools.take(DeviceId(0), t, &hands);
                    let mut acts = std::iter::from_fn(|| tools.next_act()).collect::<Vec<_>>();
                    if (HELD_US[0]..HELD_US[1]).contains(&t) && hands.count == 2 {
                        count += 1;
                        acts.retain(|a| match pose {
                            Pose::Pinch => matches!(a, Act::Hold { .. }),
                            _ => matches!(a, Act::Zoom(_)),
                        });
                        good += usize::from(!acts.is_empty());
                    }
                }
            }
            let share = good as f64 / count as f64;
            println!(
                "{wanted} at {rate} Hz: {:.2} % of {count} frames with both hands",
                share * 100.0
            );
            assert!(share >= 0.97, "{wanted} at {rate} Hz: {share}");
        }
    }
}

/// The fingertip as the tools see it, frame by frame.
/// The longest sweep of any act on clay, and the smallest and largest radius of this pose's, world
/// units.
fn sweeps(reach: [ReachBox; 2], pose: Pose, shape: Shape) -> (f32, [f32; 2]) {
    let script = HandScript { performers: vec![performance(false, shape)] };
    let mut tools = HandTools::new(HandSettings { reach: reach[0], ..HandSettings::default() });
    tools.place_volume(Vec3::ZERO, 1.0, 0.0);
    let (mut longest, mut radii, mut changed) = (0.0f32, [f32::MAX, 0.0f32], false);
    for (t, hands) in frames(&script, 120.0, Jitter { rest_mm: 0.0, moving_mm: 0.0, ..tracker(0) })
    {
        tools.take(DeviceId(0), t, &hands);
        if !changed && t > 1_600_000 {
            (tools.settings.reach, changed) = (reach[1], true);
            tools.place_volume(Vec3::ZERO, 1.0, 0.0);
        }
        while let Some(act) = tools.next_act() {
            let (of, from, to, radius) = match act {
                Act::Push(p) => (Pose::Point, p.from, p.to, p.radius),
                Act::Drag(d) => (Pose::Pinch, d.from, d.to, d.radius),
                Act::Palm(p) => (Pose::Flat, p.from, p.to, p.radius),
                _ => continue,
            };
            longest = longest.max(from.distance(to));
            if of == pose {
                radii = [radii[0].min(radius), radii[1].max(radius)];
            }
        }
    }
    (longest, radii)
}

#[test]
fn a_new_reach_under_a_working_hand_sweeps_nothing_and_keeps_its_tools() {
    let all = ReachBox::default();
    let near = ReachBox { middle_mm: vec3(60.0, 230.0, 40.0), half_mm: 60.0 };
    for (pose, shape) in SHAPES {
        if !matches!(pose, Pose::Point | Pose::Pinch | Pose::Flat) {
            continue;
        }
        let (alone, radii) = sweeps([near, near], pose, shape);
        let (changed, others) = sweeps([all, near], pose, shape);
        println!("{pose:?}: longest sweep {alone:.3}, with a new reach {changed:.3}; {radii:?}");
        assert!(
            alone > 0.0 && changed < 1.2 * alone,
            "{pose:?}: {changed} where {alone} is one's own"
        );
        assert!((others[1] / others[0] - 1.0).abs() < 1e-4, "{pose:?}: {others:?}");
        assert!((radii[1] / others[0] - 1.0).abs() < 1e-4, "{pose:?}: {radii:?} {others:?}");
    }
}

fn tip_of(tools: &HandTools, t: u64) -> Option<Vec3> {
    tools.tracks().find(|k| k.seen_us == t).and_then(|k| k.index_tip)
}

#[test]
fn a_resting_fingertip_trembles_less_than_a_tenth_of_a_millimetre() {
    let key = HandKey::flat(0, vec3(0.0, 200.0, 0.0)).pointing();
    let script = HandScript {
        performers: vec![Performer {
            left: false,
            keys: vec![key, HandKey { t_us: s(20.0), ..key }],
        }],
    };
    for rate in [60.0, 90.0, 120.0] {
        let mut tools = HandTools::new(HandSettings::default());
        let noise = Jitter { seed: 5, rest_mm: 0.2, moving_mm: 1.2, ..Jitter::default() };
        let mut tips = Vec::new();
        for (t, hands) in frames(&script, rate, noise) {
            tools.take(DeviceId(0), t, &hands);
            if t > s(2.0) {
                tips.extend(tip_of(&tools, t));
            }
        }
        let middle = tips.iter().sum::<Vec3>() / tips.len() as f32;
        let sigma = (tips.iter().map(|p| (*p - middle).length_squared()).sum::<f32>()
            / (3.0 * tips.len() as f32))
            .sqrt();
        println!("{rate} Hz: {sigma:.3} mm a axis of 0.200 put in");
        assert!(sigma < 0.1, "{sigma} mm at {rate} Hz");
    }
}

#[test]
fn a_moving_fingertip_lags_less_than_thirty_milliseconds() {
    // There and back over 200 mm in 2.4 s: up to 260 mm a second, at 90 Hz.
    let key = |t: f32, x: f32| HandKey::flat(s(t), vec3(x, 200.0, 0.0)).pointing();
    let keys =
        (0..10).map(|i| key(i as f32 * 1.2, if i % 2 == 0 { -100.0 } else { 100.0 })).collect();
    let script = HandScript { performers: vec![Performer { left: false, keys }] };
    let mut tools = HandTools::new(HandSettings::default());
    let noise = Jitter { seed: 8, rest_mm: 0.2, moving_mm: 1.2, ..Jitter::default() };
    let mut seen = Vec::new();
    for (t, hands) in frames(&script, 90.0, noise) {
        tools.take(DeviceId(0), t, &hands);
        seen.extend(tip_of(&tools, t).map(|p| (t, p.x)));
    }
    let truth = |t: u64| {
        script.performers[0]
            .at(t)
            .map(|(k, _)| skeleton(&k, false).fingers[1].expect("whole").tip.x)
    };
    // The delay at which the truth fits best.
    let misfit = |delay: u64| {
        seen.iter()
            .filter(|(t, _)| *t > s(1.0))
            .filter_map(|(t, x)| Some((x - truth(t - delay)?).powi(2)))
            .sum::<f32>()
    };
    let lag = (0..80).min_by(|a, b| misfit(a * 1000).total_cmp(&misfit(b * 1000))).expect("some");
    println!("lag {lag} ms at 90 Hz");
    assert!(lag < 30, "{lag} ms");
}

#[test]
fn a_fingertip_at_three_metres_a_second_does_not_tunnel_through_a_thin_wall() {
    use sculptd_clay::brush::BrushSettings;
    use sculptd_clay::{Clay, Workers};
    use sculptd_engine::camera::Camera;
    use sculptd_engine::world::{World, WorldOptions};
    use sculptd_geometry::job::Job;

    let wall = wall(2.0);
    let mesh = Clay::build(&wall, &Job::default()).expect("a wall");
    let options = WorldOptions {
        dab_budget: 10_000_000,
        undo_bytes: 1 << 28,
        hands: HandSettings::default(),
    };
    let mut world =
        World::new(mesh, Camera::default(), BrushSettings::default(), Workers::new(1), options);
    let before = world.mesh().to_tri();
    // One frame well before the wall, the next well behind it: 90 Hz and 3 m/s are 33 mm a frame.
    let volume = *world.volume();
    let mm = |world: Vec3| (volume.turn.inverse() * (world - volume.origin)) / volume.scale;
    let (from, to) = (mm(vec3(0.0, 0.0, 60.0)), mm(vec3(0.0, 0.0, -60.0)));
    let tip =
        skeleton(&HandKey::flat(0, Vec3::ZERO).pointing(), false).fingers[1].expect("whole").tip;
    let cross = f64::from((to - from).length()) / 3000.0;
    let key = |t: f64, tip_at: Vec3| HandKey::flat((t * 1e6) as u64, tip_at - tip).pointing();
    let keys = vec![key(0.0, from), key(2.0, from), key(2.0 + cross, to), key(3.0, to)];
    let script = HandScript { performers: vec![Performer { left: false, keys }] };
    let mut touched = 0;
    for (i, (t_us, hands)) in frames(&script, 90.0, Jitter::default()).into_iter().enumerate() {
        let sample =
            Sample { device: DeviceId(1), t_us, device_t_us: None, body: Body::Hands(hands) };
        touched += world.step(i as u64 + 1, &[sample], &[]).vertices_moved;
    }
    let after = world.mesh().to_tri();
    let moved = before.positions.iter().zip(&after.positions).filter(|(a, b)| a != b).count();
    // Everything that the finger's path covers has gone aside.
    let left =
        after.positions.iter().filter(|p| p.x.hypot(p.y) < 0.5 * 12.0 * volume.scale).count();
    println!("{touched} moves, {moved} vertices moved, {left} left in the finger's way");
    assert!(moved > 20 && left == 0, "{moved} moved, {left} left in the way");
}

/// A closed slab of 100 x 100 units about the origin, this thick, its grid a unit wide.
fn wall(thick: f32) -> sculptd_geometry::TriMesh {
    let n = 100usize;
    let mut t = sculptd_geometry::TriMesh::default();
    let id = |side: usize, x: usize, y: usize| (side * (n + 1) * (n + 1) + y * (n + 1) + x) as u32;
    for side in 0..2 {
        for y in 0..=n {
            for x in 0..=n {
                t.positions.push(vec3(
                    x as f32 - 50.0,
                    y as f32 - 50.0,
                    (0.5 - side as f32) * thick,
                ));
            }
        }
        for y in 0..n {
            for x in 0..n {
                let [a, b, c, d] = [
                    id(side, x, y),
                    id(side, x + 1, y),
                    id(side, x + 1, y + 1),
                    id(side, x, y + 1),
                ];
                let (first, second) =
                    if side == 0 { ([a, b, c], [a, c, d]) } else { ([a, c, b], [a, d, c]) };
                t.triangles.extend([first, second]);
            }
        }
    }
    let rim = |i: usize| match i / n {
        0 => (i, 0),
        1 => (n, i - n),
        2 => (3 * n - i, n),
        _ => (0, 4 * n - i),
    };
    for i in 0..4 * n {
        let ((ax, ay), (bx, by)) = (rim(i), rim((i + 1) % (4 * n)));
        let [a, b, c, d] = [id(0, ax, ay), id(1, ax, ay), id(1, bx, by), id(0, bx, by)];
        t.triangles.extend([[a, b, c], [a, c, d]]);
    }
    t
}
