//! Writes the pages that changed, each in time that follows its size: vertices keep their places,
//! rings and triangles are copied with new local indices, and only what changed is put in.
//!
//! 1. Who lives where: a vertex that is gone leaves its place to a new one, else to the page's
//!    last. A page beyond [`PAGE_VERTICES`] is parted along the k-d order. Pages whose halo names
//!    a vertex that has another place are written as well.
//! 2. Each page by one task: halo, rings, triangles, leaves, normals, tree.
//! 3. Halos take over the normals. A page beside, where nothing else changed, keeps its topology.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::edit::{Edit, NONE};
use crate::assembly::{PAGE_VERTICES, order};
use crate::boxtree::LEAF;
use crate::normals;
use crate::page::{BREAK, Neighbour, Page, PageTopology, Ring};
use crate::pool::Pool;
use crate::workers::Workers;

/// Pages below which one thread writes them alone.
const PARALLEL: usize = 6;

/// A page to be written.
#[derive(Debug)]
pub(crate) struct PageWrite {
    slot: u32,
    /// Handles of its vertices, in order.
    own: Vec<u32>,
    /// Triangles that it gets, and their numbers.
    given: Vec<([u32; 3], u32)>,
    /// Its vertices were put in order anew: so are its triangles.
    reorder: bool,
    pub(crate) page: Arc<Page>,
    /// It is too tangled for a page.
    failed: bool,
}

/// The memory of one task.
#[derive(Debug, Default)]
pub(crate) struct WriteTask {
    /// The halo: page and local index, and the handle. Ascending.
    foreign: Vec<(u64, u32)>,
    seen: Vec<u16>,
    /// For each row the last triangle that has it.
    anchor: Vec<u32>,
    triangles: Vec<([u16; 3], u32)>,
    given: Vec<(u32, u32, [u16; 3])>,
    sorted: Vec<([u16; 3], u32)>,
    items: Vec<order::Item>,
    rows: Vec<Vec4>,
}

/// Pages to be written, and the memory for it.
#[derive(Debug, Default)]
pub(crate) struct Rebuild {
    pub(crate) writes: Vec<PageWrite>,
    spare: Vec<PageWrite>,
    tasks: Vec<WriteTask>,
    /// For each slot its place in `writes`.
    write_of: Vec<u32>,
    fresh: Vec<(u32, u32)>,
    items: Vec<order::Item>,
    beside: Vec<u32>,
    indices: Vec<u32>,
    /// Pages of which only halo normals change.
    pub(crate) patches: Vec<(u32, Arc<Page>)>,
    /// Vertices have other homes: triangles may have, too.
    relocated: bool,
}

/// What all tasks read.
struct Shared<'a> {
    edit: &'a Edit,
    pages: &'a [Arc<Page>],
    relocated: bool,
}

/// A triangle from its least vertex on.
fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

impl Rebuild {
    fn write(&mut self, slot: u32, pool: &mut Pool, blank: &Arc<Page>) -> usize {
        let mut write = self.spare.pop().unwrap_or_else(|| PageWrite {
            slot: 0,
            own: Vec::with_capacity(PAGE_VERTICES + 64),
            given: Vec::with_capacity(256),
            reorder: false,
            page: blank.clone(),
            failed: false,
        });
        write.slot = slot;
        write.own.clear();
        write.given.clear();
        (write.reorder, write.failed) = (false, false);
        write.page = pool.take();
        if let Some(page) = Arc::get_mut(&mut write.page) {
            page.topology = pool.take_topology();
        }
        if self.write_of.len() <= slot as usize {
            self.write_of.resize(slot as usize + 1, NONE);
        }
        self.write_of[slot as usize] = self.writes.len() as u32;
        self.writes.push(write);
        self.writes.len() - 1
    }

    fn write_of(&self, slot: u32) -> Option<usize> {
        self.write_of.get(slot as usize).filter(|&&w| w != NONE).map(|&w| w as usize)
    }

    /// Lays out who lives where, and shares the new triangles out. `next`: the numbers that the
    /// next new vertex and triangle get. `new_page` gives the number of a page without vertices.
    pub(crate) fn lay_out(
        &mut self,
        edit: &mut Edit,
        pages: &mut Vec<Arc<Page>>,
        pool: &mut Pool,
        blank: &Arc<Page>,
        next: [&mut u32; 2],
        mut new_page: impl FnMut(&mut Vec<Arc<Page>>) -> u32,
    ) {
        self.write_of.clear();
        self.relocated = false;
        self.fresh.clear();
        let [next_vertex, next_triangle] = next;
        for &h in &edit.made {
            if !edit.is_dead(h) {
                edit.number[h as usize] = *next_vertex;
                *next_vertex += 1;
                self.fresh.push((edit.home[h as usize], h));
            }
        }
        self.fresh.sort_unstable();
        let mut at = 0;
        while let Some(&slot) = edit.dirty.get(at) {
            at += 1;
            if self.write_of(slot).is_some() {
                continue;
            }
            let w = self.write(slot, pool, blank);
            self.settle(edit, pages, w);
            if self.writes[w].own.len() > PAGE_VERTICES {
                self.part(edit, pages, pool, blank, w, &mut new_page);
            }
        }
        for w in &self.writes {
            edit.open(pages, w.slot);
        }
        self.share_out(edit, pages, next_triangle);
    }

    /// The vertices of a page, in order: whoever stays keeps its place where it can.
    fn settle(&mut self, edit: &mut Edit, pages: &[Arc<Page>], w: usize) {
        let slot = self.writes[w].slot;
        let mut own = std::mem::take(&mut self.writes[w].own);
        let (base, count) = {
            let s = &edit.slots[slot as usize];
            (s.base, s.own)
        };
        own.extend((base..base + count).map(|h| if edit.is_dead(h) { NONE } else { h }));
        let from = self.fresh.partition_point(|f| f.0 < slot);
        let to = self.fresh.partition_point(|f| f.0 <= slot);
        let mut fresh = from..to;
        let mut l = 0;
        while l < own.len() {
            if own[l] == NONE {
                if let Some(f) = fresh.next() {
                    own[l] = self.fresh[f].1;
                } else {
                    while own.last() == Some(&NONE) {
                        own.pop();
                    }
                    if l >= own.len() {
                        break;
                    }
                    own[l] = own.pop().unwrap_or(NONE);
                    edit.local[own[l] as usize] = l as u16;
                    self.mark_beside(edit, pages, own[l]);
                }
            }
            l += 1;
        }
        own.extend(fresh.map(|f| self.fresh[f].1));
        for (l, &h) in own.iter().enumerate() {
            edit.local[h as usize] = l as u16;
        }
        self.writes[w].own = own;
    }

    /// Pages that name this vertex in their halo are to be written: its place is another.
    fn mark_beside(&mut self, edit: &mut Edit, pages: &[Arc<Page>], h: u32) {
        self.beside.clear();
        edit.load(pages, h);
        if edit.has_ring(h) {
            self.beside.extend_from_slice(edit.ring(h));
        } else {
            let slot = edit.source[h as usize];
            let s = &edit.slots[slot as usize];
            let t = &pages[s.page as usize].topology;
            let rows = t.ring((h - s.base) as usize).iter().map(|r| (r & !BREAK) as usize);
            self.beside.extend(rows.map(|row| edit.of_row(slot, row)));
        }
        for &n in &self.beside {
            edit.mark_page(edit.home[n as usize]);
        }
    }

    /// Parts a page that grew too large.
    fn part(
        &mut self,
        edit: &mut Edit,
        pages: &mut Vec<Arc<Page>>,
        pool: &mut Pool,
        blank: &Arc<Page>,
        w: usize,
        new_page: &mut impl FnMut(&mut Vec<Arc<Page>>) -> u32,
    ) {
        self.relocated = true;
        let mut own = std::mem::take(&mut self.writes[w].own);
        let mut items = std::mem::take(&mut self.items);
        items.clear();
        for &h in &own {
            edit.load(pages, h);
            items.push((edit.points[h as usize].truncate(), h));
        }
        // Room to grow: the next split is not the next dab's.
        let count = items.len();
        let parts = count.div_ceil(PAGE_VERTICES * 3 / 4);
        let start = |c: usize| c * count / parts;
        order::order(&mut items, 0, parts, &start);
        own.clear();
        self.writes[w].own = own;
        for part in 0..parts {
            let some = &mut items[start(part)..start(part + 1)];
            order::order_runs(some, 8);
            let to = match part {
                0 => w,
                _ => {
                    let slot = edit.new_slot(new_page(pages));
                    self.write(slot, pool, blank)
                }
            };
            let write = &mut self.writes[to];
            write.reorder = true;
            // Regular vertices first: their loops are the fastest.
            let regular = |h: u32| edit.is_closed(h) && edit.ring(h).len() == 6;
            write.own.extend(some.iter().map(|i| i.1).filter(|&h| regular(h)));
            write.own.extend(some.iter().map(|i| i.1).filter(|&h| !regular(h)));
            for (l, &h) in write.own.iter().enumerate() {
                edit.home[h as usize] = write.slot;
                edit.local[h as usize] = l as u16;
            }
        }
        for i in &items {
            self.mark_beside(edit, pages, i.1);
        }
        self.items = items;
    }

    /// Which page is home to which triangle: new ones, and those of vertices that moved house.
    fn share_out(&mut self, edit: &mut Edit, pages: &[Arc<Page>], next_triangle: &mut u32) {
        let mut created = std::mem::take(&mut edit.created);
        created.iter_mut().for_each(|t| *t = canonical(*t));
        created.sort_unstable();
        created.dedup();
        created.retain(|&t| edit.has_triangle(t));
        edit.created = created;
        for &t in &edit.created {
            let id = *next_triangle;
            *next_triangle += 1;
            if let Some(w) = self.write_of(owner(edit, t)) {
                self.writes[w].given.push((t, id));
            }
        }
        if !self.relocated {
            return;
        }
        for w in 0..self.writes.len() {
            let slot = self.writes[w].slot;
            let s = edit.slots[slot as usize];
            if s.own == 0 {
                continue;
            }
            let t = &pages[s.page as usize].topology;
            for (corners, &id) in t.triangles.iter().zip(&t.triangle_ids) {
                let corners = corners.map(|v| edit.of_row(slot, v as usize));
                if !survives(edit, corners) {
                    continue;
                }
                let home = owner(edit, corners);
                if home != slot
                    && let Some(to) = self.write_of(home)
                {
                    self.writes[to].given.push((corners, id));
                }
            }
        }
    }

    /// Writes all pages. False, and nothing is to be kept, where one is too tangled.
    pub(crate) fn write_all(
        &mut self,
        edit: &Edit,
        pages: &[Arc<Page>],
        pool: &mut Pool,
        workers: &Workers,
    ) -> bool {
        let shared = Shared { edit, pages, relocated: self.relocated };
        let parallel = self.writes.len() >= PARALLEL;
        while self.tasks.len() < self.writes.len() {
            self.tasks.push(WriteTask::default());
        }
        let Rebuild { writes, tasks, write_of, indices, .. } = self;
        workers.each(parallel, writes, tasks, |write, task| task.write(write, &shared));
        if writes.iter().any(|w| w.failed) {
            return false;
        }
        indices.clear();
        indices.extend(0..writes.len() as u32);
        {
            let (writes, write_of) = (&*writes, &*write_of);
            workers.each(parallel, indices, tasks, |_, task| {
                task.rows.clear();
                for &(key, h) in &task.foreign {
                    let (page, local) = ((key >> 16) as usize, (key & 0xffff) as usize);
                    let home = edit.home[h as usize] as usize;
                    let from = match write_of.get(home) {
                        Some(&w) if w != NONE => &writes[w as usize].page,
                        _ => &pages[page],
                    };
                    task.rows.push(from.normals[local]);
                }
            });
        }
        for (write, task) in writes.iter_mut().zip(tasks) {
            if let Some(page) = Arc::get_mut(&mut write.page) {
                page.normals[write.own.len()..].copy_from_slice(&task.rows);
            }
        }
        self.patch(edit, pages, pool);
        true
    }

    /// Pages beside, where only copies of normals are out of date.
    fn patch(&mut self, edit: &Edit, pages: &[Arc<Page>], pool: &mut Pool) {
        let Rebuild { writes, write_of, beside, patches, .. } = self;
        let written = |page: u32| {
            let slot = edit.known_slot(page)?;
            write_of.get(slot as usize).filter(|&&w| w != NONE).map(|&w| w as usize)
        };
        beside.clear();
        for w in &*writes {
            let all = w.page.topology.neighbours.iter().map(|n| n.page);
            beside.extend(all.filter(|&p| written(p).is_none()));
        }
        beside.sort_unstable();
        beside.dedup();
        let bits = |n: &Vec4| n.to_array().map(f32::to_bits);
        for &number in &*beside {
            let old = &pages[number as usize];
            let t = &old.topology;
            let mut copy: Option<Arc<Page>> = None;
            for (home, part) in t.halo_parts() {
                let Some(w) = written(home) else { continue };
                let from = &writes[w].page;
                for k in part {
                    let now = &from.normals[t.halo_sources[k] as usize];
                    if bits(now) == bits(&old.normals[t.own + k]) {
                        continue;
                    }
                    let copy = copy.get_or_insert_with(|| {
                        let mut page = pool.take();
                        if let Some(page) = Arc::get_mut(&mut page) {
                            page.fill_from(old);
                        }
                        page
                    });
                    if let Some(page) = Arc::get_mut(copy) {
                        page.normals[t.own + k] = *now;
                    }
                }
            }
            if let Some(copy) = copy {
                patches.push((number, copy));
            }
        }
    }

    /// Hands each new page to `put` with its number, and keeps the memory.
    pub(crate) fn drain(&mut self, edit: &Edit, blank: &Arc<Page>, mut put: impl FnMut(u32, Arc<Page>)) {
        let Rebuild { writes, spare, patches, .. } = self;
        for mut w in writes.drain(..) {
            put(edit.slots[w.slot as usize].page, std::mem::replace(&mut w.page, blank.clone()));
            spare.push(w);
        }
        patches.drain(..).for_each(|(number, page)| put(number, page));
    }
}

/// The slot of the page that is home to a triangle: where two of its corners are at home, or else
/// the first page of three.
fn owner(edit: &Edit, corners: [u32; 3]) -> u32 {
    let [a, b, c] = corners.map(|h| edit.home[h as usize]);
    if b == c {
        b
    } else if a == b || a == c {
        a
    } else {
        let page = |s: u32| edit.slots[s as usize].page;
        [b, c].into_iter().fold(a, |best, s| if page(s) < page(best) { s } else { best })
    }
}

/// Whether a triangle of before is still there, and not among the created.
fn survives(edit: &Edit, corners: [u32; 3]) -> bool {
    !corners.iter().all(|&h| edit.is_changed(h))
        || (edit.has_triangle(corners)
            && edit.created.binary_search(&canonical(corners)).is_err())
}

impl WriteTask {
    fn write(&mut self, write: &mut PageWrite, shared: &Shared<'_>) {
        let PageWrite { slot, own, given, reorder, page, failed } = write;
        let Some(page) = Arc::get_mut(page) else { return };
        let Some(t) = Arc::get_mut(&mut page.topology) else { return };
        *failed = !(self.vertices(*slot, own, t, shared)
            && self.triangles(*slot, given, *reorder, t, own, shared)
            && t.index_with(&mut self.seen));
        if *failed {
            return;
        }
        page.tree.reset(t.triangles.len().div_ceil(LEAF));
        page.points.clear();
        page.normals.clear();
        let everyone = own.iter().copied().chain(self.foreign.iter().map(|f| f.1));
        for h in everyone {
            let i = h as usize;
            let (point, colour) = if shared.edit.is_placed(h) {
                (shared.edit.points[i], f32::from_bits(shared.edit.colours[i]))
            } else {
                let s = &shared.edit.slots[shared.edit.source[i] as usize];
                let from = &shared.pages[s.page as usize];
                let row = (h - s.base) as usize;
                (from.points[row], from.normals[row].w)
            };
            page.points.push(point);
            page.normals.push(Vec3::ZERO.extend(colour));
        }
        if own.is_empty() {
            (page.lo, page.hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            return;
        }
        normals::all(page);
        page.refit(u32::MAX);
    }

    /// The local index of a vertex in the page that is written.
    fn translate(&self, slot: u32, own: usize, edit: &Edit, h: u32) -> u16 {
        let i = h as usize;
        if edit.home[i] == slot {
            return edit.local[i];
        }
        let key = key(edit, h);
        (own + self.foreign.partition_point(|f| f.0 < key)) as u16
    }

    /// Halo, rings, numbers.
    fn vertices(
        &mut self,
        slot: u32,
        own: &[u32],
        t: &mut PageTopology,
        shared: &Shared<'_>,
    ) -> bool {
        let Shared { edit, pages, .. } = *shared;
        self.foreign.clear();
        for &h in own {
            each_neighbour(edit, pages, h, |n, _| {
                if edit.home[n as usize] != slot {
                    self.foreign.push((key(edit, n), n));
                }
            });
        }
        self.foreign.sort_unstable();
        self.foreign.dedup();
        if own.len() + self.foreign.len() >= BREAK as usize {
            return false;
        }
        t.own = own.len();
        t.halo_sources.clear();
        t.neighbours.clear();
        for (k, f) in self.foreign.iter().enumerate() {
            let page = (f.0 >> 16) as u32;
            if t.neighbours.last().is_none_or(|n| n.page != page) {
                t.neighbours.push(Neighbour { page, first: k as u32 });
            }
            t.halo_sources.push(f.0 as u16);
        }
        t.ids.clear();
        t.kinds.clear();
        t.hexes.clear();
        t.rings.clear();
        t.ring_starts.clear();
        for (v, &h) in own.iter().enumerate() {
            let start = t.rings.len();
            each_neighbour(edit, pages, h, |n, flag| {
                t.rings.push(self.translate(slot, own.len(), edit, n) | flag);
            });
            let (kind, id) = if edit.source[h as usize] == NONE {
                (Ring::Closed, edit.number[h as usize])
            } else {
                let s = &edit.slots[edit.source[h as usize] as usize];
                let old = &pages[s.page as usize].topology;
                let local = (h - s.base) as usize;
                (old.kinds[local], old.ids[local])
            };
            t.ids.push(id);
            t.kinds.push(kind);
            match (kind, &t.rings[start..]) {
                (Ring::Closed, &[a, b, c, d, e, f]) if t.hexes.len() == v => {
                    t.hexes.push([a, b, c, d, e, f]);
                    t.rings.clear();
                }
                _ => t.ring_starts.push(start.min(u16::MAX as usize) as u16),
            }
        }
        t.ring_starts.push(t.rings.len().min(u16::MAX as usize) as u16);
        t.rings.len() <= u16::MAX as usize
    }

    fn triangles(
        &mut self,
        slot: u32,
        given: &[([u32; 3], u32)],
        reorder: bool,
        t: &mut PageTopology,
        own: &[u32],
        shared: &Shared<'_>,
    ) -> bool {
        let Shared { edit, pages, relocated } = *shared;
        self.anchor.clear();
        self.anchor.resize(own.len() + self.foreign.len(), NONE);
        self.triangles.clear();
        let s = edit.slots[slot as usize];
        if s.own > 0 {
            let old = &pages[s.page as usize].topology;
            for (corners, &id) in old.triangles.iter().zip(&old.triangle_ids) {
                let corners = corners.map(|v| edit.of_row(slot, v as usize));
                if !survives(edit, corners) || (relocated && owner(edit, corners) != slot) {
                    continue;
                }
                let local = corners.map(|h| self.translate(slot, own.len(), edit, h));
                let at = self.triangles.len() as u32;
                local.iter().for_each(|&v| self.anchor[v as usize] = at);
                self.triangles.push((local, id));
            }
        }
        // What is new lies beside what it shares a vertex with.
        self.given.clear();
        for &(corners, id) in given {
            let local = corners.map(|h| self.translate(slot, own.len(), edit, h));
            let anchors = local.map(|v| self.anchor[v as usize]);
            let anchor = anchors.into_iter().filter(|&a| a != NONE).max().unwrap_or(NONE);
            self.given.push((anchor, id, local));
        }
        let kept = self.triangles.len();
        if reorder || 2 * self.given.len() > kept {
            self.triangles.extend(self.given.iter().map(|g| (g.2, g.1)));
            self.items.clear();
            let place = |v: u16| match usize::from(v).checked_sub(own.len()) {
                None => point(edit, pages, own[v as usize]),
                Some(k) => point(edit, pages, self.foreign[k].1),
            };
            for (k, (corners, _)) in self.triangles.iter().enumerate() {
                let [a, b, c] = corners.map(place);
                let middle = a.min(b).min(c) * 0.5 + a.max(b).max(c) * 0.5;
                self.items.push((middle, k as u32));
            }
            order::order_runs(&mut self.items, LEAF);
            self.sorted.clear();
            self.sorted.extend(self.items.iter().map(|i| self.triangles[i.1 as usize]));
            std::mem::swap(&mut self.sorted, &mut self.triangles);
        } else if !self.given.is_empty() {
            self.given.sort_unstable();
            self.sorted.clear();
            let mut next = 0;
            for k in 0..kept {
                self.sorted.push(self.triangles[k]);
                while self.given.get(next).is_some_and(|g| g.0 == k as u32) {
                    self.sorted.push((self.given[next].2, self.given[next].1));
                    next += 1;
                }
            }
            self.sorted.extend(self.given[next..].iter().map(|g| (g.2, g.1)));
            std::mem::swap(&mut self.sorted, &mut self.triangles);
        }
        t.triangles.clear();
        t.triangle_ids.clear();
        t.triangles.extend(self.triangles.iter().map(|t| t.0));
        t.triangle_ids.extend(self.triangles.iter().map(|t| t.1));
        true
    }
}

/// Where a vertex is in the new pages, as a number that orders the halo.
fn key(edit: &Edit, h: u32) -> u64 {
    let page = edit.slots[edit.home[h as usize] as usize].page;
    u64::from(page) << 16 | u64::from(edit.local[h as usize])
}

fn point(edit: &Edit, pages: &[Arc<Page>], h: u32) -> Vec3 {
    if edit.is_placed(h) {
        return edit.points[h as usize].truncate();
    }
    let s = &edit.slots[edit.source[h as usize] as usize];
    pages[s.page as usize].point((h - s.base) as usize)
}

/// Calls `visit` with the neighbours of a vertex in order, and the flag of the ring's entry.
fn each_neighbour(edit: &Edit, pages: &[Arc<Page>], h: u32, mut visit: impl FnMut(u32, u16)) {
    if edit.has_ring(h) {
        edit.ring(h).iter().for_each(|&n| visit(n, 0));
        return;
    }
    let slot = edit.source[h as usize];
    let s = &edit.slots[slot as usize];
    for &row in pages[s.page as usize].topology.ring((h - s.base) as usize) {
        visit(edit.of_row(slot, (row & !BREAK) as usize), row & BREAK);
    }
}
