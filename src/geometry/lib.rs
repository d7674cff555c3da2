//! Meshes as files hold them, and the questions asked of a solid: repair, Booleans, wall thickness,
//! measures, distance, projection, remeshing, decimation, subdivision.
//!
//! Everything here works on immutable data; long work takes a [`job::Job`] that can be cancelled.
//! This crate knows no other member of the workspace.
//!
//! Read first: [`flat`] (what a mesh is), then [`io`], then the question that you have.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod alpha_shape;
pub mod boolean;
pub mod bvh;
pub mod check;
pub mod decimate;
pub mod distance;
pub mod edges;
pub mod flat;
pub mod grid;
pub mod io;
pub mod job;
pub mod march;
pub mod measure;
pub mod offset;
pub mod picture;
pub mod projection;
pub mod remesh;
pub mod repair;
pub mod self_intersection;
pub mod shapes;
pub mod silhouette;
pub mod simd;
pub mod subdivide;
pub mod thickness;
pub mod triangulate;
mod unfold;
pub mod winding;
pub mod written;

pub use flat::{PolyMesh, TriMesh};
