//! Both surfaces cut at each other, and each piece in its place: from this every result is chosen.

use glam::DVec3;

use super::Operation;
use super::curve::chains;
use super::emit::Origin;
use super::meet::{self, Meeting, Side};
use super::merge::{self, Polygon};
use super::pieces::{self, Piece, Shape};
use super::points::Points;
use super::tree::{Span, Tree};
use crate::analysis::cancel::{Cancelled, Job};
use crate::mesh::PolyMesh;

/// How often a surface goes around a point, where the operand at hand is only a part of it.
pub type Around<'a> = &'a dyn Fn(DVec3) -> i32;

#[derive(Debug)]
pub struct Arrangement {
    pub points: Points,
    /// The operands, corners over the common points.
    pub meshes: [PolyMesh; 2],
    sides: [Side; 2],
    starts: [Vec<u32>; 2],
    pieces: [Vec<Piece>; 2],
    meeting: Meeting,
    /// Corners below this are the operands' own: those of A, then those of B.
    pub own: usize,
    eps: f64,
    floor: f64,
}

impl Arrangement {
    /// `eps`: places nearer than this are one; `floor`: what rounding alone does. `around`: for a patch of A, the whole of it.
    pub fn new(
        operands: [&PolyMesh; 2],
        eps: f64,
        floor: f64,
        around: Option<Around<'_>>,
        job: &Job,
        lap: &mut dyn FnMut(&'static str),
    ) -> Result<Arrangement, Cancelled> {
        let mut points =
            Points::new(operands.iter().flat_map(|m| m.positions.iter().copied()).collect(), eps);
        let own = points.at.len();
        let meshes = common(operands, &mut points, eps, job)?;
        lap("weld");
        let mut starts: [Vec<u32>; 2] = Default::default();
        let mut build = |s: usize| -> Result<Side, Cancelled> {
            let (side, first) = side(&meshes[s], &points.at, job)?;
            starts[s] = first;
            Ok(side)
        };
        let sides = [build(0)?, build(1)?];
        lap("tree");
        job.progress(0.2);
        let meeting = meet::meet(&sides, &mut points, eps, job)?;
        lap("meet");
        job.progress(0.5);
        let mut pieces: [Vec<Piece>; 2] = [Vec::new(), Vec::new()];
        for s in 0..2 {
            let flat = |f: usize| merge::is_flat(&meshes[s], f, &points.at, 4.0 * floor);
            pieces[s] = pieces::cut(&meshes[s], s, &sides[s], &starts[s], &meeting, &points.at, flat, job)?;
        }
        lap("cut");
        pieces::place(&meshes, &sides, &mut pieces, &meeting, &points, around, job)?;
        lap("place");
        job.progress(0.8);
        Ok(Arrangement { points, meshes, sides, starts, pieces, meeting, own, eps, floor })
    }

    /// Calls `take(origin, corners, whole)` for each face of a result; `whole`: an operand's face as it came.
    pub fn faces(
        &self,
        operation: Operation,
        keep_contact: bool,
        mut take: impl FnMut(Origin, &[u32], bool),
    ) {
        let takes = |s: usize, place| operation.takes(s, place, keep_contact);
        let flat =
            |s: usize, f: u32| merge::is_flat(&self.meshes[s], f as usize, &self.points.at, 4.0 * self.floor);
        let mut used = vec![false; self.own];
        let mut back = Vec::new();
        let mut give = |origin, corners: &[u32], turned: bool, whole: bool| {
            if turned {
                back.clear();
                back.extend(corners.iter().rev());
                take(origin, &back, false);
            } else {
                take(origin, corners, whole);
            }
        };
        for s in 0..2 {
            for p in self.pieces[s].iter().filter(|p| matches!(p.shape, Shape::Whole)) {
                let Some(turned) = takes(s, p.place) else { continue };
                let corners = self.meshes[s].face(p.face as usize);
                corners.iter().for_each(|&v| used[v as usize] = true);
                let origin = Origin { operand: s as u8, face: p.face };
                // A bent face seen from behind may come in other triangles: then these are what is turned.
                if turned && corners.len() > 3 && !flat(s, p.face) {
                    let (first, last) =
                        (self.starts[s][p.face as usize], self.starts[s][p.face as usize + 1]);
                    for t in &self.sides[s].triangles[first as usize..last as usize] {
                        give(origin, t, true, false);
                    }
                } else {
                    give(origin, corners, turned, true);
                }
            }
        }
        let mut cut: Vec<Polygon> = Vec::new();
        let mut turns = Vec::new();
        for s in 0..2 {
            let cells: Vec<&Piece> =
                self.pieces[s].iter().filter(|p| !matches!(p.shape, Shape::Whole)).collect();
            // Cells of one face with one fate are one again.
            for group in cells.chunk_by(|p, q| p.face == q.face) {
                for side in [false, true] {
                    let own: Vec<&Piece> =
                        group.iter().copied().filter(|p| takes(s, p.place) == Some(side)).collect();
                    if let Some(first) = own.first() {
                        let made =
                            merge::polygons(s as u8, first.face, &own, flat(s, first.face), &self.points.at);
                        turns.resize(turns.len() + made.len(), side);
                        cut.extend(made);
                    }
                }
            }
        }
        let kept = |v: u32| used.get(v as usize).copied().unwrap_or(false);
        merge::straighten(&mut cut, &self.meshes, kept, &self.points.at, self.eps);
        for (p, turned) in cut.iter().zip(turns) {
            give(Origin { operand: p.side, face: p.face }, &p.corners, turned, false);
        }
    }

    /// The curve in which the surfaces meet, in polylines; see [`chains`].
    pub fn curve(&self) -> Vec<Vec<DVec3>> {
        let mut ends: Vec<(u32, u32)> = self.meeting.curve.keys().copied().collect();
        ends.sort_unstable();
        let place = |i: u32| self.points.at[i as usize];
        chains(&ends).into_iter().map(|c| c.into_iter().map(place).collect()).collect()
    }
}

/// Both operands over one list of points; those of either that are near the other's box are met by identity.
fn common(
    operands: [&PolyMesh; 2],
    points: &mut Points,
    eps: f64,
    job: &Job,
) -> Result<[PolyMesh; 2], Cancelled> {
    let spans = operands.map(|m| Span::of(m.positions.iter().copied()));
    let both = Span { lo: spans[0].lo.max(spans[1].lo), hi: spans[0].hi.min(spans[1].hi) }.grown(4.0 * eps);
    let mut base = 0u32;
    let mut one = |m: &PolyMesh| -> Result<PolyMesh, Cancelled> {
        job.check()?;
        let names: Vec<u32> = (0..m.positions.len() as u32)
            .map(|i| {
                let p = m.positions[i as usize];
                let near = both.lo.cmple(p).all() && p.cmple(both.hi).all();
                if near { points.list(base + i) } else { base + i }
            })
            .collect();
        base += m.positions.len() as u32;
        let mut out = PolyMesh::new();
        out.corners.reserve(m.corners.len());
        let mut ring: Vec<u32> = Vec::new();
        job.check()?;
        for f in m.faces() {
            ring.clear();
            for &c in f {
                let v = names[c as usize];
                if ring.last() != Some(&v) {
                    ring.push(v);
                }
            }
            while ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            // A face that shrank to an edge keeps its number and has no corners.
            if ring.len() < 3 {
                ring.clear();
            }
            out.push_face(&ring);
        }
        Ok(out)
    };
    Ok([one(operands[0])?, one(operands[1])?])
}

/// Triangles, boxes and the tree of one operand, and the first triangle of each face.
fn side(mesh: &PolyMesh, at: &[DVec3], job: &Job) -> Result<(Side, Vec<u32>), Cancelled> {
    job.check()?;
    let mut triangles = Vec::with_capacity(mesh.corners.len());
    let mut starts = Vec::with_capacity(mesh.face_count() + 1);
    starts.push(0);
    for f in mesh.faces() {
        match *f {
            [] => {}
            [a, b, c] => triangles.push([a, b, c]),
            _ => crate::mesh::triangulate::face(at, f, &mut triangles),
        }
        starts.push(triangles.len() as u32);
    }
    let spans: Vec<Span> = triangles.iter().map(|t| Span::of(t.map(|i| at[i as usize]))).collect();
    let tree = Tree::build(&spans, job)?;
    Ok((Side { triangles, spans, tree }, starts))
}
