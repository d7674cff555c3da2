//! Questions asked of a solid: thickness, measures, distance, projection, Booleans, remeshing.
//! Everything here works on immutable data and is run on background threads.

pub mod alpha_shape;
pub mod boolean;
pub mod cancel;
pub mod distance;
pub mod grid;
pub mod march;
pub mod measure;
pub mod offset;
pub mod picture;
pub mod projection;
pub mod remesh;
pub mod silhouette;
pub mod thickness;
pub mod tree;
mod unfold;
pub mod winding;
