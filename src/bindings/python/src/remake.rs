//! Another mesh of the same solid, or of a larger, smaller, hollow or sound one.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean;
use sculptd_geometry::decimate::{DecimationTarget, quadric};
use sculptd_geometry::job::Job;
use sculptd_geometry::offset::{self as offsets};
use sculptd_geometry::remesh::{self as remeshing, RemeshSettings};
use sculptd_geometry::{repair as repairs, subdivide as subdivision};

use crate::job::{Progress, watched};
use crate::mesh::Mesh;
use crate::solid::prepared;
use crate::{errors, file};

/// One closed surface of even triangles around everything that is inside `mesh`, closed or not,
/// crossed or not. `side`: samples along the longest side, 8 to 1024. `sharp`: keep sharp edges.
#[pyfunction]
#[pyo3(signature = (mesh, *, side=256, sharp=false, progress=None))]
fn remesh(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    side: usize,
    sharp: bool,
    progress: Progress,
) -> PyResult<Mesh> {
    let (part, solid) = prepared(py, mesh.get(), &None)?;
    let centre = part.centre;
    let settings = RemeshSettings { side, sharp };
    let made =
        watched(py, &progress, move |job| remeshing::remesh(&part.mesh, &solid, settings, job))?
            .map_err(|e| errors::remesh(&e))?;
    Ok(Mesh::at(&made.mesh, centre))
}

/// The surface at `distance` from that of `mesh`, and nowhere nearer; negative shrinks. Raises
/// EmptyResult where shrinking leaves nothing. The result has no colours; if `mesh` has some, this
/// warns with a LossWarning.
#[pyfunction]
#[pyo3(signature = (mesh, distance, *, side=256, progress=None))]
fn offset(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    distance: f64,
    side: usize,
    progress: Progress,
) -> PyResult<Mesh> {
    if !distance.is_finite() {
        return Err(PyValueError::new_err("distance: expected a finite length"));
    }
    if mesh.get().poly().colours.is_some() {
        file::tell(py, &["the vertices' colours are left out: an offset has none".into()], false)?;
    }
    let (part, solid) = prepared(py, mesh.get(), &None)?;
    let made = watched(py, &progress, move |job| offsets::offset(&solid, distance, side, job))?
        .map_err(|e| errors::remesh(&e))?;
    Ok(Mesh::at(&made.mesh, part.centre))
}

/// `mesh` with a cavity inside that leaves a wall of at least `wall`. The old surface is kept bit
/// by bit, in single precision around the part's middle. Raises EmptyResult where the part is
/// nowhere thick enough.
#[pyfunction]
#[pyo3(signature = (mesh, wall, *, side=256, progress=None))]
fn hollow(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    wall: f64,
    side: usize,
    progress: Progress,
) -> PyResult<Mesh> {
    if !(wall > 0.0 && wall.is_finite()) {
        return Err(PyValueError::new_err("wall: expected a length above 0"));
    }
    let (part, solid) = prepared(py, mesh.get(), &None)?;
    let centre = part.centre;
    let made =
        watched(py, &progress, move |job| offsets::hollow(&part.mesh, &solid, wall, side, job))?
            .map_err(|e| errors::remesh(&e))?;
    Ok(Mesh::at(&made.mesh, centre))
}

/// Fewer triangles for nearly the same surface: edges are collapsed where the quadric error is
/// least (Garland and Heckbert 1997), down to `triangles`, and never beyond an error of `error`.
///
/// The error of a collapse, in the mesh's unit, is the root of the mean square distance of the new
/// vertex from the planes of the triangles that it stands for. It is no bound on the distance
/// between the surfaces. To measure that, ask
/// `abs(sculptd.signed_distance(mesh, smaller.vertices)).max()`, which looks at the vertices alone.
#[pyfunction]
#[pyo3(signature = (mesh, triangles=0, *, error=f64::INFINITY, progress=None))]
fn decimate(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    triangles: usize,
    error: f64,
    progress: Progress,
) -> PyResult<Mesh> {
    if error.is_nan() || error < 0.0 || triangles == 0 && error == f64::INFINITY {
        return Err(PyValueError::new_err("expected a number of triangles, or an error, or both"));
    }
    let poly = mesh.get().poly().clone();
    let target = DecimationTarget { triangles, error, single: false };
    let made = watched(py, &progress, move |job| quadric(&poly, target, job))?
        .map_err(errors::cancelled)?;
    Ok(made.into())
}

/// Corners beyond which `subdivide` refuses: about 12 GiB.
const MOST_CORNERS: u64 = 1 << 30;

/// Smaller faces and a rounder surface: 'loop' (triangles) or 'catmull-clark' (quadrilaterals).
#[pyfunction]
#[pyo3(signature = (mesh, levels=1, *, scheme="loop", progress=None))]
fn subdivide(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    levels: u32,
    scheme: &str,
    progress: Progress,
) -> PyResult<Mesh> {
    let poly = mesh.get().poly().clone();
    if subdivision::corners_after(&poly, levels) > MOST_CORNERS {
        return Err(PyValueError::new_err(format!(
            "levels: {levels} levels of {} faces do not fit into memory",
            poly.face_count()
        )));
    }
    let made = match scheme {
        "loop" => watched(py, &progress, move |job| subdivision::loop_(&poly, levels, job))?,
        "catmull-clark" => {
            watched(py, &progress, move |job| subdivision::catmull_clark(&poly, levels, job))?
        }
        other => {
            return Err(PyValueError::new_err(format!(
                "scheme: expected 'loop' or 'catmull-clark'; found '{other}'"
            )));
        }
    };
    Ok(made.map_err(errors::cancelled)?.into())
}

/// What [`repair`] does, in the order in which it is done.
fn repaired(
    mut mesh: PolyMesh,
    weld: f64,
    longest: usize,
    job: &Job,
) -> Result<(PolyMesh, Vec<String>), boolean::BooleanError> {
    let mut told = Vec::new();
    let mut tell = |n: usize, what: &str| {
        if n > 0 {
            told.push(format!("{n} {what}"));
        }
    };
    tell(repairs::weld(&mut mesh, weld), "vertices welded to others");
    tell(repairs::remove_degenerate(&mut mesh), "faces without extent removed");
    job.check()?;
    let oriented = repairs::orient_shells(&mut mesh);
    tell(oriented.turned, "faces turned over");
    job.check()?;
    let filled = repairs::fill_holes(&mut mesh, longest);
    tell(filled.holes, "holes closed");
    tell(
        filled.left,
        "open edges left as they are: they bound no simple hole of longest_hole edges",
    );
    if oriented.crossing + oriented.nested > 0 && filled.left == 0 {
        tell(oriented.crossing, "pairs of shells that cross made one solid");
        tell(oriented.nested, "shells within others made one solid with them");
        mesh = boolean::solve(&mesh, job)?;
    }
    Ok((mesh, told))
}

/// The mesh made sound: vertices within `weld` become one, faces without extent go, neighbours
/// agree on their side, holes of at most `longest_hole` edges are closed, shells that cross become
/// one solid. `warnings` of the result say what was done. A longer rim is rather the edge of an
/// open surface, such as a bowl without a wall, than a fault; it stays open unless you allow it.
#[pyfunction]
#[pyo3(signature = (mesh, *, weld=0.0, longest_hole=64, progress=None))]
fn repair(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    weld: f64,
    longest_hole: usize,
    progress: Progress,
) -> PyResult<Mesh> {
    if !(weld >= 0.0 && weld.is_finite()) {
        return Err(PyValueError::new_err("weld: expected a length of 0 or more"));
    }
    let poly = mesh.get().poly().clone();
    let (made, told) = watched(py, &progress, move |job| {
        repaired(PolyMesh::clone(&poly), weld, longest_hole, job)
    })?
    .map_err(|e| errors::boolean(py, &e))?;
    Ok(Mesh::warned(made, told))
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(remesh, m)?)?;
    m.add_function(wrap_pyfunction!(offset, m)?)?;
    m.add_function(wrap_pyfunction!(hollow, m)?)?;
    m.add_function(wrap_pyfunction!(decimate, m)?)?;
    m.add_function(wrap_pyfunction!(subdivide, m)?)?;
    m.add_function(wrap_pyfunction!(repair, m)?)
}
