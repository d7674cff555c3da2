//! What a file says of its faces that no operation here reads, kept for the programs that do:
//! texture coordinates by corner, and what groups and materials are called.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::PolyMesh;

/// A corner without a texture coordinate.
pub const NO_UV: u32 = u32::MAX;

/// What a group of faces is called in OBJ; each may be empty.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct GroupName {
    /// `o`.
    pub object: String,
    /// `g`.
    pub group: String,
    /// `usemtl`.
    pub material: String,
}

/// Texture coordinates and names, see the module.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FaceAttributes {
    /// Texture coordinates, as the file has them.
    pub uvs: Vec<[f64; 2]>,
    /// For each corner of the mesh the place of its texture coordinate in `uvs`, or [`NO_UV`].
    /// Empty where the file has none.
    pub uv_corners: Vec<u32>,
    /// The names of the groups, by their numbers.
    pub groups: Vec<GroupName>,
    /// The files of materials (`mtllib`).
    pub libraries: Vec<String>,
}

impl FaceAttributes {
    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.uv_corners.is_empty() && self.groups.is_empty() && self.libraries.is_empty()
    }

    /// Bytes that it takes, about.
    pub fn bytes(&self) -> usize {
        self.uvs.len() * 16 + self.uv_corners.len() * 4 + self.groups.len() * 96
    }
}

impl PolyMesh {
    /// The texture coordinates and, for each corner, which of them it has.
    pub fn uvs(&self) -> Option<(&[[f64; 2]], &[u32])> {
        let all = self.attributes.as_deref()?;
        let fits = !all.uv_corners.is_empty() && all.uv_corners.len() == self.corners.len();
        fits.then_some((&all.uvs[..], &all.uv_corners[..]))
    }

    /// What a group is called.
    pub fn group_name(&self, group: u32) -> Option<&GroupName> {
        self.attributes.as_deref()?.groups.get(group as usize)
    }

    /// Whether any group names a material.
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
