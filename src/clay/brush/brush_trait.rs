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

/// What runs a kernel over the clay.
pub trait RunKernel {
    /// Runs one kernel over what `reach` touches.
    fn run_kernel<K: Kernel>(&mut self, reach: &Reach, kernel: &K);

    /// Whether the surface about a dab folds; see [`SurfaceQuery::is_folded`]. It is not looked at
    /// where [`RunKernel::keep_flat`] was told of the dab before it in the same stroke.
    fn is_folded(&mut self, dab: &Dab<'_>) -> bool;

    /// Nothing within this dab turned away.
    fn keep_flat(&mut self, dab: &Dab<'_>);
}

/// A vertex that a brush looks at.
#[derive(Debug, Clone, Copy)]
pub struct VertexContext<'a> {
    /// The page that it is an own vertex of.
    pub page: &'a PageIn<'a>,
    /// The page's number, and the vertex in it.
    pub number: u32,
    /// See [`VertexContext::number`].
    pub v: usize,
    /// Where it is.
    pub p: Vec3,
    /// Where the dab measures it: where the stroke found it, or where it is.
    pub at: Vec3,
    /// How much the brush does here, 0 to 1: its fade, less what is masked.
    pub weight: f32,
    /// What was found out while the brush was made ready.
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

/// What is to change at a vertex. Several images' changes add up.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VertexChange {
    /// Added to where it is.
    pub by: Vec3,
    /// Where it is to be from where the stroke found it, instead of where it is now.
    pub held: Option<Vec3>,
    /// Added to the mask.
    pub mask: f32,
    /// The share of the brush's colour that is laid on, 0 to 1.
    pub dye: f32,
    /// The face set that it is in from now on, 0 for none; `None`: that which it is in.
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
    /// How the brush is held.
    const GRIP: Grip = Grip::Surface;
    /// The numbers that only this brush has, [`super::settings::EXTRAS`] at most.
    const OWN_NUMBERS: &'static [OwnNumber] = &[];
    /// Whether it can be measured on the surface as the stroke found it; see
    /// [`super::BrushSettings::accumulate`].
    const FOUND: bool = false;
    /// How often a dab goes over the clay; each pass sees what the one before did.
    const PASSES: usize = 1;
    /// Whether the mask protects from it; a brush that paints the mask must not be stopped by it.
    const MASKED: bool = true;
    /// Whether triangles may be cut under it: not if it needs to know where vertices were when the
    /// stroke began.
    const CUTS: bool = matches!(Self::GRIP, Grip::Surface | Grip::Tow);

    /// What the dab needs to know, found out before anything moves.
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self;

    /// What part of space it concerns.
    fn reach(dab: &Dab<'_>) -> Reach {
        dab.ball(1.0)
    }

    /// What the dab covers, and how much it does there; `None` for a brush whose
    /// [`Brush::share`] says so vertex by vertex.
    fn footprint(&self, dab: &Dab<'_>) -> Option<Footprint> {
        Some(Footprint::ball(dab))
    }

    /// How much a brush without a footprint does to a vertex, 0 to 1, mask left out of account; 0
    /// outside. `at`: where the dab measures the vertex; for an anchored brush where it was at the
    /// start of the stroke.
    #[inline(always)]
    fn share(&self, _dab: &Dab<'_>, _page: &PageIn<'_>, _v: usize, _at: Vec3) -> f32 {
        0.0
    }

    /// What changes at a vertex within the reach.
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
