//! Boxes of triangles in groups of eight, in the order of a space-filling curve: which triangles
//! may meet.
//!
//! The triangles are sorted by the Morton code of the middle of their boxes (Morton, "A computer
//! oriented geodetic data base", 1966; for trees: Lauterbach et al., "Fast BVH construction on
//! GPUs", 2009). Each eight that follow each other are a group, each eight groups a group of the
//! level above. Nothing but the boxes is kept, so the tree takes a fifth of the time of one that is
//! built by surface area, and eight boxes are tested at once.

use glam::DVec3;
use rayon::prelude::*;

use crate::job::{Cancelled, Job};

/// A box in single precision, rounded outwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundedBox {
    lo: [f32; 3],
    hi: [f32; 3],
}

impl RoundedBox {
    const EMPTY: RoundedBox = RoundedBox { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    /// Around a box in double precision.
    pub fn around(lo: DVec3, hi: DVec3) -> RoundedBox {
        let down = |x: f64| {
            let near = x as f32;
            if f64::from(near) > x { near.next_down() } else { near }
        };
        let up = |x: f64| {
            let near = x as f32;
            if f64::from(near) < x { near.next_up() } else { near }
        };
        RoundedBox { lo: lo.to_array().map(down), hi: hi.to_array().map(up) }
    }

    fn join(self, o: RoundedBox) -> RoundedBox {
        let pick = |f: fn(f32, f32) -> f32, a: [f32; 3], b: [f32; 3]| {
            [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])]
        };
        RoundedBox { lo: pick(f32::min, self.lo, o.lo), hi: pick(f32::max, self.hi, o.hi) }
    }
}

/// Eight boxes, coordinate by coordinate. An unused lane is a box of nothing.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct BoxGroup {
    lo: [[f32; 8]; 3],
    hi: [[f32; 8]; 3],
}

impl BoxGroup {
    const EMPTY: BoxGroup =
        BoxGroup { lo: [[f32::INFINITY; 8]; 3], hi: [[f32::NEG_INFINITY; 8]; 3] };

    fn of(boxes: impl Iterator<Item = RoundedBox>) -> BoxGroup {
        let mut out = BoxGroup::EMPTY;
        for (lane, b) in boxes.enumerate() {
            for axis in 0..3 {
                (out.lo[axis][lane], out.hi[axis][lane]) = (b.lo[axis], b.hi[axis]);
            }
        }
        out
    }

    fn lane(&self, lane: usize) -> RoundedBox {
        RoundedBox { lo: self.lo.map(|l| l[lane]), hi: self.hi.map(|h| h[lane]) }
    }

    fn joined_box(&self) -> RoundedBox {
        (0..8).fold(RoundedBox::EMPTY, |b, lane| b.join(self.lane(lane)))
    }

    /// Returns a bit for each of the eight boxes that has a point in common with `b`.
    #[inline(always)]
    fn meets(&self, b: &RoundedBox) -> u32 {
        let mut bits = [0u32; 8];
        for lane in 0..8 {
            let x = (self.lo[0][lane] <= b.hi[0]) & (b.lo[0] <= self.hi[0][lane]);
            let y = (self.lo[1][lane] <= b.hi[1]) & (b.lo[1] <= self.hi[1][lane]);
            let z = (self.lo[2][lane] <= b.hi[2]) & (b.lo[2] <= self.hi[2][lane]);
            bits[lane] = u32::from(x & y & z) << lane;
        }
        bits.iter().fold(0, |mask, bit| mask | bit)
    }
}

/// The tree.
#[derive(Debug)]
pub(super) struct BoxGroups {
    /// The triangles in the order of the curve.
    order: Vec<u32>,
    /// First the triangles' boxes, then those of the groups of the level before; the last level
    /// has one group.
    levels: Vec<Vec<BoxGroup>>,
}

/// Groups of triangles that one task works through.
const TASK: usize = 256;

impl BoxGroups {
    /// Over the triangles of `list`, whose boxes `of` gives; not empty.
    pub fn build(
        list: impl IndexedParallelIterator<Item = u32>,
        of: impl Fn(u32) -> RoundedBox + Sync,
        job: &Job,
    ) -> Result<BoxGroups, Cancelled> {
        let boxes: Vec<(RoundedBox, u32)> = list.map(|t| (of(t), t)).collect();
        let whole = boxes
            .par_chunks(1 << 14)
            .map(|c| c.iter().fold(RoundedBox::EMPTY, |a, b| a.join(b.0)))
            .reduce(|| RoundedBox::EMPTY, RoundedBox::join);
        // The sum of both sides is twice the middle.
        let twice = |b: &RoundedBox| [0, 1, 2].map(|k| f64::from(b.lo[k]) + f64::from(b.hi[k]));
        let size = [0, 1, 2].map(|k| f64::from(whole.hi[k]) - f64::from(whole.lo[k]));
        let scale = CELLS / (2.0 * size.into_iter().fold(f64::MIN_POSITIVE, f64::max));
        let code = |b: &RoundedBox| {
            let middle = twice(b);
            let cell = |k: usize| ((middle[k] - 2.0 * f64::from(whole.lo[k])) * scale) as u64;
            spread(cell(0)) << 2 | spread(cell(1)) << 1 | spread(cell(2))
        };
        job.check()?;
        let mut keys: Vec<(u64, u32)> =
            boxes.par_iter().enumerate().map(|(i, b)| (code(&b.0), i as u32)).collect();
        sort_by_code(&mut keys);
        job.check()?;
        let order: Vec<u32> = keys.par_iter().map(|k| boxes[k.1 as usize].1).collect();
        let first =
            keys.par_chunks(8).map(|c| BoxGroup::of(c.iter().map(|k| boxes[k.1 as usize].0)));
        let mut levels: Vec<Vec<BoxGroup>> = vec![first.collect()];
        while let Some(below) = levels.last().filter(|l| l.len() > 1) {
            let above =
                below.par_chunks(8).map(|c| BoxGroup::of(c.iter().map(BoxGroup::joined_box)));
            let above = above.collect();
            levels.push(above);
        }
        job.check()?;
        Ok(BoxGroups { order, levels })
    }

    /// Calls `f(task's state, triangle, triangle)` once for each two whose boxes have a point in
    /// common; the states in the order of the curve.
    pub fn pairs<T: Send + Default>(
        &self,
        job: &Job,
        f: impl Fn(&mut T, u32, u32) + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let groups = &self.levels[0];
        (0..groups.len().div_ceil(TASK))
            .into_par_iter()
            .map(|task| {
                job.check()?;
                let mut state = T::default();
                let mut stack = Vec::with_capacity(64);
                for own in task * TASK..groups.len().min((task + 1) * TASK) {
                    let group = &groups[own];
                    let lanes = self.order[own * 8..].iter().take(8).enumerate();
                    for (lane, &t) in lanes.clone() {
                        let later = group.meets(&group.lane(lane)) & (!1u32 << lane);
                        each_bit(later, |other| f(&mut state, t, self.order[own * 8 + other]));
                    }
                    let whole = group.joined_box();
                    self.descend(&whole, own + 1, &mut stack, |other| {
                        let theirs = &groups[other];
                        // Only boxes of the first eight that reach the box around the other eight.
                        let near = group.meets(&theirs.joined_box());
                        for (lane, &t) in lanes.clone().filter(|l| near >> l.0 & 1 == 1) {
                            let met = theirs.meets(&group.lane(lane));
                            each_bit(met, |u| f(&mut state, t, self.order[other * 8 + u]));
                        }
                    });
                }
                Ok(state)
            })
            .collect()
    }

    /// Calls `f` for each triangle whose box has a point in common with `b`.
    pub fn near(&self, b: &RoundedBox, stack: &mut Vec<(u32, u32)>, mut f: impl FnMut(u32)) {
        let groups = &self.levels[0];
        self.descend(b, 0, stack, |other| {
            each_bit(groups[other].meets(b), |u| f(self.order[other * 8 + u]));
        });
    }

    /// Calls `f` for each group of triangles from `from` on whose box meets `b`.
    fn descend(
        &self,
        b: &RoundedBox,
        from: usize,
        stack: &mut Vec<(u32, u32)>,
        mut f: impl FnMut(usize),
    ) {
        let top = self.levels.len() - 1;
        if top == 0 {
            if from == 0 {
                f(0);
            }
            return;
        }
        stack.clear();
        stack.push((top as u32, 0));
        while let Some((level, group)) = stack.pop() {
            let met = self.levels[level as usize][group as usize].meets(b);
            // Groups of triangles below one of this level's children.
            let below = 8usize.pow(level - 1);
            each_bit(met, |child| {
                let child = group as usize * 8 + child;
                if (child + 1) * below > from && level == 1 {
                    f(child);
                } else if (child + 1) * below > from {
                    stack.push((level - 1, child as u32));
                }
            });
        }
    }
}

#[inline(always)]
fn each_bit(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Cells along the longest side of the whole box; 21 bits.
const CELLS: f64 = ((1u64 << 21) - 1) as f64;

/// The low 21 bits, two empty ones after each.
fn spread(cell: u64) -> u64 {
    let mut x = cell & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// By code, equal codes as they came: a radix sort from the lowest digit of 11 bits on.
fn sort_by_code(keys: &mut Vec<(u64, u32)>) {
    const BITS: u32 = 11;
    if keys.len() < 4096 {
        keys.sort_unstable();
        return;
    }
    let digit = |k: u64, pass: u32| (k >> (pass * BITS)) as usize & ((1 << BITS) - 1);
    let mut other = vec![(0u64, 0u32); keys.len()];
    for pass in 0..63u32.div_ceil(BITS) {
        let mut starts = vec![0u32; 1 << BITS];
        keys.iter().for_each(|k| starts[digit(k.0, pass)] += 1);
        if starts.iter().any(|&n| n as usize == keys.len()) {
            continue;
        }
        let mut sum = 0;
        for s in &mut starts {
            sum += std::mem::replace(s, sum);
        }
        for k in keys.iter() {
            let at = &mut starts[digit(k.0, pass)];
            other[*at as usize] = *k;
            *at += 1;
        }
        std::mem::swap(keys, &mut other);
    }
}
