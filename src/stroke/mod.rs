//! From a pen's path over the view to dabs on the surface.

pub mod camera;
pub mod curve;
pub mod spacer;
pub mod steady;
pub mod track;

pub use camera::Camera;
pub use spacer::{Flow, PenPoint, Spacer, Surface, Way};
pub use steady::Steady;
pub use track::{PenEvent, PenTrack};
