//! Background tasks of the window, each on a thread of its own: reading and writing meshes, the
//! live thickness map, file dialogs. The window never waits for them. The tick loop hears of them
//! only by the command that a loaded mesh becomes.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use arc_swap::ArcSwap;
use crossbeam_channel as cc;
use glam::Vec3;

use super::latest_wins::LatestWins;
use super::look_files::LookFiles;
use super::pages::MapValues;
use super::preview::{self, Preview};
use super::task_texts::{failed, operation_title, saved};
use super::thickness_task::{ThicknessRequest, follow};
use super::wiring::Wiring;
use crate::language::{current, set_current, tr};
use crate::panels::hand_menu;
use crate::panels::state::Pairing;
use crate::panels::state::{
    DistanceSummary, FilePurpose, FolderListing, MESH_ENDINGS, Measured, ThicknessSummary,
};
use sculptd_clay::face_sets::{FaceSetPart, Partition};
use sculptd_clay::measured_mask::MaskMeasure;
use sculptd_clay::{Clay, Snapshot};
use sculptd_daemon::boolean_jobs::JoinError;
use sculptd_daemon::command_queue::{CommandSender, QueuedCommand};
use sculptd_daemon::decimate_job::DecimateWanted;
use sculptd_daemon::quad_job::QuadsWanted;
use sculptd_daemon::remesh_job::Wanted;
use sculptd_daemon::scene_jobs::{SceneBoolean, Selection};
use sculptd_daemon::snap_jobs::{self, PickedFace};
use sculptd_daemon::trim;
use sculptd_daemon::trim::Part;
use sculptd_daemon::{
    Published, boolean_jobs, decimate_job, face_set_jobs, mask_jobs, polygons, quad_job,
    remesh_job, scene_jobs, startup,
};
use sculptd_devices::Clock;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::hand::{HeldObject, MenuItem};
use sculptd_engine::local_remesh::LocalRemesh;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{
    NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, SceneCommand, SceneError,
};
use sculptd_geometry::io::{MAX_FILE, read_mesh_within, write_beside, write_scene};
use sculptd_geometry::job::Job;
use sculptd_geometry::projection;
use sculptd_geometry::projection::PlaneRegion;

/// What a background task reports.
#[derive(Debug)]
pub enum TaskReport {
    /// A line for the messages; `true`: something went wrong.
    Message(String, bool),
    /// A file was loaded or written: it goes to the recent ones.
    Used(PathBuf),
    Map(MapValues, Box<ThicknessSummary>),
    /// A Boolean has ended, well or not.
    Joined,
    /// A large mesh was read; the clay is still made of it.
    Read(Arc<Preview>),
    /// A mesh was loaded: distances are to it from now on.
    Opened,
    Preview(Result<Option<Arc<Preview>>, String>),
    Distances(MapValues, DistanceSummary),
    Measured(Box<Measured>),
    /// A dialog's answer.
    Chosen(FilePurpose, PathBuf),
    /// The desktop offers no dialog.
    NoDialog(FilePurpose),
    Listed(PathBuf, FolderListing),
    /// Pictures for the look were read.
    Look(Box<LookFiles>),
    /// A picture that was dropped on the window was kept here.
    KeptPicture(String),
}

/// A mesh on its way into the loop.
#[derive(Debug, Clone, Default)]
struct LoadUnderWay {
    name: String,
    read: Arc<Job>,
    build: Arc<Job>,
    ended: Arc<AtomicBool>,
}

/// The share of a load that reading takes, about.
const READING: f32 = 0.3;
/// Triangles from which on a mesh is shown before the clay is made of it: fewer are ready at once.
const SHOWN_EARLY: usize = 300_000;

fn read_and_build(
    path: &Path,
    load: &LoadUnderWay,
    shown: &ArcSwap<Published>,
    say: &cc::Sender<TaskReport>,
    tell: &dyn Fn(&str),
) -> Result<startup::Loaded, startup::StartupError> {
    let loaded = read_mesh_within(path, MAX_FILE, &load.read)?;
    let (plain, _) = loaded.mesh.triangulate();
    polygons::remember(loaded.mesh, &plain);
    load.read.progress(1.0);
    tell("read");
    if plain.triangles.len() >= SHOWN_EARLY {
        let picture = preview::of_mesh(&plain, shown.load().mesh.page_count());
        let _ = say.send(TaskReport::Read(Arc::new(picture)));
        tell("to be shown");
    }
    let built = startup::build(plain, loaded.warnings, path.display().to_string(), &load.build);
    tell("clay");
    built
}

#[derive(Debug)]
pub struct Tasks {
    pub(super) say: cc::Sender<TaskReport>,
    pub done: cc::Receiver<TaskReport>,
    thickness: Option<LatestWins<ThicknessRequest>>,
    dialog: Arc<AtomicBool>,
    load: Option<LoadUnderWay>,
}

impl Default for Tasks {
    fn default() -> Self {
        let (say, done) = cc::unbounded();
        Tasks { say, done, thickness: None, dialog: Arc::default(), load: None }
    }
}

/// Runs something on a thread that speaks the language of this one.
pub(super) fn thread(name: &str, what: impl FnOnce() + Send + 'static) {
    let language = current();
    let run = move || {
        set_current(&language);
        what();
    };
    let _ = std::thread::Builder::new().name(name.into()).spawn(run);
}

/// A dialog that is gone sooner was never seen: no person dismisses one so quickly.
const NOBODY_ANSWERED_US: u64 = 300_000;

/// Whether there is no session bus, by which a desktop's dialogs are asked for.
fn no_desktop() -> bool {
    let there = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty());
    let socket = || there("XDG_RUNTIME_DIR").is_some_and(|d| Path::new(&d).join("bus").exists());
    cfg!(all(unix, not(target_os = "macos")))
        && there("DBUS_SESSION_BUS_ADDRESS").is_none()
        && !socket()
}

impl Tasks {
    /// Reads a mesh, makes clay of it and sends it to the loop; it is shown as soon as it was read.
    pub fn load(&mut self, path: PathBuf, wiring: &Wiring) {
        let (shown, commands) = (wiring.published.clone(), wiring.commands.clone());
        let (clock, begun_us) = (wiring.clock.clone(), wiring.clock.now_us());
        let say = self.say.clone();
        let name = path.display().to_string();
        let short = path.file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
        let load = LoadUnderWay { name: short, ..LoadUnderWay::default() };
        self.load = Some(load.clone());
        thread("sculptd-load", move || {
            let tell = |what: &str| {
                let ms = (clock.now_us() - begun_us) / 1000;
                tracing::debug!(ms, "{name}: {what}");
            };
            let said = match read_and_build(&path, &load, &shown, &say, &tell) {
                Ok(loaded) => {
                    let count = loaded.mesh.vertex_count();
                    let mut text = tr!("task-loaded", name = name.as_str(), count = count);
                    for warning in loaded.warnings.iter().take(3) {
                        text.push_str("; ");
                        text.push_str(warning);
                    }
                    let new = NewClay::new(Arc::new(loaded.plain), false);
                    let built = Payload::Clay(Box::new(loaded.mesh));
                    let command = QueuedCommand::with_payload(Command::Replace(new), built);
                    // Waits where the loop has many commands: this thread may.
                    match commands.send(command) {
                        Ok(()) => {
                            let _ = say.send(TaskReport::Opened);
                            let _ = say.send(TaskReport::Used(path));
                            TaskReport::Message(text, false)
                        }
                        Err(_) => TaskReport::Message(tr!("task-loop-ended"), true),
                    }
                }
                Err(e) => TaskReport::Message(e.to_string(), true),
            };
            let _ = say.send(said);
            load.ended.store(true, Relaxed);
        });
    }

    /// The file that is being loaded, and how much of it is done, in steps of a fiftieth.
    pub fn progress(&self) -> Option<(String, f32)> {
        let load = self.load.as_ref().filter(|l| !l.ended.load(Relaxed))?;
        let done = load.read.done() * READING + load.build.done() * (1.0 - READING);
        Some((load.name.clone(), (done * 50.0).floor() / 50.0))
    }

    /// Writes the visible objects, each coordinate times `scale`; `unit` is the message of the
    /// unit's name.
    pub fn export(&self, path: PathBuf, state: &Published, scale: f64, unit: &'static str) {
        let (scene, mesh) = (state.scene.clone(), state.mesh.clone());
        let (lo, hi) = state.world_bounds();
        let say = self.say.clone();
        thread("sculptd-export", move || {
            let size = (hi - lo).as_dvec3() * scale;
            let written = scene_jobs::selected(&scene, &mesh, Selection::Visible)
                .map_err(|e| e.to_string())
                .and_then(|mut meshes| {
                    meshes.iter_mut().for_each(|m| m.enlarge(scale));
                    write_scene(&path, &meshes).map_err(|e| e.to_string())
                });
            let said = match written {
                Ok(lost) => {
                    let [x, y, z] = size.to_array().map(|n| format!("{n:.4}"));
                    let (name, unit) = (path.display().to_string(), tr!(unit));
                    let text = tr!("task-exported", path = name, x = x, y = y, z = z, unit = unit);
                    let _ = say.send(TaskReport::Used(path));
                    let lost: String = lost.iter().map(|l| format!("\n{l}")).collect();
                    TaskReport::Message(text + &lost, false)
                }
                Err(e) => TaskReport::Message(e, true),
            };
            let _ = say.send(said);
        });
    }

    /// Adds an object of a primitive, or gives one other numbers.
    pub fn primitive(&self, primitive: Primitive, of: Option<ObjectId>, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-load", move || {
            let built = primitive
                .triangles()
                .map_err(|e| e.to_string())
                .and_then(|plain| Clay::build(&plain, &Job::default()).map_err(|e| e.to_string()));
            let clay = match built {
                Ok(clay) => clay,
                Err(e) => {
                    let _ = say.send(TaskReport::Message(e, true));
                    return;
                }
            };
            let source = ObjectSource::Primitive(primitive);
            let new = NewObject::new(primitive.shape.name(), source, ObjectTransform::NONE);
            let command = Command::Scene(match of {
                Some(id) => SceneCommand::Reshape(id, new),
                None => SceneCommand::Add(new),
            });
            let built = Payload::Clay(Box::new(clay));
            let _ = commands.send(QueuedCommand::with_payload(command, built));
        });
    }

    /// What the hands hold becomes an object where they hold it.
    pub fn held(&self, held: HeldObject, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-load", move || {
            let clay = match Clay::build(&held.plain, &Job::default()) {
                Ok(clay) => clay,
                Err(e) => {
                    let _ = say.send(TaskReport::Message(e.to_string(), true));
                    return;
                }
            };
            let transform = held.place.to_object();
            let new = NewObject::new("held object", ObjectSource::Mesh(held.plain), transform);
            let command = Command::Scene(SceneCommand::Add(new));
            let built = Payload::Clay(Box::new(clay));
            let _ = commands.send(QueuedCommand::with_payload(command, built));
            let _ = commands.send(Command::PutDown);
        });
    }

    /// A Boolean of the active object and another, in the place of both.
    pub fn pair(&self, pairing: Pairing, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-boolean", move || {
            let state = shown.load_full();
            let active = state.scene.active().map_or(pairing.with, |o| o.id);
            let (ids, job) = ([active, pairing.with], Job::default());
            let Pairing { operation, live, all, .. } = pairing;
            let asked = SceneBoolean { live, all, ..SceneBoolean::new(operation) };
            let (text, wrong) = match scene_jobs::boolean(&state, ids, asked, &job) {
                Ok(done) => {
                    let (command, built) = done.command();
                    let command = Command::Scene(command);
                    let sent = commands.send(QueuedCommand::with_payload(command, built));
                    let operation = operation_title(pairing.operation);
                    (tr!("task-done", operation = operation), sent.is_err())
                }
                Err(e) => (e.to_string(), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
            let _ = say.send(TaskReport::Joined);
        });
    }

    /// A mirrored twin of an object, in a plane through the origin of the world.
    pub fn mirror(&self, id: ObjectId, axis: usize, state: Arc<Published>, to: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-boolean", move || {
            let (text, wrong) = match scene_jobs::mirror(&state, id, axis, &Job::default()) {
                Ok(done) => {
                    let (command, built) = done.command();
                    let command = Command::Scene(command);
                    let sent = to.send(QueuedCommand::with_payload(command, built));
                    (tr!("task-mirrored"), sent.is_err())
                }
                Err(e) => (e.to_string(), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
        });
    }

    /// Lays a face of one object flush on a face of another.
    pub fn snap(&self, faces: [PickedFace; 2], state: Arc<Published>, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-boolean", move || {
            let (text, wrong) = match snap_jobs::command(&state, faces) {
                Ok(command) => (tr!("task-snapped"), commands.send(command).is_err()),
                Err(e) => (e.to_string(), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
        });
    }

    /// Joins the held object with the object; the result takes the object's place, and undo
    /// brings the object back.
    pub fn join(&self, choice: MenuItem, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-boolean", move || {
            let (text, wrong) =
                match boolean_jobs::at_rest(&shown, choice, &Job::default(), &commands) {
                    Ok(_) => (tr!("task-done", operation = hand_menu::title(choice)), false),
                    Err(e) => (e.to_string(), true),
                };
            let _ = say.send(TaskReport::Message(text, wrong));
            let _ = say.send(TaskReport::Joined);
        });
    }

    /// Sends the commands of what changes the whole object, and says how it went.
    fn change(
        &self,
        name: &'static str,
        commands: CommandSender,
        of: impl FnOnce() -> Result<(Vec<QueuedCommand>, String), JoinError> + Send + 'static,
    ) {
        let say = self.say.clone();
        thread(name, move || {
            let (text, wrong) = match of() {
                Ok((all, text)) => {
                    let sent = all.into_iter().all(|c| commands.send(c).is_ok());
                    (if sent { text } else { JoinError::Ended.to_string() }, !sent)
                }
                Err(e) => (e.to_string(), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
            let _ = say.send(TaskReport::Joined);
        });
    }

    /// Cuts off what is seen in a part of the view.
    pub fn trim(&self, part: Part, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        self.change("sculptd-trim", commands, move || {
            Ok((trim::at_rest(&shown, &part)?, tr!("task-trimmed")))
        });
    }

    /// The object one level finer or coarser.
    pub fn level(&self, finer: bool, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        self.change("sculptd-level", commands, move || {
            let (command, (at, of)) = boolean_jobs::level(&shown, finer)?;
            Ok((vec![command], tr!("task-level", at = at + 1, all = of)))
        });
    }

    /// The object as one surface of even triangles.
    pub fn remesh(&self, wanted: Wanted, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        self.change("sculptd-remesh", commands, move || {
            let (command, made) = remesh_job::remeshed(&shown, &wanted, &Job::default())?;
            let [before, now] = made.volume;
            let change = format!("{:+.2}", (now / before - 1.0) * 100.0);
            let voxel = format!("{:.4}", made.voxel);
            let (count, crossings) = (made.triangles, made.crossings);
            let text = tr!(
                "task-remeshed",
                count = count,
                voxel = voxel,
                change = change,
                crossings = crossings
            );
            Ok((vec![command], text))
        });
    }

    /// Triangles of one size in a part of the active object; what came of it is told.
    pub fn remesh_local(&self, asked: LocalRemesh, commands: CommandSender) {
        let say = self.say.clone();
        thread("sculptd-remesh", move || {
            let (answer, result) = cc::bounded(1);
            let command = Command::Scene(SceneCommand::RemeshLocal(asked));
            let queued = QueuedCommand { scene_result: Some(answer), ..command.into() };
            let sent = commands.send(queued).is_ok();
            let (text, wrong) = match result.recv() {
                Ok(Ok(changed)) if sent => (tr!("task-remesh-local", count = changed.0), false),
                Ok(Err(SceneError::TakenBack)) => (tr!("task-remesh-taken-back"), false),
                Ok(Err(e)) => (e.to_string(), true),
                _ => (JoinError::Ended.to_string(), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
            let _ = say.send(TaskReport::Joined);
        });
    }

    /// Face sets by the shape of the active object.
    pub fn make_sets(
        &self,
        by: Partition,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        self.change("sculptd-sets", commands, move || {
            let edit = face_set_jobs::parted(&shown.load_full(), by)?;
            let command = Command::Scene(SceneCommand::Sets(edit));
            Ok((vec![command.into()], tr!("task-sets-made")))
        });
    }

    /// What is measured of the active object is masked.
    pub fn mask_measured(
        &self,
        by: MaskMeasure,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        self.change("sculptd-mask", commands, move || {
            let mask = mask_jobs::measured(&shown.load_full(), by, &Job::default())?;
            let count = mask.protected();
            let command = Command::Scene(SceneCommand::MaskMeasured(mask));
            Ok((vec![command.into()], tr!("task-mask-measured", count = count)))
        });
    }

    /// A part of the active object, and how thick it is laid on, as a new object.
    pub fn extract(
        &self,
        (part, thickness): (FaceSetPart, f64),
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        self.change("sculptd-sets", commands, move || {
            let (shown, name) = (shown.load_full(), tr!("sets-extract-name"));
            let made = face_set_jobs::extract(&shown, part, thickness, &name, &Job::default())?;
            let (new, clay) = made;
            let (command, count) = (Command::Scene(SceneCommand::Add(new)), clay.vertex_count());
            let payload = Payload::Clay(Box::new(clay));
            let queued = QueuedCommand::with_payload(command, payload);
            Ok((vec![queued], tr!("task-extracted", count = count)))
        });
    }

    /// The object as quads that follow its shape.
    pub fn quads(
        &self,
        wanted: QuadsWanted,
        job: Arc<Job>,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        self.change("sculptd-remesh", commands, move || {
            let (command, made) = quad_job::quads(&shown, &wanted, &job)?;
            let (quads, others, crossing) = (made.quads, made.other_faces, made.self_intersections);
            let text = tr!("task-quads", quads = quads, triangles = others, crossings = crossing);
            Ok((vec![command], made.warnings.into_iter().fold(text, |all, w| all + "; " + &w)))
        });
    }

    /// The object with fewer triangles.
    pub fn decimate(
        &self,
        wanted: DecimateWanted,
        job: Arc<Job>,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        self.change("sculptd-remesh", commands, move || {
            let (command, made) = decimate_job::decimated(&shown, &wanted, &job)?;
            let (before, now, crossing) =
                (made.triangles_before, made.triangles, made.new_crossings);
            let text = tr!("task-decimated", before = before, now = now, crossings = crossing);
            Ok((vec![command], text))
        });
    }

    /// Writes the shadow's outline.
    pub fn outline(&self, path: PathBuf, outline: &[PlaneRegion]) {
        let (say, drawing) = (self.say.clone(), projection::svg(outline));
        thread("sculptd-outline", move || {
            let (text, wrong) = match write_beside(&path, |out| out.write_all(drawing.as_bytes())) {
                Ok(()) => (saved(&path), false),
                Err(e) => (failed(&path, &e), true),
            };
            let _ = say.send(TaskReport::Message(text, wrong));
        });
    }

    /// For threads that follow the object.
    pub fn reporter(&self) -> cc::Sender<TaskReport> {
        self.say.clone()
    }

    /// Asks the desktop for a file, and says where it offers no dialog; nothing comes back if the
    /// person changed their mind.
    pub fn open_dialog(&self, purpose: FilePurpose, clock: Clock) {
        if self.dialog.swap(true, Relaxed) {
            return;
        }
        let (say, open) = (self.say.clone(), self.dialog.clone());
        thread("sculptd-dialog", move || {
            let begun_us = clock.now_us();
            let dialog =
                rfd::AsyncFileDialog::new().add_filter(tr!("chooser-meshes"), &MESH_ENDINGS);
            let chosen = match purpose {
                _ if no_desktop() => None,
                FilePurpose::Open => pollster::block_on(dialog.pick_file()),
                FilePurpose::Export => {
                    pollster::block_on(dialog.set_file_name("sculpture.stl").save_file())
                }
            };
            open.store(false, Relaxed);
            let report = match chosen {
                Some(file) => TaskReport::Chosen(purpose, file.path().to_owned()),
                None if clock.now_us() - begun_us < NOBODY_ANSWERED_US => {
                    TaskReport::NoDialog(purpose)
                }
                None => return,
            };
            let _ = say.send(report);
        });
    }

    /// Asks for the thickness map of this clay; the newest request counts.
    /// `near` is a place of the world, and the limit in its unit.
    pub fn thickness(
        &mut self,
        (mesh, transform): (&Snapshot, ObjectTransform),
        near: Vec3,
        limit: f32,
    ) {
        let reports = &self.say;
        let worker = self.thickness.get_or_insert_with(|| {
            let say = reports.clone();
            let told = move |map: MapValues, about: ThicknessSummary| {
                say.send(TaskReport::Map(map, Box::new(about))).is_ok()
            };
            LatestWins::follow("sculptd-thickness", move |requests| follow(requests, &told))
        });
        let near = transform.inverse().point(near);
        worker.request(ThicknessRequest { mesh: mesh.clone(), transform, near, limit });
    }

    pub fn say(&self, text: impl Into<String>, wrong: bool) {
        let _ = self.say.send(TaskReport::Message(text.into(), wrong));
    }

    /// Writes a picture.
    pub fn picture(&self, path: PathBuf, picture: image::RgbaImage, quiet: bool) {
        let say = self.say.clone();
        thread("sculptd-picture", move || {
            let said = super::picture::write_png(&path, &picture);
            match said {
                Ok(()) if quiet => {}
                Ok(()) => drop(say.send(TaskReport::Message(saved(&path), false))),
                Err(e) => drop(say.send(TaskReport::Message(failed(&path, &e), true))),
            }
        });
    }
}

/// A name that is not taken: `sculptd-1.png`, `sculptd-2.png`, ...
pub fn free_name(folder: &Path, stem: &str, ending: &str) -> PathBuf {
    (1..)
        .map(|n| folder.join(format!("{stem}-{n}{ending}")))
        .find(|p| !p.exists())
        .unwrap_or_default()
}
