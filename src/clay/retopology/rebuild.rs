//! Writes the pages that changed, each in time that follows its size: vertices keep their places,
//! rings and triangles are copied with new local indices, and only what changed is put in.
//!
//! 1. Who lives where: a vertex that is gone leaves its place to a new one, else to the page's
//!    last. A page beyond [`PAGE_VERTICES`] is parted along the k-d order. Pages whose halo names
//!    a vertex that has another place are written as well.
//! 2. Each page by one task ([`super::write_page`]): halo, rings, triangles, leaves, normals, tree.
//! 3. Halos take over the normals. A page beside, where nothing else changed, keeps its topology.

use std::sync::Arc;

use glam::Vec4;

use super::edit::{Edit, NONE};
use super::write_page::{PageWrite, WriteInput, WriteTask, canonical, owner, survives};
use crate::assembly::{PAGE_VERTICES, order};
use crate::page::{BREAK, Page};
use crate::pool::Pool;
use crate::workers::Workers;

/// Pages below which one thread writes them alone.
const PARALLEL: usize = 6;

/// Pages to be written, and the memory for it.
#[derive(Debug, Default)]
pub(crate) struct PageRebuild {
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

impl PageRebuild {
    /// Makes room for this many pages, and for the usual needs of writing them.
    pub(crate) fn reserve(&mut self, pages: usize) {
        let blank = Arc::default();
        self.spare.resize_with(pages, || PageWrite::new(&blank));
        self.tasks.resize_with(pages, WriteTask::new);
        self.writes.reserve(pages);
        self.write_of.reserve(1024);
        self.indices.reserve(pages);
        self.patches.reserve(4 * pages);
        self.fresh.reserve(1 << 13);
        self.items.reserve(8 * PAGE_VERTICES);
        self.beside.reserve(8 * PAGE_VERTICES);
    }

    fn write(&mut self, slot: u32, pool: &mut Pool, blank: &Arc<Page>) -> usize {
        let mut write = self.spare.pop().unwrap_or_else(|| PageWrite::new(blank));
        write.slot = slot;
        write.own.clear();
        write.given.clear();
        (write.reorder, write.failed) = (false, false);
        write.page = pool.take_whole();
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
        mut new_page: impl FnMut(&mut Vec<Arc<Page>>, &Pool) -> u32,
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
        new_page: &mut impl FnMut(&mut Vec<Arc<Page>>, &Pool) -> u32,
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
                    let slot = edit.new_slot(new_page(pages, pool));
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

    /// Assigns a home page to each new triangle, and to each triangle of a vertex that moved to
    /// another page.
    fn share_out(&mut self, edit: &mut Edit, pages: &[Arc<Page>], next_triangle: &mut u32) {
        let mut created = std::mem::take(&mut edit.created);
        created.retain(|&t| edit.has_triangle(t));
        created.iter_mut().for_each(|t| *t = canonical(*t));
        created.sort_unstable();
        created.dedup();
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
        let known = edit.slots.iter().filter_map(|s| pages.get(s.page as usize));
        let sets = known.clone().any(|p| p.sets.is_some());
        let shared = WriteInput { edit, pages, relocated: self.relocated, sets };
        let parallel = self.writes.len() >= PARALLEL;
        while self.tasks.len() < self.writes.len() {
            self.tasks.push(WriteTask::new());
        }
        let PageRebuild { writes, tasks, write_of, indices, .. } = self;
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
        let PageRebuild { writes, write_of, beside, patches, .. } = self;
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
    pub(crate) fn drain(
        &mut self,
        edit: &Edit,
        blank: &Arc<Page>,
        mut put: impl FnMut(u32, Arc<Page>),
    ) {
        let PageRebuild { writes, spare, patches, .. } = self;
        for mut w in writes.drain(..) {
            put(edit.slots[w.slot as usize].page, std::mem::replace(&mut w.page, blank.clone()));
            spare.push(w);
        }
        patches.drain(..).for_each(|(number, page)| put(number, page));
    }
}
