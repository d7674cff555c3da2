//! Writing, each format as the plainest file that every program reads.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Format, write_beside};
use crate::mesh::PolyMesh;

#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error("{}: expected a name that ends in .obj, .stl, .ply or .off", path.display())]
    Format { path: PathBuf },
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
}

/// The format that a name asks for.
pub fn writable_format(path: &Path) -> Result<Format, WriteError> {
    match path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase().as_str() {
        "obj" => Ok(Format::Obj),
        "stl" => Ok(Format::Stl),
        "ply" => Ok(Format::Ply),
        "off" => Ok(Format::Off),
        _ => Err(WriteError::Format { path: path.into() }),
    }
}

pub fn write_mesh(path: &Path, mesh: &PolyMesh) -> Result<(), WriteError> {
    let format = writable_format(path)?;
    write_beside(path, |out| match format {
        Format::Obj => obj(out, mesh),
        Format::Stl => stl(out, mesh),
        Format::Ply => ply(out, mesh),
        Format::Off => off(out, mesh),
    })
    .map_err(|source| WriteError::Io { path: path.into(), source })
}

fn obj(out: &mut dyn Write, mesh: &PolyMesh) -> io::Result<()> {
    writeln!(out, "# sculptd")?;
    for p in &mesh.positions {
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for face in mesh.faces() {
        write!(out, "f")?;
        for v in face {
            write!(out, " {}", v + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn stl(out: &mut dyn Write, mesh: &PolyMesh) -> io::Result<()> {
    let (tri, _) = mesh.triangulate();
    let mut header = [0u8; 80];
    header[..7].copy_from_slice(b"sculptd");
    out.write_all(&header)?;
    out.write_all(&(tri.triangles.len() as u32).to_le_bytes())?;
    for t in 0..tri.triangles.len() {
        let [a, b, c] = tri.corners(t);
        let n = (b - a).cross(c - a).normalize_or_zero();
        for v in [n, a, b, c] {
            for f in v.to_array() {
                out.write_all(&f.to_le_bytes())?;
            }
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

fn ply(out: &mut dyn Write, mesh: &PolyMesh) -> io::Result<()> {
    writeln!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment sculptd\nelement vertex {}",
        mesh.positions.len()
    )?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header", mesh.face_count())?;
    for p in &mesh.positions {
        for f in p.to_array() {
            out.write_all(&f.to_le_bytes())?;
        }
    }
    for face in mesh.faces() {
        out.write_all(&[face.len().min(255) as u8])?;
        for v in &face[..face.len().min(255)] {
            out.write_all(&(*v as i32).to_le_bytes())?;
        }
    }
    Ok(())
}

fn off(out: &mut dyn Write, mesh: &PolyMesh) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", mesh.positions.len(), mesh.face_count())?;
    for p in &mesh.positions {
        writeln!(out, "{} {} {}", p.x, p.y, p.z)?;
    }
    for face in mesh.faces() {
        write!(out, "{}", face.len())?;
        for v in face {
            write!(out, " {v}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}
