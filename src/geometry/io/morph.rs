//! Morph targets: named offsets of a mesh's vertices, each with a weight, as glTF has them.

use glam::{DVec3, Vec3};

/// A morph target.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MorphTarget {
    /// For people.
    pub name: String,
    /// The factor of its offsets.
    pub weight: f32,
    /// True if it is applied; otherwise a file stores the weight 0, and this weight beside it.
    pub visible: bool,
    /// Numbers of vertices, ascending, each with its offset in the frame of the mesh.
    pub offsets: Vec<(u32, Vec3)>,
}

impl MorphTarget {
    /// The weight that other programs see.
    pub fn applied(&self) -> f32 {
        if self.visible { self.weight } else { 0.0 }
    }
}

/// A mesh without its morph targets, and these.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MorphedMesh {
    /// The positions of the vertices without any target.
    pub base: Vec<DVec3>,
    /// The targets, in order.
    pub targets: Vec<MorphTarget>,
}

impl MorphedMesh {
    /// Makes it larger by this factor.
    pub fn enlarge(&mut self, factor: f64) {
        self.base.iter_mut().for_each(|p| *p *= factor);
        let offsets = self.targets.iter_mut().flat_map(|t| &mut t.offsets);
        offsets.for_each(|o| o.1 *= factor as f32);
    }
}
