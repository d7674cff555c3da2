//! The methods that give the object other triangles.

use glam::DVec3;

use super::host::Host;
use super::scene::ask;
use super::view_region::region;
use super::{face_sets, layers};
use crate::decimate_job::{DecimateWanted, decimated};
use crate::quad_job::{QuadsWanted, quads};
use crate::remesh_job::{Wanted, remeshed};
use crate::symmetrise_job::{SymmetriseWanted, symmetrised};
use sculptd_control::RpcError;
use sculptd_control::edit::{RemeshParams, RemeshReply};
use sculptd_control::retopology as asked;
use sculptd_devices::Clock;
use sculptd_engine::local_remesh::{LocalRemesh, WantedEdge};
use sculptd_engine::scene::SceneCommand;
use sculptd_geometry::remesh::LostParts;

pub(super) fn remesh(host: &Host, params: RemeshParams) -> Result<RemeshReply, RpcError> {
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let wanted = Wanted { voxel: params.voxel, sharp: params.sharp };
    let (layers_baked, sets_dropped) = (layers::count(host), face_sets::count(host));
    let done = host.operate(&place.job, |now| remeshed(now, &wanted, &place.job))?;
    let (note, made) = (done.note(), done.made);
    Ok(RemeshReply {
        layers_baked,
        sets_dropped,
        voxel: made.voxel,
        vertices: made.vertices as u64,
        triangles: made.triangles as u64,
        volume_before: made.volume[0],
        volume: made.volume[1],
        self_intersections: made.crossings as u64,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
        warnings: made.lost.iter().map(lost_parts).chain(note).collect(),
    })
}

/// Says what a remesh did not hold.
fn lost_parts(lost: &LostParts) -> String {
    let ([x, y, z], area) = (lost.place.to_array(), lost.area);
    format!(
        "{area:.3} square units of the surface are lost, for instance at ({x}, {y}, {z}): parts \
         there are thinner than a voxel. Use a smaller one"
    )
}

/// Hands it to the loop and waits for what came of it.
pub(super) fn remesh_local(
    host: &Host,
    params: asked::RemeshLocalParams,
) -> Result<asked::RemeshLocalReply, RpcError> {
    let asked::RemeshLocalParams { edge, stretched_only, region: seen } = params;
    let edge = edge.map_or(WantedEdge::OfUsual(1.0), WantedEdge::Length);
    let region = seen.map(region).transpose()?;
    let wanted = LocalRemesh { edge, stretched_only, region };
    let done = ask(host, SceneCommand::RemeshLocal(wanted))?;
    Ok(asked::RemeshLocalReply { changed: done.id.into() })
}

pub(super) fn remesh_quads(
    host: &Host,
    params: asked::RemeshQuadsParams,
) -> Result<asked::RemeshQuadsReply, RpcError> {
    if params.creases.is_some_and(|c| !(0.0..=180.0).contains(&c)) {
        return Err(RpcError::bad_params("creases: expected an angle of 0 to 180 degrees"));
    }
    let guides = params.guides.into_iter();
    let wanted = QuadsWanted {
        quads: params.quads as usize,
        creases: params.creases,
        guides: guides.map(|line| line.into_iter().map(DVec3::from).collect()).collect(),
        levels: params.levels,
    };
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let layers_baked = layers::count(host);
    let done = host.operate(&place.job, |now| quads(now, &wanted, &place.job))?;
    let (note, made) = (done.note(), done.made);
    Ok(asked::RemeshQuadsReply {
        quads: made.quads as u64,
        other_faces: made.other_faces as u64,
        vertices: made.vertices as u64,
        triangles: made.triangles as u64,
        volume_before: made.volume[0],
        volume: made.volume[1],
        self_intersections: made.self_intersections as u64,
        without_detail: made.without_detail as u64,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
        layers_baked,
        warnings: made.warnings.into_iter().chain(note).collect(),
    })
}

pub(super) fn symmetrise(
    host: &Host,
    params: asked::SymmetriseParams,
) -> Result<asked::SymmetriseReply, RpcError> {
    let axis = match params.axis {
        asked::PlaneAxis::X => 0,
        asked::PlaneAxis::Y => 1,
        asked::PlaneAxis::Z => 2,
    };
    let wanted = SymmetriseWanted { axis, keeps_positive: !params.negative };
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let layers_baked = layers::count(host);
    let done = host.operate(&place.job, |now| symmetrised(now, wanted, &place.job))?;
    let (note, made) = (done.note(), done.made);
    Ok(asked::SymmetriseReply {
        vertices: made.vertices as u64,
        triangles: made.triangles as u64,
        volume_before: made.volume[0],
        volume: made.volume[1],
        self_intersections: made.crossings as u64,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
        layers_baked,
        warnings: note.into_iter().collect(),
    })
}

pub(super) fn decimate(
    host: &Host,
    params: asked::DecimateParams,
) -> Result<asked::DecimateReply, RpcError> {
    if params.max_error.is_some_and(|e| !(e >= 0.0 && e.is_finite())) {
        return Err(RpcError::bad_params("max_error: expected a distance of 0 or more"));
    }
    let wanted =
        DecimateWanted { triangles: params.triangles as usize, max_error: params.max_error };
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let layers_baked = layers::count(host);
    let done = host.operate(&place.job, |now| decimated(now, &wanted, &place.job))?;
    let (note, made) = (done.note(), done.made);
    Ok(asked::DecimateReply {
        vertices: made.vertices as u64,
        triangles: made.triangles as u64,
        triangles_before: made.triangles_before as u64,
        volume_before: made.volume[0],
        volume: made.volume[1],
        new_self_intersections: made.new_crossings as u64,
        repeated: made.repeated as u64,
        seconds: (clock.now_us() - begun) as f64 * 1e-6,
        layers_baked,
        warnings: note.into_iter().collect(),
    })
}
