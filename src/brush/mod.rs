//! Brushes: one kernel a file. A kernel sees one page at a time and says where its own vertices go.

pub mod gaussian;
mod push;
pub mod settings;
mod smooth;

pub use gaussian::Gaussian;
pub use push::Push;
pub use settings::{BrushKind, BrushSettings, PressureCurve};
pub use smooth::Smooth;
