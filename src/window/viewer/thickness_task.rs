//! The thread that keeps the live thickness map of the newest clay.

use std::sync::Arc;

use crossbeam_channel as cc;
use glam::Vec3;

use super::latest_wins::Request;
use super::pages::MapValues;
use crate::panels::state::{ThicknessSummary, ThinSpot};
use sculptd_clay::Snapshot;
use sculptd_clay::live_thickness::LiveMap;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::job::Job;

/// Request to the thickness thread: the newest clay, the position of the brush, and the thickness
/// below which a wall is too thin.
#[derive(Debug, Clone)]
pub(super) struct ThicknessRequest {
    pub(super) mesh: Snapshot,
    /// Transform from the clay to the world, in whose unit walls are measured.
    pub(super) transform: ObjectTransform,
    pub(super) near: Vec3,
    pub(super) limit: f32,
}

/// Vertices measured before the thread looks for a newer request: some ten milliseconds.
const BATCH: usize = 40_000;

/// Keeps the map of the newest clay until the window is gone: until `say`, which takes the map and
/// its summary, returns `false`.
pub(super) fn follow(
    requests: &cc::Receiver<Request<ThicknessRequest>>,
    say: &dyn Fn(MapValues, ThicknessSummary) -> bool,
) {
    // One worker is left to the loop.
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads((cores - 1).max(1)).build() else {
        return;
    };
    let job = Job::default();
    let mut map: Option<LiveMap> = None;
    let mut pages: Vec<Arc<[f32]>> = Vec::new();
    while let Ok((mut wanted, _)) = requests.recv() {
        loop {
            if map.as_mut().is_none_or(|m| pool.install(|| m.advance(&wanted.mesh)).is_err()) {
                map = pool.install(|| LiveMap::new(&wanted.mesh, &job)).ok();
                pages.clear();
            }
            let Some(map) = &mut map else { return };
            let left = pool.install(|| map.work(wanted.near, BATCH, &job)).unwrap_or(0);
            let unit = wanted.transform.scale as f32;
            gather(&wanted.mesh, map.values(), unit, &mut pages);
            if !say(MapValues { pages: pages.clone() }, about(&wanted, map, left)) {
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

/// The values times `unit` by page; a page with the same bits as before stays the same.
fn gather(mesh: &Snapshot, values: &[f32], unit: f32, pages: &mut Vec<Arc<[f32]>>) {
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

/// Spots listed.
const SPOTS: usize = 5;

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
    let at = |share: f64| {
        known.get(((known.len().max(1) - 1) as f64 * share) as usize).map_or(0.0, |k| k.0)
    };
    let (min, max, high) = (at(0.0), at(1.0), at(0.98));
    let mut histogram = vec![0u32; ThicknessSummary::CLASSES];
    let span = (high - min).max(1e-12);
    for (v, _) in &known {
        let class = ((v - min) / span * ThicknessSummary::CLASSES as f32) as usize;
        histogram[class.min(ThicknessSummary::CLASSES - 1)] += 1;
    }
    // The thinnest places, each at least a tenth of the object's size from the others.
    let (lo, hi) = wanted.mesh.bounds();
    let apart = (hi - lo).length() * 0.05 * unit;
    let mut places = vec![None; values.len()];
    let below = known.partition_point(|k| k.0 < wanted.limit);
    let thin = &known[..below.min(20_000)];
    for &(_, id) in thin {
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
    for &(thickness, id) in thin {
        let Some(place) = places[id as usize] else { continue };
        if spots.len() < SPOTS && spots.iter().all(|s| s.place.distance(place) > apart) {
            spots.push(ThinSpot { place, thickness });
        }
    }
    ThicknessSummary {
        min,
        max,
        high,
        median: at(0.5),
        measured: values.len() - left,
        vertices: values.len(),
        below: below as f32 / known.len().max(1) as f32,
        histogram,
        spots,
    }
}
