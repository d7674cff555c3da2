//! Memory that is no longer needed, handed to whoever owns the clay.
//!
//! Freeing a large mesh takes milliseconds, and the thread that sculpts must not spend them. The
//! core starts no threads, so the owner passes a [`GarbageSink`] in; without one, memory is freed
//! where it is discarded, which is what tests and replays want.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use crate::page::Page;

/// Memory to be freed.
pub enum Garbage {
    /// Something that others may hold as well: a page, a picture, the triangles of a file.
    Shared(Arc<dyn Any + Send + Sync>),
    /// The pages of an undo step, each with its number.
    Pages(Vec<(u32, Arc<Page>)>),
    /// Something that nobody else holds: a whole [`Clay`](crate::Clay), a command.
    Owned(Box<dyn Any + Send>),
}

impl fmt::Debug for Garbage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Garbage::Shared(_) => f.write_str("Shared(..)"),
            Garbage::Pages(pages) => write!(f, "Pages({})", pages.len()),
            Garbage::Owned(_) => f.write_str("Owned(..)"),
        }
    }
}

/// Takes garbage from the thread that sculpts.
pub trait CollectGarbage: Send + Sync + fmt::Debug {
    /// Takes the garbage without waiting for anybody, and frees it elsewhere.
    fn collect(&self, garbage: Garbage);
}

/// The destination of garbage. The default frees it at once, on the thread that discards it.
#[derive(Debug, Clone, Default)]
pub struct GarbageSink(Option<Arc<dyn CollectGarbage>>);

impl GarbageSink {
    /// A sink that hands everything to `collector`.
    pub fn new(collector: Arc<dyn CollectGarbage>) -> Self {
        GarbageSink(Some(collector))
    }

    /// Hands the garbage over.
    pub fn discard(&self, garbage: Garbage) {
        match &self.0 {
            Some(collector) => collector.collect(garbage),
            None => drop(garbage),
        }
    }

    /// Hands over something that nobody else holds.
    pub fn discard_owned<T: Any + Send>(&self, garbage: T) {
        if self.0.is_some() {
            self.discard(Garbage::Owned(Box::new(garbage)));
        }
    }
}
