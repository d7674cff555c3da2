//! Our own recordings: raw bytes as they were read, with what was known of the device.
//!
//! Text, one thing a line, whole lines only, so that a recording cut off by a crash is good up to
//! its last line:
//!
//! ```text
//! sculptd-recording 1
//! {"interface":0,"vid":1386,"pid":184,"number":0,"name":"...","serial":"...","descriptor":"05..."}
//! 0 0 02c28042480de2110000
//! 0 3932 02e01e050bcf00217fc2
//! ```
//!
//! A line with a brace describes an interface, under a number of this file; a report's line has
//! that number, microseconds since the recording began, and the bytes in hexadecimal. `number` is
//! the interface's own on its device, or absent. A reader refuses a version that it does not know.

use std::collections::BTreeMap;
use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::hid_recorder::BadLine;
use super::{HidRecording, Stamped};
use crate::catalogue::Identity;
use crate::tablet::hex_bytes;

/// The first line.
pub const MAGIC: &str = "sculptd-recording 1";

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    interface: usize,
    vid: u16,
    pid: u16,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    number: Option<u8>,
    #[serde(default)]
    name: String,
    #[serde(default)]
    serial: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    uniq: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    driver: String,
    #[serde(default)]
    descriptor: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    strings: BTreeMap<u8, String>,
}

/// Writes a recording as it happens.
#[derive(Debug)]
pub struct Recorder<W: Write> {
    out: W,
    interfaces: usize,
}

impl<W: Write> Recorder<W> {
    /// # Errors
    /// The first line cannot be written.
    pub fn new(mut out: W) -> io::Result<Self> {
        writeln!(out, "{MAGIC}")?;
        Ok(Recorder { out, interfaces: 0 })
    }

    /// Tells of an interface; gives its number in this file.
    ///
    /// # Errors
    /// The line cannot be written.
    pub fn interface(&mut self, who: &Identity, serial: &str) -> io::Result<usize> {
        let head = Head {
            interface: self.interfaces,
            vid: who.vid,
            pid: who.pid,
            number: who.interface,
            name: who.name.clone(),
            serial: serial.to_owned(),
            uniq: who.uniq.clone(),
            driver: who.driver.clone(),
            descriptor: hex(&who.descriptor),
            strings: who.strings.iter().map(|(i, b)| (*i, hex(b))).collect(),
        };
        serde_json::to_writer(&mut self.out, &head)?;
        writeln!(self.out)?;
        self.interfaces += 1;
        Ok(head.interface)
    }

    /// # Errors
    /// The line cannot be written.
    pub fn report(&mut self, interface: usize, t_us: u64, bytes: &[u8]) -> io::Result<()> {
        writeln!(self.out, "{interface} {t_us} {}", hex(bytes))
    }

    /// # Errors
    /// The buffered data cannot be written.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}

fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut s, b| {
        let _ = write!(s, "{b:02x}");
        s
    })
}

/// A file that starts like one of ours, whatever its version.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(b"sculptd-recording ")
}

/// Reads a whole file. A last line without its end is what a crash leaves: it is left out.
pub fn parse(text: &str) -> Result<HidRecording, BadLine> {
    let mut out = HidRecording::default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    if whole.len() + 1 < text.len() {
        out.cut_at = Some(whole.lines().count() + 1);
    }
    let bad = |line: usize, what: String| BadLine { line: line + 1, what };
    let mut first_us = None;
    for (i, line) in whole.lines().enumerate() {
        if i == 0 {
            if line != MAGIC {
                return Err(bad(i, format!("`{line}`: expected `{MAGIC}`")));
            }
        } else if line.starts_with('{') {
            let who = head(line, out.interfaces.len()).map_err(|what| bad(i, what))?;
            out.interfaces.push(who);
        } else if !line.is_empty() {
            let mut report = event(line, out.interfaces.len()).map_err(|what| bad(i, what))?;
            let first = *first_us.get_or_insert(report.t_us);
            report.t_us =
                report.t_us.saturating_sub(first).max(out.reports.last().map_or(0, |r| r.t_us));
            let seen = &mut out.interfaces[report.interface].seen_lengths;
            if !seen.contains(&report.bytes.len()) {
                seen.push(report.bytes.len());
            }
            out.reports.push(report);
        }
    }
    if whole.is_empty() {
        return Err(bad(0, "an empty recording".to_owned()));
    }
    Ok(out)
}

fn head(line: &str, next: usize) -> Result<Identity, String> {
    let head: Head = serde_json::from_str(line).map_err(|e| e.to_string())?;
    if head.interface != next {
        return Err(format!("interface {}: expected {next}", head.interface));
    }
    let bytes = |text: &str| hex_bytes(text).ok_or("expected pairs of hexadecimal digits");
    let mut strings = Vec::new();
    for (index, text) in &head.strings {
        strings.push((*index, bytes(text)?));
    }
    Ok(Identity {
        vid: head.vid,
        pid: head.pid,
        interface: head.number,
        uniq: head.uniq,
        driver: head.driver,
        name: head.name,
        descriptor: bytes(&head.descriptor)?,
        strings,
        seen_lengths: Vec::new(),
    })
}

fn event(line: &str, interfaces: usize) -> Result<Stamped, String> {
    let mut parts = line.split(' ');
    let (Some(interface), Some(t), Some(bytes), None) =
        (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return Err("expected an interface, microseconds and bytes".to_owned());
    };
    let interface: usize =
        interface.parse().map_err(|_| format!("`{interface}`: expected an interface"))?;
    if interface >= interfaces {
        return Err(format!("interface {interface} was not described"));
    }
    let t_us = t.parse().map_err(|_| format!("`{t}`: expected microseconds"))?;
    let bytes = hex_bytes(bytes).ok_or("expected pairs of hexadecimal digits")?;
    Ok(Stamped { t_us, interface, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written() -> String {
        let mut r = Recorder::new(Vec::new()).unwrap();
        let who = Identity {
            vid: 0x256c,
            pid: 0x6d,
            interface: Some(1),
            name: "A \"pen\"".into(),
            descriptor: vec![5, 0x0d],
            strings: vec![(201, vec![4, 3, b'x', 0])],
            uniq: "HUION_T173_190619".into(),
            driver: "uclogic".into(),
            seen_lengths: vec![],
        };
        assert_eq!(r.interface(&who, "S1").unwrap(), 0);
        r.report(0, 1000, &[8, 0x81]).unwrap();
        r.report(0, 5000, &[]).unwrap();
        String::from_utf8(r.finish().unwrap()).unwrap()
    }

    #[test]
    fn what_was_written_is_read() {
        let got = parse(&written()).unwrap();
        let who = &got.interfaces[0];
        assert_eq!((who.vid, who.interface, who.name.as_str()), (0x256c, Some(1), "A \"pen\""));
        assert_eq!(
            (who.string(201).as_deref(), who.descriptor.as_slice()),
            (Some("x"), &[5u8, 0x0d][..])
        );
        let reports: Vec<_> = got.reports.iter().map(|r| (r.t_us, r.bytes.clone())).collect();
        assert_eq!(reports, [(0, vec![8, 0x81]), (4000, vec![])]);
    }

    #[test]
    fn a_cut_recording_is_good_to_its_last_line_and_a_broken_one_is_named() {
        let text = written();
        let cut = &text[..text.len() - 3];
        let good = parse(cut).unwrap();
        assert_eq!((good.reports.len(), good.cut_at), (1, Some(4)));
        assert_eq!(parse(&text).unwrap().cut_at, None);
        for (from, to, line) in [
            ("recording 1", "recording 2", 1),
            ("\"interface\":0", "\"interface\":7", 2),
            ("0 1000 ", "3 1000 ", 3),
            ("0881", "088", 3),
            ("0 5000 ", "0 x ", 4),
            ("\"pid\"", "\"nid\"", 2),
        ] {
            assert_eq!(parse(&text.replace(from, to)).unwrap_err().line, line, "{from}");
        }
    }
}
