//! Rules for shared commands. Commands that need data of one daemon, or that would replace
//! everybody's work, are not shared. The sender refuses them, and the host refuses them again.

use crate::wire::frame::{Batch, MAX_COMMAND};
use sculptd_engine::command::Command;

/// Why a command cannot be shared; `None`: it can.
pub fn refused_command(command: &Command) -> Option<&'static str> {
    match command {
        Command::Jump(_) | Command::JumpScene(_) => {
            Some("jumps within the history need the session file of one daemon")
        }
        Command::Begin(_) => Some("a visit begins anew for one installation alone"),
        Command::Reopened | Command::OnePerson => {
            Some("nobody but the host ends what can be taken back")
        }
        Command::Cut(_) => Some("a cut is computed for one replica"),
        Command::OfPerson(_) => Some("whose a command is, the host says"),
        Command::OfClay(of) => match &of.command {
            Command::OfClay(_) | Command::Rebased(_) => Some("it is nested"),
            other => refused_command(other),
        },
        Command::Rebased(rebased) => match &rebased.command {
            Command::Rebased(_) => Some("it is nested"),
            other => refused_command(other),
        },
        _ => None,
    }
}

/// Why a batch is not taken; `None`: it is.
pub fn refused(batch: &Batch) -> Option<&'static str> {
    batch.commands.iter().find_map(refused_command)
}

/// Returns the bytes of a command; `None`: more than [`MAX_COMMAND`].
pub fn size(command: &Command) -> Option<usize> {
    let bytes = postcard::to_stdvec(command).ok()?.len();
    (bytes <= MAX_COMMAND).then_some(bytes)
}
