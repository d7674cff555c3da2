//! Dynamic topology: the triangles within balls are brought to a wanted size while sculpting, in
//! counted work.
//!
//! 1. *Scan*: the pages that the balls touch are looked through for edges that are too long or too
//!    short and for badly shaped triangles ([`crate::retopology::scan`]).
//! 2. *Operations*: splits, collapses and flips on the rings of the vertices concerned, the most
//!    urgent first, until all are done or the budget of counted operations is used up
//!    ([`crate::retopology::operations`], where the quality bounds are stated).
//! 3. *Rebuild*: the pages whose rings or places changed are written, and those whose halo names a
//!    vertex that has another place; nobody else ([`crate::retopology::rebuild`]).
//! 4. They take the old ones' places. The old ones are the undo step, as of any dab; a page that
//!    was not there before was empty.
//!
//! Scan and rebuild run on all workers, a page a task; operations run on one thread, in an order
//! that only the input decides: the same bits with any number of workers. Vertices and triangles
//! keep the numbers that they had, so a ring that did not change keeps its order, and its normal
//! its bits. All memory is kept from call to call.
//!
//! What the budget leaves undone is found again by the next scan: the caller keeps the ball and
//! asks again ([`Cuts::unfinished`]).

use std::sync::Arc;

use super::clay::Clay;
use super::page::Page;
use super::pool::Pool;
use super::workers::Workers;
use crate::assembly::splice::remake;
use crate::assembly::{Cut, Grafted};
use crate::retopology::operations::Pass;
use crate::retopology::scan::{BALLS, PageScan};
use crate::retopology::{Cuts, Detail, PAGE_SCAN, PAGE_WRITE, TopologyBuffers};

/// Numbers are not used beyond this: what is left is for the pages' own arithmetic.
const LAST_NUMBER: u32 = u32::MAX - (1 << 24);

/// Pages below which one thread looks through them alone.
const PARALLEL: usize = 12;

impl Clay {
    /// Brings the triangles within the balls to the wanted size, in `budget` counted operations
    /// ([`Cuts::work`]) and a little more: the pages of the balls are looked through whatever it
    /// is, and a quarter of it is for operations. Sixteen balls at most are looked at in one call.
    /// Part of the open undo step, if there is one.
    pub fn adapt_topology(&mut self, balls: &[Detail], budget: usize, workers: &Workers) -> Cuts {
        let used = self.next_vertex.max(self.next_triangle);
        if used >= LAST_NUMBER || !balls.iter().all(Detail::is_sane) {
            return Cuts::default();
        }
        let mut cuts = Cuts { unfinished: balls.len() > BALLS, ..Cuts::default() };
        let balls = &balls[..balls.len().min(BALLS)];
        self.find(balls, workers, &mut cuts);
        let Clay { topology, pages, .. } = self;
        let TopologyBuffers { edit, queues, found, .. } = topology;
        let room = budget.saturating_sub(cuts.work).max(budget / 4);
        // Numbers for new triangles: four a split, two a flip, nine a collapse.
        let room = room.min(((LAST_NUMBER - used) / 16) as usize);
        if found.len() > room {
            found.select_nth_unstable(room);
            found.truncate(room);
            cuts.unfinished = true;
        }
        found.sort_unstable();
        found.dedup();
        if found.is_empty() {
            return cuts;
        }
        edit.clear(pages.len());
        let budget = cuts.work.saturating_add(room);
        let mut pass = Pass { edit, queues, pages, balls, cuts, budget };
        pass.run(found);
        cuts = pass.cuts;
        if cuts.changes() > 0 && !self.rebuild(workers, &mut cuts) {
            return Cuts { work: cuts.work, ..Cuts::default() };
        }
        cuts
    }

    /// Looks through the pages that the balls touch.
    fn find(&mut self, balls: &[Detail], workers: &Workers, cuts: &mut Cuts) {
        let Clay { topology, pages, top, .. } = self;
        let TopologyBuffers { scans, pages: touched, found, .. } = topology;
        touched.clear();
        let touches = |b: &Detail, lo, hi| {
            (b.centre - b.centre.clamp(lo, hi)).length_squared() <= b.radius * b.radius
        };
        top.walk_boxes(
            |lo, hi| balls.iter().any(|b| touches(b, lo, hi)),
            |p| touched.push(p as u32),
        );
        while scans.len() < touched.len() {
            scans.push(PageScan::new());
        }
        let parallel = touched.len() >= PARALLEL;
        workers.each(parallel, touched, scans, |page, scan| {
            scan.page = *page;
            scan.scan(&pages[*page as usize], balls);
        });
        cuts.work += PAGE_SCAN * touched.len();
        found.clear();
        for scan in &scans[..touched.len()] {
            found.extend_from_slice(&scan.found);
        }
    }

    /// Writes the pages that changed. False, and the clay is as it was, where one would be too
    /// tangled.
    fn rebuild(&mut self, workers: &Workers, cuts: &mut Cuts) -> bool {
        let before = self.pages.len();
        let Clay { topology, pages, pool, buffers, empty, next_vertex, next_triangle, .. } = self;
        let TopologyBuffers { edit, rebuild, .. } = topology;
        let blank = &buffers.blank;
        rebuild.lay_out(edit, pages, pool, blank, [next_vertex, next_triangle], |pages, pool| {
            empty_page(empty, pages, pool)
        });
        cuts.work += PAGE_WRITE * rebuild.writes.len();
        let sound = rebuild.write_all(edit, pages, pool, workers);
        if self.pages.len() > before {
            self.grow();
        }
        if !sound {
            let Clay { topology, buffers, pool, empty, pages, .. } = self;
            let TopologyBuffers { edit, rebuild, .. } = topology;
            rebuild.drain(edit, &buffers.blank, |number, page| {
                pool.give_back(page);
                if pages[number as usize].own() == 0 {
                    empty.push(number);
                }
            });
            return false;
        }
        let mut buffers = std::mem::take(&mut self.topology);
        let blank = self.buffers.blank.clone();
        self.revision += 1;
        let TopologyBuffers { edit, rebuild, .. } = &mut buffers;
        let mut count = 0;
        rebuild.drain(edit, &blank, |number, page| {
            self.replace_page(number, page);
            count += 1;
        });
        self.topology = buffers;
        self.settle_pages();
        self.pool.reclaim(2 * count + 4);
        true
    }

    pub(super) fn push_empty(&mut self) {
        self.pages.push(self.pool.nothing());
    }

    /// Makes a cut where the clay is, around it, as it was when the cut was computed: part of the
    /// open undo step, if there is one, at a cost of the pages around the cut. None, and nothing
    /// changed, where it is not so.
    pub fn graft(&mut self, cut: &Cut) -> Option<Grafted> {
        let old = self.snapshot();
        let made = cut.fits(&old).then(|| remake(&old, cut)).flatten()?;
        drop(old);
        let count = made.pages.last().map_or(0, |p| p.0 as usize + 1);
        if count > self.pages.len() {
            while self.pages.len() < count {
                self.push_empty();
            }
            self.grow();
        }
        [self.next_vertex, self.next_triangle] = made.next;
        let written = made.pages.len();
        self.replace_pages(made.pages);
        Some(Grafted { written, shared: self.pages.len() - written })
    }

    /// New pages take the old ones' places, as after a dab.
    fn replace_pages(&mut self, built: Vec<(u32, Arc<Page>)>) {
        self.revision += 1;
        for (number, page) in built {
            self.replace_page(number, page);
        }
        self.settle_pages();
    }

    fn replace_page(&mut self, number: u32, mut page: Arc<Page>) {
        if let Some(page) = Arc::get_mut(&mut page) {
            page.revision = self.revision;
        }
        if page.own() == 0 {
            self.empty.push(number);
        }
        self.top.set_leaf(number as usize, page.lo, page.hi);
        self.stale.add(number);
        let old = std::mem::replace(&mut self.pages[number as usize], page);
        self.recount(number, &old);
        if let Some(old) = self.history.keep(number, old) {
            self.pool.retire(old);
        }
    }

    fn settle_pages(&mut self) {
        for &leaf in self.stale.paths() {
            self.top.refit_path(leaf as usize);
        }
        self.stale.clear_paths();
        self.history.trim();
    }
}

/// The number of a page without vertices: one that was emptied, or a new one.
fn empty_page(empty: &mut Vec<u32>, pages: &mut Vec<Arc<Page>>, pool: &Pool) -> u32 {
    while let Some(i) = empty.pop() {
        if pages[i as usize].own() == 0 {
            // Emptied, filled again by undo, emptied again: then it is noted twice, and must
            // not be given twice.
            empty.retain(|&other| other != i);
            return i;
        }
    }
    pages.push(pool.nothing());
    pages.len() as u32 - 1
}

#[cfg(test)]
mod tests;
