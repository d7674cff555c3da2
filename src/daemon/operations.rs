//! One way to change a whole object: an operation is computed from an immutable snapshot, on the
//! thread of whoever asks; the loop installs the result where the objects are still as they were,
//! and whoever asked hears what the world did. Window, control socket and hands use this alone.
//!
//! A result that no longer fits is computed again, [`TRIES`] times at most, then refused with the
//! reason. It never overwrites a newer stroke, and it is never dropped without a word.

use std::time::Duration;

use arc_swap::ArcSwap;

use crate::command_queue::{CommandSender, NoAnswer, QueuedCommand};
use crate::published::Published;
use crate::scene_jobs::CombineError;
use crate::snap_jobs::{Placed, SnapError};
use sculptd_clay::LevelError;
use sculptd_clay::face_sets::{ExtractError, SetsError};
use sculptd_clay::measured_mask::MeasuredMaskError;
use sculptd_engine::answer::Answer;
use sculptd_engine::command::{Command, OfClay};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{SceneCommand, SceneError};
use sculptd_geometry::boolean::BooleanError;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::quads::QuadError;
use sculptd_geometry::remesh::RemeshError;

/// Number of attempts before an operation fails because the sculpture keeps changing.
pub const TRIES: usize = 3;
/// Time limit for the loop's answer.
const PATIENCE: Duration = Duration::from_secs(60);

/// Reason that an operation changed nothing.
#[derive(Debug, thiserror::Error)]
pub enum OperationError {
    #[error("nothing is in the hands")]
    Empty,
    #[error(transparent)]
    Boolean(#[from] BooleanError),
    #[error("this part of the view holds nothing that could be cut off")]
    NoPart,
    #[error(transparent)]
    Level(#[from] LevelError),
    #[error("nothing of the sculpture would be left")]
    Nothing,
    #[error("the result cannot be sculpted: {0}")]
    Build(String),
    #[error(
        "the sculpture changed {TRIES} times while the result was computed. Pause sculpting and \
         try again"
    )]
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
    /// The world refused it.
    #[error(transparent)]
    Refused(#[from] SceneError),
    #[error(transparent)]
    NoAnswer(#[from] NoAnswer),
    #[error(transparent)]
    Combine(#[from] CombineError),
    #[error(transparent)]
    Snap(#[from] SnapError),
    #[error(transparent)]
    FaceSets(#[from] SetsError),
    #[error(transparent)]
    Extract(#[from] ExtractError),
    #[error(transparent)]
    Mask(#[from] MeasuredMaskError),
}

impl OperationError {
    /// Returns whether the result was computed from objects that are no longer as they were.
    fn is_stale(&self) -> bool {
        matches!(
            self,
            OperationError::Refused(
                SceneError::Stale | SceneError::Changed(_) | SceneError::MaskChanged
            )
        )
    }
}

/// A result, ready to be installed.
#[derive(Debug)]
pub struct Computed<T> {
    /// Carried out only if the objects that it was computed from have not changed.
    pub edit: QueuedCommand,
    /// Carried out after `edit`.
    pub then: Option<Command>,
    /// The result.
    pub made: T,
}

impl<T> Computed<T> {
    /// Returns a result that replaces the active object's clay, which must still be the one that
    /// `shown` shows.
    pub fn of_clay(shown: &Published, queued: QueuedCommand, made: T) -> Computed<T> {
        let (clay, revision) = shown.clay_revision();
        // A local cut itself checks whether it still fits.
        let revision = (!matches!(queued.command, Command::Cut(_))).then_some(revision);
        let command = queued.command;
        let command = Command::OfClay(Box::new(OfClay { clay, revision, command }));
        Computed { edit: QueuedCommand { command, ..queued }, then: None, made }
    }

    /// Returns the commands, for a loop that waits for no result.
    pub fn into_commands(self) -> Vec<QueuedCommand> {
        std::iter::once(self.edit).chain(self.then.map(QueuedCommand::from)).collect()
    }

    /// Returns a change of the scene; the command itself names the objects that it depends on.
    pub fn of_scene(command: SceneCommand, payload: Option<Payload>, made: T) -> Computed<T> {
        let edit = QueuedCommand { payload, ..Command::Scene(command).into() };
        Computed { edit, then: None, made }
    }
}

impl Computed<Placed> {
    /// Returns an object laid flush on a face of another.
    pub fn of_snap(placed: Placed) -> Computed<Placed> {
        Computed::of_scene(SceneCommand::Snap(Box::new(placed.placing)), None, placed)
    }
}

/// Outcome of an operation.
#[derive(Debug, Clone, Copy)]
pub struct Installed<T> {
    /// The result.
    pub made: T,
    /// Answer of the world.
    pub answer: Answer,
    /// The tick that installed it.
    pub tick: u64,
    /// Number of times that the result was computed.
    pub tries: usize,
}

/// The loop, as operations see it.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    pub published: &'a ArcSwap<Published>,
    pub commands: &'a CommandSender,
}

/// Computes a result, has the loop install it and waits for the answer.
///
/// # Errors
/// Why nothing was changed.
pub fn carry_out<T>(
    to: Target<'_>,
    job: &Job,
    compute: impl Fn(&Published) -> Result<Computed<T>, OperationError>,
) -> Result<Installed<T>, OperationError> {
    for tries in 1..=TRIES {
        let Computed { edit, then, made } = compute(&to.published.load_full())?;
        job.check()?;
        let answered = to.commands.carry_out(edit, PATIENCE)?;
        match answered.result.map_err(OperationError::from) {
            Ok(answer) => {
                let mut tick = answered.tick;
                if let Some(command) = then {
                    let after = to.commands.carry_out(command, PATIENCE)?;
                    after.result?;
                    tick = after.tick;
                }
                return Ok(Installed { made, answer, tick, tries });
            }
            Err(e) if e.is_stale() => {}
            Err(e) => return Err(e),
        }
    }
    Err(OperationError::Restless)
}
