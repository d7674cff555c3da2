//! What each method does. It runs on the client's thread: slow work here delays that client only.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::face_sets::{self, SetsDone};
pub use super::host::MAX_MESH_FILE;
use super::host::{Host, failed};
use super::joining::boolean;
use super::layers::{self, LayerDone};
use super::snap::operation;
use super::status_reply::{self, convert, other_version};
use super::stroke::LentBrush;
use super::view_region::mask_region;
use super::{guests_reply, history, mask, measurement, people_reply, repairs};
use super::{retopology, scene, snap};
use crate::trim::Part;
use crate::window_link::DisplayVariables;
use crate::{Published, boolean_jobs, scene_jobs, startup, trim};
use sculptd_clay::brush::{self, BrushKind, Picture};
use sculptd_clay::face_sets::SetsEdit;
use sculptd_clay::{LayerEdit, LayerId};
use sculptd_control::brush as asked;
use sculptd_control::edit::{self, LevelStep, TrimRegion};
use sculptd_control::face_sets as asked_sets;
use sculptd_control::guests;
use sculptd_control::layers::{self as asked_layers, LayerParams};
use sculptd_control::method::{self, METHODS};
use sculptd_control::people::PeopleReply;
use sculptd_control::repair::{RepairParams, RepairReply};
use sculptd_control::retopology::{
    DecimateParams, DecimateReply, RemeshLocalParams, RemeshLocalReply, RemeshQuadsParams,
    RemeshQuadsReply, SymmetriseParams, SymmetriseReply,
};
use sculptd_control::scene::{self as asked_scene, ObjectParams};
use sculptd_control::snap::{SnapParams, SnapReply};
use sculptd_control::status::{self, NoParams, SentReply, Versions};
use sculptd_control::view::{CameraSettings, ReachParams, ReachReply};
use sculptd_control::{Handler, Request, RpcError, event};
use sculptd_engine::command::Command;
use sculptd_engine::hand::ReachBox;
use sculptd_engine::scene::{ObjectId, SceneCommand};
use sculptd_engine::stroke::CurveAction;
use sculptd_geometry::io::{read_in_millimetres, read_regular};
use sculptd_geometry::job::Job;
use sculptd_geometry::repair;

/// Longest picture file, bytes.
pub const MAX_PICTURE_FILE: u64 = 256 << 20;

const SENT: SentReply = SentReply { sent: true };

/// Result of a method that acts on one object.
type ObjectDone = Result<asked_scene::ObjectReply, RpcError>;
type CombineDone = Result<asked_scene::CombineReply, RpcError>;

/// Answers one request by its name.
///
/// # Errors
/// As [`Request::read`], and the error of the method.
pub fn call(host: &Host, name: &str, params: Value) -> Result<Value, RpcError> {
    method::answer(host, Request::read(name, params)?)
}

/// Lays the named fields over what is in force. An unknown field is refused by its name.
fn merge<T: Serialize + DeserializeOwned>(now: &T, named: impl Serialize) -> Result<T, RpcError> {
    let bad = |e: serde_json::Error| RpcError::bad_params(e.to_string());
    let mut all = serde_json::to_value(now).map_err(bad)?;
    if let Value::Object(named) = serde_json::to_value(named).map_err(bad)? {
        for (key, value) in named {
            all[key] = value;
        }
    }
    serde_json::from_value(all).map_err(bad)
}

/// Returns the brush in hand with the named settings applied. A named brush starts from its preset;
/// the other named settings are applied over it. A user brush may also bring a picture.
fn merged_brush(
    presets: &brush::Presets,
    shown: &Published,
    named: &asked::BrushSettings,
) -> Result<(brush::BrushSettings, Option<Arc<Picture>>), RpcError> {
    if let Some(own) = named.kind.as_deref().and_then(|name| presets.own_of(name)) {
        let rest = asked::BrushSettings { kind: None, ..named.clone() };
        let taken = presets.taken(&shown.brush, &shown.kept_brushes, &own);
        let brush: brush::BrushSettings = merge(&taken, rest)?;
        brush.check().map_err(RpcError::bad_params)?;
        return Ok((brush.clamped(), own.picture));
    }
    let other = named.kind.as_deref().map(str::parse::<BrushKind>).transpose();
    let other = other.map_err(RpcError::bad_params)?;
    // Who names the preset as well has asked for all settings and sends them back.
    let whole = named.others.contains_key("preset");
    let here = |k: BrushKind| k == shown.brush.kind && (whole || shown.brush.preset == 0);
    let base = match other.filter(|k| !here(*k)) {
        Some(kind) => presets.recalled(&shown.brush, &shown.kept_brushes, kind),
        None => shown.brush,
    };
    let brush: brush::BrushSettings = merge(&base, named)?;
    brush.check().map_err(RpcError::bad_params)?;
    Ok((brush.clamped(), None))
}

/// A path from outside: absolute, and no link at its end.
fn safe(path: &Path) -> Result<(), RpcError> {
    if !path.is_absolute() || path.components().any(|c| c == std::path::Component::ParentDir) {
        return Err(RpcError::bad_params("path: expected an absolute path without '..'"));
    }
    if path.symlink_metadata().is_ok_and(|m| m.file_type().is_symlink()) {
        return Err(RpcError::bad_params("path: expected a file, found a symbolic link"));
    }
    Ok(())
}

fn load(path: &Path, job: &Job) -> Result<startup::Loaded, RpcError> {
    safe(path)?;
    startup::load_within(path, MAX_MESH_FILE, job).map_err(failed)
}

impl Handler for Host {
    fn hello(&self, params: status::HelloParams) -> Result<status::HelloReply, RpcError> {
        let theirs = params.versions.unwrap_or(Versions::OURS);
        let protocol = Versions::OURS.newest_in_common(theirs);
        let protocol = protocol.ok_or_else(|| other_version(theirs))?;
        let version = env!("CARGO_PKG_VERSION").into();
        Ok(status::HelloReply { protocol, versions: Versions::OURS, version })
    }

    fn methods(&self, _: NoParams) -> Result<status::MethodsReply, RpcError> {
        Ok(METHODS.iter().map(|m| (m.name.into(), m.about.into())).collect())
    }

    fn status(&self, params: status::StatusParams) -> Result<status::StatusReply, RpcError> {
        status_reply::status(self, &params)
    }

    fn brush(&self, named: asked::BrushSettings) -> Result<asked::BrushSettings, RpcError> {
        let (brush, picture) = merged_brush(&self.presets, &self.published.load(), &named)?;
        if let Some(picture) = picture {
            self.carry_out(Command::Picture(picture))?;
        }
        // A question changes nothing: the answer may be older than what another has just sent.
        if named != asked::BrushSettings::default() {
            self.carry_out(Command::Brush(brush))?;
        }
        convert(brush)
    }

    fn brushes(&self, _: NoParams) -> Result<asked::BrushesReply, RpcError> {
        let all = BrushKind::ALL.iter().map(|kind| {
            let preset = self.presets.get(*kind);
            Ok(asked::BrushInfo {
                name: kind.name().into(),
                about: preset.about().into(),
                settings: convert(preset.settings())?,
                extra: convert(kind.own_numbers())?,
                own: false,
            })
        });
        let own = self.presets.own();
        let own = own.iter().map(|own| {
            Ok(asked::BrushInfo {
                name: own.name.clone(),
                about: own.about.clone(),
                settings: convert(own.settings)?,
                extra: convert(own.settings.kind.own_numbers())?,
                own: true,
            })
        });
        all.chain(own).collect()
    }

    fn picture(&self, params: asked::PathParams) -> Result<asked::PictureReply, RpcError> {
        safe(&params.path)?;
        let named = |e: &dyn std::fmt::Display| failed(format!("{}: {e}", params.path.display()));
        let bytes = read_regular(&params.path, MAX_PICTURE_FILE).map_err(|e| named(&e))?;
        let picture = Picture::decode(&bytes).map_err(|e| named(&e))?;
        let size = asked::PictureReply { width: picture.width, height: picture.height };
        self.carry_out(Command::Picture(Arc::new(picture)))?;
        Ok(size)
    }

    fn mask(&self, params: asked::MaskParams) -> Result<SentReply, RpcError> {
        let command = Command::Mask(convert(params.action)?);
        self.carry_out(command)?;
        Ok(SENT)
    }

    fn mask_measured(
        &self,
        params: asked::MaskMeasuredParams,
    ) -> Result<asked::MaskMeasuredReply, RpcError> {
        mask::measured(self, params)
    }

    fn mask_region(&self, params: asked::MaskRegionParams) -> Result<SentReply, RpcError> {
        let command = Command::MaskRegion(mask_region(params)?);
        self.carry_out(command)?;
        Ok(SENT)
    }

    fn curve(&self, params: asked::CurveParams) -> Result<asked::CurveReply, RpcError> {
        let points = self.published.load().draft.points().len() as u64;
        self.carry_out(Command::CurveStroke(match params.act {
            asked::CurveAction::Apply => CurveAction::Apply,
            asked::CurveAction::Cancel => CurveAction::Cancel,
            asked::CurveAction::Delete(handle) => CurveAction::Delete(handle as usize),
        }))?;
        Ok(asked::CurveReply { sent: true, points })
    }

    fn stroke(&self, params: asked::StrokeParams) -> Result<asked::StrokeReply, RpcError> {
        params.check()?;
        let pen = self.pen.as_ref().ok_or_else(|| failed("this run has no pen for strokes"))?;
        let shown = self.published.load_full();
        let brush = params.brush.as_ref().map(|b| merged_brush(&self.presets, &shown, b));
        let brush = brush.transpose()?;
        // With the settings that the other brush had, to be put back after the stroke.
        let brush = brush.map(|(settings, picture)| {
            let key = settings.key();
            let kept = || self.presets.kept(&shown.brush, &shown.kept_brushes, key);
            LentBrush { settings, picture, kept: (key != shown.brush.key()).then(kept) }
        });
        let link = self.link();
        match pen.try_lock() {
            Ok(mut pen) => pen.draw(link, &params, brush),
            Err(std::sync::TryLockError::Poisoned(pen)) => {
                pen.into_inner().draw(link, &params, brush)
            }
            Err(std::sync::TryLockError::WouldBlock) => Err(failed("another stroke is under way")),
        }
    }

    fn camera(&self, named: CameraSettings) -> Result<CameraSettings, RpcError> {
        let asks = named == CameraSettings::default();
        let camera: sculptd_engine::camera::Camera = merge(&self.published.load().camera, named)?;
        if !camera.is_sane() {
            return Err(RpcError::bad_params("no view can be made of this camera"));
        }
        if !asks {
            self.carry_out(Command::Camera(camera))?;
        }
        convert(camera)
    }

    fn undo(&self, _: NoParams) -> Result<SentReply, RpcError> {
        history::go(self, Command::Undo)?;
        Ok(SENT)
    }

    fn redo(&self, _: NoParams) -> Result<SentReply, RpcError> {
        history::go(self, Command::Redo)?;
        Ok(SENT)
    }

    fn history(&self, _: NoParams) -> Result<edit::HistoryReply, RpcError> {
        history::list(self)
    }

    fn jump(&self, params: edit::JumpParams) -> Result<SentReply, RpcError> {
        history::jump(self, params.node)?;
        Ok(SENT)
    }

    fn load(&self, params: asked::PathParams) -> Result<edit::LoadReply, RpcError> {
        scene::load(self, load(&params.path, &self.jobs.begin().job)?)
    }

    fn export(&self, params: asked_scene::ExportParams) -> Result<edit::ExportReply, RpcError> {
        safe(&params.path)?;
        scene::export(self, params)
    }

    fn people(&self, _: NoParams) -> Result<PeopleReply, RpcError> {
        Ok(people_reply::people(&self.published.load()))
    }

    fn guests_list(&self, _: NoParams) -> Result<guests::GuestsReply, RpcError> {
        Ok(guests_reply::list(self))
    }

    fn guests_invite(&self, p: guests::GuestInviteParams) -> Result<guests::GuestLink, RpcError> {
        guests_reply::invite(self, &p)
    }

    fn guests_revoke(
        &self,
        p: guests::GuestRevokeParams,
    ) -> Result<guests::GuestRevokeReply, RpcError> {
        guests_reply::revoke(self, &p)
    }

    fn scene_list(&self, _: NoParams) -> Result<asked_scene::SceneReply, RpcError> {
        Ok(scene::list(&self.published.load()))
    }

    fn scene_add(&self, p: asked_scene::AddParams) -> ObjectDone {
        p.path.as_deref().map_or(Ok(()), safe)?;
        scene::add(self, &p)
    }

    fn scene_remove(&self, p: ObjectParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Remove(ObjectId(p.id)))
    }

    fn scene_duplicate(&self, p: ObjectParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Duplicate(ObjectId(p.id)))
    }

    fn scene_rename(&self, p: asked_scene::RenameParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Rename(ObjectId(p.id), p.name))
    }

    fn scene_transform(&self, p: asked_scene::TransformParams) -> ObjectDone {
        scene::transform(self, &p)
    }

    fn scene_activate(&self, p: ObjectParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Activate(ObjectId(p.id)))
    }

    fn scene_show(&self, p: asked_scene::ShowParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Show(ObjectId(p.id), p.visible))
    }

    fn scene_lock(&self, p: asked_scene::LockParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Lock(ObjectId(p.id), p.locked))
    }

    fn scene_reshape(&self, p: asked_scene::ReshapeParams) -> ObjectDone {
        scene::reshape(self, &p)
    }

    fn scene_snap(&self, p: SnapParams) -> Result<SnapReply, RpcError> {
        snap::snap(self, &p)
    }

    fn scene_boolean(&self, p: asked_scene::SceneBooleanParams) -> CombineDone {
        snap::boolean(self, &p)
    }

    fn scene_apply(&self, p: ObjectParams) -> ObjectDone {
        scene::ask(self, SceneCommand::ApplyLive(ObjectId(p.id)))
    }

    fn scene_mirror(&self, p: asked_scene::MirrorParams) -> CombineDone {
        scene::mirror(self, p)
    }

    fn scene_move(&self, p: asked_scene::MoveParams) -> ObjectDone {
        scene::ask(self, SceneCommand::Move(ObjectId(p.id), p.to))
    }

    fn scene_group(&self, p: asked_scene::GroupParams) -> ObjectDone {
        let ids = p.ids.into_iter().map(ObjectId).collect();
        scene::ask(self, SceneCommand::Group(ids, p.name.unwrap_or_default()))
    }

    fn scene_merge(&self, p: asked_scene::MergeParams) -> CombineDone {
        let ids: Vec<ObjectId> = p.ids.iter().map(|id| ObjectId(*id)).collect();
        scene::combine(self, |shown, job| scene_jobs::merge(shown, &ids, job))
    }

    fn scene_split(&self, p: ObjectParams) -> CombineDone {
        scene::combine(self, |shown, job| scene_jobs::split(shown, ObjectId(p.id), job))
    }

    fn layers_list(&self, _: NoParams) -> Result<asked_layers::LayersReply, RpcError> {
        Ok(layers::list(&self.published.load()))
    }

    fn layers_add(&self, p: asked_layers::LayerAddParams) -> LayerDone {
        layers::add(self, p)
    }

    fn layers_remove(&self, p: LayerParams) -> LayerDone {
        layers::edit(self, LayerEdit::Remove(LayerId(p.layer)))
    }

    fn layers_rename(&self, p: asked_layers::LayerRenameParams) -> LayerDone {
        layers::edit(self, LayerEdit::Rename(LayerId(p.layer), p.name))
    }

    fn layers_move(&self, p: asked_layers::LayerMoveParams) -> LayerDone {
        layers::edit(self, LayerEdit::Move(LayerId(p.layer), p.to))
    }

    fn layers_set(&self, p: asked_layers::LayerSetParams) -> LayerDone {
        layers::set(self, p)
    }

    fn layers_activate(&self, p: asked_layers::LayerActivateParams) -> LayerDone {
        layers::edit(self, LayerEdit::Activate(p.layer.map(LayerId)))
    }

    fn layers_merge(&self, p: LayerParams) -> LayerDone {
        layers::edit(self, LayerEdit::MergeDown(LayerId(p.layer)))
    }

    fn layers_duplicate(&self, p: LayerParams) -> LayerDone {
        layers::edit(self, LayerEdit::Duplicate(LayerId(p.layer)))
    }

    fn layers_clear(&self, p: LayerParams) -> LayerDone {
        layers::edit(self, LayerEdit::Clear(LayerId(p.layer)))
    }

    fn sets_list(&self, _: NoParams) -> Result<asked_sets::FaceSetsReply, RpcError> {
        Ok(face_sets::list(&self.published.load()))
    }

    fn sets_rename(&self, p: asked_sets::FaceSetNameParams) -> SetsDone {
        face_sets::rename(self, p)
    }

    fn sets_make(&self, p: asked_sets::FaceSetMakeParams) -> SetsDone {
        face_sets::make(self, p)
    }

    fn sets_clear(&self, _: NoParams) -> SetsDone {
        face_sets::edit(self, SetsEdit::Clear)
    }

    fn sets_hide(&self, p: asked_sets::FaceSetParams) -> SetsDone {
        face_sets::hide(self, &p)
    }

    fn sets_show(&self, p: asked_sets::FaceSetShowParams) -> SetsDone {
        face_sets::edit(self, p.set.map_or(SetsEdit::ShowAll, SetsEdit::Show))
    }

    fn sets_invert(&self, _: NoParams) -> SetsDone {
        face_sets::edit(self, SetsEdit::Invert)
    }

    fn sets_isolate(&self, p: asked_sets::FaceSetParams) -> SetsDone {
        face_sets::isolate(self, &p)
    }

    fn sets_region(&self, p: asked_sets::FaceSetRegionParams) -> SetsDone {
        face_sets::region(self, p)
    }

    fn sets_extract(&self, p: asked_sets::FaceSetExtractParams) -> ObjectDone {
        face_sets::extract(self, &p)
    }

    fn layers_bake(&self, _: NoParams) -> LayerDone {
        layers::edit(self, LayerEdit::Bake)
    }

    fn hash(&self, _: NoParams) -> Result<edit::HashReply, RpcError> {
        let shown = self.published.load_full();
        Ok(edit::HashReply { tick: shown.tick, hash: format!("{:016x}", shown.hash()) })
    }

    fn thickness(&self, params: edit::ThicknessParams) -> Result<edit::ThicknessReply, RpcError> {
        measurement::thickness(self, &params)
    }

    fn take_up(&self, params: asked::PathParams) -> Result<edit::TakeUpReply, RpcError> {
        let loaded = load(&params.path, &self.jobs.begin().job)?;
        let triangles = loaded.plain.triangles.len() as u64;
        self.carry_out(Command::TakeUp(Arc::new(loaded.plain)))?;
        Ok(edit::TakeUpReply { triangles, warnings: loaded.warnings })
    }

    fn put_down(&self, _: NoParams) -> Result<SentReply, RpcError> {
        self.carry_out(Command::PutDown)?;
        Ok(SENT)
    }

    fn join(&self, params: edit::JoinParams) -> Result<edit::BooleanReply, RpcError> {
        let operation = operation(params.operation);
        let place = self.jobs.begin_operation()?;
        boolean(self, &place, |to, job| boolean_jobs::join_held(to, operation, job))
    }

    fn trim(&self, params: edit::TrimParams) -> Result<edit::BooleanReply, RpcError> {
        let part = match params.part {
            TrimRegion::Box(corners) => Part::Box(corners),
            TrimRegion::Line(ends) => Part::Line(ends),
        };
        let place = self.jobs.begin_operation()?;
        boolean(self, &place, |to, job| trim::carry_out(to, &part, job))
    }

    fn level(&self, params: edit::LevelParams) -> Result<edit::LevelReply, RpcError> {
        let finer = params.to == LevelStep::Up;
        let place = self.jobs.begin_operation()?;
        let (layers_baked, sets_dropped) = (layers::count(self), face_sets::count(self));
        let done = self.operate(&place.job, |now| boolean_jobs::level(now, finer, &place.job))?;
        let (level, levels) = done.made;
        let (level, levels) = (level as u64, levels as u64);
        Ok(edit::LevelReply { level, levels, layers_baked, sets_dropped })
    }

    fn remesh(&self, params: edit::RemeshParams) -> Result<edit::RemeshReply, RpcError> {
        retopology::remesh(self, params)
    }

    fn remesh_quads(&self, params: RemeshQuadsParams) -> Result<RemeshQuadsReply, RpcError> {
        retopology::remesh_quads(self, params)
    }

    fn remesh_local(&self, params: RemeshLocalParams) -> Result<RemeshLocalReply, RpcError> {
        retopology::remesh_local(self, params)
    }

    fn symmetrise(&self, params: SymmetriseParams) -> Result<SymmetriseReply, RpcError> {
        retopology::symmetrise(self, params)
    }

    fn decimate(&self, params: DecimateParams) -> Result<DecimateReply, RpcError> {
        retopology::decimate(self, params)
    }

    fn repair(&self, params: RepairParams) -> Result<RepairReply, RpcError> {
        repairs::repair(self, &params)
    }

    fn boolean(&self, params: edit::BooleanParams) -> Result<edit::BooleanReply, RpcError> {
        safe(&params.path)?;
        let place = self.jobs.begin_operation()?;
        let read = read_in_millimetres(&params.path, MAX_MESH_FILE, &place.job);
        let mut tool = read.map_err(failed)?.mesh;
        repair::weld(&mut tool, 0.0);
        tool.positions.iter_mut().for_each(|x| *x += glam::DVec3::from(params.at));
        let (given, operation) = (|_: &Published| Ok(tool.clone()), operation(params.operation));
        boolean(self, &place, |to, job| boolean_jobs::carry_out(to, given, false, operation, job))
    }

    fn progress(&self, _: NoParams) -> Result<edit::ProgressReply, RpcError> {
        let done = self.jobs.done();
        Ok(edit::ProgressReply { running: done.is_some(), done })
    }

    fn cancel(&self, _: NoParams) -> Result<edit::CancelReply, RpcError> {
        Ok(edit::CancelReply { cancelled: self.jobs.cancel() })
    }

    fn reach(&self, params: ReachParams) -> Result<ReachReply, RpcError> {
        let reach = match (params.middle_mm, params.half_mm) {
            (None, None) => None,
            (Some(middle), Some(half_mm)) => Some(ReachBox { middle_mm: middle.into(), half_mm }),
            _ => return Err(RpcError::bad_params("expected both middle_mm and half_mm, or none")),
        };
        if reach.is_some_and(|r| !r.is_sane()) {
            let text = "expected a place within 2 m and half a side of 30 to 1000 mm";
            return Err(RpcError::bad_params(text));
        }
        self.carry_out(reach.map_or(Command::CalibrateReach, Command::Reach))?;
        Ok(ReachReply { measuring: reach.is_none() })
    }

    fn subscribe(&self, _: NoParams) -> Result<event::SubscribeReply, RpcError> {
        let events = event::EventName::ALL.into();
        Ok(event::SubscribeReply { events })
    }

    fn window(&self, params: status::WindowParams) -> Result<status::WindowReply, RpcError> {
        let named = [
            ("DISPLAY", params.display),
            ("WAYLAND_DISPLAY", params.wayland_display),
            ("XAUTHORITY", params.xauthority),
        ];
        let given = |(name, value): (&str, Option<String>)| value.map(|v| (name.to_owned(), v));
        let screen: DisplayVariables = named.into_iter().filter_map(given).collect();
        if !screen.keys().any(|k| k.ends_with("DISPLAY")) {
            return Err(RpcError::bad_params("expected `display` or `wayland_display`"));
        }
        let session = self.window.want(screen).map_err(|e| failed(e.to_string()))?;
        self.stop.store(true, Relaxed);
        Ok(status::WindowReply { session: session.display().to_string() })
    }

    fn shutdown(&self, _: NoParams) -> Result<status::ShutdownReply, RpcError> {
        self.stop.store(true, Relaxed);
        Ok(status::ShutdownReply { stopping: true })
    }
}
