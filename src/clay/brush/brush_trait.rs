//! What a brush says of each vertex: [`Brush`] from a dab makes itself ready, and then tells for
//! each vertex what changes.

use glam::{Vec3, Vec4};

use super::dab::{Dab, Grip};
use super::footprint::Footprint;
use super::preset::OwnNumber;
use super::triples::{Triples, fourth_lanes};
use super::weights::BLOCK;
use crate::brush::surface_query::{Scratch, SurfaceQuery};
use crate::{Kernel, PageIn, Reach};

/// Runs a kernel over the clay.
pub trait RunKernel {
    /// Runs one kernel over what `reach` touches.
    fn run_kernel<K: Kernel>(&mut self, reach: &Reach, kernel: &K);

    /// Returns true if the surface around a dab folds; see [`SurfaceQuery::is_folded`]. Skips the
    /// test and returns false if [`RunKernel::keep_flat`] was called for the previous dab of the
    /// stroke.
    fn is_folded(&mut self, dab: &Dab<'_>) -> bool;

    /// Records that no surface within this dab turns away from it.
    fn keep_flat(&mut self, dab: &Dab<'_>);
}

/// A vertex that a brush looks at.
#[derive(Debug, Clone, Copy)]
pub struct VertexContext<'a> {
    /// The page that owns the vertex.
    pub page: &'a PageIn<'a>,
    /// The page's number, and the vertex in it.
    pub number: u32,
    /// See [`VertexContext::number`].
    pub v: usize,
    /// The current position.
    pub p: Vec3,
    /// The position at which the dab measures the vertex: the one at the start of the stroke, or
    /// the current one.
    pub at: Vec3,
    /// The weight of the brush here, 0 to 1: its fade, reduced by the mask.
    pub weight: f32,
    /// Data computed while the brush was prepared.
    pub scratch: &'a Scratch,
}

impl VertexContext<'_> {
    /// The normal as it is.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        self.page.normals.get(self.v)
    }

    /// The normal where the dab measures the vertex.
    #[inline]
    pub fn normal_at(&self, dab: &Dab<'_>) -> Vec3 {
        if dab.found { self.page.normal_before(self.v) } else { self.normal() }
    }

    /// The middle of the neighbours; on a border of the neighbours on the border only, so that it
    /// does not shrink. The vertex itself where there are none.
    #[inline]
    pub fn middle(&self) -> Vec3 {
        if self.page.is_border(self.v) {
            return self.border_middle();
        }
        let (mut sum, mut n) = (Vec3::ZERO, 0.0f32);
        for k in self.page.ring(self.v) {
            sum += self.page.point(k) - self.p;
            n += 1.0;
        }
        if n > 0.0 { self.p + sum / n } else { self.p }
    }

    /// Between the two neighbours on the border: the ends of an open fan. Elsewhere the vertex
    /// itself.
    fn border_middle(&self) -> Vec3 {
        let mut ring = self.page.ring(self.v);
        match (ring.next(), ring.last(), self.page.is_open(self.v)) {
            (Some(a), Some(b), true) => (self.page.point(a) + self.page.point(b)) * 0.5,
            _ => self.p,
        }
    }
}

/// Neighbouring vertices of a page that a brush looks at together, 64 at most; beyond the
/// last all is zero. Where the weight is 0 nothing is changed, whatever the brush says.
#[derive(Debug, Clone, Copy)]
pub struct BlockContext<'a> {
    page: &'a PageIn<'a>,
    first: usize,
    count: usize,
    /// See [`VertexContext::weight`].
    pub weights: &'a [f32; BLOCK],
}

impl<'a> BlockContext<'a> {
    /// `count` own vertices of `page` from `first` on.
    #[inline(always)]
    pub fn new(
        page: &'a PageIn<'a>,
        first: usize,
        count: usize,
        weights: &'a [f32; BLOCK],
    ) -> BlockContext<'a> {
        BlockContext { page, first, count, weights }
    }

    #[inline(always)]
    fn of(&self, rows: &[Vec4]) -> Triples {
        Triples::of(&rows[self.first..self.first + self.count])
    }

    /// Places as they are.
    #[inline(always)]
    pub fn now(&self) -> Triples {
        self.of(self.page.rows())
    }

    /// Normals as they are.
    #[inline(always)]
    pub fn normals(&self) -> Triples {
        self.of(self.page.normal_rows())
    }

    /// Places as the stroke found them.
    #[inline(always)]
    pub fn before(&self) -> Triples {
        self.of(self.page.rows_before())
    }

    /// Normals as the stroke found them.
    #[inline(always)]
    pub fn normals_before(&self) -> Triples {
        self.of(self.page.normal_rows_before())
    }

    /// Masks as they are, 0 free to 1 protected.
    #[inline(always)]
    pub fn masks(&self) -> [f32; BLOCK] {
        fourth_lanes(&self.page.rows()[self.first..self.first + self.count])
    }
}

/// The change of a vertex. The changes of several images add up.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VertexChange {
    /// Offset added to the position.
    pub by: Vec3,
    /// Offset from the position at the start of the stroke, which replaces the current position.
    pub held: Option<Vec3>,
    /// Added to the mask.
    pub mask: f32,
    /// The share of the brush's colour that is laid on, 0 to 1.
    pub dye: f32,
    /// The new face set, 0 for none; `None` keeps the current one.
    pub set: Option<u16>,
}

impl VertexChange {
    /// It moves from where it is.
    #[inline(always)]
    pub fn by(by: Vec3) -> VertexChange {
        VertexChange { by, ..VertexChange::default() }
    }

    /// It moves to so far from where the stroke found it.
    pub fn held(by: Vec3) -> VertexChange {
        VertexChange { held: Some(by), ..VertexChange::default() }
    }

    /// Its mask changes by so much, above 0 to more protection.
    pub fn mask(mask: f32) -> VertexChange {
        VertexChange { mask, ..VertexChange::default() }
    }
}

/// A brush: one type, one file. A value of it is one dab, made ready.
pub trait Brush: Copy + Sync {
    /// The grip of the brush.
    const GRIP: Grip = Grip::Surface;
    /// The numbers that only this brush has, [`super::settings::EXTRAS`] at most.
    const OWN_NUMBERS: &'static [OwnNumber] = &[];
    /// True if the brush can measure the surface at the start of the stroke; see
    /// [`super::BrushSettings::accumulate`].
    const FOUND: bool = false;
    /// The number of passes of a dab over the clay; each pass reads the result of the one before.
    const PASSES: usize = 1;
    /// True if the mask protects from the brush. False for brushes that paint the mask.
    const MASKED: bool = true;
    /// True if triangles under the brush may be split and collapsed: false for a brush that needs
    /// the positions at the start of the stroke.
    const CUTS: bool = matches!(Self::GRIP, Grip::Surface | Grip::Tow);

    /// Prepares the brush: computes all that the dab needs before any vertex moves.
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self;

    /// Returns the region of space that the dab can change.
    fn reach(dab: &Dab<'_>) -> Reach {
        dab.ball(1.0)
    }

    /// Returns the area that the dab covers and its weights there; `None` for a brush that computes
    /// each vertex's weight in [`Brush::share`].
    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        Some(Footprint::ball(dab))
    }

    /// Returns the weight of a brush without a footprint at a vertex, 0 to 1, without the mask; 0
    /// outside. `at` is the position at which the dab measures the vertex; for an anchored brush,
    /// the position at the start of the stroke.
    #[inline(always)]
    fn share(&self, _dab: &Dab<'_>, _page: &PageIn<'_>, _v: usize, _at: Vec3) -> f32 {
        0.0
    }

    /// Returns the change of a vertex within the reach.
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange;

    /// Whether [`Brush::change_block`] says what [`Brush::change`] does.
    const BLOCKS: bool = false;

    /// [`Brush::change`] of a block of vertices at once, by a loop without a branch, for a brush
    /// that only moves them from where they are: `by` comes as zeros and takes the way of each.
    #[inline(always)]
    fn change_block(&self, _dab: &Dab<'_>, _block: &BlockContext<'_>, _by: &mut Triples) {}

    /// A faster way for a dab without images that overlap and without options; false: there is
    /// none.
    fn alone<R: RunKernel>(_dab: &Dab<'_>, _on: &mut R) -> bool {
        false
    }
}
