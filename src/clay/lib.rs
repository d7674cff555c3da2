//! The clay: pages, topology, trees, queries, brushes, snapshots, undo.
//!
//! Laws kept here:
//! * The cost of a change follows the pages that it reaches, never the mesh: [`dab`](Mesh::dab),
//!   normals, trees, undo and [`Snapshot`] alike.
//! * Whoever holds a page may read it for ever: a page is written anew, never changed.
//! * Same input, same bits, with any number of [`Workers`].
//!
//! Memory at rest: about 95 bytes a vertex all told, measured by a test against 120.
//!
//! Read first: [`page`], then [`Clay::dab`], then [`brush`].
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod assembly;
mod boxtree;
pub mod brush;
mod clay;
mod dab;
mod dyntopo;
mod garbage;
mod kernel;
pub mod live_thickness;
pub mod local_boolean;
mod masks;
pub mod multires;
mod normals;
pub mod page;
mod pick;
mod pool;
mod publish;
mod ray;
mod reach;
mod snapshot;
pub mod stored;
mod undo;
mod verify;
mod workers;

pub use assembly::{
    BuildError, Corner, Cut, Grafted, Home, NewVertex, PAGE_VERTICES, bytes_to_build, home_of,
};
pub use clay::{Clay, Memory};
pub use dab::{DabReport, PhaseTimes};
pub use dyntopo::{Cuts, Detail};
pub use garbage::{CollectGarbage, Garbage, GarbageSink};
pub use kernel::{Kernel, PageIn, PageOut};
pub use multires::{Level, LevelError, Levels};
pub use page::{Page, Points};
pub use ray::{Hit, Ray};
pub use reach::Reach;
pub use snapshot::{Ranks, Snapshot};
pub use stored::{BadPage, ObjectState};
pub use workers::Workers;
