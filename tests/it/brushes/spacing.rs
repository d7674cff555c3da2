//! Strokes without gaps: over forms of all kinds, seen from everywhere, in one frame or in many, on
//! clay that stays as it is and on clay that the stroke itself raises.

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{BrushKind, BrushSettings, GaussianBrush};
use sculptd_clay::{Clay, Hit, Ray, Reach, Workers};
use sculptd_engine::camera::Camera;
use sculptd_engine::stroke::spacer::BRIDGED;
use sculptd_engine::stroke::{Flow, Laid, PenPoint, Spacer, Surface};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::{Studio, form};

/// Greatest distance between dabs of one run, in spacings.
const WIDEST: f32 = 1.05;

/// Clay that writes down where dabs were laid.
struct Bench<'a> {
    mesh: &'a mut Clay,
    camera: Camera,
    radius: f32,
    /// Height of one dab over the radius; 0 leaves the clay as it is.
    strength: f32,
    /// Dabs that may still be laid before the walk must pause.
    left: usize,
    laid: Vec<(PenPoint, Vec3, Laid)>,
    /// Index of the path's piece for each dab; `piece` is the current one.
    pieces: Vec<usize>,
    /// Surface point of the last dab.
    under: Option<Hit>,
    piece: usize,
    /// From the last dab, as its clay stood then, in spacings; none for the first of a run.
    apart: Vec<Option<f32>>,
}

impl<'a> Bench<'a> {
    fn new(mesh: &'a mut Clay, camera: Camera, radius: f32, strength: f32) -> Bench<'a> {
        Bench {
            mesh,
            camera,
            radius,
            strength,
            left: usize::MAX,
            laid: Vec::new(),
            pieces: Vec::new(),
            under: None,
            piece: 0,
            apart: Vec::new(),
        }
    }

    /// Returns the current position of the surface point under the last dab.
    fn clay(&self) -> Option<Vec3> {
        let hit = self.under?;
        let [a, b, c] = self.mesh.page(hit.page).corners(hit.triangle as usize);
        let [u, v, w] = hit.barycentric;
        Some(a * u + b * v + c * w)
    }

    /// Draws through the points, each piece cut into `frames`, at most `most` dabs before a pause.
    fn draw(&mut self, points: &[PenPoint], frames: usize, most: usize) {
        self.left = most;
        let mut spacer = Spacer::new(self.camera.aspect);
        spacer.begin(&points[0], self);
        for (piece, pair) in points.windows(2).enumerate() {
            self.piece = piece;
            for f in 0..frames {
                let at = |k: usize| pair[0].lerp(&pair[1], k as f32 / frames as f32);
                let mut share = 0.0;
                while share < 1.0 {
                    self.left = most;
                    share = spacer.advance(&at(f), &at(f + 1), share, self);
                }
            }
        }
    }

    /// Why a run may end between two places of the view: nothing is seen there, or the surface
    /// leaps so far (mesh units).
    fn breach(&mut self, way: &[Vec2]) -> Option<f32> {
        let mut last: Option<Vec3> = None;
        let mut widest = 0.0f32;
        for leg in way.windows(2) {
            for i in 0..=4000 {
                let now = self.pick(leg[0].lerp(leg[1], i as f32 / 4000.0))?.position;
                widest = widest.max(last.map_or(0.0, |l| (now - l).length()));
                last = Some(now);
            }
        }
        Some(widest)
    }
}

impl Surface for Bench<'_> {
    fn pick(&mut self, view: Vec2) -> Option<Hit> {
        self.mesh.pick(self.camera.ray(view))
    }

    fn spacing(&self, at: &PenPoint) -> f32 {
        0.2 * self.radius * (0.5 + 0.5 * at.pressure)
    }

    fn world_per_view(&self, hit: &Hit) -> f32 {
        self.camera.world_per_view((self.camera.eye() - hit.position).dot(self.camera.backward()))
    }

    fn drop(&mut self, ray: Ray, far: f32) -> Option<Hit> {
        self.mesh.pick(ray).filter(|h| h.t <= far)
    }

    fn dab(&mut self, at: &PenPoint, hit: &Hit, laid: Laid) -> Flow {
        let apart = self.laid.last().copied().map(|(pen, was, _)| {
            let to_now =
                self.pick(pen.view).map_or(f32::INFINITY, |h| (hit.position - h.position).length());
            let to_was = (hit.position - was).length();
            let to_clay = self.clay().map_or(f32::INFINITY, |p| (hit.position - p).length());
            // On clay that is raised the last dab is where its place is seen now; what was laid out
            // of sight, where its clay is.
            let apart = if self.strength > 0.0 { to_now.min(to_was).min(to_clay) } else { to_was };
            apart / self.spacing(at)
        });
        self.apart.push(apart.filter(|_| !laid.first));
        if self.strength > 0.0 {
            let radius = self.radius * (0.5 + 0.5 * at.pressure);
            let height = self.strength * laid.share * radius;
            let kernel = GaussianBrush::new(hit.position, radius, hit.normal, height);
            self.mesh.dab(
                &Reach::Sphere { centre: hit.position, radius },
                &kernel,
                &Workers::new(1),
            );
        }
        self.laid.push((*at, hit.position, laid));
        self.pieces.push(self.piece);
        self.under = Some(*hit);
        self.left -= 1;
        if self.left == 0 { Flow::Pause } else { Flow::Go }
    }
}

fn point(view: Vec2, pressure: f32) -> PenPoint {
    PenPoint { view, pressure, tilt: None, inverted: false }
}

/// A sheet of waves that run into each other: crests wherever it is seen aslant.
fn waves() -> TriMesh {
    let mut sheet = shapes::grid(2.0, 2.0, 200, 200).triangulate().0;
    for p in &mut sheet.positions {
        p.z += 0.06 * (p.x * 14.0).sin() * (p.y * 11.0 + 0.4).cos()
            + 0.02 * (p.x * 41.0 + p.y * 37.0).sin();
    }
    sheet
}

fn forms() -> Vec<(&'static str, Clay)> {
    let built = |mesh: &TriMesh| Clay::build(mesh, &Job::default()).expect("builds");
    vec![
        ("plane", built(&shapes::grid(2.0, 2.0, 60, 60).triangulate().0)),
        ("sphere", built(&shapes::icosphere(1.0, 60))),
        ("torus", built(&shapes::torus(0.8, 0.3, 160, 60).triangulate().0)),
        ("relief", built(&form(40_000))),
        ("waves", built(&waves())),
    ]
}

fn camera(dice: &mut Dice, mesh: &Clay) -> Camera {
    let (lo, hi) = mesh.bounds();
    let mut camera = Camera {
        yaw: dice.next() * std::f32::consts::TAU,
        // Up to a plane seen all but edge on.
        pitch: (dice.next() - 0.5) * 3.1,
        orthographic: dice.next() < 0.4,
        ..Camera::default()
    };
    camera.frame(lo, hi);
    camera
}

fn path(dice: &mut Dice, camera: &Camera, pieces: usize) -> Vec<PenPoint> {
    let scale = Vec2::new(1.0 / camera.aspect, 1.0);
    (0..=pieces)
        .map(|_| {
            let at =
                Vec2::from_angle(dice.next() * std::f32::consts::TAU) * dice.next().sqrt() * 0.42;
            point(Vec2::splat(0.5) + at * scale, 0.3 + 0.7 * dice.next())
        })
        .collect()
}

#[test]
fn a_pen_at_any_speed_over_any_form_leaves_no_gap() {
    let mut dice = Dice(77);
    let (mut dabs, mut widest, mut seen, mut leaps, mut overhung) = (0, 0.0f32, 0, 0, 0);
    let rounds = if std::env::var_os("SCULPTD_LONG").is_some() { 1000 } else { 80 };
    for (name, mut mesh) in forms() {
        for round in 0..rounds {
            let camera = camera(&mut dice, &mesh);
            let points = path(&mut dice, &camera, 1 + round % 3);
            let radius = 0.04 + 0.3 * dice.next() * dice.next();
            // In one frame, in a few, in very many; whole, or a few dabs a tick.
            let (frames, most) =
                ([1, 1, 3, 90][round % 4], [usize::MAX, 3][usize::from(round % 5 == 4)]);
            let mut bench = Bench::new(&mut mesh, camera, radius, 0.0);
            bench.draw(&points, frames, most);
            dabs += bench.apart.len();
            for i in 1..bench.apart.len() {
                let ((from, was, _), (to, now, _)) = (bench.laid[i - 1], bench.laid[i]);
                if let Some(apart) = bench.apart[i] {
                    assert!(
                        apart <= WIDEST,
                        "{name} {round}: {apart} of the spacing between dabs {i}"
                    );
                    widest = widest.max(apart);
                    continue;
                }
                let spacing = bench.spacing(&to);
                if (now - was).length() <= spacing {
                    // A new run as near as the old one would have been.
                    continue;
                }
                // Round the corners of the path.
                let corners =
                    points[bench.pieces[i - 1] + 1..=bench.pieces[i]].iter().map(|p| p.view);
                let way: Vec<Vec2> =
                    [from.view].into_iter().chain(corners).chain([to.view]).collect();
                match bench.breach(&way) {
                    None => seen += 1,
                    Some(leap) if leap > 0.9 * BRIDGED * spacing => leaps += 1,
                    Some(_) => overhung += 1,
                }
            }
        }
    }
    println!(
        "{dabs} dabs, the widest step {widest:.4} of the spacing; runs ended {seen} times at an \
            edge, {leaps} at a wide leap, \
         {overhung} under an overhang"
    );
    assert!(dabs > 10_000 && seen > 10 && leaps > 10);
    assert!(overhung * 100 <= leaps.max(100), "{overhung} runs ended for no wide leap");
}

#[test]
fn clay_that_a_stroke_raises_is_crossed_without_a_gap_too() {
    let mut dice = Dice(5);
    let (mut dabs, mut widest, mut runs) = (0, 0.0f32, 0);
    for round in 0..24 {
        let work = if round % 2 == 0 { shapes::icosphere(1.0, 60) } else { form(40_000) };
        let mut mesh = Clay::build(&work, &Job::default()).expect("builds");
        let (lo, hi) = mesh.bounds();
        let mut camera = Camera { orthographic: round % 3 == 0, ..Camera::default() };
        camera.frame(lo, hi);
        // From one side to the other, near the rim where a step over the view is a long way over
        // the clay.
        let along = Vec2::from_angle(dice.next() * std::f32::consts::TAU);
        let aside = along.perp() * (dice.next() - 0.5) * 0.3;
        let scale = Vec2::new(1.0 / camera.aspect, 1.0);
        let at = |t: f32| {
            point(Vec2::splat(0.5) + (along * (t - 0.5) * 0.55 + aside) * scale, 0.3 + 0.7 * t)
        };
        let strength = [0.02, 0.08, -0.05][round % 3];
        let mut bench = Bench::new(&mut mesh, camera, 0.05 + 0.15 * dice.next(), strength);
        bench.draw(
            &[at(0.0), at(1.0)],
            [1, 1, 2, 7][round % 4],
            [usize::MAX, 3][usize::from(round % 5 == 4)],
        );
        let here = bench.apart.iter().flatten().copied().fold(0.0, f32::max);
        assert!(bench.apart.len() > 10, "round {round}: {} dabs", bench.apart.len());
        assert!(here <= WIDEST, "round {round}: {here} of the spacing");
        runs += bench.apart.iter().skip(1).filter(|a| a.is_none()).count();
        dabs += bench.apart.len();
        widest = widest.max(here);
    }
    println!("{dabs} dabs, {runs} more runs, the widest step {widest:.4} of the spacing");
    // Strong dabs near the rim raise crests that hide what is behind them.
    assert!(runs * 25 < dabs, "{runs} runs in {dabs} dabs");
}

#[test]
fn the_cut_into_frames_changes_nothing_of_what_is_laid_down() {
    let mut dice = Dice(12);
    for (name, mut mesh) in forms() {
        let (mut most, mut sum) = (0.0f32, 0.0f32);
        for _ in 0..6 {
            let camera = camera(&mut dice, &mesh);
            let points = path(&mut dice, &camera, 3);
            let mut total = |frames: usize| -> f32 {
                let mut bench = Bench::new(&mut mesh, camera, 0.08, 0.0);
                bench.draw(&points, frames, usize::MAX);
                bench.laid.iter().map(|(_, _, l)| l.share).sum()
            };
            let one = total(1);
            for frames in [2, 7, 40, 400] {
                let many = total(frames);
                // The last dab of a run may fall short, and steps are 0.94 to 1 of the spacing.
                let off = (many - one).abs();
                assert!(off <= 3.0 + 0.04 * one, "{name}: {one} in one frame, {many} in {frames}");
                most = most.max(off / one.max(30.0));
            }
            sum += one;
        }
        println!(
            "{name}: {sum:.0} whole dabs laid, at most {:.1} % more or less in many frames",
            most * 100.0
        );
    }
}

#[test]
fn a_stroke_drawn_fast_and_one_drawn_slowly_raise_the_same_clay() {
    let start = form(40_000);
    let brush = BrushSettings {
        radius: 0.12,
        strength: 0.05,
        ..sculptd::presets().of(BrushKind::Gaussian)
    };
    let volume = |studio: &Studio| -> f64 {
        let mesh = studio.world.mesh().to_tri();
        let c = |v: u32| mesh.positions[v as usize].as_dvec3();
        mesh.triangles.iter().map(|t| c(t[0]).dot(c(t[1]).cross(c(t[2])))).sum::<f64>() / 6.0
    };
    let raised = |frames: usize| -> f64 {
        let mut studio = Studio::new(&start, brush, 1);
        let before = volume(&studio);
        let at =
            |k: usize| Vec2::new(0.35, 0.3).lerp(Vec2::new(0.62, 0.7), k as f32 / frames as f32);
        let points: Vec<_> = (0..=frames).map(|k| (at(k), 0.8)).collect();
        studio.stroke(&points);
        volume(&studio) - before
    };
    let one = raised(1);
    for frames in [3, 20, 150] {
        let many = raised(frames);
        println!("{frames} frames raise {:.4} of what one raises", many / one);
        assert!(one > 0.0 && (many / one - 1.0).abs() < 0.04, "{frames} frames: {many} to {one}");
    }
}
