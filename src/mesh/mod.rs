//! The clay: pages, topology, trees, queries, snapshots, undo; and the flat meshes that files hold.

pub mod flat;
pub mod io;
pub mod shapes;

pub use flat::{PolyMesh, TriMesh};
