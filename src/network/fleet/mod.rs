//! A fleet: installations that publish their state under their names, and staff who list them, ask
//! them for something, and roll out settings.
//!
//! Read first: [`state`] (what an installation publishes, a documented schema), [`request`] (what
//! staff may ask for), [`registry`] (the list), [`rollout`]. All of them are state machines or data
//! without clock, IO and threads; with the feature `zenoh`, `fleet_link` carries their messages,
//! `installation_thread` runs an installation's end beside its daemon, `fleet_console` the
//! staff's.
//!
//! ```text
//! sculptd/fleet/1/FLEET/state/INSTALLATION     state, JSON, in the clear; attached: its tag
//! sculptd/fleet/1/FLEET/request/INSTALLATION   requests of staff, sealed
//! sculptd/fleet/1/FLEET/answer/INSTALLATION    answers to them, sealed
//! ```
//!
//! Laws kept here:
//! * State says nothing of visitors. Anybody on the network can read it; only a holder of the
//!   installation's key can publish an accepted one.
//! * Whether an installation is online follows from its signed states alone, of a run that has
//!   answered a question which the list drew: what was recorded shows nobody.
//! * Only holders of the staff's key can send requests, and no request is carried out twice.
//! * A lost network stops no installation. The installation itself reverts settings on trial unless
//!   a request keeps them.

pub mod access;
#[cfg(feature = "zenoh")]
pub mod fleet_console;
#[cfg(feature = "zenoh")]
pub mod fleet_link;
pub mod installation;
#[cfg(feature = "zenoh")]
pub mod installation_thread;
pub mod registry;
pub mod request;
pub mod request_guard;
pub mod requester;
pub mod rollout;
#[cfg(test)]
pub mod schema;
pub mod settings_files;
pub mod state;
pub mod state_publisher;

/// The schema of the states, requests and answers, as JSON Schema: `schema.json` beside this file.
pub const SCHEMA: &str = include_str!("schema.json");

/// The start of every key on the network; the fleet's name follows.
pub const KEY_ROOT: &str = "sculptd/fleet/1";

/// Microseconds between two publications of a state that does not change.
pub const PERIOD_US: u64 = 2_000_000;
/// Microseconds between two publications at least, however often the state changes.
pub const SPACING_US: u64 = 250_000;
/// After so long without a publication an installation is lost, microseconds: three may be late or
/// lost, and the list is right within ten seconds all the same.
pub const LOST_US: u64 = 8_000_000;
