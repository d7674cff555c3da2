//! The outline of a mesh seen along a direction: a chain of directed edges, and the region that it
//! goes around (the non-zero rule, resolved in whole numbers by the crate `i_overlay`).
//!
//! The triangles that face the viewer cover each point of the plane as often as their common border
//! goes around it. So the shadow is the region where the border's winding number is not zero, and
//! only the border, the silhouette edges, needs to be resolved into polygons. Of an open mesh all
//! triangles count, each turned to face the viewer.

use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::Overlay;
use i_overlay::core::overlay::ShapeType::Subject;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::{Precision, Solver};
use i_overlay::i_float::int::point::IntPoint;

use rayon::prelude::*;

use super::distance::topology::{NO_PARTNER, Topology};
use super::measure::Strips;
use super::snap_rounding::{WholeEdge, snap_rounded};
use crate::boolean::box_tree::{Span, SpanTree};
use crate::job::Job;

/// Half the extent of a chain in whole numbers. The smallest step is 7e-15 of the extent, 64 times
/// the rounding of double precision, so that edges that coincide up to rounding become one.
const REACH: f64 = (1u64 << 46) as f64;

/// Steps of a resolved outline in one of a chain.
const FINER: i64 = 256;

/// A plane to project onto: `u` to the right, `v` up, `towards` the viewer; right-handed, of unit
/// length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectionPlane {
    /// To the right in the picture.
    pub u: DVec3,
    /// Up in the picture.
    pub v: DVec3,
    /// Towards the viewer.
    pub towards: DVec3,
}

impl ProjectionPlane {
    /// Seen along `direction`, which is not zero, turned by `turn` radians about it. Along an axis,
    /// `u` and `v` are axes.
    pub fn along(direction: DVec3, turn: f64) -> Option<ProjectionPlane> {
        let towards = -direction.try_normalize()?;
        let up = if towards.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
        let u = up.cross(towards).normalize();
        let v = towards.cross(u);
        let (s, c) = turn.sin_cos();
        Some(ProjectionPlane { u: u * c + v * s, v: v * c - u * s, towards })
    }

    /// The coordinates of `p` in the plane.
    pub fn flat(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.u), p.dot(self.v))
    }

    /// The point of the plane through the origin at these coordinates.
    pub fn solid(&self, p: DVec2) -> DVec3 {
        self.u * p.x + self.v * p.y
    }
}

/// A region of the plane: an outer loop, counter-clockwise, and holes, clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlaneRegion {
    /// The first point stands again at the end.
    pub outer: Vec<DVec2>,
    /// Each with its first point again at the end.
    pub holes: Vec<Vec<DVec2>>,
}

/// Twice the area of a loop, positive counter-clockwise.
fn twice(ring: &[DVec2]) -> f64 {
    let Some(&o) = ring.first() else { return 0.0 };
    ring.windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum()
}

impl PlaneRegion {
    /// The outer loop, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<DVec2>> {
        std::iter::once(&self.outer).chain(&self.holes)
    }

    /// Area without the holes, in the square of the unit.
    pub fn area(&self) -> f64 {
        (twice(&self.outer).abs() - self.holes.iter().map(|h| twice(h).abs()).sum::<f64>()) * 0.5
    }
}

/// Directed edges in a plane, in whole numbers, whose sum is closed.
#[derive(Debug, Clone)]
pub struct Chain {
    centre: DVec2,
    scale: f64,
    edges: Vec<[[i64; 2]; 2]>,
}

impl Chain {
    /// For points within the box from `lo` to `hi`.
    pub fn new(lo: DVec2, hi: DVec2) -> Chain {
        let half = ((hi - lo) * 0.5).max_element();
        let scale = if half > 0.0 && half.is_finite() { REACH / half } else { 1.0 };
        Chain { centre: (lo + hi) * 0.5, scale, edges: Vec::new() }
    }

    /// The whole-number coordinates of a point within the box.
    pub fn grid_coordinates(&self, p: DVec2) -> [i64; 2] {
        ((p - self.centre) * self.scale).to_array().map(|x| x.round() as i64)
    }

    /// Adds the edge from `a` to `b`; an edge of no length is none.
    #[inline]
    pub fn push(&mut self, a: [i64; 2], b: [i64; 2]) {
        if a != b {
            self.edges.push([a, b]);
        }
    }

    /// An edge there and back is nothing. In a view along a part's walls nearly all are of this
    /// kind, and they are what makes the resolution slow.
    fn cancel(&mut self) {
        let lower_first =
            |e: &[[i64; 2]; 2]| if e[0] <= e[1] { (*e, 1) } else { ([e[1], e[0]], -1) };
        self.edges.sort_unstable_by_key(|e| lower_first(e).0);
        let mut kept = Vec::with_capacity(self.edges.len());
        for group in self.edges.chunk_by(|a, b| lower_first(a).0 == lower_first(b).0) {
            let net: i64 = group.iter().map(|e| lower_first(e).1).sum();
            let [a, b] = lower_first(&group[0]).0;
            kept.extend((0..net).map(|_| [a, b]));
            kept.extend((net..0).map(|_| [b, a]));
        }
        self.edges = kept;
    }

    /// The boxes of the edges, and a tree over them.
    fn tree(&self) -> (Vec<Span>, SpanTree) {
        let spans: Vec<Span> = self.edges.iter().map(|e| Span::of(e.map(flat_place))).collect();
        // A fresh job is never cancelled.
        let tree = SpanTree::build(&spans, &Job::default()).unwrap_or_default();
        (spans, tree)
    }

    /// Returns true if few enough edges are near each other to be resolved. In a bundle, such as
    /// the coincident sides of slivers, each edge crosses each other again once it is rounded.
    fn crosses_rarely(&self, spans: &[Span], tree: &SpanTree) -> bool {
        const EACH: usize = 256;
        const ALL: usize = 1_000_000;
        let mut left = EACH * spans.len() + ALL;
        spans.iter().all(|s| {
            let mut met = 0;
            tree.each_meets(s, |_| met += 1);
            left = left.saturating_sub(met);
            left > 0
        })
    }

    /// Returns the greatest distance of the corners of resolved shapes, in steps of one in
    /// [`FINER`], from the edges that they came from; in steps.
    fn farthest(&self, tree: &SpanTree, shapes: &[Vec<Vec<[i64; 2]>>]) -> f64 {
        let nearest = |p: &[i64; 2]| {
            let at = flat_place(*p) / FINER as f64;
            let mut reach = 4.0;
            loop {
                let mut best = f64::INFINITY;
                tree.each_meets(&Span::of([at]).grown(reach), |e| {
                    let [a, b] = self.edges[e as usize].map(flat_place);
                    let t = ((at - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
                    best = best.min((a + (b - a) * t).distance(at));
                });
                if best <= reach || reach > 4.0 * REACH {
                    return best;
                }
                reach *= 64.0;
            }
        };
        shapes.par_iter().flatten().flatten().map(nearest).reduce(|| 0.0, f64::max)
    }

    /// The edges as loops. Every point has as many edges in as out, so a walk ends only where it
    /// began.
    fn loops(&mut self) -> Vec<Vec<IntPoint<i64>>> {
        self.cancel();
        self.edges.sort_unstable();
        let edges = &self.edges;
        // The first edge from each point, and for each edge where the next begins.
        let mut starts: Vec<u32> = Vec::new();
        for i in 0..edges.len() {
            if i == 0 || edges[i][0] != edges[i - 1][0] {
                starts.push(i as u32);
            }
        }
        let from = |p: [i64; 2]| starts.binary_search_by(|&i| edges[i as usize][0].cmp(&p));
        let mut next = starts.clone();
        let mut loops = Vec::new();
        for s in 0..starts.len() {
            loop {
                let mut at = s;
                let mut ring = Vec::new();
                loop {
                    let edge = next[at] as usize;
                    let end = starts.get(at + 1).map_or(edges.len(), |&e| e as usize);
                    if edge >= end {
                        break;
                    }
                    next[at] += 1;
                    let [a, b] = edges[edge];
                    ring.push(IntPoint::new(a[0], a[1]));
                    let Ok(to) = from(b) else { break };
                    at = to;
                }
                if ring.is_empty() {
                    break;
                }
                if ring.len() > 2 {
                    loops.push(ring);
                }
            }
        }
        loops
    }

    /// The region that the chain goes around, as polygons with holes.
    pub fn resolve(mut self) -> Vec<PlaneRegion> {
        let shapes = self.shapes();
        self.regions(shapes)
    }

    /// In whole numbers: of each polygon its rings.
    fn shapes(&mut self) -> Vec<Vec<Vec<[i64; 2]>>> {
        let loops = self.loops();
        let mut overlay = Overlay::<i64>::new(self.edges.len());
        // Nearly coincident edges are joined after a few rounds, each round over three times the
        // length; with a finer precision they are resolved into thousands of slivers.
        overlay.solver = Solver { precision: Precision::LOW, ..Solver::AUTO };
        for l in &loops {
            overlay.add_contour(l, Subject);
        }
        let shapes = overlay.overlay(OverlayRule::Subject, FillRule::NonZero);
        let ring = |r: Vec<IntPoint<i64>>| r.into_iter().map(|p| [p.x, p.y]).collect();
        shapes.into_iter().map(|shape| shape.into_iter().map(ring).collect()).collect()
    }

    fn regions(&self, shapes: Vec<Vec<Vec<[i64; 2]>>>) -> Vec<PlaneRegion> {
        let back = |p: &[i64; 2]| self.centre + DVec2::new(p[0] as f64, p[1] as f64) / self.scale;
        shapes
            .into_iter()
            .filter_map(|shape| {
                let mut rings = shape.iter().map(|r| {
                    let mut ring: Vec<DVec2> = r.iter().map(back).collect();
                    ring.extend(ring.first().copied());
                    ring
                });
                Some(PlaneRegion { outer: rings.next()?, holes: rings.collect() })
            })
            .collect()
    }
}

fn flat_place(p: [i64; 2]) -> DVec3 {
    DVec3::new(p[0] as f64, p[1] as f64, 0.0)
}

/// A shadow.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShadowOutline {
    /// The covered regions.
    pub regions: Vec<PlaneRegion>,
    /// Zero if the outline is exact; else the height of the strips that approximate it, because its
    /// edges cross too often to be resolved in a time proportional to the mesh's size.
    pub strip: f64,
    /// One standard deviation of the regions' area; 0 where the outline is exact.
    pub standard_error: f64,
    /// The greatest error of the area of an exact outline, in square units: the length of the rings
    /// times the distance of their corners from the original edges, rounding included. Zero if it
    /// is drawn in strips.
    pub error_bound: f64,
}

/// Strips in which an outline is drawn that is not resolved.
const STRIPS: usize = 512;

/// Returns the shadow of a mesh on `plane`. It is exact to about 1e-14 of the mesh's extent, beyond
/// the rounding of its vertices to single precision. Nearly coincident edges increase the error to
/// [`ShadowOutline::error_bound`]. Rings repeat their first point at the end.
pub fn outline(topology: &Topology, plane: &ProjectionPlane) -> Vec<PlaneRegion> {
    let positions: Vec<DVec3> = topology.positions.iter().map(|p| p.as_dvec3()).collect();
    outline_of(topology, &positions, plane).regions
}

/// The same with the positions of the welded vertices in double precision
/// ([`crate::distance::DistanceSolid::positions`]), and whether it is exact.
pub fn outline_of(
    topology: &Topology,
    positions: &[DVec3],
    plane: &ProjectionPlane,
) -> ShadowOutline {
    let flat: Vec<DVec2> = positions.iter().map(|&p| plane.flat(p)).collect();
    let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &p in &flat {
        if p.is_finite() {
            lo = lo.min(p);
            hi = hi.max(p);
        }
    }
    if lo.x > hi.x {
        return ShadowOutline::default();
    }
    // By the flat corners, so that what counts as facing is what has area in the plane.
    let facing: Vec<i8> = topology
        .triangles
        .iter()
        .map(|t| {
            if t[0] == u32::MAX {
                return 0;
            }
            let [a, b, c] = t.map(|v| flat[v as usize]);
            let area = (b - a).perp_dot(c - a);
            (area > 0.0) as i8 - (area < 0.0) as i8
        })
        .collect();
    let mut chain = Chain::new(lo, hi);
    for (i, t) in topology.triangles.iter().enumerate() {
        let side = facing[i];
        if side == 0 || (topology.closed && side < 0) {
            continue;
        }
        for k in 0..3 {
            let other = topology.across[i][k];
            if other != NO_PARTNER && facing[other as usize] == side {
                continue;
            }
            let a = chain.grid_coordinates(flat[t[k] as usize]);
            let b = chain.grid_coordinates(flat[t[(k + 1) % 3] as usize]);
            if side > 0 { chain.push(a, b) } else { chain.push(b, a) }
        }
    }
    chain.cancel();
    let (spans, tree) = chain.tree();
    if chain.crosses_rarely(&spans, &tree) {
        let edges = snap_rounded(&chain.edges, &spans, &tree);
        // In finer steps, so that resolving what no longer crosses joins nothing.
        let finer = |e: WholeEdge| e.map(|p| p.map(|x| x * FINER));
        let mut cut = Chain {
            centre: chain.centre,
            scale: chain.scale * FINER as f64,
            edges: edges.into_iter().map(finer).collect(),
        };
        let shapes = cut.shapes();
        // Rounding to whole numbers moves a point by less than a step.
        let off = (chain.farthest(&tree, &shapes) + 1.0) / chain.scale;
        let regions = cut.regions(shapes);
        let length: f64 = regions
            .iter()
            .flat_map(PlaneRegion::rings)
            .flat_map(|r| r.windows(2).map(|w| w[0].distance(w[1])))
            .sum();
        let error_bound = length * off;
        return ShadowOutline { regions, strip: 0.0, standard_error: 0.0, error_bound };
    }
    let used =
        |t: &&[u32; 3]| t.iter().all(|&v| flat.get(v as usize).is_some_and(|p| p.is_finite()));
    let triangles: Vec<[u32; 3]> = topology.triangles.iter().filter(used).copied().collect();
    in_strips(&flat, &triangles)
}

/// The union of triangles in strips: in each what the line in its middle meets. The strips lie
/// across the direction in which most of the edges run.
fn in_strips(flat: &[DVec2], triangles: &[[u32; 3]]) -> ShadowOutline {
    let edges = triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    let square = |d: DVec2| DVec2::new(d.x * d.x - d.y * d.y, 2.0 * d.x * d.y);
    let sum: DVec2 = edges.map(|(a, b)| square(flat[b as usize] - flat[a as usize])).sum();
    // The direction whose square, as a complex number, is theirs.
    let along = (sum.normalize_or(DVec2::X) + DVec2::X).normalize_or(DVec2::Y);
    let across = -along.perp();
    let turned: Vec<DVec2> = flat.iter().map(|p| DVec2::new(p.dot(across), p.dot(along))).collect();
    let back = |p: DVec2| across * p.x + along * p.y;
    let flat = &turned[..];
    let used = || triangles.iter().flatten().map(|&v| flat[v as usize]);
    let (lo, hi) =
        used().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let Some(strips) = Strips::new(flat, triangles, STRIPS) else {
        return ShadowOutline::default();
    };
    let mut chain = Chain::new(lo, hi);
    let rows: Vec<Vec<(i64, i64)>> = (0..STRIPS)
        .into_par_iter()
        .map(|s| {
            let mut spans: Vec<(i64, i64)> = strips
                .spans(s, flat, triangles)
                .into_iter()
                .map(|(a, b)| {
                    (
                        chain.grid_coordinates(DVec2::new(a, lo.y))[0],
                        chain.grid_coordinates(DVec2::new(b, lo.y))[0],
                    )
                })
                .filter(|(a, b)| a < b)
                .collect();
            spans.sort_unstable();
            let mut row: Vec<(i64, i64)> = Vec::new();
            for (a, b) in spans {
                match row.last_mut() {
                    Some(last) if a <= last.1 => last.1 = last.1.max(b),
                    _ => row.push((a, b)),
                }
            }
            row
        })
        .collect();
    let border = |s: usize| {
        chain.grid_coordinates(DVec2::new(lo.x, strips.lo + s as f64 * strips.height))[1]
    };
    let borders: Vec<i64> = (0..=STRIPS).map(border).collect();
    let mut marks: Vec<(i64, i64)> = Vec::new();
    for (s, &y) in borders.iter().enumerate() {
        let row = |s: Option<usize>| s.and_then(|s| rows.get(s)).map_or(&[][..], |r| r);
        let (below, above) = (row(s.checked_sub(1)), row(Some(s)));
        // If only one of the two rows is covered, a piece of the outline is between them.
        marks.clear();
        marks.extend(below.iter().flat_map(|&(a, b)| [(a, 1), (b, -1)]));
        marks.extend(above.iter().flat_map(|&(a, b)| [(a, -1), (b, 1)]));
        marks.sort_unstable();
        let mut sum = 0;
        for w in marks.windows(2) {
            sum += w[0].1;
            match sum {
                1 => chain.push([w[1].0, y], [w[0].0, y]),
                -1 => chain.push([w[0].0, y], [w[1].0, y]),
                _ => {}
            }
        }
        if let Some(&next) = borders.get(s + 1) {
            for &(a, b) in above {
                chain.push([b, y], [b, next]);
                chain.push([a, next], [a, y]);
            }
        }
    }
    let lengths: Vec<f64> = rows
        .iter()
        .map(|r| r.iter().map(|(a, b)| (*b - *a) as f64).sum::<f64>() / chain.scale)
        .collect();
    // Between two strips the length changes somewhere, evenly likely anywhere; at both ends from
    // and to nothing.
    let ends = [lengths.first(), lengths.last()].into_iter().flatten().map(|l| l * l);
    let spread: f64 = lengths.windows(2).map(|w| (w[1] - w[0]).powi(2)).chain(ends).sum();
    let standard_error = strips.height * (spread / 12.0).sqrt();
    let mut regions = chain.resolve();
    for ring in regions.iter_mut().flat_map(|r| std::iter::once(&mut r.outer).chain(&mut r.holes)) {
        ring.iter_mut().for_each(|p| *p = back(*p));
    }
    ShadowOutline { regions, strip: strips.height, standard_error, error_bound: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CentredMesh;
    use crate::distance::DistanceSolid;
    use crate::job::Job;
    use crate::shapes::cuboid;

    #[test]
    fn a_million_sizes_from_the_origin_a_shadow_keeps_its_digits() {
        let far = DVec3::new(1e6, -2e6, 5e5);
        let (lo, hi) = (far + DVec3::new(0.1, 0.2, 0.3), far + DVec3::new(1.3, 0.9, 0.7));
        let mesh = cuboid(lo, hi);
        let part = CentredMesh::new(&mesh, 1.0);
        let own: Vec<DVec3> = mesh.positions.iter().map(|p| *p - part.centre).collect();
        let corners = part.mesh.triangles.iter().map(|t| t.map(|v| own[v as usize])).collect();
        let solid = DistanceSolid::build(&part.mesh, &Job::default()).expect("built");
        let solid = solid.with_corners(corners);
        let size = hi - lo;
        for (direction, want) in [(DVec3::Z, size.x * size.y), (DVec3::X, size.y * size.z)] {
            let plane = ProjectionPlane::along(direction, 0.0).expect("a plane");
            let shadow = outline_of(&solid.topology, &solid.positions(), &plane);
            let area: f64 = shadow.regions.iter().map(PlaneRegion::area).sum();
            assert!((area / want - 1.0).abs() < 1e-8, "{area} instead of {want}");
            assert_eq!((shadow.strip, shadow.standard_error), (0.0, 0.0));
            assert!(shadow.error_bound > 0.0 && shadow.error_bound < 1e-12 * want);
        }
    }

    #[test]
    fn edges_that_nearly_coincide_are_as_exact_as_their_bound() {
        // Plates one over the other, each a millionth of a millionth of a degree further turned.
        // Their union is all but the first of them.
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..60u32 {
            let (s, c) = (0.4 + f64::from(i) * 3e-12).sin_cos();
            for (x, y) in [(-3.0, -2.0), (3.0, -2.0), (3.0, 2.0), (-3.0, 2.0)] {
                positions.push(DVec3::new(c * x - s * y, s * x + c * y, f64::from(i)));
            }
            triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| v + 4 * i)));
        }
        let single: Vec<glam::Vec3> = positions.iter().map(|p| p.as_vec3()).collect();
        let corners = triangles.iter().map(|t| t.map(|v: u32| positions[v as usize])).collect();
        let mesh = crate::TriMesh { positions: single, triangles, colours: None };
        let solid = DistanceSolid::build(&mesh, &Job::default()).expect("built");
        let solid = solid.with_corners(corners);
        let plane = ProjectionPlane::along(DVec3::NEG_Z, 0.0).expect("a plane");
        let shadow = outline_of(&solid.topology, &solid.positions(), &plane);
        let area: f64 = shadow.regions.iter().map(PlaneRegion::area).sum();
        // The far corners sweep a triangle on each side: the sum of both halves of each side's
        // length squared, times half the angle.
        let angle = 59.0 * 3e-12;
        let swept = angle * (2.0 * 9.0 + 2.0 * 4.0);
        assert_eq!(shadow.strip, 0.0);
        assert!(shadow.error_bound < 1e-9, "{}", shadow.error_bound);
        assert!(area >= 24.0 - shadow.error_bound && area <= 24.0 + swept + shadow.error_bound);
    }

    #[test]
    fn bundles_of_slivers_are_drawn_in_strips() {
        // 2,000 bars a hundredth wide and 100 long, a thousandth of a degree apart.
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..2000u32 {
            let (s, c) = (0.3 + f64::from(i) * 1.7e-5).sin_cos();
            let (along, across) = (DVec3::new(c, s, 0.0) * 50.0, DVec3::new(-s, c, 0.0) * 0.005);
            for p in [-along - across, along - across, along + across, across - along] {
                positions.push((p + DVec3::Z * f64::from(i)).as_vec3());
            }
            triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| v + 4 * i)));
        }
        let mesh = crate::TriMesh { positions, triangles, colours: None };
        let solid = DistanceSolid::build(&mesh, &Job::default()).expect("built");
        let plane = ProjectionPlane::along(DVec3::NEG_Z, 0.0).expect("a plane");
        let shadow = outline_of(&solid.topology, &solid.positions(), &plane);
        assert!(shadow.strip > 0.0 && shadow.standard_error > 0.0);
        let area: f64 = shadow.regions.iter().map(PlaneRegion::area).sum();
        let want = crate::measure::projected_area(&mesh, glam::Vec3::Z, &Job::default());
        let want = want.expect("not cancelled");
        let near = 4.0 * shadow.standard_error + 1e-3 * want;
        assert!((area - want).abs() < near, "{area} instead of {want}, +- {near}");
    }
}
