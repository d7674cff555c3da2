//! Face sets: groups of the surface, and which part of it is hidden.
//!
//! Laws kept here:
//! * A vertex has one number of 16 bits: its set, 0 for none, and whether it is hidden. A triangle
//!   is hidden where all its corners are, so that what is hidden and what is left after
//!   [`SetsEdit::Invert`] together cover the surface.
//! * The numbers lie beside a page's points, behind an `Arc` of their own that dabs share. A page
//!   without sets and without hidden vertices has none: it costs what it cost before.
//! * What is hidden is not picked and not changed by brushes, masks and dynamic topology. Layers
//!   are summed up there too, for the surface is their sum.
//! * A copy in a halo says what its home says.

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
