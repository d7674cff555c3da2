//! Where each part of a surface lies as seen from the other solid: faces in contact by their
//! borders, all else by one winding number for each part that the cut leaves connected.

use glam::DVec3;
use rayon::prelude::*;
use robust::orient3d;

use crate::disjoint_sets::DisjointSets;
use super::arrange::Around;
use super::pieces::{Piece, Place, triangles as parts_of};
use super::points::{Map, Points};
use crate::PolyMesh;
use crate::boolean::box_tree::{Span, Tree};
use crate::boolean::broad_phase::Surface;
use crate::boolean::intersect::{Meeting, c3};
use crate::job::{Cancelled, Job};
use crate::triangulate::area_vector;

/// Places of the faces that nothing cuts, each that of the connected part that it is in.
#[derive(Debug, Default)]
pub struct Fates {
    /// Part of each face; `NONE` for faces that are in pieces.
    part: Vec<u32>,
    places: Vec<Place>,
}

const NONE: u32 = u32::MAX;

impl Fates {
    pub fn of(&self, face: u32) -> Option<Place> {
        self.places.get(self.part[face as usize] as usize).copied()
    }
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
    rings.join(&NONE)
}

/// Decides the place of every piece, and of the faces that are in none.
pub fn place(
    meshes: &[PolyMesh; 2],
    triangles: &[Vec<[u32; 3]>; 2],
    bounds: [Span; 2],
    pieces: &mut [Vec<Piece>; 2],
    m: &Meeting,
    points: &Points,
    around: Option<Around<'_>>,
    job: &Job,
) -> Result<[Fates; 2], Cancelled> {
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
    job.check()?;
    let [first, second] = pieces;
    let one = |s: usize, pieces: &mut [Piece]| {
        let other = Other {
            surface: Surface { triangles: &triangles[1 - s], at: &points.at, base: 0 },
            // Corners on its surface may be beyond its box by the tolerance.
            bounds: bounds[1 - s].grown(4.0 * points.tolerance()),
            around: around.filter(|_| s == 1),
            asked: 0,
            tree: None,
        };
        one_side(&meshes[s], pieces, &settled[s], m, &points.at, other, job)
    };
    let (a, b) = rayon::join(|| one(0, first), || one(1, second));
    Ok([a?, b?])
}

/// What is known of a connected part.
#[derive(Clone, Copy)]
struct Part {
    /// Beyond the other's box: no more is asked.
    beyond: bool,
    /// The largest triangle so far, and a place in it.
    size: f64,
    spot: DVec3,
}

fn one_side(
    mesh: &PolyMesh,
    pieces: &mut [Piece],
    settled: &[bool],
    m: &Meeting,
    at: &[DVec3],
    mut other: Other<'_>,
    job: &Job,
) -> Result<Fates, Cancelled> {
    let shared = |v: u32| m.shared[v as usize];
    let base = at.len() as u32;
    let mut sets = DisjointSets::new(at.len() + pieces.len());
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
        corners.windows(2).for_each(|w| sets.join(w[0], w[1]));
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
                    sets.join(base + i as u32, a);
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
    let mut numbers = vec![NONE; at.len() + pieces.len()];
    let mut parts: Vec<Part> = Vec::new();
    let mut number = |root: u32, parts: &mut Vec<Part>| {
        let n = &mut numbers[root as usize];
        if *n == NONE {
            *n = parts.len() as u32;
            parts.push(Part { beyond: false, size: -1.0, spot: DVec3::ZERO });
        }
        *n
    };
    for (f, corners) in mesh.faces().enumerate() {
        if f % 65_536 == 0 {
            job.check()?;
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
    let mut places = Vec::with_capacity(parts.len());
    for p in &parts {
        let inside = !p.beyond && other.winding(p.spot, job)? > 0;
        places.push(if inside { Place::Inside } else { Place::Outside });
    }
    for (p, n) in pieces.iter_mut().zip(of_piece) {
        if n != NONE {
            p.place = places[n as usize];
        }
    }
    Ok(Fates { part, places })
}

/// The solid that is asked.
struct Other<'a> {
    surface: Surface<'a>,
    bounds: Span,
    /// The whole of it, where the surface is a part only.
    around: Option<Around<'a>>,
    asked: usize,
    /// Once so many ask that it is worth it.
    tree: Option<Tree>,
}

/// Winding numbers by looking at all triangles; for more a tree is made.
const WITHOUT_TREE: usize = 12;

impl Other<'_> {
    fn look(&self, part: &mut Part, loops: &[&[u32]], at: &[DVec3]) {
        if part.beyond {
            return;
        }
        let within = |v: &u32| {
            let p = at[*v as usize];
            self.bounds.lo.cmple(p).all() && p.cmple(self.bounds.hi).all()
        };
        if self.around.is_none() && !loops[0].iter().all(within) {
            part.beyond = true;
            return;
        }
        let (size, spot) = probe(loops, at);
        if size > part.size {
            (part.size, part.spot) = (size, spot);
        }
    }

    /// How often the surface goes around a point.
    fn winding(&mut self, o: DVec3, job: &Job) -> Result<i32, Cancelled> {
        job.check()?;
        if let Some(around) = self.around {
            return Ok(around(o));
        }
        if !(self.bounds.lo.cmple(o).all() && o.cmple(self.bounds.hi).all()) {
            return Ok(0);
        }
        self.asked += 1;
        if self.asked > WITHOUT_TREE && self.tree.is_none() {
            let count = self.surface.triangles.len() as u32;
            let spans: Vec<Span> =
                (0..count).into_par_iter().map(|t| self.surface.span(t)).collect();
            self.tree = Some(Tree::build(&spans, job)?);
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

/// A place in a triangle that nobody draws an edge through: an edge of the other surface may lie in
/// this one.
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
    for t in parts_of(loops, n, at) {
        let [a, b, c] = t.map(|i| at[i as usize]);
        let size = (b - a).cross(c - a).length();
        if size > best.0 {
            best = (size, within(a, b, c));
        }
    }
    best
}

/// Signed crossings of a segment of length `reach` that leaves the surface's box, decided exactly;
/// a segment that meets an edge is tried anew in another direction. `along` shows the triangles
/// near the segment to `o`'s far end until told false.
pub fn crossings(
    o: DVec3,
    reach: f64,
    along: impl Fn(DVec3, &mut dyn FnMut([DVec3; 3]) -> bool),
) -> i32 {
    for attempt in 0..64 {
        let k = attempt as f64;
        let d = DVec3::new((k * 1.7 + 0.4).sin(), (k * 2.3 + 1.1).sin(), (k * 0.9 + 2.2).cos());
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
