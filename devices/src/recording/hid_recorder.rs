//! The text that the `hid-recorder` tool writes (hid-tools): `D:` device number, `R:` descriptor,
//! `N:` name, `P:` place, `I:` bus and ids, `E:` a stamped report. Also read: `# USB-STRING S index
//! bytes`, raw string descriptors by index.

use super::{HidRecording, Stamped};
use crate::catalogue::Identity;
use crate::tablet::hex_bytes;

/// Most interfaces in one file, and most bytes in one report.
const MAX_INTERFACES: usize = 64;
const MAX_REPORT: usize = 4096;

/// A line that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadLine {
    /// Number of the line, from 1.
    pub line: usize,
    /// The fault, and the expected content.
    pub what: String,
}

/// Reads a whole file. An unfinished last line that cannot be read was cut off: it is left out, and
/// [`HidRecording::cut_at`] reports it.
///
/// # Errors
/// Any other line that cannot be read, or a file without a descriptor and without a report.
pub fn parse(text: &str) -> Result<HidRecording, BadLine> {
    let mut reader = LineReader::default();
    let unended = (!text.ends_with('\n')).then(|| text.lines().count());
    for (i, line) in text.lines().enumerate() {
        let unfinished = !line.contains(':') && !line.starts_with('#') && !line.trim().is_empty();
        match reader.line(line.trim()) {
            Ok(()) if unended == Some(i + 1) && unfinished && reader.described => {
                reader.out.cut_at = Some(i + 1);
            }
            Ok(()) => {}
            Err(_) if unended == Some(i + 1) && reader.described => {
                reader.out.cut_at = Some(i + 1);
            }
            Err(what) => return Err(BadLine { line: i + 1, what }),
        }
    }
    if !reader.described {
        return Err(BadLine {
            line: 1,
            what: "no `R:` or `E:` line: not a hid-recorder file".to_owned(),
        });
    }
    Ok(reader.finish())
}

#[derive(Default)]
struct LineReader {
    out: HidRecording,
    /// Device number of each interface, in order of appearance.
    numbers: Vec<u32>,
    current: Option<usize>,
    strings: Vec<(u8, Vec<u8>)>,
    first_us: Option<u64>,
    last_us: u64,
    /// Added where a file's stamps begin again.
    shift_us: u64,
    described: bool,
}

impl LineReader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let Some((tag, rest)) = line.split_once(':').filter(|(tag, _)| tag.len() == 1) else {
            if let Some(rest) = line.strip_prefix("# USB-STRING S ") {
                self.usb_string(rest);
            }
            return Ok(());
        };
        let rest = rest.trim();
        match tag {
            "D" => {
                let n = rest
                    .parse::<u32>()
                    .map_err(|_| format!("`D: {rest}`: expected a device number"))?;
                self.select(n)?;
            }
            "R" => self.here()?.descriptor = counted(rest)?,
            "N" => self.here()?.name = rest.to_owned(),
            "P" => {
                self.here()?.interface =
                    rest.rsplit_once("/input").and_then(|(_, n)| n.parse().ok())
            }
            "I" => self.ids(rest)?,
            "E" => self.event(rest)?,
            _ => return Ok(()),
        }
        self.described |= matches!(tag, "R" | "E");
        Ok(())
    }

    fn select(&mut self, n: u32) -> Result<(), String> {
        let at = match self.numbers.iter().position(|&known| known == n) {
            Some(at) => at,
            None if self.numbers.len() >= MAX_INTERFACES => {
                return Err(format!("more than {MAX_INTERFACES} devices in one recording"));
            }
            None => {
                self.numbers.push(n);
                self.out.interfaces.push(Identity::default());
                self.numbers.len() - 1
            }
        };
        self.current = Some(at);
        Ok(())
    }

    fn here(&mut self) -> Result<&mut Identity, String> {
        if self.current.is_none() {
            self.select(0)?;
        }
        let at = self.current.unwrap_or(0);
        Ok(&mut self.out.interfaces[at])
    }

    fn ids(&mut self, rest: &str) -> Result<(), String> {
        let parts: Vec<&str> = rest.split_whitespace().collect();
        let [_, vid, pid] = parts[..] else {
            return Err(format!("`I: {rest}`: expected bus, vendor and product"));
        };
        let hex = |s: &str| {
            u16::from_str_radix(s, 16)
                .map_err(|_| format!("`{s}`: expected four hexadecimal digits"))
        };
        let (vid, pid) = (hex(vid)?, hex(pid)?);
        let here = self.here()?;
        (here.vid, here.pid) = (vid, pid);
        Ok(())
    }

    fn event(&mut self, rest: &str) -> Result<(), String> {
        let (stamp, bytes) =
            rest.split_once(char::is_whitespace).ok_or("expected a stamp, a count and bytes")?;
        let t = micros(stamp).ok_or_else(|| format!("`{stamp}`: expected seconds"))?;
        let bytes = counted(bytes)?;
        if bytes.len() > MAX_REPORT {
            return Err(format!("a report of {} bytes: more than {MAX_REPORT}", bytes.len()));
        }
        let first = *self.first_us.get_or_insert(t);
        let mut t = t.saturating_sub(first).saturating_add(self.shift_us);
        if t < self.last_us {
            self.shift_us += self.last_us - t;
            t = self.last_us;
        }
        self.last_us = t;
        let here = self.here()?;
        if !here.seen_lengths.contains(&bytes.len()) {
            here.seen_lengths.push(bytes.len());
        }
        let interface = self.current.unwrap_or(0);
        self.out.reports.push(Stamped { t_us: t, interface, bytes });
        Ok(())
    }

    /// `index bytes...`: a whole string descriptor, or only its text.
    fn usb_string(&mut self, rest: &str) {
        let rest = rest.trim();
        let Some((index, bytes)) = rest.split_once(char::is_whitespace) else { return };
        let (Ok(index), Some(bytes)) = (u8::from_str_radix(index, 16), hex_bytes(bytes)) else {
            return;
        };
        self.strings.push((index, bytes));
    }

    fn finish(mut self) -> HidRecording {
        for one in &mut self.out.interfaces {
            one.strings.clone_from(&self.strings);
        }
        self.out
    }
}

/// `count hex hex ...`: exactly as many bytes as counted.
fn counted(text: &str) -> Result<Vec<u8>, String> {
    let (count, bytes) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let count: usize =
        count.parse().map_err(|_| format!("`{count}`: expected a count of bytes"))?;
    let bytes = hex_bytes(bytes).ok_or("expected pairs of hexadecimal digits")?;
    if bytes.len() != count {
        return Err(format!("{count} bytes announced, {} found", bytes.len()));
    }
    Ok(bytes)
}

/// Decimal seconds as whole microseconds, without the rounding of a float.
fn micros(text: &str) -> Option<u64> {
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    let whole: u64 = whole.parse().ok()?;
    if !part.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let mut us = 0;
    for k in 0..6 {
        us = us * 10 + u64::from(part.as_bytes().get(k).map_or(0, |b| b - b'0'));
    }
    whole.checked_mul(1_000_000)?.checked_add(us)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_devices_and_their_reports() {
        let text = "# note\nD:1\nR: 2 05 0d\nN: One\nP: usb-1/input1\nI: 3 056a 005E\nD: 0\nR: 1 \
                   00\nI: 3 056A 005b\n\
                    E: 1.000000 2 02 80\nD:1\nE: 1.010500 1 ff\nE: 0.5 0\n";
        let got = parse(text).unwrap();
        assert_eq!((got.interfaces[0].pid, got.interfaces[1].pid), (0x5e, 0x5b));
        assert_eq!(
            (got.interfaces[0].name.as_str(), got.interfaces[0].interface),
            ("One", Some(1))
        );
        let seen: Vec<_> =
            got.reports.iter().map(|r| (r.t_us, r.interface, r.bytes.len())).collect();
        assert_eq!(seen, [(0, 1, 2), (10_500, 0, 1), (10_500, 0, 0)], "time never runs backward");
    }

    #[test]
    fn a_recording_is_read_up_to_the_line_that_was_cut() {
        let text = "R: 2 05 0d\nE: 0.1 2 01 02\nE: 0.2 2 03 04\n";
        assert_eq!(parse(text).unwrap().cut_at, None);
        for length in text.len() - 14..text.len() - 1 {
            let got = parse(&text[..length]).unwrap();
            assert_eq!((got.reports.len(), got.cut_at), (1, Some(3)), "{:?}", &text[..length]);
        }
        assert_eq!(parse(&text[..text.len() - 1]).unwrap().reports.len(), 2, "only its end is cut");
        let e = parse("R: 2 05 0d\nE: 0.1 2 01\nE: 0.2 2 03 0").unwrap_err();
        assert_eq!(e.line, 2, "an earlier line was not cut off");
    }

    #[test]
    fn a_broken_line_is_named() {
        for (text, line) in [
            ("R: 2 05\n", 1),
            ("D: x\n", 1),
            ("R: 1 05\nE: 0.1 2 01\n", 2),
            ("I: 3 056a\n", 1),
            ("R: 1 05\nE: -1 1 01\n", 2),
            ("R: 1 zz\n", 1),
            ("", 1),
            ("hello\nworld\n", 1),
        ] {
            assert_eq!(parse(text).unwrap_err().line, line, "{text:?}");
        }
    }
}
