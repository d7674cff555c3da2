//! The fixed rate: when the next tick is due, and what happens when one is late.
//!
//! The overrun policy: a loop never spirals. A tick that ends after the next was due is an overrun;
//! it is counted, the missed slots are left out and the next tick starts at the next slot of the
//! grid. The tick *number* goes on by one, so what the world computes does not depend on how loaded
//! the machine was.

use std::time::Duration;

use sculptd_devices::Clock;

/// Ticks at a fixed rate on a clock of microseconds.
#[derive(Debug, Clone)]
pub struct Pacer {
    period_us: f64,
    /// Slots since the start; the next tick is due at `slot * period`.
    slot: u64,
    start_us: u64,
    pub overruns: u64,
}

/// Time until the next tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Due {
    Now { late_us: u64 },
    In(Duration),
}

impl Pacer {
    /// `rate_hz` from 30 to 1000.
    pub fn new(rate_hz: u32, now_us: u64) -> Self {
        Pacer { period_us: 1e6 / f64::from(rate_hz.max(1)), slot: 0, start_us: now_us, overruns: 0 }
    }

    fn due_us(&self) -> u64 {
        self.start_us + (self.slot as f64 * self.period_us) as u64
    }

    pub fn due(&self, now_us: u64) -> Due {
        let due = self.due_us();
        if now_us >= due {
            Due::Now { late_us: now_us - due }
        } else {
            Due::In(Duration::from_micros(due - now_us))
        }
    }

    /// The tick that was due is done: sets the next slot, leaving out those already missed. Returns
    /// how many were missed.
    pub fn done(&mut self, now_us: u64) -> u64 {
        self.slot += 1;
        if now_us <= self.due_us() {
            return 0;
        }
        let slot_now = ((now_us - self.start_us) as f64 / self.period_us) as u64;
        let missed = (slot_now + 1).saturating_sub(self.slot).saturating_sub(1) + 1;
        self.slot = slot_now + 1;
        self.overruns += 1;
        missed
    }

    /// Leaves out the slots that passed while the loop slept on purpose; they are no overruns.
    /// Returns how many.
    pub fn skip_slept(&mut self, now_us: u64) -> u64 {
        let slot_now = (now_us.saturating_sub(self.start_us) as f64 / self.period_us) as u64;
        let slept = (slot_now + 1).saturating_sub(self.slot);
        self.slot += slept;
        slept
    }

    /// Waits until the next tick is due; a manual clock is never waited for.
    pub fn wait(&self, clock: &Clock, sleeper: &spin_sleep::SpinSleeper) -> u64 {
        loop {
            match self.due(clock.now_us()) {
                Due::Now { late_us } => return late_us,
                Due::In(rest) => match clock {
                    Clock::Monotonic(_) => sleeper.sleep(rest),
                    Clock::Manual(_) => return 0,
                },
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_keep_their_grid_and_a_late_one_is_counted_once() {
        let mut pacer = Pacer::new(100, 0);
        assert_eq!(pacer.due(0), Due::Now { late_us: 0 });
        assert_eq!(pacer.done(3_000), 0);
        assert_eq!(pacer.due(3_000), Due::In(Duration::from_micros(7_000)));
        // The tick of slot 1 takes until 34.5 ms: slots 2 and 3 are missed, slot 4 is next.
        assert_eq!(pacer.done(34_500), 2);
        assert_eq!(pacer.overruns, 1);
        assert_eq!(pacer.due(34_500), Due::In(Duration::from_micros(5_500)));
    }

    #[test]
    fn slots_that_were_slept_through_are_left_out_and_no_overruns() {
        let mut pacer = Pacer::new(100, 0);
        pacer.done(1_000);
        // Slots 1 to 3 pass in sleep; the next tick is the one of slot 4.
        assert_eq!(pacer.skip_slept(34_500), 3);
        assert_eq!(pacer.due(34_500), Due::In(Duration::from_micros(5_500)));
        assert_eq!(pacer.skip_slept(34_600), 0);
        assert_eq!(pacer.overruns, 0);
    }

    #[test]
    fn the_grid_does_not_drift_at_a_rate_that_does_not_divide_a_second() {
        let mut pacer = Pacer::new(144, 0);
        for _ in 0..144 * 3600 {
            let due = pacer.due_us();
            pacer.done(due);
        }
        assert_eq!(pacer.due_us(), 3600 * 1_000_000);
        assert_eq!(pacer.overruns, 0);
    }
}
