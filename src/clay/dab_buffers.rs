//! The memory of dabs: one output and one task for each page that a dab writes, kept from dab to
//! dab so that a stroke allocates nothing.

use std::sync::Arc;

use glam::Vec4;

use super::layers::PageLayers;
use super::page::Page;

/// Nanoseconds spent since the clock was set, by phase.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PhaseTimes {
    /// Finding the point under the pen.
    pub pick: u64,
    /// Finding the pages that the reach touches.
    pub query: u64,
    /// The kernel.
    pub displace: u64,
    /// Normals, and taking over halos.
    pub normals: u64,
    /// Refitting trees.
    pub bvh: u64,
    /// Making snapshots.
    pub publish: u64,
    /// Putting the new pages in place.
    pub undo: u64,
}

/// A page that a dab writes: what the tasks of other pages may read.
#[derive(Debug)]
pub(super) struct PageOutput {
    pub(super) index: u32,
    pub(super) page: Arc<Page>,
    /// One for each owned vertex: [`MOVED`](super::normals::MOVED) and so on.
    pub(super) marks: Vec<u8>,
    /// All marks, joined, those of the halo's homes too.
    pub(super) any: u8,
    /// The blocks in which something moved.
    pub(super) touched: u32,
    pub(super) moved: usize,
    pub(super) affected: usize,
    /// The page holds the old page's normals and tree already.
    pub(super) complete: bool,
    /// The new face sets, one for each owned vertex, valid where marks contain
    /// [`GROUPED`](super::normals::GROUPED); empty where none do.
    pub(super) sets: Vec<u16>,
    /// The new layers of the page; `None` keeps the old page's.
    pub(super) layers: Option<Option<Arc<PageLayers>>>,
    pub(super) normals_ns: u64,
    pub(super) bvh_ns: u64,
}

/// The data of a page that a dab writes, touched only by the page's task.
#[derive(Debug)]
pub(super) struct PageTask {
    /// Parts of the halo to take over.
    pub(super) incoming: Vec<HaloPart>,
    /// Their rows, one part after the other.
    pub(super) rows: Vec<Vec4>,
    pub(super) colours: Vec<(u16, [u8; 4])>,
}

/// Halo rows in a row that one home gives.
#[derive(Debug, Clone, Copy)]
pub(super) struct HaloPart {
    pub(super) first: u16,
    pub(super) count: u16,
    /// The marks they come with, joined.
    pub(super) marks: u8,
}

impl PageTask {
    /// Each part with its rows.
    #[inline(always)]
    pub(super) fn parts(&self) -> impl Iterator<Item = (HaloPart, &[Vec4])> {
        let mut rows = self.rows.as_slice();
        self.incoming.iter().map(move |&part| {
            let (one, rest) = rows.split_at(part.count as usize);
            rows = rest;
            (part, one)
        })
    }
}

/// Pages that one dab writes, most of the time at most.
const DAB_PAGES: usize = 96;

/// The memory of dabs, kept from one to the next.
#[derive(Debug, Default)]
pub(super) struct DabBuffers {
    pub(super) slots: Vec<PageOutput>,
    pub(super) sides: Vec<PageTask>,
    pub(super) spare: Vec<(PageOutput, PageTask)>,
    /// For each page its slot in this dab plus one, or 0.
    pub(super) slot_of: Vec<u32>,
    /// The page in a spare slot: making an empty page would allocate.
    pub(super) blank: Arc<Page>,
    /// Rows that a new slot gets room for.
    pub(super) rows: usize,
}

impl DabBuffers {
    /// `rows`: of the largest page.
    pub(super) fn new(pages: usize, rows: usize) -> Self {
        DabBuffers { slot_of: vec![0; pages], rows, ..DabBuffers::default() }
    }

    /// Room for any page at once, or slots would grow one by one, long into a stroke.
    fn fresh(&self) -> (PageOutput, PageTask) {
        let slot = PageOutput {
            index: 0,
            page: self.blank.clone(),
            marks: Vec::with_capacity(self.rows),
            any: 0,
            touched: 0,
            moved: 0,
            affected: 0,
            complete: false,
            sets: Vec::new(),
            layers: None,
            normals_ns: 0,
            bvh_ns: 0,
        };
        let side = PageTask {
            incoming: Vec::with_capacity(64),
            rows: Vec::with_capacity(self.rows),
            colours: Vec::new(),
        };
        (slot, side)
    }

    /// Makes room for this many pages in the clay, and for dabs that write many of them.
    pub(super) fn reserve(&mut self, pages: usize) {
        self.slot_of.reserve(pages.saturating_sub(self.slot_of.len()));
        self.slots.reserve(256);
        self.sides.reserve(256);
        self.spare.reserve(256);
        while self.spare.len() < DAB_PAGES {
            self.spare.push(self.fresh());
        }
    }

    pub(super) fn grow(&mut self, pages: usize) {
        self.slot_of.resize(pages, 0);
    }

    pub(super) fn add(&mut self, index: u32, page: Arc<Page>) {
        let (mut slot, mut side) = self.spare.pop().unwrap_or_else(|| self.fresh());
        slot.index = index;
        slot.page = page;
        slot.marks.clear();
        (slot.any, slot.touched, slot.moved, slot.affected, slot.complete) = (0, 0, 0, 0, false);
        (slot.normals_ns, slot.bvh_ns) = (0, 0);
        slot.layers = None;
        slot.sets.clear();
        side.incoming.clear();
        side.rows.clear();
        side.colours.clear();
        self.slots.push(slot);
        self.sides.push(side);
        self.slot_of[index as usize] = self.slots.len() as u32;
    }

    /// The slot of a page, if it changed in a way of `kinds`.
    pub(super) fn changed(
        slots: &[PageOutput],
        slot_of: &[u32],
        page: u32,
        kinds: u8,
    ) -> Option<usize> {
        let s = (slot_of[page as usize] as usize).checked_sub(1)?;
        (slots[s].any & kinds != 0).then_some(s)
    }
}
