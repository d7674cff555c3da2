//! Pages that were replaced wait here until nobody reads them any more, and are then written again.
//!
//! So a reader that drops the last snapshot with an old page frees nothing, and the tick thread
//! neither allocates nor frees in the steady state of a stroke. What is too much goes to a thread
//! that only drops.

use std::collections::VecDeque;
use std::sync::{Arc, OnceLock};

use crossbeam_channel::Sender;

use super::page::Page;

/// Pages kept for reuse, at most; 512-vertex pages take about 25 KB each.
const KEPT: usize = 2048;

/// What the dropping thread is given.
pub(super) enum Garbage {
    Page(Arc<Page>),
    Pages(Vec<(u32, Arc<Page>)>),
}

/// Hands memory to the thread that drops it. When that thread is far behind, the caller drops it.
pub(super) fn discard(garbage: Garbage) {
    static BIN: OnceLock<Sender<Garbage>> = OnceLock::new();
    let bin = BIN.get_or_init(|| {
        let (bin, full) = crossbeam_channel::bounded::<Garbage>(4096);
        // Without the thread the channel is closed and everybody drops for himself.
        let _ = std::thread::Builder::new().name("sculptd-drop".into()).spawn(move || {
            for garbage in full {
                match garbage {
                    Garbage::Page(page) => drop(page),
                    Garbage::Pages(pages) => drop(pages),
                }
            }
        });
        bin
    });
    let _ = bin.try_send(garbage);
}

#[derive(Debug, Default)]
pub(super) struct Pool {
    free: Vec<Arc<Page>>,
    /// Replaced, oldest first; somebody may still read them.
    waiting: VecDeque<Arc<Page>>,
    /// Rows, and leaves of the tree, that a new page gets room for.
    rows: usize,
    leaves: usize,
}

impl Pool {
    /// `rows`, `leaves`: of the largest page. `count`: pages to have ready.
    pub(super) fn new(rows: usize, leaves: usize, count: usize) -> Self {
        let mut pool = Pool {
            free: Vec::with_capacity(KEPT),
            waiting: VecDeque::with_capacity(KEPT),
            rows,
            leaves,
        };
        for _ in 0..count {
            let mut page = pool.fresh();
            if let Some(page) = Arc::get_mut(&mut page) {
                // Touched now, or the first dab would meet the kernel's zero pages one by one.
                page.points.resize(rows, glam::Vec4::ZERO);
                page.normals.resize(rows, glam::Vec4::ZERO);
            }
            pool.free.push(page);
        }
        pool
    }

    fn fresh(&self) -> Arc<Page> {
        let mut page = Page {
            points: Vec::with_capacity(self.rows),
            normals: Vec::with_capacity(self.rows),
            ..Page::default()
        };
        page.tree.reset(self.leaves);
        Arc::new(page)
    }

    /// A page that nobody else holds; its contents are old.
    pub(super) fn take(&mut self) -> Arc<Page> {
        self.free.pop().unwrap_or_else(|| self.fresh())
    }

    /// Gives back a page that nobody else holds.
    pub(super) fn give_back(&mut self, page: Arc<Page>) {
        self.free.push(page);
    }

    /// A page that the clay no longer shows; readers and steps may still hold it.
    pub(super) fn retire(&mut self, page: Arc<Page>) {
        self.waiting.push_back(page);
    }

    /// Looks at up to `count` waiting pages, oldest first.
    pub(super) fn reclaim(&mut self, count: usize) {
        for _ in 0..count.min(self.waiting.len()) {
            let Some(mut page) = self.waiting.pop_front() else { return };
            if Arc::get_mut(&mut page).is_none() {
                if self.waiting.len() < KEPT {
                    self.waiting.push_back(page);
                } else {
                    // Its reader will free it.
                    discard(Garbage::Page(page));
                }
            } else if self.free.len() < KEPT {
                self.free.push(page);
            } else {
                discard(Garbage::Page(page));
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.free.iter().map(|p| p.bytes()).sum::<usize>()
            + self.waiting.iter().map(|p| p.bytes()).sum::<usize>()
    }
}
