//! Numbers and lines of text formats, at the speed of the memory rather than of a general parser.

use super::problem::{FilePlace, FileProblem, excerpt};

const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// A decimal number, correctly rounded. The common case (up to 19 digits whose value is under 2^53,
/// and a small exponent) is one exact multiplication or division (Clinger 1990); all else goes to
/// the standard library. "nan" and "inf" are numbers here: the caller says why they are refused.
#[inline]
pub(super) fn float(token: &[u8]) -> Option<f64> {
    let (negative, digits) = match token.first()? {
        b'-' => (true, &token[1..]),
        b'+' => (false, &token[1..]),
        _ => (false, token),
    };
    let (mut mantissa, mut scale, mut seen, mut i) = (0u64, 0i32, 0, 0);
    while let Some(&b) = digits.get(i)
        && b.is_ascii_digit()
    {
        mantissa = mantissa.wrapping_mul(10).wrapping_add((b - b'0') as u64);
        seen += 1;
        i += 1;
    }
    if digits.get(i) == Some(&b'.') {
        i += 1;
        while let Some(&b) = digits.get(i)
            && b.is_ascii_digit()
        {
            mantissa = mantissa.wrapping_mul(10).wrapping_add((b - b'0') as u64);
            seen += 1;
            scale -= 1;
            i += 1;
        }
    }
    if seen == 0 || seen > 19 {
        return slow(token);
    }
    if let Some(b'e' | b'E') = digits.get(i) {
        let power = integer(&digits[i + 1..])?;
        if power.abs() > 400 {
            return slow(token);
        }
        scale += power as i32;
        i = digits.len();
    }
    if i != digits.len() {
        return slow(token);
    }
    if mantissa >= 1 << 53 || scale.abs() > 22 {
        return slow(token);
    }
    let value = mantissa as f64;
    let value =
        if scale < 0 { value / POWERS[-scale as usize] } else { value * POWERS[scale as usize] };
    Some(if negative { -value } else { value })
}

#[cold]
fn slow(token: &[u8]) -> Option<f64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// A whole number with an optional sign.
#[inline]
pub(super) fn integer(token: &[u8]) -> Option<i64> {
    let (negative, digits) = match token.first()? {
        b'-' => (true, &token[1..]),
        b'+' => (false, &token[1..]),
        _ => (false, token),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0i64;
    for &b in digits {
        if !b.is_ascii_digit() {
            return None;
        }
        value = value * 10 + (b - b'0') as i64;
    }
    Some(if negative { -value } else { value })
}

/// Returns what is wrong with a coordinate, if anything. It must fit single precision, which clay
/// uses. (Real files hold boxes of 3.4e38 a side, meant as half spaces.)
#[inline]
pub(super) fn refuse(value: f64) -> Option<&'static str> {
    if (value as f32).is_finite() {
        None
    } else if value.is_nan() {
        Some("NaN")
    } else {
        Some("a coordinate beyond 3.4e38")
    }
}

/// The tokens of a piece of text, with the offset kept for messages.
#[derive(Debug, Clone)]
pub(super) struct TextCursor<'a> {
    pub text: &'a [u8],
    pub at: usize,
}

impl<'a> TextCursor<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        TextCursor { text, at: 0 }
    }

    /// The next word on this line; `None` at the line's end, which is not passed.
    #[inline]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        while let Some(b' ' | b'\t' | b'\r' | 0x0b | 0x0c) = self.text.get(self.at) {
            self.at += 1;
        }
        let start = self.at;
        while let Some(&b) = self.text.get(self.at)
            && b > b' '
        {
            self.at += 1;
        }
        if self.at == start {
            // Another control character stands for itself, so that every call moves or ends.
            if matches!(self.text.get(self.at), None | Some(b'\n')) {
                return None;
            }
            self.at += 1;
        }
        Some(&self.text[start..self.at])
    }

    /// Returns the next word on this line or a later one; `#` starts a comment if `comments` is
    /// set.
    #[inline]
    pub(super) fn word_anywhere(&mut self, comments: bool) -> Option<&'a [u8]> {
        loop {
            match self.word() {
                Some(w) if comments && w[0] == b'#' => {
                    self.skip_line();
                }
                Some(w) => return Some(w),
                None if self.at >= self.text.len() => return None,
                None => self.at += 1,
            }
        }
    }

    /// To the next word, on this line or a later one.
    pub(super) fn skip_blanks(&mut self) {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    /// To the start of the next line.
    #[inline]
    pub(super) fn skip_line(&mut self) {
        self.at = match memchr::memchr(b'\n', self.text.get(self.at..).unwrap_or_default()) {
            Some(n) => self.at + n + 1,
            None => self.text.len(),
        };
    }

    pub(super) fn ended(&self) -> bool {
        self.at >= self.text.len()
    }
}

/// The 1-based line of an offset.
pub(super) fn line_of(text: &[u8], at: usize) -> u64 {
    memchr::memchr_iter(b'\n', &text[..at.min(text.len())]).count() as u64 + 1
}

/// The problem that at `at` of `text` something else was expected; shows the line from there, or
/// what `word` is.
#[cold]
pub(super) fn unexpected(text: &[u8], at: usize, expected: impl Into<String>) -> FileProblem {
    let rest = text.get(at..).unwrap_or_default();
    let found = if rest.is_empty() { "the end of the file".to_string() } else { excerpt(rest) };
    FileProblem::new(FilePlace::Line(line_of(text, at)), expected.into(), found)
}

/// Pieces of about `size` bytes that end after a line's end; a line that ends in a backslash goes
/// on.
pub(super) fn pieces(text: &[u8], size: usize) -> Vec<(usize, usize)> {
    let mut out = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let mut end = (start + size).min(text.len());
        loop {
            match memchr::memchr(b'\n', &text[end..]) {
                None => {
                    end = text.len();
                    break;
                }
                Some(n) => {
                    let stop = end + n;
                    end = stop + 1;
                    let body = &text[start..stop];
                    let body = body.strip_suffix(b"\r").unwrap_or(body);
                    if body.last() != Some(&b'\\') {
                        break;
                    }
                }
            }
        }
        out.push((start, end));
        start = end;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        for t in [
            "0",
            "-0",
            "1",
            "-1.5",
            "+2.25",
            ".5",
            "5.",
            "1e3",
            "1E-3",
            "-1.2345678901234567e-300",
            "1e400",
            "123456789012345678901234567890",
            "0.1",
            "3.141592653589793",
            "9007199254740993",
            "1.7976931348623157e308",
            "4.9e-324",
            "0.000000000000000000000001",
            "1e22",
            "1e23",
            "12345678e15",
            "nan",
            "inf",
            "-inf",
            "0.30000000000000004",
        ] {
            let want: f64 = t.parse().unwrap();
            assert_eq!(float(t.as_bytes()).map(f64::to_bits), Some(want.to_bits()), "{t}");
        }
        for t in ["", "-", "+", ".", "1e", "1e+", "1.2.3", "0x10", "1,5", "e5", "--1", "1e5x"] {
            assert_eq!(float(t.as_bytes()), None, "{t}");
        }
    }

    #[test]
    fn random_numbers_are_those_of_the_standard_library() {
        let mut s = 1u64;
        for _ in 0..20_000 {
            s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let v = f64::from_bits(s);
            if v.is_finite() {
                for t in [
                    format!("{v}"),
                    format!("{v:e}"),
                    format!("{:.6}", v % 1e6),
                    format!("{}", v as f32),
                ] {
                    assert_eq!(float(t.as_bytes()), t.parse().ok(), "{t}");
                }
            }
        }
    }

    #[test]
    fn pieces_cover_the_text_and_never_cut_a_continued_line() {
        let text = b"a b\nc \\\n d\r\ne \\\r\n f\ng";
        for size in 1..text.len() + 2 {
            let p = pieces(text, size);
            assert_eq!(p[0].0, 0);
            assert_eq!(p.last().unwrap().1, text.len());
            for w in p.windows(2) {
                assert_eq!(w[0].1, w[1].0);
                assert!(!text[..w[0].1].ends_with(b"\\\n") && !text[..w[0].1].ends_with(b"\\\r\n"));
            }
        }
    }
}
