//! Modelling with bare hands from start to exported mesh: a thing is taken up, carried to its
//! place, and joined with the work. A simulated hand over a simulated tracker, through its
//! WebSocket, the real client and the stepped loop.

use std::sync::Arc;

use glam::{DVec3, Vec3, vec3};
use sculptd_clay::Clay;
use sculptd_daemon::config::Config;
use sculptd_daemon::simulated_loop::{Pace, SimulatedLoop, SimulatedOptions};
use sculptd_daemon::{demo_devices, startup};
use sculptd_devices::sim::hand::skeleton;
use sculptd_devices::sim::{HandKey, HandScript, Performer, TrackerConfig};
use sculptd_devices::{Clock, queue};
use sculptd_engine::command::Command;
use sculptd_engine::hand::menu::ball_mm;
use sculptd_engine::hand::{Menu, MenuItem};
use sculptd_engine::world::World;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh, check, shapes};

const RATE: u32 = 120;

/// The path of one right hand (and now and then the left) in the making.
struct Acting {
    t: f32,
    right: Vec<HandKey>,
    left: Vec<HandKey>,
}

impl Acting {
    fn new() -> Self {
        let mut acting = Acting { t: 0.0, right: Vec::new(), left: Vec::new() };
        acting.rest(0.0, vec3(110.0, 280.0, 60.0));
        acting
    }

    fn key(&self, palm: Vec3) -> HandKey {
        HandKey::flat((f64::from(self.t) * 1e6) as u64, palm)
    }

    /// Half-closed, doing nothing, `after` seconds from now.
    fn rest(&mut self, after: f32, palm: Vec3) {
        self.t += after;
        self.right.push(self.key(palm).curled(0.55));
    }

    /// Points into a ball of the menu until its ring has closed.
    fn choose(&mut self, choice: MenuItem, holding: bool) {
        let i = Menu::choices(holding).iter().position(|c| *c == choice).expect("on the menu");
        let tip = skeleton(&HandKey::flat(0, Vec3::ZERO).pointing(), false).fingers[1]
            .expect("whole")
            .tip;
        let palm = ball_mm(i) - tip;
        // Around the work, not through it.
        self.rest(0.4, vec3(0.0, 330.0, 160.0));
        self.rest(0.5, palm + vec3(0.0, 0.0, 60.0));
        self.t += 0.3;
        self.right.push(self.key(palm).pointing());
        self.t += 1.5;
        self.right.push(self.key(palm).pointing());
        self.rest(0.2, palm + vec3(0.0, 0.0, 40.0));
        self.rest(0.4, vec3(0.0, 330.0, 160.0));
    }

    /// Pinches, carries by `mm`, turning as it goes, and lets go.
    fn carry(&mut self, mm: Vec3, roll: f32) {
        let from = vec3(60.0, 240.0, 60.0) - mm * 0.5;
        self.rest(0.5, from);
        for (after, palm, pinch, turned) in [
            (0.3, from, 1.0, 0.0),
            (0.3, from, 1.0, 0.0),
            (1.2, from + mm, 1.0, roll),
            (0.6, from + mm, 1.0, roll),
            (0.15, from + mm, 0.0, roll),
        ] {
            self.t += after;
            self.right.push(self.key(palm).pinched(pinch).turned(0.0, 0.0, turned));
        }
        self.rest(0.2, from + mm);
    }

    /// Both hands pinch and draw apart: what they hold grows by `factor`.
    fn stretch(&mut self, factor: f32) {
        let (middle, half) = (vec3(0.0, 250.0, 80.0), vec3(50.0, 0.0, 0.0));
        self.rest(0.5, middle + half);
        let at = |acting: &Self, side: f32, wide: f32| acting.key(middle + half * (side * wide));
        self.left.push(at(self, -1.0, 1.0).curled(0.55));
        // Pinch points stand nearer together than palms: what grows is their distance.
        let tips = |left: bool| {
            let f = skeleton(&HandKey::flat(0, Vec3::ZERO).pinched(1.0), left).fingers;
            (f[0].expect("whole").tip.x + f[1].expect("whole").tip.x) * 0.5
        };
        let inner = 2.0 * half.x + tips(false) - tips(true);
        let wide = (inner * factor - (inner - 2.0 * half.x)) / (2.0 * half.x);
        for (after, w, pinch) in [
            (0.3, 1.0, 1.0),
            (0.3, 1.0, 1.0),
            (1.2, wide, 1.0),
            (0.6, wide, 1.0),
            (0.15, wide, 0.0),
        ] {
            self.t += after;
            self.right.push(at(self, 1.0, w).pinched(pinch));
            self.left.push(at(self, -1.0, w).pinched(pinch));
        }
        self.t += 0.2;
        self.right.push(at(self, 1.0, wide).curled(0.55));
        self.left.push(at(self, -1.0, wide).curled(0.55).gone());
    }

    fn script(mut self) -> HandScript {
        self.rest(0.5, vec3(150.0, 330.0, 60.0));
        let performer =
            |left, keys: Vec<HandKey>| (!keys.is_empty()).then_some(Performer { left, keys });
        HandScript {
            performers: [performer(false, self.right), performer(true, self.left)]
                .into_iter()
                .flatten()
                .collect(),
        }
    }
}

/// The world of a work, and how many mm of the hand are one unit of it.
fn world(work: &TriMesh) -> (World, f32) {
    let mesh = Clay::build(work, &Job::default()).expect("a work");
    let world = startup::world(mesh, &Config::default());
    let scale = world.volume().scale;
    (world, 1.0 / scale)
}

/// From where a thing appears to where its middle should be, in the hand's mm.
fn way(world: &World, to: Vec3) -> Vec3 {
    let v = world.volume();
    let yaw = glam::Quat::from_rotation_y(world.camera().yaw);
    let appears = world.middle() + yaw * vec3(world.extent() * 1.2, world.extent() * 0.4, 0.0);
    v.turn.inverse() * ((to - appears) / v.scale)
}

/// Performs, exports, and reads what came of it.
fn perform(
    world: &mut World,
    script: HandScript,
    commands: &[(u64, Command)],
    name: &str,
) -> (PolyMesh, f64) {
    let clock = Clock::manual();
    let (factory, mut receiver) = queue::channel(4096);
    let (feed, _adaptor) = demo_devices::tracker(
        script,
        TrackerConfig { rate: 90.0, ..TrackerConfig::default() },
        &clock,
        &factory,
    )
    .expect("a tracker");
    let mut feeds = vec![feed];
    let stepped = SimulatedLoop {
        world,
        feeds: &mut feeds,
        receiver: &mut receiver,
        clock: &clock,
        journal: None,
        observer: &mut |_, _, _| {},
        script: commands,
    };
    let options = SimulatedOptions {
        rate_hz: RATE,
        pace: Pace::Fast,
        max_ticks: Some(20_000),
        drain_per_tick: 256,
        verify: false,
    };
    stepped.run(&options).expect("runs");
    world.verify_invariants().expect("sound");
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(format!("{name}.ply"));
    write_mesh(&path, &world.mesh().to_tri().to_poly()).expect("exports");
    let read = read_mesh(&path, &Job::default()).expect("reads").mesh;
    let info = check::report(&read, true, &Job::default()).expect("checked");
    let volume = info.volume.expect("closed");
    println!(
        "{name}: {} triangles, volume {volume:.4}, {} component(s), closed {}, manifold {}",
        info.triangles, info.components, info.closed, info.manifold
    );
    assert!(info.closed && info.manifold && info.oriented, "{name}: {info:?}");
    assert_eq!(info.components, 1, "{name}");
    (read, volume)
}

fn volume(work: &TriMesh) -> f64 {
    check::report(&work.to_poly(), false, &Job::default()).expect("checked").volume.expect("closed")
}

#[test]
fn a_piggy_bank_gets_its_snout_and_its_slot() {
    let body = shapes::icosphere(1.0, 40);
    let (mut world, _) = world(&body);
    let slot =
        shapes::cuboid(DVec3::new(-0.3, -0.4, -0.06), DVec3::new(0.3, 0.4, 0.06)).triangulate().0;
    let mut acting = Acting::new();
    // The snout: a cylinder of the menu, half sunk in at the front.
    acting.choose(MenuItem::Cylinder, false);
    let yaw = world.camera().yaw;
    let front = glam::Quat::from_rotation_y(yaw) * vec3(0.0, 0.0, 1.0);
    acting.carry(way(&world, front), 0.0);
    acting.choose(MenuItem::Add, true);
    // The slot: a loaded mesh, sunk into the top.
    let taken = (acting.t * RATE as f32) as u64 + 20;
    acting.rest(0.5, vec3(110.0, 300.0, 80.0));
    acting.carry(way(&world, vec3(0.0, 0.97, 0.0)), 0.0);
    acting.choose(MenuItem::Carve, true);
    let commands = [(taken, Command::TakeUp(Arc::new(slot)))];
    let (pig, left) = perform(&mut world, acting.script(), &commands, "piggy bank");
    // The snout stands out in front, and there is a hole in the top.
    let out = pig.positions.iter().map(|p| p.as_vec3().dot(front)).fold(0.0, f32::max);
    assert!(out > 1.15, "the snout stands out to {out}");
    let top = pig
        .positions
        .iter()
        .filter(|p| p.y > 0.4 && p.x.hypot(p.z) < 0.4)
        .map(|p| p.y)
        .fold(2.0, f64::min);
    assert!(top < 0.55, "the slot goes down to {top}");
    assert!(left > volume(&body) * 0.95, "{left}");
    assert!(world.undo_steps() >= 2);
}

#[test]
fn a_teapot_is_opened_for_its_lid() {
    let body = shapes::icosphere(1.0, 40);
    let (mut world, _) = world(&body);
    let mut acting = Acting::new();
    acting.choose(MenuItem::Ball, false);
    acting.carry(way(&world, vec3(0.0, 1.0, 0.0)), 0.0);
    acting.choose(MenuItem::Carve, true);
    let before = volume(&body);
    let (pot, left) = perform(&mut world, acting.script(), &[], "teapot");
    // A ball of this radius about a point of the unit sphere: the lens that both have in common,
    // exactly.
    let r = f64::from(world.extent()) / 3.0 / 3f64.sqrt();
    let lens = std::f64::consts::PI * r.powi(3) * (2.0 / 3.0 - r / 4.0);
    let carved = before - left;
    println!("carved {carved:.4}, a ball at the top carves {lens:.4}");
    assert!((carved / lens - 1.0).abs() < 0.2, "{carved} of {lens}");
    assert!(pot.positions.iter().all(|p| p.length() < 1.001));
    // Undo brings the whole pot back.
    world.step(1_000_000, &[], &[Command::Undo]);
    assert!((volume(&world.mesh().to_tri()) - before).abs() < 1e-9);
}

#[test]
fn an_aeroplane_gets_its_wing() {
    let fuselage = shapes::cylinder(0.3, 3.0, 64).triangulate().0;
    let (mut world, _) = world(&fuselage);
    let wing =
        shapes::cuboid(DVec3::new(-1.0, -0.05, -0.2), DVec3::new(1.0, 0.05, 0.2)).triangulate().0;
    let middle = world.middle();
    let mut acting = Acting::new();
    acting.rest(0.5, vec3(110.0, 300.0, 80.0));
    acting.carry(way(&world, middle), 0.0);
    acting.stretch(1.5);
    acting.choose(MenuItem::Add, true);
    let before = world.mesh().bounds();
    let commands = [(30, Command::TakeUp(Arc::new(wing)))];
    let (_, whole) = perform(&mut world, acting.script(), &commands, "aeroplane");
    let after = world.mesh().bounds();
    let grown = (after.1 - after.0).max_element() / (before.1 - before.0).x;
    println!(
        "the span is {:.2} widths of the fuselage",
        (after.1 - after.0).x / (before.1 - before.0).x
    );
    assert!(grown > 1.5 && whole > volume(&fuselage), "{grown}");
}
