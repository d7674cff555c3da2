//! Pictures of meshes without a display: drawn on the processor, the same bytes everywhere.

use std::sync::Arc;

use glam::Vec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sculptd_geometry::picture::{Camera, draw};
use sculptd_geometry::thickness::colour::colour;
use sculptd_geometry::{CentredMesh, PolyMesh};

use crate::job::watched;
use crate::mesh::Mesh;
use crate::thickness::Thickness;

/// A PNG file's bytes: the mesh from a corner above, or from `towards_eye`. With `thickness` of the
/// same mesh it is coloured by its walls, with a scale beside it.
#[pyfunction]
#[pyo3(signature = (mesh, *, thickness=None, width=640, height=480, towards_eye=None))]
fn picture<'py>(
    py: Python<'py>,
    mesh: &Bound<'py, Mesh>,
    thickness: Option<&Bound<'py, Thickness>>,
    width: usize,
    height: usize,
    towards_eye: Option<[f32; 3]>,
) -> PyResult<Bound<'py, PyBytes>> {
    if !(16..=8192).contains(&width) || !(16..=8192).contains(&height) {
        return Err(PyValueError::new_err("expected a width and a height from 16 to 8192"));
    }
    let eye = towards_eye.map(Vec3::from);
    if eye.is_some_and(|e| !e.is_finite() || e == Vec3::ZERO) {
        return Err(PyValueError::new_err("towards_eye: expected a vector that is not zero"));
    }
    let poly = mesh.get().poly().clone();
    let measured = thickness.map(|t| t.get().measured.clone());
    if measured.as_ref().is_some_and(|m| m.values.len() != poly.positions.len()) {
        return Err(PyValueError::new_err("thickness: expected that of the same mesh"));
    }
    let png = watched(py, &None, move |_| {
        let part = CentredMesh::new(&poly, 1.0);
        let aspect = width as f32 / height as f32;
        let camera = match eye {
            Some(eye) => Camera::from_side(&part.mesh, eye, aspect),
            None => Camera::from_corner(&part.mesh, aspect),
        };
        let scale = measured.as_ref().map(|m| m.scale());
        let colours = measured.as_ref().zip(scale).map(|(m, scale)| m.colours(scale));
        let mut made = draw(&part.mesh, colours.as_deref(), &camera, width, height);
        if let Some((low, high)) = scale {
            made.legend(low, high, |v| colour(v, low, high));
        }
        made.png()
    })?
    .map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(PyBytes::new(py, &png))
}

/// Draws a mesh from a corner above, as a PNG file's bytes of this width and height.
pub fn drawn(
    py: Python<'_>,
    poly: Arc<PolyMesh>,
    (width, height): (usize, usize),
) -> PyResult<Vec<u8>> {
    watched(py, &None, move |_| {
        let part = CentredMesh::new(&poly, 1.0);
        let camera = Camera::from_corner(&part.mesh, width as f32 / height as f32);
        draw(&part.mesh, None, &camera, width, height).png()
    })?
    .map_err(|e| PyValueError::new_err(e.to_string()))
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(picture, m)?)
}
