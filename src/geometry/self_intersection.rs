//! Which triangles of a mesh cross others: boxes in a tree, then exact tests.
//!
//! Two triangles cross if their insides have a line in common, or if they lie in one plane and
//! overlap. A surface also crosses another exactly along edges: an edge that runs through a
//! triangle's inside with faces on both sides of it, and two edges on one line whose faces come in
//! turns. What both share by index and touches from outside do not count. Signs are those of exact
//! arithmetic (Shewchuk's `orient3d`) on the coordinates as they are, so all cases of surfaces that
//! go through each other are among these: such surfaces have a line in common, and each piece of it
//! is inside of, or an edge of, a face of either.

use std::cmp::Ordering;

use glam::{DMat3, DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::job::{Cancelled, Job};
use crate::tight_frame::tight_frame;

/// How often a mesh crosses itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of triangles.
    pub pairs: usize,
    /// Triangles with a part in a pair.
    pub triangles: usize,
}

/// Pairs that cross whatever is beside them, and what to ask their neighbours.
type Found = (Vec<(u32, u32)>, Vec<Touch>);

/// All crossing pairs, the lower triangle first, sorted.
pub fn pairs(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    job: &Job,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    if triangles.len() < 2 {
        return Ok(Vec::new());
    }
    // In a turned frame places are off by rounding: the boxes are larger by more than that.
    let (turn, room) = match tight_frame(positions, triangles) {
        Some(turn) => {
            let reach = positions.iter().fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
            (turn, reach * 1e-14)
        }
        None => (DMat3::IDENTITY, 0.0),
    };
    let boxes: Vec<Aabb> = triangles
        .par_iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let [a, b, c] = if room > 0.0 { [turn * a, turn * b, turn * c] } else { [a, b, c] };
            let (lo, hi) = (a.min(b).min(c) - room, a.max(b).max(c) + room);
            // Outwards, so that rounding to single precision loses no contact.
            let down = Vec3::from(lo.to_array().map(|v| (v as f32).next_down()));
            let up = Vec3::from(hi.to_array().map(|v| (v as f32).next_up()));
            Aabb::new(down.into(), up.into())
        })
        .collect();
    job.check()?;
    let tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Low,
        &boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        0,
    );
    job.check()?;
    job.progress(0.6);
    // In the tree's order neighbours in the list are neighbours in space: the walk stays in the
    // cache.
    let found: Result<Vec<Found>, Cancelled> = tree
        .primitive_indices
        .par_chunks(1024)
        .map(|block| {
            job.check()?;
            let (mut out, mut touches) = (Vec::new(), Vec::new());
            let mut stack: Vec<u32> = Vec::with_capacity(128);
            for &t in block {
                let own = &boxes[t as usize];
                stack.push(0);
                while let Some(n) = stack.pop() {
                    let node = &tree.nodes[n as usize];
                    if !node.aabb().intersect_aabb(own) {
                        continue;
                    }
                    if !node.is_leaf() {
                        stack.extend([node.first_index, node.first_index + 1]);
                        continue;
                    }
                    let first = node.first_index as usize;
                    for &u in &tree.primitive_indices[first..first + node.prim_count as usize] {
                        if u <= t || !boxes[u as usize].intersect_aabb(own) {
                            continue;
                        }
                        // Triangles at one edge are compared in their order around it, below.
                        let (own, other) = (triangles[t as usize], triangles[u as usize]);
                        if own.iter().filter(|v| other.contains(v)).count() == 2 {
                            continue;
                        }
                        match triangles_meet(
                            positions,
                            triangles[t as usize],
                            triangles[u as usize],
                        ) {
                            Meet::No => {}
                            Meet::Cross => out.push((t, u)),
                            found => touches.extend(touch(positions, triangles, t, u, found)),
                        }
                    }
                }
            }
            Ok((out, touches))
        })
        .collect();
    let (mut crossed, mut touches) = (Vec::new(), Vec::new());
    for (c, t) in found? {
        crossed.extend(c);
        touches.extend(t);
    }
    through(positions, triangles, touches, &mut crossed);
    along_shared_edges(positions, triangles, &mut crossed);
    crossed.sort_unstable();
    crossed.dedup();
    Ok(crossed)
}

/// Pairs of triangles that share an edge cross only where they lie in one plane, on the same side
/// of the edge. The triangles at each edge are sorted by their direction around it, so that
/// thousands at one edge are not compared each with each.
fn along_shared_edges(positions: &[DVec3], triangles: &[[u32; 3]], out: &mut Vec<(u32, u32)>) {
    // (lower vertex, upper vertex, triangle)
    let mut uses: Vec<(u32, u32, u32)> = triangles
        .iter()
        .enumerate()
        .filter(|(_, t)| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
        .flat_map(|(i, t)| {
            [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a.min(b), a.max(b), i as u32))
        })
        .collect();
    uses.par_sort_unstable();
    let p = |v: u32| positions[v as usize];
    for edge in uses.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).filter(|e| e.len() > 1) {
        let (a, b) = (edge[0].0, edge[0].1);
        let third = |t: u32| triangles[t as usize].into_iter().find(|v| *v != a && *v != b);
        let mut fan: Vec<(u32, DVec3)> =
            edge.iter().filter_map(|e| Some((e.2, p(third(e.2)?)))).collect();
        // Three points on a line are no triangle, and tell no direction.
        fan.retain(|&(_, q)| !on_a_line(p(a), p(b), q));
        if fan.is_empty() {
            continue;
        }
        let meets = |x: DVec3, y: DVec3| {
            side(p(a), p(b), x, y) == 0.0 && overlap([p(a), p(b), x], [p(a), p(b), y])
        };
        if let &[x, y] = &fan[..] {
            if meets(x.1, y.1) {
                out.push((x.0.min(y.0), x.0.max(y.0)));
            }
            continue;
        }
        // Around the edge from the first one's direction on: first the half turn on one side of its
        // plane, its own direction before all, the opposite one between.
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
        let mut turned: Vec<(i32, u32, DVec3)> =
            fan.drain(..).map(|(t, q)| (half(q), t, q)).collect();
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
}

/// Whether three points lie on one line, exactly.
fn on_a_line(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| {
        let flat = |p: DVec3| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
        orient2d(flat(a), flat(b), flat(c)) == 0.0
    })
}

/// Counts the pairs of [`pairs`].
pub fn count(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    job: &Job,
) -> Result<Crossings, Cancelled> {
    let found = pairs(positions, triangles, job)?;
    let mut crossed: Vec<u32> = found.iter().flat_map(|&(a, b)| [a, b]).collect();
    crossed.sort_unstable();
    crossed.dedup();
    Ok(Crossings { pairs: found.len(), triangles: crossed.len() })
}

/// Whether the insides of two triangles have a line or an area in common, beyond the corners that
/// they share.
pub fn crosses(positions: &[DVec3], s: [u32; 3], t: [u32; 3]) -> bool {
    triangles_meet(positions, s, t) != Meet::No
}

fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let at = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(at(a), at(b), at(c), at(d))
}

/// How two triangles meet where that may be a crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Meet {
    No,
    /// Their insides have a line or an area in common.
    Cross,
    /// An edge (by its number) of the second, or of the first, runs through the other's inside. A
    /// crossing, if the surface goes on at the other side.
    Along(Which, usize),
    /// Edge of the first, edge of the second: parts of one line. A crossing, if the surfaces change
    /// sides there.
    Edges(usize, usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Which {
    First,
    Second,
}

/// On which side of a plane a point is, as [`side`] says it; None where rounding may hide it
/// (Shewchuk's first filter).
fn rounded_side([a, b, c]: [DVec3; 3], p: DVec3) -> Option<f64> {
    let (a, b, c) = (a - p, b - p, c - p);
    let (xy, yz, zx) = ((b.x * c.y, c.x * b.y), (c.x * a.y, a.x * c.y), (a.x * b.y, b.x * a.y));
    let det = a.z * (xy.0 - xy.1) + b.z * (yz.0 - yz.1) + c.z * (zx.0 - zx.1);
    let size = a.z.abs() * (xy.0.abs() + xy.1.abs())
        + b.z.abs() * (yz.0.abs() + yz.1.abs())
        + c.z.abs() * (zx.0.abs() + zx.1.abs());
    (det.abs() > 1e-15 * size).then_some(det)
}

/// Whether an edge of the first triangle parts it from the second, seen along the first's normal,
/// by more than rounding: corners that both have may lie on the edge.
fn beside(ps: [DVec3; 3], pt: [DVec3; 3], s: [u32; 3], t: [u32; 3]) -> bool {
    let n = (ps[1] - ps[0]).cross(ps[2] - ps[0]);
    let reach = ps.iter().chain(&pt).fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    (0..3).any(|k| {
        let j = (k + 1) % 3;
        let out = (ps[j] - ps[k]).cross(n);
        // The triangle's own third corner is on the other side by more than rounding too.
        let far = 1e-13 * reach * out.length();
        far > 0.0
            && (ps[(k + 2) % 3] - ps[k]).dot(out) < -far
            && (0..3).all(|i| t[i] == s[k] || t[i] == s[j] || (pt[i] - ps[k]).dot(out) > far)
    })
}

/// How two triangles meet beyond what they share.
fn triangles_meet(positions: &[DVec3], s: [u32; 3], t: [u32; 3]) -> Meet {
    let p = |v: u32| positions[v as usize];
    let shared = s.iter().filter(|v| t.contains(v)).count();
    let (ps, pt) = (s.map(p), t.map(p));
    // A common vertex is in both planes: known without arithmetic.
    let sides = |plane: [u32; 3], at: [DVec3; 3], of: [u32; 3], near: [Option<f64>; 3]| {
        [0, 1, 2].map(|i| match near[i] {
            Some(side) => side,
            None if plane.contains(&of[i]) => 0.0,
            None => side(at[0], at[1], at[2], p(of[i])),
        })
    };
    let rounded = |plane: [u32; 3], at: [DVec3; 3], of: [u32; 3]| {
        of.map(|v| if plane.contains(&v) { None } else { rounded_side(at, p(v)) })
    };
    let near = rounded(s, ps, t);
    // Triangles beside each other in one plane need exact signs, and are told apart without.
    let unsure = (0..3).any(|i| near[i].is_none() && !s.contains(&t[i]));
    if unsure && (beside(ps, pt, s, t) || beside(pt, ps, t, s)) {
        return Meet::No;
    }
    let of_t = sides(s, ps, t, near);
    let zeros = |d: &[f64; 3]| d.iter().filter(|&&v| v == 0.0).count();
    if zeros(&of_t) == 3 {
        return if overlap(ps, pt) { Meet::Cross } else { Meet::No };
    }
    if shared >= 2 {
        return Meet::No;
    }
    let astride = |d: &[f64; 3]| d.iter().any(|&v| v > 0.0) && d.iter().any(|&v| v < 0.0);
    if !astride(&of_t) && zeros(&of_t) < 2 {
        return Meet::No;
    }
    let of_s = sides(t, pt, s, rounded(t, pt, s));
    match (astride(&of_s), astride(&of_t)) {
        (true, true) if lines_overlap(ps, of_s, pt, of_t) => Meet::Cross,
        (true, false) => edge_on(&of_t)
            .filter(|&k| runs_through(pt[k], pt[(k + 1) % 3], ps))
            .map_or(Meet::No, |k| Meet::Along(Which::Second, k)),
        (false, true) => edge_on(&of_s)
            .filter(|&k| runs_through(ps[k], ps[(k + 1) % 3], pt))
            .map_or(Meet::No, |k| Meet::Along(Which::First, k)),
        (false, false) => match (edge_on(&of_s), edge_on(&of_t)) {
            (Some(i), Some(j))
                if along_each_other([ps[i], ps[(i + 1) % 3]], [pt[j], pt[(j + 1) % 3]]) =>
            {
                Meet::Edges(i, j)
            }
            _ => Meet::No,
        },
        _ => Meet::No,
    }
}

/// The edge whose ends lie in the plane, given the corners' sides of it.
fn edge_on(d: &[f64; 3]) -> Option<usize> {
    (0..3).find(|&k| d[k] == 0.0 && d[(k + 1) % 3] == 0.0)
}

/// Whether the lines in which two triangles cut each other's plane have more than a point in
/// common; each is astride the other's plane. After Guigue and Devillers, *Fast and robust
/// triangle-triangle overlap test using orientation predicates* (2003).
fn lines_overlap(ps: [DVec3; 3], of_s: [f64; 3], pt: [DVec3; 3], of_t: [f64; 3]) -> bool {
    // Turned so that the first corner is alone on its side, the others on the other side or on the
    // plane; then the second and the third change places where the other's plane looks away.
    let alone = |d: [f64; 3]| {
        (0..3)
            .find(|&k| {
                let others = [d[(k + 1) % 3], d[(k + 2) % 3]];
                d[k] > 0.0 && others.iter().all(|&v| v <= 0.0)
                    || d[k] < 0.0 && others.iter().all(|&v| v >= 0.0)
            })
            .unwrap_or(0)
    };
    let turned = |p: [DVec3; 3], k: usize| [p[k], p[(k + 1) % 3], p[(k + 2) % 3]];
    let (i, j) = (alone(of_s), alone(of_t));
    let (mut a, mut b) = (turned(ps, i), turned(pt, j));
    if of_s[i] < 0.0 {
        b.swap(1, 2);
    }
    if of_t[j] < 0.0 {
        a.swap(1, 2);
    }
    side(a[0], a[1], b[0], b[1]) < 0.0 && side(a[0], a[2], b[2], b[0]) < 0.0
}

/// Whether a piece of a line in the triangle's plane runs through the triangle's inside.
fn runs_through(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let flat = flatten([t, t]);
    let (a, p, q) = (t.map(&flat), flat(p), flat(q));
    let turn = orient2d(a[0], a[1], a[2]);
    let beside =
        |k: usize| [p, q].iter().all(|&x| orient2d(a[k], a[(k + 1) % 3], x) * turn.signum() <= 0.0);
    let of = a.map(|x| orient2d(p, q, x));
    turn != 0.0 && of.iter().any(|&v| v > 0.0) && of.iter().any(|&v| v < 0.0) && !(0..3).any(beside)
}

/// Whether two pieces of one line have a length in common.
fn along_each_other(e: [DVec3; 2], f: [DVec3; 2]) -> bool {
    let d = (e[1] - e[0]).abs();
    let axis = if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    };
    let range = |e: [DVec3; 2]| (e[0][axis].min(e[1][axis]), e[0][axis].max(e[1][axis]));
    let ((a, b), (c, d)) = (range(e), range(f));
    a.max(c) < b.min(d)
}

/// What one triangle has to say of a place where an edge lies on another surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Touch {
    /// Edge; the triangle that it runs through; a triangle at the edge, and whether it is above.
    Along([u32; 2], u32, u32, bool),
    /// Edge and edge on one line, the lesser first; a triangle at each.
    Edges([u32; 2], [u32; 2], u32, u32),
}

fn touch(
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
/// side.
fn through(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    mut touches: Vec<Touch>,
    out: &mut Vec<(u32, u32)>,
) {
    touches.sort_unstable();
    let same = |a: &Touch, b: &Touch| match (a, b) {
        (Touch::Along(e, t, ..), Touch::Along(f, u, ..)) => (e, t) == (f, u),
        (Touch::Edges(e, f, ..), Touch::Edges(g, h, ..)) => (e, f) == (g, h),
        _ => false,
    };
    let ordered = |a: u32, b: u32| (a.min(b), a.max(b));
    for group in touches.chunk_by(same) {
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

/// Drops the axis along which the larger of two triangles has the longest normal.
fn flatten([s, t]: [[DVec3; 3]; 2]) -> impl Fn(DVec3) -> Coord<f64> {
    let n = ((s[1] - s[0]).cross(s[2] - s[0])).abs();
    let m = ((t[1] - t[0]).cross(t[2] - t[0])).abs();
    let n = n.max(m);
    move |p: DVec3| {
        if n.x >= n.y && n.x >= n.z {
            Coord { x: p.y, y: p.z }
        } else if n.y >= n.z {
            Coord { x: p.z, y: p.x }
        } else {
            Coord { x: p.x, y: p.y }
        }
    }
}

/// Whether two triangles in one plane have an area in common: no edge's line has one on either
/// side.
fn overlap(ps: [DVec3; 3], pt: [DVec3; 3]) -> bool {
    let flat = flatten([ps, pt]);
    let (a, b) = (ps.map(&flat), pt.map(&flat));
    let apart = |a: &[Coord<f64>; 3], b: &[Coord<f64>; 3]| {
        let turn = orient2d(a[0], a[1], a[2]);
        turn == 0.0
            || (0..3).any(|i| {
                let j = (i + 1) % 3;
                b.iter().all(|&q| orient2d(a[i], a[j], q) * turn.signum() <= 0.0)
            })
    };
    !apart(&a, &b) && !apart(&b, &a)
}

#[cfg(test)]
#[path = "self_intersection_tests.rs"]
mod tests;
