//! Pages as bytes, and clay put together from pages that were stored: what a session file keeps of
//! an object's history.
//!
//! A page is named by its number and the revision that wrote it: within one object two pages of one
//! name are the same, to the bit. Trees are not stored, they follow from the points.

use std::sync::Arc;

use glam::{Vec3, Vec4};
use serde::{Deserialize, Serialize};

use super::boxtree::LEAF;
use super::clay::Clay;
use super::layers::PageLayers;
use super::page::{BREAK, Page, PageTopology};
use super::page_sets::PageSets;
use crate::assembly::Built;

/// The bytes are not those of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not those of a page")]
pub struct BadPage;

/// The state of the clay besides its pages.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectState {
    /// The number of pages.
    pub pages: u32,
    /// As [`Clay::revision`].
    pub revision: u64,
    /// As [`Clay::object_id`].
    pub object_id: u32,
    /// The numbers that the next new vertex and triangle get.
    pub next: [u32; 2],
    /// Pages without vertices that are used first.
    pub empty: Vec<u32>,
}

impl PageTopology {
    /// The topology as bytes (postcard).
    pub fn to_bytes(&self) -> Vec<u8> {
        // Plain data always serialises.
        postcard::to_stdvec(self).unwrap_or_default()
    }

    /// # Errors
    /// [`BadPage`] where anything points outside.
    pub fn from_bytes(bytes: &[u8]) -> Result<PageTopology, BadPage> {
        postcard::from_bytes::<PageTopology>(bytes).map_err(|_| BadPage)?.checked()
    }

    /// The topology with what follows from it filled in.
    ///
    /// # Errors
    /// [`BadPage`] where anything points outside.
    pub(super) fn checked(mut self) -> Result<PageTopology, BadPage> {
        let t = &self;
        let halo = t.halo_sources.len();
        let all = t.own.checked_add(halo).filter(|n| *n < BREAK as usize).ok_or(BadPage)?;
        let ascending = |ends: &[u16]| ends.windows(2).all(|w| w[0] <= w[1]);
        let sane = t.ids.len() == t.own
            && t.kinds.len() == t.own
            && t.triangle_ids.len() == t.triangles.len()
            && t.triangles.iter().flatten().all(|&v| (v as usize) < all)
            && t.hexes.len() <= t.own
            && t.hexes.rows() <= all
            // A page without anything has no starts at all.
            && (t.ring_starts.len() == t.own - t.hexes.len() + 1 || t.own == 0)
            && ascending(&t.ring_starts)
            && t.ring_starts.last().is_none_or(|e| *e as usize == t.rings.len())
            && t.rings.iter().all(|&v| ((v & !BREAK) as usize) < all)
            && t.neighbours.windows(2).all(|w| w[0].page < w[1].page && w[0].first <= w[1].first)
            && t.neighbours.first().is_none_or(|n| n.first == 0)
            && t.neighbours.iter().all(|n| n.first as usize <= halo)
            && (halo == 0 || !t.neighbours.is_empty());
        if sane && self.index() { Ok(self) } else { Err(BadPage) }
    }
}

impl Page {
    /// Returns the part that a dab may change: points and normals, owned and halo, 32 bytes a
    /// vertex. Layer data (postcard) follows if the page has layers or face sets. Face sets, two
    /// bytes a vertex, follow if it has any.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.points.len() * 32);
        for row in self.points.iter().chain(&self.normals) {
            for x in row.to_array() {
                out.extend_from_slice(&x.to_bits().to_le_bytes());
            }
        }
        let none = PageLayers::default();
        out = match (self.layers(), self.sets()) {
            (None, None) => return out,
            // Plain data always serialises.
            (layers, _) => postcard::to_extend(layers.unwrap_or(&none), out).unwrap_or_default(),
        };
        let sets = self.sets().map_or(&[][..], |s| s.rows());
        sets.iter().for_each(|s| out.extend_from_slice(&s.to_le_bytes()));
        out
    }

    /// The page again, with what stands still in it.
    ///
    /// # Errors
    /// [`BadPage`] where the bytes are of another page, or a place is not finite.
    pub fn from_bytes(
        bytes: &[u8],
        topology: Arc<PageTopology>,
        revision: u64,
    ) -> Result<Page, BadPage> {
        let all = topology.own + topology.halo_sources.len();
        let Some((bytes, rest)) = bytes.split_at_checked(all * 32) else { return Err(BadPage) };
        let (mut layers, mut sets) = (None, None);
        if !rest.is_empty() {
            let (some, rest): (PageLayers, &[u8]) =
                postcard::take_from_bytes(rest).map_err(|_| BadPage)?;
            if !some.fits(topology.own) || !(rest.is_empty() || rest.len() == all * 2) {
                return Err(BadPage);
            }
            layers = some.shared();
            let number = |b: &[u8]| u16::from_le_bytes([b[0], b[1]]);
            sets = PageSets::shared(rest.chunks_exact(2).map(number).collect());
        }
        let row = |b: &[u8]| {
            let x =
                |k: usize| f32::from_bits(u32::from_le_bytes([b[k], b[k + 1], b[k + 2], b[k + 3]]));
            Vec4::new(x(0), x(4), x(8), x(12))
        };
        let (points, normals) = bytes.split_at(all * 16);
        let points: Vec<Vec4> = points.chunks_exact(16).map(row).collect();
        let normals: Vec<Vec4> = normals.chunks_exact(16).map(row).collect();
        Page { topology, points, normals, revision, layers, sets, ..Page::default() }.of_read()
    }

    /// The page that was read, with what follows from its points filled in.
    ///
    /// # Errors
    /// [`BadPage`] where a place is not finite.
    pub(super) fn of_read(mut self) -> Result<Page, BadPage> {
        // The colour's bits may spell anything.
        if !self.points.iter().all(|p| p.is_finite())
            || !self.normals.iter().all(|n| n.truncate().is_finite())
        {
            return Err(BadPage);
        }
        self.tree.reset(self.topology.triangles.len().div_ceil(LEAF));
        if self.topology.own == 0 && self.topology.triangles.is_empty() {
            (self.lo, self.hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        } else {
            self.refit(u32::MAX);
        }
        Ok(self)
    }

    /// The page that stands where there was none before.
    pub fn nothing() -> Page {
        let mut page = Page { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY, ..Page::default() };
        page.tree.reset(0);
        page
    }
}

/// Returns true if every page's halo refers to vertices that exist.
fn fit(pages: &[Arc<Page>]) -> bool {
    pages.iter().all(|p| {
        let t = p.topology();
        t.halo_parts().all(|(home, part)| {
            pages.get(home as usize).is_some_and(|h| {
                t.halo_sources.get(part).is_some_and(|s| s.iter().all(|&l| (l as usize) < h.own()))
            })
        })
    })
}

impl Clay {
    /// What [`Clay::of_stored`] needs besides the pages.
    pub fn rest(&self) -> ObjectState {
        ObjectState {
            pages: self.pages.len() as u32,
            revision: self.revision,
            object_id: self.object_id,
            next: [self.next_vertex, self.next_triangle],
            empty: self.empty.clone(),
        }
    }

    /// Restores clay from stored pages, without undo steps.
    ///
    /// # Errors
    /// Returns [`BadPage`] if pages are missing or do not fit each other.
    pub fn of_stored(pages: Vec<Arc<Page>>, rest: &ObjectState) -> Result<Clay, BadPage> {
        if pages.len() != rest.pages as usize
            || !fit(&pages)
            || rest.empty.iter().any(|&i| i >= rest.pages)
        {
            return Err(BadPage);
        }
        let vertices = pages.iter().map(|p| p.own()).sum();
        let triangles = pages.iter().map(|p| p.triangles().len()).sum();
        let built = Built { pages, vertices, triangles, warnings: Vec::new(), next: rest.next };
        let mut mesh = Clay::of(built, rest.revision);
        mesh.object_id = rest.object_id;
        mesh.empty.clone_from(&rest.empty);
        Ok(mesh)
    }

    /// Returns separate clay with the same pages, which both share until one of them changes. It
    /// has no undo steps. The cost is proportional to the number of pages, not of vertices.
    pub fn duplicate(&self, object_id: u32) -> Clay {
        let built = Built {
            pages: self.pages.clone(),
            vertices: self.vertices,
            triangles: self.triangles,
            warnings: Vec::new(),
            next: [self.next_vertex, self.next_triangle],
        };
        let mut twin = Clay::of(built, self.revision);
        twin.object_id = object_id;
        twin.empty.clone_from(&self.empty);
        twin.set_levels(self.levels().cloned());
        twin
    }

    /// Returns a separate copy of the clay in its current state, also in the middle of a step, for
    /// trial changes that do not affect this one. It has no undo steps except the open one. Its
    /// revisions continue after `revision`, so that none of its states is confused with one of this
    /// clay. The cost is proportional to the number of pages, not of vertices.
    pub fn fork(&self, revision: u64) -> Clay {
        let mut twin = self.duplicate(self.object_id);
        twin.history.go_on_as(&self.history);
        twin.revision = twin.revision.max(revision);
        twin
    }

    /// Restores the order in which empty pages are reused, as returned by [`Clay::rest`].
    pub fn set_empty(&mut self, empty: Vec<u32>) {
        let count = self.pages.len() as u32;
        self.empty = empty;
        self.empty.retain(|i| *i < count);
    }

    /// Replaces the current pages with stored ones: a jump within the history of this object.
    /// Afterwards nothing can be undone or redone. Returns false, and changes nothing, if the pages
    /// are not of this object.
    pub fn jump(&mut self, pages: &[(u32, Arc<Page>)]) -> bool {
        let count = pages.iter().map(|(i, _)| *i as usize + 1).max().unwrap_or(0);
        if count > self.pages.len() + pages.len() {
            return false;
        }
        self.history.forget();
        if count > self.pages.len() {
            while self.pages.len() < count {
                self.push_empty();
            }
            self.grow();
        }
        for (index, page) in pages {
            let i = *index as usize;
            self.top.set_leaf(i, page.lo, page.hi);
            self.stale.add(*index);
            let old = std::mem::replace(&mut self.pages[i], page.clone());
            self.recount(*index, &old);
            if page.own() == 0 {
                self.empty.push(*index);
            }
            self.pool.retire(old);
        }
        for &leaf in self.stale.paths() {
            self.top.refit_path(leaf as usize);
        }
        self.stale.clear_paths();
        self.revision += 1;
        true
    }
}
