//! Putting a world together: the work, the settings, the workers.

use std::path::{Path, PathBuf};

use glam::Vec2;

use crate::config::Config;
use crate::polygons;
use sculptd_clay::{BuildError, Clay, Workers};
use sculptd_devices::Body;
use sculptd_devices::queue::Sender;
use sculptd_devices::recording::Player;
use sculptd_engine::command::Command;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{
    MAX_NAME, NewObject, ObjectSource, ObjectTransform, SceneCommand, clean_name,
};
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::io::{MAX_FILE, MorphTarget, ReadError, read_in_millimetres};
use sculptd_geometry::job::Job;
use sculptd_geometry::{TriMesh, shapes};

use super::session::format::Settings;
use super::session::history::{StoreError, keeper::Keeper};
use super::session::writer::WriterThread;
use super::session::{self, OpenError, Opened, SessionWriter};
use super::session::{CreateError, HeldSession};
use super::tick::Journal;
use crate::simulated_loop::Feed;

/// The work that one starts with: a ball of this many vertices, fine enough for detail, light on
/// any machine.
pub const START_VERTICES: usize = 160_000;

/// Radius of that ball, mm: as large as a head that is held in both hands.
pub const START_RADIUS: f32 = 50.0;

#[derive(Debug, thiserror::Error)]
pub enum StartupError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("{path}: {source}")]
    Build { path: String, source: BuildError },
}

/// A work as it was loaded.
#[derive(Debug)]
pub struct Loaded {
    pub plain: TriMesh,
    pub mesh: Clay,
    pub warnings: Vec<String>,
    /// Morph targets of the mesh, which stands without them.
    pub targets: Vec<MorphTarget>,
}

/// Reads a mesh from a file, or makes the ball that a session starts with.
pub fn load(path: Option<&Path>, job: &Job) -> Result<Loaded, StartupError> {
    match path {
        Some(path) => {
            let mut loaded = load_within(path, MAX_FILE, job)?;
            if !loaded.targets.is_empty() {
                let count = loaded.targets.len();
                let text = "morph targets left out; the methods 'load' and 'scene.add' bring them";
                loaded.warnings.push(format!("{count} {text} as layers"));
            }
            Ok(loaded)
        }
        None => {
            let mut ball = shapes::sphere_of_about(START_VERTICES);
            ball.positions.iter_mut().for_each(|p| *p *= START_RADIUS);
            build(ball, vec![], "the start ball".into(), job)
        }
    }
}

/// Reads a mesh from a regular file of at most `limit` bytes.
pub fn load_within(path: &Path, limit: u64, job: &Job) -> Result<Loaded, StartupError> {
    let loaded = read_in_millimetres(path, limit, job)?;
    let (plain, _) = loaded.mesh.triangulate();
    polygons::remember(loaded.mesh, &plain);
    let built = build(plain, loaded.warnings, path.display().to_string(), job)?;
    Ok(Loaded { targets: loaded.targets, ..built })
}

/// Builds clay from a mesh; `path` names it in an error.
///
/// # Errors
/// Returns an error if the mesh cannot be clay, or if the job is cancelled.
pub fn build(
    plain: TriMesh,
    mut warnings: Vec<String>,
    path: String,
    job: &Job,
) -> Result<Loaded, StartupError> {
    let mesh = Clay::build(&plain, job).map_err(|source| StartupError::Build { path, source })?;
    warnings.extend(mesh.warnings().iter().cloned());
    Ok(Loaded { plain, mesh, warnings, targets: Vec::new() })
}

/// The world of a fresh session.
pub fn world(mesh: Clay, config: &Config) -> World {
    let options = WorldOptions {
        dab_budget: config.r#loop.dab_budget,
        undo_bytes: config.undo.bytes,
        hands: config.hand,
    };
    let workers = Workers::new(config.r#loop.worker_count());
    World::new(mesh, config.camera.camera(), config.brush, workers, options)
}

/// Returns the part of a configuration that a new session stores.
pub fn session_settings(config: &Config) -> Settings {
    Settings {
        rate_hz: config.r#loop.rate_hz,
        dab_budget: config.r#loop.dab_budget,
        undo_bytes: config.undo.bytes,
        camera: config.camera.camera(),
        brush: config.brush,
        hands: config.hand,
    }
}

/// A world, and the session that records it, if one was asked for.
#[derive(Debug)]
pub struct Begun {
    pub world: World,
    pub journal: Option<(SessionWriter, WriterThread)>,
    pub warnings: Vec<String>,
    /// The mesh that a reopened session started with; `None`: the world is as it starts.
    pub started_with: Option<TriMesh>,
}

#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    #[error(transparent)]
    Rig(#[from] StartupError),
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    Salvage(#[from] session::salvage::SalvageError),
    #[error(transparent)]
    Create(#[from] CreateError),
}

/// Returns the name of an object loaded from a file: the file's name without its extension.
pub fn object_name(path: &Path) -> String {
    let stem = path.file_stem().map(|s| s.to_string_lossy());
    stem.and_then(|s| clean_name(&s.chars().take(MAX_NAME).collect::<String>()))
        .unwrap_or_else(|| "object".into())
}

/// As [`begin_with`], with one mesh or none.
///
/// # Errors
/// [`BeginError`]
pub fn begin(
    mesh: Option<&Path>,
    session: Option<&Path>,
    config: &Config,
    job: &Job,
) -> Result<Begun, BeginError> {
    let meshes: Vec<PathBuf> = mesh.map(Path::to_path_buf).into_iter().collect();
    begin_with(&meshes, session, config, job)
}

/// Holds a session before it is read. Returns `None` for a file that cannot be written: opening it
/// tells why.
fn held(path: &Path) -> Result<Option<HeldSession>, BeginError> {
    match session::hold(path) {
        Err(e @ CreateError::Busy { .. }) => Err(e.into()),
        held => Ok(held.ok()),
    }
}

/// Begins with meshes, each an object at its true size and place. If `session` names a file, the
/// run is recorded into it. An existing session is replayed to its end and continued; it contains
/// its start, so no mesh may be given with it.
///
/// # Errors
/// [`BeginError`]
pub fn begin_with(
    meshes: &[PathBuf],
    session: Option<&Path>,
    config: &Config,
    job: &Job,
) -> Result<Begun, BeginError> {
    let half_made = session.is_some_and(|p| p.exists() && session::is_half_made(p));
    if let Some(path) = session.filter(|p| p.exists() && !half_made) {
        let workers = Workers::new(config.r#loop.worker_count());
        let mut warnings = Vec::new();
        let mut path = path.to_path_buf();
        let mut held = held(&path)?;
        let mut opened = session::open(&path);
        if !matches!(
            &opened,
            Ok(Opened { loss: None, .. })
                | Err(OpenError::OtherLayout { .. }
                    | OpenError::Io { .. }
                    | OpenError::ReadOnlyFolder { .. })
        ) {
            // A damaged file is kept as it is; the work goes on in another, beside it.
            match session::salvage(&path) {
                Ok(saved) => {
                    warnings.push(saved.to_string());
                    path = saved.path;
                    held = self::held(&path)?;
                    opened = session::open(&path);
                }
                Err(e) => {
                    return Err(opened.err().map_or(BeginError::Salvage(e), BeginError::Open));
                }
            }
        }
        let opened = opened?;
        if let Some(text) = &opened.not_ended {
            warnings.push(format!("{}: {text}", path.display()));
        }
        restore_polygons(&path, &mut warnings);
        let count = config.r#loop.worker_count();
        let (mut replayed, purge, node) = match session::reopen(&path, &opened, None, count, job) {
            Some(r) => (r.replayed, r.checkpoint, Some(r.node)),
            None if opened.replay_from.is_some() => {
                let why = opened.replay_from.map(|r| r.why).unwrap_or_default();
                let path = path.display().to_string();
                return Err(OpenError::NoCheckpoint { path, why }.into());
            }
            None => {
                let replayed =
                    session::replay::replay(&opened, None, workers, job).map_err(|source| {
                        StartupError::Build { path: path.display().to_string(), source }
                    })?;
                let ticks = replayed.ticks;
                (replayed, ticks, None)
            }
        };
        if replayed.jumps_missed > 0 {
            warnings.push(format!(
                "{}: {} jumps within the history could not be made again",
                path.display(),
                replayed.jumps_missed
            ));
        }
        let (mut writer, mut thread) = match held {
            Some(held) => session::resume_held(&path, held)?,
            None => session::resume(&path)?,
        };
        let world = &mut replayed.world;
        // Open strokes end as if the pen were lifted. From here on the file contains the undo
        // history.
        let tick = replayed.ticks + 1;
        let mut reopened = vec![Command::Reopened];
        if world.has_people() {
            reopened.push(Command::OnePerson);
        }
        world.step(tick, &[], &reopened);
        let keeper =
            Keeper::start(thread.path.clone(), world, purge, node, config.undo.history_bytes);
        keep(keeper, &mut writer, &mut thread, &mut warnings);
        writer.tick(tick, &[], &reopened, world);
        let started_with = opened.start.world.is_none().then_some(opened.start.mesh);
        let journal = Some((writer, thread));
        return Ok(Begun { world: replayed.world, journal, warnings, started_with });
    }
    let loaded = load(meshes.first().map(PathBuf::as_path), job)?;
    let mut warnings = loaded.warnings;
    if half_made && let Some(path) = session {
        warnings.push(format!(
            "{}: it was empty, or left by a start that was interrupted; it is begun anew",
            path.display()
        ));
    }
    let mut world = world(loaded.mesh, config);
    let mut others = Vec::new();
    for path in meshes.get(1..).unwrap_or_default() {
        let other = load(Some(path), job)?;
        warnings.extend(other.warnings.iter().cloned());
        others.push((object_name(path), other));
    }
    let mut journal = match session {
        None => None,
        Some(path) => {
            let settings = session_settings(config);
            let (mut writer, mut thread) = session::create(path, &loaded.plain, &settings)?;
            let keeper =
                Keeper::start(thread.path.clone(), &mut world, 0, None, config.undo.history_bytes);
            keep(keeper, &mut writer, &mut thread, &mut warnings);
            Some((writer, thread))
        }
    };
    if !others.is_empty() {
        let name = meshes.first().map(|p| object_name(p)).unwrap_or_default();
        add_others(&mut world, name, others, journal.as_mut().map(|j| &mut j.0));
    }
    Ok(Begun { world, journal, warnings, started_with: None })
}

/// Adds the objects after the first, by commands in the first tick, so that a replay does the same;
/// the camera frames all of them.
fn add_others(
    world: &mut World,
    name: String,
    others: Vec<(String, Loaded)>,
    journal: Option<&mut SessionWriter>,
) {
    let first = world.scene().active().id;
    let (mut lo, mut hi) = world.mesh().bounds();
    let mut commands = vec![Command::Scene(SceneCommand::Rename(first, name))];
    for (name, loaded) in others {
        let (a, b) = loaded.mesh.bounds();
        (lo, hi) = (lo.min(a), hi.max(b));
        let source = ObjectSource::Mesh(loaded.plain.into());
        let new = NewObject::new(&name, source, ObjectTransform::NONE);
        let mut command = Command::Scene(SceneCommand::Add(new));
        world.deliver(&mut command, Payload::Clay(Box::new(loaded.mesh)));
        commands.push(command);
    }
    commands.push(Command::Scene(SceneCommand::Activate(first)));
    let mut camera = *world.camera();
    camera.frame(lo, hi);
    commands.push(Command::Camera(camera));
    let tick = world.tick() + 1;
    world.step(tick, &[], &commands);
    if let Some(journal) = journal {
        journal.tick(tick, &[], &commands, world);
    }
}

/// The polygons of the session's objects are there for what is written of them.
fn restore_polygons(path: &Path, warnings: &mut Vec<String>) {
    let why = match session::stored_polygons::restore(path) {
        Ok(0) => return,
        Ok(n) => format!("{n} are damaged"),
        Err(e) => e.to_string(),
    };
    let path = path.display();
    warnings.push(format!("{path}: polygons of its files cannot be read, triangles stay: {why}"));
}

/// The session goes on without its history where that cannot be written; that is said.
fn keep(
    keeper: Result<Keeper, StoreError>,
    writer: &mut SessionWriter,
    thread: &mut WriterThread,
    warnings: &mut Vec<String>,
) {
    match keeper {
        Ok(keeper) => {
            writer.keep(keeper.handle.clone());
            thread.history = Some(keeper);
        }
        Err(e) => {
            warnings.push(format!("no history is kept, undo goes back as far as memory does: {e}"))
        }
    }
}

/// Part of a tablet, in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    pub min: Vec2,
    pub size: Vec2,
}

/// The part of the tablet that a recording mostly touches: the median of its contacts in the
/// middle, half of them within the middle half, as wide as the view. A recording made in a corner
/// then lies over the work and not beside it. `None` where nothing ever touches.
pub fn used_area(mut player: Player, aspect: f32) -> Option<Area> {
    let mut touched: Vec<Vec2> = Vec::new();
    player.advance(u64::MAX, &mut |sample| {
        if let Body::Pen(pen) = sample.body
            && pen.tip
        {
            touched.push(pen.pos_mm);
        }
    });
    if touched.is_empty() {
        return None;
    }
    let median = |value: &dyn Fn(&Vec2) -> f32| {
        let mut all: Vec<f32> = touched.iter().map(value).collect();
        all.sort_unstable_by(f32::total_cmp);
        all[all.len() / 2]
    };
    let middle = Vec2::new(median(&|p| p.x), median(&|p| p.y));
    let spread =
        Vec2::new(median(&|p| (p.x - middle.x).abs()), median(&|p| (p.y - middle.y).abs()));
    // At least 10 mm: a recording of one dot is a dot in the middle.
    let size = (spread * 4.0).max(Vec2::splat(10.0));
    let size = Vec2::new(size.x.max(size.y * aspect), size.y.max(size.x / aspect));
    Some(Area { min: middle - size * 0.5, size })
}

/// A recording, fed through its parser into the channel.
#[derive(Debug)]
pub struct RecordingFeed {
    player: Player,
    sender: Sender,
    sent: u64,
    /// The part of the tablet that is laid over the view; `None`: all of it.
    area: Option<Area>,
}

impl RecordingFeed {
    pub fn new(player: Player, sender: Sender, area: Option<Area>) -> Self {
        RecordingFeed { player, sender, sent: 0, area }
    }
}

impl Feed for RecordingFeed {
    fn advance(&mut self, until_us: u64) -> u64 {
        let (sender, sent, area) = (&mut self.sender, &mut self.sent, self.area);
        self.player.advance(until_us, &mut |mut sample| {
            if let (Body::Pen(pen), Some(area)) = (&mut sample.body, area) {
                pen.pos_mm -= area.min;
                pen.area_mm = area.size;
            }
            sender.push(sample);
            *sent += 1;
        });
        sender.flush();
        *sent
    }

    fn finished(&self) -> bool {
        self.player.finished()
    }
}
