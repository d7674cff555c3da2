//! `sculptd bench`: can this machine hold this mesh at this rate?
//!
//! First single dabs on the bare clay, each phase by itself; then a stroke through the real
//! `World::step` with one pen sample and one published snapshot a tick, at the loop's rate.

use std::path::PathBuf;
use std::sync::OnceLock;

use glam::{Vec2, Vec3};
use serde::Serialize;

use super::{Fail, Outcome, answer};
use sculptd_clay::brush::stamp::Lens;
use sculptd_clay::brush::{
    BrushKind, BrushSettings, Dab, Measure, PressureCurve, Scratch, Tool, TopologySettings,
};
use sculptd_clay::{
    Clay, Cuts, DabReport, Detail, Hit, PhaseTimes, Ray, Reach, Workers, bytes_to_build,
};
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::pacer::Pacer;
use sculptd_daemon::tick_statistics::{Percentiles, TickStatistics, thread_cpu_ns};
use sculptd_devices::{Body, Clock, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::HandSettings;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

#[derive(Debug, clap::Args)]
pub struct BenchArgs {
    /// The mesh to sculpt.
    #[arg(long, value_name = "FILE", conflicts_with = "vertices")]
    pub mesh: Option<PathBuf>,
    /// Or a ball of about this many vertices.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub vertices: u64,
    /// Vertices that one dab is to affect, about.
    #[arg(long, value_name = "K", default_value_t = 10_000)]
    pub affected: usize,
    /// The brush to measure, with its preset; `turns` alternates between gaussian and smooth.
    #[arg(long, value_name = "NAME", default_value = "gaussian")]
    pub brush: BenchBrush,
    /// Dynamic topology with edges of this share of the radius, under single dabs (all of it done
    /// within the dab) and under the stroke (in the tick's budget); 0.002 to 1.
    #[arg(long, value_name = "EDGE")]
    pub topology: Option<f32>,
    /// Single dabs to measure.
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub dabs: usize,
    /// Ticks a second of the stroke; 0 leaves the stroke out.
    #[arg(long, value_name = "HZ", default_value_t = 120)]
    pub rate: u32,
    /// Seconds of stroke.
    #[arg(long = "for", value_name = "S", default_value_t = 2.0)]
    pub seconds: f64,
    /// Threads; 0 takes what the machine has.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub workers: usize,
}

/// The measured brush: one, or two in alternation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BenchBrush {
    One(BrushKind),
    Turns,
}

impl std::str::FromStr for BenchBrush {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "turns" => Ok(BenchBrush::Turns),
            name => name.parse().map(BenchBrush::One),
        }
    }
}

impl BenchBrush {
    fn kind(self, turn: usize) -> BrushKind {
        match self {
            BenchBrush::One(kind) => kind,
            BenchBrush::Turns if turn % 2 == 0 => BrushKind::Gaussian,
            BenchBrush::Turns => BrushKind::Smooth,
        }
    }

    /// Returns the brush's preset. Brushes that raise the surface get a small strength, so that the
    /// form lasts.
    fn settings(self, turn: usize) -> BrushSettings {
        let kind = self.kind(turn);
        let preset = crate::presets().of(kind);
        let strength = match kind {
            BrushKind::Gaussian => 0.02,
            BrushKind::Smooth => 0.5,
            _ => preset.strength,
        };
        BrushSettings { strength, spacing: 0.2, ..preset }
    }
}

#[derive(Debug, Serialize)]
struct Spread {
    p50: f64,
    p99: f64,
}

#[derive(Debug, Serialize)]
struct Phases {
    pick: Spread,
    query: Spread,
    displace: Spread,
    normals: Spread,
    bvh: Spread,
    publish: Spread,
    undo: Spread,
    topology: Spread,
}

/// Edges changed by a single dab, on average.
#[derive(Debug, Serialize)]
struct TopologyChanges {
    splits: f64,
    collapses: f64,
    flips: f64,
}

#[derive(Debug, Serialize)]
struct BenchAnswer {
    vertices: usize,
    triangles: usize,
    affected: usize,
    ns_per_affected_vertex: f64,
    dab_us: Spread,
    first_dab_us: f64,
    /// With `--topology`: of the dabs of the first way along the arc, each of which comes upon clay
    /// that is not yet as fine or coarse as is wanted.
    fresh_dab_us: Spread,
    phases_us: Phases,
    topology_a_dab: TopologyChanges,
    vertices_at_end: usize,
    tick_ms: Percentiles,
    tick_cpu_ms: Percentiles,
    tick_dabs: u64,
    tick_affected: f64,
    ticks: u64,
    late_ticks: u64,
    bytes_per_vertex: f64,
    read_s: f64,
    load_s: f64,
    workers: usize,
    tree_growth: f32,
}

fn clock() -> &'static Clock {
    static CLOCK: OnceLock<Clock> = OnceLock::new();
    CLOCK.get_or_init(Clock::monotonic)
}

fn now_ns() -> u64 {
    clock().now_ns()
}

/// Median and 99th percentile, nanoseconds to microseconds.
fn spread(mut of: Vec<u64>) -> Spread {
    of.sort_unstable();
    let at = |q: f64| of.get(((of.len() as f64 * q) as usize).min(of.len().saturating_sub(1)));
    let us = |q| at(q).map_or(0.0, |&ns| ns as f64 / 1e3);
    Spread { p50: us(0.5), p99: us(0.99) }
}

pub fn run(args: &BenchArgs, json: bool) -> Outcome {
    let begun = now_ns();
    let plain = input(args)?;
    let read_s = (now_ns() - begun) as f64 / 1e9;
    let begun = now_ns();
    let mut mesh = Clay::build(&plain, &Job::default()).map_err(|e| Fail::Input(e.to_string()))?;
    let load_s = (now_ns() - begun) as f64 / 1e9;
    drop(plain);
    let workers =
        Workers::new(LoopConfig { workers: args.workers, ..LoopConfig::default() }.worker_count());
    workers.warm();
    let bytes_per_vertex = mesh.memory().at_rest() as f64 / mesh.vertex_count() as f64;
    mesh.set_clock(now_ns);

    let radius = radius_for(&mesh, args.affected);
    let dabs = single_dabs(&mut mesh, args, radius, &workers);
    let (vertices, triangles) = (mesh.vertex_count(), mesh.triangle_count());
    let stroke = stroke(mesh, args, radius, workers);
    let mean = |sum: usize| sum as f64 / dabs.total.len().max(1) as f64;
    let topology_a_dab = TopologyChanges {
        splits: mean(dabs.cuts.splits),
        collapses: mean(dabs.cuts.collapses),
        flips: mean(dabs.cuts.flips),
    };

    let affected = dabs.affected / dabs.total.len().max(1);
    let phase = |of: fn(&PhaseTimes) -> u64| spread(dabs.phases.iter().map(of).collect());
    let dab_us = spread(dabs.total.clone());
    let report = BenchAnswer {
        vertices,
        triangles,
        affected,
        ns_per_affected_vertex: dab_us.p50 * 1e3 / affected.max(1) as f64,
        dab_us,
        first_dab_us: dabs.first as f64 / 1e3,
        fresh_dab_us: spread(dabs.fresh),
        phases_us: Phases {
            pick: phase(|p| p.pick),
            query: phase(|p| p.query),
            displace: phase(|p| p.displace),
            normals: phase(|p| p.normals),
            bvh: phase(|p| p.bvh),
            publish: phase(|p| p.publish),
            undo: phase(|p| p.undo),
            topology: spread(dabs.topology),
        },
        topology_a_dab,
        vertices_at_end: stroke.vertices,
        tick_ms: stroke.figures.tick_ms(),
        tick_cpu_ms: stroke.figures.tick_cpu_ms(),
        tick_dabs: stroke.figures.dabs,
        tick_affected: stroke.figures.vertices_moved as f64 / stroke.figures.dabs.max(1) as f64,
        ticks: stroke.figures.ticks,
        late_ticks: stroke.figures.overruns,
        bytes_per_vertex,
        read_s,
        load_s,
        workers: stroke.workers,
        tree_growth: stroke.tree_growth,
    };
    answer(json, &report, |out| {
        writeln!(
            out,
            "clay     {vertices} vertices, {bytes_per_vertex:.0} bytes each, made in {load_s:.2} s"
        )?;
        writeln!(
            out,
            "dab      {affected} vertices: {:.0} us, {:.0} at p99; {:.1} ns a vertex; the first \
             one {:.0} us",
            report.dab_us.p50,
            report.dab_us.p99,
            report.ns_per_affected_vertex,
            report.first_dab_us
        )?;
        let p = &report.phases_us;
        for (name, s) in [
            ("pick", &p.pick),
            ("query", &p.query),
            ("displace", &p.displace),
            ("normals", &p.normals),
            ("bvh", &p.bvh),
            ("publish", &p.publish),
            ("undo", &p.undo),
            ("topology", &p.topology),
        ] {
            writeln!(out, "  {name:<9}{:8.1} us  p99 {:8.1}", s.p50, s.p99)?;
        }
        let (c, fresh) = (&report.topology_a_dab, &report.fresh_dab_us);
        if fresh.p50 > 0.0 {
            writeln!(
                out,
                "fresh    {:.0} us, {:.0} at p99, on clay to be cut",
                fresh.p50, fresh.p99
            )?;
        }
        writeln!(
            out,
            "edges    {:.0} split, {:.0} collapsed, {:.0} flipped a dab; {} vertices at the end",
            c.splits, c.collapses, c.flips, report.vertices_at_end
        )?;
        let t = &report.tick_ms;
        writeln!(
            out,
            "ticks    {} at {} Hz, {} dabs: p50 {:.2} ms, p99 {:.2}, max {:.2}; {} late",
            report.ticks, args.rate, report.tick_dabs, t.p50, t.p99, t.max, report.late_ticks
        )
    });
    Ok(())
}

fn input(args: &BenchArgs) -> Result<TriMesh, Fail> {
    let Some(path) = &args.mesh else {
        let (v, t) = (args.vertices, args.vertices * 2);
        // The ball itself is made through tables of about its size again.
        super::memory::room_for(bytes_to_build(v, t), &format!("a ball of {v} vertices"))?;
        return Ok(shapes::sphere_of_about(args.vertices as usize));
    };
    let loaded = sculptd_geometry::io::read_mesh(path, &Job::default())?;
    let (plain, _) = loaded.mesh.triangulate();
    let need = bytes_to_build(plain.positions.len() as u64, plain.triangles.len() as u64);
    super::memory::room_for(need, &path.display().to_string())?;
    Ok(plain)
}

/// A ray at the clay's middle from the side of `towards`.
fn ray_from(mesh: &Clay, towards: Vec3) -> Ray {
    let (lo, hi) = mesh.bounds();
    Ray { origin: (lo + hi) * 0.5 + towards * (hi - lo).length(), dir: -towards }
}

/// Path of the single dabs.
#[derive(Debug, Clone, Copy)]
enum DabPath {
    /// A spiral over the whole ball, neighbours a small step apart.
    Spiral,
    /// An arc on a great circle in both directions, neighbours a fifth of the radius apart. If dabs
    /// change topology, each dab must find the clay cut as finely as on a mesh of any other size.
    Arc {
        /// The brush's radius as an angle of the ball.
        radius: f32,
    },
}

/// Radii from one dab of a stroke to the next.
const STEP: f32 = 0.2;
/// Radii from one end of the arc to the other.
const ARC: f32 = 8.0;

impl DabPath {
    fn new(args: &BenchArgs, mesh: &Clay, radius: f32) -> DabPath {
        let (lo, hi) = mesh.bounds();
        match args.topology {
            Some(_) => DabPath::Arc { radius: radius / ((hi - lo).max_element() * 0.5) },
            None => DabPath::Spiral,
        }
    }

    /// The direction of dab `i`, seen from the middle.
    fn direction(self, i: usize) -> Vec3 {
        match self {
            DabPath::Spiral => direction(i),
            DabPath::Arc { radius } => {
                let at = (i as f32 * STEP) % (2.0 * ARC);
                let turn = at.min(2.0 * ARC - at) * radius;
                Vec3::new(turn.cos(), 0.0, turn.sin())
            }
        }
    }
}

fn direction(i: usize) -> Vec3 {
    let t = i as f32 * 0.01;
    let height = (t * 0.37).sin() * 0.9;
    let flat = (1.0 - height * height).sqrt();
    Vec3::new(flat * t.cos(), height, flat * t.sin())
}

/// The radius within which `affected` vertices lie, where the first dab goes.
fn radius_for(mesh: &Clay, affected: usize) -> f32 {
    let (lo, hi) = mesh.bounds();
    let (mut small, mut large) = (0.0, (hi - lo).length());
    let centre = mesh.pick(ray_from(mesh, direction(0))).map_or((lo + hi) * 0.5, |h| h.position);
    for _ in 0..40 {
        let radius = (small + large) * 0.5;
        let mut count = 0;
        mesh.each_vertex(&Reach::Sphere { centre, radius }, |_, _, _| count += 1);
        if count < affected { small = radius } else { large = radius }
    }
    large
}

#[derive(Debug, Default)]
struct Dabs {
    fresh: Vec<u64>,
    total: Vec<u64>,
    phases: Vec<PhaseTimes>,
    topology: Vec<u64>,
    cuts: Cuts,
    affected: usize,
    first: u64,
}

/// Dabs a stroke: one undo step.
const STROKE: usize = 50;

/// A dab of a stroke that goes on by a fifth of the radius.
fn one_dab<'a>(
    settings: &'a BrushSettings,
    path: DabPath,
    hit: &Hit,
    ray: &Ray,
    sign: f32,
    i: usize,
) -> Dab<'a> {
    let radius = settings.radius;
    let way = path.direction(i + 1) - path.direction(i);
    let flat = way - hit.normal * way.dot(hit.normal);
    let along = flat.try_normalize().unwrap_or_else(|| hit.normal.any_orthonormal_vector());
    let right = ray.dir.any_orthonormal_vector();
    let dab = Dab {
        settings,
        centre: hit.position,
        normal: hit.normal,
        touch: hit.position,
        found: settings.kind.found() && !settings.accumulate,
        radius,
        strength: settings.strength,
        span: 1.0,
        pace: 0.0,
        heading: along * 0.5,
        course: along,
        bend: Vec3::ZERO,
        pass: 0,
        sign,
        motion: along * (0.2 * radius),
        last: Vec3::ZERO,
        eye: -ray.dir,
        right,
        lens: Lens {
            eye: ray.origin,
            right,
            up: right.cross(ray.dir),
            back: -ray.dir,
            half: 0.4,
            parallel: false,
        },
        hand: 1.0,
        image: 0,
        travelled: 0.2 * radius * i as f32,
        stroke: (i / STROKE) as u32 + 1,
        set: 0,
        draws: None,
    };
    Dab { pace: dab.pace_of(settings.strength), ..dab }
}

fn single_dabs(mesh: &mut Clay, args: &BenchArgs, radius: f32, workers: &Workers) -> Dabs {
    let mut out = Dabs::default();
    let mut snapshot = None;
    let mut scratch = Scratch::default();
    let path = DabPath::new(args, mesh, radius);
    for i in 0..args.dabs {
        let ray = ray_from(mesh, path.direction(i));
        let before = mesh.phases();
        let t0 = now_ns();
        let hit = mesh.pick(ray);
        let t1 = now_ns();
        let Some(hit) = hit else { continue };
        mesh.begin_step();
        let settings = BrushSettings { radius, ..args.brush.settings(i / STROKE) };
        let mut tool = Tool { mesh, workers, scratch: &mut scratch, report: DabReport::default() };
        // Out and in by turns, so that the form lasts however long the measurement.
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        settings.kind.apply(&[one_dab(&settings, path, &hit, &ray, sign, i)], &mut tool);
        let report = tool.report;
        let t2 = now_ns();
        if let Some(edge) = args.topology {
            let (edge, centre) = (edge * radius, hit.position);
            let ball = Detail { centre, radius, edge, split: true, collapse: true };
            let cuts = mesh.adapt_topology(&[ball], usize::MAX, workers);
            out.cuts.splits += cuts.splits;
            out.cuts.collapses += cuts.collapses;
            out.cuts.flips += cuts.flips;
        }
        out.topology.push(now_ns() - t2);
        if i % STROKE == STROKE - 1 {
            mesh.end_step();
        }
        // Like a reader, release the last snapshot once the next one exists.
        snapshot.replace(mesh.snapshot());
        let total = now_ns() - t0;
        let after = mesh.phases();
        out.phases.push(PhaseTimes {
            pick: t1 - t0,
            query: after.query - before.query,
            displace: after.displace - before.displace,
            normals: after.normals - before.normals,
            bvh: after.bvh - before.bvh,
            publish: after.publish - before.publish,
            undo: after.undo - before.undo,
        });
        if out.total.is_empty() {
            out.first = total;
        }
        out.total.push(total);
        if args.topology.is_some() && (1..(ARC / STEP) as usize).contains(&i) {
            out.fresh.push(total);
        }
        out.affected += report.affected;
    }
    mesh.end_step();
    out
}

struct Stroke {
    figures: TickStatistics,
    workers: usize,
    tree_growth: f32,
    vertices: usize,
}

/// A pen that circles over the view, one dab's distance a tick, through the world.
fn stroke(mesh: Clay, args: &BenchArgs, radius: f32, workers: Workers) -> Stroke {
    let count = workers.count();
    let (lo, hi) = mesh.bounds();
    let extent = (hi - lo).length() * 0.5;
    let firm = PressureCurve { at_zero: 1.0, gamma: 1.0 };
    let settings = |turn: usize, negative: bool| {
        let brush = args.brush.settings(turn);
        let topology = args.topology.map_or(brush.topology, |edge| TopologySettings {
            by: Measure::Brush,
            edge,
            ..brush.topology
        });
        BrushSettings {
            radius: radius / extent,
            negative,
            pressure_radius: firm,
            pressure_strength: firm,
            topology,
            ..brush
        }
        .clamped()
    };
    let options =
        WorldOptions { dab_budget: u64::MAX, undo_bytes: 1 << 28, hands: HandSettings::default() };
    let mut world = World::new(mesh, Camera::default(), settings(0, false), workers, options);
    let mut figures = TickStatistics::default();
    let mut pacer = Pacer::new(args.rate.max(1), now_ns() / 1000);
    let sleeper = spin_sleep::SpinSleeper::default();
    let ticks = (f64::from(args.rate) * args.seconds) as u64;
    let area = Vec2::new(160.0 * world.camera().aspect, 160.0);
    let depth = (world.camera().distance - extent).max(extent * 0.1);
    let step = radius * 0.22 / world.camera().world_per_view(depth);
    let (mut angle, mut shown) = (0.0f32, None);
    for tick in 1..=ticks {
        pacer.wait(clock(), &sleeper);
        let ring = 0.15 + 0.1 * (tick as f32 * 0.001).sin();
        angle += step / ring;
        let at = Vec2::new(0.5, 0.5)
            + Vec2::new(angle.cos() / world.camera().aspect, angle.sin()) * ring;
        // The pen lifts twice a second: a stroke is an undo step.
        let half = u64::from(args.rate).div_ceil(2).max(2);
        let sample = Sample {
            device: DeviceId(1),
            t_us: tick * 1_000_000 / u64::from(args.rate.max(1)),
            device_t_us: None,
            body: Body::Pen(Pen {
                in_range: true,
                tip: tick % half != 0,
                pos_mm: at * area,
                area_mm: area,
                pressure: Some(0.5),
                ..Pen::default()
            }),
        };
        let turn = (tick / half) as usize;
        let change = [Command::Brush(settings(turn / 2, turn % 2 == 1))];
        let commands = if tick % half == 1 { &change[..] } else { &[] };
        let (begun, begun_cpu) = (now_ns(), thread_cpu_ns());
        let report = *world.step(tick, &[sample], commands);
        shown.replace(world.snapshot());
        let took = now_ns() - begun;
        figures.tick(&report, took, thread_cpu_ns() - begun_cpu);
        pacer.done(clock().now_us());
        figures.overruns = pacer.overruns;
    }
    Stroke {
        figures,
        workers: count,
        tree_growth: world.mesh().tree_growth(),
        vertices: world.mesh().vertex_count(),
    }
}
