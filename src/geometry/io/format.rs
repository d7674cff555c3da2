//! The formats of mesh files.

/// The format of a mesh file, detected from its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// STL, binary: single precision, no shared vertices.
    StlBinary,
    /// STL as text.
    StlAscii,
    /// PLY as text.
    PlyAscii,
    /// PLY, binary, little-endian.
    PlyLittle,
    /// PLY, binary, big-endian.
    PlyBig,
    /// Geomview's OFF, as text.
    Off,
    /// glTF 2.0 as JSON, its buffers inside or beside it.
    Gltf,
    /// glTF 2.0 in its binary container.
    Glb,
    /// 3MF, a ZIP archive of XML.
    ThreeMf,
}

impl MeshFormat {
    /// The format's usual name, with its encoding where it has several.
    pub fn name(self) -> &'static str {
        match self {
            MeshFormat::Obj => "OBJ",
            MeshFormat::StlBinary => "STL (binary)",
            MeshFormat::StlAscii => "STL (text)",
            MeshFormat::PlyAscii => "PLY (text)",
            MeshFormat::PlyLittle => "PLY (binary, little-endian)",
            MeshFormat::PlyBig => "PLY (binary, big-endian)",
            MeshFormat::Off => "OFF",
            MeshFormat::Gltf => "glTF",
            MeshFormat::Glb => "GLB",
            MeshFormat::ThreeMf => "3MF",
        }
    }
}
