//! What `scene.snap` and `scene.boolean` do.

use glam::DVec3;

use super::host::Host;
use super::scene;
use crate::operations::Computed;
use crate::scene_jobs::{self, SceneBoolean};
use crate::snap_jobs::{self, PickedFace};
use sculptd_control::RpcError;
use sculptd_control::edit::Operation as AskedOperation;
use sculptd_control::scene::{CombineReply, SceneBooleanParams};
use sculptd_control::snap::{SnapAlignment, SnapParams, SnapReply};
use sculptd_engine::scene::{FaceAlignment, ObjectId};
use sculptd_geometry::boolean::Operation;

pub(super) fn snap(host: &Host, params: &SnapParams) -> Result<SnapReply, RpcError> {
    let picked = |id, at| PickedFace { id: ObjectId(id), at: DVec3::from_array(at) };
    let (moved, target) = (picked(params.id, params.at), picked(params.to, params.to_at));
    let alignment = match params.align {
        SnapAlignment::Nearest => FaceAlignment::Nearest,
        SnapAlignment::Centre => FaceAlignment::Centre,
        SnapAlignment::Edge => FaceAlignment::Edge,
    };
    let place = host.jobs.begin();
    let done = host.operate(&place.job, |now| {
        let placed = snap_jobs::face_to_face(now, moved, target, alignment, params.spin)?;
        Ok(Computed::of_snap(placed))
    })?;
    let placed = done.made;
    let transform = scene::placement(&placed.placing.transform);
    let id = scene::object_of(done.answer);
    Ok(SnapReply { id, transform, off: placed.off, areas: placed.areas })
}

pub(super) fn boolean(host: &Host, p: &SceneBooleanParams) -> Result<CombineReply, RpcError> {
    let ids = [ObjectId(p.a), ObjectId(p.b)];
    let asked = SceneBoolean {
        keep: p.keep,
        live: p.live,
        all: p.all,
        keep_contact: p.keep_contact,
        tolerance: p.tolerance,
        ..SceneBoolean::new(operation(p.operation))
    };
    scene::combine(host, |shown, job| scene_jobs::boolean(shown, ids, asked, job))
}

pub(super) fn operation(asked: AskedOperation) -> Operation {
    match asked {
        AskedOperation::Union => Operation::Union,
        AskedOperation::Intersection => Operation::Intersection,
        AskedOperation::Difference => Operation::Difference,
        AskedOperation::ReverseDifference => Operation::ReverseDifference,
    }
}
