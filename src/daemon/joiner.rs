//! The thing in the hands and the work made one, on a thread of its own.
//!
//! A choice from the hands' menu (or a call on the control socket) asks; the joiner takes the newest snapshot, computes the
//! Boolean and sends what came of it as commands. The loop never waits for it. When the work was changed meanwhile, the
//! result is computed again on the work as it is now: nothing that was sculpted is lost.

use std::sync::Arc;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::published::Published;
use crate::analysis::boolean::{self, Operation, Options};
use crate::analysis::cancel::Job;
use crate::command::{Command, NewClay};
use crate::hand::{Choice, Thing};
use crate::mesh::{LevelError, Levels, Mesh, Snapshot, TriMesh};

/// Tries before a work that never rests is told so.
const TRIES: usize = 3;

#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    #[error("nothing is in the hands")]
    Empty,
    #[error(transparent)]
    Boolean(#[from] boolean::Error),
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
}

/// What a choice from the menu means for the work and the thing.
pub fn operation(choice: Choice) -> Option<Operation> {
    match choice {
        Choice::Add => Some(Operation::Union),
        Choice::Carve => Some(Operation::Difference),
        Choice::Keep => Some(Operation::Intersection),
        _ => None,
    }
}

/// The work and the thing made one: the commands that put the result in place.
pub fn join(
    work: &Snapshot,
    thing: &Thing,
    operation: Operation,
    job: &Job,
) -> Result<Vec<Command>, JoinError> {
    let tool = thing.placed().to_poly();
    // Where the thing is small, only what is near it is cut.
    if let Some(done) = boolean::local(work, &tool, operation, &Options::default(), job)? {
        let mut mesh = done.mesh;
        if mesh.triangle_count() == 0 {
            return Err(JoinError::Nothing);
        }
        // Built anew from plain triangles, as a replay will build it: the same bits follow from the same strokes.
        let plain = mesh.snapshot().to_tri();
        let built = Mesh::build(&plain, job).map_err(|e| JoinError::Build(e.to_string()))?;
        return Ok(vec![Command::Replace(NewClay::new(Arc::new(plain), built, true)), Command::PutDown]);
    }
    let work = work.to_tri().to_poly();
    let (solids, _) = boolean::compute([&work, &tool], &[operation], &Options::default(), job, || 0.0)?;
    let solid = solids.into_iter().next().ok_or(JoinError::Nothing)?;
    if solid.mesh.face_count() == 0 {
        return Err(JoinError::Nothing);
    }
    let plain: TriMesh = solid.mesh.triangulate().0;
    let built = Mesh::build(&plain, job).map_err(|e| JoinError::Build(e.to_string()))?;
    Ok(vec![Command::Replace(NewClay::new(Arc::new(plain), built, true)), Command::PutDown])
}

/// The work one level finer or coarser: the command that puts it in place, and which level of how many it is.
pub fn level(shown: &ArcSwap<Published>, finer: bool) -> Result<(Command, (usize, usize)), JoinError> {
    settled(shown, |now| {
        let (work, job) = (now.mesh.to_tri(), Job::default());
        let levels = now.mesh.levels().map(|l| &**l);
        let (plain, levels) = match (finer, levels) {
            // Where triangles were cut the levels end: what is there now is the lowest of new ones.
            (true, levels) => Levels::up(levels.filter(|l| l.fits(&work)), &work, &job)?,
            (false, Some(levels)) => levels.down(&work, &job)?,
            (false, None) => return Err(LevelError::Lowest.into()),
        };
        let built = Mesh::build(&plain, &job).map_err(|e| JoinError::Build(e.to_string()))?;
        let at = levels.at();
        let mut clay = NewClay::new(Arc::new(plain), built, true);
        clay.levels = Some(Arc::new(levels));
        Ok((Command::Replace(clay), at))
    })
}

/// A running joiner; it ends when this is dropped and what it computes is done.
#[derive(Debug)]
pub struct Joiner {
    asked: cc::Sender<Choice>,
}

impl Joiner {
    /// # Errors
    /// If no thread can be started.
    pub fn start(shown: Arc<ArcSwap<Published>>, commands: cc::Sender<Command>) -> std::io::Result<Self> {
        let (asked, todo) = cc::bounded::<Choice>(1);
        std::thread::Builder::new().name("sculptd-join".into()).spawn(move || {
            for choice in todo {
                match at_rest(&shown, choice) {
                    Ok(done) => {
                        for command in done {
                            if commands.send(command).is_err() {
                                return;
                            }
                        }
                    }
                    Err(e) => tracing::warn!("{}: {e}", choice.label()),
                }
            }
        })?;
        Ok(Joiner { asked })
    }

    /// Asks for a join. One at a time: a second wish while one is under way is not taken.
    pub fn ask(&self, choice: Choice) -> bool {
        self.asked.try_send(choice).is_ok()
    }
}

/// Joins the work as it is now; again when it was changed meanwhile.
pub fn at_rest(shown: &ArcSwap<Published>, choice: Choice) -> Result<Vec<Command>, JoinError> {
    let operation = operation(choice).ok_or(JoinError::Empty)?;
    settled(shown, |now| {
        let thing = now.thing.as_ref().ok_or(JoinError::Empty)?;
        join(&now.mesh, thing, operation, &Job::default())
    })
}

/// What `of` makes of the work; made again when the work was changed meanwhile.
pub fn settled<T>(
    shown: &ArcSwap<Published>,
    of: impl Fn(&Published) -> Result<T, JoinError>,
) -> Result<T, JoinError> {
    for _ in 0..TRIES {
        let before = shown.load_full();
        let done = of(&before)?;
        if shown.load().mesh.revision() == before.mesh.revision() {
            return Ok(done);
        }
    }
    Err(JoinError::Restless)
}
