//! The thing in the hands and the work made one, on a thread of its own.
//!
//! A choice from the hands' menu (or a call on the control socket) asks; the joiner takes the
//! newest snapshot, computes the Boolean and sends what came of it as commands. The loop never
//! waits for it. Where the work was changed meanwhile elsewhere, a cut is made all the same; where
//! it was changed there, it is computed again: nothing that was sculpted is lost.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;
use serde::Serialize;

use super::command_queue::{CommandSender, QueuedCommand};
use super::hand_jobs;
pub use super::hand_jobs::operation;
use super::published::Published;
use sculptd_clay::{Clay, Grafted, Level, LevelError, Levels, PAGE_VERTICES, Snapshot};
use sculptd_engine::command::{Carving, Command, NewClay, OfClay};
use sculptd_engine::hand::MenuItem;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::ObjectId;
use sculptd_geometry::boolean;
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::quads::QuadError;
use sculptd_geometry::remesh::RemeshError;
use sculptd_geometry::{PolyMesh, TriMesh};

/// Tries before a work that never rests is told so.
const TRIES: usize = 3;
/// Pages that a cut may concern: the tick that makes it waits for no more than this.
const MOST_PAGES: usize = 64;
/// For the loop to say whether a cut was made.
const PATIENCE: Duration = Duration::from_secs(10);

#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    #[error("nothing is in the hands")]
    Empty,
    #[error(transparent)]
    Boolean(#[from] boolean::BooleanError),
    #[error("this part of the view holds nothing that could be cut off")]
    NoPart,
    #[error(transparent)]
    Level(#[from] LevelError),
    #[error("nothing of the work would be left")]
    Nothing,
    #[error("the result cannot be sculpted: {0}")]
    Build(String),
    #[error("the work was changed while it was joined, {TRIES} times over")]
    Restless,
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error(transparent)]
    Remesh(#[from] RemeshError),
    #[error("voxel = {voxel}: expected {least} to {most}, 1024 to 8 along the longest side")]
    Voxel { voxel: f32, least: f32, most: f32 },
    #[error(transparent)]
    Quads(#[from] QuadError),
    #[error("levels = {0}: expected 0 to 6")]
    QuadLevels(u32),
    #[error("triangles = {0}: expected at least 4, or a max_error")]
    Triangles(usize),
    #[error("the loop has ended")]
    Ended,
    #[error(transparent)]
    Combine(#[from] crate::scene_jobs::CombineError),
    #[error(transparent)]
    Snap(#[from] crate::snap_jobs::SnapError),
    #[error(transparent)]
    FaceSets(#[from] crate::face_set_jobs::ExtractionError),
    #[error(transparent)]
    Mask(#[from] sculptd_clay::measured_mask::MeasuredMaskError),
}

/// The work and a tool made one: the commands that put the result in place. Where the tool reaches
/// little of the work, only that is computed and written; every other page stays as it is. `held`:
/// the tool is the thing in the hands.
pub fn join(
    work: &Snapshot,
    tool: &PolyMesh,
    held: bool,
    operation: Operation,
    job: &Job,
) -> Result<Vec<QueuedCommand>, JoinError> {
    let options = BooleanOptions::default();
    if let Some(cut) = sculptd_clay::local_boolean::local(work, tool, operation, &options, job)?
        && cut.page_count() <= MOST_PAGES
        && cut.can_be_made(work)
    {
        let carving = Carving { cut: Arc::new(cut), put_down: held };
        return Ok(vec![Command::Cut(carving).into()]);
    }
    let masks = work.masks();
    let work = work.to_tri().to_poly();
    job.check().map_err(boolean::BooleanError::from)?;
    let (solids, _) = boolean::compute([&work, tool], &[operation], &options, job, || 0.0)?;
    let solid = solids.into_iter().next().ok_or(JoinError::Nothing)?;
    if solid.mesh.face_count() == 0 {
        return Err(JoinError::Nothing);
    }
    let plain: TriMesh = solid.mesh.triangulate().0;
    let masks = masks.map(|m| boolean::mixed(&solid, &work, &m));
    let built = Clay::build_masked(&plain, masks.as_deref().unwrap_or(&[]), job);
    let built = built.map_err(|e| JoinError::Build(e.to_string()))?;
    let new = NewClay::new(Arc::new(plain), true);
    let command = match masks {
        Some(masks) => Command::ReplaceMasked(new, Arc::new(masks)),
        None => Command::Replace(new),
    };
    let mut out = vec![QueuedCommand::with_payload(command, Payload::Clay(Box::new(built)))];
    out.extend(held.then(|| Command::PutDown.into()));
    Ok(out)
}

/// The work one level finer or coarser: the command that puts it in place, and which level of how
/// many it is.
pub fn level(
    shown: &ArcSwap<Published>,
    finer: bool,
) -> Result<(QueuedCommand, (usize, usize)), JoinError> {
    settled(shown, |now| {
        let (work, job) =
            (Level { mesh: now.mesh.to_tri(), masks: now.mesh.masks() }, Job::default());
        let levels = now.mesh.levels().map(|l| &**l);
        let (level, levels) = match (finer, levels) {
            // Where triangles were cut the levels end: what is there now is the lowest of new ones.
            (true, levels) => Levels::up(levels.filter(|l| l.fits(&work.mesh)), &work, &job)?,
            (false, Some(levels)) => levels.down(&work, &job)?,
            (false, None) => return Err(LevelError::Lowest.into()),
        };
        let built = Clay::build_masked(&level.mesh, level.masks.as_deref().unwrap_or(&[]), &job);
        let built = built.map_err(|e| JoinError::Build(e.to_string()))?;
        let at = levels.at();
        let mut clay = NewClay::new(Arc::new(level.mesh), true);
        clay.levels = Some(Arc::new(levels));
        let command = match level.masks {
            Some(masks) => Command::ReplaceMasked(clay, Arc::new(masks)),
            None => Command::Replace(clay),
        };
        let queued = QueuedCommand::with_payload(command, Payload::Clay(Box::new(built)));
        Ok((of_clay(now, queued), at))
    })
}

/// What hands ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandRequest {
    /// What they hold is joined with the object, or with an object of the scene.
    Join(MenuItem),
    /// An object of the scene that they have put down is laid flush on a face near it.
    LayDown(ObjectId),
}

/// A running joiner; it ends when this is dropped and what it computes is done.
#[derive(Debug)]
pub struct BooleanJobs {
    asked: cc::Sender<HandRequest>,
}

impl BooleanJobs {
    /// # Errors
    /// If no thread can be started.
    pub fn start(shown: Arc<ArcSwap<Published>>, commands: CommandSender) -> std::io::Result<Self> {
        let (asked, todo) = cc::bounded::<HandRequest>(1);
        std::thread::Builder::new().name("sculptd-join".into()).spawn(move || {
            for request in todo {
                // A bug in one Boolean must not end those that follow.
                let join = || by_hand(&shown, request, &Job::default(), &commands);
                match catch_unwind(AssertUnwindSafe(join)) {
                    Ok(Ok(())) => {}
                    Ok(Err(JoinError::Ended)) => return,
                    Ok(Err(e)) => tracing::warn!("{request:?}: {e}"),
                    Err(_) => tracing::error!("{request:?}: it ended by a bug"),
                }
            }
        })?;
        Ok(BooleanJobs { asked })
    }

    /// Asks for a join. One at a time: a second wish while one is under way is not taken.
    pub fn ask(&self, request: HandRequest) -> bool {
        self.asked.try_send(request).is_ok()
    }
}

/// Carries out what hands asked for.
fn by_hand(
    shown: &ArcSwap<Published>,
    request: HandRequest,
    job: &Job,
    commands: &CommandSender,
) -> Result<(), JoinError> {
    let now = shown.load_full();
    let send = |queued| commands.send(queued).map_err(|_| JoinError::Ended);
    match (request, now.object_in_hand) {
        (HandRequest::Join(choice), Some(held)) => send(hand_jobs::join(&now, held, choice, job)?),
        (HandRequest::Join(choice), None) => at_rest(shown, choice, job, commands).map(|_| ()),
        (HandRequest::LayDown(id), _) => {
            // The state that shows where it was put down comes right after the tick that asked.
            match hand_jobs::lay_down(&now, id)? {
                Some(queued) => send(queued),
                None => Ok(()),
            }
        }
    }
}

/// What a join came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Joined {
    /// Computed and written only where the tool is.
    pub local: bool,
    /// Pages written anew, and pages that stayed as they were.
    pub pages_written: usize,
    pub pages_shared: usize,
    /// Times that it was computed: again where the work was changed meanwhile.
    pub tries: usize,
}

/// Joins the work as it is now with the thing in the hands, by a choice of the hands' menu.
pub fn at_rest(
    shown: &ArcSwap<Published>,
    choice: MenuItem,
    job: &Job,
    commands: &CommandSender,
) -> Result<Joined, JoinError> {
    join_held(shown, operation(choice).ok_or(JoinError::Empty)?, job, commands)
}

/// A Boolean of the object as it is now and what the hands hold.
pub fn join_held(
    shown: &ArcSwap<Published>,
    operation: Operation,
    job: &Job,
    commands: &CommandSender,
) -> Result<Joined, JoinError> {
    let held =
        |now: &Published| now.thing.as_ref().map(|t| t.placed().to_poly()).ok_or(JoinError::Empty);
    carry_out(shown, held, true, operation, job, commands)
}

/// A tool of the world in the frame of the active object.
pub fn in_own_frame(shown: &Published, mut tool: PolyMesh) -> PolyMesh {
    let own = shown.transform().inverse();
    if !own.is_none() {
        tool.positions.iter_mut().for_each(|p| *p = own.apply(*p));
    }
    tool
}

/// A command that was computed for the active clay, to be carried out only while that is active. In
/// a scene of one object nothing else can be.
pub fn of_clay(shown: &Published, queued: QueuedCommand) -> QueuedCommand {
    if shown.scene.objects.len() == 1 {
        return queued;
    }
    let (clay, revision) = shown.clay_revision();
    let wrap = |command: Command| match command {
        // A cut says itself whether it still fits.
        Command::Cut(_) => Command::OfClay(Box::new(OfClay { clay, revision: None, command })),
        Command::Replace(_) | Command::ReplaceMasked(..) => {
            Command::OfClay(Box::new(OfClay { clay, revision: Some(revision), command }))
        }
        other => other,
    };
    QueuedCommand { command: wrap(queued.command), ..queued }
}

/// What `of` makes of the work; made again when the work was changed meanwhile.
pub fn settled<T>(
    shown: &ArcSwap<Published>,
    of: impl Fn(&Published) -> Result<T, JoinError>,
) -> Result<T, JoinError> {
    for _ in 0..TRIES {
        let before = shown.load_full();
        let done = of(&before)?;
        if shown.load().clay_revision() == before.clay_revision() {
            return Ok(done);
        }
    }
    Err(JoinError::Restless)
}

/// Joins the work as it is now with the tool; again where the work was changed there meanwhile.
pub fn carry_out(
    shown: &ArcSwap<Published>,
    tool: impl Fn(&Published) -> Result<PolyMesh, JoinError>,
    held: bool,
    operation: Operation,
    job: &Job,
    commands: &CommandSender,
) -> Result<Joined, JoinError> {
    let send = |c: QueuedCommand| commands.send(c).map_err(|_| JoinError::Ended);
    for tries in 1..=TRIES {
        let before = shown.load_full();
        let tool = in_own_frame(&before, tool(&before)?);
        let done = join(&before.mesh, &tool, held, operation, job)?;
        let mut done: Vec<_> = done.into_iter().map(|c| of_clay(&before, c)).collect();
        job.check().map_err(boolean::BooleanError::from)?;
        if let [one] = &mut done[..]
            && one.command.is_cut()
        {
            let (answer, made) = cc::bounded(1);
            one.result = Some(answer);
            done.into_iter().try_for_each(send)?;
            match made.recv_timeout(PATIENCE) {
                Ok(Some(Grafted { written, shared })) => {
                    return Ok(Joined {
                        local: true,
                        pages_written: written,
                        pages_shared: shared,
                        tries,
                    });
                }
                Ok(None) => continue,
                Err(_) => return Err(JoinError::Ended),
            }
        }
        if shown.load().clay_revision() == before.clay_revision() {
            let pages = done.iter_mut().find_map(|queued| {
                let new = queued.command.new_clay_mut()?;
                Some(new.plain.positions.len().div_ceil(PAGE_VERTICES))
            });
            done.into_iter().try_for_each(send)?;
            return Ok(Joined {
                local: false,
                pages_written: pages.unwrap_or(0),
                pages_shared: 0,
                tries,
            });
        }
    }
    Err(JoinError::Restless)
}
