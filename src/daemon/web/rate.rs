//! Bounds on what one page may send.

/// Units a second, with a reserve for bursts of one second.
#[derive(Debug)]
pub struct RateLimit {
    per_second: u64,
    /// Millionths of a unit.
    left: u64,
    seen_us: u64,
}

impl RateLimit {
    /// Creates a limit whose reserve is full.
    pub fn new(per_second: u64, now_us: u64) -> RateLimit {
        RateLimit { per_second, left: per_second * 1_000_000, seen_us: now_us }
    }

    /// Takes units. Returns false if they exceed the limit.
    pub fn take(&mut self, units: u64, now_us: u64) -> bool {
        let passed = now_us.saturating_sub(self.seen_us).min(1_000_000);
        self.seen_us = now_us;
        self.left = (self.left + passed * self.per_second).min(self.per_second * 1_000_000);
        let Some(left) = self.left.checked_sub(units.saturating_mul(1_000_000)) else {
            return false;
        };
        self.left = left;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_of_a_second_and_then_the_rate() {
        let mut limit = RateLimit::new(100, 0);
        assert!((0..100).all(|_| limit.take(1, 0)) && !limit.take(1, 0));
        assert!(limit.take(1, 10_000) && !limit.take(1, 10_000));
        assert!(limit.take(100, 5_000_000) && !limit.take(1, 5_000_000));
        assert!(!limit.take(u64::MAX, 9_000_000));
    }
}
