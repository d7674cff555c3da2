//! Background tasks of the window, each on a separate thread: reading and writing meshes, the live
//! thickness map, file dialogs. The window never waits for them. The tick loop receives only the
//! command that adds a loaded mesh.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::check_task::CheckReport;
use super::latest_wins::LatestWins;
use super::look_files::LookFiles;
use super::pages::MapValues;
use super::preview::{self, Preview};
use super::task_texts::{failed, operation_title, repaired, saved, symmetric};
use super::thickness_task::{ThicknessRequest, WallReport, follow};
use super::wiring::Wiring;
use crate::language::{current, set_current, tr};
use crate::panels::hand_menu;
use crate::panels::state::Pairing;
use crate::panels::state::{
    DistanceSummary, FilePurpose, FolderListing, MESH_ENDINGS, Measured, SectionFigures,
};
use sculptd_clay::face_sets::{FaceSetPart, Partition};
use sculptd_clay::measured_mask::MaskMeasure;
use sculptd_clay::{BuildError, Clay};
use sculptd_daemon::command_queue::{CommandSender, QueuedCommand};
use sculptd_daemon::decimate_job::{DecimateMade, DecimateWanted};
use sculptd_daemon::operations::{self, Computed, Installed, OperationError, Target};
use sculptd_daemon::quad_job::{QuadsMade, QuadsWanted};
use sculptd_daemon::remesh_job::{Remeshed, Wanted};
use sculptd_daemon::repair_jobs::RepairRequest;
use sculptd_daemon::scene_jobs::{SceneBoolean, Selection};
use sculptd_daemon::snap_jobs::{self, PickedFace};
use sculptd_daemon::symmetrise_job::{SymmetriseMade, SymmetriseWanted, symmetrised};
use sculptd_daemon::trim;
use sculptd_daemon::trim::Part;
use sculptd_daemon::{
    Published, boolean_jobs, decimate_job, face_set_jobs, mask_jobs, polygons, quad_job,
    remesh_job, repair_jobs, scene_jobs, startup,
};
use sculptd_devices::Clock;
use sculptd_engine::answer::Answer;
use sculptd_engine::command::{Command, NewClay};
use sculptd_engine::hand::{HeldObject, MenuItem};
use sculptd_engine::local_remesh::LocalRemesh;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{
    FaceAlignment, NewObject, ObjectId, ObjectSource, ObjectTransform, Primitive, SceneCommand,
    SceneError,
};
use sculptd_geometry::io::{MAX_FILE, read_in_millimetres, write_beside, write_scene};
use sculptd_geometry::job::Job;
use sculptd_geometry::projection;
use sculptd_geometry::projection::PlaneRegion;

/// Report of a background task.
#[derive(Debug)]
pub enum TaskReport {
    /// A line for the messages; `true`: something went wrong.
    Message(String, bool),
    /// A file was loaded or written: it goes to the recent ones.
    Used(PathBuf),
    Walls(WallReport),
    /// A Boolean has ended, well or not.
    Joined,
    /// A large mesh was read; the clay is still made of it.
    Read(Arc<Preview>),
    /// A mesh was loaded: distances are to it from now on.
    Opened,
    Preview(Result<Option<Arc<Preview>>, String>),
    Distances(MapValues, DistanceSummary),
    Measured(Box<Measured>),
    Section(SectionFigures),
    Checked(Box<CheckReport>),
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
    let loaded = read_in_millimetres(path, MAX_FILE, &load.read)?;
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

/// The loop: what it shows, and where commands go.
pub type Loop = (Arc<ArcSwap<Published>>, CommandSender);

/// For the loop to answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// Hands a command to the loop and waits for what came of it.
fn ask(
    commands: &CommandSender,
    command: impl Into<QueuedCommand>,
) -> Result<Answer, OperationError> {
    Ok(commands.carry_out(command, PATIENCE)?.result?)
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

/// Returns true if there is no session bus, which a desktop's dialogs need.
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
                    match ask(&commands, command) {
                        Ok(_) => {
                            let _ = say.send(TaskReport::Opened);
                            let _ = say.send(TaskReport::Used(path));
                            TaskReport::Message(text, false)
                        }
                        Err(e) => TaskReport::Message(e.to_string(), true),
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
                    write_scene(&path, &meshes, &Job::default()).map_err(|e| e.to_string())
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

    /// Carries out an operation on a separate thread, and reports the world's answer. `done`: the
    /// message after success.
    fn operate<T>(
        &self,
        name: &'static str,
        (shown, commands): Loop,
        job: Arc<Job>,
        compute: impl Fn(&Published, &Job) -> Result<Computed<T>, OperationError> + Send + 'static,
        done: impl FnOnce(Installed<T>) -> String + Send + 'static,
    ) {
        self.report(name, move || {
            let to = Target { published: &shown, commands: &commands };
            let installed = operations::carry_out(to, &job, |now| compute(now, &job))?;
            let follows = installed.rounds > 0;
            let text = done(installed);
            let told = follows && !text.is_empty();
            Ok(if told { format!("{text}\n{}", tr!("task-followed")) } else { text })
        });
    }

    /// Runs a task on a separate thread, and reports its result.
    fn report(
        &self,
        name: &'static str,
        of: impl FnOnce() -> Result<String, OperationError> + Send + 'static,
    ) {
        let say = self.say.clone();
        thread(name, move || {
            let (text, wrong) = match of() {
                Ok(text) => (text, false),
                Err(OperationError::Refused(SceneError::TakenBack)) => {
                    (tr!("task-remesh-taken-back"), false)
                }
                Err(e) => (e.to_string(), true),
            };
            if !text.is_empty() {
                let _ = say.send(TaskReport::Message(text, wrong));
            }
            let _ = say.send(TaskReport::Joined);
        });
    }

    /// Adds an object of a primitive, or gives one other numbers.
    pub fn primitive(&self, primitive: Primitive, of: Option<ObjectId>, commands: CommandSender) {
        self.report("sculptd-load", move || {
            let build = |e: &dyn std::fmt::Display| OperationError::Build(e.to_string());
            let plain = primitive.triangles().map_err(|e| build(&e))?;
            let clay = Clay::build(&plain, &Job::default()).map_err(|e| build(&e))?;
            let source = ObjectSource::Primitive(primitive);
            let new = NewObject::new(primitive.shape.name(), source, ObjectTransform::NONE);
            let command = Command::Scene(match of {
                Some(id) => SceneCommand::Reshape(id, new),
                None => SceneCommand::Add(new),
            });
            let built = Payload::Clay(Box::new(clay));
            ask(&commands, QueuedCommand::with_payload(command, built)).map(|_| String::new())
        });
    }

    /// Adds the held object to the scene at its current place.
    pub fn held(&self, held: HeldObject, commands: CommandSender) {
        self.report("sculptd-load", move || {
            let build = |e: BuildError| OperationError::Build(e.to_string());
            let clay = Clay::build(&held.plain, &Job::default()).map_err(build)?;
            let transform = held.place.to_object();
            let new = NewObject::new("held object", ObjectSource::Mesh(held.plain), transform);
            let command = Command::Scene(SceneCommand::Add(new));
            let built = Payload::Clay(Box::new(clay));
            ask(&commands, QueuedCommand::with_payload(command, built))?;
            ask(&commands, Command::PutDown).map(|_| String::new())
        });
    }

    /// A Boolean of the active object and another, which replaces both.
    pub fn pair(&self, pairing: Pairing, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        let active = shown.load().scene.active().map_or(pairing.with, |o| o.id);
        let ids = [active, pairing.with];
        let Pairing { operation, live, all, .. } = pairing;
        let asked = SceneBoolean { live, all, ..SceneBoolean::new(operation) };
        let compute = move |now: &Published, job: &Job| {
            Ok(Computed::of_combined(now, scene_jobs::boolean(now, ids, asked, job)?, ()))
        };
        let done = move |_| tr!("task-done", operation = operation_title(operation));
        self.operate("sculptd-boolean", (shown, commands), Arc::default(), compute, done);
    }

    /// A mirrored twin of an object, in a plane through the origin of the world.
    pub fn mirror(&self, id: ObjectId, axis: usize, to: Loop) {
        let compute = move |now: &Published, job: &Job| {
            Ok(Computed::of_combined(now, scene_jobs::mirror(now, id, axis, job)?, ()))
        };
        self.operate("sculptd-boolean", to, Arc::default(), compute, |_| tr!("task-mirrored"));
    }

    /// Lays a face of one object flush on a face of another.
    pub fn snap(&self, [moved, target]: [PickedFace; 2], to: Loop) {
        let compute = move |now: &Published, _: &Job| {
            let placed = snap_jobs::face_to_face(now, moved, target, FaceAlignment::Nearest, 0.0)?;
            Ok(Computed::of_snap(placed))
        };
        self.operate("sculptd-boolean", to, Arc::default(), compute, |_| tr!("task-snapped"));
    }

    /// Joins the held object with the object; the result takes the object's place, and undo
    /// brings the object back.
    pub fn join(&self, choice: MenuItem, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        self.report("sculptd-boolean", move || {
            let to = Target { published: &shown, commands: &commands };
            boolean_jobs::at_rest(to, choice, &Job::default())?;
            Ok(tr!("task-done", operation = hand_menu::title(choice)))
        });
    }

    /// Cuts off what is seen in a part of the view.
    pub fn trim(&self, part: Part, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        self.report("sculptd-trim", move || {
            let to = Target { published: &shown, commands: &commands };
            trim::carry_out(to, &part, &Job::default())?;
            Ok(tr!("task-trimmed"))
        });
    }

    /// Repairs the active object.
    pub fn repair(&self, request: RepairRequest, job: Arc<Job>, (shown, commands): Loop) {
        self.report("sculptd-boolean", move || {
            let to = Target { published: &shown, commands: &commands };
            repair_jobs::carry_out(to, &request, &job).map(|done| repaired(&done))
        });
    }

    /// The object one level finer or coarser.
    pub fn level(&self, finer: bool, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        let compute = move |now: &Published, job: &Job| boolean_jobs::level(now, finer, job);
        let done = |done: Installed<(usize, usize)>| {
            let (at, of) = done.made;
            tr!("task-level", at = at + 1, all = of)
        };
        self.operate("sculptd-level", (shown, commands), Arc::default(), compute, done);
    }

    /// The object as one surface of even triangles.
    pub fn remesh(&self, wanted: Wanted, shown: Arc<ArcSwap<Published>>, commands: CommandSender) {
        let compute = move |now: &Published, job: &Job| remesh_job::remeshed(now, &wanted, job);
        let done = |done: Installed<Remeshed>| {
            let made = done.made;
            let [before, now] = made.volume;
            let percent = (now / before - 1.0) * 100.0;
            // A change that is only rounding has no sign.
            let change =
                if percent.abs() < 0.005 { "0.00".into() } else { format!("{percent:+.2}") };
            let voxel = format!("{:.4}", made.voxel);
            let (count, crossings) = (made.triangles, made.crossings);
            let text = tr!(
                "task-remeshed",
                count = count,
                voxel = voxel,
                change = change,
                crossings = crossings
            );
            match made.lost {
                Some(lost) => {
                    let [x, y, z] = lost.place.to_array().map(|n| format!("{n:.3}"));
                    let lost = tr!("task-remesh-lost", x = x, y = y, z = z);
                    text + "\n" + &lost
                }
                None => text,
            }
        };
        self.operate("sculptd-remesh", (shown, commands), Arc::default(), compute, done);
    }

    /// Remeshes a part of the active object to triangles of one size, and reports the result.
    pub fn remesh_local(&self, asked: LocalRemesh, commands: CommandSender) {
        self.report("sculptd-remesh", move || {
            let command = Command::Scene(SceneCommand::RemeshLocal(asked));
            let changed = ask(&commands, command)?.object().map_or(0, |changed| changed.0);
            Ok(tr!("task-remesh-local", count = changed))
        });
    }

    /// Face sets by the shape of the active object.
    pub fn make_sets(
        &self,
        by: Partition,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let compute = move |now: &Published, job: &Job| face_set_jobs::parted(now, by, job);
        let done = |_| tr!("task-sets-made");
        self.operate("sculptd-sets", (shown, commands), Arc::default(), compute, done);
    }

    /// Masks the measured vertices of the active object.
    pub fn mask_measured(
        &self,
        by: MaskMeasure,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let compute = move |now: &Published, job: &Job| mask_jobs::measured(now, by, job);
        let done = |done: Installed<u64>| tr!("task-mask-measured", count = done.made);
        self.operate("sculptd-mask", (shown, commands), Arc::default(), compute, done);
    }

    /// A part of the active object, and how thick it is laid on, as a new object.
    pub fn extract(
        &self,
        (part, thickness): (FaceSetPart, f64),
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let name = tr!("sets-extract-name");
        let compute = move |now: &Published, job: &Job| {
            face_set_jobs::extract(now, part, thickness, &name, job)
        };
        let done = |done: Installed<usize>| tr!("task-extracted", count = done.made);
        self.operate("sculptd-sets", (shown, commands), Arc::default(), compute, done);
    }

    /// The object as quads that follow its shape.
    pub fn quads(
        &self,
        wanted: QuadsWanted,
        job: Arc<Job>,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let compute = move |now: &Published, job: &Job| quad_job::quads(now, &wanted, job);
        let done = |done: Installed<QuadsMade>| {
            let made = done.made;
            let (quads, others, crossing) = (made.quads, made.other_faces, made.self_intersections);
            let text = tr!("task-quads", quads = quads, triangles = others, crossings = crossing);
            made.warnings.into_iter().fold(text, |all, w| all + "; " + &w)
        };
        self.operate("sculptd-remesh", (shown, commands), job, compute, done);
    }

    /// The object with fewer triangles.
    pub fn decimate(
        &self,
        wanted: DecimateWanted,
        job: Arc<Job>,
        shown: Arc<ArcSwap<Published>>,
        commands: CommandSender,
    ) {
        let compute = move |now: &Published, job: &Job| decimate_job::decimated(now, &wanted, job);
        let done = |done: Installed<DecimateMade>| {
            let made = done.made;
            let (before, now, crossing) =
                (made.triangles_before, made.triangles, made.new_crossings);
            tr!("task-decimated", before = before, now = now, crossings = crossing)
        };
        self.operate("sculptd-remesh", (shown, commands), job, compute, done);
    }

    /// One side of the active object becomes the mirror image of the other.
    pub fn symmetrise(&self, wanted: SymmetriseWanted, to: Loop) {
        let compute = move |now: &Published, job: &Job| symmetrised(now, wanted, job);
        let done = |m: Installed<SymmetriseMade>| symmetric(&m.made);
        self.operate("sculptd-boolean", to, Arc::default(), compute, done);
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
    pub(super) fn thickness(&mut self, wanted: ThicknessRequest) {
        let reports = &self.say;
        let worker = self.thickness.get_or_insert_with(|| {
            let say = reports.clone();
            let told = move |report| say.send(TaskReport::Walls(report)).is_ok();
            LatestWins::follow("sculptd-thickness", move |requests| follow(requests, &told))
        });
        worker.request(wanted);
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
