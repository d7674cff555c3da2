//! The part of the surface that is being changed: rings of neighbours, copied from the pages vertex
//! by vertex when an operation first needs them.
//!
//! A handle names a vertex: its page's base plus the vertex's local index. New vertices get
//! separate handles. Handles count up in the order in which pages are first visited, which depends
//! only on the input.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use crate::page::{BREAK, Page, Ring};

/// Neighbours of a vertex, at most, where an operation gives it more: the valence bound.
pub(crate) const MOST_NEIGHBOURS: usize = 12;

/// The ring was taken from its page.
pub(super) const LOADED: u8 = 1;
/// Position and colour are in the arrays here.
pub(super) const PLACED: u8 = 2;
/// The ring is one closed fan that may be changed.
pub(super) const CLOSED: u8 = 4;
/// The ring is one open fan, where edges may be inserted.
pub(super) const OPEN: u8 = 8;
/// The vertex is no more.
pub(super) const DEAD: u8 = 16;
/// The ring or the position is another now.
pub(super) const CHANGED: u8 = 32;

/// Pages with more ring entries or rows than these are too tangled to be changed: their local
/// indices have 15 bits, and counts 16.
const MOST_ENTRIES: usize = 24_000;

/// No slot, no handle.
pub(crate) const NONE: u32 = u32::MAX;

/// A page that takes part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EditPage {
    /// Its number; of a page that is new, too.
    pub(crate) page: u32,
    /// The handle of its first vertex.
    pub(crate) base: u32,
    /// Own vertices that it had.
    pub(crate) own: u32,
    /// The first handle of its halo in [`Edit::halo`]; [`NONE`] until it is requested.
    pub(super) halo: u32,
    /// True if it will be written.
    pub(crate) dirty: bool,
    /// True if it is too tangled to be changed.
    tangled: bool,
    /// True if its vertices may be changed.
    open: bool,
}

/// Rings, places and homes of the vertices that take part.
#[derive(Debug, Default)]
pub(crate) struct Edit {
    /// The pages whose vertices may be changed, ascending; none are given: all.
    pub(crate) limit: Vec<u32>,
    /// For each page its slot plus one, or 0.
    slot_of: Vec<u32>,
    pub(crate) slots: Vec<EditPage>,
    /// Handles of the halos of the pages that were asked for.
    pub(super) halo: Vec<u32>,
    /// Handles given so far.
    count: usize,
    pub(super) state: Vec<u8>,
    /// The slot and the local index that each vertex has now.
    pub(crate) home: Vec<u32>,
    pub(crate) local: Vec<u16>,
    /// The slot that each vertex came from; [`NONE`] for a new one.
    pub(crate) source: Vec<u32>,
    /// Of new vertices: the number in the clay.
    pub(crate) number: Vec<u32>,
    pub(super) valence: Vec<u8>,
    pub(super) rings: Vec<[u32; MOST_NEIGHBOURS]>,
    /// Position and mask.
    pub(crate) points: Vec<Vec4>,
    /// RGBA.
    pub(crate) colours: Vec<u32>,
    /// Face set, and whether it is hidden.
    pub(crate) sets: Vec<u16>,
    /// New vertices, in the order in which they were made.
    pub(crate) made: Vec<u32>,
    /// Triangles that were made; some are no more.
    pub(crate) created: Vec<[u32; 3]>,
    /// Slots to be written.
    pub(crate) dirty: Vec<u32>,
}

impl Edit {
    /// Forgets everything and keeps the memory. `pages`: how many there are.
    pub(crate) fn clear(&mut self, pages: usize) {
        for s in self.slots.drain(..) {
            self.slot_of[s.page as usize] = 0;
        }
        if self.slot_of.len() < pages {
            self.slot_of.resize(pages, 0);
        }
        self.limit.clear();
        self.halo.clear();
        self.made.clear();
        self.created.clear();
        self.dirty.clear();
        self.count = 0;
    }

    /// Makes room for what a tick's work usually needs.
    pub(crate) fn reserve_lists(&mut self) {
        self.slots.reserve(512);
        self.dirty.reserve(512);
        self.halo.reserve(1 << 15);
        self.made.reserve(1 << 13);
        self.created.reserve(1 << 15);
        self.slot_of.reserve(1 << 12);
        self.reserve(1 << 15);
        self.count = 0;
    }

    pub(super) fn reserve(&mut self, more: usize) -> u32 {
        let base = self.count;
        self.count += more;
        if self.state.len() < self.count {
            let n = self.count.next_multiple_of(1 << 14);
            self.state.resize(n, 0);
            self.home.resize(n, 0);
            self.local.resize(n, 0);
            self.source.resize(n, 0);
            self.number.resize(n, 0);
            self.valence.resize(n, 0);
            self.rings.resize(n, [0; MOST_NEIGHBOURS]);
            self.points.resize(n, Vec4::ZERO);
            self.colours.resize(n, 0);
            self.sets.resize(n, 0);
        }
        base as u32
    }

    /// The slot of a page; its vertices have handles from now on.
    pub(crate) fn slot(&mut self, pages: &[Arc<Page>], page: u32) -> u32 {
        if let Some(s) = self.slot_of[page as usize].checked_sub(1) {
            return s;
        }
        let t = &pages[page as usize].topology;
        let own = t.own;
        let base = self.reserve(own);
        let s = self.slots.len() as u32;
        let range = base as usize..base as usize + own;
        self.state[range.clone()].fill(0);
        self.home[range.clone()].fill(s);
        self.source[range.clone()].fill(s);
        for (l, local) in self.local[range].iter_mut().enumerate() {
            *local = l as u16;
        }
        let entries = t.rings.len() + 6 * t.hexes.len();
        let rows = own + t.halo_sources.len();
        let tangled = entries.max(rows).max(t.triangles.len()) > MOST_ENTRIES;
        self.slots.push(EditPage {
            page,
            base,
            own: own as u32,
            halo: NONE,
            dirty: false,
            tangled,
            open: self.limit.is_empty() || self.limit.binary_search(&page).is_ok(),
        });
        self.slot_of[page as usize] = s + 1;
        s
    }

    /// The slot of a page without vertices that new ones are moved into.
    pub(crate) fn new_slot(&mut self, page: u32) -> u32 {
        if self.slot_of.len() <= page as usize {
            self.slot_of.resize(page as usize + 1, 0);
        }
        let s = self.slots.len() as u32;
        let base = self.count as u32;
        let (dirty, tangled, open) = (false, false, true);
        self.slots.push(EditPage { page, base, own: 0, halo: 0, dirty, tangled, open });
        self.slot_of[page as usize] = s + 1;
        self.mark_page(s);
        s
    }

    /// Returns the handle of an owned vertex of a page.
    pub(crate) fn handle(&mut self, pages: &[Arc<Page>], (page, local): (u32, u16)) -> u32 {
        let s = self.slot(pages, page);
        self.slots[s as usize].base + u32::from(local)
    }

    /// Sees to it that the handles of a slot's halo are known.
    pub(crate) fn open(&mut self, pages: &[Arc<Page>], slot: u32) {
        let EditPage { page, halo, .. } = self.slots[slot as usize];
        if halo != NONE {
            return;
        }
        let from = self.halo.len() as u32;
        let t = &pages[page as usize].topology;
        for (home, part) in t.halo_parts() {
            let s = self.slot(pages, home);
            let base = self.slots[s as usize].base;
            self.halo.extend(t.halo_sources[part].iter().map(|&l| base + u32::from(l)));
        }
        self.slots[slot as usize].halo = from;
    }

    /// The handle of a row of a slot's old page, once it is open.
    #[inline]
    pub(crate) fn of_row(&self, slot: u32, row: usize) -> u32 {
        let s = &self.slots[slot as usize];
        match row.checked_sub(s.own as usize) {
            None => s.base + row as u32,
            Some(k) => self.halo[s.halo as usize + k],
        }
    }

    /// Takes the ring of a vertex from its page, and the places of its neighbours.
    pub(crate) fn load(&mut self, pages: &[Arc<Page>], h: u32) {
        let i = h as usize;
        if self.state[i] & LOADED != 0 {
            return;
        }
        let slot = self.source[i];
        self.open(pages, slot);
        let s = self.slots[slot as usize];
        let page = &pages[s.page as usize];
        let local = (h - s.base) as usize;
        let ring = page.topology.ring(local);
        self.state[i] |= LOADED;
        self.place(page, h, local);
        let kind = page.topology.kinds[local];
        if s.tangled || ring.len() > MOST_NEIGHBOURS || kind == Ring::ManyFans {
            return;
        }
        self.state[i] |= if kind == Ring::Closed { CLOSED } else { OPEN };
        self.valence[i] = ring.len() as u8;
        for (k, &row) in ring.iter().enumerate() {
            let row = (row & !BREAK) as usize;
            let n = self.of_row(slot, row);
            self.rings[i][k] = n;
            self.place(page, n, row);
        }
    }

    fn place(&mut self, page: &Page, h: u32, row: usize) {
        let i = h as usize;
        if self.state[i] & PLACED == 0 {
            self.state[i] |= PLACED;
            self.points[i] = page.points[row];
            self.colours[i] = page.normals[row].w.to_bits();
            self.sets[i] = page.set_bits(row);
        }
    }

    /// A new vertex in the home of `beside`.
    pub(super) fn make(&mut self, beside: u32, point: Vec4, colour: u32) -> u32 {
        let h = self.reserve(1);
        let i = h as usize;
        let home = self.home[beside as usize];
        self.state[i] = LOADED | PLACED | CLOSED;
        self.home[i] = home;
        self.local[i] = u16::MAX;
        self.source[i] = NONE;
        self.valence[i] = 0;
        self.points[i] = point;
        self.colours[i] = colour;
        self.sets[i] = self.sets[beside as usize];
        self.made.push(h);
        self.mark(h);
        h
    }

    /// The ring or the place of a vertex is another now: its page is to be written.
    pub(super) fn mark(&mut self, h: u32) {
        self.state[h as usize] |= CHANGED;
        self.mark_page(self.home[h as usize]);
    }

    /// As [`Edit::mark`] for a vertex whose normal turns.
    pub(super) fn mark_turned(&mut self, h: u32) {
        if self.has_ring(h) {
            self.mark(h);
        } else {
            self.mark_page(self.home[h as usize]);
        }
    }

    /// The slot of a page that takes part.
    pub(crate) fn known_slot(&self, page: u32) -> Option<u32> {
        self.slot_of.get(page as usize)?.checked_sub(1)
    }

    /// A page is to be written.
    pub(crate) fn mark_page(&mut self, slot: u32) {
        if !std::mem::replace(&mut self.slots[slot as usize].dirty, true) {
            self.dirty.push(slot);
        }
    }

    #[inline]
    pub(crate) fn is(&self, h: u32, bits: u8) -> bool {
        self.state[h as usize] & bits != 0
    }

    /// Returns true if a vertex was removed.
    pub(crate) fn is_dead(&self, h: u32) -> bool {
        self.is(h, DEAD)
    }

    /// Returns true if the ring of a vertex is loaded into this edit.
    pub(crate) fn has_ring(&self, h: u32) -> bool {
        self.is(h, CLOSED | OPEN)
    }

    /// Returns true if a loaded ring is closed.
    pub(crate) fn is_closed(&self, h: u32) -> bool {
        self.is(h, CLOSED)
    }

    /// Returns true if the ring or the position of a vertex changed.
    pub(crate) fn is_changed(&self, h: u32) -> bool {
        self.is(h, CHANGED)
    }

    /// Returns true if position and colour are loaded.
    pub(crate) fn is_placed(&self, h: u32) -> bool {
        self.is(h, PLACED)
    }

    /// Returns true if all of these belong to pages whose vertices may be changed.
    pub(super) fn are_open(&self, all: &[u32]) -> bool {
        self.limit.is_empty()
            || all.iter().all(|&h| self.slots[self.home[h as usize] as usize].open)
    }

    /// The ring of a vertex whose ring is here.
    #[inline]
    pub(crate) fn ring(&self, h: u32) -> &[u32] {
        &self.rings[h as usize][..self.valence[h as usize] as usize]
    }

    #[inline]
    pub(super) fn at(&self, h: u32) -> Vec3 {
        self.points[h as usize].truncate()
    }

    /// Returns true if three vertices form a triangle in this order, according to the first vertex,
    /// whose ring must be loaded.
    pub(crate) fn has_triangle(&self, [a, b, c]: [u32; 3]) -> bool {
        if self.is_dead(a) {
            return false;
        }
        let ring = self.ring(a);
        let Some(k) = ring.iter().position(|&n| n == b) else { return false };
        match ring.get(k + 1) {
            Some(&next) => next == c,
            None => self.is_closed(a) && ring[0] == c,
        }
    }

    pub(super) fn remove_neighbour(&mut self, h: u32, gone: u32) {
        let (ring, n) = (&mut self.rings[h as usize], self.valence[h as usize] as usize);
        if let Some(k) = ring[..n].iter().position(|&v| v == gone) {
            ring.copy_within(k + 1..n, k);
            self.valence[h as usize] -= 1;
        }
    }

    pub(super) fn replace_neighbour(&mut self, h: u32, old: u32, new: u32) {
        let n = self.valence[h as usize] as usize;
        for v in &mut self.rings[h as usize][..n] {
            if *v == old {
                *v = new;
            }
        }
    }

    /// Inserts a neighbour right after another one. There must be room.
    pub(super) fn insert_after(&mut self, h: u32, after: u32, new: u32) {
        let (ring, n) = (&mut self.rings[h as usize], self.valence[h as usize] as usize);
        if n < MOST_NEIGHBOURS
            && let Some(k) = ring[..n].iter().position(|&v| v == after)
        {
            ring.copy_within(k + 1..n, k + 2);
            ring[k + 1] = new;
            self.valence[h as usize] += 1;
        }
    }
}
