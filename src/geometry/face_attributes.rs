//! What a file says of its faces that no operation here reads, kept for the programs that do:
//! texture coordinates by corner, and what groups and materials are called.

use serde::{Deserialize, Serialize};

/// A corner without a texture coordinate.
pub const NO_UV: u32 = u32::MAX;

/// The names of a group of faces in OBJ; each may be empty.
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
    /// Returns true if there are no attributes.
    pub fn is_empty(&self) -> bool {
        self.uv_corners.is_empty() && self.groups.is_empty() && self.libraries.is_empty()
    }

    /// Bytes that it takes, about.
    pub fn bytes(&self) -> usize {
        self.uvs.len() * 16 + self.uv_corners.len() * 4 + self.groups.len() * 96
    }
}
