//! Cameras that misbehave: garbage, cut pictures, one picture a second, silence, absence. None of
//! these needs a model except where a hand is looked for.

#![allow(clippy::print_stdout)] // Skips are told on standard output.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use sculptd_camera::camera_thread::{self, CameraChoice, CameraConfig};
use sculptd_camera::drawn::{DrawnScene, draw};
use sculptd_camera::hand_camera::HandCameraSettings;
use sculptd_camera::models;
use sculptd_camera::picture::Picture;
use sculptd_camera::source::{CameraError, open_file};
use sculptd_devices::{Clock, DeviceId, queue};

fn write(path: &Path, bytes: &[u8]) {
    std::fs::File::create(path).and_then(|mut f| f.write_all(bytes)).expect("written");
}

/// Y4M without colour of so many grey pictures.
fn y4m(pictures: usize, rate: &str) -> Vec<u8> {
    let mut bytes = format!("YUV4MPEG2 W64 H48 F{rate} Cmono\n").into_bytes();
    for i in 0..pictures {
        bytes.extend(b"FRAME\n");
        bytes.extend(vec![(16 + 8 * i) as u8; 64 * 48]);
    }
    bytes
}

/// Reads to the end. Returns whole pictures, damaged ones, and any other error.
fn read(path: &Path) -> (usize, usize, Option<CameraError>) {
    let mut source = match open_file(path) {
        Ok(source) => source,
        Err(e) => return (0, 0, Some(e)),
    };
    let (mut whole, mut damaged) = (0, 0);
    for _ in 0..10_000 {
        match source.next_picture() {
            Ok(Some(_)) => whole += 1,
            Ok(None) => return (whole, damaged, None),
            Err(CameraError::Damaged { .. }) => damaged += 1,
            Err(e) => return (whole, damaged, Some(e)),
        }
    }
    panic!("a source without end")
}

/// A JPEG of a drawn picture: baseline, one scan, made by hand from flat grey blocks.
fn jpeg() -> Vec<u8> {
    let hex = "ffd8ffe000104a46494600010100000100010000ffdb004300100b0c0e0c0a100e0d0e121110\
               1318281a181616183123251d283a333d3c3933383740485c4e404457453738506d51575f6267\
               68673e4d71797064785c656763ffc0000b080010001001011100ffc400150001010000000000\
               0000000000000000000007ffc40014100100000000000000000000000000000000ffda000801\
               0100003f009fc0ffd9";
    let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    digits
        .chunks(2)
        .filter_map(|d| u8::from_str_radix(std::str::from_utf8(d).ok()?, 16).ok())
        .collect()
}

#[test]
fn damaged_recordings_lose_their_damaged_pictures_only() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("hands.y4m");
    write(&path, &y4m(4, "30:1"));
    assert!(matches!(read(&path), (4, 0, None)));
    let mut cut = y4m(4, "30:1");
    cut.truncate(cut.len() - 100);
    write(&path, &cut);
    assert!(matches!(read(&path), (3, 1, None)), "{:?}", read(&path));
    for header in ["F0:1", "Fx", "F1"] {
        write(&path, &y4m(1, header.trim_start_matches('F')));
        assert!(matches!(read(&path).2, Some(CameraError::Damaged { .. })), "{header}");
    }
    write(&path, b"YUV4MPEG2 W99999999 H99999999 F30:1\n");
    assert!(matches!(read(&path).2, Some(CameraError::Damaged { .. })));
    write(&path, b"");
    assert!(matches!(read(&path).2, Some(CameraError::Unknown { .. })));
    write(&path, b"solid clay");
    let e = read(&path).2.expect("not a camera").to_string();
    assert!(e.contains("hands.y4m") && e.contains("Motion JPEG"), "{e}");
}

#[test]
fn motion_jpeg_goes_on_after_garbage() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("hands.mjpeg");
    let good = jpeg();
    let mut cut = good.clone();
    cut.truncate(good.len() / 2);
    let mut bytes = good.clone();
    bytes.extend(&cut);
    bytes.extend(&good);
    bytes.extend([0xff, 0xd8, 1, 2, 3, 4]);
    write(&path, &bytes);
    let (whole, damaged, end) = read(&path);
    assert!(
        end.is_none() && damaged >= 2 && whole + damaged == 4,
        "{whole} whole, {damaged} damaged"
    );
    let mut seed = 1_u32;
    for length in [10, 1000, 30_000] {
        let noise = (0..length).map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 24) as u8
        });
        let bytes: Vec<u8> = [0xff, 0xd8].into_iter().chain(noise).collect();
        write(&path, &bytes);
        let (_, _, end) = read(&path);
        assert!(end.is_none());
    }
}

#[test]
fn an_empty_folder_and_one_of_other_files_are_errors() {
    let dir = tempfile::tempdir().expect("a folder");
    assert!(matches!(read(dir.path()).2, Some(CameraError::Unknown { .. })));
    write(&dir.path().join("a.png"), b"not a picture");
    assert!(matches!(read(dir.path()), (0, 1, None)));
}

fn models_folder() -> Option<std::path::PathBuf> {
    let named = std::env::var_os("SCULPTD_CAMERA_MODELS").map(std::path::PathBuf::from);
    let own = std::env::var_os("HOME")
        .map(|h| std::path::PathBuf::from(h).join(".local/share/sculptd/hand-models"));
    let looked: Vec<_> = named.into_iter().chain(own).collect();
    models::find(&looked).inspect_err(|e| println!("skipped: {e}")).ok()
}

fn config(choice: CameraChoice) -> CameraConfig {
    CameraConfig { choice, settings: HandCameraSettings::default(), device: DeviceId(210) }
}

#[test]
fn an_absent_camera_says_so_and_stops_at_once() {
    let Some(folder) = models_folder() else { return };
    let (factory, mut receiver) = queue::channel(64);
    let config = config(CameraChoice::Device("/dev/video-absent".into()));
    let tracks = models::load(&folder).expect("the models load");
    let clock = Clock::monotonic();
    let handle =
        camera_thread::start(config, tracks, clock.clone(), factory.sender()).expect("a thread");
    let ends = clock.now_us() + 2_000_000;
    while handle.status().last_error.is_none() && clock.now_us() < ends {
        let _ = receiver.next_within(Duration::from_millis(20));
    }
    let status = handle.status();
    let why = status.last_error.expect("a reason");
    assert!(!status.connected && why.contains("/dev/video-absent"), "{why}");
    let begun = clock.now_us();
    drop(handle);
    assert!(clock.now_us() - begun < 500_000, "it does not wait for the next attempt");
}

#[test]
fn a_slow_camera_releases_its_hands_between_pictures() {
    let Some(folder) = models_folder() else { return };
    // A hand in every picture, one picture a second.
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("slow.y4m");
    let scene = DrawnScene { size: (320, 240), ..DrawnScene::default() };
    let key = sculptd_devices::sim::hand::HandKey::flat(0, glam::Vec3::new(0.0, 200.0, 0.0))
        .turned(0.0, 1.57, 0.0)
        .spread(0.3);
    let hand = sculptd_camera::drawn_hand::DrawnHand::new(&key, false, 1.0);
    let Picture { rgb, .. } = draw(&scene, &[hand]);
    let mut bytes = b"YUV4MPEG2 W320 H240 F1:1 C444 XCOLORRANGE=FULL\n".to_vec();
    for _ in 0..3 {
        bytes.extend(b"FRAME\n");
        for [r, g, b, offset] in
            [[0.299, 0.587, 0.114, 0.0], [-0.169, -0.331, 0.5, 128.0], [0.5, -0.419, -0.081, 128.0]]
        {
            let of = |p: &[u8]| f32::from(p[0]) * r + f32::from(p[1]) * g + f32::from(p[2]) * b;
            bytes.extend(rgb.chunks_exact(3).map(|p| (of(p) + offset) as u8));
        }
    }
    write(&path, &bytes);
    let (factory, mut receiver) = queue::channel(64);
    let tracks = models::load(&folder).expect("the models load");
    let config = config(CameraChoice::File(path));
    let handle = camera_thread::start(config, tracks, Clock::monotonic(), factory.sender())
        .expect("a thread");
    let mut counts = Vec::new();
    while let Some(sample) = receiver.next_within(Duration::from_millis(2500)) {
        let sculptd_devices::Body::Hands(hands) = sample.body else { panic!("{sample:?}") };
        counts.push(hands.count);
    }
    assert!(counts.contains(&1), "the hand is seen: {counts:?}");
    for pair in counts.windows(2) {
        assert!(pair[0] == 0 || pair[1] == 0, "released between pictures: {counts:?}");
    }
    assert_eq!(counts.last(), Some(&0), "released at the end: {counts:?}");
    assert!(handle.status().ended);
}
