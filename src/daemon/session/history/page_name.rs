//! What a page's version is called in the file.

/// The number of the clay, of the page, and the revision that wrote the page.
pub type Name = (u32, u32, u64);

/// The revision of a page that was not there yet.
pub const NOTHING: u64 = u64::MAX;
