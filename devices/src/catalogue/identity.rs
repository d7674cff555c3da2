//! Data that can be read from one interface of a device.

/// Vendors whose reports are UC-Logic's, whatever their descriptors say: those call the second
/// button an eraser.
pub(super) const UC_LOGIC: [u16; 3] = [0x5543, 0x256c, 0x28bd];
/// Vendors that sell pen tablets and hardly anything else: KYE, Aiptek, Hanvon, Waltop, Huion,
/// XP-Pen, XENX, VEIKK, UC-Logic, LetSketch.
pub(super) const TABLET_VENDORS: [u16; 10] =
    [0x0458, 0x08ca, 0x0b57, 0x172f, 0x256c, 0x28bd, 0x2d80, 0x2feb, 0x5543, 0x6161];

/// Data read from one interface before it sends a report; for recordings also the lengths of its
/// reports.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Identity {
    /// USB or Bluetooth vendor id; 0 where it is unknown.
    pub vid: u16,
    /// Product id.
    pub pid: u16,
    /// USB interface number; `None` where the bus has none.
    pub interface: Option<u8>,
    /// Product name, empty where the device has none.
    pub name: String,
    /// The kernel's `HID_UNIQ`, empty where it has none. Usually a serial number. For Huion and
    /// Gaomon tablets under `hid_uclogic` it is the firmware's name, which string 201 holds, too.
    pub uniq: String,
    /// The kernel driver that is bound to the interface (`DRIVER` of its uevent), empty where it is
    /// unknown.
    pub driver: String,
    /// Report descriptor, as the platform shows it: a kernel driver may have replaced the device's
    /// own. Empty where the platform does not show it.
    pub descriptor: Vec<u8>,
    /// USB string descriptors by index, with their two-byte header.
    pub strings: Vec<(u8, Vec<u8>)>,
    /// Distinct lengths, in bytes, of the reports that a recording holds.
    pub seen_lengths: Vec<usize>,
}

/// Index of the USB string that holds the firmware's name on UC-Logic tablets.
const FIRMWARE_NAME: u8 = 201;

impl Identity {
    /// A USB string's text; `None` where it is unknown. String 201 falls back on
    /// [`Identity::uniq`], where that looks like a firmware's name.
    pub fn string(&self, index: u8) -> Option<String> {
        let Some((_, raw)) = self.strings.iter().find(|(i, _)| *i == index) else {
            return (index == FIRMWARE_NAME).then(|| self.firmware_name()).flatten();
        };
        let pairs = raw.get(2..)?.chunks_exact(2);
        let units: Vec<u16> = pairs.map(|p| u16::from_le_bytes([p[0], p[1]])).collect();
        Some(String::from_utf16_lossy(&units).trim_matches('\0').to_owned())
    }

    /// `HUION_T173_190619`: a brand, a model code and a date.
    fn firmware_name(&self) -> Option<String> {
        let parts: Vec<&str> = self.uniq.split('_').collect();
        let dated = parts.last()?.len() == 6 && parts.last()?.bytes().all(|b| b.is_ascii_digit());
        (parts.len() >= 3 && dated).then(|| self.uniq.clone())
    }
}
