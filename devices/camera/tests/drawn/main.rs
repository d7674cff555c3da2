//! Drawn hands through the whole camera: pictures whose joints are known, models, tracks,
//! millimetres, the filter of the hand tools and the poses.
//!
//! The models must be installed (`sculptd camera setup`, or `SCULPTD_CAMERA_MODELS`); without them
//! each test says that it is skipped. `SCULPTD_LONG=1` runs the full counts.

#![allow(clippy::print_stdout)] // Figures and skips are told on standard output.

mod costs;
mod engines;
mod pinches;
mod places;
mod stage;
