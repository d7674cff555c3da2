//! A pen tablet that the kernel takes for a real one, by Linux's user-space HID.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

/// Report descriptor of such a tablet, as far as the drivers need it: reports 2 and 12 (the pad) in
/// nine opaque bytes, feature 2 in one.
pub const DESCRIPTOR: &[u8] = &[
    0x05, 0x0d, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x02, 0x09, 0x00, 0x75, 0x08, 0x95, 0x09, 0x15, 0x00,
    0x26, 0xff, 0x00, 0x81, 0x02, 0x09, 0x00, 0x95, 0x01, 0xb1, 0x02, 0x85, 0x0c, 0x09, 0x00, 0x95,
    0x09, 0x81, 0x02, 0xc0,
];
/// `O_NONBLOCK` on Linux.
pub const NONBLOCK: i32 = 0o4000;

/// A virtual HID device, `Documentation/hid/uhid.rst`.
pub struct Uhid(File);

impl Uhid {
    /// A Wacom PTK-440 is plugged in.
    pub fn plug() -> io::Result<Uhid> {
        let file =
            OpenOptions::new().read(true).write(true).custom_flags(NONBLOCK).open("/dev/uhid")?;
        let mut event = vec![0u8; 4 + 128 + 64 + 64];
        event[..4].copy_from_slice(&11u32.to_le_bytes());
        event[4..4 + 7].copy_from_slice(b"PTK-440");
        event[132..132 + 5].copy_from_slice(b"vm/in");
        event[196..196 + 6].copy_from_slice(b"SERIAL");
        event.extend((DESCRIPTOR.len() as u16).to_le_bytes());
        event.extend(3u16.to_le_bytes());
        for n in [0x056au32, 0x00b8, 0x0100, 0] {
            event.extend(n.to_le_bytes());
        }
        event.extend(DESCRIPTOR);
        event.resize(4376, 0);
        (&file).write_all(&event)?;
        Ok(Uhid(file))
    }

    /// Answers what the drivers ask; every wait goes through here.
    pub fn serve(&mut self, time: Duration) -> io::Result<()> {
        let mut left = time.as_millis();
        loop {
            let mut event = [0u8; 4380];
            while let Ok(n) = self.0.read(&mut event) {
                if n < 12 {
                    break;
                }
                let reply = match u32::from_le_bytes([event[0], event[1], event[2], event[3]]) {
                    // Get report: the mode is 2, anything else is refused.
                    9 if event[8] == 2 => {
                        [&10u32.to_le_bytes()[..], &event[4..8], &[0, 0, 2, 0, 2, 2]].concat()
                    }
                    9 => [&10u32.to_le_bytes()[..], &event[4..8], &[5, 0, 0, 0]].concat(),
                    13 => [&14u32.to_le_bytes()[..], &event[4..8], &[0, 0]].concat(),
                    _ => continue,
                };
                self.0.write_all(&reply)?;
            }
            if left == 0 {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(1));
            left -= 1;
        }
    }

    /// The device sends a report.
    pub fn report(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut event = 12u32.to_le_bytes().to_vec();
        event.extend((bytes.len() as u16).to_le_bytes());
        event.extend(bytes);
        self.0.write_all(&event)
    }
}
