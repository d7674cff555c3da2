//! A USB device that this program answers for: the kernel's `vhci_hcd` hands every transfer of the
//! device's port over a socket, in the protocol of USB/IP (Linux `Documentation/usb/
//! usbip_protocol.rst`). Drivers that ask a device over USB, as `hid_uclogic` does for its
//! parameter strings, find a whole device there, which uhid cannot give.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::thread::JoinHandle;

use crossbeam_channel as cc;

/// `vhci_hcd`'s file: "port socket device speed".
const ATTACH: &str = "/sys/devices/platform/vhci_hcd.0/attach";
/// `USB_SPEED_FULL` of Linux.
const FULL_SPEED: u32 = 2;
const HEADER: usize = 48;
/// `-EPIPE`: a stall, as a device answers what it does not know.
const STALL: i32 = -32;

/// A HID device with one interface and one interrupt endpoint.
#[derive(Debug, Clone)]
pub struct Description {
    pub vid: u16,
    pub pid: u16,
    pub report_descriptor: Vec<u8>,
    /// Raw string descriptors by index, with their two-byte header.
    pub strings: BTreeMap<u8, Vec<u8>>,
}

/// A string descriptor of this text.
pub fn text(s: &str) -> Vec<u8> {
    let mut out = vec![0, 3];
    out.extend(s.encode_utf16().flat_map(u16::to_le_bytes));
    out[0] = out.len() as u8;
    out
}

/// A transfer that the host asks for.
enum Asked {
    Submit { seq: u32, endpoint: u32, into_host: bool, length: u32, setup: [u8; 8] },
    Unlink { seq: u32, target: u32 },
}

/// The plugged device; dropping it pulls the plug.
pub struct UsbDevice {
    reports: Option<cc::Sender<Vec<u8>>>,
    socket: UnixStream,
    threads: Vec<JoinHandle<()>>,
}

impl UsbDevice {
    pub fn plug(description: Description) -> io::Result<UsbDevice> {
        let (ours, theirs) = UnixStream::pair()?;
        let (asked_tx, asked) = cc::unbounded();
        let (reports, due) = cc::unbounded();
        let (reader, writer) = (ours.try_clone()?, ours.try_clone()?);
        let threads = vec![
            std::thread::spawn(move || listen(reader, &asked_tx)),
            std::thread::spawn(move || drop(answer(writer, &description, &asked, &due))),
        ];
        let line = format!("0 {} 1 {FULL_SPEED}", theirs.as_raw_fd());
        File::options().write(true).open(ATTACH)?.write_all(line.as_bytes())?;
        Ok(UsbDevice { reports: Some(reports), socket: ours, threads })
    }

    /// The device sends a report as soon as the host asks for one.
    pub fn report(&self, bytes: &[u8]) {
        if let Some(reports) = &self.reports {
            let _ = reports.send(bytes.to_vec());
        }
    }
}

impl Drop for UsbDevice {
    fn drop(&mut self) {
        self.reports = None;
        let _ = self.socket.shutdown(std::net::Shutdown::Both);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn listen(mut socket: UnixStream, to: &cc::Sender<Asked>) {
    let mut h = [0u8; HEADER];
    while socket.read_exact(&mut h).is_ok() {
        let word = |at: usize| u32::from_be_bytes([h[at], h[at + 1], h[at + 2], h[at + 3]]);
        let asked = match word(0) {
            1 => {
                let (into_host, length) = (word(12) == 1, word(24));
                if !into_host && socket.read_exact(&mut vec![0; length as usize]).is_err() {
                    return;
                }
                let mut setup = [0; 8];
                setup.copy_from_slice(&h[40..48]);
                Asked::Submit { seq: word(4), endpoint: word(16), into_host, length, setup }
            }
            2 => Asked::Unlink { seq: word(4), target: word(20) },
            _ => return,
        };
        if to.send(asked).is_err() {
            return;
        }
    }
}

fn answer(
    mut socket: UnixStream,
    device: &Description,
    asked: &cc::Receiver<Asked>,
    due: &cc::Receiver<Vec<u8>>,
) -> io::Result<()> {
    // Interrupt transfers that wait for a report, oldest first.
    let mut waiting: Vec<(u32, u32)> = Vec::new();
    loop {
        let none = cc::never();
        let due = if waiting.is_empty() { &none } else { due };
        cc::select! {
            recv(asked) -> next => match next {
                Ok(Asked::Submit { seq, endpoint: 0, into_host, length, setup }) => {
                    let reply = if into_host { control(device, setup) } else { Some(Vec::new()) };
                    let data = reply.as_ref().map(|d| &d[..d.len().min(length as usize)]);
                    let done = data.map_or(0, |d| if into_host { d.len() as u32 } else { length });
                    let status = if reply.is_some() { 0 } else { STALL };
                    returned(&mut socket, 3, seq, status, done, data.unwrap_or(&[]))?;
                }
                Ok(Asked::Submit { seq, length, .. }) => waiting.push((seq, length)),
                Ok(Asked::Unlink { seq, target }) => {
                    let there = waiting.iter().any(|w| w.0 == target);
                    waiting.retain(|w| w.0 != target);
                    // -ECONNRESET: the request was cancelled.
                    returned(&mut socket, 4, seq, if there { -104 } else { 0 }, 0, &[])?;
                }
                Err(_) => return Ok(()),
            },
            recv(due) -> report => match report {
                Ok(report) => {
                    let (seq, length) = waiting.remove(0);
                    let data = &report[..report.len().min(length as usize)];
                    returned(&mut socket, 3, seq, 0, data.len() as u32, data)?;
                }
                Err(_) => return Ok(()),
            },
        }
    }
}

fn returned(
    socket: &mut UnixStream,
    command: u32,
    seq: u32,
    status: i32,
    length: u32,
    data: &[u8],
) -> io::Result<()> {
    let mut out = Vec::with_capacity(HEADER + data.len());
    for word in [command, seq, 0, 0, 0, status as u32, length, 0, 0, 0] {
        out.extend(word.to_be_bytes());
    }
    out.resize(HEADER, 0);
    out.extend(data);
    socket.write_all(&out)
}

/// Returns the device's answer to a control transfer; `None` if it stalls.
fn control(device: &Description, setup: [u8; 8]) -> Option<Vec<u8>> {
    let value = u16::from_le_bytes([setup[2], setup[3]]);
    let [vid, pid] = [device.vid, device.pid].map(u16::to_le_bytes);
    let length = (device.report_descriptor.len() as u16).to_le_bytes();
    // HID 1.11, one report descriptor.
    let hid = [9, 0x21, 0x11, 0x01, 0, 1, 0x22, length[0], length[1]];
    match (setup[0], setup[1], value >> 8, value as u8) {
        // USB 1.1, no class, 64 bytes in a packet of endpoint 0, strings 1 and 2.
        (0x80, 6, 1, _) => {
            let ids = [vid[0], vid[1], pid[0], pid[1]];
            Some([&[18, 1, 0x10, 1, 0, 0, 0, 64][..], &ids, &[0, 1, 1, 2, 0, 1]].concat())
        }
        (0x80, 6, 2, _) => {
            let configuration = [9, 2, 34, 0, 1, 1, 0, 0x80, 50];
            let interface = [9, 4, 0, 0, 1, 3, 0, 0, 0];
            // Interrupt endpoint into the host, 64 bytes, every 2 ms.
            let endpoint = [7, 5, 0x81, 3, 64, 0, 2];
            Some([&configuration[..], &interface, &hid, &endpoint].concat())
        }
        // The languages: US English only.
        (0x80, 6, 3, 0) => Some(vec![4, 3, 9, 4]),
        (0x80, 6, 3, index) => device.strings.get(&index).cloned(),
        (0x81, 6, 0x21, _) => Some(hid.to_vec()),
        (0x81, 6, 0x22, _) => Some(device.report_descriptor.clone()),
        (0x80, 0, ..) => Some(vec![0, 0]),
        _ => None,
    }
}
