//! The layers of a whole object as plain numbers, for what writes them to a file.

use glam::{DVec3, Vec3};

use crate::Snapshot;
use crate::layers::Layer;

/// The layers of an object by the places of vertices in [`Snapshot::to_tri`].
#[derive(Debug, Clone, PartialEq)]
pub struct FlatLayers {
    /// The positions of the vertices without any layer.
    pub base: Vec<DVec3>,
    /// The layers from the lowest up, each with the vertices that it moves, ascending, and their
    /// offsets.
    pub layers: Vec<(Layer, Vec<(u32, Vec3)>)>,
}

impl Snapshot {
    /// The layers of the object; `None`: it has none. Costs as much as the clay is large.
    pub fn flat_layers(&self) -> Option<FlatLayers> {
        let stack = self.layers().filter(|s| !s.layers.is_empty())?;
        let ranks = self.ranks();
        let mut flat = FlatLayers {
            base: vec![DVec3::ZERO; self.vertex_count()],
            layers: stack.layers.iter().map(|l| (l.clone(), Vec::new())).collect(),
        };
        for page in self.pages() {
            let base = page.layers().map_or(&[][..], |l| l.base());
            for (v, &id) in page.topology().ids.iter().enumerate() {
                let place = base.get(v).copied().unwrap_or_else(|| page.point(v).as_dvec3());
                flat.base[ranks.of(id)] = place;
            }
            let Some(layers) = page.layers() else { continue };
            for (layer, offsets) in &mut flat.layers {
                let Some(row) = layers.row(layer.id) else { continue };
                let moved = row.iter().zip(&page.topology().ids);
                let moved = moved.filter(|(o, _)| **o != DVec3::ZERO);
                offsets.extend(moved.map(|(o, &id)| (ranks.of(id) as u32, o.as_vec3())));
            }
        }
        flat.layers.iter_mut().for_each(|l| l.1.sort_unstable_by_key(|o| o.0));
        Some(flat)
    }
}
