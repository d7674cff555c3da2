//! The work list of dynamic topology: balls in which triangles are still to be brought to their
//! size.
//!
//! Laws kept here:
//! * The pen comes first: dabs move clay before a tick's topology work begins, and what they cost
//!   is taken from its budget.
//! * The work of a tick is bounded by counted work, looking through pages and writing them
//!   included, so that a replay stops at the same operation. What does not fit is carried over to
//!   the next tick, the newest ball first.
//! * Work that follows a stroke finds its topology done: [`TopologyWork::finish`] does the waiting
//!   work within a separate bound. Work dropped because of a bound is counted.
//! * The list is empty whenever the world is at rest: it is no part of a saved state.

use sculptd_clay::{Clay, Cuts, Detail, LEAST_TOPOLOGY_BUDGET, Workers};

/// Counted work of a tick: about two milliseconds on one core.
const TICK_BUDGET: u64 = 8_000;
/// Counted work at most where a stroke must be finished at once, as before an undo: about twenty
/// milliseconds on one core.
const FINISH_BUDGET: usize = 80_000;
/// Vertices that dabs visit in the time of one operation.
const VISITS: u64 = 16;
/// Number of balls that one pass handles together: about what a few ticks of a stroke leave, so
/// that shared pages are searched once.
const TOGETHER: usize = 8;
/// Balls that wait, at most. They lie a quarter of a radius apart, so a stroke of 250 radii fits;
/// beyond it the oldest is dropped, and its triangles keep their size until the next stroke there.
const MOST: usize = 1024;
/// A ball that lies so near another, as a share of its radius, adds nothing to it.
const APART: f32 = 0.25;

/// Topology work that remains.
#[derive(Debug, Default)]
pub(crate) struct TopologyWork {
    balls: Vec<Detail>,
    /// Balls that were dropped before they were done, since this was last asked for.
    dropped: u64,
}

impl TopologyWork {
    /// Nothing waits; there is room for all that may.
    pub(crate) fn new() -> TopologyWork {
        TopologyWork { balls: Vec::with_capacity(MOST), dropped: 0 }
    }

    /// Returns true if no ball waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.balls.is_empty()
    }

    /// Balls that were dropped before they were done since the last call.
    pub(crate) fn take_dropped(&mut self) -> u64 {
        std::mem::take(&mut self.dropped)
    }

    /// Adds a ball, unless one that is nearly the same waits already.
    pub(crate) fn add(&mut self, ball: Detail) {
        let near = |other: &Detail| {
            let apart = (other.centre - ball.centre).length() + (other.radius - ball.radius).abs();
            apart < APART * ball.radius
                && (other.edge - ball.edge).abs() < 0.1 * ball.edge
                && (other.split, other.collapse) == (ball.split, ball.collapse)
        };
        if self.balls.iter().rev().any(near) {
            return;
        }
        if self.balls.len() == MOST {
            self.balls.remove(0);
            self.dropped += 1;
        }
        self.balls.push(ball);
    }

    /// Does what fits in the budget of a tick in which dabs have visited so many vertices.
    pub(crate) fn run(&mut self, clay: &mut Clay, workers: &Workers, visited: u64) -> Cuts {
        let budget = TICK_BUDGET.saturating_sub(visited / VISITS) as usize;
        self.work(clay, workers, budget.max(LEAST_TOPOLOGY_BUDGET))
    }

    /// Does all that waits, as far as the bound lets it; the rest is dropped and counted.
    pub(crate) fn finish(&mut self, clay: &mut Clay, workers: &Workers) {
        self.work(clay, workers, FINISH_BUDGET);
        self.dropped += self.balls.len() as u64;
        self.balls.clear();
    }

    fn work(&mut self, clay: &mut Clay, workers: &Workers, budget: usize) -> Cuts {
        let (mut sum, mut most) = (Cuts::default(), usize::MAX);
        while !self.balls.is_empty() {
            let first = self.balls.len().saturating_sub(TOGETHER);
            let left = (budget - sum.work).min(most);
            let done = clay.adapt_topology(&self.balls[first..], left, workers);
            sum.splits += done.splits;
            sum.collapses += done.collapses;
            sum.flips += done.flips;
            sum.slides += done.slides;
            sum.work += done.work;
            if done.tangled && most > LEAST_TOPOLOGY_BUDGET {
                most = LEAST_TOPOLOGY_BUDGET;
            } else if !done.unfinished {
                self.dropped += if done.tangled { (self.balls.len() - first) as u64 } else { 0 };
                self.balls.truncate(first);
            }
            // With less a pass might get nowhere.
            if sum.work + LEAST_TOPOLOGY_BUDGET > budget {
                break;
            }
        }
        sum
    }
}
