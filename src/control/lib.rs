//! The control socket of `sculptd`, as types: every request, reply and event, and a client.
//!
//! `sculptd` listens on a Unix socket and speaks JSON-RPC 2.0, one message a line. This crate
//! knows nobody: a program that drives a daemon needs it alone.
//!
//! Read first: [`method`] (every method, in one table), then [`client`] (how to call one), then
//! the types: [`status`], [`brush`], [`view`], [`edit`], [`scene`], [`layers`], [`snap`],
//! [`event`]. [`wire`] has the lines, the limits and the errors, [`range`](mod@range) the range of
//! each number. The same for other languages is [`SCHEMA`].
//!
//! ```
//! use sculptd_control::Request;
//! use sculptd_control::edit::{JoinParams, Operation};
//!
//! let request = Request::Join(JoinParams { operation: Operation::Difference });
//! let line = serde_json::to_string(&request.envelope(1)?)?;
//! assert_eq!(
//!     line,
//!     r#"{"jsonrpc":"2.0","id":1,"method":"join","params":{"operation":"difference"}}"#
//! );
//! # Ok::<(), serde_json::Error>(())
//! ```
//!
//! What a daemon promises: a request is answered in the order in which it came on its connection;
//! a parameter that is unknown, missing or out of its range is refused by its name, and nothing is
//! changed; an error carries the request's id. What it does not promise: that a command which was
//! answered with `sent` has been carried out; it is at the loop's next tick.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod brush;
mod check;
#[cfg(unix)]
pub mod client;
pub mod edit;
pub mod event;
pub mod face_sets;
pub mod guests;
pub mod layers;
pub mod method;
pub mod people;
pub mod range;
pub mod repair;
pub mod retopology;
pub mod scene;
#[cfg(test)]
pub mod schema;
pub mod snap;
pub mod status;
pub mod view;
pub mod wire;

pub use check::SCHEMA;
#[cfg(unix)]
pub use client::Client;
pub use method::{Handler, METHODS, Method, Request};
pub use wire::RpcError;
