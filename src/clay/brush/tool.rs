//! Applies a dab and its images to the clay.

use glam::Vec3;

use super::brush_trait::{BlockContext, Brush, RunKernel, VertexChange, VertexContext};
use super::dab::{Dab, Grip};
use super::footprint::Footprint;
use super::options::IMAGES;
use super::smooth::SmoothBrush;
use super::stamp::StampBy;
use super::triples::Triples;
use super::weigh::{WeightRules, weigh};
use super::weights::{BLOCK, Weights};
use crate::brush::automask::AutoMasking;
use crate::brush::surface_query::{Scratch, SurfaceQuery, folded};
use crate::{Clay, DabReport, Kernel, PageIn, PageOut, Reach, Workers};
use sculptd_geometry::simd::wide::{Wide, WideWork, dispatch};

/// The clay in a brush's hand.
#[derive(Debug)]
pub struct Tool<'a> {
    /// The clay.
    pub mesh: &'a mut Clay,
    /// The threads that help.
    pub workers: &'a Workers,
    /// Memory kept from dab to dab.
    pub scratch: &'a mut Scratch,
    /// Summed over all dabs.
    pub report: DabReport,
}

impl Tool<'_> {
    /// Runs one kernel over the clay and counts what it did.
    pub fn run<K: Kernel>(&mut self, reach: &Reach, kernel: &K) {
        let r = self.mesh.dab(reach, kernel, self.workers);
        self.report.affected += r.affected;
        self.report.moved += r.moved;
        self.report.pages += r.pages;
    }

    /// A dab and its images, [`IMAGES`] at most; what is beyond is left out.
    pub fn apply<B: Brush>(&mut self, dabs: &[Dab<'_>]) {
        let dabs = &dabs[..dabs.len().min(IMAGES)];
        for pass in 0..B::PASSES {
            if pass == 0 {
                self.apply_pass::<B>(dabs);
                continue;
            }
            let mut again = [dabs[0]; IMAGES];
            again[..dabs.len()].copy_from_slice(dabs);
            again.iter_mut().for_each(|d| d.pass = pass);
            self.apply_pass::<B>(&again[..dabs.len()]);
        }
    }

    /// Evens the surface under a dab, where the settings ask for it.
    pub fn even(&mut self, dabs: &[Dab<'_>]) {
        let dabs = &dabs[..dabs.len().min(IMAGES)];
        let Some(first) = dabs.first().filter(|d| d.settings.auto_smooth > 0.0) else { return };
        if first.settings.kind.grip() != Grip::Surface {
            return;
        }
        let mut even = [*first; IMAGES];
        for (even, dab) in even.iter_mut().zip(dabs) {
            let strength = dab.settings.auto_smooth;
            *even = Dab { centre: dab.touch, found: false, sign: 1.0, strength, ..*dab };
        }
        self.apply_pass::<SmoothBrush>(&even[..dabs.len()]);
    }

    fn apply_pass<B: Brush>(&mut self, dabs: &[Dab<'_>]) {
        let Some(first) = dabs.first() else { return };
        let stamped = first.settings.stamp.by != StampBy::Off;
        let plain = !first.settings.auto.is_on() && !stamped && first.settings.saturation == 0.0;
        // Groups the images that act together: those whose balls overlap, directly or through
        // others.
        let balls: [(Vec3, f32); IMAGES] =
            std::array::from_fn(|i| dabs.get(i).map_or((Vec3::ZERO, 0.0), |d| ball(&B::reach(d))));
        let mut group: [u8; IMAGES] = std::array::from_fn(|i| i as u8);
        for i in 1..dabs.len() {
            for j in 0..i {
                let near = balls[i].1 + balls[j].1;
                if (balls[i].0 - balls[j].0).length_squared() < near * near {
                    let (from, to) = (group[i].max(group[j]), group[i].min(group[j]));
                    group[..dabs.len()].iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
                }
            }
        }
        for g in 0..dabs.len() {
            let of = group[..dabs.len()].iter().filter(|k| **k == g as u8).count();
            if of == 0 || (of == 1 && plain && B::alone(&dabs[g], self)) {
                continue;
            }
            let mut members: [Option<Member<'_, B>>; IMAGES] = [const { None }; IMAGES];
            let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let mut n = 0;
            for i in (0..dabs.len()).filter(|i| group[*i] == g as u8) {
                let Tool { mesh, workers, scratch, .. } = self;
                let mut on = SurfaceQuery { mesh, workers, scratch, image: dabs[i].image };
                let brush = B::ready(&dabs[i], &mut on);
                let footprint = brush.footprint(&dabs[i]);
                let auto = AutoMasking::ready(&dabs[i], &mut on);
                members[n] = Some(Member { dab: dabs[i], brush, footprint, auto });
                lo = lo.min(balls[i].0 - balls[i].1);
                hi = hi.max(balls[i].0 + balls[i].1);
                n += 1;
            }
            let reach = if n == 1 {
                B::reach(&dabs[g])
            } else {
                // Wider than need be; what lies outside of every image is left as it is.
                Reach::Sphere { centre: (lo + hi) * 0.5, radius: (hi - lo).length() * 0.5 }
            };
            let limit = first.settings.saturation * first.settings.strength * first.radius;
            let limit = if first.settings.saturation > 0.0 { limit } else { f32::INFINITY };
            let scratch = std::mem::take(self.scratch);
            self.run(&reach, &BrushKernel { members: &members[..n], scratch: &scratch, limit });
            *self.scratch = scratch;
        }
    }
}

impl RunKernel for Tool<'_> {
    fn run_kernel<K: Kernel>(&mut self, reach: &Reach, kernel: &K) {
        self.run(reach, kernel);
    }

    fn is_folded(&mut self, dab: &Dab<'_>) -> bool {
        let flat = self.scratch.flat[dab.image.min(IMAGES - 1)].take();
        flat != Some(dab.stroke) && folded(self.mesh, dab)
    }

    fn keep_flat(&mut self, dab: &Dab<'_>) {
        self.scratch.flat[dab.image.min(IMAGES - 1)] = Some(dab.stroke);
    }
}

/// A ball around a reach.
fn ball(reach: &Reach) -> (Vec3, f32) {
    match *reach {
        Reach::Sphere { centre, radius } => (centre, radius),
        Reach::Capsule { from, to, radius } => {
            ((from + to) * 0.5, radius + (to - from).length() * 0.5)
        }
    }
}

/// One image of a dab, made ready.
struct Member<'a, B> {
    dab: Dab<'a>,
    brush: B,
    footprint: Option<Footprint>,
    auto: AutoMasking,
}

impl<B: Brush> Member<'_, B> {
    /// Returns true if vertices are measured at their positions at the start of the stroke.
    fn before(&self) -> bool {
        self.dab.found || matches!(B::GRIP, Grip::Anchor)
    }

    /// The share of the brush at a vertex, and its weight: the share, less what is left alone.
    fn weight(&self, page: &PageIn<'_>, v: usize, scratch: &Scratch) -> (f32, f32) {
        let at = if self.before() { page.before(v) } else { page.positions.get(v) };
        let share = match &self.footprint {
            Some(footprint) => footprint.at(at),
            None => self.brush.share(&self.dab, page, v, at),
        };
        if !(share > 0.0) {
            return (0.0, 0.0);
        }
        let free = if B::MASKED { 1.0 - page.mask(v) } else { 1.0 };
        let mut weight = share * free * self.auto.share(page, v, at, scratch);
        if matches!(B::GRIP, Grip::Surface) {
            let before = self.dab.found;
            let n = if before { page.normal_before(v) } else { page.normals.get(v) };
            weight *= self.dab.facing(n);
        }
        (share, weight)
    }
}

struct BrushKernel<'a, B> {
    members: &'a [Option<Member<'a, B>>],
    scratch: &'a Scratch,
    limit: f32,
}

impl<B: Brush> Kernel for BrushKernel<'_, B> {
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>) {
        let weights = &mut Weights::zero();
        // The weights of a single dab that leaves nothing alone are computed at once.
        let known = match self.members {
            [Some(Member { dab, footprint: Some(footprint), auto, .. })] if !auto.is_on() => {
                let surface = matches!(B::GRIP, Grip::Surface);
                let rules = WeightRules {
                    before: dab.found || matches!(B::GRIP, Grip::Anchor),
                    masked: B::MASKED,
                    facing: surface.then_some(dab.normal),
                };
                out.visit_many(weigh(weights, page, footprint, &rules));
                true
            }
            _ => false,
        };
        match self.members {
            [Some(Member { dab, brush, .. })]
                if B::BLOCKS && known && self.limit == f32::INFINITY =>
            {
                dispatch(false, ChangeBlocks { brush, dab, page, weights, out });
            }
            _ => self.change(page, known.then(|| weights.of(page)), out),
        }
    }
}

/// [`Brush::change_block`] over a page, compiled for this processor.
struct ChangeBlocks<'a, 'b, B> {
    brush: &'a B,
    dab: &'a Dab<'a>,
    page: &'a PageIn<'a>,
    weights: &'a Weights,
    out: &'a mut PageOut<'b>,
}

impl<B: Brush> WideWork for ChangeBlocks<'_, '_, B> {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide>(self, _: W) {
        let own = self.page.own();
        for (b, weights) in self.weights.blocks().enumerate() {
            let first = b * BLOCK;
            if first >= own {
                break;
            }
            if weights.iter().fold(0, |bits, w| bits | w.to_bits()) == 0 {
                continue;
            }
            let count = BLOCK.min(own - first);
            let mut by = Triples::ZERO;
            let block = BlockContext::new(self.page, first, count, weights);
            self.brush.change_block(self.dab, &block, &mut by);
            for (i, weight) in weights.iter().enumerate() {
                by.set(i, if *weight > 0.0 { by.get(i) } else { Vec3::ZERO });
            }
            self.out.push_block(first, &by.rows()[..count]);
        }
    }
}

impl<B: Brush> BrushKernel<'_, B> {
    /// Changes what the members have a weight at; `known`: the weights of the only one.
    fn change(&self, page: &PageIn<'_>, known: Option<&[f32]>, out: &mut PageOut<'_>) {
        for v in 0..page.own() {
            if known.is_some_and(|weights| !(weights[v] > 0.0)) {
                continue;
            }
            let p = page.positions.get(v);
            let mut sum = VertexChange::default();
            let mut within = false;
            for member in self.members.iter().flatten() {
                let weight = match known {
                    Some(weights) => weights[v],
                    None => {
                        let (share, weight) = member.weight(page, v, self.scratch);
                        within |= share > 0.0;
                        weight
                    }
                };
                if !(weight > 0.0) {
                    continue;
                }
                let spot = VertexContext {
                    page,
                    number: page.number(),
                    v,
                    p,
                    at: if member.before() { page.before(v) } else { p },
                    weight,
                    scratch: self.scratch,
                };
                let c = member.brush.change(&member.dab, &spot);
                sum.by += c.by;
                if let Some(by) = c.held {
                    sum.held = Some(sum.held.unwrap_or(Vec3::ZERO) + by);
                }
                sum.mask += c.mask;
                sum.dye += c.dye;
                sum.set = sum.set.or(c.set);
            }
            if known.is_none() {
                if !within {
                    continue;
                }
                out.visit();
            }
            if let Some(by) = sum.held {
                sum.by += page.before(v) + by - p;
            }
            if sum.by != Vec3::ZERO {
                out.set(v, held(page.before(v), p, sum.by, self.limit, B::GRIP));
            }
            if sum.mask != 0.0 {
                out.set_mask(v, page.mask(v) + sum.mask);
            }
            if let Some(set) = sum.set.filter(|set| *set != page.face_set(v)) {
                out.set_face_set(v, set);
            }
            if sum.dye > 0.0
                && let Some(Member { dab, .. }) = &self.members[0]
            {
                let (old, new) = (page.colour(v), dab.settings.colour);
                let t = sum.dye.min(1.0);
                out.set_colour(v, std::array::from_fn(|i| blend(old[i], new[i], t)));
            }
        }
    }
}

/// One channel, mixed as light is: sRGB is near enough the square root of it. Never stands still
/// short of its goal.
fn blend(old: u8, new: u8, t: f32) -> u8 {
    let (a, b) = (f32::from(old), f32::from(new));
    let mixed = (a * a * (1.0 - t) + b * b * t).sqrt();
    let rounded = mixed.round() as u8;
    if rounded == old && new != old && t > 0.02 {
        return if new > old { old + 1 } else { old - 1 };
    }
    rounded
}

/// Returns the new position of a vertex that must stay within `limit` of `before`. The step is cut
/// where it leaves the ball, so the last one ends exactly on it. A vertex that is outside already
/// (its budget is spent) stays, unless it comes nearer.
#[inline(always)]
fn held(before: Vec3, p: Vec3, by: Vec3, limit: f32, grip: Grip) -> Vec3 {
    let goal = p + by;
    if limit == f32::INFINITY || matches!(grip, Grip::Anchor) {
        return goal;
    }
    let (from, to) = (p - before, goal - before);
    if to.length_squared() <= limit * limit {
        return goal;
    }
    let (a, b, c) = (by.length_squared(), from.dot(by), from.length_squared() - limit * limit);
    if c >= 0.0 {
        return if to.length_squared() < from.length_squared() { goal } else { p };
    }
    // |from + s by| = limit: the positive root, written without cancellation.
    let root = (b * b - a * c).max(0.0).sqrt();
    let s = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
    before + (from + by * s.clamp(0.0, 1.0)).clamp_length_max(limit)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::brush::stamp::Lens;
    use crate::brush::{BrushKind, BrushSettings};
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    /// Three dabs of a stroke over a ball that is masked in part.
    fn stroke(settings: &BrushSettings) -> Vec<Vec3> {
        let mut mesh = Clay::build(&shapes::sphere_of_about(20_000), &Job::default()).expect("ok");
        let (workers, mut scratch) = (Workers::new(1), Scratch::default());
        mesh.begin_step();
        for i in 0..3 {
            let centre = Vec3::new(0.05 * i as f32, 0.0, 1.0).normalize();
            let first = Dab {
                settings,
                centre,
                normal: centre,
                touch: centre,
                found: settings.kind.found() && !settings.accumulate,
                radius: 0.4,
                strength: 0.3,
                span: 0.6,
                pace: 0.0,
                heading: Vec3::X * 0.5,
                course: Vec3::X,
                bend: Vec3::ZERO,
                pass: 0,
                sign: if i == 2 { -1.0 } else { 1.0 },
                motion: Vec3::X * (0.05 * i.min(1) as f32),
                last: Vec3::ZERO,
                eye: Vec3::Z,
                right: Vec3::X,
                lens: Lens::default(),
                hand: 1.0,
                image: 0,
                travelled: 0.05 * i as f32,
                stroke: 1,
                set: 0,
                draws: None,
            };
            let dab = Dab { pace: first.pace_of(first.strength), ..first };
            let report = DabReport::default();
            let mut tool =
                Tool { mesh: &mut mesh, workers: &workers, scratch: &mut scratch, report };
            if i == 0 {
                let centre = Vec3::new(0.2, 0.1, 1.0).normalize();
                let mask = Dab { centre, normal: centre, radius: 0.2, strength: 0.7, ..dab };
                BrushKind::Mask.apply(&[mask], &mut tool);
            }
            settings.kind.apply(&[dab], &mut tool);
            assert!(tool.report.moved > 100, "{}: {:?}", settings.kind, tool.report);
        }
        mesh.to_tri().positions
    }

    #[test]
    fn blocks_of_vertices_move_as_single_vertices_do_to_the_bit() {
        let kinds = [BrushKind::Pinch, BrushKind::Layer, BrushKind::Clay, BrushKind::ClayStrips];
        for kind in kinds {
            for hardness in [0.0, 0.4] {
                let blocks = BrushSettings { hardness, ..BrushSettings::new(kind) };
                // A limit that is never reached is held vertex by vertex.
                let single = BrushSettings { saturation: 1e6, ..blocks };
                let blocks = stroke(&BrushSettings { accumulate: false, ..blocks });
                let single = stroke(&BrushSettings { accumulate: false, ..single });
                assert!(blocks == single, "{kind}, hardness {hardness}");
            }
        }
    }
}
