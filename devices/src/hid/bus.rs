//! The interfaces that are plugged in, and how they are opened: by hidapi on a real machine, by a
//! simulation in tests.

use std::collections::BTreeMap;
use std::ffi::CString;
use std::io;

use hidapi::{HidApi, HidDevice, HidError};

use super::transport::Transport;
use crate::catalogue::Identity;

/// Indexed USB strings that distinguish models. Read where the platform can read them.
const TELLING_STRINGS: [u8; 7] = [2, 4, 5, 6, 100, 121, 201];

/// One interface of one device.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Node {
    /// Path with which it is opened: `/dev/hidraw0`. Unique while it is plugged in.
    pub path: String,
    /// Empty where the device has none.
    pub serial: String,
    /// Data read from the interface without opening it.
    pub who: Identity,
    /// The interface may hold a pen: a digitiser, a vendor's usage, or a pointer. The others are
    /// not opened.
    pub may_be_pen: bool,
}

/// A source of interfaces.
pub trait Bus: Send {
    /// Everything plugged in now.
    fn nodes(&mut self) -> io::Result<Vec<Node>>;
    /// Opens an interface.
    ///
    /// # Errors
    /// The interface is gone, or the user may not open it ([`io::ErrorKind::PermissionDenied`]).
    fn open(&mut self, node: &Node) -> io::Result<Box<dyn Transport>>;
    /// A number that is cheap to read and changes when a device is plugged in or out; `None` where
    /// there is none.
    fn stamp(&self) -> Option<u64> {
        None
    }
}

/// The machine's own bus.
pub struct HidApiBus {
    api: HidApi,
}

impl std::fmt::Debug for HidApiBus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HidApiBus").finish_non_exhaustive()
    }
}

impl HidApiBus {
    /// # Errors
    /// The platform's HID service is not there.
    pub fn new() -> io::Result<Self> {
        Ok(HidApiBus { api: HidApi::new().map_err(to_io)? })
    }
}

impl Bus for HidApiBus {
    fn nodes(&mut self) -> io::Result<Vec<Node>> {
        self.api.reset_devices().map_err(to_io)?;
        self.api.add_devices(0, 0).map_err(to_io)?;
        // One node yields an entry for each of its top-level usages.
        let mut nodes: BTreeMap<String, Node> = BTreeMap::new();
        for info in self.api.device_list() {
            let path = info.path().to_string_lossy().into_owned();
            let may = matches!(info.usage_page(), 0x0d | 0xff00.. | 0)
                || (info.usage_page(), info.usage()) == (1, 2)
                || info.usage_page() == 1 && info.usage() == 1;
            let node = nodes.entry(path.clone()).or_insert_with(|| Node {
                serial: info.serial_number().unwrap_or_default().to_owned(),
                who: Identity {
                    vid: info.vendor_id(),
                    pid: info.product_id(),
                    interface: u8::try_from(info.interface_number()).ok(),
                    name: info.product_string().unwrap_or_default().to_owned(),
                    uniq: uevent(&path, "HID_UNIQ"),
                    driver: uevent(&path, "DRIVER"),
                    descriptor: descriptor_of(&path),
                    ..Identity::default()
                },
                path,
                may_be_pen: false,
            });
            node.may_be_pen |= may;
        }
        Ok(nodes.into_values().collect())
    }

    fn open(&mut self, node: &Node) -> io::Result<Box<dyn Transport>> {
        let path = CString::new(node.path.clone())
            .map_err(|_| io::Error::from(io::ErrorKind::InvalidInput))?;
        let device = self.api.open_path(&path).map_err(to_io)?;
        Ok(Box::new(HidApiTransport { device }))
    }

    fn stamp(&self) -> Option<u64> {
        // A node that appears or disappears changes the time of its folder.
        let changed = std::fs::metadata("/dev").ok()?.modified().ok()?;
        let since = changed.duration_since(std::time::UNIX_EPOCH).ok()?;
        cfg!(target_os = "linux").then_some(since.as_nanos() as u64)
    }
}

/// The report descriptor without opening the node, where the system shows it.
fn descriptor_of(path: &str) -> Vec<u8> {
    let name = path.rsplit('/').next().unwrap_or_default();
    if !name.starts_with("hidraw") {
        return Vec::new();
    }
    std::fs::read(format!("/sys/class/hidraw/{name}/device/report_descriptor")).unwrap_or_default()
}

/// A value of the HID device's uevent, where the system shows one: Linux.
fn uevent(path: &str, key: &str) -> String {
    let name = path.rsplit('/').next().unwrap_or_default();
    if !name.starts_with("hidraw") {
        return String::new();
    }
    let text = std::fs::read_to_string(format!("/sys/class/hidraw/{name}/device/uevent"));
    value_of(&text.unwrap_or_default(), key)
}

/// The value of `KEY=value` in a uevent.
fn value_of(uevent: &str, key: &str) -> String {
    let pairs = uevent.lines().filter_map(|line| line.split_once('='));
    pairs.filter(|(k, _)| *k == key).map(|(_, v)| v.to_owned()).next().unwrap_or_default()
}

/// Reads what only an open device gives: the descriptor, where it is not known yet, and indexed
/// strings.
pub(super) fn read_more(who: &mut Identity, device: &mut dyn Transport) {
    if who.descriptor.is_empty()
        && let Some(bytes) = device.descriptor()
    {
        who.descriptor = bytes;
    }
    for index in TELLING_STRINGS {
        if let Some(text) = device.string(index) {
            let units = text.encode_utf16().flat_map(u16::to_le_bytes);
            let mut raw = vec![(2 + 2 * text.encode_utf16().count()).min(255) as u8, 3];
            raw.extend(units);
            who.strings.push((index, raw));
        }
    }
}

struct HidApiTransport {
    device: HidDevice,
}

impl Transport for HidApiTransport {
    fn read(&mut self, buf: &mut [u8], timeout_ms: i32) -> io::Result<usize> {
        self.device.read_timeout(buf, timeout_ms).map_err(to_io)
    }

    fn write(&mut self, report: &[u8]) -> io::Result<()> {
        self.device.write(report).map(|_| ()).map_err(to_io)
    }

    fn send_feature(&mut self, report: &[u8]) -> io::Result<()> {
        self.device.send_feature_report(report).map_err(to_io)
    }

    fn get_feature(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.device.get_feature_report(buf).map_err(to_io)
    }

    fn descriptor(&mut self) -> Option<Vec<u8>> {
        let mut bytes = vec![0; hidapi::MAX_REPORT_DESCRIPTOR_SIZE];
        let n = self.device.get_report_descriptor(&mut bytes).ok()?;
        bytes.truncate(n);
        Some(bytes)
    }

    fn string(&mut self, index: u8) -> Option<String> {
        self.device.get_indexed_string(i32::from(index)).ok().flatten()
    }
}

fn to_io(e: HidError) -> io::Error {
    match e {
        HidError::IoError { error } => error,
        HidError::InitializationError => io::Error::other("the HID service cannot be started"),
        other => {
            let text = other.to_string();
            let denied = text.to_ascii_lowercase().contains("permission denied");
            let kind = if denied { io::ErrorKind::PermissionDenied } else { io::ErrorKind::Other };
            io::Error::new(kind, text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uevent_names_the_driver_and_the_firmware() {
        let text = "DRIVER=uclogic\nHID_ID=0003:0000256C:0000006D\nHID_NAME=HUION Huion Tablet\n\
                    HID_PHYS=usb-1/input0\nHID_UNIQ=HUION_T173_190619\n";
        assert_eq!(value_of(text, "DRIVER"), "uclogic");
        assert_eq!(value_of(text, "HID_UNIQ"), "HUION_T173_190619");
        assert_eq!(value_of(text, "HID_"), "");
        assert_eq!(value_of("", "DRIVER"), "");
        let who = Identity { uniq: value_of(text, "HID_UNIQ"), ..Identity::default() };
        assert_eq!(who.string(201).as_deref(), Some("HUION_T173_190619"));
        let serial = Identity { uniq: "1ABC23".to_owned(), ..Identity::default() };
        assert_eq!(serial.string(201), None, "a serial number is no firmware");
    }
}
