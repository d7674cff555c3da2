//! A surface that keeps its search trees while parts of it are replaced.
//!
//! Faces and vertices are only added; a face that goes is marked. The trees are static, one for
//! each batch of new triangles, and small ones are joined before they are many (Bentley and Saxe,
//! "Decomposable searching problems I: static-to-dynamic transformation", 1980). So a step costs
//! what it replaces, and a logarithm of the rest.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use crate::boolean::box_tree::{Span, SpanTree};
use crate::boolean::classify::crossings;
use crate::boolean::points::Map;
use crate::job::{Cancelled, Job};
use crate::{FaceAttributes, PolyMesh, triangulate};

/// The operand of a chain, and the face of it, from which a face of the result comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChainOrigin {
    /// 0 for the first solid, then the tools in their order.
    pub operand: u32,
    /// The operand's face.
    pub face: u32,
}

/// A tree over some of the triangles. Those that went stay in it until it is joined with another.
#[derive(Debug)]
struct Level {
    tree: SpanTree,
    triangles: Vec<u32>,
}

/// What was there after a change.
#[derive(Debug, Clone)]
struct Version {
    /// Faces until then, those that were gone included.
    faces: u32,
    coloured: bool,
    grouped: bool,
    /// The names of the groups.
    attributes: Option<Arc<FaceAttributes>>,
}

const THERE: u32 = u32::MAX;

/// A closed surface that is changed in places. What it was before each change can still be read.
#[derive(Debug)]
pub(super) struct KeptSurface {
    at: Vec<DVec3>,
    colours: Option<Vec<[u8; 4]>>,
    starts: Vec<u32>,
    corners: Vec<u32>,
    /// The version from which on a face is gone; `THERE`: it is not.
    until: Vec<u32>,
    origins: Vec<ChainOrigin>,
    groups: Option<Vec<u32>>,
    triangles: Vec<[u32; 3]>,
    /// The face that each triangle is, or is a part of.
    face_of: Vec<u32>,
    /// Larger trees first.
    levels: Vec<Level>,
    /// Faces that are still there.
    live: usize,
    /// One for each change so far, and one for the beginning.
    versions: Vec<Version>,
    /// A box around the surface, or around what it was.
    pub span: Span,
    /// True if all faces are triangles.
    pub all_triangles: bool,
    /// The number of B's group 0, if a tool has groups.
    pub next_group: u32,
}

/// The faces of a surface that reach a box.
pub(super) struct SurfacePatch {
    pub mesh: PolyMesh,
    /// The surface's vertex, of each of the patch.
    pub vertices: Vec<u32>,
    /// The surface's face, of each of the patch.
    pub faces: Vec<u32>,
}

/// A replacement of some faces by others.
pub(super) struct SurfaceChange {
    pub removed: Vec<u32>,
    /// New vertices; their numbers go on from those of the surface.
    pub positions: Vec<DVec3>,
    /// One a new vertex, where there are colours.
    pub colours: Option<Vec<[u8; 4]>>,
    /// New faces, over the surface's vertices. Groups, where there are any; no positions.
    pub faces: PolyMesh,
    pub origins: Vec<ChainOrigin>,
    /// A box around the new vertices.
    pub span: Span,
    /// The number of the next tool's group 0.
    pub next_group: u32,
}

impl KeptSurface {
    /// Keeps a mesh, cut into triangles if `in_triangles`.
    pub fn new(
        mesh: &PolyMesh,
        origins: &[ChainOrigin],
        in_triangles: bool,
        job: &Job,
    ) -> Result<KeptSurface, Cancelled> {
        let groups = mesh.groups.as_ref();
        let mut out = KeptSurface {
            at: mesh.positions.clone(),
            colours: mesh.colours.clone(),
            starts: vec![0],
            corners: Vec::with_capacity(mesh.corners.len()),
            until: Vec::new(),
            origins: Vec::with_capacity(mesh.face_count()),
            groups: groups.map(|_| Vec::new()),
            triangles: Vec::with_capacity(mesh.face_count()),
            face_of: Vec::with_capacity(mesh.face_count()),
            levels: Vec::new(),
            live: 0,
            versions: Vec::new(),
            span: Span::of(mesh.positions.iter().copied()),
            all_triangles: true,
            next_group: groups.map_or(1, |g| g.iter().max().map_or(0, |m| m + 1)),
        };
        let attributes = mesh.attributes.as_ref().filter(|_| groups.is_some()).map(|all| {
            let FaceAttributes { groups, libraries, .. } = all.as_ref().clone();
            Arc::new(FaceAttributes { groups, libraries, ..FaceAttributes::default() })
        });
        let mut parts = Vec::new();
        for (f, corners) in mesh.faces().enumerate() {
            if f % 65_536 == 0 {
                job.check()?;
            }
            let group = groups.and_then(|g| g.get(f)).copied();
            if in_triangles && corners.len() > 3 {
                parts.clear();
                triangulate::face(&mesh.positions, corners, &mut parts);
                parts.iter().for_each(|t| out.push_face(t, origins[f], group));
            } else {
                out.push_face(corners, origins[f], group);
            }
        }
        out.add_level(0, job)?;
        out.note_version(attributes);
        Ok(out)
    }

    fn note_version(&mut self, attributes: Option<Arc<FaceAttributes>>) {
        self.versions.push(Version {
            faces: self.until.len() as u32,
            coloured: self.colours.is_some(),
            grouped: self.groups.is_some(),
            attributes,
        });
    }

    /// The number of changes so far.
    pub fn version(&self) -> usize {
        self.versions.len() - 1
    }

    fn attributes(&self) -> Option<Arc<FaceAttributes>> {
        self.versions.last().and_then(|v| v.attributes.clone())
    }

    fn push_face(&mut self, corners: &[u32], origin: ChainOrigin, group: Option<u32>) {
        let face = self.until.len() as u32;
        self.corners.extend_from_slice(corners);
        self.starts.push(self.corners.len() as u32);
        self.until.push(THERE);
        self.live += 1;
        self.origins.push(origin);
        if let Some(groups) = &mut self.groups {
            groups.push(group.unwrap_or(0));
        }
        match *corners {
            [a, b, c] => self.triangles.push([a, b, c]),
            _ => {
                self.all_triangles = false;
                triangulate::face(&self.at, corners, &mut self.triangles);
            }
        }
        self.face_of.resize(self.triangles.len(), face);
    }

    /// The number of faces that are still there.
    pub fn face_count(&self) -> usize {
        self.live
    }

    /// Returns true if most of the memory is for faces that went.
    pub fn mostly_gone(&self) -> bool {
        self.until.len() > 2 * self.live + 4096
    }

    fn face(&self, f: u32) -> &[u32] {
        &self.corners[self.starts[f as usize] as usize..self.starts[f as usize + 1] as usize]
    }

    fn place(&self, t: u32) -> [DVec3; 3] {
        self.triangles[t as usize].map(|v| self.at[v as usize])
    }

    fn is_there(&self, t: u32) -> bool {
        self.until[self.face_of[t as usize] as usize] == THERE
    }

    /// Puts the triangles from `first` on into the trees.
    fn add_level(&mut self, first: usize, job: &Job) -> Result<(), Cancelled> {
        let mut triangles: Vec<u32> = (first as u32..self.triangles.len() as u32).collect();
        while let Some(last) = self.levels.pop_if(|l| l.triangles.len() < 2 * triangles.len()) {
            triangles.extend(last.triangles.into_iter().filter(|&t| self.is_there(t)));
        }
        if triangles.is_empty() {
            return Ok(());
        }
        let span = |&t: &u32| Span::of(self.place(t));
        let spans: Vec<Span> = if triangles.len() > 1 << 13 {
            triangles.par_iter().map(span).collect()
        } else {
            triangles.iter().map(span).collect()
        };
        let tree = SpanTree::build(&spans, job)?;
        self.levels.push(Level { tree, triangles });
        Ok(())
    }

    /// Returns the faces that reach a box.
    pub fn patch(&self, reach: &Span) -> SurfacePatch {
        let mut faces: Vec<u32> = Vec::new();
        for level in &self.levels {
            level.tree.each_meets(reach, |i| {
                let t = level.triangles[i as usize];
                if self.is_there(t) && Span::of(self.place(t)).meets(reach) {
                    faces.push(self.face_of[t as usize]);
                }
            });
        }
        faces.sort_unstable();
        faces.dedup();
        let mut out = SurfacePatch { mesh: PolyMesh::new(), vertices: Vec::new(), faces };
        let mut names: Map<u32, u32> = Map::default();
        for &f in &out.faces {
            for &v in self.face(f) {
                let name = *names.entry(v).or_insert_with(|| {
                    out.vertices.push(v);
                    out.mesh.positions.push(self.at[v as usize]);
                    out.vertices.len() as u32 - 1
                });
                out.mesh.corners.push(name);
            }
            out.mesh.face_starts.push(out.mesh.corners.len() as u32);
        }
        let of_faces = |g: &Vec<u32>| out.faces.iter().map(|&f| g[f as usize]).collect();
        out.mesh.groups = self.groups.as_ref().map(of_faces);
        out.mesh.attributes = self.attributes();
        let of_vertices = |c: &Vec<[u8; 4]>| out.vertices.iter().map(|&v| c[v as usize]).collect();
        out.mesh.colours = self.colours.as_ref().map(of_vertices);
        out
    }

    /// Returns the origin of a face.
    pub fn origin(&self, f: u32) -> ChainOrigin {
        self.origins[f as usize]
    }

    /// Returns the number of vertices, those that are no longer used included.
    pub fn vertex_count(&self) -> u32 {
        self.at.len() as u32
    }

    /// Returns the winding number of the surface around a point.
    pub fn winding(&self, o: DVec3) -> i32 {
        let reach = (self.span.hi - self.span.lo).length() * 2.0;
        crossings(o, reach, |p, visit| {
            let mut on = true;
            for level in &self.levels {
                level.tree.along(o, p, |i| {
                    let t = level.triangles[i as usize];
                    on = on && (!self.is_there(t) || visit(self.place(t)));
                    on
                });
            }
        })
    }

    /// Replaces faces.
    pub fn apply(&mut self, change: &SurfaceChange, job: &Job) -> Result<(), Cancelled> {
        let (first, before) = (self.triangles.len(), self.at.len());
        let next = self.versions.len() as u32;
        for &f in &change.removed {
            self.until[f as usize] = next;
        }
        self.live -= change.removed.len();
        if change.colours.is_some() && self.colours.is_none() {
            self.colours = Some(vec![[255; 4]; before]);
        }
        if change.faces.groups.is_some() && self.groups.is_none() {
            self.groups = Some(vec![0; self.until.len()]);
        }
        self.at.extend(&change.positions);
        if let Some(colours) = &mut self.colours {
            colours.extend(change.colours.iter().flatten());
            colours.resize(self.at.len(), [255; 4]);
        }
        let named = change.faces.groups.is_some();
        let attributes = if named { change.faces.attributes.clone() } else { self.attributes() };
        for (f, corners) in change.faces.faces().enumerate() {
            let group = change.faces.groups.as_ref().and_then(|g| g.get(f)).copied();
            self.push_face(corners, change.origins[f], group);
        }
        self.span = self.span.join(change.span);
        self.next_group = change.next_group;
        self.note_version(attributes);
        self.add_level(first, job)
    }

    /// Returns the surface as a mesh, and the origin of each face. Vertices that no face has are
    /// left out.
    pub fn to_mesh(&self) -> (PolyMesh, Vec<ChainOrigin>) {
        self.mesh_at(self.version())
    }

    /// As [`KeptSurface::to_mesh`], of the surface after so many changes.
    pub fn mesh_at(&self, version: usize) -> (PolyMesh, Vec<ChainOrigin>) {
        const NONE: u32 = u32::MAX;
        let Some(was) = self.versions.get(version) else { return Default::default() };
        let mut names = vec![NONE; self.at.len()];
        let there: Vec<u32> =
            (0..was.faces).filter(|&f| self.until[f as usize] as usize > version).collect();
        for &f in &there {
            self.face(f).iter().for_each(|&v| names[v as usize] = 0);
        }
        let colours = self.colours.as_ref().filter(|_| was.coloured);
        let mut out = PolyMesh::new();
        out.colours = colours.map(|_| Vec::new());
        for (v, name) in names.iter_mut().enumerate().filter(|(_, n)| **n != NONE) {
            *name = out.positions.len() as u32;
            out.positions.push(self.at[v]);
            if let (Some(to), Some(from)) = (&mut out.colours, colours) {
                to.push(from[v]);
            }
        }
        out.face_starts.reserve(there.len());
        for &f in &there {
            out.corners.extend(self.face(f).iter().map(|&v| names[v as usize]));
            out.face_starts.push(out.corners.len() as u32);
        }
        let groups = self.groups.as_ref().filter(|_| was.grouped);
        out.groups = groups.map(|g| there.iter().map(|&f| g[f as usize]).collect());
        out.attributes = was.attributes.clone();
        (out, there.iter().map(|&f| self.origins[f as usize]).collect())
    }
}
