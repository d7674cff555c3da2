//! Brushes: one kernel a file. A kernel sees one page at a time and says where its own vertices go.

pub(crate) mod cotangent;
mod drag;
pub mod gaussian;
mod palm;
mod push;
pub mod settings;
mod smooth;
pub mod weights;

pub use drag::Drag;
pub use gaussian::Gaussian;
pub use palm::Palm;
pub use push::Push;
pub use settings::{BrushKind, BrushSettings, PressureCurve};
pub use smooth::Smooth;
