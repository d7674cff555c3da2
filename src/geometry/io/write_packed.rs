//! GLB, glTF and 3MF, out.

use std::io::{self, Cursor, Write};

use zip::write::SimpleFileOptions;

use crate::PolyMesh;

/// A mesh as glTF has it: single precision, colours as bytes of linear light (the format's own).
struct GltfScene<'a> {
    json: serde_json::Value,
    points: Vec<glam::Vec3>,
    triangles: Vec<[u32; 3]>,
    colours: Option<&'a [[u8; 4]]>,
    /// Bytes of the buffer.
    total: usize,
}

fn scene(mesh: &PolyMesh) -> GltfScene<'_> {
    let (triangles, _) = mesh.triangles();
    let points: Vec<glam::Vec3> = mesh.positions.iter().map(|p| p.as_vec3()).collect();
    let (lo, hi) =
        points.iter().fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(lo, hi), &p| {
            (lo.min(p), hi.max(p))
        });
    let (place, index) = (points.len() * 12, triangles.len() * 12);
    let colour = mesh.colours.as_ref().map_or(0, |c| c.len() * 4);
    let total = place + index + colour;
    let mut views = vec![
        serde_json::json!({"buffer": 0, "byteOffset": 0, "byteLength": place, "target": 34962}),
        serde_json::json!({"buffer": 0, "byteOffset": place, "byteLength": index, "target": 34963}),
    ];
    let mut accessors = vec![
        serde_json::json!({"bufferView": 0, "componentType": 5126, "count": points.len(), "type": "VEC3",
            "min": lo.to_array(), "max": hi.to_array()}),
        serde_json::json!({"bufferView": 1, "componentType": 5125, "count": triangles.len() * 3, "type": "SCALAR"}),
    ];
    let mut attributes = serde_json::json!({"POSITION": 0});
    if colour > 0 {
        views.push(serde_json::json!({"buffer": 0, "byteOffset": place + index, "byteLength": colour, "target": 34962}));
        accessors
            .push(serde_json::json!({"bufferView": 2, "componentType": 5121, "normalized": true,
            "count": points.len(), "type": "VEC4"}));
        attributes["COLOR_0"] = 2.into();
    }
    let mut json = serde_json::json!({
        "asset": {"version": "2.0", "generator": "sculptd"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1, "mode": 4}]}],
        "buffers": [{"byteLength": total}], "bufferViews": views, "accessors": accessors,
    });
    if points.is_empty() {
        // No accessor may be empty: an empty solid is a scene without nodes.
        json = serde_json::json!({
            "asset": {"version": "2.0", "generator": "sculptd"}, "scene": 0, "scenes": [{}],
        });
    }
    GltfScene { json, points, triangles, colours: mesh.colours.as_deref(), total }
}

impl GltfScene<'_> {
    fn buffer(&self, out: &mut dyn Write) -> io::Result<()> {
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
                (l * 255.0).round() as u8
            };
            out.write_all(&[linear(c[0]), linear(c[1]), linear(c[2]), c[3]])?;
        }
        Ok(())
    }
}

/// glTF in its binary container.
pub(super) fn glb(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    let scene = scene(mesh);
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
pub(super) fn gltf(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    let mut scene = scene(mesh);
    if scene.total > 0 {
        let mut bytes = Vec::with_capacity(scene.total);
        scene.buffer(&mut bytes)?;
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        scene.json["buffers"][0]["uri"] = uri.into();
    }
    out.write_all(&serde_json::to_vec(&scene.json)?)
}

/// Base64 with padding (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
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

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// One object, in millimetres, double precision.
pub(super) fn threemf(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
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
        "<model unit=\"millimeter\" xml:lang=\"en\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">"
    )?;
    writeln!(text, "<resources><object id=\"1\" type=\"model\"><mesh><vertices>")?;
    for p in &mesh.positions {
        writeln!(text, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z)?;
    }
    writeln!(text, "</vertices><triangles>")?;
    for [a, b, c] in mesh.triangles().0 {
        writeln!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>")?;
    }
    writeln!(
        text,
        "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>"
    )?;
    text.flush()?;
    drop(text);
    out.write_all(&zip.finish()?.into_inner())
}
