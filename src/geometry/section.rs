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
//!
//! Triangles say on which side of a contour the solid is. Where neighbours disagree, for faces of
//! the mesh are turned, the contours around which they do are directed by the even-odd rule: one
//! within an odd number of others is a hole. [`Section::turned`] is then above 0.

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
    /// The length of the pieces whose triangles have the solid on the other side, in the mesh's
    /// unit.
    pub turned: f64,
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
    /// The length of the pieces whose triangles have the solid on the other side than their contour
    /// does, in the mesh's unit. 0 where neighbouring triangles agree. Above 0, `area` is that of
    /// the even-odd rule, and a sum over the triangles is another.
    pub turned: f64,
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

    /// The contours, open ones first, from where they start, each with the length of its pieces;
    /// and the length of the lines along which they run out and back.
    fn trace(&self, partner: &[u32]) -> (Vec<(Contour, f64)>, f64) {
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
            // The length of the pieces along the contour, and of those against it.
            let mut along = [0.0; 2];
            let closed = loop {
                done[at as usize / 2] = true;
                let far = at ^ 1;
                along[at as usize % 2] += self.end(at).distance(self.end(far));
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
                let contour = Contour { points, closed, area: 0.0, turned: along[1] };
                out.push((contour, along[0] + along[1]));
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

impl Contour {
    /// Turns the contour, whose pieces have this length.
    fn turn(&mut self, length: f64) {
        self.points.reverse();
        (self.area, self.turned) = (-self.area, length - self.turned);
    }

    /// Returns true if a place of the plane is within the contour, seen along an axis.
    fn surrounds(&self, p: DVec3, [x, y]: [usize; 2]) -> bool {
        let crosses = |w: &&[DVec3]| {
            let (a, b) = (w[0] - p, w[1] - p);
            (a[y] > 0.0) != (b[y] > 0.0) && {
                let side = a[x] * b[y] - a[y] * b[x];
                (side > 0.0) == (b[y] > a[y])
            }
        };
        self.points.windows(2).filter(crosses).count() % 2 == 1
    }
}

/// Directs the contours whose triangles disagree, each with the length of its pieces, by the
/// even-odd rule.
fn direct(contours: &mut [(Contour, f64)], up: DVec3) {
    let axes = [[1, 2], [2, 0], [0, 1]][up.abs().max_position()];
    let hole = |i: usize| {
        let p = (contours[i].0.points[0] + contours[i].0.points[1]) * 0.5;
        let others = contours.iter().enumerate().filter(|(j, _)| *j != i);
        others.filter(|(_, (c, _))| c.closed && c.surrounds(p, axes)).count() % 2 == 1
    };
    let disagree = |c: &Contour| c.closed && c.turned > 0.0;
    let wrong: Vec<usize> = (0..contours.len())
        .filter(|&i| disagree(&contours[i].0) && (contours[i].0.area < 0.0) != hole(i))
        .collect();
    for i in wrong {
        let (contour, length) = &mut contours[i];
        contour.turn(*length);
    }
}

impl Section {
    fn of(mut contours: Vec<(Contour, f64)>, normal: DVec3) -> Section {
        let up = normal.normalize();
        let base = contours.first().map(|(c, _)| c.points[0]);
        let origin = base.unwrap_or_default();
        // Twice the area between each piece and the origin.
        let fans = |c: &Contour| -> Vec<(DVec3, f64)> {
            let round = c.points.iter().chain(c.points.first()).skip(1);
            let fan = |(p, q): (&DVec3, &DVec3)| {
                let (p, q) = (*p - origin, *q - origin);
                (p + q, p.cross(q).dot(up))
            };
            c.points.iter().zip(round).map(fan).collect()
        };
        if contours.iter().any(|(c, _)| c.turned > 0.0) {
            for (c, _) in &mut contours {
                c.area = fans(c).iter().map(|f| f.1 * 0.5).sum();
            }
            direct(&mut contours, up);
        }
        let mut out = Self::default();
        let mut moment = DVec3::ZERO;
        for (mut c, _) in contours {
            out.open += usize::from(!c.closed);
            out.perimeter += length(&c.points);
            out.turned += c.turned;
            c.area = 0.0;
            for (sum, twice) in fans(&c) {
                out.area += twice * 0.5;
                c.area += twice * 0.5;
                moment += sum * (twice / 6.0);
            }
            out.contours.push(c);
        }
        out.centroid = base.map(|o| o + moment / out.area).filter(|c| c.is_finite());
        out
    }
}

#[cfg(test)]
mod tests;
