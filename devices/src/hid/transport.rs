//! How report bytes come and go: a hidraw node, a recording, a simulator.

use std::io;

/// One open interface of one device. Everything above it is the same for a real tablet and a simulated one.
pub trait Transport: Send {
    /// The next input report, its id first where the device has ids. `Ok(0)`: none came in `timeout_ms`. An error means
    /// that the device is gone.
    fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize>;
    /// An output report, its id first.
    fn write(&mut self, report: &[u8]) -> io::Result<()>;
    /// A feature report, its id first.
    fn send_feature(&mut self, report: &[u8]) -> io::Result<()>;
}
