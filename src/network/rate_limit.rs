//! Bounds on what one sender may cost: a bucket of tokens that fills with time.

/// A bucket of tokens.
#[derive(Debug, Clone, Copy)]
pub struct RateLimit {
    tokens: f64,
    most: f64,
    per_us: f64,
    at_us: u64,
}

impl RateLimit {
    /// Full at first; `per_s` tokens come back a second, up to `most`.
    pub fn new(most: f64, per_s: f64, now_us: u64) -> Self {
        RateLimit { tokens: most, most, per_us: per_s / 1e6, at_us: now_us }
    }

    /// Takes tokens; false, and nothing taken, where there are not so many.
    pub fn take(&mut self, count: f64, now_us: u64) -> bool {
        let passed = now_us.saturating_sub(self.at_us) as f64;
        self.at_us = self.at_us.max(now_us);
        self.tokens = (self.tokens + passed * self.per_us).min(self.most);
        let enough = self.tokens >= count;
        if enough {
            self.tokens -= count;
        }
        enough
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_gives_what_it_holds_and_fills_with_time() {
        let mut limit = RateLimit::new(10.0, 5.0, 0);
        assert!(limit.take(10.0, 0) && !limit.take(1.0, 0));
        assert!(!limit.take(6.0, 1_000_000) && limit.take(5.0, 1_000_000));
        assert!(limit.take(10.0, 9_000_000), "never more than it holds");
        assert!(!limit.take(1.0, 9_000_000));
    }
}
