//! What the methods of the scene do.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::host::{Host, MAX_MESH_FILE, failed};
use crate::Published;
use crate::command_queue::QueuedCommand;
use crate::operations::Computed;
use crate::scene_jobs::{self, Combined, Selection};
use crate::startup;
use sculptd_clay::Clay;
use sculptd_control::RpcError;
use sculptd_control::edit::{ExportReply, LoadReply, Operation as AskedOperation};
use sculptd_control::scene::{
    AddParams, CombineReply, ExportObjects, ExportParams, FollowedBoolean, MirrorParams,
    ObjectInfo, ObjectReply, Placement, PrimitiveShape as AskedShape, ReshapeParams, SceneReply,
    TransformParams, WorldAxis,
};
use sculptd_devices::Clock;
use sculptd_engine::answer::Answer;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{
    NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, PrimitiveShape, SceneCommand,
};
use sculptd_geometry::boolean;
use sculptd_geometry::io::write_scene;
use sculptd_geometry::job::Job;

fn placed(asked: &Placement) -> Result<ObjectTransform, RpcError> {
    let turn = DQuat::from_array(asked.turn);
    let transform = ObjectTransform {
        shift: DVec3::from_array(asked.shift),
        turn: if turn.length() > 1e-6 { turn.normalize() } else { DQuat::NAN },
        scale: asked.scale,
    };
    let bad = || RpcError::bad_params("transform.turn: expected a rotation, not four zeros");
    transform.is_sane().then_some(transform).ok_or_else(bad)
}

pub(super) fn placement(transform: &ObjectTransform) -> Placement {
    Placement {
        shift: transform.shift.to_array(),
        turn: transform.turn.to_array(),
        scale: transform.scale,
    }
}

fn shape(asked: AskedShape) -> PrimitiveShape {
    match asked {
        AskedShape::Box(n) => PrimitiveShape::Box(n),
        AskedShape::Ball(n) => PrimitiveShape::Ball(n),
        AskedShape::Cylinder(n) => PrimitiveShape::Cylinder(n),
        AskedShape::Cone(n) => PrimitiveShape::Cone(n),
        AskedShape::Torus(n) => PrimitiveShape::Torus(n),
        AskedShape::Tube(n) => PrimitiveShape::Tube(n),
        AskedShape::Plane(n) => PrimitiveShape::Plane(n),
    }
}

fn shape_reply(shape: PrimitiveShape) -> AskedShape {
    match shape {
        PrimitiveShape::Box(n) => AskedShape::Box(n),
        PrimitiveShape::Ball(n) => AskedShape::Ball(n),
        PrimitiveShape::Cylinder(n) => AskedShape::Cylinder(n),
        PrimitiveShape::Cone(n) => AskedShape::Cone(n),
        PrimitiveShape::Torus(n) => AskedShape::Torus(n),
        PrimitiveShape::Tube(n) => AskedShape::Tube(n),
        PrimitiveShape::Plane(n) => AskedShape::Plane(n),
    }
}

fn operation_reply(operation: boolean::Operation) -> AskedOperation {
    match operation {
        boolean::Operation::Union => AskedOperation::Union,
        boolean::Operation::Intersection => AskedOperation::Intersection,
        boolean::Operation::Difference => AskedOperation::Difference,
        boolean::Operation::ReverseDifference => AskedOperation::ReverseDifference,
    }
}

/// Every object.
pub(super) fn list(shown: &Published) -> SceneReply {
    let scene = &shown.scene;
    let info = |(i, (o, clay)): (usize, (&sculptd_engine::scene::ObjectView, &_))| {
        let clay: &sculptd_clay::Snapshot = clay;
        let (lo, hi) = o.settings.transform.bounds(clay.bounds());
        ObjectInfo {
            id: o.id.0,
            name: o.settings.name.clone(),
            active: i == scene.active,
            visible: o.settings.visible,
            locked: o.settings.locked,
            transform: placement(&o.settings.transform),
            primitive: o
                .settings
                .primitive
                .filter(|_| clay.revision() == 0)
                .map(|p| shape_reply(p.shape)),
            vertices: clay.vertex_count() as u64,
            triangles: clay.triangle_count() as u64,
            bounds: [lo.to_array(), hi.to_array()],
            group: Some(o.settings.group.clone()).filter(|g| !g.is_empty()),
            follows: o.live(clay).map(|live| FollowedBoolean {
                operation: operation_reply(live.operation),
                a: live.operands[0].id.0,
                b: live.operands[1].id.0,
            }),
        }
    };
    let objects = scene.each(&shown.mesh).enumerate().map(info).collect();
    SceneReply { active: scene.active().map_or(0, |o| o.id.0), objects }
}

/// Hands a command to the loop and waits for what came of it.
pub(super) fn ask(
    host: &Host,
    command: impl Into<QueuedSceneCommand>,
) -> Result<ObjectReply, RpcError> {
    let QueuedSceneCommand { command, payload } = command.into();
    let queued = QueuedCommand { payload, ..QueuedCommand::from(Command::Scene(command)) };
    Ok(ObjectReply { id: object_of(host.carry_out(queued)?), warnings: Vec::new() })
}

/// The number of the object that a command made or was about.
pub(super) fn object_of(answer: Answer) -> u32 {
    answer.object().map_or(0, |id| id.0)
}

/// A command to the scene with what it needs.
pub(super) struct QueuedSceneCommand {
    pub(super) command: SceneCommand,
    pub(super) payload: Option<Payload>,
}

impl From<SceneCommand> for QueuedSceneCommand {
    fn from(command: SceneCommand) -> Self {
        QueuedSceneCommand { command, payload: None }
    }
}

fn primitive(
    asked: AskedShape,
    edge: Option<f64>,
    job: &Job,
) -> Result<(Primitive, Clay), RpcError> {
    let shape = shape(asked);
    let primitive = Primitive { shape, edge: edge.unwrap_or_else(|| shape.usual_edge()) };
    let bad = |e: &dyn std::fmt::Display| RpcError::bad_params(format!("primitive: {e}"));
    let plain = primitive.triangles().map_err(|e| bad(&e))?;
    let clay = Clay::build(&plain, job).map_err(|e| bad(&e))?;
    Ok((primitive, clay))
}

pub(super) fn add(host: &Host, params: &AddParams) -> Result<ObjectReply, RpcError> {
    let mut transform = params.transform.as_ref().map_or(Ok(ObjectTransform::NONE), placed)?;
    let (mut layers, place) = (None, host.jobs.begin());
    let (source, clay, name, warnings) = match (params.primitive, &params.path, params.held) {
        (None, None, true) => {
            let held = host.published.load().thing.clone();
            let held = held.ok_or_else(|| RpcError::failed("nothing is in the hands"))?;
            let clay = Clay::build(&held.plain, &place.job).map_err(failed)?;
            // A transform in the request replaces that of the hands.
            if params.transform.is_none() {
                transform = held.place.to_object();
            }
            (ObjectSource::Mesh(held.plain), clay, "held object".into(), Vec::new())
        }
        (Some(asked), None, false) => {
            let (primitive, clay) = primitive(asked, params.edge, &place.job)?;
            let name = primitive.shape.name().to_owned();
            (ObjectSource::Primitive(primitive), clay, name, Vec::new())
        }
        (None, Some(path), false) => {
            let loaded = startup::load_within(path, MAX_MESH_FILE, &place.job).map_err(failed)?;
            layers = scene_jobs::layers_of(&loaded.targets);
            let source = ObjectSource::Mesh(loaded.plain.into());
            (source, loaded.mesh, startup::object_name(path), loaded.warnings)
        }
        _ => return Err(RpcError::bad_params("expected one of `primitive`, `path` and `held`")),
    };
    let new = NewObject::new(params.name.as_deref().unwrap_or(&name), source, transform);
    let command = SceneCommand::Add(new);
    let payload = Some(Payload::Clay(Box::new(clay)));
    let reply = ask(host, QueuedSceneCommand { command, payload })?;
    if params.held {
        host.carry_out(Command::PutDown)?;
    }
    if let Some(layers) = layers {
        ask(host, SceneCommand::Layers(layers))?;
    }
    Ok(ObjectReply { warnings, ..reply })
}

pub(super) fn reshape(host: &Host, params: &ReshapeParams) -> Result<ObjectReply, RpcError> {
    let place = host.jobs.begin();
    let (primitive, clay) = primitive(params.primitive, params.edge, &place.job)?;
    let name = primitive.shape.name();
    let source = ObjectSource::Primitive(primitive);
    let new = NewObject::new(name, source, ObjectTransform::NONE);
    let command = SceneCommand::Reshape(ObjectId(params.id), new);
    ask(host, QueuedSceneCommand { command, payload: Some(Payload::Clay(Box::new(clay))) })
}

pub(super) fn transform(host: &Host, params: &TransformParams) -> Result<ObjectReply, RpcError> {
    let (id, mut transform) = (ObjectId(params.id), placed(&params.transform)?);
    if params.relative {
        let shown = host.published.load();
        let object = shown.scene.object(id);
        let object = object.ok_or_else(|| failed(format!("there is no object {id}")))?;
        transform = object.settings.transform.then(&transform);
    }
    ask(host, SceneCommand::Transform(id, transform))
}

/// Carries out what makes new objects of others.
pub(super) fn combine(
    host: &Host,
    of: impl Fn(&Published, &Job) -> Result<Combined, scene_jobs::CombineError>,
) -> Result<CombineReply, RpcError> {
    let place = host.jobs.begin_operation()?;
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let done = host.operate(&place.job, |shown| {
        let combined = of(shown, &place.job)?;
        let operands = || {
            let all = shown.scene.each(&shown.mesh);
            all.filter(|(o, _)| combined.exchange.from.iter().any(|f| f.id == o.id)).map(|o| o.1)
        };
        let layers =
            |clay: &sculptd_clay::Snapshot| clay.layers().map_or(0, |s| s.layers.len() as u64);
        let made = CombineReply {
            id: 0,
            objects: combined.clays.len() as u64,
            vertices: combined.clays.iter().map(|c| c.vertex_count() as u64).sum(),
            seconds: 0.0,
            layers_baked: operands().map(layers).sum(),
            sets_dropped: operands().map(|clay| clay.face_set_count()).sum(),
        };
        Ok(Computed::of_combined(shown, combined, made))
    })?;
    let seconds = (clock.now_us() - begun) as f64 * 1e-6;
    Ok(CombineReply { id: object_of(done.answer), seconds, ..done.made })
}

/// Replaces the active object with a mesh; its morph targets become layers.
pub(super) fn load(host: &Host, loaded: startup::Loaded) -> Result<LoadReply, RpcError> {
    let vertices = loaded.mesh.vertex_count() as u64;
    let command = Command::Replace(NewClay::new(Arc::new(loaded.plain), false));
    let built = Payload::Clay(Box::new(loaded.mesh));
    host.carry_out(QueuedCommand::with_payload(command, built))?;
    if let Some(targets) = scene_jobs::layers_of(&loaded.targets) {
        ask(host, SceneCommand::Layers(targets))?;
    }
    Ok(LoadReply { vertices, warnings: loaded.warnings })
}

pub(super) fn mirror(host: &Host, params: MirrorParams) -> Result<CombineReply, RpcError> {
    let axis = match params.axis {
        WorldAxis::X => 0,
        WorldAxis::Y => 1,
        WorldAxis::Z => 2,
    };
    combine(host, |shown, job| scene_jobs::mirror(shown, ObjectId(params.id), axis, job))
}

pub(super) fn export(host: &Host, params: ExportParams) -> Result<ExportReply, RpcError> {
    let place = host.jobs.begin();
    let shown = host.published.load_full();
    let which = match params.objects {
        None | Some(ExportObjects::Visible) => Selection::Visible,
        Some(ExportObjects::Active) => Selection::Active,
        Some(ExportObjects::All) => Selection::All,
        Some(ExportObjects::Object(id)) => Selection::One(ObjectId(id)),
    };
    let meshes = scene_jobs::selected(&shown.scene, &shown.mesh, which).map_err(failed)?;
    let warnings = write_scene(&params.path, &meshes, &place.job).map_err(failed)?;
    let vertices = meshes.iter().map(|m| m.mesh.positions.len() as u64).sum();
    Ok(ExportReply { path: params.path, tick: shown.tick, vertices, warnings })
}
