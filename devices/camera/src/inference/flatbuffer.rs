//! Reads FlatBuffers, the container of `.tflite` files, without trusting a byte of them: every
//! offset is checked against the file's length.

/// Why a file is not a valid model.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// An offset leads out of the file.
    #[error("byte {0}: an offset leads out of the file")]
    Truncated(usize),
    /// The model uses something that this program does not compute.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// The parts of the model contradict each other.
    #[error("{0}")]
    Inconsistent(String),
}

/// A table in a FlatBuffer.
#[derive(Debug, Clone, Copy)]
pub struct FlatTable<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// Most elements of one vector; the largest weight buffer of the hand models has 0.5 million bytes.
const MAX_ELEMENTS: usize = 1 << 26;

fn read<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], ModelError> {
    let piece = bytes.get(at..at.saturating_add(N)).and_then(|b| <[u8; N]>::try_from(b).ok());
    piece.ok_or(ModelError::Truncated(at))
}

fn offset(bytes: &[u8], at: usize) -> Result<usize, ModelError> {
    let by = u32::from_le_bytes(read(bytes, at)?) as usize;
    at.checked_add(by).filter(|to| *to < bytes.len()).ok_or(ModelError::Truncated(at))
}

impl<'a> FlatTable<'a> {
    /// Returns the root table of a file.
    ///
    /// # Errors
    /// Returns an error if the file is shorter than its root offset says.
    pub fn root(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Ok(FlatTable { bytes, at: offset(bytes, 0)? })
    }

    /// Returns the position of a field, or `None` if it has its default.
    fn field(&self, index: usize) -> Result<Option<usize>, ModelError> {
        let back = i32::from_le_bytes(read(self.bytes, self.at)?) as i64;
        let vtable =
            usize::try_from(self.at as i64 - back).map_err(|_| ModelError::Truncated(self.at))?;
        let size = u16::from_le_bytes(read(self.bytes, vtable)?) as usize;
        if 4 + 2 * index + 2 > size {
            return Ok(None);
        }
        let by = u16::from_le_bytes(read(self.bytes, vtable + 4 + 2 * index)?) as usize;
        Ok((by > 0).then_some(self.at + by))
    }

    /// Returns a byte field; 0 if it is absent.
    ///
    /// # Errors
    /// Returns an error if the field lies outside the file; so do all methods below.
    pub fn byte(&self, index: usize) -> Result<u8, ModelError> {
        match self.field(index)? {
            Some(at) => Ok(u8::from_le_bytes(read(self.bytes, at)?)),
            None => Ok(0),
        }
    }

    /// Returns a 32-bit field; `default` if it is absent.
    pub fn int(&self, index: usize, default: i32) -> Result<i32, ModelError> {
        match self.field(index)? {
            Some(at) => Ok(i32::from_le_bytes(read(self.bytes, at)?)),
            None => Ok(default),
        }
    }

    /// Returns a table field.
    pub fn table(&self, index: usize) -> Result<Option<FlatTable<'a>>, ModelError> {
        let at = self.field(index)?;
        at.map(|at| Ok(FlatTable { bytes: self.bytes, at: offset(self.bytes, at)? })).transpose()
    }

    /// Returns the first element's position and the length of a vector field.
    fn vector(&self, index: usize, element: usize) -> Result<(usize, usize), ModelError> {
        let Some(at) = self.field(index)? else { return Ok((0, 0)) };
        let at = offset(self.bytes, at)?;
        let length = u32::from_le_bytes(read(self.bytes, at)?) as usize;
        let end = at + 4 + length.min(MAX_ELEMENTS) * element;
        if length > MAX_ELEMENTS || end > self.bytes.len() {
            return Err(ModelError::Truncated(at));
        }
        Ok((at + 4, length))
    }

    /// Returns a vector of tables.
    pub fn tables(&self, index: usize) -> Result<Vec<FlatTable<'a>>, ModelError> {
        let (from, length) = self.vector(index, 4)?;
        let table = |i| Ok(FlatTable { bytes: self.bytes, at: offset(self.bytes, from + 4 * i)? });
        (0..length).map(table).collect()
    }

    /// Returns a vector of 32-bit numbers.
    pub fn ints(&self, index: usize) -> Result<Vec<i32>, ModelError> {
        let (from, length) = self.vector(index, 4)?;
        (0..length).map(|i| Ok(i32::from_le_bytes(read(self.bytes, from + 4 * i)?))).collect()
    }

    /// Returns a vector of bytes.
    pub fn bytes(&self, index: usize) -> Result<&'a [u8], ModelError> {
        let (from, length) = self.vector(index, 1)?;
        Ok(self.bytes.get(from..from + length).unwrap_or_default())
    }
}
