//! Runs inside the virtual machine of `tests/vm/run.sh`: a uhid tablet is plugged in, the daemon's
//! own binary records it from /dev/hidraw*, the kernel's wacom driver decodes it, and both are
//! compared with what was sent and with our decoder. Then the plug is pulled in mid-stroke and put
//! back. A Huion under `hid_uclogic` follows, see [`uclogic`], then serial pens, see [`serial`].
//! Prints one `VM ok` or `VM FAIL` line for each thing shown.
#![cfg(target_os = "linux")]
// A test program: it prints its findings and waits for a kernel.
#![allow(clippy::print_stdout, clippy::disallowed_methods)]

mod serial;
mod uclogic;
mod uhid;
mod usb_over_ip;

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;

use sculptd_devices::catalogue::{Catalogue, Found, Identification, Identity};
use sculptd_devices::hid::decoder::Decoder;
use sculptd_devices::hid::transport::Transport;
use sculptd_devices::recording::raw;
use sculptd_devices::serial::Protocol;
use sculptd_devices::sim::{PenScript, SimTablet, TabletConfig, journal};
use sculptd_devices::{Body, DeviceId, Pen, Tool};
use uhid::{DESCRIPTOR, NONBLOCK, Uhid};

const MODEL: &str = "Wacom PTK-440";
const REPORTS: usize = 1200;

/// The kernel's own reading, from evdev: `struct input_event` of 64-bit Linux.
#[derive(Default, Clone, Copy, PartialEq, Debug)]
struct Kernel {
    x: i32,
    y: i32,
    pressure: i32,
    pen: bool,
    rubber: bool,
    stylus: bool,
    stylus2: bool,
}

impl Kernel {
    fn read(&mut self, node: &mut File) {
        let mut events = [0u8; 24 * 64];
        while let Ok(n) = node.read(&mut events) {
            for e in events[..n].chunks_exact(24) {
                let kind = u16::from_le_bytes([e[16], e[17]]);
                let code = u16::from_le_bytes([e[18], e[19]]);
                let value = i32::from_le_bytes([e[20], e[21], e[22], e[23]]);
                match (kind, code) {
                    (3, 0) => self.x = value,
                    (3, 1) => self.y = value,
                    (3, 24) => self.pressure = value,
                    (1, 0x140) => self.pen = value != 0,
                    (1, 0x141) => self.rubber = value != 0,
                    (1, 0x14b) => self.stylus = value != 0,
                    (1, 0x14c) => self.stylus2 = value != 0,
                    _ => {}
                }
            }
        }
    }
}

fn nodes(dir: &str, start: &str) -> BTreeSet<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().flatten().map(|e| e.path());
    entries
        .filter(|p| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with(start)))
        .collect()
}

/// The evdev node of the pen, which the driver names.
fn pen_node() -> Option<PathBuf> {
    nodes("/sys/class/input", "event").into_iter().find_map(|p| {
        let name = std::fs::read_to_string(p.join("device/name")).ok()?;
        let file = Path::new("/dev/input").join(p.file_name()?);
        name.trim().ends_with("Pen").then_some(file)
    })
}

fn found() -> (Found, Identity) {
    let catalogue = Catalogue::builtin().expect("the built-in models");
    let who =
        Identity { vid: 0x056a, pid: 0xb8, descriptor: DESCRIPTOR.to_vec(), ..Identity::default() };
    match catalogue.identify(&who) {
        Identification::Identified(found) if found.tablet.name == MODEL => (found, who),
        other => panic!("{other:?}"),
    }
}

/// Reports of the journal's strokes, as the tablet would send them.
fn reports(found: &Found) -> Vec<Vec<u8>> {
    reports_of(found, &journal().pen)
}

/// The same of another script, drawn on the journal's area.
fn reports_of(found: &Found, script: &PenScript) -> Vec<Vec<u8>> {
    let (journal, a) = (journal(), found.tablet.area);
    let end_us = script.end_us();
    let script = script.fitted(journal.area_mm, glam::vec2(a.width_mm as f32, a.height_mm as f32));
    let (mut tablet, mut end) =
        SimTablet::new(found, script, TabletConfig { keeps: 100_000, ..TabletConfig::default() });
    tablet.advance(end_us);
    let mut buf = [0; 64];
    let mut all = Vec::new();
    while let Ok(n @ 1..) = end.read(&mut buf, 0) {
        all.push(buf[..n].to_vec());
    }
    // From the first that is pressed, with the entry before it.
    all.truncate(REPORTS);
    all
}

fn tell(good: bool, what: &str) -> bool {
    println!("VM {} {what}", if good { "ok  " } else { "FAIL" });
    good
}

/// Feeds all reports, comparing the kernel's state after each with ours.
fn feed(uhid: &mut Uhid, found: &Found, reports: &[Vec<u8>]) -> io::Result<(usize, usize, i64)> {
    let node = pen_node().ok_or_else(|| io::Error::other("no evdev node of the pen"))?;
    let mut node = OpenOptions::new().read(true).custom_flags(NONBLOCK).open(node)?;
    let mut decoder = Decoder::new(found, DESCRIPTOR, DeviceId(0));
    let (mut kernel, mut ours) = (Kernel::default(), None::<Pen>);
    let (mut placed, mut differ, mut worst) = (0, 0, 0);
    for (i, report) in reports.iter().enumerate() {
        uhid.report(report)?;
        uhid.serve(Duration::from_millis(3))?;
        kernel.read(&mut node);
        decoder.feed(report, i as u64 * 4000, &mut |s| {
            if let Body::Pen(p) = s.body {
                ours = Some(p);
            }
        });
        let there = kernel.pen || kernel.rubber;
        let Some(p) = ours.filter(|p| p.in_range) else {
            differ += usize::from(there);
            continue;
        };
        placed += 1;
        let pressure = (p.pressure.unwrap_or(0.0) * 2047.0).round() as i32;
        let same = there
            && kernel.rubber == (p.tool == Tool::Eraser)
            && kernel.pressure == pressure
            && u32::from(kernel.stylus) | u32::from(kernel.stylus2) << 1 == p.buttons;
        if !same && differ < 3 {
            println!("   report {i} {report:02x?}: kernel {kernel:?}, ours {p:?}");
        }
        differ += usize::from(!same);
        let off = i64::from(kernel.x - p.raw[0]).abs().max(i64::from(kernel.y - p.raw[1]).abs());
        worst = worst.max(off);
    }
    Ok((placed, differ, worst))
}

fn run() -> io::Result<bool> {
    let (found, _) = found();
    let sent = reports(&found);
    let mut daemon = Command::new("/bin/sculptd")
        .args(["devices", "record", "/tmp/vm.rec", "--for", "45", "--json"])
        .stdout(Stdio::piped())
        .spawn()?;
    let mut uhid = Uhid::plug()?;
    uhid.serve(Duration::from_millis(4000))?;
    let mut good = tell(!nodes("/dev", "hidraw").is_empty(), "a uhid tablet has a hidraw node");
    let (placed, differ, worst) = feed(&mut uhid, &found, &sent)?;
    let what = format!(
        "wacom.ko agrees on {placed} placed reports of {}: {differ} differ, x and y within \
         {worst} counts",
        sent.len()
    );
    good &= tell(placed > 500 && differ == 0 && worst <= 4, &what);
    // Pulled while the tip is down.
    let mut decoder = Decoder::new(&found, DESCRIPTOR, DeviceId(0));
    let mut down = 0;
    for (i, report) in sent.iter().enumerate() {
        uhid.report(report)?;
        uhid.serve(Duration::from_millis(2))?;
        decoder.feed(report, i as u64 * 4000, &mut |s| {
            down += usize::from(matches!(s.body, Body::Pen(p) if p.tip))
        });
        if down > 50 {
            break;
        }
    }
    let cut = down > 50;
    drop(uhid);
    std::thread::sleep(Duration::from_millis(1000));
    good &= tell(cut && nodes("/dev", "hidraw").is_empty(), "the plug was pulled in mid-stroke");
    let mut uhid = Uhid::plug()?;
    uhid.serve(Duration::from_millis(4000))?;
    for report in &sent {
        uhid.report(report)?;
        uhid.serve(Duration::from_millis(2))?;
    }
    let mut out = String::new();
    while daemon.try_wait()?.is_none() {
        uhid.serve(Duration::from_millis(50))?;
    }
    if let Some(mut pipe) = daemon.stdout.take() {
        pipe.read_to_string(&mut out)?;
    }
    println!("   {}", out.trim());
    let recording = raw::parse(&std::fs::read_to_string("/tmp/vm.rec")?)
        .map_err(|e| io::Error::other(e.what))?;
    let of = |n: usize| {
        recording.reports.iter().filter(|r| r.interface == n).map(|r| r.bytes.clone()).collect()
    };
    let first: Vec<Vec<u8>> = of(0);
    let again: Vec<Vec<u8>> = of(1);
    let same = first.len() > sent.len() && first[..sent.len()] == sent[..];
    let what = format!(
        "the daemon read {} reports through /dev/hidraw, byte for byte as sent",
        first.len()
    );
    good &= tell(same, &what);
    let tail = again.len().min(sent.len());
    let what = format!(
        "after the replug, with nothing asked of anyone, {} of {} more",
        again.len(),
        sent.len()
    );
    good &= tell(
        recording.interfaces.len() == 2
            && tail * 10 > sent.len() * 9
            && again[..] == sent[sent.len() - tail..],
        &what,
    );
    let contacts = out
        .split_once("\"contacts\":")
        .and_then(|(_, r)| r.split([',', '}']).next()?.parse::<u32>().ok());
    good &= tell(
        contacts.is_some_and(|c| c > 1) && out.contains("\"lost_transitions\":0"),
        "contacts came, and no transition was lost",
    );
    Ok(good)
}

fn main() -> ExitCode {
    let all = run().and_then(|tablet| {
        let rewritten = uclogic::run()?;
        let isdv4 = serial::compare(Protocol::Isdv4, "--w8001", 255.0)?;
        let wacom_iv = serial::compare(Protocol::WacomIv, "--wacom_iv", 255.0)?;
        Ok(tablet && rewritten && isdv4 && wacom_iv)
    });
    match all {
        Ok(true) => {
            println!("VM PASSED");
            ExitCode::SUCCESS
        }
        Ok(false) => {
            println!("VM FAILED");
            ExitCode::FAILURE
        }
        Err(e) => {
            println!("VM FAILED: {e}");
            ExitCode::FAILURE
        }
    }
}
