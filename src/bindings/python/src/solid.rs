//! Distance to a solid, at points.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use sculptd_geometry::CentredMesh;
use sculptd_geometry::distance::{DistanceSolid, Sign};

use crate::array::points;
use crate::errors;
use crate::job::{Progress, watched};
use crate::mesh::Mesh;

/// A mesh made ready for questions of distance. Building costs about 0.4 microseconds a triangle;
/// each question then costs about as much as the logarithm of the mesh's size.
///
/// `sign`: 'winding' (right on every closed mesh, smooth across holes) or 'pseudonormal' (right on
/// closed meshes that do not cross themselves).
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
pub struct Solid {
    pub part: Arc<CentredMesh>,
    pub solid: Arc<DistanceSolid>,
}

/// A part in its own frame, and the tree over it.
pub fn prepared(
    py: Python<'_>,
    mesh: &Mesh,
    progress: &Progress,
) -> PyResult<(CentredMesh, DistanceSolid)> {
    let poly = mesh.poly().clone();
    watched(py, progress, move |job| {
        let part = CentredMesh::new(&poly, 1.0);
        let solid = DistanceSolid::build(&part.mesh, job)?;
        Ok((part, solid))
    })?
    .map_err(errors::cancelled)
}

#[pymethods]
impl Solid {
    #[new]
    #[pyo3(signature = (mesh, *, sign="winding", progress=None))]
    fn new(
        py: Python<'_>,
        mesh: &Bound<'_, Mesh>,
        sign: &str,
        progress: Progress,
    ) -> PyResult<Solid> {
        let sign = match sign {
            "winding" => Sign::Winding,
            "pseudonormal" => Sign::Pseudonormal,
            other => {
                return Err(PyValueError::new_err(format!(
                    "sign: expected 'winding' or 'pseudonormal'; found '{other}'"
                )));
            }
        };
        let (part, solid) = prepared(py, mesh.get(), &progress)?;
        Ok(Solid { part: Arc::new(part), solid: Arc::new(solid.with_sign(sign)) })
    }

    /// The distance of each of (n, 3) points to the surface, negative inside: float64.
    #[pyo3(signature = (at, *, progress=None))]
    fn signed_distance<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        progress: Progress,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let moved = self.moved(at)?;
        let solid = self.solid.clone();
        let found = watched(py, &progress, move |job| solid.signed_distances(&moved, job))?
            .map_err(errors::cancelled)?;
        Ok(PyArray1::from_vec(py, found))
    }

    /// For each of (n, 3) points: the nearest point of the surface, (n, 3) float64, and its
    /// triangle, uint32 (4294967295 where there is none). Triangles are those of
    /// `mesh.triangulated()`.
    #[pyo3(signature = (at, *, progress=None))]
    #[allow(clippy::type_complexity)]
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
        progress: Progress,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<u32>>)> {
        let moved = self.moved(at)?;
        let solid = self.solid.clone();
        let found = watched(py, &progress, move |job| solid.nearest(&moved, job))?
            .map_err(errors::cancelled)?;
        let place = |n: &Option<sculptd_geometry::bvh::NearestPoint>| {
            n.map_or(DVec3::NAN, |n| n.point + self.part.centre)
        };
        let places: Vec<f64> = found.iter().flat_map(|n| place(n).to_array()).collect();
        let triangles = found.iter().map(|n| n.map_or(u32::MAX, |n| n.triangle)).collect();
        let places = PyArray1::from_vec(py, places).reshape([found.len(), 3])?;
        Ok((places, PyArray1::from_vec(py, triangles)))
    }

    /// The winding number at each of (n, 3) points: about 1 inside, 0 outside. float64.
    fn winding<'py>(
        &self,
        py: Python<'py>,
        at: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let moved = self.moved(at)?;
        let solid = self.solid.clone();
        let found = watched(py, &None, move |job| {
            let one = |p: &DVec3| job.check().map(|()| solid.winding(*p));
            moved.par_iter().map(one).collect::<Result<Vec<f64>, _>>()
        })?
        .map_err(errors::cancelled)?;
        Ok(PyArray1::from_vec(py, found))
    }
}

impl Solid {
    /// The points in the part's own frame.
    fn moved(&self, at: &Bound<'_, PyAny>) -> PyResult<Vec<DVec3>> {
        let mut at = points(at, "points")?;
        if let Some(bad) = at.iter().position(|p| !p.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "points: entry {bad} is not finite: a distance needs numbers; leave such points out"
            )));
        }
        at.iter_mut().for_each(|p| *p -= self.part.centre);
        Ok(at)
    }
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Solid>()
}
