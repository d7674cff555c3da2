//! Pen tablets across the boundary: reports in, samples out.

use std::ffi::{CString, c_char};

use sculptd_devices::catalogue::{Catalogue, Identification, Identity};
use sculptd_devices::hid::decoder::Decoder;
use sculptd_devices::{Body, DeviceId, Pen, Sample, Tool};

use crate::boundary::{
    Failure, SculptdStatus, copy_out, exclusive, guarded, hand_out, optional, reference, slice,
    take_back, text,
};

/// A pen tablet of a known model, and the state of its pen. One thread uses it at a time.
#[derive(Debug)]
pub struct SculptdTablet {
    decoder: Decoder,
    name: CString,
    area_mm: [f64; 2],
    /// Samples of one report, kept so that a report allocates nothing once it has grown.
    made: Vec<SculptdPenSample>,
}

/// The tool that touches or hovers.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SculptdTool {
    /// The tip of a pen.
    Pen = 0,
    /// The other end of a pen.
    Eraser = 1,
    /// A puck or mouse on the tablet.
    Mouse = 2,
    /// A finger.
    Touch = 3,
}

/// The whole state of a pen at one instant. What the tablet does not tell is NaN.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdPenSample {
    /// Microseconds on the caller's clock.
    pub t_us: u64,
    /// From the left edge of the active area, mm.
    pub x_mm: f32,
    /// From the top edge, mm, towards the user.
    pub y_mm: f32,
    /// 0 to 1.
    pub pressure: f32,
    /// Radians from the vertical, positive to the right.
    pub tilt_x: f32,
    /// Radians from the vertical, positive towards the user.
    pub tilt_y: f32,
    /// Radians about the pen's own axis, clockwise seen from above.
    pub twist: f32,
    /// Barrel buttons, bit 0 the lower one.
    pub buttons: u32,
    /// The tool that touches or hovers.
    pub tool: SculptdTool,
    /// True if the position is meaningful; false in the last sample of a visit.
    pub in_range: bool,
    /// True while the tip touches.
    pub tip: bool,
}

impl SculptdPenSample {
    fn of(t_us: u64, pen: &Pen) -> SculptdPenSample {
        let tilt = pen.tilt.map_or([f32::NAN; 2], |t| t.to_array());
        SculptdPenSample {
            t_us,
            x_mm: pen.pos_mm.x,
            y_mm: pen.pos_mm.y,
            pressure: pen.pressure.unwrap_or(f32::NAN),
            tilt_x: tilt[0],
            tilt_y: tilt[1],
            twist: pen.twist.unwrap_or(f32::NAN),
            buttons: pen.buttons,
            tool: match pen.tool {
                Tool::Pen => SculptdTool::Pen,
                Tool::Eraser => SculptdTool::Eraser,
                Tool::Mouse => SculptdTool::Mouse,
                Tool::Touch => SculptdTool::Touch,
            },
            in_range: pen.in_range,
            tip: pen.tip,
        }
    }
}

/// Finds the model of one interface of a device by its ids, its name and its report descriptor
/// (which may be null with a length of 0 where it is unknown), and makes its decoder.
/// SCULPTD_STATUS_DEVICE where it is of no known model; the message says why.
///
/// # Safety
/// `name` ends with a zero; `descriptor` has `length` bytes; `tablet` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_open(
    vendor: u16,
    product: u16,
    name: *const c_char,
    descriptor: *const u8,
    length: usize,
    tablet: *mut *mut SculptdTablet,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (name, descriptor) =
            unsafe { (text(name, "name")?, slice(descriptor, length, "descriptor")?) };
        let device = |text: String| Failure(SculptdStatus::Device, text);
        let catalogue = Catalogue::builtin().map_err(|e| device(e.to_string()))?;
        let who = Identity {
            vid: vendor,
            pid: product,
            name: name.to_string_lossy().into_owned(),
            descriptor: descriptor.to_vec(),
            ..Identity::default()
        };
        let found = match catalogue.identify(&who) {
            Identification::Identified(found) => found,
            Identification::Ambiguous(mut several) if !several.is_empty() => several.remove(0),
            Identification::Ambiguous(_) => return Err(device("no known model".into())),
            Identification::Declined(why) => return Err(device(why)),
        };
        let area = found.tablet.area;
        let made = SculptdTablet {
            decoder: Decoder::new(&found, descriptor, DeviceId(0)),
            name: CString::new(found.tablet.name.clone()).unwrap_or_default(),
            area_mm: [area.width_mm, area.height_mm],
            made: Vec::with_capacity(16),
        };
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(tablet, made) }
    })
}

/// The model's name; it lives as long as the tablet. Null for a null tablet.
///
/// # Safety
/// `tablet` is null or came from this library and was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_name(tablet: *const SculptdTablet) -> *const c_char {
    // SAFETY: as this function's caller promises.
    unsafe { optional(tablet) }.map_or(std::ptr::null(), |t| t.name.as_ptr())
}

/// The size of the active area, mm.
///
/// # Safety
/// `tablet` came from this library and was not freed; `width_mm` and `height_mm` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_area(
    tablet: *const SculptdTablet,
    width_mm: *mut f64,
    height_mm: *mut f64,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        unsafe {
            let size = reference(tablet, "tablet")?.area_mm;
            *exclusive(width_mm, "width_mm")? = size[0];
            *exclusive(height_mm, "height_mm")? = size[1];
        }
        Ok(())
    })
}

/// Reads one report, its id first where it has one, and writes the samples that it makes.
/// `count`: on entry the room in `samples`, on return how many were made. 16 is enough for every
/// known tablet; where more come than there is room for, the status is SCULPTD_STATUS_ARGUMENT, the
/// first ones are written, and the rest are lost.
///
/// # Safety
/// `tablet` came from this library and nobody else uses it now; `report` has `length` bytes;
/// `samples` has room for `*count`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_report(
    tablet: *mut SculptdTablet,
    report: *const u8,
    length: usize,
    t_us: u64,
    samples: *mut SculptdPenSample,
    count: *mut usize,
) -> SculptdStatus {
    // SAFETY: as this function's caller promises.
    unsafe {
        each(tablet, samples, count, |decoder, emit| {
            decoder.feed(slice(report, length, "report")?, t_us, emit);
            Ok(())
        })
    }
}

/// Lets time pass: a tablet that says nothing when its pen leaves has its visit ended after a
/// silence. Call it a few times a second while no report comes; otherwise as
/// sculptd_tablet_report().
///
/// # Safety
/// As sculptd_tablet_report().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_tick(
    tablet: *mut SculptdTablet,
    t_us: u64,
    samples: *mut SculptdPenSample,
    count: *mut usize,
) -> SculptdStatus {
    // SAFETY: as this function's caller promises.
    unsafe {
        each(tablet, samples, count, |decoder, emit| {
            decoder.tick(t_us, emit);
            Ok(())
        })
    }
}

/// # Safety
/// As [`sculptd_tablet_report`].
unsafe fn each(
    tablet: *mut SculptdTablet,
    samples: *mut SculptdPenSample,
    count: *mut usize,
    feed: impl FnOnce(&mut Decoder, &mut dyn FnMut(Sample)) -> Result<(), Failure>,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as the caller promises.
        let (tablet, count) = unsafe { (exclusive(tablet, "tablet")?, exclusive(count, "count")?) };
        let capacity = std::mem::take(count);
        let SculptdTablet { decoder, made, .. } = tablet;
        made.clear();
        feed(decoder, &mut |sample| {
            if let Body::Pen(pen) = &sample.body {
                made.push(SculptdPenSample::of(sample.t_us, pen));
            }
        })?;
        let fits = made.len().min(capacity);
        // SAFETY: no more than the room that the caller states.
        unsafe { copy_out(&made[..fits], samples, "samples") }?;
        *count = fits;
        if fits < made.len() {
            let text = format!("{} samples came: there was room for {capacity}", made.len());
            return Err(Failure::argument(text));
        }
        Ok(())
    })
}

/// Frees a tablet; null is good.
///
/// # Safety
/// `tablet` is null or came from this library, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_tablet_free(tablet: *mut SculptdTablet) {
    // SAFETY: as this function's caller promises.
    unsafe { take_back(tablet) }
}
