//! The clay: pages, topology, trees, queries, snapshots, undo; and the flat meshes that files hold.
//!
//! Laws kept here:
//! * The cost of a change follows the pages that it reaches, never the mesh: [`dab`](Mesh::dab), normals, trees, undo and
//!   [`Snapshot`] alike.
//! * Whoever holds a page may read it for ever: a page is written anew, never changed.
//! * Same input, same bits, with any number of [`Workers`].
//!
//! Memory at rest: about 95 bytes a vertex all told, measured by a test against 120.

mod boxtree;
mod build;
pub mod check;
mod clay;
pub mod crossing;
mod dab;
pub mod decimate;
pub mod edges;
pub mod flat;
pub mod io;
mod kernel;
pub mod levels;
mod masks;
pub mod mend;
mod normals;
pub mod page;
mod pick;
mod pool;
mod publish;
mod ray;
mod reach;
mod remodel;
pub mod shapes;
mod snapshot;
pub mod stored;
pub mod subdivide;
pub mod triangulate;
mod undo;
mod verify;
mod workers;

pub use build::{BuildError, Corner, Cut, Grafted, Home, NewVertex, PAGE_VERTICES, bytes_to_build, home_of};
pub use clay::{Memory, Mesh};
pub use dab::{DabReport, PhaseTimes};
pub use flat::{PolyMesh, TriMesh};
pub use kernel::{Kernel, PageIn, PageOut};
pub use levels::{Level, LevelError, Levels};
pub use page::{Page, Points};
pub use ray::{Hit, Ray};
pub use reach::Reach;
pub use remodel::{Cuts, Detail};
pub use snapshot::{Ranks, Snapshot};
pub use stored::{BadPage, Rest};
pub use workers::Workers;
