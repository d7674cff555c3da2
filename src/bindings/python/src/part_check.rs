//! Whether a part is ready to be printed or moulded.

use std::time::Instant;

use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sculptd_check::preset::CheckPreset;
use sculptd_check::{CheckAnswer, CheckRequest, CheckSettings, PresetLibrary, check_part};
use sculptd_geometry::thickness::check::ThicknessLimits;
use sculptd_geometry::thickness::preset::Preset;

use crate::embedded_presets::{CHECKS, WALLS};
use crate::errors;
use crate::job::{Progress, watched};
use crate::mesh::Mesh;

/// How a part is made, by names of presets, and how it stands.
#[derive(Debug)]
pub struct PartRequest<'a> {
    /// `fdm`, `sla`, `sls` or `moulding`; the printer's, or `fdm`.
    pub process: Option<&'a str>,
    pub printer: Option<&'a str>,
    pub material: Option<&'a str>,
    /// The build direction, or the pull direction of a mould.
    pub up: [f64; 3],
    /// Millimetres a unit of the mesh.
    pub scale: f64,
    /// Search for the best build direction.
    pub orient: bool,
}

fn bad(e: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(e.to_string())
}

/// The presets that come with the module.
fn library() -> PyResult<PresetLibrary> {
    let read = |(name, text): &(&str, &str)| CheckPreset::read(name, text).map_err(bad);
    let checks = CHECKS.iter().map(read).collect::<PyResult<Vec<_>>>()?;
    let read = |(name, text): &(&str, &str)| Preset::read(name, text).map_err(bad);
    let walls = WALLS.iter().map(read).collect::<PyResult<Vec<_>>>()?;
    Ok(PresetLibrary { checks, walls })
}

/// The limits of walls by the name of a process or a material.
pub fn wall_limits(name: &str) -> PyResult<ThicknessLimits> {
    library()?.walls(name).map(ThicknessLimits::from).map_err(bad)
}

fn settings(request: &PartRequest<'_>) -> PyResult<CheckSettings> {
    let library = library()?;
    let printer = request.printer.map(|name| library.printer(name)).transpose().map_err(bad)?;
    let usual = printer.map_or("fdm", |p| p.process.as_str());
    let process = library.process(request.process.unwrap_or(usual)).map_err(bad)?;
    let material = request.material.map(|name| library.material(name)).transpose().map_err(bad)?;
    CheckSettings::new(&library, process, printer, material, DVec3::from(request.up)).map_err(bad)
}

/// Checks a part.
pub fn checked(
    py: Python<'_>,
    mesh: &Mesh,
    request: &PartRequest<'_>,
    progress: &Progress,
) -> PyResult<CheckAnswer> {
    let up = DVec3::from(request.up);
    if !(up.is_finite() && up != DVec3::ZERO) {
        return Err(PyValueError::new_err("up: expected a vector that is not zero"));
    }
    if !(request.scale > 0.0 && request.scale.is_finite()) {
        return Err(PyValueError::new_err("scale: expected a number above 0"));
    }
    let settings = settings(request)?;
    let (scale, orient) = (request.scale, request.orient);
    #[allow(clippy::disallowed_methods)] // The answer states its duration.
    let began = Instant::now();
    let seconds = move || began.elapsed().as_secs_f64();
    let poly = mesh.poly().clone();
    watched(py, progress, move |job| {
        check_part(
            "",
            &poly,
            scale,
            &settings,
            CheckRequest { orient, ..Default::default() },
            job,
            seconds,
        )
    })?
    .map(|solid| solid.answer)
    .map_err(errors::cancelled)
}
