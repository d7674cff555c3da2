//! The world: device samples and commands come in, clay comes out.
//!
//! Law kept here: two things change the world, a [`sculptd_devices::Sample`] and a
//! [`command::Command`], both plain data, and [`world::World::step`] is the only writer. It has no
//! clock and no IO, starts no threads, and never fails. So live running, replay, recovery, golden
//! tests, fuzzing and bug reports are one mechanism.
//!
//! Read first: [`command`] and [`payload`], then [`world`] and [`scene`], then [`stroke`] and
//! [`hand`].
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::unwrap_used))]
// Tests compare with the functions that the bans of clippy.toml keep out of the clay.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod answer;
pub mod camera;
pub mod checkpoint;
pub mod command;
pub mod desktop_layout;
pub mod hand;
mod layer_work;
pub mod local_remesh;
pub mod mask_region;
pub mod old_layout;
pub mod payload;
mod region_seen;
mod remesh_work;
pub mod scene;
pub mod stroke;
mod surface_edit;
mod topology_work;
pub mod view_region;
pub mod world;
