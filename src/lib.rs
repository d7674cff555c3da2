//! # sculptd: the map
//!
//! `sculptd` turns the movements of a hand into clay, in real time. Pen tablets (HID), serial pens
//! and a Leap-style hand-tracking feed are read by adaptors; their samples pass one bounded
//! lock-free channel into a sculpt loop that runs at a fixed rate on the CPU; Booleans, thickness
//! and distance run on background threads against immutable snapshots; a wgpu viewer with egui
//! panels draws the snapshots.
//!
//! ## Three laws
//! 1. **Two things change the world: a `Sample` (what a device said) and a `Command` (what was
//!    asked).** A panel's click, a control-socket call, a finished Boolean, an undo: each is a
//!    [`sculptd_engine::command::Command`]. Both are plain data and serialise.
//!    [`sculptd_engine::world::World::step`] is the only writer. It has no clock, no IO, no threads
//!    of its own making, and never fails. So live running, replay, recovery, golden tests, fuzzing
//!    and bug reports are one mechanism.
//! 2. **Cost follows what moved, never what exists.** A dab costs what its vertices cost, on a mesh
//!    of a thousand vertices or of ten million. No tick touches the whole mesh: not for normals,
//!    not for the trees, not to publish, not for undo.
//! 3. **The tick thread never waits.** No locks held by others, no IO, no unbounded work; after
//!    warm-up it neither allocates nor frees in the steady state of a stroke. A contact or
//!    proximity change is never lost; motion may be coalesced, and every loss is counted and shown.
//!
//! ## The path of one pen sample: four rooms, two doors
//! `devices` (read, stamp, parse, pen state: a [`sculptd_devices::Sample`], complete state in mm,
//! 0..1 and radians) -> **door 1**, the channel [`sculptd_devices::queue`] -> [`daemon`]'s tick
//! loop (drain at most N, order by time) -> [`world`] ([`stroke`]: view ray, resampling ->
//! [`brush`]: dabs -> [`mesh`]: pages) -> **door 2**, the [`mesh::Snapshot`] in
//! [`daemon::Published`] -> the viewer (upload dirty pages, draw).
//!
//! ## Rooms, and who may know whom
//! * `sculptd-devices` (a crate of its own, `devices/`) and [`mesh`] know nobody.
//! * [`stroke`], [`brush`], [`hand`], [`analysis`] build on them. [`world`] joins them.
//! * `panels` (egui only) and `viewer` (wgpu only), behind the feature `viewer`, see snapshots and
//!   send commands.
//! * [`daemon`] wires all; [`cli`] reads arguments and prints; [`config`] turns what was written
//!   into what it means.
//!
//! `tests/it/tidy.rs` holds these walls.
//!
//! ## Threads
//! | thread | made by | does | waits for |
//! |---|---|---|---|
//! | main | the process | the window's event loop, or waits for a signal | the window system |
//! | `sculptd-tick` | [`daemon::live`] | drain, `World::step`, publish | its own clock only |
//! | workers | [`mesh::Workers`] | parts of a large dab | the tick thread |
//! | one a tablet, one a serial port, one a tracker | the adaptors in `devices` | read, parse, push | its device |
//! | `sculptd-join` | [`daemon::joiner`] | Booleans of the work with the thing in the hands, sent back as commands | a wish |
//! | `sculptd-preview`, `-distance`, `-thickness`, `-measure` | `viewer::snapshot_workers`, `viewer::tasks` | follow the newest snapshot for the window | a request; a newer one replaces it |
//! | `sculptd-tail` | [`daemon::session`] | copies input to memory that outlives the process | the tick thread's data |
//! | journal | [`daemon::session`] | writes samples and commands in groups | that thread's data, the disk |
//! | `sculptd-history` | [`daemon::session::history`] | writes the pages of each step; fetches them for undo | the tick thread's moments, the disk |
//! | `sculptd-drop` | [`daemon::live`] | frees what was replaced | the tick thread's leavings |
//!
//! ## Determinism
//! The same binary, the same start mesh, the same samples and commands give the same bits, with any
//! number of workers. Across machines compare facts (volume, bounds, counts) within a tolerance:
//! `sin` and `powf` come from the platform.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod cli;
#[doc(hidden)]
pub mod fuzzing;
