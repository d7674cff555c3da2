//! From a pen's path over the view to dabs on the surface.

pub mod curve;
pub mod curve_stroke;
pub mod spacer;
pub mod stabilizer;
pub mod surface;
pub mod track;

pub use curve_stroke::{Draft, DraftAct};
pub use spacer::Spacer;
pub use stabilizer::Steady;
pub use surface::{Flow, Laid, PenPoint, Surface, Way};
pub use track::{PenEvent, PenTrack};
