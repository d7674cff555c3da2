//! GLB and glTF, out: single precision, colours as linear light (as the format has them) of
//! 16 bits, which every byte of sRGB survives.

use std::io::{self, Write};

use glam::{DQuat, DVec3, Vec3};
use serde_json::{Map, Value, json};

use super::gltf::{GROUP, GltfUnit, IN_MILLIMETRES, OBJECT};
use super::{MorphTarget, MorphedMesh};
use crate::face_attributes::NO_UV;
use crate::{GroupName, PolyMesh};

/// A mesh on its way to a glTF file.
#[derive(Debug, Clone, Copy)]
pub(super) struct GltfMesh<'a> {
    pub mesh: &'a PolyMesh,
    /// The name of its node.
    pub name: Option<&'a str>,
    /// Its base and its morph targets, which replace its positions.
    pub morphed: Option<&'a MorphedMesh>,
    /// Shift, turn and scale of its node; `None` for no transform.
    pub place: Option<(DVec3, DQuat, f64)>,
}

impl<'a> GltfMesh<'a> {
    /// Without a name and a place.
    pub fn bare(mesh: &'a PolyMesh) -> GltfMesh<'a> {
        GltfMesh { mesh, name: None, morphed: None, place: None }
    }
}

/// A file on the way.
struct GltfScene<'a> {
    json: Value,
    parts: Vec<GltfPart<'a>>,
    /// Bytes of the buffer.
    total: usize,
}

/// One mesh in the buffer, in this order.
struct GltfPart<'a> {
    points: Vec<Vec3>,
    /// v downwards; as many as points, or none.
    uvs: Vec<[f32; 2]>,
    /// One primitive after the other.
    triangles: Vec<[u32; 3]>,
    /// The vertex of each point, and the colours of the vertices.
    colours: Option<(Vec<u32>, &'a [[u8; 4]])>,
    targets: &'a [MorphTarget],
}

/// The triangles of a group, with or without texture coordinates.
struct GltfPrimitive {
    group: u32,
    has_uv: bool,
    first: usize,
    count: usize,
}

impl<'a> GltfPart<'a> {
    fn new(one: &GltfMesh<'a>) -> (GltfPart<'a>, Vec<GltfPrimitive>) {
        let (triangles, faces) = one.mesh.triangles();
        let morphed = one.morphed.filter(|m| m.base.len() == one.mesh.positions.len());
        let places = morphed.map_or(&one.mesh.positions, |m| &m.base);
        let uvs = one.mesh.uvs().filter(|_| morphed.is_none());
        let uv = |face: u32, vertex: u32| {
            let (corners, (_, of)) = (one.mesh.face(face as usize), uvs?);
            let at = corners.iter().position(|c| *c == vertex)?;
            Some(of[one.mesh.face_starts[face as usize] as usize + at]).filter(|n| *n != NO_UV)
        };
        let group = |face: u32| one.mesh.groups.as_ref().map_or(0, |g| g[face as usize]);
        let with_uv = |t: usize| triangles[t].iter().all(|v| uv(faces[t], *v).is_some());
        let mut order: Vec<(u32, bool, usize)> = (0..triangles.len())
            .map(|t| (group(faces[t]), uvs.is_some() && with_uv(t), t))
            .collect();
        // Stable: the triangles of a group keep their order.
        order.sort_by_key(|&(group, has_uv, _)| (group, has_uv));
        let mut primitives: Vec<GltfPrimitive> = Vec::new();
        for (n, &(group, has_uv, _)) in order.iter().enumerate() {
            match primitives.last_mut() {
                Some(p) if (p.group, p.has_uv) == (group, has_uv) => p.count += 1,
                _ => primitives.push(GltfPrimitive { group, has_uv, first: n, count: 1 }),
            }
        }
        let single = |p: &DVec3| p.as_vec3();
        let Some((values, _)) = uvs else {
            let points: Vec<Vec3> = places.iter().map(single).collect();
            let of = (0..points.len() as u32).collect();
            let colours = one.mesh.colours.as_deref().map(|c| (of, c));
            let targets = morphed.map_or(&[][..], |m| &m.targets);
            let triangles = order.iter().map(|o| triangles[o.2]).collect();
            return (GltfPart { points, uvs: Vec::new(), triangles, colours, targets }, primitives);
        };
        // A point for each pair of a vertex and a texture coordinate.
        let key = |t: usize, v: u32, has_uv: bool| {
            let uv = if has_uv { uv(faces[t], v) } else { None };
            (v, uv.unwrap_or(NO_UV))
        };
        let corners = order.iter().flat_map(|&(_, has_uv, t)| {
            let key = &key;
            triangles[t].into_iter().map(move |v| key(t, v, has_uv))
        });
        let corners: Vec<(u32, u32)> = corners.collect();
        let mut keys = corners.clone();
        keys.sort_unstable();
        keys.dedup();
        let at = |key: &(u32, u32)| keys.binary_search(key).unwrap_or_default() as u32;
        let triangles =
            corners.as_chunks::<3>().0.iter().map(|t| [at(&t[0]), at(&t[1]), at(&t[2])]);
        let triangles = triangles.collect();
        let coordinate = |n: u32| values.get(n as usize).copied().unwrap_or_default();
        let part = GltfPart {
            points: keys.iter().map(|k| single(&places[k.0 as usize])).collect(),
            uvs: keys
                .iter()
                .map(|k| coordinate(k.1))
                .map(|[u, v]| [u as f32, (1.0 - v) as f32])
                .collect(),
            triangles,
            colours: one.mesh.colours.as_deref().map(|c| (keys.iter().map(|k| k.0).collect(), c)),
            targets: &[],
        };
        (part, primitives)
    }
}

/// Accessors and views as they are listed.
#[derive(Default)]
struct GltfLists {
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    total: usize,
}

impl GltfLists {
    /// Adds a view of the next bytes; its number.
    fn view(&mut self, bytes: usize, target: u32) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.total, "byteLength": bytes, "target": target,
        }));
        self.total += bytes;
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds an accessor of places or offsets between two corners.
    fn vectors(&mut self, count: usize, (lo, hi): (Vec3, Vec3)) -> usize {
        let view = self.view(count * 12, 34962);
        self.accessor(json!({
            "bufferView": view, "componentType": 5126, "count": count, "type": "VEC3",
            "min": lo.to_array(), "max": hi.to_array(),
        }))
    }

    /// The number of the material of a name.
    fn material(&mut self, name: &str) -> usize {
        let known = self.materials.iter().position(|m| m["name"] == name);
        known.unwrap_or_else(|| {
            self.materials.push(json!({"name": name}));
            self.materials.len() - 1
        })
    }

    /// Adds a mesh; the JSON of it.
    fn mesh(
        &mut self,
        one: &GltfMesh<'_>,
        name: Option<&str>,
        part: &GltfPart<'_>,
        primitives: &[GltfPrimitive],
    ) -> Value {
        let count = part.points.len();
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let bounds = part.points.iter().fold(none, |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let mut shared = Map::new();
        shared.insert("POSITION".into(), self.vectors(count, bounds).into());
        let uvs = (!part.uvs.is_empty()).then(|| {
            let view = self.view(count * 8, 34962);
            self.accessor(json!({
                "bufferView": view, "componentType": 5126, "count": count, "type": "VEC2",
            }))
        });
        let index = self.view(part.triangles.len() * 12, 34963);
        if part.colours.is_some() {
            let view = self.view(count * 8, 34962);
            let colours = self.accessor(json!({
                "bufferView": view, "componentType": 5123, "normalized": true,
                "count": count, "type": "VEC4",
            }));
            shared.insert("COLOR_0".into(), colours.into());
        }
        let morphs: Vec<Value> = part.targets.iter().map(|t| self.target(t, count)).collect();
        let mut listed = Vec::new();
        for p in primitives {
            let indices = self.accessor(json!({
                "bufferView": index, "byteOffset": p.first * 12, "componentType": 5125,
                "count": p.count * 3, "type": "SCALAR",
            }));
            let mut attributes = shared.clone();
            if let Some(uvs) = uvs.filter(|_| p.has_uv) {
                attributes.insert("TEXCOORD_0".into(), uvs.into());
            }
            let mut primitive = json!({"attributes": attributes, "indices": indices, "mode": 4});
            if !morphs.is_empty() {
                primitive["targets"] = json!(morphs);
            }
            if let Some(group) = one.mesh.group_name(p.group) {
                self.name(&mut primitive, group, name);
            }
            listed.push(primitive);
        }
        let mut mesh = json!({"primitives": listed});
        if !part.targets.is_empty() {
            mesh["weights"] = part.targets.iter().map(MorphTarget::applied).collect();
            let names: Vec<&str> = part.targets.iter().map(|t| t.name.as_str()).collect();
            let own: Vec<Value> = part
                .targets
                .iter()
                .map(|t| json!({"intensity": t.weight, "visible": t.visible}))
                .collect();
            mesh["extras"] = json!({"targetNames": names, "sculptdLayers": own});
        }
        mesh
    }

    fn target(&mut self, target: &MorphTarget, count: usize) -> Value {
        let zero = (Vec3::ZERO, Vec3::ZERO);
        let mut bounds = target.offsets.iter().map(|o| (o.1, o.1));
        // If every vertex has an offset, 0 is not among them.
        let first = bounds.next().filter(|_| target.offsets.len() == count).unwrap_or(zero);
        let offsets = target.offsets.iter().map(|o| o.1);
        let bounds = offsets.fold(first, |(lo, hi), o| (lo.min(o), hi.max(o)));
        json!({"POSITION": self.vectors(count, bounds)})
    }

    /// Adds the names of a group to its primitive: its material, and what the node does not say.
    fn name(&mut self, primitive: &mut Value, group: &GroupName, node: Option<&str>) {
        if !group.material.is_empty() {
            primitive["material"] = self.material(&group.material).into();
        }
        let mut own = Map::new();
        if Some(group.object.as_str()) != node {
            own.insert(OBJECT.into(), group.object.as_str().into());
        }
        if !group.group.is_empty() {
            own.insert(GROUP.into(), group.group.as_str().into());
        }
        if !own.is_empty() {
            primitive["extras"] = own.into();
        }
    }
}

/// The name of a mesh's node: that of the mesh, or the one object of all its groups.
fn node_name<'a>(one: &GltfMesh<'a>, primitives: &[GltfPrimitive]) -> Option<&'a str> {
    let mesh = one.mesh;
    let mut objects = primitives.iter().filter_map(|p| mesh.group_name(p.group));
    let first = objects.next().map(|g| g.object.as_str()).filter(|o| !o.is_empty());
    let same = objects.all(|g| Some(g.object.as_str()) == first);
    one.name.or(first.filter(|_| same))
}

fn scene<'a>(meshes: &[GltfMesh<'a>], unit: GltfUnit) -> GltfScene<'a> {
    let mut lists = GltfLists::default();
    let (mut nodes, mut listed, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    // No accessor may be empty: an empty solid has no node.
    for one in meshes {
        let (part, primitives) = GltfPart::new(one);
        if primitives.is_empty() {
            continue;
        }
        let name = node_name(one, &primitives);
        let mut node = json!({"mesh": listed.len()});
        if let Some(name) = name {
            node["name"] = name.into();
        }
        if let Some((shift, turn, scale)) = one.place {
            node["translation"] = json!(shift.to_array());
            node["rotation"] = json!(turn.to_array());
            node["scale"] = json!([scale, scale, scale]);
        }
        nodes.push(node);
        listed.push(lists.mesh(one, name, &part, &primitives));
        parts.push(part);
    }
    let mut asset = json!({"version": "2.0", "generator": "sculptd"});
    let mut shown: Vec<usize> = (0..nodes.len()).collect();
    if unit == GltfUnit::Millimetres && !nodes.is_empty() {
        asset["extras"] = json!({IN_MILLIMETRES: true});
        nodes.push(json!({"name": "millimetres", "scale": [1e-3, 1e-3, 1e-3], "children": shown}));
        shown = vec![nodes.len() - 1];
    }
    let mut json = json!({"asset": asset, "scene": 0, "scenes": [{}]});
    if !parts.is_empty() {
        json = json!({
            "asset": asset, "scene": 0, "scenes": [{"nodes": shown}], "nodes": nodes,
            "meshes": listed, "buffers": [{"byteLength": lists.total}],
            "bufferViews": lists.views, "accessors": lists.accessors,
        });
        if !lists.materials.is_empty() {
            json["materials"] = lists.materials.into();
        }
    }
    GltfScene { json, parts, total: lists.total }
}

impl GltfScene<'_> {
    fn buffer(&self, out: &mut dyn Write) -> io::Result<()> {
        self.parts.iter().try_for_each(|part| part.write(out))
    }
}

impl GltfPart<'_> {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for p in &self.points {
            out.write_all(bytemuck::bytes_of(&p.to_array().map(|v| v.to_bits().to_le())))?;
        }
        for uv in &self.uvs {
            out.write_all(bytemuck::bytes_of(&uv.map(|v| v.to_bits().to_le())))?;
        }
        for t in &self.triangles {
            out.write_all(bytemuck::bytes_of(&t.map(u32::to_le)))?;
        }
        let colours = self.colours.iter();
        for c in colours.flat_map(|(of, all)| of.iter().map(|v| all[*v as usize])) {
            let linear = |v: u8| {
                let v = v as f64 / 255.0;
                let l = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
                (l * 65535.0).round() as u16
            };
            let [r, g, b] = [linear(c[0]), linear(c[1]), linear(c[2])];
            let all = [r, g, b, u16::from(c[3]) * 257].map(u16::to_le);
            out.write_all(bytemuck::bytes_of(&all))?;
        }
        for target in self.targets {
            let mut offsets = target.offsets.iter().peekable();
            for v in 0..self.points.len() as u32 {
                let by = offsets.next_if(|o| o.0 == v).map_or(Vec3::ZERO, |o| o.1);
                out.write_all(bytemuck::bytes_of(&by.to_array().map(|v| v.to_bits().to_le())))?;
            }
        }
        Ok(())
    }
}

/// glTF in its binary container.
pub(super) fn glb(meshes: &[GltfMesh<'_>], unit: GltfUnit, out: &mut dyn Write) -> io::Result<()> {
    let scene = scene(meshes, unit);
    let total = scene.total;
    let mut json = serde_json::to_vec(&scene.json)?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = u32::try_from(12 + 8 + json.len() + 8 + total)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "GLB holds at most 4 GiB"))?;
    out.write_all(b"glTF")?;
    for word in [2, length, json.len() as u32, 0x4e4f_534a] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&json)?;
    for word in [total as u32, 0x004e_4942] {
        out.write_all(&word.to_le_bytes())?;
    }
    scene.buffer(out)
}

/// glTF as JSON, its buffer inside.
pub(super) fn gltf(meshes: &[GltfMesh<'_>], unit: GltfUnit, out: &mut dyn Write) -> io::Result<()> {
    let mut scene = scene(meshes, unit);
    if scene.total > 0 {
        let mut bytes = Vec::with_capacity(scene.total);
        scene.buffer(&mut bytes)?;
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        scene.json["buffers"][0]["uri"] = uri.into();
    }
    out.write_all(&serde_json::to_vec(&scene.json)?)
}

/// Base64 with padding (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for part in bytes.chunks(3) {
        let byte = |i: usize| u32::from(part.get(i).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= part.len() { letter.into() } else { '=' });
        }
    }
    out
}
