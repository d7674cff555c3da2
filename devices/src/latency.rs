//! How long something takes, as quantiles: four steps an octave, so a figure is at most a quarter
//! too high.

use serde::Serialize;

const STEPS: usize = 256;

/// Counts of microseconds. Recording allocates nothing.
#[derive(Debug, Clone)]
pub struct Latency {
    counts: [u64; STEPS],
    sum_us: u64,
}

/// A reading of [`Latency`], in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Quantiles {
    /// Median, in microseconds.
    pub p50: u64,
    /// 99th percentile, in microseconds.
    pub p99: u64,
    /// Maximum, in microseconds.
    pub max: u64,
}

impl Default for Latency {
    fn default() -> Self {
        Latency { counts: [0; STEPS], sum_us: 0 }
    }
}

impl Latency {
    /// Adds one duration, in microseconds.
    pub fn record(&mut self, us: u64) {
        self.counts[step(us)] += 1;
        self.sum_us = self.sum_us.saturating_add(us);
    }

    /// All durations together, microseconds.
    pub fn sum_us(&self) -> u64 {
        self.sum_us
    }

    /// Returns the number of values up to `us`: exact for one less than a power of two, else up to
    /// one step too few.
    pub fn at_most(&self, us: u64) -> u64 {
        let whole = (0..STEPS).take_while(|s| upper(*s) <= us);
        whole.map(|s| self.counts[s]).sum()
    }

    /// The median, the 99th percentile and the maximum; 0 if nothing was recorded.
    pub fn quantiles(&self) -> Quantiles {
        let all: u64 = self.counts.iter().sum();
        let at = |share: f64| {
            let wanted = (all as f64 * share).ceil() as u64;
            let mut seen = 0;
            let found = self.counts.iter().position(|n| {
                seen += n;
                seen >= wanted && seen > 0
            });
            found.map_or(0, upper)
        };
        Quantiles { p50: at(0.5), p99: at(0.99), max: at(1.0) }
    }
}

fn step(us: u64) -> usize {
    if us < 8 {
        return us as usize;
    }
    let octave = us.ilog2() as usize;
    8 + (octave - 3) * 4 + (us >> (octave - 2) & 3) as usize
}

/// The largest value of a step.
fn upper(step: usize) -> u64 {
    if step < 8 {
        return step as u64;
    }
    let (octave, quarter) = (3 + (step - 8) / 4, (step - 8) as u64 % 4);
    let width = 1u64 << (octave - 2);
    (1u64 << octave) + (quarter * width + (width - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_holds_what_it_says() {
        for us in (0..5000).chain([u64::MAX, u64::MAX / 2, 1 << 40]) {
            let high = upper(step(us));
            assert!(high >= us && high as f64 <= us as f64 * 1.25, "{us}: {high}");
        }
        let mut l = Latency::default();
        assert_eq!(l.quantiles(), Quantiles::default());
        (1..=1000).for_each(|us| l.record(us));
        assert_eq!((l.at_most(511), l.at_most(1023), l.sum_us()), (511, 1000, 500_500));
        let q = l.quantiles();
        assert!((500..=640).contains(&q.p50) && (990..=1240).contains(&q.p99), "{q:?}");
    }
}
