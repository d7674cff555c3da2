//! The smooth brush: cotangent-weighted Laplacian, weights clamped, boundaries and needles safe.
//!
//! Each neighbour `b` of a vertex `p` weighs `cot` of the angles opposite the edge, in the two
//! triangles beside it (Pinkall and Polthier 1993), each clamped to [`MAX_COT`] either way, their
//! sum to 0 from below: two obtuse angles would push instead of pull. Over a flat mesh that is
//! Delaunay the sums are what leaves every vertex in its place. With `b` and `c` relative to `p`,
//! the triangle's doubled area `|b x c|` is under both its cotangents: at `c` it is `(c.c - b.c) /
//! |b x c|`, at `b` it is `(b.b - b.c) / |b x c|`.
//!
//! The distance of a vertex from the middle of the dab is the straight-line distance where the
//! surface is open there. Where it folds, it is the distance along the surface (by Dijkstra over
//! the edges): the brush smooths one finger and not the one beside it.

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use glam::{Vec3, Vec4};

use super::brush_trait::{Brush, RunKernel, VertexChange, VertexContext};
use super::cotangent::{LANES, closed};
use super::dab::Dab;
use super::footprint::Footprint;
use super::weights::Weights;
use crate::brush::surface_query::SurfaceQuery;
use crate::{Kernel, PageIn, PageOut};
use sculptd_geometry::simd::cotangents::MAX_COT;

/// Vertices looked at together.
const BLOCK: usize = 64;

/// One dab of smooth, made ready.
#[derive(Debug, Clone, Copy)]
pub struct SmoothBrush {
    centre: Vec3,
    /// The vertices that face away from this normal are left alone; zero: none are.
    normal: Vec3,
    radius: f32,
    /// The share of the way to the weighted mean of the ring, at the centre.
    lambda: f32,
    /// The surface folds: the distance of a vertex is measured along it.
    folded: bool,
}

impl SmoothBrush {
    /// `lambda` 0 to 1: the share of the way to the weighted mean of the ring, at the centre.
    pub fn new(centre: Vec3, radius: f32, lambda: f32) -> Self {
        let lambda = lambda.clamp(0.0, 1.0);
        SmoothBrush { centre, normal: Vec3::ZERO, radius, lambda, folded: false }
    }

    fn of(dab: &Dab<'_>) -> Self {
        let lambda = dab.evening(dab.strength);
        SmoothBrush { normal: dab.normal, ..SmoothBrush::new(dab.centre, dab.radius, lambda) }
    }
}

/// The same for any ring. About an open or a tangled one the two cotangents of an edge are met
/// apart, where its triangles are; each edge's sum is clamped once both are known.
fn any(page: &PageIn<'_>, v: usize, p: Vec3) -> (Vec3, f32) {
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    let mut add = |d: Vec3, w: f32| {
        let w = w.max(0.0);
        sum += d * w;
        weights += w;
    };
    // The edge that the last triangle ended at, its weight so far; the one that the first began at.
    let mut open: Option<(u16, Vec3, f32)> = None;
    let mut first: Option<(u16, Vec3, f32)> = None;
    for [kb, kc] in page.wedges(v) {
        let (b, c) = (page.point(kb) - p, page.point(kc) - p);
        let area = b.cross(c).length();
        let inverse = if area > 0.0 { 1.0 / area } else { 0.0 };
        let bc = b.dot(c);
        let to_b = ((c.dot(c) - bc) * inverse).clamp(-MAX_COT, MAX_COT);
        let to_c = ((b.dot(b) - bc) * inverse).clamp(-MAX_COT, MAX_COT);
        match open.take() {
            Some((k, d, w)) if k == kb => add(d, w + to_b),
            before => {
                if let Some((_, d, w)) = before {
                    add(d, w);
                }
                if first.is_none() {
                    first = Some((kb, b, to_b));
                } else {
                    add(b, to_b);
                }
            }
        }
        open = Some((kc, c, to_c));
    }
    match (open, first) {
        (Some((k, d, w)), Some((f, _, wf))) if k == f => add(d, w + wf),
        (end, start) => [end, start].into_iter().flatten().for_each(|(_, d, w)| add(d, w)),
    }
    (sum, weights)
}

#[inline(always)]
pub(super) fn around(page: &PageIn<'_>, v: usize, p: Vec3) -> (Vec3, f32) {
    if let Some(sum) = page.cotangents(v) {
        (sum.truncate(), sum.w)
    } else if page.is_closed(v) && page.ring(v).len() <= LANES {
        closed(page, v)
    } else {
        any(page, v, p)
    }
}

/// The share of a dab of this radius at a squared distance from its middle.
#[inline(always)]
fn faded(d2: f32, radius: f32) -> f32 {
    let fade = (1.0 - d2 / (radius * radius)).max(0.0);
    fade * fade
}

impl SmoothBrush {
    /// Evens a page; says whether something within turns away by more than a right angle.
    #[inline(always)]
    fn even(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) -> bool {
        let radius2 = self.radius * self.radius;
        let (mut who, mut sums) = ([0u16; BLOCK], [Vec4::ZERO; BLOCK]);
        let w = &mut Weights::zero();
        let fade = |d2: f32| {
            let fade = 1.0 - d2 / radius2;
            self.lambda * (fade * fade)
        };
        let (within, turned) = w.sphere(page, self.centre, self.normal, radius2, fade);
        out.visit_many(within);
        let weights = w.of(page);
        for first in (0..weights.len()).step_by(BLOCK) {
            let (mut count, mut regular) = (0, 0);
            for (v, &w) in weights.iter().enumerate().skip(first).take(BLOCK) {
                who[count] = v as u16;
                count += usize::from(w != 0.0);
                regular += usize::from(w != 0.0 && v < page.regular());
            }
            page.cotangents_of(&who[..regular], &mut sums[..regular]);
            for (i, &v) in who[..count].iter().enumerate() {
                let (v, p) = (v as usize, page.point(v));
                let (sum, all) =
                    if i < regular { (sums[i].truncate(), sums[i].w) } else { around(page, v, p) };
                if all > 0.0 {
                    out.set(v, p + sum * (weights[v] / all));
                }
            }
        }
        turned
    }
}

impl Kernel for SmoothBrush {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        self.even(page, out);
    }
}

/// The brush, and whether anything within it turned away: the next dab then looks for folds.
struct WatchedSmooth {
    brush: SmoothBrush,
    turned: AtomicBool,
}

impl Kernel for WatchedSmooth {
    #[inline(always)]
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        if self.brush.even(page, out) {
            self.turned.store(true, Relaxed);
        }
    }
}

impl Brush for SmoothBrush {
    fn ready(dab: &Dab<'_>, on: &mut SurfaceQuery<'_>) -> Self {
        let folded = on.is_folded(dab);
        if folded {
            on.measure(dab);
        }
        SmoothBrush { folded, ..SmoothBrush::of(dab) }
    }

    fn footprint(&self, _: &Dab<'_>) -> Option<Footprint> {
        None
    }

    #[inline(always)]
    fn share(&self, dab: &Dab<'_>, _: &PageIn<'_>, _: usize, p: Vec3) -> f32 {
        let fade = faded((p - self.centre).length_squared(), dab.radius);
        // `change` measures the distance by the walk.
        if self.folded && fade > 0.0 { 1.0 } else { fade }
    }

    #[inline]
    fn change(&self, dab: &Dab<'_>, spot: &VertexContext<'_>) -> VertexChange {
        let mut weight = spot.weight;
        if self.folded {
            let walk = spot.scratch.walk(dab.image);
            let far = walk.and_then(|w| w.distance(spot.number, spot.v));
            weight *= far.map_or(0.0, |d| faded(d * d, dab.radius));
        }
        let (sum, weights) = around(spot.page, spot.v, spot.p);
        if weights > 0.0 && weight > 0.0 {
            VertexChange::by(sum * (self.lambda * weight / weights))
        } else {
            VertexChange::default()
        }
    }

    fn alone<R: RunKernel>(dab: &Dab<'_>, on: &mut R) -> bool {
        if on.is_folded(dab) {
            return false;
        }
        let watched = WatchedSmooth { brush: SmoothBrush::of(dab), turned: false.into() };
        on.run_kernel(&Self::reach(dab), &watched);
        if !watched.turned.load(Relaxed) {
            on.keep_flat(dab);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::brush::{BrushKind, BrushSettings, Dab, Scratch, Tool};
    use crate::{Clay, DabReport, Workers};
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    #[test]
    fn what_lies_beside_a_fold_is_left_alone() {
        // Two rough balls that all but touch, and a dab on the one beside the gap, which reaches
        // far over the other through the air.
        let mut mesh = shapes::icosphere(1.0, 24);
        let count = mesh.positions.len();
        for (i, p) in mesh.positions.iter_mut().enumerate() {
            *p *= 1.0 + 0.02 * ((i * 7919) % 101) as f32 / 101.0;
        }
        let other: Vec<Vec3> = mesh.positions.iter().map(|p| *p + Vec3::X * 2.05).collect();
        mesh.positions.extend(&other);
        let more = mesh.triangles.iter().map(|t| t.map(|v| v + count as u32));
        mesh.triangles.extend(more.collect::<Vec<_>>());
        let before = mesh.positions.clone();
        let mut clay = Clay::build(&mesh, &Job::default()).expect("clay");
        let settings = BrushSettings::new(BrushKind::Smooth);
        let centre = Vec3::new(0.6, 0.0, 0.8);
        let first = Dab::resting(&settings, centre, 0.9, 0.8);
        clay.begin_step();
        let (workers, mut scratch) = (Workers::new(1), Scratch::default());
        let report = DabReport::default();
        let mut tool = Tool { mesh: &mut clay, workers: &workers, scratch: &mut scratch, report };
        BrushKind::Smooth.apply(&[first], &mut tool);
        let after = clay.to_tri().positions;
        let moved = |from: usize, to: usize| {
            (from..to).map(|i| before[i].distance(after[i])).fold(0.0, f32::max)
        };
        assert!(moved(0, count) > 0.001, "the ball under the dab is evened");
        assert_eq!(moved(count, 2 * count), 0.0, "the one beside it is left alone");
    }
}
