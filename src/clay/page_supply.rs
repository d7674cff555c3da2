//! Pages made ahead of need, handed to the clay by whoever owns it.
//!
//! Dynamic topology makes pages while a stroke goes on, and the thread that sculpts must not call
//! the allocator. The core starts no threads, so the owner passes a [`PageSupply`] in, which is
//! filled elsewhere; without one, pages are made where they are needed, which is what tests and
//! replays want.

use std::fmt;
use std::sync::Arc;

use glam::Vec4;

use crate::assembly::PAGE_VERTICES;
use crate::page::{Page, PageTopology};

/// An empty page with room for any that dynamic topology writes.
#[derive(Debug)]
pub struct SparePage(pub(super) Arc<Page>);

impl SparePage {
    /// Allocates a page, about 80 kB, and touches its rows, so that whoever writes it first does
    /// not meet the system's zero pages.
    #[allow(clippy::new_without_default)]
    pub fn new() -> SparePage {
        let mut topology = PageTopology::default();
        topology.reserve(PAGE_VERTICES);
        let mut page = Page { topology: Arc::new(topology), ..Page::default() };
        page.make_room(PAGE_VERTICES);
        page.points.resize(2 * PAGE_VERTICES, Vec4::ZERO);
        page.normals.resize(2 * PAGE_VERTICES, Vec4::ZERO);
        SparePage(Arc::new(page))
    }
}

/// Gives pages to the thread that sculpts.
pub trait SupplyPages: Send + Sync + fmt::Debug {
    /// A page, if one is ready. Never waits for anybody.
    fn take(&self) -> Option<SparePage>;
}

/// The source of pages. The default has none.
#[derive(Debug, Clone, Default)]
pub struct PageSupply(Option<Arc<dyn SupplyPages>>);

impl PageSupply {
    /// A supply that asks `supplier`.
    pub fn new(supplier: Arc<dyn SupplyPages>) -> Self {
        PageSupply(Some(supplier))
    }

    pub(super) fn take(&self) -> Option<SparePage> {
        self.0.as_ref()?.take()
    }
}
