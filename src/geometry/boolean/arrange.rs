//! Both surfaces cut at each other and each piece classified: every result is a selection of these
//! pieces.

use glam::DVec3;

use super::Operation;
use super::common::{Common, common};
use super::curve::chains;
use super::emit::FaceOrigin;
use super::merge::{self, ResultPolygon};
use super::pieces::{self, FacePiece, PieceShape};
use super::points::PointSet;
use crate::PolyMesh;
use crate::boolean::classify::{Around, Classification, classify};
use crate::boolean::intersect;
use crate::boolean::intersect::Intersections;
use crate::job::{Cancelled, Job};

/// The relation of a result's face to the operand's face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceState {
    /// The face unchanged.
    Whole,
    /// The whole face, or a triangle of it, with reversed orientation.
    Turned,
    /// A part of it, or the whole with more corners.
    Cut,
}

/// Both operands over common points, each face cut where the other surface crosses it, and each
/// piece classified.
#[derive(Debug)]
pub struct Arrangement {
    /// The positions of all corners.
    pub points: PointSet,
    /// The operands, corners over the common points.
    pub meshes: [PolyMesh; 2],
    triangles: [Vec<[u32; 3]>; 2],
    starts: [Vec<u32>; 2],
    /// Pieces of the faces that the other operand cuts or may cut.
    pieces: [Vec<FacePiece>; 2],
    /// Classification of all other faces.
    classification: [Classification; 2],
    meeting: Intersections,
    /// Corners below this are the operands' own: those of A, then those of B.
    pub own: usize,
    /// Why the parts of the surfaces are not where their samples say, if so.
    pub doubt: Option<String>,
    eps: f64,
    floor: f64,
}

impl Arrangement {
    /// `eps`: places nearer than this are one; `floor`: what rounding alone does. `around`: for a
    /// patch of A, the whole of it.
    pub fn new(
        operands: [&PolyMesh; 2],
        eps: f64,
        floor: f64,
        around: Option<Around<'_>>,
        job: &Job,
        lap: &mut dyn FnMut(&'static str),
    ) -> Result<Arrangement, Cancelled> {
        Arrangement::of(common(operands, eps, job, lap)?, eps, floor, around, job, lap)
    }

    /// The same, of operands that are already over common points.
    pub(super) fn of(
        common: Common,
        eps: f64,
        floor: f64,
        around: Option<Around<'_>>,
        job: &Job,
        lap: &mut dyn FnMut(&'static str),
    ) -> Result<Arrangement, Cancelled> {
        let Common { mut points, meshes, triangles, starts, bounds, pairs, .. } = common;
        let own = points.at.len();
        job.progress(0.2);
        let meeting =
            intersect::intersect([&triangles[0], &triangles[1]], pairs, &mut points, eps, job)?;
        lap("intersect");
        job.progress(0.5);
        let mut pieces: [Vec<FacePiece>; 2] = [Vec::new(), Vec::new()];
        for s in 0..2 {
            let flat = |f: usize| merge::is_flat(&meshes[s], f, &points.at, 4.0 * floor);
            let cut = pieces::cut(
                &meshes[s],
                s,
                &triangles[s],
                &starts[s],
                &meeting,
                &points.at,
                flat,
                job,
            );
            pieces[s] = cut?;
        }
        lap("cut");
        let (classification, doubt) =
            classify(&meshes, &triangles, bounds, &mut pieces, &meeting, &points, around, job)?;
        lap("classify");
        job.progress(0.8);
        Ok(Arrangement {
            points,
            meshes,
            triangles,
            starts,
            pieces,
            classification,
            meeting,
            own,
            doubt,
            eps,
            floor,
        })
    }

    /// Calls `take(origin, corners, state)` for each face of a result. A cancelled job leaves faces
    /// out.
    pub fn faces(
        &self,
        operation: Operation,
        keep_contact: bool,
        job: &Job,
        mut take: impl FnMut(FaceOrigin, &[u32], FaceState),
    ) {
        let takes = |s: usize, place| operation.takes(s, place, keep_contact);
        let flat = |s: usize, f: u32| {
            merge::is_flat(&self.meshes[s], f as usize, &self.points.at, 4.0 * self.floor)
        };
        let mut used = vec![false; self.own];
        let mut back = Vec::new();
        let mut give = |origin, corners: &[u32], turned: bool, whole: bool| {
            let state = match (whole, turned) {
                (false, _) => FaceState::Cut,
                (true, true) => FaceState::Turned,
                (true, false) => FaceState::Whole,
            };
            if turned {
                back.clear();
                back.extend(corners.iter().rev());
                take(origin, &back, state);
            } else {
                take(origin, corners, state);
            }
        };
        for s in 0..2 {
            let mut pieces = self.pieces[s].iter().peekable();
            for face in 0..self.meshes[s].face_count() as u32 {
                if face % 65_536 == 0 && job.cancelled() {
                    return;
                }
                let mut whole = self.classification[s].of(face);
                while let Some(p) = pieces.next_if(|p| p.face == face) {
                    whole = matches!(p.shape, PieceShape::Whole).then_some(p.place);
                }
                let Some(turned) = whole.and_then(|place| takes(s, place)) else { continue };
                let corners = self.meshes[s].face(face as usize);
                corners.iter().for_each(|&v| used[v as usize] = true);
                let origin = FaceOrigin { operand: s as u8, face };
                // A bent face seen from behind may come in other triangles: then these are what is
                // turned.
                if turned && corners.len() > 3 && !flat(s, face) {
                    let (first, last) =
                        (self.starts[s][face as usize], self.starts[s][face as usize + 1]);
                    for t in &self.triangles[s][first as usize..last as usize] {
                        give(origin, t, true, true);
                    }
                } else {
                    give(origin, corners, turned, true);
                }
            }
        }
        let mut cut: Vec<ResultPolygon> = Vec::new();
        let mut turns = Vec::new();
        for s in 0..2 {
            let cells: Vec<&FacePiece> =
                self.pieces[s].iter().filter(|p| !matches!(p.shape, PieceShape::Whole)).collect();
            // Cells of one face with one classification are joined again.
            for group in cells.chunk_by(|p, q| p.face == q.face) {
                for side in [false, true] {
                    let own: Vec<&FacePiece> =
                        group.iter().copied().filter(|p| takes(s, p.place) == Some(side)).collect();
                    if let Some(first) = own.first() {
                        let made = merge::polygons(
                            s as u8,
                            first.face,
                            &own,
                            flat(s, first.face),
                            &self.points.at,
                        );
                        turns.resize(turns.len() + made.len(), side);
                        cut.extend(made);
                    }
                }
            }
        }
        let kept = |v: u32| used.get(v as usize).copied().unwrap_or(false);
        merge::straighten(&mut cut, &self.meshes, kept, &self.points.at, self.eps);
        for (p, turned) in cut.iter().zip(turns) {
            give(FaceOrigin { operand: p.side, face: p.face }, &p.corners, turned, false);
        }
    }

    /// Of each point, whether both surfaces have it.
    pub fn on_both(&self) -> &[bool] {
        &self.meeting.shared
    }

    /// The curve in which the surfaces meet, in polylines; see `chains`.
    pub fn curve(&self) -> Vec<Vec<DVec3>> {
        let mut ends: Vec<(u32, u32)> = self.meeting.curve.keys().copied().collect();
        ends.sort_unstable();
        let place = |i: u32| self.points.at[i as usize];
        chains(&ends).into_iter().map(|c| c.into_iter().map(place).collect()).collect()
    }
}
