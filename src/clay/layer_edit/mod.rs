//! What is done to the layers of an object: edits of the list, and what follows from them page by
//! page. [`crate::layers`] says what layers are.

mod edit;
mod flat;
mod kernel;

pub use edit::LayerJob;
pub use flat::FlatLayers;
pub use kernel::LayerOperation;

#[cfg(test)]
mod tests;
