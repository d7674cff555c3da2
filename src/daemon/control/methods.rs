//! What can be asked. The names and parameters here are the schema; `methods` lists them to any
//! client.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::PROTOCOL;
use super::protocol::{Code, RpcError};
use super::server::Host;
use crate::command_queue::QueuedCommand;
use crate::session::history::{Handle, Want, listing};
use crate::{Published, boolean_jobs, startup, trim};
use sculptd_clay::Snapshot;
use sculptd_clay::brush::{BrushKind, MaskAction, Picture};
use sculptd_clay::live_thickness::LiveMap;
use sculptd_devices::Clock;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::hand::{MenuItem, ReachBox};
use sculptd_engine::payload::Payload;
use sculptd_engine::stroke::CurveAction;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::io::{read_mesh, write_mesh};
use sculptd_geometry::job::Job;
use sculptd_geometry::repair;

/// Every method with its parameters, for `methods` and for the schema test.
pub const METHODS: &[(&str, &str)] = &[
    ("methods", "{}: this list"),
    (
        "status",
        "{version?}: the loop's figures, the work, the brush, the journal and what stands in its way",
    ),
    (
        "brush",
        "{kind?, radius?, strength?, negative?, spacing?, ... as in the configuration's [brush]}: another kind comes with its own settings; changes what is named, answers with all",
    ),
    ("brushes", "{}: every brush, what it does, its own numbers"),
    (
        "picture",
        "{path}: loads a picture of heights (PNG, TIFF, EXR) for brushes with the alpha picture",
    ),
    (
        "mask",
        "{action: clear|fill|invert|blur|sharpen|grow|shrink|{cavity: 0..1}}: the whole work's mask",
    ),
    (
        "curve",
        "{act: apply|cancel|{delete: n}}: the curve that a pen has laid is drawn, put away, or loses its handle n, from 0",
    ),
    ("camera", "{target?, yaw?, pitch?, distance?, fov_y?, aspect?, orthographic?}: likewise"),
    ("undo", "{}: takes back one step"),
    ("redo", "{}: does it again"),
    ("history", "{}: every place that the work was at, branches too, as the session keeps them"),
    ("jump", "{node}: back or forth to a place of the history"),
    ("load", "{path}: another work from a file"),
    ("export", "{path}: writes the work; the name's ending says the format"),
    ("hash", "{}: one number for the whole clay"),
    (
        "thickness",
        "{rays?, near?}: wall thickness of the work, measured again only where it may have changed, `near` first",
    ),
    ("take-up", "{path}: the hands take up a mesh from a file, to carry it to its place"),
    ("put-down", "{}: the thing in the hands is gone"),
    ("join", "{operation}: add, carve or keep: the thing in the hands and the work become one"),
    (
        "trim",
        "{part: {box: [x, y, x, y]} | {line: [x, y, x, y]}}: cuts off what is seen there, or to the left of the line; answers as boolean",
    ),
    (
        "level",
        "{to: up|down}: the work one level finer or coarser; what was sculpted on finer levels goes along with coarser ones",
    ),
    (
        "boolean",
        "{operation: union|intersection|difference, path, at?}: the work and a mesh from a file, moved by `at`, become one; answers with the pages written and shared",
    ),
    ("progress", "{}: of the join or Boolean under way, 0 to 1"),
    ("cancel", "{}: ends the join or Boolean under way; nothing is changed"),
    (
        "reach",
        "{middle_mm, half_mm} lays this part of the tracked space over the work; {} measures it for five seconds",
    ),
    (
        "subscribe",
        "{}: from now on a line {method: event, params: {event, tick, now}} for each change of work, history, brush, losses or journal",
    ),
    ("shutdown", "{}: ends the daemon as a signal would"),
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TrimParam {
    part: trim::Part,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum LevelTo {
    Up,
    Down,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LevelParam {
    to: LevelTo,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JumpParam {
    node: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathParam {
    path: PathBuf,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct StatusParam {
    version: Option<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ThicknessParam {
    rays: usize,
    near: [f32; 3],
}

impl Default for ThicknessParam {
    fn default() -> Self {
        ThicknessParam { rays: 1, near: [0.0; 3] }
    }
}

/// Brings the map that the host keeps up to this state of the clay and tells what it says. The
/// first call measures all.
fn thickness(host: &Host, mesh: &Snapshot, p: &ThicknessParam) -> Result<Value, String> {
    let job = Job::default();
    let mut kept = host.thickness.lock().map_err(|e| e.to_string())?;
    let fits = kept.as_mut().is_some_and(|m| m.rays() == p.rays && m.advance(mesh).is_ok());
    if !fits {
        *kept = Some(LiveMap::new(mesh, p.rays, &job).map_err(|e| e.to_string())?);
    }
    let Some(map) = kept.as_mut() else { return Err("no map".into()) };
    let measured = map.stale();
    map.work(p.near.into(), usize::MAX, &job).map_err(|e| e.to_string())?;
    let known: Vec<f32> = map.values().iter().copied().filter(|v| v.is_finite()).collect();
    let least = known.iter().copied().reduce(f32::min);
    let most = known.iter().copied().reduce(f32::max);
    let mean = known.iter().map(|&v| f64::from(v)).sum::<f64>() / known.len().max(1) as f64;
    Ok(json!({
        "revision": map.revision(), "vertices": map.values().len(), "measured": measured, "valid": known.len(),
        "min": least, "max": most, "mean": mean,
    }))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JoinParam {
    operation: MenuItem,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BooleanParam {
    operation: Operation,
    path: PathBuf,
    #[serde(default)]
    at: [f64; 3],
}

/// Runs a join that `progress` and `cancel` know of. One at a time.
fn watched(
    host: &Host,
    work: impl FnOnce(&Job) -> Result<boolean_jobs::Joined, boolean_jobs::JoinError>,
) -> Result<Value, RpcError> {
    let failed = |text: String| RpcError::new(Code::Failed, text);
    let job = Arc::new(Job::default());
    {
        let mut slot = host.joining.lock().map_err(|e| failed(e.to_string()))?;
        if slot.is_some() {
            return Err(failed("another join is under way".into()));
        }
        *slot = Some(job.clone());
    }
    let clock = Clock::monotonic();
    let begun = clock.now_us();
    let done = work(&job);
    *host.joining.lock().map_err(|e| failed(e.to_string()))? = None;
    let joined = done.map_err(|e| failed(e.to_string()))?;
    let mut said = json!(joined);
    said["seconds"] = json!((clock.now_us() - begun) as f64 * 1e-6);
    Ok(said)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveParam {
    act: CurveAction,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaskParam {
    action: MaskAction,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct Nothing {}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, RpcError> {
    let params = if params.is_null() { json!({}) } else { params };
    serde_json::from_value(params).map_err(|e| RpcError::new(Code::BadParams, e.to_string()))
}

/// Lays the named fields over what is in force; an unknown field or a wrong type is refused by
/// name.
fn merge<T: serde::Serialize + DeserializeOwned>(now: &T, params: Value) -> Result<T, RpcError> {
    let bad = |e: serde_json::Error| RpcError::new(Code::BadParams, e.to_string());
    let mut all = serde_json::to_value(now).map_err(bad)?;
    match params {
        Value::Null => {}
        Value::Object(named) => {
            for (key, value) in named {
                all[key] = value;
            }
        }
        _ => return Err(RpcError::new(Code::BadParams, "expected an object")),
    }
    serde_json::from_value(all).map_err(bad)
}

/// A path from outside: absolute, and no link at its end.
fn safe(path: &Path) -> Result<(), RpcError> {
    if !path.is_absolute() || path.components().any(|c| c == std::path::Component::ParentDir) {
        return Err(RpcError::new(Code::BadParams, "expected an absolute path without '..'"));
    }
    if path.symlink_metadata().is_ok_and(|m| m.file_type().is_symlink()) {
        return Err(RpcError::new(Code::BadParams, "the path is a symbolic link"));
    }
    Ok(())
}

fn kept(host: &Host) -> Result<&Handle, RpcError> {
    let none =
        || RpcError::new(Code::Failed, "no history is kept: the daemon runs without --session");
    host.history.as_ref().ok_or_else(none)
}

/// Answers one request. Runs on the client's thread: slow work here delays that client only.
pub fn call(host: &Host, method: &str, params: Value) -> Result<Value, RpcError> {
    let send_queued = |command: QueuedCommand| {
        host.commands.try_send(command).map_err(|_| {
            RpcError::new(
                Code::Failed,
                "the loop has more commands waiting than it can take; try again",
            )
        })
    };
    let send = |command: Command| send_queued(command.into());
    let failed = |e: String| RpcError::new(Code::Failed, e);
    let state = host.published.load_full();
    match method {
        "methods" => {
            read::<Nothing>(params)?;
            Ok(METHODS
                .iter()
                .map(|(name, what)| (name.to_string(), json!(what)))
                .collect::<serde_json::Map<_, _>>()
                .into())
        }
        "status" => {
            if let Some(v) = read::<StatusParam>(params)?.version.filter(|v| *v != PROTOCOL) {
                return Err(RpcError::new(
                    Code::Version,
                    format!("this daemon speaks version {PROTOCOL}, the client {v}"),
                ));
            }
            let f = &state.figures;
            let journal = host.journal.as_ref().map(|h| {
                use std::sync::atomic::Ordering::Relaxed;
                json!({ "written": h.written.load(Relaxed), "lost": h.lost.load(Relaxed), "fault": h.trouble() })
            });
            Ok(json!({
                "protocol": PROTOCOL, "version": env!("CARGO_PKG_VERSION"), "tick": state.tick,
                "heard": f.newest_tick,
                "samples": f.samples, "dabs": f.dabs, "vertices_moved": f.vertices_moved, "overruns": f.overruns,
                "losses": f.losses, "tick_ms": f.tick_ms,
                "vertices": state.mesh.vertex_count(), "triangles": state.mesh.triangle_count(),
                "undo_steps": state.undo_steps, "redo_steps": state.redo_steps, "brush": state.brush,
                "curve_points": state.draft.points().len(),
                "journal": journal,
            }))
        }
        "subscribe" => {
            read::<Nothing>(params)?;
            Ok(json!({ "events": super::events::EVENTS }))
        }
        "brush" => {
            let other = params.get("kind").and_then(|k| k.as_str()).map(str::parse::<BrushKind>);
            let other = other.transpose().map_err(|e| RpcError::new(Code::BadParams, e))?;
            // Another brush comes with its own settings; what else is said is laid over them.
            let base = match other.filter(|k| *k != state.brush.kind) {
                Some(kind) => host.presets.switched(&state.brush, kind),
                None => state.brush,
            };
            let brush = merge(&base, params)?;
            brush.check().map_err(|e| RpcError::new(Code::BadParams, e))?;
            let brush = brush.clamped();
            send(Command::Brush(brush))?;
            Ok(json!(brush))
        }
        "picture" => {
            let p: PathParam = read(params)?;
            safe(&p.path)?;
            let bytes =
                std::fs::read(&p.path).map_err(|e| failed(format!("{}: {e}", p.path.display())))?;
            let picture = Picture::decode(&bytes)
                .map_err(|e| failed(format!("{}: {e}", p.path.display())))?;
            let answer = json!({ "width": picture.width, "height": picture.height });
            send(Command::Picture(Arc::new(picture)))?;
            Ok(answer)
        }
        "mask" => {
            send(Command::Mask(read::<MaskParam>(params)?.action))?;
            Ok(json!({ "sent": true }))
        }
        "curve" => {
            let act = read::<CurveParam>(params)?.act;
            send(Command::CurveStroke(act))?;
            Ok(json!({ "sent": true, "points": state.draft.points().len() }))
        }
        "brushes" => {
            read::<Nothing>(params)?;
            Ok(BrushKind::ALL
                .iter()
                .map(|k| {
                    let p = host.presets.get(*k);
                    json!({
                        "name": k.name(),
                        "about": p.about(),
                        "settings": p.settings(),
                        "extra": k.own_numbers(),
                    })
                })
                .collect::<Vec<_>>()
                .into())
        }
        "camera" => {
            let camera = merge(&state.camera, params)?;
            if !camera.is_sane() {
                return Err(RpcError::new(Code::BadParams, "no view can be made of this camera"));
            }
            send(Command::Camera(camera))?;
            Ok(json!(camera))
        }
        "undo" | "redo" => {
            read::<Nothing>(params)?;
            send(if method == "undo" { Command::Undo } else { Command::Redo })?;
            Ok(json!({ "sent": true }))
        }
        "history" => {
            read::<Nothing>(params)?;
            let tree = kept(host)?.tree();
            Ok(json!({ "here": tree.cursor, "places": listing::places(&tree) }))
        }
        "jump" => {
            let node = read::<JumpParam>(params)?.node;
            let history = kept(host)?;
            if history.tree().way(node).is_none() {
                return Err(failed(format!("no way leads to {node}; 'history' lists the places")));
            }
            history.want(Want::Node(node));
            Ok(json!({ "sent": true }))
        }
        "load" => {
            let p: PathParam = read(params)?;
            safe(&p.path)?;
            let loaded =
                startup::load(Some(&p.path), &Job::default()).map_err(|e| failed(e.to_string()))?;
            let vertices = loaded.mesh.vertex_count();
            let command = Command::Replace(NewClay::new(Arc::new(loaded.plain), false));
            let built = Payload::Clay(Box::new(loaded.mesh));
            send_queued(QueuedCommand::with_payload(command, built))?;
            Ok(json!({ "vertices": vertices, "warnings": loaded.warnings }))
        }
        "export" => {
            let p: PathParam = read(params)?;
            safe(&p.path)?;
            let mesh = state.mesh.to_tri().to_poly();
            write_mesh(&p.path, &mesh).map_err(|e| failed(e.to_string()))?;
            Ok(json!({ "path": p.path, "tick": state.tick, "vertices": mesh.positions.len() }))
        }
        "take-up" => {
            let p: PathParam = read(params)?;
            safe(&p.path)?;
            let loaded =
                startup::load(Some(&p.path), &Job::default()).map_err(|e| failed(e.to_string()))?;
            let triangles = loaded.plain.triangles.len();
            send(Command::TakeUp(Arc::new(loaded.plain)))?;
            Ok(json!({ "triangles": triangles, "warnings": loaded.warnings }))
        }
        "put-down" => {
            read::<Nothing>(params)?;
            send(Command::PutDown)?;
            Ok(json!({ "sent": true }))
        }
        "join" => {
            let p: JoinParam = read(params)?;
            watched(host, |job| {
                boolean_jobs::at_rest(&host.published, p.operation, job, &host.commands)
            })
        }
        "boolean" => {
            let p: BooleanParam = read(params)?;
            safe(&p.path)?;
            if !p.at.iter().all(|x| x.is_finite()) || p.operation == Operation::ReverseDifference {
                return Err(RpcError::new(
                    Code::BadParams,
                    "expected union, intersection or difference, and a finite place",
                ));
            }
            let mut tool =
                read_mesh(&p.path, &Job::default()).map_err(|e| failed(e.to_string()))?.mesh;
            repair::weld(&mut tool, 0.0);
            tool.positions.iter_mut().for_each(|x| *x += glam::DVec3::from(p.at));
            let given = |_: &Published| Ok(tool.clone());
            watched(host, |job| {
                boolean_jobs::carry_out(
                    &host.published,
                    given,
                    false,
                    p.operation,
                    job,
                    &host.commands,
                )
            })
        }
        "progress" => {
            read::<Nothing>(params)?;
            let under_way = host.joining.lock().map_err(|e| failed(e.to_string()))?;
            Ok(
                json!({ "running": under_way.is_some(), "done": under_way.as_ref().map(|j| j.done()) }),
            )
        }
        "cancel" => {
            read::<Nothing>(params)?;
            let under_way = host.joining.lock().map_err(|e| failed(e.to_string()))?;
            if let Some(job) = under_way.as_ref() {
                job.cancel();
            }
            Ok(json!({ "cancelled": under_way.is_some() }))
        }
        "trim" => {
            let p: TrimParam = read(params)?;
            watched(host, |job| trim::carry_out(&host.published, &p.part, job, &host.commands))
        }
        "level" => {
            let p: LevelParam = read(params)?;
            let finer = matches!(p.to, LevelTo::Up);
            let (command, (level, levels)) =
                boolean_jobs::level(&host.published, finer).map_err(|e| failed(e.to_string()))?;
            send_queued(command)?;
            Ok(json!({ "level": level, "levels": levels }))
        }
        "reach" => {
            let reach = if params.is_null() || params == json!({}) {
                None
            } else {
                Some(read::<ReachBox>(params)?)
            };
            if reach.is_some_and(|r| !r.is_sane()) {
                return Err(RpcError::new(
                    Code::BadParams,
                    "expected a place within 2 m and half a side of 30 to 1000 mm",
                ));
            }
            send(reach.map_or(Command::CalibrateReach, Command::Reach))?;
            Ok(json!({ "measuring": reach.is_none() }))
        }
        "hash" => {
            read::<Nothing>(params)?;
            Ok(json!({ "tick": state.tick, "hash": format!("{:016x}", state.mesh.hash()) }))
        }
        "thickness" => {
            let p: ThicknessParam = read(params)?;
            if !(1..=1000).contains(&p.rays) || !p.near.iter().all(|x| x.is_finite()) {
                return Err(RpcError::new(
                    Code::BadParams,
                    "expected 1 to 1000 rays and a finite place",
                ));
            }
            thickness(host, &state.mesh, &p).map_err(failed)
        }
        "shutdown" => {
            read::<Nothing>(params)?;
            host.stop.store(true, std::sync::atomic::Ordering::Relaxed);
            Ok(json!({ "stopping": true }))
        }
        _ => Err(RpcError::new(
            Code::NoMethod,
            format!("no method '{method}'; 'methods' lists them"),
        )),
    }
}
