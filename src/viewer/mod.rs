//! The viewer: draws what was published, sends commands and pointer samples, and owns nothing of the world. A viewer that
//! stalls or dies costs the sculpture nothing.

mod flight;
mod frame;
pub mod gpu;
pub mod lapse;
pub mod look;
pub mod overlay;
pub mod pages;
pub mod picture;
mod pointer;
mod remember;
pub mod renderer;
mod shots;
pub mod window;
pub mod work;

pub use gpu::{Gpu, NoViewer};
pub use window::{Wiring, run};
