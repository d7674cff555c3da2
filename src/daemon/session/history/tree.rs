//! Which node follows which, and what lies between two of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use super::page_name::NOTHING;
use super::stored_scene::{StoredScene, same_scene};
use sculptd_engine::world::HistoryEvent;

/// A page that a step changed: its number, its revision before, and after.
pub type Change = (u32, u64, u64);

/// The work after a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Node {
    pub id: u64,
    pub parent: Option<u64>,
    pub tick: u64,
    pub deed: HistoryEvent,
    pub object_id: u32,
    /// Against the parent; of a work that took another's place, all pages, from [`NOTHING`].
    pub changes: Vec<Change>,
    /// All pages of the work.
    pub pages: u32,
    pub middle: Vec3,
    pub extent: f32,
    /// Numbers that the next new vertex and triangle get.
    pub next: [u32; 2],
    pub levels: Option<u64>,
    /// The objects, where the list differs from that of the node before. Lies behind the node in
    /// the same row.
    #[serde(skip)]
    pub scene: Option<Arc<StoredScene>>,
}

impl Node {
    /// Returns whether another clay begins here, so that `changes` names all its pages. An edit of
    /// layers, sets or masks names the pages that it changed, like a stroke: the pages themselves
    /// decide, not the kind of event.
    pub fn begins_clay(&self) -> bool {
        match self.deed {
            HistoryEvent::Replace => true,
            HistoryEvent::Scene(_) => {
                self.changes.len() == self.pages as usize
                    && !self.changes.is_empty()
                    && self.changes.iter().all(|c| c.1 == NOTHING)
            }
            _ => false,
        }
    }
}

/// All nodes, and where the work is.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    /// Shared with those whom the tree was shown to.
    nodes: BTreeMap<u64, Arc<Node>>,
    children: BTreeMap<u64, Vec<u64>>,
    /// The child of each node that was left last: where redo leads.
    latest: BTreeMap<u64, u64>,
    pub cursor: u64,
}

/// The way from one node to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TreePath {
    /// The pages to put in place, within one work.
    Pages(Vec<(u32, u64)>),
    /// Another work.
    Other,
    /// Other objects.
    Scene,
}

impl Tree {
    pub fn add(&mut self, node: Node) {
        if let Some(parent) = node.parent {
            let beside = self.children.entry(parent).or_default();
            if !beside.contains(&node.id) {
                beside.push(node.id);
            }
            self.latest.insert(parent, node.id);
        }
        self.nodes.insert(node.id, Arc::new(node));
    }

    pub fn node(&self, id: u64) -> Option<&Node> {
        self.nodes.get(&id).map(Arc::as_ref)
    }

    pub fn here(&self) -> Option<&Node> {
        self.node(self.cursor)
    }

    /// In the order in which they were made.
    pub fn nodes(&self) -> impl Iterator<Item = &Node> {
        self.nodes.values().map(Arc::as_ref)
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn next_id(&self) -> u64 {
        self.nodes.last_key_value().map_or(0, |(id, _)| id.saturating_add(1))
    }

    pub fn children(&self, id: u64) -> &[u64] {
        self.children.get(&id).map_or(&[], Vec::as_slice)
    }

    /// Returns the target of an undo; `None` at the beginning.
    pub fn before(&self) -> Option<u64> {
        self.here()?.parent
    }

    /// Returns the target of a redo.
    pub fn after(&self) -> Option<u64> {
        self.latest.get(&self.cursor).copied()
    }

    /// The child of a node that was left last.
    pub fn latest(&self, id: u64) -> Option<u64> {
        self.latest.get(&id).copied()
    }

    /// The work is at this node now; redo leads back to where it came from along the way.
    pub fn go(&mut self, id: u64) {
        let mut at = id;
        while let Some(parent) = self.nodes.get(&at).and_then(|n| n.parent) {
            self.latest.insert(parent, at);
            at = parent;
        }
        self.cursor = id;
    }

    /// Takes out a node that nothing follows.
    pub fn prune(&mut self, id: u64) -> Option<Node> {
        if !self.children(id).is_empty() {
            return None;
        }
        let node = self.nodes.remove(&id)?;
        self.children.remove(&id);
        if let Some(parent) = node.parent {
            let beside = self.children.entry(parent).or_default();
            beside.retain(|c| *c != id);
            if self.latest.get(&parent) == Some(&id) {
                match beside.last() {
                    Some(other) => self.latest.insert(parent, *other),
                    None => self.latest.remove(&parent),
                };
            }
        }
        Some(Arc::unwrap_or_clone(node))
    }

    /// Takes out a root; `first`, the only one that follows it, is the root from now on.
    pub fn behead(&mut self, root: u64, first: Node) -> Option<Node> {
        if self.children(root) != [first.id] {
            return None;
        }
        self.children.remove(&root);
        self.latest.remove(&root);
        self.nodes.insert(first.id, Arc::new(first));
        self.nodes.remove(&root).map(Arc::unwrap_or_clone)
    }

    /// The objects at a node; `None`: there is one, as a session begins with it.
    pub fn scene_at(&self, id: u64) -> Option<&Arc<StoredScene>> {
        self.line(id).find_map(|n| n.scene.as_ref())
    }

    /// The nodes from this one up to its root.
    pub fn line(&self, id: u64) -> impl Iterator<Item = &Node> {
        std::iter::successors(self.node(id), |n| n.parent.and_then(|p| self.node(p)))
    }

    /// From the cursor to a node; `None` where there is no way, for they do not hang together.
    pub fn way(&self, to: u64) -> Option<TreePath> {
        let target = self.node(to)?;
        let up: Vec<&Node> = self.line(self.cursor).collect();
        let mut down: Vec<&Node> = Vec::new();
        let mut meet = None;
        for node in self.line(to) {
            if let Some(k) = up.iter().position(|n| n.id == node.id) {
                meet = Some(k);
                break;
            }
            down.push(node);
        }
        let up = &up[..meet?];
        if !same_scene(self.scene_at(self.cursor), self.scene_at(to)) {
            return Some(TreePath::Scene);
        }
        let object_id = self.here()?.object_id;
        if target.object_id != object_id || up.iter().chain(&down).any(|n| n.begins_clay()) {
            return Some(TreePath::Other);
        }
        let mut pages = BTreeMap::new();
        for node in up {
            pages.extend(node.changes.iter().map(|c| (c.0, c.1)));
        }
        for node in down.iter().rev() {
            pages.extend(node.changes.iter().map(|c| (c.0, c.2)));
        }
        Some(TreePath::Pages(pages.into_iter().collect()))
    }

    /// The version of every page of the work at a node. `first`: pages of the work that the session
    /// began with.
    pub fn names(&self, node: &Node, pages: u32, first: usize) -> Vec<(u32, u64)> {
        let versions = self.versions(node.id);
        // A page that no step speaks of is as it was in the beginning, or was not there.
        let unspoken =
            |i: u32| if node.object_id == 0 && (i as usize) < first { 0 } else { NOTHING };
        (0..pages).map(|i| (i, versions.get(&i).copied().unwrap_or_else(|| unspoken(i)))).collect()
    }

    /// The revision of every page that any step changed since the work was put in place; the others
    /// are as they were then.
    pub fn versions(&self, id: u64) -> BTreeMap<u32, u64> {
        let mut found = BTreeMap::new();
        for node in self.line(id) {
            for (page, _, after) in &node.changes {
                found.entry(*page).or_insert(*after);
            }
            if node.begins_clay() {
                break;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(id: u64, parent: Option<u64>, changes: &[Change]) -> Node {
        Node {
            id,
            parent,
            tick: id * 10,
            deed: HistoryEvent::Step,
            object_id: 0,
            changes: changes.to_vec(),
            pages: 9,
            middle: Vec3::ZERO,
            extent: 1.0,
            next: [0, 0],
            levels: None,
            scene: None,
        }
    }

    #[test]
    fn the_way_from_branch_to_branch_puts_every_page_right() {
        let mut tree = Tree::default();
        tree.add(node(0, None, &[]));
        tree.add(node(1, Some(0), &[(1, 0, 1), (2, 0, 1)]));
        tree.add(node(2, Some(1), &[(2, 1, 2)]));
        // After taking both back: a branch.
        tree.add(node(3, Some(0), &[(2, 0, 5), (4, 0, 5)]));
        tree.cursor = 2;
        assert_eq!(tree.way(3), Some(TreePath::Pages(vec![(1, 0), (2, 5), (4, 5)])));
        assert_eq!(tree.way(0), Some(TreePath::Pages(vec![(1, 0), (2, 0)])));
        assert_eq!(tree.way(2), Some(TreePath::Pages(vec![])));
        tree.go(3);
        assert_eq!(tree.way(1), Some(TreePath::Pages(vec![(1, 1), (2, 1), (4, 0)])));
        assert_eq!((tree.before(), tree.after()), (Some(0), None));
        tree.go(1);
        tree.go(0);
        assert_eq!(tree.after(), Some(1), "redo leads where one was last");
        assert_eq!(tree.versions(2), [(1, 1), (2, 2)].into());
        assert_eq!(tree.way(77), None);
    }
}
