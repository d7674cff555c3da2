//! What a tick of the live loop and of the simulated one have in common.

use crate::published::PublishedFigures;
use crate::tick_statistics::{Losses, TickStatistics};
use sculptd_devices::Sample;
use sculptd_devices::queue::Receiver;
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

/// Receives the input of each tick for the journal: everything that changed the world.
pub trait Journal: Send {
    /// Called on the tick thread after every tick that had input; must not wait.
    fn tick(&mut self, tick: u64, samples: &[Sample], commands: &[Command], world: &mut World);

    /// Returns true while input waits for room: the loop ticks on until it has been handed over.
    fn has_waiting(&self) -> bool {
        false
    }
}

/// Sorts by time, then by device; equal samples keep their order. Samples arrive nearly sorted, so
/// an insertion sort is fast, and it needs no memory.
pub fn in_order_of_time(samples: &mut [Sample]) {
    for i in 1..samples.len() {
        let mut j = i;
        while j > 0
            && (samples[j - 1].t_us, samples[j - 1].device) > (samples[j].t_us, samples[j].device)
        {
            samples.swap(j - 1, j);
            j -= 1;
        }
    }
}

/// The figures as a viewer sees them.
pub fn published_figures(
    figures: &TickStatistics,
    receiver: &Receiver,
    last_tick_ns: u64,
) -> PublishedFigures {
    let count = receiver.stats().total();
    PublishedFigures {
        ticks: figures.ticks,
        samples: figures.samples,
        dabs: figures.dabs,
        vertices_moved: figures.vertices_moved,
        overruns: figures.overruns,
        topology_dropped: figures.topology_dropped,
        tick_ms: figures.tick_ms(),
        losses: Losses { motion: count.lost_motion, transition: count.lost_transition },
        last_tick_ms: last_tick_ns as f64 / 1e6,
        garbage_overflows: 0,
        input_holds: 0,
        longest_hold_us: 0,
        newest_us: 0,
        newest_tick: 0,
        input_to_snapshot_ms: 0.0,
    }
}
