//! Meshes across the boundary.

use std::ffi::c_char;

use glam::DVec3;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;

use crate::boundary::{
    Failure, SculptdStatus, guarded, hand_out, optional, optional_mut, path, reference, slice,
    take_back,
};

/// A surface of polygons in double precision, lengths in the unit of its file (mm as a rule). It
/// never changes.
#[derive(Debug)]
pub struct SculptdMesh {
    pub(crate) poly: PolyMesh,
}

/// Reads OBJ, STL, PLY, OFF, glTF, GLB or 3MF; the content decides the format.
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
        let poly = read_mesh(&file, &Job::default())?.mesh;
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(mesh, SculptdMesh { poly }) }
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
        unsafe { hand_out(mesh, SculptdMesh { poly }) }
    })
}

/// Writes the mesh in the format of the name's ending: .obj, .stl, .ply, .off, .glb, .3mf. The file
/// is written beside and renamed.
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

/// # Safety
/// `count` is null or may be written.
unsafe fn lend<T>(all: &[T], told: usize, count: *mut usize) -> *const T {
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
