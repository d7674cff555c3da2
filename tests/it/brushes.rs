//! Brushes: golden strokes, formulas, properties.

mod boundary;
mod curve;
mod feel;
mod formulas;
mod golden;
mod levels;
mod properties;
mod sheet;
mod slide;
mod spacing;
mod texture;
mod topology;
mod topology_soak;

use glam::{Vec2, Vec3};
use sculptd_clay::brush::BrushSettings;
use sculptd_clay::{Clay, Workers};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::stroke::CurveAction;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

/// A work, a pen, and a hand that guides it.
pub struct Studio {
    pub world: World,
    /// Tilt of the pen, in radians.
    pub tilt: Option<Vec2>,
    /// The complete input of the world, if it is recorded.
    pub told: Option<Vec<Told>>,
    /// True if the work exceeded one tick.
    paused: bool,
    tick: u64,
}

/// One tick's samples and commands.
pub type Told = (u64, Vec<Sample>, Vec<Command>);

impl Studio {
    pub fn new(mesh: &TriMesh, brush: BrushSettings, workers: usize) -> Studio {
        let mesh = Clay::build(mesh, &Job::default()).expect("builds");
        let options = WorldOptions {
            dab_budget: 400_000,
            undo_bytes: 1 << 30,
            hands: HandSettings::default(),
        };
        // Straight from the front, so that the view's left and right are the work's.
        let camera = Camera { yaw: 0.0, pitch: 0.0, ..Camera::default() };
        Studio {
            world: World::new(mesh, camera, brush, Workers::new(workers), options),
            tilt: None,
            told: None,
            paused: false,
            tick: 0,
        }
    }

    fn step(&mut self, samples: &[Sample], commands: &[Command]) -> u64 {
        self.tick += 1;
        if let Some(told) = &mut self.told {
            told.push((self.tick, samples.to_vec(), commands.to_vec()));
        }
        let report = self.world.step(self.tick, samples, commands);
        self.paused = report.paused;
        report.dabs
    }

    pub fn tell(&mut self, command: Command) {
        self.step(&[], &[command]);
    }

    pub fn sample(&mut self, view: Vec2, pressure: f32, tip: bool) -> u64 {
        let area_mm = Vec2::new(self.world.camera().aspect, 1.0) * 100.0;
        let pen = Pen {
            in_range: true,
            tip,
            pos_mm: view * area_mm,
            area_mm,
            pressure: Some(pressure),
            tilt: self.tilt,
            ..Pen::default()
        };
        let sample = Sample {
            device: DeviceId(1),
            t_us: (self.tick + 1) * 8000,
            device_t_us: None,
            body: Body::Pen(pen),
        };
        self.step(&[sample], &[])
    }

    pub fn rest(&mut self, ticks: u32) -> u64 {
        (0..ticks).map(|_| self.step(&[], &[])).sum()
    }

    /// One stroke through the points, each with its pressure; the dabs it made.
    pub fn stroke(&mut self, points: &[(Vec2, f32)]) -> u64 {
        let mut dabs = 0;
        for &(view, pressure) in points {
            dabs += self.sample(view, pressure, true);
        }
        let (last, _) = points[points.len() - 1];
        dabs += self.sample(last, 0.0, false) + self.rest(2);
        for _ in 0..10_000 {
            if !self.paused {
                break;
            }
            dabs += self.rest(1);
        }
        if self.world.curve_stroke().is_some() {
            // A curve that was laid is drawn at once.
            dabs += self.step(&[], &[Command::CurveStroke(CurveAction::Apply)]);
            while self.paused {
                dabs += self.rest(1);
            }
        }
        dabs
    }

    pub fn positions(&self) -> Vec<Vec3> {
        self.world.mesh().to_tri().positions
    }

    /// Returns the view position of a point on the sculpture.
    pub fn view(&self, p: Vec3) -> Vec2 {
        self.world.camera().project(p).expect("before the eye")
    }
}

/// A ball with a little relief, so that what evens, fills and scrapes has something to do.
/// Symmetric about no plane.
pub fn form(vertices: usize) -> TriMesh {
    let mut mesh = shapes::sphere_of_about(vertices);
    for p in &mut mesh.positions {
        let relief = (p.x * 9.0).sin() * (p.y * 8.0 + 0.7).sin() * (p.z * 10.0 + 0.3).sin();
        *p *= 1.0 + 0.03 * relief;
    }
    mesh
}

/// An S over the middle of the view, as a hand draws it: soft, firm, soft.
pub fn s_curve() -> Vec<(Vec2, f32)> {
    (0..=24)
        .map(|i| {
            let t = i as f32 / 24.0;
            let x = 0.5 + 0.09 * (t * 5.0).sin();
            (Vec2::new(x, 0.3 + 0.4 * t), 0.2 + 0.8 * (t * std::f32::consts::PI).sin())
        })
        .collect()
}
