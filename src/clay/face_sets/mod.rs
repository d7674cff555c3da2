//! Face sets: groups of the surface, and the visibility of its parts.
//!
//! Laws kept here:
//! * A vertex has one number of 16 bits: its set, 0 for none, and a flag for hidden. A triangle is
//!   hidden if all its corners are, so that the hidden part and the part left after
//!   [`SetsEdit::Invert`] together cover the surface.
//! * A page keeps the numbers next to its points, behind a separate `Arc` that dabs share. A page
//!   without sets and without hidden vertices has none, and costs nothing extra.
//! * Picking, brushes, masks and dynamic topology ignore hidden vertices. Layers are summed up
//!   there too, because the surface is their sum.
//! * A copy in a halo has the number of its home vertex.

mod edit;
mod extract;
mod make;
#[cfg(test)]
mod tests;
mod work;

pub use crate::page_sets::{HIDDEN, MOST_SETS, PageSets};
pub use edit::{PartEdit, SetsEdit, SetsError};
pub use extract::{ExtractError, FaceSetPart, extract};
pub use make::{Partition, partition};
pub use work::{SetsTask, SetsWork};

/// From this mask on, 0 free to 1 protected, a vertex counts as masked.
pub const MASKED: f32 = 0.5;
