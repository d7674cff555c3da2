//! glTF 2.0, as JSON with its buffers beside it or inside it, and as GLB. The JSON's meaning is
//! read by the kept crate `gltf-json`; buffers, views and accessors by us, so that each length is
//! checked against the bytes there are.
//!
//! Triangles (lists, strips, fans) of the default scene, each node's transform applied; coordinates
//! as they stand, y up and without a unit's change. Corners of one node that are equal in place are
//! one vertex: files of this format have a vertex for each normal and texture coordinate. Morph
//! targets come beside the mesh, which stands without them. Skins and materials are passed over.

mod morph;

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use glam::{DMat4, DQuat, DVec3};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use super::morph::MorphTarget;
use super::problem::{FilePlace, FileProblem, ParseError, excerpt};
use super::text::refuse;
use crate::job::Job;
use crate::weld::weld_keys;
use crate::{PolyMesh, repair};

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
    job: &Job,
) -> Result<PolyMesh, ParseError> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let root: Root = serde_json::from_slice(json)
        .map_err(|e| bad(FilePlace::Line(e.line() as u64), "glTF 2.0 as JSON", format!("{e}")))?;
    let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if version.split('.').next() != Some("2") {
        return Err(bad(FilePlace::File, "glTF version 2", format!("version {version}")));
    }
    for needed in &root.extensions_required {
        if needed.contains("compression") || needed.contains("meshopt") {
            return Err(bad(
                FilePlace::File,
                "geometry that is not compressed",
                format!("the extension {needed}"),
            ));
        }
        warnings.push(format!("the extension {needed} is not looked at"));
    }
    let mut file = GltfFile {
        root: &root,
        buffers: Vec::new(),
        mesh: PolyMesh::new(),
        colours: Vec::new(),
        coloured: false,
        groups: Vec::new(),
        left_out: 0,
        targets: Vec::new(),
        unread_targets: 0,
        extras: serde_json::Value::Null,
    };
    if root.meshes.iter().flat_map(|m| &m.primitives).any(|p| p.targets.is_some()) {
        // Names of targets stand where the kept crate does not look.
        file.extras = serde_json::from_slice(json).unwrap_or_default();
    }
    for (n, buffer) in root.buffers.iter().enumerate() {
        job.check()?;
        let bytes = match &buffer.uri {
            None if n == 0 => binary
                .map(|b| b.to_vec())
                .ok_or_else(|| bad(FilePlace::File, "a binary chunk for buffer 0", "none"))?,
            None => return Err(bad(FilePlace::File, format!("a uri of buffer {n}"), "none")),
            Some(uri) => fetch(uri, name, n)?,
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let found = format!("{} bytes", bytes.len());
            return Err(bad(
                FilePlace::File,
                format!("{} bytes in buffer {n}", buffer.byte_length.0),
                found,
            ));
        }
        file.buffers.push(bytes);
    }
    job.progress(0.3);
    let scene = root.scene.or(if root.scenes.is_empty() { None } else { Some(Index::new(0)) });
    let mut todo: Vec<(usize, DMat4)> = match scene.and_then(|s| root.scenes.get(s.value())) {
        Some(s) => s.nodes.iter().rev().map(|n| (n.value(), DMat4::IDENTITY)).collect(),
        None => (0..root.nodes.len()).rev().map(|n| (n, DMat4::IDENTITY)).collect(),
    };
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
        let place = outer * own;
        if let Some(m) = node.mesh {
            file.instance(m.value(), place, job)?;
        }
        for child in node.children.iter().flatten().rev() {
            todo.push((child.value(), place));
        }
    }
    if file.left_out > 0 {
        warnings.push(format!("{} primitives of points or lines left out", file.left_out));
    }
    if file.unread_targets > 0 {
        warnings.push(format!("{} morph targets left out", file.unread_targets));
    }
    let (materials, textures) = (root.materials.len(), root.textures.len());
    if materials + textures > 0 {
        warnings.push(format!("{materials} materials and {textures} textures left out"));
    }
    let mut mesh = file.mesh;
    if mesh.face_count() == 0 {
        return Err(bad(FilePlace::File, "a node with triangles in the default scene", "none"));
    }
    mesh.groups = (file.groups.windows(2).any(|w| w[0] != w[1])).then_some(file.groups);
    mesh.colours = file.coloured.then_some(file.colours);
    targets.append(&mut file.targets);
    Ok(mesh)
}

/// A buffer's bytes, inside the JSON or in a file in the same folder or below it, and nowhere else.
fn fetch(uri: &str, name: &Path, n: usize) -> Result<Vec<u8>, ParseError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let body = data.split_once(";base64,").map(|(_, b)| b);
        return body.and_then(base64).ok_or_else(|| {
            bad(FilePlace::File, format!("base64 data in buffer {n}"), excerpt(uri.as_bytes()))
        });
    }
    let refused = |why: &str| {
        bad(
            FilePlace::File,
            format!("the name of a file beside this one as buffer {n}"),
            format!("\"{uri}\" ({why})"),
        )
    };
    let relative = PathBuf::from(percent(uri).ok_or_else(|| refused("no valid name"))?);
    if uri.contains("://")
        || !relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
    {
        return Err(refused("it leads elsewhere"));
    }
    let folder = match name.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let told = |e: std::io::Error| refused(&e.to_string());
    let path = folder.join(&relative).canonicalize().map_err(told)?;
    if !path.starts_with(folder.canonicalize().map_err(told)?) {
        return Err(refused("it leads elsewhere"));
    }
    super::read_regular(&path, super::MAX_FILE).map_err(told)
}

fn percent(uri: &str) -> Option<String> {
    let mut out = Vec::with_capacity(uri.len());
    let mut bytes = uri.bytes();
    while let Some(b) = bytes.next() {
        if b == b'%' {
            let digits = [bytes.next()?, bytes.next()?];
            out.push(u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?);
        } else {
            out.push(b);
        }
    }
    String::from_utf8(out).ok().filter(|s| !s.contains('\0'))
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut n) = (0u32, 0);
    for b in text.trim_end_matches('=').bytes() {
        let v = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | v as u32;
        n += 6;
        if n >= 8 {
            n -= 8;
            out.push((bits >> n) as u8);
        }
    }
    Some(out)
}

struct GltfFile<'a> {
    root: &'a Root,
    buffers: Vec<Vec<u8>>,
    mesh: PolyMesh,
    colours: Vec<[u8; 4]>,
    coloured: bool,
    groups: Vec<u32>,
    left_out: usize,
    targets: Vec<MorphTarget>,
    unread_targets: usize,
    /// The file as plain JSON, where it has morph targets.
    extras: serde_json::Value,
}

impl GltfFile<'_> {
    fn instance(&mut self, mesh: usize, place: DMat4, job: &Job) -> Result<(), ParseError> {
        let root = self.root;
        let Some(source) = root.meshes.get(mesh) else {
            return Err(bad(
                FilePlace::File,
                format!("a mesh below {}", root.meshes.len()),
                mesh.to_string(),
            ));
        };
        let (mut points, mut colours, mut corners, mut groups) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut starts = Vec::new();
        for (p, primitive) in source.primitives.iter().enumerate() {
            job.check()?;
            let what = format!("primitive {p} of mesh {mesh}");
            let first = points.len() as u32;
            let Some(triangles) = self.primitive(primitive, &what, &mut points, &mut colours)?
            else {
                continue;
            };
            if self.mesh.corners.len() + corners.len() + triangles.len() > MAX_INSTANCED {
                return Err(bad(
                    FilePlace::File,
                    format!("at most {MAX_INSTANCED} corners in all instances"),
                    "more",
                ));
            }
            starts.push((p, first as usize));
            groups.resize(
                groups.len() + triangles.len() / 3,
                self.groups.last().map_or(0, |g| g + 1) + p as u32,
            );
            corners.extend(triangles.iter().map(|i| first + i));
        }
        let mut placed = Vec::with_capacity(points.len());
        for p in &points {
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
        self.coloured |= colours.iter().any(|&c| c != [255; 4]);
        self.colours.resize(self.mesh.positions.len(), [255; 4]);
        for (v, c) in of.iter().zip(&colours).rev() {
            self.colours[(base + v) as usize] = *c;
        }
        let mut part = PolyMesh::new();
        let mut kept = Vec::new();
        for (t, g) in corners.chunks_exact(3).zip(groups) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| base + of[i as usize]);
            if a != b && b != c && c != a {
                part.push_face(&[a, b, c]);
                kept.push(g);
            }
        }
        if place.determinant() < 0.0 {
            repair::flip(&mut part);
        }
        part.faces().for_each(|f| self.mesh.push_face(f));
        self.groups.extend(kept);
        Ok(())
    }

    /// Appends a primitive's points (and white where it has no colours); its triangles' corners, or
    /// `None` if it has none.
    fn primitive(
        &mut self,
        primitive: &Primitive,
        what: &str,
        points: &mut Vec<DVec3>,
        colours: &mut Vec<[u8; 4]>,
    ) -> Result<Option<Vec<u32>>, ParseError> {
        let (Checked::Valid(mode), Some(at)) =
            (primitive.mode, primitive.attributes.get(&Checked::Valid(Semantic::Positions)))
        else {
            self.left_out += 1;
            return Ok(None);
        };
        let place = self.accessor(at.value(), &format!("positions of {what}"))?;
        if place.parts != 3 {
            return Err(bad(
                FilePlace::File,
                format!("three coordinates in the positions of {what}"),
                place.parts.to_string(),
            ));
        }
        let first = points.len();
        for i in 0..place.count {
            let mut v = [0.0; 3];
            for (c, v) in v.iter_mut().enumerate() {
                *v = place.value(i, c);
            }
            points.push(DVec3::from(v));
        }
        colours.resize(points.len(), [255; 4]);
        if let Some(c) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) {
            let c = self.accessor(c.value(), &format!("colours of {what}"))?;
            let top = match c.kind {
                ComponentType::U8 => 255.0,
                ComponentType::U16 => 65535.0,
                _ => 1.0,
            };
            for i in 0..c.count.min(place.count) {
                for part in 0..c.parts.min(4) {
                    let linear = (c.get(i, part) / top).clamp(0.0, 1.0);
                    let v = if part == 3 { linear } else { to_srgb(linear) };
                    colours[first + i][part] = (v * 255.0).round() as u8;
                }
            }
        }
        let count = place.count as u32;
        let order: Vec<u32> = match primitive.indices {
            None => (0..count).collect(),
            Some(i) => {
                let list = self.accessor(i.value(), &format!("indices of {what}"))?;
                if !matches!(list.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
                    || list.parts != 1
                {
                    return Err(bad(
                        FilePlace::File,
                        format!("whole numbers as indices of {what}"),
                        "another type",
                    ));
                }
                (0..list.count).map(|i| list.get(i, 0) as u32).collect()
            }
        };
        if let Some(out) = order.iter().find(|&&i| i >= count) {
            return Err(bad(
                FilePlace::File,
                format!("indices below {count} in {what}"),
                out.to_string(),
            ));
        }
        Ok(Some(match mode {
            Mode::Triangles => order[..order.len() - order.len() % 3].to_vec(),
            Mode::TriangleStrip => order
                .windows(3)
                .enumerate()
                .flat_map(|(n, w)| if n % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
                .collect(),
            Mode::TriangleFan => {
                order.windows(2).skip(1).flat_map(|w| [order[0], w[0], w[1]]).collect()
            }
            _ => {
                self.left_out += 1;
                points.truncate(first);
                colours.truncate(first);
                return Ok(None);
            }
        }))
    }

    fn accessor(&self, n: usize, what: &str) -> Result<AccessorValues<'_>, ParseError> {
        let wrong = |expected: &str, found: String| {
            bad(FilePlace::File, format!("{expected} for the {what}"), found)
        };
        let a = self.root.accessors.get(n).ok_or_else(|| {
            wrong("an accessor", format!("number {n} of {}", self.root.accessors.len()))
        })?;
        let (Checked::Valid(kind), Checked::Valid(shape)) = (a.component_type, a.type_) else {
            return Err(wrong("a known type", "another".into()));
        };
        let parts =
            parts_of(shape).ok_or_else(|| wrong("numbers or vectors", "matrices".into()))?;
        let (kind, count) = (kind.0, a.count.0 as usize);
        let mut all = match a.buffer_view {
            Some(view) => {
                let offset = a.byte_offset.map_or(0, |o| o.0) as usize;
                self.values((view.value(), offset), count, (kind, parts), what)?
            }
            // Without a view all are zero, but for the sparse ones.
            None if a.sparse.is_some() && count <= MAX_INSTANCED => AccessorValues::zeros(count),
            None => return Err(wrong("a buffer view", "none".into())),
        };
        (all.kind, all.parts, all.normalized) = (kind, parts, a.normalized);
        if let Some(sparse) = &a.sparse {
            let Checked::Valid(index) = sparse.indices.component_type else {
                return Err(wrong("a known type of sparse indices", "another".into()));
            };
            let number = sparse.count.0 as usize;
            let from = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0 as usize);
            let places = self.values(from, number, (index.0, 1), what)?;
            let from = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0 as usize);
            let values = self.values(from, number, (kind, parts), what)?;
            for i in 0..number {
                let at = places.get(i, 0);
                if !(at >= 0.0 && at < count as f64) {
                    let found = format!("{at} of {count}");
                    return Err(wrong("sparse indices within the count", found));
                }
                let mut row = [0.0; 4];
                for (part, value) in row.iter_mut().enumerate().take(parts) {
                    *value = values.get(i, part);
                }
                all.sparse.insert(at as usize, row);
            }
        }
        Ok(all)
    }

    /// So many values of a kind and so many parts in a buffer view, from a byte of it on.
    fn values(
        &self,
        (view, offset): (usize, usize),
        count: usize,
        (kind, parts): (ComponentType, usize),
        what: &str,
    ) -> Result<AccessorValues<'_>, ParseError> {
        let wrong = |expected: &str, found: String| {
            bad(FilePlace::File, format!("{expected} for the {what}"), found)
        };
        let view = self
            .root
            .buffer_views
            .get(view)
            .ok_or_else(|| wrong("a buffer view", format!("number {view}")))?;
        let buffer = self
            .buffers
            .get(view.buffer.value())
            .ok_or_else(|| wrong("a buffer", format!("number {}", view.buffer.value())))?;
        let start = view.byte_offset.map_or(0, |o| o.0) as usize;
        let bytes = start
            .checked_add(view.byte_length.0 as usize)
            .and_then(|end| buffer.get(start..end))
            .and_then(|b| b.get(offset..))
            .ok_or_else(|| {
                wrong(
                    "bytes inside its buffer",
                    format!("a view past its end ({} bytes)", buffer.len()),
                )
            })?;
        let size = kind.size();
        let stride = view.byte_stride.map_or(size * parts, |s| s.0);
        let need = count
            .checked_sub(1)
            .map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size * parts));
        if stride == 0 || need.is_none_or(|n| n > bytes.len()) || count >= u32::MAX as usize {
            return Err(wrong(
                "as many bytes as its count needs",
                format!("a count of {count} in {} bytes", bytes.len()),
            ));
        }
        let (normalized, sparse) = (false, BTreeMap::new());
        Ok(AccessorValues { bytes, stride, count, parts, kind, size, normalized, sparse })
    }
}

/// Numbers of an element; `None` of a matrix.
fn parts_of(shape: Type) -> Option<usize> {
    match shape {
        Type::Scalar => Some(1),
        Type::Vec2 => Some(2),
        Type::Vec3 => Some(3),
        Type::Vec4 => Some(4),
        _ => None,
    }
}

/// The numbers of an accessor; all within `bytes`.
struct AccessorValues<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    parts: usize,
    kind: ComponentType,
    size: usize,
    /// Whole numbers stand for parts of 1.
    normalized: bool,
    /// The sparse values, which replace those in `bytes`.
    sparse: BTreeMap<usize, [f64; 4]>,
}

impl AccessorValues<'_> {
    fn zeros(count: usize) -> Self {
        let (kind, sparse) = (ComponentType::F32, BTreeMap::new());
        let (stride, parts, size, normalized) = (0, 1, 0, false);
        AccessorValues { bytes: &[], stride, count, parts, kind, size, normalized, sparse }
    }

    fn get(&self, i: usize, part: usize) -> f64 {
        if let Some(row) = self.sparse.get(&i) {
            return row[part.min(3)];
        }
        let b = &self.bytes[i * self.stride + (part * self.size).min(self.bytes.len())..];
        match (self.kind, &b[..self.size]) {
            (_, &[]) => 0.0,
            (ComponentType::I8, &[a]) => a as i8 as f64,
            (ComponentType::U8, &[a]) => a as f64,
            (ComponentType::I16, &[a, b]) => i16::from_le_bytes([a, b]) as f64,
            (ComponentType::U16, &[a, b]) => u16::from_le_bytes([a, b]) as f64,
            (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]) as f64,
            (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]) as f64,
            _ => f64::NAN,
        }
    }

    /// The value that a whole number stands for where the accessor is normalized (glTF 2.0, 3.11):
    /// a signed one's least is -1 too.
    fn value(&self, i: usize, part: usize) -> f64 {
        let raw = self.get(i, part);
        match self.kind {
            _ if !self.normalized => raw,
            ComponentType::I8 => (raw / 127.0).max(-1.0),
            ComponentType::U8 => raw / 255.0,
            ComponentType::I16 => (raw / 32767.0).max(-1.0),
            ComponentType::U16 => raw / 65535.0,
            ComponentType::U32 | ComponentType::F32 => raw,
        }
    }
}

fn to_srgb(v: f64) -> f64 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}
