//! The loop on a clock that is moved by hand: recordings and simulated devices are fed tick by
//! tick, through their real parsers and the real channel, so that two runs give the same bits
//! however loaded the machine is.
//!
//! A tick here: move the clock to the tick's time, let every feed deliver what is due, wait until
//! the channel has it, take it, step the world. In real pace the loop also sleeps until the tick is
//! due on the wall's clock.

use std::time::Duration;

use super::pacer::Pacer;
use super::published::{Published, PublishedFigures, Publisher};
use crate::command_queue::QueuedCommand;
use crate::operations::Computed;
use crate::tick::{Journal, in_order_of_time};
use crate::tick_statistics::{Losses, Summary, TickStatistics, thread_cpu_ns};
use crate::{boolean_jobs, hand_jobs};
use sculptd_clay::GarbageSink;
use sculptd_devices::queue::Receiver;
use sculptd_devices::{Clock, Sample};
use sculptd_engine::command::Command;
use sculptd_engine::world::{StepReport, World};
use sculptd_geometry::job::Job;

/// Something that delivers samples when its time has come.
pub trait Feed {
    /// Delivers everything due at or before `until_us`. Returns how many samples the channel will
    /// have been given by all of this feed's deliveries since the start.
    fn advance(&mut self, until_us: u64) -> u64;
    /// Nothing more will come.
    fn finished(&self) -> bool;
}

/// Speed of a stepped loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Pace {
    /// One second of input takes one second.
    #[default]
    Real,
    /// As fast as the machine can.
    Fast,
}

#[derive(Debug, Clone, Copy)]
pub struct SimulatedOptions {
    pub rate_hz: u32,
    pub pace: Pace,
    /// Ends after this many ticks, if the input has not ended before.
    pub max_ticks: Option<u64>,
    pub drain_per_tick: usize,
    /// `verify_invariants` after every tick: for simulation runs.
    pub verify: bool,
}

/// An adaptor did not hand over what its simulated device sent. Only a broken pipe between threads
/// of this process does this.
#[derive(Debug, thiserror::Error)]
pub enum SimulatedError {
    #[error(
        "the simulated devices sent {expected} samples, but only {arrived} arrived within \
            {PATIENCE:?}"
    )]
    Silent { expected: u64, arrived: u64 },
    #[error("tick {tick}: {text}")]
    Broken { tick: u64, text: String },
}

/// Time limit for bytes to pass a pseudo-terminal or a loopback socket on a loaded machine.
const PATIENCE: Duration = Duration::from_secs(10);

/// Everything a stepped run needs.
pub struct SimulatedLoop<'a> {
    pub world: &'a mut World,
    pub feeds: &'a mut [Box<dyn Feed>],
    pub receiver: &'a mut Receiver,
    /// A manual clock, shared with the adaptors.
    pub clock: &'a Clock,
    pub journal: Option<&'a mut dyn Journal>,
    /// Called after every tick with the tick, its samples, its commands and the world.
    pub observer: &'a mut dyn FnMut(u64, &[Sample], &World),
    /// Commands by tick, in order of ticks.
    pub script: &'a [(u64, Command)],
}

impl std::fmt::Debug for SimulatedLoop<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stepped").field("feeds", &self.feeds.len()).finish_non_exhaustive()
    }
}

impl SimulatedLoop<'_> {
    /// Runs until the feeds and the script have ended and the world is at rest, or `max_ticks`.
    pub fn run(mut self, options: &SimulatedOptions) -> Result<TickStatistics, SimulatedError> {
        let wall = Clock::monotonic();
        let sleeper = spin_sleep::SpinSleeper::default();
        let mut pacer = Pacer::new(options.rate_hz, 0);
        let mut figures = TickStatistics::default();
        let mut samples: Vec<Sample> = Vec::with_capacity(options.drain_per_tick);
        let mut commands = Vec::new();
        // Boolean results that hands requested. They are installed in the next tick, so that a
        // stepped run has no race.
        let mut joined: Vec<QueuedCommand> = Vec::new();
        let mut script = self.script.iter().peekable();
        let first = self.world.tick();
        let mut tick = first;
        let mut quiet = 0;
        while options.max_ticks.is_none_or(|max| tick - first < max) {
            tick += 1;
            if options.pace == Pace::Real {
                pacer.wait(&wall, &sleeper);
            }
            let t_us = ((tick - first) as f64 * 1e6 / f64::from(options.rate_hz)) as u64;
            self.clock.set_us(t_us);
            let expected: u64 = self.feeds.iter_mut().map(|f| f.advance(t_us)).sum();
            samples.clear();
            await_arrival(self.receiver, expected, options.drain_per_tick, &mut samples, &wall)?;
            in_order_of_time(&mut samples);
            commands.clear();
            while let Some((_, command)) = script.next_if(|(at, _)| *at <= tick) {
                commands.push(command.clone());
            }
            commands.extend(joined.drain(..).map(|queued| queued.deliver(self.world)));
            let (begun, begun_cpu) = (wall.now_ns(), thread_cpu_ns());
            let report = *self.world.step(tick, &samples, &commands);
            let took = wall.now_ns() - begun;
            figures.tick(&report, took, thread_cpu_ns() - begun_cpu);
            if let Some(journal) = self.journal.as_deref_mut() {
                journal.tick(tick, &samples, &commands, self.world);
            }
            joined.extend(self.of_hands(&report));
            if let Some(operation) = report.join.and_then(boolean_jobs::operation)
                && let Some(tool) = self.world.thing().map(|t| t.placed().to_poly())
            {
                let shown = Published::of(self.world, PublishedFigures::default());
                match boolean_jobs::join(&shown, tool, true, operation, &Job::default()) {
                    Ok(done) => joined = done.into_commands(),
                    Err(e) => tracing::warn!("{}: {e}", operation.name()),
                }
            }
            if options.verify {
                self.world
                    .verify_invariants()
                    .map_err(|text| SimulatedError::Broken { tick, text })?;
            }
            (self.observer)(tick, &samples, self.world);
            if options.pace == Pace::Real {
                pacer.done(wall.now_us());
                figures.overruns = pacer.overruns;
            }
            let ended = self.feeds.iter().all(|f| f.finished()) && script.peek().is_none();
            quiet = if ended && samples.is_empty() && joined.is_empty() && !report.paused {
                quiet + 1
            } else {
                0
            };
            // Two ticks of silence after the end: the last pen-up was walked, the last hand has let
            // go.
            if quiet >= 2 {
                break;
            }
        }
        Ok(figures)
    }
}

impl SimulatedLoop<'_> {
    /// Carries out at once the jobs that hands request for objects of the scene.
    fn of_hands(&mut self, report: &StepReport) -> Vec<QueuedCommand> {
        let join = report.join.zip(self.world.object_in_hand());
        if join.is_none() && report.put_down.is_none() {
            return Vec::new();
        }
        let shown = Published::of(self.world, PublishedFigures::default());
        match (join, report.put_down) {
            (Some((choice, held)), _) => hand_jobs::join(&shown, held, choice, &Job::default())
                .inspect_err(|e| tracing::warn!("{}: {e}", choice.label()))
                .map(Computed::into_commands)
                .unwrap_or_default(),
            (None, Some(id)) => hand_jobs::lay_down(&shown, id)
                .inspect_err(|e| tracing::warn!("put down: {e}"))
                .ok()
                .flatten()
                .map(Computed::into_commands)
                .unwrap_or_default(),
            (None, None) => Vec::new(),
        }
    }
}

/// Takes samples until everything that was sent is here; the wait is for other threads of this
/// process only.
fn await_arrival(
    receiver: &mut Receiver,
    expected: u64,
    max: usize,
    samples: &mut Vec<Sample>,
    wall: &Clock,
) -> Result<(), SimulatedError> {
    let patience = wall.now_us() + PATIENCE.as_micros() as u64;
    loop {
        let room = max.saturating_sub(samples.len()).max(1);
        receiver.drain(room, samples);
        let count = receiver.stats().total();
        if count.sent >= expected && count.on_the_way() == 0 {
            return Ok(());
        }
        if wall.now_us() > patience {
            return Err(SimulatedError::Silent { expected, arrived: count.sent });
        }
        std::thread::yield_now();
    }
}

/// Returns the summary of a finished run.
pub fn summary(
    figures: &TickStatistics,
    world: &World,
    receiver: &Receiver,
    export: Option<String>,
) -> Summary {
    let count = receiver.stats().total();
    Summary {
        ticks: figures.ticks,
        samples: figures.samples,
        samples_sent: count.sent,
        samples_coalesced: count.coalesced,
        dabs: figures.dabs,
        vertices_moved: figures.vertices_moved,
        losses: Losses { motion: count.lost_motion, transition: count.lost_transition },
        tick_ms: figures.tick_ms(),
        tick_cpu_ms: figures.tick_cpu_ms(),
        overruns: figures.overruns,
        topology_dropped: figures.topology_dropped,
        vertices: world.mesh().vertex_count() as u64,
        triangles: world.mesh().triangle_count() as u64,
        hash: format!("{:016x}", world.hash()),
        export,
        sample_to_tick_ms: figures.sample_to_tick_ms(),
        sample_to_present: None,
    }
}

/// Publishes the world's state.
pub fn publish(world: &mut World, figures: PublishedFigures, publisher: &mut Publisher) {
    publisher.publish(Published::of(world, figures), &GarbageSink::default());
}
