//! The history as the panel shows it: pictures of the steps in memory, and the versions that a
//! session's file keeps, laid out as a tree.

use std::collections::{BTreeMap, BTreeSet};

use sculptd_daemon::session::history::Tree;
use sculptd_engine::scene::SceneEvent;
use sculptd_engine::world::HistoryEvent;

/// Pictures kept.
pub const KEPT: usize = 24;

/// The object after a step.
#[derive(Clone)]
pub struct StepPicture {
    pub step: usize,
    /// Tells this state from another that came after as many steps.
    pub mark: u64,
    pub texture: egui::TextureHandle,
}

impl std::fmt::Debug for StepPicture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StepPicture").field("step", &self.step).finish_non_exhaustive()
    }
}

/// One version, as it is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VersionRow {
    pub node: u64,
    /// The row of the version before.
    pub parent: Option<usize>,
    /// 0: the line of the present version, with what redo leads to.
    pub lane: usize,
    pub tick: u64,
    /// The message of what was done, where it was more than a stroke.
    pub operation: Option<&'static str>,
    pub here: bool,
}

fn operation(event: HistoryEvent) -> Option<&'static str> {
    match event {
        HistoryEvent::Replace => Some("history-replaced"),
        HistoryEvent::Scene(event) => Some(match event {
            SceneEvent::Add => "history-added",
            SceneEvent::Remove => "history-removed",
            SceneEvent::Duplicate => "history-duplicated",
            SceneEvent::Rename => "history-renamed",
            SceneEvent::Transform => "history-moved",
            SceneEvent::Activate => "history-activated",
            SceneEvent::Show => "history-shown",
            SceneEvent::Lock => "history-locked",
            SceneEvent::Reshape => "history-reshaped",
            SceneEvent::Boolean => "history-boolean",
            SceneEvent::Merge => "history-merged",
            SceneEvent::Split => "history-split",
            SceneEvent::Layers => "history-layers",
            SceneEvent::Sets => "history-sets",
            SceneEvent::Mask => "history-mask",
            SceneEvent::Remesh => "history-remesh",
            SceneEvent::Snap => "history-snapped",
            SceneEvent::Arrange => "history-arranged",
            SceneEvent::NameSet => "history-set-named",
            SceneEvent::Follow => "history-followed",
            SceneEvent::Apply => "history-applied",
            SceneEvent::Mirror => "history-mirrored",
        }),
        _ => None,
    }
}

/// The tree, and how it was last shown.
#[derive(Default)]
pub struct HistoryVersions {
    pub rows: Vec<VersionRow>,
    /// Rows of the present line, the first version first.
    pub line: Vec<usize>,
    /// Ticks a second.
    pub rate_hz: u32,
    /// Pictures that have come.
    pub pictures: BTreeMap<u64, egui::TextureHandle>,
    /// Versions whose pictures are on the screen.
    pub visible: Vec<u64>,
    /// Version that a drag requested last.
    pub(in crate::panels) asked: Option<u64>,
    /// The version that was last scrolled to.
    pub(in crate::panels) shown: Option<u64>,
}

impl std::fmt::Debug for HistoryVersions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HistoryVersions").field("rows", &self.rows.len()).finish_non_exhaustive()
    }
}

impl HistoryVersions {
    /// Lays the tree out: a row a version, in the order in which they were made, branches beside
    /// the present line.
    pub fn set(&mut self, tree: &Tree) {
        let mut present: BTreeSet<u64> = tree.line(tree.cursor).map(|n| n.id).collect();
        let mut at = tree.cursor;
        while let Some(next) = tree.latest(at).filter(|next| present.insert(*next)) {
            at = next;
        }
        let row_of: BTreeMap<u64, usize> =
            tree.nodes().enumerate().map(|(i, n)| (n.id, i)).collect();
        // The last row of each lane that is taken.
        let mut ends = vec![usize::MAX];
        let mut rows: Vec<VersionRow> = Vec::with_capacity(tree.len());
        for (i, n) in tree.nodes().enumerate() {
            let parent = n.parent.and_then(|p| row_of.get(&p).copied());
            let lane = if present.contains(&n.id) {
                0
            } else {
                let goes_on = parent.filter(|p| {
                    rows[*p].lane > 0
                        && n.parent.is_some_and(|p| tree.children(p).first() == Some(&n.id))
                });
                goes_on.map_or_else(
                    || lane(tree, n.id, parent.unwrap_or(i), &mut ends, &row_of),
                    |p| rows[p].lane,
                )
            };
            let (tick, here) = (n.tick, n.id == tree.cursor);
            rows.push(VersionRow {
                node: n.id,
                parent,
                lane,
                tick,
                operation: operation(n.deed),
                here,
            });
        }
        self.line = (0..rows.len()).filter(|i| rows[*i].lane == 0).collect();
        self.rows = rows;
    }
}

impl HistoryVersions {
    /// Returns whether a version precedes the present one, and whether redo leads to one.
    pub fn ends(&self) -> (bool, bool) {
        let Some(here) = self.rows.iter().position(|r| r.here) else { return (false, false) };
        (self.rows[here].parent.is_some(), self.line.last().is_some_and(|last| *last > here))
    }
}

/// A free lane for the branch that begins at `id`.
fn lane(
    tree: &Tree,
    id: u64,
    from: usize,
    ends: &mut Vec<usize>,
    row_of: &BTreeMap<u64, usize>,
) -> usize {
    let mut end = id;
    while let Some(next) = tree.children(end).first() {
        end = *next;
    }
    let end = row_of.get(&end).copied().unwrap_or(from);
    let free = (1..ends.len()).find(|l| ends[*l] < from);
    let lane = free.unwrap_or_else(|| {
        ends.push(0);
        ends.len() - 1
    });
    ends[lane] = end;
    lane
}
