//! Questions asked of a solid: thickness, measures, distance, projection, Booleans, remeshing.
//! Everything here works on immutable data and is run on background threads.

pub mod boolean;
pub mod cancel;
pub mod measure;
pub mod picture;
pub mod thickness;
pub mod tree;
