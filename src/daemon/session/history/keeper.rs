//! The thread that keeps the history: it writes a node for every step, and fetches what undo asks
//! for beyond memory.
//!
//! The tick thread hands it moments and never waits; where the disk is far behind, moments are left
//! out and the next one that is kept stands for all of them.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam_channel as cc;

use super::store::{Store, StoreError};
use super::stored_scene::{StoredObject, StoredScene};
use super::tree::{NOTHING, Node, Tree, TreePath};
use super::world_at_rest::WorldAtRest;
use crate::command_queue::{CommandAnswer, CommandSender, QueuedCommand};
use crate::session::history::history_writer::HistoryWriter;
use crate::session::place::SessionPath;
use sculptd_clay::{Clay, Levels, ObjectState, Snapshot};
use sculptd_devices::Clock;
use sculptd_engine::command::{Command, Jump, JumpObject, OtherWork, SceneJump};
use sculptd_engine::payload::Payload;
use sculptd_engine::world::{HistoryEntry, HistoryEvent, World};
use sculptd_geometry::job::Job;

/// Moments that may wait for the disk, each holding the pages of its time.
const WAITING: usize = 64;
/// Interval between retries while the disk cannot be written.
const RETRY: Duration = Duration::from_millis(1000);
/// Interval between looks at a jump under way.
const LOOK: Duration = Duration::from_millis(2);
/// A jump without an answer that the world ignores for this long was for an earlier state of the
/// sculpture.
const PATIENCE: Duration = Duration::from_millis(500);
/// Maximum number of undos that wait for the one in progress.
const WANTS: usize = 64;

/// A requested move in the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Want {
    Undo,
    Redo,
    Node(u64),
}

#[derive(Debug)]
enum HistoryMessage {
    HistoryEntry { tick: u64, moment: HistoryEntry },
    State(Box<WorldAtRest>),
    Want(Want),
    End,
}

/// The history as others reach it.
#[derive(Debug, Clone)]
pub struct Handle {
    inbox: cc::Sender<HistoryMessage>,
    commands: Arc<OnceLock<CommandSender>>,
    tree: Arc<Mutex<Tree>>,
    fault: Arc<Mutex<Option<String>>>,
    path: SessionPath,
    /// Set when the caller no longer waits for a disk that cannot be written.
    ending: Arc<AtomicBool>,
    /// Number of messages sent and not yet processed.
    busy: Arc<AtomicUsize>,
    /// True while a jump is waiting, or was sent and has not returned.
    jumping: Arc<AtomicBool>,
}

impl Handle {
    /// Jumps are sent here; before it is known, none are.
    pub fn connect(&self, commands: CommandSender) {
        let _ = self.commands.set(commands);
    }

    /// Hands over what a tick did. Never waits. Whether a checkpoint is owed.
    pub fn tick(&self, tick: u64, world: &World) -> bool {
        let mut owed = false;
        for moment in world.moments() {
            owed = true;
            if self.inbox.len() < WAITING {
                self.send(HistoryMessage::HistoryEntry { tick, moment: moment.clone() });
            }
        }
        let missed = world.report().missed;
        for _ in 0..missed.unsigned_abs() {
            self.want(if missed < 0 { Want::Undo } else { Want::Redo });
        }
        owed
    }

    /// Hands over the world at rest. False where it is not at rest, or the disk is behind.
    pub fn checkpoint(&self, world: &mut World) -> bool {
        if self.inbox.len() >= WAITING || !world.is_at_rest() {
            return false;
        }
        WorldAtRest::of(world).is_some_and(|at| self.send(HistoryMessage::State(Box::new(at))))
    }

    fn send(&self, message: HistoryMessage) -> bool {
        self.busy.fetch_add(1, Relaxed);
        self.inbox.send(message).is_ok()
    }

    pub fn want(&self, want: Want) {
        if self.inbox.len() < WAITING {
            self.send(HistoryMessage::Want(want));
        }
    }

    /// Returns the tree as written so far.
    pub fn tree(&self) -> Tree {
        self.tree.lock().map(|t| t.clone()).unwrap_or_default()
    }

    /// Returns the cursor, the next node id and the number of nodes: together they identify the
    /// tree.
    pub fn shape(&self) -> (u64, u64, usize) {
        self.tree.lock().map(|t| (t.cursor, t.next_id(), t.len())).unwrap_or_default()
    }

    /// Returns the picture of a node as PNG.
    pub fn thumbnail(&self, node: u64) -> Option<Vec<u8>> {
        Store::read(&self.path.get()).ok()?.thumbnail(node).ok()?
    }

    /// Returns true if every message is written and no jump is in progress.
    pub fn is_idle(&self) -> bool {
        self.busy.load(Relaxed) == 0
    }

    /// Returns true if something still has to be written, or if a requested jump is pending: the
    /// world has not made it and it was not abandoned.
    pub fn is_going(&self) -> bool {
        !self.is_idle() || self.jumping.load(Relaxed)
    }

    /// Returns the current fault, if any.
    pub fn trouble(&self) -> Option<String> {
        self.fault.lock().ok().and_then(|f| f.clone())
    }
}

/// The thread, to be waited for at the end.
#[derive(Debug)]
pub struct Keeper {
    thread: JoinHandle<()>,
    pub handle: Handle,
}

impl Keeper {
    /// Begins or continues the history of the session that the world was created from. `purge`:
    /// nodes after this tick were not recovered. `at`: the world's node before the replayed input.
    /// `most`: bytes in the file, beyond which the oldest places are removed.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn start(
        path: impl Into<SessionPath>,
        world: &mut World,
        purge: u64,
        at: Option<u64>,
        most: u64,
    ) -> Result<Keeper, StoreError> {
        let path = path.into();
        world.keep_moments();
        let first = world.moment(HistoryEvent::Step);
        let mut ledger =
            HistoryWriter::open(Store::write(&path.get())?, purge, first.work.clone(), most)?;
        ledger.begin(world.tick(), &first, at)?;
        let keeping = HistoryThread {
            shown: Arc::new(Mutex::new(ledger.tree.clone())),
            ledger,
            path: path.clone(),
            wants: VecDeque::new(),
            sent: None,
            jumping: Arc::default(),
            full: false,
            clock: Clock::monotonic(),
        };
        let (outbox, inbox) = cc::unbounded();
        let handle = Handle {
            inbox: outbox,
            commands: Arc::default(),
            tree: keeping.shown.clone(),
            fault: Arc::default(),
            path,
            ending: Arc::default(),
            busy: Arc::default(),
            jumping: keeping.jumping.clone(),
        };
        let (fault, commands, ending, busy) = (
            handle.fault.clone(),
            handle.commands.clone(),
            handle.ending.clone(),
            handle.busy.clone(),
        );
        let thread = std::thread::Builder::new()
            .name("sculptd-history".into())
            .spawn(move || keeping.run(&inbox, &fault, &commands, &ending, &busy))
            .map_err(|e| StoreError::Damaged(format!("no thread for the history: {e}")))?;
        Ok(Keeper { thread, handle })
    }

    /// Waits until all that was handed over is written.
    pub fn finish(self) -> Option<String> {
        self.handle.ending.store(true, Relaxed);
        let _ = self.handle.inbox.send(HistoryMessage::End);
        let _ = self.thread.join();
        self.handle.trouble()
    }
}

struct HistoryThread {
    ledger: HistoryWriter,
    path: SessionPath,
    shown: Arc<Mutex<Tree>>,
    wants: VecDeque<Want>,
    /// The outstanding jump.
    sent: Option<SentJump>,
    jumping: Arc<AtomicBool>,
    /// True if the remaining history exceeds the bound, and that was reported.
    full: bool,
    clock: Clock,
}

/// A jump on its way to the world.
struct SentJump {
    /// What the loop says of it. A loop that gives no answers has ended this channel.
    answer: cc::Receiver<CommandAnswer>,
    /// The time by which its entry must have come, in microseconds; `None` before the answer.
    by: Option<u64>,
}

impl SentJump {
    /// Returns true if the jump was refused or is given up. One that was carried out is over when
    /// its entry has come.
    fn is_over(&mut self, now: u64) -> bool {
        if let Some(by) = self.by {
            return now >= by;
        }
        match self.answer.try_recv() {
            Ok(CommandAnswer { result: Err(_), .. }) => return true,
            Ok(_) | Err(cc::TryRecvError::Disconnected) => {
                self.by = Some(now + PATIENCE.as_micros() as u64);
            }
            Err(cc::TryRecvError::Empty) => {}
        }
        false
    }
}

impl HistoryThread {
    fn run(
        mut self,
        inbox: &cc::Receiver<HistoryMessage>,
        fault: &Mutex<Option<String>>,
        commands: &OnceLock<CommandSender>,
        ending: &AtomicBool,
        busy: &AtomicUsize,
    ) {
        crate::priority::raise_priority_below();
        loop {
            let patience = if self.jumping.load(Relaxed) { LOOK } else { RETRY };
            let message = match inbox.recv_timeout(patience) {
                Ok(message) => message,
                Err(cc::RecvTimeoutError::Timeout) => {
                    self.serve(commands);
                    self.tell_jumping();
                    continue;
                }
                Err(cc::RecvTimeoutError::Disconnected) => break,
            };
            match &message {
                HistoryMessage::End => break,
                HistoryMessage::Want(want) => {
                    // Wherever one wanted to go before: this is where one ends.
                    if matches!(want, Want::Node(_)) {
                        self.wants.clear();
                    }
                    if self.wants.len() < WANTS {
                        self.wants.push_back(*want);
                    }
                }
                HistoryMessage::HistoryEntry { .. } | HistoryMessage::State(_) => {
                    // A disk that takes nothing now may later: the moment is kept till then.
                    while let Err(e) = self.take(&message) {
                        let first =
                            fault.lock().is_ok_and(|mut f| f.replace(e.to_string()).is_none());
                        if first {
                            tracing::error!("history: {e}");
                        }
                        self.ledger.recover();
                        // The log holds it still.
                        if ending.load(Relaxed) {
                            return;
                        }
                        let (_keep, quiet) = cc::bounded::<()>(0);
                        let _ = quiet.recv_timeout(RETRY);
                    }
                    if let Ok(mut f) = fault.lock() {
                        *f = None;
                    }
                    self.keep_within();
                }
            }
            self.serve(commands);
            self.tell_jumping();
            busy.fetch_sub(1, Relaxed);
        }
        // Closing takes the rest of the log over, and syncs as it should.
        let _ = self.ledger.store.db.pragma_update(None, "synchronous", "full");
    }

    fn take(&mut self, message: &HistoryMessage) -> Result<(), StoreError> {
        match message {
            HistoryMessage::HistoryEntry { tick, moment } => {
                self.ledger.moment(*tick, moment)?;
                if matches!(moment.deed, HistoryEvent::Jump(_)) {
                    self.sent = None;
                    self.ledger.store.settle_pins(*tick)?;
                }
                self.show();
                Ok(())
            }
            HistoryMessage::State(world) => self.ledger.state(world),
            _ => Ok(()),
        }
    }

    /// The bound on the file. Where it cannot be kept, the history goes on growing, and that is
    /// said once.
    fn keep_within(&mut self) {
        match self.ledger.keep_within() {
            Ok(None) => self.full = false,
            Ok(Some(freed)) => {
                let left = self.ledger.bytes;
                tracing::info!(
                    "history: {} oldest places went, {} KiB are left",
                    freed.places,
                    left >> 10
                );
                if left > self.ledger.most && !std::mem::replace(&mut self.full, true) {
                    tracing::warn!(
                        "history: what must stay takes {} KiB, more than it may",
                        left >> 10
                    );
                }
                self.show();
            }
            Err(e) => {
                tracing::warn!("history: the oldest places cannot be let go: {e}");
                self.ledger.recover();
            }
        }
    }

    fn show(&self) {
        if let Ok(mut shown) = self.shown.lock() {
            shown.clone_from(&self.ledger.tree);
        }
    }

    fn tell_jumping(&self) {
        self.jumping.store(self.sent.is_some() || !self.wants.is_empty(), Relaxed);
    }

    /// Sends the next jump that is wanted, unless one is under way.
    fn serve(&mut self, commands: &OnceLock<CommandSender>) {
        let now = self.clock.now_us();
        if self.sent.as_mut().is_some_and(|sent| !sent.is_over(now)) {
            return;
        }
        self.sent = None;
        if self.ledger.closed {
            self.wants.clear();
        }
        let Some(commands) = commands.get() else { return };
        while let Some(want) = self.wants.pop_front() {
            let to = match want {
                Want::Undo => self.ledger.tree.before(),
                Want::Redo => self.ledger.tree.after(),
                Want::Node(id) => Some(id).filter(|id| *id != self.ledger.tree.cursor),
            };
            let Some(to) = to else { continue };
            match self.fetch(to) {
                Ok(Some(jump)) => {
                    let (asked, answer) = cc::bounded(1);
                    let jump = QueuedCommand { answer: Some(asked), ..jump };
                    if commands.try_send(jump).is_ok() {
                        self.sent = Some(SentJump { answer, by: None });
                        return;
                    }
                }
                Ok(None) => tracing::warn!("history: there is no way to {to} from here"),
                Err(e) => tracing::warn!("history: {to} cannot be fetched: {e}"),
            }
        }
    }

    fn fetch(&mut self, to: u64) -> Result<Option<QueuedCommand>, StoreError> {
        let (Some(way), Some(node)) = (self.ledger.tree.way(to), self.ledger.tree.node(to)) else {
            return Ok(None);
        };
        let from = (self.ledger.now.object_id(), self.ledger.now.revision());
        let jump = |pages, other| Jump { node: to, from, object_id: node.object_id, pages, other };
        let queued =
            |jump, payload| QueuedCommand::with_payload(Command::Jump(Box::new(jump)), payload);
        match way {
            TreePath::Pages(pages) => {
                let mut got = Vec::with_capacity(pages.len());
                for &(i, revision) in &pages {
                    let t = self.ledger.topology.get(&i).copied().unwrap_or(0);
                    let near = ((i as usize) < self.ledger.now.page_count())
                        .then(|| (self.ledger.now.page(i), t));
                    got.push((i, self.ledger.store.page((node.object_id, i, revision), near)?.0));
                }
                let jump = jump(pages, None);
                self.ledger.pin(to, &jump.pages, None)?;
                Ok(Some(queued(jump, Payload::Pages(got))))
            }
            TreePath::Other => {
                let base = base(&self.path.get())?;
                let (rest, names) = describe(&self.ledger, node, base.page_count())?;
                let mesh = assemble(&self.ledger.store, &base, &rest, &names, node.levels)?;
                let other = OtherWork {
                    rest,
                    middle: node.middle,
                    extent: node.extent,
                    levels: node.levels,
                };
                let (levels, jump) = (node.levels, jump(names, Some(other)));
                self.ledger.pin(to, &jump.pages, levels)?;
                Ok(Some(queued(jump, Payload::Clay(Box::new(mesh)))))
            }
            TreePath::Scene => self.fetch_scene(to),
        }
    }

    /// A jump to a node with other objects: all of them come from the file.
    fn fetch_scene(&mut self, to: u64) -> Result<Option<QueuedCommand>, StoreError> {
        let Some(node) = self.ledger.tree.node(to).cloned() else { return Ok(None) };
        let from = (self.ledger.now.object_id(), self.ledger.now.revision());
        let scene = self.ledger.tree.scene_at(to).cloned();
        let scene = scene.unwrap_or_else(|| Arc::new(StoredScene::one_object()));
        let base = base(&self.path.get())?;
        let (mut objects, mut clays) = (Vec::new(), Vec::new());
        for object in &scene.objects {
            let (clay, pages) = described(&self.ledger, &node, object, base.page_count())?;
            clays.push(assemble(&self.ledger.store, &base, &clay.rest, &pages, clay.levels)?);
            let (id, settings) = (object.id, object.settings.clone());
            objects.push(JumpObject { id, settings, pages, clay });
        }
        for o in &objects {
            self.ledger.pin_clay(o.clay.rest.object_id, &o.pages, o.clay.levels)?;
        }
        let jump = SceneJump { node: to, from, objects, active: scene.active };
        let command = Command::JumpScene(Box::new(jump));
        Ok(Some(QueuedCommand::with_payload(command, Payload::Clays(clays))))
    }
}

/// A work's pages by name, and what it is besides: revisions go on above all that its lineage ever
/// had.
fn describe(
    ledger: &HistoryWriter,
    node: &Node,
    first: usize,
) -> Result<(ObjectState, Vec<(u32, u64)>), StoreError> {
    let high = ledger.high(node.object_id)?.over(node);
    let (revision, next) = (high.revision.saturating_add(1), high.next);
    let rest = ObjectState {
        pages: node.pages,
        revision,
        object_id: node.object_id,
        next,
        empty: Vec::new(),
    };
    Ok((rest, ledger.tree.names(node, node.pages, first)))
}

/// The clay of an object at a node: that of the node itself where the object is active there.
fn described(
    ledger: &HistoryWriter,
    node: &Node,
    object: &StoredObject,
    first: usize,
) -> Result<(OtherWork, Vec<(u32, u64)>), StoreError> {
    let Some(clay) = &object.clay else {
        let (rest, names) = describe(ledger, node, first)?;
        let (middle, extent, levels) = (node.middle, node.extent, node.levels);
        return Ok((OtherWork { rest, middle, extent, levels }, names));
    };
    let high = ledger.high(clay.number)?;
    let newest = clay.pages.iter().map(|p| p.1).filter(|r| *r != NOTHING).max().unwrap_or(0);
    let rest = ObjectState {
        pages: clay.pages.len() as u32,
        revision: high.revision.max(newest).saturating_add(1),
        object_id: clay.number,
        next: [high.next[0].max(clay.next[0]), high.next[1].max(clay.next[1])],
        empty: Vec::new(),
    };
    let (middle, extent, levels) = (clay.middle, clay.extent, clay.levels);
    Ok((OtherWork { rest, middle, extent, levels }, clay.pages.to_vec()))
}

/// The work that the session began with.
fn base(path: &Path) -> Result<Snapshot, StoreError> {
    let damaged = |e: &dyn std::fmt::Display| StoreError::Damaged(format!("the start ({e})"));
    let start = crate::session::connection::read_start(path)?;
    start.clay(&Job::default()).map_err(|e| damaged(&e))
}

/// A whole work out of the file.
pub(in crate::session) fn assemble(
    store: &Store,
    base: &Snapshot,
    rest: &ObjectState,
    names: &[(u32, u64)],
    levels: Option<u64>,
) -> Result<Clay, StoreError> {
    let mut pages = Vec::with_capacity(names.len());
    for &(i, revision) in names {
        let first = (rest.object_id == base.object_id() && (i as usize) < base.page_count())
            .then(|| base.page(i));
        pages.push(match first {
            Some(page) if revision == page.revision() => page.clone(),
            _ => store.page((rest.object_id, i, revision), first.map(|p| (p, 0)))?.0,
        });
    }
    let empty = (0u32..).zip(&pages).filter(|(_, p)| p.own() == 0).map(|(i, _)| i).collect();
    let rest = ObjectState { empty, ..rest.clone() };
    let mut mesh = Clay::of_stored(pages, &rest)
        .map_err(|_| StoreError::Damaged("the pages of a work".into()))?;
    mesh.set_levels(levels.map(|id| store.side::<Levels>(id)).transpose()?.map(Arc::new));
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_engine::answer::Answer;
    use sculptd_engine::scene::SceneError;

    fn sent() -> (cc::Sender<CommandAnswer>, SentJump) {
        let (asked, answer) = cc::bounded(1);
        (asked, SentJump { answer, by: None })
    }

    /// A loaded machine may take seconds for a tick: a jump that it carries out later must not be
    /// reported as refused before.
    #[test]
    fn a_jump_is_waited_for_until_the_loop_has_answered() {
        let patience = PATIENCE.as_micros() as u64;
        let (asked, mut jump) = sent();
        assert!(!jump.is_over(0) && !jump.is_over(60_000_000), "a slow loop");
        asked.send(CommandAnswer { tick: 7, result: Ok(Answer::Done) }).expect("heard");
        assert!(!jump.is_over(60_000_001), "its entry is still to come");
        assert!(!jump.is_over(60_000_000 + patience) && jump.is_over(60_000_001 + patience));
        let (asked, mut jump) = sent();
        asked.send(CommandAnswer { tick: 7, result: Err(SceneError::Last) }).expect("heard");
        assert!(jump.is_over(1), "refused");
        let (asked, mut jump) = sent();
        drop(asked);
        assert!(!jump.is_over(1) && jump.is_over(1 + patience), "a loop that gives no answers");
    }
}
