//! Bytes out and in: variable-length integers (LEB128), zigzag for signed ones, and lengths that
//! are checked before anything is allocated.

/// The bytes are not those of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not those of a message")]
pub struct BadBytes;

/// Appends an unsigned integer, seven bits a byte.
pub fn put_number(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Appends a signed integer: small magnitudes take one byte.
pub fn put_signed(out: &mut Vec<u8>, value: i64) {
    put_number(out, ((value << 1) ^ (value >> 63)) as u64);
}

/// Appends a length and the bytes.
pub fn put_bytes(out: &mut Vec<u8>, bytes: &[u8]) {
    put_number(out, bytes.len() as u64);
    out.extend_from_slice(bytes);
}

/// Reads what the functions above wrote; never reads beyond the end.
#[derive(Debug, Clone, Copy)]
pub struct ByteReader<'a>(&'a [u8]);

impl<'a> ByteReader<'a> {
    /// Reads from the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        ByteReader(bytes)
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.0.len()
    }

    /// One byte.
    ///
    /// # Errors
    /// [`BadBytes`] at the end.
    pub fn byte(&mut self) -> Result<u8, BadBytes> {
        let (first, rest) = self.0.split_first().ok_or(BadBytes)?;
        self.0 = rest;
        Ok(*first)
    }

    /// An unsigned integer.
    ///
    /// # Errors
    /// [`BadBytes`] at the end, and where it has more than 64 bits.
    pub fn number(&mut self) -> Result<u64, BadBytes> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if shift == 63 && bits > 1 {
                return Err(BadBytes);
            }
            value |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(BadBytes)
    }

    /// An unsigned integer of at most `most`.
    ///
    /// # Errors
    /// [`BadBytes`] where it is larger.
    pub fn at_most(&mut self, most: u64) -> Result<u64, BadBytes> {
        self.number().and_then(|n| if n <= most { Ok(n) } else { Err(BadBytes) })
    }

    /// Reads the number of entries that follow. Each takes at least a byte, so it cannot exceed the
    /// bytes left.
    ///
    /// # Errors
    /// [`BadBytes`] if the number exceeds the bytes left, or `most`.
    pub fn count(&mut self, most: usize) -> Result<usize, BadBytes> {
        let most = most.min(self.left());
        self.at_most(most as u64).map(|n| n as usize)
    }

    /// A signed integer.
    ///
    /// # Errors
    /// [`BadBytes`] as of [`ByteReader::number`].
    pub fn signed(&mut self) -> Result<i64, BadBytes> {
        let n = self.number()?;
        Ok((n >> 1) as i64 ^ -((n & 1) as i64))
    }

    /// So many bytes.
    ///
    /// # Errors
    /// [`BadBytes`] where there are fewer.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], BadBytes> {
        let (bytes, rest) = self.0.split_at_checked(count).ok_or(BadBytes)?;
        self.0 = rest;
        Ok(bytes)
    }

    /// All bytes that are left.
    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }

    /// So many bytes, as an array.
    ///
    /// # Errors
    /// [`BadBytes`] where there are fewer.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], BadBytes> {
        self.take(N).and_then(|b| b.try_into().map_err(|_| BadBytes))
    }

    /// A length of at most `most`, and so many bytes.
    ///
    /// # Errors
    /// [`BadBytes`] where it is longer, or fewer follow.
    pub fn bytes(&mut self, most: usize) -> Result<&'a [u8], BadBytes> {
        let length = self.at_most(most as u64)?;
        self.take(length as usize)
    }

    /// A text of at most `most` bytes.
    ///
    /// # Errors
    /// [`BadBytes`] where it is longer or no UTF-8.
    pub fn text(&mut self, most: usize) -> Result<String, BadBytes> {
        let bytes = self.bytes(most)?;
        std::str::from_utf8(bytes).map(String::from).map_err(|_| BadBytes)
    }

    /// # Errors
    /// [`BadBytes`] where bytes are left.
    pub fn end(&self) -> Result<(), BadBytes> {
        if self.0.is_empty() { Ok(()) } else { Err(BadBytes) }
    }
}
