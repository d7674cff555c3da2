//! The tick loop as a request reaches it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use arc_swap::ArcSwap;

use crate::Published;
use crate::command_queue::{CommandSender, QueuedCommand};
use crate::operations::Target;
use sculptd_control::RpcError;
use sculptd_engine::answer::Answer;

/// For the loop to say what came of a command.
const PATIENCE: Duration = Duration::from_secs(60);

/// Link to the loop: its command queue and its published state.
#[derive(Debug, Clone, Copy)]
pub struct LoopLink<'a> {
    /// The bounded queue of the loop.
    pub commands: &'a CommandSender,
    /// The newest state.
    pub published: &'a Arc<ArcSwap<Published>>,
    /// Set when the daemon ends.
    pub stop: &'a AtomicBool,
}

impl LoopLink<'_> {
    /// Sends a command to the loop and waits for its result. The published state shows the effect
    /// when this returns.
    ///
    /// # Errors
    /// Returns an error if the world refused the command, or if no answer came.
    pub fn carry_out(&self, command: impl Into<QueuedCommand>) -> Result<Answer, RpcError> {
        let failed = |e: &dyn std::fmt::Display| RpcError::failed(e.to_string());
        let answered = self.commands.carry_out(command, PATIENCE).map_err(|e| failed(&e))?;
        answered.result.map_err(|e| failed(&e))
    }

    /// The loop, as operations see it.
    pub fn target(&self) -> Target<'_> {
        Target { published: self.published, commands: self.commands }
    }

    /// Returns true once the daemon is ending.
    pub fn stopped(&self) -> bool {
        self.stop.load(Relaxed)
    }
}
