//! Several meshes, each with a name and a place, to one file.

use std::io;
use std::path::Path;
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use super::beside::CancellableWriter;
use super::gltf::GltfUnit::Millimetres;
use super::write::{encode_until_cancelled, left_out, writable_format};
use super::write_gltf::{self, GltfMesh};
use super::write_threemf::{self, ThreeMfPart};
use super::{MorphedMesh, WriteError, write_beside};
use crate::face_attributes::NO_UV;
use crate::job::Job;
use crate::{FaceAttributes, GroupName, PolyMesh};

/// A mesh with a name and a place.
#[derive(Debug, Clone)]
pub struct SceneMesh {
    /// For people.
    pub name: String,
    /// In its own frame.
    pub mesh: PolyMesh,
    /// The position of its origin.
    pub shift: DVec3,
    /// Its rotation; unit length.
    pub turn: DQuat,
    /// World units for a unit of the mesh, > 0.
    pub scale: f64,
    /// The mesh as the sum of a base and morph targets, which glTF keeps; as many vertices.
    pub morphed: Option<MorphedMesh>,
}

impl Default for SceneMesh {
    fn default() -> Self {
        SceneMesh {
            name: String::new(),
            mesh: PolyMesh::new(),
            shift: DVec3::ZERO,
            turn: DQuat::IDENTITY,
            scale: 1.0,
            morphed: None,
        }
    }
}

impl SceneMesh {
    /// Makes it and its distance from the world's origin larger by this factor.
    pub fn enlarge(&mut self, factor: f64) {
        if self.stands_still() {
            self.mesh.positions.iter_mut().for_each(|p| *p *= factor);
            self.morphed.iter_mut().for_each(|m| m.enlarge(factor));
        } else {
            self.shift *= factor;
            self.scale *= factor;
        }
    }

    fn stands_still(&self) -> bool {
        self.shift == DVec3::ZERO && self.turn == DQuat::IDENTITY && self.scale == 1.0
    }
}

/// Writes several meshes, in millimetres, in the format that the extension of `path` names, whole
/// or not at all. Returns the parts that the file does not hold, one sentence each. glTF keeps each
/// mesh as a node with its name and its transform, in metres by one node above them, 3MF as a
/// component of one object. Every other format gets one mesh with the transforms applied, the
/// meshes one after the other; in OBJ each has its name.
///
/// # Errors
/// Returns an error if no format has the extension, the file cannot be written, or the job was
/// cancelled; then nothing is written.
pub fn write_scene(
    path: &Path,
    meshes: &[SceneMesh],
    job: &Job,
) -> Result<Vec<String>, WriteError> {
    let kind = writable_format(path)?;
    encode_scene(path, kind, meshes, job)?;
    Ok(scene_left_out(kind, meshes))
}

/// Returns the parts of the meshes that a file of the ending `kind` does not hold.
fn scene_left_out(kind: &str, meshes: &[SceneMesh]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for text in meshes.iter().flat_map(|m| left_out(kind, &m.mesh)) {
        if !out.contains(&text) {
            out.push(text);
        }
    }
    let gltf = matches!(kind, "glb" | "gltf");
    if gltf && meshes.iter().any(|m| m.morphed.is_some() && m.mesh.uvs().is_some()) {
        out.push(format!("the texture coordinates are left out beside layers in .{kind}"));
    }
    if !gltf && meshes.iter().any(|m| m.morphed.is_some()) {
        out.push(format!("the layers are part of the surface: .{kind} is written without"));
    }
    if meshes.len() > 1 && matches!(kind, "stl" | "ply" | "off") {
        out.push(format!("the objects are one mesh without names: .{kind} holds no others"));
    }
    out
}

fn encode_scene(
    path: &Path,
    kind: &str,
    meshes: &[SceneMesh],
    job: &Job,
) -> Result<(), WriteError> {
    let failed = |source: io::Error| WriteError::Io { path: path.into(), source };
    match kind {
        "glb" | "gltf" => {
            let parts: Vec<GltfMesh<'_>> = meshes
                .iter()
                .map(|m| GltfMesh {
                    mesh: &m.mesh,
                    name: Some(&*m.name).filter(|name| !name.is_empty()),
                    morphed: m.morphed.as_ref(),
                    place: (!m.stands_still()).then_some((m.shift, m.turn, m.scale)),
                })
                .collect();
            write_beside(path, |out| {
                let out = &mut CancellableWriter { out, job };
                match kind {
                    "glb" => write_gltf::glb(&parts, Millimetres, out),
                    _ => write_gltf::gltf(&parts, Millimetres, out),
                }
            })
            .map_err(failed)
        }
        "3mf" if meshes.len() > 1 => {
            let parts: Vec<ThreeMfPart<'_>> = meshes
                .iter()
                .map(|m| ThreeMfPart {
                    mesh: &m.mesh,
                    name: &m.name,
                    rows: DMat3::from_quat(m.turn) * m.scale,
                    shift: m.shift,
                })
                .collect();
            write_beside(path, |out| write_threemf::threemf_parts(&parts, out, job)).map_err(failed)
        }
        _ => {
            let mesh = merged(meshes);
            write_beside(path, |out| encode_until_cancelled(kind, &mesh, out, job)).map_err(failed)
        }
    }
}

/// Returns all meshes as one, in world coordinates. Each of several meshes has its name and
/// separate groups. Colours stay if any mesh has them; the others are white.
pub fn merged(meshes: &[SceneMesh]) -> PolyMesh {
    let mut all = PolyMesh::new();
    let coloured = meshes.iter().any(|m| m.mesh.colours.is_some());
    let mut colours = Vec::new();
    if let [one] = meshes {
        all.groups.clone_from(&one.mesh.groups);
        all.attributes.clone_from(&one.mesh.attributes);
    }
    let mut groups = Vec::new();
    let mut attributes = FaceAttributes::default();
    for part in meshes {
        let first = all.positions.len() as u32;
        let group = attributes.groups.len() as u32;
        attributes.groups.extend(named_groups(part));
        take_uvs(&mut attributes, &part.mesh, all.corners.len());
        if let Some(own) = &part.mesh.attributes {
            for library in &own.libraries {
                if !attributes.libraries.contains(library) {
                    attributes.libraries.push(library.clone());
                }
            }
        }
        let place = |p: &DVec3| match part.stands_still() {
            true => *p,
            false => part.shift + part.turn * (*p * part.scale),
        };
        all.positions.extend(part.mesh.positions.iter().map(place));
        match &part.mesh.colours {
            Some(own) => colours.extend_from_slice(own),
            None if coloured => colours.resize(all.positions.len(), [255; 4]),
            None => {}
        }
        let mut corners = Vec::new();
        for (f, face) in part.mesh.faces().enumerate() {
            corners.clear();
            corners.extend(face.iter().map(|v| v + first));
            all.push_face(&corners);
            groups.push(group + part.mesh.groups.as_ref().map_or(0, |g| g[f]));
        }
    }
    all.colours = coloured.then_some(colours);
    if meshes.len() > 1 {
        all.groups = Some(groups);
        if !attributes.uv_corners.is_empty() {
            attributes.uv_corners.resize(all.corners.len(), NO_UV);
        }
        all.attributes = Some(Arc::new(attributes));
    }
    all
}

/// Returns the groups of one mesh of several: its name as the object, and its groups within it.
fn named_groups(part: &SceneMesh) -> Vec<GroupName> {
    let own = part.mesh.groups.as_ref().and_then(|g| g.iter().max());
    let count = own.map_or(1, |most| most + 1);
    let group = |g: u32| {
        let own = part.mesh.group_name(g).cloned().unwrap_or_default();
        let named = [&own.group, &own.object].into_iter().find(|n| !n.is_empty());
        let group = named.unwrap_or(&part.name).clone();
        GroupName { object: part.name.clone(), group, material: own.material }
    };
    (0..count).map(group).collect()
}

/// Appends the texture coordinates of a mesh whose corners begin at `first`.
fn take_uvs(all: &mut FaceAttributes, mesh: &PolyMesh, first: usize) {
    let Some((values, corners)) = mesh.uvs() else { return };
    let base = all.uvs.len() as u32;
    all.uv_corners.resize(first, NO_UV);
    all.uv_corners.extend(corners.iter().map(|&c| if c == NO_UV { c } else { base + c }));
    all.uvs.extend_from_slice(values);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::MorphTarget;
    use crate::io::parse_in_millimetres;
    use crate::job::Job;
    use crate::shapes;
    use glam::Vec3;

    fn scene() -> Vec<SceneMesh> {
        let box_of = |size: f64| shapes::cuboid(DVec3::ZERO, DVec3::splat(size));
        let turn = DQuat::from_rotation_y(1.0);
        vec![
            SceneMesh {
                name: "lid \"A\"".into(),
                mesh: box_of(1.0),
                shift: DVec3::ZERO,
                turn: DQuat::IDENTITY,
                scale: 1.0,
                morphed: None,
            },
            SceneMesh {
                name: "pot".into(),
                mesh: box_of(2.0),
                shift: DVec3::new(10.0, 2.0, -3.0),
                turn,
                scale: 0.5,
                morphed: None,
            },
        ]
    }

    #[test]
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    fn morph_targets_come_back_from_gltf_with_names_weights_and_offsets() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut all = scene();
        let targets = vec![
            MorphTarget {
                name: "wrinkles".into(),
                weight: -1.25,
                visible: true,
                offsets: vec![(1, Vec3::X), (6, Vec3::new(0.0, 0.5, -0.25))],
            },
            MorphTarget {
                name: "scar".into(),
                weight: 0.5,
                visible: false,
                offsets: vec![(0, Vec3::Y)],
            },
        ];
        let base = all[0].mesh.positions.clone();
        all[0].mesh.positions[1] += DVec3::X;
        all[0].morphed = Some(MorphedMesh { base: base.clone(), targets: targets.clone() });
        for ending in ["glb", "gltf"] {
            let path = dir.path().join(format!("layers.{ending}"));
            write_scene(&path, &all[..1], &Job::default()).expect("written");
            let bytes = std::fs::read(&path).expect("there");
            let read = parse_in_millimetres(&bytes, &path, &Job::default()).expect("readable");
            assert_eq!(read.mesh.positions, base);
            assert_eq!(read.targets, targets);
            if ending == "gltf" {
                let json: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
                let mesh = &json["meshes"][0];
                assert_eq!(mesh["weights"], serde_json::json!([-1.25, 0.0]));
                assert_eq!(mesh["extras"]["targetNames"][1], "scar");
            }
        }
    }

    #[test]
    #[allow(clippy::disallowed_methods)] // Nobody reads half of it.
    fn names_and_places_stand_in_gltf_and_are_applied_elsewhere() {
        let dir = tempfile::tempdir().expect("a folder");
        let all = merged(&scene());
        assert_eq!((all.positions.len(), all.face_count()), (16, 12));
        for ending in ["glb", "gltf", "obj", "ply", "stl", "off", "3mf"] {
            let path = dir.path().join(format!("scene.{ending}"));
            write_scene(&path, &scene(), &Job::default()).expect("written");
            let bytes = std::fs::read(&path).expect("there");
            let read = parse_in_millimetres(&bytes, &path, &Job::default()).expect("readable").mesh;
            let bounds = |mesh: &PolyMesh| {
                let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                mesh.positions.iter().fold(none, |(lo, hi), p| (lo.min(*p), hi.max(*p)))
            };
            let (a, b) = (bounds(&all), bounds(&read));
            assert!((a.0 - b.0).length() < 1e-5 && (a.1 - b.1).length() < 1e-5, "{ending}: {b:?}");
            if ending == "gltf" {
                let json: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
                assert_eq!(json["nodes"][0]["name"], "lid \"A\"");
                assert_eq!(json["nodes"][0].get("translation"), None);
                assert_eq!(json["nodes"][1]["translation"][0], 10.0);
                assert_eq!(json["nodes"][1]["scale"], serde_json::json!([0.5, 0.5, 0.5]));
                assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([2]));
                // Other programs see metres.
                let metres =
                    crate::io::parse(&bytes, &path, &Job::default()).expect("readable").mesh;
                assert!((bounds(&metres).1 * 1e3 - bounds(&read).1).length() < 1e-5);
            }
        }
    }
}
