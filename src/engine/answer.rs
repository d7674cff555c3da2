//! Results of commands. Each command of a step has one answer, at the same index in
//! [`crate::world::World::answers`].

use crate::scene::{ObjectId, SceneError};
use sculptd_clay::Grafted;

/// Result of a command that succeeded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// The command was carried out.
    Done,
    /// A command to the scene was carried out: the object that it made or was about, see
    /// [`crate::world::SceneResult`].
    Object(ObjectId),
    /// A local cut was made.
    Cut(Grafted),
    /// There was nothing in memory to undo or redo. The history of the session may hold more.
    NothingInMemory,
    /// Its pages follow in later ticks; [`crate::world::World::late_answer`] returns the final
    /// result.
    UnderWay,
}

impl Answer {
    /// Returns the object that a command to the scene made or was about.
    pub fn object(self) -> Option<ObjectId> {
        match self {
            Answer::Object(id) => Some(id),
            _ => None,
        }
    }
}

/// Result of a command. After an error the world is unchanged.
pub type CommandResult = Result<Answer, SceneError>;
