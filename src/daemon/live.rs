//! The loop in real time: a separate thread that adaptors feed and the viewer reads.
//!
//! Laws kept here: the tick thread never waits for anyone. It takes the content of the channel,
//! steps, publishes, sleeps. While no work is left it sleeps until input comes: idle means idle. It
//! leaves out the same ticks as a replay, so both give the same bits.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use arc_swap::{ArcSwap, ArcSwapOption};
use crossbeam_channel as cc;

use super::pacer::Pacer;
use super::page_thread::PageThread;
use super::published::{Published, PublishedFigures, Publisher};
use crate::boolean_jobs::{BooleanJobs, HandRequest};
use crate::command_queue::{CommandAnswer, CommandSender, QueuedCommand, command_queue};
use crate::config::LoopConfig;
use crate::garbage_thread::{GarbageThread, discard_commands};
use crate::input_hold::{LONGEST_HOLD, LoopHold, SHARED_HOLD};
use crate::kiosk::visit_door::{VisitDoor, WaitingVisitor};
use crate::pen_trail::{PenTrail, PenTrailSender, pen_trail};
use crate::people::{PeopleHere, SharedEnd};
use crate::priority::raise_priority;
use crate::session::writer::WriterThread;
use crate::shared_input::{NextTick, SharedInput};
use crate::tablet_actions::TabletActions;
use crate::tick::{Journal, in_order_of_time, published_figures};
use crate::tick_statistics::{TickStatistics, thread_cpu_ns};
use sculptd_clay::{GarbageSink, PageSupply};
use sculptd_devices::queue::Receiver;
use sculptd_devices::{Clock, Sample};
use sculptd_engine::answer::{Answer, CommandResult};
use sculptd_engine::command::Command;
use sculptd_engine::payload::PayloadStore;
use sculptd_engine::scene::SceneError;
use sculptd_engine::world::World;

/// Commands waiting for the loop; a sender beyond this limit gets an error and retries.
pub const COMMANDS: usize = 1024;
/// Commands taken a tick: the store beside the world has room for the payload of each.
const COMMANDS_PER_TICK: usize = PayloadStore::CAPACITY;
/// Ticks after the stop for the samples that adaptors sent before it.
const LAST_TICKS: u32 = 8;
/// Ticks without input or work before the loop sleeps.
const QUIET_TICKS: u32 = 8;
/// Longest sleep: so often an idle loop ticks for those who watch over it.
const LONGEST_SLEEP: Duration = Duration::from_secs(1);
/// Longest wait at the end for the others to take the last input, in microseconds.
const DELIVERY_US: u64 = 4_000_000;

/// A running loop.
#[derive(Debug)]
pub struct Live {
    pub commands: CommandSender,
    pub published: Arc<ArcSwap<Published>>,
    /// Positions of tablet pens over time, for the window.
    pub pen_trail: PenTrail,
    /// Guests of this daemon, which the loop shows; `None` if there are none.
    pub guests: Arc<ArcSwapOption<PeopleHere>>,
    /// The loop stops when this is dropped.
    running: cc::Sender<Infallible>,
    thread: JoinHandle<Ended>,
}

/// Input of the loop beside the samples.
#[derive(Debug, Default)]
pub struct LiveInput {
    /// Samples taken a tick, at most.
    pub drain_per_tick: usize,
    /// Active tablet controls.
    pub actions: Option<TabletActions>,
    /// Door of an installation.
    pub door: Option<Arc<VisitDoor>>,
    /// With it the world steps only that input.
    pub shared: Option<Box<dyn SharedInput>>,
}

/// A loop that has ended, with all that it held.
#[derive(Debug)]
pub struct Ended {
    pub world: World,
    pub figures: TickStatistics,
    pub receiver: Receiver,
    /// Sessions that were begun while the loop ran, to be waited for.
    pub writing: Vec<WriterThread>,
    /// End of the part in a shared sculpture.
    pub shared: SharedEnd,
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
    /// Starts without tablet controls, visitors and others at the sculpture.
    ///
    /// # Errors
    /// Returns [`LiveError::Start`] if a thread cannot start.
    pub fn start(
        world: World,
        receiver: Receiver,
        clock: Clock,
        config: LoopConfig,
        drain_per_tick: usize,
        journal: Option<Box<dyn Journal>>,
    ) -> Result<Self, LiveError> {
        let input = LiveInput { drain_per_tick, ..LiveInput::default() };
        Live::start_with(world, receiver, clock, config, input, journal)
    }

    /// As [`Live::start`], with all that may come beside the samples.
    ///
    /// # Errors
    /// Returns [`LiveError::Start`] if a thread cannot start.
    pub fn start_with(
        mut world: World,
        receiver: Receiver,
        clock: Clock,
        config: LoopConfig,
        input: LiveInput,
        journal: Option<Box<dyn Journal>>,
    ) -> Result<Self, LiveError> {
        let (commands, inbox) = command_queue(COMMANDS);
        let garbage = GarbageThread::start().map_err(LiveError::Start)?;
        world.set_garbage_sink(garbage.sink());
        let pages = PageThread::start().map_err(LiveError::Start)?.supply();
        world.set_page_supply(pages.clone());
        let publisher = Publisher::new(Published::of(&mut world, PublishedFigures::default()));
        let published = publisher.reader();
        let (running, stopped) = cc::bounded(0);
        let (trail, pen_trail) = pen_trail();
        let guests: Arc<ArcSwapOption<PeopleHere>> = Arc::default();
        let ticking = Ticking {
            world,
            receiver,
            clock,
            inbox,
            publisher,
            stopped,
            rate_hz: config.rate_hz,
            drain_per_tick: input.drain_per_tick,
            actions: input.actions,
            visitor: input.door.map(WaitingVisitor::new),
            journal,
            garbage,
            pages,
            shared: input.shared,
            guests: guests.clone(),
            writing: Vec::new(),
            trail,
            // Without its thread the hands' menu cannot join: that is said when it is asked to.
            joiner: BooleanJobs::start(published.clone(), commands.clone()).ok(),
        };
        let thread = std::thread::Builder::new()
            .name("sculptd-tick".into())
            .spawn(move || ticking.run())
            .map_err(LiveError::Start)?;
        Ok(Live { commands, published, pen_trail, guests, running, thread })
    }

    pub fn is_running(&self) -> bool {
        !self.thread.is_finished()
    }

    /// Stops after the tick under way and gives everything back.
    pub fn stop(self) -> Result<Ended, LiveError> {
        drop(self.running);
        self.thread.join().map_err(|_| LiveError::Panicked)
    }
}

struct Ticking {
    world: World,
    receiver: Receiver,
    clock: Clock,
    inbox: cc::Receiver<QueuedCommand>,
    publisher: Publisher,
    /// Disconnected once the loop is to stop.
    stopped: cc::Receiver<Infallible>,
    rate_hz: u32,
    drain_per_tick: usize,
    actions: Option<TabletActions>,
    visitor: Option<WaitingVisitor>,
    journal: Option<Box<dyn Journal>>,
    joiner: Option<BooleanJobs>,
    garbage: GarbageThread,
    pages: PageSupply,
    shared: Option<Box<dyn SharedInput>>,
    guests: Arc<ArcSwapOption<PeopleHere>>,
    /// Of the journals that took the place of the first one.
    writing: Vec<WriterThread>,
    trail: PenTrailSender,
}

/// Channel for the answer of a command; `None` if no caller waits for it.
type AnswerSender = Option<cc::Sender<CommandAnswer>>;

/// State that the loop keeps between ticks.
struct TickBuffers {
    samples: Vec<Sample>,
    /// Samples newer than a command that waits for the older ones; the next tick has them.
    later: Vec<Sample>,
    commands: Vec<Command>,
    /// Channel for the answer of each command of this tick.
    senders: Vec<AnswerSender>,
    /// Channel for the answer of an edit whose pages are still pending.
    late: AnswerSender,
    /// Answers to send once the state that shows them is published.
    answers: Vec<(cc::Sender<CommandAnswer>, CommandAnswer)>,
    /// Commands that wait for the end of such an edit or of a hold, in order; they precede the
    /// inbox.
    held: VecDeque<QueuedCommand>,
    /// Input held back for an operation.
    hold: LoopHold,
    /// For a shared sculpture: channels for the answers of local commands still in transit, by
    /// their numbers.
    waiting: VecDeque<(u64, AnswerSender)>,
    /// Requests of hands to workers, sent once the state that they refer to is published.
    asked: Vec<HandRequest>,
    figures: TickStatistics,
    /// Duration of the last step, in ns.
    stepped: u64,
    /// The newest sample's time, its tick, and how long it took to the snapshot, ms.
    newest: (u64, u64, f64),
}

impl Ticking {
    fn run(mut self) -> Ended {
        raise_priority();
        self.world.warm();
        let garbage = self.garbage.sink();
        let mut pacer = Pacer::new(self.rate_hz, self.clock.now_us());
        let sleeper = spin_sleep::SpinSleeper::default();
        let mut now = TickBuffers {
            samples: Vec::with_capacity(self.drain_per_tick),
            later: Vec::with_capacity(self.drain_per_tick),
            commands: Vec::with_capacity(COMMANDS_PER_TICK),
            senders: Vec::with_capacity(COMMANDS_PER_TICK),
            late: None,
            answers: Vec::with_capacity(COMMANDS_PER_TICK),
            held: VecDeque::with_capacity(COMMANDS),
            hold: LoopHold::default(),
            asked: Vec::new(),
            waiting: VecDeque::new(),
            figures: TickStatistics::default(),
            stepped: 0,
            newest: (0, 0, 0.0),
        };
        let mut tick = self.world.tick();
        let mut last = LAST_TICKS;
        let mut quiet = 0;
        while !self.is_stopped()
            || (last > 0 && self.receiver.waiting() + now.later.len() + now.held.len() > 0)
        {
            if self.is_stopped() {
                last -= 1;
            }
            if quiet >= QUIET_TICKS {
                let slept = self.sleep_until_input(&mut pacer);
                tick += slept;
                now.figures.ticks += slept;
            }
            pacer.wait(&self.clock, &sleeper);
            now.hold.end(self.clock.now_us(), self.is_stopped());
            now.samples.clear();
            if now.hold.now().is_none() {
                now.samples.append(&mut now.later);
                let room = self.drain_per_tick.saturating_sub(now.samples.len());
                self.receiver.drain(room, &mut now.samples);
                in_order_of_time(&mut now.samples);
            }
            // A command that needs the surface would finish the whole pending edit within this
            // tick.
            let mut edits = self.shared.is_none() && self.world.is_in_surface_edit();
            let (mut begins, mut visit_begins) = (false, false);
            for _ in 0..COMMANDS_PER_TICK {
                let Some(mut queued) = now.next_command(&self.inbox) else { break };
                if now.puts_off(&mut queued, self.receiver.waiting() > 0) {
                    now.held.push_front(queued);
                    break;
                }
                // An edit that begins in this tick can be undone in the next one.
                if edits && !begins && self.world.is_taken_back_by(&queued.command) {
                    edits = false;
                }
                if edits && queued.command.needs_surface() {
                    now.held.push_front(queued);
                    break;
                }
                if let Some(hold) = queued.hold.take()
                    && matches!(queued.command, Command::LiftAll)
                {
                    // At a shared sculpture the host holds what others do, see `order_hold` there.
                    let longest = if self.shared.is_some() { SHARED_HOLD } else { LONGEST_HOLD };
                    if !now.hold.begin(hold, self.clock.now_us(), longest) {
                        now.answer(queued.answer.take(), tick, Err(SceneError::Busy));
                        continue;
                    }
                    // These are stepped after the hold.
                    now.later.append(&mut now.samples);
                }
                visit_begins |= queued.begins_visit;
                begins |= self.shared.is_none() && queued.command.begins_surface_edit();
                edits |= begins;
                if let Some(shared) = &mut self.shared {
                    let answer = queued.answer.take();
                    if let Some(result) = shared.result_here(&mut self.world, &queued) {
                        now.answer(answer, tick, result);
                        continue;
                    }
                    now.senders.push(answer);
                    // Every replica builds what the command needs.
                    queued.payload.take().into_iter().for_each(|p| garbage.discard_owned(p));
                    now.commands.push(queued.command);
                    continue;
                }
                now.senders.push(queued.answer.take());
                now.commands.push(queued.deliver(&mut self.world));
            }
            self.trail.send(&now.samples);
            if let Some(visitor) = &mut self.visitor {
                visitor.step(&mut now.samples, visit_begins, self.clock.now_us());
            }
            if let Some(actions) = &mut self.actions {
                let first = now.commands.len();
                actions.take(&mut now.samples, &self.world, &mut now.commands);
                if edits {
                    // A tablet's keys wait their turn behind what waits already.
                    now.held.extend(now.commands.drain(first..).map(QueuedCommand::from));
                }
            }
            let has_input = !now.samples.is_empty() || !now.commands.is_empty();
            match self.shared.take() {
                None => {
                    tick += 1;
                    self.step(tick, &mut now, &garbage, true);
                }
                Some(mut shared) => {
                    self.step_shared(shared.as_mut(), &mut now, &garbage);
                    self.shared = Some(shared);
                }
            }
            let mut shown = published_figures(&now.figures, &self.receiver, now.stepped);
            shown.garbage_overflows = self.garbage.overflowed();
            (shown.input_holds, shown.longest_hold_us) = (now.hold.count, now.hold.longest_us);
            (shown.newest_us, shown.newest_tick, shown.input_to_snapshot_ms) = now.newest;
            let mut state = Published::of(&mut self.world, shown);
            if let Some(shared) = &mut self.shared {
                state.people = Some(shared.people());
                state.own_input = shared.own_input();
                state.standing = shared.standing();
                if let Some(ahead) = shared.ahead(&self.world) {
                    state.show_ahead(ahead);
                }
            } else {
                state.people = self.guests.load_full();
            }
            self.publisher.publish(state, &garbage);
            // A layer is asked for and its pages follow: until then nothing of it is seen.
            if !self.world.is_in_layer_edit() {
                for (sender, answer) in now.answers.drain(..) {
                    let _ = sender.try_send(answer);
                }
            }
            // After the state that they are about is to be seen.
            for request in now.asked.drain(..) {
                if !self.joiner.as_ref().is_some_and(|j| j.ask(request)) {
                    tracing::warn!("{request:?}: another join is under way");
                }
            }
            pacer.done(self.clock.now_us());
            now.figures.overruns = pacer.overruns;
            quiet = if has_input || self.has_work(&now) { 0 } else { quiet + 1 };
        }
        let shared = self.end_shared(&mut now, &garbage);
        let Ticking { world, receiver, writing, .. } = self;
        Ended { world, figures: now.figures, receiver, writing, shared }
    }

    /// Delivers what is still on its way to the others, and steps here what cannot be delivered.
    fn end_shared(&mut self, now: &mut TickBuffers, garbage: &GarbageSink) -> SharedEnd {
        let Some(mut shared) = self.shared.take() else { return SharedEnd::default() };
        let until = self.clock.now_us() + DELIVERY_US;
        shared.close();
        let quiet = cc::never::<()>();
        loop {
            self.step_shared(shared.as_mut(), now, garbage);
            if let Some(end) = shared.closed() {
                return end;
            }
            if self.clock.now_us() >= until {
                let undelivered = shared.standing().waiting;
                return SharedEnd { undelivered, ..SharedEnd::default() };
            }
            let _ = quiet.recv_timeout(Duration::from_millis(2));
        }
    }

    fn is_stopped(&self) -> bool {
        self.stopped.try_recv() == Err(cc::TryRecvError::Disconnected)
    }

    /// Returns true while ticks without input change something, or something waits for a tick.
    fn has_work(&self, now: &TickBuffers) -> bool {
        let report = self.world.report();
        let waits = now.late.is_some() || !now.answers.is_empty();
        let waits = waits || !now.held.is_empty() || !now.later.is_empty();
        let waits = waits || now.hold.now().is_some();
        let waits = waits || self.visitor.as_ref().is_some_and(WaitingVisitor::waits);
        self.shared.is_some()
            || matches!(self.clock, Clock::Manual(_))
            || waits
            || report.paused
            || report.resting
            || !self.world.is_at_rest()
            || self.journal.as_ref().is_some_and(|j| j.has_waiting())
    }

    /// Sleeps until a sample or a command comes, the loop is to stop, or [`LONGEST_SLEEP`] is over.
    /// Returns the slots that passed: the number of the tick counts them.
    fn sleep_until_input(&self, pacer: &mut Pacer) -> u64 {
        let mut wakers = cc::Select::new();
        self.receiver.add_to(&mut wakers);
        wakers.recv(&self.inbox);
        wakers.recv(&self.stopped);
        // Either way the next tick sees what came.
        let _ = wakers.ready_timeout(LONGEST_SLEEP);
        pacer.skip_slept(self.clock.now_us())
    }

    /// One tick with the input in `now`. `asks`: what the step asks for is started.
    fn step(&mut self, tick: u64, now: &mut TickBuffers, garbage: &GarbageSink, asks: bool) {
        let (begun, begun_cpu) = (self.clock.now_ns(), thread_cpu_ns());
        let report = *self.world.step(tick, &now.samples, &now.commands);
        if let Some(journal) = self.journal.as_deref_mut() {
            journal.tick(tick, &now.samples, &now.commands, &mut self.world);
        }
        if asks {
            now.asked.extend(report.join.map(HandRequest::Join));
            now.asked.extend(report.put_down.map(HandRequest::LayDown));
        }
        if let Some(result) = self.world.late_answer() {
            let late = now.late.take();
            now.answer(late, tick, result);
        }
        let mut senders = std::mem::take(&mut now.senders);
        for (sender, result) in senders.drain(..).zip(self.world.answers()) {
            match result {
                Ok(Answer::UnderWay) => now.late = sender,
                result => now.answer(sender, tick, *result),
            }
        }
        now.senders = senders;
        discard_commands(&mut now.commands, garbage);
        now.stepped = self.clock.now_ns() - begun;
        now.figures.tick(&report, now.stepped, thread_cpu_ns() - begun_cpu);
        let ended_us = self.clock.now_us();
        now.samples.iter().for_each(|s| now.figures.sample(ended_us.saturating_sub(s.t_us)));
        if let Some(sample) = now.samples.last() {
            let took_us = ended_us.saturating_sub(sample.t_us);
            now.newest = (sample.t_us, tick, took_us as f64 / 1e3);
        }
    }

    /// The own input goes out, and the ticks that have come are stepped: as many as fit into three
    /// periods of the loop, so that a replica that is behind catches up.
    fn step_shared(
        &mut self,
        shared: &mut dyn SharedInput,
        now: &mut TickBuffers,
        garbage: &GarbageSink,
    ) {
        let own_us = now.samples.last().map(|s| s.t_us);
        let first = shared.submit(&self.world, &mut now.samples, &mut now.commands);
        // Commands of the tablets' keys follow; their results have no receiver.
        now.waiting.extend((first..).zip(now.senders.drain(..)));
        let newest = now.newest;
        let until = self.clock.now_us() + 3_000_000 / u64::from(self.rate_hz.max(1));
        loop {
            match shared.next(&self.world) {
                NextTick::Wait => break,
                NextTick::World(mut world, journal, waiting_from) => {
                    // The old file ends here: it records another world.
                    if let Some(old) = self.journal.take() {
                        garbage.discard_owned(old);
                    }
                    if let Some(journal) = journal {
                        let (writer, thread) = *journal;
                        self.journal = Some(Box::new(writer));
                        self.writing.push(thread);
                    }
                    world.set_garbage_sink(garbage.clone());
                    world.set_page_supply(self.pages.clone());
                    world.warm();
                    // Their senders are dropped, so the callers learn that no answer will come.
                    now.waiting.retain(|(number, _)| *number >= waiting_from);
                    now.late = None;
                    garbage.discard_owned(std::mem::replace(&mut self.world, *world));
                }
                NextTick::Step(next) => {
                    for number in next.refused {
                        let sender = now.take_waiting(number);
                        now.answer(sender, next.tick, Err(SceneError::NotShared));
                    }
                    let mut own = next.own.iter().peekable();
                    for i in 0..next.commands.len() {
                        let number = own.next_if(|o| o.0 == i).map(|o| o.1);
                        let sender = number.and_then(|number| now.take_waiting(number));
                        now.senders.push(sender);
                    }
                    (now.samples, now.commands) = (next.samples, next.commands);
                    self.step(next.tick, now, garbage, shared.hosts());
                    shared.after_step(&mut self.world);
                }
            }
            if self.clock.now_us() >= until {
                break;
            }
        }
        // Samples of frames have the times of their ticks. The own are seen by now, ahead of them.
        now.newest = newest;
        if let Some(own_us) = own_us
            && shared.ahead(&self.world).is_some()
        {
            let took_us = self.clock.now_us().saturating_sub(own_us);
            now.newest = (own_us, self.world.tick(), took_us as f64 / 1e3);
        }
    }
}

impl TickBuffers {
    /// Takes the next command. During a hold that is the holder's next one; others wait.
    fn next_command(&mut self, inbox: &cc::Receiver<QueuedCommand>) -> Option<QueuedCommand> {
        let Some(hold) = self.hold.now() else {
            return self.held.pop_front().or_else(|| inbox.try_recv().ok());
        };
        while self.held.len() < COMMANDS {
            let queued = inbox.try_recv().ok()?;
            if queued.hold.as_ref().is_some_and(|h| h.is(hold)) {
                return Some(queued);
            }
            self.held.push_back(queued);
        }
        None
    }

    /// Returns true if samples older than the command are still to be stepped: then this tick
    /// steps only those. `more`: the channel holds samples that did not fit this tick.
    fn puts_off(&mut self, queued: &mut QueuedCommand, more: bool) -> bool {
        let Some(t_us) = queued.t_us else { return false };
        let older = self.samples.partition_point(|s| s.t_us < t_us);
        if older == 0 {
            return false;
        }
        let more = more && older == self.samples.len();
        self.later.extend(self.samples.drain(older..));
        if !more {
            // A device whose clock is late must not put it off for ever.
            queued.t_us = None;
        }
        true
    }

    /// Takes the channel of a command by its number. Earlier commands will not be answered any
    /// more: their channels are dropped.
    fn take_waiting(&mut self, number: u64) -> AnswerSender {
        while self.waiting.front().is_some_and(|(first, _)| *first < number) {
            self.waiting.pop_front();
        }
        let is_it = self.waiting.front().is_some_and(|(first, _)| *first == number);
        is_it.then(|| self.waiting.pop_front()).flatten().and_then(|(_, sender)| sender)
    }

    /// Keeps an answer until its effect is published.
    fn answer(&mut self, sender: AnswerSender, tick: u64, result: CommandResult) {
        self.answers.extend(sender.map(|sender| (sender, CommandAnswer { tick, result })));
    }
}
