//! Tests that run several modules together: simulated devices, reader threads and the channel.
//!
//! They stand here and not beside the modules that they test, so that no module imports the
//! simulators.

mod flood;
mod hot_plug;
mod serial_lines;
