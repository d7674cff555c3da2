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

/// The two arcs of an ambiguous face: the pairs of its edges (places in [`face_edges`]) at its
/// inside corners.
fn arcs(axis: usize, side: usize, case: usize) -> [[usize; 2]; 2] {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let near = case >> (side << axis) & 1 == 1;
    debug_assert!(!near || case >> (side << axis | 1 << b | 1 << c) & 1 == 1);
    if near { [[0, 2], [1, 3]] } else { [[0, 3], [1, 2]] }
}

static PATTERNS: LazyLock<[CellPattern; 256]> = LazyLock::new(|| {
    std::array::from_fn(|case| {
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
                    [_, _, _, _] => {
                        arcs(axis, side, case).iter().for_each(|&[a, b]| join(edges[a], edges[b]))
                    }
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
    })
});

/// A corner of a face being made.
#[derive(Clone, Copy)]
enum QuadCorner {
    Patch(u32),
    /// The middle of a doubled border: (lower cell, axis, arc) in one number.
    Middle(u64),
}

struct CrossedCells<'a> {
    grid: &'a DistanceGrid,
    cases: Vec<u8>,
    first: Vec<u32>,
}

impl CrossedCells<'_> {
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

    fn pattern(&self, at: usize) -> &'static CellPattern {
        &PATTERNS[self.cases[at] as usize]
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
        let arc =
            arcs(axis, 1, self.cases[low] as usize).iter().position(|a| a.contains(&place))?;
        Some((low as u64 * 3 + axis as u64) * 2 + arc as u64)
    }

    fn middle_place(&self, key: u64) -> DVec3 {
        let (arc, axis, low) = (key as usize % 2, key as usize / 2 % 3, key as usize / 6);
        let [a, b] = arcs(axis, 1, self.cases[low] as usize)[arc].map(|i| face_edges(axis, 1)[i]);
        (self.crossing_point(low, a) + self.crossing_point(low, b)) * 0.5
    }
}

/// The zero surface. `place` puts a vertex, given the points where its patch's edges are crossed (3
/// to 12).
pub fn extract(
    grid: &DistanceGrid,
    place: impl Fn(&[DVec3]) -> DVec3 + Sync,
    job: &Job,
) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), Cancelled> {
    let [nx, ny, nz] = grid.size;
    let plane = nx * ny;
    let mut cells = CrossedCells { grid, cases: vec![0; plane * nz], first: vec![0; plane * nz] };
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
        count += PATTERNS[cells.cases[at as usize] as usize].count as u32;
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
                    points.extend(edges.map(|e| cells.crossing_point(at as usize, e)));
                    out.push(place(&points).as_vec3());
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

/// The faces of the edges that start at the lower corner of each listed cell; those with a middle
/// apart.
fn faces(
    cells: &CrossedCells,
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
            let v = |i: u32| positions[i as usize];
            if v(p).distance_squared(v(r)) <= v(q).distance_squared(v(s)) {
                triangles.push([p, q, r]);
                triangles.push([p, r, s]);
            } else {
                triangles.push([p, q, s]);
                triangles.push([q, r, s]);
            }
        }
    }
    (triangles, odd)
}
