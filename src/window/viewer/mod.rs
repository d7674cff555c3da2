//! The viewer: draws what was published, sends commands and pointer samples, and owns nothing of
//! the world. A viewer that stalls or dies costs the sculpture nothing.

mod background;
mod camera_animation;
pub mod field;
mod frame;
pub mod gpu;
mod history_tree;
mod latest_wins;
pub mod look;
pub mod overlay;
pub mod overlay_mesh;
pub mod pages;
pub mod picture;
mod pointer;
pub mod preview;
mod remember;
pub mod renderer;
mod shots;
mod ssao;
mod thumbs;
pub mod timelapse;
pub mod window;
pub mod work;

pub use gpu::{Gpu, NoViewer};
pub use window::{Wiring, run};
