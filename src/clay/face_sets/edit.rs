//! Edits of the face sets: what there is to ask for and to ask about, how pages get new sets. An
//! edit costs a look at every vertex, in portions ([`super::work`]), and a new page where one
//! changed or a neighbour's did.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{HIDDEN, MOST_SETS, PageSets};
use crate::clay::Clay;
use crate::page::Page;
use crate::ray::Hit;
use crate::snapshot::Snapshot;

/// An edit of the face sets of an object. Plain data: a part of commands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum SetsEdit {
    /// Makes a new set of the visible vertices masked by half or more.
    FromMask,
    /// Makes a new set of the visible vertices.
    FromVisible,
    /// Assigns these sets to the visible vertices, computed from the clay of this revision: see
    /// [`super::partition`].
    Assign {
        /// [`Clay::revision`] of the clay that they were computed from.
        revision: u64,
        /// The number of each page, and the sets of its owned vertices.
        pages: Arc<Vec<(u32, Vec<u16>)>>,
    },
    /// Removes every vertex from its set. Hidden vertices stay hidden.
    Clear,
    /// Hides a set.
    Hide(u16),
    /// Shows a set.
    Show(u16),
    /// Hides the vertices masked by half or more.
    HideMasked,
    /// Shows the hidden vertices, and hides the visible ones.
    Invert,
    /// Shows this set and hides everything else; 0 is the vertices in no set.
    Isolate(u16),
    /// Shows everything.
    ShowAll,
}

/// An edit of a part of the surface that is given vertex by vertex. Plain data: a part of commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PartEdit {
    /// Makes a new set of the part's visible vertices.
    NewSet,
    /// Hides the part.
    Hide,
    /// Hides everything except the part.
    Isolate,
}

/// The reason why an edit of the face sets was rejected. Nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SetsError {
    /// There was nothing to do.
    #[error(
        "it would change nothing: nothing is masked by half or more, nothing lies there, or it is \
         so already"
    )]
    Nothing,
    /// A set that no vertex is in.
    #[error("there is no face set {0}")]
    NoSet(u16),
    /// All numbers are used up.
    #[error("an object has at most {MOST_SETS} face sets; sets.clear makes room")]
    Full,
    /// The clay is another than the one that the sets were computed from.
    #[error("the object has changed since its face sets were computed")]
    Changed,
    /// Levels of thickness out of their range.
    #[error("the number of levels: expected 1 to 16")]
    Levels,
    /// The job was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl SetsEdit {
    /// Returns true if it owns memory beyond its size.
    pub fn owns_memory(&self) -> bool {
        matches!(self, SetsEdit::Assign { .. })
    }
}

/// The set of the corner that is nearest to a hit, by its weights; of equal ones the first.
fn set_at(page: &Page, hit: &Hit) -> u16 {
    let Some(corners) = page.triangles().get(hit.triangle as usize) else { return 0 };
    let [a, b, c] = hit.barycentric;
    let nearest = if a >= b && a >= c { 0 } else { 1 + usize::from(c > b) };
    page.face_set(usize::from(corners[nearest]))
}

impl Snapshot {
    /// The face set under a hit of this snapshot; 0: none.
    pub fn set_at(&self, hit: &Hit) -> u16 {
        self.pages().nth(hit.page as usize).map_or(0, |page| set_at(page, hit))
    }

    /// The greatest number of a set; 0: there is none.
    pub fn highest_set(&self) -> u16 {
        self.pages().map(|p| p.highest_set()).max().unwrap_or(0)
    }

    /// Each set that there is, ascending: its number, how many vertices it has, and how many of
    /// them are hidden. Set 0 is what is in no set. Costs a look at every vertex.
    pub fn face_sets(&self) -> Vec<(u16, u64, u64)> {
        let mut counts = vec![[0u64; 2]; usize::from(self.highest_set()) + 1];
        for page in self.pages() {
            match page.sets() {
                None => counts[0][0] += page.own() as u64,
                Some(sets) => sets.rows[..page.own()].iter().for_each(|r| {
                    let count = &mut counts[usize::from(r & !HIDDEN)];
                    count[0] += 1;
                    count[1] += u64::from(r & HIDDEN != 0);
                }),
            }
        }
        let all = counts.into_iter().enumerate().filter(|(_, c)| c[0] > 0);
        all.map(|(set, [vertices, hidden])| (set as u16, vertices, hidden)).collect()
    }

    /// Returns the number of sets, not counting the vertices in no set; 1 if there is no set but
    /// something is hidden. Nearly free without face sets.
    pub fn face_set_count(&self) -> u64 {
        if !self.pages().any(|p| p.sets.is_some()) {
            return 0;
        }
        let (sets, none) = (self.face_sets(), |s: &(u16, u64, u64)| s.0 == 0);
        (sets.iter().filter(|s| !none(s)).count() as u64).max(1)
    }
}

impl Clay {
    /// Returns true if any vertex is in a set or hidden.
    pub fn has_sets(&self) -> bool {
        self.pages.iter().any(|p| p.sets.is_some())
    }

    /// The number that the next new set gets: one above the greatest. `None`: all are used up.
    /// Costs what [`Clay::highest_set`] costs.
    pub fn next_set(&self) -> Option<u16> {
        let highest = self.highest_set();
        (highest < MOST_SETS).then_some(highest + 1)
    }

    /// The face set under a hit of the clay as it is; 0: none.
    pub fn set_at(&self, hit: &Hit) -> u16 {
        self.pages.get(hit.page as usize).map_or(0, |page| set_at(page, hit))
    }

    /// Sets the face sets of the owned vertices of some pages, ascending, and updates the halos.
    pub(crate) fn put_sets(&mut self, changed: &[(u32, Vec<u16>)]) {
        let mut concerned: Vec<u32> = Vec::with_capacity(2 * changed.len());
        for (number, _) in changed {
            concerned.push(*number);
            let t = &self.pages[*number as usize].topology;
            concerned.extend(t.neighbours.iter().map(|n| n.page));
        }
        concerned.sort_unstable();
        concerned.dedup();
        let of = |page: u32| changed.binary_search_by_key(&page, |c| c.0).ok();
        let fresh: Vec<(u32, Option<Arc<PageSets>>)> = concerned
            .into_iter()
            .filter_map(|number| {
                let page = &self.pages[number as usize];
                let own = |v: usize| page.set_bits(v);
                let mut rows: Vec<u16> = Vec::with_capacity(page.points.len());
                match of(number) {
                    Some(i) => rows.extend_from_slice(&changed[i].1),
                    None => rows.extend((0..page.own()).map(own)),
                }
                for (home, part) in page.topology.halo_parts() {
                    let from = &page.topology.halo_sources[part];
                    match of(home) {
                        Some(i) => rows.extend(from.iter().map(|&l| changed[i].1[l as usize])),
                        None => {
                            let home = &self.pages[home as usize];
                            rows.extend(from.iter().map(|&l| home.set_bits(l as usize)));
                        }
                    }
                }
                let sets = PageSets::shared(rows);
                (sets != page.sets).then_some((number, sets))
            })
            .collect();
        self.revision += 1;
        let count = fresh.len();
        for (number, sets) in fresh {
            let mut page = self.pool.take();
            let old = &self.pages[number as usize];
            // Nobody else holds a page of the pool.
            let Some(new) = Arc::get_mut(&mut page) else { continue };
            new.fill_from(old);
            (new.sets, new.revision) = (sets, self.revision);
            self.stale.add(number);
            let old = std::mem::replace(&mut self.pages[number as usize], page);
            if let Some(old) = self.history.keep(number, old) {
                self.pool.retire(old);
            }
        }
        self.stale.clear_paths();
        self.history.trim();
        self.pool.reclaim(2 * count + 4);
    }
}
