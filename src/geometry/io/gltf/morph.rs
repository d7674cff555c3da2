//! Morph targets: offsets of a primitive's points, plain or sparse. One that cannot be read is left
//! out and counted; the mesh stands without it.

use glam::{DMat4, DVec3, Vec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked;

use super::GltfFile;
use crate::io::morph::MorphTarget;

/// Morph targets of one mesh that are read, at most.
const MAX_TARGETS: usize = 256;

impl GltfFile<'_> {
    /// The morph targets of an instance. `starts`: its primitives and the first point of each.
    /// `of`: which vertex each point has become, counted from `base`.
    pub(super) fn morphs(
        &mut self,
        mesh: usize,
        place: DMat4,
        starts: &[(usize, usize)],
        (of, base): (&[u32], u32),
    ) {
        let root = self.root;
        let source = &root.meshes[mesh];
        let counts = source.primitives.iter().filter_map(|p| p.targets.as_ref()).map(Vec::len);
        let count = counts.max().unwrap_or(0).min(MAX_TARGETS);
        let extras = source.extras.as_ref().filter(|_| count > 0);
        let extras: serde_json::Value =
            extras.and_then(|e| serde_json::from_str(e.get()).ok()).unwrap_or_default();
        for k in 0..count {
            let Some(mut offsets) = self.target(mesh, k, starts, of) else {
                self.left_out.targets += 1;
                continue;
            };
            offsets.sort_by_key(|o| o.0);
            offsets.dedup_by_key(|o| o.0);
            let placed = |(v, by): (u32, DVec3)| {
                let by = place.transform_vector3(by).as_vec3();
                (by.is_finite() && by != Vec3::ZERO).then_some((base + v, by))
            };
            let offsets = offsets.into_iter().filter_map(placed).collect();
            let weight = source.weights.as_ref().and_then(|w| w.get(k).copied()).unwrap_or(0.0);
            let (name, own) = (extras["targetNames"][k].as_str(), &extras["sculptdLayers"][k]);
            let target = MorphTarget {
                name: name.map_or_else(|| format!("target {}", k + 1), str::to_owned),
                weight: own["intensity"].as_f64().map_or(weight, |w| w as f32),
                visible: own["visible"].as_bool().unwrap_or(true),
                offsets,
            };
            self.targets.push(target);
        }
    }

    /// The offsets of target `k` by vertex, in the frame of the mesh. `None`: it cannot be read.
    fn target(
        &self,
        mesh: usize,
        k: usize,
        starts: &[(usize, usize)],
        of: &[u32],
    ) -> Option<Vec<(u32, DVec3)>> {
        let mut out = Vec::new();
        for &(p, first) in starts {
            let primitive = &self.root.meshes[mesh].primitives[p];
            let at = primitive.attributes.get(&Checked::Valid(Semantic::Positions))?;
            let points = self.root.accessors.get(at.value())?.count.0 as usize;
            let target = primitive.targets.as_ref().and_then(|t| t.get(k)?.positions);
            let Some(target) = target else { continue };
            let offsets = self.offsets(target.value(), points)?;
            let of = of.get(first..first.checked_add(points)?)?;
            let moved = offsets.into_iter().zip(of).filter(|(by, _)| *by != DVec3::ZERO);
            out.extend(moved.map(|(by, v)| (*v, by)));
        }
        Some(out)
    }

    /// One offset a point: those of the accessor, or zeros, with the sparse ones in their places.
    fn offsets(&self, accessor: usize, points: usize) -> Option<Vec<DVec3>> {
        let a = self.root.accessors.get(accessor)?;
        let (Checked::Valid(kind), Checked::Valid(Type::Vec3)) = (a.component_type, a.type_) else {
            return None;
        };
        if kind.0 != ComponentType::F32 || a.count.0 as usize != points {
            return None;
        }
        let mut all = vec![DVec3::ZERO; points];
        let what = "offsets of a morph target";
        if let Some(view) = a.buffer_view {
            let from = (view.value(), a.byte_offset.map_or(0, |o| o.0) as usize);
            let dense = self.values(from, points, (kind.0, 3), what).ok()?;
            for (i, by) in all.iter_mut().enumerate() {
                *by = DVec3::new(dense.get(i, 0), dense.get(i, 1), dense.get(i, 2));
            }
        }
        if let Some(sparse) = &a.sparse {
            let Checked::Valid(index) = sparse.indices.component_type else { return None };
            let count = sparse.count.0 as usize;
            let at = |view: usize, offset: u64| (view, offset as usize);
            let from = at(sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
            let places = self.values(from, count, (index.0, 1), what).ok()?;
            let from = at(sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
            let values = self.values(from, count, (kind.0, 3), what).ok()?;
            for i in 0..count {
                let by = all.get_mut(places.get(i, 0) as usize)?;
                *by = DVec3::new(values.get(i, 0), values.get(i, 1), values.get(i, 2));
            }
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::Vec3;

    use crate::io::parse;
    use crate::io::write_gltf::base64;
    use crate::job::Job;

    /// A triangle with one target whose only offset is sparse, and one that lies past the buffer.
    fn file(sparse_view: usize) -> Vec<u8> {
        let mut bytes: Vec<u8> = Vec::new();
        for x in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.25, -2.0] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([2, 0, 0, 0]);
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        let sparse = |view: usize| {
            serde_json::json!({
                "componentType": 5126, "count": 3, "type": "VEC3",
                "sparse": {
                    "count": 1,
                    "indices": { "bufferView": 2, "componentType": 5123 },
                    "values": { "bufferView": view },
                },
            })
        };
        serde_json::json!({
            "asset": { "version": "2.0" },
            "scene": 0, "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0, "scale": [2.0, 2.0, 2.0] }],
            "buffers": [{ "byteLength": 52, "uri": uri }],
            "bufferViews": [
                { "buffer": 0, "byteLength": 36 },
                { "buffer": 0, "byteOffset": 36, "byteLength": 12 },
                { "buffer": 0, "byteOffset": 48, "byteLength": 2 },
            ],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                  "min": [0, 0, 0], "max": [1, 1, 0] },
                sparse(sparse_view),
            ],
            "meshes": [{
                "weights": [0.5],
                "primitives": [{ "attributes": { "POSITION": 0 }, "targets": [{ "POSITION": 1 }] }],
            }],
        })
        .to_string()
        .into_bytes()
    }

    #[test]
    fn sparse_targets_are_read_and_one_that_cannot_be_is_left_out_and_told() {
        let read = |view| parse(&file(view), Path::new("a.gltf"), &Job::default());
        let loaded = read(1).expect("readable");
        assert_eq!(loaded.mesh.positions.len(), 3);
        let [target] = &loaded.targets[..] else { panic!("{:?}", loaded.targets) };
        assert_eq!((target.name.as_str(), target.weight, target.visible), ("target 1", 0.5, true));
        assert_eq!(target.offsets, [(2, Vec3::new(1.0, 0.5, -4.0))]);
        let without = read(7).expect("readable all the same");
        assert!(without.targets.is_empty() && without.mesh.positions.len() == 3);
        assert!(without.warnings.iter().any(|w| w.contains("1 morph targets left out")));
    }
}
