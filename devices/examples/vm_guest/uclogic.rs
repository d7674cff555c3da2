//! The kernel's `hid_uclogic` on a simulated Huion: it asks the device for its parameters, replaces
//! the device's descriptor and changes each report. The recording of the daemon's binary through
//! hidraw must give the strokes that the raw reports give.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::process::{Command, Stdio};
use std::time::Duration;

use sculptd_devices::catalogue::{Catalogue, Identification, Identity};
use sculptd_devices::hid::decoder::Decoder;
use sculptd_devices::recording::{Player, raw};
use sculptd_devices::sim::{PenScript, Stroke, journal};
use sculptd_devices::{Body, DeviceId, Pad, Pen, Sample};

use super::usb_over_ip::{Description, UsbDevice, text};
use super::{nodes, reports_of, tell};

const IDS: (u16, u16) = (0x256c, 0x006d);
/// Name and firmware of a Huion H950P, and what its string 200 says: 44200 x 27600 counts, 8191
/// levels, 5080 counts an inch.
const NAME: &str = "Huion Tablet";
const FIRMWARE: &str = "HUION_T204_190619";
const PARAMETERS: [u8; 18] =
    [18, 3, 0xa8, 0xac, 0x00, 0xd0, 0x6b, 0x00, 0xff, 0x1f, 0xd8, 0x13, 0x03, 8, 0, 0, 0, 0];
/// Its own descriptor: report 8, eleven bytes that only the vendor knows.
const VENDOR: &[u8] = &[
    0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x08, 0x75, 0x08, 0x95, 0x0b, 0x15, 0x00, 0x26,
    0xff, 0x00, 0x09, 0x01, 0x81, 0x02, 0xc0,
];
/// Keys 1, 3 and none of the pad.
const KEYS: [[u8; 12]; 3] = [
    [8, 0xe0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0],
    [8, 0xe0, 1, 1, 4, 0, 0, 0, 0, 0, 0, 0],
    [8, 0xe0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0],
];
/// mm: the strokes may differ by so much.
const WITHIN_MM: f32 = 0.1;

fn split(samples: Vec<Sample>) -> (Vec<Pen>, Vec<Pad>) {
    let (mut pens, mut pads) = (Vec::new(), Vec::new());
    for sample in samples {
        match sample.body {
            Body::Pen(p) => pens.push(p),
            Body::Pad(p) => pads.push(p),
            Body::Hands(_) => {}
        }
    }
    (pens, pads)
}

fn contacts(pens: &[Pen]) -> usize {
    let touches: Vec<bool> = pens.iter().map(|p| p.tip && p.in_range).collect();
    touches.windows(2).filter(|w| !w[0] && w[1]).count()
}

pub fn run() -> io::Result<bool> {
    let strings = BTreeMap::from([
        (1, text("HUION")),
        (2, text(NAME)),
        (200, PARAMETERS.to_vec()),
        (201, text(FIRMWARE)),
    ]);
    let catalogue = Catalogue::builtin().map_err(io::Error::other)?;
    let who = Identity {
        vid: IDS.0,
        pid: IDS.1,
        interface: Some(0),
        name: NAME.into(),
        descriptor: VENDOR.to_vec(),
        strings: strings.iter().map(|(i, s)| (*i, s.clone())).collect(),
        ..Identity::default()
    };
    let Identification::Identified(found) = catalogue.identify(&who) else {
        return Ok(tell(false, "a Huion H950P is known by its firmware's name"));
    };
    // A Huion pen has no eraser.
    let strokes = journal().pen.strokes().iter().map(|s| Stroke { eraser: false, ..*s }).collect();
    let mut sent = reports_of(&found, &PenScript::new(strokes));
    sent.extend(KEYS.map(Vec::from));

    let mut daemon = Command::new("/bin/sculptd")
        .args(["devices", "record", "/tmp/uclogic.rec", "--for", "32", "--json"])
        .stdout(Stdio::piped())
        .spawn()?;
    let usb = UsbDevice::plug(Description {
        vid: IDS.0,
        pid: IDS.1,
        report_descriptor: VENDOR.to_vec(),
        strings,
    })?;
    std::thread::sleep(Duration::from_millis(5000));
    let bound = nodes("/sys/bus/hid/drivers/uclogic", "0003:256C:006D");
    let mut good = tell(bound.len() == 1, "hid_uclogic has taken a Huion on an emulated USB port");
    for report in &sent {
        usb.report(report);
        // The kernel keeps 64 reports of a reader that stands still: on a busy machine for most of
        // a second.
        std::thread::sleep(Duration::from_millis(12));
    }
    let mut out = String::new();
    if let Some(mut pipe) = daemon.stdout.take() {
        pipe.read_to_string(&mut out)?;
    }
    daemon.wait()?;
    drop(usb);
    println!("   {}", out.trim());

    let text = std::fs::read_to_string("/tmp/uclogic.rec")?;
    let recording = raw::parse(&text).map_err(|e| io::Error::other(e.what))?;
    let changed = recording.reports.iter().zip(&sent).filter(|(a, b)| a.bytes != **b).count();
    let shown = recording.interfaces.first();
    let rewritten = shown.is_some_and(|i| i.descriptor != VENDOR && i.driver == "uclogic");
    let what = format!("it shows another descriptor, and {changed} of its reports are changed");
    good &= tell(rewritten && changed * 2 > sent.len(), &what);

    let mut player = Player::open("/tmp/uclogic.rec".as_ref(), DeviceId(0), &catalogue)
        .map_err(io::Error::other)?;
    let info = player.device().clone();
    let mut theirs = Vec::new();
    player.advance(u64::MAX / 2, &mut |s| theirs.push(s));
    let mut decoder = Decoder::new(&found, VENDOR, DeviceId(0));
    let mut ours = Vec::new();
    for (i, report) in sent.iter().enumerate() {
        decoder.feed(report, i as u64 * 4000, &mut |s| ours.push(s));
    }
    let ((theirs, their_keys), (ours, our_keys)) = (split(theirs), split(ours));
    // A pen out of range has no place.
    let placed = |pens: &[Pen]| pens.iter().filter(|p| p.in_range).copied().collect::<Vec<_>>();
    let (a, b) = (placed(&theirs), placed(&ours));
    let (mut off_mm, mut other) = (0.0f32, 0);
    for (a, b) in a.iter().zip(&b) {
        off_mm = off_mm.max(a.pos_mm.distance(b.pos_mm));
        let pressure = (a.pressure.unwrap_or(0.0) - b.pressure.unwrap_or(0.0)).abs();
        let same = a.tip == b.tip && a.buttons == b.buttons && pressure < 2e-4;
        let tilted = a.tilt.zip(b.tilt).is_none_or(|(a, b)| a.distance(b) < 0.02);
        other += usize::from(!(same && tilted));
        if !(same && tilted) && other < 4 {
            println!("   {a:?}\n   {b:?}");
        }
    }
    let what = format!(
        "\"{}\", {} contacts of {}, {} of {} places: all within {off_mm:.4} mm of the raw ones, \
         {other} differ in tip, buttons, pressure or tilt",
        info.name,
        contacts(&theirs),
        contacts(&ours),
        a.len(),
        b.len()
    );
    let same = a.len() == b.len() && contacts(&theirs) == contacts(&ours) && contacts(&ours) > 1;
    good &= tell(same && off_mm <= WITHIN_MM && other == 0, &what);
    let keys = |pads: &[Pad]| pads.iter().map(|p| p.keys).collect::<Vec<_>>();
    let what = format!("pad keys {:?}, raw {:?}", keys(&their_keys), keys(&our_keys));
    Ok(good & tell(keys(&their_keys) == keys(&our_keys) && our_keys.len() == 3, &what))
}
