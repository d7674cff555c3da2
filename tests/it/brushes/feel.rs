//! What a stroke looks like: the waviness of its crest, its section, its height at any rate of
//! reports and spacing, and a pen that rests.
//!
//! Waviness is the root mean square slope, in degrees, of what is left of the height along the
//! crest when a moving average over half a radius is taken away: what an eye sees as corrugation.

use glam::{Vec2, Vec3};
use sculptd_clay::brush::{Alpha, BrushKind, BrushSettings, Grip, PressureCurve, TopologySettings};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_geometry::{TriMesh, shapes};

use super::super::clay::Dice;
use super::Studio;

/// Radius of the brush, mesh units, on forms about two units wide.
const RADIUS: f32 = 0.2;
/// Half a millimetre on a tablet 152 mm high before a view 2.1 units high.
const TREMBLE: f32 = 0.5 / 152.0 * 2.1;

/// Form on which a stroke is drawn; it maps a length along the stroke to a point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum TestForm {
    /// A square of side 2, straight over it.
    Plane,
    /// The same square, along a circle of radius 0.4.
    Arc,
    /// A ball of radius 1, along its equator.
    Ball,
}

impl TestForm {
    /// With about so many vertices across the brush.
    fn mesh(self, across: u32) -> TriMesh {
        // An even number of cells, so that the stroke's line contains vertices.
        match self {
            TestForm::Plane | TestForm::Arc => {
                let cells = across * 5 / 2 * 2;
                shapes::grid(2.0, 2.0, cells, cells).triangulate().0
            }
            TestForm::Ball => {
                let around = across * 16;
                let mut ball = shapes::uv_sphere(1.0, around / 2, around).triangulate().0;
                // The poles go from the z axis to the y axis.
                ball.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x, p.z, -p.y));
                ball
            }
        }
    }

    fn at(self, u: f32) -> Vec3 {
        match self {
            TestForm::Plane => Vec3::new(u, 0.0, 0.0),
            TestForm::Arc => {
                let a = u / 0.4;
                Vec3::new(0.4 * a.sin(), 0.4 * (1.0 - a.cos()) - 0.2, 0.0)
            }
            TestForm::Ball => Vec3::new(u.sin(), 0.0, u.cos()),
        }
    }

    /// Length along the stroke, distance from its line, height of a vertex where it is now.
    fn measure(self, now: Vec3) -> [f32; 3] {
        match self {
            TestForm::Plane => [now.x, now.y, now.z],
            TestForm::Arc => {
                let d = now - Vec3::new(0.0, 0.2, 0.0);
                [d.x.atan2(-d.y) * 0.4, 0.4 - d.truncate().length(), now.z]
            }
            // The far half lies out of every measure.
            TestForm::Ball => {
                [now.x.atan2(now.z), (now.y / now.length()).asin(), now.length() - 1.0]
            }
        }
    }
}

/// A stroke and how it is drawn.
#[derive(Clone, Copy)]
pub struct Trial {
    pub brush: BrushSettings,
    pub form: TestForm,
    pub across: u32,
    /// Reports a second of a stroke that takes 1.2 seconds.
    pub rate: u32,
    /// Amplitude of the pen's jitter, in mesh units.
    pub tremble: f32,
}

impl Trial {
    pub fn new(brush: BrushSettings) -> Trial {
        let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
        let radius = RADIUS / std::f32::consts::SQRT_2;
        let brush = BrushSettings { radius, pressure_radius: firm, ..brush };
        Trial { brush, form: TestForm::Plane, across: 60, rate: 125, tremble: 0.0 }
    }

    /// The form before and after, as length, offset and height.
    pub fn draw(&self) -> Stroke {
        let mesh = self.form.mesh(self.across);
        let mut brush = self.brush;
        if self.form == TestForm::Ball {
            // The bounding radius of a ball in a box is the box's.
            brush.radius = RADIUS / 3f32.sqrt();
        }
        let mut studio = Studio::new(&mesh, brush, 1);
        let camera = Camera { orthographic: true, ..*studio.world.camera() };
        studio.tell(Command::Camera(camera));
        let mut dice = Dice(3);
        let count = (1.2 * self.rate as f32) as usize;
        let half = if self.form == TestForm::Plane { 0.6 } else { 0.45 };
        let points: Vec<(Vec2, f32)> = (0..=count)
            .map(|i| {
                let u = half * (2.0 * i as f32 / count as f32 - 1.0);
                let mut off = || (dice.next() * 2.0 - 1.0) * self.tremble;
                let aside = Vec3::new(off(), off(), 0.0);
                (studio.view(self.form.at(u) + aside), 0.7)
            })
            .collect();
        studio.stroke(&points);
        Stroke(studio.positions().into_iter().map(|p| self.form.measure(p)).collect())
    }
}

/// Result of a stroke: length along it, distance from its line, and height, for each vertex.
pub struct Stroke(Vec<[f32; 3]>);

impl Stroke {
    /// Height of the crest, and its waviness in degrees.
    ///
    /// It is measured on the heights near the line, after subtracting the section of the stroke
    /// and, within half a radius, the section's shift to a side. Otherwise vertices beside the line
    /// by chance (along an arc, or under a brush that moves them aside) would appear as waves: an
    /// ideal bell sampled at the vertices along the arc has 0.8 degrees.
    pub fn crest(&self) -> (f32, f32) {
        const BINS: usize = 200;
        const HALF: f32 = 0.32;
        let wide = |[u, v, _]: &&[f32; 3]| v.abs() < 0.5 * RADIUS && u.abs() < HALF;
        let section = Section::fit(self.0.iter().filter(wide));
        let band = |[u, v, _]: &&[f32; 3]| v.abs() < 0.055 * RADIUS && u.abs() < HALF;
        let left: Vec<[f64; 3]> = self
            .0
            .iter()
            .filter(band)
            .map(|&[u, v, h]| [u, v, h].map(f64::from))
            .map(|[u, v, h]| [u, v, h - section.at(v)])
            .collect();
        let step = f64::from(2.0 * HALF) / BINS as f64;
        let ripple: Vec<(f64, f64)> = (20..BINS - 20)
            .filter_map(|i| {
                let at = -f64::from(HALF) + (i as f64 + 0.5) * step;
                let around = left.iter().filter(|r| (r[0] - at).abs() <= f64::from(RADIUS) / 4.0);
                let here = around.clone().filter(|r| (r[0] - at).abs() <= step / 2.0);
                let n = around.clone().count() as f64;
                let mean = |k: usize| around.clone().map(|r| r[k]).sum::<f64>() / n;
                let (v0, r0) = (mean(1), mean(2));
                let square: f64 = around.clone().map(|r| (r[1] - v0).powi(2)).sum();
                let product: f64 = around.clone().map(|r| (r[1] - v0) * (r[2] - r0)).sum();
                let slope = if square > 1e-12 { product / square } else { 0.0 };
                let count = here.clone().count();
                let sum: f64 = here.map(|r| r[2] - r0 - slope * (r[1] - v0)).sum();
                (count > 0).then(|| (at, sum / count as f64))
            })
            .collect();
        // From bin to bin, the empty ones passed over.
        let squares: f64 =
            ripple.windows(2).map(|w| (w[1].1 - w[0].1).powi(2) / (w[1].0 - w[0].0)).sum();
        let length = ripple.last().map_or(1.0, |l| l.0) - ripple.first().map_or(0.0, |f| f.0);
        let slope = (squares / length).sqrt();
        (section.at(0.0).abs() as f32, slope.atan().to_degrees() as f32)
    }

    /// Mean height at distances from the line of up to `reach` radii, by tenths of a radius.
    pub fn section(&self, reach: f32) -> Vec<f32> {
        let count = (reach * 10.0).round() as i32;
        (-count..=count)
            .map(|k| {
                let here = |v: f32| (v / RADIUS * 10.0 - k as f32).abs() < 0.3;
                let near = self.0.iter().filter(|[u, v, _]| u.abs() < 0.2 && here(*v));
                let (sum, n) = near.fold((0.0, 0.0f32), |(s, n), [.., h]| (s + h, n + 1.0));
                sum / n.max(1.0)
            })
            .collect()
    }
}

/// The section of a stroke: a polynomial of the distance from its line.
struct Section([f64; Section::TERMS]);

impl Section {
    const TERMS: usize = 9;

    fn powers(v: f64) -> [f64; Section::TERMS] {
        // In half radii, so that the powers stay of one size.
        std::array::from_fn(|k| (v / (0.5 * f64::from(RADIUS))).powi(k as i32))
    }

    /// Least squares by the normal equations, kept from being singular where a coarse form has few
    /// rows of vertices.
    fn fit<'a>(rows: impl Iterator<Item = &'a [f32; 3]>) -> Section {
        const N: usize = Section::TERMS;
        let mut m = [[0.0f64; N + 1]; N];
        for [_, v, h] in rows {
            let p = Section::powers(f64::from(*v));
            for (i, row) in m.iter_mut().enumerate() {
                (0..N).for_each(|j| row[j] += p[i] * p[j]);
                row[N] += p[i] * f64::from(*h);
            }
        }
        let ridge = 1e-10 * m[0][0];
        (0..N).for_each(|i| m[i][i] += ridge);
        for i in 0..N {
            let pivot = m[i];
            for (k, row) in m.iter_mut().enumerate() {
                if k != i {
                    let by = row[i] / pivot[i];
                    (0..=N).for_each(|j| row[j] -= by * pivot[j]);
                }
            }
        }
        Section(std::array::from_fn(|i| m[i][N] / m[i][i]))
    }

    fn at(&self, v: f64) -> f64 {
        Section::powers(v).iter().zip(&self.0).map(|(p, c)| p * c).sum()
    }
}

/// Returns the range of the heights of a section, as a share of their mean.
pub fn flatness(section: &[f32]) -> f32 {
    let (lo, hi) = section.iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let mean = section.iter().sum::<f32>() / section.len() as f32;
    (hi - lo) / mean.abs()
}

/// The brushes that raise, each of whose strokes must be clean.
pub const RAISING: [BrushKind; 7] = [
    BrushKind::Draw,
    BrushKind::Clay,
    BrushKind::ClayStrips,
    BrushKind::Layer,
    BrushKind::Inflate,
    BrushKind::Blob,
    BrushKind::Gaussian,
];

/// Vertices across the brush, with a still and with a trembling pen. The finest are most of the
/// work, and are for long runs.
fn densities() -> impl Iterator<Item = (u32, f32)> {
    let finest = crate::field::long().then_some(100);
    [10, 30].into_iter().chain(finest).flat_map(|a| [(a, 0.0), (a, TREMBLE)])
}

#[test]
fn a_stroke_over_a_plane_is_smooth_along_its_crest() {
    for kind in RAISING {
        let (height, waviness) = Trial::new(sculptd::presets().of(kind)).draw().crest();
        println!("{kind}: {waviness:.3} degrees at a height of {height:.4}");
        assert!(height > 0.02 * RADIUS, "{kind}: only {height} high");
        assert!(waviness <= 0.1, "{kind}: {waviness} degrees");
    }
}

#[test]
fn strokes_are_smooth_on_a_ball_along_a_curve_and_with_a_trembling_pen() {
    for kind in RAISING {
        let brush = sculptd::presets().of(kind);
        for form in [TestForm::Plane, TestForm::Arc, TestForm::Ball] {
            for (across, tremble) in densities() {
                let trial = Trial { form, across, tremble, ..Trial::new(brush) };
                let (_, waviness) = trial.draw().crest();
                println!("{kind}, {form:?}, {across} across, {tremble:.4}: {waviness:.3} degrees");
                assert!(waviness <= 0.3, "{kind}, {form:?}, {across}: {waviness} degrees");
            }
        }
    }
}

#[test]
fn a_scraped_ridge_is_smooth_on_a_ball_along_a_curve_and_under_a_trembling_pen() {
    let brush = sculptd::presets().of(BrushKind::MultiplaneScrape);
    for form in [TestForm::Plane, TestForm::Arc, TestForm::Ball] {
        for (across, tremble) in densities() {
            let (_, waviness) = Trial { form, across, tremble, ..Trial::new(brush) }.draw().crest();
            println!("{form:?}, {across} across, {tremble:.4}: {waviness:.3} degrees");
            let most = if form == TestForm::Plane && tremble == 0.0 { 0.1 } else { 0.3 };
            assert!(waviness <= most, "{form:?}, {across}: {waviness} degrees");
        }
    }
}

#[test]
fn what_levels_or_evens_leaves_no_waves_on_a_ball() {
    for kind in [
        BrushKind::Flatten,
        BrushKind::Fill,
        BrushKind::Scrape,
        BrushKind::Trim,
        BrushKind::Plane,
        BrushKind::Smooth,
        BrushKind::SurfaceSmooth,
        BrushKind::Sharpen,
    ] {
        let trial = Trial { form: TestForm::Ball, ..Trial::new(sculptd::presets().of(kind)) };
        for (across, tremble) in densities() {
            let (height, waviness) = Trial { across, tremble, ..trial }.draw().crest();
            println!("{kind}, {across} across, {tremble:.4}: {waviness:.3} at {height:.5}");
            assert!(waviness <= 0.3, "{kind}, {across}: {waviness} degrees");
        }
    }
}

#[test]
fn strips_are_even_on_relief() {
    // The remaining relief along the middle of the strip, as a share of the original relief.
    let left = |kind: BrushKind| {
        let trial = Trial { across: 60, ..Trial::new(sculptd::presets().of(kind)) };
        let mut mesh = trial.form.mesh(trial.across);
        for p in &mut mesh.positions {
            p.z = 0.02 * (9.0 * p.x + 1.0).sin() * (8.0 * p.y).cos();
        }
        let mut studio = Studio::new(&mesh, trial.brush, 1);
        studio.tell(Command::Camera(Camera { orthographic: true, ..*studio.world.camera() }));
        let at = |i: i32| Vec3::new(0.008 * i as f32 - 0.6, 0.0, 0.0);
        let points: Vec<_> = (0..=150).map(|i| (studio.view(at(i)), 0.7)).collect();
        studio.stroke(&points);
        let spread = |all: &[Vec3]| {
            let near = all.iter().filter(|p| p.x.abs() < 0.4 && p.y.abs() < 0.3 * RADIUS);
            let (n, sum, squares) = near.fold((0.0, 0.0, 0.0), |(n, sum, squares), p| {
                (n + 1.0, sum + f64::from(p.z), squares + f64::from(p.z).powi(2))
            });
            (squares / n - (sum / n) * (sum / n)).max(0.0f64).sqrt()
        };
        spread(&studio.positions()) / spread(&mesh.positions)
    };
    let (strips, layer) = (left(BrushKind::ClayStrips), left(BrushKind::Layer));
    println!("{strips:.3} of the relief is left by clay strips, {layer:.3} by layer");
    // Blender 3.4's clay strips leave 0.53 after the same stroke.
    assert!(strips < 0.65, "{strips} of the relief is left");
    assert!(layer > 0.9, "a coat of even height keeps it: {layer}");
}

#[test]
fn surface_smooth_takes_ripples_away_and_keeps_the_height() {
    let trial = Trial::new(sculptd::presets().of(BrushKind::SurfaceSmooth));
    let mut mesh = trial.form.mesh(60);
    let mut dice = Dice(5);
    // A ridge as wide as the brush, and noise upon it.
    for p in &mut mesh.positions {
        p.z = 0.05 * (-p.y * p.y / (0.5 * RADIUS * RADIUS)).exp() + 0.001 * (dice.next() - 0.5);
    }
    let as_stroke = |all: &[Vec3]| Stroke(all.iter().map(|p| trial.form.measure(*p)).collect());
    let (height, before) = as_stroke(&mesh.positions).crest();
    let mut studio = Studio::new(&mesh, trial.brush, 1);
    studio.tell(Command::Camera(Camera { orthographic: true, ..*studio.world.camera() }));
    let points: Vec<(Vec2, f32)> = (0..=100)
        .map(|i| (studio.view(Vec3::new(0.012 * i as f32 - 0.6, 0.0, 0.0)), 0.7))
        .collect();
    for _ in 0..4 {
        studio.stroke(&points);
    }
    let (now, after) = as_stroke(&studio.positions()).crest();
    println!("{before:.3} degrees at {height:.4}, then {after:.3} at {now:.4}");
    assert!(after < 0.5 * before, "{before} degrees, then {after}");
    assert!((now - height).abs() < 0.01 * height, "{height} high, then {now}");
}

#[test]
fn layer_and_clay_strips_leave_a_flat_top() {
    for (kind, most) in [(BrushKind::Layer, 0.02), (BrushKind::ClayStrips, 0.03)] {
        let section = Trial::new(sculptd::presets().of(kind)).draw().section(0.6);
        println!("{kind}: {:.4} of {section:?}", flatness(&section));
        assert!(flatness(&section) <= most, "{kind}: {section:?}");
    }
}

#[test]
fn neither_the_rate_of_reports_nor_the_spacing_changes_the_surface() {
    use BrushKind::{Crease, MultiplaneScrape, Texture, Trim};
    for kind in RAISING.into_iter().chain([Crease, Texture, Trim, MultiplaneScrape]) {
        let forms = [TestForm::Plane, TestForm::Arc];
        for &form in &forms[..if crate::field::long() { 2 } else { 1 }] {
            let trial = Trial { form, across: 30, ..Trial::new(sculptd::presets().of(kind)) };
            any_rate_and_spacing(kind, trial);
        }
    }
}

fn any_rate_and_spacing(kind: BrushKind, trial: Trial) {
    let section = trial.draw().section(1.0);
    let height = section.iter().fold(0.0f32, |h, v| h.max(v.abs()));
    let rates = [60, 133, 266, 1000].map(|rate| Trial { rate, ..trial });
    let spaced = [0.03, 0.05, 0.1, 0.2].map(|spacing| {
        let mut other = trial;
        other.brush.spacing = spacing;
        other
    });
    for (i, other) in rates.iter().chain(&spaced).enumerate() {
        let now = other.draw().section(1.0);
        let off = now.iter().zip(&section).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("{kind}, {:?}, {i}: {:.2} % off", trial.form, off / height * 100.0);
        assert!(off < 0.02 * height, "{kind}, {:?}, {i}: {off} of {height}", trial.form);
    }
}

/// Returns the largest displacement of vertices relative to the brush's default spacing, over four
/// other spacings, as a share of the longest path of a vertex. The relief has these wave numbers in
/// x and y.
fn off_by_spacing(brush: BrushSettings, waves: Vec2) -> f32 {
    let relief = |p: Vec3| 0.02 * (p.x * waves.x).sin() * (p.y * waves.y + 0.4).sin();
    let (off, most) = off_and_way(brush, relief);
    off / most
}

/// Returns the largest displacement of vertices relative to the brush's default spacing, over four
/// other spacings, and the longest path of a vertex, on this relief.
fn off_and_way(brush: BrushSettings, mut relief: impl FnMut(Vec3) -> f32) -> (f32, f32) {
    let trial = Trial { across: 30, ..Trial::new(brush) };
    let mut mesh = trial.form.mesh(trial.across);
    for p in &mut mesh.positions {
        p.z += relief(*p);
    }
    // Away from the ends of the stroke, which lie where the last dab happens to.
    let inner: Vec<usize> =
        (0..mesh.positions.len()).filter(|i| mesh.positions[*i].x.abs() < 0.35).collect();
    let draw = |spacing: f32| {
        let mut brush = trial.brush;
        brush.spacing = spacing;
        let mut studio = Studio::new(&mesh, brush, 1);
        studio.tell(Command::Camera(Camera { orthographic: true, ..*studio.world.camera() }));
        let at = |i: i32| Vec3::new(0.008 * i as f32 - 0.6, 0.0, 0.0);
        let points: Vec<_> = (0..=150).map(|i| (studio.view(at(i)), 0.7)).collect();
        studio.stroke(&points);
        studio.positions()
    };
    let first = draw(trial.brush.spacing);
    let moved = inner.iter().map(|i| first[*i].distance(mesh.positions[*i]));
    let most = moved.fold(0.0, f32::max);
    let mut worst = 0.0f32;
    for spacing in [0.03, 0.05, 0.1, 0.2] {
        let other = draw(spacing);
        let off = inner.iter().map(|i| first[*i].distance(other[*i])).fold(0.0, f32::max);
        println!("{}, {spacing}: {:.2} % of {most:.4}", brush.kind, off / most * 100.0);
        worst = worst.max(off);
    }
    (worst, most)
}

#[test]
fn what_levels_or_draws_together_does_not_depend_on_the_spacing_either() {
    for kind in [BrushKind::Fill, BrushKind::Flatten, BrushKind::Scrape, BrushKind::Pinch] {
        let off = off_by_spacing(sculptd::presets().of(kind), Vec2::new(19.0, 23.0));
        assert!(off < 0.02, "{kind}: {off}");
    }
}

#[test]
fn a_knife_cuts_and_triangles_slide_as_far_with_any_spacing() {
    for kind in [BrushKind::Trim, BrushKind::SlideRelax] {
        for waves in [[19.0, 23.0], [9.0, 8.0], [3.0, 4.0], [12.0, 1.0]] {
            let off = off_by_spacing(sculptd::presets().of(kind), Vec2::from(waves));
            assert!(off < 0.02, "{kind} on {waves:?}: {off}");
        }
    }
}

#[test]
fn surface_smooth_leaves_the_same_surface_with_any_spacing() {
    let brush = sculptd::presets().of(BrushKind::SurfaceSmooth);
    // On what is smooth it does next to nothing, and the roundings of single precision are a good
    // part of that; so what is held is the surface that it leaves, as a share of its height.
    let gentle = |p: Vec3| 0.02 * (p.x * 9.0).sin() * (p.y * 8.0 + 0.4).sin();
    let mut dice = Dice(5);
    let rough = |p: Vec3| gentle(p) + 0.001 * (dice.next() - 0.5);
    for (name, (off, way)) in
        [("gentle", off_and_way(brush, gentle)), ("rough", off_and_way(brush, rough))]
    {
        println!("{name}: {off:.7} off, after a way of {way:.7}");
        assert!(off < 0.02 * 0.02, "{name}: {off}");
    }
}

#[test]
fn nor_does_what_raises_on_relief() {
    for kind in RAISING.into_iter().chain([BrushKind::Crease, BrushKind::MultiplaneScrape]) {
        let off = off_by_spacing(sculptd::presets().of(kind), Vec2::new(19.0, 23.0));
        assert!(off < 0.02, "{kind}: {off}");
    }
    // The rims of some alphas are steep and show any shift of a pattern. On still sharper relief,
    // coordinates along the surface fold, and a pattern mapped by them folds too.
    for alpha in Alpha::MADE {
        let brush = BrushSettings { alpha, ..sculptd::presets().of(BrushKind::Texture) };
        for waves in [Vec2::new(9.0, 8.0), Vec2::new(19.0, 23.0)] {
            let off = off_by_spacing(brush, waves);
            assert!(off < 0.01, "texture of {alpha:?} on {waves}: {off}");
        }
    }
}

#[test]
fn a_resting_pen_that_trembles_does_nothing_more() {
    let mesh = TestForm::Plane.mesh(20);
    for kind in BrushKind::ALL.iter().filter(|k| k.grip() == Grip::Surface) {
        let trial = Trial::new(sculptd::presets().of(*kind));
        let mut studio = Studio::new(&mesh, trial.brush, 1);
        let camera = Camera { orthographic: true, ..*studio.world.camera() };
        studio.tell(Command::Camera(camera));
        // Up to here the stroke has a direction; then two seconds at 125 reports each.
        for i in 0..20 {
            let at = Vec3::new(-0.4 + 0.02 * i as f32, 0.0, 0.0);
            studio.sample(studio.view(at), 0.7, true);
        }
        let (before, mut dice) = (studio.positions(), Dice(8));
        let mut dabs = 0;
        for _ in 0..250 {
            let mut off = || (dice.next() - 0.5) * TREMBLE;
            let at = Vec3::new(-0.02 + off(), off(), 0.0);
            dabs += studio.sample(studio.view(at), 0.7, true);
        }
        let after = studio.positions();
        let far = before.iter().zip(&after).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        println!("{kind}: {dabs} dabs while the pen rests, {far:.5} far");
        assert!(dabs <= 1, "{kind}: {dabs} dabs while the pen rests");
    }
}

#[test]
fn the_far_side_of_a_thin_plate_stays() {
    // A ball pressed to a plate 0.02 thick.
    let mut mesh = shapes::icosphere(1.0, 80);
    mesh.positions.iter_mut().for_each(|p| p.z *= 0.01);
    let surface = BrushKind::ALL.iter().copied().filter(|k| k.grip() == Grip::Surface);
    for kind in surface {
        let mut brush = sculptd::presets().of(kind);
        // The test identifies vertices by their numbers.
        brush.topology = TopologySettings::default();
        let mut studio = Studio::new(&mesh, brush, 1);
        let points: Vec<_> = (0..20).map(|i| Vec3::new(-0.3 + 0.03 * i as f32, 0.0, 0.0)).collect();
        let points: Vec<_> = points.into_iter().map(|p| (studio.view(p), 0.8)).collect();
        studio.stroke(&points);
        let far = mesh.positions.iter().zip(studio.positions());
        let far = far.filter(|(a, _)| a.z < 0.0 && a.truncate().length() < 0.8);
        let most = far.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        assert!(most == 0.0, "{kind}: the far side went {most}");
    }
}
