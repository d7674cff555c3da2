//! STL, both kinds; corners welded on exact coordinates.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{BadMesh, number};
use crate::mesh::PolyMesh;

struct Weld {
    mesh: PolyMesh,
    known: BTreeMap<[u64; 3], u32>,
}

impl Weld {
    fn vertex(&mut self, p: DVec3) -> u32 {
        // -0 and 0 are the same place.
        let key = (p + 0.0).to_array().map(f64::to_bits);
        *self.known.entry(key).or_insert_with(|| {
            self.mesh.positions.push(p);
            self.mesh.positions.len() as u32 - 1
        })
    }
}

pub fn parse(bytes: &[u8]) -> Result<PolyMesh, BadMesh> {
    let mut weld = Weld { mesh: PolyMesh::new(), known: BTreeMap::new() };
    let count = bytes.get(80..84).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let solid = bytes.trim_ascii_start().starts_with(b"solid");
    let whole = count.is_some_and(|n| n.checked_mul(50).and_then(|b| b.checked_add(84)) == Some(bytes.len()));
    if solid && !whole && bytes.windows(5).any(|w| w == b"facet") {
        ascii(bytes, &mut weld)?;
    } else {
        let Some(count) = count else {
            return Err(BadMesh::byte(bytes.len(), "the file ends within the 84-byte header"));
        };
        binary(bytes, count, &mut weld)?;
    }
    Ok(weld.mesh)
}

fn binary(bytes: &[u8], count: usize, weld: &mut Weld) -> Result<(), BadMesh> {
    let need = count.saturating_mul(50).saturating_add(84);
    if bytes.len() < need {
        return Err(BadMesh::byte(
            bytes.len(),
            format!("the file ends here; {count} triangles were announced, which need {need} bytes"),
        ));
    }
    for (t, record) in bytes[84..need].chunks_exact(50).enumerate() {
        let mut face = [0; 3];
        for (k, corner) in face.iter_mut().enumerate() {
            let at = |i: usize| {
                let b = &record[12 + k * 12 + i * 4..];
                f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            };
            let p = DVec3::new(at(0), at(1), at(2));
            if !p.is_finite() {
                return Err(BadMesh::byte(
                    84 + t * 50 + 12 + k * 12,
                    format!("expected a finite point, found {p}"),
                ));
            }
            *corner = weld.vertex(p);
        }
        weld.mesh.push_face(&face);
    }
    Ok(())
}

fn ascii(bytes: &[u8], weld: &mut Weld) -> Result<(), BadMesh> {
    let text = String::from_utf8_lossy(bytes);
    let mut face: Vec<u32> = Vec::new();
    let mut last = 0;
    for (n, line) in text.lines().enumerate() {
        let n = n + 1;
        last = n;
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => {
                let v: Vec<f64> = words.map(|w| number(w, n)).collect::<Result<_, _>>()?;
                let [x, y, z] = v[..] else {
                    return Err(BadMesh::line(
                        n,
                        format!("expected three coordinates after 'vertex', found {}", v.len()),
                    ));
                };
                face.push(weld.vertex(DVec3::new(x, y, z)));
            }
            Some("endfacet") => {
                if face.len() != 3 {
                    return Err(BadMesh::line(
                        n,
                        format!("expected three vertices in a facet, found {}", face.len()),
                    ));
                }
                weld.mesh.push_face(&face);
                face.clear();
            }
            _ => {}
        }
    }
    if face.is_empty() { Ok(()) } else { Err(BadMesh::line(last, "the file ends within a facet")) }
}
