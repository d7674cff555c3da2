//! A cut in the clay as plain data: the triangles removed, the triangles added, and the state of
//! the pages that it was computed from. It can be sent, stored and replayed. It applies only where
//! that state is unchanged.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::super::page::{Page, PageTopology};
use super::super::snapshot::Snapshot;

/// The place of a vertex: its page and its local index among the page's owned vertices.
pub type Home = (u32, u16);

/// A corner of an added triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Corner {
    /// A vertex that is in the clay already.
    Old(Home),
    /// Index into the new vertices.
    New(u32),
}

/// A vertex that comes with the new triangles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NewVertex {
    /// The position; every coordinate must be finite.
    pub place: Vec3,
    /// RGBA, sRGB.
    pub colour: [u8; 4],
    /// 0 free to 1 protected.
    pub mask: f32,
}

/// The triangles to remove and to add. Both sets have the same border.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cut {
    /// Lower corner of the inspected box: every page that meets the box is among `seen`.
    pub lo: Vec3,
    /// The upper corner of that box.
    pub hi: Vec3,
    /// Page and stamp of each page that was inspected, will be written or is next to one,
    /// ascending.
    seen: Vec<(u32, u64)>,
    /// Page, index of the triangle in it.
    pub(super) removed: Vec<(u32, u32)>,
    pub(super) added: Vec<[Corner; 3]>,
    pub(super) new: Vec<NewVertex>,
}

/// The result of an applied cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grafted {
    /// The number of pages that were rewritten or added.
    pub written: usize,
    /// The number of pages shared with the old clay.
    pub shared: usize,
}

/// Home of a local vertex.
pub fn home_of(t: &PageTopology, page: u32, v: u16) -> Home {
    match (v as usize).checked_sub(t.own) {
        None => (page, v),
        Some(k) => t.halo_home(k),
    }
}

impl Cut {
    /// `lo`, `hi`: the box in which the clay was looked at.
    pub fn new(
        clay: &Snapshot,
        (lo, hi): (Vec3, Vec3),
        removed: Vec<(u32, u32)>,
        added: Vec<[Corner; 3]>,
        new: Vec<NewVertex>,
    ) -> Cut {
        let mut cut = Cut { lo, hi, seen: Vec::new(), removed, added, new };
        let (inner, beside) = concerned(clay, &touched(clay, &cut));
        let mut pages = [inner, beside, within(clay, lo, hi)].concat();
        pages.sort_unstable();
        pages.dedup();
        cut.seen = pages.into_iter().map(|p| (p, stamp(clay.page(p)))).collect();
        cut
    }

    /// Returns the number of inspected pages, including those to be written.
    pub fn page_count(&self) -> usize {
        self.seen.len()
    }

    /// Page and index of each triangle that goes.
    pub fn removed(&self) -> &[(u32, u32)] {
        &self.removed
    }

    /// The triangles that come.
    pub fn added(&self) -> &[[Corner; 3]] {
        &self.added
    }

    /// The vertices that come with them.
    pub fn new_vertices(&self) -> &[NewVertex] {
        &self.new
    }

    /// Returns true if the clay around the cut still has the state that the cut was computed from.
    /// Returns false for any cut that is not valid.
    pub(crate) fn fits(&self, clay: &Snapshot) -> bool {
        let there = |p: u32| self.seen.binary_search_by_key(&p, |s| s.0).is_ok();
        let count = clay.page_count();
        let as_seen = self.seen.is_sorted_by(|a, b| a.0 < b.0)
            && self.seen.iter().all(|&(p, s)| (p as usize) < count && stamp(clay.page(p)) == s)
            && within(clay, self.lo, self.hi).into_iter().all(there);
        let named = |c: &Corner| match *c {
            Corner::Old((p, v)) => there(p) && (v as usize) < clay.page(p).own(),
            Corner::New(i) => (i as usize) < self.new.len(),
        };
        let known =
            |&(p, t): &(u32, u32)| there(p) && (t as usize) < clay.page(p).triangles().len();
        let sane = |v: &NewVertex| v.place.is_finite() && (0.0..=1.0).contains(&v.mask);
        as_seen
            && self.removed.iter().all(known)
            && self.added.iter().flatten().all(named)
            && self.new.iter().all(sane)
            && {
                let (inner, beside) = concerned(clay, &touched(clay, self));
                inner.into_iter().chain(beside).all(there)
            }
    }
}

fn within(clay: &Snapshot, lo: Vec3, hi: Vec3) -> Vec<u32> {
    let mut out = Vec::new();
    clay.each_page_in(|l, h| l.cmple(hi).all() && lo.cmple(h).all(), |p, _| out.push(p));
    out
}

/// Vertices that lose or get a triangle, ascending.
pub(super) fn touched(clay: &Snapshot, cut: &Cut) -> Vec<Home> {
    let gone = cut.removed.iter().flat_map(|&(p, t)| {
        let topology = clay.page(p).topology();
        topology.triangles[t as usize].map(|v| home_of(topology, p, v))
    });
    let old = |c: &Corner| match *c {
        Corner::Old(h) => Some(h),
        Corner::New(_) => None,
    };
    let mut out: Vec<Home> = gone.chain(cut.added.iter().flatten().filter_map(old)).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Returns the pages to write, and the pages that share a triangle with them; both ascending.
pub(super) fn concerned(clay: &Snapshot, touched: &[Home]) -> (Vec<u32>, Vec<u32>) {
    let mut inner: Vec<u32> = touched.iter().map(|h| h.0).collect();
    inner.dedup();
    let mut beside: Vec<u32> = inner
        .iter()
        .flat_map(|&p| clay.page(p).topology().neighbours.iter().map(|n| n.page))
        .collect();
    beside.sort_unstable();
    beside.dedup();
    beside.retain(|p| inner.binary_search(p).is_err());
    (inner, beside)
}

/// One number for a page's positions, mask and triangles (FNV-1a, a word at a time).
fn stamp(page: &Page) -> u64 {
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    let mut eat = |word: u64| h = (h ^ word).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
    let t = page.topology();
    eat(t.own as u64);
    for p in &page.points {
        let [x, y, z, w] = p.to_array().map(|c| u64::from(c.to_bits()));
        eat(x << 32 | y);
        eat(z << 32 | w);
    }
    for &[a, b, c] in &t.triangles {
        eat(u64::from(a) << 32 | u64::from(b) << 16 | u64::from(c));
    }
    for n in &t.neighbours {
        eat(u64::from(n.page) << 32 | u64::from(n.first));
    }
    h
}
