//! A mesh for sculpting in real time: pages, brushes, dynamic topology, undo, snapshots.
//!
//! Read first: [`page`] (how a mesh is kept), then [`Clay::dab`] (how it is changed), then
//! [`brush`] (what changes it). `examples/dab_on_a_mesh.rs` does the whole in forty lines.
//!
//! Laws kept here:
//! * The cost of a change follows the pages that it reaches, never the mesh: [`Clay::dab`],
//!   normals, trees, undo and [`Snapshot`] alike.
//! * A page is immutable once shared: a change writes a new page, so a reader may keep its page.
//! * Same input, same bits, with any number of [`Workers`].
//! * No clock, no IO, no randomness, no threads but those of [`Workers`]. Memory that is no longer
//!   needed goes to the owner's [`GarbageSink`], and pages for changing topology come from its
//!   [`PageSupply`].
//!
//! Memory at rest: about 95 bytes a vertex all told, measured by a test against 120.
//!
//! ```
//! use glam::Vec3;
//! use sculptd_clay::brush::GaussianBrush;
//! use sculptd_clay::{Clay, Ray, Reach, Workers};
//! use sculptd_geometry::{job::Job, shapes};
//!
//! let mut clay = Clay::build(&shapes::icosphere(1.0, 16), &Job::default())?;
//! let ray = Ray { origin: Vec3::Z * 3.0, dir: -Vec3::Z };
//! let hit = clay.pick(ray).expect("the ray meets the ball");
//! let before = clay.hash();
//!
//! clay.begin_step();
//! let (radius, height) = (0.3, 0.1);
//! let reach = Reach::Sphere { centre: hit.position, radius };
//! let brush = GaussianBrush::new(hit.position, radius, hit.normal, height);
//! let report = clay.dab(&reach, &brush, &Workers::new(1));
//! clay.end_step();
//! assert!(report.moved > 0 && clay.pick(ray).is_some_and(|now| now.t < hit.t));
//!
//! assert!(clay.undo());
//! assert_eq!(clay.hash(), before);
//! # Ok::<(), sculptd_clay::BuildError>(())
//! ```
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]
// Tests compare with the functions that the bans of clippy.toml keep out of the clay.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod assembly;
mod boxtree;
pub mod brush;
mod clay;
mod dab;
mod dab_buffers;
mod dyntopo;
pub mod face_sets;
mod garbage;
mod kernel;
mod layer_edit;
pub mod layers;
pub mod live_thickness;
pub mod local_boolean;
mod masks;
pub mod measured_mask;
pub mod multires;
mod normals;
pub mod page;
mod page_hashes;
mod page_planes;
mod page_sets;
mod page_supply;
mod pick;
mod pool;
mod publish;
mod ray;
mod reach;
mod retopology;
mod snapshot;
mod step_authors;
pub mod stored;
mod undo;
mod verify;
mod vertex_states;
mod workers;

pub use assembly::{
    BuildError, Corner, Cut, Grafted, Home, NewVertex, PAGE_VERTICES, bytes_to_build, home_of,
};
pub use clay::{Clay, Memory};
pub use dab::DabReport;
pub use dab_buffers::PhaseTimes;
pub use garbage::{CollectGarbage, Garbage, GarbageSink};
pub use kernel::{Kernel, PageIn, PageOut};
pub use layer_edit::{FlatLayers, LayerJob, LayerOperation};
pub use layers::{LayerEdit, LayerError, LayerId, LayerStack};
pub use multires::{Level, LevelError, Levels};
pub use page::{Page, Points};
pub use page_hashes::PageHashes;
pub use page_supply::{PageSupply, SparePage, SupplyPages};
pub use ray::{Hit, Ray};
pub use reach::Reach;
pub use retopology::{Cuts, Detail, LEAST_TOPOLOGY_BUDGET, PAGE_SCAN, PAGE_WRITE, Within};
pub use snapshot::{Ranks, Snapshot};
pub use step_authors::Author;
pub use stored::{BadPage, ObjectState};
pub use undo::{StepPages, StepPlace};
pub use vertex_states::VertexState;
pub use workers::Workers;
