//! Polygons into triangles, concave ones too.
//!
//! A face is seen along the axis of its normal's (Newell) largest component and cut by ears
//! (Meisters 1975). The tests for convex corners, and for corners inside an ear, are exact
//! (Shewchuk's `orient2d`) for the given coordinates, so that the result depends on nothing else. A
//! quadrilateral is cut along the shorter of its inner diagonals. A polygon that crosses itself
//! gives triangles too, two fewer than its corners; they overlap as it does.
//!
//! A large polygon for which ears take more than a few steps a corner is cut by a sweep instead
//! (`monotone`), in n log n steps, unless it touches or crosses itself.

mod monotone;

use std::collections::BTreeSet;

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, orient2d};

use super::{PolyMesh, TriMesh};

impl PolyMesh {
    /// All faces in triangles (indices into `positions`), and the face of each. A face of n corners
    /// gives n - 2.
    pub fn triangles(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let count = self.faces().map(|f| f.len().saturating_sub(2)).sum();
        let (mut out, mut of) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (f, corners) in self.faces().enumerate() {
            match *corners {
                [a, b, c] => out.push([a, b, c]),
                _ => face(&self.positions, corners, &mut out),
            }
            of.resize(out.len(), f as u32);
        }
        if out.len() > self.face_count() {
            self.separate_diagonals(&mut out, &of);
        }
        (out, of)
    }

    /// Recuts faces whose diagonal is another face's diagonal or edge too: that edge would have
    /// four triangles, and the mesh would no longer be manifold.
    fn separate_diagonals(&self, triangles: &mut [[u32; 3]], of: &[u32]) {
        let key = |a: u32, b: u32| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let sides = |t: &[u32; 3]| [key(t[0], t[1]), key(t[1], t[2]), key(t[2], t[0])];
        // Within one face's triangles a diagonal is an edge that comes twice.
        let mut diagonals: Vec<(u64, u32)> = Vec::new();
        let mut edges: Vec<u64> = Vec::new();
        let mut start = 0;
        for group in of.chunk_by(|a, b| a == b) {
            let own = &triangles[start..start + group.len()];
            start += group.len();
            if own.len() < 2 {
                continue;
            }
            edges.clear();
            edges.extend(own.iter().flat_map(sides));
            edges.sort_unstable();
            let twice = edges.chunk_by(|a, b| a == b).filter(|g| g.len() == 2);
            diagonals.extend(twice.map(|g| (g[0], group[0])));
        }
        diagonals.sort_unstable();
        // One bit a diagonal, by a hash, so that few of the mesh's edges are searched for.
        let bits = (diagonals.len() * 16).next_power_of_two().max(64);
        let slot = |k: u64| (k.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20) as usize & (bits - 1);
        let mut marked = vec![0u64; bits / 64];
        diagonals.iter().for_each(|d| marked[slot(d.0) / 64] |= 1 << (slot(d.0) % 64));
        let border = |f: usize| {
            let c = self.face(f);
            (0..c.len()).map(move |i| key(c[i], c[(i + 1) % c.len()]))
        };
        let shared = |f: usize| {
            border(f).filter_map(|k| {
                let maybe = marked[slot(k) / 64] >> (slot(k) % 64) & 1 == 1;
                let at = maybe.then(|| diagonals.partition_point(|d| d.0 < k))?;
                diagonals.get(at).filter(|d| d.0 == k).map(|d| d.1)
            })
        };
        let mut again: Vec<u32> =
            (0..self.face_count()).into_par_iter().flat_map_iter(shared).collect();
        for same in diagonals.chunk_by(|a, b| a.0 == b.0) {
            again.extend(same[1..].iter().map(|d| d.1));
        }
        if again.is_empty() {
            return;
        }
        again.sort_unstable();
        again.dedup();
        let mut taken: BTreeSet<u64> = diagonals
            .iter()
            .filter(|d| again.binary_search(&d.1).is_err())
            .map(|d| d.0)
            .chain((0..self.face_count()).flat_map(border))
            .collect();
        let mut made = Vec::new();
        for f in again {
            made.clear();
            let corners = self.face(f as usize);
            face_avoiding(&self.positions, corners, |a, b| taken.contains(&key(a, b)), &mut made);
            let start = of.partition_point(|&g| g < f);
            triangles[start..start + made.len()].copy_from_slice(&made);
            taken.extend(made.iter().flat_map(sides));
        }
    }

    /// The same surface in triangles and single precision, and the face of each triangle.
    pub fn triangulate(&self) -> (TriMesh, Vec<u32>) {
        let (triangles, of) = self.triangles();
        let positions = self.positions.iter().map(|p| p.as_vec3()).collect();
        (TriMesh { positions, triangles, colours: self.colours.clone() }, of)
    }
}

/// Twice the area vector of a polygon (Newell's sum), taken around its first corner.
pub fn area_vector(positions: &[DVec3], corners: &[u32]) -> DVec3 {
    let Some(&first) = corners.first() else { return DVec3::ZERO };
    let o = positions[first as usize];
    corners
        .windows(2)
        .map(|w| (positions[w[0] as usize] - o).cross(positions[w[1] as usize] - o))
        .sum()
}

/// The corners in the plane, seen along the axis of the normal's largest component and so that the
/// polygon runs counter-clockwise.
fn projected(positions: &[DVec3], corners: &[u32]) -> Vec<Coord<f64>> {
    let n = area_vector(positions, corners);
    let a = n.abs();
    let flat = |v: &u32| {
        let p = positions[*v as usize];
        let (x, y, up) = if a.x >= a.y && a.x >= a.z {
            (p.y, p.z, n.x)
        } else if a.y >= a.z {
            (p.z, p.x, n.y)
        } else {
            (p.x, p.y, n.z)
        };
        if up < 0.0 { Coord { x: y, y: x } } else { Coord { x, y } }
    };
    corners.iter().map(flat).collect()
}

/// Appends the triangles of one polygon by diagonals that `taken` does not hold, where there are
/// such.
fn face_avoiding(
    positions: &[DVec3],
    corners: &[u32],
    taken: impl Fn(u32, u32) -> bool,
    out: &mut Vec<[u32; 3]>,
) {
    let points = projected(positions, corners);
    cut(corners, &points, |i, j| !taken(corners[i], corners[j]), out);
}

/// Appends the triangles of one polygon.
pub fn face(positions: &[DVec3], corners: &[u32], out: &mut Vec<[u32; 3]>) {
    if corners.len() < 3 {
        return;
    }
    let points = projected(positions, corners);
    let turn = |i: usize, j: usize, k: usize| orient2d(points[i], points[j], points[k]);
    if corners.len() == 4 {
        let good = |i: usize, j: usize, k: usize| turn(i, j, k) > 0.0;
        let first = good(0, 1, 2) && good(0, 2, 3);
        let second = good(0, 1, 3) && good(1, 2, 3);
        let length = |i: usize, j: usize| {
            positions[corners[i] as usize].distance_squared(positions[corners[j] as usize])
        };
        let thin = |i, j, k| flat_ear(&points, i, j, k, turn(i, j, k));
        let by_first = match (first, second) {
            (true, true) => {
                let first = thin(0, 1, 2) || thin(0, 2, 3);
                let second = thin(0, 1, 3) || thin(1, 2, 3);
                if first == second { length(0, 2) <= length(1, 3) } else { second }
            }
            (false, false) => length(0, 2) <= length(1, 3),
            (f, _) => f,
        };
        let order: [[usize; 3]; 2] =
            if by_first { [[0, 1, 2], [0, 2, 3]] } else { [[0, 1, 3], [1, 2, 3]] };
        out.extend(order.map(|t| t.map(|i| corners[i])));
        return;
    }
    cut(corners, &points, |_, _| true, out);
}

/// Fewest corners of a polygon that is cut by a sweep where ears take many steps.
const SWEEP_FROM: usize = 2_000;

/// Steps a corner within which ears cut a polygon without deep bays.
const FEW_STEPS: u64 = 64;

/// Appends the triangles by ears, or by a sweep where ears take too many steps. Diagonals that are
/// not `allowed` are taken only where there is no other.
fn cut(
    corners: &[u32],
    points: &[Coord<f64>],
    allowed: impl Fn(usize, usize) -> bool,
    out: &mut Vec<[u32; 3]>,
) {
    let start = out.len();
    if corners.len() >= SWEEP_FROM {
        if ears(corners, points, &allowed, FEW_STEPS * corners.len() as u64, out) {
            return;
        }
        out.truncate(start);
        if let Some(all) = monotone::triangles(points, &allowed) {
            out.extend(all.iter().map(|t| t.map(|i| corners[i as usize])));
            return;
        }
    }
    ears(corners, points, &allowed, u64::MAX, out);
}

/// Returns true if three corners are collinear up to rounding. Such a triangle has no direction: in
/// space it may overlap a neighbouring face in that face's plane.
fn flat_ear(points: &[Coord<f64>], i: usize, j: usize, k: usize, turn: f64) -> bool {
    let square = |a: usize, b: usize| {
        let (x, y) = (points[a].x - points[b].x, points[a].y - points[b].y);
        x * x + y * y
    };
    turn.abs() <= 1e-9 * square(i, j).max(square(j, k)).max(square(k, i))
}

/// Corners that may be held against an ear, over all ears of a polygon: some seconds. A polygon
/// beyond it crosses or repeats itself over and over.
const MOST_CHECKS: u64 = 1_000_000_000;

/// The corners of a polygon that are not convex, in a grid of square cells of about one each.
struct ReflexCorners<'a> {
    points: &'a [Coord<f64>],
    live: Vec<bool>,
    /// Those that are live, and some that were.
    list: Vec<usize>,
    count: usize,
    low: Coord<f64>,
    /// Cells a unit.
    scale: f64,
    /// Cells along each side; 0 where there are too few corners for a grid.
    side: usize,
    cells: Vec<Vec<u32>>,
}

/// Fewest corners that are put in a grid.
const GRID_FROM: usize = 64;

impl<'a> ReflexCorners<'a> {
    fn new(points: &'a [Coord<f64>], list: Vec<usize>) -> Self {
        let mut live = vec![false; points.len()];
        list.iter().for_each(|&r| live[r] = true);
        let mut low = Coord { x: f64::INFINITY, y: f64::INFINITY };
        let mut high = Coord { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY };
        for p in points {
            low = Coord { x: low.x.min(p.x), y: low.y.min(p.y) };
            high = Coord { x: high.x.max(p.x), y: high.y.max(p.y) };
        }
        let size = (high.x - low.x).max(high.y - low.y);
        let grid = list.len() >= GRID_FROM && size > 0.0 && size.is_finite();
        let side = if grid { (list.len() as f64).sqrt() as usize } else { 0 };
        let (scale, count) = (side as f64 / size, list.len());
        let mut out = ReflexCorners {
            points,
            live,
            list,
            count,
            low,
            scale,
            side,
            cells: vec![Vec::new(); side * side],
        };
        if side > 0 {
            for i in 0..out.list.len() {
                let r = out.list[i];
                let (x, y) = out.cell(points[r]);
                out.cells[y * side + x].push(r as u32);
            }
        }
        out
    }

    /// Rounding keeps the order, so a corner within a box is in a cell within the box's cells.
    fn cell(&self, p: Coord<f64>) -> (usize, usize) {
        let along = |v: f64, low: f64| (((v - low) * self.scale) as usize).min(self.side - 1);
        (along(p.x, self.low.x), along(p.y, self.low.y))
    }

    fn holds(&self, r: usize) -> bool {
        self.live[r]
    }

    fn remove(&mut self, r: usize) {
        self.count -= usize::from(std::mem::take(&mut self.live[r]));
        if self.list.len() > 2 * self.count + GRID_FROM {
            self.list.retain(|&r| self.live[r]);
        }
    }

    /// Whether `test` says yes to a corner in the ear's box other than its own. Adds the corners
    /// that were looked at to `checks`.
    fn any(&mut self, ear: [usize; 3], checks: &mut u64, test: impl Fn(usize) -> bool) -> bool {
        let live = &self.live;
        let hit = |r: usize| live[r] && !ear.contains(&r) && test(r);
        if self.side > 0 {
            let cells = ear.map(|i| self.cell(self.points[i]));
            let range = |of: fn(&(usize, usize)) -> usize| {
                let (a, b, c) = (of(&cells[0]), of(&cells[1]), of(&cells[2]));
                (a.min(b).min(c), a.max(b).max(c))
            };
            let ((x0, x1), (y0, y1)) = (range(|c| c.0), range(|c| c.1));
            if (x1 - x0 + 1) * (y1 - y0 + 1) < self.list.len() {
                for y in y0..=y1 {
                    for cell in &mut self.cells[y * self.side + x0..=y * self.side + x1] {
                        *checks += cell.len() as u64 + 1;
                        cell.retain(|&r| live[r as usize]);
                        if cell.iter().any(|&r| hit(r as usize)) {
                            return true;
                        }
                    }
                }
                return false;
            }
        }
        *checks += self.list.len() as u64 + 1;
        self.list.iter().any(|&r| hit(r))
    }
}

/// Cuts ears; a diagonal that is not `allowed` is taken only where no other ear is left. Returns
/// false, with some of the triangles, where that takes more than `most` steps.
fn ears(
    corners: &[u32],
    points: &[Coord<f64>],
    allowed: impl Fn(usize, usize) -> bool,
    most: u64,
    out: &mut Vec<[u32; 3]>,
) -> bool {
    let turn = |i: usize, j: usize, k: usize| orient2d(points[i], points[j], points[k]);
    let n = corners.len();
    let mut next: Vec<usize> = (1..n).chain([0]).collect();
    let mut prev: Vec<usize> = [n - 1].into_iter().chain(0..n - 1).collect();
    // Only reflex corners can be inside an ear, and a corner that became convex stays so.
    let mut reflex =
        ReflexCorners::new(points, (0..n).filter(|&i| turn(prev[i], i, next[i]) <= 0.0).collect());
    let inside = |p: usize, i: usize, q: usize, r: usize| {
        // A corner at the same place as one of the ear's is a touch, not a hindrance.
        [p, i, q].iter().all(|&c| (points[c].x, points[c].y) != (points[r].x, points[r].y))
            && turn(p, i, r) >= 0.0
            && turn(i, q, r) >= 0.0
            && turn(q, p, r) >= 0.0
    };
    let (mut left, mut at, mut tried) = (n, 0, 0);
    // Rounds of ever lower demands: a true ear by an allowed diagonal that leaves no three corners
    // in line; any true ear by an allowed diagonal; a true ear; any convex corner; any corner.
    // Simple polygons without neighbours in the way need the first two only.
    let (mut demand, mut least, mut checks, mut steps) = (0, 0, 0u64, 0u64);
    while left > 3 {
        steps += 1;
        if checks.saturating_add(steps) > most {
            return false;
        }
        let (p, q) = (prev[at], next[at]);
        let bend = turn(p, at, q);
        let convex = bend > 0.0;
        if demand < 3 && checks > MOST_CHECKS {
            // Whatever it is: any corner, in order, which ends at once.
            (demand, least) = (4, 4);
        }
        let good = match demand {
            0..=2 => {
                (demand > 1 || allowed(p, q))
                    && convex
                    && (demand > 0 || !flat_ear(points, p, at, q, bend))
                    && !reflex.any([p, at, q], &mut checks, |r| inside(p, at, q, r))
            }
            3 => convex,
            _ => true,
        };
        if !good {
            at = q;
            tried += 1;
            if tried > left {
                demand += 1;
                tried = 0;
            }
            continue;
        }
        out.push([corners[p], corners[at], corners[q]]);
        next[p] = q;
        prev[q] = p;
        left -= 1;
        tried = 0;
        demand = least;
        reflex.remove(at);
        for r in [p, q] {
            if reflex.holds(r) && turn(prev[r], r, next[r]) > 0.0 {
                reflex.remove(r);
            }
        }
        // One on, so that a round polygon is not cut into a fan.
        at = next[q];
    }
    out.push([corners[prev[at]], corners[at], corners[next[at]]]);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(mesh: &PolyMesh) -> (f64, f64) {
        let (triangles, of) = mesh.triangles();
        assert_eq!(triangles.len(), of.len());
        let areas = triangles.iter().map(|t| area_vector(&mesh.positions, t).z / 2.0);
        (areas.clone().sum(), areas.fold(f64::INFINITY, f64::min))
    }

    fn polygon(points: &[(f64, f64)]) -> PolyMesh {
        let mut m = PolyMesh::new();
        m.positions = points.iter().map(|&(x, y)| DVec3::new(x, y, x * 0.25)).collect();
        m.push_face(&(0..points.len() as u32).collect::<Vec<_>>());
        m
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        let comb: Vec<(f64, f64)> = (0..40)
            .map(|i| (i as f64, if i % 2 == 0 { 10.0 } else { 1.0 }))
            .rev()
            .chain([(0.0, 0.0), (39.0, 0.0)])
            .collect();
        let shapes: [&[(f64, f64)]; 4] = [
            &[(0., 0.), (4., 0.), (4., 4.), (1., 1.)],
            &[(0., 0.), (2., 1.), (4., 0.), (4., 4.), (2., 3.), (0., 4.)],
            &[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (3., 3.), (0., 3.)],
            &comb,
        ];
        for points in shapes {
            let m = polygon(points);
            let want = area_vector(&m.positions, m.face(0)).z / 2.0;
            let (sum, least) = area(&m);
            assert!(
                (sum - want).abs() < 1e-12 * want && least >= 0.0,
                "{points:?}: {sum} {want} {least}"
            );
        }
    }

    #[test]
    fn two_faces_over_the_same_corners_take_different_diagonals() {
        // A pillow of two squares: both would be cut along the shorter diagonal from 0 to 2.
        let mut m = polygon(&[(0., 0.), (1., 0.1), (1., 1.), (0., 1.1)]);
        m.positions[2].z = 0.1;
        m.push_face(&[3, 2, 1, 0]);
        let mut sides: Vec<(u32, u32)> = m
            .triangles()
            .0
            .iter()
            .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        sides.sort_unstable();
        assert!(sides.chunk_by(|a, b| a == b).all(|g| g.len() == 2), "{sides:?}");
    }

    #[test]
    fn a_face_that_repeats_its_corners_ends() {
        let mut m = PolyMesh::new();
        m.positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let corners: Vec<u32> = (0..60_000).map(|i| (i * 7 + i / 3) as u32 % 4).collect();
        m.push_face(&corners);
        assert_eq!(m.triangulate().0.triangles.len(), corners.len() - 2);
    }

    #[test]
    fn a_large_star_takes_no_time_and_any_polygon_gives_two_fewer_triangles_than_corners() {
        let star: Vec<(f64, f64)> = (0..2000)
            .map(|i| {
                let (a, r) =
                    (i as f64 * std::f64::consts::TAU / 2000.0, if i % 2 == 0 { 1.0 } else { 0.9 });
                (r * a.cos(), r * a.sin())
            })
            .collect();
        let m = polygon(&star);
        let (sum, least) = area(&m);
        assert!((sum - area_vector(&m.positions, m.face(0)).z / 2.0).abs() < 1e-9 && least > 0.0);
        let wave: Vec<(f64, f64)> = (0..200_000)
            .map(|i| {
                let a = i as f64 * std::f64::consts::TAU / 200_000.0;
                let r = 10.0 + (50.0 * a).sin();
                (r * a.cos(), r * a.sin())
            })
            .collect();
        let m = polygon(&wave);
        let (sum, least) = area(&m);
        assert!((sum - area_vector(&m.positions, m.face(0)).z / 2.0).abs() < 1e-6 && least >= 0.0);
        for crossed in [&[(0., 0.), (1., 1.), (1., 0.), (0., 1.), (0.5, 3.0)][..], &[(0., 0.); 7]] {
            assert_eq!(polygon(crossed).triangles().0.len(), crossed.len() - 2);
        }
    }
}
