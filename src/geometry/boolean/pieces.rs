//! The faces of both operands near the cut: whole where nothing cuts them, in cells where something
//! does.

use glam::DVec3;

use super::planar::{PlanarCell, cells, flatten};
use crate::PolyMesh;
use crate::boolean::intersect::Intersections;
use crate::job::{Cancelled, Job};

/// The place of a piece relative to the other operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Placement {
    Inside,
    Outside,
    /// On its surface, facing the same way.
    Same,
    /// On its surface, facing the other way.
    Against,
}

/// A part of a face that is on one side of the other operand as a whole.
#[derive(Debug, Clone)]
pub struct FacePiece {
    /// The operand's face.
    pub face: u32,
    /// The part of the face.
    pub shape: PieceShape,
    /// Its placement.
    pub place: Placement,
}

/// The shape of a piece within its face.
#[derive(Debug, Clone)]
pub enum PieceShape {
    /// The unchanged face.
    Whole,
    /// The face, with more corners on its border.
    Border(Vec<u32>),
    PlanarCell(PlanarCell),
}

impl FacePiece {
    /// All loops, whichever the shape.
    pub fn loops<'a>(&'a self, face: impl FnOnce(u32) -> &'a [u32]) -> Vec<&'a [u32]> {
        match &self.shape {
            PieceShape::Whole => vec![face(self.face)],
            PieceShape::Border(b) => vec![b],
            PieceShape::PlanarCell(c) => {
                std::iter::once(&c.outer).chain(&c.holes).map(Vec::as_slice).collect()
            }
        }
    }
}

/// Cuts the faces of one operand that the other may meet. `mesh` has its corners over the common
/// points; `starts[f]` is the first triangle of face `f`. A face with a corner on the other surface
/// is among them.
pub fn cut(
    mesh: &PolyMesh,
    side: usize,
    triangles: &[[u32; 3]],
    starts: &[u32],
    m: &Intersections,
    points: &[DVec3],
    flat: impl Fn(usize) -> bool,
    job: &Job,
) -> Result<Vec<FacePiece>, Cancelled> {
    let mut out = Vec::new();
    let marks = &m.marks[side];
    let mut near: Vec<u32> =
        marks.keys().map(|t| starts.partition_point(|s| s <= t) as u32 - 1).collect();
    near.sort_unstable();
    near.dedup();
    for (n, f) in near.into_iter().map(|f| f as usize).enumerate() {
        if n % 1024 == 0 {
            job.check()?;
        }
        let mut push =
            |shape| out.push(FacePiece { face: f as u32, shape, place: Placement::Outside });
        let range = starts[f]..starts[f + 1];
        let own = &triangles[range.start as usize..range.end as usize];
        let split =
            range.clone().any(|t| marks.get(&t).is_some_and(|k| k.flat || !k.segments.is_empty()))
                || (range.len() > 1 && along_diagonal(mesh.face(f), own, m));
        if !split {
            let border = ring(mesh.face(f), m);
            if border.len() == mesh.face(f).len() {
                push(PieceShape::Whole);
                continue;
            }
            if flat(f) {
                push(PieceShape::Border(border));
                continue;
            }
        }
        for t in range {
            let tri = triangles[t as usize];
            let ring = ring(&tri, m);
            let none = Vec::new();
            let segments = marks.get(&t).map_or(&none, |k| &k.segments);
            if segments.is_empty() {
                push(PieceShape::PlanarCell(PlanarCell { outer: ring, holes: Vec::new() }));
                continue;
            }
            let [a, b, c] = tri.map(|i| points[i as usize]);
            let flat = flatten((b - a).cross(c - a));
            for cell in cells(&ring, segments, |i| flat(points[i as usize])) {
                push(PieceShape::PlanarCell(cell));
            }
        }
    }
    Ok(out)
}

/// Returns true if the cut runs along a diagonal of the face's input triangulation.
fn along_diagonal(corners: &[u32], triangles: &[[u32; 3]], m: &Intersections) -> bool {
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
pub(super) fn ring(corners: &[u32], m: &Intersections) -> Vec<u32> {
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

/// The triangles of a polygon with holes.
pub fn triangles(loops: &[&[u32]], n: DVec3, at: &[DVec3]) -> Vec<[u32; 3]> {
    let mut out = Vec::new();
    if loops.len() == 1 {
        crate::triangulate::face(at, loops[0], &mut out);
    } else if let Some(made) = super::planar::delaunay(loops, n, at) {
        out = made;
    } else {
        crate::triangulate::face(at, &bridged(loops, n, at), &mut out);
    }
    out
}

/// Holes joined to the border by the shortest bridges that cross nothing: one loop that runs along
/// each bridge twice.
fn bridged(loops: &[&[u32]], n: DVec3, at: &[DVec3]) -> Vec<u32> {
    let flat = flatten(n);
    let spot = |v: u32| flat(at[v as usize]);
    let mut ring = loops[0].to_vec();
    let mut left: Vec<&[u32]> = loops[1..].to_vec();
    while !left.is_empty() {
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
        // If a ring's corner appears twice, the bridge must start in the right one of its angles.
        let opens = |i: usize, q: u32| {
            let len = ring.len();
            let (p, v, x) =
                (spot(ring[(i + len - 1) % len]), spot(ring[i]), spot(ring[(i + 1) % len]));
            let turn = robust::orient2d(p, v, x);
            let (l, r) = (robust::orient2d(p, v, spot(q)), robust::orient2d(v, x, spot(q)));
            if turn > 0.0 { l > 0.0 && r > 0.0 } else { l > 0.0 || r > 0.0 }
        };
        let open = |w: &Bridge| {
            let q = left[w.hole][w.to];
            opens(w.from, q) && !crosses(ring[w.from], q)
        };
        let Some(Bridge { from: i, hole: h, to: j, .. }) = shortest_bridge(&ring, &left, at, open)
        else {
            break;
        };
        let hole = left.remove(h);
        let mut next = ring[..=i].to_vec();
        next.extend(hole[j..].iter().chain(&hole[..=j]));
        next.extend(&ring[i..]);
        ring = next;
    }
    ring
}

/// A line from a corner of a ring to a corner of one of several holes, by their places.
#[derive(Debug, Clone, Copy)]
struct Bridge {
    squared: f64,
    from: usize,
    hole: usize,
    to: usize,
}

/// The shortest bridge that is `open`, or the shortest of all where none is. Looks at the shortest
/// ones first, a few at a time: to sort all pairs of corners takes longer than all else.
fn shortest_bridge(
    ring: &[u32],
    holes: &[&[u32]],
    at: &[DVec3],
    open: impl Fn(&Bridge) -> bool,
) -> Option<Bridge> {
    let each = |look: &mut dyn FnMut(Bridge)| {
        for (hole, corners) in holes.iter().enumerate() {
            for (from, &p) in ring.iter().enumerate() {
                for (to, &q) in corners.iter().enumerate() {
                    let squared = at[p as usize].distance_squared(at[q as usize]);
                    look(Bridge { squared, from, hole, to });
                }
            }
        }
    };
    let (mut first, mut done, mut limit) = (None, f64::NEG_INFINITY, 0.0);
    loop {
        let (mut ways, mut next) = (Vec::new(), f64::INFINITY);
        let mut more = false;
        each(&mut |w: Bridge| {
            if w.squared > done && w.squared <= limit {
                ways.push(w);
            } else if w.squared > limit {
                (next, more) = (next.min(w.squared), true);
            }
        });
        ways.sort_by(|a, b| {
            let places = |w: &Bridge| (w.from, w.hole, w.to);
            a.squared.total_cmp(&b.squared).then(places(a).cmp(&places(b)))
        });
        first = first.or(ways.first().copied());
        if let Some(w) = ways.into_iter().find(&open) {
            return Some(w);
        }
        if !more {
            return first;
        }
        (done, limit) = (limit, next * 4.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangulate::area_vector;

    #[test]
    fn the_shortest_open_bridge_is_that_of_a_sorted_list() {
        let mut seed = 1u64;
        let mut dice = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            f64::from((seed >> 40) as u32 % 40)
        };
        let at: Vec<DVec3> = (0..60).map(|_| DVec3::new(dice(), dice(), 0.0)).collect();
        let all: Vec<u32> = (0..60).collect();
        let (ring, holes) = (&all[..20], [&all[20..30], &all[30..60]]);
        let mut sorted = Vec::new();
        for (h, hole) in holes.iter().enumerate() {
            for (i, &p) in ring.iter().enumerate() {
                for (j, &q) in hole.iter().enumerate() {
                    sorted.push((at[p as usize].distance_squared(at[q as usize]), i, h, j));
                }
            }
        }
        sorted.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
        for n in [1, 2, 7, 40, 300, 1000] {
            let open = |w: &Bridge| (w.from * 31 + w.hole * 17 + w.to * 7).is_multiple_of(n);
            let made = shortest_bridge(ring, &holes, &at, open).expect("a bridge");
            let is = |w: &&(f64, usize, usize, usize)| {
                open(&Bridge { squared: w.0, from: w.1, hole: w.2, to: w.3 })
            };
            let expected = *sorted.iter().find(is).unwrap_or(&sorted[0]);
            assert_eq!((made.squared, made.from, made.hole, made.to), expected);
        }
        let none = shortest_bridge(ring, &holes, &at, |_| false).expect("a bridge");
        assert_eq!((none.squared, none.from, none.hole, none.to), sorted[0]);
        assert!(shortest_bridge(ring, &[&[]], &at, |_| true).is_none());
    }

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
        assert!(
            (got - want.length()).abs() < 1e-12,
            "{made:?}: {got} instead of {}",
            want.length()
        );
        // A corner of the hole is in line with one of the border: no triangle is that line.
        assert!(made.iter().all(|t| area_vector(&at, t).length() > 1e-6), "{made:?}");
    }
}
