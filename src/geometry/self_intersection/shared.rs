//! Triangles that share an edge.

use std::cmp::Ordering;

use glam::DVec3;

use super::predicate::{on_a_line, overlap, side};

/// Adds the pairs of triangles at the edge from `a` to `b` that cross: coplanar ones on the same
/// side of the edge. The triangles are sorted by their direction around it, so that thousands at
/// one edge are not compared each with each.
pub(super) fn along_shared_edge(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    (a, b): (u32, u32),
    around: &[u32],
    out: &mut Vec<(u32, u32)>,
) {
    let p = |v: u32| positions[v as usize];
    let third = |t: u32| triangles[t as usize].into_iter().find(|v| *v != a && *v != b);
    let mut fan: Vec<(u32, DVec3)> =
        around.iter().filter_map(|&t| Some((t, p(third(t)?)))).collect();
    // Three points on a line are no triangle, and tell no direction.
    fan.retain(|&(_, q)| !on_a_line(p(a), p(b), q));
    if fan.is_empty() {
        return;
    }
    let meets = |x: DVec3, y: DVec3| {
        side(p(a), p(b), x, y) == 0.0 && overlap([p(a), p(b), x], [p(a), p(b), y])
    };
    if let &[x, y] = &fan[..] {
        if meets(x.1, y.1) {
            out.push((x.0.min(y.0), x.0.max(y.0)));
        }
        return;
    }
    // The order around the edge from the first direction: that direction, the half turn on one side
    // of its plane, the opposite direction, the other half turn.
    let first = fan[0].1;
    let half = |q: DVec3| {
        let s = side(p(a), p(b), first, q);
        if s > 0.0 {
            1
        } else if s < 0.0 {
            3
        } else if q == first || meets(first, q) {
            0
        } else {
            2
        }
    };
    let mut turned: Vec<(i32, u32, DVec3)> = fan.drain(..).map(|(t, q)| (half(q), t, q)).collect();
    turned.sort_by(|x, y| {
        let around = || side(p(a), p(b), y.2, x.2).total_cmp(&0.0);
        let same_half = x.0 == y.0 && (x.0 == 1 || x.0 == 3);
        x.0.cmp(&y.0).then_with(|| if same_half { around() } else { Ordering::Equal })
    });
    for group in turned.chunk_by(|x, y| x.0 == y.0 && side(p(a), p(b), x.2, y.2) == 0.0) {
        for (i, x) in group.iter().enumerate() {
            for y in &group[i + 1..] {
                if meets(x.2, y.2) {
                    out.push((x.1.min(y.1), x.1.max(y.1)));
                }
            }
        }
    }
}
