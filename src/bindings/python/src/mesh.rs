//! Meshes: made from arrays, read from files, written, and shared with NumPy.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use sculptd_geometry::io::{LoadedMesh, read_mesh, write_mesh};
use sculptd_geometry::{PolyMesh, TriMesh, shapes, written};

use crate::array::{integers, points, shared};
use crate::errors;
use crate::job::{Progress, watched};

/// A surface of polygons in double precision. It never changes: every operation gives a new one.
///
/// Arguments: `vertices`, (n, 3) numbers in mm; `faces`, (m, k) vertex numbers, k = 3 for
/// triangles, counter-clockwise seen from outside; or, with `face_starts` of m + 1 numbers, the
/// corners of all faces in one flat array, where face f owns
/// `faces[face_starts[f]:face_starts[f + 1]]`. `colours`: (n, 4) RGBA, 0 to 255.
///
/// The arrays are copied once, into memory that the mesh owns. The attributes `vertices`, `faces`,
/// `corners` and `face_starts` are read-only arrays over that memory: no copy is made.
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
pub struct Mesh {
    pub poly: Arc<PolyMesh>,
    /// The format of the file, if it came from one.
    format: Option<&'static str>,
    warnings: Vec<String>,
}

impl From<PolyMesh> for Mesh {
    fn from(poly: PolyMesh) -> Self {
        Mesh { poly: Arc::new(poly), format: None, warnings: Vec::new() }
    }
}

impl Mesh {
    /// With sentences for the caller.
    pub fn warned(poly: PolyMesh, warnings: Vec<String>) -> Mesh {
        Mesh { poly: Arc::new(poly), format: None, warnings }
    }

    /// A surface that was made in a frame whose origin is at `centre`.
    pub fn at(mesh: &TriMesh, centre: DVec3) -> Mesh {
        let mut poly = mesh.to_poly();
        poly.positions.iter_mut().for_each(|p| *p += centre);
        poly.into()
    }

    fn regular(&self) -> Option<usize> {
        let poly = &self.poly;
        let mut sizes = poly.face_starts.windows(2).map(|w| w[1] - w[0]);
        let first = sizes.next().unwrap_or(3);
        sizes.all(|s| s == first).then_some(first as usize)
    }
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces, face_starts=None, colours=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        face_starts: Option<&Bound<'_, PyAny>>,
        colours: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Mesh> {
        let positions = points(vertices, "vertices")?;
        if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
            return Err(PyValueError::new_err(format!("vertices: entry {at} is not finite")));
        }
        let (corners, shape) = integers(faces, "faces", positions.len())?;
        let starts = match (face_starts, shape.as_slice()) {
            (Some(starts), [_]) => integers(starts, "face_starts", corners.len() + 1)?.0,
            (None, &[_, k]) if k >= 3 => (0..=corners.len() / k).map(|f| (f * k) as u32).collect(),
            (None, _) if corners.is_empty() => vec![0],
            _ => {
                return Err(PyValueError::new_err(format!(
                    "faces: expected an array of shape (m, 3) or (m, k), or one row and \
                     face_starts; found {shape:?}"
                )));
            }
        };
        let good = starts.first() == Some(&0)
            && starts.last().is_some_and(|&l| l as usize == corners.len())
            && starts.windows(2).all(|w| w[0] + 3 <= w[1]);
        if !good {
            return Err(PyValueError::new_err(
                "face_starts: expected 0, then at least 3 more each time, at last the number of \
                 corners",
            ));
        }
        let colours = match colours {
            None => None,
            Some(array) => {
                let (flat, shape) = integers(array, "colours", 256)?;
                if shape != [positions.len(), 4] {
                    let text = format!("colours: expected shape ({}, 4)", positions.len());
                    return Err(PyValueError::new_err(text));
                }
                let bytes: Vec<u8> = flat.iter().map(|&c| c as u8).collect();
                Some(bytes.as_chunks::<4>().0.to_vec())
            }
        };
        Ok(PolyMesh { positions, face_starts: starts, corners, colours, ..PolyMesh::new() }.into())
    }

    /// (n, 3) float64, read-only, shared with the mesh.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let flat: &[f64] = bytemuck::cast_slice(&self.poly.positions);
        shared(py, self.poly.clone(), flat, vec![self.poly.positions.len(), 3])
    }

    /// (m, k) uint32, read-only, shared with the mesh. Raises ValueError where faces differ in
    /// their number of corners: then use `corners` and `face_starts`, or `triangulated()`.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let k = self.regular().ok_or_else(|| {
            PyValueError::new_err(
                "the faces differ in their number of corners: use corners and face_starts, or \
                 triangulated()",
            )
        })?;
        shared(py, self.poly.clone(), &self.poly.corners, vec![self.poly.face_count(), k])
    }

    /// The corners of all faces, one after the other: uint32, read-only, shared.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shared(py, self.poly.clone(), &self.poly.corners, vec![self.poly.corners.len()])
    }

    /// The start of each face's corners, and finally their number: uint32, read-only, shared.
    #[getter]
    fn face_starts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shared(py, self.poly.clone(), &self.poly.face_starts, vec![self.poly.face_starts.len()])
    }

    /// (n, 4) uint8 RGBA, read-only, shared; None where the mesh has no colours.
    #[getter]
    fn colours<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(colours) = &self.poly.colours else { return Ok(None) };
        shared(py, self.poly.clone(), colours.as_flattened(), vec![colours.len(), 4]).map(Some)
    }

    /// The group (OBJ) or object (3MF) of each face, uint32, shared; None where the file has none.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(groups) = &self.poly.groups else { return Ok(None) };
        shared(py, self.poly.clone(), groups, vec![groups.len()]).map(Some)
    }

    /// The format of the file, e.g. 'STL (binary)'; None for a mesh that came from no file.
    #[getter]
    fn format(&self) -> Option<&'static str> {
        self.format
    }

    /// The data left out, guessed or repaired when this mesh was made: one sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The same surface with every polygon cut into triangles; vertices keep their numbers.
    fn triangulated(&self, py: Python<'_>) -> Mesh {
        py.detach(|| written::triangulated(&self.poly)).into()
    }

    /// The mesh with every vertex multiplied by `scale`, then moved by `offset`.
    #[pyo3(signature = (scale=1.0, offset=[0.0, 0.0, 0.0]))]
    fn transformed(&self, scale: f64, offset: [f64; 3]) -> PyResult<Mesh> {
        let offset = DVec3::from(offset);
        if !(scale > 0.0 && scale.is_finite() && offset.is_finite()) {
            return Err(PyValueError::new_err("expected a scale above 0 and a finite offset"));
        }
        let mut poly = PolyMesh::clone(&self.poly);
        poly.positions.iter_mut().for_each(|p| *p = *p * scale + offset);
        Ok(poly.into())
    }

    /// Writes the mesh in the format of the name's ending: .obj, .stl, .ply, .off, .glb, .3mf. The
    /// file is written beside and renamed, so a file that stood there stays whole if this fails.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_mesh(&path, &self.poly)).map_err(|e| errors::write(&e))
    }

    /// A box between two corners, of six quadrilaterals.
    #[classmethod]
    #[pyo3(name = "box")]
    fn cuboid(_: &Bound<'_, PyType>, low: [f64; 3], high: [f64; 3]) -> PyResult<Mesh> {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        if !(low.is_finite() && high.is_finite() && low.cmplt(high).all()) {
            return Err(PyValueError::new_err("expected low below high along every axis"));
        }
        Ok(shapes::cuboid(low, high).into())
    }

    /// A ball of triangles around the origin: `frequency` parts of each edge of an icosahedron, so
    /// 20 * frequency**2 triangles.
    #[classmethod]
    #[pyo3(signature = (radius, frequency=32))]
    fn sphere(_: &Bound<'_, PyType>, radius: f32, frequency: u32) -> PyResult<Mesh> {
        if !(radius > 0.0 && radius.is_finite() && (1..=2000).contains(&frequency)) {
            return Err(PyValueError::new_err("expected a radius above 0, a frequency 1 to 2000"));
        }
        Ok(shapes::icosphere(radius, frequency).to_poly().into())
    }

    /// A cylinder along z.
    #[classmethod]
    #[pyo3(signature = (radius, height, around=64))]
    fn cylinder(_: &Bound<'_, PyType>, radius: f64, height: f64, around: u32) -> PyResult<Mesh> {
        let good = radius > 0.0 && height > 0.0 && radius.is_finite() && height.is_finite();
        if !(good && (3..=1_000_000).contains(&around)) {
            return Err(PyValueError::new_err("expected lengths above 0 and 3 or more around"));
        }
        Ok(shapes::cylinder(radius, height, around).into())
    }

    fn __repr__(&self) -> String {
        let (v, f) = (self.poly.positions.len(), self.poly.face_count());
        format!("<sculptd.Mesh of {v} vertices and {f} faces>")
    }

    fn __len__(&self) -> usize {
        self.poly.face_count()
    }
}

/// Reads a mesh file: OBJ, STL, PLY, OFF, glTF, GLB or 3MF; the content decides the format.
///
/// Raises OSError (FileNotFoundError and others) if the file can't be opened. Raises
/// FileFormatError, with the line or byte, if the content violates the format.
#[pyfunction]
#[pyo3(signature = (path, progress=None))]
fn read(py: Python<'_>, path: PathBuf, progress: Progress) -> PyResult<Mesh> {
    let path: &Path = &path;
    let LoadedMesh { mesh, format, warnings, .. } =
        watched(py, &progress, |job| read_mesh(path, job))?.map_err(|e| errors::read(py, &e))?;
    Ok(Mesh { poly: Arc::new(mesh), format: Some(format.name()), warnings })
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Mesh>()?;
    m.add_function(wrap_pyfunction!(read, m)?)
}
