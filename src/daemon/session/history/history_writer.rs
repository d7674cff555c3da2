//! What the keeper writes: nodes, the versions of pages that they name, checkpoints. See [`super`].

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::store::{Checkpoint, Name, Store, StoreError};
use super::stored_scene::{
    StoredClay, StoredObject, StoredScene, same_scene, unchanged, version, versions_of,
};
use super::tree::{Change, NOTHING, Node, Tree};
use super::world_at_rest::WorldAtRest;
use crate::session::VERSION;
use crate::session::history::retention::{Freed, HighestNumbers, Pin, bound};
use crate::session::history::thumbnail;
use crate::session::stored_polygons::StoredPolygons;
use sculptd_clay::{Page, Snapshot};
use sculptd_engine::scene::{KnownHashes, ObjectId, ObjectSettings, SceneEvent, SceneView};
use sculptd_engine::world::{HistoryEntry, HistoryEvent, SideData};

/// Bytes of one transaction: the journal's own rows wait for no longer than that takes.
const CHUNK: usize = 4 << 20;

/// The file and the tree, and the work at the cursor.
#[derive(Debug)]
pub struct HistoryWriter {
    pub store: Store,
    pub tree: Tree,
    /// The work at the cursor.
    pub now: Snapshot,
    /// The objects at the cursor, as the world shows them and as they are stored; `None`: there is
    /// one, as a session begins.
    view: Arc<SceneView>,
    scene: Option<Arc<StoredScene>>,
    /// The revision of each page's topology in `now`, where it is not 0.
    pub topology: BTreeMap<u32, u64>,
    names: BTreeMap<Name, u64>,
    topologies: BTreeSet<Name>,
    sides: Vec<(SideData, u64)>,
    /// Known hashes of the pages for the previous checkpoint.
    hashes: KnownHashes,
    next_side: u64,
    polygons: StoredPolygons,
    /// Bytes in the open transaction.
    open: usize,
    /// Bytes that the history takes in the file, and may take.
    pub bytes: u64,
    pub most: u64,
    /// Another person's work began: no history is kept from there on.
    pub closed: bool,
}

impl HistoryWriter {
    /// Opens the history in the file, without the nodes after `purge` and without pages that no
    /// node uses.
    pub fn open(
        store: Store,
        purge: u64,
        now: Snapshot,
        most: u64,
    ) -> Result<HistoryWriter, StoreError> {
        let mut tree = Tree::default();
        store.db.execute_batch("BEGIN IMMEDIATE")?;
        for node in store.tree()?.nodes() {
            if node.tick <= purge && node.parent.is_none_or(|p| tree.node(p).is_some()) {
                tree.add(node.clone());
            } else {
                store.db.execute("DELETE FROM node WHERE id = ?1", [node.id as i64])?;
                store.db.execute("DELETE FROM sight WHERE node = ?1", [node.id as i64])?;
            }
        }
        let until = i64::try_from(purge).unwrap_or(i64::MAX);
        store.db.execute("DELETE FROM checkpoint WHERE tick > ?1", [until])?;
        let mut used: BTreeSet<Name> = BTreeSet::new();
        for n in tree.nodes() {
            used.extend(
                n.changes.iter().flat_map(|c| [(n.object_id, c.0, c.1), (n.object_id, c.0, c.2)]),
            );
            used.extend(n.scene.iter().flat_map(|s| s.names()));
        }
        // The pages named by the log's jumps stay, even if their places were removed.
        store.settle_pins(purge)?;
        for (_, _, pin) in store.pins()? {
            used.extend(pin.pages.iter().map(|&(i, revision)| (pin.object_id, i, revision)));
        }
        let mut names = store.names()?;
        for name in names.keys().filter(|n| !used.contains(*n)) {
            store.db.execute(
                "DELETE FROM page WHERE lineage = ?1 AND number = ?2 AND revision = ?3",
                (name.0, name.1, name.2 as i64),
            )?;
        }
        names.retain(|n, _| used.contains(n));
        // A topology is older than the pages that have it.
        let mut topologies = store.topologies()?;
        let kept: BTreeSet<Name> = names.iter().map(|(n, t)| (n.0, n.1, *t)).collect();
        for name in topologies.iter().filter(|n| n.2 != 0 && !kept.contains(*n)) {
            store.db.execute(
                "DELETE FROM topology WHERE lineage = ?1 AND number = ?2 AND revision = ?3",
                (name.0, name.1, name.2 as i64),
            )?;
        }
        topologies.retain(|n| n.2 == 0 || kept.contains(n));
        store.db.execute_batch("COMMIT")?;
        let next_side = store.next_side()?;
        let polygons = StoredPolygons::read(&store.db)?;
        let bytes = store.total()?;
        Ok(HistoryWriter {
            store,
            tree,
            now,
            view: Arc::default(),
            scene: None,
            topology: BTreeMap::new(),
            names,
            topologies,
            sides: Vec::new(),
            hashes: KnownHashes::default(),
            next_side,
            polygons,
            open: 0,
            bytes,
            most,
            closed: false,
        })
    }

    /// Moves the cursor to the state of the world: to `at`, or to a new node below it.
    pub fn begin(
        &mut self,
        tick: u64,
        first: &HistoryEntry,
        at: Option<u64>,
    ) -> Result<(), StoreError> {
        let work = &first.work;
        self.keep_polygons(first)?;
        let scene = self.scene_of(&first.scene)?;
        let parent = at.filter(|id| self.tree.node(*id).is_some());
        let known = parent.map(|id| self.tree.versions(id)).unwrap_or_default();
        let object_id = parent.and_then(|id| self.tree.node(id)).map_or(0, |n| n.object_id);
        let other = object_id != work.object_id();
        let changed: Vec<(u32, u64)> = (0..work.page_count() as u32)
            .map(|i| (i, if other { NOTHING } else { known.get(&i).copied().unwrap_or(0) }))
            .filter(|(i, before)| {
                let now = version(work.page(*i));
                now != *before && (now != NOTHING || other)
            })
            .collect();
        self.topology = if other {
            BTreeMap::new()
        } else {
            let of = |(i, rev): (&u32, &u64)| Some((*i, *self.names.get(&(object_id, *i, *rev))?));
            known.iter().filter_map(of).filter(|(_, t)| *t != 0).collect()
        };
        let same = same_scene(parent.and_then(|p| self.tree.scene_at(p)), scene.as_ref());
        (self.view, self.scene) = (first.scene.clone(), scene.clone());
        if parent.is_some() && changed.is_empty() && same {
            self.tree.go(parent.unwrap_or_default());
            return Ok(());
        }
        let node = self.node(
            tick,
            first,
            parent,
            if other { HistoryEvent::Replace } else { HistoryEvent::Step },
        );
        self.store.db.execute_batch("BEGIN IMMEDIATE")?;
        self.open = 0;
        let mut changes: Vec<Change> = Vec::with_capacity(changed.len());
        for (i, before) in changed {
            let page = work.page(i);
            if version(page) == NOTHING {
                changes.push((i, before, NOTHING));
                continue;
            }
            // Its topology may not be stored yet, so store it.
            self.topology.insert(i, page.revision());
            self.keep_topology((work.object_id(), i, page.revision()), page)?;
            self.keep_page((work.object_id(), i, page.revision()), page.revision(), page)?;
            changes.push((i, before, page.revision()));
        }
        let scene = scene.filter(|_| !same);
        self.finish_node(Node { changes, scene, ..node }, work)
    }

    /// The polygons of the files that new objects were loaded from are stored too.
    fn keep_polygons(&mut self, moment: &HistoryEntry) -> Result<(), StoreError> {
        let others = moment.scene.objects.iter().filter_map(|o| o.clay.as_ref());
        for clay in others.chain([&moment.work]) {
            self.polygons.keep(&self.store.db, clay)?;
        }
        Ok(())
    }

    /// Returns the objects as they are stored. Pages of inactive objects are written if they are
    /// not stored yet. `None`: there is one object, as at the start of a session.
    fn scene_of(&mut self, view: &Arc<SceneView>) -> Result<Option<Arc<StoredScene>>, StoreError> {
        if Arc::ptr_eq(view, &self.view) {
            return Ok(self.scene.clone());
        }
        // As at the start of a session: an object that remains after a Boolean of all has another
        // number.
        let first = view.objects.first().is_some_and(|o| o.id == ObjectId(0));
        if first && view.is_plain() && self.scene.is_none() {
            return Ok(None);
        }
        let before = (self.view.clone(), self.scene.clone());
        self.store.db.execute_batch("BEGIN IMMEDIATE")?;
        self.open = 0;
        let mut objects = Vec::with_capacity(view.objects.len());
        for o in &view.objects {
            let clay = match (unchanged(o, &before.0, before.1.as_deref()), &o.clay) {
                (Some(known), _) => Some(known.clone()),
                (None, Some(clay)) => Some(StoredClay {
                    number: clay.object_id(),
                    pages: Arc::new(self.stored_pages(clay)?),
                    middle: o.middle,
                    extent: o.extent,
                    next: clay.next_numbers(),
                    levels: match clay.levels() {
                        Some(levels) => Some(self.side(SideData::Levels(levels.clone()))?),
                        None => None,
                    },
                }),
                (None, None) => None,
            };
            objects.push(StoredObject { id: o.id, settings: o.settings.clone(), clay });
        }
        self.store.db.execute_batch("COMMIT")?;
        Ok(Some(Arc::new(StoredScene { objects, active: view.active as u32 })))
    }

    /// Returns the name of every page of a clay; pages not yet stored are written.
    fn stored_pages(&mut self, clay: &Snapshot) -> Result<Vec<(u32, u64)>, StoreError> {
        let (number, all) = (clay.object_id(), versions_of(clay));
        for &(i, revision) in &all {
            // The start already contains its pages.
            let known = revision == NOTHING || number == 0 && revision == 0;
            if !known && !self.names.contains_key(&(number, i, revision)) {
                let page = clay.page(i).clone();
                self.keep_topology((number, i, revision), &page)?;
                self.keep_page((number, i, revision), revision, &page)?;
            }
        }
        Ok(all)
    }

    /// After an error: what the file holds is read again, for a part of it may not have been
    /// written.
    pub fn recover(&mut self) {
        let _ = self.store.db.execute_batch("ROLLBACK");
        if let (Ok(names), Ok(topologies)) = (self.store.names(), self.store.topologies()) {
            (self.names, self.topologies) = (names, topologies);
        }
        if let Ok(bytes) = self.store.total() {
            self.bytes = bytes;
        }
        self.sides.clear();
    }

    fn node(
        &mut self,
        tick: u64,
        moment: &HistoryEntry,
        parent: Option<u64>,
        deed: HistoryEvent,
    ) -> Node {
        let levels = moment.work.levels().map(|l| SideData::Levels(l.clone()));
        Node {
            id: self.tree.next_id(),
            parent,
            tick,
            deed,
            object_id: moment.work.object_id(),
            changes: Vec::new(),
            pages: moment.work.page_count() as u32,
            middle: moment.middle,
            extent: moment.extent,
            next: moment.work.next_numbers(),
            levels: levels.and_then(|l| self.side(l).ok()),
            scene: None,
        }
    }

    /// Returns the id of a side, which is written on its first use.
    fn side(&mut self, side: SideData) -> Result<u64, StoreError> {
        if let Some((_, id)) = self.sides.iter().find(|(known, _)| known.is_same(&side)) {
            return Ok(*id);
        }
        let id = self.next_side;
        self.bytes += self.store.put_side(id, &side)? as u64;
        self.next_side += 1;
        // One of each kind is remembered: the next one of it is seldom an older one.
        self.sides
            .retain(|(known, _)| std::mem::discriminant(known) != std::mem::discriminant(&side));
        self.sides.push((side, id));
        Ok(id)
    }

    /// The pages that differ from the work at the cursor; `None` for another work.
    fn differences(&self, work: &Snapshot) -> Option<Vec<Change>> {
        if work.object_id() != self.now.object_id() {
            return None;
        }
        let mut changes = Vec::new();
        work.each_changed(&self.now, |i, page| {
            let old = (i as usize) < self.now.page_count();
            let before = if old { version(self.now.page(i)) } else { NOTHING };
            let after = version(page);
            if before != after {
                changes.push((i, before, after));
            }
        });
        Some(changes)
    }

    /// Goes where a deed led, or writes a node for it.
    pub fn moment(&mut self, tick: u64, moment: &HistoryEntry) -> Result<(), StoreError> {
        let work = &moment.work;
        // Visitors come and go: nothing of one is kept for the next.
        if self.closed || moment.deed == HistoryEvent::Begin {
            self.closed = true;
            self.now = work.clone();
            return Ok(());
        }
        let changes = self.differences(work);
        if changes.is_none() || !Arc::ptr_eq(&moment.scene, &self.view) {
            self.keep_polygons(moment)?;
        }
        let scene = self.scene_of(&moment.scene)?;
        // Not what was seen last: after an error that may not have been written.
        let same = same_scene(self.tree.scene_at(self.tree.cursor), scene.as_ref());
        (self.view, self.scene) = (moment.scene.clone(), scene.clone());
        let leads_here = |tree: &Tree, id: u64| same_scene(tree.scene_at(id), scene.as_ref());
        let fits = |n: &&Node| n.object_id == work.object_id() && leads_here(&self.tree, n.id);
        let known = match moment.deed {
            // A scene that changed on the way makes it another place.
            HistoryEvent::Jump(id) => self.tree.node(id).filter(fits).map(|n| n.id),
            _ if same && changes.as_ref().is_some_and(|c| c.is_empty()) => Some(self.tree.cursor),
            HistoryEvent::Undo => self.tree.here().and_then(|here| {
                let back = |c: &Change| (c.0, c.2, c.1);
                let fits = match &changes {
                    Some(changes) => {
                        !here.begins_clay()
                            && here.changes.iter().map(back).eq(changes.iter().copied())
                    }
                    None => here.begins_clay(),
                };
                here.parent.filter(|p| {
                    fits && leads_here(&self.tree, *p)
                        && self.tree.node(*p).is_some_and(|p| p.object_id == work.object_id())
                })
            }),
            HistoryEvent::Redo => self.tree.children(self.tree.cursor).iter().copied().find(|id| {
                self.tree.node(*id).is_some_and(|n| {
                    n.object_id == work.object_id()
                        && leads_here(&self.tree, *id)
                        && changes.as_ref().is_none_or(|c| *c == n.changes)
                })
            }),
            HistoryEvent::Step
            | HistoryEvent::Replace
            | HistoryEvent::Begin
            | HistoryEvent::Scene(_) => None,
        };
        if let Some(id) = known {
            self.tree.go(id);
            self.stand(work);
            return Ok(());
        }
        let parent = Some(self.tree.cursor);
        let deed = match (moment.deed, &changes) {
            (HistoryEvent::Scene(event), None) => HistoryEvent::Scene(event),
            (
                HistoryEvent::Scene(
                    SceneEvent::Layers | SceneEvent::Sets | SceneEvent::Mask | SceneEvent::Remesh,
                ),
                _,
            ) => moment.deed,
            (HistoryEvent::Scene(event), Some(c)) if c.is_empty() => HistoryEvent::Scene(event),
            (_, None) => HistoryEvent::Replace,
            (_, Some(_)) => HistoryEvent::Step,
        };
        let mut node = self.node(tick, moment, parent, deed);
        self.store.db.execute_batch("BEGIN IMMEDIATE")?;
        self.open = 0;
        // If one object remains as at the start of a session, the node records that too.
        node.scene = (!same).then(|| scene.unwrap_or_else(|| Arc::new(StoredScene::one_object())));
        node.changes = match changes {
            Some(changes) => {
                for &(i, before, after) in &changes {
                    self.step_page(work, i, before, after)?;
                }
                changes
            }
            None => self.keep_all_pages(work)?,
        };
        self.finish_node(node, work)
    }

    /// A page that a step changed: before, if it was never stored, and after.
    fn step_page(
        &mut self,
        work: &Snapshot,
        i: u32,
        before: u64,
        after: u64,
    ) -> Result<(), StoreError> {
        let object_id = work.object_id();
        let page = work.page(i).clone();
        let had = self.topology.get(&i).copied().unwrap_or(0);
        let mut topology = after;
        if before != NOTHING {
            let old = self.now.page(i).clone();
            let stays = Arc::ptr_eq(old.topology(), page.topology());
            if stays {
                topology = had;
            } else {
                self.keep_topology((object_id, i, had), &old)?;
            }
            self.keep_page((object_id, i, before), had, &old)?;
        }
        if after == NOTHING {
            return Ok(());
        }
        if topology == after {
            self.keep_topology((object_id, i, after), &page)?;
        }
        self.keep_page((object_id, i, after), topology, &page)
    }

    /// Another work, with all its pages.
    fn keep_all_pages(&mut self, work: &Snapshot) -> Result<Vec<Change>, StoreError> {
        let object_id = work.object_id();
        (0..work.page_count() as u32)
            .map(|i| {
                let page = work.page(i).clone();
                let revision = version(&page);
                if revision == NOTHING {
                    return Ok((i, NOTHING, NOTHING));
                }
                // If undo restores the sculpture, its pages are already stored.
                if !self.names.contains_key(&(object_id, i, revision)) {
                    self.keep_topology((object_id, i, revision), &page)?;
                    self.keep_page((object_id, i, revision), revision, &page)?;
                }
                Ok((i, NOTHING, revision))
            })
            .collect()
    }

    fn keep_page(&mut self, name: Name, topology: u64, page: &Page) -> Result<(), StoreError> {
        if self.names.contains_key(&name) {
            return Ok(());
        }
        let bytes = self.store.put_page(name, topology, page)?;
        self.names.insert(name, topology);
        self.chunk(bytes)
    }

    fn keep_topology(&mut self, name: Name, page: &Page) -> Result<(), StoreError> {
        if self.topologies.contains(&name) {
            return Ok(());
        }
        let bytes = self.store.put_topology(name, page.topology())?;
        self.topologies.insert(name);
        self.chunk(bytes)
    }

    fn chunk(&mut self, bytes: usize) -> Result<(), StoreError> {
        self.open += bytes;
        self.bytes += bytes as u64;
        if self.open > CHUNK {
            self.open = 0;
            self.store.db.execute_batch("COMMIT; BEGIN IMMEDIATE")?;
        }
        Ok(())
    }

    fn finish_node(&mut self, node: Node, work: &Snapshot) -> Result<(), StoreError> {
        self.bytes += self.store.put_node(&node)? as u64;
        if let Some(png) = thumbnail::png(work) {
            self.bytes += self.store.put_sight(node.id, &png)? as u64;
        }
        self.store.db.execute_batch("COMMIT")?;
        let id = node.id;
        self.tree.add(node);
        self.tree.go(id);
        self.stand(work);
        Ok(())
    }

    /// The work at the cursor is this one.
    fn stand(&mut self, work: &Snapshot) {
        let object_id = work.object_id();
        match self.differences(work) {
            Some(changes) => {
                for (i, _, after) in changes {
                    let t = self.names.get(&(object_id, i, after)).copied().unwrap_or(0);
                    self.topology.insert(i, t);
                }
            }
            None => {
                self.topology = (0..work.page_count() as u32)
                    .filter_map(|i| {
                        Some((i, *self.names.get(&(object_id, i, work.page(i).revision()))?))
                    })
                    .collect();
            }
        }
        self.now = work.clone();
    }

    /// Writes a checkpoint, with the hash of the live sculpture as its proof.
    pub fn state(&mut self, world: &WorldAtRest) -> Result<(), StoreError> {
        let saved = &world.saved;
        // After moments that were left out, this is not the work at the cursor.
        let now = (self.now.object_id(), self.now.revision());
        if self.closed || (saved.rest.object_id, saved.rest.revision) != now {
            return Ok(());
        }
        let listed = saved.scene().ok().flatten();
        let listed = listed.map_or(vec![(ObjectId(0), ObjectSettings::default())], |s| {
            s.objects.into_iter().map(|o| (o.id, o.settings)).collect()
        });
        let plain = StoredScene::one_object();
        let stored = self.tree.scene_at(self.tree.cursor).map_or(&plain, |s| s);
        let stored = stored.objects.iter().map(|o| (o.id, o.settings.clone()));
        if !stored.eq(listed) {
            return Ok(());
        }
        self.store.db.execute_batch("BEGIN IMMEDIATE")?;
        let sides = [
            saved.thing.clone().map(SideData::HeldObject),
            saved.picture.clone().map(SideData::Picture),
            saved.levels.clone().map(SideData::Levels),
        ];
        let mut ids = [None; 3];
        for (id, side) in ids.iter_mut().zip(sides) {
            *id = side.map(|s| self.side(s)).transpose()?;
        }
        let bytes = self.store.put_checkpoint(&Checkpoint {
            tick: saved.tick,
            node: self.tree.cursor,
            rest: saved.rest.clone(),
            core: saved.core.clone(),
            sides: ids,
            steps: saved.steps,
            layout: VERSION,
            proof: Some(world.scene.page_hash(&world.active, &mut self.hashes)),
        })?;
        self.store.db.execute_batch("COMMIT")?;
        self.bytes += bytes as u64;
        Ok(())
    }

    /// Lets the oldest places go where the history takes more than it may, so many at once that it
    /// is seldom done.
    pub fn keep_within(&mut self) -> Result<Option<Freed>, StoreError> {
        if self.bytes <= self.most {
            return Ok(None);
        }
        let most = self.most - self.most / 8;
        let (tree, names, topologies) = (&mut self.tree, &mut self.names, &mut self.topologies);
        let (freed, left) = bound(&self.store, tree, names, topologies, self.bytes, most)?;
        self.bytes = left;
        // Sides that were removed are written again on their next use.
        self.sides.clear();
        Ok(Some(freed))
    }

    /// Keeps the data that a jump to a node in the log names, as long as possible.
    pub fn pin(
        &mut self,
        node: u64,
        pages: &[(u32, u64)],
        levels: Option<u64>,
    ) -> Result<(), StoreError> {
        match self.tree.node(node).map(|n| n.object_id) {
            Some(object_id) => self.pin_clay(object_id, pages, levels),
            None => Ok(()),
        }
    }

    /// The same for the pages of one clay.
    pub fn pin_clay(
        &mut self,
        object_id: u32,
        pages: &[(u32, u64)],
        levels: Option<u64>,
    ) -> Result<(), StoreError> {
        self.bytes += self.store.put_pin(&Pin { object_id, pages: pages.to_vec(), levels })? as u64;
        Ok(())
    }

    /// The highest numbers that a lineage ever had.
    pub fn high(&self, object_id: u32) -> Result<HighestNumbers, StoreError> {
        let first = self.store.high(object_id)?;
        Ok(self.tree.nodes().filter(|n| n.object_id == object_id).fold(first, HighestNumbers::over))
    }
}
