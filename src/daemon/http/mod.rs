//! The one HTTP server (RFC 9112, by the `hyper` library) behind the metrics page, the downloads of
//! a kiosk's visitors, and the page on which others join.
//!
//! Laws kept here:
//! * Nobody holds up anybody else: connections are tasks of one thread, and none of them waits for
//!   another.
//! * Everything has a limit ([`bounds`]): connections, bytes of a head, seconds to send it, seconds
//!   without progress, bytes a second at least for one connection and at most for all of them.
//!   Where all places are taken, the connection that has made no progress for the longest time
//!   gives way to the new one.
//! * A file is read in pieces as its reader takes them. It is never in memory as a whole.
//! * An idle server uses no processor time.
//!
//! Read first: [`bounds`], [`answer`] (what a request may get), [`server`] (the connections).

pub mod answer;
pub mod bounds;
pub mod server;
pub mod upgrade;

pub use answer::{Answer, Refusal};
pub use server::HttpServer;
