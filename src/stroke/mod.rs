//! From a pen's path over the view to dabs on the surface.

pub mod camera;
pub mod curve;
pub mod draft;
pub mod spacer;
pub mod steady;
pub mod surface;
pub mod track;

pub use camera::Camera;
pub use draft::{Draft, DraftAct};
pub use spacer::Spacer;
pub use steady::Steady;
pub use surface::{Flow, Laid, PenPoint, Surface, Way};
pub use track::{PenEvent, PenTrack};
