//! The bounded queue of commands on their way to the loop, each with what it needs besides its own
//! data and with where its result goes.

use std::time::Duration;

use crossbeam_channel as cc;

use sculptd_clay::Grafted;
use sculptd_engine::command::Command;
use sculptd_engine::payload::Payload;
use sculptd_engine::world::{SceneResult, World};

/// A command on its way to the loop.
#[derive(Debug)]
pub struct QueuedCommand {
    /// What is asked.
    pub command: Command,
    /// What the command needs, built or fetched already.
    pub payload: Option<Payload>,
    /// Told what came of a [`Command::Cut`]; `None`: the clay had changed there. The loop never
    /// waits for whoever listens.
    pub result: Option<cc::Sender<Option<Grafted>>>,
    /// Told what came of a [`Command::Scene`].
    pub scene_result: Option<cc::Sender<SceneResult>>,
}

impl From<Command> for QueuedCommand {
    fn from(command: Command) -> Self {
        QueuedCommand { command, payload: None, result: None, scene_result: None }
    }
}

impl QueuedCommand {
    /// A command and the payload that it needs.
    pub fn with_payload(command: Command, payload: Payload) -> Self {
        QueuedCommand { payload: Some(payload), ..QueuedCommand::from(command) }
    }

    /// Puts the payload beside the world; gives the command for the next step.
    pub fn deliver(self, world: &mut World) -> Command {
        let mut command = self.command;
        if let Some(payload) = self.payload {
            world.deliver(&mut command, payload);
        }
        command
    }
}

/// The queue takes no more now, or the loop has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the loop takes no more commands")]
pub struct QueueClosed;

/// The senders' end of the queue.
#[derive(Debug, Clone)]
pub struct CommandSender(cc::Sender<QueuedCommand>);

impl CommandSender {
    /// Sends a command; waits while the queue is full.
    ///
    /// # Errors
    /// When the loop has ended.
    pub fn send(&self, command: impl Into<QueuedCommand>) -> Result<(), QueueClosed> {
        self.0.send(command.into()).map_err(|_| QueueClosed)
    }

    /// Sends a command without waiting.
    ///
    /// # Errors
    /// When the queue is full or the loop has ended.
    pub fn try_send(&self, command: impl Into<QueuedCommand>) -> Result<(), QueueClosed> {
        self.0.try_send(command.into()).map_err(|_| QueueClosed)
    }

    /// Sends a command; waits for at most `patience` while the queue is full.
    ///
    /// # Errors
    /// When the queue is still full then, or the loop has ended.
    pub fn send_timeout(
        &self,
        command: impl Into<QueuedCommand>,
        patience: Duration,
    ) -> Result<(), QueueClosed> {
        self.0.send_timeout(command.into(), patience).map_err(|_| QueueClosed)
    }
}

/// A queue for at most `capacity` commands: the senders' end and the loop's.
pub fn command_queue(capacity: usize) -> (CommandSender, cc::Receiver<QueuedCommand>) {
    let (sender, receiver) = cc::bounded(capacity);
    (CommandSender(sender), receiver)
}
