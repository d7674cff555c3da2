//! One way to change a whole object: an operation is computed from an immutable snapshot, on the
//! thread of whoever asks; the loop installs the result where the objects are still as they were,
//! and whoever asked hears what the world did. Window, control socket and hands use this alone.
//!
//! If somebody sculpts on meanwhile, the result follows: see `rebase`. Since a pen that does not
//! rest is always a little ahead, the loop's input is held for a moment at the end, see
//! [`crate::input_hold`]; at a shared sculpture everybody's. A result that cannot follow is
//! computed again, [`TRIES`] times at most, then refused with the reason. It never overwrites a
//! newer stroke, and it is never dropped without a word.

pub mod basis;
mod computed;
mod error;
mod rebase;
mod surface;

use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use crate::command_queue::{CommandAnswer, CommandSender, QueuedCommand};
use crate::input_hold::{HoldGuard, LONGEST_HOLD};
use crate::published::Published;
use basis::Basis;
pub use computed::{Computed, in_place};
pub use error::{OperationError, TRIES};
use rebase::Rebase;
use sculptd_devices::Clock;
use sculptd_engine::answer::Answer;
use sculptd_engine::command::Command;
use sculptd_engine::scene::SceneError;
use sculptd_geometry::job::Job;

/// Time limit for the loop's answer.
const PATIENCE: Duration = Duration::from_secs(60);
/// Rounds in which a result follows the strokes before it is computed again. From the second one
/// on the input is held, if the round before was quick enough.
const ROUNDS: usize = 8;

/// Outcome of an operation.
#[derive(Debug, Clone, Copy)]
pub struct Installed<T> {
    /// The result. Its figures are those from before the strokes that it followed.
    pub made: T,
    /// Answer of the world.
    pub answer: Answer,
    /// The tick that installed it.
    pub tick: u64,
    /// Number of times that the result was computed.
    pub tries: usize,
    /// Number of rounds in which it followed strokes made meanwhile; 0: it fitted at once.
    pub rounds: usize,
}

impl<T> Installed<T> {
    /// What people must know of the figures: the strokes that the result followed are not in them.
    pub fn note(&self) -> Option<String> {
        let text = "strokes made while it was computed were carried over; the figures are those \
                    from before them";
        (self.rounds > 0).then(|| text.to_owned())
    }
}

/// The loop, as operations see it.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    pub published: &'a ArcSwap<Published>,
    pub commands: &'a CommandSender,
}

impl Target<'_> {
    /// Ends every stroke and holds the input. Returns `None` if the loop cannot hold it.
    fn hold(&self) -> Result<Option<HoldGuard>, OperationError> {
        for _ in 0..TRIES {
            let guard = HoldGuard::default();
            let ends = QueuedCommand { hold: Some(guard.hold()), ..Command::LiftAll.into() };
            match self.commands.carry_out(ends, PATIENCE)?.result {
                Ok(_) => return Ok(Some(guard)),
                // Right after another hold.
                Err(SceneError::Busy) => {
                    let _ = cc::never::<()>().recv_timeout(LONGEST_HOLD / 2);
                }
                Err(_) => break,
            }
        }
        Ok(None)
    }

    /// Has the loop install a result. Returns `None` if it was computed from objects that are no
    /// longer as they were.
    fn install(
        &self,
        edit: QueuedCommand,
        held: Option<&HoldGuard>,
    ) -> Result<Option<(Answer, u64)>, OperationError> {
        let edit = QueuedCommand { hold: held.map(HoldGuard::hold), ..edit };
        let CommandAnswer { tick, result } = self.commands.carry_out(edit, PATIENCE)?;
        match result.map_err(OperationError::from) {
            Ok(answer) => Ok(Some((answer, tick))),
            Err(e) if e.is_stale() => Ok(None),
            Err(e) => Err(e),
        }
    }
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
    let clock = Clock::monotonic();
    let mut held = None;
    for tries in 1..=TRIES {
        let begun_us = clock.now_us();
        let Computed { edit, then, made, basis } = compute(&to.published.load_full())?;
        job.check()?;
        let took_us = clock.now_us() - begun_us;
        let basis = basis.map(|basis| (basis, edit.command.clone()));
        let fits = basis.as_ref().is_none_or(|(basis, _)| basis.is_current(&to.published.load()));
        let mut installed = if fits { to.install(edit, held.as_ref())? } else { None };
        drop(held.take());
        let mut rounds = 0;
        if let (None, Some((basis, command))) = (&installed, basis) {
            installed = follow(to, job, basis, command, &mut rounds)?;
        }
        if let Some((answer, mut tick)) = installed {
            if let Some(command) = then {
                let after = to.commands.carry_out(command, PATIENCE)?;
                after.result?;
                tick = after.tick;
            }
            return Ok(Installed { made, answer, tick, tries, rounds });
        }
        // What is quick to compute is at last computed from a sculpture that stands still.
        if tries + 1 == TRIES && Duration::from_micros(took_us) < LONGEST_HOLD {
            held = to.hold()?;
        }
    }
    Err(OperationError::Restless)
}

/// Lets a result follow the strokes made since it was computed, and has the loop install it.
/// Returns `None` if it has to be computed again.
fn follow(
    to: Target<'_>,
    job: &Job,
    basis: Basis,
    command: Command,
    rounds: &mut usize,
) -> Result<Option<(Answer, u64)>, OperationError> {
    if basis.now(&to.published.load()).is_none() {
        return Ok(None);
    }
    let clock = Clock::monotonic();
    let mut rebase = Rebase::new(basis, command, job)?;
    let mut is_quick = false;
    while *rounds < ROUNDS {
        *rounds += 1;
        // The input is held once a round is known to fit the time of a hold.
        let held = if is_quick { to.hold()? } else { None };
        let begun_us = clock.now_us();
        let Some(followed) = rebase.follow(&to.published.load_full(), job)? else {
            return Ok(None);
        };
        job.check()?;
        let took = Duration::from_micros(clock.now_us() - begun_us);
        is_quick = took < LONGEST_HOLD;
        let held_now = held.is_some();
        let current = rebase.is_current(&followed, &to.published.load());
        let installed = if current { to.install(followed.queued, held.as_ref())? } else { None };
        tracing::debug!("round {rounds}: followed in {took:?}, input held: {held_now}");
        if installed.is_some() {
            return Ok(installed);
        }
    }
    Ok(None)
}
