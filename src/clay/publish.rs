//! What a snapshot costs: new chunks for changed pages, one vector of chunks. Both are pooled: what
//! readers have let go is filled again.

use std::collections::VecDeque;
use std::sync::Arc;

use super::page::Page;
use super::snapshot::{CHUNK, Chunk};

/// The pages that changed since the last snapshot.
#[derive(Debug, Default)]
pub(super) struct Stale {
    chunk_is: Vec<bool>,
    chunks: Vec<u32>,
    /// One leaf of each node of the clay's tree above a changed page.
    paths: Vec<u32>,
    path_is: Vec<bool>,
}

impl Stale {
    pub(super) fn new(pages: usize) -> Self {
        let chunks = pages.div_ceil(CHUNK);
        let nodes = pages.div_ceil(8);
        Stale {
            chunk_is: vec![false; chunks],
            chunks: Vec::with_capacity(chunks.min(4096)),
            paths: Vec::with_capacity(nodes.min(4096)),
            path_is: vec![false; nodes],
        }
    }

    /// Makes room for this many pages in the clay.
    pub(super) fn reserve(&mut self, pages: usize) {
        let (chunks, nodes) = (pages.div_ceil(CHUNK), pages.div_ceil(8));
        self.chunk_is.reserve(chunks.saturating_sub(self.chunk_is.len()));
        self.path_is.reserve(nodes.saturating_sub(self.path_is.len()));
        self.chunks.reserve(chunks.min(4096));
        self.paths.reserve(nodes.min(4096));
    }

    pub(super) fn grow(&mut self, pages: usize) {
        self.chunk_is.resize(pages.div_ceil(CHUNK), false);
        self.path_is.resize(pages.div_ceil(8), false);
    }

    pub(super) fn add(&mut self, page: u32) {
        let c = page as usize / CHUNK;
        if !std::mem::replace(&mut self.chunk_is[c], true) {
            self.chunks.push(c as u32);
        }
        if !std::mem::replace(&mut self.path_is[page as usize / 8], true) {
            self.paths.push(page);
        }
    }

    pub(super) fn paths(&self) -> &[u32] {
        &self.paths
    }

    pub(super) fn clear_paths(&mut self) {
        for p in self.paths.drain(..) {
            self.path_is[p as usize / 8] = false;
        }
    }
}

#[derive(Debug)]
pub(super) struct SpinePool {
    shown: Arc<Vec<Arc<Chunk>>>,
    old_spines: VecDeque<Arc<Vec<Arc<Chunk>>>>,
    old_chunks: VecDeque<Arc<Chunk>>,
    free_chunks: Vec<Arc<Chunk>>,
    /// Stands where a chunk is about to be put.
    blank: Arc<Chunk>,
    /// Chunks that a new spine gets room for.
    most: usize,
}

fn free_chunk() -> Arc<Chunk> {
    Arc::new(Chunk { pages: Vec::with_capacity(CHUNK), ..Chunk::default() })
}

/// Old chunks looked after, at most; a reader that holds more frees them itself.
const KEPT: usize = 4096;
/// Old spines looked after, at most.
const SPINES: usize = 8;

impl SpinePool {
    pub(super) fn new(pages: &[Arc<Page>]) -> Self {
        let spine = pages
            .chunks(CHUNK)
            .map(|some| {
                let mut chunk = Chunk { pages: Vec::with_capacity(CHUNK), ..Chunk::default() };
                chunk.fill(some);
                Arc::new(chunk)
            })
            .collect();
        SpinePool {
            shown: Arc::new(spine),
            old_spines: VecDeque::with_capacity(SPINES + 1),
            old_chunks: VecDeque::with_capacity(KEPT + 1),
            free_chunks: Vec::with_capacity(KEPT),
            blank: Arc::default(),
            most: 0,
        }
    }

    /// Makes room for this many pages in the clay.
    pub(super) fn reserve(&mut self, pages: usize) {
        self.most = pages.div_ceil(CHUNK);
        // The chunks that readers hold of a few snapshots in a row.
        let ready = self.most.min(256);
        while self.free_chunks.len() < ready {
            self.free_chunks.push(free_chunk());
        }
    }

    /// Returns the greatest number of a face set in the clay. Visits each chunk, and each page that
    /// changed since the last snapshot.
    pub(super) fn highest_set(&self, pages: &[Arc<Page>], stale: &Stale) -> u16 {
        let of = |(c, pages): (usize, &[Arc<Page>])| match self.shown.get(c) {
            Some(chunk) if !stale.chunk_is[c] => chunk.highest_set,
            _ => pages.iter().map(|p| p.highest_set()).max().unwrap_or(0),
        };
        pages.chunks(CHUNK).enumerate().map(of).max().unwrap_or(0)
    }

    pub(super) fn publish(
        &mut self,
        pages: &[Arc<Page>],
        stale: &mut Stale,
    ) -> Arc<Vec<Arc<Chunk>>> {
        if stale.chunks.is_empty() {
            return self.shown.clone();
        }
        let mut spine = self.spine();
        if let Some(new) = Arc::get_mut(&mut spine) {
            new.clear();
            new.extend_from_slice(&self.shown);
            new.resize(pages.len().div_ceil(CHUNK), self.blank.clone());
        }
        self.reclaim(2 * stale.chunks.len() + 4);
        for c in stale.chunks.drain(..) {
            let c = c as usize;
            stale.chunk_is[c] = false;
            let mut chunk = self.free_chunks.pop().unwrap_or_else(free_chunk);
            if let Some(chunk) = Arc::get_mut(&mut chunk) {
                chunk.fill(&pages[c * CHUNK..((c + 1) * CHUNK).min(pages.len())]);
            }
            if let Some(new) = Arc::get_mut(&mut spine) {
                let old = std::mem::replace(&mut new[c], chunk);
                if self.old_chunks.len() < KEPT {
                    self.old_chunks.push_back(old);
                }
            }
        }
        let old = std::mem::replace(&mut self.shown, spine.clone());
        if self.old_spines.len() < SPINES {
            self.old_spines.push_back(old);
        }
        spine
    }

    /// An empty spine that nobody else holds.
    fn spine(&mut self) -> Arc<Vec<Arc<Chunk>>> {
        for _ in 0..self.old_spines.len() {
            let Some(mut old) = self.old_spines.pop_front() else { break };
            match Arc::get_mut(&mut old) {
                Some(free) => {
                    // Its chunks live on: the pool holds each old one.
                    free.clear();
                    free.reserve(self.most);
                    return old;
                }
                None => self.old_spines.push_back(old),
            }
        }
        Arc::new(Vec::with_capacity(self.shown.len().max(self.most)))
    }

    fn reclaim(&mut self, count: usize) {
        for _ in 0..count.min(self.old_chunks.len()) {
            let Some(mut old) = self.old_chunks.pop_front() else { return };
            match Arc::get_mut(&mut old) {
                Some(free) => {
                    // Lets go of the old pages, which the clay's own pool holds.
                    free.pages.clear();
                    if self.free_chunks.len() < KEPT {
                        self.free_chunks.push(old);
                    }
                }
                None => self.old_chunks.push_back(old),
            }
        }
    }
}
