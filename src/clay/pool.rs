//! Pages that were replaced wait here until nobody reads them any more, and are then written again.
//!
//! A reader that drops the last snapshot with an old page therefore frees nothing, and the tick
//! thread neither allocates nor frees in the steady state of a stroke. Pages beyond the pool's
//! bound go to the [`GarbageSink`].

use std::collections::VecDeque;
use std::sync::Arc;

use super::garbage::{Garbage, GarbageSink};
use super::page::{Page, PageTopology};
use super::page_sets::PageSets;
use super::page_supply::{PageSupply, SparePage};
use crate::assembly::PAGE_VERTICES;

/// Pages kept for reuse, at most; 512-vertex pages take about 25 KB each.
const KEPT: usize = 2048;

#[derive(Debug, Default)]
pub(super) struct Pool {
    free: Vec<Arc<Page>>,
    /// Replaced, oldest first; somebody may still read them.
    waiting: VecDeque<Arc<Page>>,
    /// Topologies that nobody holds any more; their contents are old.
    topologies: Vec<Arc<PageTopology>>,
    /// Face sets of pages that nobody holds any more; their contents are old.
    sets: Vec<Arc<PageSets>>,
    /// The empty topology of a page without one.
    blank: Arc<PageTopology>,
    /// The empty page that precedes every new page: one for all.
    nothing: Arc<Page>,
    /// Rows, and leaves of the tree, that a new page gets room for.
    rows: usize,
    leaves: usize,
    /// Topology is changed: every page has room for any that may come of it.
    roomy: bool,
    /// Receives what exceeds the pool's capacity.
    pub(super) sink: GarbageSink,
    /// Supplies pages when the pool has none and topology is changed.
    pub(super) supply: PageSupply,
}

impl Pool {
    /// `rows`, `leaves`: of the largest page. `count`: pages to have ready.
    pub(super) fn new(rows: usize, leaves: usize, count: usize) -> Self {
        let mut pool = Pool {
            free: Vec::with_capacity(KEPT),
            waiting: VecDeque::with_capacity(KEPT),
            rows,
            leaves,
            topologies: Vec::with_capacity(KEPT),
            sets: Vec::with_capacity(KEPT),
            blank: Arc::default(),
            nothing: Arc::new(Page::nothing()),
            roomy: false,
            sink: GarbageSink::default(),
            supply: PageSupply::default(),
        };
        for _ in 0..count {
            let mut page = pool.fresh();
            if let Some(page) = Arc::get_mut(&mut page) {
                // Touched now, or the first dab would meet the kernel's zero pages one by one.
                page.points.resize(rows, glam::Vec4::ZERO);
                page.normals.resize(rows, glam::Vec4::ZERO);
            }
            pool.free.push(page);
        }
        pool
    }

    fn fresh(&self) -> Arc<Page> {
        let mut page = Page {
            points: Vec::with_capacity(self.rows),
            normals: Vec::with_capacity(self.rows),
            topology: self.blank.clone(),
            ..Page::default()
        };
        page.tree.reset(self.leaves);
        if self.roomy {
            page.make_room(PAGE_VERTICES);
        }
        Arc::new(page)
    }

    /// From now on every page has room for what changing topology may make of it. Pages that have
    /// not go to the garbage sink.
    pub(super) fn be_roomy(&mut self) {
        if !std::mem::replace(&mut self.roomy, true) {
            for page in self.free.drain(..) {
                self.sink.discard(Garbage::Shared(page));
            }
        }
    }

    /// Takes a page and a topology from the supply, if it has one ready.
    pub(super) fn restock(&mut self) {
        let Some(SparePage(mut page)) = self.supply.take() else { return };
        if let Some(page) = Arc::get_mut(&mut page) {
            let topology = std::mem::replace(&mut page.topology, self.blank.clone());
            self.topologies.push(topology);
        }
        self.free.push(page);
    }

    /// A page that nobody else holds; its contents are old.
    pub(super) fn take(&mut self) -> Arc<Page> {
        if self.roomy && self.free.is_empty() {
            self.restock();
        }
        self.free.pop().unwrap_or_else(|| self.fresh())
    }

    /// A page with a topology that nobody else holds either; their contents are old. Only after
    /// [`Pool::be_roomy`].
    pub(super) fn take_whole(&mut self) -> Arc<Page> {
        if self.topologies.is_empty() {
            self.restock();
        }
        let mut page = self.take();
        if let Some(page) = Arc::get_mut(&mut page) {
            let mut topology = self.topologies.pop().unwrap_or_default();
            if let Some(topology) = Arc::get_mut(&mut topology) {
                topology.reserve(PAGE_VERTICES);
            }
            page.topology = topology;
            page.make_room(PAGE_VERTICES);
        }
        page
    }

    /// Face sets that nobody else holds; their contents are old. Where none are ready they are
    /// made.
    pub(super) fn take_sets(&mut self) -> Arc<PageSets> {
        let fresh = || PageSets { rows: Vec::with_capacity(self.rows), ..PageSets::default() };
        self.sets.pop().unwrap_or_else(|| Arc::new(fresh()))
    }

    /// Gives back face sets that nobody else holds.
    pub(super) fn give_back_sets(&mut self, sets: Arc<PageSets>) {
        self.sets.push(sets);
    }

    /// The page that stands where there was none before.
    pub(super) fn nothing(&self) -> Arc<Page> {
        self.nothing.clone()
    }

    /// Gives back a page that nobody else holds.
    pub(super) fn give_back(&mut self, page: Arc<Page>) {
        self.free.push(page);
    }

    /// A page that the clay no longer shows; readers and steps may still hold it.
    pub(super) fn retire(&mut self, page: Arc<Page>) {
        if Arc::ptr_eq(&page, &self.nothing) {
            return;
        }
        self.waiting.push_back(page);
    }

    /// Looks at up to `count` waiting pages, oldest first.
    pub(super) fn reclaim(&mut self, count: usize) {
        for _ in 0..count.min(self.waiting.len()) {
            let Some(mut page) = self.waiting.pop_front() else { return };
            if let Some(free) = Arc::get_mut(&mut page) {
                if let Some(layers) = free.layers.take() {
                    self.sink.discard(Garbage::Shared(layers));
                }
                if let Some(mut sets) = free.sets.take() {
                    // Displaced pages share their sets with the pages that replaced them.
                    if Arc::get_mut(&mut sets).is_some() && self.sets.len() < KEPT {
                        self.sets.push(sets);
                    } else {
                        self.sink.discard(Garbage::Shared(sets));
                    }
                }
                // The last page that lets go of a topology leaves it here.
                let mut topology = std::mem::replace(&mut free.topology, self.blank.clone());
                if Arc::get_mut(&mut topology).is_some() {
                    if self.topologies.len() < KEPT {
                        self.topologies.push(topology);
                    } else {
                        self.sink.discard(Garbage::Shared(topology));
                    }
                }
                let fits = !self.roomy || page.has_room(PAGE_VERTICES);
                if fits && self.free.len() < KEPT {
                    self.free.push(page);
                } else {
                    self.sink.discard(Garbage::Shared(page));
                }
            } else {
                if self.waiting.len() < KEPT {
                    self.waiting.push_back(page);
                } else {
                    // Its reader will free it.
                    self.sink.discard(Garbage::Shared(page));
                }
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.free.iter().map(|p| p.bytes()).sum::<usize>()
            + self.waiting.iter().map(|p| p.bytes()).sum::<usize>()
            + self.topologies.iter().map(|t| t.bytes()).sum::<usize>()
            + self.sets.iter().map(|s| s.weight()).sum::<usize>()
    }
}
