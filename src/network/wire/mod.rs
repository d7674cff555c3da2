//! What goes over the wire, as data and as bytes. Laws kept here:
//! * Reading never panics, whatever the bytes, and allocates no more than the bytes can hold.
//! * Input is sent, never a mesh; the pages of a checkpoint go to who joins, and to nobody else.

pub mod bytes;
pub mod frame;
pub mod frame_codec;
pub mod hands;
pub mod message;
pub mod range_coder;
pub mod samples;
