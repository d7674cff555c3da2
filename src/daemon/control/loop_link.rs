//! The tick loop as a request reaches it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use arc_swap::ArcSwap;

use crate::Published;
use crate::command_queue::{CommandSender, QueuedCommand};
use sculptd_control::RpcError;

/// Where commands go to and what the loop shows.
#[derive(Debug, Clone, Copy)]
pub struct LoopLink<'a> {
    /// The bounded queue of the loop.
    pub commands: &'a CommandSender,
    /// The newest state.
    pub published: &'a Arc<ArcSwap<Published>>,
    /// Raised when the daemon ends.
    pub stop: &'a AtomicBool,
}

impl LoopLink<'_> {
    /// Hands a command to the loop.
    ///
    /// # Errors
    /// Where the queue is full.
    pub fn send(&self, command: impl Into<QueuedCommand>) -> Result<(), RpcError> {
        let full = "the loop has more commands waiting than it can take; try again";
        self.commands.try_send(command).map_err(|_| RpcError::failed(full))
    }

    /// Whether the daemon ends.
    pub fn stopped(&self) -> bool {
        self.stop.load(Relaxed)
    }
}
