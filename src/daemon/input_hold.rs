//! A short hold of the loop's input, so that a result that was computed from a sculpture in motion
//! can catch up with it and be installed.
//!
//! The command that starts a hold ends every open stroke. Until the holder lets go, the loop takes
//! no samples and no commands but the holder's; they wait in their channels, in order, and nothing
//! of them is lost. Ticks go on. The loop itself ends a hold after [`LONGEST_HOLD`], at a shared
//! sculpture after [`SHARED_HOLD`], whatever the holder does: it never waits for anyone.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

/// The longest hold, and the shortest time between two. A pen that stands still for a tenth of
/// a second is noticed but not lost; its samples, 1,000 a second at most, fit the channel.
pub const LONGEST_HOLD: Duration = Duration::from_millis(100);
/// The longest hold at a shared sculpture, where the holder's commands come back by way of the
/// host, which holds the input of the others for as long.
pub const SHARED_HOLD: Duration = Duration::from_millis(300);

/// A hold as the loop and the commands of the holder know it.
#[derive(Debug, Clone, Default)]
pub struct InputHold(Arc<AtomicBool>);

impl InputHold {
    /// Returns true if both are the same hold.
    pub fn is(&self, other: &InputHold) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Returns true once the holder has let go.
    pub fn is_released(&self) -> bool {
        self.0.load(Relaxed)
    }
}

/// Lets the input go when it is dropped.
#[derive(Debug, Default)]
pub struct HoldGuard(InputHold);

impl HoldGuard {
    /// The hold, for the holder's commands.
    pub fn hold(&self) -> InputHold {
        self.0.clone()
    }
}

impl Drop for HoldGuard {
    fn drop(&mut self) {
        self.0.0.store(true, Relaxed);
    }
}

/// The loop's side: the hold under way, and the figures of all holds.
#[derive(Debug, Default)]
pub struct LoopHold {
    /// The hold, and its end at the latest.
    now: Option<(InputHold, u64)>,
    begun_us: u64,
    /// Before this time no other hold begins.
    rests_until_us: u64,
    /// Number of holds.
    pub count: u64,
    /// Duration of the longest, in microseconds.
    pub longest_us: u64,
}

impl LoopHold {
    /// Returns the hold under way.
    pub fn now(&self) -> Option<&InputHold> {
        self.now.as_ref().map(|(hold, _)| hold)
    }

    /// Begins a hold of this length at most. Returns false, and begins none, during another and for
    /// a while after it.
    pub fn begin(&mut self, hold: InputHold, now_us: u64, longest: Duration) -> bool {
        let free = self.now.is_none() && now_us >= self.rests_until_us;
        if free {
            self.now = Some((hold, now_us + longest.as_micros() as u64));
            self.begun_us = now_us;
            self.count += 1;
        }
        free
    }

    /// Ends the hold if the holder has let go, if its time is over, or if the loop `stops`.
    pub fn end(&mut self, now_us: u64, stops: bool) {
        let Some((hold, until_us)) = &self.now else { return };
        if stops || hold.is_released() || now_us >= *until_us {
            self.longest_us = self.longest_us.max(now_us.saturating_sub(self.begun_us));
            self.rests_until_us = now_us + LONGEST_HOLD.as_micros() as u64;
            self.now = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hold_ends_when_it_is_dropped_or_after_its_time_and_the_next_one_waits() {
        let mut held = LoopHold::default();
        let guard = HoldGuard::default();
        assert!(held.begin(guard.hold(), 1_000_000, LONGEST_HOLD));
        held.end(1_050_000, false);
        assert!(held.now().is_some_and(|h| h.is(&guard.hold())));
        // A second one has to wait.
        let second = HoldGuard::default();
        assert!(!held.begin(second.hold(), 1_050_000, LONGEST_HOLD));
        drop(guard);
        held.end(1_060_000, false);
        assert!(held.now().is_none() && !held.begin(second.hold(), 1_159_999, LONGEST_HOLD));
        // A holder that forgets to let go.
        assert!(held.begin(second.hold(), 1_160_000, LONGEST_HOLD));
        std::mem::forget(second);
        held.end(1_259_999, false);
        assert!(held.now().is_some());
        held.end(1_260_000, false);
        assert!(held.now().is_none());
        assert_eq!((held.count, held.longest_us), (2, 100_000));
        // At a shared sculpture the way is longer.
        assert!(held.begin(InputHold::default(), 1_400_000, SHARED_HOLD));
        held.end(1_699_999, false);
        assert!(held.now().is_some());
        held.end(1_700_000, false);
        assert!(held.now().is_none());
        // A loop that stops holds nothing back.
        assert!(held.begin(InputHold::default(), 2_000_000, LONGEST_HOLD));
        held.end(2_000_001, true);
        assert!(held.now().is_none());
    }
}
