//! The clay at one moment, immutable and shared.
//!
//! A snapshot is a spine of chunks of pages. Publishing rebuilds only the chunks with a changed
//! page. The clay shares the pages themselves and replaces a page instead of changing it (copy on
//! write).

use std::sync::Arc;

use glam::Vec3;

use super::boxtree::BoxRay;
use super::page::Page;
use super::pick::{self, Found};
use super::ray::{Hit, Ray};
use crate::layers::{LayerStack, PageLayers};
use crate::multires::Levels;
use sculptd_geometry::TriMesh;

/// Pages a chunk.
pub(super) const CHUNK: usize = 32;

#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) pages: Vec<Arc<Page>>,
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
    /// The greatest number of a face set in it.
    pub(super) highest_set: u16,
}

impl Chunk {
    pub(super) fn fill(&mut self, pages: &[Arc<Page>]) {
        self.pages.clear();
        self.pages.extend_from_slice(pages);
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        (self.lo, self.hi) = pages.iter().fold(none, |(lo, hi), p| (lo.min(p.lo), hi.max(p.hi)));
        self.highest_set = pages.iter().map(|p| p.highest_set()).max().unwrap_or(0);
    }
}

#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Totals {
    pub(super) revision: u64,
    pub(super) object_id: u32,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) pages: usize,
    /// The numbers that the next new vertex and triangle get.
    pub(super) next: [u32; 2],
}

/// The clay at one moment. Cloning it costs two reference counts.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub(super) spine: Arc<Vec<Arc<Chunk>>>,
    pub(super) totals: Totals,
    pub(super) levels: Option<Arc<Levels>>,
}

impl Snapshot {
    /// As [`super::Clay::levels`].
    pub fn levels(&self) -> Option<&Arc<Levels>> {
        self.levels.as_ref()
    }

    /// As [`super::Clay::layers`].
    pub fn layers(&self) -> Option<&Arc<LayerStack>> {
        let first = (self.totals.pages > 0).then(|| self.page(0))?;
        first.layers.as_ref()?.stack.as_ref()
    }

    /// All pages in order. A page that did not change between two snapshots is the same `Arc` in
    /// both.
    pub fn pages(&self) -> impl ExactSizeIterator<Item = &Arc<Page>> + Clone {
        (0..self.totals.pages).map(|i| self.page(i as u32))
    }

    /// Returns the number of pages, including pages without vertices.
    pub fn page_count(&self) -> usize {
        self.totals.pages
    }

    /// # Panics
    /// Panics if there is no such page.
    pub fn page(&self, index: u32) -> &Arc<Page> {
        &self.spine[index as usize / CHUNK].pages[index as usize % CHUNK]
    }

    /// Calls `visit` with the number of each page that differs from `older`, at a cost of the
    /// changed pages and an eighth of a nanosecond for each other. Snapshots of different clays
    /// differ everywhere.
    pub fn each_changed(&self, older: &Snapshot, mut visit: impl FnMut(u32, &Arc<Page>)) {
        for (c, chunk) in self.spine.iter().enumerate() {
            let old = older.spine.get(c);
            if old.is_some_and(|o| Arc::ptr_eq(o, chunk)) {
                continue;
            }
            for (i, page) in chunk.pages.iter().enumerate() {
                if !old.and_then(|o| o.pages.get(i)).is_some_and(|o| Arc::ptr_eq(o, page)) {
                    visit((c * CHUNK + i) as u32, page);
                }
            }
        }
    }

    /// Calls `visit` with each page whose box, and whose chunk's box, `meets` takes, in ascending
    /// order.
    pub fn each_page_in(
        &self,
        meets: impl Fn(Vec3, Vec3) -> bool,
        mut visit: impl FnMut(u32, &Arc<Page>),
    ) {
        for (c, chunk) in self.spine.iter().enumerate().filter(|(_, c)| meets(c.lo, c.hi)) {
            for (i, page) in chunk.pages.iter().enumerate().filter(|(_, p)| meets(p.lo, p.hi)) {
                visit((c * CHUNK + i) as u32, page);
            }
        }
    }

    /// As [`super::Clay::revision`].
    pub fn revision(&self) -> u64 {
        self.totals.revision
    }

    /// As [`super::Clay::object_id`].
    pub fn object_id(&self) -> u32 {
        self.totals.object_id
    }

    /// The numbers that the next new vertex and triangle get.
    pub fn next_numbers(&self) -> [u32; 2] {
        self.totals.next
    }

    /// Returns the number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.totals.vertices
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.totals.triangles
    }

    /// Lower and upper corner of the box around everything.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.spine.iter().fold(none, |(lo, hi), c| (lo.min(c.lo), hi.max(c.hi)))
    }

    /// The colour of the surface at a hit on it, RGBA, sRGB: between those of the triangle's
    /// corners.
    pub fn colour_at(&self, hit: &Hit) -> [u8; 4] {
        let page = self.page(hit.page);
        let corners = page.triangles()[hit.triangle as usize];
        let corners = corners.map(|v| page.colour(usize::from(v)));
        std::array::from_fn(|channel| {
            let parts = corners.iter().zip(hit.barycentric);
            let sum: f32 = parts.map(|(colour, share)| f32::from(colour[channel]) * share).sum();
            sum.round() as u8
        })
    }

    /// The nearest point of the surface on the ray, seen from either side. As exact as
    /// [`super::Clay::pick`].
    pub fn pick(&self, ray: Ray) -> Option<Hit> {
        let (lo, hi) = self.bounds();
        let boxes = BoxRay::new(ray.origin, ray.dir, lo.abs().max(hi.abs()).max_element());
        let mut best: Option<Found> = None;
        for (c, chunk) in self.spine.iter().enumerate() {
            if boxes.enters(chunk.lo, chunk.hi, best.map_or(f32::INFINITY, |b| b.t)).is_none() {
                continue;
            }
            for (i, page) in chunk.pages.iter().enumerate() {
                if boxes.enters(page.lo, page.hi, best.map_or(f32::INFINITY, |b| b.t)).is_some() {
                    pick::in_page(&boxes, page, (c * CHUNK + i) as u32, &mut best);
                }
            }
        }
        Some(pick::finish(best?, ray, |i| self.page(i)))
    }

    /// From vertices' numbers to their places in [`Snapshot::to_tri`].
    pub fn ranks(&self) -> Ranks {
        ranks(&|i| self.page(i), self.totals)
    }

    /// The clay as one mesh, in the order of the mesh that was loaded. Costs as much as the clay is
    /// large.
    pub fn to_tri(&self) -> TriMesh {
        to_tri(&|i| self.page(i), self.totals)
    }

    /// One number for positions, mask, colours and triangles; costs as much as the clay is large.
    pub fn hash(&self) -> u64 {
        hash(&|i| self.page(i), self.totals)
    }
}

/// From a vertex's number to its place in the order of numbers: the same while no vertex was added
/// or taken away.
#[derive(Debug)]
pub struct Ranks(Option<Vec<u32>>);

impl Ranks {
    /// The place of a vertex; for a number that no vertex has, whatever comes.
    pub fn find(&self, id: u32) -> Option<u32> {
        self.0.as_ref().map_or(Some(id), |ranks| ranks.get(id as usize).copied())
    }

    #[inline]
    pub(super) fn of(&self, id: u32) -> usize {
        self.0.as_ref().map_or(id, |ranks| ranks[id as usize]) as usize
    }
}

pub(super) fn ranks<'a>(page: &dyn Fn(u32) -> &'a Arc<Page>, totals: Totals) -> Ranks {
    let pages = || (0..totals.pages as u32).map(page);
    let most = pages().flat_map(|p| p.topology.ids.iter()).max().map_or(0, |m| *m as usize + 1);
    if most == totals.vertices {
        return Ranks(None);
    }
    let mut ranks = vec![0u32; most];
    for page in pages() {
        page.topology.ids.iter().for_each(|id| ranks[*id as usize] = 1);
    }
    let mut count = 0;
    for r in &mut ranks {
        count += std::mem::replace(r, count);
    }
    Ranks(Some(ranks))
}

/// In the order of the mesh that was loaded. Triangles that were left out at load are not there:
/// the others close up.
pub(super) fn to_tri<'a>(page: &dyn Fn(u32) -> &'a Arc<Page>, totals: Totals) -> TriMesh {
    let rank = ranks(page, totals);
    let mut positions = vec![Vec3::ZERO; totals.vertices];
    let mut colours = vec![[255u8; 4]; totals.vertices];
    let mut triangles: Vec<(u32, [u32; 3])> = Vec::with_capacity(totals.triangles);
    for p in 0..totals.pages as u32 {
        let one = page(p);
        let t = &one.topology;
        for (v, &id) in t.ids.iter().enumerate() {
            let id = rank.of(id);
            positions[id] = one.point(v);
            colours[id] = one.colour(v);
        }
        for (corners, &id) in t.triangles.iter().zip(&t.triangle_ids) {
            triangles.push((
                id,
                corners.map(|v| match (v as usize).checked_sub(t.own) {
                    None => rank.of(t.ids[v as usize]) as u32,
                    Some(k) => {
                        let (home, local) = t.halo_home(k);
                        rank.of(page(home).topology.ids[local as usize]) as u32
                    }
                }),
            ));
        }
    }
    triangles.sort_unstable_by_key(|t| t.0);
    TriMesh {
        positions,
        triangles: triangles.into_iter().map(|t| t.1).collect(),
        colours: colours.iter().any(|c| *c != [255; 4]).then_some(colours),
    }
}

/// FNV-1a, 64 bits, a word at a time, over positions, mask, colours and triangles in the loaded
/// order, then over the layers and the face sets, where there are any.
pub(super) fn hash<'a>(page: &dyn Fn(u32) -> &'a Arc<Page>, totals: Totals) -> u64 {
    let plain = to_tri(page, totals);
    let rank = ranks(page, totals);
    let mut mask = vec![0u32; totals.vertices];
    for p in 0..totals.pages as u32 {
        let one = page(p);
        for (v, &id) in one.topology.ids.iter().enumerate() {
            mask[rank.of(id)] = one.mask(v).to_bits();
        }
    }
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    let mut eat = |bits: u32| h = (h ^ u64::from(bits)).wrapping_mul(0x0000_0100_0000_01b3);
    for (v, p) in plain.positions.iter().enumerate() {
        for c in p.to_array() {
            eat(c.to_bits());
        }
        eat(mask[v]);
        eat(plain.colours.as_ref().map_or(u32::MAX, |c| u32::from_le_bytes(c[v])));
    }
    plain.triangles.iter().flatten().for_each(|&v| eat(v));
    for p in 0..totals.pages as u32 {
        page(p).layers().map(PageLayers::words).into_iter().flatten().for_each(&mut eat);
        let own = page(p).own();
        page(p).sets().iter().flat_map(|s| &s.rows()[..own]).for_each(|&s| eat(u32::from(s)));
    }
    h
}
