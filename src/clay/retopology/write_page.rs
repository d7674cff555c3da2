//! Writes one page: its vertices keep their order, rings and triangles get the local indices of
//! now, and what is new is put in beside what it shares a vertex with.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::edit::{Edit, NONE};
use crate::assembly::{PAGE_VERTICES, order};
use crate::boxtree::LEAF;
use crate::normals;
use crate::page::{BREAK, Neighbour, Page, PageTopology, Ring};
use crate::page_sets::PageSets;

/// A page to be written.
#[derive(Debug)]
pub(crate) struct PageWrite {
    pub(super) slot: u32,
    /// Handles of its vertices, in order.
    pub(super) own: Vec<u32>,
    /// Triangles that it gets, and their numbers.
    pub(super) given: Vec<([u32; 3], u32)>,
    /// True if its vertices were reordered; its triangles are reordered then too.
    pub(super) reorder: bool,
    pub(super) page: Arc<Page>,
    /// True if it is too tangled for a page.
    pub(super) failed: bool,
}

impl PageWrite {
    pub(super) fn new(blank: &Arc<Page>) -> PageWrite {
        PageWrite {
            slot: 0,
            own: Vec::with_capacity(4 * PAGE_VERTICES),
            given: Vec::with_capacity(4 * PAGE_VERTICES),
            reorder: false,
            page: blank.clone(),
            failed: false,
        }
    }
}

/// The memory of one task.
#[derive(Debug, Default)]
pub(crate) struct WriteTask {
    /// The halo: page and local index, and the handle. Ascending.
    pub(super) foreign: Vec<(u64, u32)>,
    seen: Vec<u16>,
    /// For each row the last triangle that has it.
    anchor: Vec<u32>,
    triangles: Vec<([u16; 3], u32)>,
    given: Vec<(u32, u32, [u16; 3])>,
    sorted: Vec<([u16; 3], u32)>,
    items: Vec<order::Item>,
    /// Normals of the halo.
    pub(super) rows: Vec<Vec4>,
}

/// The input shared by all tasks.
pub(super) struct WriteInput<'a> {
    pub(super) edit: &'a Edit,
    pub(super) pages: &'a [Arc<Page>],
    /// Vertices have other homes: triangles may have, too.
    pub(super) relocated: bool,
    /// The object has face sets, or hidden vertices.
    pub(super) sets: bool,
}

/// A triangle from its least vertex on.
pub(super) fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The slot of the page that is home to a triangle: where two of its corners are at home, or else
/// the first page of three.
pub(super) fn owner(edit: &Edit, corners: [u32; 3]) -> u32 {
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

/// Returns true if an old triangle still exists and is not among the created ones.
pub(super) fn survives(edit: &Edit, corners: [u32; 3]) -> bool {
    !corners.iter().all(|&h| edit.is_changed(h))
        || (edit.has_triangle(corners) && edit.created.binary_search(&canonical(corners)).is_err())
}

impl WriteTask {
    /// With room for any page that is not tangled, or tasks would grow one by one, long into a
    /// stroke.
    pub(super) fn new() -> WriteTask {
        let most = 4 * PAGE_VERTICES;
        WriteTask {
            foreign: Vec::with_capacity(most),
            seen: Vec::with_capacity(most),
            anchor: Vec::with_capacity(most),
            triangles: Vec::with_capacity(most),
            given: Vec::with_capacity(most),
            sorted: Vec::with_capacity(most),
            items: Vec::with_capacity(most),
            rows: Vec::with_capacity(most),
        }
    }

    /// Writes the page, all but the normals of its halo.
    pub(super) fn write(&mut self, write: &mut PageWrite, shared: &WriteInput<'_>) {
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
        page.sets = shared.sets.then(|| self.sets(own, shared)).flatten();
        if own.is_empty() {
            (page.lo, page.hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            return;
        }
        normals::all(page);
        page.refit(u32::MAX);
    }

    /// Returns the face sets of the page: a vertex keeps its set, and a new vertex gets the set of
    /// the vertex next to which it was made.
    fn sets(&self, own: &[u32], shared: &WriteInput<'_>) -> Option<Arc<PageSets>> {
        let of = |h: u32| {
            if shared.edit.is_placed(h) {
                return shared.edit.sets[h as usize];
            }
            let s = &shared.edit.slots[shared.edit.source[h as usize] as usize];
            shared.pages[s.page as usize].set_bits((h - s.base) as usize)
        };
        PageSets::shared(
            own.iter().copied().chain(self.foreign.iter().map(|f| f.1)).map(of).collect(),
        )
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
        shared: &WriteInput<'_>,
    ) -> bool {
        let WriteInput { edit, pages, .. } = *shared;
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
        shared: &WriteInput<'_>,
    ) -> bool {
        let WriteInput { edit, pages, relocated, .. } = *shared;
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
        // A new triangle goes next to one that it shares a vertex with.
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

/// Returns the place of a vertex in the new pages, as a number that orders the halo.
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
