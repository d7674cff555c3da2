//! Dynamic topology: the triangles within balls are brought to a wanted size while sculpting, in
//! counted work.
//!
//! 1. *Scan*: the pages that the balls touch are looked through for edges that are too long or too
//!    short and for badly shaped triangles ([`crate::retopology::scan`]), a few at a time, those of
//!    the newest balls first. A page that was looked through and left as it was is passed over
//!    until somebody writes it or another ball touches it.
//! 2. *Operations*: splits, collapses and flips on the rings of the vertices concerned, page by
//!    page, the most urgent first, until all are done or the budget of counted work is used up
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
use crate::retopology::scan::BALLS;
use crate::retopology::{Cuts, Detail, PAGE_SCAN, PAGE_WRITE, PageVisit, SCANNED, TopologyBuffers};

/// Numbers are not used beyond this: what is left is for the pages' own arithmetic.
const LAST_NUMBER: u32 = u32::MAX - (1 << 24);

/// Pages below which one thread looks through them alone.
const PARALLEL: usize = 12;

impl Clay {
    /// Brings the triangles within the balls to the wanted size, in `budget` of counted work
    /// ([`Cuts::work`]) and a little more. Sixteen balls at most are looked at in one call. Part of
    /// the open undo step, if there is one.
    ///
    /// A budget of [`crate::LEAST_TOPOLOGY_BUDGET`] or more always gets on with at least one page.
    /// Leaves clay with layers unchanged: layers are stored by vertex.
    pub fn adapt_topology(&mut self, balls: &[Detail], budget: usize, workers: &Workers) -> Cuts {
        let used = self.next_vertex.max(self.next_triangle);
        if used >= LAST_NUMBER || self.layer_count() > 0 || !balls.iter().all(Detail::is_sane) {
            return Cuts::default();
        }
        self.prepare_topology();
        let more = balls.len() > BALLS;
        let balls = &balls[..balls.len().min(BALLS)];
        let looked = self.choose(balls);
        let Clay { topology, pages, .. } = self;
        let TopologyBuffers { edit, queues, scans, pages: chosen, .. } = topology;
        edit.clear(pages.len());
        // Numbers for new triangles: four a split, two a flip, nine a collapse.
        let budget = budget.min(looked + ((LAST_NUMBER - used) / 16) as usize);
        let cuts = Cuts { work: looked, ..Cuts::default() };
        let slides = true;
        let mut pass = Pass { edit, queues, pages, balls, within: None, slides, cuts, budget };
        let mut tried = 0;
        for some in chosen.chunks_mut(SCANNED) {
            workers.each(some.len() >= PARALLEL, some, scans, |&mut (_, page), scan| {
                scan.page = page;
                scan.scan(&pass.pages[page as usize], balls, None);
            });
            pass.cuts.work += PAGE_SCAN * some.len();
            let done = scans[..some.len()].iter().take_while(|scan| pass.run(&scan.found)).count();
            tried += done;
            if done < some.len() || pass.is_spent() {
                break;
            }
        }
        let mut cuts = pass.cuts;
        let before = self.revision;
        if cuts.changes() > 0 && !self.rebuild(workers, &mut cuts) {
            cuts = Cuts { work: cuts.work, tangled: true, ..Cuts::default() };
        }
        let Clay { topology, pages, .. } = self;
        let TopologyBuffers { pages: chosen, visits, balls: numbers, .. } = topology;
        let first = numbers.iter().map(|b| b.1).min().unwrap_or(0);
        let last = numbers.iter().map(|b| b.1).max().unwrap_or(0);
        let mut clean = 0;
        for &(_, page) in &chosen[..tried] {
            let revision = pages[page as usize].revision;
            if revision <= before {
                visits[page as usize] = PageVisit { revision, balls: (first, last) };
                clean += 1;
            }
        }
        cuts.unfinished = (more || clean < chosen.len()) && (clean > 0 || cuts.changes() > 0);
        cuts
    }

    /// Chooses the pages to be looked through, those of the newest balls first; what choosing
    /// counts.
    fn choose(&mut self, balls: &[Detail]) -> usize {
        let Clay { topology, pages, top, .. } = self;
        topology.number(balls, pages.len());
        let TopologyBuffers { pages: chosen, visits, balls: numbers, .. } = topology;
        chosen.clear();
        let touches = |b: &Detail, lo, hi| {
            (b.centre - b.centre.clamp(lo, hi)).length_squared() <= b.radius * b.radius
        };
        let mut looked = 0;
        top.walk_boxes(
            |lo, hi| balls.iter().any(|b| touches(b, lo, hi)),
            |p| {
                looked += 1;
                let (page, visit) = (&pages[p], &visits[p]);
                let here = numbers.iter().filter(|b| touches(&b.0, page.lo, page.hi));
                let (first, last) =
                    here.fold((u32::MAX, 0), |(first, last), b| (first.min(b.1), last.max(b.1)));
                let known = visit.balls.0 <= first && last <= visit.balls.1;
                if visit.revision != page.revision || !known {
                    chosen.push((u32::MAX - last, p as u32));
                }
            },
        );
        chosen.sort_unstable();
        looked
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
        let old = &self.pages[number as usize];
        if let Some(page) = Arc::get_mut(&mut page) {
            page.revision = self.revision;
            page.keep_layer_stack(old);
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

mod apart;
#[cfg(test)]
mod tests;
