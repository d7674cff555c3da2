//! The generalised winding number: how often the surface goes around a point. One inside a closed
//! solid, nothing outside, two where two shells overlap, something between near holes.
//!
//! Jacobson, Kavan and Sorkine-Hornung, "Robust inside-outside segmentation using generalized
//! winding numbers", 2013; summed by a hierarchy as Barill et al., "Fast winding numbers for soups
//! and clouds", 2018: a far subtree counts as one dipole (their first order), a near one is opened,
//! a triangle's solid angle is exact (Van Oosterom and Strackee 1983).

use std::f64::consts::PI;

use glam::DVec3;

use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, Pack};
use crate::simd::wide::{self, Wide, WideWork};

/// A subtree counts as one dipole from this many of its radii away. At 3, the sum over 100,000
/// triangles is off by less than 0.02, and only whether it is above a half matters.
const FAR: f32 = 3.0;

/// The eight children of one node as dipoles at their centres of area.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Dipoles {
    centre: [[f32; 8]; 3],
    /// Area times normal.
    moment: [[f32; 8]; 3],
    /// Square of [`FAR`] radii. A child that is not there is far away, at 1e9, and has no moment.
    far: [f32; 8],
}

/// The dipoles of a tree's nodes, by the same index.
#[derive(Debug, Clone)]
pub struct Winding {
    dipoles: Vec<Dipoles>,
}

#[derive(Clone, Copy, Default)]
struct DipoleSum {
    moment: DVec3,
    area: f64,
    weighted: DVec3,
    lo: DVec3,
    hi: DVec3,
}

fn corners(pack: &Pack, i: usize) -> [DVec3; 3] {
    [0, 1, 2]
        .map(|c| DVec3::new(pack.v[c][0][i] as f64, pack.v[c][1][i] as f64, pack.v[c][2][i] as f64))
}

fn pack_sum(pack: &Pack) -> DipoleSum {
    let mut s = DipoleSum { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY, ..Default::default() };
    for i in 0..4 {
        if pack.id[i] == NO_TRIANGLE {
            continue;
        }
        let [a, b, c] = corners(pack, i);
        let moment = (b - a).cross(c - a) * 0.5;
        let area = moment.length();
        s.moment += moment;
        s.area += area;
        s.weighted += (a + b + c) * (area / 3.0);
        s.lo = s.lo.min(a).min(b).min(c);
        s.hi = s.hi.max(a).max(b).max(c);
    }
    s
}

impl Winding {
    /// The dipoles of every node of `tree`, in time linear in its size.
    pub fn build(tree: &Bvh8) -> Winding {
        let nodes = tree.nodes();
        let none = Dipoles { centre: [[1e9; 8]; 3], moment: [[0.0; 8]; 3], far: [-1.0; 8] };
        let mut dipoles = vec![none; nodes.len()];
        let mut sums = vec![DipoleSum::default(); nodes.len()];
        // Children come after their parent.
        for at in (0..nodes.len()).rev() {
            let node = &nodes[at];
            let mut all =
                DipoleSum { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY, ..Default::default() };
            for i in 0..8 {
                if node.planes[0][i] == f32::INFINITY {
                    continue;
                }
                let child = node.child[i];
                let s = if child & LEAF != 0 {
                    pack_sum(&tree.packs()[(child & !LEAF) as usize])
                } else {
                    sums[child as usize]
                };
                all.moment += s.moment;
                all.area += s.area;
                all.weighted += s.weighted;
                all.lo = all.lo.min(s.lo);
                all.hi = all.hi.max(s.hi);
                let centre = if s.area > 0.0 { s.weighted / s.area } else { (s.lo + s.hi) * 0.5 };
                let radius = (centre - s.lo).max(s.hi - centre).length() as f32 * FAR;
                let d = &mut dipoles[at];
                for axis in 0..3 {
                    d.centre[axis][i] = centre[axis] as f32;
                    d.moment[axis][i] = s.moment[axis] as f32;
                }
                d.far[i] = radius * radius;
            }
            sums[at] = all;
        }
        Winding { dipoles }
    }

    /// Returns the winding number of the surface of `tree`, from which this was built, around `p`;
    /// returns 0 out of range ([`crate::bvh::REACH`]).
    pub fn at(&self, tree: &Bvh8, p: DVec3) -> f64 {
        if self.dipoles.is_empty() || tree.out_of_range(p) {
            return 0.0;
        }
        wide::dispatch(tree.scalar(), WindingQuery { winding: self, tree, p })
    }
}

/// A sum of angles without an arc tangent for each: that of the complex number, whose real part is
/// not negative, and so many half turns. Turns are counted where a product or a factor is folded
/// over, so that the sum is never off by one, whichever angles it is made of.
#[derive(Clone, Copy)]
struct AngleSum {
    re: f64,
    im: f64,
    half_turns: i32,
}

impl AngleSum {
    const NONE: AngleSum = AngleSum { re: 1.0, im: 0.0, half_turns: 0 };

    /// The angle of (x, y), in [-pi, pi].
    #[inline(always)]
    fn of(y: f64, x: f64) -> AngleSum {
        let size = x.abs() + y.abs();
        if !(size > 0.0) {
            return AngleSum::NONE;
        }
        let fold = 1.0f64.copysign(x) / size;
        let turn = if y.is_sign_negative() { -1 } else { 1 };
        AngleSum { re: x * fold, im: y * fold, half_turns: if x < 0.0 { turn } else { 0 } }
    }

    #[inline(always)]
    fn plus(self, o: AngleSum) -> AngleSum {
        let (re, im) = (self.re * o.re - self.im * o.im, self.re * o.im + self.im * o.re);
        // Only two angles of one sign are together more than a quarter turn.
        let turn = if self.im < 0.0 { -1 } else { 1 };
        let fold = if re < 0.0 { -1.0 } else { 1.0 };
        let half_turns = self.half_turns + o.half_turns + if re < 0.0 { turn } else { 0 };
        AngleSum { re: re * fold, im: im * fold, half_turns }
    }

    /// The same, of a length that stays away from zero however many are summed up.
    #[inline(always)]
    fn renewed(self) -> AngleSum {
        let scale = 1.0 / (self.re + self.im.abs());
        AngleSum { re: self.re * scale, im: self.im * scale, ..self }
    }

    fn turns(self) -> f64 {
        self.im.atan2(self.re) / (2.0 * PI) + 0.5 * f64::from(self.half_turns)
    }
}

/// Half the solid angles of a leaf's triangles seen from `p`, four at once (Van Oosterom and
/// Strackee 1983); positive where a front is turned away.
#[inline(always)]
fn angles_of(pack: &Pack, p: DVec3) -> AngleSum {
    let p = p.to_array();
    let mut v = [[[0.0f64; 4]; 3]; 3];
    for c in 0..3 {
        for axis in 0..3 {
            for i in 0..4 {
                v[c][axis][i] = f64::from(pack.v[c][axis][i]) - p[axis];
            }
        }
    }
    let [a, b, c] = v;
    let dot = |s: &[[f64; 4]; 3], t: &[[f64; 4]; 3]| {
        let mut out = [0.0; 4];
        for i in 0..4 {
            out[i] = s[0][i] * t[0][i] + s[1][i] * t[1][i] + s[2][i] * t[2][i];
        }
        out
    };
    let mut normal = [[0.0; 4]; 3];
    for k in 0..3 {
        let (m, n) = ((k + 1) % 3, (k + 2) % 3);
        for i in 0..4 {
            normal[k][i] = b[m][i] * c[n][i] - b[n][i] * c[m][i];
        }
    }
    let up = dot(&a, &normal);
    let [la, lb, lc] = [&a, &b, &c].map(|s| dot(s, s).map(f64::sqrt));
    let (ab, bc, ca) = (dot(&a, &b), dot(&b, &c), dot(&c, &a));
    let mut down = [0.0; 4];
    for i in 0..4 {
        down[i] = la[i] * lb[i] * lc[i] + ab[i] * lc[i] + bc[i] * la[i] + ca[i] * lb[i];
    }
    let one = |i: usize| {
        if pack.id[i] == NO_TRIANGLE { AngleSum::NONE } else { AngleSum::of(up[i], down[i]) }
    };
    one(0).plus(one(1)).plus(one(2).plus(one(3)))
}

struct WindingQuery<'a> {
    winding: &'a Winding,
    tree: &'a Bvh8,
    p: DVec3,
}

impl WideWork for WindingQuery<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<W: Wide>(self, _: W) -> f64 {
        let WindingQuery { winding, tree, p: exact } = self;
        let p = exact.as_vec3().to_array();
        let mut inline = [0u32; 128];
        let mut heap =
            if tree.stack_need() > 128 { vec![0u32; tree.stack_need()] } else { Vec::new() };
        let stack: &mut [u32] = if heap.is_empty() { &mut inline } else { &mut heap };
        let mut top = 1;
        let (mut far_sum, mut near_sum) = (0.0f64, AngleSum::NONE);
        while top > 0 {
            top -= 1;
            let at = stack[top] as usize;
            let d = &winding.dipoles[at];
            let (mut square, mut share) = ([0.0f32; 8], [0.0f32; 8]);
            for axis in 0..3 {
                for i in 0..8 {
                    let r = d.centre[axis][i] - p[axis];
                    square[i] += r * r;
                    share[i] += r * d.moment[axis][i];
                }
            }
            let mut sum = 0.0f32;
            for i in 0..8 {
                let v = share[i] / (square[i] * square[i].sqrt());
                sum += if square[i] > d.far[i] { v } else { 0.0 };
            }
            far_sum += sum as f64;
            let node = &tree.nodes()[at];
            for i in 0..8 {
                if square[i] > d.far[i] {
                    continue;
                }
                let child = node.child[i];
                if child & LEAF == 0 {
                    stack[top] = child;
                    top += 1;
                    continue;
                }
                let own = angles_of(&tree.packs()[(child & !LEAF) as usize], exact);
                near_sum = near_sum.plus(own).renewed();
            }
        }
        far_sum / (4.0 * PI) + near_sum.turns()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_angles_have_all_their_turns() {
        // Whole and half turns among them, where an arc tangent of the product would lose one.
        let mut sum = AngleSum::NONE;
        let mut known = 0.0;
        for i in 0..4000 {
            let angle = match i % 4 {
                0 => PI,
                1 => f64::from(i) * 0.37 % PI,
                2 => -(f64::from(i) * 0.11 % PI),
                _ => PI / 2.0,
            };
            let size = 10f64.powi(i % 9 - 4);
            let (y, x) = if i % 4 == 0 { (0.0, -1.0) } else { (angle.sin(), angle.cos()) };
            sum = sum.plus(AngleSum::of(y * size, x * size)).renewed();
            known += angle;
            assert!((sum.turns() - known / (2.0 * PI)).abs() < 1e-9, "{i}");
        }
        let none = [AngleSum::of(0.0, 0.0), AngleSum::of(0.0, 3.0), AngleSum::of(-0.0, 3.0)];
        assert!(none.iter().all(|a| a.turns() == 0.0));
        assert_eq!([0.0, -0.0].map(|y| AngleSum::of(y, -2.0).turns()), [0.5, -0.5]);
    }
}
