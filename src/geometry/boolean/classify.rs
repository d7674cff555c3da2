//! Where each part of a surface lies relative to the other solid. Faces in contact are found by
//! equal borders; every other connected part between cuts is classified by one winding number, and
//! then checked by the winding numbers of samples on it.

use glam::DVec3;
use rayon::prelude::*;
use robust::orient3d;

use super::common::{FEW, join_where};
use super::pieces::{FacePiece, Placement, triangles as parts_of};
use super::points::{Map, PointSet};
use crate::PolyMesh;
use crate::boolean::box_tree::{Span, SpanTree};
use crate::boolean::broad_phase::SurfaceView;
use crate::boolean::intersect::{Intersections, c3};
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;
use crate::triangulate::area_vector;

/// The whole of a surface of which an operand is only a part.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// Returns the winding number of the whole around a point.
    pub winding: &'a (dyn Fn(DVec3) -> i32 + Sync),
    /// A box around the whole, where one is known.
    pub bounds: Option<Span>,
    /// The number of pieces, and of faces, of a surface that are classified again.
    pub samples: usize,
}

/// Placements of the faces that nothing cuts: each has that of the connected part that it is in.
#[derive(Debug, Default)]
pub struct Classification {
    /// Part of each face; `NONE` for faces that are in pieces.
    part: Vec<u32>,
    placements: Vec<Placement>,
}

const NONE: u32 = u32::MAX;
/// Of a face with a corner beyond the other's box, until its part has a number.
const FAR: u32 = u32::MAX - 1;

impl std::fmt::Debug for Around<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Around").field("bounds", &self.bounds).finish_non_exhaustive()
    }
}

impl Classification {
    /// Returns the placement of a face; `None` for a face that is in pieces.
    pub fn of(&self, face: u32) -> Option<Placement> {
        self.placements.get(self.part[face as usize] as usize).copied()
    }
}

/// One name for a piece's borders, whichever way they run, and whether it was turned.
pub(super) fn key(loops: &[&[u32]], reverse: bool) -> Vec<u32> {
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
    rings.join(&NONE)
}

/// Decides the place of every piece, and of the faces that are in none.
pub fn classify(
    meshes: &[PolyMesh; 2],
    triangles: &[Vec<[u32; 3]>; 2],
    bounds: [Span; 2],
    pieces: &mut [Vec<FacePiece>; 2],
    m: &Intersections,
    points: &PointSet,
    around: Option<Around<'_>>,
    job: &Job,
) -> Result<([Classification; 2], Option<String>), Cancelled> {
    let mut contact: Map<Vec<u32>, usize> = Map::default();
    let shared = |p: u32| m.shared[p as usize];
    let touches = |loops: &[&[u32]]| loops.iter().all(|l| l.iter().all(|&v| shared(v)));
    for (i, p) in pieces[0].iter().enumerate() {
        let loops = p.loops(|f| meshes[0].face(f as usize));
        if touches(&loops) {
            contact.insert(key(&loops, false), i);
        }
    }
    job.check()?;
    let mut settled = [vec![false; pieces[0].len()], vec![false; pieces[1].len()]];
    for i in 0..pieces[1].len() {
        let loops = pieces[1][i].loops(|f| meshes[1].face(f as usize));
        if !touches(&loops) {
            continue;
        }
        for (reverse, place) in [(false, Placement::Same), (true, Placement::Against)] {
            if let Some(&j) = contact.get(&key(&loops, reverse)) {
                pieces[1][i].place = place;
                pieces[0][j].place = place;
                settled[0][j] = true;
                settled[1][i] = true;
                break;
            }
        }
    }
    job.check()?;
    let [first, second] = pieces;
    let one = |s: usize, pieces: &mut [FacePiece]| {
        let surface = SurfaceView { triangles: &triangles[1 - s], at: &points.at, base: 0 };
        let mut other = WindingOracle::new(surface, bounds[1 - s], points.tolerance());
        other.of_patch = around.map(|a| a.samples);
        if let Some(whole) = around.filter(|_| s == 1) {
            other = other.within(whole);
        }
        one_side(&meshes[s], pieces, &settled[s], m, &points.at, other, job)
    };
    let large = triangles.iter().any(|t| t.len() >= FEW);
    let (a, b) = join_where(large, || one(0, first), || one(1, second));
    let ((a, first), (b, second)) = (a?, b?);
    Ok(([a, b], first.or(second)))
}

/// The data of a connected part.
#[derive(Clone, Copy)]
struct ConnectedPart {
    /// True if it is beyond the other's box, so that no test is needed.
    beyond: bool,
    /// The largest triangle so far, and a place in it.
    size: f64,
    spot: DVec3,
}

fn one_side(
    mesh: &PolyMesh,
    pieces: &mut [FacePiece],
    settled: &[bool],
    m: &Intersections,
    at: &[DVec3],
    mut other: WindingOracle<'_>,
    job: &Job,
) -> Result<(Classification, Option<String>), Cancelled> {
    let shared = |v: u32| m.shared[v as usize];
    let base = at.len() as u32;
    // Places beyond the other's box are in one set, whatever joins them: what hangs together with
    // them is outside, and needs no further look.
    let beyond = base + pieces.len() as u32;
    let is_beyond: Vec<bool> = at.par_iter().with_min_len(FEW).map(|p| other.beyond(*p)).collect();
    let mut sets = DisjointSets::new(at.len() + pieces.len() + 1);
    let mut part = vec![0; mesh.face_count()];
    pieces.iter().for_each(|p| part[p.face as usize] = NONE);
    for (f, corners) in mesh.faces().enumerate() {
        if f % 65_536 == 0 {
            job.check()?;
        }
        if part[f] == NONE || corners.is_empty() {
            part[f] = NONE;
            continue;
        }
        // No corner of these is on the other surface.
        if !corners.iter().any(|&v| is_beyond[v as usize]) {
            corners.windows(2).for_each(|w| sets.join(w[0], w[1]));
            continue;
        }
        part[f] = FAR;
        for &v in corners.iter().filter(|v| !is_beyond[**v as usize]) {
            sets.join(v, beyond);
        }
    }
    let mut borders: Map<(u32, u32), Vec<u32>> = Map::default();
    for (i, p) in pieces.iter().enumerate().filter(|&(i, _)| !settled[i]) {
        if i % 4096 == 0 {
            job.check()?;
        }
        for l in p.loops(|f| mesh.face(f as usize)) {
            for k in 0..l.len() {
                let (a, b) = (l[k], l[(k + 1) % l.len()]);
                if !shared(a) {
                    sets.join(base + i as u32, if is_beyond[a as usize] { beyond } else { a });
                } else if shared(b) && !m.curve.contains_key(&(a.min(b), a.max(b))) {
                    borders.entry((a.min(b), a.max(b))).or_default().push(i as u32);
                }
            }
        }
    }
    for around in borders.values() {
        around.windows(2).for_each(|w| sets.join(base + w[0], base + w[1]));
    }
    // Number the parts, and find in each the place from which to ask.
    let mut numbers = vec![NONE; at.len() + pieces.len() + 1];
    let mut parts: Vec<ConnectedPart> = Vec::new();
    let mut number = |root: u32, parts: &mut Vec<ConnectedPart>| {
        let n = &mut numbers[root as usize];
        if *n == NONE {
            *n = parts.len() as u32;
            parts.push(ConnectedPart { beyond: false, size: -1.0, spot: DVec3::ZERO });
        }
        *n
    };
    let far = number(sets.root(beyond), &mut parts);
    parts[far as usize].beyond = true;
    for (f, corners) in mesh.faces().enumerate() {
        if f % 65_536 == 0 {
            job.check()?;
        }
        if part[f] == FAR {
            part[f] = far;
            continue;
        }
        if part[f] == NONE {
            continue;
        }
        part[f] = number(sets.root(corners[0]), &mut parts);
        other.look(&mut parts[part[f] as usize], &[corners], at);
    }
    let mut of_piece = vec![NONE; pieces.len()];
    for (i, p) in pieces.iter().enumerate().filter(|&(i, _)| !settled[i]) {
        of_piece[i] = number(sets.root(base + i as u32), &mut parts);
        other.look(&mut parts[of_piece[i] as usize], &p.loops(|f| mesh.face(f as usize)), at);
    }
    let mut placements = Vec::with_capacity(parts.len());
    for p in &parts {
        let inside = !p.beyond && other.winding(p.spot, job)? > 0;
        placements.push(if inside { Placement::Inside } else { Placement::Outside });
    }
    for (p, &n) in pieces.iter_mut().zip(&of_piece) {
        if n != NONE {
            p.place = placements[n as usize];
        }
    }
    // Pieces and faces that were not settled by contact. Pieces are near the other surface, so they
    // are asked even where their part reaches beyond its box: a part that the cut failed to divide
    // does, and is not outside as a whole.
    let asked = |n: u32| n != NONE && !parts[n as usize].beyond;
    let near: Vec<usize> = (0..pieces.len()).filter(|&i| of_piece[i] != NONE).collect();
    let apart: Vec<usize> = if parts.iter().all(|p| p.beyond) {
        Vec::new()
    } else {
        (0..part.len()).filter(|&f| asked(part[f])).collect()
    };
    let count = other.samples(mesh.face_count(), pieces.len());
    let spread = |n: usize| n.div_ceil(count).max(1);
    let samples = near.iter().step_by(spread(near.len())).map(|&i| {
        let loops = pieces[i].loops(|f| mesh.face(f as usize));
        (of_piece[i], probe(&loops, at))
    });
    let samples = samples.chain(
        apart.iter().step_by(spread(apart.len())).map(|&f| (part[f], probe(&[mesh.face(f)], at))),
    );
    let mut doubt = None;
    for (n, (_, place)) in samples {
        let said = placements[n as usize] == Placement::Inside;
        match other.clear_winding(place, job)? {
            Some(winding) if (winding > 0) != said => {
                doubt = Some(format!(
                    "a sample at ({:.6}, {:.6}, {:.6}) is not where its part of the surface is",
                    place.x, place.y, place.z
                ));
                break;
            }
            _ => {}
        }
    }
    Ok((Classification { part, placements }, doubt))
}

/// A solid that answers queries for its winding number.
pub(super) struct WindingOracle<'a> {
    surface: SurfaceView<'a>,
    bounds: Span,
    /// The whole of it, where the surface is a part only.
    around: Option<Around<'a>>,
    /// Samples, where one operand is a patch of a larger surface.
    of_patch: Option<usize>,
    /// The tolerance: nearer to the surface than four of it, nothing is inside or outside.
    eps: f64,
    asked: usize,
    /// Built once there are enough queries to repay it.
    tree: Option<SpanTree>,
}

/// Winding numbers by looking at all triangles; for more a tree is made.
const WITHOUT_TREE: usize = 40;
/// Samples by which the parts of a surface are checked: where few of its faces are near the other
/// surface, and where shells nearly coincide.
const FEW_SAMPLES: usize = 12;
const MANY_SAMPLES: usize = 1500;

impl<'a> WindingOracle<'a> {
    /// A closed surface within `bounds`; `eps` is the tolerance of its corners.
    pub(super) fn new(surface: SurfaceView<'a>, bounds: Span, eps: f64) -> Self {
        // Corners on the surface may be beyond its box by the tolerance.
        let bounds = bounds.grown(4.0 * eps);
        let tree = None;
        WindingOracle { surface, bounds, around: None, of_patch: None, eps, asked: 0, tree }
    }

    /// The surface as a part of a whole.
    fn within(mut self, whole: Around<'a>) -> Self {
        // Without a box, no place is beyond it.
        let endless = Span { lo: DVec3::NEG_INFINITY, hi: DVec3::INFINITY };
        self.bounds = whole.bounds.map_or(endless, |b| b.grown(4.0 * self.eps));
        self.around = Some(whole);
        self
    }

    /// Returns true if a place is beyond the box of the surface, and therefore outside.
    fn beyond(&self, p: DVec3) -> bool {
        !(self.bounds.lo.cmple(p).all() && p.cmple(self.bounds.hi).all())
    }

    fn look(&self, part: &mut ConnectedPart, loops: &[&[u32]], at: &[DVec3]) {
        if part.beyond {
            return;
        }
        if loops[0].iter().any(|v| self.beyond(at[*v as usize])) {
            part.beyond = true;
            return;
        }
        let (size, spot) = probe(loops, at);
        if size > part.size {
            (part.size, part.spot) = (size, spot);
        }
    }

    /// Returns the number of pieces, and of faces, of a surface to classify again separately.
    fn samples(&self, faces: usize, pieces: usize) -> usize {
        if let Some(samples) = self.of_patch {
            // The parts of a patch are small, most of its faces are cut, and its border is checked.
            samples
        } else if pieces * 4 > faces && pieces > 64 {
            MANY_SAMPLES
        } else if self.surface.triangles.len() > 100_000 {
            FEW_SAMPLES / 3
        } else {
            FEW_SAMPLES
        }
    }

    /// As [`WindingOracle::winding`], but None for a point so near to the surface that the
    /// tolerance decides where it is.
    pub(super) fn clear_winding(&mut self, o: DVec3, job: &Job) -> Result<Option<i32>, Cancelled> {
        let winding = self.winding(o, job)?;
        let slack = 4.0 * self.eps;
        let near = |t: u32| distance_squared(self.surface.corners(t), o) <= slack * slack;
        let span = Span { lo: o - slack, hi: o + slack };
        let close = match &self.tree {
            Some(tree) => tree.any_meets(&span, near),
            None => {
                let all = 0..self.surface.triangles.len() as u32;
                all.into_par_iter()
                    .with_min_len(1 << 13)
                    .any(|t| self.surface.span(t).meets(&span) && near(t))
            }
        };
        Ok((!close).then_some(winding))
    }

    /// Returns the winding number of the surface around a point.
    fn winding(&mut self, o: DVec3, job: &Job) -> Result<i32, Cancelled> {
        job.check()?;
        if self.beyond(o) {
            return Ok(0);
        }
        if let Some(whole) = self.around {
            return Ok((whole.winding)(o));
        }
        self.asked += 1;
        if self.asked > WITHOUT_TREE && self.tree.is_none() {
            let count = self.surface.triangles.len() as u32;
            let spans = (0..count).into_par_iter().with_min_len(FEW);
            let spans: Vec<Span> = spans.map(|t| self.surface.span(t)).collect();
            self.tree = Some(SpanTree::build(&spans, job)?);
        }
        let reach = (self.bounds.hi - self.bounds.lo).length() * 2.0;
        Ok(crossings(o, reach, |p, visit| match &self.tree {
            Some(tree) => tree.along(o, p, |t| visit(self.surface.corners(t))),
            None => {
                let inverse = 1.0 / (p - o);
                let near = |t: &[u32; 3]| {
                    let c = t.map(|v| self.surface.at[v as usize]);
                    let lo = (c[0].min(c[1]).min(c[2]) - o) * inverse;
                    let hi = (c[0].max(c[1]).max(c[2]) - o) * inverse;
                    let (near, far) = (lo.min(hi).max_element(), lo.max(hi).min_element());
                    (near.max(0.0) <= far.min(1.0) + 1e-9).then_some(c)
                };
                let all = self.surface.triangles.par_iter().with_min_len(1 << 13);
                let found: Vec<[DVec3; 3]> = all.filter_map(near).collect();
                found.into_iter().all(visit);
            }
        }))
    }
}

/// Square of the distance of a point from a triangle (Ericson, Real-Time Collision Detection,
/// 2005, 5.1.5).
fn distance_squared([a, b, c]: [DVec3; 3], p: DVec3) -> f64 {
    let on_edge = |x: DVec3, y: DVec3| {
        let d = y - x;
        let t = ((p - x).dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (x + d * t).distance_squared(p)
    };
    let n = (b - a).cross(c - a);
    let within = |x: DVec3, y: DVec3| (y - x).cross(p - x).dot(n) >= 0.0;
    if n != DVec3::ZERO && within(a, b) && within(b, c) && within(c, a) {
        let d = (p - a).dot(n);
        return d * d / n.length_squared();
    }
    on_edge(a, b).min(on_edge(b, c)).min(on_edge(c, a))
}

/// A place in a triangle with weights that are unlikely to be on an edge of the other surface.
fn within(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    a * 0.414_213_562_373_095 + b * 0.267_949_192_431_123 + c * 0.317_837_245_195_782
}

/// Returns a point inside the piece and its clearance.
pub(super) fn probe(loops: &[&[u32]], at: &[DVec3]) -> (f64, DVec3) {
    let l = loops[0];
    if l.len() == 3 && loops.len() == 1 {
        let [a, b, c] = [l[0], l[1], l[2]].map(|i| at[i as usize]);
        return ((b - a).cross(c - a).length(), within(a, b, c));
    }
    let n: DVec3 = loops.iter().map(|l| area_vector(at, l)).sum();
    let mut best = (-1.0, at[l[0] as usize]);
    for t in parts_of(loops, n, at) {
        let [a, b, c] = t.map(|i| at[i as usize]);
        let size = (b - a).cross(c - a).length();
        if size > best.0 {
            best = (size, within(a, b, c));
        }
    }
    best
}

/// Returns the signed crossings of a segment of length `reach` that leaves the surface's box,
/// decided exactly. If the segment meets an edge, another direction is tried. `along` passes the
/// triangles near the segment to `o`'s far end until its callback returns false.
pub fn crossings(
    o: DVec3,
    reach: f64,
    along: impl Fn(DVec3, &mut dyn FnMut([DVec3; 3]) -> bool),
) -> i32 {
    for attempt in 0..64 {
        let k = attempt as f64;
        let d = DVec3::new(
            (k * 1.7 + 0.4).portable_sin(),
            (k * 2.3 + 1.1).portable_sin(),
            (k * 0.9 + 2.2).portable_cos(),
        );
        let p = o + d.normalize_or(DVec3::X) * reach;
        let (mut sum, mut good) = (0, true);
        along(p, &mut |[a, b, c]| {
            let (x, y) =
                (orient3d(c3(a), c3(b), c3(c), c3(o)), orient3d(c3(a), c3(b), c3(c), c3(p)));
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
