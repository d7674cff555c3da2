//! What came of a command. Each command of a step has one answer, at the same place in
//! [`crate::world::World::answers`].

use crate::scene::{ObjectId, SceneError};
use sculptd_clay::Grafted;

/// What a command that was carried out came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// It was carried out.
    Done,
    /// A command to the scene was carried out: the object that it made or was about, see
    /// [`crate::world::SceneResult`].
    Object(ObjectId),
    /// A local cut was made.
    Cut(Grafted),
    /// There was nothing in memory to undo or redo. The history of the session may hold more.
    NothingInMemory,
    /// Its pages follow in later ticks; [`crate::world::World::late_answer`] tells what came of it.
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

/// What came of a command. After an error the world is as it was.
pub type CommandResult = Result<Answer, SceneError>;
