//! The clay: pages, topology, trees, queries, snapshots, undo; and the flat meshes that files hold.

mod build;
mod clay;
pub mod flat;
pub mod io;
pub mod page;
mod ray;
pub mod shapes;
mod snapshot;
pub mod triangulate;
mod undo;

pub use build::BuildError;
pub use clay::{DabReport, Kernel, Mesh, PageIn, PageOut, Reach, Workers};
pub use flat::{PolyMesh, TriMesh};
pub use page::Page;
pub use ray::{Hit, Ray};
pub use snapshot::Snapshot;
