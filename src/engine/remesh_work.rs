//! A part of an object gets triangles of one size: where it was stretched, or what is seen in a
//! region.
//!
//! Laws kept here:
//! * The pages follow in counted portions, as those of every edit of an object do
//!   ([`crate::surface_edit`]); strokes wait until the last one has followed.
//! * Masked, hidden and border vertices stay. The new triangles join the kept ones edge by edge:
//!   there is no rim.
//! * No vertex that is kept moves but where two become one, which then lies between both: the
//!   surface stays where it was to within the square of an edge over the radius of its curvature.

use glam::Vec3;

use crate::local_remesh::{LocalRemesh, WantedEdge};
use crate::region_seen::RegionSeen;
use crate::scene::SceneError;
use sculptd_clay::{Clay, Detail, LEAST_TOPOLOGY_BUDGET, Workers};

/// Greatest ratio between the requested edge length and the usual one. A typing error could
/// otherwise make a hundred times the triangles.
const EDGE_RANGE: f32 = 16.0;
/// Most triangles that an object may have afterwards: about 5 GB of clay.
const MOST_TRIANGLES: f32 = 1e8;
/// Most triangles that may be made of a whole object. Strokes wait meanwhile, up to half a minute.
const MOST_NEW: f32 = 8e6;
/// Counted work of a tick, in the units of dynamic topology: some three milliseconds on two cores.
/// Strokes wait, so it is more than they leave.
const TICK_BUDGET: usize = 24_000;
/// Vertices that are looked at in the time of one operation.
const LOOKED: u64 = 10;
/// Cost of testing a vertex, as in [`RegionSeen::cost`], from which on a pass takes twice the time
/// that it counts.
const COSTLY: u64 = 8;
/// Number of pages that one pass works on, one task each.
const TOGETHER: usize = 3;
/// Pages that are known to have something to do, at most: among them some lie apart.
const KNOWN: usize = 32;
/// The first time through the pages edges are split down to this power of two times the wanted
/// length, then to half of that, until all have it: where fine triangles meet coarse ones at once,
/// vertices come to have as many neighbours as they may, and then nothing about them can be split.
const COARSEST: u32 = 3;
/// Most rounds over the pages at the target length. Each round visits the pages changed by the
/// previous one. Each operation brings edges nearer to their length or widens an angle, so the
/// rounds end by themselves; the bound guards against rounding.
const ROUNDS: u32 = 12;
/// Most edges sampled to estimate the usual length.
const SAMPLED: usize = 4096;

/// Remesh work that remains.
#[derive(Debug)]
pub(crate) struct RemeshWork {
    seen: Option<RegionSeen>,
    edge: f32,
    collapse: bool,
    /// The next page to be looked at.
    next: usize,
    /// Pages that have something to do.
    todo: Vec<u32>,
    /// For each page that there was at first, whether it has something of the region.
    region: Vec<bool>,
    /// Counted work of a page's task at most: less where pages would grow too much at once.
    page_budget: usize,
    /// The power of two times the wanted length that edges are split down to.
    coarse: u32,
    /// The longest edge of the pages that were looked through this time, before anything was split.
    longest: f32,
    round: u32,
    /// The clay's revision when this round began, and when the one before did.
    revisions: [u64; 2],
    /// Edges that were changed.
    changes: u32,
}

impl RemeshWork {
    /// Prepares the requested remesh of this clay.
    ///
    /// # Errors
    /// [`SceneError::Edge`] if the edge length is out of range, [`SceneError::Fine`] if it would
    /// make too many triangles, [`SceneError::KeptByVertex`] if the clay has layers.
    pub(crate) fn new(
        asked: &LocalRemesh,
        seen: Option<RegionSeen>,
        clay: &mut Clay,
    ) -> Result<RemeshWork, SceneError> {
        if clay.layer_count() > 0 {
            return Err(SceneError::KeptByVertex);
        }
        let usual = usual_edge(clay).ok_or(SceneError::Edge)?;
        let edge = match asked.edge {
            WantedEdge::Length(edge) => edge,
            WantedEdge::OfUsual(times) => usual * times,
        };
        if !(edge >= usual / EDGE_RANGE && edge <= usual * EDGE_RANGE) {
            return Err(SceneError::Edge);
        }
        let finer = (usual / edge) * (usual / edge);
        let (now, then) = (clay.triangle_count() as f32, clay.triangle_count() as f32 * finer);
        if then > MOST_TRIANGLES || (seen.is_none() && then - now > MOST_NEW) {
            return Err(SceneError::Fine);
        }
        clay.prepare_topology();
        Ok(RemeshWork {
            seen,
            edge,
            collapse: !asked.stretched_only,
            next: 0,
            todo: Vec::with_capacity(KNOWN),
            region: vec![true; clay.page_count()],
            page_budget: TICK_BUDGET,
            coarse: COARSEST,
            longest: 0.0,
            round: 0,
            revisions: [clay.revision(); 2],
            changes: 0,
        })
    }

    /// Does what fits in a tick; how many edges were changed in all, once all is done.
    pub(crate) fn run(&mut self, clay: &mut Clay, workers: &Workers) -> Option<u32> {
        self.work(clay, workers, TICK_BUDGET)
    }

    /// Does all that is left.
    pub(crate) fn finish(&mut self, clay: &mut Clay, workers: &Workers) -> u32 {
        self.work(clay, workers, usize::MAX).unwrap_or(self.changes)
    }

    fn work(&mut self, clay: &mut Clay, workers: &Workers, budget: usize) -> Option<u32> {
        let mut left = budget;
        // With less a pass might get nowhere.
        while left >= LEAST_TOPOLOGY_BUDGET {
            let looked = self.choose(clay);
            left = left.saturating_sub(looked + 1);
            let more = self.next < clay.page_count();
            if self.todo.is_empty() && !more && self.next_round(clay) {
                return Some(self.changes);
            }
            if self.todo.is_empty() || (self.todo.len() < KNOWN && more) {
                continue;
            }
            let seen = self.seen.as_ref();
            let weight = 1 + (seen.map_or(0, RegionSeen::cost) / COSTLY) as usize;
            let most = (left / (weight * LEAST_TOPOLOGY_BUDGET)).clamp(1, TOGETHER);
            let apart = clay.pages_apart(self.todo.iter().copied(), most);
            let mut wanted: Vec<_> = apart.iter().map(|&p| (p, self.ball(clay, p))).collect();
            // A region goes all the way through: where a place faces decides nothing.
            let holds = |p| seen.is_none_or(|s| s.holds(p, Vec3::ZERO));
            let within = seen.is_some().then_some(&holds as _);
            let budget = (left / (weight * apart.len())).max(LEAST_TOPOLOGY_BUDGET);
            let budget = budget.min(self.page_budget);
            let (done, unfinished) = clay.adapt_pages(&mut wanted, within, budget, workers);
            left = left.saturating_sub(done.work * weight + 1);
            self.changes = self.changes.saturating_add(done.changes() as u32);
            if done.tangled && self.page_budget > LEAST_TOPOLOGY_BUDGET {
                self.page_budget = LEAST_TOPOLOGY_BUDGET;
                continue;
            }
            self.page_budget = TICK_BUDGET;
            for (at, page) in apart.iter().enumerate() {
                if done.tangled || unfinished >> at & 1 == 0 {
                    self.todo.retain(|p| p != page);
                }
            }
        }
        None
    }

    /// Begins the next round; true where all is done.
    fn next_round(&mut self, clay: &Clay) -> bool {
        let changed = clay.revision() > self.revisions[0];
        match self.coarse {
            0 if !changed || self.round == ROUNDS => return true,
            0 => self.round += 1,
            // Down to where there is something to split again.
            coarse => {
                let times = self.longest / (self.edge * (4.0 / 3.0));
                let power = (0..coarse).find(|p| times <= (1u32 << *p) as f32);
                self.coarse = power.map_or(coarse - 1, |p| p.saturating_sub(1));
            }
        }
        (self.next, self.longest) = (0, 0.0);
        self.revisions = [clay.revision(), self.revisions[0]];
        false
    }

    /// Returns true if a page is visited in this round.
    fn concerns(&self, clay: &Clay, page: u32) -> bool {
        match self.round {
            0 | 1 => self.region.get(page as usize).is_none_or(|r| *r),
            _ => clay.page(page).revision() > self.revisions[1],
        }
    }

    /// The ball about a page with all that its edges reach.
    fn ball(&self, clay: &Clay, page: u32) -> Detail {
        let rows = clay.page(page).point_rows().iter().map(|p| p.truncate());
        let (lo, hi) =
            rows.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let radius = (hi - lo).length() * 0.51;
        let edge = self.edge * (1u32 << self.coarse) as f32;
        let collapse = self.collapse && self.coarse == 0;
        Detail { centre: (lo + hi) * 0.5, radius, edge, split: true, collapse }
    }

    /// Looks for pages that have something of the region and edges to be changed; what looking for
    /// them counts.
    fn choose(&mut self, clay: &Clay) -> usize {
        let mut looked = 0;
        let edge = self.edge * (1u32 << self.coarse) as f32;
        let collapse = self.collapse && self.coarse == 0;
        while self.next < clay.page_count()
            && self.todo.len() < KNOWN
            && looked / LOOKED < LEAST_TOPOLOGY_BUDGET as u64 / 2
        {
            let number = self.next as u32;
            let page = clay.page(number);
            self.next += 1;
            looked += 1;
            if !self.concerns(clay, number) {
                continue;
            }
            let (lo, hi) = page.bounds();
            if !self.seen.as_ref().is_none_or(|seen| seen.may_hold(lo, hi)) {
                self.region.get_mut(number as usize).iter_mut().for_each(|r| **r = false);
                continue;
            }
            looked += page.triangles().len() as u64 / 2;
            let (mut least, mut most) = (f32::INFINITY, 0.0f32);
            for [a, b, c] in (0..page.triangles().len()).map(|i| page.corners(i)) {
                for d2 in [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)] {
                    (least, most) = (least.min(d2), most.max(d2));
                }
            }
            self.longest = self.longest.max(most.sqrt());
            if most.sqrt() <= edge * (4.0 / 3.0) && !(collapse && least.sqrt() < edge * 0.5) {
                continue;
            }
            if let Some(seen) = &self.seen {
                looked += page.own() as u64 * seen.cost();
                let rows = page.point_rows().iter();
                if !rows.into_iter().any(|p| seen.holds(p.truncate(), Vec3::ZERO)) {
                    self.region.get_mut(number as usize).iter_mut().for_each(|r| **r = false);
                    continue;
                }
            }
            self.todo.push(number);
        }
        (looked / LOOKED) as usize
    }
}

/// The median of edges that are spread over the clay, mesh units; `None` where it has none.
pub(crate) fn usual_edge(clay: &Clay) -> Option<f32> {
    let mut edges: Vec<f32> = Vec::with_capacity(SAMPLED);
    let step = (3 * clay.triangle_count()).div_ceil(SAMPLED).max(1);
    let mut at = 0;
    for page in (0..clay.page_count()).map(|i| clay.page(i as u32)) {
        let count = 3 * page.triangles().len();
        while at < count {
            let [p, q] = [at % 3, (at + 1) % 3].map(|k| page.corners(at / 3)[k]);
            edges.push(p.distance(q));
            at += step;
        }
        at -= count;
    }
    edges.retain(|e| *e > 0.0 && e.is_finite());
    edges.sort_unstable_by(f32::total_cmp);
    edges.get(edges.len() / 2).copied()
}
