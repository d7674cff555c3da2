//! The viewer: draws what was published, sends commands and pointer samples, and owns nothing of the world. A viewer that
//! stalls or dies costs the sculpture nothing.

pub mod gpu;
pub mod look;
pub mod overlay;
mod pages;
pub mod picture;
pub mod renderer;
pub mod window;

pub use gpu::{Gpu, NoViewer};
pub use window::{Wiring, run};
