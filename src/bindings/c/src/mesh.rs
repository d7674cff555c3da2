//! Meshes across the boundary.

use std::collections::BTreeSet;
use std::ffi::{CString, c_char};

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{left_out, read_mesh, writable_format, write_mesh};
use sculptd_geometry::job::Job;

use crate::boundary::{
    Failure, SculptdStatus, exclusive, guarded, hand_out, optional, optional_mut, path, reference,
    slice, take_back,
};
use crate::sentences::SculptdSentences;

/// A surface of polygons in double precision, lengths in the unit of its file (mm as a rule). It
/// never changes.
#[derive(Debug)]
pub struct SculptdMesh {
    pub(crate) poly: PolyMesh,
    /// The name of the format that it was read from.
    format: Option<CString>,
    /// The parts of the file that it does not have, one sentence each.
    unread: Vec<String>,
}

impl SculptdMesh {
    /// A mesh that comes from no file.
    pub(crate) fn computed(poly: PolyMesh) -> SculptdMesh {
        SculptdMesh { poly, format: None, unread: Vec::new() }
    }
}

/// The contents of a mesh, which a format may keep or drop.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdMeshContents {
    /// The number of vertices.
    pub vertices: usize,
    /// The number of faces.
    pub faces: usize,
    /// The number of corners of the largest face: 3 in a mesh of triangles, 0 without faces.
    pub most_corners: usize,
    /// The number of groups of faces; 0 where faces have no groups.
    pub groups: usize,
    /// True if vertices have colours.
    pub colours: bool,
    /// True if groups name materials.
    pub materials: bool,
    /// True if corners have texture coordinates.
    pub texture_coordinates: bool,
}

/// Reads OBJ, STL, PLY, OFF, glTF, GLB or 3MF; the content decides the format.
/// sculptd_mesh_unread() lists the parts of the file that the mesh does not have.
///
/// # Safety
/// `file` is a path that ends with a zero; `mesh` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_read(
    file: *const c_char,
    mesh: *mut *mut SculptdMesh,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let file = unsafe { path(file) }?;
        let loaded = read_mesh(&file, &Job::default())?;
        let format = CString::new(loaded.format.name()).ok();
        let read = SculptdMesh { poly: loaded.mesh, format, unread: loaded.warnings };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(mesh, read) }
    })
}

/// A mesh from arrays, which are copied: `vertex_count` times x, y, z; face f has the corners from
/// `face_starts[f]` to before `face_starts[f + 1]`, counter-clockwise seen from outside, so that
/// `face_starts` has `face_count + 1` entries, the first 0. With `face_starts` null all faces are
/// triangles.
///
/// # Safety
/// The arrays have the stated sizes (`corners` has `face_starts[face_count]` entries, or 3 times
/// `face_count`); `mesh` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_new(
    vertices: *const f64,
    vertex_count: usize,
    corners: *const u32,
    face_starts: *const u32,
    face_count: usize,
    mesh: *mut *mut SculptdMesh,
) -> SculptdStatus {
    guarded(|| {
        let too_many = || Failure::argument("more than 2^32 - 1 vertices or corners");
        let numbers = vertex_count.checked_mul(3).ok_or_else(too_many)?;
        // SAFETY: as this function's caller promises.
        let flat = unsafe { slice(vertices, numbers, "vertices") }?;
        let positions: Vec<DVec3> = bytemuck::cast_slice(flat).to_vec();
        let starts: Vec<u32> = if face_starts.is_null() {
            let last = u32::try_from(face_count).ok().and_then(|n| n.checked_mul(3));
            last.ok_or_else(too_many)?;
            (0..=face_count as u32).map(|f| f * 3).collect()
        } else {
            // SAFETY: as this function's caller promises.
            unsafe { slice(face_starts, face_count + 1, "face_starts") }?.to_vec()
        };
        if starts[0] != 0 || !starts.windows(2).all(|w| u64::from(w[0]) + 3 <= u64::from(w[1])) {
            let text = "face_starts: expected 0 first, then at least 3 more each time";
            return Err(Failure::argument(text));
        }
        // SAFETY: as this function's caller promises.
        let corners = unsafe { slice(corners, starts[face_count] as usize, "corners") }?.to_vec();
        if let Some(at) = corners.iter().position(|&c| c as usize >= positions.len()) {
            return Err(Failure::argument(format!(
                "corners[{at}] is {}: expected a number below {vertex_count}",
                corners[at]
            )));
        }
        if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
            return Err(Failure::argument(format!("vertex {at} is not finite")));
        }
        let poly = PolyMesh { positions, face_starts: starts, corners, ..PolyMesh::new() };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(mesh, SculptdMesh::computed(poly)) }
    })
}

/// Writes the mesh in the format of the name's ending: .obj, .stl, .ply, .off, .glb, .gltf or .3mf.
/// The file appears whole or not at all. sculptd_mesh_unwritten() lists what it will not hold.
///
/// # Safety
/// `mesh` came from this library and was not freed; `file` is a path that ends with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_write(
    mesh: *const SculptdMesh,
    file: *const c_char,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (mesh, file) = unsafe { (reference(mesh, "mesh")?, path(file)?) };
        Ok(write_mesh(&file, &mesh.poly)?)
    })
}

/// Returns the format that the mesh was read from, e.g. "STL (binary)"; it lives as long as the
/// mesh. Null for null and for a mesh that comes from no file.
///
/// # Safety
/// `mesh` is null or came from this library and was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_format(mesh: *const SculptdMesh) -> *const c_char {
    // SAFETY: as this function's caller promises.
    let format = unsafe { optional(mesh) }.and_then(|m| m.format.as_ref());
    format.map_or(std::ptr::null(), |f| f.as_ptr())
}

/// Writes the contents of the mesh.
///
/// # Safety
/// `mesh` came from this library and was not freed; `contents` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_contents(
    mesh: *const SculptdMesh,
    contents: *mut SculptdMeshContents,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (poly, contents) =
            unsafe { (&reference(mesh, "mesh")?.poly, exclusive(contents, "contents")?) };
        let groups = poly.groups.as_ref();
        *contents = SculptdMeshContents {
            vertices: poly.positions.len(),
            faces: poly.face_count(),
            most_corners: poly.faces().map(<[u32]>::len).max().unwrap_or(0),
            groups: groups.map_or(0, |g| g.iter().collect::<BTreeSet<_>>().len()),
            colours: poly.colours.is_some(),
            materials: poly.has_materials(),
            texture_coordinates: poly.uvs().is_some(),
        };
        Ok(())
    })
}

/// Makes a list of the parts of its file that the mesh does not have, or that were guessed, one
/// sentence each. It is empty for a mesh that comes from no file.
///
/// # Safety
/// `mesh` came from this library and was not freed; `sentences` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_unread(
    mesh: *const SculptdMesh,
    sentences: *mut *mut SculptdSentences,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let unread = unsafe { &reference(mesh, "mesh")?.unread };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(sentences, SculptdSentences::new(unread)) }
    })
}

/// Makes a list of the parts of the mesh that a file of this name will not hold, or will hold
/// otherwise, one sentence each. Nothing is written; the ending of the name decides.
///
/// # Safety
/// `mesh` came from this library and was not freed; `file` ends with a zero; `sentences` points to
/// a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_unwritten(
    mesh: *const SculptdMesh,
    file: *const c_char,
    sentences: *mut *mut SculptdSentences,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (mesh, file) = unsafe { (reference(mesh, "mesh")?, path(file)?) };
        let unwritten = left_out(writable_format(&file)?, &mesh.poly);
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(sentences, SculptdSentences::new(&unwritten)) }
    })
}

/// The coordinates x, y, z of each vertex, and in `count` the number of vertices. They belong to
/// the mesh and live as long as it. Null for a null mesh or one without vertices.
///
/// # Safety
/// `mesh` is null or came from this library and was not freed; `count` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_vertices(
    mesh: *const SculptdMesh,
    count: *mut usize,
) -> *const f64 {
    // SAFETY: as this function's caller promises.
    let positions = unsafe { optional(mesh) }.map_or(&[][..], |m| &m.poly.positions);
    // SAFETY: as this function's caller promises.
    unsafe { lend(bytemuck::cast_slice(positions), positions.len(), count) }
}

/// The corners of all faces, one after the other, and in `count` their number; as
/// sculptd_mesh_vertices().
///
/// # Safety
/// As sculptd_mesh_vertices().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_corners(
    mesh: *const SculptdMesh,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: as this function's caller promises.
    let corners = unsafe { optional(mesh) }.map_or(&[][..], |m| &m.poly.corners);
    // SAFETY: as this function's caller promises.
    unsafe { lend(corners, corners.len(), count) }
}

/// Returns the start of each face's corners, and finally their number. `count` receives the number
/// of faces, one less than the entries. As sculptd_mesh_vertices().
///
/// # Safety
/// As sculptd_mesh_vertices().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_face_starts(
    mesh: *const SculptdMesh,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: as this function's caller promises.
    let starts = unsafe { optional(mesh) }.map_or(&[][..], |m| &m.poly.face_starts);
    // SAFETY: as this function's caller promises.
    unsafe { lend(starts, starts.len().saturating_sub(1), count) }
}

/// Lends an array: where it starts, and in `count` the number `told`; null for an empty one.
///
/// # Safety
/// `count` is null or may be written.
pub(crate) unsafe fn lend<T>(all: &[T], told: usize, count: *mut usize) -> *const T {
    // SAFETY: as the caller promises.
    if let Some(count) = unsafe { optional_mut(count) } {
        *count = told;
    }
    if all.is_empty() { std::ptr::null() } else { all.as_ptr() }
}

/// Frees a mesh; null is good.
///
/// # Safety
/// `mesh` is null or came from this library, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_mesh_free(mesh: *mut SculptdMesh) {
    // SAFETY: as this function's caller promises.
    unsafe { take_back(mesh) }
}
