//! What a brush is: from a dab it makes itself ready, and then says for each vertex what changes.
//!
//! A dab may have images (mirrors, turns). Images whose reaches overlap act together: each reads
//! the clay as it was before any of them, and what they do is added up. So a symmetric stroke on a
//! symmetric form stays symmetric also where it meets itself on the mirror.

use glam::Vec3;

use super::BrushSettings;
use super::preset::OwnNumber;
use super::stamp::Lens;
use crate::brush::surface_query::{Scratch, SurfaceQuery};
use crate::{PageIn, Reach};
use sculptd_geometry::portable::PortableMath;

/// Images of a dab at most, itself counted.
pub const IMAGES: usize = 32;

/// How a brush is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grip {
    /// It lies on the surface: one dab a spacing.
    Surface,
    /// It holds what was under it when the pen came down; a dab says how far it was drawn since
    /// then.
    Anchor,
    /// It takes the clay along, parallel to the view, and goes along itself; a dab says how far it
    /// came since the last.
    Tow,
}

/// One dab, in mesh units.
#[derive(Debug, Clone, Copy)]
pub struct Dab<'a> {
    /// What the person set.
    pub settings: &'a BrushSettings,
    /// The middle of the dab: on the surface as the stroke found it if `found`, else as it is.
    pub centre: Vec3,
    /// Unit length, out of the clay at `centre` (leaning to the pen where the settings say so).
    pub normal: Vec3,
    /// Where the pen touches the surface as it is.
    pub touch: Vec3,
    /// The dab is measured on the surface as the stroke found it.
    pub found: bool,
    /// Mesh units, pressure counted in.
    pub radius: f32,
    /// 0 to 1, pressure counted in.
    pub strength: f32,
    /// The way that the dab stands for, in fifths of the radius: strengths are those of a dab for
    /// which this is 1.
    pub span: f32,
    /// The share of the way to its goal that a brush goes with this dab: [`Dab::approach`] at the
    /// rate `strength`.
    pub share: f32,
    /// The direction of the stroke, averaged over half a radius; of any length, zero at its start.
    pub heading: Vec3,
    /// Which of the brush's passes it is, from 0.
    pub pass: usize,
    /// 1, or -1 for the other way round.
    pub sign: f32,
    /// On the surface: from the last dab's centre, zero for the first. Anchored: from the start.
    /// Towed: of this step.
    pub motion: Vec3,
    /// Anchored: the motion of the dab before.
    pub last: Vec3,
    /// Unit, towards the eye.
    pub eye: Vec3,
    /// Unit, to the right of the view.
    pub right: Vec3,
    /// How the eye sees the work.
    pub lens: Lens,
    /// 1, or -1 in an image that is mirrored.
    pub hand: f32,
    /// Which of the images it is; 0 the brush itself.
    pub image: usize,
    /// Length of the stroke up to here, and a number that differs from stroke to stroke.
    pub travelled: f32,
    /// See [`Dab::travelled`].
    pub stroke: u32,
}

impl Dab<'_> {
    /// What a brush that raises lays down with this dab: its height, negative to carve.
    pub fn height(&self) -> f32 {
        self.sign * self.strength * self.span * self.radius
    }

    /// The height of a brush that does all it does at once, negative to carve.
    pub fn whole_height(&self) -> f32 {
        self.sign * self.strength * self.radius
    }

    /// The share of the way to its goal that a brush goes with this dab, if it goes `rate` of it
    /// (0 to 1) with a dab for which `span` is 1.
    pub fn approach(&self, rate: f32) -> f32 {
        if self.span == 1.0 {
            rate
        } else {
            1.0 - (1.0 - rate.clamp(0.0, 1.0)).portable_powf(self.span)
        }
    }

    /// The share of the brush at a squared distance from its middle.
    #[inline(always)]
    pub fn fade(&self, d2: f32) -> f32 {
        let s = self.settings;
        let x = d2.sqrt() / self.radius;
        let x = if s.hardness > 0.0 { soft(x, s.hardness) } else { x };
        s.falloff.at(x, &s.curve)
    }

    /// How much a vertex with the normal `n` belongs to the side that the dab lies on: 1 where it
    /// faces as the dab does, 0 from 120 degrees on, so that a thin plate's far side stays.
    #[inline(always)]
    pub fn facing(&self, n: Vec3) -> f32 {
        facing(n.dot(self.normal))
    }

    /// One of the brush's own numbers.
    pub fn extra(&self, i: usize) -> f32 {
        self.settings.extra[i]
    }

    /// The stroke's direction in the tangent plane, unit length; for a stroke without one, to the
    /// right of the view.
    pub fn along(&self) -> Vec3 {
        let flat = |d: Vec3| (d - self.normal * d.dot(self.normal)).try_normalize();
        flat(self.heading)
            .or_else(|| flat(self.motion))
            .or_else(|| flat(self.right))
            .unwrap_or_else(|| self.normal.any_orthonormal_vector())
    }

    /// A ball about the centre, drawn out to where the stroke may have raised what lay in it.
    pub fn ball(&self, radii: f32) -> Reach {
        let radius = self.radius * radii;
        if !self.found {
            return Reach::Sphere { centre: self.centre, radius };
        }
        // A stroke goes on raising what the pen has passed: by as much again as it had before.
        let raised = (self.touch - self.centre) * 2.5;
        let room = self.normal * (self.height() * 2.0);
        Reach::Capsule { from: self.centre, to: self.centre + raised + room, radius: radius * 1.01 }
    }
}

/// A distance in radii as the falloff counts it: 0 as far as `hardness`, 1 at the rim.
#[inline(always)]
pub(super) fn soft(x: f32, hardness: f32) -> f32 {
    ((x - hardness) / (1.0 - hardness)).max(0.0)
}

/// See [`Dab::facing`]; `c` is the cosine between the normals.
#[inline(always)]
pub(super) fn facing(c: f32) -> f32 {
    ((c + 0.5) * 2.0).max(0.0).min(1.0)
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

    /// How much it does to a vertex, 0 to 1, mask left out of account; 0 outside. `at`: where the
    /// dab measures the vertex; for an anchored brush where it was at the start of the stroke.
    #[inline(always)]
    fn share(&self, dab: &Dab<'_>, _page: &PageIn<'_>, _v: usize, at: Vec3) -> f32 {
        dab.fade((at - dab.centre).length_squared())
    }

    /// What changes at a vertex within the reach.
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange;

    /// A faster way for a dab without images that overlap and without options; false: there is
    /// none.
    fn alone(_dab: &Dab<'_>, _tool: &mut super::tool::Tool<'_>) -> bool {
        false
    }
}
