//! One page: some five hundred vertices, their surroundings, and the triangles between them.
//!
//! Laws kept here:
//! * A page holds its **own** vertices and copies (the **halo**) of the foreign vertices that its
//!   triangles and rings need, so every inner loop stays within the page. Local index `< own` is
//!   own, the rest is halo.
//! * What never changes while the topology stands ([`PageTopology`]) is apart from what a dab
//!   changes, so that copy on write copies only the latter.
//! * A vertex is two 16-byte rows: position with mask, normal with colour. A ring's neighbour is
//!   one aligned load.

use std::sync::Arc;

use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};

use super::boxtree::{BoxTree, LEAF};

use super::layers::PageLayers;
use super::page_sets::{HIDDEN, PageSets, all_hidden};
use sculptd_geometry::simd::leaves::Leaves;
use sculptd_geometry::simd::rings::Hexes;

/// The bit of a ring's entry that says: between the entry before and this one there is no triangle.
pub const BREAK: u16 = 0x8000;

/// The number of vertices in a block, owned and halo in a row: the resolution of tracking movement.
pub(super) const BLOCK: usize = 32;

/// The bit of the block that a row is in. All beyond the last bit share it.
#[inline(always)]
pub(super) fn block_of(row: usize) -> u32 {
    1 << (row / BLOCK).min(31)
}

/// The arrangement of the triangles around a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Ring {
    /// One closed fan: the last neighbour and the first make a triangle too.
    Closed,
    /// One open fan: the vertex is on the border of the surface. Also a vertex without triangles.
    Open,
    /// Several fans, parted by [`BREAK`]; a closed one among them repeats its first neighbour.
    ManyFans,
}

/// A page from which others are seen: its number, and where its part of the halo begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Neighbour {
    /// The number of that page.
    pub page: u32,
    /// Index into [`PageTopology::halo_sources`]; the part ends where the next neighbour's begins.
    pub first: u32,
}

/// The part of a page that stays fixed while the mesh is only displaced.
#[derive(Debug, Default, Clone, Serialize, Deserialize)]
pub struct PageTopology {
    /// The number of owned vertices.
    pub own: usize,
    /// The owned vertices' numbers in the mesh that was loaded.
    pub ids: Vec<u32>,
    /// Local corners, counter-clockwise seen from outside. In the order of the page's tree: eight
    /// make a leaf.
    pub triangles: Vec<[u16; 3]>,
    /// The triangles' numbers in the mesh that was loaded.
    pub triangle_ids: Vec<u32>,
    /// The rings of the first own vertices: they have a closed one of six each, as most vertices of
    /// most meshes have.
    pub hexes: Hexes,
    /// The rings of the others: vertex `hexes.len() + i` has `rings[ring_starts[i]..ring_starts[i +
    /// 1]]`.
    pub ring_starts: Vec<u16>,
    /// The rings' local indices, with [`BREAK`] bits.
    pub rings: Vec<u16>,
    /// The arrangement of the triangles around each owned vertex.
    pub kinds: Vec<Ring>,
    /// The vertices of each leaf of the page's tree. This and what comes after follows from the
    /// rest when a page is made or read.
    #[serde(skip)]
    pub leaves: Leaves,
    /// The blocks of each 32 owned vertices and their rings.
    #[serde(skip)]
    pub ring_blocks: Vec<u32>,
    /// The blocks of the vertices of each eight leaves of the page's tree.
    #[serde(skip)]
    pub leaf_blocks: Vec<u32>,
    /// Owned vertices whose triangles are all in other pages, or that have none: they are not in
    /// the page's tree.
    #[serde(skip)]
    pub loose: Vec<u16>,
    /// Local index of each halo vertex in its home page.
    pub halo_sources: Vec<u16>,
    /// The homes of the halo, ascending. Neighbourhood is mutual.
    pub neighbours: Vec<Neighbour>,
}

impl PageTopology {
    /// The neighbours of own vertex `v`, counter-clockwise, [`BREAK`] bits included.
    #[inline(always)]
    pub fn ring(&self, v: usize) -> &[u16] {
        match self.hexes.get(v) {
            Some(ring) => ring,
            None => {
                let i = v - self.hexes.len();
                &self.rings[self.ring_starts[i] as usize..self.ring_starts[i + 1] as usize]
            }
        }
    }

    /// Fills in what follows from the rest: the leaves, which blocks lie where, and what the tree
    /// does not know. False where the leaves have too many corners.
    #[must_use]
    pub(super) fn index(&mut self) -> bool {
        self.index_with(&mut Vec::new())
    }

    /// As [`PageTopology::index`], with memory that the caller keeps: allocates nothing where the
    /// topology had room before.
    #[must_use]
    pub(super) fn index_with(&mut self, seen: &mut Vec<u16>) -> bool {
        seen.clear();
        seen.resize(self.own + self.halo_sources.len(), u16::MAX);
        let PageTopology { own, triangles, leaves, leaf_blocks, loose, .. } = self;
        if !leaves.refill(triangles, LEAF, seen) {
            return false;
        }
        leaf_blocks.clear();
        leaf_blocks.extend(
            triangles
                .chunks(8 * LEAF)
                .map(|some| some.iter().flatten().fold(0, |bits, &v| bits | block_of(v as usize))),
        );
        loose.clear();
        // The leaves have met every vertex of a triangle.
        loose.extend((0..*own as u16).filter(|&v| seen[v as usize] == u16::MAX));
        let mut blocks = std::mem::take(&mut self.ring_blocks);
        blocks.clear();
        blocks.extend((0..self.own.div_ceil(BLOCK)).map(|b| {
            (b * BLOCK..self.own.min((b + 1) * BLOCK)).fold(block_of(b * BLOCK), |bits, v| {
                self.ring(v).iter().fold(bits, |bits, &k| bits | block_of((k & !BREAK) as usize))
            })
        }));
        self.ring_blocks = blocks;
        true
    }

    /// Makes room for a page of about `own` vertices, so that it can be written again and again
    /// without asking for more.
    pub(super) fn reserve(&mut self, own: usize) {
        fn room<T>(of: &mut Vec<T>, count: usize) {
            of.clear();
            of.reserve(count);
        }
        room(&mut self.ids, own);
        room(&mut self.kinds, own);
        room(&mut self.triangles, own * 5 / 2);
        room(&mut self.triangle_ids, own * 5 / 2);
        room(&mut self.rings, own * 7);
        room(&mut self.ring_starts, own + 1);
        room(&mut self.ring_blocks, own.div_ceil(BLOCK) + 1);
        room(&mut self.leaf_blocks, own);
        room(&mut self.loose, own);
        room(&mut self.halo_sources, 2 * own);
        room(&mut self.neighbours, 64);
        self.hexes.reserve(own);
        self.leaves.reserve(own * 5 / 2 / LEAF, own * 8);
    }

    /// Home page of halo vertex `k` (counted from the first halo vertex), and its local index
    /// there.
    pub fn halo_home(&self, k: usize) -> (u32, u16) {
        let n = self.neighbours.partition_point(|n| n.first as usize <= k) - 1;
        (self.neighbours[n].page, self.halo_sources[k])
    }

    /// The halo's parts: home page, and which halo vertices are its.
    pub fn halo_parts(&self) -> impl Iterator<Item = (u32, std::ops::Range<usize>)> + '_ {
        self.neighbours.iter().enumerate().map(|(i, n)| {
            let end = self
                .neighbours
                .get(i + 1)
                .map_or(self.halo_sources.len(), |next| next.first as usize);
            (n.page, n.first as usize..end)
        })
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<PageTopology>()
            + self.ids.len() * 4
            + self.triangles.len() * 10
            + self.hexes.len() * 12
            + (self.ring_blocks.len() + self.leaf_blocks.len()) * 4
            + self.loose.len() * 2
            + self.ring_starts.len() * 2
            + self.leaves.bytes()
            + self.rings.len() * 2
            + self.kinds.len()
            + self.halo_sources.len() * 2
            + self.neighbours.len() * size_of::<Neighbour>()
    }
}

/// Rows of 16 bytes, read as points.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a>(pub &'a [Vec4]);

impl Points<'_> {
    /// The position in row `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        self.0[i].truncate()
    }

    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns true if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The part of a page that a dab may change, and the topology it belongs to.
#[derive(Debug, Default)]
pub struct Page {
    pub(super) topology: Arc<PageTopology>,
    /// Own, then halo: x, y, z, mask (0 free to 1 protected).
    pub(super) points: Vec<Vec4>,
    /// Own, then halo: unit normal (zero where all triangles are degenerate), and RGBA as the bits
    /// of a float.
    pub(super) normals: Vec<Vec4>,
    /// Over the page's triangles, eight a leaf.
    pub(super) tree: BoxTree,
    /// Of the page's triangles and own vertices.
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
    /// The clay's revision that wrote this page.
    pub(super) revision: u64,
    /// Base and offsets of the layers that change the page.
    pub(super) layers: Option<Arc<PageLayers>>,
    /// Face sets and what is hidden, own and halo.
    pub(super) sets: Option<Arc<PageSets>>,
}

impl Page {
    /// The same page again, its topology shared.
    pub(super) fn copy(&self) -> Page {
        Page {
            topology: self.topology.clone(),
            points: self.points.clone(),
            normals: self.normals.clone(),
            tree: self.tree.clone(),
            lo: self.lo,
            hi: self.hi,
            revision: self.revision,
            layers: self.layers.clone(),
            sets: self.sets.clone(),
        }
    }

    /// Makes this page the same as `other`, in the memory that it has.
    pub(super) fn fill_from(&mut self, other: &Page) {
        self.topology.clone_from(&other.topology);
        self.points.clear();
        self.points.extend_from_slice(&other.points);
        self.normals.clear();
        self.normals.extend_from_slice(&other.normals);
        self.tree.copy_from(&other.tree);
        (self.lo, self.hi) = (other.lo, other.hi);
        self.layers.clone_from(&other.layers);
        self.sets.clone_from(&other.sets);
    }

    /// Returns the page's layer data; `None` if no layer changes it.
    pub fn layers(&self) -> Option<&PageLayers> {
        self.layers.as_deref()
    }

    /// The list of layers goes along from the page that this one takes the place of.
    pub(super) fn keep_layer_stack(&mut self, old: &Page) {
        let Some(stack) = old.layers().and_then(|l| l.stack.as_ref()) else { return };
        if self.layers().is_some_and(|l| l.stack.is_some()) {
            return;
        }
        let mut layers = self.layers().cloned().unwrap_or_default();
        layers.stack = Some(stack.clone());
        self.layers = layers.shared();
    }

    /// Returns the part that stays fixed while the page is only displaced.
    pub fn topology(&self) -> &Arc<PageTopology> {
        &self.topology
    }

    /// Returns true if an owned vertex is on a border, or its ring is not one closed fan.
    pub fn is_border(&self, own: usize) -> bool {
        self.topology.kinds[own] != Ring::Closed
    }

    /// Own vertices; the rest of every array is halo.
    pub fn own(&self) -> usize {
        self.topology.own
    }

    /// Own and halo vertices as rows of x, y, z, mask: ready for a GPU.
    pub fn point_rows(&self) -> &[Vec4] {
        &self.points
    }

    /// Own and halo normals as rows of x, y, z and RGBA bits: ready for a GPU. Never compare or add
    /// whole rows: the colour's bits may spell "not a number".
    pub fn normal_rows(&self) -> &[Vec4] {
        &self.normals
    }

    /// Own and halo positions.
    pub fn positions(&self) -> Points<'_> {
        Points(&self.points)
    }

    /// Own and halo unit normals; zero where all triangles are degenerate.
    pub fn normals(&self) -> Points<'_> {
        Points(&self.normals)
    }

    /// An own or a halo vertex.
    #[inline]
    pub fn point(&self, local: usize) -> Vec3 {
        self.points[local].truncate()
    }

    /// Returns the unit normal of an owned or halo vertex.
    #[inline]
    pub fn normal(&self, local: usize) -> Vec3 {
        self.normals[local].truncate()
    }

    /// 0 free to 1 protected.
    #[inline]
    pub fn mask(&self, local: usize) -> f32 {
        self.points[local].w
    }

    /// RGBA, sRGB.
    #[inline]
    pub fn colour(&self, local: usize) -> [u8; 4] {
        self.normals[local].w.to_bits().to_le_bytes()
    }

    /// Local corners of each triangle, into own and halo vertices.
    pub fn triangles(&self) -> &[[u16; 3]] {
        &self.topology.triangles
    }

    /// The positions of a triangle's corners.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.topology.triangles[triangle].map(|v| self.point(v as usize))
    }

    /// Lower and upper corner of the box around the page's triangles and own vertices.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        (self.lo, self.hi)
    }

    /// The clay's revision that wrote this page.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Makes room for a page of `own` vertices, a halo as large, and eight triangles a leaf for
    /// four triangles a vertex; what it held is gone.
    pub(super) fn make_room(&mut self, own: usize) {
        (self.layers, self.sets) = (None, None);
        self.points.clear();
        self.normals.clear();
        self.points.reserve(2 * own);
        self.normals.reserve(2 * own);
        self.tree.reset(own / 2);
    }

    /// Whether [`Page::make_room`] has nothing to do but to empty the page.
    pub(super) fn has_room(&self, own: usize) -> bool {
        self.points.capacity().min(self.normals.capacity()) >= 2 * own
    }

    /// Brings the page's tree and bounds up to date after vertices in the blocks `touched` moved.
    #[inline(always)]
    pub(super) fn refit(&mut self, touched: u32) {
        let Page { topology: t, points, tree, .. } = self;
        let (mut lo, mut hi) =
            tree.refit_leaves(&t.leaves, points, |eight| t.leaf_blocks[eight] & touched != 0);
        for &v in &t.loose {
            let p = points[v as usize].truncate();
            (lo, hi) = (lo.min(p), hi.max(p));
        }
        (self.lo, self.hi) = (lo, hi);
    }

    /// Returns the page's size in the undo budget, in bytes. It does not depend on the capacity of
    /// the page's vectors, because a replay must forget the same steps.
    pub(super) fn weight(&self) -> usize {
        // The tree: 192 bytes for 64 triangles, and a little for the nodes above.
        size_of::<Page>()
            + 16
            + self.points.len() * 32
            + self.topology.triangles.len() * 4
            + self.layers.as_ref().map_or(0, |l| l.weight())
            + self.sets.as_ref().map_or(0, |s| s.weight())
    }

    /// Heap bytes of what a copy on write copies.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Page>()
            + 16
            + (self.points.capacity() + self.normals.capacity()) * 16
            + self.tree.bytes()
            + self.layers.as_ref().map_or(0, |l| l.weight())
            + self.sets.as_ref().map_or(0, |s| s.weight())
    }

    /// The page's face sets; `None`: no vertex is in a set or hidden.
    pub fn sets(&self) -> Option<&PageSets> {
        self.sets.as_deref()
    }

    /// The greatest number of a set in it; 0: none is in one.
    pub(crate) fn highest_set(&self) -> u16 {
        self.sets().map_or(0, |s| s.highest)
    }

    /// Returns the number of the set and [`HIDDEN`], of an owned or halo vertex.
    #[inline]
    pub(crate) fn set_bits(&self, local: usize) -> u16 {
        self.sets().map_or(0, |s| s.rows[local])
    }

    /// Returns the set of an owned or halo vertex; 0: none.
    #[inline]
    pub fn face_set(&self, local: usize) -> u16 {
        self.set_bits(local) & !HIDDEN
    }

    /// Returns true if an owned or halo vertex is hidden.
    #[inline]
    pub fn is_hidden(&self, local: usize) -> bool {
        self.set_bits(local) & HIDDEN != 0
    }

    /// The rows of a page where something is hidden.
    #[inline]
    pub(crate) fn hidden_rows(&self) -> Option<&[u16]> {
        self.sets().filter(|s| s.any_hidden).map(|s| s.rows.as_slice())
    }

    /// Returns true if the same triangles between the same rows are shown as of an older state of
    /// this page. False also where only face sets differ.
    pub fn shows_triangles_of(&self, older: &Page) -> bool {
        let same_sets = match (&self.sets, &older.sets) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        same_sets && Arc::ptr_eq(&self.topology, &older.topology)
    }

    /// Returns true if all corners of a triangle are hidden.
    #[inline]
    pub fn is_triangle_hidden(&self, triangle: usize) -> bool {
        self.hidden_rows().is_some_and(|rows| all_hidden(rows, self.triangles()[triangle]))
    }
}
