//! The wall thickness of the object, as a client asks for it again and again.

use super::host::{Host, KeptThickness, failed, locked};
use sculptd_control::RpcError;
use sculptd_control::edit::{ThicknessDefinition, ThicknessParams, ThicknessReply};
use sculptd_geometry::thickness::check::ThicknessLimits;
use sculptd_geometry::thickness::ready::ReadyPart;
use sculptd_geometry::thickness::{ThicknessMethod, ThicknessSettings};

/// Measures the newest mesh as `sculptd thickness` does. The same question about the same mesh is
/// answered from memory.
pub(super) fn thickness(host: &Host, params: &ThicknessParams) -> Result<ThicknessReply, RpcError> {
    let state = host.published.load_full();
    let (mesh, scale) = (&state.mesh, state.transform().scale);
    let mut kept = locked(&host.thickness);
    let same = |k: &&KeptThickness| {
        k.params == *params && k.scale == scale && k.reply.revision == mesh.revision()
    };
    if let Some(k) = kept.as_ref().filter(same) {
        return Ok(ThicknessReply { measured: 0, ..k.reply.clone() });
    }
    let (method, definition) = match params.method {
        Some(ThicknessDefinition::Sphere) => (ThicknessMethod::Sphere, ThicknessDefinition::Sphere),
        Some(ThicknessDefinition::Ray) => (ThicknessMethod::Ray, ThicknessDefinition::Ray),
        None if params.rays == 1 => (ThicknessMethod::Ray, ThicknessDefinition::Ray),
        _ => (ThicknessMethod::Cone, ThicknessDefinition::Cone),
    };
    let rays = params.rays as usize;
    let settings = ThicknessSettings { method, rays, ..ThicknessSettings::default() };
    let limits =
        ThicknessLimits { fail_below: params.limit.filter(|l| *l > 0.0), ..Default::default() };
    let whole = mesh.to_tri().to_poly();
    let place = host.jobs.begin();
    let job = &*place.job;
    let part = ReadyPart::new(&whole, scale, None, settings.crease, job).map_err(failed)?;
    let vertices = part.original_mesh().positions.len() as u64;
    let found = part.judge("", &settings, limits, job, || 0.0).map_err(failed)?;
    let (answer, values) = (found.answer, &found.thickness.values);
    let valid = values.iter().take(vertices as usize).filter(|v| v.is_finite()).count() as u64;
    let s = &answer.summary;
    let reply = ThicknessReply {
        revision: mesh.revision(),
        method: definition,
        vertices,
        measured: vertices,
        valid,
        min: s.min,
        max: s.max,
        mean: s.mean,
        median: s.median,
        lower: answer.least.map(|l| l.lower),
        upper: answer.least.map(|l| l.upper),
        certified: answer.least.is_some_and(|l| l.certified),
        statement: answer.statement,
        below_percent: answer.below.map(|b| b.area_percent),
    };
    *kept = Some(KeptThickness { params: *params, scale, reply: reply.clone() });
    Ok(reply)
}
