//! Tests that run several modules together: simulated devices, reader threads and the channel.
//!
//! They stand here and not beside the modules that they test, so that no module imports the
//! simulators.

mod flood;
mod hot_plug;
mod serial_lines;

use std::time::Duration;

/// Waits until it has happened, for a minute at most: the machine may be loaded.
fn until(what: &str, mut happened: impl FnMut() -> bool) {
    let (_hold, stop) = crate::device_thread::pair();
    for _ in 0..6000 {
        if happened() {
            return;
        }
        stop.wait(Duration::from_millis(10));
    }
    panic!("never: {what}");
}
