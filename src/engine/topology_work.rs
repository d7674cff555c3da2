//! The work list of dynamic topology: balls in which triangles are still to be brought to their
//! size.
//!
//! Laws kept here:
//! * The pen comes first: dabs move clay before a tick's topology work begins, and what they cost
//!   is taken from its budget.
//! * The work of a tick is bounded by counted operations, so that a replay stops at the same one.
//!   What does not fit is carried over to the next tick, the newest ball first.
//! * The list is empty whenever the world is at rest: it is no part of a saved state.

use sculptd_clay::{Clay, Cuts, Detail, Workers};

/// Counted operations of a tick: about two milliseconds on one core.
const TICK_BUDGET: u64 = 1_600;
/// What is left to topology where the dabs of the tick have used the budget up.
const LEAST_BUDGET: u64 = 400;
/// Vertices that dabs visit in the time of one operation.
const VISITS: u64 = 16;
/// Balls that one pass looks at together: those that a few ticks of a stroke leave, so that pages
/// which they share are looked through once.
const TOGETHER: usize = 8;
/// Balls that wait, at most. They lie a quarter of a radius apart, so a stroke of 250 radii fits;
/// beyond it the oldest is dropped, and its triangles keep their size until the next stroke there.
const MOST: usize = 1024;
/// A ball that lies so near another, as a share of its radius, adds nothing to it.
const APART: f32 = 0.25;

/// What is still to be done.
#[derive(Debug, Default)]
pub(crate) struct TopologyWork {
    balls: Vec<Detail>,
}

impl TopologyWork {
    /// Nothing waits; there is room for all that may.
    pub(crate) fn new() -> TopologyWork {
        TopologyWork { balls: Vec::with_capacity(MOST) }
    }

    /// Whether nothing waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.balls.is_empty()
    }

    /// Forgets what waits.
    pub(crate) fn clear(&mut self) {
        self.balls.clear();
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
        }
        self.balls.push(ball);
    }

    /// Does what fits in the budget of a tick in which dabs have visited so many vertices.
    pub(crate) fn run(&mut self, clay: &mut Clay, workers: &Workers, visited: u64) -> Cuts {
        let mut sum = Cuts::default();
        let budget = TICK_BUDGET.saturating_sub(visited / VISITS).max(LEAST_BUDGET) as usize;
        while !self.balls.is_empty() && sum.work < budget {
            let first = self.balls.len().saturating_sub(TOGETHER);
            let done = clay.adapt_topology(&self.balls[first..], budget - sum.work, workers);
            sum.splits += done.splits;
            sum.collapses += done.collapses;
            sum.flips += done.flips;
            sum.work += done.work;
            // Where nothing could be changed, nothing will be.
            if !done.unfinished || done.changes() == 0 {
                self.balls.truncate(first);
            } else {
                break;
            }
        }
        sum
    }
}
