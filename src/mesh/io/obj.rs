//! Wavefront OBJ: `v`, `f` (polygons kept, negative indices, `v/vt/vn`), `g`/`o`/`usemtl` as groups, colours after `v`.

use glam::DVec3;

use super::{BadMesh, number, shorten};
use crate::mesh::PolyMesh;

pub fn parse(bytes: &[u8], warnings: &mut Vec<String>) -> Result<PolyMesh, BadMesh> {
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = PolyMesh::new();
    let mut colours: Vec<[u8; 4]> = Vec::new();
    let mut small = 0usize;
    let mut face: Vec<u32> = Vec::new();
    for (n, line) in text.lines().enumerate() {
        let n = n + 1;
        let mut words = line.split('#').next().unwrap_or("").split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let values: Vec<f64> = words.map(|w| number(w, n)).collect::<Result<_, _>>()?;
                let [x, y, z, rest @ ..] = values.as_slice() else {
                    return Err(BadMesh::line(
                        n,
                        format!("expected three coordinates after 'v', found {}", values.len()),
                    ));
                };
                mesh.positions.push(DVec3::new(*x, *y, *z));
                if let [r, g, b] = rest {
                    colours
                        .push([*r, *g, *b].map(|c| (c * 255.0).round().clamp(0.0, 255.0) as u8).into_rgba());
                }
            }
            Some("f") => {
                face.clear();
                for w in words {
                    let first = w.split('/').next().unwrap_or("");
                    let index: i64 = first.parse().map_err(|_| {
                        BadMesh::line(n, format!("expected a vertex number, found '{}'", shorten(w)))
                    })?;
                    let count = mesh.positions.len() as i64;
                    let at = if index < 0 { count + index } else { index - 1 };
                    if index == 0 || at < 0 || at >= count {
                        return Err(BadMesh::line(
                            n,
                            format!("vertex {index} is out of range, {count} are defined so far"),
                        ));
                    }
                    face.push(at as u32);
                }
                if face.len() < 3 {
                    small += 1;
                } else {
                    mesh.push_face(&face);
                }
            }
            _ => {}
        }
    }
    if mesh.positions.is_empty() {
        return Err(BadMesh::line(1, "expected 'v' and 'f' lines, found none"));
    }
    if small > 0 {
        warnings.push(format!("{small} faces with fewer than three corners were left out"));
    }
    if colours.len() == mesh.positions.len() {
        mesh.colours = Some(colours);
    }
    Ok(mesh)
}

trait IntoRgba {
    fn into_rgba(self) -> [u8; 4];
}

impl IntoRgba for [u8; 3] {
    fn into_rgba(self) -> [u8; 4] {
        [self[0], self[1], self[2], 255]
    }
}
