//! Facts of a mesh: sizes, topology, whether it crosses itself, its shadow.

use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sculptd_geometry::distance::Topology;
use sculptd_geometry::measure::measures_of;
use sculptd_geometry::projection::{PlaneRegion, ProjectionPlane, area, outline};
use sculptd_geometry::{CentredMesh, check};

use crate::array::shared;
use crate::errors;
use crate::job::{Progress, watched};
use crate::mesh::Mesh;
use crate::part_check::{PartRequest, checked};

/// Converts a value to Python's dicts and lists, by way of JSON.
pub fn to_python<'py, T: serde::Serialize>(
    py: Python<'py>,
    value: &T,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| PyValueError::new_err(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Volume, area, dimensions along x, y and z, and the centroid of the enclosed volume (None where
/// there is no volume): a dict. Of an open mesh the volume means little; `check` tells.
#[pyfunction(name = "measure")]
fn measures<'py>(py: Python<'py>, mesh: &Bound<'py, Mesh>) -> PyResult<Bound<'py, PyDict>> {
    let poly = mesh.get().poly().clone();
    let none: Progress = None;
    let m = watched(py, &none, move |_| measures_of(&poly.positions, &poly.triangles().0))?;
    let out = PyDict::new(py);
    out.set_item("volume", m.volume)?;
    out.set_item("area", m.area)?;
    out.set_item("dimensions", m.dimensions)?;
    out.set_item("centroid", m.centroid.map(|c| c.to_array()))?;
    Ok(out)
}

/// Returns the facts of the mesh: counts, topology, bounds, crossings. The result is a dict with
/// the fields of `sculptd info --json`. `crossings=False` leaves out the slowest part.
///
/// With `process` ('fdm', 'sla', 'sls' or 'moulding'), `printer` or `material`, whether the part is
/// ready to be made: the answer of `sculptd check --json`, a dict with `ok`, `findings` and facts
/// such as `volume` and `weight`. `up`: the build direction, or the pull direction of a mould;
/// `scale`: the millimetres in one unit of the mesh: 25.4 for inches, 1000 for metres. Limits and
/// the answer are in millimetres. `orient`: search for the best
/// build direction too.
#[pyfunction(name = "check")]
#[pyo3(signature = (mesh, *, crossings=true, process=None, printer=None, material=None,
                    up=[0.0, 0.0, 1.0], scale=1.0, orient=false, progress=None))]
fn check_mesh<'py>(
    py: Python<'py>,
    mesh: &Bound<'py, Mesh>,
    crossings: bool,
    process: Option<&str>,
    printer: Option<&str>,
    material: Option<&str>,
    up: [f64; 3],
    scale: f64,
    orient: bool,
    progress: Progress,
) -> PyResult<Bound<'py, PyAny>> {
    if process.is_some() || printer.is_some() || material.is_some() {
        let request = PartRequest { process, printer, material, up, scale, orient };
        return to_python(py, &checked(py, mesh.get(), &request, &progress)?);
    }
    let poly = mesh.get().poly().clone();
    let report = watched(py, &progress, move |job| check::report(&poly, crossings, job))?
        .map_err(errors::cancelled)?;
    to_python(py, &report)
}

/// The shadow of a part along a direction.
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
struct Projection {
    regions: std::sync::Arc<Vec<PlaneRegion>>,
    plane: ProjectionPlane,
}

#[pymethods]
impl Projection {
    /// In square units, without the holes.
    #[getter]
    fn area(&self) -> f64 {
        area(&self.regions)
    }

    /// The axes of the plane as unit vectors of space: coordinates u and v of the outlines.
    #[getter]
    fn axes(&self) -> ([f64; 3], [f64; 3]) {
        (self.plane.u.to_array(), self.plane.v.to_array())
    }

    /// One tuple a region: its outer outline, (n, 2) float64 counter-clockwise, and a list of its
    /// holes, clockwise. Each outline ends with its first point.
    #[getter]
    #[allow(clippy::type_complexity)]
    fn regions<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Vec<(Bound<'py, PyAny>, Vec<Bound<'py, PyAny>>)>> {
        let array = |ring: &Vec<glam::DVec2>| {
            let flat = bytemuck::cast_slice::<_, f64>(ring);
            shared(py, self.regions.clone(), flat, vec![ring.len(), 2])
        };
        let one = |r: &PlaneRegion| {
            Ok((array(&r.outer)?, r.holes.iter().map(array).collect::<PyResult<_>>()?))
        };
        self.regions.iter().map(one).collect()
    }
}

/// The exact shadow of a mesh along `direction` (any length but zero).
#[pyfunction]
#[pyo3(signature = (mesh, direction=[0.0, 0.0, -1.0], *, progress=None))]
fn project(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    direction: [f64; 3],
    progress: Progress,
) -> PyResult<Projection> {
    let plane = ProjectionPlane::along(DVec3::from(direction), 0.0)
        .ok_or_else(|| PyValueError::new_err("direction: expected a vector that is not zero"))?;
    let poly = mesh.get().poly().clone();
    let regions = watched(py, &progress, move |_| {
        // In the frame of the part, then moved to where the part is.
        let part = CentredMesh::new(&poly, 1.0);
        let mut regions = outline(&Topology::build(&part.mesh), &plane);
        let moved = plane.flat(part.centre);
        for region in &mut regions {
            for ring in std::iter::once(&mut region.outer).chain(&mut region.holes) {
                ring.iter_mut().for_each(|p| *p += moved);
            }
        }
        regions
    })?;
    Ok(Projection { regions: std::sync::Arc::new(regions), plane })
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Projection>()?;
    m.add_function(wrap_pyfunction!(measures, m)?)?;
    m.add_function(wrap_pyfunction!(check_mesh, m)?)?;
    m.add_function(wrap_pyfunction!(project, m)?)
}
