//! The clay as a stroke sees it: from a place over the view to dabs, with all their images.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::StepReport;
use super::images::Images;
use super::local_camera::LocalCamera;
use crate::stroke::{Flow, Laid, PenPoint, StrokeMethod, Surface};
use crate::topology_work::TopologyWork;
use sculptd_clay::brush::dab::{HEADING, SHARPEST};
use sculptd_clay::brush::options::IMAGES;
use sculptd_clay::brush::restore::Restore;
use sculptd_clay::brush::{
    BrushKind, BrushSettings, Dab, Grip, Measure, Method, Scratch, Tool, draw_face_sets,
};
use sculptd_clay::{Clay, DabReport, Detail, Hit, Ray, Reach, Workers};
use sculptd_geometry::portable::PortableMath;

/// Least cosine of the angle between the two averages of a stroke's direction at which it counts as
/// a bend; at a wider angle the stroke turned a corner.
const LEAST_COSINE: f32 = 0.5;
/// The way over which the pressure that counts may rise from nothing to all, in radii: a stroke
/// begins softly however hard the pen comes down after its first touch. It falls at once.
const ONSET: f32 = 0.35;
/// Strengths are those of a dab a fifth of the radius from the one before.
const FIFTH: f32 = 0.2;
/// Strings by which a brush follows the pen: the shortest and the longest, in heights of the view.
const STRINGS: (f32, f32) = (0.004, 0.05);

/// State of one pen's stroke, kept from dab to dab.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Stroke {
    /// Number of the stroke in this world, then its dabs so far.
    pub(super) number: u32,
    dabs: u32,
    /// Centre of the last dab.
    last: Option<Vec3>,
    travelled: f32,
    /// State of a held brush.
    held: Option<HeldStroke>,
    /// Ticks that the pen has rested.
    pub(super) rested: u32,
    /// Centre of the last dab on the surface that dabs are measured on.
    #[serde(default)]
    pub(super) last_measured: Option<Vec3>,
    /// The normal of the last dab, for showing only.
    #[serde(skip)]
    pub(super) last_normal: Vec3,
    /// The direction of the stroke, averaged over [`HEADING`] radii, of any length.
    #[serde(default)]
    heading: Vec3,
    /// The pressure that counts: it rises no faster than [`ONSET`] allows.
    #[serde(default)]
    pressure: f32,
    /// `heading`, averaged over as long a way once more.
    #[serde(default)]
    lagging: Vec3,
    /// The way that the two average, in radii.
    #[serde(default)]
    way: f32,
    /// The face set under the first dab of each image, where the brush keeps to it.
    #[serde(default)]
    sets: [Option<u16>; IMAGES],
    /// The face set that the stroke draws, once it is known: `Some(None)` where no number is left.
    #[serde(default)]
    draws: Option<Option<u16>>,
}

/// Point at which a held brush took hold, and its drag.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct HeldStroke {
    from: PenPoint,
    hit: Hit,
    drag: Vec3,
    /// Area of the dab that is not final yet, starting with its main ball.
    shown: Option<(Vec3, f32)>,
    /// The greatest pressure so far: what is not final until the pen lifts keeps it, so that it
    /// does not vanish with the pressure of the lifting pen.
    #[serde(default)]
    pressure: f32,
}

impl Stroke {
    pub(super) fn begin(&mut self, number: u32) {
        *self = Stroke { number, ..Stroke::default() };
    }

    /// [`Dab::course`] and [`Dab::bend`]. `heading` and `lagging` are averages, over one and over
    /// two windows, of a direction that turns evenly. Each gives the direction of a moment ago:
    /// half way into its window at the start of a stroke, one and two windows ago later. The angle
    /// between the two measures how fast the direction turns.
    fn course(&self, radius: f32) -> (Vec3, Vec3) {
        let straight = (self.heading, Vec3::ZERO);
        let (Some(heading), Some(lagging)) =
            (self.heading.try_normalize(), self.lagging.try_normalize())
        else {
            return straight;
        };
        let cosine = heading.dot(lagging);
        if cosine < LEAST_COSINE {
            return straight;
        }
        // The mean ages of what they average, in windows.
        let x = (self.way / HEADING).clamp(0.3, 20.0);
        let e = (-x).portable_exp();
        let one = 1.0 - x * e / (1.0 - e);
        let two = (2.0 - (x * x + 2.0 * x + 2.0) * e) / (1.0 - (1.0 + x) * e);
        // Little is known of a bend while the stroke is short.
        let turn = (heading * cosine - lagging) * ((1.0 - e) / (cosine * (two - one)));
        let course = (heading + turn * one).normalize_or_zero();
        let bend = (turn - course * turn.dot(course)) / (HEADING * radius);
        (course, bend.clamp_length_max(SHARPEST / radius))
    }
}

/// Cost of a page that a dab writes, in visited vertices of the dabs' budget, if the brush changes
/// topology. With the default budget of 400,000 the dabs of a tick take about six milliseconds on
/// one core.
const PAGE_VISITS: u64 = 640;

/// The clay while pens walk over it.
pub(super) struct StrokeContext<'a> {
    pub(super) mesh: &'a mut Clay,
    pub(super) workers: &'a Workers,
    pub(super) scratch: &'a mut Scratch,
    /// As the object sees it.
    pub(super) camera: LocalCamera<'a>,
    /// Strokes reach the object: it is neither hidden nor locked.
    pub(super) editable: bool,
    /// The brush that the stroke began with.
    pub(super) brush: BrushSettings,
    pub(super) middle: Vec3,
    pub(super) extent: f32,
    pub(super) report: &'a mut StepReport,
    pub(super) left: u64,
    pub(super) topology: &'a mut TopologyWork,
    pub(super) stroke: Stroke,
}

impl StrokeContext<'_> {
    fn radius(&self, pressure: f32) -> f32 {
        self.brush.radius * self.extent * self.brush.pressure_radius.factor(pressure)
    }

    /// A number between 0 and 1 that only the seed, the stroke, the dab and `salt` decide.
    fn dice(&self, salt: u32) -> f32 {
        let mut x = u64::from(self.brush.path.seed) << 32 | u64::from(self.stroke.number);
        x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ u64::from(self.stroke.dabs) << 8
            ^ u64::from(salt);
        // The finaliser of splitmix64.
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) >> 40) as f32 / (1u64 << 24) as f32
    }

    /// The pen's own direction, from its tip up, in the world.
    fn pen_direction(&self, tilt: Vec2) -> Vec3 {
        let (right, up) = self.camera.axes();
        let lean = Vec2::new(
            tilt.x.clamp(-1.4, 1.4).portable_tan(),
            tilt.y.clamp(-1.4, 1.4).portable_tan(),
        );
        (self.camera.backward() + right * lean.x - up * lean.y).normalize()
    }

    /// Returns the position and normal of a hit at the start of the stroke.
    fn as_found(&self, hit: &Hit) -> (Vec3, Vec3) {
        let page = self.mesh.before(hit.page);
        let mix = |[a, b, c]: [Vec3; 3]| {
            let [u, v, w] = hit.barycentric;
            a * u + b * v + c * w
        };
        let corners = page.triangles()[hit.triangle as usize].map(usize::from);
        let normal = mix(corners.map(|v| page.normal(v)));
        let normal = normal.try_normalize().unwrap_or(hit.normal);
        (mix(page.corners(hit.triangle as usize)), normal)
    }

    /// The face set that an image of the stroke keeps to: that under its first dab.
    fn first_set(&mut self, image: usize, hit: Option<&Hit>) -> u16 {
        if !self.brush.auto.face_sets {
            return 0;
        }
        let mesh = &*self.mesh;
        *self.stroke.sets[image].get_or_insert_with(|| hit.map_or(0, |h| mesh.set_at(h)))
    }

    /// The face set that the stroke draws, if its brush does: found at its first dab, `hit`. A new
    /// one has a number above those of all others, so that no stroke joins another by chance.
    fn drawn_set(&mut self, at: &PenPoint, hit: &Hit) -> Option<u16> {
        let s = &self.brush;
        if s.kind != BrushKind::DrawFaceSets {
            return None;
        }
        let mesh = &*self.mesh;
        *self.stroke.draws.get_or_insert_with(|| match s.extra[draw_face_sets::SET] as u16 {
            _ if s.negative != at.inverted => Some(mesh.set_at(hit)),
            0 => mesh.next_set(),
            set => Some(set),
        })
    }

    /// The stroke goes on to a dab at `centre`: its direction, the pressure that counts, and the
    /// way that the dab stands for, in fifths of the radius.
    fn go_on(&mut self, at: &PenPoint, centre: Vec3, radius: f32, share: f32) -> f32 {
        let s = &self.brush;
        let stroke = &mut self.stroke;
        let step = stroke.last_measured.map_or(Vec3::ZERO, |last| centre - last);
        stroke.last_measured = Some(centre);
        let way = step.length() / radius;
        stroke.way += way;
        let kept = (-way / HEADING).portable_exp();
        stroke.heading = stroke.heading * kept + step / radius;
        stroke.lagging = stroke.lagging * kept + stroke.heading * (1.0 - kept);
        let spaced =
            matches!(self.way(), StrokeMethod::Spaced | StrokeMethod::Line | StrokeMethod::Curve);
        let stroke = &mut self.stroke;
        // A dab that did not move (the first of a run, or that of a resting pen) stands for a
        // spacing, and one that is strewn for its share of one.
        let measured = spaced && s.path.jitter <= 0.0 && way > 1e-3 * s.spacing;
        let way = if measured { way.min(s.spacing) } else { s.spacing * share };
        let first = stroke.dabs == 0;
        let most = if first { 1.0 } else { stroke.pressure + way / ONSET };
        stroke.pressure = at.pressure.min(most);
        if s.path.compensate && spaced { way / FIFTH } else { share }
    }

    /// One dab and its images. `share`: of the strength. `drag`: what a held brush was drawn, now
    /// and before.
    fn one_dab(
        &mut self,
        at: &PenPoint,
        hit: &Hit,
        radius: f32,
        share: f32,
        drag: Option<(Vec3, Vec3)>,
    ) {
        self.mesh.begin_step();
        let brush = self.brush;
        let s = &brush;
        let cuts = s.topology.by != Measure::Off && s.kind.cuts() && self.mesh.layer_count() == 0;
        let found = s.kind.found() && !s.accumulate && !cuts;
        let (centre, normal) = if found { self.as_found(hit) } else { (hit.position, hit.normal) };
        let normal = match at.tilt {
            Some(tilt) if s.tilt > 0.0 => {
                normal.lerp(self.pen_direction(tilt), s.tilt).try_normalize().unwrap_or(normal)
            }
            _ => normal,
        };
        let moved = self.stroke.last.map_or(Vec3::ZERO, |last| hit.position - last);
        // Measured where dabs are: where the stroke raised the clay, its places lie aside of those.
        let measured = self.stroke.last_measured.map_or(Vec3::ZERO, |last| centre - last);
        let mut span = share;
        if drag.is_none() {
            self.stroke.travelled += moved.length();
            self.stroke.last = Some(hit.position);
            self.stroke.last_normal = normal;
            span = self.go_on(at, centre, radius, share);
        }
        let pressure = if drag.is_none() { self.stroke.pressure } else { at.pressure };
        let strength = s.strength * s.pressure_strength.factor(pressure);
        let (motion, last) = drag.unwrap_or((measured, Vec3::ZERO));
        let ray = self.camera.ray(at.view);
        let (course, bend) = self.stroke.course(radius);
        let first = Dab {
            settings: s,
            centre,
            normal,
            touch: hit.position,
            found,
            radius,
            strength,
            span,
            pace: 0.0,
            heading: self.stroke.heading,
            course,
            bend,
            pass: 0,
            sign: if s.negative != at.inverted { -1.0 } else { 1.0 },
            motion,
            last,
            eye: -ray.dir,
            right: self.camera.axes().0,
            lens: self.camera.lens(),
            hand: 1.0,
            image: 0,
            travelled: self.stroke.travelled,
            stroke: self.stroke.number,
            set: self.first_set(0, Some(hit)),
            draws: self.drawn_set(at, hit),
        };
        let first = Dab { pace: first.pace_of(strength), ..first };
        let mut dabs = [first; IMAGES];
        let mut count = 1;
        for (i, image) in Images::of(s, self.middle, self.extent).each().iter().enumerate().skip(1)
        {
            let (touch, centre) = (image.at(hit.position), image.at(centre));
            let normal = image.m * normal;
            // The same view from the mirrored eye. On a symmetric work it hits the mirrored point
            // exactly; otherwise the brush uses the surface found there.
            let there =
                self.mesh.pick(Ray { origin: image.at(ray.origin), dir: image.m * ray.dir });
            let held = drag.is_some();
            let (touch, centre, normal) = match there {
                _ if held => (touch, centre, normal),
                Some(h) if (h.position - touch).length() < radius * 1e-3 => (touch, centre, normal),
                Some(h) if found => {
                    let (centre, normal) = self.as_found(&h);
                    (h.position, centre, normal)
                }
                Some(h) => (h.position, h.position, h.normal),
                None => continue,
            };
            dabs[count] = Dab {
                image: i,
                centre,
                normal,
                touch,
                heading: image.m * first.heading,
                course: image.m * course,
                bend: image.m * bend,
                motion: image.m * motion,
                last: image.m * last,
                eye: image.m * first.eye,
                right: image.m * first.right,
                lens: first.lens.image(image.m, image.t),
                hand: image.hand,
                set: self.first_set(i, there.as_ref()),
                ..first
            };
            count += 1;
        }
        self.stroke.dabs += 1;
        self.stroke.rested = 0;
        if !(strength > 0.0) {
            return;
        }
        let mut tool = Tool {
            mesh: self.mesh,
            workers: self.workers,
            scratch: self.scratch,
            report: DabReport::default(),
        };
        s.kind.apply(&dabs[..count], &mut tool);
        let done = tool.report;
        self.report.dabs += count as u64;
        self.report.vertices_moved += done.moved as u64;
        // If topology changes, each dab is a separate pass over its pages, and their rings are less
        // regular: the pages dominate the cost.
        let pages = if cuts { PAGE_VISITS * done.pages as u64 } else { 0 };
        self.left = self.left.saturating_sub(done.affected as u64 + 1 + pages);
        self.ask_for_topology(&dabs[..count], hit);
    }

    /// Asks for the wanted size of triangles under a dab and its images, where the brush is set to.
    fn ask_for_topology(&mut self, dabs: &[Dab<'_>], hit: &Hit) {
        let t = &self.brush.topology;
        let measure = match t.by {
            Measure::Off => return,
            Measure::Brush => dabs[0].radius,
            Measure::Work => self.extent,
            Measure::View => self.world_per_view(hit),
        };
        let path = self.brush.path.method;
        let counts =
            self.brush.saturation > 0.0 || matches!(path, Method::Anchored | Method::DragDot);
        // Triangles of an object with layers stay: what a layer does is kept by vertex.
        if counts || !self.brush.kind.cuts() || self.mesh.layer_count() > 0 {
            return;
        }
        for dab in dabs {
            self.topology.add(Detail {
                centre: dab.centre,
                radius: dab.radius,
                edge: t.edge * measure,
                split: t.split,
                collapse: t.collapse,
            });
        }
    }

    /// A place strewn about a hit, in its tangent plane, and the surface there.
    fn strewn(&mut self, hit: &Hit, radius: f32) -> Hit {
        let j = self.brush.path.jitter;
        if j <= 0.0 {
            return *hit;
        }
        let (angle, far) = (self.dice(1) * std::f32::consts::TAU, self.dice(2).sqrt() * j * radius);
        let (u, v) = hit.normal.any_orthonormal_pair();
        let aside = hit.position + (u * angle.portable_cos() + v * angle.portable_sin()) * far;
        let down = Ray { origin: aside + hit.normal * radius, dir: -hit.normal };
        self.mesh
            .pick(down)
            .filter(|h| (h.position - aside).length() < 2.0 * radius)
            .unwrap_or(*hit)
    }

    /// Takes back the dab that is not final, and all its images.
    fn take_back(&mut self, held: &mut HeldStroke) {
        let Some((centre, radius)) = held.shown.take() else { return };
        for image in Images::of(&self.brush, self.middle, self.extent).each() {
            let centre = image.at(centre);
            let reach = Reach::Sphere { centre, radius: radius * 2.5 };
            let done =
                self.mesh.dab(&reach, &Restore { centre, radius: radius * 1.01 }, self.workers);
            self.left = self.left.saturating_sub(done.affected as u64 + 1);
        }
    }

    /// Returns the drag of a pen at `at`, parallel to the view at the depth where it took hold.
    fn drawn(&self, held: &HeldStroke, at: &PenPoint) -> Vec3 {
        let (right, up) = self.camera.axes();
        let scale = self.world_per_view(&held.hit);
        let d = at.view - held.from.view;
        right * (d.x * self.camera.aspect() * scale) - up * (d.y * scale)
    }

    fn move_held(&mut self, mut held: HeldStroke, at: &PenPoint) -> HeldStroke {
        let drag = self.drawn(&held, at);
        held.pressure = held.pressure.max(at.pressure);
        let firm = PenPoint { pressure: held.pressure, ..*at };
        let at = if self.brush.kind.grip() == Grip::Tow { at } else { &firm };
        match (self.brush.path.method, self.brush.kind.grip()) {
            (Method::Anchored, Grip::Surface) => {
                self.take_back(&mut held);
                let radius = drag.length().min(self.extent * 2.0);
                if radius > self.extent * 1e-3 {
                    self.one_dab(at, &held.hit, radius, 1.0, Some((drag, held.drag)));
                    held.shown = Some((held.hit.position, radius));
                }
            }
            (Method::DragDot, Grip::Surface) => {
                self.take_back(&mut held);
                if let Some(hit) = self.pick(at.view) {
                    let radius = self.radius(at.pressure);
                    self.one_dab(at, &hit, radius, 1.0, Some((drag - held.drag, Vec3::ZERO)));
                    held.shown = Some((hit.position, radius));
                }
            }
            (_, Grip::Tow) => {
                // In steps that are short against the brush, each from where the last one left the
                // clay.
                let radius = self.radius(at.pressure);
                let whole = drag - held.drag;
                let steps =
                    (whole.length() / (radius * self.brush.spacing)).ceil().clamp(1.0, 4096.0);
                let by = whole / steps;
                for _ in 0..steps as usize {
                    self.one_dab(at, &held.hit, radius, 1.0, Some((by, Vec3::ZERO)));
                    held.hit.position += by;
                }
            }
            _ => {
                // The radius is that of the start: later pressure does not change how much is held.
                let radius = self.radius(held.from.pressure);
                self.one_dab(at, &held.hit, radius, 1.0, Some((drag, held.drag)));
            }
        }
        held.drag = drag;
        held
    }
}

impl Surface for StrokeContext<'_> {
    fn pick(&mut self, view: Vec2) -> Option<Hit> {
        self.mesh.pick(self.camera.ray(view)).filter(|_| self.editable)
    }

    fn spacing(&self, at: &PenPoint) -> f32 {
        self.radius(at.pressure) * self.brush.spacing
    }

    fn string(&mut self, at: &PenPoint) -> f32 {
        if !(self.brush.steady > 0.0) {
            return 0.0;
        }
        let Some(hit) = self.pick(at.view) else { return STRINGS.0 };
        let radius = self.radius(1.0) / self.world_per_view(&hit).max(1e-20);
        (radius * self.brush.steady).clamp(STRINGS.0, STRINGS.1)
    }

    fn world_per_view(&self, hit: &Hit) -> f32 {
        let depth = (self.camera.eye() - hit.position).dot(self.camera.backward());
        self.camera.world_per_view(depth.max(1e-6))
    }

    fn way(&self) -> StrokeMethod {
        match (self.brush.kind.grip(), self.brush.path.method) {
            (Grip::Anchor | Grip::Tow, _) => StrokeMethod::Held,
            (Grip::Surface, Method::Anchored | Method::DragDot) => StrokeMethod::Held,
            (Grip::Surface, Method::Space | Method::Airbrush) => StrokeMethod::Spaced,
            (Grip::Surface, Method::Dots) => StrokeMethod::Each,
            (Grip::Surface, Method::Line) => StrokeMethod::Line,
            (Grip::Surface, Method::Curve) => StrokeMethod::Curve,
        }
    }

    fn hold(&mut self, at: &PenPoint, began: bool) -> Flow {
        if began {
            self.stroke.held = self.pick(at.view).map(|hit| {
                self.mesh.begin_step();
                HeldStroke { from: *at, hit, drag: Vec3::ZERO, shown: None, pressure: 0.0 }
            });
            if self.brush.path.method != Method::DragDot {
                return Flow::Go;
            }
        }
        if let Some(held) = self.stroke.held {
            let held = self.move_held(held, at);
            self.stroke.held = Some(held);
        }
        if self.left == 0 { Flow::Pause } else { Flow::Go }
    }

    fn drop(&mut self, ray: Ray, far: f32) -> Option<Hit> {
        self.mesh.pick(ray).filter(|h| self.editable && h.t <= far)
    }

    fn dab(&mut self, at: &PenPoint, hit: &Hit, laid: Laid) -> Flow {
        let radius = self.radius(at.pressure);
        if laid.first && self.way() != StrokeMethod::Each {
            // Nothing leads over from the run before.
            self.stroke.last = None;
            self.stroke.last_measured = None;
        }
        let hit = self.strewn(hit, radius);
        if laid.tap {
            self.stroke.pressure = at.pressure;
        }
        self.one_dab(at, &hit, radius, laid.share, None);
        if self.left == 0 { Flow::Pause } else { Flow::Go }
    }
}

/// Returns true if the brush lays dabs while a pen rests.
pub(super) fn goes_on_by_time(brush: &BrushSettings) -> bool {
    let path = &brush.path;
    let spaced = matches!(path.method, Method::Space | Method::Airbrush | Method::Dots);
    brush.kind.grip() == Grip::Surface
        && spaced
        && (path.continuous || path.method == Method::Airbrush)
}
