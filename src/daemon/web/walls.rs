//! The map of wall thickness that pages show: one thread measures the active object's walls for all
//! of them, on one core, and only while a page shows them.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use arc_swap::{ArcSwap, ArcSwapOption};
use crossbeam_channel as cc;
use serde::Serialize;

use super::locked;
use crate::Published;
use sculptd_clay::live_thickness::LiveMap;
use sculptd_clay::{Ranks, Snapshot};
use sculptd_engine::scene::ObjectId;
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::MeasuredSide;

/// Vertices that are measured before pages see what is known.
const BATCH: usize = 40_000;
/// Least time between two maps.
const PAUSE: Duration = Duration::from_millis(50);
/// Share of the values below the high end of the scale, as in the window: a few thick places do
/// not press the others together.
const HIGH: f64 = 0.98;

/// The walls of one state of the clay, as far as they are known.
#[derive(Debug)]
pub struct WallMap {
    pub object: ObjectId,
    /// Number of its clay.
    pub clay: u32,
    /// One value for each row of each page, in the world's unit; NaN: none, or none yet.
    pub pages: Vec<Arc<[f32]>>,
    pub scale: WallScale,
}

/// Content of a legend, lengths in the world's unit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct WallScale {
    /// The thinnest wall.
    pub low: f32,
    /// 98 % of the vertices have thinner walls.
    pub high: f32,
    /// Share of the vertices that are measured, 0 to 1.
    pub measured: f32,
}

/// The map that is shown, and how many pages show it.
#[derive(Debug, Default)]
pub struct Walls {
    newest: ArcSwapOption<WallMap>,
    wanted: Mutex<WallReaders>,
}

#[derive(Debug, Default)]
struct WallReaders {
    pages: usize,
    is_running: bool,
}

/// A page that shows the map; dropped when it does not any more.
#[derive(Debug)]
pub struct WallsWanted(Arc<Walls>);

impl Drop for WallsWanted {
    fn drop(&mut self) {
        locked(&self.0.wanted).pages -= 1;
    }
}

impl Walls {
    /// Asks for the map, and starts the thread that measures it where none runs.
    pub fn want(
        self: &Arc<Self>,
        published: &Arc<ArcSwap<Published>>,
        stop: &Arc<AtomicBool>,
    ) -> WallsWanted {
        let mut wanted = locked(&self.wanted);
        wanted.pages += 1;
        if !wanted.is_running {
            let (walls, published, stop) = (self.clone(), published.clone(), stop.clone());
            let run = move || walls.follow(&published, &stop);
            match std::thread::Builder::new().name("sculptd-page-walls".into()).spawn(run) {
                Ok(_) => wanted.is_running = true,
                Err(e) => tracing::error!("web: walls cannot be measured: {e}"),
            }
        }
        drop(wanted);
        WallsWanted(self.clone())
    }

    /// Returns the newest map; `None` before the first.
    pub fn measured_map(&self) -> Option<Arc<WallMap>> {
        self.newest.load_full()
    }

    /// True once no page wants the map: the thread ends, and the next page starts another.
    fn is_over(&self, stop: &AtomicBool) -> bool {
        let mut wanted = locked(&self.wanted);
        wanted.is_running = wanted.pages > 0 && !stop.load(Relaxed);
        if !wanted.is_running {
            self.newest.store(None);
        }
        !wanted.is_running
    }

    fn follow(&self, published: &ArcSwap<Published>, stop: &AtomicBool) {
        let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => pool,
            Err(e) => {
                locked(&self.wanted).is_running = false;
                return tracing::error!("web: walls cannot be measured: {e}");
            }
        };
        let job = Job::default();
        let mut map: Option<(LiveMap, Ranks)> = None;
        let mut pages = Vec::new();
        // The state whose walls are all measured.
        let mut done = None;
        while !self.is_over(stop) {
            let state = published.load_full();
            let (mesh, unit) = (&state.mesh, state.transform().scale as f32);
            let now = (state.clay_revision(), unit);
            let Some(object) = state.scene.active().map(|o| o.id).filter(|_| done != Some(now))
            else {
                pause();
                continue;
            };
            let newer = |m: &mut (LiveMap, Ranks)| pool.install(|| m.0.advance(mesh)).is_ok();
            if !map.as_mut().is_some_and(newer) {
                let made = pool.install(|| LiveMap::new(mesh, MeasuredSide::Wall, &job));
                map = made.ok().map(|made| (made, mesh.ranks()));
                pages.clear();
            }
            // Clay without walls: the next state may have some.
            let Some((live, ranks)) = &mut map else {
                self.newest.store(None);
                done = Some(now);
                pause();
                continue;
            };
            let near = state.transform().inverse().point(state.camera.target);
            let left = pool.install(|| live.work(near, BATCH, &job)).unwrap_or(0);
            values_by_page(mesh, live.values(), ranks, unit, &mut pages);
            let scale = scale_of(live.values(), unit, left);
            let (clay, pages) = (mesh.object_id(), pages.clone());
            self.newest.store(Some(Arc::new(WallMap { object, clay, pages, scale })));
            done = Some(now).filter(|_| left == 0);
            pause();
        }
    }
}

/// Waits before the next look.
fn pause() {
    let _ = cc::after(PAUSE).recv();
}

/// The values times `unit` by page and row; a page with the same bits as before stays the same.
fn values_by_page(
    mesh: &Snapshot,
    all: &[f32],
    ranks: &Ranks,
    unit: f32,
    pages: &mut Vec<Arc<[f32]>>,
) {
    pages.truncate(mesh.page_count());
    let mut ids: Vec<u32> = Vec::new();
    for (i, page) in mesh.pages().enumerate() {
        // The own vertices, then the copies of the neighbours'.
        let topology = page.topology();
        ids.clear();
        ids.extend(&topology.ids[..topology.own]);
        for (home, part) in topology.halo_parts() {
            let theirs = &mesh.page(home).topology().ids;
            ids.extend(topology.halo_sources[part].iter().map(|v| theirs[usize::from(*v)]));
        }
        let value = |id: &u32| {
            let row = ranks.find(*id).and_then(|row| all.get(row as usize));
            row.map_or(f32::NAN, |v| v * unit)
        };
        let same = |old: &Arc<[f32]>| {
            old.len() == ids.len()
                && old.iter().zip(&ids).all(|(o, id)| o.to_bits() == value(id).to_bits())
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

fn scale_of(values: &[f32], unit: f32, left: usize) -> WallScale {
    let mut known: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let measured = (values.len() - left.min(values.len())) as f32 / values.len().max(1) as f32;
    if known.is_empty() {
        return WallScale { measured, ..WallScale::default() };
    }
    let low = known.iter().copied().fold(f32::INFINITY, f32::min);
    let at = ((known.len() - 1) as f64 * HIGH) as usize;
    let high = *known.select_nth_unstable_by(at, f32::total_cmp).1;
    WallScale { low: low * unit, high: high * unit, measured }
}

/// The part of the map that one browser has.
#[derive(Debug, Default)]
pub struct SentWalls {
    map: Option<Arc<WallMap>>,
    sent: Vec<Option<Arc<[f32]>>>,
    waiting: VecDeque<u32>,
}

impl SentWalls {
    /// Takes a newer map: the pages that differ wait for their turn.
    pub fn follow(&mut self, map: Option<Arc<WallMap>>) {
        if self.map.as_ref().map(Arc::as_ptr) == map.as_ref().map(Arc::as_ptr) {
            return;
        }
        let of = |m: &Arc<WallMap>| (m.object, m.clay);
        if self.map.as_ref().map(of) != map.as_ref().map(of) {
            self.sent.clear();
        }
        self.map = map;
        let now: &[Arc<[f32]>] = self.map.as_ref().map_or(&[], |m| m.pages.as_slice());
        self.sent.resize(now.len(), None);
        let differs = |p: &u32| {
            let sent = &self.sent[*p as usize];
            !sent.as_ref().is_some_and(|sent| Arc::ptr_eq(sent, &now[*p as usize]))
        };
        self.waiting = (0..now.len() as u32).filter(differs).collect();
    }

    /// The browser received a page again, without its walls.
    pub fn forget(&mut self, object: ObjectId, page: u32) {
        if self.map.as_ref().is_some_and(|m| m.object == object)
            && let Some(sent) = self.sent.get_mut(page as usize)
        {
            *sent = None;
            self.waiting.push_back(page);
        }
    }

    /// The browser may lack any of them.
    pub fn clear(&mut self) {
        *self = SentWalls::default();
    }

    /// Returns true if there are walls to send.
    pub fn wait(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Returns the next page that the browser has, and its values. `rows`: the rows of a page of
    /// this object and clay there; `None` where it has none yet.
    pub fn next(
        &mut self,
        rows: impl Fn(ObjectId, u32, u32) -> Option<usize>,
    ) -> Option<(ObjectId, u32, Arc<[f32]>)> {
        let map = self.map.clone()?;
        while let Some(page) = self.waiting.pop_front() {
            let (Some(values), Some(sent)) =
                (map.pages.get(page as usize), self.sent.get_mut(page as usize))
            else {
                continue;
            };
            // Another number of rows: a newer map or the page itself is on its way.
            if rows(map.object, map.clay, page) == Some(values.len()) {
                *sent = Some(values.clone());
                return Some((map.object, page, values.clone()));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: &[&[f32]]) -> Arc<WallMap> {
        let pages = values.iter().map(|v| Arc::from(*v)).collect();
        Arc::new(WallMap { object: ObjectId(0), clay: 1, pages, scale: WallScale::default() })
    }

    #[test]
    fn only_pages_that_differ_and_that_the_browser_has_are_sent() {
        let first = map(&[&[1.0], &[2.0, 3.0]]);
        let mut sent = SentWalls::default();
        sent.follow(Some(first.clone()));
        let has = |_, _, page| (page == 1).then_some(2);
        assert_eq!(sent.next(has).map(|(.., page, _)| page), Some(1));
        assert!(sent.next(has).is_none());
        // The page that was not there comes, and its walls follow.
        sent.forget(ObjectId(0), 0);
        assert_eq!(sent.next(|_, _, _| Some(1)).map(|(.., page, _)| page), Some(0));
        let pages = vec![first.pages[0].clone(), Arc::from([2.0, 4.0].as_slice())];
        let newer = WallMap { object: ObjectId(0), clay: 1, pages, scale: first.scale };
        sent.follow(Some(Arc::new(newer)));
        assert_eq!(sent.next(|_, _, page| Some(page as usize + 1)).map(|p| p.1), Some(1));
        assert!(!sent.wait());
        sent.follow(None);
        assert!(sent.next(|_, _, _| Some(1)).is_none());
    }

    #[test]
    fn every_row_of_a_page_has_the_value_of_its_vertex() {
        let mesh = sculptd_geometry::shapes::icosphere(1.0, 32);
        let mut clay = sculptd_clay::Clay::build(&mesh, &Job::default()).expect("clay");
        let snapshot = clay.snapshot();
        let all: Vec<f32> = mesh.positions.iter().map(|p| p.x).collect();
        let mut pages = Vec::new();
        values_by_page(&snapshot, &all, &snapshot.ranks(), 2.0, &mut pages);
        for (page, values) in snapshot.pages().zip(&pages) {
            assert_eq!(values.len(), page.point_rows().len());
            for (row, value) in values.iter().enumerate() {
                assert_eq!(*value, 2.0 * page.point(row).x);
            }
        }
    }

    #[test]
    fn the_scale_leaves_out_the_few_thickest_and_what_is_not_known() {
        let mut values: Vec<f32> = (1..=100).map(|v| v as f32).collect();
        values.push(f32::NAN);
        let scale = scale_of(&values, 2.0, 1);
        assert_eq!((scale.low, scale.high), (2.0, 196.0));
        assert!((scale.measured - 100.0 / 101.0).abs() < 1e-6);
        assert_eq!(scale_of(&[f32::NAN], 1.0, 1), WallScale::default());
    }
}
