//! Strokes without gaps, on real clay that the stroke itself raises.

use glam::{Vec2, Vec3};
use sculptd::analysis::cancel::Job;
use sculptd::brush::Gaussian;
use sculptd::mesh::{Hit, Mesh, Reach, Workers, shapes};
use sculptd::stroke::{Camera, Flow, PenPoint, Spacer, Surface};

use super::super::clay::Dice;
use super::form;

/// Clay that writes down where dabs were laid.
struct Bench {
    mesh: Mesh,
    camera: Camera,
    radius: f32,
    /// Of one dab, over the radius.
    strength: f32,
    /// Dabs that may still be laid before the walk must pause.
    left: usize,
    /// The last dab: its view point, and where it was laid.
    last: Option<(Vec2, Vec3)>,
    /// How far the next one was laid from it, in spacings.
    apart: Vec<f32>,
    /// Leaps over what the eye does not see.
    hidden: usize,
}

impl Bench {
    /// The longest leap of the surface as it is seen along the way between two points of the view, in five hundred steps.
    fn leaps(&mut self, from: Vec2, to: Vec2) -> f32 {
        let seen: Vec<Vec3> = (0..=500)
            .filter_map(|i| self.pick(from.lerp(to, i as f32 / 500.0)))
            .map(|hit| hit.position)
            .collect();
        seen.windows(2).map(|w| (w[1] - w[0]).length()).fold(0.0, f32::max)
    }
}

impl Surface for Bench {
    fn pick(&mut self, view: Vec2) -> Option<Hit> {
        self.mesh.pick(self.camera.ray(view))
    }

    fn spacing(&self, at: &PenPoint) -> f32 {
        0.2 * self.radius * (0.5 + 0.5 * at.pressure)
    }

    fn world_per_view(&self, hit: &Hit) -> f32 {
        self.camera.world_per_view((self.camera.eye() - hit.position).dot(self.camera.backward()))
    }

    fn dab(&mut self, at: &PenPoint, hit: &Hit, _: Option<Vec3>) -> Flow {
        if let Some((view, laid)) = self.last {
            // From where its own clay stands now; where that is raised, and seen in another place, from where it was laid.
            let now = self.pick(view).map_or(laid, |h| h.position);
            let apart = (hit.position - now).length();
            let apart = if self.strength > 0.02 { apart.min((hit.position - laid).length()) } else { apart };
            let apart = apart / self.spacing(at);
            if apart > 1.05 && self.leaps(view, at.view) > 0.5 * self.spacing(at) {
                // What lies between is hidden behind clay: the stroke goes on where it is seen again.
                println!("{apart:.2} spacings over a place that the eye does not see");
                self.hidden += 1;
            } else {
                self.apart.push(apart);
            }
        }
        let radius = self.radius * (0.5 + 0.5 * at.pressure);
        let kernel = Gaussian::new(hit.position, radius, hit.normal, self.strength * radius);
        self.mesh.dab(&Reach::Sphere { centre: hit.position, radius }, &kernel, &Workers::new(1));
        self.last = Some((at.view, hit.position));
        self.left -= 1;
        if self.left == 0 { Flow::Pause } else { Flow::Go }
    }
}

fn point(view: Vec2, pressure: f32) -> PenPoint {
    PenPoint { view, pressure, tilt: None, inverted: false }
}

#[test]
fn a_pen_that_crosses_the_work_in_one_frame_leaves_no_gap() {
    let mut dice = Dice(77);
    let (mut widest, mut dabs, mut hidden) = (0.0f32, 0, 0);
    for round in 0..24 {
        let work = if round % 2 == 0 { shapes::icosphere(1.0, 60) } else { form(40_000) };
        let mesh = Mesh::build(&work, &Job::default()).expect("builds");
        let (lo, hi) = mesh.bounds();
        let mut camera = Camera { orthographic: round % 3 == 0, ..Camera::default() };
        camera.frame(lo, hi);
        let strength = [0.0, 0.02, 0.08][round % 3];
        let mut bench = Bench {
            mesh,
            camera,
            radius: 0.05 + 0.15 * dice.next(),
            strength,
            left: usize::MAX,
            last: None,
            apart: Vec::new(),
            hidden: 0,
        };
        // From one side to the other, near the rim where a step over the view is a long way over the clay.
        let angle = dice.next() * std::f32::consts::TAU;
        let along = Vec2::from_angle(angle);
        let aside = along.perp() * (dice.next() - 0.5) * 0.3;
        let scale = Vec2::new(1.0 / bench.camera.aspect, 1.0);
        let at = |t: f32| point(Vec2::splat(0.5) + (along * (t - 0.5) * 0.55 + aside) * scale, 0.3 + 0.7 * t);
        // In one frame, or in several; whole, or a few dabs a tick.
        let frames = [1, 1, 2, 7][round % 4];
        let most = if round % 5 == 4 { 3 } else { usize::MAX };
        bench.left = most;
        let mut spacer = Spacer::new(bench.camera.aspect);
        spacer.begin(&at(0.0), &mut bench);
        for f in 0..frames {
            let (from, to) = (at(f as f32 / frames as f32), at((f + 1) as f32 / frames as f32));
            let mut share = 0.0;
            while share < 1.0 {
                bench.left = most;
                share = spacer.walk(&from, &to, share, &mut bench);
            }
        }
        let here = bench.apart.iter().copied().fold(0.0, f32::max);
        assert!(bench.apart.len() > 10, "round {round}: {} dabs", bench.apart.len());
        assert!(here <= 1.05, "round {round}: {here} of the spacing, {frames} frames");
        hidden += bench.hidden;
        dabs += bench.apart.len();
        widest = widest.max(here);
    }
    assert!(hidden * 100 < dabs, "{hidden} leaps in {dabs} dabs");
    println!("{dabs} dabs, {hidden} leaps over hidden places, the widest step {widest:.4} of the spacing");
}
