//! The wall thickness of the object, as a client asks for it again and again.

use super::host::{Host, failed, locked};
use sculptd_clay::live_thickness::LiveMap;
use sculptd_control::RpcError;
use sculptd_control::edit::{ThicknessParams, ThicknessReply};
use sculptd_geometry::job::Job;

/// Brings the map that the host keeps up to the state of the mesh. The first call measures all.
pub(super) fn thickness(host: &Host, params: &ThicknessParams) -> Result<ThicknessReply, RpcError> {
    let state = host.published.load_full();
    let (mesh, transform, job) = (&state.mesh, state.transform(), Job::default());
    let rays = params.rays as usize;
    let mut kept = locked(&host.thickness);
    // Taken out while it works, so that a panic leaves none rather than half of one.
    let current = kept.take().filter(|m| m.rays() == rays);
    let advanced = current.and_then(|mut m| m.advance(mesh).is_ok().then_some(m));
    let mut map = match advanced {
        Some(map) => map,
        None => LiveMap::new(mesh, rays, &job).map_err(failed)?,
    };
    let measured = map.stale() as u64;
    map.work(transform.inverse().point(params.near.into()), usize::MAX, &job).map_err(failed)?;
    let values = map.values();
    // The map is of the clay's own frame; walls are told in the world's unit.
    let unit = transform.scale as f32;
    let valid = values.iter().filter(|v| v.is_finite()).map(|v| v * unit);
    let valid: Vec<f32> = valid.collect();
    let sum = valid.iter().map(|&v| f64::from(v)).sum::<f64>();
    let reply = ThicknessReply {
        revision: map.revision(),
        vertices: values.len() as u64,
        measured,
        valid: valid.len() as u64,
        min: valid.iter().copied().reduce(f32::min),
        max: valid.iter().copied().reduce(f32::max),
        mean: sum / valid.len().max(1) as f64,
    };
    *kept = Some(map);
    Ok(reply)
}
