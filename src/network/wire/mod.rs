//! Messages on the wire, as data and as bytes. Laws kept here:
//! * Reading never panics, whatever the bytes, and allocates no more than the bytes can hold.
//! * Only input is sent, never a mesh; only a joining replica receives the pages of a checkpoint.

pub mod bytes;
pub mod frame;
pub mod frame_codec;
pub mod greeting;
pub mod hands;
pub mod keys;
pub mod message;
pub mod range_coder;
pub mod samples;
