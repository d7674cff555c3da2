//! # sculptd: the map
//!
//! `sculptd` turns hand movements into clay, in real time. Adaptors read HID pen tablets, serial
//! pens, webcams and a Leap-style hand-tracking feed. Their samples pass through one bounded
//! lock-free channel into a sculpt loop, which runs at a fixed rate on the CPU. Booleans, thickness
//! and distance run on background threads against immutable snapshots. A wgpu viewer with egui
//! panels draws the snapshots.
//!
//! Read first: this page, then `sculptd_engine::command` (the possible requests),
//! `sculptd_engine::world` (the effect of one step), `sculptd_daemon::live` (the loop around it).
//! Each crate's `lib.rs` names the place to start in it. `CONTRIBUTING.md` explains how to build
//! and where to add things.
//!
//! ## Five laws
//! 1. **Two things change the world: a `Sample` (a device's state) and a `Command` (a request).**
//!    A panel's click, a control-socket call, a finished Boolean, an undo: each is a
//!    [`sculptd_engine::command::Command`]. Both are plain data and serialise completely; neither
//!    contains a channel, lock or thread handle. Data that takes long to build from a command (its
//!    clay) waits in the [`sculptd_engine::payload::PayloadStore`] beside the world; without it the
//!    world builds the data again.
//!    [`sculptd_engine::world::World::step`] is the only writer. It has no clock and no IO, starts
//!    no threads, and never fails. So live running, replay, crash recovery, golden tests, fuzzing
//!    and bug reports are one mechanism. Each command has one answer, at its place in
//!    [`sculptd_engine::world::World::answers`]; nothing reports success before it.
//! 2. **Cost follows what moved, never what exists.** A dab costs what its vertices cost, on a mesh
//!    of a thousand vertices or of ten million. No tick touches the whole mesh: not for normals,
//!    not for the BVH, not for the spatial query, not to publish a snapshot, not for undo. A local
//!    Boolean costs what its region costs.
//! 3. **The tick thread never waits.** No locks held by others, no IO, no unbounded work; after
//!    warm-up it neither allocates nor frees in the steady state of a stroke. A contact or
//!    proximity change is never lost; motion may be coalesced, and every loss is counted and shown.
//!    While a result of an operation is put in place, input may wait for a tenth of a second in its
//!    channels: [`sculptd_daemon::input_hold`].
//!    Nothing large is freed on the tick thread, whatever is full: see
//!    [`sculptd_clay::GarbageSink`].
//!    Dynamic topology is bounded by counted work, including scanning and writing pages; work that
//!    does not fit is carried over to the next tick. A thread makes its pages in advance. Two ticks
//!    may be late for it: the first one with a brush that changes topology, or with a local remesh,
//!    which allocates in proportion to the number of pages; and one with an undo, which finishes
//!    the carried-over work, some twenty milliseconds at most.
//!    An edit of the whole mask, of face sets or of triangles in place, also within a region, goes
//!    through pages in portions counted by the cost of reading and writing, and strokes wait.
//!    Commands that need the surface wait in [`sculptd_daemon::live`] until it is done, except an
//!    undo, which reverts new triangles in place at once.
//!    Five more exceptions: a local remesh allocates its lists of pages, and once the memory of its
//!    tasks; an edit of face sets, a stroke that draws them, and dynamic topology on an object that
//!    has some, allocate two bytes per written vertex; the end of a stroke on a layer allocates
//!    that layer's new offsets; a command that needs the whole surface while layers are still being
//!    summed up finishes them in its tick, and so do a hand menu and commands of a shared sculpture
//!    during such an edit; and in a shared sculpture (feature `network`) ticks allocate, each
//!    replica builds a mesh that a command brings on this thread, and while others sculpt beside a
//!    local stroke, the world is forked for the picture (`network::local_echo`), at most ten times
//!    a second, at the cost of its pages.
//! 4. **Old files open.** A session, gallery or preference of an older version opens at its newest
//!    state; only replay from the start may be refused, by name. Each file is written under
//!    a temporary name and renamed.
//! 5. **Nothing happens when nothing happens.** An idle daemon and an idle window use no processor
//!    time that a person could measure.
//!
//! ## The path of one pen sample: four crates and two hand-offs
//! `sculptd-devices` reads, stamps and parses: a [`sculptd_devices::Sample`] holds complete state,
//! never a delta, in mm, 0 to 1 and radians. The channel [`sculptd_devices::queue`] hands it to the
//! tick loop in [`sculptd_daemon::live`], which drains at most N samples and orders them by time.
//! [`sculptd_engine::world`] turns them into view rays, a resampled stroke and dabs;
//! [`sculptd_clay::Clay::dab`] moves vertices in pages. The [`sculptd_clay::Snapshot`] in
//! [`sculptd_daemon::Published`] hands the result to the viewer, which uploads the pages that
//! changed and draws. In the picture alone, ring and stroke run ahead to the position of a tablet's
//! pen that is predicted for the time when the frame is seen: `viewer::provisional`.
//!
//! ## Crates, from the bottom up
//! The compiler enforces the dependencies between them; `tests/tidy` rejects cycles between the
//! files of a crate.
//!
//! * `sculptd-geometry` (`src/geometry`) depends on none: meshes, files, repair, BVH, Booleans and
//!   chains of them at the cost of what each cuts, thickness, distance, jobs that can be cancelled.
//! * `sculptd-devices` (`devices`) depends on none: everything between a wire and a `Sample`;
//!   tablets as data.
//! * `sculptd-camera` (`devices/camera`) depends on devices: pictures of a webcam to hand samples,
//!   with an inference engine for the hand models.
//! * `sculptd-clay` (`src/clay`) depends on geometry: pages, dabs, brushes, dynamic topology,
//!   multiresolution, undo, snapshots, local Booleans.
//! * `sculptd-engine` (`src/engine`) depends on devices, geometry, clay: commands, payloads, the
//!   scene and its undo, the world, camera, strokes, hands.
//! * `sculptd-control` (`src/control`) depends on none: the requests, replies and events of the
//!   control socket as types, their JSON schema, a client.
//! * `sculptd-check` (`src/check`) depends on geometry: whether a part is ready to be printed or
//!   moulded, as findings with place, value and limit, in which direction to build it, and repairs.
//! * `sculptd-daemon` (`src/daemon`) depends on all of the above: the tick loop, simulated time,
//!   sessions, control socket, kiosk, metrics, the page by which guests join.
//! * `sculptd-network` (`src/network`) depends on the daemon and all below it: one sculpture shared
//!   by several daemons, and a fleet of installations. Both protocols are state machines without
//!   clock, IO and threads; Zenoh carries their messages (feature `network`, not in the default
//!   set).
//! * `sculptd-window` (`src/window`) depends on the daemon and all below it: panels (egui) and
//!   viewer (wgpu), which read snapshots and send commands.
//! * `sculptd-mesh-commands` (`src/mesh_commands`) depends on geometry, check, and on the clock of
//!   the devices: the subcommands over mesh files. They are separate so that an edit of the clay
//!   does not recompile them.
//! * `sculptd` (`src/main.rs`, `src/cli`) depends on all: the command line, which reads arguments,
//!   calls, and prints.
//! * `src/bindings`, for other languages: `c` (a header and a shared library over geometry and
//!   devices) and `python` (over geometry; a separate workspace). No crate here depends on them.
//!
//! ## Threads
//! The core crates (except geometry's Booleans) start no threads. The daemon requests the workers
//! of [`sculptd_clay::Workers`], and passes in the sink of [`sculptd_daemon::garbage_thread`] and
//! the supply of [`sculptd_daemon::page_thread`].
//!
//! * main, made by the process: runs the window's event loop, or waits for a signal. Waits for: the
//!   window system, whose end may end it.
//! * `sculptd-tick`, made by `daemon::live`: drains samples and commands, steps the world,
//!   publishes. Waits for: its own clock only.
//! * `sculptd-worker-N`, made by `clay::Workers`, for the tick thread: parts of a large dab. Waits
//!   for: the tick thread.
//! * `sculptd-drop`, made by `daemon::garbage_thread`: frees what the tick thread no longer needs.
//!   Waits for: the tick thread.
//! * `sculptd-pages`, made by `daemon::page_thread`: makes pages for dynamic topology ahead of
//!   need. Waits for: the tick thread.
//! * one a tablet, one a serial port, one a tracker, made by `devices::device_thread`, for the
//!   adaptors: reads, parses, sends samples. Waits for: its device.
//! * `sculptd-camera`, made by `camera::camera_thread`, for the adaptors: looks at pictures, sends
//!   hands. Waits for: its camera's reader.
//! * `sculptd-camera-reader`, made by `camera::camera_thread`: reads and decodes pictures. Waits
//!   for: the camera. Nobody waits for it: a camera that has stopped sending may block it.
//! * `sculptd-join`, made by `daemon::boolean_jobs`: Booleans of the clay with the held
//!   object, sent back as commands. Waits for: a choice in the hand menu.
//! * `sculptd-follow`, made by `daemon::live_booleans`: recomputes live Boolean results when their
//!   operands change. Waits for: the published state, time.
//! * `sculptd-global`, made by `geometry::boolean::global`: the slow exact route of a Boolean, so
//!   that it can be cancelled. Waits for: its Boolean.
//! * `sculptd-tail`, made by `daemon::session::writer`: copies input to memory that outlives the
//!   process. Waits for: the tick thread.
//! * `sculptd-journal`, made by `daemon::session::writer`: writes samples and commands in groups.
//!   Waits for: the tail, the disk.
//! * `sculptd-sync`, made by `daemon::session::syncer`: syncs written input to the disk.
//!   Waits for: the journal, the disk.
//! * `sculptd-history`, made by `daemon::session::history`: writes the pages of each step; fetches
//!   them for undo. Waits for: the tick thread, the disk.
//! * `sculptd-control`, made by `daemon::control::server`: accepts clients of the control socket.
//!   Waits for: the socket.
//! * `sculptd-client`, made by `daemon::control::server`: answers one client's requests. Waits for:
//!   that client.
//! * `sculptd-events`, made by `daemon::control::events`: sends events to one client. Waits for:
//!   the published state.
//! * `sculptd-metrics`, `sculptd-share`, `sculptd-web`, made by `daemon::http`: serve metrics, a
//!   visitor's sculpture for download, and the page by which guests join, each to many clients.
//!   Wait for: their socket, time.
//! * `sculptd-take-home`, made by `daemon::web`: writes the work as a file for a guest, once.
//! * `sculptd-page-walls`, made by `daemon::web`: measures walls while a page shows their map.
//! * `sculptd-page`, made by `daemon::web`: reads what one guest's page sends, and sends it the
//!   clay that it lacks. Waits for: that page, time.
//! * `sculptd-telemetry`, made by `daemon::telemetry`: sends metrics and the log to a collector.
//!   Waits for: time, the collector.
//! * `sculptd-service`, made by `daemon::service`: the watchdog of systemd, reload on SIGHUP. Waits
//!   for: time, a signal.
//! * `sculptd-kiosk`, made by `daemon::kiosk::keeper`: the cycle of an installation: attract,
//!   sculpt, reset. Waits for: time, the published state.
//! * `sculptd-visits`, made by `daemon::kiosk::visit_journal`: makes the session file of the next
//!   visit, and removes it once the visit's work was put away.
//! * `sculptd-score`, made by `daemon::kiosk::exhibit::score_thread`: scores the newest clay
//!   against the goal of an exhibit during a visit. Waits for: the next goal, time.
//! * `sculptd-export`, made by `daemon::kiosk::keeper`: packs the works of today into one file,
//!   once.
//! * `sculptd-wall`, made by `daemon::kiosk::wall`: reads the next work of the gallery wall, one at
//!   a time. Ends with the installation.
//! * `sculptd-gallery`, made by `daemon::kiosk::spool`: sends finished sculptures to their
//!   destination. Waits for: the disk, the network.
//! * `sculptd-player`, made by `daemon::live_run`: plays recordings as devices. Waits for: the
//!   clock.
//! * `sculptd-prune`, made by `cli::library`: removes old sessions of the data folder. Waits for:
//!   the disk.
//! * `sculptd-brushes`, made by `daemon::brush_folder`: reads the user's brushes again when a file
//!   changes. Waits for: the clock. Owns: the folder as it was read. Publishes through: the list
//!   that all clones of the presets share.
//! * `sculptd-survivor`, made by `cli::window_guard`: replaces the main thread if the window
//!   system has ended it. Waits for: such a loss.
//! * `sculptd-limit`, made by `daemon::live_run`: ends a run after `--for`. Waits for: the clock.
//! * `sculptd-shared`, made by `network::live`: the station of a shared sculpture: takes datagrams
//!   and the local input, orders or follows. Waits for: the network, the tick thread, time.
//! * `sculptd-replica`, made by `network::live`: hashes, checkpoints, and worlds made of them, for
//!   that station. Waits for: the station.
//! * `sculptd-bulk`, made by `network::zenoh_link`: sends checkpoints to those who join. Waits for:
//!   them, and for the receiver.
//! * `sculptd-fleet`, made by `network::fleet::installation_thread`: publishes the state of an
//!   installation, and carries out requests of staff. Waits for: the network, time, the published
//!   state.
//! * `sculptd-load`, `sculptd-export`, `sculptd-outline`, `sculptd-picture`, made by
//!   `window::viewer::tasks`: read and write files for the window. Waits for: the disk.
//! * `sculptd-boolean`, `sculptd-trim`, `sculptd-level`, `sculptd-remesh`, `sculptd-sets`,
//!   `sculptd-mask`, made by `window::viewer::tasks`: changes of the whole object that the window
//!   asked for, sent as commands. Waits for: the loop's answer.
//! * `sculptd-brush`, made by `window::viewer::brush_requests`: writes the brush in hand into the
//!   folder of the user's brushes. Waits for: the disk.
//! * `sculptd-dialog`, made by `window::viewer::tasks`: the desktop's file dialog. Waits for: a
//!   person.
//! * `sculptd-folder`, made by `window::viewer::tasks`: lists a folder for the window's file
//!   chooser. Waits for: the disk.
//! * `sculptd-look`, made by `window::viewer::tasks`: reads and stores pictures for the look of the
//!   clay. Waits for: the disk.
//! * `sculptd-thickness`, made by `window::viewer::tasks`: the live thickness map. Waits for: a
//!   request; a newer one replaces it.
//! * `sculptd-preview`, `sculptd-distance`, `sculptd-measure`, `sculptd-section`, `sculptd-check`,
//!   made by `window::viewer::snapshot_workers`: follow the newest snapshot for the window. Waits
//!   for: a request; a newer one replaces it.
//! * `sculptd-coarse`, made by `window::viewer::coarse_pages`: makes the fewer triangles that far
//!   pages are drawn with. Waits for: nothing; it ends when all are made.
//! * `sculptd-pictures`, made by `window::viewer::version_pictures`: reads thumbnails of the
//!   history. Waits for: the disk.
//! * `sculptd-earlier`, made by `window::viewer::earlier_pictures`: reads the pictures of earlier
//!   sessions. Waits for: the disk.
//!
//! Long computations outside the tick (Booleans, thickness, repair) also use the threads of rayon's
//! global pool.
//!
//! ## Determinism
//! The same binary, the same start mesh, the same samples and commands give the same bits, with any
//! number of workers, with and without AVX2: sines, powers and turns come from `libm`.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod cli;
#[doc(hidden)]
pub mod fuzzing;
mod presets;
pub mod settings;

pub use presets::presets;
