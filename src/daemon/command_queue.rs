//! The bounded queue of commands to the loop. Each command carries its payload and the channel for
//! its answer.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

use crossbeam_channel as cc;

use crate::event_clock::EventClock;
use crate::input_hold::InputHold;
use sculptd_engine::answer::CommandResult;
use sculptd_engine::command::Command;
use sculptd_engine::payload::Payload;
use sculptd_engine::scene::SceneError;
use sculptd_engine::world::World;

/// A command on its way to the loop.
#[derive(Debug)]
pub struct QueuedCommand {
    /// The command to carry out.
    pub command: Command,
    /// Data that the command needs, built or fetched in advance.
    pub payload: Option<Payload>,
    /// Channel for the answer. It is sent once the published state shows the effect. The loop never
    /// waits for the receiver.
    pub answer: Option<cc::Sender<CommandAnswer>>,
    /// Time of the event that asked for it, on the clock of the samples, in microseconds: older
    /// samples are stepped before it, newer ones after it. `None`: it is carried out at once.
    pub t_us: Option<u64>,
    /// The hold that this command starts, or whose holder sent it.
    pub hold: Option<InputHold>,
    /// A visit of an installation begins with it: see [`crate::kiosk::visit_door`].
    pub begins_visit: bool,
}

/// Result of a command, and the tick of its effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandAnswer {
    /// The tick that carried out or refused the command.
    pub tick: u64,
    /// Result of the command, or the reason for refusing it.
    pub result: CommandResult,
}

/// Reason that no answer came.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoAnswer {
    /// The queue stayed full: nothing was sent.
    #[error("the loop has more commands waiting than it can take. Try again")]
    Full,
    /// The command was sent and may still be carried out.
    #[error("no answer came within {0} s; the command may still be carried out")]
    Late(u64),
    /// The loop has ended, or the sculpture was replaced before it came to the command.
    #[error(
        "no answer will come: the loop ended, or the sculpture was replaced; look at what is there"
    )]
    Ended,
}

impl From<Command> for QueuedCommand {
    fn from(command: Command) -> Self {
        QueuedCommand {
            command,
            payload: None,
            answer: None,
            t_us: None,
            hold: None,
            begins_visit: false,
        }
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
pub struct CommandSender {
    queue: cc::Sender<QueuedCommand>,
    /// Channel for the answers that no caller waits for.
    answers: Option<cc::Sender<CommandAnswer>>,
    /// Gives commands the times of the events that asked for them.
    clock: Option<EventClock>,
    /// The tick of the newest effect that was waited for; 0 for none.
    effect: Arc<AtomicU64>,
}

impl CommandSender {
    /// Returns the sender of one client, with a separate record of that client's effects.
    pub fn of_client(&self) -> Self {
        CommandSender { effect: Arc::default(), ..self.clone() }
    }

    /// Records an effect at `tick` that came about otherwise than by [`Self::carry_out`].
    pub fn had_effect(&self, tick: u64) {
        self.effect.fetch_max(tick, Relaxed);
    }

    /// Returns the tick of the newest effect since this was last called, if there was one.
    pub fn take_effect(&self) -> Option<u64> {
        Some(self.effect.swap(0, Relaxed)).filter(|tick| *tick > 0)
    }

    /// Returns the sender of a window. Its commands report their results to `answers`, so that no
    /// refusal is lost if the caller does not wait, and have the times of `clock`, so that they are
    /// carried out between the samples before and after them.
    pub fn of_window(&self, answers: cc::Sender<CommandAnswer>, clock: EventClock) -> Self {
        CommandSender { answers: Some(answers), clock: Some(clock), ..self.clone() }
    }

    fn with_answer(&self, command: impl Into<QueuedCommand>) -> QueuedCommand {
        let mut queued = command.into();
        queued.answer = queued.answer.or_else(|| self.answers.clone());
        queued.t_us = queued.t_us.or_else(|| Some(self.clock.as_ref()?.now_us()));
        queued
    }

    /// Sends a command; waits while the queue is full.
    ///
    /// # Errors
    /// Returns [`QueueClosed`] if the loop has ended.
    pub fn send(&self, command: impl Into<QueuedCommand>) -> Result<(), QueueClosed> {
        self.queue.send(self.with_answer(command)).map_err(|_| QueueClosed)
    }

    /// Sends a command and waits for its answer: when this returns, the published state shows the
    /// effect. Waits for at most `patience` for room in the queue, and as long for the answer.
    ///
    /// # Errors
    /// Returns [`NoAnswer`] if no answer came. A refusal counts as an answer.
    pub fn carry_out(
        &self,
        command: impl Into<QueuedCommand>,
        patience: Duration,
    ) -> Result<CommandAnswer, NoAnswer> {
        let (answer, answered) = cc::bounded(1);
        let queued = QueuedCommand { answer: Some(answer), ..self.with_answer(command) };
        self.queue.send_timeout(queued, patience).map_err(|e| match e {
            cc::SendTimeoutError::Timeout(_) => NoAnswer::Full,
            cc::SendTimeoutError::Disconnected(_) => NoAnswer::Ended,
        })?;
        let answered = answered.recv_timeout(patience).map_err(|e| match e {
            cc::RecvTimeoutError::Timeout => NoAnswer::Late(patience.as_secs()),
            cc::RecvTimeoutError::Disconnected => NoAnswer::Ended,
        })?;
        if answered.result.is_ok() {
            self.had_effect(answered.tick);
        }
        Ok(answered)
    }

    /// Sends a command without waiting.
    ///
    /// # Errors
    /// Returns [`QueueClosed`] if the queue is full or the loop has ended.
    pub fn try_send(&self, command: impl Into<QueuedCommand>) -> Result<(), QueueClosed> {
        self.queue.try_send(self.with_answer(command)).map_err(|e| {
            if let cc::TrySendError::Full(QueuedCommand { answer: Some(answer), .. }) = e {
                let _ = answer.try_send(CommandAnswer { tick: 0, result: Err(SceneError::Busy) });
            }
            QueueClosed
        })
    }

    /// Sends a command; waits for at most `patience` while the queue is full.
    ///
    /// # Errors
    /// Returns [`QueueClosed`] if the queue is still full after `patience`, or the loop has ended.
    pub fn send_timeout(
        &self,
        command: impl Into<QueuedCommand>,
        patience: Duration,
    ) -> Result<(), QueueClosed> {
        self.queue.send_timeout(self.with_answer(command), patience).map_err(|_| QueueClosed)
    }
}

/// A queue for at most `capacity` commands: the senders' end and the loop's.
pub fn command_queue(capacity: usize) -> (CommandSender, cc::Receiver<QueuedCommand>) {
    let (sender, receiver) = cc::bounded(capacity);
    (CommandSender { queue: sender, answers: None, clock: None, effect: Arc::default() }, receiver)
}
