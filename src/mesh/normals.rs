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

/// The unit normal of own vertex `v`; zero where all its triangles are degenerate. The fourth lane is nothing.
#[inline(always)]
pub(super) fn of_vertex(t: &Topology, points: &[Vec4], v: usize) -> Vec4 {
    let mut n = area_sum(t, points, v);
    n.w = 0.0;
    let mut length2 = n.dot(n);
    if length2 < TINY {
        let largest = n.abs().max_element();
        if !(largest > 0.0) {
            return Vec4::ZERO;
        }
        n /= largest;
        length2 = n.dot(n);
    }
    n / length2.sqrt()
}

/// Computes every own normal of a page.
pub(super) fn all(page: &mut Page) {
    let Page { topology, points, normals, .. } = page;
    for v in 0..topology.own {
        let n = of_vertex(topology, points, v);
        normals[v] = n.xyz().extend(normals[v].w);
    }
}

/// Computes the normals of moved vertices and of those with a moved neighbour, and marks them [`TURNED`].
/// `marks`: one a vertex, own and halo.
pub(super) fn around_moved(page: &mut Page, marks: &mut [u8], all_moved: bool) {
    let Page { topology, points, normals, .. } = page;
    let marks = &mut marks[..points.len()];
    for v in 0..topology.own {
        if !all_moved && marks[v] & MOVED == 0 {
            let near = topology.ring(v).iter().fold(0, |m, &k| m | marks[(k & !BREAK) as usize]);
            if near & MOVED == 0 {
                continue;
            }
        }
        let n = of_vertex(topology, points, v);
        let row = &mut normals[v];
        *row = n.xyz().extend(row.w);
        marks[v] |= TURNED;
    }
}
