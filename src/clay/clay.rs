//! The clay: the one mutable mesh.

use std::sync::Arc;

use glam::Vec3;

use super::boxtree::{BoxRay, BoxTree};
use super::dab_buffers::{DabBuffers, PhaseTimes};
use super::garbage::GarbageSink;
use super::page::Page;
use super::page_supply::PageSupply;
use super::pick;
use super::pool::Pool;
use super::publish::{SpinePool, Stale};
use super::ray::{Hit, Ray};
use super::reach::Reach;
use super::snapshot::{Snapshot, Totals, hash, to_tri};
use super::step_authors::Author;
use super::undo::{History, StepPages, StepPlace};
use crate::assembly::{BuildError, Built, PAGE_VERTICES, build};
use crate::multires::Levels;
use crate::retopology::TopologyBuffers;
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// Pages, the tree over them, their history. Changed by one thread; others read [`Snapshot`]s.
#[derive(Debug)]
pub struct Clay {
    pub(super) pages: Vec<Arc<Page>>,
    pub(super) top: BoxTree,
    pub(super) history: History,
    pub(super) pool: Pool,
    pub(super) buffers: DabBuffers,
    pub(super) topology: TopologyBuffers,
    pub(super) order: Vec<u32>,
    pub(super) stale: Stale,
    spines: SpinePool,
    pub(super) revision: u64,
    /// The identifier of the object, where several replaced each other.
    pub(super) object_id: u32,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    /// The numbers that the next new vertex and triangle get.
    pub(super) next_vertex: u32,
    pub(super) next_triangle: u32,
    /// Pages that lost all their vertices.
    pub(super) empty: Vec<u32>,
    warnings: Vec<String>,
    pub(super) clock: Option<fn() -> u64>,
    pub(super) phases: PhaseTimes,
    built_cost: f32,
    levels: Option<Arc<Levels>>,
}

/// Bytes by part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Memory {
    /// Positions, mask, normals, colour, halos, trees.
    pub pages: usize,
    /// Triangles, rings, ids, halo sources.
    pub topology: usize,
    /// The tree over the pages, and tables with an entry a page.
    pub top: usize,
    /// Pages ready for reuse.
    pub pool: usize,
    /// Steps.
    pub undo: usize,
}

impl Memory {
    /// Returns the bytes that the clay takes at rest: all but undo.
    pub fn at_rest(&self) -> usize {
        self.pages + self.topology + self.top + self.pool
    }
}

impl Clay {
    /// Builds clay from any triangle soup: open, non-manifold, with stray vertices. See
    /// [`Clay::warnings`].
    pub fn build(tri: &TriMesh, job: &Job) -> Result<Clay, BuildError> {
        Ok(Clay::of(build(tri, job)?, 0))
    }

    pub(super) fn of(built: Built, revision: u64) -> Clay {
        let Built { pages, vertices, triangles, warnings, next } = built;
        let mut top = BoxTree::default();
        top.reset(pages.len());
        for (i, page) in pages.iter().enumerate() {
            top.set_leaf(i, page.lo, page.hi);
        }
        top.refit_all();
        let rows = pages.iter().map(|p| p.points.len()).max().unwrap_or(0);
        let leaves = pages.iter().map(|p| p.tree.leaves()).max().unwrap_or(0);
        let count = pages.len();
        Clay {
            built_cost: top.cost(),
            levels: None,
            top,
            history: History::new(count),
            // A page of a strange mesh may be huge: then pooled pages grow on use instead.
            pool: Pool::new(rows.min(2048), leaves.min(512), (count / 16).clamp(8, 512)),
            buffers: DabBuffers::new(count, rows.min(2048)),
            topology: TopologyBuffers::default(),
            order: Vec::with_capacity(256),
            stale: Stale::new(count),
            spines: SpinePool::new(&pages),
            pages,
            revision,
            object_id: 0,
            vertices,
            triangles,
            next_vertex: next[0],
            next_triangle: next[1],
            empty: Vec::new(),
            warnings,
            clock: None,
            phases: PhaseTimes::default(),
        }
    }

    /// The coarser and finer levels that were made of this clay, or of what it was cut from.
    pub fn levels(&self) -> Option<&Arc<Levels>> {
        self.levels.as_ref()
    }

    /// Replaces the levels that travel with the clay.
    pub fn set_levels(&mut self, levels: Option<Arc<Levels>>) {
        self.levels = levels;
    }

    /// From now on, pages and undo steps that are no longer needed go to this sink. A new clay
    /// frees them in place.
    pub fn set_garbage_sink(&mut self, sink: GarbageSink) {
        self.history.sink = sink.clone();
        self.pool.sink = sink;
    }

    /// From now on, pages that changing topology needs come from this supply. A new clay makes them
    /// in place.
    pub fn set_page_supply(&mut self, supply: PageSupply) {
        self.pool.supply = supply;
    }

    /// Returns the warnings about the input.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Returns the number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Grows with every change.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Returns the identifier of the object, where several replaced each other: a page's number and
    /// revision are unique within one object.
    pub fn object_id(&self) -> u32 {
        self.object_id
    }

    /// Sets the identifier of the object, see [`Clay::object_id`].
    pub fn set_object_id(&mut self, object_id: u32) {
        self.object_id = object_id;
    }

    /// Lower and upper corner of the box around everything.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.top.bounds()
    }

    /// Returns the number of pages, including pages without vertices.
    pub fn page_count(&self) -> usize {
        self.pages.len()
    }

    /// # Panics
    /// Panics if there is no such page.
    pub fn page(&self, index: u32) -> &Arc<Page> {
        &self.pages[index as usize]
    }

    /// Returns a page as it was when the open step began. Returns the current page if the step has
    /// not touched it or has changed its topology.
    ///
    /// # Panics
    /// Panics if there is no such page.
    pub fn before(&self, index: u32) -> &Arc<Page> {
        let now = &self.pages[index as usize];
        self.history
            .before(index)
            .filter(|b| Arc::ptr_eq(&b.topology, &now.topology))
            .unwrap_or(now)
    }

    /// Calls `visit` with each page that the reach touches now or touched when the open step began,
    /// as it was then: those of now in ascending order, then others in the order in which the step
    /// met them.
    pub fn each_page_before(&self, reach: &Reach, mut visit: impl FnMut(u32, &Page)) {
        self.each_page(reach, |i, _| visit(i, self.before(i)));
        self.history.each_before(|i, page| {
            let now = &self.pages[i as usize];
            let there = |p: &Page| reach.touches(p.lo, p.hi);
            if !there(now) && there(page) && Arc::ptr_eq(&page.topology, &now.topology) {
                visit(i, page);
            }
        });
    }

    fn totals(&self) -> Totals {
        Totals {
            revision: self.revision,
            object_id: self.object_id,
            vertices: self.vertices,
            triangles: self.triangles,
            pages: self.pages.len(),
            next: [self.next_vertex, self.next_triangle],
        }
    }

    /// Returns the greatest number of a face set; 0 if there is none. Visits each chunk of pages,
    /// and each page that changed since the last snapshot.
    pub fn highest_set(&self) -> u16 {
        self.spines.highest_set(&self.pages, &self.stale)
    }

    /// The clay as it is now, for others to read. Costs as much as what changed since the last one.
    pub fn snapshot(&mut self) -> Snapshot {
        let now = self.clock.unwrap_or(|| 0);
        let t0 = now();
        let spine = self.spines.publish(&self.pages, &mut self.stale);
        self.phases.publish += now() - t0;
        Snapshot { spine, totals: self.totals(), levels: self.levels.clone() }
    }

    /// The nearest point of the surface on the ray, seen from either side. Exact: no ray passes
    /// between two triangles that share an edge or a vertex.
    pub fn pick(&self, ray: Ray) -> Option<Hit> {
        pick::everywhere(&self.top, &self.pages, ray)
    }

    /// The nearest point on the ray of the surface as it was when the open step began, among the
    /// pages that `near` touches or touched then.
    pub fn pick_before(&self, ray: Ray, near: &Reach) -> Option<Hit> {
        let (lo, hi) = self.bounds();
        let boxes = BoxRay::new(ray.origin, ray.dir, lo.abs().max(hi.abs()).max_element());
        let mut best = None;
        self.each_page_before(near, |number, page| {
            pick::in_page(&boxes, page, number, &mut best);
        });
        Some(pick::finish(best?, ray, |i| self.before(i)))
    }

    /// Calls `visit` with each page that the reach may touch, in ascending order.
    pub fn each_page(&self, reach: &Reach, mut visit: impl FnMut(u32, &Arc<Page>)) {
        self.top.walk_boxes(|lo, hi| reach.touches(lo, hi), |p| visit(p as u32, &self.pages[p]));
    }

    /// Calls `visit` with each vertex within the reach: page, local index, squared distance to the
    /// centre or the axis. In an order that only the clay decides.
    pub fn each_vertex(&self, reach: &Reach, mut visit: impl FnMut(&Page, usize, f32)) {
        let radius2 = reach.radius() * reach.radius();
        self.each_page(reach, |_, page| {
            for v in 0..page.own() {
                let d2 = reach.distance_squared(page.point(v));
                if d2 <= radius2 {
                    visit(page, v, d2);
                }
            }
        });
    }

    /// Opens an undo step, unless one is open.
    pub fn begin_step(&mut self) {
        self.history.begin();
    }

    /// Closes the open undo step; one that changed nothing is forgotten. Whether there is one more.
    pub fn end_step(&mut self) -> bool {
        self.history.end()
    }

    /// Sets the author of the next changes, for steps of several people.
    pub fn set_author(&mut self, author: Author) {
        self.history.authors.now = author;
    }

    /// Closes the open undo step of several people: people who changed no page in common get a step
    /// each. A part stays open where an owner's strokes have not `ended`. The owners of each new
    /// step, oldest first; what can be done again stays, for whoever keeps the order of several
    /// people's steps.
    pub fn end_step_of_people(&mut self, ended: impl Fn(u8) -> bool) -> Vec<Vec<u8>> {
        let pages = &self.pages;
        self.history.end_of_people(ended, |i, was| is_more_than_surface(was, &pages[i as usize]))
    }

    /// Returns the pages that the open step has changed so far, and one of the people it belongs
    /// to.
    pub fn open_step(&self) -> Option<(StepPages, u8)> {
        let whole = |i: u32, was: &Page| is_more_than_surface(was, &self.pages[i as usize]);
        self.history.open_pages(whole).zip(self.history.authors.first())
    }

    /// Returns true if the open step includes changes of a person.
    pub fn is_step_of(&self, person: u8) -> bool {
        self.history.is_open() && self.history.authors.holds(person)
    }

    /// Returns the pages that a step changed; `None` if there is no such step.
    pub fn step_pages(&self, place: StepPlace) -> Option<StepPages> {
        self.history.pages_of(place)
    }

    /// Makes a step the newest of its kind. The step must share no page with the steps after it
    /// ([`StepPages::shares`]): then the clay is the same in either order.
    pub fn raise_step(&mut self, place: StepPlace) {
        self.history.raise(place);
    }

    /// Lets one step go that could be done again; the newest is 0.
    pub fn forget_one_redo(&mut self, k: usize) {
        self.history.forget_one_redo(k);
    }

    /// Returns true if an undo step is open.
    pub fn is_in_step(&self) -> bool {
        self.history.is_open()
    }

    /// Undoes the newest step. Returns false if there is none. Closes an open step first, except
    /// one of several people: that shares no page with the undone step.
    pub fn undo(&mut self) -> bool {
        self.end_alone();
        self.travel(|history, swap| history.undo(swap))
    }

    /// Redoes the step undone last. Returns false if there is none. Treats an open step as
    /// [`Clay::undo`] does.
    pub fn redo(&mut self) -> bool {
        self.end_alone();
        self.travel(|history, swap| history.redo(swap))
    }

    fn end_alone(&mut self) {
        if !self.history.authors.is_told() {
            self.history.end();
        }
    }

    fn travel(
        &mut self,
        way: impl FnOnce(&mut History, &mut dyn FnMut(u32, Arc<Page>) -> Arc<Page>) -> bool,
    ) -> bool {
        let Clay { history, pages, top, stale, vertices, triangles, empty, .. } = self;
        let done = way(history, &mut |i, page| {
            top.set_leaf(i as usize, page.lo, page.hi);
            stale.add(i);
            let old = std::mem::replace(&mut pages[i as usize], page);
            let new = &pages[i as usize].topology;
            if !Arc::ptr_eq(&old.topology, new) {
                *vertices = *vertices + new.own - old.topology.own;
                *triangles = *triangles + new.triangles.len() - old.topology.triangles.len();
                if new.own == 0 {
                    empty.push(i);
                }
            }
            old
        });
        for &leaf in stale.paths() {
            top.refit_path(leaf as usize);
        }
        stale.clear_paths();
        self.revision += u64::from(done);
        done
    }

    /// Forgets the steps that can be redone.
    pub fn forget_redo(&mut self) {
        self.history.forget_redo();
    }

    /// Lets the oldest step go: for a scene, whose undo has one bound over several objects.
    pub fn forget_oldest_step(&mut self) {
        self.history.forget_oldest();
    }

    /// Forgets all steps, so that nothing can be undone or redone and no step is open.
    pub fn forget_steps(&mut self) {
        self.history.forget();
    }

    /// Bytes that the steps hold.
    pub fn undo_bytes(&self) -> u64 {
        self.history.bytes()
    }

    /// Keeps the totals after a page took the place of `old`.
    pub(super) fn recount(&mut self, index: u32, old: &Page) {
        let (new, old) = (&self.pages[index as usize].topology, &old.topology);
        self.vertices = self.vertices + new.own - old.own;
        self.triangles = self.triangles + new.triangles.len() - old.triangles.len();
    }

    /// Makes room for changing topology, once: pages, tables, lists. What it takes is kept. The
    /// first [`Clay::adapt_topology`] does it otherwise.
    pub fn prepare_topology(&mut self) {
        if self.topology.is_ready() {
            return;
        }
        // As many pages again as there are.
        let most = 2 * self.pages.len() + 1024;
        self.topology.make_ready(most);
        self.pool.be_roomy();
        // A supply that was not asked before begins to make pages.
        self.pool.restock();
        self.buffers.rows = self.buffers.rows.max(2 * PAGE_VERTICES);
        self.pages.reserve(most - self.pages.len());
        self.empty.reserve(most);
        self.buffers.reserve(most);
        self.history.reserve(most);
        self.stale.reserve(most);
        self.top.reserve(most);
        self.spines.reserve(most);
    }

    /// Everything that has an entry a page gets one for each page that was added at the end.
    pub(super) fn grow(&mut self) {
        let count = self.pages.len();
        self.buffers.grow(count);
        self.history.grow(count);
        self.stale.grow(count);
        if count > self.top.leaves() {
            // Room for more than one, or each new page would rebuild the tree.
            self.top.reset((count + count / 8).next_multiple_of(64));
            for (i, page) in self.pages.iter().enumerate() {
                self.top.set_leaf(i, page.lo, page.hi);
            }
            self.top.refit_all();
        }
    }

    /// Returns the number of steps that can be undone.
    pub fn undo_steps(&self) -> usize {
        self.history.undo_steps()
    }

    /// Steps that can be done again.
    pub fn redo_steps(&self) -> usize {
        self.history.redo_steps()
    }

    /// Bytes that undo may hold; the oldest steps go first.
    pub fn set_undo_bytes(&mut self, bytes: u64) {
        self.history.limit = bytes;
        self.history.trim();
    }

    /// Measures the phases of all that follows with this clock, nanoseconds. Without one nothing is
    /// measured.
    pub fn set_clock(&mut self, now: fn() -> u64) {
        self.clock = Some(now);
        self.phases = PhaseTimes::default();
    }

    /// Time spent since [`Clay::set_clock`], by phase; `pick` stays 0, its caller measures it.
    pub fn phases(&self) -> PhaseTimes {
        self.phases
    }

    /// Cost of a ray in the tree over the pages, against what it was after loading.
    pub fn tree_growth(&self) -> f32 {
        if self.built_cost > 0.0 { self.top.cost() / self.built_cost } else { 1.0 }
    }

    /// In the order of the mesh that was loaded; triangles that were left out then are not there.
    pub fn to_tri(&self) -> TriMesh {
        to_tri(&|i| &self.pages[i as usize], self.totals())
    }

    /// One number for positions, mask, colours and triangles; costs as much as the clay is large.
    pub fn hash(&self) -> u64 {
        hash(&|i| &self.pages[i as usize], self.totals())
    }

    /// Returns the size of the pages in bytes: the same in every run, unlike [`Clay::memory`].
    pub fn weight(&self) -> usize {
        self.pages.iter().map(|p| p.weight() + p.topology.bytes()).sum()
    }

    /// Returns the current size of the clay in bytes, by part. Visits each page.
    pub fn memory(&self) -> Memory {
        Memory {
            pages: self.pages.iter().map(|p| p.bytes()).sum(),
            topology: self.pages.iter().map(|p| p.topology.bytes()).sum(),
            top: self.top.bytes() + self.pages.len() * (8 + 8 + 4 + 8 + 8),
            pool: self.pool.bytes(),
            undo: self.history.bytes() as usize,
        }
    }
}

/// Returns true if a page differs from its former state by more than the surface: by its topology,
/// or by the list of layers.
fn is_more_than_surface(was: &Page, now: &Page) -> bool {
    let stack = |page: &Page| page.layers().and_then(|l| l.stack.as_ref().map(Arc::as_ptr));
    !Arc::ptr_eq(&was.topology, &now.topology) || stack(was) != stack(now)
}
