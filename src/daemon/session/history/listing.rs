//! The history as a list, for people and for other programs.

use std::path::Path;

use serde::Serialize;

use super::store::{Store, StoreError};
use super::tree::Tree;
use sculptd_engine::world::HistoryEvent;

/// One place of the history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Place {
    pub node: u64,
    /// The place before; none where a work begins.
    pub parent: Option<u64>,
    pub tick: u64,
    pub deed: HistoryEvent,
    /// Pages that the step changed, of all.
    pub changed: usize,
    pub pages: u32,
    /// True if another branch starts at the previous place.
    pub branch: bool,
    /// True if the sculpture is at this place.
    pub here: bool,
}

/// Contents of a session's history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct History {
    pub places: Vec<Place>,
    /// Bytes of the stored pages.
    pub bytes: u64,
    /// Bytes of all of the history: what `undo.history_bytes` bounds.
    pub total_bytes: u64,
    /// Places that were let go, to keep within the bound or with what a crash cost.
    pub dropped: u64,
    pub checkpoints: u64,
}

/// Every place, in the order in which they were made.
pub fn places(tree: &Tree) -> Vec<Place> {
    tree.nodes()
        .map(|n| Place {
            node: n.id,
            parent: n.parent,
            tick: n.tick,
            deed: n.deed,
            changed: n.changes.len(),
            pages: n.pages,
            branch: n.parent.is_some_and(|p| tree.children(p).len() > 1),
            here: n.id == tree.cursor,
        })
        .collect()
}

/// Reads the newest small picture of a session's sculpture, PNG; `None` if it has none.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn newest_picture(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    let store = Store::read(path)?;
    if store.has_tables()? { store.newest_thumbnail() } else { Ok(None) }
}

/// Reads a session's history; it is empty if the session has none.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn read(path: &Path) -> Result<History, StoreError> {
    let store = Store::read(path)?;
    if !store.has_tables()? {
        return Ok(History {
            places: Vec::new(),
            bytes: 0,
            total_bytes: 0,
            dropped: 0,
            checkpoints: 0,
        });
    }
    let mut tree = store.tree()?;
    let all = store.checkpoints(u64::MAX)?;
    // The cursor at the time of the last write.
    if let Some(newest) = all.first().and_then(|id| store.checkpoint(*id).ok()) {
        tree.cursor = newest.node;
    }
    Ok(History {
        places: places(&tree),
        bytes: store.bytes()?,
        total_bytes: store.total()?,
        // Places are numbered in the order in which they are made.
        dropped: tree.next_id().saturating_sub(tree.len() as u64),
        checkpoints: all.len() as u64,
    })
}
