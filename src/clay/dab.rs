//! One dab: what it costs follows the pages it reaches.
//!
//! 1. *query*: pages whose box the reach touches.
//! 2. *displace*: each page is copied to a fresh one, where the kernel writes. Kernels read only
//!    the old pages.
//! 3. *normals*, *bvh*: halos take over what moved at home; normals of moved vertices and of their
//!    neighbours; trees. Then halos take over the turned normals.
//! 4. *undo*: the new pages take the old ones' places; the old ones go to the open step or to the
//!    pool.
//!
//! Each array element is written by one task, and each task reads only what earlier phases wrote:
//! the same bits with any number of workers. All memory is kept from dab to dab; only a dab that
//! puts vertices into other face sets allocates for pages whose sets nobody has let go of yet, two
//! bytes a vertex.

use std::sync::Arc;

use super::clay::Clay;
use super::dab_buffers::{DabBuffers, HaloPart, PageOutput, PageTask};
use super::kernel::{Kernel, PageIn, PageOut};
use super::layers::LayerStack;
use super::normals::{GROUPED, LAYERED, MOVED, PAINTED, TURNED, around_moved};
use super::page::{BLOCK, Page, block_of};
use super::page_sets::HIDDEN;
use super::pool::Pool;
use super::reach::Reach;
use super::workers::Workers;
use sculptd_geometry::simd::wide::{Wide, WideWork, dispatch};

/// Rows below which one thread does a dab alone: waking another costs more than it helps.
const PARALLEL: usize = 6 * 1024;

/// The result of a dab.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DabReport {
    /// Vertices that the kernel counted.
    pub affected: usize,
    /// Vertices with a new position, mask, colour or face set.
    pub moved: usize,
    /// The number of pages rewritten.
    pub pages: usize,
}

/// Adds the pages whose halo holds a vertex that changed in a way of `kinds` and that have no slot
/// yet.
fn add_neighbours(mesh: &mut Clay, from: usize, kinds: u8) {
    for s in 0..from {
        if mesh.buffers.slots[s].any & kinds == 0 {
            continue;
        }
        let home = mesh.buffers.slots[s].index;
        let topology = mesh.pages[home as usize].topology.clone();
        for n in &topology.neighbours {
            if mesh.buffers.slot_of[n.page as usize] != 0 {
                continue;
            }
            let other = &mesh.pages[n.page as usize].topology;
            let marks = &mesh.buffers.slots[s].marks;
            let touched =
                other.halo_parts().find(|(page, _)| *page == home).is_some_and(|(_, part)| {
                    other.halo_sources[part].iter().any(|&l| marks[l as usize] & kinds != 0)
                });
            if touched {
                let page = mesh.pool.take();
                mesh.buffers.add(n.page, page);
            }
        }
    }
}

/// A kernel behind one table of functions, so that the driver of a dab is compiled once and not for
/// each brush; only the pass over one page is.
trait PageKernel: Sync {
    /// [`displace`], compiled for this processor.
    fn displace(&self, slot: &mut PageOutput, side: &mut PageTask, was: &PageBefore<'_>);
}

/// A page before a dab.
struct PageBefore<'a> {
    old: &'a Page,
    /// The page when the open step began.
    before: &'a Page,
    stack: Option<&'a LayerStack>,
}

impl<K: Kernel> PageKernel for K {
    fn displace(&self, slot: &mut PageOutput, side: &mut PageTask, was: &PageBefore<'_>) {
        dispatch(false, Displace { slot, side, was, kernel: self });
    }
}

impl Clay {
    /// Lets `kernel` change what `reach` touches. See the module for what happens.
    pub fn dab<K: Kernel>(&mut self, reach: &Reach, kernel: &K, workers: &Workers) -> DabReport {
        self.dab_pages(Some(reach), &[], kernel, workers)
    }

    /// Lets `kernel` change these pages, ascending.
    pub fn dab_on<K: Kernel>(&mut self, pages: &[u32], kernel: &K, workers: &Workers) -> DabReport {
        self.dab_pages(None, pages, kernel, workers)
    }

    /// What `reach` touches is changed, or without one the pages of a list.
    fn dab_pages(
        &mut self,
        reach: Option<&Reach>,
        list: &[u32],
        kernel: &dyn PageKernel,
        workers: &Workers,
    ) -> DabReport {
        let now = self.clock.unwrap_or(|| 0);
        let t0 = now();
        let mut rows = 0;
        {
            let Clay { top, buffers, pool, pages, .. } = self;
            let mut add = |p: usize| {
                rows += pages[p].points.len();
                buffers.add(p as u32, pool.take());
            };
            match reach {
                Some(reach) => top.walk_boxes(|lo, hi| reach.touches(lo, hi), add),
                None => list.iter().for_each(|&p| add(p as usize)),
            }
        }
        let stack = self.layers().cloned();
        let t1 = now();
        let parallel = rows > PARALLEL;
        let selected = self.buffers.slots.len();
        {
            let Clay { buffers, pages, history, .. } = self;
            workers.each(parallel, &mut buffers.slots, &mut buffers.sides, |slot, side| {
                let (old, before) = (&pages[slot.index as usize], history.before(slot.index));
                let same = |b: &&Arc<Page>| Arc::ptr_eq(&b.topology, &old.topology);
                let before = before.filter(same).unwrap_or(old);
                kernel.displace(slot, side, &PageBefore { old, before, stack: stack.as_deref() });
            });
        }
        add_neighbours(self, selected, MOVED | PAINTED | GROUPED);
        let t2 = now();
        {
            let Clay { buffers, pages, .. } = self;
            let DabBuffers { slots, sides, slot_of, .. } = buffers;
            let mut indices = std::mem::take(&mut self.order);
            indices.clear();
            indices.extend(0..slots.len() as u32);
            workers.each(parallel, &mut indices, sides, |s, side| {
                collect_halo(
                    slots,
                    slot_of,
                    *s,
                    &pages[slots[*s as usize].index as usize],
                    side,
                    MOVED | PAINTED | GROUPED,
                );
            });
            self.order = indices;
            let clock = now;
            workers.each(parallel, slots, sides, |slot, side| {
                let old = &pages[slot.index as usize];
                dispatch(false, TurnNormals { slot, side, old, now: clock });
            });
        }
        let turned = self.buffers.slots.len();
        add_neighbours(self, turned, TURNED | PAINTED);
        {
            let Clay { buffers, pages, .. } = self;
            let DabBuffers { slots, sides, slot_of, .. } = buffers;
            let mut indices = std::mem::take(&mut self.order);
            indices.clear();
            indices.extend(0..slots.len() as u32);
            workers.each(parallel, &mut indices, sides, |s, side| {
                collect_halo(
                    slots,
                    slot_of,
                    *s,
                    &pages[slots[*s as usize].index as usize],
                    side,
                    TURNED | PAINTED,
                );
            });
            self.order = indices;
            workers.each(parallel, slots, sides, |slot, side| {
                settle(slot, side, &pages[slot.index as usize]);
            });
        }
        let t3 = now();
        let (report, normals_ns, bvh_ns) = self.commit();
        let t4 = now();
        if self.clock.is_some() {
            let times = &mut self.phases;
            times.query += t1 - t0;
            times.displace += t2 - t1;
            // Both happen in one pass over the pages: parted by what each took within it.
            let within = (normals_ns + bvh_ns).max(1);
            let bvh = (t3 - t2) * bvh_ns / within;
            times.bvh += bvh;
            times.normals += t3 - t2 - bvh;
            times.undo += t4 - t3;
        }
        report
    }

    /// New pages take the old ones' places.
    fn commit(&mut self) -> (DabReport, u64, u64) {
        let mut report = DabReport::default();
        let (mut normals_ns, mut bvh_ns) = (0, 0);
        let Clay { buffers, pages, pool, history, top, stale, revision, .. } = self;
        let changes = buffers.slots.iter().any(|s| s.any != 0);
        *revision += u64::from(changes);
        let retired = buffers.slots.len();
        for s in 0..buffers.slots.len() {
            if buffers.slots[s].any & GROUPED != 0 {
                regroup(buffers, s, pages, pool);
            }
        }
        for (mut slot, side) in buffers.slots.drain(..).zip(buffers.sides.drain(..)) {
            buffers.slot_of[slot.index as usize] = 0;
            report.affected += slot.affected;
            report.moved += slot.moved;
            normals_ns += slot.normals_ns;
            bvh_ns += slot.bvh_ns;
            let mut page = std::mem::replace(&mut slot.page, buffers.blank.clone());
            if slot.any == 0 {
                pool.give_back(page);
            } else {
                report.pages += 1;
                if let Some(page) = Arc::get_mut(&mut page) {
                    page.revision = *revision;
                    page.layers = match slot.layers.take() {
                        Some(layers) => layers,
                        None => pages[slot.index as usize].layers.clone(),
                    };
                    if slot.any & GROUPED == 0 {
                        page.sets.clone_from(&pages[slot.index as usize].sets);
                    }
                    top.set_leaf(slot.index as usize, page.lo, page.hi);
                }
                stale.add(slot.index);
                let old = std::mem::replace(&mut pages[slot.index as usize], page);
                if let Some(old) = history.keep(slot.index, old) {
                    pool.retire(old);
                }
            }
            buffers.spare.push((slot, side));
        }
        for &chunk in stale.paths() {
            top.refit_path(chunk as usize);
        }
        stale.clear_paths();
        history.trim();
        pool.reclaim(2 * retired + 4);
        (report, normals_ns, bvh_ns)
    }
}

/// [`displace`], compiled for this processor.
struct Displace<'a, K> {
    slot: &'a mut PageOutput,
    side: &'a mut PageTask,
    was: &'a PageBefore<'a>,
    kernel: &'a K,
}

impl<K: Kernel> WideWork for Displace<'_, K> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        displace(self.slot, self.side, self.was, self.kernel);
    }
}

/// [`turn_normals`], compiled for this processor.
struct TurnNormals<'a> {
    slot: &'a mut PageOutput,
    side: &'a mut PageTask,
    old: &'a Page,
    now: fn() -> u64,
}

impl WideWork for TurnNormals<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, w: W) {
        turn_normals(w, self.slot, self.side, self.old, self.now);
    }
}

/// Copies the points and lets the kernel write.
#[inline(always)]
fn displace<K: Kernel>(
    slot: &mut PageOutput,
    side: &mut PageTask,
    was: &PageBefore<'_>,
    kernel: &K,
) {
    let old = was.old;
    let Some(page) = Arc::get_mut(&mut slot.page) else { return };
    page.points.clear();
    page.points.extend_from_slice(&old.points);
    let own = old.topology.own;
    slot.marks.resize(own, 0);
    let mut out = PageOut {
        points: &mut page.points[..own],
        marks: &mut slot.marks,
        colours: &mut side.colours,
        sets: &mut slot.sets,
        affected: 0,
        layers: None,
    };
    let seen = if K::SEES_START { was.before } else { old };
    kernel.page(&PageIn::new(slot.index, seen, was.before, was.stack), &mut out);
    slot.affected = out.affected;
    slot.layers = out.layers;
    if !K::CHANGES_HIDDEN
        && let Some(rows) = old.hidden_rows()
    {
        for (v, mark) in slot.marks.iter_mut().enumerate() {
            if *mark != 0 && rows[v] & HIDDEN != 0 {
                page.points[v] = old.points[v];
                *mark = 0;
            }
        }
        side.colours.retain(|(v, _)| rows[*v as usize] & HIDDEN == 0);
    }
    tally(slot);
    slot.any |= if slot.layers.is_some() { LAYERED } else { 0 };
}

/// Gives the new page of slot `s` its face sets: the former ones, and the new ones where marks are
/// set, for owned and halo vertices.
fn regroup(buffers: &mut DabBuffers, s: usize, pages: &[Arc<Page>], pool: &mut Pool) {
    let DabBuffers { slots, slot_of, .. } = buffers;
    let old = &pages[slots[s].index as usize];
    let mut fresh = pool.take_sets();
    let Some(sets) = Arc::get_mut(&mut fresh) else { return };
    sets.rows.clear();
    sets.rows.extend((0..old.points.len()).map(|v| old.set_bits(v)));
    let new = |slot: &PageOutput, l: usize, was: u16| match slot.marks.get(l) {
        Some(marks) if marks & GROUPED != 0 => was & HIDDEN | slot.sets[l],
        _ => was,
    };
    let (own, halo) = sets.rows.split_at_mut(old.own());
    if !slots[s].sets.is_empty() {
        own.iter_mut().enumerate().for_each(|(v, row)| *row = new(&slots[s], v, *row));
    }
    for (home, part) in old.topology.halo_parts() {
        let Some(from) = DabBuffers::changed(slots, slot_of, home, GROUPED) else { continue };
        let sources = &old.topology.halo_sources[part.clone()];
        for (row, &l) in halo[part].iter_mut().zip(sources) {
            *row = new(&slots[from], usize::from(l), *row);
        }
    }
    let any = sets.index();
    if let Some(page) = Arc::get_mut(&mut slots[s].page) {
        page.sets = match any {
            true => Some(fresh),
            false => {
                pool.give_back_sets(fresh);
                None
            }
        };
    }
}

/// Joins all marks, counts them, and finds the blocks in which something moved.
#[inline(always)]
fn tally(slot: &mut PageOutput) {
    for (b, chunk) in slot.marks.chunks(BLOCK).enumerate() {
        let (mut any, mut few) = (0, 0u8);
        for &m in chunk {
            any |= m;
            few += u8::from(m != 0);
        }
        slot.any |= any;
        slot.moved += few as usize;
        slot.touched |= if any & MOVED != 0 { block_of(b * BLOCK) } else { 0 };
    }
}

/// Collects what changed at the homes of slot `s`'s halo.
fn collect_halo(
    slots: &[PageOutput],
    slot_of: &[u32],
    s: u32,
    old: &Page,
    side: &mut PageTask,
    kinds: u8,
) {
    side.incoming.clear();
    side.rows.clear();
    let t = &old.topology;
    for (home, part) in t.halo_parts() {
        let Some(from) = DabBuffers::changed(slots, slot_of, home, kinds) else { continue };
        if from == s as usize {
            continue;
        }
        let from = &slots[from];
        let marks =
            t.halo_sources[part.clone()].iter().fold(0, |m, &l| m | from.marks[l as usize]) & kinds;
        if marks != 0 {
            // All of the part: what did not change is the same there and here.
            let rows = if kinds & MOVED != 0 { &from.page.points } else { &from.page.normals };
            side.rows.extend(t.halo_sources[part.clone()].iter().map(|&l| rows[l as usize]));
            let first = (t.own + part.start) as u16;
            side.incoming.push(HaloPart { first, count: part.len() as u16, marks });
        }
    }
}

/// Takes over the halo's new places, and computes the normals and the tree.
#[inline(always)]
fn turn_normals<W: Wide>(
    w: W,
    slot: &mut PageOutput,
    side: &mut PageTask,
    old: &Page,
    now: fn() -> u64,
) {
    if slot.any == 0 && side.incoming.is_empty() {
        return;
    }
    let Some(page) = Arc::get_mut(&mut slot.page) else { return };
    let t0 = now();
    if slot.marks.is_empty() {
        page.points.clear();
        page.points.extend_from_slice(&old.points);
        slot.marks.resize(old.topology.own, 0);
    }
    for (part, rows) in side.parts() {
        let first = part.first as usize;
        page.points[first..first + rows.len()].copy_from_slice(rows);
        slot.any |= part.marks;
        if part.marks & MOVED != 0 {
            (first..first + rows.len())
                .step_by(BLOCK)
                .for_each(|row| slot.touched |= block_of(row));
            slot.touched |= block_of(first + rows.len() - 1);
        }
    }
    slot.complete = true;
    if !Arc::ptr_eq(&page.topology, &old.topology) {
        page.topology = old.topology.clone();
    }
    let moved = slot.any & MOVED != 0;
    if moved {
        around_moved(w, page, &old.normals, &mut slot.marks, slot.touched);
        slot.any |= TURNED;
    } else {
        page.normals.clear();
        page.normals.extend_from_slice(&old.normals);
    }
    for &(v, colour) in &side.colours {
        page.normals[v as usize].w = f32::from_bits(u32::from_le_bytes(colour));
    }
    let t1 = now();
    page.tree.copy_from(&old.tree);
    (page.lo, page.hi) = (old.lo, old.hi);
    if moved {
        page.refit(slot.touched);
    }
    slot.normals_ns = t1 - t0;
    slot.bvh_ns = now() - t1;
}

/// Takes over the halo's new normals and colours.
fn settle(slot: &mut PageOutput, side: &mut PageTask, old: &Page) {
    if side.incoming.is_empty() {
        return;
    }
    let Some(page) = Arc::get_mut(&mut slot.page) else { return };
    if !slot.complete {
        page.topology.clone_from(&old.topology);
        page.points.clear();
        page.points.extend_from_slice(&old.points);
        page.normals.clear();
        page.normals.extend_from_slice(&old.normals);
        page.tree.copy_from(&old.tree);
        (page.lo, page.hi) = (old.lo, old.hi);
    }
    for (part, rows) in side.parts() {
        page.normals[part.first as usize..][..rows.len()].copy_from_slice(rows);
        slot.any |= part.marks;
    }
}
