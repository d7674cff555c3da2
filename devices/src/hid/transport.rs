//! Where reports are read from and written to: a hidraw node or a simulation.

use std::io;

/// One open interface of one device. Everything above it is the same for a real tablet and a
/// simulated one.
pub trait Transport: Send {
    /// The next input report, its id first where the device has ids. `Ok(0)`: none came in
    /// `timeout_ms`. An error means that the device is gone.
    fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize>;
    /// An output report, its id first.
    fn write(&mut self, report: &[u8]) -> io::Result<()>;
    /// A feature report, its id first.
    fn send_feature(&mut self, report: &[u8]) -> io::Result<()>;
    /// Asks for a feature report: its id is in `buf[0]`. Gives how many bytes came.
    fn get_feature(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let _ = buf;
        Err(io::ErrorKind::Unsupported.into())
    }
    /// Returns the report descriptor, if the platform provides it.
    fn descriptor(&mut self) -> Option<Vec<u8>> {
        None
    }
    /// A USB string by index, where the platform can ask for it. On some tablets the asking
    /// switches the protocol.
    fn string(&mut self, index: u8) -> Option<String> {
        let _ = index;
        None
    }
}
