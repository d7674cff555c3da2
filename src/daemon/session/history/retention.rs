//! A history of bounded size: what goes, and in which order.
//!
//! * The oldest places go first: the branches that hang on the first place, then that place itself.
//!   The place after it then says of every page which version it has, so that all that is left can
//!   be gone to as before.
//! * What the work is at, the newest checkpoints and the way to them stay, whatever they take.
//! * A jump that the log holds names pages; those stay ("pinned") as long as anything else can go,
//!   so that a replay from the start finds them. They go only once a checkpoint lies after the
//!   jump: opening the session needs them no more.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::OptionalExtension;
use serde::{Deserialize, Serialize};

use super::store::{Name, Store, StoreError};
use super::tree::{NOTHING, Node, Tree};
use crate::session::VERSION;

/// Newest checkpoints that always stay.
const KEPT: usize = 2;
/// Bytes that are freed in one transaction: the journal waits for no longer than that takes.
const CHUNK: u64 = 8 << 20;
/// Cost of a place there beside its bytes.
const PLACE: u64 = 256 << 10;
/// A jump in progress, whose tick is not known yet.
const UNDER_WAY: i64 = i64::MAX;

/// The pages and levels that a jump names.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pin {
    pub object_id: u32,
    pub pages: Vec<(u32, u64)>,
    pub levels: Option<u64>,
}

/// The highest numbers that a lineage had in places that went: new ones go on above them, so that
/// no name means two things.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct HighestNumbers {
    pub revision: u64,
    pub next: [u32; 2],
}

impl HighestNumbers {
    pub fn over(self, node: &Node) -> HighestNumbers {
        let revision =
            node.changes.iter().map(|c| c.2).filter(|r| *r != NOTHING).max().unwrap_or(0);
        HighestNumbers {
            revision: self.revision.max(revision),
            next: [self.next[0].max(node.next[0]), self.next[1].max(node.next[1])],
        }
    }
}

/// Counts of removed places and freed bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Freed {
    pub places: u64,
    pub bytes: u64,
}

/// Removes the oldest places until the history is at most `most` bytes, or no more can be removed.
/// `had`: its current size, see [`Store::total`]. The second result is its new size.
///
/// # Errors
/// Returns an error if the file cannot be written. The removals made so far remain, and the file is
/// consistent.
pub fn bound(
    store: &Store,
    tree: &mut Tree,
    names: &mut BTreeMap<Name, u64>,
    topologies: &mut BTreeSet<Name>,
    had: u64,
    most: u64,
) -> Result<(Freed, u64), StoreError> {
    let mut cut = RetentionRun::new(store, tree, had)?;
    while cut.left > most && cut.place(tree, names)? {}
    while cut.left > most && cut.pin(names)? {}
    if cut.began {
        cut.levels(tree)?;
        cut.shapes(names, topologies)?;
        store.db.execute_batch("COMMIT")?;
    }
    Ok((cut.freed, cut.left))
}

/// A cutting under way.
struct RetentionRun<'a> {
    store: &'a Store,
    freed: Freed,
    left: u64,
    open: u64,
    /// Places that name a page, and pins that do.
    uses: BTreeMap<Name, u32>,
    pins: Vec<(i64, i64, Pin)>,
    /// Checkpoints of each place, with the things beside the work that they name.
    checkpoints: BTreeMap<u64, Vec<(i64, Vec<u64>)>>,
    /// Places that stay, and the whole way to them.
    stay: BTreeSet<u64>,
    way: BTreeSet<u64>,
    /// First places of works that do not hang together with the present one.
    strange: Vec<u64>,
    /// The tick of the oldest checkpoint that stays.
    safe: i64,
    began: bool,
}

fn named(node: &Node) -> impl Iterator<Item = Name> + '_ {
    let both = |c: &(u32, u64, u64)| [(node.object_id, c.0, c.1), (node.object_id, c.0, c.2)];
    let listed = node.scene.iter().flat_map(|s| s.names());
    node.changes.iter().flat_map(both).filter(|n| n.2 != NOTHING).chain(listed)
}

impl<'a> RetentionRun<'a> {
    fn new(store: &'a Store, tree: &Tree, had: u64) -> Result<RetentionRun<'a>, StoreError> {
        let mut uses: BTreeMap<Name, u32> = BTreeMap::new();
        let pins = store.pins()?;
        let of_pins =
            pins.iter().flat_map(|p| p.2.pages.iter().map(|&(i, rev)| (p.2.object_id, i, rev)));
        for name in tree.nodes().flat_map(named).chain(of_pins) {
            *uses.entry(name).or_default() += 1;
        }
        let mut stay = BTreeSet::from([tree.cursor]);
        let mut safe = 0;
        let mut checkpoints: BTreeMap<u64, Vec<(i64, Vec<u64>)>> = BTreeMap::new();
        for (i, id) in store.checkpoints(u64::MAX)?.into_iter().enumerate() {
            let Ok(c) = store.checkpoint(id) else { continue };
            if i < KEPT {
                stay.insert(c.node);
                safe = c.tick as i64;
            }
            let sides = c.sides.into_iter().flatten().collect();
            checkpoints.entry(c.node).or_default().push((id as i64, sides));
        }
        let way: BTreeSet<u64> = stay.iter().flat_map(|id| tree.line(*id)).map(|n| n.id).collect();
        let strange =
            tree.nodes().filter(|n| n.parent.is_none() && !way.contains(&n.id)).map(|n| n.id);
        let strange = strange.collect();
        let (freed, left, open, began) = (Freed::default(), had, 0, false);
        Ok(RetentionRun {
            store,
            freed,
            left,
            open,
            uses,
            pins,
            checkpoints,
            stay,
            way,
            strange,
            safe,
            began,
        })
    }

    /// Lets one place go. False: none can.
    fn place(
        &mut self,
        tree: &mut Tree,
        names: &mut BTreeMap<Name, u64>,
    ) -> Result<bool, StoreError> {
        let Some(root) = tree.line(tree.cursor).last().map(|n| n.id) else { return Ok(false) };
        self.strange.retain(|id| tree.node(*id).is_some());
        let loose = |id: &u64| !self.way.contains(id);
        let of_root = tree.children(root);
        let may_merge =
            !self.stay.contains(&root) && of_root.iter().filter(|id| !loose(id)).count() == 1;
        let mut branch =
            self.strange.first().copied().or_else(|| of_root.iter().copied().find(loose));
        if branch.is_none() && !may_merge {
            // The first place must stay: the oldest of what hangs anywhere.
            branch = tree.nodes().map(|n| n.id).find(loose);
        }
        if let Some(mut end) = branch {
            while let Some(last) = tree.children(end).last() {
                end = *last;
            }
            self.drop_end(end, tree, names)?;
            return Ok(true);
        }
        if !may_merge {
            return Ok(false);
        }
        self.merge(root, tree, names)?;
        Ok(true)
    }

    /// The first place goes; the one after it speaks of all pages.
    fn merge(
        &mut self,
        root: u64,
        tree: &mut Tree,
        names: &mut BTreeMap<Name, u64>,
    ) -> Result<(), StoreError> {
        let Some(next) = tree.children(root).first().and_then(|id| tree.node(*id)).cloned() else {
            return Ok(());
        };
        let changes = tree.versions(next.id).into_iter().map(|(page, v)| (page, v, v)).collect();
        // It inherits the list of objects if it has none.
        let scene = tree.scene_at(next.id).cloned();
        let first = Node { parent: None, changes, scene, ..next };
        for name in named(&first) {
            *self.uses.entry(name).or_default() += 1;
        }
        self.begin()?;
        let sql = "SELECT length(data) FROM node WHERE id = ?1";
        let before: Option<i64> =
            self.store.db.query_row(sql, [next.id as i64], |r| r.get(0)).optional()?;
        let after = self.store.put_node(&first)? as u64;
        self.left = (self.left + after).saturating_sub(before.unwrap_or(0) as u64);
        // First what names pages, then the pages: between two transactions the file is whole.
        if let Some(node) = tree.behead(root, first) {
            self.gone(&node, names)?;
        }
        self.forget(named(&next).collect(), names)
    }

    fn drop_end(
        &mut self,
        id: u64,
        tree: &mut Tree,
        names: &mut BTreeMap<Name, u64>,
    ) -> Result<(), StoreError> {
        self.begin()?;
        tree.prune(id).map_or(Ok(()), |node| self.gone(&node, names))
    }

    /// A place that is no longer in the tree.
    fn gone(&mut self, node: &Node, names: &mut BTreeMap<Name, u64>) -> Result<(), StoreError> {
        let id = node.id as i64;
        let db = &self.store.db;
        self.store.raise(node.object_id, node)?;
        let mut bytes = 0u64;
        for sql in [
            "DELETE FROM node WHERE id = ?1 RETURNING length(data)",
            "DELETE FROM sight WHERE node = ?1 RETURNING length(png)",
        ] {
            bytes +=
                db.query_row(sql, [id], |r| r.get::<_, i64>(0)).optional()?.unwrap_or(0) as u64;
        }
        for (checkpoint, _) in self.checkpoints.remove(&node.id).unwrap_or_default() {
            let sql = "DELETE FROM checkpoint WHERE id = ?1 RETURNING length(data)";
            bytes +=
                db.query_row(sql, [checkpoint], |r| r.get::<_, i64>(0)).optional()?.unwrap_or(0)
                    as u64;
        }
        self.freed.places += 1;
        self.open += PLACE;
        self.free(bytes)?;
        self.forget(named(node).collect(), names)
    }

    /// Pages that one place or pin fewer names.
    fn forget(
        &mut self,
        all: Vec<Name>,
        names: &mut BTreeMap<Name, u64>,
    ) -> Result<(), StoreError> {
        for name in all {
            let Some(uses) = self.uses.get_mut(&name) else { continue };
            *uses -= 1;
            if *uses > 0 {
                continue;
            }
            self.uses.remove(&name);
            names.remove(&name);
            let sql = "DELETE FROM page WHERE lineage = ?1 AND number = ?2 AND revision = ?3 \
                RETURNING length(data)";
            let key = (name.0, name.1, name.2 as i64);
            let mut query = self.store.db.prepare_cached(sql)?;
            let bytes: Option<i64> = query.query_row(key, |r| r.get(0)).optional()?;
            drop(query);
            self.free(bytes.unwrap_or(0) as u64)?;
        }
        Ok(())
    }

    /// Lets the oldest jump's pages go. False: none may.
    fn pin(&mut self, names: &mut BTreeMap<Name, u64>) -> Result<bool, StoreError> {
        let Some(at) = self.pins.iter().position(|p| p.1 <= self.safe) else { return Ok(false) };
        let (id, _, pin) = self.pins.remove(at);
        self.begin()?;
        let sql = "DELETE FROM pin WHERE id = ?1 RETURNING length(data)";
        let bytes: i64 = self.store.db.query_row(sql, [id], |r| r.get(0))?;
        self.free(bytes as u64)?;
        self.forget(pin.pages.iter().map(|&(i, rev)| (pin.object_id, i, rev)).collect(), names)?;
        Ok(true)
    }

    /// Levels and other things beside the work that nothing names any more.
    fn levels(&mut self, tree: &Tree) -> Result<(), StoreError> {
        let mut used: BTreeSet<u64> = tree.nodes().filter_map(|n| n.levels).collect();
        used.extend(tree.nodes().flat_map(|n| n.scene.iter()).flat_map(|s| s.levels()));
        used.extend(self.pins.iter().filter_map(|p| p.2.levels));
        used.extend(self.checkpoints.values().flatten().flat_map(|c| c.1.iter().copied()));
        for id in self.store.side_ids()? {
            if !used.contains(&id) {
                let sql = "DELETE FROM side WHERE id = ?1 RETURNING length(data)";
                let bytes: i64 = self.store.db.query_row(sql, [id as i64], |r| r.get(0))?;
                self.free(bytes as u64)?;
            }
        }
        Ok(())
    }

    /// Topologies that no page has any more; those of the beginning stay.
    fn shapes(
        &mut self,
        names: &BTreeMap<Name, u64>,
        all: &mut BTreeSet<Name>,
    ) -> Result<(), StoreError> {
        let used: BTreeSet<Name> = names.iter().map(|(n, t)| (n.0, n.1, *t)).collect();
        let spare: Vec<Name> =
            all.iter().filter(|n| n.2 != 0 && !used.contains(*n)).copied().collect();
        for name in spare {
            let sql = "DELETE FROM topology WHERE lineage = ?1 AND number = ?2 AND revision = ?3 \
                RETURNING length(data)";
            let key = (name.0, name.1, name.2 as i64);
            let bytes: Option<i64> = self.store.db.query_row(sql, key, |r| r.get(0)).optional()?;
            all.remove(&name);
            self.free(bytes.unwrap_or(0) as u64)?;
        }
        Ok(())
    }

    fn begin(&mut self) -> Result<(), StoreError> {
        if !self.began {
            self.store.db.execute_batch("BEGIN IMMEDIATE")?;
            self.began = true;
        }
        Ok(())
    }

    /// Counts what went. A kill between two transactions leaves pages that nothing names; the next
    /// opening removes them.
    fn free(&mut self, bytes: u64) -> Result<(), StoreError> {
        self.freed.bytes += bytes;
        self.left = self.left.saturating_sub(bytes);
        self.open += bytes;
        if self.open > CHUNK {
            self.open = 0;
            self.store.db.execute_batch("COMMIT; BEGIN IMMEDIATE")?;
        }
        Ok(())
    }
}

/// The tables of the bound.
impl Store {
    /// A jump is sent that names these.
    pub fn put_pin(&self, pin: &Pin) -> Result<usize, StoreError> {
        let data = super::store::encoded(postcard::to_stdvec(pin))?;
        self.db.execute(
            "INSERT INTO pin (tick, data, layout) VALUES (?1, ?2, ?3)",
            (UNDER_WAY, &data, VERSION),
        )?;
        Ok(data.len())
    }

    /// Every jump that was under way was made, or never will be, by this tick.
    pub fn settle_pins(&self, tick: u64) -> Result<(), StoreError> {
        let tick = i64::try_from(tick).unwrap_or(UNDER_WAY - 1);
        self.db.execute("UPDATE pin SET tick = ?1 WHERE tick = ?2", (tick, UNDER_WAY))?;
        Ok(())
    }

    /// The jumps in order, with their ticks.
    pub fn pins(&self) -> Result<Vec<(i64, i64, Pin)>, StoreError> {
        let mut query = self.db.prepare("SELECT id, tick, data FROM pin ORDER BY id")?;
        let rows = query.query_map([], |r| Ok((r.get(0)?, r.get(1)?, r.get::<_, Vec<u8>>(2)?)))?;
        let mut all = Vec::new();
        for row in rows {
            let (id, tick, data) = row?;
            if let Ok(pin) = postcard::from_bytes(&data) {
                all.push((id, tick, pin));
            }
        }
        Ok(all)
    }

    /// The highest numbers of a lineage among the places that went.
    pub fn high(&self, object_id: u32) -> Result<HighestNumbers, StoreError> {
        let sql = "SELECT revision, vertex, triangle FROM high WHERE lineage = ?1";
        let row = self.db.query_row(sql, [object_id], |r| {
            Ok(HighestNumbers {
                revision: r.get::<_, i64>(0)? as u64,
                next: [r.get(1)?, r.get(2)?],
            })
        });
        Ok(row.optional()?.unwrap_or_default())
    }

    fn raise(&self, object_id: u32, node: &Node) -> Result<(), StoreError> {
        let h = self.high(object_id)?.over(node);
        let sql = "INSERT OR REPLACE INTO high (lineage, revision, vertex, triangle) VALUES (?1, \
            ?2, ?3, ?4)";
        self.db.execute(sql, (object_id, h.revision as i64, h.next[0], h.next[1]))?;
        Ok(())
    }

    fn side_ids(&self) -> Result<Vec<u64>, StoreError> {
        let mut query = self.db.prepare("SELECT id FROM side")?;
        let rows = query.query_map([], |r| r.get::<_, i64>(0))?;
        rows.map(|r| Ok(r? as u64)).collect()
    }
}
