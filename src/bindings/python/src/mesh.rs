//! Meshes: made from arrays, read from files, written, and shared with NumPy.

use std::hash::{DefaultHasher, Hasher};
use std::sync::{Arc, OnceLock};

use glam::{DMat4, DVec3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use sculptd_geometry::boolean::{Operation, SolidState};
use sculptd_geometry::measure::{Measures, measures_of};
use sculptd_geometry::repair::flip;
use sculptd_geometry::{FaceAttributes, GroupName, PolyMesh, TriMesh, check, shapes, written};
use serde::{Deserialize, Serialize};

use crate::array::{integers, points, shared};
use crate::job::watched;
use crate::{boolean, errors, file, picture};

/// A surface of polygons in double precision. It never changes: every operation gives a new one.
///
/// Arguments: `vertices`, (n, 3) numbers in mm; `faces`, (m, k) vertex numbers, k = 3 for
/// triangles, counter-clockwise seen from outside; or, with `face_starts` of m + 1 numbers, the
/// corners of all faces in one flat array, where face f owns
/// `faces[face_starts[f]:face_starts[f + 1]]`. `colours`: (n, 4) RGBA, 0 to 255. `groups`: the
/// group of each face, a number; `group_names`: the names of the groups 0, 1 and so on.
///
/// The arrays are copied once, into memory that the mesh owns. The attributes `vertices`, `faces`,
/// `corners` and `face_starts` are read-only arrays over that memory: no copy is made.
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
pub struct Mesh {
    /// Made when first asked for, where the mesh is a state of a solid.
    poly: OnceLock<Arc<PolyMesh>>,
    /// What the next Boolean may start from.
    pub before: Before,
    /// The format of the file, if it came from one.
    format: Option<String>,
    warnings: Vec<String>,
}

/// What a mesh came from, as far as the next Boolean of it is concerned.
#[derive(Debug, Clone)]
pub enum Before {
    /// A file, arrays, or another operation.
    Other,
    /// A Boolean of the whole.
    Boolean,
    /// Booleans that keep their search trees.
    State(SolidState),
}

/// A mesh as it is pickled.
#[derive(Serialize, Deserialize)]
struct PickledMesh {
    positions: Vec<DVec3>,
    face_starts: Vec<u32>,
    corners: Vec<u32>,
    colours: Option<Vec<[u8; 4]>>,
    groups: Option<Vec<u32>>,
    attributes: Option<FaceAttributes>,
    format: Option<String>,
    warnings: Vec<String>,
}

/// Returns true if `starts` begins at 0, ends at the number of corners, and no face has fewer than
/// three.
fn are_starts(starts: &[u32], corners: usize) -> bool {
    starts.first() == Some(&0)
        && starts.last().is_some_and(|&l| l as usize == corners)
        && starts.windows(2).all(|w| w[0].checked_add(3).is_some_and(|least| least <= w[1]))
}

/// The name of a group, else of its object, else of its material.
fn shown_name(g: &GroupName) -> &str {
    [&g.group, &g.object, &g.material].into_iter().find(|n| !n.is_empty()).map_or("", |n| n)
}

impl From<PolyMesh> for Mesh {
    fn from(poly: PolyMesh) -> Self {
        Mesh::warned(poly, Vec::new())
    }
}

impl Mesh {
    /// With sentences for the caller.
    pub fn warned(poly: PolyMesh, warnings: Vec<String>) -> Mesh {
        Mesh { poly: Arc::new(poly).into(), before: Before::Other, format: None, warnings }
    }

    /// From a file.
    pub fn read(poly: PolyMesh, format: &str, warnings: Vec<String>) -> Mesh {
        Mesh { format: Some(format.into()), ..Mesh::warned(poly, warnings) }
    }

    /// The result of a Boolean.
    pub fn joined(poly: PolyMesh, warnings: Vec<String>) -> Mesh {
        Mesh { before: Before::Boolean, ..Mesh::warned(poly, warnings) }
    }

    /// A state of a solid; its arrays are made when they are first asked for.
    pub fn state(state: SolidState, warnings: Vec<String>) -> Mesh {
        Mesh { poly: OnceLock::new(), before: Before::State(state), format: None, warnings }
    }

    /// The surface.
    pub fn poly(&self) -> &Arc<PolyMesh> {
        self.poly.get_or_init(|| match &self.before {
            Before::State(state) => Arc::new(state.mesh()),
            Before::Other | Before::Boolean => Arc::default(),
        })
    }

    /// A surface that was made in a frame whose origin is at `centre`.
    pub fn at(mesh: &TriMesh, centre: DVec3) -> Mesh {
        let mut poly = mesh.to_poly();
        poly.positions.iter_mut().for_each(|p| *p += centre);
        poly.into()
    }

    fn sizes(&self, py: Python<'_>) -> PyResult<Measures> {
        let poly = self.poly().clone();
        watched(py, &None, move |_| measures_of(&poly.positions, &poly.triangles().0))
    }

    fn regular(&self) -> Option<usize> {
        let poly = self.poly();
        let mut sizes = poly.face_starts.windows(2).map(|w| w[1] - w[0]);
        let first = sizes.next().unwrap_or(3);
        sizes.all(|s| s == first).then_some(first as usize)
    }
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, faces, face_starts=None, colours=None, groups=None,
                        group_names=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        face_starts: Option<&Bound<'_, PyAny>>,
        colours: Option<&Bound<'_, PyAny>>,
        groups: Option<&Bound<'_, PyAny>>,
        group_names: Option<Vec<String>>,
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
        if !are_starts(&starts, corners.len()) {
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
        let groups = groups.map(|g| integers(g, "groups", u32::MAX as usize)).transpose()?;
        if groups.as_ref().is_some_and(|(_, shape)| *shape != [starts.len() - 1]) {
            let text = format!("groups: expected shape ({},)", starts.len() - 1);
            return Err(PyValueError::new_err(text));
        }
        let named = |group| GroupName { group, ..GroupName::default() };
        let attributes = group_names.map(|names| {
            let groups = names.into_iter().map(named).collect();
            Arc::new(FaceAttributes { groups, ..FaceAttributes::default() })
        });
        Ok(PolyMesh {
            positions,
            face_starts: starts,
            corners,
            colours,
            groups: groups.map(|(groups, _)| groups),
            attributes,
        }
        .into())
    }

    /// (n, 3) float64, read-only, shared with the mesh.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let flat: &[f64] = bytemuck::cast_slice(&self.poly().positions);
        shared(py, self.poly().clone(), flat, vec![self.poly().positions.len(), 3])
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
        shared(py, self.poly().clone(), &self.poly().corners, vec![self.poly().face_count(), k])
    }

    /// The corners of all faces, one after the other: uint32, read-only, shared.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shared(py, self.poly().clone(), &self.poly().corners, vec![self.poly().corners.len()])
    }

    /// The start of each face's corners, and finally their number: uint32, read-only, shared.
    #[getter]
    fn face_starts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let poly = self.poly();
        shared(py, poly.clone(), &poly.face_starts, vec![poly.face_starts.len()])
    }

    /// (n, 4) uint8 RGBA, read-only, shared; None where the mesh has no colours.
    #[getter]
    fn colours<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(colours) = &self.poly().colours else { return Ok(None) };
        shared(py, self.poly().clone(), colours.as_flattened(), vec![colours.len(), 4]).map(Some)
    }

    /// The group (OBJ) or object (3MF) of each face, uint32, shared; None where the file has none.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(groups) = &self.poly().groups else { return Ok(None) };
        shared(py, self.poly().clone(), groups, vec![groups.len()]).map(Some)
    }

    /// The names of the groups 0, 1 and so on: that of the group, else of its object, else of its
    /// material. None where the file has none.
    #[getter]
    fn group_names(&self) -> Option<Vec<&str>> {
        let groups = &self.poly().attributes.as_deref()?.groups;
        (!groups.is_empty()).then(|| groups.iter().map(shown_name).collect())
    }

    /// The format of the file, e.g. 'STL (binary)'; None for a mesh that came from no file.
    #[getter]
    fn format(&self) -> Option<&str> {
        self.format.as_deref()
    }

    /// The data left out, guessed or repaired when this mesh was made: one sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The same surface with every polygon cut into triangles; vertices keep their numbers.
    fn triangulated(&self, py: Python<'_>) -> PyResult<Mesh> {
        let poly = self.poly().clone();
        watched(py, &None, move |_| written::triangulated(&poly)).map(Mesh::from)
    }

    /// The mesh with every vertex multiplied by `scale`, then moved by `offset`, then mapped by
    /// `matrix`: (4, 4) numbers, the last row 0, 0, 0, 1. A matrix that mirrors turns the faces, so
    /// that a solid stays a solid.
    #[pyo3(signature = (scale=1.0, offset=[0.0, 0.0, 0.0], matrix=None))]
    fn transformed(
        &self,
        scale: f64,
        offset: [f64; 3],
        matrix: Option<[[f64; 4]; 4]>,
    ) -> PyResult<Mesh> {
        let offset = DVec3::from(offset);
        if !(scale > 0.0 && scale.is_finite() && offset.is_finite()) {
            return Err(PyValueError::new_err("expected a scale above 0 and a finite offset"));
        }
        let mut poly = PolyMesh::clone(self.poly());
        poly.positions.iter_mut().for_each(|p| *p = *p * scale + offset);
        if let Some(rows) = matrix {
            let map = DMat4::from_cols_array_2d(&rows).transpose();
            let turn = map.determinant();
            if !(map.is_finite() && rows[3] == [0.0, 0.0, 0.0, 1.0] && turn != 0.0) {
                return Err(PyValueError::new_err(
                    "matrix: expected finite numbers, the last row 0, 0, 0, 1, and a determinant \
                     that is not 0",
                ));
            }
            poly.positions.iter_mut().for_each(|p| *p = map.transform_point3(*p));
            if turn < 0.0 {
                flip(&mut poly);
            }
        }
        Ok(poly.into())
    }

    /// The enclosed volume. Raises ValueError if the mesh is not closed and oriented: an open mesh
    /// has none.
    #[getter]
    fn volume(&self, py: Python<'_>) -> PyResult<f64> {
        if !self.is_closed(py)? {
            return Err(PyValueError::new_err(
                "the mesh is not closed, so it has no volume; check() names its faults and \
                 repair() closes holes",
            ));
        }
        Ok(self.sizes(py)?.volume)
    }

    /// The sum of the areas of all faces.
    #[getter]
    fn area(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.sizes(py)?.area)
    }

    /// The lowest and the highest corner of the box around all faces; None without faces.
    #[getter]
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let used = self.poly().corners.iter().map(|&v| self.poly().positions[v as usize]);
        let ends = used.map(|p| (p, p)).reduce(|(lo, hi), (p, _)| (lo.min(p), hi.max(p)))?;
        Some((ends.0.to_array(), ends.1.to_array()))
    }

    /// True if each edge has exactly two faces, which run along it in opposite directions.
    #[getter]
    fn is_closed(&self, py: Python<'_>) -> PyResult<bool> {
        let poly = self.poly().clone();
        let report = watched(py, &None, move |job| check::report(&poly, false, job))?;
        Ok(report.map_err(errors::cancelled)?.closed)
    }

    fn __sub__(&self, py: Python<'_>, other: &Bound<'_, Mesh>) -> PyResult<Mesh> {
        boolean::combined(py, self, other.get(), Operation::Difference)
    }

    fn __or__(&self, py: Python<'_>, other: &Bound<'_, Mesh>) -> PyResult<Mesh> {
        boolean::combined(py, self, other.get(), Operation::Union)
    }

    fn __and__(&self, py: Python<'_>, other: &Bound<'_, Mesh>) -> PyResult<Mesh> {
        boolean::combined(py, self, other.get(), Operation::Intersection)
    }

    /// Equal bits of positions, faces, colours, groups and attributes.
    fn __eq__(&self, other: &Bound<'_, Mesh>) -> bool {
        let (a, b) = (self.poly(), other.get().poly());
        // By bits, as the hash: 0 and -0 differ.
        let bits = bytemuck::cast_slice::<DVec3, u64>;
        Arc::ptr_eq(a, b) || a == b && bits(&a.positions) == bits(&b.positions)
    }

    fn __hash__(&self) -> u64 {
        let mut hash = DefaultHasher::new();
        hash.write(bytemuck::cast_slice(&self.poly().positions));
        hash.write(bytemuck::cast_slice(&self.poly().corners));
        hash.write(bytemuck::cast_slice(&self.poly().face_starts));
        hash.finish()
    }

    /// A mesh never changes, so a copy shares its arrays.
    pub fn __copy__(&self) -> Mesh {
        Mesh {
            poly: self.poly.clone(),
            before: self.before.clone(),
            format: self.format.clone(),
            warnings: self.warnings.clone(),
        }
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Mesh {
        self.__copy__()
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let PolyMesh { positions, face_starts, corners, colours, groups, attributes } =
            PolyMesh::clone(self.poly());
        let pickled = PickledMesh {
            positions,
            face_starts,
            corners,
            colours,
            groups,
            attributes: attributes.map(Arc::unwrap_or_clone),
            format: self.format.clone(),
            warnings: self.warnings.clone(),
        };
        let bytes = postcard::to_allocvec(&pickled)
            .map_err(|e| PyValueError::new_err(format!("the mesh cannot be pickled: {e}")))?;
        let restore = py.get_type::<Mesh>().getattr("_unpickled")?;
        Ok((restore, (PyBytes::new(py, &bytes),)))
    }

    #[classmethod]
    fn _unpickled(_: &Bound<'_, PyType>, bytes: &[u8]) -> PyResult<Mesh> {
        let p: PickledMesh = postcard::from_bytes(bytes)
            .map_err(|e| PyValueError::new_err(format!("not a pickled mesh: {e}")))?;
        let (vertices, faces) = (p.positions.len(), p.face_starts.len().saturating_sub(1));
        let sound = are_starts(&p.face_starts, p.corners.len())
            && p.corners.iter().all(|&v| (v as usize) < vertices)
            && p.colours.as_ref().is_none_or(|c| c.len() == vertices)
            && p.groups.as_ref().is_none_or(|g| g.len() == faces);
        if !sound {
            return Err(PyValueError::new_err("not a pickled mesh: its arrays disagree"));
        }
        let poly = PolyMesh {
            positions: p.positions,
            face_starts: p.face_starts,
            corners: p.corners,
            colours: p.colours,
            groups: p.groups,
            attributes: p.attributes.map(Arc::new),
        };
        Ok(Mesh { format: p.format, ..Mesh::warned(poly, p.warnings) })
    }

    /// The picture that a notebook shows.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let png = picture::drawn(py, self.poly().clone(), (480, 360))?;
        Ok(PyBytes::new(py, &png))
    }

    /// The picture and the facts that a notebook shows.
    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("sculptd.convert")?.call_method1("html", (slf,))
    }

    /// Shows the mesh in a window or a notebook, by pyvista, which must be installed. The
    /// arguments are those of `pyvista.PolyData.plot`.
    #[pyo3(signature = (**settings))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("sculptd.convert")?.call_method("plot", (slf,), settings)
    }

    /// Writes the mesh in the format of the name's ending: .obj, .stl, .ply, .off, .glb, .3mf; or
    /// in `format` ('stl'). `path`: a path, or a binary file object. A path is written beside and
    /// renamed, so a file that stood there stays whole if this fails. What the format does not
    /// hold is a LossWarning: colours in STL, groups where it has none, and coordinates that
    /// single precision (STL, GLB, glTF) moves by more than a millionth of the mesh's size. With
    /// `strict` it is raised and nothing is written. `strict` also counts what leaves the surface
    /// as it is: polygons that are cut into triangles, and any rounded coordinate.
    #[pyo3(signature = (path, format=None, *, strict=false))]
    fn write(
        &self,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        format: Option<&str>,
        strict: bool,
    ) -> PyResult<()> {
        file::write(py, self.poly().clone(), path, format, strict)
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
        let (v, f) = (self.poly().positions.len(), self.poly().face_count());
        format!("<sculptd.Mesh of {v} vertices and {f} faces>")
    }

    fn __len__(&self) -> usize {
        self.poly().face_count()
    }
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Mesh>()
}
