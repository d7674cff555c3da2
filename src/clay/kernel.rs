//! What a brush sees of a page, and where it writes.

use std::sync::Arc;

use glam::{BVec4A, Vec3, Vec4};

use super::layers::{LayerStack, LayerSum, PageLayers};
use super::normals::{GROUPED, MOVED, PAINTED};
use super::page::{BLOCK, BREAK, Page, Points, Ring};
use sculptd_geometry::simd::cotangents;

/// The effect of a brush on one page. Called once for each page that the dab may reach, on any
/// thread, in any order. It reads the state before the dab everywhere, also of neighbours in other
/// pages, so that the order does not affect the result.
pub trait Kernel: Sync {
    /// True if it changes hidden vertices too; otherwise its writes to them are dropped.
    const CHANGES_HIDDEN: bool = false;
    /// True if it reads each page, halo included, as it was when the open undo step began. For
    /// kernels that process a surface in portions and read neighbours, which may be written
    /// already.
    const SEES_START: bool = false;

    /// Changes the owned vertices of one page through `out`.
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>);
}

/// A page as a kernel reads it: the state before the dab, halo included. Owned vertices are
/// `0..own()`.
#[derive(Debug, Clone, Copy)]
pub struct PageIn<'a> {
    page: &'a Page,
    before: &'a Page,
    number: u32,
    /// True if a layer is active, and the sum of the page's layers.
    layers: (bool, Option<LayerSum<'a>>),
    /// Own, then halo.
    pub positions: Points<'a>,
    /// Own, then halo; zero where all triangles are degenerate.
    pub normals: Points<'a>,
}

impl<'a> PageIn<'a> {
    /// `before`: the page when the stroke began, of the same topology.
    pub(super) fn new(
        number: u32,
        page: &'a Page,
        before: &'a Page,
        stack: Option<&LayerStack>,
    ) -> Self {
        let sum = stack.zip(page.layers()).and_then(|(stack, own)| LayerSum::new(stack, own));
        PageIn {
            page,
            before,
            number,
            layers: (stack.is_some_and(|s| s.active.is_some()), sum),
            positions: Points(&page.points),
            normals: Points(&page.normals),
        }
    }

    /// Returns the number of owned vertices; higher local indices are halo.
    pub fn own(&self) -> usize {
        self.page.topology.own
    }

    /// Returns the page's number in the clay.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Own and halo vertices as rows of x, y, z, mask: for vectorised loops.
    pub fn rows(&self) -> &'a [Vec4] {
        &self.page.points
    }

    /// Own and halo normals; the fourth lane is the colour's bits.
    pub fn normal_rows(&self) -> &'a [Vec4] {
        &self.page.normals
    }

    /// [`PageIn::rows`] when the open undo step began.
    pub fn rows_before(&self) -> &'a [Vec4] {
        self.before.point_rows()
    }

    /// [`PageIn::normal_rows`] when the open undo step began.
    pub fn normal_rows_before(&self) -> &'a [Vec4] {
        self.before.normal_rows()
    }

    /// An own or a halo vertex by local index.
    #[inline(always)]
    pub fn point(&self, local: u16) -> Vec3 {
        self.page.point(local as usize)
    }

    /// 0 free to 1 protected; own or halo.
    #[inline(always)]
    pub fn mask(&self, local: usize) -> f32 {
        self.page.mask(local)
    }

    /// RGBA, sRGB; own or halo.
    #[inline(always)]
    pub fn colour(&self, local: usize) -> [u8; 4] {
        self.page.colour(local)
    }

    /// Returns the position of an owned or halo vertex at the start of the stroke (the open undo
    /// step). Brushes that depend on the displacement so far need only this and
    /// [`PageIn::normal_before`].
    #[inline(always)]
    pub fn before(&self, local: usize) -> Vec3 {
        self.before.point(local)
    }

    /// The unit normal when the open undo step began; own or halo.
    #[inline(always)]
    pub fn normal_before(&self, local: usize) -> Vec3 {
        self.before.normal(local)
    }

    /// The mask, 0 free to 1 protected, when the open undo step began; own or halo.
    #[inline(always)]
    pub fn mask_before(&self, local: usize) -> f32 {
        self.before.mask(local)
    }

    /// The colour (RGBA, sRGB) when the open undo step began; own or halo.
    #[inline(always)]
    pub fn colour_before(&self, local: usize) -> [u8; 4] {
        self.before.colour(local)
    }

    /// Returns the page's layer data as it was when the open step began.
    pub fn layers(&self) -> Option<&'a PageLayers> {
        self.page.layers()
    }

    /// Returns the position of an owned vertex without the active layer; `None` if the base is
    /// active.
    #[inline(always)]
    pub fn below_active_layer(&self, own: usize) -> Option<Vec3> {
        let (active, sum) = &self.layers;
        active.then(|| sum.as_ref().map_or_else(|| self.before(own), |s| s.below(own)))
    }

    /// The vertex's number in the mesh that was loaded: a seed that does not depend on the pages.
    /// Own vertices only.
    #[inline(always)]
    pub fn id(&self, own: usize) -> u32 {
        self.page.topology.ids[own]
    }

    /// Returns the face set of an owned or halo vertex; 0: none.
    #[inline(always)]
    pub fn face_set(&self, local: usize) -> u16 {
        self.page.face_set(local)
    }

    /// Returns the face set of an owned or halo vertex when the open undo step began; 0: none.
    #[inline(always)]
    pub fn face_set_before(&self, local: usize) -> u16 {
        self.before.face_set(local)
    }

    /// Returns true if an owned vertex is on the border of the surface, or on a non-manifold edge.
    #[inline(always)]
    pub fn is_border(&self, own: usize) -> bool {
        self.page.topology.kinds[own] != Ring::Closed
    }

    /// Returns true if an owned vertex is on the border of the surface with all its triangles in
    /// one open fan: its ring then begins and ends on the border.
    #[inline(always)]
    pub fn is_open(&self, own: usize) -> bool {
        self.page.topology.kinds[own] == Ring::Open
    }

    /// Returns true if the triangles of an owned vertex form one closed fan.
    #[inline(always)]
    pub fn is_closed(&self, own: usize) -> bool {
        self.page.topology.kinds[own] == Ring::Closed
    }

    /// Returns the neighbours of an owned vertex, counter-clockwise, as local indices. Around a
    /// non-manifold vertex a neighbour may appear twice.
    #[inline(always)]
    pub fn ring(&self, own: usize) -> impl ExactSizeIterator<Item = u16> + 'a {
        self.page.topology.ring(own).iter().map(|k| k & !BREAK)
    }

    /// Returns the cotangent-weighted sums around an owned vertex with a closed ring of six: see
    /// [`cotangents::about`].
    #[inline(always)]
    pub fn cotangents(&self, own: usize) -> Option<Vec4> {
        cotangents::about(&self.page.topology.hexes, &self.page.points, own)
    }

    /// The same of several; those before [`PageIn::regular`] only.
    #[inline(always)]
    pub fn cotangents_of(&self, who: &[u16], out: &mut [Vec4]) {
        cotangents::about_each(&self.page.topology.hexes, &self.page.points, who, out);
    }

    /// Own vertices from the first on that are known to have a closed ring of six each.
    pub fn regular(&self) -> usize {
        self.page.topology.hexes.len()
    }

    /// Returns the two other corners of each triangle around an owned vertex, counter-clockwise.
    #[inline(always)]
    pub fn wedges(&self, own: usize) -> impl Iterator<Item = [u16; 2]> + 'a {
        let t = &self.page.topology;
        let ring = t.ring(own);
        let inner = ring.windows(2).filter(|w| w[1] & BREAK == 0).map(|w| [w[0] & !BREAK, w[1]]);
        let last = match (t.kinds[own], ring) {
            (Ring::Closed, [first, .., last]) => Some([*last, *first]),
            _ => None,
        };
        inner.chain(last)
    }
}

/// The output of a kernel. A kernel writes each vertex at most once a dab.
#[derive(Debug)]
pub struct PageOut<'a> {
    pub(super) points: &'a mut [Vec4],
    pub(super) marks: &'a mut [u8],
    pub(super) colours: &'a mut Vec<(u16, [u8; 4])>,
    /// See [`super::dab_buffers::PageOutput::sets`].
    pub(super) sets: &'a mut Vec<u16>,
    pub(super) affected: usize,
    /// The new layer data of the page; `None` keeps the current one.
    pub(super) layers: Option<Option<Arc<PageLayers>>>,
}

impl PageOut<'_> {
    /// Gives the page other layers.
    pub(super) fn set_layers(&mut self, layers: Option<Arc<PageLayers>>) {
        self.layers = Some(layers);
    }

    /// Counts a vertex within the reach.
    #[inline(always)]
    pub fn visit(&mut self) {
        self.affected += 1;
    }

    /// Counts several.
    #[inline(always)]
    pub fn visit_many(&mut self, count: usize) {
        self.affected += count;
    }

    /// Gives own vertex `v` a new place. A place that is not finite, or the same as before, changes
    /// nothing.
    #[inline(always)]
    pub fn set(&mut self, v: usize, p: Vec3) {
        let row = &mut self.points[v];
        if p.is_finite() && p != row.truncate() {
            *row = p.extend(row.w);
            self.marks[v] |= MOVED;
        }
    }

    /// Gives own vertex `v` a new mask, 0 free to 1 protected; clamped.
    #[inline(always)]
    pub fn set_mask(&mut self, v: usize, mask: f32) {
        let row = &mut self.points[v];
        // `max` first: it turns a NaN into 0.
        let mask = mask.max(0.0).min(1.0);
        if mask != row.w {
            row.w = mask;
            self.marks[v] |= PAINTED;
        }
    }

    /// Gives own vertex `v` a new colour, RGBA, sRGB.
    #[inline(always)]
    pub fn set_colour(&mut self, v: usize, colour: [u8; 4]) {
        self.colours.push((v as u16, colour));
        self.marks[v] |= PAINTED;
    }

    /// Puts own vertex `v` into another face set; 0: into none.
    #[inline(always)]
    pub fn set_face_set(&mut self, v: usize, set: u16) {
        if self.sets.is_empty() {
            self.sets.resize(self.marks.len(), 0);
        }
        self.sets[v] = set;
        self.marks[v] |= GROUPED;
    }

    /// Adds `by`, one per vertex, to the owned vertices from `first` on. A sum that is not finite,
    /// or that equals the old value, changes nothing.
    #[inline(always)]
    pub fn push_block(&mut self, first: usize, by: &[Vec4]) {
        let rows = &mut self.points[first..first + by.len()];
        let marks = &mut self.marks[first..first + by.len()];
        let mut finite = BVec4A::TRUE;
        for (row, by) in rows.iter().zip(by) {
            finite &= (*row + *by).abs().cmplt(Vec4::INFINITY);
        }
        let all = finite.all();
        for ((row, mark), by) in rows.iter_mut().zip(marks).zip(by) {
            let new = *row + *by;
            if all || new.is_finite() {
                let differs = new.cmpne(*row);
                *mark |= if differs.any() { MOVED } else { 0 };
                *row = Vec4::select(differs, new, *row);
            }
        }
    }

    /// Adds `offset * weights[v]` to every owned vertex, for brushes whose offset has one
    /// direction. A sum that is not finite changes nothing. `weights` has one value per owned
    /// vertex, 0 for no change.
    #[inline(always)]
    pub fn push_all(&mut self, offset: Vec3, weights: &[f32]) {
        let offset = offset.extend(0.0);
        let blocks = self
            .points
            .chunks_mut(BLOCK)
            .zip(self.marks.chunks_mut(BLOCK))
            .zip(weights.chunks(BLOCK));
        for ((rows, marks), weights) in blocks {
            if weights.iter().fold(0, |bits, w| bits | w.to_bits()) == 0 {
                continue;
            }
            let mut news = [Vec4::ZERO; BLOCK];
            let mut finite = BVec4A::TRUE;
            for ((new, row), &w) in news.iter_mut().zip(&*rows).zip(weights) {
                *new = *row + offset * w;
                finite &= new.abs().cmplt(Vec4::INFINITY);
            }
            let all = finite.all();
            for ((row, mark), new) in rows.iter_mut().zip(marks).zip(news) {
                if all || new.is_finite() {
                    let differs = new.cmpne(*row);
                    *mark |= if differs.any() { MOVED } else { 0 };
                    *row = Vec4::select(differs, new, *row);
                }
            }
        }
    }
}
