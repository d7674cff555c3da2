//! OFF and COFF, text.

use glam::DVec3;

use super::{BadMesh, number};
use crate::mesh::PolyMesh;

pub fn parse(bytes: &[u8]) -> Result<PolyMesh, BadMesh> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = text.lines().enumerate().flat_map(|(n, l)| {
        l.split('#').next().unwrap_or("").split_ascii_whitespace().map(move |w| (n + 1, w))
    });
    let (mut line, first) = words.next().unwrap_or((1, ""));
    if !first.ends_with("OFF") {
        return Err(BadMesh::line(line, "expected the word OFF"));
    }
    let mut next = |what: &str| -> Result<f64, BadMesh> {
        let (n, w) = words
            .next()
            .ok_or_else(|| BadMesh::line(line, format!("the file ends here, expected {what}")))?;
        line = n;
        number(w, n)
    };
    let [vertices, faces, _] =
        [next("a vertex count")?, next("a face count")?, next("an edge count")?].map(|v| v as usize);
    if vertices.saturating_add(faces) > bytes.len() {
        return Err(BadMesh::line(
            line,
            format!("{vertices} vertices and {faces} faces cannot fit into {} bytes", bytes.len()),
        ));
    }
    let coloured = first.starts_with('C');
    let mut mesh = PolyMesh::new();
    for _ in 0..vertices {
        mesh.positions.push(DVec3::new(next("x")?, next("y")?, next("z")?));
        for _ in 0..if coloured { 4 } else { 0 } {
            next("a colour")?;
        }
    }
    for f in 0..faces {
        let count = next("a face's corner count")? as usize;
        let mut face = Vec::with_capacity(count.min(64));
        for _ in 0..count {
            let v = next("a vertex number")?;
            if v < 0.0 || v as usize >= vertices {
                return Err(BadMesh::line(
                    0,
                    format!("face {f}: vertex {v} is out of range, there are {vertices}"),
                ));
            }
            face.push(v as u32);
        }
        if count >= 3 {
            mesh.push_face(&face);
        }
    }
    Ok(mesh)
}
