//! An adaptive binary range coder (Martin 1979, with the carry of LZMA by Pavlov): an expected bit
//! costs a fraction of a bit. One description serves both directions: a function over [`Coder`]
//! writes with an [`Encoder`] and reads with a [`Decoder`].
//!
//! Probabilities learn quickly at first (each new bit weighs as much as all before it together
//! would in an estimate by counting, Krichevsky and Trofimov 1981), as a message is short, and
//! nothing is kept from one message to the next, as any may be lost.

use super::bytes::{BadBytes, ByteReader, put_bytes};

/// The probability that a bit is 0, of 65536, and how often it was seen.
#[derive(Debug, Clone, Copy)]
pub struct BitModel {
    zero: u16,
    seen: u16,
}

/// A bit that is nearly sure costs this much at least: 1/90 of a bit.
const LEAST: i32 = 500;
/// From so many bits on all weigh alike.
const SLOWEST: u16 = 24;

impl BitModel {
    /// Knows nothing yet.
    pub const EVEN: BitModel = BitModel { zero: 1 << 15, seen: 0 };
    /// Is rarely 1.
    pub const RARE: BitModel = BitModel { zero: 62_000, seen: 6 };

    fn learn(&mut self, bit: bool) {
        let target = if bit { 0 } else { 1 << 16 };
        let step = (target - i32::from(self.zero)) * 2 / (2 * i32::from(self.seen) + 3);
        self.zero = (i32::from(self.zero) + step).clamp(LEAST, (1 << 16) - LEAST) as u16;
        self.seen = (self.seen + 1).min(SLOWEST);
    }
}

/// Integers by their length in bits: the length is modelled, and the bit below the first.
#[derive(Debug, Clone)]
pub struct NumberModel {
    lengths: [BitModel; 33],
    seconds: [BitModel; 33],
    sign: BitModel,
}

impl Default for NumberModel {
    fn default() -> Self {
        let even = [BitModel::EVEN; 33];
        NumberModel { lengths: even, seconds: even, sign: BitModel::EVEN }
    }
}

/// One direction of a coder. A writer is given what is to be written and gives it back; a reader
/// ignores what it is given.
pub trait Coder {
    /// One bit.
    ///
    /// # Errors
    /// [`BadBytes`] beyond the end.
    fn bit(&mut self, model: &mut BitModel, bit: bool) -> Result<bool, BadBytes>;

    /// Bytes that are not compressed, of at most `most`; a writer gives nothing back.
    ///
    /// # Errors
    /// [`BadBytes`] beyond the end.
    fn bytes(&mut self, bytes: &[u8], most: usize) -> Result<Vec<u8>, BadBytes>;

    /// The `count` low bits of a number, without a model.
    ///
    /// # Errors
    /// [`BadBytes`] beyond the end.
    fn bits(&mut self, value: u64, count: u32) -> Result<u64, BadBytes> {
        let mut read = 0;
        for k in (0..count).rev() {
            let mut even = BitModel::EVEN;
            read = read << 1 | u64::from(self.bit(&mut even, value >> k & 1 != 0)?);
        }
        Ok(read)
    }

    /// A number of at most 32 bits.
    ///
    /// # Errors
    /// [`BadBytes`] beyond the end.
    fn number(&mut self, model: &mut NumberModel, value: u32) -> Result<u32, BadBytes> {
        let length = 32 - value.leading_zeros();
        let mut read = 0;
        while read < 32 && self.bit(&mut model.lengths[read as usize], read < length)? {
            read += 1;
        }
        if read < 2 {
            return Ok(read);
        }
        let shift = read - 2;
        let second = self.bit(&mut model.seconds[read as usize], value >> shift & 1 != 0)?;
        let rest = self.bits(u64::from(value), shift)? as u32;
        Ok((0b10 | u32::from(second)) << shift | rest)
    }

    /// A number with a sign, its magnitude below 2³¹.
    ///
    /// # Errors
    /// [`BadBytes`] beyond the end.
    fn signed(&mut self, model: &mut NumberModel, value: i32) -> Result<i32, BadBytes> {
        let magnitude = self.number(model, value.unsigned_abs())?;
        if magnitude == 0 {
            return Ok(0);
        }
        let magnitude = i32::try_from(magnitude).map_err(|_| BadBytes)?;
        let negative = self.bit(&mut model.sign, value < 0)?;
        Ok(if negative { -magnitude } else { magnitude })
    }
}

/// Writes.
#[derive(Debug)]
pub struct Encoder {
    low: u64,
    range: u32,
    cache: u8,
    pending: usize,
    coded: Vec<u8>,
    plain: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        let (coded, plain) = (Vec::new(), Vec::new());
        Encoder { low: 0, range: u32::MAX, cache: 0, pending: 0, coded, plain }
    }
}

impl Encoder {
    fn shift(&mut self) {
        if (self.low as u32) < 0xff00_0000 || self.low >> 32 != 0 {
            let carry = (self.low >> 32) as u8;
            self.coded.push(self.cache.wrapping_add(carry));
            for _ in 0..std::mem::take(&mut self.pending) {
                self.coded.push(0xff_u8.wrapping_add(carry));
            }
            self.cache = (self.low >> 24) as u8;
        } else {
            self.pending += 1;
        }
        self.low = (self.low & 0x00ff_ffff) << 8;
    }

    /// Appends what was written: the coded bytes with their length, then the plain ones.
    pub fn finish(mut self, out: &mut Vec<u8>) {
        // Of all numbers within the range, the one with most zeros at its end, which are not sent.
        let end = self.low + u64::from(self.range);
        for bits in (0..=24).rev() {
            let mask = (1u64 << bits) - 1;
            let value = (self.low + mask) & !mask;
            if value < end {
                self.low = value;
                break;
            }
        }
        (0..5).for_each(|_| self.shift());
        // The first byte is the whole part of a number below one.
        let mut coded = &self.coded[1..];
        for _ in 0..4 {
            coded = coded.strip_suffix(&[0]).unwrap_or(coded);
        }
        put_bytes(out, coded);
        out.extend(&self.plain);
    }
}

impl Coder for Encoder {
    fn bit(&mut self, model: &mut BitModel, bit: bool) -> Result<bool, BadBytes> {
        let bound = (self.range >> 16) * u32::from(model.zero);
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        model.learn(bit);
        while self.range < 1 << 24 {
            self.range <<= 8;
            self.shift();
        }
        Ok(bit)
    }

    fn bytes(&mut self, bytes: &[u8], _most: usize) -> Result<Vec<u8>, BadBytes> {
        put_bytes(&mut self.plain, bytes);
        Ok(Vec::new())
    }
}

/// Reads.
#[derive(Debug)]
pub struct Decoder<'a> {
    range: u32,
    code: u32,
    coded: &'a [u8],
    /// Bytes that were read beyond the end: zeros that were not sent.
    beyond: usize,
    plain: ByteReader<'a>,
}

impl<'a> Decoder<'a> {
    /// Reads what [`Encoder::finish`] wrote, up to the end of the bytes.
    ///
    /// # Errors
    /// [`BadBytes`] where there is less.
    pub fn new(mut bytes: ByteReader<'a>) -> Result<Decoder<'a>, BadBytes> {
        let coded = bytes.bytes(bytes.left())?;
        let mut decoder = Decoder { range: u32::MAX, code: 0, coded, beyond: 0, plain: bytes };
        for _ in 0..4 {
            decoder.code = decoder.code << 8 | u32::from(decoder.next()?);
        }
        Ok(decoder)
    }

    fn next(&mut self) -> Result<u8, BadBytes> {
        if let Some((first, rest)) = self.coded.split_first() {
            self.coded = rest;
            return Ok(*first);
        }
        self.beyond += 1;
        if self.beyond > 4 { Err(BadBytes) } else { Ok(0) }
    }

    /// # Errors
    /// [`BadBytes`] where bytes are left.
    pub fn end(&self) -> Result<(), BadBytes> {
        if self.coded.is_empty() { self.plain.end() } else { Err(BadBytes) }
    }
}

impl Coder for Decoder<'_> {
    fn bit(&mut self, model: &mut BitModel, _bit: bool) -> Result<bool, BadBytes> {
        let bound = (self.range >> 16) * u32::from(model.zero);
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        model.learn(bit);
        while self.range < 1 << 24 {
            self.range <<= 8;
            self.code = self.code << 8 | u32::from(self.next()?);
        }
        Ok(bit)
    }

    fn bytes(&mut self, _bytes: &[u8], most: usize) -> Result<Vec<u8>, BadBytes> {
        self.plain.bytes(most).map(<[u8]>::to_vec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all(c: &mut impl Coder, values: &[(u32, i32, bool)]) -> Vec<(u32, i32, bool)> {
        let (mut a, mut b, mut rare) =
            (NumberModel::default(), NumberModel::default(), BitModel::RARE);
        let mut one = |&(n, s, flag): &(u32, i32, bool)| {
            let n = c.number(&mut a, n)?;
            let s = c.signed(&mut b, s)?;
            Ok::<_, BadBytes>((n, s, c.bit(&mut rare, flag)?))
        };
        values.iter().map_while(|v| one(v).ok()).collect()
    }

    fn coded(values: &[(u32, i32, bool)]) -> Vec<u8> {
        let (mut encoder, mut out) = (Encoder::default(), Vec::new());
        all(&mut encoder, values);
        encoder.finish(&mut out);
        out
    }

    proptest! {
        #[test]
        fn numbers_come_back(
            values in proptest::collection::vec(
                (any::<u32>(), -0x7fff_ffff_i32..=0x7fff_ffff, any::<bool>()), 0..200),
            shift in 0u32..31,
        ) {
            let small = values.iter().map(|v| (v.0 >> shift, v.1 >> shift, v.2 && shift > 20));
            let small: Vec<_> = small.collect();
            let bytes = coded(&small);
            let mut decoder = Decoder::new(ByteReader::new(&bytes)).expect("whole");
            prop_assert_eq!(all(&mut decoder, &small), small);
            prop_assert_eq!(decoder.end(), Ok(()));
        }
    }

    #[test]
    fn what_is_expected_costs_next_to_nothing_and_no_message_goes_on_for_ever() {
        let same = vec![(3, 0, false); 2000];
        let bytes = coded(&same);
        assert!(bytes.len() < 60 + 2000 / 8, "{} bytes", bytes.len());
        let mut decoder = Decoder::new(ByteReader::new(&bytes)).expect("whole");
        let more = vec![(0, 0, false); 1_000_000];
        let read = all(&mut decoder, &more).len();
        assert!((2000..4000).contains(&read), "{read} read");
    }
}
