//! A triangle cut by segments: the cells of the plane graph, each with its holes. Angles are
//! compared exactly.

use std::cmp::Ordering;

use glam::DVec3;
use robust::{Coord, orient2d};

use super::points::Map;
use crate::disjoint_sets::DisjointSets;

/// A cell: counter-clockwise border, clockwise holes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanarCell {
    /// The border, counter-clockwise.
    pub outer: Vec<u32>,
    /// Clockwise.
    pub holes: Vec<Vec<u32>>,
}

/// Drops the axis along which the normal is longest, so that what is counter-clockwise stays so.
pub fn flatten(n: DVec3) -> impl Fn(DVec3) -> Coord<f64> + Copy {
    let a = n.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    let flip = n[axis] < 0.0;
    move |p: DVec3| {
        let (x, y) = match axis {
            0 => (p.y, p.z),
            1 => (p.z, p.x),
            _ => (p.x, p.y),
        };
        if flip { Coord { x: y, y: x } } else { Coord { x, y } }
    }
}

/// With fewer edges, names and edges are looked for one by one.
const FEW: usize = 48;

/// Cells of the polygon `ring` (counter-clockwise) cut by `segments`; both over global points
/// placed by `at`. Segments that separate nothing are left out.
pub fn cells(
    ring: &[u32],
    segments: &[(u32, u32)],
    at: impl Fn(u32) -> Coord<f64>,
) -> Vec<PlanarCell> {
    let few = ring.len() + segments.len() <= FEW;
    let mut ids: Map<u32, usize> = Map::default();
    let mut names: Vec<u32> = Vec::with_capacity(ring.len() + segments.len());
    let mut id = |v: u32| {
        let next = names.len();
        let known = match few {
            true => names.iter().position(|&w| w == v).unwrap_or(next),
            false => *ids.entry(v).or_insert(next),
        };
        if known == next {
            names.push(v);
        }
        known
    };
    let mut edges: Vec<(usize, usize)> = Vec::with_capacity(ring.len() + segments.len());
    for (i, &v) in ring.iter().enumerate() {
        edges.push((id(v), id(ring[(i + 1) % ring.len()])));
    }
    let border = edges.len();
    let mut known: Map<(usize, usize), ()> = Map::default();
    if !few {
        known.extend(edges.iter().map(|&(a, b)| ((a.min(b), a.max(b)), ())));
    }
    for &(p, q) in segments {
        let (a, b) = (id(p), id(q));
        let mut is_new = || match few {
            true => !edges.contains(&(a, b)) && !edges.contains(&(b, a)),
            false => known.insert((a.min(b), a.max(b)), ()).is_none(),
        };
        if a != b && is_new() {
            edges.push((a, b));
        }
    }
    let spots: Vec<Coord<f64>> = names.iter().map(|&v| at(v)).collect();
    let mut alive = vec![true; edges.len()];
    loop {
        let loops = trace(&edges, &alive, &spots);
        let mut of = vec![usize::MAX; edges.len() * 2];
        for (l, hs) in loops.iter().enumerate() {
            hs.iter().for_each(|&h| of[h] = l);
        }
        let mut again = false;
        for e in border..edges.len() {
            if alive[e] && of[2 * e] == of[2 * e + 1] {
                alive[e] = false;
                again = true;
            }
        }
        if !again {
            return assemble(&edges, &loops, &of, &spots, &names, border);
        }
    }
}

/// Half-edge `2 e` runs as edge `e` does, `2 e + 1` against it. Each loop has its cell on the left.
fn trace(edges: &[(usize, usize)], alive: &[bool], spots: &[Coord<f64>]) -> Vec<Vec<usize>> {
    let tail = |h: usize| if h % 2 == 0 { edges[h / 2].0 } else { edges[h / 2].1 };
    // The half-edges from each spot, one spot after the other.
    let mut starts = vec![0usize; spots.len() + 1];
    for e in (0..edges.len()).filter(|&e| alive[e]) {
        starts[edges[e].0 + 1] += 1;
        starts[edges[e].1 + 1] += 1;
    }
    for v in 0..spots.len() {
        starts[v + 1] += starts[v];
    }
    let (mut free, mut out) = (starts.clone(), vec![0usize; starts[spots.len()]]);
    for h in (0..edges.len() * 2).filter(|&h| alive[h / 2]) {
        out[free[tail(h)]] = h;
        free[tail(h)] += 1;
    }
    let mut place = vec![0usize; edges.len() * 2];
    for v in 0..spots.len() {
        let hs = &mut out[starts[v]..starts[v + 1]];
        if hs.len() > 1 {
            hs.sort_unstable_by(|&g, &h| {
                angle(spots[v], spots[tail(g ^ 1)], spots[tail(h ^ 1)]).then(g.cmp(&h))
            });
        }
        hs.iter().enumerate().for_each(|(i, &h)| place[h] = i);
    }
    let mut seen = vec![false; edges.len() * 2];
    let mut loops = Vec::new();
    for start in 0..edges.len() * 2 {
        if seen[start] || !alive[start / 2] {
            continue;
        }
        let (mut one, mut h) = (Vec::new(), start);
        while !seen[h] {
            seen[h] = true;
            one.push(h);
            // At the head: the next one clockwise from the way back.
            let around = &out[starts[tail(h ^ 1)]..starts[tail(h ^ 1) + 1]];
            let i = place[h ^ 1];
            h = around[(i + around.len() - 1) % around.len()];
        }
        loops.push(one);
    }
    loops
}

/// Order of two directions around `o`, from the positive x axis on counter-clockwise.
fn angle(o: Coord<f64>, p: Coord<f64>, q: Coord<f64>) -> Ordering {
    let upper = |p: Coord<f64>| p.y > o.y || (p.y == o.y && p.x > o.x);
    upper(q).cmp(&upper(p)).then_with(|| 0.0f64.total_cmp(&orient2d(o, p, q)))
}

fn assemble(
    edges: &[(usize, usize)],
    loops: &[Vec<usize>],
    of: &[usize],
    spots: &[Coord<f64>],
    names: &[u32],
    border: usize,
) -> Vec<PlanarCell> {
    let tail = |h: usize| if h % 2 == 0 { edges[h / 2].0 } else { edges[h / 2].1 };
    let area = |l: &[usize]| {
        let o = spots[tail(l[0])];
        l.iter()
            .map(|&h| (spots[tail(h)], spots[tail(h ^ 1)]))
            .map(|(p, q)| (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x))
            .sum::<f64>()
    };
    let outside = of[1];
    // Connected parts, so that a hole is looked for only in other parts.
    let mut parts = DisjointSets::new(spots.len());
    for (e, &(a, b)) in edges.iter().enumerate() {
        if of[2 * e] != usize::MAX {
            parts.join(a as u32, b as u32);
        }
    }
    let main = parts.root(edges[0].0 as u32);
    let name = |l: &[usize]| l.iter().map(|&h| names[tail(h)]).collect::<Vec<u32>>();
    let mut out: Vec<(PlanarCell, f64, usize, u32)> = Vec::new();
    let mut holes = Vec::new();
    for (i, l) in loops.iter().enumerate() {
        if i == outside {
            continue;
        }
        let a = area(l);
        let part = parts.root(tail(l[0]) as u32);
        if a > 0.0 || part == main {
            out.push((PlanarCell { outer: name(l), holes: Vec::new() }, a, i, part));
        } else {
            holes.push((l, part));
        }
    }
    debug_assert!(border >= 3);
    for (l, part) in holes {
        let p = spots[tail(l[0])];
        let inside = |i: usize| {
            let mut odd = false;
            for &h in &loops[i] {
                let (a, b) = (spots[tail(h)], spots[tail(h ^ 1)]);
                if (a.y > p.y) != (b.y > p.y) {
                    let side = orient2d(a, b, p);
                    odd ^= if b.y > a.y { side > 0.0 } else { side < 0.0 };
                }
            }
            odd
        };
        let best = out
            .iter_mut()
            .filter(|c| c.3 != part && inside(c.2))
            .min_by(|x, y| x.1.total_cmp(&y.1));
        if let Some(c) = best {
            c.0.holes.push(name(l));
        }
    }
    out.into_iter().map(|c| c.0).collect()
}

/// The triangles of a polygon with holes, as few thin ones as can be (constrained Delaunay, Chew
/// 1989). None where rounding makes the loops cross or touch.
pub fn delaunay(loops: &[&[u32]], n: DVec3, at: &[DVec3]) -> Option<Vec<[u32; 3]>> {
    use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
    let flat = flatten(n);
    let mut cdt: ConstrainedDelaunayTriangulation<Point2<f64>> =
        ConstrainedDelaunayTriangulation::new();
    let mut names: Vec<u32> = Vec::new();
    let mut rings = Vec::new();
    for l in loops {
        let mut ring = Vec::with_capacity(l.len());
        for &v in *l {
            let c = flat(at[v as usize]);
            let h = cdt.insert(Point2::new(c.x, c.y)).ok()?;
            if h.index() == names.len() {
                names.push(v);
            } else if names[h.index()] != v {
                return None;
            }
            ring.push(h);
        }
        rings.push(ring);
    }
    for ring in &rings {
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if !cdt.can_add_constraint(a, b) {
                return None;
            }
            cdt.add_constraint(a, b);
        }
    }
    // Each edge of a loop parts inside from outside, from the outer face on.
    let mut parts = vec![false; cdt.num_undirected_edges()];
    for ring in &rings {
        for i in 0..ring.len() {
            let edge = cdt.get_edge_from_neighbors(ring[i], ring[(i + 1) % ring.len()])?;
            let part = &mut parts[edge.as_undirected().fix().index()];
            *part = !*part;
        }
    }
    let mut inside: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    let outer = cdt.outer_face().fix();
    inside[outer.index()] = Some(false);
    let mut todo: Vec<_> = cdt.convex_hull().flat_map(|e| [e, e.rev()]).collect();
    todo.retain(|e| e.face().fix() == outer);
    while let Some(edge) = todo.pop() {
        let (from, to) = (edge.face().fix().index(), edge.rev().face());
        if inside[to.fix().index()].is_none() {
            let part = parts[edge.as_undirected().fix().index()];
            inside[to.fix().index()] = Some(inside[from]? != part);
            todo.extend(to.as_inner()?.adjacent_edges());
        }
    }
    let mut out = Vec::new();
    for face in cdt.inner_faces() {
        if inside[face.fix().index()] == Some(true) {
            out.push(face.vertices().map(|v| names[v.index()]));
        }
    }
    // Corners, one border and holes: what a triangulation must count.
    let corners: usize = loops.iter().map(|l| l.len()).sum();
    (out.len() == corners + 2 * (loops.len() - 1) - 2).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_with_a_cut_a_hole_and_a_loose_end() {
        let spots = [
            (0., 0.),
            (4., 0.),
            (4., 4.),
            (0., 4.), // ring
            (2., 0.),
            (2., 4.), // the cut
            (0.5, 0.5),
            (1.5, 0.5),
            (1., 1.), // a hole in the left half
            (3., 3.), // a loose end
        ];
        let at = |i: u32| Coord { x: spots[i as usize].0, y: spots[i as usize].1 };
        let c = cells(&[0, 4, 1, 2, 5, 3], &[(4, 5), (6, 7), (7, 8), (8, 6), (2, 9)], at);
        assert_eq!(c.len(), 3);
        let mut shape: Vec<(usize, usize)> =
            c.iter().map(|c| (c.outer.len(), c.holes.len())).collect();
        shape.sort_unstable();
        assert_eq!(shape, [(3, 0), (4, 0), (4, 1)]);
    }
}
