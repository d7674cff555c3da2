//! From a pen's path over the view to dabs on the surface.

pub mod curve;
pub mod curve_stroke;
pub mod spacer;
pub mod stabilizer;
pub mod surface;
pub mod track;

pub use curve_stroke::{CurveAction, CurveStroke};
pub use spacer::Spacer;
pub use stabilizer::Stabilizer;
pub use surface::{Flow, Laid, PenPoint, StrokeMethod, Surface};
pub use track::{PenEvent, PenTrack};
