//! The faces of both operands, whole where nothing cuts them, in cells where something does; and where each piece lies.

use glam::DVec3;
use robust::orient3d;

use super::meet::{Meeting, Side, c3};
use super::planar::{Cell, cells, flatten};
use super::points::{Map, Points, Sets};
use crate::analysis::cancel::{Cancelled, Job};
use crate::mesh::PolyMesh;
use crate::mesh::triangulate::area_vector;

/// Where a piece lies as seen from the other operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    Inside,
    Outside,
    /// On its surface, facing the same way.
    Same,
    /// On its surface, facing the other way.
    Against,
}

#[derive(Debug, Clone)]
pub struct Piece {
    pub face: u32,
    pub shape: Shape,
    pub place: Place,
}

#[derive(Debug, Clone)]
pub enum Shape {
    /// The face as it came.
    Whole,
    /// The face, with more corners on its border.
    Border(Vec<u32>),
    Cell(Cell),
}

impl Piece {
    /// All loops, whichever the shape.
    pub fn loops<'a>(&'a self, face: impl FnOnce(u32) -> &'a [u32]) -> Vec<&'a [u32]> {
        match &self.shape {
            Shape::Whole => vec![face(self.face)],
            Shape::Border(b) => vec![b],
            Shape::Cell(c) => std::iter::once(&c.outer).chain(&c.holes).map(Vec::as_slice).collect(),
        }
    }
}

/// Cuts one operand. `mesh` has its corners over the common points; `starts[f]` is the first triangle of face `f`.
pub fn cut(
    mesh: &PolyMesh,
    side: usize,
    s: &Side,
    starts: &[u32],
    m: &Meeting,
    points: &[DVec3],
    flat: impl Fn(usize) -> bool,
    job: &Job,
) -> Result<Vec<Piece>, Cancelled> {
    let mut out = Vec::with_capacity(mesh.face_count());
    let marks = &m.marks[side];
    for f in 0..mesh.face_count() {
        if f % 4096 == 0 {
            job.check()?;
        }
        let mut push = |shape| out.push(Piece { face: f as u32, shape, place: Place::Outside });
        let range = starts[f]..starts[f + 1];
        if range.is_empty() {
            continue;
        }
        if !range.clone().any(|t| marks.contains_key(&t)) {
            push(Shape::Whole);
            continue;
        }
        let split = range.clone().any(|t| marks.get(&t).is_some_and(|k| k.flat || !k.segments.is_empty()))
            || (range.len() > 1
                && along_diagonal(mesh.face(f), &s.triangles[range.start as usize..range.end as usize], m));
        if !split {
            let border = ring(mesh.face(f), m);
            if border.len() == mesh.face(f).len() {
                push(Shape::Whole);
                continue;
            }
            if flat(f) {
                push(Shape::Border(border));
                continue;
            }
        }
        for t in range {
            let tri = s.triangles[t as usize];
            let ring = ring(&tri, m);
            let none = Vec::new();
            let segments = marks.get(&t).map_or(&none, |k| &k.segments);
            if segments.is_empty() {
                push(Shape::Cell(Cell { outer: ring, holes: Vec::new() }));
                continue;
            }
            let [a, b, c] = tri.map(|i| points[i as usize]);
            let flat = flatten((b - a).cross(c - a));
            for cell in cells(&ring, segments, |i| flat(points[i as usize])) {
                push(Shape::Cell(cell));
            }
        }
    }
    Ok(out)
}

/// Whether the cut runs along a diagonal by which the face came in triangles.
fn along_diagonal(corners: &[u32], triangles: &[[u32; 3]], m: &Meeting) -> bool {
    let side = |a: u32, b: u32| {
        (0..corners.len()).any(|i| {
            let (p, q) = (corners[i], corners[(i + 1) % corners.len()]);
            (p, q) == (a, b) || (q, p) == (a, b)
        })
    };
    triangles.iter().any(|t| {
        (0..3).any(|k| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            !side(a, b) && {
                let line = ring(&[a, b], m);
                // There and back: the second half repeats the first.
                line.windows(2).any(|w| m.curve.contains_key(&(w[0].min(w[1]), w[0].max(w[1]))))
            }
        })
    })
}

/// A loop with the points that the meeting found on its edges.
fn ring(corners: &[u32], m: &Meeting) -> Vec<u32> {
    let mut out = Vec::with_capacity(corners.len() + 2);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        out.push(a);
        if let Some(e) = m.edge_of(a, b) {
            let e = &m.edges[e as usize];
            if e.ends[0] == a {
                out.extend(&e.inner);
            } else {
                out.extend(e.inner.iter().rev());
            }
        }
    }
    out
}

/// One name for a piece's borders, whichever way they run, and whether it was turned.
fn key(loops: &[&[u32]], reverse: bool) -> Vec<u32> {
    let mut rings: Vec<Vec<u32>> = loops
        .iter()
        .map(|l| {
            let mut v = l.to_vec();
            if reverse {
                v.reverse();
            }
            let least = (0..v.len()).min_by_key(|&i| v[i]).unwrap_or(0);
            v.rotate_left(least);
            v
        })
        .collect();
    rings.sort();
    rings.join(&u32::MAX)
}

/// Decides the place of every piece: pieces in contact by their borders, all others by one ray for each part of the
/// surface that the cut leaves connected.
pub fn place(
    meshes: &[PolyMesh; 2],
    sides: &[Side; 2],
    pieces: &mut [Vec<Piece>; 2],
    m: &Meeting,
    points: &Points,
    around: Option<super::arrange::Around<'_>>,
    job: &Job,
) -> Result<(), Cancelled> {
    let at = &points.at;
    let shared = |p: u32| m.shared.contains_key(&p);
    let mut contact: Map<Vec<u32>, usize> = Map::default();
    let mut borders: [Map<(u32, u32), Vec<u32>>; 2] = Default::default();
    for s in 0..2 {
        for (i, p) in pieces[s].iter().enumerate() {
            if i % 4096 == 0 {
                job.check()?;
            }
            let loops = p.loops(|f| meshes[s].face(f as usize));
            for l in &loops {
                for k in 0..l.len() {
                    let (a, b) = (l[k], l[(k + 1) % l.len()]);
                    if shared(a) && shared(b) {
                        borders[s].entry((a.min(b), a.max(b))).or_default().push(i as u32);
                    }
                }
            }
            if s == 0 && loops.iter().all(|l| l.iter().all(|&v| shared(v))) {
                contact.insert(key(&loops, false), i);
            }
        }
    }
    let mut settled = [vec![false; pieces[0].len()], vec![false; pieces[1].len()]];
    for i in 0..pieces[1].len() {
        let loops = pieces[1][i].loops(|f| meshes[1].face(f as usize));
        if !loops.iter().all(|l| l.iter().all(|&v| shared(v))) {
            continue;
        }
        for (reverse, place) in [(false, Place::Same), (true, Place::Against)] {
            if let Some(&j) = contact.get(&key(&loops, reverse)) {
                pieces[1][i].place = place;
                pieces[0][j].place = place;
                settled[0][j] = true;
                settled[1][i] = true;
                break;
            }
        }
    }
    for s in 0..2 {
        job.check()?;
        let count = pieces[s].len();
        let mut sets = Sets::new(count + at.len());
        for (i, p) in pieces[s].iter().enumerate().filter(|&(i, _)| !settled[s][i]) {
            if i % 4096 == 0 {
                job.check()?;
            }
            for l in p.loops(|f| meshes[s].face(f as usize)) {
                for &v in l.iter().filter(|&&v| !shared(v)) {
                    sets.join(i as u32, count as u32 + v);
                }
            }
        }
        for (edge, around) in &borders[s] {
            if !m.curve.contains_key(edge) {
                let free: Vec<u32> = around.iter().copied().filter(|&i| !settled[s][i as usize]).collect();
                free.windows(2).for_each(|w| sets.join(w[0], w[1]));
            }
        }
        job.check()?;
        // The largest triangle of each part asks for all.
        let mut largest: Map<u32, (f64, DVec3)> = Map::default();
        for (i, p) in pieces[s].iter().enumerate().filter(|&(i, _)| !settled[s][i]) {
            let root = sets.root(i as u32);
            let loops = p.loops(|f| meshes[s].face(f as usize));
            let (size, spot) = probe(&loops, at);
            let best = largest.entry(root).or_insert((-1.0, spot));
            if size > best.0 {
                *best = (size, spot);
            }
        }
        let mut answers: Map<u32, Place> = Map::default();
        for i in (0..count).filter(|&i| !settled[s][i]) {
            let root = sets.root(i as u32);
            let place = match answers.get(&root) {
                Some(&p) => p,
                None => {
                    job.check()?;
                    let spot = largest[&root].1;
                    let w = match around {
                        Some(around) if s == 1 => around(spot),
                        _ => winding(&sides[1 - s], at, spot),
                    };
                    let p = if w > 0 { Place::Inside } else { Place::Outside };
                    answers.insert(root, p);
                    p
                }
            };
            pieces[s][i].place = place;
        }
    }
    Ok(())
}

/// A place in a triangle that nobody draws an edge through: an edge of the other surface may lie in this one.
fn within(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    a * 0.414_213_562_373_095 + b * 0.267_949_192_431_123 + c * 0.317_837_245_195_782
}

/// A point inside the piece and how much room there is.
fn probe(loops: &[&[u32]], at: &[DVec3]) -> (f64, DVec3) {
    let l = loops[0];
    if l.len() == 3 && loops.len() == 1 {
        let [a, b, c] = [l[0], l[1], l[2]].map(|i| at[i as usize]);
        return ((b - a).cross(c - a).length(), within(a, b, c));
    }
    let n: DVec3 = loops.iter().map(|l| area_vector(at, l)).sum();
    let mut best = (-1.0, at[l[0] as usize]);
    for t in triangles(loops, n, at) {
        let [a, b, c] = t.map(|i| at[i as usize]);
        let size = (b - a).cross(c - a).length();
        if size > best.0 {
            best = (size, within(a, b, c));
        }
    }
    best
}

/// The triangles of a polygon with holes.
pub fn triangles(loops: &[&[u32]], n: DVec3, at: &[DVec3]) -> Vec<[u32; 3]> {
    let mut out = Vec::new();
    if loops.len() == 1 {
        crate::mesh::triangulate::face(at, loops[0], &mut out);
    } else if let Some(made) = super::planar::delaunay(loops, n, at) {
        out = made;
    } else {
        crate::mesh::triangulate::face(at, &bridged(loops, n, at), &mut out);
    }
    out
}

/// Holes joined to the border by the shortest bridges that cross nothing: one loop that runs along each bridge twice.
fn bridged(loops: &[&[u32]], n: DVec3, at: &[DVec3]) -> Vec<u32> {
    let flat = flatten(n);
    let spot = |v: u32| flat(at[v as usize]);
    let mut ring = loops[0].to_vec();
    let mut left: Vec<&[u32]> = loops[1..].to_vec();
    while !left.is_empty() {
        let mut ways: Vec<(f64, usize, usize, usize)> = Vec::new();
        for (h, hole) in left.iter().enumerate() {
            for (i, &p) in ring.iter().enumerate() {
                for (j, &q) in hole.iter().enumerate() {
                    ways.push((at[p as usize].distance_squared(at[q as usize]), i, h, j));
                }
            }
        }
        ways.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2, a.3).cmp(&(b.1, b.2, b.3))));
        let crosses = |p: u32, q: u32| {
            std::iter::once(&ring[..]).chain(left.iter().copied()).any(|l| {
                (0..l.len()).any(|k| {
                    let (a, b) = (l[k], l[(k + 1) % l.len()]);
                    if [a, b].contains(&p) || [a, b].contains(&q) {
                        return false;
                    }
                    let turn = |x: u32, y: u32, z: u32| robust::orient2d(spot(x), spot(y), spot(z));
                    turn(p, q, a) * turn(p, q, b) <= 0.0 && turn(a, b, p) * turn(a, b, q) <= 0.0
                })
            })
        };
        // Where a ring's corner comes twice, the bridge must start in the right one of its angles.
        let opens = |i: usize, q: u32| {
            let len = ring.len();
            let (p, v, x) = (spot(ring[(i + len - 1) % len]), spot(ring[i]), spot(ring[(i + 1) % len]));
            let turn = robust::orient2d(p, v, x);
            let (l, r) = (robust::orient2d(p, v, spot(q)), robust::orient2d(v, x, spot(q)));
            if turn > 0.0 { l > 0.0 && r > 0.0 } else { l > 0.0 || r > 0.0 }
        };
        let way = ways.iter().find(|w| opens(w.1, left[w.2][w.3]) && !crosses(ring[w.1], left[w.2][w.3]));
        let &(_, i, h, j) = way.unwrap_or(&ways[0]);
        let hole = left.remove(h);
        let mut next = ring[..=i].to_vec();
        next.extend(hole[j..].iter().chain(&hole[..=j]));
        next.extend(&ring[i..]);
        ring = next;
    }
    ring
}

/// How often the surface goes around a point.
pub fn winding(side: &Side, at: &[DVec3], o: DVec3) -> i32 {
    let span = side.tree.span();
    if !(span.lo.cmple(o).all() && o.cmple(span.hi).all()) {
        return 0;
    }
    crossings(o, (span.hi - span.lo).length() * 2.0, |p, visit| {
        side.tree.along(o, p, |t| visit(side.triangles[t as usize].map(|i| at[i as usize])));
    })
}

/// Signed crossings of a segment of length `reach` that leaves the surface's box, decided exactly; a segment that meets an
/// edge is tried anew in another direction. `along` shows the triangles near the segment to `o`'s far end until told false.
pub fn crossings(o: DVec3, reach: f64, along: impl Fn(DVec3, &mut dyn FnMut([DVec3; 3]) -> bool)) -> i32 {
    for attempt in 0..64 {
        let k = attempt as f64;
        let d = DVec3::new((k * 1.7 + 0.4).sin(), (k * 2.3 + 1.1).sin(), (k * 0.9 + 2.2).cos());
        let p = o + d.normalize_or(DVec3::X) * reach;
        let (mut sum, mut good) = (0, true);
        along(p, &mut |[a, b, c]| {
            let (x, y) = (orient3d(c3(a), c3(b), c3(c), c3(o)), orient3d(c3(a), c3(b), c3(c), c3(p)));
            if (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0) {
                return true;
            }
            let turn = |i: DVec3, j: DVec3| orient3d(c3(o), c3(p), c3(i), c3(j));
            let w = [turn(a, b), turn(b, c), turn(c, a)];
            if w.iter().any(|&v| v > 0.0) && w.iter().any(|&v| v < 0.0) {
                return true;
            }
            if x == 0.0 || y == 0.0 || w.contains(&0.0) {
                good = false;
                return false;
            }
            // robust's orient3d is positive below the plane: the point is on the inner side.
            sum += if x > 0.0 { 1 } else { -1 };
            true
        });
        if good {
            return sum;
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_hole_is_left_out_once() {
        let at: Vec<DVec3> = [
            [0., 3., 1.],
            [2., 2., 4.],
            [3., 1., 4.],
            [26. / 11., 16. / 11., 38. / 11.],
            [14. / 9., 19. / 9., 3.],
            [11. / 6., 11. / 6., 3.],
        ]
        .map(DVec3::from)
        .to_vec();
        let loops: [&[u32]; 2] = [&[0, 1, 2], &[3, 4, 5]];
        let want: DVec3 = loops.iter().map(|l| area_vector(&at, l)).sum();
        let made = triangles(&loops, want, &at);
        let got: f64 = made.iter().map(|t| area_vector(&at, t).length()).sum();
        assert!((got - want.length()).abs() < 1e-12, "{made:?}: {got} instead of {}", want.length());
        // A corner of the hole is in line with one of the border: no triangle is that line.
        assert!(made.iter().all(|t| area_vector(&at, t).length() > 1e-6), "{made:?}");
    }
}
