//! Whether a kernel driver replaced an interface's descriptor and changes its reports.
//!
//! Under Linux `hid-uclogic`, `hid-kye`, `hid-waltop`, `hid-holtek-kbd` and HID-BPF programs
//! replace the report descriptor of a tablet. `hid-uclogic` and HID-BPF change the reports, too,
//! and they do so before hidraw hands them out. Both are visible in the descriptor that hidraw
//! shows, which is the replaced one. Such reports are read by that descriptor, and its size is the
//! true one.
//!
//! Source: Linux `hid-uclogic-params.c` and `hid-uclogic-rdesc.h` (report ids of the frame), the
//! descriptors of public collections that were taken under `hid-uclogic`.

use super::identity::{Identity, UC_LOGIC};
use crate::descriptor::{Descriptor, PenLayout};

/// Report ids that `hid-uclogic` gives the keys, rings and dials that it splits off pen reports.
const FRAME_IDS: [u8; 4] = [0xf7, 0xf8, 0xf9, 0xba];
/// Drivers that replace the device's descriptor.
const DRIVERS: [&str; 6] = ["uclogic", "kye", "waltop", "holtek", "viewsonic", "hid-generic-bpf"];
/// Report id of the vendor protocol: Huion and Gaomon.
const HUION_VENDOR: u8 = 0x08;
/// Report id of the vendor protocol: XP-Pen and UGEE.
const UGEE_VENDOR: u8 = 0x02;
/// In-range bit of a report that `hid-uclogic` describes: bit 6 of byte 1.
const KERNEL_IN_RANGE: usize = 14;

/// The pen's layout if this interface is read by a descriptor that a driver wrote, else `None`.
pub(super) fn rewritten<'a>(who: &Identity, d: &'a Descriptor) -> Option<&'a PenLayout> {
    let pen = d.pens.iter().find(|p| !p.as_mouse && p.pressure.is_some())?;
    let named = DRIVERS.iter().any(|name| who.driver.starts_with(name));
    (named || by_shape(who, d, pen)).then_some(pen)
}

/// No device describes these reports itself: its vendor protocol is on a vendor's page.
fn by_shape(who: &Identity, d: &Descriptor, pen: &PenLayout) -> bool {
    if !UC_LOGIC.contains(&who.vid) {
        return false;
    }
    let framed = FRAME_IDS.iter().any(|id| d.declares_id(*id));
    let wide = pen.x.as_ref().is_some_and(|x| x.len == 24);
    let own_protocol = match pen.report_id {
        Some(HUION_VENDOR) => who.vid != 0x28bd,
        Some(UGEE_VENDOR) => who.vid == 0x28bd,
        _ => false,
    };
    // Alone in its descriptor, with the driver's own in-range bit: protocol version 1 of UC-Logic.
    let alone = d.input_lengths.len() == 1
        && pen.report_id == Some(7)
        && pen.in_range.as_ref().is_some_and(|b| b.start == KERNEL_IN_RANGE);
    framed || wide || own_protocol || alone
}
