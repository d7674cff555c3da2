//! The viewer: draws what was published, sends commands and pointer samples, and owns nothing of the world. A viewer that
//! stalls or dies costs the sculpture nothing.

pub mod field;
mod flight;
mod frame;
pub mod gpu;
pub mod lapse;
pub mod look;
pub mod loose;
mod newest;
pub mod overlay;
pub mod pages;
pub mod picture;
mod places;
mod pointer;
pub mod preview;
mod remember;
pub mod renderer;
mod shade;
mod shots;
mod thumbs;
pub mod window;
mod wishes;
pub mod work;

pub use gpu::{Gpu, NoViewer};
pub use window::{Wiring, run};
