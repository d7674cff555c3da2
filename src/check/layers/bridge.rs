//! The span of a flat ceiling: how far the strands of a printer reach from one support to the next.
//!
//! A strand is a chord of the ceiling's outline; it is held where both its ends are on edges from
//! which a wall goes down. The ceiling is a bridge if strands of some one direction are all held.
//! Its span is the longest strand, in the direction in which that is shortest.

use std::f64::consts::PI;

use glam::DVec2;
use sculptd_geometry::portable::PortableMath;

use crate::part::{PreparedPart, Standing};

/// Strands that are tried in each direction.
const STRANDS: usize = 101;
/// Directions that are tried besides those of the supports.
const DIRECTIONS: usize = 36;
/// Most directions of supports that are tried.
const MOST_SUPPORTS: usize = 24;
/// The share of the strands' length that may be held at one end only.
const LOOSE: f64 = 0.02;

/// An edge of the outline.
struct BorderEdge {
    ends: [DVec2; 2],
    held: bool,
}

/// The span of a flat ceiling, or `None` where no direction of strands is held at both ends.
pub fn bridge_span(part: &PreparedPart, stand: &Standing, triangles: &[u32]) -> Option<f64> {
    let edges = border(part, stand, triangles);
    let mut held: Vec<&BorderEdge> = edges.iter().filter(|e| e.held).collect();
    let length = |e: &BorderEdge| e.ends[0].distance(e.ends[1]);
    held.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let first = held.first()?;
    let across = |e: &BorderEdge| (e.ends[1] - e.ends[0]).perp().normalize_or_zero();
    let mut directions: Vec<DVec2> = Vec::new();
    for e in &held {
        let d = across(e);
        let known = directions.iter().any(|o| o.dot(d).abs() > 0.9999);
        if d != DVec2::ZERO && !known {
            directions.push(d);
        }
        if directions.len() == MOST_SUPPORTS {
            break;
        }
    }
    let base = across(first);
    for i in 1..DIRECTIONS {
        let turn = PI * i as f64 / DIRECTIONS as f64;
        directions.push(DVec2::new(turn.portable_cos(), turn.portable_sin()).rotate(base));
    }
    let spans = directions.iter().filter_map(|&d| {
        let (longest, loose) = strands(&edges, d)?;
        (loose <= LOOSE).then_some(longest)
    });
    spans.min_by(f64::total_cmp)
}

/// The outline of the region in the plan, and where walls go down from it.
fn border(part: &PreparedPart, stand: &Standing, triangles: &[u32]) -> Vec<BorderEdge> {
    let (u, v) = stand.plan();
    let names = &part.topology().triangles;
    let flat = |n: u32| {
        let p = part.places[n as usize];
        DVec2::new(p.dot(u), p.dot(v))
    };
    let mut out = Vec::new();
    for &t in triangles {
        for k in 0..3 {
            let beyond = part.across(t, k);
            if beyond.is_some_and(|n| triangles.binary_search(&n).is_ok()) {
                continue;
            }
            let (a, b) = (names[t as usize][k], names[t as usize][(k + 1) % 3]);
            let height = stand.heights[a as usize].max(stand.heights[b as usize]);
            // The wall beyond the edge goes down from it.
            let held = beyond.is_some_and(|n| {
                let third = names[n as usize].iter().find(|c| **c != a && **c != b);
                third.is_some_and(|&c| stand.heights[c as usize] < height - part.tolerance)
            });
            out.push(BorderEdge { ends: [flat(a), flat(b)], held });
        }
    }
    out
}

/// The longest strand along `d` that is held, and the share of the length of all strands that is
/// not.
fn strands(edges: &[BorderEdge], d: DVec2) -> Option<(f64, f64)> {
    let side = d.perp();
    let all = edges.iter().flat_map(|e| e.ends);
    let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| {
        (lo.min(p.dot(side)), hi.max(p.dot(side)))
    });
    if !(lo < hi) {
        return None;
    }
    let step = (hi - lo) / STRANDS as f64;
    let line = |i: usize| lo + (i as f64 + 0.5) * step;
    let mut met: Vec<Vec<(f64, bool)>> = vec![Vec::new(); STRANDS];
    for e in edges {
        let (mut a, mut b) = (e.ends[0], e.ends[1]);
        if a.dot(side) > b.dot(side) {
            std::mem::swap(&mut a, &mut b);
        }
        let (from, to) = (a.dot(side), b.dot(side));
        let first = ((from - lo) / step - 0.5).floor().max(0.0) as usize;
        for (i, at) in (first..STRANDS).map(|i| (i, line(i))).take_while(|l| l.1 < to) {
            if at >= from {
                let p = a + (b - a) * ((at - from) / (to - from));
                met[i].push((p.dot(d), e.held));
            }
        }
    }
    let (mut longest, mut held, mut loose) = (0f64, 0.0, 0.0);
    for ends in &mut met {
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in ends.chunks_exact(2) {
            let length = pair[1].0 - pair[0].0;
            if pair[0].1 && pair[1].1 {
                longest = longest.max(length);
                held += length;
            } else {
                loose += length;
            }
        }
    }
    (held > 0.0).then(|| (longest, loose / (held + loose)))
}
