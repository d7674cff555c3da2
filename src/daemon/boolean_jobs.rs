//! Booleans of the held object with the sculpture, computed on a separate thread.
//!
//! A choice from the hand menu (or a call on the control socket) requests a Boolean. The thread
//! takes the newest snapshot, computes the Boolean and sends the result as commands. The loop never
//! waits for it. A local cut still applies if the sculpture changed elsewhere meanwhile. If the
//! sculpture changed within the cut, the Boolean is computed again, so that no stroke is lost.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;
use serde::Serialize;

use super::command_queue::{CommandSender, NoAnswer};
use super::hand_jobs;
pub use super::hand_jobs::operation;
use super::operations::basis::{Basis, Placing};
use super::operations::{self, Computed, OperationError, Target, in_place};
use super::people::SharedState;
use super::published::Published;
use sculptd_clay::{Grafted, Level, LevelError, Levels, PAGE_VERTICES};
use sculptd_engine::answer::Answer;
use sculptd_engine::command::{Carving, Command};
use sculptd_engine::hand::MenuItem;
use sculptd_engine::scene::{ObjectId, SceneError};
use sculptd_geometry::boolean;
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

/// Pages that a cut may concern: the tick that makes it waits for no more than this.
const MOST_PAGES: usize = 64;
/// Result of a Boolean with the active object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Joined {
    /// True if only the surface near the tool was computed and written.
    pub local: bool,
    /// Number of pages rewritten, and of pages left unchanged.
    pub pages_written: usize,
    pub pages_shared: usize,
    /// Number of times it was computed: once more after each change of the sculpture meanwhile.
    pub tries: usize,
}

/// Computes the Boolean of the active object with a tool given in the world's frame. If the tool
/// reaches little of the object, only that part is computed and written; every other page stays
/// unchanged. `held`: the tool is the held object.
///
/// # Errors
/// Returns an error if the Boolean has no result.
pub fn join(
    shown: &Published,
    tool: PolyMesh,
    held: bool,
    operation: Operation,
    job: &Job,
) -> Result<Computed<usize>, OperationError> {
    let (work, tool) = (&shown.mesh, in_own_frame(shown, tool));
    let options = BooleanOptions::default();
    let then = held.then_some(Command::PutDown);
    // The others at a shared sculpture have the same surface, and not the same pages: a cut of some
    // pages is for one daemon alone.
    let is_shared = shown.standing.state != SharedState::NotShared;
    if !is_shared
        && let Some(cut) =
            sculptd_clay::local_boolean::local(work, &tool, operation, &options, job)?
        && cut.page_count() <= MOST_PAGES
        && cut.can_be_made(work)
    {
        let carving = Carving { cut: Arc::new(cut), put_down: held };
        return Ok(Computed::of_clay(shown, Command::Cut(carving).into(), 0));
    }
    let masks = work.masks();
    let work = work.to_tri().to_poly();
    job.check().map_err(boolean::BooleanError::from)?;
    let (solids, report) = boolean::compute([&work, &tool], &[operation], &options, job, || 0.0)?;
    report.warnings.iter().for_each(|w| tracing::warn!("Boolean of the active object: {w}"));
    let solid = solids.into_iter().next().ok_or(OperationError::Nothing)?;
    if solid.mesh.face_count() == 0 {
        return Err(OperationError::Nothing);
    }
    let plain: TriMesh = solid.mesh.triangulate().0;
    let masks = masks.map(|m| boolean::mixed(&solid, &work, &m));
    let pages = plain.positions.len().div_ceil(PAGE_VERTICES);
    let new = in_place(Arc::new(plain), masks, None, job)?;
    let tool = Some(tool.triangulate().0);
    let basis = Basis::of_active(shown, Placing::Boolean { tool });
    Ok(Computed { then, ..Computed::of_clay(shown, new, pages).following(basis) })
}

/// Computes the active object one level finer or coarser. Returns the new level and the number of
/// levels.
///
/// # Errors
/// Returns an error if there is no such level.
pub fn level(
    now: &Published,
    finer: bool,
    job: &Job,
) -> Result<Computed<(usize, usize)>, OperationError> {
    let work = Level { mesh: now.mesh.to_tri(), masks: now.mesh.masks() };
    let levels = now.mesh.levels().map(|l| &**l);
    let (level, levels) = match (finer, levels) {
        // Cutting triangles invalidates the levels: the current mesh becomes the lowest new level.
        (true, levels) => Levels::up(levels.filter(|l| l.fits(&work.mesh)), &work, job)?,
        (false, Some(levels)) => levels.down(&work, job)?,
        (false, None) => return Err(LevelError::Lowest.into()),
    };
    let at = levels.at();
    let queued = in_place(Arc::new(level.mesh), level.masks, Some(Arc::new(levels)), job)?;
    let placing = if finer { Placing::Finer } else { Placing::Coarser };
    Ok(Computed::of_clay(now, queued, at).following(Basis::of_active(now, placing)))
}

/// Request from tracked hands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandRequest {
    /// Joins the held object with the active object, or with another object of the scene.
    Join(MenuItem),
    /// Lays an object of the scene that was put down flush on a nearby face.
    LayDown(ObjectId),
}

/// The running Boolean thread. Once this is dropped, it ends after its current computation.
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
                // A panic in one Boolean must not stop the ones after it.
                let to = Target { published: &shown, commands: &commands };
                let join = || by_hand(to, request, &Job::default());
                match catch_unwind(AssertUnwindSafe(join)) {
                    Ok(Ok(())) => {}
                    Ok(Err(OperationError::NoAnswer(NoAnswer::Ended))) => return,
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
fn by_hand(to: Target<'_>, request: HandRequest, job: &Job) -> Result<(), OperationError> {
    match (request, to.published.load().object_in_hand) {
        (HandRequest::Join(choice), Some(held)) => {
            operations::carry_out(to, job, |now| hand_jobs::join(now, held, choice, job))?;
        }
        (HandRequest::Join(choice), None) => {
            at_rest(to, choice, job)?;
        }
        (HandRequest::LayDown(id), _) => {
            // The state that shows where it was put down comes right after the tick that asked.
            let near = |now: &Published| hand_jobs::lay_down(now, id);
            if near(&to.published.load_full())?.is_some() {
                operations::carry_out(to, job, |now| {
                    near(now)?.ok_or(OperationError::Refused(SceneError::Stale))
                })?;
            }
        }
    }
    Ok(())
}

/// Joins the active object with the thing in the hands, by a choice of the hands' menu.
///
/// # Errors
/// Why nothing was changed.
pub fn at_rest(to: Target<'_>, choice: MenuItem, job: &Job) -> Result<Joined, OperationError> {
    join_held(to, operation(choice).ok_or(OperationError::Empty)?, job)
}

/// A Boolean of the active object and what the hands hold.
///
/// # Errors
/// Why nothing was changed.
pub fn join_held(
    to: Target<'_>,
    operation: Operation,
    job: &Job,
) -> Result<Joined, OperationError> {
    let held = |now: &Published| {
        now.thing.as_ref().map(|t| t.placed().to_poly()).ok_or(OperationError::Empty)
    };
    carry_out(to, held, true, operation, job)
}

/// A tool of the world in the frame of the active object.
pub fn in_own_frame(shown: &Published, mut tool: PolyMesh) -> PolyMesh {
    let own = shown.transform().inverse();
    if !own.is_none() {
        tool.positions.iter_mut().for_each(|p| *p = own.apply(*p));
    }
    tool
}

/// Joins the active object with a tool, and waits for the loop to install the result.
///
/// # Errors
/// Why nothing was changed.
pub fn carry_out(
    to: Target<'_>,
    tool: impl Fn(&Published) -> Result<PolyMesh, OperationError>,
    held: bool,
    operation: Operation,
    job: &Job,
) -> Result<Joined, OperationError> {
    let compute = |now: &Published| join(now, tool(now)?, held, operation, job);
    let done = operations::carry_out(to, job, compute)?;
    let (local, pages_written, pages_shared) = match done.answer {
        Answer::Cut(Grafted { written, shared }) => (true, written, shared),
        _ => (false, done.made, 0),
    };
    Ok(Joined { local, pages_written, pages_shared, tries: done.tries })
}
