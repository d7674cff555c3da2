//! Meshes as plain arrays: what a file holds, what a Boolean takes, what an analysis reads. The
//! clay of a sculpture is paged (crate `sculptd-clay`); these are the forms in which it is loaded
//! and saved.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::face_attributes::{FaceAttributes, GroupName};

/// A polygon mesh in double precision. Corners run counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PolyMesh {
    /// In the unit of the file, millimetres as a rule.
    pub positions: Vec<DVec3>,
    /// Face `f` owns `corners[face_starts[f]..face_starts[f + 1]]`; one entry more than faces, the
    /// first is 0.
    pub face_starts: Vec<u32>,
    /// Vertex indices, each below the number of positions.
    pub corners: Vec<u32>,
    /// One RGBA a vertex, sRGB, where the file has colours.
    pub colours: Option<Vec<[u8; 4]>>,
    /// One group (OBJ `g`/`usemtl`, 3MF object) a face, where the file has them.
    pub groups: Option<Vec<u32>>,
    /// Texture coordinates and the names of groups, where the file has them.
    pub attributes: Option<Arc<FaceAttributes>>,
}

impl PolyMesh {
    /// A mesh of nothing.
    pub fn new() -> Self {
        PolyMesh { face_starts: vec![0], ..Default::default() }
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.face_starts.len().saturating_sub(1)
    }

    /// The corners of face `f`, counter-clockwise seen from outside.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.face_starts[f] as usize..self.face_starts[f + 1] as usize]
    }

    /// The corners of each face, in order.
    pub fn faces(&self) -> impl Iterator<Item = &[u32]> {
        self.face_starts.windows(2).map(|w| &self.corners[w[0] as usize..w[1] as usize])
    }

    /// Adds a face. The caller extends `groups` where the mesh has them.
    pub fn push_face(&mut self, corners: &[u32]) {
        if self.face_starts.is_empty() {
            self.face_starts.push(0);
        }
        self.corners.extend_from_slice(corners);
        self.face_starts.push(self.corners.len() as u32);
    }
}

/// The file's further attributes of faces and corners.
impl PolyMesh {
    /// Returns the texture coordinates, and the index into them for each corner.
    pub fn uvs(&self) -> Option<(&[[f64; 2]], &[u32])> {
        let all = self.attributes.as_deref()?;
        let fits = !all.uv_corners.is_empty() && all.uv_corners.len() == self.corners.len();
        fits.then_some((&all.uvs[..], &all.uv_corners[..]))
    }

    /// Returns the name of a group.
    pub fn group_name(&self, group: u32) -> Option<&GroupName> {
        self.attributes.as_deref()?.groups.get(group as usize)
    }

    /// Returns true if any group names a material.
    pub fn has_materials(&self) -> bool {
        let groups = self.attributes.as_deref().map_or(&[][..], |a| &a.groups);
        groups.iter().any(|g| !g.material.is_empty())
    }

    /// Lets the texture coordinates go: the corners are others now. The names stay.
    pub fn drop_uvs(&mut self) {
        if self.attributes.as_ref().is_some_and(|a| !a.uv_corners.is_empty()) {
            let own = self.attributes.get_or_insert_default();
            let own = Arc::make_mut(own);
            (own.uvs, own.uv_corners) = (Vec::new(), Vec::new());
        }
    }

    /// Turns face `f` over, its texture coordinates with it.
    pub fn turn_face(&mut self, f: usize) {
        let range = self.face_starts[f] as usize..self.face_starts[f + 1] as usize;
        if self.uvs().is_some()
            && let Some(own) = &mut self.attributes
        {
            Arc::make_mut(own).uv_corners[range.clone()].reverse();
        }
        self.corners[range].reverse();
    }
}

/// A triangle mesh in single precision, the clay's own.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TriMesh {
    /// In the unit of the file, millimetres as a rule.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One RGBA a vertex, sRGB.
    pub colours: Option<Vec<[u8; 4]>>,
}

impl TriMesh {
    /// The positions of triangle `t`. Panics where an index is out of range.
    pub fn corners(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// Lower and upper corner of the box around all vertices; (+inf, -inf) without any.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    }

    /// The same surface in double precision, one polygon a triangle.
    pub fn to_poly(&self) -> PolyMesh {
        let mut out = PolyMesh::new();
        out.positions = self.positions.iter().map(|p| p.as_dvec3()).collect();
        out.corners = self.triangles.iter().flatten().copied().collect();
        out.face_starts = (0..=self.triangles.len() as u32).map(|i| i * 3).collect();
        out.colours.clone_from(&self.colours);
        out
    }
}
