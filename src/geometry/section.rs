//! Sections of a mesh by parallel planes: contours, area, perimeter and centroid.
//!
//! Which side of the plane a vertex is on is decided once a vertex, and a vertex in the plane
//! counts as above it: the simulation of simplicity (Edelsbrunner and Mücke 1990). So an edge
//! either crosses the plane in one point or not at all, and the contours of a closed mesh are
//! closed wherever the plane passes: through faces, edges or vertices. A plane through a face gives
//! the section just below it. A shell whose lowest points are in the plane has nothing below: it is
//! cut just above the plane.
//!
//! A contour bounds an area. Where a contour runs out along a line and back along the same line, it
//! encloses nothing: at a doubled face (two triangles with the same three vertices), and in a plane
//! through a ridge. Such lines are left out of the contours and the perimeter, and measured as
//! [`Section::folded`], so that `perimeter + folded` is the length in which the plane meets the
//! triangles.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rayon::prelude::*;

use crate::PolyMesh;
use crate::aabb::Aabb;
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};

/// Rounding errors of a vertex's height over a slanted plane within which it lies in the plane.
const ERRORS: f64 = 8.0;
/// Widest crack that is closed, as a part of the largest coordinate: the rounding to single
/// precision of two vertices that a file should name once.
const CRACK: f64 = 4.0 * f32::EPSILON as f64;
/// No partner: the end is open.
const OPEN: u32 = u32::MAX;

/// One contour of a section.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// The solid is to the left, seen against the normal. A closed contour names its first point
    /// again at the end.
    pub points: Vec<DVec3>,
    /// True where the mesh closes it: an open mesh has contours with two ends.
    pub closed: bool,
    /// In the square of the mesh's unit, below 0 for a hole. An open contour counts as if a
    /// straight line closed it.
    pub area: f64,
}

/// The section of a mesh by one plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Outer contours run counter-clockwise and holes clockwise, seen against the normal.
    pub contours: Vec<Contour>,
    /// In the square of the mesh's unit. Parts that overlap count once each. Open contours count
    /// as if a straight line closed them.
    pub area: f64,
    /// The length of all contours, in the mesh's unit.
    pub perimeter: f64,
    /// The length of the lines along which contours run out and back, in the mesh's unit, both
    /// directions counted. They enclose nothing and are not part of `contours` or `perimeter`.
    pub folded: f64,
    /// The centre of the area, where there is one.
    pub centroid: Option<DVec3>,
    /// The number of contours with two ends.
    pub open: usize,
}

/// A mesh prepared for planes of one direction.
#[derive(Debug)]
pub struct Slicer<'a> {
    positions: &'a [DVec3],
    triangles: Vec<[u32; 3]>,
    normal: DVec3,
    /// `normal . p` of each vertex.
    heights: Vec<f64>,
    /// The height of the lowest vertex in the shell of each vertex.
    lowest: Vec<f64>,
    /// The largest absolute coordinate.
    reach: f64,
}

impl<'a> Slicer<'a> {
    /// Prepares `mesh` for planes `normal . p = offset`. `None`: the normal has no direction, or
    /// a vertex's height is not finite.
    pub fn new(mesh: &'a PolyMesh, normal: DVec3) -> Option<Slicer<'a>> {
        let length = normal.length_squared();
        let heights: Vec<f64> = mesh.positions.iter().map(|p| normal.dot(*p)).collect();
        if !(length > 0.0 && length.is_finite() && heights.iter().all(|h| h.is_finite())) {
            return None;
        }
        let (triangles, _) = mesh.triangles();
        let mut sets = DisjointSets::new(heights.len());
        for t in &triangles {
            sets.join(t[0], t[1]);
            sets.join(t[1], t[2]);
        }
        let roots: Vec<u32> = (0..heights.len() as u32).map(|v| sets.root(v)).collect();
        let mut least = vec![f64::INFINITY; heights.len()];
        for (&root, &h) in roots.iter().zip(&heights) {
            least[root as usize] = least[root as usize].min(h);
        }
        let lowest = roots.iter().map(|&r| least[r as usize]).collect();
        let reach = mesh.positions.iter().fold(0f64, |r, p| r.max(p.abs().max_element()));
        Some(Slicer { positions: &mesh.positions, triangles, normal, heights, lowest, reach })
    }

    /// The least and the greatest offset at which a plane meets a triangle of the mesh.
    pub fn range(&self) -> Option<(f64, f64)> {
        let all = self.triangles.iter().flatten().map(|&v| self.heights[v as usize]);
        let range = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
        (range.0 <= range.1).then_some(range)
    }

    /// The sections by planes at `offsets`, in their order.
    pub fn all(&self, offsets: &[f64], job: &Job) -> Result<Vec<Section>, Cancelled> {
        offsets.par_iter().map(|&o| job.check().map(|()| self.at(o))).collect()
    }

    /// The section by the plane at `offset`.
    pub fn at(&self, offset: f64) -> Section {
        let n = self.normal.abs();
        // The height over a plane along an axis has no rounding error to allow for.
        let slanted = n.max_element() < n.element_sum();
        let size = n.element_sum() * self.reach + offset.abs();
        let slack = if slanted { ERRORS * f64::EPSILON * size } else { 0.0 };
        let above = |v: u32| {
            let (h, lowest) = (self.heights[v as usize], self.lowest[v as usize]);
            if (lowest - offset).abs() <= slack { h > offset + slack } else { h >= offset - slack }
        };
        let mut cut = Cut::default();
        for t in &self.triangles {
            let sides = t.map(above);
            let Some(k) = (0..3).find(|&k| sides[k] && !sides[(k + 1) % 3]) else { continue };
            let (top, low, third) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            let up = if sides[(k + 2) % 3] { (low, third) } else { (third, top) };
            let down = cut.point((top, low), |a, b| self.point_in_plane(a, b, offset, slack));
            let up = cut.point(up, |a, b| self.point_in_plane(a, b, offset, slack));
            cut.pieces.push([down, up]);
        }
        let ends = cut.joined(CRACK * self.reach);
        let (contours, folded) = cut.trace(&ends);
        Section { folded, ..Section::of(contours, self.normal) }
    }

    /// The place at which the edge from `a` to `b` meets the plane.
    fn point_in_plane(&self, a: u32, b: u32, offset: f64, slack: f64) -> DVec3 {
        let height = |v: u32| self.heights[v as usize] - offset;
        let (p, q) = (self.positions[a as usize], self.positions[b as usize]);
        let (h, k) = (height(a), height(b));
        if h.abs() <= slack {
            return p;
        }
        if k.abs() <= slack {
            return q;
        }
        let x = p + (q - p) * (h / (h - k));
        x + self.normal * ((offset - self.normal.dot(x)) / self.normal.length_squared())
    }
}

/// The pieces of a section, one a triangle.
#[derive(Default)]
struct Cut {
    points: Vec<DVec3>,
    /// The point of each edge that crosses, by its vertices in order.
    names: BTreeMap<(u32, u32), u32>,
    /// From the edge where the triangle's border goes down to the one where it goes up. End `2 i`
    /// is where piece `i` starts, `2 i + 1` where it ends.
    pieces: Vec<[u32; 2]>,
}

impl Cut {
    fn point(&mut self, (a, b): (u32, u32), place: impl Fn(u32, u32) -> DVec3) -> u32 {
        let points = &mut self.points;
        *self.names.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push(place(a.min(b), a.max(b)));
            points.len() as u32 - 1
        })
    }

    fn end(&self, end: u32) -> DVec3 {
        self.points[self.pieces[end as usize / 2][end as usize % 2] as usize]
    }

    /// The partner of each end: the one in the triangle beyond the edge; across a crack the
    /// nearest one within `reach`.
    fn joined(&self, reach: f64) -> Vec<u32> {
        let mut at: Vec<[Vec<u32>; 2]> = vec![Default::default(); self.points.len()];
        for (i, piece) in self.pieces.iter().enumerate() {
            for k in 0..2 {
                at[piece[k] as usize][k].push((2 * i + k) as u32);
            }
        }
        let mut partner = vec![OPEN; self.pieces.len() * 2];
        let mut join = |a: u32, b: u32| {
            partner[a as usize] = b;
            partner[b as usize] = a;
        };
        let mut loose = Vec::new();
        for [starts, ends] in &at {
            let n = starts.len().min(ends.len());
            (0..n).for_each(|i| join(starts[i], ends[i]));
            // Faces that disagree on the outside leave ends of one kind.
            for pair in [&starts[n..], &ends[n..]].into_iter().flat_map(|rest| rest.chunks(2)) {
                match *pair {
                    [a, b] => join(a, b),
                    _ => loose.extend(pair),
                }
            }
        }
        self.close_cracks(&mut loose, reach, &mut join);
        partner
    }

    /// Joins loose ends that are within `reach`, the nearest first.
    fn close_cracks(&self, loose: &mut [u32], reach: f64, join: &mut impl FnMut(u32, u32)) {
        // Along the axis in which they spread most, so that few are near each other.
        let all = Aabb::of(loose.iter().map(|e| self.end(*e)));
        let axis = (all.max - all.min).max_position();
        let x = |end: &u32| self.end(*end)[axis];
        loose.sort_by(|a, b| x(a).total_cmp(&x(b)).then(a.cmp(b)));
        let mut near = Vec::new();
        for (i, &a) in loose.iter().enumerate() {
            for &b in loose[i + 1..].iter().take_while(|b| x(b) - x(&a) <= reach) {
                let gap = self.end(a).distance(self.end(b));
                if gap <= reach && a / 2 != b / 2 {
                    // A start and an end go together before two of a kind.
                    near.push((a % 2 == b % 2, gap, a, b));
                }
            }
        }
        near.sort_by(|p, q| {
            p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)).then((p.2, p.3).cmp(&(q.2, q.3)))
        });
        let mut taken = BTreeSet::new();
        for (_, _, a, b) in near {
            if !taken.contains(&a) && !taken.contains(&b) {
                taken.extend([a, b]);
                join(a, b);
            }
        }
    }

    /// The contours, open ones first, from where they start; and the length of the lines along
    /// which they run out and back.
    fn trace(&self, partner: &[u32]) -> (Vec<Contour>, f64) {
        let mut folded = 0.0;
        let mut done = vec![false; self.pieces.len()];
        let mut out = Vec::new();
        let open = (0..partner.len() as u32).filter(|&e| partner[e as usize] == OPEN);
        // Starts of pieces before ends, so that contours keep their direction.
        let (starts, ends): (Vec<u32>, Vec<u32>) = open.partition(|e| e % 2 == 0);
        let rest = (0..self.pieces.len() as u32).map(|i| 2 * i);
        for first in starts.into_iter().chain(ends).chain(rest) {
            if done[first as usize / 2] {
                continue;
            }
            let (mut points, mut at) = (vec![self.end(first)], first);
            let closed = loop {
                done[at as usize / 2] = true;
                let far = at ^ 1;
                folded += push(&mut points, self.end(far));
                match partner[far as usize] {
                    OPEN => break false,
                    next if next == first => break true,
                    next => at = next,
                }
                folded += push(&mut points, self.end(at));
            };
            if closed {
                folded += close(&mut points);
            }
            if points.len() > if closed { 3 } else { 1 } {
                out.push(Contour { points, closed, area: 0.0 });
            } else {
                folded += length(&points);
            }
        }
        (out, folded)
    }
}

/// Adds a point to a line. Leaves out a point that repeats the last one, and the piece along which
/// the line turns back on itself; returns the length of that piece, out and back.
fn push(points: &mut Vec<DVec3>, p: DVec3) -> f64 {
    match points[..] {
        [.., last] if last == p => 0.0,
        [.., before, last] if before == p => {
            points.pop();
            2.0 * last.distance(p)
        }
        _ => {
            points.push(p);
            0.0
        }
    }
}

/// Ends a closed line at its first point, without a spike there; returns the length of the spike,
/// out and back.
fn close(points: &mut Vec<DVec3>) -> f64 {
    if points.first() == points.last() {
        points.pop();
    }
    let (mut from, mut spike) = (0, 0.0);
    while points.len() > from + 2 && points[from + 1] == points[points.len() - 1] {
        spike += 2.0 * points[from].distance(points[from + 1]);
        points.pop();
        from += 1;
    }
    points.drain(..from);
    points.extend(points.first().copied());
    spike
}

fn length(points: &[DVec3]) -> f64 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

impl Section {
    fn of(mut contours: Vec<Contour>, normal: DVec3) -> Section {
        let mut out =
            Section { open: contours.iter().filter(|c| !c.closed).count(), ..Self::default() };
        let up = normal.normalize();
        let (mut moment, mut base) = (DVec3::ZERO, None);
        for c in &mut contours {
            out.perimeter += length(&c.points);
            let origin = *base.get_or_insert(c.points[0]);
            let round = c.points.iter().chain(c.points.first());
            for (p, q) in c.points.iter().zip(round.skip(1)) {
                let (p, q) = (*p - origin, *q - origin);
                let twice = p.cross(q).dot(up);
                out.area += twice * 0.5;
                c.area += twice * 0.5;
                moment += (p + q) * (twice / 6.0);
            }
        }
        out.centroid = base.map(|o| o + moment / out.area).filter(|c| c.is_finite());
        out.contours = contours;
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measures;
    use crate::shapes::{cuboid, cylinder, icosphere, torus};

    fn at(mesh: &PolyMesh, normal: DVec3, offset: f64) -> Section {
        let section = Slicer::new(mesh, normal).expect("a direction").at(offset);
        assert_eq!((section.open, section.contours.iter().all(|c| c.closed)), (0, true));
        section
    }

    fn close_to(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{value} {expected}");
    }

    fn both(a: &PolyMesh, b: &PolyMesh) -> PolyMesh {
        let mut out = a.clone();
        let base = a.positions.len() as u32;
        out.positions.extend(&b.positions);
        b.faces().for_each(|f| out.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>()));
        out
    }

    #[test]
    fn a_box_has_its_outline_in_its_faces_too() {
        let mesh = cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 20.0));
        for z in [0.0, 1e-9, 5.0, 20.0 - 1e-9, 20.0] {
            let s = at(&mesh, DVec3::Z, z);
            assert_eq!(s.contours.len(), 1);
            close_to(s.area, 1200.0);
            close_to(s.perimeter, 140.0);
            assert!(s.centroid.expect("an area").distance(DVec3::new(20.0, 15.0, z)) < 1e-9);
        }
        for z in [-1e-9, 20.0 + 1e-9] {
            assert_eq!(at(&mesh, DVec3::Z, z), Section::default());
        }
        // Through four edges, and along one of them alone.
        close_to(at(&mesh, DVec3::new(3.0, -4.0, 0.0), 0.0).area, 50.0 * 20.0);
        let edge = Section { folded: 2.0 * 20.0, ..Section::default() };
        assert_eq!(at(&mesh, DVec3::new(1.0, 1.0, 0.0), 70.0), edge);
        assert!(Slicer::new(&mesh, DVec3::ZERO).is_none());
        assert!(Slicer::new(&mesh, DVec3::splat(f64::NAN)).is_none());
    }

    #[test]
    fn a_step_is_cut_below_it_and_a_hole_runs_clockwise() {
        let (lo, hi) = (DVec3::ZERO, DVec3::splat(4.0));
        let mut hole = cuboid(DVec3::ONE, DVec3::new(2.0, 2.0, 3.0));
        crate::repair::flip(&mut hole);
        let part = both(&cuboid(lo, hi), &hole);
        let part = both(&part, &cuboid(DVec3::new(9.0, 0.0, 2.0), DVec3::new(12.0, 3.0, 7.0)));
        for (z, area, contours) in
            [(0.0, 16.0, 1), (1.0, 15.0, 2), (2.0, 24.0, 3), (3.0, 24.0, 3), (7.0, 9.0, 1)]
        {
            let s = at(&part, DVec3::Z, z);
            close_to(s.area, area);
            assert_eq!(s.contours.len(), contours, "at {z}");
        }
    }

    /// Between two heights of vertices the area is a polynomial of degree two: two points of Gauss
    /// give the volume exactly.
    #[test]
    fn sections_of_closed_meshes_add_up_to_the_volume() {
        let prism = cylinder(3.0, 5.0, 7);
        let lens = both(&torus(9.0, 2.0, 24, 12), &icosphere(4.0, 6).to_poly());
        let tilted = DVec3::new(0.3, -0.5, 0.8);
        for (mesh, normal) in [
            (&prism, DVec3::Z),
            (&prism, DVec3::X),
            (&prism, tilted),
            (&lens, DVec3::Y),
            (&lens, DVec3::Z),
            (&lens, tilted),
        ] {
            let slicer = Slicer::new(mesh, normal).expect("a direction");
            let mut heights = slicer.heights.clone();
            heights.sort_by(f64::total_cmp);
            let mut volume = 0.0;
            for w in heights.windows(2).filter(|w| w[1] - w[0] > 1e-9) {
                let (middle, half) = ((w[0] + w[1]) * 0.5, (w[1] - w[0]) * 0.5);
                let x = half / 3f64.sqrt();
                volume +=
                    half * (at(mesh, normal, middle - x).area + at(mesh, normal, middle + x).area);
                // At a vertex: what is just below it.
                let (here, below) =
                    (at(mesh, normal, w[1]).area, at(mesh, normal, w[1] - 1e-10).area);
                assert!((here - below).abs() < 1e-6, "{here} {below}");
            }
            let triangles = mesh.triangulate().0;
            let whole = measures(&triangles).volume.abs();
            assert!((volume / normal.length() - whole).abs() < 1e-6 * whole, "{volume} {whole}");
        }
    }

    /// The sum over the triangles, without joining anything: a vertex in the plane is above it.
    fn met(mesh: &PolyMesh, axis: usize, height: f64) -> f64 {
        let piece = |t: &[u32; 3]| {
            let p = t.map(|v| mesh.positions[v as usize]);
            let cuts = [[0, 1], [1, 2], [2, 0]].map(|e| e.map(|i: usize| p[i]));
            let cuts: Vec<DVec3> = cuts
                .iter()
                .filter(|[a, b]| (a[axis] >= height) != (b[axis] >= height))
                .map(|[a, b]| *a + (*b - *a) * ((height - a[axis]) / (b[axis] - a[axis])))
                .collect();
            if let [a, b] = cuts[..] { a.distance(b) } else { 0.0 }
        };
        mesh.triangles().0.iter().map(piece).sum()
    }

    #[test]
    fn a_line_out_and_back_is_no_perimeter_and_is_measured() {
        // A roof: below its ridge a rectangle, in the plane of the ridge a line.
        let corners =
            [[0, 0, 0], [10, 0, 0], [10, 4, 0], [0, 4, 0], [0, 2, 3], [10, 2, 3]].map(|p| {
                let [x, y, z] = p.map(f64::from);
                DVec3::new(x, y, z)
            });
        let mut roof = PolyMesh { positions: corners.to_vec(), ..PolyMesh::new() };
        for f in [&[3, 2, 1, 0][..], &[0, 1, 5, 4], &[2, 3, 4, 5], &[0, 4, 3], &[1, 2, 5]] {
            roof.push_face(f);
        }
        let s = at(&roof, DVec3::Z, 3.0);
        assert_eq!((s.contours.len(), s.area, s.perimeter, s.folded), (0, 0.0, 0.0, 20.0));
        let s = at(&roof, DVec3::Z, 1.5);
        assert_eq!((s.contours.len(), s.folded), (1, 0.0));
        close_to(s.perimeter, 24.0);
        // A doubled face on an edge of the box, which then has four faces, and one by itself.
        let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(4.0));
        let find = |p: [f64; 3]| mesh.positions.iter().position(|q| *q == DVec3::from(p));
        let [low, high] = [[4.0, 4.0, 0.0], [4.0; 3]].map(|p| find(p).expect("a corner") as u32);
        let free = mesh.positions.len() as u32;
        for p in [[6.0, 6.0, 1.0], [9.0, 0.0, 0.0], [9.0, 0.0, 4.0], [9.0, 2.0, 1.0]] {
            mesh.positions.push(DVec3::from(p));
        }
        for f in [[low, high, free], [high, low, free], [free + 1, free + 2, free + 3]] {
            mesh.push_face(&f);
        }
        mesh.push_face(&[free + 2, free + 1, free + 3]);
        for (axis, height) in [(2, 0.5), (2, 1.0), (2, 3.25), (0, 5.0), (1, 1.0), (1, 4.5)] {
            let normal = [DVec3::X, DVec3::Y, DVec3::Z][axis];
            let s = at(&mesh, normal, height);
            close_to(s.perimeter + s.folded, met(&mesh, axis, height));
            close_to(s.perimeter, if axis != 0 && height < 4.0 { 16.0 } else { 0.0 });
            assert!(s.folded > 0.1, "{axis} {height}");
            close_to(s.contours.iter().map(|c| c.area).sum(), s.area);
        }
    }

    #[test]
    fn an_open_mesh_has_contours_with_two_ends_and_a_crack_is_closed() {
        let mesh = cylinder(3.0, 5.0, 12);
        let z = mesh.positions.iter().map(|p| p.z).fold(f64::INFINITY, f64::min) + 2.0;
        let mut open = PolyMesh::new();
        open.positions.clone_from(&mesh.positions);
        mesh.faces().filter(|f| f.len() == 4).skip(2).for_each(|f| open.push_face(f));
        let s = Slicer::new(&open, DVec3::Z).expect("a direction").at(z);
        assert_eq!((s.open, s.contours.len(), s.contours[0].closed), (1, 1, false));
        // Each face with vertices of its own, off by less than single precision holds.
        let mut torn = PolyMesh::new();
        for (i, f) in mesh.faces().enumerate() {
            let base = torn.positions.len() as u32;
            let shift = DVec3::new(1.0, -1.0, 0.0) * (i % 3) as f64 * 1e-7;
            torn.positions.extend(f.iter().map(|&v| mesh.positions[v as usize] + shift));
            torn.push_face(&(base..base + f.len() as u32).collect::<Vec<_>>());
        }
        let s = at(&torn, DVec3::Z, z);
        assert_eq!(s.contours.len(), 1);
        assert!((s.area - at(&mesh, DVec3::Z, z).area).abs() < 1e-5);
    }
}
