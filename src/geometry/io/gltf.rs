//! glTF 2.0, as JSON with its buffers beside it or inside it, and as GLB. The JSON's meaning is
//! read by the kept crate `gltf-json`; buffers, views and accessors by us, so that each length is
//! checked against the bytes there are.
//!
//! Triangles (lists, strips, fans) of the default scene, each node's transform applied; coordinates
//! as they stand, y up and without a unit's change. Corners of one node that are equal in place are
//! one vertex: files of this format have a vertex for each normal and texture coordinate. Each
//! primitive is a group, named by its node and its material. Morph targets come beside the mesh,
//! which stands without them. Skins, animations and what materials look like are passed over.

mod accessors;
mod buffers;
mod instances;
mod meshopt;
mod morph;
mod primitives;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};
use gltf_json::{Index, Root};

use super::morph::MorphTarget;
use super::problem::{FilePlace, FileProblem, ParseError};
use super::text::refuse;
use crate::face_attributes::NO_UV;
use crate::job::Job;
use crate::weld::weld_keys;
use crate::{FaceAttributes, GroupName, PolyMesh};
use instances::INSTANCING;
use meshopt::MESHOPT;
use primitives::PrimitivePoints;

/// The unit of a file's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GltfUnit {
    /// They are read and written as they stand.
    AsTheyStand,
    /// The format's metres are millimetres here. A node above all others converts what is written.
    Millimetres,
}

/// Marks a file whose only root node turns millimetres into metres.
pub(super) const IN_MILLIMETRES: &str = "sculptdMillimetres";
/// Who wrote a file.
pub(super) const GENERATOR: &str = "sculptd";

/// Fields beside a primitive, of this program: the names of its group, as in OBJ.
pub(super) const OBJECT: &str = "object";
pub(super) const GROUP: &str = "group";

/// Extensions that change what is read here, and are read.
const READ: [&str; 4] = [MESHOPT[0], MESHOPT[1], INSTANCING, "KHR_mesh_quantization"];
/// Extensions whose compressed geometry is not read.
const COMPRESSED: [&str; 1] = ["KHR_draco_mesh_compression"];

/// Corners that instances may add up to: a small file can name one mesh a million times.
pub(super) const MAX_INSTANCED: usize = 200_000_000;

fn bad(at: FilePlace, expected: impl Into<String>, found: impl Into<String>) -> ParseError {
    FileProblem::new(at, expected.into(), found.into()).into()
}

/// A GLB container's two chunks.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ParseError> {
    let word =
        |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(bad(
            FilePlace::Byte(bytes.len() as u64),
            "a GLB header of 12 bytes",
            "the end of the file",
        ));
    };
    if version != 2 {
        return Err(bad(FilePlace::Byte(4), "version 2", version.to_string()));
    }
    if length as usize > bytes.len() {
        let found = format!("the end of the file after {} bytes", bytes.len());
        let at = FilePlace::Byte(bytes.len() as u64);
        return Err(bad(at, format!("{length} bytes as the header states"), found));
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while at + 8 <= length as usize {
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else { break };
        let Some(body) = bytes.get(at + 8..at + 8 + size as usize) else {
            return Err(bad(
                FilePlace::Byte(at as u64),
                format!("a chunk of {size} bytes"),
                "the end of the file",
            ));
        };
        match kind {
            0x4e4f_534a if json.is_none() => json = Some(body),
            0x004e_4942 if binary.is_none() => binary = Some(body),
            _ => {}
        }
        at += 8 + size as usize;
    }
    let json = json.ok_or_else(|| bad(FilePlace::Byte(12), "a chunk of JSON", "none"))?;
    Ok((json, binary))
}

pub(super) fn parse(
    bytes: &[u8],
    name: &Path,
    warnings: &mut Vec<String>,
    targets: &mut Vec<MorphTarget>,
    (unit, job): (GltfUnit, &Job),
) -> Result<PolyMesh, ParseError> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let root: Root = serde_json::from_slice(json)
        .map_err(|e| bad(FilePlace::Line(e.line() as u64), "glTF 2.0 as JSON", format!("{e}")))?;
    let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if version.split('.').next() != Some("2") {
        return Err(bad(FilePlace::File, "glTF version 2", format!("version {version}")));
    }
    for needed in &root.extensions_required {
        if COMPRESSED.contains(&needed.as_str()) {
            return Err(bad(
                FilePlace::File,
                "geometry that is not compressed, or by EXT_meshopt_compression",
                format!("the extension {needed}"),
            ));
        }
        if !READ.contains(&needed.as_str()) {
            warnings.push(format!("the extension {needed} is not looked at"));
        }
    }
    let buffers = buffers::read(&root, binary, name, job)?;
    let unpacked = meshopt::unpack(&root, &buffers, job)?;
    let mut file = GltfFile {
        root: &root,
        buffers,
        unpacked,
        mesh: PolyMesh::new(),
        colours: Vec::new(),
        coloured: false,
        groups: Vec::new(),
        attributes: FaceAttributes::default(),
        left_out: LeftOut::default(),
        targets: Vec::new(),
    };
    job.progress(0.3);
    let scene = root.scene.or(if root.scenes.is_empty() { None } else { Some(Index::new(0)) });
    let roots: Vec<usize> = match scene.and_then(|s| root.scenes.get(s.value())) {
        Some(s) => s.nodes.iter().map(|n| n.value()).collect(),
        None => (0..root.nodes.len()).collect(),
    };
    let (outer, marked) = outermost(&root, unit, roots.len());
    let mut todo: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|n| (n, outer)).collect();
    let mut converts = marked;
    let mut seen = vec![false; root.nodes.len()];
    while let Some((n, outer)) = todo.pop() {
        job.check()?;
        let Some(node) = root.nodes.get(n) else {
            return Err(bad(
                FilePlace::File,
                format!("a node below {}", root.nodes.len()),
                n.to_string(),
            ));
        };
        if std::mem::replace(&mut seen[n], true) {
            if scene.is_none() {
                continue;
            }
            return Err(bad(FilePlace::File, "a tree of nodes", format!("node {n} twice")));
        }
        let own = match node.matrix {
            Some(m) => DMat4::from_cols_array(&m.map(f64::from)),
            None => DMat4::from_scale_rotation_translation(
                DVec3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from)),
                node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from))),
                DVec3::from(node.translation.unwrap_or_default().map(f64::from)),
            ),
        };
        let place = if std::mem::take(&mut converts) { outer } else { outer * own };
        if let Some(m) = node.mesh {
            for inner in file.places(node, n)? {
                file.instance(m.value(), place * inner, node.name.as_deref(), job)?;
            }
        }
        for child in node.children.iter().flatten().rev() {
            todo.push((child.value(), place));
        }
    }
    warnings.extend(file.left_out.sentences(&root));
    let mut mesh = file.mesh;
    if mesh.face_count() == 0 {
        return Err(bad(FilePlace::File, "a node with triangles in the default scene", "none"));
    }
    let named = file.attributes.groups.iter().any(|name| *name != GroupName::default());
    let several = file.groups.windows(2).any(|w| w[0] != w[1]);
    mesh.groups = (named || several).then_some(file.groups);
    if !named {
        file.attributes.groups.clear();
    }
    if !file.attributes.uv_corners.is_empty() {
        file.attributes.uv_corners.resize(mesh.corners.len(), NO_UV);
    }
    mesh.attributes = (!file.attributes.is_empty()).then(|| Arc::new(file.attributes));
    mesh.colours = file.coloured.then_some(file.colours);
    targets.append(&mut file.targets);
    Ok(mesh)
}

/// Returns the transform around all nodes, and whether the first node's own is left out: that of a
/// file of this program, whose numbers are millimetres.
fn outermost(root: &Root, unit: GltfUnit, roots: usize) -> (DMat4, bool) {
    let grown = DMat4::from_scale(DVec3::splat(1000.0));
    let ours = root.asset.generator.as_deref() == Some(GENERATOR);
    let marks = root.asset.extras.as_ref().is_some_and(|e| e.get().contains(IN_MILLIMETRES));
    match unit {
        GltfUnit::AsTheyStand => (DMat4::IDENTITY, false),
        GltfUnit::Millimetres if ours && !marks => (DMat4::IDENTITY, false),
        GltfUnit::Millimetres if ours && roots == 1 => (DMat4::IDENTITY, true),
        // Of another program, or changed by one.
        GltfUnit::Millimetres => (grown, false),
    }
}

/// The unread parts of a file, counted.
#[derive(Default)]
struct LeftOut {
    /// Primitives of points or lines.
    primitives: usize,
    targets: usize,
    /// Triangles of which two corners are in one place.
    flat: usize,
    /// Further sets of texture coordinates.
    sets: usize,
    /// Texture coordinates that are no numbers, or not as many as points.
    bad_uvs: usize,
}

impl LeftOut {
    /// One sentence for each kind. Normals and tangents are not named: they follow from the
    /// surface.
    fn sentences(&self, root: &Root) -> Vec<String> {
        let (materials, textures) = (root.materials.len(), root.textures.len());
        let mut out = Vec::new();
        let mut say = |count: usize, text: String| {
            if count > 0 {
                out.push(text);
            }
        };
        let of = |count: usize, what: &str| format!("{count} {what} left out");
        say(self.primitives, of(self.primitives, "primitives of points or lines"));
        say(self.targets, of(self.targets, "morph targets"));
        say(self.flat, of(self.flat, "triangles with two corners in one place"));
        say(self.sets, of(self.sets, "further sets of texture coordinates"));
        say(self.bad_uvs, of(self.bad_uvs, "damaged sets of texture coordinates"));
        say(materials, of(materials, "looks of materials"));
        say(textures, of(textures, "textures"));
        say(root.skins.len(), of(root.skins.len(), "skins"));
        say(root.animations.len(), of(root.animations.len(), "animations"));
        out
    }
}

struct GltfFile<'a> {
    root: &'a Root,
    buffers: Vec<Cow<'a, [u8]>>,
    /// The bytes of the views that are packed, by their numbers.
    unpacked: BTreeMap<usize, Vec<u8>>,
    mesh: PolyMesh,
    colours: Vec<[u8; 4]>,
    coloured: bool,
    groups: Vec<u32>,
    attributes: FaceAttributes,
    left_out: LeftOut,
    targets: Vec<MorphTarget>,
}

impl GltfFile<'_> {
    /// Adds a mesh at a place; `node`: the name of its node.
    fn instance(
        &mut self,
        mesh: usize,
        place: DMat4,
        node: Option<&str>,
        job: &Job,
    ) -> Result<(), ParseError> {
        let root = self.root;
        let Some(source) = root.meshes.get(mesh) else {
            return Err(bad(
                FilePlace::File,
                format!("a mesh below {}", root.meshes.len()),
                mesh.to_string(),
            ));
        };
        let (mut points, mut corners, mut groups) =
            (PrimitivePoints::default(), Vec::new(), Vec::new());
        let mut starts = Vec::new();
        for (p, primitive) in source.primitives.iter().enumerate() {
            job.check()?;
            let what = format!("primitive {p} of mesh {mesh}");
            let first = points.places.len() as u32;
            let Some(triangles) = self.primitive(primitive, &what, &mut points)? else { continue };
            if self.mesh.corners.len() + corners.len() + triangles.len() > MAX_INSTANCED {
                return Err(bad(
                    FilePlace::File,
                    format!("at most {MAX_INSTANCED} corners in all instances"),
                    "more",
                ));
            }
            starts.push((p, first as usize));
            let name = self.group_name(mesh, p, node);
            groups.resize(groups.len() + triangles.len() / 3, self.attributes.groups.len() as u32);
            self.attributes.groups.push(name);
            corners.extend(triangles.iter().map(|i| first + i));
        }
        let mut placed = Vec::with_capacity(points.places.len());
        for p in &points.places {
            let q = place.transform_point3(*p) + DVec3::ZERO;
            if let Some(found) = q.to_array().into_iter().find_map(refuse) {
                return Err(bad(
                    FilePlace::File,
                    format!("finite coordinates in mesh {mesh}"),
                    found,
                ));
            }
            placed.push(q.to_array().map(f64::to_bits));
        }
        let (unique, of) = weld_keys(placed.len(), job, |i| placed[i])?;
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(unique.iter().map(|b| DVec3::from(b.map(f64::from_bits))));
        self.morphs(mesh, place, &starts, (&of, base));
        self.coloured |= points.colours.iter().any(|&c| c != [255; 4]);
        self.colours.resize(self.mesh.positions.len(), [255; 4]);
        for (v, c) in of.iter().zip(&points.colours).rev() {
            self.colours[(base + v) as usize] = *c;
        }
        let mirrored = place.determinant() < 0.0;
        let (first_corner, first_uv) = (self.mesh.corners.len(), self.attributes.uvs.len() as u32);
        let mut uv_corners = Vec::new();
        for (t, g) in corners.chunks_exact(3).zip(groups) {
            let t = if mirrored { [t[2], t[1], t[0]] } else { [t[0], t[1], t[2]] };
            let [a, b, c] = t.map(|i| base + of[i as usize]);
            if a == b || b == c || c == a {
                self.left_out.flat += 1;
                continue;
            }
            self.mesh.push_face(&[a, b, c]);
            self.groups.push(g);
            if !points.uvs.is_empty() {
                let uv = |i: u32| points.uvs.get(i as usize).is_some_and(Option::is_some);
                uv_corners.extend(t.map(|i| if uv(i) { first_uv + i } else { NO_UV }));
            }
        }
        if !uv_corners.is_empty() {
            self.attributes.uv_corners.resize(first_corner, NO_UV);
            self.attributes.uv_corners.append(&mut uv_corners);
            self.attributes.uvs.extend(points.uvs.iter().map(|uv| uv.unwrap_or_default()));
        }
        Ok(())
    }

    /// Returns the names of a primitive: its node or its mesh, and its material. What this program
    /// wrote also names the group.
    fn group_name(&self, mesh: usize, p: usize, node: Option<&str>) -> GroupName {
        let source = &self.root.meshes[mesh];
        let primitive = &source.primitives[p];
        let own = primitive.extras.as_ref();
        let own: serde_json::Value =
            own.and_then(|e| serde_json::from_str(e.get()).ok()).unwrap_or_default();
        let own = |name: &str| own[name].as_str();
        let material = primitive.material.and_then(|m| self.root.materials.get(m.value()));
        let text = |name: Option<&str>| name.unwrap_or_default().to_owned();
        GroupName {
            object: text(own(OBJECT).or(node).or(source.name.as_deref())),
            group: text(own(GROUP)),
            material: text(material.and_then(|m| m.name.as_deref())),
        }
    }
}

#[cfg(test)]
mod tests;
