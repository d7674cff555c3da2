//! Vertex normals: the sum of the triangles' area vectors, brought to unit length.
//!
//! Around a vertex with neighbours `d0, d1, ...` (relative to it) the sum is `d0 x d1 + d1 x d2 + ...`. A cross product is
//! `yzx(a * yzx(b) - yzx(a) * b)`, so one shuffle a neighbour and one at the end suffice. The order of the sum is the
//! ring's, which the topology fixes: the same bits whoever computes it.

use glam::{Vec4, Vec4Swizzles};

use super::page::{BREAK, Page, Ring, Topology};

/// A vertex whose position changed.
pub(super) const MOVED: u8 = 1;
/// A vertex whose normal was computed anew.
pub(super) const TURNED: u8 = 2;
/// A vertex whose mask or colour changed.
pub(super) const PAINTED: u8 = 4;

/// Below this squared length the sum is scaled up first, so that tiny triangles do not underflow.
const TINY: f32 = 1e-30;

/// The sum of area vectors about own vertex `v`, twice the area each.
#[inline(always)]
fn area_sum(t: &Topology, points: &[Vec4], v: usize) -> Vec4 {
    let ring = t.ring(v);
    let p = points[v];
    let mut sum = Vec4::ZERO;
    if let (Ring::Closed, &[a, b, c, d, e, f]) = (t.kinds[v], ring) {
        // Most vertices of most meshes. Two neighbouring terms share a factor: d0 x d1 + d1 x d2 = d1 x (d2 - d0).
        // Written out: an array's `map` is not always inlined into code for wider instructions.
        let (a, c, e) = (points[a as usize], points[c as usize], points[e as usize]);
        let (b, d, f) = (points[b as usize] - p, points[d as usize] - p, points[f as usize] - p);
        let term = |u: Vec4, v: Vec4| u * v.yzxw() - u.yzxw() * v;
        return (term(b, c - a) + term(d, e - c) + term(f, a - e)).yzxw();
    }
    let [first, rest @ ..] = ring else { return sum };
    let first = points[*first as usize] - p;
    let first_turned = first.yzxw();
    let (mut last, mut last_turned) = (first, first_turned);
    if t.kinds[v] == Ring::Several {
        for &k in rest {
            let d = points[(k & !BREAK) as usize] - p;
            let turned = d.yzxw();
            if k & BREAK == 0 {
                sum += last * turned - last_turned * d;
            }
            (last, last_turned) = (d, turned);
        }
    } else {
        for &k in rest {
            let d = points[k as usize] - p;
            let turned = d.yzxw();
            sum += last * turned - last_turned * d;
            (last, last_turned) = (d, turned);
        }
        if t.kinds[v] == Ring::Closed {
            sum += last * first_turned - last_turned * first;
        }
    }
    sum.yzxw()
}

/// The unit vector along a sum of area vectors; zero for a sum of nothing. The fourth lane is nothing.
#[inline(always)]
fn unit(sum: Vec4) -> Vec4 {
    let length2 = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    if length2 >= TINY && length2 < f32::INFINITY {
        sum * (1.0 / length2.sqrt())
    } else {
        unit_of_extremes(sum)
    }
}

/// As [`unit`], for sums whose squared length leaves the range of single precision.
#[cold]
fn unit_of_extremes(sum: Vec4) -> Vec4 {
    let n = sum.truncate();
    let largest = n.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        (n / largest).normalize_or_zero().extend(0.0)
    } else {
        Vec4::ZERO
    }
}

/// The unit normal of own vertex `v`; zero where all its triangles are degenerate. The fourth lane is nothing.
#[inline(always)]
pub(super) fn of_vertex(t: &Topology, points: &[Vec4], v: usize) -> Vec4 {
    unit(area_sum(t, points, v))
}

/// Computes every own normal of a page.
pub(super) fn all(page: &mut Page) {
    let Page { topology, points, normals, .. } = page;
    for v in 0..topology.own {
        let n = of_vertex(topology, points, v);
        normals[v] = n.xyz().extend(normals[v].w);
    }
}

/// Normals brought to unit length together: the square roots and divisions of several overlap in wide instructions.
const BATCH: usize = 32;

/// Computes the normals of moved vertices and of those with a moved neighbour, and marks them [`TURNED`].
/// `marks`: one a vertex, own and halo.
#[inline(always)]
pub(super) fn around_moved(page: &mut Page, marks: &mut [u8], all_moved: bool) {
    let Page { topology, points, normals, .. } = page;
    let marks = &mut marks[..points.len()];
    let mut sums = [Vec4::ZERO; BATCH];
    let mut who = [0u16; BATCH];
    let mut inverse = [0.0f32; BATCH];
    let mut waiting = 0;
    for v in 0..topology.own {
        let near = if all_moved || marks[v] & MOVED != 0 {
            MOVED
        } else {
            match *topology.ring(v) {
                [a, b, c, d, e, f] => {
                    let at = |k: u16| marks[(k & !BREAK) as usize];
                    (at(a) | at(b)) | (at(c) | at(d)) | (at(e) | at(f))
                }
                ref ring => ring.iter().fold(0, |m, &k| m | marks[(k & !BREAK) as usize]),
            }
        };
        if near & MOVED != 0 {
            sums[waiting] = area_sum(topology, points, v);
            who[waiting] = v as u16;
            waiting += 1;
        }
        if waiting < BATCH && v + 1 < topology.own {
            continue;
        }
        for (inverse, sum) in inverse.iter_mut().zip(&sums) {
            *inverse = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
        }
        let odd = inverse[..waiting].iter().any(|l| !(TINY..f32::INFINITY).contains(l));
        for inverse in &mut inverse {
            *inverse = 1.0 / inverse.sqrt();
        }
        for i in 0..waiting {
            let n = if odd { unit(sums[i]) } else { sums[i] * inverse[i] };
            let v = who[i] as usize;
            let row = &mut normals[v];
            *row = n.xyz().extend(row.w);
            marks[v] |= TURNED;
        }
        waiting = 0;
    }
}
