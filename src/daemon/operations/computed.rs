//! Results on their way to the loop.

use std::sync::Arc;

use super::basis::Basis;
use super::error::OperationError;
use crate::command_queue::QueuedCommand;
use crate::published::Published;
use crate::scene_jobs::Combined;
use crate::snap_jobs::Placed;
use sculptd_clay::{Clay, Levels};
use sculptd_engine::command::{Command, NewClay, OfClay};
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::{SceneCommand, SceneEvent};
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// A result, ready to be installed.
#[derive(Debug)]
pub struct Computed<T> {
    /// Carried out only if the objects that it was computed from have not changed.
    pub edit: QueuedCommand,
    /// Carried out after `edit`.
    pub then: Option<Command>,
    /// The result.
    pub made: T,
    /// What it was computed from, if it can follow later strokes there.
    pub basis: Option<Basis>,
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
        Computed { edit: QueuedCommand { command, ..queued }, then: None, made, basis: None }
    }

    /// The same result, which can follow later strokes on `basis`.
    pub fn following(self, basis: Option<Basis>) -> Computed<T> {
        Computed { basis, ..self }
    }

    /// Returns the commands, for a loop that waits for no result.
    pub fn into_commands(self) -> Vec<QueuedCommand> {
        std::iter::once(self.edit).chain(self.then.map(QueuedCommand::from)).collect()
    }

    /// Returns a change of the scene; the command itself names the objects that it depends on.
    pub fn of_scene(command: SceneCommand, payload: Option<Payload>, made: T) -> Computed<T> {
        let edit = QueuedCommand { payload, ..Command::Scene(command).into() };
        Computed { edit, then: None, made, basis: None }
    }

    /// Returns new objects made of others. A Boolean can follow strokes on its operands; what is
    /// merely copied is as quickly computed again.
    pub fn of_combined(shown: &Published, combined: Combined, made: T) -> Computed<T> {
        let exchange = &combined.exchange;
        let boolean = exchange.event == SceneEvent::Boolean;
        let basis = boolean.then(|| Basis::of_operands(shown, &exchange.from)).flatten();
        let (command, payload) = combined.command();
        Computed::of_scene(command, Some(payload), made).following(basis)
    }
}

impl Computed<Placed> {
    /// Returns an object laid flush on a face of another.
    pub fn of_snap(placed: Placed) -> Computed<Placed> {
        Computed::of_scene(SceneCommand::Snap(Box::new(placed.placing)), None, placed)
    }
}

/// Returns the command that replaces the object's triangles, with masks and levels. The pages are
/// built here.
///
/// # Errors
/// Returns an error if no clay can be built, or if the job was cancelled.
pub fn in_place(
    new: Arc<TriMesh>,
    masks: Option<Vec<f32>>,
    levels: Option<Arc<Levels>>,
    job: &Job,
) -> Result<QueuedCommand, OperationError> {
    let built = Clay::build_masked(&new, masks.as_deref().unwrap_or(&[]), job);
    let built = built.map_err(|e| OperationError::Build(e.to_string()))?;
    let mut clay = NewClay::new(new, true);
    clay.levels = levels;
    let command = match masks {
        Some(masks) => Command::ReplaceMasked(clay, Arc::new(masks)),
        None => Command::Replace(clay),
    };
    Ok(QueuedCommand::with_payload(command, Payload::Clay(Box::new(built))))
}
