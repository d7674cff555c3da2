//! Buttons and contacts that are not what they seem, played as whole streams: rebuilt from public
//! reports of these tablets (Linux HID-BPF programs, DIGImend, OpenTabletDriver).

use std::path::Path;

use sculptd_devices::catalogue::{Catalogue, Identity};
use sculptd_devices::recording::{HidRecording, Player, Stamped};
use sculptd_devices::{Body, DeviceId, Pen, Tool};

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|b| u8::from_str_radix(b, 16).unwrap()).collect()
}

/// A tablet with these ids and this descriptor.
fn tablet(vid: u16, pid: u16, name: &str, descriptor: &str) -> Identity {
    let descriptor = hex(descriptor);
    Identity { vid, pid, name: name.to_owned(), descriptor, ..Identity::default() }
}

/// Returns the samples decoded from these reports, each with its time.
fn play(mut who: Identity, reports: &[(u64, Vec<u8>)]) -> Vec<(u64, Pen)> {
    who.seen_lengths = vec![reports[0].1.len()];
    let stamped = |(t_us, bytes): &(u64, Vec<u8>)| Stamped {
        t_us: *t_us,
        interface: 0,
        bytes: bytes.clone(),
    };
    let recording = HidRecording {
        interfaces: vec![who],
        reports: reports.iter().map(stamped).collect(),
        cut_at: None,
    };
    let catalogue = Catalogue::builtin().unwrap();
    let mut player = Player::of(Path::new("pen"), recording, DeviceId(0), &catalogue).unwrap();
    let mut out = Vec::new();
    player.advance(u64::MAX / 2, &mut |s| {
        if let Body::Pen(p) = s.body {
            out.push((s.t_us, p));
        }
    });
    out
}

/// Reports 4 ms apart.
fn every_4_ms(reports: impl IntoIterator<Item = Vec<u8>>) -> Vec<(u64, Vec<u8>)> {
    reports.into_iter().enumerate().map(|(i, b)| (i as u64 * 4000, b)).collect()
}

fn said(pens: &[(u64, Pen)]) -> Vec<(Tool, bool, u32)> {
    pens.iter().filter(|p| p.1.in_range).map(|p| (p.1.tool, p.1.tip, p.1.buttons)).collect()
}

/// Contacts: runs of samples that touch.
fn strokes(pens: &[(u64, Pen)]) -> usize {
    let mut before = false;
    let begins = |p: &&(u64, Pen)| {
        let begins = p.1.tip && !before;
        before = p.1.tip;
        begins
    };
    pens.iter().filter(begins).count()
}

const HUION_VENDOR: &str = "06 00 ff 09 01 a1 01 85 08 75 68 95 01 09 01 81 02 c0";

fn kamvas_gen_3(firmware: &str, pid: u16) -> Identity {
    let mut who = tablet(0x256c, pid, "HUION Huion Tablet", HUION_VENDOR);
    let units = firmware.encode_utf16().flat_map(u16::to_le_bytes);
    who.strings.push((201, [2 + 2 * firmware.len() as u8, 3].into_iter().chain(units).collect()));
    who
}

fn huion(flags: u8, i: u8, pressure: u16) -> Vec<u8> {
    let [low, high] = pressure.to_le_bytes();
    vec![8, flags, 0x20 + i, 0x4e, 0x38, 0x4a, low, high, 0, 0, 0, 0, 3, 0]
}

#[test]
fn three_buttons_and_the_eraser_of_huions_third_generation() {
    for (firmware, pid) in [("HUION_M22d_241101", 0x2009), ("HUION_M22c_240606", 0x2008)] {
        let flags = [0x80, 0x81, 0x89, 0x88, 0x82, 0x84, 0x80, 0xa0, 0xa1, 0xa0, 0x00];
        let reports = flags
            .iter()
            .enumerate()
            .map(|(i, f)| huion(*f, i as u8, if f & 1 != 0 { 4000 } else { 0 }));
        let pens = play(kamvas_gen_3(firmware, pid), &every_4_ms(reports));
        let (pen, eraser) = (Tool::Pen, Tool::Eraser);
        let expected = [
            (pen, false, 0),
            (pen, true, 0),
            (pen, true, 4),
            (pen, false, 4),
            (pen, false, 1),
            (pen, false, 2),
            (pen, false, 0),
            (eraser, false, 0),
            (eraser, true, 0),
            (eraser, false, 0),
        ];
        assert_eq!(said(&pens), expected, "{firmware}");
    }
}

/// Tip, barrel, secondary tip, invert, eraser, one bit more, in range; axes of 16 bits, pressure,
/// tilt: what a Kamvas sends before its driver switches it.
const KAMVAS_FIRMWARE: &str = "05 0d 09 02 a1 01 85 0a 09 20 a1 01 \
    09 42 09 44 09 43 09 3c 09 45 15 00 25 01 75 01 95 \
    06 81 02 09 32 75 01 95 01 81 02 81 03 05 01 09 30 09 31 55 0d 65 33 26 ff 7f 35 00 46 \
    00 08 75 10 95 02 81 02 05 0d 09 30 26 ff 3f 75 10 95 01 81 02 09 3d 09 3e 15 a6 25 5a \
    75 08 95 02 81 02 c0 c0";

#[test]
fn the_third_button_of_a_kamvas_shares_its_bit_with_the_eraser() {
    let who = tablet(0x256c, 0x006b, "HUION Huion Tablet_GT1902", KAMVAS_FIRMWARE);
    let report = |flags: u8| {
        let pressure = if flags & 0x11 != 0 { 0x10 } else { 0 };
        vec![0x0a, flags, 0, 0x40, 0, 0x40, 0, pressure, 0, 0]
    };
    // A stroke with the third button, then the pen leaves and comes back turned over.
    let flags = [0x40, 0x41, 0x49, 0x41, 0x42, 0x44, 0x00, 0x48, 0x58, 0x48, 0x00];
    let pens = play(who, &every_4_ms(flags.map(report)));
    let (pen, eraser) = (Tool::Pen, Tool::Eraser);
    let expected = [
        (pen, false, 0),
        (pen, true, 0),
        (pen, true, 4),
        (pen, true, 0),
        (pen, false, 1),
        (pen, false, 2),
        (eraser, false, 0),
        (eraser, true, 0),
        (eraser, false, 0),
    ];
    assert_eq!(said(&pens), expected);
}

/// Report that the kernel's HID-BPF program describes: tip, two barrel buttons, button 0x4A.
const KAMVAS_BPF: &str = "05 0d 09 02 a1 01 85 08 09 20 a1 00 \
    15 00 25 01 75 01 95 03 09 42 09 44 09 5a 81 02 05 \
    09 09 4a 95 01 81 02 95 03 81 03 05 0d 09 32 95 01 81 02 05 01 65 11 55 0e 09 30 75 18 \
    27 20 11 01 00 35 00 46 a8 0d 81 02 09 31 75 10 27 ac 99 00 00 46 af 07 81 02 05 0d 09 \
    30 65 00 26 ff 3f 81 02 c0 c0";

#[test]
fn the_third_button_is_kept_under_hid_bpf() {
    let who = tablet(0x256c, 0x2009, "HUION Huion Tablet_GS1563", KAMVAS_BPF);
    let report =
        |flags: u8| vec![8, flags, 0, 0x40, 0, 0, 0x40, 0, if flags & 1 != 0 { 9 } else { 0 }];
    let pens = play(who, &every_4_ms([0x80, 0x81, 0x89, 0x82, 0x84, 0x88, 0x80].map(report)));
    let buttons: Vec<u32> = said(&pens).iter().map(|p| p.2).collect();
    assert_eq!(buttons, [0, 0, 4, 1, 2, 4, 0]);
    assert!(said(&pens).iter().all(|p| p.0 == Tool::Pen));
    assert_eq!(strokes(&pens), 1);
}

/// Tip, barrel, eraser, two bits of padding, in range; axes of 15 bits, pressure, tilt.
const ARTIST_24: &str = "05 0d 09 02 a1 01 85 07 09 20 a1 00 \
    09 42 09 44 09 45 15 00 25 01 75 01 95 03 81 02 95 \
    02 81 03 09 32 95 01 81 02 95 02 81 03 75 10 95 01 35 00 a4 05 01 09 30 65 13 55 0d 46 \
    f0 50 26 ff 7f 81 02 09 31 46 91 2d 26 ff 7f 81 02 b4 09 30 45 00 26 ff 1f 81 42 09 3d \
    15 81 25 7f 75 08 95 01 81 02 09 3e 15 81 25 7f 81 02 c0 c0";

fn artist(flags: u8) -> Vec<u8> {
    let pressure = if flags & 1 != 0 { 15 } else { 0 };
    vec![7, flags, 0x40, 0x1f, 0x28, 0x23, 0xa0 * (flags & 1), pressure, 0, 0]
}

#[test]
fn the_second_button_of_an_artist_24_does_not_cut_its_stroke() {
    for pid in [0x093a, 0x092d] {
        let who = tablet(0x28bd, pid, "UGTABLET 23.8 inch PenDisplay", ARTIST_24);
        let flags =
            [0x20, 0x21, 0x21, 0x21, 0x00, 0x24, 0x25, 0x25, 0x25, 0x00, 0x20, 0x21, 0x21, 0x20, 0];
        let pens = play(who, &every_4_ms(flags.map(artist)));
        assert_eq!(strokes(&pens), 1, "{pid:04x}: {:?}", said(&pens));
        assert!(said(&pens).iter().all(|p| p.0 == Tool::Pen));
        let held = said(&pens).iter().filter(|p| p.1 && p.2 == 2).count();
        assert_eq!(held, 3);
    }
}

/// Like an Artist 24's, with invert after the eraser, which its pens have.
const PRO_16_GEN_2: &str = "05 0d 09 02 a1 01 85 07 09 20 a1 00 \
    09 42 09 44 09 45 09 3c 15 00 25 01 75 01 95 04 81 \
    02 95 01 81 03 09 32 95 01 81 02 95 02 81 03 75 10 95 01 35 00 a4 05 01 09 30 65 13 55 \
    0d 46 ff 34 26 ff 7f 81 02 09 31 46 20 21 26 ff 7f 81 02 b4 09 30 45 00 26 ff 3f 81 42 \
    09 3d 15 81 25 7f 75 08 95 01 81 02 09 3e 15 81 25 7f 81 02 c0 c0";
/// Tip, barrel, eraser, tablet pick, invert: a descriptor that has a bit for each.
const PRO_16: &str = "05 0d 09 02 a1 01 85 07 09 20 a1 00 \
    09 42 09 44 09 45 09 46 09 3c 15 00 25 01 75 01 95 \
    05 81 02 09 32 95 01 81 02 95 02 81 03 75 10 95 01 35 00 a4 05 01 09 30 65 13 55 0d 46 \
    74 34 26 ff 7f 81 02 09 31 46 7f 1d 26 ff 7f 81 02 b4 09 30 45 00 26 ff 1f 81 42 09 3d \
    15 81 25 7f 75 08 95 01 81 02 09 3e 15 81 25 7f 81 02 c0 c0";

#[test]
fn the_eraser_of_an_artist_pro_touches_and_its_second_button_does_not_erase() {
    let (pen, eraser) = (Tool::Pen, Tool::Eraser);
    let expected =
        [(pen, false, 0), (pen, true, 0), (pen, false, 2), (eraser, false, 0), (eraser, true, 0)];
    let who = tablet(0x28bd, 0x095b, "UGTABLET Artist Pro 16", PRO_16_GEN_2);
    let pens = play(who, &every_4_ms([0x20, 0x21, 0x24, 0x00, 0x28, 0x29, 0x00].map(artist)));
    assert_eq!(said(&pens), expected, "touches with the tip's bit");
    let who = tablet(0x28bd, 0x094b, "UGTABLET Artist Pro 16", PRO_16);
    let pens = play(who, &every_4_ms([0x20, 0x21, 0x28, 0x00, 0x30, 0x34, 0x00].map(artist)));
    assert_eq!(said(&pens), expected, "touches with a bit of its own");
}

/// A selector of tip, barrel button and tablet pick in two bits, invert, in range.
const SIRIUS: &str = "05 0d 09 02 a1 01 85 10 09 20 a1 00 \
    09 42 09 44 09 46 15 01 25 03 95 01 75 02 81 00 75 \
    01 15 00 25 01 09 3c 81 02 81 03 09 32 81 02 95 03 81 03 75 10 95 01 05 01 65 13 55 0d \
    35 00 09 30 46 10 27 26 20 4e 81 02 09 31 46 70 17 26 e0 2e 81 02 05 0d 09 30 45 00 65 \
    00 26 ff 03 81 02 c0 c0";

#[test]
fn a_barrel_button_of_a_waltop_in_the_air_is_no_contact() {
    // Its pen rests at a nonzero pressure: 5 counts, or more on a worn one.
    for rest in [5u16, 70, 300] {
        let report = |(flags, pressure): (u8, u16)| {
            let [low, high] = pressure.to_le_bytes();
            vec![0x10, flags, 0xe8, 3, 0xd0, 7, low, high]
        };
        let firm = rest + 600;
        let stream = [
            (0x10, rest),
            (0x11, firm),
            (0x12, rest),
            (0x13, rest),
            (0x10, rest),
            (0x12, rest),
            (0x11, firm),
            (0x12, firm),
            (0x12, rest),
            (0x00, 0),
        ];
        let who = tablet(0x172f, 0x0502, "WALTOP Batteryless Tablet", SIRIUS);
        let pens = play(who, &every_4_ms(stream.map(report)));
        let seen: Vec<(bool, u32)> = said(&pens).iter().map(|p| (p.1, p.2)).collect();
        let expected = [
            (false, 0),
            (true, 0),
            (false, 1),
            (false, 2),
            (false, 0),
            (false, 1),
            (true, 0),
            (true, 1),
            (false, 1),
        ];
        assert_eq!(seen, expected, "resting at {rest}");
    }
}

#[test]
fn the_third_button_of_a_pro_pen_3d_is_one_button() {
    let vendor = "06 0d ff 09 01 a1 01 85 10 75 08 95 1a 09 01 81 02 c0";
    let who = tablet(0x056a, 0x0357, "Wacom Co.,Ltd. Intuos Pro M", vendor);
    let report = |flags: u8| {
        let mut b = vec![0u8; 27];
        b[..10].copy_from_slice(&[0x10, flags, 0x20, 0x4e, 0, 0x98, 0x3a, 0, 0, 0]);
        if flags & 0x09 != 0 {
            b[8..10].copy_from_slice(&[0xb8, 0x0b]);
        }
        b
    };
    let flags = [0x60, 0x62, 0x64, 0x66, 0x61, 0x60, 0x00, 0x70, 0x78, 0x70, 0x00];
    let pens = play(who, &every_4_ms(flags.map(report)));
    let (pen, eraser) = (Tool::Pen, Tool::Eraser);
    let expected = [
        (pen, false, 0),
        (pen, false, 1),
        (pen, false, 2),
        (pen, false, 4),
        (pen, true, 0),
        (pen, false, 0),
        (eraser, false, 0),
        (eraser, true, 0),
        (eraser, false, 0),
    ];
    assert_eq!(said(&pens), expected);
}

#[test]
fn a_pen_pulled_away_in_contact_ends_its_stroke_50_ms_later() {
    let who = || kamvas_gen_3("HUION_M22d_241101", 0x2009);
    let at = |x: u16| {
        let mut report = huion(0x81, 0, 4000);
        report[2..4].copy_from_slice(&x.to_le_bytes());
        report
    };
    // Counts of 5 um every 4 ms: a pen at 100 mm/s, and one that rests and is reported again.
    let fast: fn(u16) -> u16 = |i| 10_000 + 80 * i;
    let rests: fn(u16) -> u16 = |i| 10_000 + i.min(60);
    for x in [fast, rests] {
        let mut reports: Vec<_> = (0..80).map(|i| (u64::from(i) * 4000, at(x(i)))).collect();
        // Back in contact after 20 s, and no report in between.
        let back = (0..5).map(|i| (20_320_000 + u64::from(i) * 4000, at(20_000 + i)));
        reports.extend(back);
        reports.push((20_340_000, huion(0, 0, 0)));
        let pens = play(who(), &reports);
        assert_eq!(strokes(&pens), 2);
        let left = pens.iter().find(|p| !p.1.in_range).unwrap();
        assert_eq!(left.0, 79 * 4000 + 50_000);
    }
}

/// Tip, barrel, invert, eraser, padding, in range; axes and pressure.
const TABLET_PC: &str = "05 0d 09 02 a1 01 85 03 09 20 a1 00 \
    09 42 09 44 09 3c 09 45 15 00 25 01 75 01 95 04 81 \
    02 95 01 81 03 09 32 95 01 81 02 95 02 81 03 05 01 09 30 75 10 95 01 a4 65 11 55 0e 35 \
    00 46 7a 08 15 00 26 c4 54 81 02 09 31 46 50 05 26 20 35 81 02 b4 05 0d 09 30 15 00 26 \
    ff 0f 81 02 c0 c0";

#[test]
fn a_pen_whose_pressure_is_always_0_draws() {
    let who = tablet(0x2d1f, 0x9999, "Tablet PC pen", TABLET_PC);
    let report = |i: u8| vec![3, 0x21, 0x88, 0x13 + i, 0x88, 0x13, 0, 0];
    let pens = play(who, &every_4_ms((0..60).map(report)));
    let drawn = pens.iter().filter(|p| p.1.tip && p.1.pressure.is_none()).count();
    assert!(drawn >= 56, "{drawn} of 60 reports in contact draw");
}
