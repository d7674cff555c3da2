//! Edges in a plane, cut where they cross, in whole numbers: snap rounding (Hobby, "Practical
//! segment intersection with finite precision output", 1999).
//!
//! Each end of an edge and each crossing of two is rounded to a whole point, and every edge is led
//! through all of these points whose unit square it passes. No edge moves by more than a step, and
//! what comes out does not cross, however many edges nearly coincide.

use glam::DVec3;
use rayon::prelude::*;

use crate::boolean::box_tree::{Span, SpanTree};
use crate::job::Job;

/// A directed edge in whole numbers below 2^47.
pub type WholeEdge = [[i64; 2]; 2];

/// Twice the area of a triangle, exactly.
fn orient([ax, ay]: [i64; 2], [bx, by]: [i64; 2], [cx, cy]: [i64; 2]) -> i128 {
    i128::from(bx - ax) * i128::from(cy - ay) - i128::from(by - ay) * i128::from(cx - ax)
}

/// The whole point next to where two edges cross, both beyond their ends; within a tenth of a step
/// of what rounding the exact point gives.
fn meeting_point([a, b]: WholeEdge, [c, d]: WholeEdge) -> Option<[i64; 2]> {
    let (p, q) = (orient(c, d, a), orient(c, d, b));
    let (r, s) = (orient(a, b, c), orient(a, b, d));
    let opposite = |x: i128, y: i128| (x > 0 && y < 0) || (x < 0 && y > 0);
    if !opposite(p, q) || !opposite(r, s) {
        return None;
    }
    // Both terms are exact up to here, so the quotient is right to its last digits.
    let t = p as f64 / (p - q) as f64;
    Some([0, 1].map(|k| a[k] + ((b[k] - a[k]) as f64 * t).round() as i64))
}

/// Returns true if an edge passes between its ends through the square around `c`, a fifth larger
/// than a step.
fn passes([a, b]: WholeEdge, c: [i64; 2]) -> bool {
    let (dx, dy) = (i128::from(b[0] - a[0]), i128::from(b[1] - a[1]));
    let along = |p: [i64; 2]| i128::from(p[0] - a[0]) * dx + i128::from(p[1] - a[1]) * dy;
    let at = along(c);
    10 * orient(a, b, c).abs() <= 6 * (dx.abs() + dy.abs()) && at > 0 && at < along(b)
}

/// Returns the edges, cut and rounded. `spans` and `tree` hold the boxes of the edges. Each edge
/// becomes a path between its old ends, so that a closed sum of edges stays closed.
pub fn snap_rounded(edges: &[WholeEdge], spans: &[Span], tree: &SpanTree) -> Vec<WholeEdge> {
    let crossings = |i: usize| {
        let mut found = Vec::new();
        tree.each_meets(&spans[i], |j| {
            if (j as usize) > i {
                found.extend(meeting_point(edges[i], edges[j as usize]));
            }
        });
        found
    };
    let mut points: Vec<[i64; 2]> =
        (0..edges.len()).into_par_iter().flat_map_iter(crossings).collect();
    points.extend(edges.iter().flatten());
    points.par_sort_unstable();
    points.dedup();
    // Larger than the squares that count, and never on a whole number.
    let square = |p: &[i64; 2]| {
        let middle = DVec3::new(p[0] as f64, p[1] as f64, 0.0);
        Span { lo: middle - DVec3::new(0.75, 0.75, 1.0), hi: middle + DVec3::new(0.75, 0.75, 1.0) }
    };
    let squares: Vec<Span> = points.iter().map(square).collect();
    // A fresh job is never cancelled.
    let near = SpanTree::build(&squares, &Job::default()).unwrap_or_default();
    let path = |edge: &WholeEdge| {
        let [a, b] = *edge;
        let place = |p: [i64; 2]| DVec3::new(p[0] as f64, p[1] as f64, 0.0);
        let mut on = Vec::new();
        near.along(place(a), place(b), |i| {
            let p = points[i as usize];
            if passes(*edge, p) {
                let way = |k: usize| i128::from(p[k] - a[k]) * i128::from(b[k] - a[k]);
                on.push((way(0) + way(1), p));
            }
            true
        });
        on.sort_unstable();
        let mut from = a;
        let mut out = Vec::with_capacity(on.len() + 1);
        for p in on.into_iter().map(|o| o.1).chain([b]) {
            if p != from {
                out.push([from, p]);
                from = p;
            }
        }
        out
    };
    edges.par_iter().flat_map_iter(path).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bundle_is_cut_at_all_its_crossings_and_crosses_no_more() {
        // Edges that all run through nearly one place at nearly one angle, and one across them.
        let mut edges: Vec<WholeEdge> = (0..40)
            .map(|i| [[-1_000_000_000, 17 * i - 300], [1_000_000_000, 290 - 15 * i]])
            .collect();
        edges.push([[-3, -1_000_000], [5, 1_000_000]]);
        let place = |p: [i64; 2]| DVec3::new(p[0] as f64, p[1] as f64, 0.0);
        let spans: Vec<Span> = edges.iter().map(|e| Span::of(e.map(place))).collect();
        let tree = SpanTree::build(&spans, &Job::default()).expect("built");
        let mut cut = snap_rounded(&edges, &spans, &tree);
        assert!(cut.len() > 100, "{}", cut.len());
        // The balance of each point is unchanged.
        let mut balance = std::collections::BTreeMap::new();
        let sides = [(&edges, 1), (&cut, -1)];
        for (list, sign) in sides {
            for e in list {
                *balance.entry(e[0]).or_insert(0) += sign;
                *balance.entry(e[1]).or_insert(0) -= sign;
            }
        }
        assert!(balance.values().all(|&n| n == 0));
        cut.sort_unstable();
        cut.dedup();
        for (i, &e) in cut.iter().enumerate() {
            for &f in &cut[i + 1..] {
                assert_eq!(meeting_point(e, f), None, "{e:?} {f:?}");
            }
        }
    }
}
