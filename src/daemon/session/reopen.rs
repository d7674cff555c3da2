//! Opening a session at its newest checkpoint: the pages that were stored, the state, and the
//! replay of what follows.
//!
//! Guaranteed: the world is, to the bit, the one that a replay from the start gives, but for undo,
//! which a reopened session keeps in the file. Each checkpoint carries the hash of the live
//! sculpture, and the sculpture that is put together from its pages must have it. Where the world
//! cannot be known (another hash, a damaged page, an undo that went back beyond the checkpoint in
//! memory), the checkpoint before it is tried, and last the caller replays from the start.

use std::path::Path;

use super::history::keeper::assemble;
use super::history::{Store, StoreError, Tree};
use super::reader::Opened;
use super::replay::{Replayed, Run};
use sculptd_clay::{ObjectState, Snapshot, Workers};
use sculptd_engine::scene::KnownHashes;
use sculptd_engine::world::{World, WorldOptions};
use sculptd_geometry::job::Job;

/// Checkpoints that are tried, from the newest back.
const TRIED: usize = 4;

/// A world, and the node of the checkpoint that it was opened at.
#[derive(Debug)]
pub struct Reopened {
    pub replayed: Replayed,
    pub checkpoint: u64,
    pub node: u64,
}

/// `until`: the tick to stop at. `None`: no checkpoint serves.
pub fn reopen(
    path: &Path,
    opened: &Opened,
    until: Option<u64>,
    workers: usize,
    job: &Job,
) -> Option<Reopened> {
    let store = Store::read(path).ok().filter(|s| s.has_tables().unwrap_or(false))?;
    let earliest = opened.replay_from.as_ref().map(|r| r.tick);
    // A checkpoint after the last recorded tick does not belong to the readable input. If the input
    // begins at a checkpoint, it may contain no tick yet.
    let last = opened.input.last().map_or(0, |t| t.tick).max(earliest.unwrap_or(0));
    let last = last.min(until.unwrap_or(u64::MAX));
    let tree = store.tree().ok()?;
    let base = opened.start.clay(job).ok()?;
    // If a replay from the start is impossible, every checkpoint is tried.
    let tried = if earliest.is_some() { usize::MAX } else { TRIED };
    for id in store.checkpoints(last).ok()?.into_iter().take(tried) {
        match from_checkpoint((&store, &tree, &base), opened, id, until, workers, job) {
            Ok(Some(reopened)) => return Some(reopened),
            Ok(None) => {}
            Err(e) => tracing::warn!("{}: checkpoint {id} does not serve: {e}", path.display()),
        }
    }
    None
}

/// The world of one checkpoint and of the input after it; `None` where it may not be the one that
/// a replay from the start gives.
pub(super) fn from_checkpoint(
    (store, tree, base): (&Store, &Tree, &Snapshot),
    opened: &Opened,
    id: u64,
    until: Option<u64>,
    workers: usize,
    job: &Job,
) -> Result<Option<Reopened>, StoreError> {
    let c = store.checkpoint(id)?;
    let earliest = opened.replay_from.as_ref().map(|r| r.tick);
    let Some(node) = tree.node(c.node).filter(|_| earliest.is_none_or(|e| c.tick >= e)) else {
        return Ok(None);
    };
    let names = tree.names(node, c.rest.pages, base.page_count());
    let (checkpoint, at, proof) = (c.tick, c.node, c.proof);
    let empty = c.rest.empty.clone();
    let active = c.rest.clone();
    let saved = store.saved(c)?;
    let damaged = |what: &str| StoreError::Damaged(what.into());
    let list = saved.scene().map_err(|_| damaged("a checkpoint's state"))?;
    let mut clays = Vec::new();
    let whole = |rest: &ObjectState, names: &[(u32, u64)], levels, empty| {
        let mut clay = assemble(store, base, rest, names, levels)?;
        clay.set_empty(empty);
        Ok::<_, StoreError>(clay)
    };
    match &list {
        None => clays.push(whole(&active, &names, None, empty)?),
        Some(list) => {
            // One object, as a session begins, has no list in the tree.
            let stored = tree.scene_at(at);
            for (i, object) in list.objects.iter().enumerate() {
                let rest = &object.rest;
                if i == list.active as usize {
                    clays.push(whole(&active, &names, None, empty.clone())?);
                    continue;
                }
                let clay = stored.and_then(|s| s.object(object.id)?.clay.as_ref());
                let clay = clay.filter(|c| c.number == rest.object_id);
                let clay = clay.ok_or_else(|| damaged("an object of a list"))?;
                clays.push(whole(rest, &clay.pages, clay.levels, rest.empty.clone())?);
            }
        }
    }
    let steps = saved.steps;
    let s = &opened.settings;
    let options =
        WorldOptions { dab_budget: s.dab_budget, undo_bytes: s.undo_bytes, hands: s.hands };
    let damaged = |_| StoreError::Damaged("a checkpoint's state".into());
    let mut world =
        World::restore(clays, saved, Workers::new(workers), options).map_err(damaged)?;
    let (scene, active) = (world.scene_view(), world.snapshot());
    let given = scene.page_hash(&active, &mut KnownHashes::default());
    if proof.is_some_and(|proof| proof != given) {
        let why = format!("the sculpture of tick {checkpoint} (its pages give another hash)");
        return Err(StoreError::Damaged(why));
    }
    let mut odd = false;
    let mut see = |_: u64, world: &mut World| {
        let missed = world.report().missed;
        odd |= missed < 0 && steps.0 > 0 || missed > 0 && steps.1 > 0;
    };
    let run = Run { opened, base, store: Some(store), until };
    let replayed = run.from(world, job, &mut see);
    // Without a replay from the start, the checkpoint's result is the only one.
    let sound = earliest.is_some() || !odd && replayed.jumps_missed == 0;
    Ok((sound && !job.cancelled()).then_some(Reopened { replayed, checkpoint, node: at }))
}
