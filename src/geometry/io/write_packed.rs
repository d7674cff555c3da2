//! GLB, glTF and 3MF, out.

use std::io::{self, Cursor, Write};

use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};
use zip::write::SimpleFileOptions;

use super::{MorphTarget, MorphedMesh};
use crate::PolyMesh;

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

/// Meshes as glTF has them: single precision, colours as linear light (the format's own) of
/// 16 bits, which every byte of sRGB survives.
struct GltfScene<'a> {
    json: Value,
    parts: Vec<GltfPart<'a>>,
    /// Bytes of the buffer.
    total: usize,
}

/// One mesh in the buffer.
struct GltfPart<'a> {
    points: Vec<glam::Vec3>,
    triangles: Vec<[u32; 3]>,
    colours: Option<&'a [[u8; 4]]>,
    targets: &'a [MorphTarget],
}

fn scene<'a>(meshes: &[GltfMesh<'a>]) -> GltfScene<'a> {
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let (mut nodes, mut listed) = (Vec::new(), Vec::new());
    let (mut parts, mut total) = (Vec::new(), 0);
    // No accessor may be empty: an empty solid has no node.
    for one in meshes.iter().filter(|m| !m.mesh.positions.is_empty()) {
        let (triangles, _) = one.mesh.triangles();
        let morphed = one.morphed.filter(|m| m.base.len() == one.mesh.positions.len());
        let places = morphed.map_or(&one.mesh.positions, |m| &m.base);
        let targets = morphed.map_or(&[][..], |m| &m.targets);
        let points: Vec<glam::Vec3> = places.iter().map(|p| p.as_vec3()).collect();
        let none = (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY);
        let (lo, hi) = points.iter().fold(none, |(lo, hi), &p| (lo.min(p), hi.max(p)));
        let mut view = |bytes: usize, target: u32| {
            views.push(json!({
                "buffer": 0, "byteOffset": total, "byteLength": bytes, "target": target,
            }));
            total += bytes;
            views.len() - 1
        };
        let place = view(points.len() * 12, 34962);
        let index = view(triangles.len() * 12, 34963);
        let first = accessors.len();
        accessors.push(json!({
            "bufferView": place, "componentType": 5126, "count": points.len(), "type": "VEC3",
            "min": lo.to_array(), "max": hi.to_array(),
        }));
        accessors.push(json!({
            "bufferView": index, "componentType": 5125, "count": triangles.len() * 3,
            "type": "SCALAR",
        }));
        let mut attributes = json!({"POSITION": first});
        if let Some(colours) = &one.mesh.colours {
            let colour = view(colours.len() * 8, 34962);
            attributes["COLOR_0"] = accessors.len().into();
            accessors.push(json!({
                "bufferView": colour, "componentType": 5123, "normalized": true,
                "count": points.len(), "type": "VEC4",
            }));
        }
        let mut morphs = Vec::with_capacity(targets.len());
        for target in targets {
            let view = view(points.len() * 12, 34962);
            morphs.push(json!({"POSITION": accessors.len()}));
            let zero = (glam::Vec3::ZERO, glam::Vec3::ZERO);
            let mut bounds = target.offsets.iter().map(|o| (o.1, o.1));
            // If every vertex has an offset, 0 is not among them.
            let first =
                bounds.next().filter(|_| target.offsets.len() == points.len()).unwrap_or(zero);
            let offsets = target.offsets.iter().map(|o| o.1);
            let (lo, hi) = offsets.fold(first, |(lo, hi), o| (lo.min(o), hi.max(o)));
            accessors.push(json!({
                "bufferView": view, "componentType": 5126, "count": points.len(), "type": "VEC3",
                "min": lo.to_array(), "max": hi.to_array(),
            }));
        }
        let mut node = json!({"mesh": listed.len()});
        if let Some(name) = one.name {
            node["name"] = name.into();
        }
        if let Some((shift, turn, scale)) = one.place {
            node["translation"] = json!(shift.to_array());
            node["rotation"] = json!(turn.to_array());
            node["scale"] = json!([scale, scale, scale]);
        }
        nodes.push(node);
        let mut primitive = json!({"attributes": attributes, "indices": first + 1, "mode": 4});
        let mut mesh = json!({});
        if !targets.is_empty() {
            primitive["targets"] = morphs.into();
            mesh["weights"] = targets.iter().map(MorphTarget::applied).collect();
            let names: Vec<&str> = targets.iter().map(|t| t.name.as_str()).collect();
            let own: Vec<Value> = targets
                .iter()
                .map(|t| json!({"intensity": t.weight, "visible": t.visible}))
                .collect();
            mesh["extras"] = json!({"targetNames": names, "sculptdLayers": own});
        }
        mesh["primitives"] = json!([primitive]);
        listed.push(mesh);
        let colours = one.mesh.colours.as_deref();
        parts.push(GltfPart { points, triangles, colours, targets });
    }
    let asset = json!({"version": "2.0", "generator": "sculptd"});
    let json = if parts.is_empty() {
        json!({"asset": asset, "scene": 0, "scenes": [{}]})
    } else {
        let shown: Vec<usize> = (0..nodes.len()).collect();
        json!({
            "asset": asset, "scene": 0, "scenes": [{"nodes": shown}], "nodes": nodes,
            "meshes": listed, "buffers": [{"byteLength": total}], "bufferViews": views,
            "accessors": accessors,
        })
    };
    GltfScene { json, parts, total }
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
        for t in &self.triangles {
            out.write_all(bytemuck::bytes_of(&t.map(u32::to_le)))?;
        }
        for c in self.colours.into_iter().flatten() {
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
                let by = offsets.next_if(|o| o.0 == v).map_or(glam::Vec3::ZERO, |o| o.1);
                out.write_all(bytemuck::bytes_of(&by.to_array().map(|v| v.to_bits().to_le())))?;
            }
        }
        Ok(())
    }
}

/// glTF in its binary container.
pub(super) fn glb(meshes: &[GltfMesh<'_>], out: &mut dyn Write) -> io::Result<()> {
    let scene = scene(meshes);
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
pub(super) fn gltf(meshes: &[GltfMesh<'_>], out: &mut dyn Write) -> io::Result<()> {
    let mut scene = scene(meshes);
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

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" \
    ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" \
    ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

/// A mesh on its way to a 3MF file: a component of one object.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThreeMfPart<'a> {
    pub mesh: &'a PolyMesh,
    pub name: &'a str,
    /// Turn and scale.
    pub rows: DMat3,
    pub shift: DVec3,
}

/// One object, in millimetres, double precision.
pub(super) fn threemf(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    threemf_model(out, |text| {
        let id = threemf_mesh(1, "", mesh, text)?;
        writeln!(text, "</resources><build><item objectid=\"{id}\"/></build></model>")
    })
}

/// One object whose components are the parts, each with its name and its transform.
pub(super) fn threemf_parts(parts: &[ThreeMfPart<'_>], out: &mut dyn Write) -> io::Result<()> {
    threemf_model(out, |text| {
        let mut ids = Vec::new();
        for part in parts {
            let name = format!(" name=\"{}\"", xml(part.name));
            let first = ids.last().map_or(1, |last| last + 1);
            ids.push(threemf_mesh(first, &name, part.mesh, text)?);
        }
        let all = ids.last().map_or(1, |last| last + 1);
        writeln!(text, "<object id=\"{all}\" type=\"model\"><components>")?;
        for (part, id) in parts.iter().zip(&ids) {
            // Row vectors: the axes one after the other, then the shift.
            let numbers = part.rows.to_cols_array().into_iter().chain(part.shift.to_array());
            let numbers: Vec<String> = numbers.map(|n| n.to_string()).collect();
            let at = numbers.join(" ");
            writeln!(text, "<component objectid=\"{id}\" transform=\"{at}\"/>")?;
        }
        writeln!(
            text,
            "</components></object></resources><build><item objectid=\"{all}\"/></build></model>"
        )
    })
}

/// A text as the value of an attribute.
fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// The package around a model whose resources and build `rest` writes.
fn threemf_model(
    out: &mut dyn Write,
    rest: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    // No clock in it: the same mesh gives the same bytes.
    let options =
        SimpleFileOptions::default().last_modified_time(zip::DateTime::default()).large_file(true);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options)?;
    let mut text = io::BufWriter::with_capacity(1 << 16, &mut zip);
    writeln!(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        text,
        "<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">"
    )?;
    writeln!(text, "<resources>")?;
    rest(&mut text)?;
    text.flush()?;
    drop(text);
    out.write_all(&zip.finish()?.into_inner())
}

/// Writes a mesh as an object, after its group of colours if it has any. `id`: the first free
/// number of a resource. Returns the object's.
fn threemf_mesh(id: usize, name: &str, mesh: &PolyMesh, text: &mut dyn Write) -> io::Result<usize> {
    let mut places = Vec::new();
    if let Some(colours) = &mesh.colours {
        // Each colour once, in the order in which vertices have them.
        let mut known = std::collections::BTreeMap::new();
        writeln!(text, "<m:colorgroup id=\"{id}\">")?;
        for colour in colours {
            let next = known.len();
            let place = *known.entry(*colour).or_insert(next);
            if place == next {
                let [r, g, b, a] = *colour;
                writeln!(text, "<m:color color=\"#{r:02X}{g:02X}{b:02X}{a:02X}\"/>")?;
            }
            places.push(place);
        }
        writeln!(text, "</m:colorgroup>")?;
    }
    let object = if places.is_empty() { id } else { id + 1 };
    let property = match places.is_empty() {
        true => String::new(),
        false => format!(" pid=\"{id}\" pindex=\"0\""),
    };
    writeln!(text, "<object id=\"{object}\" type=\"model\"{name}{property}><mesh><vertices>")?;
    for p in &mesh.positions {
        writeln!(text, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z)?;
    }
    writeln!(text, "</vertices><triangles>")?;
    for corners in mesh.triangles().0 {
        let [a, b, c] = corners;
        write!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        if !places.is_empty() {
            let [p, q, r] = corners.map(|v| places[v as usize]);
            write!(text, " pid=\"{id}\" p1=\"{p}\" p2=\"{q}\" p3=\"{r}\"")?;
        }
        writeln!(text, "/>")?;
    }
    writeln!(text, "</triangles></mesh></object>")?;
    Ok(object)
}
