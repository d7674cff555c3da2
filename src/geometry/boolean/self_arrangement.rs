//! A surface that crosses itself as the solid of all places that it goes around, by an arrangement
//! of the surface with itself (Zhou, Grinspun, Zorin and Jacobson, "Mesh arrangements for solid
//! geometry", 2016): triangles are cut where they cross, cells that hang together at edges of two
//! have one winding number on each side, and those stay that have the solid on one side only.
//!
//! Points are rounded to doubles as they are made, unlike in that paper, so there are surfaces for
//! which the cells do not fit together. Then the result is not closed or fails the caller's
//! comparison, and the exact engine of [`super::global`] is asked.

use std::cell::Cell;

use glam::DVec3;
use rayon::prelude::*;

use super::box_tree::{Span, SpanTree};
use super::classify::{crossings, key, probe};
use super::emit::{self, FaceOrigin};
use super::intersect::{Intersections, intersect_itself};
use super::pieces::{ring, triangles as parts_of};
use super::planar::{cells, flatten};
use super::points::{Map, PointSet};
use super::self_cuts::SelfCuts;
use super::{attributes, simplify};
use crate::PolyMesh;
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// The number of coplanar triangles that is always allowed, however few triangles there are.
const FEW_FLAT: usize = 64;

/// A triangle that nothing cuts, or a cell of one.
struct SelfCell {
    triangle: u32,
    /// Its border and its holes; of a whole triangle none.
    loops: Vec<Vec<u32>>,
    /// The multiplicity: coincident cells are one, and those with the opposite direction subtract.
    times: i32,
    /// Other triangles that have such a cell.
    also: Vec<u32>,
}

/// The surface over separate points, cut at itself.
struct SelfArrangement {
    points: PointSet,
    triangles: Vec<[u32; 3]>,
    /// Face of each triangle.
    faces: Vec<u32>,
    cells: Vec<SelfCell>,
    /// Points below this are the mesh's.
    own: usize,
}

/// The solid that the closed `mesh` goes around, in triangles with the colours and groups of their
/// faces, and the face that each came from. Places nearer than `eps` are one. The inner error says
/// why the cells do not fit.
pub fn solid(
    mesh: &PolyMesh,
    eps: f64,
    job: &Job,
) -> Result<Result<(PolyMesh, Vec<FaceOrigin>), String>, Cancelled> {
    let Some(a) = SelfArrangement::new(mesh, eps, job)? else {
        return Ok(Err("many faces lie in one plane".into()));
    };
    let kept = a.kept(job)?;
    let (mut out, mut origins) = (PolyMesh::new(), Vec::new());
    let mut cut = Vec::new();
    for (cell, turned) in a.cells.iter().zip(kept).filter_map(|(c, k)| k.map(|k| (c, k))) {
        let origin = FaceOrigin { operand: 0, face: a.faces[cell.triangle as usize] };
        let way = |t: [u32; 3]| if turned { [t[0], t[2], t[1]] } else { t };
        if cell.loops.is_empty() {
            out.push_face(&way(a.triangles[cell.triangle as usize]));
            origins.push(origin);
            continue;
        }
        for t in parts_of(&a.loops(cell), a.normal(cell.triangle), &a.points.at) {
            cut.push(simplify::CutFace { origin, corners: way(t).to_vec() });
        }
    }
    job.check()?;
    let group = |o| simplify::group_of([mesh, mesh], o);
    for (origin, t) in simplify::retriangulated(&cut, a.own, &a.points.at, 4.0 * eps, group) {
        out.push_face(&t);
        origins.push(origin);
    }
    let facts = emit::finish(&mut out, &a.points.at, job)?;
    if !facts.closed {
        return Ok(Err("the solved surface is not closed".into()));
    }
    if facts.components > 1 {
        // Shells thinner than the rounding of their corners: cells that were no solid before.
        emit::drop_thin_shells(&mut out, &mut origins, 8.0 * eps);
    }
    attributes::carry(&mut out, &origins, [mesh, mesh]);
    Ok(Ok((out, origins)))
}

impl SelfArrangement {
    /// None where so many faces lie upon each other that rounded points hardly ever fit.
    fn new(mesh: &PolyMesh, eps: f64, job: &Job) -> Result<Option<SelfArrangement>, Cancelled> {
        let (all, of) = mesh.triangles();
        let mut points = PointSet::new(mesh.positions.clone(), eps);
        let own = points.at.len();
        let names: Vec<u32> = (0..own as u32).map(|v| points.list(v)).collect();
        let (mut triangles, mut faces) = (Vec::new(), Vec::new());
        for (t, f) in all.iter().zip(of) {
            let [a, b, c] = t.map(|v| names[v as usize]);
            if a != b && b != c && c != a {
                triangles.push([a, b, c]);
                faces.push(f);
            }
        }
        job.check()?;
        let pairs = self_intersection::near_pairs(&points.at, &triangles, 2.0 * eps, job)?;
        let mut m = intersect_itself(&triangles, pairs, &mut points, eps, job)?;
        let flat = m.marks[0].values().filter(|k| k.flat).count();
        if flat > FEW_FLAT && flat * 4 > triangles.len() {
            return Ok(None);
        }
        let cuts = SelfCuts::divided(&triangles, &mut m, &mut points, eps, job)?;
        let mut out = SelfArrangement { points, triangles, faces, cells: Vec::new(), own };
        out.cut(&m, &cuts, job)?;
        out.join_coincident(&m);
        Ok(Some(out))
    }

    fn normal(&self, t: u32) -> DVec3 {
        let [a, b, c] = self.triangles[t as usize].map(|v| self.points.at[v as usize]);
        (b - a).cross(c - a)
    }

    fn loops<'a>(&'a self, cell: &'a SelfCell) -> Vec<&'a [u32]> {
        match cell.loops.is_empty() {
            true => vec![&self.triangles[cell.triangle as usize]],
            false => cell.loops.iter().map(Vec::as_slice).collect(),
        }
    }

    /// Every triangle, in cells where something cuts it.
    fn cut(&mut self, m: &Intersections, cuts: &SelfCuts, job: &Job) -> Result<(), Cancelled> {
        for (t, corners) in self.triangles.iter().enumerate() {
            if t % 4096 == 0 {
                job.check()?;
            }
            let triangle = t as u32;
            let border = ring(corners, m);
            let through = cuts.through(triangle);
            let mut push = |loops| {
                self.cells.push(SelfCell { triangle, loops, times: 1, also: Vec::new() });
            };
            if through.is_empty() {
                push(if border.len() == 3 { Vec::new() } else { vec![border] });
                continue;
            }
            let [a, b, c] = corners.map(|v| self.points.at[v as usize]);
            let flat = flatten((b - a).cross(c - a));
            for cell in cells(&border, &through, |v| flat(self.points.at[v as usize])) {
                push(std::iter::once(cell.outer).chain(cell.holes).collect());
            }
        }
        Ok(())
    }

    /// Merges cells that have the same border into the first of them.
    fn join_coincident(&mut self, m: &Intersections) {
        let mut first: Map<Vec<u32>, usize> = Map::default();
        for i in 0..self.cells.len() {
            let cell = &self.cells[i];
            if !m.marks[0].contains_key(&cell.triangle) {
                continue;
            }
            let loops = self.loops(cell);
            let (along, against) = (key(&loops, false), key(&loops, true));
            let known = |k: &Vec<u32>| first.get(k).copied();
            let (other, by) = match (known(&along), known(&against)) {
                (Some(other), _) => (other, 1),
                (None, Some(other)) => (other, -1),
                (None, None) => {
                    first.insert(along, i);
                    continue;
                }
            };
            let triangle = cell.triangle;
            self.cells[i].times = 0;
            self.cells[other].times += by;
            self.cells[other].also.push(triangle);
        }
        self.cells.retain(|c| c.times != 0);
    }

    /// The connected part of each cell: parts end at edges of more than two cells.
    fn parts(&self) -> Vec<u32> {
        let mut half: Vec<(u32, u32, u32, bool)> = Vec::new();
        for (i, cell) in self.cells.iter().enumerate() {
            for l in self.loops(cell) {
                for k in 0..l.len() {
                    let (a, b) = (l[k], l[(k + 1) % l.len()]);
                    half.push((a.min(b), a.max(b), i as u32, a < b));
                }
            }
        }
        half.par_sort_unstable();
        let mut sets = DisjointSets::new(self.cells.len());
        for edge in half.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            if let [x, y] = edge
                && x.3 != y.3
                && self.cells[x.2 as usize].times == self.cells[y.2 as usize].times
            {
                sets.join(x.2, y.2);
            }
        }
        (0..self.cells.len() as u32).map(|i| sets.root(i)).collect()
    }

    /// Of each cell, whether it bounds the solid, and whether it is turned for that.
    fn kept(&self, job: &Job) -> Result<Vec<Option<bool>>, Cancelled> {
        let part = self.parts();
        // The cell from which to ask, a place in it and how large it is.
        let mut best: Vec<(f64, DVec3, u32)> = vec![(-1.0, DVec3::ZERO, 0); self.cells.len()];
        for (i, cell) in self.cells.iter().enumerate() {
            if i % 4096 == 0 {
                job.check()?;
            }
            let (size, place) = probe(&self.loops(cell), &self.points.at);
            let slot = &mut best[part[i] as usize];
            if size > slot.0 {
                *slot = (size, place, i as u32);
            }
        }
        let spans: Vec<Span> = self
            .triangles
            .iter()
            .map(|t| Span::of(t.map(|v| self.points.at[v as usize])))
            .collect();
        let tree = SpanTree::build(&spans, job)?;
        let size = Span::of(self.points.at.iter().copied());
        let reach = (size.hi - size.lo).length() * 2.0;
        let asked: Vec<u32> = (0..part.len() as u32).filter(|&i| part[i as usize] == i).collect();
        let told: Result<Vec<Option<bool>>, Cancelled> = asked
            .par_iter()
            .map(|&i| {
                job.check()?;
                let (_, place, cell) = best[i as usize];
                Ok(self.bounds(&self.cells[cell as usize], place, reach, &tree))
            })
            .collect();
        let told = told?;
        let answer = |root: u32| asked.binary_search(&root).ok().and_then(|k| told[k]);
        Ok(part.into_iter().map(answer).collect())
    }

    /// Returns whether a cell bounds the solid, and its direction. It compares the winding numbers
    /// on both sides of a place in the cell: the ray leaves on one side, and the other side differs
    /// by one.
    fn bounds(&self, cell: &SelfCell, place: DVec3, reach: f64, tree: &SpanTree) -> Option<bool> {
        let far = Cell::new(place);
        let sum = crossings(place, reach, |end, visit| {
            far.set(end);
            tree.along(place, end, |t| {
                t == cell.triangle
                    || cell.also.contains(&t)
                    || visit(self.triangles[t as usize].map(|v| self.points.at[v as usize]))
            });
        });
        let outwards = (far.get() - place).dot(self.normal(cell.triangle)) > 0.0;
        let (front, back) =
            if outwards { (sum, sum + cell.times) } else { (sum - cell.times, sum) };
        ((front > 0) != (back > 0)).then_some(front > 0)
    }
}
