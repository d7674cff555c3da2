//! Where pointers from C become references, and failures become numbers and a sentence.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use sculptd_geometry::boolean::BooleanError;
use sculptd_geometry::io::{ReadError, WriteError};
use sculptd_geometry::thickness::ThicknessError;

/// The outcome of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SculptdStatus {
    /// Success.
    Ok = 0,
    /// An argument is null, out of its range, or contradicts another.
    Argument = 1,
    /// A file could not be opened, read or written.
    Io = 2,
    /// A file is not what it claims; the message names the line or byte.
    Format = 3,
    /// An operand of a Boolean is open, inside out or crosses itself.
    Operand = 4,
    /// A device is of no known model, or of one that is left alone.
    Device = 5,
    /// A defect of this library.
    Defect = 6,
}

/// A failure: the number and the sentence.
#[derive(Debug)]
pub struct Failure(pub SculptdStatus, pub String);

impl Failure {
    /// A wrong argument.
    pub fn argument(text: impl Into<String>) -> Failure {
        Failure(SculptdStatus::Argument, text.into())
    }
}

impl From<ReadError> for Failure {
    fn from(e: ReadError) -> Self {
        let status = match e {
            ReadError::Format { .. } => SculptdStatus::Format,
            _ => SculptdStatus::Io,
        };
        Failure(status, e.to_string())
    }
}

impl From<WriteError> for Failure {
    fn from(e: WriteError) -> Self {
        let status = match e {
            WriteError::Io { .. } => SculptdStatus::Io,
            WriteError::Extension { .. } => SculptdStatus::Argument,
        };
        Failure(status, e.to_string())
    }
}

impl From<BooleanError> for Failure {
    fn from(e: BooleanError) -> Self {
        Failure(SculptdStatus::Operand, e.to_string())
    }
}

impl From<ThicknessError> for Failure {
    fn from(e: ThicknessError) -> Self {
        Failure::argument(e.to_string())
    }
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::new(CString::default());
}

/// Runs a function's body: a failure is kept for [`sculptd_error_message`], a panic ends here.
pub fn guarded(body: impl FnOnce() -> Result<(), Failure>) -> SculptdStatus {
    let defect = |_| {
        let text = "a defect of sculptd: an assertion failed; please report it";
        Err(Failure(SculptdStatus::Defect, text.into()))
    };
    let (status, text) = match catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(defect) {
        Ok(()) => (SculptdStatus::Ok, String::new()),
        Err(Failure(status, text)) => (status, text),
    };
    let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with(|m| *m.borrow_mut() = text);
    status
}

/// Returns the reason why this thread's last call that returns a SculptdStatus failed; empty if it
/// succeeded. Valid until the next such call of this thread.
#[unsafe(no_mangle)]
pub extern "C" fn sculptd_error_message() -> *const c_char {
    MESSAGE.with(|m| m.borrow().as_ptr())
}

/// The library's version, e.g. "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn sculptd_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(text) => text,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// The object behind a pointer that may be null.
///
/// # Safety
/// As [`reference`].
pub unsafe fn optional<'a, T>(p: *const T) -> Option<&'a T> {
    // SAFETY: as the caller promises.
    unsafe { p.as_ref() }
}

/// The place behind a pointer that may be null, to be written.
///
/// # Safety
/// As [`exclusive`].
pub unsafe fn optional_mut<'a, T>(p: *mut T) -> Option<&'a mut T> {
    // SAFETY: as the caller promises.
    unsafe { p.as_mut() }
}

/// The object behind a pointer.
///
/// # Safety
/// `p` is null or points to a `T` that no other thread changes while the reference lives.
pub unsafe fn reference<'a, T>(p: *const T, what: &str) -> Result<&'a T, Failure> {
    // SAFETY: not null by the check, else as the caller promises.
    unsafe { p.as_ref() }.ok_or_else(|| Failure::argument(format!("{what} is null")))
}

/// The object behind a pointer, to be changed.
///
/// # Safety
/// As [`reference`], and nobody else holds a reference to it.
pub unsafe fn exclusive<'a, T>(p: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: not null by the check, else as the caller promises.
    unsafe { p.as_mut() }.ok_or_else(|| Failure::argument(format!("{what} is null")))
}

/// `count` elements behind a pointer; null is good for none.
///
/// # Safety
/// `p` is null or points to `count` elements that nobody changes while the slice lives.
pub unsafe fn slice<'a, T>(p: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if p.is_null() || !p.is_aligned() || count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Failure::argument(format!("{what}: expected {count} elements")));
    }
    // SAFETY: aligned and not null by the check, of a size that fits, else as the caller promises.
    Ok(unsafe { std::slice::from_raw_parts(p, count) })
}

/// Writes `values` to the place behind a pointer, which may be uninitialised; none for none.
///
/// # Safety
/// `p` is null or points to room for as many elements that nobody else uses meanwhile.
pub unsafe fn copy_out<T: Copy>(values: &[T], p: *mut T, what: &str) -> Result<(), Failure> {
    if values.is_empty() {
        return Ok(());
    }
    if p.is_null() || !p.is_aligned() {
        let count = values.len();
        return Err(Failure::argument(format!("{what}: expected room for {count} elements")));
    }
    // SAFETY: aligned and not null by the check; the room and that nobody else uses it, so that
    // nothing overlaps, as the caller promises.
    unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), p, values.len()) };
    Ok(())
}

/// The text behind a pointer.
///
/// # Safety
/// `p` is null or points to bytes that end with a zero.
pub unsafe fn text<'a>(p: *const c_char, what: &str) -> Result<&'a CStr, Failure> {
    if p.is_null() {
        return Err(Failure::argument(format!("{what} is null")));
    }
    // SAFETY: not null by the check, ends with a zero as the caller promises.
    Ok(unsafe { CStr::from_ptr(p) })
}

/// The path behind a pointer: bytes on Unix, UTF-8 elsewhere.
///
/// # Safety
/// As [`text`].
pub unsafe fn path(p: *const c_char) -> Result<PathBuf, Failure> {
    // SAFETY: as the caller promises.
    let text = unsafe { text(p, "path") }?;
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        Ok(std::ffi::OsStr::from_bytes(text.to_bytes()).into())
    }
    #[cfg(not(unix))]
    {
        let text = text.to_str().map_err(|_| Failure::argument("path: expected UTF-8"))?;
        Ok(text.into())
    }
}

/// Hands an object out.
///
/// # Safety
/// `out` is null or points to a pointer that may be written.
pub unsafe fn hand_out<T>(out: *mut *mut T, value: T) -> Result<(), Failure> {
    // SAFETY: as the caller promises.
    let out = unsafe { exclusive(out, "the place for the result") }?;
    *out = Box::into_raw(Box::new(value));
    Ok(())
}

/// Takes an object back and drops it; null is good.
///
/// # Safety
/// `p` is null or came from [`hand_out`] and was not freed before.
pub unsafe fn take_back<T>(p: *mut T) {
    if !p.is_null() {
        // SAFETY: it came from `Box::into_raw` in `hand_out`, once, as the caller promises.
        drop(unsafe { Box::from_raw(p) });
    }
}
