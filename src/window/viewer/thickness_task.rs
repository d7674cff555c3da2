//! The thread that keeps the live map of walls or of gaps of the newest clay.

use std::sync::Arc;

use crossbeam_channel as cc;
use glam::Vec3;

use super::distance_reference::DistanceReference;
use super::latest_wins::Request;
use super::pages::MapValues;
use super::wall_probe::WallBall;
use crate::panels::state::{ThicknessSummary, ThinSpot, WallChangeSummary};
use sculptd_clay::Snapshot;
use sculptd_clay::live_thickness::LiveMap;
use sculptd_engine::hand::Similarity;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::changes::EarlierVersion;
use sculptd_geometry::thickness::{MeasuredSide, ThicknessSettings};

/// Request to the thickness thread: the newest clay, the position of the brush, and the limit below
/// which a wall is too thin or a gap too narrow.
#[derive(Debug, Clone)]
pub(super) struct ThicknessRequest {
    pub(super) mesh: Snapshot,
    /// Transform from the clay to the world, in whose unit walls are measured.
    pub(super) transform: ObjectTransform,
    pub(super) near: Vec3,
    pub(super) side: MeasuredSide,
    pub(super) limit: f32,
    /// The place and the normal, in the world, where the ball in the wall is wanted.
    pub(super) probe: Option<(Vec3, Vec3)>,
    /// The form with whose walls they are compared.
    pub(super) earlier: Option<DistanceReference>,
}

/// A request in short: the clay, the side, the limit, its transform, the place under the pointer,
/// and the form that it is compared with, by its revision and its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AskedWalls {
    pub(super) clay: (u32, u64),
    pub(super) side: MeasuredSide,
    pub(super) limit: f32,
    pub(super) transform: ObjectTransform,
    pub(super) probe: Option<Vec3>,
    pub(super) earlier: Option<((u32, u64), Similarity)>,
}

/// Report of the thread.
#[derive(Debug)]
pub enum WallReport {
    /// The map of a side as far as it is known.
    Map(MeasuredSide, MapValues, Box<ThicknessSummary>),
    /// The ball that was asked for.
    Ball(Option<WallBall>),
    /// The change of walls.
    Changes(MapValues, WallChangeSummary),
}

/// Vertices measured before the thread looks for a newer request: some ten milliseconds.
const BATCH: usize = 40_000;

/// Keeps the map of the newest clay until the window is gone: until `say` returns `false`.
pub(super) fn follow(
    requests: &cc::Receiver<Request<ThicknessRequest>>,
    say: &dyn Fn(WallReport) -> bool,
) {
    // One worker is left to the loop.
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads((cores - 1).max(1)).build() else {
        return;
    };
    let job = Job::default();
    let mut map: Option<LiveMap> = None;
    let mut pages: Vec<Arc<[f32]>> = Vec::new();
    let mut compared = ComparedWalls::default();
    // Of what was said last.
    let mut said = None;
    while let Ok((mut wanted, _)) = requests.recv() {
        loop {
            let follows = |m: &mut LiveMap| {
                m.side() == wanted.side && pool.install(|| m.advance(&wanted.mesh)).is_ok()
            };
            if !map.as_mut().is_some_and(follows) {
                map = pool.install(|| LiveMap::new(&wanted.mesh, wanted.side, &job)).ok();
                (pages, said) = (Vec::new(), None);
            }
            let Some(map) = &mut map else { return };
            let left = pool.install(|| map.work(wanted.near, BATCH, &job)).unwrap_or(0);
            let unit = wanted.transform.scale as f32;
            let clay = (wanted.mesh.object_id(), wanted.mesh.revision());
            let now = Some((clay, wanted.limit, wanted.transform));
            if left > 0 || said != now {
                collect_pages(&wanted.mesh, map.values(), unit, &mut pages);
                let about = Box::new(about(&wanted, map, left));
                let values = MapValues { pages: pages.clone() };
                if !say(WallReport::Map(map.side(), values, about)) {
                    return;
                }
                said = now.filter(|_| left == 0);
            }
            if let Some((place, normal)) = wanted.probe {
                let ball = map.ball(wanted.transform.inverse().point(place));
                let ball = ball.map(|d| WallBall { place, normal, diameter: d * unit });
                if !say(WallReport::Ball(ball)) {
                    return;
                }
            }
            if left == 0
                && let Some(report) = pool.install(|| compared.with(&wanted, map, &job))
                && !say(report)
            {
                return;
            }
            match requests.try_recv() {
                Ok((newer, _)) => wanted = newer,
                Err(_) if left > 0 => {}
                Err(_) => break,
            }
        }
    }
}

/// The comparison of the clay's walls with an earlier form.
#[derive(Default)]
struct ComparedWalls {
    to: Option<(DistanceReference, Similarity, ObjectTransform, EarlierVersion)>,
    /// The state of the clay that was compared last.
    clay: Option<(u32, u64)>,
    pages: Vec<Arc<[f32]>>,
}

impl ComparedWalls {
    /// Compares a measured map with the form that is wanted; `None` where nothing is new.
    fn with(&mut self, wanted: &ThicknessRequest, map: &LiveMap, job: &Job) -> Option<WallReport> {
        let earlier = wanted.earlier.as_ref()?;
        let (place, transform) = (earlier.place(), wanted.transform);
        let same = self
            .to
            .as_ref()
            .is_some_and(|(to, p, t, _)| to.same(earlier) && *p == place && *t == transform);
        if !same {
            // In the frame of the clay; an earlier state of it is there already.
            let mut mesh = (*earlier.in_own_frame()).clone();
            if !matches!(earlier, DistanceReference::Before(_)) {
                let back = transform.inverse();
                mesh.positions.iter_mut().for_each(|p| *p = back.point(place.apply(*p)));
            }
            let reach = mesh.positions.iter().fold(0.0f32, |m, p| m.max(p.abs().max_element()));
            let settings = ThicknessSettings::default();
            let made = EarlierVersion::new(&mesh, reach * ROUNDINGS, &settings, job).ok()?;
            self.to = Some((earlier.clone(), place, transform, made));
        }
        let clay = (wanted.mesh.object_id(), wanted.mesh.revision());
        if same && self.clay == Some(clay) {
            return None;
        }
        self.clay = Some(clay);
        let (.., version) = self.to.as_ref()?;
        let values = map.changes(version, job).ok()?;
        let unit = transform.scale as f32;
        self.pages.clear();
        collect_pages(&wanted.mesh, &values, unit, &mut self.pages);
        let mut known: Vec<(f32, u32)> = values
            .iter()
            .zip(0..)
            .filter(|v| v.0.is_finite())
            .map(|(v, i)| (v * unit, i))
            .collect();
        known.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let rounding = reach_of(&wanted.mesh) * ROUNDINGS * unit;
        let thinner = known.partition_point(|k| k.0 < -rounding);
        let about = WallChangeSummary {
            thinned: known.first().map_or(0.0, |k| k.0.min(0.0)),
            thickened: known.last().map_or(0.0, |k| k.0.max(0.0)),
            compared: known.len() as f32 / values.len().max(1) as f32,
            spots: spots(wanted, &known[..thinner.min(MOST_PLACES)], values.len()),
        };
        Some(WallReport::Changes(MapValues { pages: self.pages.clone() }, about))
    }
}

/// Differences up to this share of the largest coordinate are rounding.
const ROUNDINGS: f32 = 1e-5;

fn reach_of(mesh: &Snapshot) -> f32 {
    let (lo, hi) = mesh.bounds();
    lo.abs().max(hi.abs()).max_element()
}

/// The values times `unit` by page; a page with the same bits as before stays the same.
fn collect_pages(mesh: &Snapshot, values: &[f32], unit: f32, pages: &mut Vec<Arc<[f32]>>) {
    pages.truncate(mesh.page_count());
    for (i, page) in mesh.pages().enumerate() {
        let ids = &page.topology().ids[..page.own()];
        let value = |id: &u32| values.get(*id as usize).map_or(f32::NAN, |v| v * unit);
        let same = |old: &Arc<[f32]>| {
            old.len() == ids.len()
                && old.iter().zip(ids).all(|(o, id)| o.to_bits() == value(id).to_bits())
        };
        if !pages.get(i).is_some_and(same) {
            let new: Arc<[f32]> = ids.iter().map(value).collect();
            match pages.get_mut(i) {
                Some(slot) => *slot = new,
                None => pages.push(new),
            }
        }
    }
}

/// Spots listed, and places from which they are chosen.
const SPOTS: usize = 5;
const MOST_PLACES: usize = 20_000;

/// The first of the places in order of their values, each at least a tenth of the object's size
/// from the others. `count`: all vertices.
fn spots(wanted: &ThicknessRequest, ranked: &[(f32, u32)], count: usize) -> Vec<ThinSpot> {
    let (lo, hi) = wanted.mesh.bounds();
    let apart = (hi - lo).length() * 0.05 * wanted.transform.scale as f32;
    let mut places = vec![None; count];
    for &(_, id) in ranked {
        places[id as usize] = Some(Vec3::NAN);
    }
    for page in wanted.mesh.pages() {
        for (v, &id) in page.topology().ids[..page.own()].iter().enumerate() {
            if places.get(id as usize).is_some_and(Option::is_some) {
                places[id as usize] = Some(wanted.transform.point(page.point(v)));
            }
        }
    }
    let mut spots: Vec<ThinSpot> = Vec::new();
    for &(thickness, id) in ranked {
        let Some(place) = places[id as usize] else { continue };
        if spots.len() < SPOTS && spots.iter().all(|s| s.place.distance(place) > apart) {
            spots.push(ThinSpot { place, thickness });
        }
    }
    spots
}

fn about(wanted: &ThicknessRequest, map: &LiveMap, left: usize) -> ThicknessSummary {
    let values = map.values();
    let unit = wanted.transform.scale as f32;
    let mut known: Vec<(f32, u32)> = values
        .iter()
        .enumerate()
        .filter(|(_, v)| v.is_finite())
        .map(|(i, v)| (v * unit, i as u32))
        .collect();
    known.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // By area: a vertex of a coarse part stands for more than one of a fine one.
    let (mut whole, mut until) = (0.0f64, Vec::with_capacity(known.len()));
    for &(_, id) in &known {
        whole += f64::from(map.areas()[id as usize]);
        until.push(whole);
    }
    let at = |share: f64| {
        let k = until.partition_point(|area| *area < whole * share);
        known.get(k.min(known.len().max(1) - 1)).map_or(0.0, |k| k.0)
    };
    let (min, max, high) = (at(0.0), at(1.0), at(0.98));
    let mut histogram = vec![0.0f32; ThicknessSummary::CLASSES];
    let span = (high - min).max(1e-12);
    for (v, id) in &known {
        let class = ((v - min) / span * ThicknessSummary::CLASSES as f32) as usize;
        histogram[class.min(ThicknessSummary::CLASSES - 1)] += map.areas()[*id as usize];
    }
    let below = known.partition_point(|k| k.0 < wanted.limit);
    let area_below = below.checked_sub(1).map_or(0.0, |last| until[last]);
    let spots = spots(wanted, &known[..below.min(MOST_PLACES)], values.len());
    ThicknessSummary {
        min,
        max,
        high,
        median: at(0.5),
        measured: values.len() - left,
        vertices: values.len(),
        below: if whole > 0.0 { (area_below / whole) as f32 } else { 0.0 },
        histogram,
        spots,
    }
}
