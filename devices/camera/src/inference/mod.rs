//! Runs the hand models on one processor core.
//!
//! `.tflite` files are loaded as they are: no conversion, no Python at run time. The kernels are
//! written here because neither measured engine reached the goal of 15 ms a picture on one core
//! (November 2026, AVX-512 machine, landmark lite and full): `rten` 0.27 took 20 and 32 ms,
//! `tract` 0.23 took 31 and 31 ms; these take 4.9 and 8.3 ms.
//!
//! * `tflite` reads the operators, `plan` fuses them and assigns memory, `network` runs them.
//! * Convolutions are matrix products over packed weights (Goto and van de Geijn, TOMS 2008);
//!   depthwise ones run over planes of one vector of channels.
//! * `pulp` selects AVX-512, AVX2 or NEON at run time, without `unsafe` here.
//!
//! The same file and the same input give the same bits on processors with the same vectors. A
//! processor with other vectors may round differently, by less than 1e-4.

mod depthwise;
mod elementwise;
mod epilogue;
mod flatbuffer;
mod matrix;
mod network;
mod plan;
mod tflite;

pub use flatbuffer::ModelError;
pub use network::Network;
pub use tflite::TensorShape;
