//! Operations on the layers of an object: edits of the list, and the resulting page updates.
//! [`crate::layers`] defines layers.

mod edit;
mod flat;
mod kernel;

pub use edit::LayerJob;
pub use flat::FlatLayers;
pub use kernel::LayerOperation;

#[cfg(test)]
mod tests;
