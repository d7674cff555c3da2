//! Places where an edge is on another surface: the other triangles at the edge decide if the
//! surface crosses there.

use glam::DVec3;
use robust::orient2d;

use super::predicate::{Meet, Which, flatten, side};

/// The contribution of one triangle at a place where an edge is on another surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Touch {
    /// Edge; the triangle that it runs through; a triangle at the edge, and whether it is above.
    Along([u32; 2], u32, u32, bool),
    /// Edge and edge on one line, the lesser first; a triangle at each.
    Edges([u32; 2], [u32; 2], u32, u32),
}

pub(super) fn touch(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    t: u32,
    u: u32,
    found: Meet,
) -> Option<Touch> {
    let edge = |t: u32, k: usize| {
        let c = triangles[t as usize];
        let (a, b) = (c[k], c[(k + 1) % 3]);
        [a.min(b), a.max(b)]
    };
    let along = |t: u32, k: usize, through: u32| {
        let [a, b, c] = triangles[through as usize].map(|v| positions[v as usize]);
        let third = triangles[t as usize][(k + 2) % 3];
        Touch::Along(edge(t, k), through, t, side(a, b, c, positions[third as usize]) > 0.0)
    };
    match found {
        Meet::Along(Which::First, k) => Some(along(t, k, u)),
        Meet::Along(Which::Second, k) => Some(along(u, k, t)),
        Meet::Edges(i, j) => {
            let (e, f) = (edge(t, i), edge(u, j));
            (e != f)
                .then(|| if e < f { Touch::Edges(e, f, t, u) } else { Touch::Edges(f, e, u, t) })
        }
        _ => None,
    }
}

/// The pairs among the touches at which a surface goes from one side of the other to the other
/// side; only of places of which one triangle `counts`.
pub(super) fn through(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    mut touches: Vec<Touch>,
    counts: impl Fn(u32) -> bool,
    out: &mut Vec<(u32, u32)>,
) {
    touches.sort_unstable();
    let same = |a: &Touch, b: &Touch| match (a, b) {
        (Touch::Along(e, t, ..), Touch::Along(f, u, ..)) => (e, t) == (f, u),
        (Touch::Edges(e, f, ..), Touch::Edges(g, h, ..)) => (e, f) == (g, h),
        _ => false,
    };
    let ordered = |a: u32, b: u32| (a.min(b), a.max(b));
    let asked = |group: &&[Touch]| {
        group.iter().any(|g| match *g {
            Touch::Along(_, t, u, _) | Touch::Edges(_, _, t, u) => counts(t) || counts(u),
        })
    };
    for group in touches.chunk_by(same).filter(asked) {
        match group[0] {
            Touch::Along(_, other, ..) => {
                let own = |g: &Touch| {
                    if let Touch::Along(_, _, t, up) = *g { (t, up) } else { (other, false) }
                };
                let above = group.iter().filter(|g| own(g).1).count();
                // Of an even number of faces at an edge, an odd number above: one at least goes on
                // below.
                if group.len() % 2 == 0 && above % 2 == 1 {
                    out.extend(group.iter().map(|g| ordered(own(g).0, other)));
                }
            }
            Touch::Edges(e, f, ..) => {
                let pair =
                    |g: &Touch| if let Touch::Edges(_, _, t, u) = *g { (t, u) } else { (0, 0) };
                let set = |of: fn((u32, u32)) -> u32| {
                    let mut all: Vec<u32> = group.iter().map(|g| of(pair(g))).collect();
                    all.sort_unstable();
                    all.dedup();
                    all
                };
                let (own, others) = (set(|p| p.0), set(|p| p.1));
                let (&[a, b], &[c, d]) = (&own[..], &others[..]) else { continue };
                let third = |t: u32, e: [u32; 2]| {
                    let v =
                        triangles[t as usize].into_iter().find(|v| !e.contains(v)).unwrap_or(e[0]);
                    positions[v as usize]
                };
                let line = e.map(|v| positions[v as usize]);
                if alternate(line, [third(a, e), third(b, e)], [third(c, f), third(d, f)]) {
                    out.extend(group.iter().map(|g| ordered(pair(g).0, pair(g).1)));
                }
            }
        }
    }
}

/// Whether, around a line, one of the second pair's half planes is on each side of the first
/// pair's.
fn alternate([p, q]: [DVec3; 2], [a, b]: [DVec3; 2], other: [DVec3; 2]) -> bool {
    let turn = |x: DVec3, y: DVec3| side(p, q, x, y);
    let flat = |x: DVec3, y: DVec3| {
        let flat = flatten([[p, q, x], [p, q, y]]);
        orient2d(flat(p), flat(q), flat(x)) * orient2d(flat(p), flat(q), flat(y)) > 0.0
    };
    // In the wedge from a around to b, the way in which `turn` is positive; None: on one of the
    // two.
    let inside = |x: DVec3| {
        let (from, to) = (turn(a, x), turn(x, b));
        if from == 0.0 && flat(a, x) || to == 0.0 && flat(b, x) {
            return None;
        }
        let whole = turn(a, b);
        if whole > 0.0 {
            Some(from > 0.0 && to > 0.0)
        } else if whole < 0.0 {
            Some(from > 0.0 || to > 0.0)
        } else {
            Some(from > 0.0 && !flat(a, b))
        }
    };
    matches!((inside(other[0]), inside(other[1])), (Some(x), Some(y)) if x != y)
}
