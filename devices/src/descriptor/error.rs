//! Why a report descriptor is refused.

/// Why a report descriptor is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DescriptorError {
    /// No bytes at all: the platform does not show the descriptor.
    #[error("the report descriptor is empty")]
    Empty,
    /// More bytes than Linux accepts.
    #[error("the report descriptor has {0} bytes, more than 4096")]
    TooLong(usize),
    /// A size, a count or a range of usages that no device can have, at this byte.
    #[error("the report descriptor declares an absurd size at byte {0}")]
    Absurd(usize),
    /// The items cannot be parsed; the text says why.
    #[error("the report descriptor cannot be read: {0}")]
    Bad(String),
}
