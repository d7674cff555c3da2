//! Meshes as files hold them, and the questions asked of a solid: repair, Booleans, wall thickness,
//! measures, distance, projection, remeshing, decimation, subdivision.
//!
//! Everything here works on immutable data; long work takes a [`job::Job`] that can be cancelled
//! and reports its progress. Parallel work runs on the current rayon pool, and every result is the
//! same with any number of threads. This crate knows no other member of the workspace.
//!
//! Read first: [`flat`] (what a mesh is), then [`io`], then the question that you have:
//!
//! | question | module |
//! |---|---|
//! | is the file sound? | [`check`], [`self_intersection`], [`repair`] |
//! | union, intersection, difference | [`boolean`] |
//! | how thick are the walls? | [`thickness`] |
//! | volume, area, projected area | [`measure`], [`projection`] |
//! | sections by planes | [`section`] |
//! | how far, inside or outside? | [`distance`], [`grid`], [`winding`], [`march`] |
//! | another mesh of the same solid | [`remesh`], [`decimate`], [`subdivide`], [`triangulate`] |
//! | how far two surfaces are apart | [`deviation`] |
//! | quads that follow the shape | [`quads`] |
//! | a thicker, thinner or hollow solid | [`offset`] |
//! | the surface of a function of space | [`implicit`] |
//! | rays and nearest points | [`bvh`] |
//!
//! ```
//! use sculptd_geometry::job::Job;
//! use sculptd_geometry::thickness::{ThicknessSettings, measure};
//! use sculptd_geometry::{check, shapes};
//!
//! let job = Job::default();
//! let ring = shapes::torus(20.0, 1.0, 96, 24);
//! let facts = check::report(&ring, true, &job).expect("not cancelled");
//! assert!(facts.closed && facts.genus == Some(1) && facts.self_intersections == Some(0));
//!
//! let (triangles, _) = ring.triangulate();
//! let walls = measure(&triangles, &ThicknessSettings::default(), &job).expect("not cancelled");
//! assert!((walls.summary().median.expect("walls") - 2.0).abs() < 0.1);
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]
#![deny(missing_docs)]
#![warn(rustdoc::broken_intra_doc_links, rustdoc::private_intra_doc_links)]

mod aabb;
pub mod alpha_shape;
pub mod boolean;
pub mod bvh;
mod centred;
pub mod check;
pub mod decimate;
pub mod deviation;
pub mod disjoint_sets;
pub mod distance;
pub mod edges;
pub mod face_attributes;
mod fans;
pub mod filaments;
pub mod flat;
pub mod flat_region;
pub mod grid;
pub mod implicit;
pub mod io;
pub mod job;
pub mod march;
pub mod measure;
mod min_cut;
pub mod offset;
pub mod picture;
pub mod portable;
pub mod projection;
pub mod quads;
pub mod remesh;
pub mod repair;
pub mod section;
pub mod self_intersection;
pub mod shapes;
pub mod silhouette;
pub mod simd;
mod snap_rounding;
pub mod subdivide;
pub mod thickness;
mod tight_frame;
pub mod triangulate;
mod unfold;
pub mod weld;
pub mod winding;
pub mod written;

pub use aabb::Aabb;
pub use centred::CentredMesh;
pub use face_attributes::{FaceAttributes, GroupName};
pub use flat::{PolyMesh, TriMesh};
