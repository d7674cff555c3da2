//! Everything between a wire and a [`Sample`].

pub mod clock;
pub mod leap;
pub mod queue;
pub mod sample;

pub use clock::Clock;
pub use sample::{Body, DeviceId, Finger, Hand, Hands, Pad, Pen, Sample, Tool};
