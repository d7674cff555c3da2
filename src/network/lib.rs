//! One sculpture shared over a network. Each daemon sends its samples and commands to a host; the
//! host orders them into ticks and sends the ticks to all; every replica steps the same world,
//! which is deterministic. Only input is sent, never a mesh; only a joining replica receives the
//! pages of a checkpoint.
//!
//! Read first: [`station`], the protocol as a state machine without clock, IO and threads;
//! [`wire`], its messages; [`executor`], which steps a world by frames. With the feature
//! `zenoh`, `live` runs a station beside the tick loop, and `zenoh_link` carries its datagrams.
//! Apart from that, [`fleet`] looks after installations from a distance.
//!
//! ```text
//! devices -> own batches -> host: frames -> every replica's world
//!              (outbox)      (host, replica_log)   (executor)
//! ```
//!
//! Laws kept here:
//! * A sample is rounded before it is sent, and every replica steps the rounded sample, its sender
//!   too.
//! * The preview of local strokes before they are ordered ([`local_echo`]) runs on a copy, and is
//!   not part of the stepped world.
//! * Input is acknowledged when a second replica has it. The sender repeats unacknowledged input,
//!   to the next host if the first is lost. It keeps acknowledged input for minutes and repeats it
//!   to a host that lacks it, because another part of a split network may have had it. Batches are
//!   numbered, so that none is stepped twice.
//! * Messages without a key are ignored; the input of a member is bounded. Reading never panics.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod acknowledgement;
pub mod comparison;
pub mod core;
pub mod door;
pub mod executor;
pub mod fleet;
pub mod handshake;
pub mod heirs;
pub mod held_checkpoint;
pub mod host;
pub mod host_limits;
pub mod host_members;
pub mod host_search;
pub mod join_link;
pub mod keyring;
#[cfg(feature = "zenoh")]
pub mod live;
pub mod local_echo;
#[cfg(feature = "zenoh")]
mod loop_messages;
pub mod member;
pub mod membership;
pub mod order_hold;
pub mod outbox;
#[cfg(feature = "zenoh")]
pub mod people_here;
pub mod policy;
pub mod random;
pub mod rate_limit;
pub mod replica_log;
#[cfg(feature = "zenoh")]
mod replica_worker;
pub mod seal;
#[cfg(feature = "zenoh")]
pub mod shared_error;
#[cfg(feature = "zenoh")]
pub mod shared_session;
pub mod station;
#[cfg(feature = "zenoh")]
mod station_thread;
#[cfg(feature = "zenoh")]
pub mod transport;
pub mod wire;
#[cfg(feature = "zenoh")]
pub mod zenoh_link;
