//! The zero surface of a grid as triangles: always a closed 2-manifold.
//!
//! Dual marching cubes (Nielson, "Dual marching cubes", 2004): within a cell the crossed edges fall
//! into patches, the same on both sides of every face, because an ambiguous face always keeps its
//! inside corners apart. A patch becomes a vertex, a crossed edge a quadrilateral between the
//! patches of its four cells. Two patches can then share two borders across one ambiguous face, the
//! only way in which an edge could get four faces (Wenger, "Isosurfaces", 2013): such borders get a
//! vertex of their own in the middle.
//!
//! Guaranteed: every edge has two faces, opposite ways; every vertex one fan. Not guaranteed: that
//! faces do not cross.

use std::sync::LazyLock;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::grid::DistanceGrid;
use crate::job::{Cancelled, Job};

/// An edge is not crossed.
const NONE: u8 = 255;

/// Edge along `axis`, on the far side (1) or not (0) along the next axis and the one after.
const fn edge(axis: usize, next: usize, after: usize) -> usize {
    axis * 4 + next + 2 * after
}

/// Corner bits of an edge's ends: bit `a` of a corner's number is its side along axis `a`.
fn ends(e: usize) -> (usize, usize) {
    let (axis, next, after) = (e / 4, e & 1, e >> 1 & 1);
    let from = next << ((axis + 1) % 3) | after << ((axis + 2) % 3);
    (from, from | 1 << axis)
}

/// For one pattern of inside corners: each edge's patch, and the number of patches.
#[derive(Clone, Copy)]
struct CellPattern {
    patch: [u8; 12],
    count: u8,
}

/// The four edges of face `axis`, `side`, and which of them meet at each inside corner where all
/// four are crossed.
fn face_edges(axis: usize, side: usize) -> [usize; 4] {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    // Along b: next is c, after is axis. Along c: next is axis, after is b.
    [edge(b, 0, side), edge(b, 1, side), edge(c, side, 0), edge(c, side, 1)]
}

/// The corners of a face of a cell: the first, along the next axis, along both, along the other.
fn face_corners(axis: usize, side: usize) -> [usize; 4] {
    let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let first = side << axis;
    [first, first | b, first | b | c, first | c]
}

/// All four edges of the face are crossed.
fn is_ambiguous(axis: usize, side: usize, case: usize) -> bool {
    let [a, b, c, d] = face_corners(axis, side).map(|corner| case >> corner & 1);
    a == c && b == d && a != b
}

/// The two arcs of an ambiguous face: the pairs of its edges (places in [`face_edges`]) at the
/// corners that it keeps apart, the inside ones or, where those are joined, the outside ones.
fn arcs(axis: usize, side: usize, case: usize, joined: bool) -> [[usize; 2]; 2] {
    debug_assert!(is_ambiguous(axis, side, case));
    let near = case >> (side << axis) & 1 == 1;
    if near != joined { [[0, 2], [1, 3]] } else { [[0, 3], [1, 2]] }
}

/// Bit `2 * axis + side`: the face is ambiguous.
static AMBIGUOUS: LazyLock<[u8; 256]> = LazyLock::new(|| {
    std::array::from_fn(|case| {
        let ambiguous = |f: &u8| is_ambiguous(usize::from(f / 2), usize::from(f % 2), case);
        (0..6).filter(ambiguous).fold(0, |bits, f| bits | 1 << f)
    })
});

/// Of the cells whose faces keep inside corners apart.
static PATTERNS: LazyLock<[CellPattern; 256]> =
    LazyLock::new(|| std::array::from_fn(|case| CellPattern::new(case, 0)));

impl CellPattern {
    /// `joined` has a bit for each face, as [`AMBIGUOUS`].
    fn new(case: usize, joined: u8) -> CellPattern {
        let crossed = |e: usize| {
            let (a, b) = ends(e);
            (case >> a ^ case >> b) & 1 == 1
        };
        let mut group: [usize; 12] = std::array::from_fn(|e| e);
        let mut join = |a: usize, b: usize| {
            let (from, to) = (group[a].max(group[b]), group[a].min(group[b]));
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        };
        for axis in 0..3 {
            for side in 0..2 {
                let edges = face_edges(axis, side);
                let hit: Vec<usize> = edges.into_iter().filter(|&e| crossed(e)).collect();
                match hit[..] {
                    [a, b] => join(a, b),
                    [_, _, _, _] => arcs(axis, side, case, joined >> (2 * axis + side) & 1 == 1)
                        .iter()
                        .for_each(|&[a, b]| join(edges[a], edges[b])),
                    _ => {}
                }
            }
        }
        let mut out = CellPattern { patch: [NONE; 12], count: 0 };
        for e in (0..12).filter(|&e| crossed(e)) {
            if group[e] == e {
                out.patch[e] = out.count;
                out.count += 1;
            } else {
                out.patch[e] = out.patch[group[e]];
            }
        }
        out
    }
}

/// A corner of a face being made.
#[derive(Clone, Copy)]
enum QuadCorner {
    Patch(u32),
    /// The middle of a doubled border: (lower cell, axis, arc) in one number.
    Middle(u64),
}

struct CrossedCells<'a, S> {
    grid: &'a DistanceGrid,
    surface: &'a S,
    cases: Vec<u8>,
    first: Vec<u32>,
}

impl<S: Sampled> CrossedCells<'_, S> {
    fn step(&self, axis: usize) -> usize {
        [1, self.grid.size[0], self.grid.size[0] * self.grid.size[1]][axis]
    }

    /// Returns the point where edge `e` of cell `at` is crossed.
    fn crossing_point(&self, at: usize, e: usize) -> DVec3 {
        let [nx, ny, _] = self.grid.size;
        let (a, b) = ends(e);
        let index = |c: usize| at + (c & 1) + (c >> 1 & 1) * nx + (c >> 2) * nx * ny;
        let (va, vb) = (self.grid.values[index(a)] as f64, self.grid.values[index(b)] as f64);
        let t = (va / (va - vb)).clamp(0.001, 0.999);
        let mut p = DVec3::new((at % nx) as f64, (at / nx % ny) as f64, (at / (nx * ny)) as f64);
        p += DVec3::new((a & 1) as f64, (a >> 1 & 1) as f64, (a >> 2) as f64);
        p[e / 4] += t;
        self.grid.origin + p * self.grid.spacing
    }

    /// The ends of the edge along `axis` on which `p` lies.
    fn edge_ends(&self, p: DVec3, axis: usize) -> [DVec3; 2] {
        let (origin, h) = (self.grid.origin[axis], self.grid.spacing);
        let low = ((p[axis] - origin) / h).floor();
        let (mut from, mut to) = (p, p);
        from[axis] = origin + low * h;
        to[axis] = origin + (low + 1.0) * h;
        [from, to]
    }

    fn pattern(&self, at: usize) -> CellPattern {
        let case = usize::from(self.cases[at]);
        let unclear = AMBIGUOUS[case];
        let joined = |f: &u8| unclear >> f & 1 == 1 && self.joined(at, f / 2, f % 2);
        match (0..6).filter(joined).fold(0, |bits, f| bits | 1 << f) {
            0 => PATTERNS[case],
            joined => CellPattern::new(case, joined),
        }
    }

    /// An ambiguous face joins its inside corners.
    fn joined(&self, at: usize, axis: u8, side: u8) -> bool {
        let [nx, ny, _] = self.grid.size;
        let mut p = DVec3::new((at % nx) as f64, (at / nx % ny) as f64, (at / (nx * ny)) as f64);
        p += 0.5;
        p[usize::from(axis)] += f64::from(side) - 0.5;
        self.surface.joined(self.grid.origin + p * self.grid.spacing)
    }

    /// The middle that the border between `low` and the next cell along `axis` needs where `e`, an
    /// edge of `low`, meets it.
    fn middle(&self, low: usize, axis: usize, e: usize) -> Option<u64> {
        let high = low + self.step(axis);
        let (here, there) = (face_edges(axis, 1), face_edges(axis, 0));
        let one = |at: usize, edges: [usize; 4]| {
            let patch = edges.map(|e| self.pattern(at).patch[e]);
            patch[0] != NONE && patch.iter().all(|&p| p == patch[0])
        };
        if !one(low, here) || !one(high, there) {
            return None;
        }
        let place = here.iter().position(|&x| x == e)?;
        let joined = self.joined(low, axis as u8, 1);
        let arcs = arcs(axis, 1, self.cases[low] as usize, joined);
        let arc = arcs.iter().position(|a| a.contains(&place))?;
        Some((low as u64 * 3 + axis as u64) * 2 + arc as u64)
    }

    fn middle_place(&self, key: u64) -> DVec3 {
        let (arc, axis, low) = (key as usize % 2, key as usize / 2 % 3, key as usize / 6);
        let joined = self.joined(low, axis as u8, 1);
        let arcs = arcs(axis, 1, self.cases[low] as usize, joined);
        let [a, b] = arcs[arc].map(|i| face_edges(axis, 1)[i]);
        (self.crossing_point(low, a) + self.crossing_point(low, b)) * 0.5
    }
}

/// The surface that the grid samples, as far as the extraction asks for it.
pub(super) trait Sampled: Sync {
    /// Returns the place of a vertex, given the points where its patch's edges are crossed (3 to
    /// 12).
    fn place(&self, crossings: &[DVec3]) -> DVec3;

    /// Returns the point where the edge from `from` to `to` is crossed. `guess` is where it would
    /// be if the distance rose evenly.
    fn crossed_at(&self, _from: DVec3, _to: DVec3, guess: DVec3) -> DVec3 {
        guess
    }

    /// Returns true if `p`, the middle of a face of a cell whose four edges are all crossed, is
    /// inside.
    fn joined(&self, _p: DVec3) -> bool {
        false
    }

    /// Returns the distance from the surface. A quadrilateral that is not flat is cut along the
    /// diagonal whose middle is nearer: the other one cuts across a sharp edge or, where a rim
    /// bends away from the quadrilateral, folds it over. Of equal ones the shorter is taken.
    fn off(&self, _p: DVec3) -> f64 {
        0.0
    }
}

impl<F: Fn(&[DVec3]) -> DVec3 + Sync> Sampled for F {
    fn place(&self, crossings: &[DVec3]) -> DVec3 {
        self(crossings)
    }
}

/// The zero surface. `place` puts a vertex, given the points where its patch's edges are crossed (3
/// to 12).
pub fn extract(
    grid: &DistanceGrid,
    place: impl Fn(&[DVec3]) -> DVec3 + Sync,
    job: &Job,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), Cancelled> {
    extract_sampled(grid, &place, job)
}

/// The zero surface, by what is known of the surface that was sampled.
pub(super) fn extract_sampled(
    grid: &DistanceGrid,
    surface: &impl Sampled,
    job: &Job,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), Cancelled> {
    let [nx, ny, nz] = grid.size;
    let plane = nx * ny;
    let mut cells =
        CrossedCells { grid, surface, cases: vec![0; plane * nz], first: vec![0; plane * nz] };
    // Patterns, and in each plane the list of cells that are crossed.
    let active: Vec<Vec<u32>> = cells
        .cases
        .par_chunks_mut(plane)
        .enumerate()
        .map(|(k, cases)| {
            job.check()?;
            let mut list = Vec::new();
            if k + 1 == nz {
                return Ok(list);
            }
            for j in 0..ny - 1 {
                let row = (k * ny + j) * nx;
                let inside = |i: usize| {
                    let v = |o: usize| (grid.values[row + o + i] < 0.0) as u8;
                    v(0) | v(nx) << 2 | v(plane) << 4 | v(plane + nx) << 6
                };
                let mut low = inside(0);
                for i in 0..nx - 1 {
                    let high = inside(i + 1);
                    let case = low | high << 1;
                    low = high;
                    if case != 0 && case != 255 {
                        cases[j * nx + i] = case;
                        list.push((row + i) as u32);
                    }
                }
            }
            Ok(list)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut count = 0u32;
    for &at in active.iter().flatten() {
        cells.first[at as usize] = count;
        count += u32::from(cells.pattern(at as usize).count);
    }
    job.check()?;
    let cells = &cells;
    let mut positions: Vec<Vec3> = active
        .par_iter()
        .map(|list| {
            job.check()?;
            let mut out = Vec::with_capacity(list.len());
            let mut points = Vec::with_capacity(12);
            for &at in list {
                let pattern = cells.pattern(at as usize);
                for patch in 0..pattern.count {
                    points.clear();
                    let edges = (0..12).filter(|&e| pattern.patch[e] == patch);
                    points.extend(edges.map(|e| {
                        let guess = cells.crossing_point(at as usize, e);
                        let [from, to] = cells.edge_ends(guess, e / 4);
                        surface.crossed_at(from, to, guess)
                    }));
                    out.push(surface.place(&points).as_vec3());
                }
            }
            Ok(out)
        })
        .collect::<Result<Vec<_>, Cancelled>>()?
        .concat();
    let (mut triangles, mut odd) = (Vec::new(), Vec::new());
    let parts = active
        .par_iter()
        .map(|list| {
            job.check()?;
            Ok(faces(cells, list, &positions))
        })
        .collect::<Result<Vec<_>, Cancelled>>()?;
    for (t, o) in parts {
        triangles.extend(t);
        odd.extend(o);
    }
    let mut middles: Vec<u64> = odd
        .iter()
        .flatten()
        .filter_map(|c| if let QuadCorner::Middle(key) = c { Some(*key) } else { None })
        .collect();
    middles.sort_unstable();
    middles.dedup();
    let base = positions.len();
    positions.extend(middles.iter().map(|&key| cells.middle_place(key).as_vec3()));
    for face in odd {
        // From a middle: no other face has its corners.
        let ids: Vec<u32> = face
            .iter()
            .map(|c| match *c {
                QuadCorner::Patch(id) => id,
                QuadCorner::Middle(key) => (base + middles.partition_point(|&m| m < key)) as u32,
            })
            .collect();
        let hub = face.iter().position(|c| matches!(c, QuadCorner::Middle(_))).unwrap_or(0);
        let n = ids.len();
        for i in 1..n - 1 {
            triangles.push([ids[hub], ids[(hub + i) % n], ids[(hub + i + 1) % n]]);
        }
    }
    Ok((positions, triangles))
}

/// The cosine of the angle by which the halves of a flat quadrilateral may be turned.
const FLAT: f32 = 0.95;

/// Returns true if a quadrilateral is to be cut from its first corner to its third.
fn cut_at_first([p, q, r, s]: [Vec3; 4], surface: &impl Sampled) -> bool {
    let first = p.distance_squared(r) <= q.distance_squared(s);
    let halves = if first { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] };
    let [a, b] = halves.map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero());
    if a.dot(b) > FLAT {
        return first;
    }
    let [one, other] = [p.midpoint(r), q.midpoint(s)].map(|m| surface.off(m.as_dvec3()));
    if one == other { first } else { one < other }
}

/// The faces of the edges that start at the lower corner of each listed cell; those with a middle
/// apart.
fn faces<S: Sampled>(
    cells: &CrossedCells<'_, S>,
    list: &[u32],
    positions: &[Vec3],
) -> (Vec<[u32; 3]>, Vec<Vec<QuadCorner>>) {
    let (mut triangles, mut odd) = (Vec::with_capacity(list.len() * 2), Vec::new());
    for &at in list {
        let at = at as usize;
        for axis in 0..3 {
            let mine = edge(axis, 0, 0);
            if cells.pattern(at).patch[mine] == NONE {
                continue;
            }
            let (b, c) = (cells.step((axis + 1) % 3), cells.step((axis + 2) % 3));
            // Around the edge, counter-clockwise seen from its far end.
            let around = [(at, 0, 0), (at - b, 1, 0), (at - b - c, 1, 1), (at - c, 0, 1)];
            let ids = around.map(|(cell, next, after)| {
                cells.first[cell] + cells.pattern(cell).patch[edge(axis, next, after)] as u32
            });
            // The border between consecutive cells: its lower cell, its axis, and the edge as that
            // cell calls it.
            let (ab, ac) = ((axis + 1) % 3, (axis + 2) % 3);
            let middles = [
                cells.middle(at - b, ab, edge(axis, 1, 0)),
                cells.middle(at - b - c, ac, edge(axis, 1, 1)),
                cells.middle(at - b - c, ab, edge(axis, 1, 1)),
                cells.middle(at - c, ac, edge(axis, 0, 1)),
            ];
            // Inside at the lower end: the outside is at the far end.
            let outward = cells.cases[at] & 1 == 1;
            if middles.iter().any(Option::is_some) {
                let mut face = Vec::with_capacity(8);
                for i in 0..4 {
                    face.push(QuadCorner::Patch(ids[i]));
                    face.extend(middles[i].map(QuadCorner::Middle));
                }
                if !outward {
                    face.reverse();
                }
                odd.push(face);
                continue;
            }
            let [p, q, r, s] = if outward { ids } else { [ids[0], ids[3], ids[2], ids[1]] };
            let first = cut_at_first([p, q, r, s].map(|i| positions[i as usize]), cells.surface);
            triangles.extend(if first { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] });
        }
    }
    (triangles, odd)
}
