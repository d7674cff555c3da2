//! One step of a chain at the cost of its tool's surroundings: only faces that reach the tool's box
//! are arranged with the tool. What replaces them has their border, edge by edge and in the same
//! direction, and is as manifold as they were, so a closed manifold stays one.

use glam::DVec3;

use super::kept::{ChainOrigin, KeptSurface, SurfaceChange, SurfacePatch};
use crate::PolyMesh;
use crate::boolean::arrange::Arrangement;
use crate::boolean::attributes;
use crate::boolean::box_tree::Span;
use crate::boolean::chosen::{ChosenFaces, chosen};
use crate::boolean::classify::Around;
use crate::boolean::common::common;
use crate::boolean::emit::{NOWHERE, separate_patch};
use crate::boolean::points::{Contact, Map};
use crate::boolean::{BooleanOptions, FaceOrigin, Operation, ResultFaces};
use crate::job::{Cancelled, Job};
use crate::triangulate;

/// Pieces of each surface that are classified again; more where the surfaces are in contact.
const SAMPLES: [usize; 2] = [12, 100];

/// With fewer faces, a tool or a patch is small beside any part.
const FEW: usize = 1 << 15;

/// Whether a step with a tool of so many faces may cost less around the tool than as a whole: there
/// a face costs twice as much.
pub(super) fn pays(part: usize, tool: usize) -> bool {
    tool < FEW || 8 * tool < part
}

/// A step: the tool, and how it is joined with the surface.
pub(super) struct LocalStep<'a> {
    pub tool: &'a PolyMesh,
    /// The tool's number in the chain.
    pub number: u32,
    /// Its volume.
    pub volume: f64,
    /// The box around it.
    pub span: Span,
    pub operation: Operation,
    pub options: &'a BooleanOptions,
    /// Length within which places are one, and what rounding alone does.
    pub eps: f64,
    pub floor: f64,
}

/// What a step changes.
pub(super) struct LocalChange {
    pub change: SurfaceChange,
    /// The volume that it adds, and the greatest error of that.
    pub volume: f64,
    pub volume_bound: f64,
    pub contact: Contact,
    /// The cut, as polylines.
    pub cut: Vec<Vec<DVec3>>,
}

impl LocalStep<'_> {
    /// The change of a union or a difference. The inner error says why only the whole can tell.
    pub fn change(
        &self,
        surface: &KeptSurface,
        job: &Job,
        lap: &mut dyn FnMut(&'static str),
    ) -> Result<Result<LocalChange, String>, Cancelled> {
        let LocalStep { tool, operation, options, eps, floor, .. } = *self;
        // A point within the tolerance of a place in the tool's box has all its faces in the patch.
        let reach = self.span.grown(8.0 * eps);
        let patch = surface.patch(&reach);
        lap("gather");
        if patch.faces.len() > 2 * FEW && 2 * patch.faces.len() > surface.face_count() {
            return Ok(Err("the tool reaches most of the part".into()));
        }
        let common = common([&patch.mesh, tool], eps, job, lap)?;
        if common.same_surface {
            return Ok(Err("both are one surface".into()));
        }
        let winding = |p: DVec3| surface.winding(p);
        let around = Around {
            winding: &winding,
            bounds: Some(surface.span),
            samples: SAMPLES[usize::from(common.points.contact.places > 0)],
        };
        let a = Arrangement::of(common, eps, floor, Some(around), job, lap)?;
        if let Some(why) = &a.doubt {
            return Ok(Err(why.clone()));
        }
        let operands = [&patch.mesh, tool];
        let triangles = match options.faces {
            ResultFaces::AsOperands => surface.all_triangles && tool.faces().all(|f| f.len() == 3),
            faces => faces == ResultFaces::Triangles,
        };
        let ChosenFaces { mut mesh, origins } =
            chosen(&a, operands, operation, options, triangles, floor, job)?;
        let own = patch.mesh.positions.len() as u32;
        let inside = |p: DVec3| reach.meets(&Span { lo: p, hi: p });
        let fixed = |v: u32| v < own && !inside(patch.mesh.positions[v as usize]);
        let made = separate_patch(&mut mesh, &a.points.at, fixed, job)?;
        let mut open = made.open;
        open.sort_unstable();
        if open != patch.border() {
            return Ok(Err("the border of the patch is another one".into()));
        }
        let (volume, area) = patch.volume_change(&mesh, self.span);
        let size = Span::of(mesh.positions.iter().copied());
        let slack = self.volume * 5e-13
            + area * floor.max(8.0 * a.points.contact.farthest)
            + (size.hi - size.lo).length().max(0.0).powi(3) * 1e-16;
        let grown = if operation == Operation::Union { volume } else { -volume };
        if !(grown >= -slack && grown <= self.volume + slack) {
            return Ok(Err(format!("the volume changes by {volume:.3e}")));
        }
        let first = surface.next_group;
        attributes::carry_from(&mut mesh, &origins, operands, first);
        let change = patch.replaced(surface, &mesh, &origins, &made.from, self);
        lap("graft");
        let (contact, cut) = (a.points.contact, a.curve());
        Ok(Ok(LocalChange { change, volume, volume_bound: slack, contact, cut }))
    }
}

impl SurfacePatch {
    /// Edges of the faces that lack a partner in the patch, sorted.
    fn border(&self) -> Vec<(u32, u32)> {
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(self.mesh.corners.len());
        for f in self.mesh.faces() {
            for (i, &a) in f.iter().enumerate() {
                let b = f[(i + 1) % f.len()];
                edges.push((a.min(b), a.max(b), a < b));
            }
        }
        edges.sort_unstable();
        let single = |g: &[(u32, u32, bool)]| match *g {
            [(a, b, true)] => Some((a, b)),
            [(a, b, false)] => Some((b, a)),
            _ => None,
        };
        let mut out: Vec<(u32, u32)> =
            edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).filter_map(single).collect();
        out.sort_unstable();
        out
    }

    /// The volume that other faces with the same border add, and the area of both.
    fn volume_change(&self, other: &PolyMesh, about: Span) -> (f64, f64) {
        let centre = (about.lo + about.hi) * 0.5;
        let sum = |mesh: &PolyMesh| {
            let mut parts = Vec::new();
            let (mut volume, mut area) = (0.0, 0.0);
            for f in mesh.faces() {
                parts.clear();
                match *f {
                    [a, b, c] => parts.push([a, b, c]),
                    _ => triangulate::face(&mesh.positions, f, &mut parts),
                }
                for t in &parts {
                    let [a, b, c] = t.map(|v| mesh.positions[v as usize] - centre);
                    let n = (b - a).cross(c - a);
                    (volume, area) = (volume + a.dot(n), area + n.length());
                }
            }
            (volume / 6.0, area / 2.0)
        };
        let (before, after) = (sum(&self.mesh), sum(other));
        (after.0 - before.0, before.1 + after.1)
    }

    /// The faces that go and come where the patch becomes `mesh`, whose vertices were the points
    /// `from`. Faces that are unchanged stay where they are.
    fn replaced(
        &self,
        surface: &KeptSurface,
        mesh: &PolyMesh,
        origins: &[FaceOrigin],
        from: &[u32],
        step: &LocalStep<'_>,
    ) -> SurfaceChange {
        let own = self.vertices.len() as u32;
        let mut change = SurfaceChange {
            removed: Vec::new(),
            positions: Vec::new(),
            colours: mesh.colours.as_ref().map(|_| Vec::new()),
            faces: PolyMesh { attributes: mesh.attributes.clone(), ..PolyMesh::new() },
            origins: Vec::new(),
            span: Span::EMPTY,
            next_group: surface.next_group,
        };
        // The first vertex that a point became is the surface's vertex still. Others are new once a
        // face has them.
        let mut taken: Map<u32, ()> = Map::default();
        let mut names: Vec<u32> = from
            .iter()
            .map(|&p| {
                let first = p != NOWHERE && p < own && taken.insert(p, ()).is_none();
                if first { self.vertices[p as usize] } else { NOWHERE }
            })
            .collect();
        let mut stays = vec![false; self.faces.len()];
        let mut added: Vec<u32> = Vec::new();
        for (f, &FaceOrigin { operand, face }) in origins.iter().enumerate() {
            let same = operand == 0 && !stays[face as usize] && {
                let old = self.mesh.face(face as usize);
                let new = mesh.face(f);
                let is = |(&v, &w): (&u32, &u32)| names[v as usize] == self.vertices[w as usize];
                old.len() == new.len() && new.iter().zip(old).all(is)
            };
            if same {
                stays[face as usize] = true;
            } else {
                added.push(f as u32);
            }
        }
        change.removed.extend((0..stays.len()).filter(|&f| !stays[f]).map(|f| self.faces[f]));
        for &f in &added {
            for &v in mesh.face(f as usize) {
                if names[v as usize] == NOWHERE {
                    names[v as usize] = surface.vertex_count() + change.positions.len() as u32;
                    change.positions.push(mesh.positions[v as usize]);
                    if let (Some(to), Some(of)) = (&mut change.colours, &mesh.colours) {
                        to.push(of[v as usize]);
                    }
                }
                change.faces.corners.push(names[v as usize]);
            }
            change.faces.face_starts.push(change.faces.corners.len() as u32);
            let FaceOrigin { operand, face } = origins[f as usize];
            change.origins.push(match operand {
                0 => surface.origin(self.faces[face as usize]),
                _ => ChainOrigin { operand: step.number, face },
            });
        }
        if let Some(groups) = &mesh.groups {
            change.faces.groups = Some(added.iter().map(|&f| groups[f as usize]).collect());
            let of_tool = step.tool.groups.as_ref().and_then(|g| g.iter().max()).unwrap_or(&0);
            change.next_group += of_tool + 1;
        }
        change.span = Span::of(change.positions.iter().copied());
        change
    }
}
