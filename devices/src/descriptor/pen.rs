//! Positions of a pen's fields in one input report.

use hidreport::{ArrayField, FieldAttributes, VariableField};

use super::bits::Bits;
use super::page_id;

/// Smallest range of a bare pointer's axis that may be a tablet's.
const LEAST_RANGE: i32 = 1000;

/// An array field: its value, less `bits.min`, is the index of the control that is pressed.
#[derive(Debug, Clone, PartialEq)]
pub struct Selector {
    /// Position of the value. A value outside `bits.min..=bits.max` presses nothing.
    pub bits: Bits,
    /// Usage of each control, on the digitiser page (0x0D).
    pub usages: Vec<u32>,
}

impl Selector {
    /// The usage that is pressed, or `None`.
    pub fn pressed(&self, report: &[u8]) -> Option<u32> {
        let index = self.bits.read(report)?.checked_sub(self.bits.min)?;
        self.usages.get(usize::try_from(index).ok()?).copied()
    }
}

/// One input report that places a pen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PenLayout {
    /// The report's id; `None` where the descriptor uses no report ids.
    pub report_id: Option<u8>,
    /// Position along the width, in counts.
    pub x: Option<Bits>,
    /// Position along the height, in counts, growing toward the user.
    pub y: Option<Bits>,
    /// Tip switch.
    pub tip: Option<Bits>,
    /// The pen is in proximity.
    pub in_range: Option<Bits>,
    /// The pen is sensed, though too far away to be placed: a usage of Wacom's own page.
    pub sense: Option<Bits>,
    /// The pen is turned over: its eraser points down.
    pub invert: Option<Bits>,
    /// The eraser touches.
    pub eraser: Option<Bits>,
    /// Barrel buttons, the lower one first.
    pub barrel: [Option<Bits>; 3],
    /// What Huion's descriptors call a secondary tip switch: the second barrel button.
    pub secondary_tip: Option<Bits>,
    /// The upper half of the pen's number: a usage of Wacom's own page. Its pens with three buttons
    /// send the third as the first two together, unless there is a bit for it.
    pub serial: Option<Bits>,
    /// Tip pressure.
    pub pressure: Option<Bits>,
    /// Tilt along x and y.
    pub tilt: [Option<Bits>; 2],
    /// Rotation about the pen's own axis.
    pub twist: Option<Bits>,
    /// Height over the surface.
    pub distance: Option<Bits>,
    /// A field whose value names the one control that is pressed, as Waltop's tablets have.
    pub selector: Option<Selector>,
    /// The report is described as a mouse with absolute axes, not as a pen. Such a report is often
    /// what a tablet sends before a driver switches it over; its range then covers the whole area,
    /// whatever the size of the area.
    pub as_mouse: bool,
    /// The report has neither pressure nor proximity: an absolute pointer, which may be a pen, a
    /// touch screen or a virtual machine's mouse.
    pub bare: bool,
}

impl PenLayout {
    /// Adds an array field if it selects among the controls of a pen.
    pub(super) fn take_array(&mut self, f: &ArrayField) {
        let usages: Vec<u32> = f.usages().iter().map(u32::from).collect();
        let of_pen = |u: &u32| matches!(page_id(*u), (0x0d, 0x42 | 0x44 | 0x46 | 0x5a));
        if self.selector.is_none() && f.bits.len() <= 8 && usages.iter().any(of_pen) {
            let (min, max) = (i32::from(f.logical_minimum), i32::from(f.logical_maximum));
            let bits = Bits {
                start: f.bits.start,
                len: f.bits.len(),
                min: min.max(0),
                max,
                physical: None,
                unit: 0,
                exponent: 0,
            };
            self.selector = Some(Selector { bits, usages });
        }
    }

    /// Adds a field if its usage is one of a pen.
    pub(super) fn take(&mut self, f: &VariableField) {
        if f.is_relative() {
            return;
        }
        let keep = |slot: &mut Option<Bits>| {
            if slot.is_none() {
                *slot = Some(Bits::of(f));
            }
        };
        match page_id(u32::from(&f.usage)) {
            (0x01, 0x30) | (0xff0d, 0x130) => keep(&mut self.x),
            (0x01, 0x31) | (0xff0d, 0x131) => keep(&mut self.y),
            (0x01, 0x32) | (0xff0d, 0x132) => keep(&mut self.distance),
            (0xff0d, 0x36) => keep(&mut self.sense),
            (0xff0d, 0x5c) => keep(&mut self.serial),
            (0xff0d, 0x5d) => keep(&mut self.barrel[2]),
            // The kernel's HID-BPF programs describe the third button so (BTN_STYLUS3).
            (0x09, 0x4a) => keep(&mut self.barrel[2]),
            (0x0d | 0xff0d, id) => match id {
                0x30 => keep(&mut self.pressure),
                0x32 => keep(&mut self.in_range),
                0x3c => keep(&mut self.invert),
                0x3d => keep(&mut self.tilt[0]),
                0x3e => keep(&mut self.tilt[1]),
                0x41 => keep(&mut self.twist),
                0x42 => keep(&mut self.tip),
                0x43 => keep(&mut self.secondary_tip),
                0x44 => keep(&mut self.barrel[0]),
                0x45 => keep(&mut self.eraser),
                // Tablet pick is what the second button is called where there is no second barrel
                // switch (Linux `hid-uclogic`, `hid-kye`, `hid-waltop`).
                0x5a | 0x46 => keep(&mut self.barrel[1]),
                _ => {}
            },
            _ => {}
        }
    }
}

/// A pen that is described as a mouse with absolute axes and a pressure or an in-range bit, as old
/// tablets do: button 1 is the tip.
#[derive(Debug, Default)]
pub(super) struct AbsoluteMouse(PenLayout);

impl AbsoluteMouse {
    pub(super) fn take(&mut self, f: &VariableField) {
        if f.is_relative() {
            return;
        }
        match page_id(u32::from(&f.usage)) {
            (0x09, 1) => self.0.tip = Some(Bits::of(f)),
            (0x09, 2) => self.0.barrel[0] = Some(Bits::of(f)),
            (0x09, 3) => self.0.barrel[1] = Some(Bits::of(f)),
            _ => self.0.take(f),
        }
    }

    /// It has absolute axes of a tablet's resolution, or pressure or proximity.
    pub(super) fn is_pen(&self) -> bool {
        let fine = self.0.x.as_ref().is_some_and(|x| x.max >= LEAST_RANGE);
        self.0.x.is_some() && (fine || !self.is_bare())
    }

    /// Nothing but axes and buttons.
    pub(super) fn is_bare(&self) -> bool {
        self.0.pressure.is_none() && self.0.in_range.is_none()
    }

    pub(super) fn into_layout(self) -> PenLayout {
        self.0
    }
}
