//! Faults of a connection, as ratios and a seed.

use serde::{Deserialize, Serialize};

/// The share of packets that each fault applies to, 0 to 1. All are 0 by default: no faults.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Faults {
    /// The same seed gives the same faults.
    pub seed: u64,
    /// The packet does not arrive.
    pub drop: f32,
    /// The packet arrives twice.
    pub duplicate: f32,
    /// The packet arrives after the next one.
    pub reorder: f32,
    /// Only the beginning of the packet arrives.
    pub tear: f32,
    /// The connection stalls, and then delivers everything that was sent in the meantime at once.
    pub stall: f32,
    /// The device's own clock jumps.
    pub clock_jump: f32,
    /// The device is unplugged; its owner may plug it in again.
    pub unplug: f32,
}

/// One event of the connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event<T> {
    /// The packet arrives as it was sent.
    Whole(T),
    /// Only this share of the packet's bytes arrives, more than 0 and less than 1.
    Torn(T, f32),
    /// Nothing arrives for this many microseconds; what is due in between comes afterwards.
    Stall(u64),
    /// The device's clock moves by this many microseconds.
    ClockJump(i64),
    /// The device is unplugged.
    Unplug,
}

/// A small seeded generator (SplitMix64, Steele et al. 2014): good enough to choose faults, the
/// same on every machine.
#[derive(Debug, Clone)]
pub struct Rng(u64);

impl Rng {
    /// A generator; the same seed gives the same numbers.
    pub fn new(seed: u64) -> Self {
        Rng(seed)
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `0..1`.
    pub fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In `0..n`; 0 for an empty range.
    pub fn below(&mut self, n: u64) -> u64 {
        if n == 0 { 0 } else { self.next_u64() % n }
    }
}

/// A line with its faults: packets go in, events come out.
#[derive(Debug, Clone)]
pub struct Line<T> {
    faults: Faults,
    rng: Rng,
    /// A packet that the next one overtakes.
    held: Option<T>,
}

impl<T: Clone> Line<T> {
    /// A line with nothing on it.
    pub fn new(faults: Faults) -> Self {
        Line { faults, rng: Rng::new(faults.seed), held: None }
    }

    /// Puts a packet on the line.
    pub fn transmit(&mut self, packet: T, mut out: impl FnMut(Event<T>)) {
        let f = self.faults;
        // Each fault draws a random number whether or not an earlier fault happened, so that one
        // ratio does not change the outcome of another.
        let [drop, duplicate, reorder, tear, stall, jump, unplug] =
            [f.drop, f.duplicate, f.reorder, f.tear, f.stall, f.clock_jump, f.unplug]
                .map(|r| self.rng.unit() < r);
        let (share, size) = (0.05 + 0.9 * self.rng.unit(), self.rng.below(1 << 20));
        if stall {
            out(Event::Stall(20_000 + size % 280_000));
        }
        if jump {
            out(Event::ClockJump((size as i64 - (1 << 19)) * 10));
        }
        if unplug {
            out(Event::Unplug);
        }
        let overtaken = self.held.take();
        if drop {
        } else if tear {
            out(Event::Torn(packet, share));
        } else if reorder && overtaken.is_none() {
            self.held = Some(packet);
        } else {
            out(Event::Whole(packet.clone()));
            if duplicate {
                out(Event::Whole(packet));
            }
        }
        if let Some(late) = overtaken {
            out(Event::Whole(late));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_good_line_changes_nothing_and_a_bad_one_repeats_by_its_seed() {
        let run = |faults| {
            let (mut line, mut events) = (Line::new(faults), Vec::new());
            (0..2000).for_each(|i| line.transmit(i, |e| events.push(e)));
            events
        };
        assert_eq!(run(Faults::default()), (0..2000).map(Event::Whole).collect::<Vec<_>>());
        let bad = Faults {
            seed: 7,
            drop: 0.1,
            duplicate: 0.1,
            reorder: 0.1,
            tear: 0.1,
            ..Faults::default()
        };
        assert_eq!(run(bad), run(bad));
        assert_ne!(run(bad), run(Faults { seed: 8, ..bad }));
        let torn = run(bad).iter().filter(|e| matches!(e, Event::Torn(..))).count();
        assert!(
            (120..280).contains(&torn),
            "{torn} of 2000 at a ratio of a tenth, less the dropped"
        );
    }
}
