//! The contents of a file beside its surface, for people and for programs that compare files.

use std::collections::BTreeSet;

use serde::Serialize;

use super::{LoadedMesh, MeshFormat};

/// The parts of a file that were read beside its vertices and faces.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileContents {
    /// The unit that the format defines; `None`: it states none.
    pub unit: Option<&'static str>,
    /// Groups of faces.
    pub groups: usize,
    /// The names of objects, each once, in the order of the groups.
    pub names: Vec<String>,
    /// The names of materials, each once, in the order of the groups.
    pub materials: Vec<String>,
    /// True if vertices have colours.
    pub colours: bool,
    /// True if corners of faces have texture coordinates.
    pub texture_coordinates: bool,
    /// Morph targets.
    pub morph_targets: usize,
}

impl LoadedMesh {
    /// Returns what was read.
    pub fn contents(&self) -> FileContents {
        let mesh = &self.mesh;
        let used: BTreeSet<u32> = mesh.groups.iter().flatten().copied().collect();
        let names = |name: fn(&crate::GroupName) -> &String| {
            let mut seen = BTreeSet::new();
            let all = used.iter().filter_map(|g| mesh.group_name(*g)).map(name);
            all.filter(|n| !n.is_empty() && seen.insert(*n)).cloned().collect()
        };
        FileContents {
            unit: match self.format {
                MeshFormat::Glb | MeshFormat::Gltf => Some("metre"),
                MeshFormat::ThreeMf => Some("millimetre"),
                _ => None,
            },
            groups: used.len(),
            names: names(|n| &n.object),
            materials: names(|n| &n.material),
            colours: mesh.colours.is_some(),
            texture_coordinates: mesh.uvs().is_some(),
            morph_targets: self.targets.len(),
        }
    }
}
