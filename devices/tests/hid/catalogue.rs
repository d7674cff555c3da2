//! The tablet files: valid, canonical, all built in, and extended by a folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sculptd_devices::catalogue::{Catalogue, Identification, Identity};
use sculptd_devices::recording::{HidRecording, Player, Stamped};
use sculptd_devices::tablet::Tablet;
use sculptd_devices::{Body, DeviceId};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tablets")
}

/// The text of `src/builtin.rs` for these files.
fn list_of(files: &[PathBuf]) -> String {
    let mut out = String::from(
        "//! The built-in tablet files. A test compares this list with the folder, and rewrites it \
         when\n\
         //! `SCULPTD_BLESS` is set.\n\n\
         /// Name and text of the files of `tablets/` with these names.\n\
         macro_rules! tablets {\n    \
             ($($name:literal)*) => {\n        \
                 &[$((concat!($name, \".toml\"), \
                 include_str!(concat!(\"../tablets/\", $name, \".toml\")))),*]\n    \
             };\n\
         }\n\n\
         /// Name and text of each file of `tablets/`, in alphabetical order.\n\
         #[rustfmt::skip]\n\
         pub(crate) const TABLETS: &[(&str, &str)] = tablets! {\n",
    );
    let mut line = String::from("   ");
    for path in files {
        let name = format!(" \"{}\"", path.file_stem().unwrap().to_string_lossy());
        if line.len() + name.len() > 100 {
            out.push_str(&line);
            out.push('\n');
            line.truncate(3);
        }
        line.push_str(&name);
    }
    out + &line + "\n};\n"
}

#[test]
fn every_file_is_valid_canonical_and_built_in() {
    let mut names = BTreeSet::new();
    let files = super::files(&folder(), ".toml");
    let mut rows = BTreeSet::new();
    for path in &files {
        let file = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(path).unwrap();
        let tablet = Tablet::parse(&file, &text).unwrap();
        assert_eq!(text, tablet.canonical(), "{file} is not in canonical form");
        assert!(names.insert(tablet.name.clone()), "{file}: a second `{}`", tablet.name);
        assert!(!tablet.source.is_empty(), "{file}");
        rows.extend(tablet.id.iter().map(|id| (id.vid, id.pid)));
    }
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/builtin.rs");
    let expected = list_of(&files);
    if std::env::var_os("SCULPTD_BLESS").is_some() {
        std::fs::File::create(&list)
            .and_then(|mut f| std::io::Write::write_all(&mut f, expected.as_bytes()))
            .unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(&list).unwrap(),
        expected,
        "run this test once with SCULPTD_BLESS=1"
    );
    let builtin = Catalogue::builtin().unwrap();
    assert_eq!(builtin.tablets().len(), files.len());
    println!("{} models, {} pairs of ids", files.len(), rows.len());
    assert!(files.len() >= 700 && rows.len() >= 500);
}

#[test]
fn the_udev_rule_names_every_vendor() {
    let rule = Path::new(env!("CARGO_MANIFEST_DIR")).join("../config/70-sculptd.rules");
    let Ok(rule) = std::fs::read_to_string(rule) else {
        println!("skipped: the rules are not part of the package");
        return;
    };
    let mut missing = BTreeSet::new();
    for tablet in Catalogue::builtin().unwrap().tablets() {
        for id in &tablet.id {
            let (vid, pid) = (id.vid, id.pid);
            let vendor = format!("ATTRS{{idVendor}}==\"{vid:04x}\", TAG");
            let one =
                format!("ATTRS{{idVendor}}==\"{vid:04x}\", ATTRS{{idProduct}}==\"{pid:04x}\"");
            let i2c_vendor = format!("KERNELS==\"0018:{vid:04X}:*\"");
            let i2c = format!("KERNELS==\"0018:{vid:04X}:{pid:04X}.*\"");
            if ![vendor, one, i2c_vendor, i2c].iter().any(|line| rule.contains(line)) {
                missing.insert(format!("{vid:04x}:{pid:04x} {}", tablet.name));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

const NEW: &str = r#"name = "Acme Slate 7"
source = "its maker's data sheet"

[area]
width_mm = 200.0
height_mm = 100.0
max_x = 20000
max_y = 10000

[pen]
max_pressure = 8191
buttons = 2

[[id]]
vid = 0xfeed
pid = 0x0007
length = 12
parser = "huion"
"#;

fn recording() -> HidRecording {
    let who = Identity { vid: 0xfeed, pid: 7, seen_lengths: vec![12], ..Identity::default() };
    let report = |i: u64, flags: u8, pressure: u8| Stamped {
        t_us: i * 5000,
        interface: 0,
        bytes: vec![8, flags, 0x10, 0x27, 0x88, 0x13, 0, pressure, 0, 0, 10, 0],
    };
    let reports =
        vec![report(0, 0x80, 0), report(1, 0x81, 16), report(2, 0x80, 0), report(3, 0, 0)];
    HidRecording { interfaces: vec![who], reports, cut_at: None }
}

#[test]
fn a_new_tablet_is_one_file_in_a_folder() {
    let dir = tempfile::tempdir().unwrap();
    let name = Path::new("new.hid");
    let builtin = Catalogue::builtin().unwrap();
    assert!(Player::of(name, recording(), DeviceId(0), &builtin).is_err(), "nobody knows it yet");
    std::fs::File::create(dir.path().join("slate.toml"))
        .and_then(|mut f| std::io::Write::write_all(&mut f, NEW.as_bytes()))
        .unwrap();
    let more = builtin.with_dir(dir.path()).unwrap();
    let mut player = Player::of(name, recording(), DeviceId(0), &more).unwrap();
    assert_eq!(player.device().name, "Acme Slate 7");
    let mut pens = Vec::new();
    player.advance(1_000_000, &mut |s| {
        if let Body::Pen(p) = s.body {
            pens.push(p);
        }
    });
    let states: Vec<_> = pens.iter().map(|p| (p.in_range, p.tip)).collect();
    assert_eq!(states, [(true, false), (true, true), (true, false), (false, false)]);
    assert_eq!((pens[1].pos_mm.x, pens[1].pos_mm.y), (100.0, 50.0));
    assert_eq!(pens[1].pressure, Some(0x1000 as f32 / 8191.0));
}

#[test]
fn a_broken_file_in_the_folder_is_named() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::File::create(dir.path().join("bad.toml"))
        .and_then(|mut f| {
            std::io::Write::write_all(&mut f, NEW.replace("buttons", "knobs").as_bytes())
        })
        .unwrap();
    let e = Catalogue::builtin().unwrap().with_dir(dir.path()).unwrap_err().to_string();
    assert!(e.contains("bad.toml") && e.contains("knobs"), "{e}");
}

#[test]
fn usb_strings_tell_namesakes_apart() {
    let catalogue = Catalogue::builtin().unwrap();
    let with = |text: &str| {
        let mut raw = vec![(2 + 2 * text.len()) as u8, 3];
        raw.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
        let strings = vec![(201, raw)];
        let who = Identity {
            vid: 0x256c,
            pid: 0x6d,
            seen_lengths: vec![12],
            strings,
            ..Identity::default()
        };
        match catalogue.identify(&who) {
            Identification::Identified(found) => found.tablet.name.clone(),
            other => format!("{other:?}"),
        }
    };
    assert_eq!(with("HUION_T173_190619"), "Huion H640P");
    assert_eq!(with("HUION_T194_190619"), "Huion HS610");
    assert!(with("HUION_X999_190619").contains("Declined"), "{}", with("HUION_X999_190619"));
}

fn text_string(index: u8, text: &str) -> (u8, Vec<u8>) {
    let mut raw = vec![(2 + 2 * text.len()) as u8, 3];
    raw.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
    (index, raw)
}

/// String 100: largest coordinates, full pressure, lines an inch.
fn params_string(x: u16, y: u16, pressure: u16, lines: u16) -> (u8, Vec<u8>) {
    let mut raw = vec![12, 3];
    for v in [x, y, 3, pressure, lines] {
        raw.extend(v.to_le_bytes());
    }
    (100, raw)
}

fn identified(who: &Identity) -> sculptd_devices::catalogue::Found {
    match Catalogue::builtin().unwrap().identify(who) {
        Identification::Identified(found) => found,
        other => panic!("{other:?}"),
    }
}

/// A vendor's collection of one report, as Huion's first interface has it.
const VENDOR: &[u8] = &[
    0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x08, 0x75, 0x08, 0x95, 0x07, 0x09, 0x01, 0x81,
    0x02, 0xc0,
];

#[test]
fn parameters_that_contradict_weigh_more_than_a_string_or_a_name() {
    let who = |name: &str, params| Identity {
        vid: 0x256c,
        pid: 0x006e,
        interface: Some(0),
        name: name.to_owned(),
        descriptor: VENDOR.to_vec(),
        strings: vec![text_string(121, "HA60-F400"), params],
        seen_lengths: vec![8],
        ..Identity::default()
    };
    // Monoprice's 10594 has the same firmware string, 40,000 counts and 2,047 levels.
    for name in ["Huion New 1060 Plus", "Monoprice 10594"] {
        let found = identified(&who(name, params_string(50_800, 31_750, 8191, 5080)));
        let (a, p) = (found.tablet.area, found.tablet.pen.max_pressure);
        assert_eq!((a.max_x, a.max_y, p), (50_800, 31_750, 8191), "{}", found.tablet.name);
        assert_eq!((a.width_mm.round(), a.height_mm.round()), (254.0, 159.0));
        assert!(found.tablet.source.contains("the device itself"), "{}", found.tablet.name);
    }
    let same = identified(&who("Monoprice 10594", params_string(40_000, 25_000, 2047, 4000)));
    assert_eq!(same.tablet.name, "Monoprice 10594");
}

#[test]
fn the_parameter_string_states_full_pressure_better_than_the_descriptor() {
    use sculptd_devices::hid::decoder::Decoder;
    // Report 9 of a mouse with absolute axes to 32,767 and pressure to 2,047.
    let descriptor = [
        &[0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x85, 0x09, 0x09, 0x01, 0xa1, 0x00, 0x05, 0x09][..],
        &[0x19, 0x01, 0x29, 0x03, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x03, 0x81, 0x02][..],
        &[0x95, 0x05, 0x81, 0x03, 0x05, 0x01, 0x09, 0x30, 0x09, 0x31, 0x26, 0xff, 0x7f, 0x75][..],
        &[0x10, 0x95, 0x02, 0x81, 0x02, 0x05, 0x0d, 0x09, 0x30, 0x26, 0xff, 0x07, 0x95, 0x01][..],
        &[0x81, 0x02, 0xc0, 0xc0][..],
    ]
    .concat();
    let who = Identity {
        vid: 0x28bd,
        pid: 0x0905,
        name: "XP-Pen Deco 01 V2".to_owned(),
        descriptor: descriptor.clone(),
        strings: vec![params_string(50_800, 31_750, 8191, 5080)],
        seen_lengths: vec![8],
        ..Identity::default()
    };
    let mut decoder = Decoder::new(&identified(&who), &descriptor, DeviceId(0));
    let (mut pressed, mut place) = (Vec::new(), 0.0);
    for (i, p) in [0u16, 2047, 4096, 8191].into_iter().enumerate() {
        let [lo, hi] = p.to_le_bytes();
        let report = [9, 1, 0xff, 0x7f, i as u8, 0, lo, hi];
        decoder.feed(&report, i as u64 * 5000, &mut |s| {
            if let Body::Pen(p) = s.body {
                pressed.push((p.pressure.unwrap() * 8191.0).round() as u32);
                place = p.pos_mm.x;
            }
        });
    }
    assert_eq!(pressed, [0, 2047, 4096, 8191]);
    assert!((place - 254.0).abs() < 0.1, "{place}");
}

#[test]
fn models_that_were_declined_are_known() {
    for (pid, length, parser) in [
        (0x00de, 10, "wacom-simple"),
        (0x00df, 10, "wacom-simple"),
        (0x00d1, 9, "wacom-simple"),
        (0x00d1, 10, "wacom-simple"),
        (0x00d9, 10, "wacom-simple"),
        (0x00dc, 10, "wacom-simple"),
        (0x0379, 51, "wacom-intuos-bluetooth"),
        (0x0377, 51, "wacom-intuos-bluetooth"),
        (0x0360, 361, "wacom-pro-bluetooth"),
        (0x0361, 361, "wacom-pro-bluetooth"),
    ] {
        let who = Identity { vid: 0x056a, pid, seen_lengths: vec![length], ..Identity::default() };
        assert_eq!(identified(&who).id().parser.name(), parser, "056a:{pid:04x}");
    }
    // Their descriptor says nothing of the nine bytes after the report's id.
    for (vid, pid) in [(0x0543, 0xe621), (0x2133, 0x0018)] {
        let who = Identity { vid, pid, seen_lengths: vec![10], ..Identity::default() };
        assert_eq!(identified(&who).id().parser.name(), "signature", "{vid:04x}:{pid:04x}");
    }
    for pid in [0x5005, 0x500f, 0x5013, 0x5015] {
        let who = Identity { vid: 0x0458, pid, seen_lengths: vec![8], ..Identity::default() };
        assert_eq!(identified(&who).id().parser.name(), "kye-plain", "0458:{pid:04x}");
    }
}

/// A vendor's pen of 2047 counts under ids of a model that has 8191.
#[test]
fn a_descriptor_outweighs_a_product_id() {
    let pen = "05 0d 09 02 a1 01 85 07 09 20 a1 00 \
               09 42 09 44 09 45 15 00 25 01 75 01 95 03 81 02 95 \
    02 81 03 09 32 95 01 81 02 95 02 81 03 75 10 95 01 35 00 a4 05 01 09 30 65 13 55 0d 46 \
    40 1f 26 40 1f 81 02 09 31 46 88 13 26 88 13 81 02 b4 09 30 45 00 26 ff 07 81 02 c0 c0";
    let descriptor: Vec<u8> =
        pen.split_whitespace().map(|b| u8::from_str_radix(b, 16).unwrap()).collect();
    let who = Identity {
        vid: 0x28bd,
        pid: 0x0071,
        name: "UGEE TABLET EX07".to_owned(),
        descriptor,
        seen_lengths: vec![8, 10],
        ..Identity::default()
    };
    let Identification::Identified(found) = Catalogue::builtin().unwrap().identify(&who) else {
        panic!("unknown")
    };
    assert_eq!(found.tablet.pen.max_pressure, 2047, "{}", found.in_words());
    assert!(!found.tablet.name.contains("Star 05"), "{}", found.in_words());
}
