//! `sculptd replay`: a session's input once more, from its start or from a checkpoint; prints the
//! clay's hash.

use std::path::PathBuf;

use serde::Serialize;

use super::ending::export;
use super::{Fail, Outcome, answer};
use sculptd_clay::{BuildError, Workers};
use sculptd_daemon::config::LoopConfig;
use sculptd_daemon::session;
use sculptd_daemon::session::film::ReplayFrames;
use sculptd_daemon::session::reopen;
use sculptd_daemon::session::replay::{Replayed, replay_seen};
use sculptd_daemon::session::{OpenError, Opened};
use sculptd_engine::world::World;
use sculptd_geometry::job::Job;

/// Pixels of a picture.
const PICTURE: (u32, u32) = (1280, 720);

#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// The session file.
    pub session: PathBuf,
    /// Stop after this tick.
    #[arg(long, value_name = "TICK")]
    pub until: Option<u64>,
    /// Begin at the nearest checkpoint before that, as opening the session does: the same clay,
    /// sooner. From the start where none serves.
    #[arg(long, conflicts_with = "frames")]
    pub from_checkpoint: bool,
    /// Write the mesh as it then is.
    #[arg(long, value_name = "FILE")]
    pub export: Option<PathBuf>,
    /// Write a picture of the work every --every seconds of the session, as frame-00000.png and on,
    /// into this folder.
    #[arg(long, value_name = "FOLDER")]
    pub frames: Option<PathBuf>,
    /// Seconds of the session between two pictures.
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, requires = "frames")]
    #[arg(value_parser = super::run::seconds)]
    pub every: f64,
    /// Threads that help; the hash is the same with any number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub workers: usize,
}

#[derive(Debug, Serialize)]
struct ReplayAnswer {
    ticks: u64,
    hash: String,
    vertices: u64,
    export: Option<String>,
    /// The tick of the checkpoint that it began at; absent: the start.
    checkpoint: Option<u64>,
    /// Jumps within the history that could not be made again: what they name is no longer in the
    /// file.
    jumps_missed: u64,
    /// Pictures written.
    frames: u32,
    /// Description of the unreadable part of the file, if any.
    loss: Option<String>,
}

type Done = Result<(Replayed, u32), Fail>;

/// Takes pictures: with a GPU as the window shows the work, else on the CPU.
enum Camera {
    None,
    Plain(ReplayFrames),
    #[cfg(feature = "viewer")]
    Gpu(Box<sculptd_window::viewer::timelapse::Timelapse>),
}

impl Camera {
    fn of(args: &ReplayArgs, rate_hz: u32) -> Result<Camera, Fail> {
        let Some(folder) = &args.frames else { return Ok(Camera::None) };
        let every = (args.every * f64::from(rate_hz)).round() as u64;
        #[cfg(feature = "viewer")]
        match sculptd_window::viewer::timelapse::Timelapse::new(folder, every, PICTURE) {
            Ok(lapse) => return Ok(Camera::Gpu(Box::new(lapse))),
            Err(e) => eprintln!("sculptd: warning: pictures are drawn on the CPU: {e}"),
        }
        ReplayFrames::new(folder, every, PICTURE).map(Camera::Plain).map_err(Fail::Input)
    }

    fn see(&mut self, tick: u64, world: &mut World) -> Result<(), String> {
        match self {
            Camera::None => Ok(()),
            Camera::Plain(film) => film.see(tick, world),
            #[cfg(feature = "viewer")]
            Camera::Gpu(lapse) => lapse.see(tick, world),
        }
    }

    fn frames(&self) -> u32 {
        match self {
            Camera::None => 0,
            Camera::Plain(film) => film.frames,
            #[cfg(feature = "viewer")]
            Camera::Gpu(lapse) => lapse.frames,
        }
    }
}

fn replay(args: &ReplayArgs, opened: &Opened, workers: Workers) -> Done {
    let mut camera = Camera::of(args, opened.settings.rate_hz)?;
    let mut failed = None;
    let mut see = |tick, world: &mut World| {
        if failed.is_none() {
            failed = camera.see(tick, world).err();
        }
    };
    let replayed = replay_seen(opened, args.until, workers, &Job::default(), &mut see)
        .map_err(|e| cannot(args, &e))?;
    match failed {
        Some(e) => Err(Fail::Input(e)),
        None => Ok((replayed, camera.frames())),
    }
}

fn cannot(args: &ReplayArgs, e: &BuildError) -> Fail {
    Fail::Input(format!("{}: {e}", args.session.display()))
}

pub fn run(args: &ReplayArgs, json: bool) -> Outcome {
    let opened = session::open(&args.session).map_err(|e| match e {
        OpenError::Io { source, .. } => Fail::io(&args.session, &source),
        e @ OpenError::Damaged { .. } => Fail::Input(format!(
            "{e}. `sculptd session save` writes what can be read into a new file beside it"
        )),
        e => Fail::Input(e.to_string()),
    })?;
    if let Some(text) = &opened.not_ended {
        eprintln!("sculptd: {}: {text}", args.session.display());
    }
    if let Some(loss) = &opened.loss {
        eprintln!("sculptd: warning: {}: {loss}", args.session.display());
    }
    if let Err(e) = session::stored_polygons::restore(&args.session) {
        eprintln!("sculptd: warning: {}: its polygons: {e}", args.session.display());
    }
    let workers =
        Workers::new(LoopConfig { workers: args.workers, ..LoopConfig::default() }.worker_count());
    let near = args.from_checkpoint.then(|| {
        let count = workers.count();
        reopen(&args.session, &opened, args.until, count, &Job::default())
    });
    let (mut replayed, frames, checkpoint) = match near.flatten() {
        Some(r) => (r.replayed, 0, Some(r.checkpoint)),
        None if opened.replay_from.is_some() => {
            let why = opened.replay_from.map(|r| r.why).unwrap_or_default();
            return Err(Fail::Input(format!(
                "{}: it cannot be replayed from its start: {why}; --from-checkpoint begins later",
                args.session.display()
            )));
        }
        None => {
            let (replayed, frames) = replay(args, &opened, workers)?;
            (replayed, frames, None)
        }
    };
    if replayed.jumps_missed > 0 {
        let n = replayed.jumps_missed;
        eprintln!(
            "sculptd: warning: {n} jumps within the history could not be made again, the clay may \
                be another; --from-checkpoint begins later"
        );
    }
    let answer_ = ReplayAnswer {
        ticks: replayed.ticks,
        hash: format!("{:016x}", replayed.world.hash()),
        vertices: replayed.world.mesh().vertex_count() as u64,
        export: export(args.export.as_deref(), &mut replayed.world)?,
        checkpoint,
        jumps_missed: replayed.jumps_missed,
        frames,
        loss: opened.loss.map(|l| l.to_string()),
    };
    answer(json, &answer_, |out| {
        writeln!(out, "ticks  {}\nhash   {}", answer_.ticks, answer_.hash)?;
        answer_.checkpoint.map_or(Ok(()), |tick| writeln!(out, "from   {tick}   a checkpoint"))
    });
    Ok(())
}
