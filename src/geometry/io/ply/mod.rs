//! PLY: text, little-endian and big-endian; any elements and properties in any order; lists;
//! colours; texture coordinates of vertices or of corners.
//!
//! Own code, so that errors name their byte or line, counts are checked before memory is taken, and
//! double precision and polygons are kept. The header becomes a plan (offset and type of the few
//! properties that matter), and rows are read by it; rows of one length on all cores.

mod binary;
mod builder;
mod header;
mod text;

use std::sync::Arc;

use super::format::MeshFormat;
use super::problem::ParseError;
use crate::PolyMesh;
use crate::job::Job;
use builder::PlyBuilder;
use header::PlyEncoding;

pub(super) fn parse(
    bytes: &[u8],
    warnings: &mut Vec<String>,
    job: &Job,
) -> Result<(PolyMesh, MeshFormat), ParseError> {
    let header = header::parse(bytes)?;
    header.check(bytes.len())?;
    let mut made = PlyBuilder::default();
    match header.encoding {
        PlyEncoding::Ascii => text::read(bytes, &header, &mut made, job)?,
        PlyEncoding::LittleEndian => {
            binary::read::<binary::LittleEndian>(bytes, &header, &mut made, job)?
        }
        PlyEncoding::BigEndian => {
            binary::read::<binary::BigEndian>(bytes, &header, &mut made, job)?
        }
    }
    let format = match header.encoding {
        PlyEncoding::Ascii => MeshFormat::PlyAscii,
        PlyEncoding::LittleEndian => MeshFormat::PlyLittle,
        PlyEncoding::BigEndian => MeshFormat::PlyBig,
    };
    if made.short > 0 {
        warnings.push(format!("{} faces of fewer than three corners left out", made.short));
    }
    warnings.extend(header.unread());
    let attributes = made.attributes();
    let mut mesh = made.mesh;
    mesh.attributes = attributes.map(Arc::new);
    mesh.colours = match header.coloured() {
        true => Some(made.colours),
        false => made.of_faces.of(mesh.positions.len(), warnings),
    };
    if mesh.face_starts.is_empty() {
        mesh.face_starts.push(0);
    }
    Ok((mesh, format))
}
