//! What the methods of face sets do: they are about the active object.

use glam::Vec2;

use super::host::Host;
use super::scene::{ask, object_of};
use super::view_region::sets_region;
use crate::Published;
use crate::face_set_jobs;
use sculptd_clay::face_sets::{FaceSetPart, PartEdit, Partition, SetsEdit};
use sculptd_control::RpcError;
use sculptd_control::face_sets::{
    FaceSetExtractParams, FaceSetInfo, FaceSetMakeParams, FaceSetNameParams, FaceSetParams,
    FaceSetRegionParams, FaceSetReply, FaceSetSource, FaceSetsReply,
};
use sculptd_control::scene::ObjectReply;
use sculptd_engine::scene::SceneCommand;

/// Result of a method that changes face sets.
pub(super) type SetsDone = Result<FaceSetReply, RpcError>;

/// Default crease or bend angle that separates face sets, in degrees.
const USUAL_DEGREES: f32 = 40.0;

/// The face sets of the active object.
pub(super) fn list(shown: &Published) -> FaceSetsReply {
    let names = shown.scene.active().map(|o| &o.settings.set_names);
    let info = |(set, vertices, hidden)| {
        let name = names.and_then(|n| n.get(&set)).cloned();
        FaceSetInfo { set, vertices, hidden, name }
    };
    let sets: Vec<FaceSetInfo> = shown.mesh.face_sets().into_iter().map(info).collect();
    FaceSetsReply {
        object: shown.scene.active().map_or(0, |o| o.id.0),
        hidden: sets.iter().map(|s| s.hidden).sum(),
        sets,
    }
}

/// Returns the number of face sets of the active object; 1 if it has none but part of it is hidden.
pub(super) fn count(host: &Host) -> u64 {
    host.published.load().mesh.face_set_count()
}

/// Sends an edit to the loop and waits for its result.
pub(super) fn edit(host: &Host, edit: SetsEdit) -> SetsDone {
    let made = u64::from(matches!(edit, SetsEdit::FromMask | SetsEdit::FromVisible));
    let done = ask(host, SceneCommand::Sets(edit))?;
    let set = u16::try_from(done.id).ok().filter(|set| *set > 0);
    Ok(FaceSetReply { set, made })
}

pub(super) fn make(host: &Host, p: FaceSetMakeParams) -> SetsDone {
    let degrees = p.degrees.unwrap_or(USUAL_DEGREES);
    let by = match p.from {
        FaceSetSource::Mask => return edit(host, SetsEdit::FromMask),
        FaceSetSource::Visible => return edit(host, SetsEdit::FromVisible),
        FaceSetSource::Loose => Partition::Loose,
        FaceSetSource::Normals => Partition::Normals(degrees),
        FaceSetSource::Crease => Partition::Crease(degrees),
        FaceSetSource::Walls => Partition::Walls(p.levels.map(usize::from)),
    };
    let place = host.jobs.begin();
    let done = host.operate(&place.job, |now| face_set_jobs::parted(now, by, &place.job))?;
    let set = u16::try_from(object_of(done.answer)).ok().filter(|set| *set > 0);
    Ok(FaceSetReply { set, made: done.made })
}

pub(super) fn region(host: &Host, p: FaceSetRegionParams) -> SetsDone {
    let asked = sets_region(p)?;
    let made = u64::from(asked.edit == PartEdit::NewSet);
    let done = ask(host, SceneCommand::SetsRegion(asked))?;
    Ok(FaceSetReply { set: u16::try_from(done.id).ok().filter(|set| *set > 0), made })
}

/// The set that is meant; `None`: what is masked.
fn named(host: &Host, p: &FaceSetParams) -> Result<Option<u16>, RpcError> {
    match (p.set, p.at, p.masked) {
        (Some(set), None, false) => Ok(Some(set)),
        (None, Some(at), false) => {
            let found = face_set_jobs::set_seen(&host.published.load(), Vec2::from(at));
            found.map(Some).ok_or_else(|| RpcError::failed("nothing is seen there"))
        }
        (None, None, true) => Ok(None),
        _ => Err(RpcError::bad_params("expected one of `set`, `at` and `masked`")),
    }
}

pub(super) fn hide(host: &Host, p: &FaceSetParams) -> SetsDone {
    edit(host, named(host, p)?.map_or(SetsEdit::HideMasked, SetsEdit::Hide))
}

pub(super) fn isolate(host: &Host, p: &FaceSetParams) -> SetsDone {
    let set = named(host, p)?;
    let masked = || RpcError::bad_params("expected one of `set` and `at`");
    edit(host, SetsEdit::Isolate(set.ok_or_else(masked)?))
}

pub(super) fn rename(host: &Host, p: FaceSetNameParams) -> SetsDone {
    ask(host, SceneCommand::NameSet(p.set, p.name.unwrap_or_default()))?;
    Ok(FaceSetReply { set: Some(p.set), made: 0 })
}

pub(super) fn extract(host: &Host, p: &FaceSetExtractParams) -> Result<ObjectReply, RpcError> {
    let part = p.set.map_or(FaceSetPart::Masked, FaceSetPart::Set);
    let (name, place) = (p.name.as_deref().unwrap_or("extract"), host.jobs.begin());
    let job = &*place.job;
    let extract = |now: &Published| face_set_jobs::extract(now, part, p.thickness, name, job);
    let done = host.operate(job, extract)?;
    Ok(ObjectReply { id: object_of(done.answer), warnings: Vec::new() })
}
