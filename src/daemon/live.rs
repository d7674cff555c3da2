//! The loop on the wall's clock: a thread of its own, fed by the adaptors' threads, read by the
//! viewer.
//!
//! Law kept here: the tick thread never waits for anybody. It takes what the channel holds, steps,
//! publishes, sleeps.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;

use super::pacer::Pacer;
use super::page_thread::PageThread;
use super::published::{Published, PublishedFigures, Publisher};
use crate::boolean_jobs::{BooleanJobs, HandRequest};
use crate::command_queue::{CommandSender, QueuedCommand, command_queue};
use crate::config::LoopConfig;
use crate::garbage_thread::{GarbageThread, discard_commands};
use crate::pen_trail::{PenTrail, PenTrailSender, pen_trail};
use crate::tablet_actions::TabletActions;
use crate::tick::{Journal, in_order_of_time, published_figures};
use crate::tick_statistics::{TickStatistics, thread_cpu_ns};
use sculptd_clay::Grafted;
use sculptd_devices::queue::Receiver;
use sculptd_devices::{Clock, Sample};
use sculptd_engine::command::Command;
use sculptd_engine::payload::PayloadStore;
use sculptd_engine::world::{SceneResult, World};

/// Commands waiting for the loop; a sender beyond it is told so and tries again.
pub const COMMANDS: usize = 1024;
/// Commands taken a tick: the store beside the world has room for the payload of each.
const COMMANDS_PER_TICK: usize = PayloadStore::CAPACITY;
/// Ticks after the stop for what the adaptors sent before it.
const LAST_TICKS: u32 = 8;

/// A running loop.
#[derive(Debug)]
pub struct Live {
    pub commands: CommandSender,
    pub published: Arc<ArcSwap<Published>>,
    /// Where the pens of tablets were, for the window.
    pub pen_trail: PenTrail,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Ended>,
}

/// A loop that has ended, with all that it held.
#[derive(Debug)]
pub struct Ended {
    pub world: World,
    pub figures: TickStatistics,
    pub receiver: Receiver,
}

#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    #[error("the tick thread could not be started: {0}")]
    Start(std::io::Error),
    /// A bug: the world cannot fail.
    #[error("the tick thread ended by a panic")]
    Panicked,
}

impl Live {
    pub fn start(
        world: World,
        receiver: Receiver,
        clock: Clock,
        config: LoopConfig,
        drain_per_tick: usize,
        journal: Option<Box<dyn Journal>>,
    ) -> Result<Self, LiveError> {
        Live::start_with(world, receiver, clock, config, (drain_per_tick, None), journal)
    }

    /// As [`Live::start`], with the controls of tablets at work.
    ///
    /// # Errors
    /// Where a thread cannot be started.
    pub fn start_with(
        mut world: World,
        receiver: Receiver,
        clock: Clock,
        config: LoopConfig,
        (drain_per_tick, actions): (usize, Option<TabletActions>),
        journal: Option<Box<dyn Journal>>,
    ) -> Result<Self, LiveError> {
        let (commands, inbox) = command_queue(COMMANDS);
        let garbage = GarbageThread::start().map_err(LiveError::Start)?;
        world.set_garbage_sink(garbage.sink());
        world.set_page_supply(PageThread::start().map_err(LiveError::Start)?.supply());
        let publisher = Publisher::new(Published::of(&mut world, PublishedFigures::default()));
        let published = publisher.reader();
        let stop = Arc::new(AtomicBool::new(false));
        let (trail, pen_trail) = pen_trail();
        let ticking = Ticking {
            world,
            receiver,
            clock,
            inbox,
            publisher,
            stop: stop.clone(),
            rate_hz: config.rate_hz,
            drain_per_tick,
            actions,
            journal,
            garbage,
            trail,
            // Without its thread the hands' menu cannot join: that is said when it is asked to.
            joiner: BooleanJobs::start(published.clone(), commands.clone()).ok(),
        };
        let thread = std::thread::Builder::new()
            .name("sculptd-tick".into())
            .spawn(move || ticking.run())
            .map_err(LiveError::Start)?;
        Ok(Live { commands, published, pen_trail, stop, thread })
    }

    pub fn is_running(&self) -> bool {
        !self.thread.is_finished()
    }

    /// Stops after the tick under way and gives everything back.
    pub fn stop(self) -> Result<Ended, LiveError> {
        self.stop.store(true, Relaxed);
        self.thread.join().map_err(|_| LiveError::Panicked)
    }
}

struct Ticking {
    world: World,
    receiver: Receiver,
    clock: Clock,
    inbox: cc::Receiver<QueuedCommand>,
    publisher: Publisher,
    stop: Arc<AtomicBool>,
    rate_hz: u32,
    drain_per_tick: usize,
    actions: Option<TabletActions>,
    journal: Option<Box<dyn Journal>>,
    joiner: Option<BooleanJobs>,
    garbage: GarbageThread,
    trail: PenTrailSender,
}

impl Ticking {
    fn run(mut self) -> Ended {
        raise_priority();
        self.world.warm();
        let garbage = self.garbage.sink();
        let mut pacer = Pacer::new(self.rate_hz, self.clock.now_us());
        let sleeper = spin_sleep::SpinSleeper::default();
        let mut figures = TickStatistics::default();
        let mut samples: Vec<Sample> = Vec::with_capacity(self.drain_per_tick);
        let mut commands: Vec<Command> = Vec::with_capacity(COMMANDS_PER_TICK);
        // Where the result of each cut of this tick goes, in the order of the commands.
        let mut results: Vec<Option<cc::Sender<Option<Grafted>>>> =
            Vec::with_capacity(COMMANDS_PER_TICK);
        let mut scene_results: Vec<Option<cc::Sender<SceneResult>>> =
            Vec::with_capacity(COMMANDS_PER_TICK);
        let mut tick = self.world.tick();
        let mut newest = (0, 0, 0.0);
        let mut last = LAST_TICKS;
        while !self.stop.load(Relaxed) || (last > 0 && self.receiver.waiting() > 0) {
            if self.stop.load(Relaxed) {
                last -= 1;
            }
            pacer.wait(&self.clock, &sleeper);
            tick += 1;
            samples.clear();
            self.receiver.drain(self.drain_per_tick, &mut samples);
            in_order_of_time(&mut samples);
            self.trail.send(&samples);
            for mut queued in self.inbox.try_iter().take(COMMANDS_PER_TICK) {
                let (result, scene_result) = (queued.result.take(), queued.scene_result.take());
                let command = queued.deliver(&mut self.world);
                if command.is_cut() {
                    results.push(result);
                }
                if matches!(command, Command::Scene(_)) {
                    scene_results.push(scene_result);
                }
                commands.push(command);
            }
            if let Some(actions) = &mut self.actions {
                actions.take(&mut samples, &self.world, &mut commands);
            }
            let (begun, begun_cpu) = (self.clock.now_ns(), thread_cpu_ns());
            let report = *self.world.step(tick, &samples, &commands);
            if let Some(journal) = self.journal.as_deref_mut() {
                journal.tick(tick, &samples, &commands, &self.world);
            }
            for (result, made) in results.drain(..).zip(self.world.cut_results()) {
                if let Some(result) = result {
                    let _ = result.try_send(*made);
                }
            }
            for (result, done) in scene_results.drain(..).zip(self.world.scene_results()) {
                if let Some(result) = result {
                    let _ = result.try_send(*done);
                }
            }
            discard_commands(&mut commands, &garbage);
            let stepped = self.clock.now_ns() - begun;
            figures.tick(&report, stepped, thread_cpu_ns() - begun_cpu);
            let mut shown = published_figures(&figures, &self.receiver, stepped);
            shown.garbage_overflows = self.garbage.overflowed();
            if let Some(sample) = samples.last() {
                let took_us = self.clock.now_us().saturating_sub(sample.t_us);
                newest = (sample.t_us, tick, took_us as f64 / 1e3);
            }
            (shown.newest_us, shown.newest_tick, shown.input_to_snapshot_ms) = newest;
            self.publisher.publish(Published::of(&mut self.world, shown), &garbage);
            // After the state that they are about is to be seen.
            let put_down = report.put_down.map(HandRequest::LayDown);
            for request in report.join.map(HandRequest::Join).into_iter().chain(put_down) {
                if !self.joiner.as_ref().is_some_and(|j| j.ask(request)) {
                    tracing::warn!("{request:?}: another join is under way");
                }
            }
            pacer.done(self.clock.now_us());
            figures.overruns = pacer.overruns;
        }
        Ended { world: self.world, figures, receiver: self.receiver }
    }
}

/// Real-time scheduling where it is allowed, else a nicer place in the queue, else as it is:
/// `sculptd doctor` says which.
pub fn raise_priority() -> &'static str {
    raise(20)
}

/// The same for what serves the loop, one step below it: a journal that waits for its turn loses
/// what a kill finds unwritten.
pub fn raise_priority_below() -> &'static str {
    raise(10)
}

fn raise(level: u8) -> &'static str {
    use thread_priority as tp;
    let fifo = tp::ThreadSchedulePolicy::Realtime(tp::RealtimeThreadSchedulePolicy::Fifo);
    let middle = tp::ThreadPriorityValue::try_from(level).map(tp::ThreadPriority::Crossplatform);
    let Ok(middle) = middle else { return "normal" };
    #[cfg(unix)]
    {
        let id = tp::thread_native_id();
        if tp::unix::set_thread_priority_and_policy(id, middle, fifo).is_ok() {
            return "real-time (SCHED_FIFO)";
        }
    }
    if tp::set_current_thread_priority(tp::ThreadPriority::Max).is_ok() {
        "raised"
    } else {
        "normal"
    }
}
