//! PLY.

use super::BadMesh;
use crate::mesh::PolyMesh;

pub fn parse(bytes: &[u8]) -> Result<PolyMesh, BadMesh> {
    if !bytes.starts_with(b"ply") {
        return Err(BadMesh::line(1, "expected the word 'ply'"));
    }
    Err(BadMesh::line(1, "expected a PLY that this build reads"))
}
