//! A moment in which the host orders one person's input alone, so that what this person has
//! computed from a sculpture in motion fits it still when it arrives. The others' input waits in
//! its queues, in order, and nothing of it is lost.

use crate::wire::frame::{Batch, PersonId};
use sculptd_engine::command::Command;

/// The longest hold, in microseconds: the command that begins it goes to its sender, and the result
/// comes back, over an ordinary network.
const HOLD_US: u64 = 300_000;
/// The time after it in which no other begins, in microseconds.
const REST_US: u64 = 300_000;

/// The host's side of a hold.
#[derive(Debug, Default)]
pub struct OrderHold {
    /// The holder, and the end at the latest.
    now: Option<(PersonId, u64)>,
    rests_until_us: u64,
}

impl OrderHold {
    /// Returns true if a person's batches are ordered now.
    pub fn admits(&self, person: PersonId, now_us: u64) -> bool {
        self.now.is_none_or(|(holder, until_us)| holder == person || now_us >= until_us)
    }

    /// Takes a batch that was ordered: one that only lifts the sender's pens begins a hold, the
    /// next command of the holder ends it.
    pub fn ordered(&mut self, batch: &Batch, now_us: u64) {
        let begins = matches!(batch.commands[..], [Command::LiftAll]) && batch.samples.is_empty();
        match self.now {
            Some((holder, until_us)) if now_us < until_us => {
                if holder == batch.person && !batch.commands.is_empty() {
                    (self.now, self.rests_until_us) = (None, now_us + REST_US);
                }
            }
            _ if begins && now_us >= self.rests_until_us => {
                self.now = Some((batch.person, now_us + HOLD_US));
                self.rests_until_us = now_us + HOLD_US + REST_US;
            }
            _ => self.now = None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hold_ends_with_the_next_command_or_after_its_time_and_another_one_waits() {
        let batch = |person, command| Batch { person, commands: vec![command], ..Batch::default() };
        let mut hold = OrderHold::default();
        hold.ordered(&batch(2, Command::Undo), 0);
        assert!(hold.admits(1, 0) && hold.admits(2, 0));
        hold.ordered(&batch(2, Command::LiftAll), 1_000);
        assert!(!hold.admits(1, 2_000) && hold.admits(2, 2_000));
        hold.ordered(&batch(2, Command::Undo), 100_000);
        assert!(hold.admits(1, 100_000), "the result is in place");
        hold.ordered(&batch(1, Command::LiftAll), 200_000);
        assert!(hold.admits(2, 200_000), "right after another");
        hold.ordered(&batch(1, Command::LiftAll), 400_000);
        assert!(!hold.admits(2, 699_999) && hold.admits(2, 700_000), "a holder who is silent");
    }
}
