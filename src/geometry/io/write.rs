//! Meshes to files. What a format cannot hold is lost there and stays here: STL holds triangles in
//! single precision and no colours; OBJ and glTF alone hold groups and the names of materials;
//! [`left_out`] says which.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;

use super::beside::CancellableWriter;
use super::gltf::GltfUnit::AsTheyStand;
use super::write_gltf::{self, GltfMesh};
use super::{WriteError, extension, write_beside, write_threemf};
use crate::face_attributes::NO_UV;
use crate::filaments::Filaments;
use crate::job::Job;
use crate::{GroupName, PolyMesh};

/// The formats written, by the ending of a name.
pub(super) const ENDINGS: [&str; 7] = ["obj", "stl", "ply", "off", "glb", "gltf", "3mf"];

/// The ending (lower case) by which [`write_mesh`] will write, asked for before the work is done.
pub fn writable_format(path: &Path) -> Result<&'static str, WriteError> {
    let kind = extension(path);
    ENDINGS
        .into_iter()
        .find(|e| *e == kind)
        .ok_or_else(|| WriteError::Extension { path: path.into() })
}

/// Returns true if the format that the extension of `path` names states its unit.
pub fn states_unit(path: &Path) -> bool {
    matches!(extension(path).as_str(), "glb" | "gltf" | "3mf")
}

/// Writes `mesh` in the format that the extension of `path` names, whole or not at all
/// ([`write_beside`]). The same mesh gives the same bytes. Reading it again gives the same mesh, to
/// the last bit of every coordinate, where the format keeps double precision (OBJ, OFF, PLY).
pub fn write_mesh(path: &Path, mesh: &PolyMesh) -> Result<(), WriteError> {
    let kind = writable_format(path)?;
    write_beside(path, |out| encode(kind, mesh, out))
        .map_err(|source| WriteError::Io { path: path.into(), source })
}

/// Writes `mesh` as a 3MF file whose triangles are painted for slicers, with the colours of `mesh`
/// beside, as [`write_mesh`] does.
pub fn write_painted(
    path: &Path,
    mesh: &PolyMesh,
    filaments: &Filaments,
) -> Result<(), WriteError> {
    write_beside(path, |out| write_threemf::threemf(mesh, Some(filaments), out, &Job::default()))
        .map_err(|source| WriteError::Io { path: path.into(), source })
}

/// The bytes of `mesh` as a file of extension `kind` (lower case) holds them.
pub fn encode(kind: &str, mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    encode_until_cancelled(kind, mesh, out, &Job::default())
}

/// The same; fails with [`Cancelled`](crate::job::Cancelled) once the job is cancelled.
pub(super) fn encode_until_cancelled(
    kind: &str,
    mesh: &PolyMesh,
    out: &mut dyn Write,
    job: &Job,
) -> io::Result<()> {
    let out = &mut CancellableWriter { out, job };
    match kind {
        "obj" => obj(mesh, out),
        "stl" => stl(mesh, out),
        "ply" => ply(mesh, out),
        "off" => off(mesh, out),
        "glb" => write_gltf::glb(&[GltfMesh::bare(mesh)], AsTheyStand, out),
        "gltf" => write_gltf::gltf(&[GltfMesh::bare(mesh)], AsTheyStand, out),
        "3mf" => write_threemf::threemf(mesh, None, out, job),
        _ => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("no mesh format is called \"{kind}\""),
        )),
    }
}

/// Returns the parts of `mesh` that a file of the ending `kind` does not hold or holds otherwise,
/// one sentence each.
pub fn left_out(kind: &str, mesh: &PolyMesh) -> Vec<String> {
    let mut out = lost(kind, mesh);
    if matches!(kind, "stl" | "glb" | "gltf" | "3mf") && mesh.faces().any(|f| f.len() > 3) {
        out.push(format!("the polygons are cut: .{kind} holds triangles alone"));
    }
    out
}

/// Returns the most by which a file of the ending `kind` changes a coordinate of `mesh`, in the
/// mesh's unit: above 0 only for formats in single precision.
pub fn rounding(kind: &str, mesh: &PolyMesh) -> f64 {
    if !matches!(kind, "stl" | "glb" | "gltf") {
        return 0.0;
    }
    let change = |p: &DVec3| (*p - p.as_vec3().as_dvec3()).abs().max_element();
    mesh.positions.iter().map(change).fold(0.0, f64::max)
}

/// Returns the parts of `mesh` that a file of the ending `kind` does not hold, one sentence each.
/// The surface is the same, so polygons that are cut into triangles are none of them.
pub fn lost(kind: &str, mesh: &PolyMesh) -> Vec<String> {
    let mut out = Vec::new();
    let clear = |colours: &Vec<[u8; 4]>| colours.iter().any(|c| c[3] != 255);
    if kind == "obj" && mesh.colours.as_ref().is_some_and(clear) {
        out.push(
            "the opacity of the vertices' colours is left out: .obj has no place for it".into(),
        );
    }
    if mesh.colours.is_some() && kind == "stl" {
        out.push(format!("the vertices' colours are left out: .{kind} is written without"));
    }
    let named = matches!(kind, "obj" | "glb" | "gltf");
    if mesh.groups.is_some() && !named {
        out.push(format!("the groups of faces are left out: .{kind} is written without"));
    }
    if mesh.has_materials() && !named {
        out.push(format!("the names of materials are left out: .{kind} is written without"));
    }
    if mesh.uvs().is_some() && !named && kind != "ply" {
        out.push(format!("the texture coordinates are left out: .{kind} is written without"));
    }
    if mesh.attributes.as_ref().is_some_and(|a| !a.libraries.is_empty()) && kind != "obj" {
        out.push(format!("the names of material files are left out: .{kind} is written without"));
    }
    out
}

fn obj(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    if mesh.positions.is_empty() {
        // An empty solid is a file too, and a file of no bytes is none.
        return out.write_all(b"# no vertices\n");
    }
    let mut line = Vec::with_capacity(128);
    for library in mesh.attributes.iter().flat_map(|a| &a.libraries) {
        writeln!(out, "mtllib {library}")?;
    }
    for (v, p) in mesh.positions.iter().enumerate() {
        line.clear();
        write!(line, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some(c) = &mesh.colours {
            let [r, g, b, _] = c[v].map(|c| c as f64 / 255.0);
            write!(line, " {r} {g} {b}")?;
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    let uvs = mesh.uvs();
    for [u, v] in uvs.iter().flat_map(|(values, _)| *values) {
        line.clear();
        writeln!(line, "vt {u} {v}")?;
        out.write_all(&line)?;
    }
    let (mut group, mut named) = (None, GroupName::default());
    for (f, corners) in mesh.faces().enumerate() {
        line.clear();
        let now = mesh.groups.as_ref().map(|g| g[f]);
        if now != group {
            group = now;
            if let Some(g) = group {
                group_lines(&mut line, g, mesh.group_name(g), &mut named)?;
            }
        }
        line.push(b'f');
        let first = mesh.face_starts[f] as usize;
        for (k, &c) in corners.iter().enumerate() {
            line.push(b' ');
            write_integer(&mut line, c as u64 + 1);
            if let Some(uv) = uvs.map(|(_, of)| of[first + k]).filter(|uv| *uv != NO_UV) {
                line.push(b'/');
                write_integer(&mut line, u64::from(uv) + 1);
            }
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}

/// Writes the lines that begin a group: the names that changed. If a name ends while others
/// continue, writes the format's word for none.
fn group_lines(
    line: &mut Vec<u8>,
    number: u32,
    name: Option<&GroupName>,
    named: &mut GroupName,
) -> io::Result<()> {
    let Some(name) = name else { return writeln!(line, "g group_{number}") };
    let pairs = [
        ("o", &name.object, &named.object),
        ("g", &name.group, &named.group),
        ("usemtl", &name.material, &named.material),
    ];
    for (word, now, before) in pairs {
        if now != before {
            writeln!(line, "{word} {}", if now.is_empty() { "default" } else { now })?;
        }
    }
    named.clone_from(name);
    Ok(())
}

fn write_integer(line: &mut Vec<u8>, mut n: u64) {
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    line.extend_from_slice(&digits[at..]);
}

fn stl(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    let (triangles, _) = mesh.triangles();
    let count = u32::try_from(triangles.len()).map_err(|_| {
        io::Error::new(io::ErrorKind::InvalidInput, "STL holds at most 2^32 - 1 triangles")
    })?;
    let mut head = [0u8; 84];
    head[..7].copy_from_slice(b"sculptd");
    head[80..].copy_from_slice(&count.to_le_bytes());
    out.write_all(&head)?;
    for t in triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut record = [0u8; 50];
        for (n, p) in [normal, a, b, c].into_iter().enumerate() {
            for (axis, v) in p.to_array().into_iter().enumerate() {
                record[n * 12 + axis * 4..][..4].copy_from_slice(&(v as f32).to_le_bytes());
            }
        }
        out.write_all(&record)?;
    }
    Ok(())
}

/// Little-endian; coordinates in single precision where that loses nothing. Texture coordinates
/// stand with the faces, two for each corner, as MeshLab writes them.
fn ply(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    let single = mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
    let kind = if single { "float" } else { "double" };
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", mesh.positions.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {kind} {axis}")?;
    }
    if mesh.colours.is_some() {
        for c in ["red", "green", "blue", "alpha"] {
            writeln!(out, "property uchar {c}")?;
        }
    }
    let most = if mesh.uvs().is_some() { 127 } else { 255 };
    let long = mesh.faces().any(|f| f.len() > most);
    let count = if long { "uint" } else { "uchar" };
    writeln!(out, "element face {}\nproperty list {count} int vertex_indices", mesh.face_count())?;
    let uvs = mesh.uvs();
    if uvs.is_some() {
        writeln!(out, "property list {count} double texcoord")?;
    }
    writeln!(out, "end_header")?;
    let mut row = Vec::with_capacity(64);
    for (v, p) in mesh.positions.iter().enumerate() {
        row.clear();
        for c in p.to_array() {
            if single {
                row.extend_from_slice(&(c as f32).to_le_bytes());
            } else {
                row.extend_from_slice(&c.to_le_bytes());
            }
        }
        if let Some(c) = &mesh.colours {
            row.extend_from_slice(&c[v]);
        }
        out.write_all(&row)?;
    }
    let length = |row: &mut Vec<u8>, n: usize| match long {
        true => row.extend_from_slice(&(n as u32).to_le_bytes()),
        false => row.push(n as u8),
    };
    for (f, corners) in mesh.faces().enumerate() {
        row.clear();
        length(&mut row, corners.len());
        for &c in corners {
            row.extend_from_slice(&c.to_le_bytes());
        }
        if let Some((values, of)) = uvs {
            let own = &of[mesh.face_starts[f] as usize..][..corners.len()];
            // A face without has an empty list.
            let own = if own.contains(&NO_UV) { &[][..] } else { own };
            length(&mut row, own.len() * 2);
            for value in own.iter().flat_map(|n| values[*n as usize]) {
                row.extend_from_slice(&value.to_le_bytes());
            }
        }
        out.write_all(&row)?;
    }
    Ok(())
}

fn off(mesh: &PolyMesh, out: &mut dyn Write) -> io::Result<()> {
    let kind = if mesh.colours.is_some() { "COFF" } else { "OFF" };
    writeln!(out, "{kind}\n{} {} 0", mesh.positions.len(), mesh.face_count())?;
    let mut line = Vec::with_capacity(128);
    for (v, p) in mesh.positions.iter().enumerate() {
        line.clear();
        write!(line, "{} {} {}", p.x, p.y, p.z)?;
        if let Some(c) = &mesh.colours {
            let [r, g, b, a] = c[v];
            write!(line, " {r} {g} {b} {a}")?;
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    for corners in mesh.faces() {
        line.clear();
        write_integer(&mut line, corners.len() as u64);
        for &c in corners {
            line.push(b' ');
            write_integer(&mut line, c as u64);
        }
        line.push(b'\n');
        out.write_all(&line)?;
    }
    Ok(())
}
